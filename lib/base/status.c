#include "base/status.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Make a message one line, whatever the names in it contain. */
static void make_one_line(char *text)
{
    for (; *text != '\0'; text++) {
        unsigned char c = (unsigned char)*text;
        if (c < 0x20 || c == 0x7f) {
            *text = '?';
        }
    }
}

enum status fail(struct error *error, enum status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    make_one_line(error->text);
    return status;
}

void note_failure(struct first_failure *first, int64_t item, enum status status, const struct error *own,
                  struct error *error)
{
#pragma omp critical(note_failure)
    if (status != STATUS_OK && (first->status == STATUS_OK || item < first->item)) {
        *first = (struct first_failure){status, item};
        *error = *own;
    }
}

enum status fail_in(struct error *error, enum status status, const char *context, ...)
{
    char joined[2 * sizeof error->text];
    va_list arguments;
    if (status == STATUS_OK) {
        return status;
    }
    va_start(arguments, context);
    vsnprintf(joined, sizeof error->text, context, arguments);
    va_end(arguments);
    text_append(joined, sizeof joined, ": %s", error->text);
    memcpy(error->text, joined, sizeof error->text);
    error->text[sizeof error->text - 1] = '\0';
    make_one_line(error->text);
    return status;
}

void text_append(char *text, size_t size, const char *format, ...)
{
    size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + length, size - length, format, arguments);
    va_end(arguments);
}

bool text_ends(const char *text, const char *ending)
{
    size_t length = strlen(text), tail = strlen(ending);
    return length >= tail && strcmp(text + length - tail, ending) == 0;
}

enum status fail_memory(struct error *error, const char *what)
{
    return fail(error, STATUS_SYSTEM, "%s: out of memory", what + (what[0] == '&'));
}

enum status fail_system(struct error *error, const char *name)
{
    return fail(error, STATUS_SYSTEM, "%s: %s", name, strerror(errno));
}
