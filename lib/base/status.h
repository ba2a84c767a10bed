/* Status codes and error messages: every function of lib/ that can fail returns a status and
 * describes the failure in a struct error; only the tools print it.
 *
 * GSL by default ends the process when one of its functions fails. The library does not change that, as it
 * holds for the whole process: a program calls gsl_set_error_handler_off() first, and then memory that GSL
 * lacks (load curves, tables of displacements, random clouds) is a status as well. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The values are the exit statuses of the tools. */
enum status {
    STATUS_OK = 0,      /* good */
    STATUS_VERDICT = 1, /* the computation says no: differs, diverged, singular, invalid */
    STATUS_INPUT = 2,   /* wrong usage or malformed input */
    STATUS_SYSTEM = 3   /* input/output or memory failure */
};

#define MUST_CHECK __attribute__((warn_unused_result))

/* Evaluate a status expression; on failure, return its status. What is to be freed then: see SCRATCH in
 * memory.h. */
#define RETURN_IF_ERROR(expression)                                                                          \
    do {                                                                                                     \
        enum status status_of_expression = (expression);                                                     \
        if (status_of_expression != STATUS_OK) {                                                             \
            return status_of_expression;                                                                     \
        }                                                                                                    \
    } while (0)

/* One line, `section: row: what is wrong: remedy`, without program name and newline. */
struct error {
    char text[512];
};

/* Store a printf-style message in `error` and return `status`, so that callers can write
 * `return fail(error, STATUS_INPUT, "...")`. Control characters in the message are replaced by '?'. */
enum status fail(struct error *error, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Note what an item of a loop that threads share came to; its message is in `own`. The failure of the first
 * item that failed stays, for any number of threads: its status in *first, which is empty to begin with, and
 * its message in `error`. */
struct first_failure {
    enum status status;
    int64_t item;
};
void note_failure(struct first_failure *first, int64_t item, enum status status, const struct error *own,
                  struct error *error);

/* Put "context: " in front of the message of `error`, unless `status` is STATUS_OK; return `status`. So the
 * status of a call may stand in its place: fail_in(error, call(..., error), "...") */
enum status fail_in(struct error *error, enum status status, const char *context, ...)
    __attribute__((format(printf, 3, 4)));

/* Print behind the text that text[size] holds, as far as there is room. */
void text_append(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Whether a text, such as the name of a file, ends in `ending`. */
bool text_ends(const char *text, const char *ending);

/* fail() with STATUS_SYSTEM and "NAME: " with the cause that errno has. */
enum status fail_system(struct error *error, const char *name);

/* fail() with the out-of-memory message for `what`. */
enum status fail_memory(struct error *error, const char *what);
