/* The header line of a section taken apart: "# NAME TYPE ROWS COLS [key=value ...]". */
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static char *next_word(char **at)
{
    char *word = *at + strspn(*at, " \t");
    char *end = word + strcspn(word, " \t");
    *at = *end != '\0' ? end + 1 : end;
    *end = '\0';
    return word;
}

static enum status header_type(const char *word, struct header *header, struct error *error)
{
    for (enum element_type type = TYPE_I4; type <= TYPE_F8; type++) {
        if (strcmp(word, element_type_name(type)) == 0) {
            header->type = type;
            return STATUS_OK;
        }
    }
    return fail(error, STATUS_INPUT, "%.40s: type '%.40s' is none of i4, i8, f4, f8", header->name, word);
}

static enum status header_count(const char *word, const char *what, const struct header *header,
                                int64_t *count, struct error *error)
{
    const char *end = word + strlen(word);
    if (word[0] == '+' || number_parse_integer(word, end, 0, INT64_MAX, count) != end) {
        return fail(error, STATUS_INPUT, "%.40s: '%.40s' is not a number of %s", header->name, word, what);
    }
    return STATUS_OK;
}

/* Gather key=value words but enc= into header->attributes, which has room for the whole line. */
static enum status header_attributes(char *at, struct header *header, struct error *error)
{
    bool encoded = false;
    char *to = header->attributes;
    for (char *word = next_word(&at); *word != '\0'; word = next_word(&at)) {
        if (strncmp(word, "enc=", 4) != 0) {
            size_t length = strlen(word);
            if (to > header->attributes) {
                *to++ = ' ';
            }
            memcpy(to, word, length);
            to += length;
            continue;
        }
        if (encoded || (strcmp(word, "enc=text") != 0 && strcmp(word, "enc=bin") != 0)) {
            return fail(error, STATUS_INPUT,
                        "%.40s: '%.40s': a section has one encoding, enc=text or enc=bin", header->name,
                        word);
        }
        encoded = true;
        header->binary = strcmp(word, "enc=bin") == 0;
    }
    *to = '\0';
    return STATUS_OK;
}

void header_free(struct header *header)
{
    FREE_ALL(header->copy, header->attributes);
}

enum status header_parse(const char *line, size_t length, struct header *header, struct error *error)
{
    *header = (struct header){.copy = strndup(line, length), .attributes = malloc(length + 1)};
    if (header->copy == NULL || header->attributes == NULL) {
        return fail_memory(error, "header");
    }
    if (length > 0 && line[length - 1] == '\r') {
        return fail(error, STATUS_INPUT, "lines end in CR LF: remove them with tr -d '\\r'");
    }
    if (!starts_with(line, length, "# ")) {
        return fail(error, STATUS_INPUT,
                    "'%.40s' stands where a section header '# NAME TYPE ROWS COLS' should", header->copy);
    }
    char *at = header->copy + 2;
    header->name = next_word(&at);
    RETURN_IF_ERROR(header_type(next_word(&at), header, error));
    RETURN_IF_ERROR(header_count(next_word(&at), "rows", header, &header->rows, error));
    RETURN_IF_ERROR(header_count(next_word(&at), "columns", header, &header->cols, error));
    RETURN_IF_ERROR(header_attributes(at, header, error));
    return section_validate(header->name, header->type, header->rows, header->cols, header->attributes,
                            error);
}
