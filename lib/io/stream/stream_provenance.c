/* Provenance: the command line of each tool that worked on the stream, as typed into a shell. */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool has_control(const char *text)
{
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text < 0x20 || *text == 0x7f) {
            return true;
        }
    }
    return false;
}

/* Write an argument as a shell reads it, at most four bytes for each of its own and three more: as it is,
 * within quotation marks, or with line ends and other control characters as $'...' with escapes. Returns the
 * end. */
static char *put_quoted(char *at, const char *argument)
{
    static const char safe[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
    bool escaped = has_control(argument);
    if (argument[0] != '\0' && argument[strspn(argument, safe)] == '\0') {
        return stpcpy(at, argument);
    }
    at = stpcpy(at, escaped ? "$'" : "'");
    for (const char *c = argument; *c != '\0'; c++) {
        unsigned char byte = (unsigned char)*c;
        if (escaped && (byte < 0x20 || byte == 0x7f)) {
            at += sprintf(at, "\\x%02x", byte);
        } else if (*c == '\'' || (escaped && *c == '\\')) {
            at += sprintf(at, escaped ? "\\%c" : "'\\%c'", *c);
        } else {
            *at++ = *c;
        }
    }
    return stpcpy(at, "'");
}

enum status stream_append_provenance(struct stream *stream, const char *line, size_t length,
                                     struct error *error)
{
    int64_t count = stream->provenance_count;
    if ((count & (count - 1)) == 0) { /* the array is full at 0, 1, 2, 4, 8, ... lines */
        RETURN_IF_ERROR(RESIZE_ARRAY(&stream->provenance, count > 0 ? 2 * count : 1, error));
    }
    char *copy = strndup(line, length);
    if (copy == NULL) {
        return fail_memory(error, "provenance");
    }
    stream->provenance[stream->provenance_count++] = copy;
    return STATUS_OK;
}

enum status stream_add_provenance(struct stream *stream, int argc, char *const argv[], struct error *error)
{
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    const char *tool = slash != NULL ? slash + 1 : argc > 0 ? argv[0] : "";
    size_t room = 8 * strlen(tool) + sizeof MTS_VERSION + 16;
    for (int i = 1; i < argc; i++) {
        room += 4 * strlen(argv[i]) + 4;
    }
    NEW_SCRATCH(char, text, (int64_t)room, error);
    char *at = put_quoted(stpcpy(put_quoted(text, tool), " " MTS_VERSION " "), tool);
    for (int i = 1; i < argc; i++) {
        at = put_quoted(stpcpy(at, " "), argv[i]);
    }
    return at - text > LINE_LIMIT - 8 /* "# @ " and the newline */
               ? fail(error, STATUS_INPUT, "the command line is longer than %d bytes", LINE_LIMIT)
               : stream_append_provenance(stream, text, (size_t)(at - text), error);
}
