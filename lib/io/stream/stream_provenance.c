/* Provenance: the command line of each tool that worked on the stream, as typed into a shell. */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Text that grows up to LINE_LIMIT; `full` when it would grow beyond. */
struct line {
    char text[LINE_LIMIT];
    size_t length;
    bool full;
};

static void append(struct line *line, const char *bytes, size_t count)
{
    /* Room for "# @ ", the newline and the terminating zero. */
    if (count > sizeof line->text - 8 - line->length) {
        line->full = true;
        return;
    }
    memcpy(line->text + line->length, bytes, count);
    line->length += count;
    line->text[line->length] = '\0';
}

static void append_text(struct line *line, const char *text)
{
    append(line, text, strlen(text));
}

static bool has_control(const char *text)
{
    for (; *text != '\0'; text++) {
        if ((unsigned char)*text < 0x20 || *text == 0x7f) {
            return true;
        }
    }
    return false;
}

/* $'...' with escapes, for arguments with line ends and other control characters. */
static void append_escaped(struct line *line, const char *argument)
{
    append_text(line, "$'");
    for (const char *c = argument; *c != '\0'; c++) {
        unsigned char byte = (unsigned char)*c;
        char escape[8] = {*c, '\0'};
        if (byte < 0x20 || byte == 0x7f) {
            snprintf(escape, sizeof escape, "\\x%02x", byte);
        } else if (*c == '\'' || *c == '\\') {
            snprintf(escape, sizeof escape, "\\%c", *c);
        }
        append_text(line, escape);
    }
    append_text(line, "'");
}

static void append_quoted(struct line *line, const char *argument)
{
    static const char safe[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
    if (argument[0] != '\0' && argument[strspn(argument, safe)] == '\0') {
        append_text(line, argument);
        return;
    }
    if (has_control(argument)) {
        append_escaped(line, argument);
        return;
    }
    append_text(line, "'");
    for (const char *c = argument; *c != '\0'; c++) {
        append(line, *c == '\'' ? "'\\''" : c, *c == '\'' ? 4 : 1);
    }
    append_text(line, "'");
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
    SCRATCH struct line *line = malloc(sizeof *line);
    if (line == NULL) {
        return fail_memory(error, "provenance");
    }
    line->length = 0;
    line->full = false;
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    const char *tool = slash != NULL ? slash + 1 : argc > 0 ? argv[0] : "";
    append_quoted(line, tool);
    append_text(line, " " MTS_VERSION " ");
    append_quoted(line, tool);
    for (int i = 1; i < argc; i++) {
        append_text(line, " ");
        append_quoted(line, argv[i]);
    }
    return line->full ? fail(error, STATUS_INPUT, "the command line is longer than %d bytes", LINE_LIMIT)
                      : stream_append_provenance(stream, line->text, line->length, error);
}
