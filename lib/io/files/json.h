/* JSON (RFC 8259), passed over value by value. */
#pragma once

#include "base/status.h"

/* A text that is being read. After the first failure nothing more is given. */
struct json {
    char *at; /* ends with a NUL; strings are decoded in place */
    enum status status;
    struct error *error;
    int64_t line;   /* of `at`, from 1 */
    char path[256]; /* of the value: "markups.position", the keys of the objects that hold it; cut when longer
                     */
    /* Called with each string, or true, false or null, as UTF-8 that stays where it is; with each finite
     * number (text NULL); and at the end of each object (text NULL, NAN). */
    void (*take)(struct json *json, char *text, double number);
    void *context;
};

/* Read the text, which is one value. */
void json_read(struct json *json);

/* Fail with STATUS_INPUT and a message "LINE: WHAT", unless it has failed before. */
void json_fail(struct json *json, const char *what);
