/* JSON (RFC 8259), scanned value by value: what is not asked for is skipped. */
#pragma once

#include "base/status.h"

/* A text that is being scanned. The first failure stays: then nothing more is found, and every loop ends. */
struct json {
    char *at; /* ends with a NUL; strings are decoded in place */
    enum status status;
    struct error *error;
    int depth;
    int64_t line; /* of `at`, from 1 */
};

/* The items of an object or array: for (bool more = json_open(json, '{'); more; more = json_next(json, '}')),
 * in an object with json_key in front of each value. */
bool json_open(struct json *json, char bracket);
bool json_next(struct json *json, char bracket);

/* Take a string, as UTF-8, which stays where it is; the key of an item with the colon behind it; a number. */
char *json_string(struct json *json);
char *json_key(struct json *json);
double json_number(struct json *json);

/* The next character that is no blank; NUL at the end and after a failure. */
char json_peek(struct json *json);

/* Pass over a value. */
void json_skip(struct json *json);

/* Nothing but blanks is left. */
void json_end(struct json *json);

/* Fail with STATUS_INPUT and a message "LINE: WHAT", unless it has failed before. */
void json_fail(struct json *json, const char *what);
