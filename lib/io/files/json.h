/* JSON (RFC 8259), whose values are given one after the other. */
#pragma once

#include "base/status.h"

/* What is given: text of a string, as UTF-8 that stays where it is; a finite number; true, false or null; the
 * end of an object. */
enum json_kind { JSON_STRING, JSON_NUMBER, JSON_WORD, JSON_END };

/* A text that is being read. After the first failure nothing more is given. */
struct json {
    char *at; /* ends with a NUL; strings are decoded in place */
    enum status status;
    struct error *error;
    int64_t line; /* of `at`, from 1 */
    /* Of the value: "markups[].position[]", the keys of the objects that hold it and [] for each array; cut
     * when longer. */
    char path[256];
    void (*take)(struct json *json, enum json_kind kind, char *text, double number);
    void *context;
};

/* Read the text, which is one value. */
void json_read(struct json *json);

/* Fail with STATUS_INPUT and a message "LINE: WHAT", unless it has failed before. */
void json_fail(struct json *json, const char *what);
