/* Reading a stream: one pass, every line and payload checked, no allocation from the counts of a header
 * alone. */
#include "io/files/textfile.h"
#include "io/stream/stream_private.h"

#include "base/memory.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* ---- the bytes: a regular file is mapped, everything else is read ---- */

/* Map a regular file that is at its beginning. The mapping is private and writable: changes of a payload
 * never reach the file. */
static bool map_file(int descriptor, struct stream *stream)
{
    struct stat file;
    if (fstat(descriptor, &file) != 0 || !S_ISREG(file.st_mode) || file.st_size <= 0 ||
        lseek(descriptor, 0, SEEK_CUR) != 0) {
        return false;
    }
    size_t size = (size_t)file.st_size;
    void *mapping = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE, descriptor, 0);
    if (mapping == MAP_FAILED) {
        return false;
    }
    stream->mapping = mapping;
    stream->mapping_size = size;
    stream->is_file = true;
    return true;
}

static bool is_stream(const char *bytes, size_t size)
{
    return starts_with(bytes, size, FIRST_LINE);
}

/* Map a regular file that is at its beginning, or read what there is; of what does not begin as a stream only
 * the beginning. */
static enum status input_open(struct input *input, struct stream *stream, int descriptor, struct error *error)
{
    char *bytes = NULL;
    enum status status = STATUS_OK;
    if (!map_file(descriptor, stream)) {
        (void)fcntl(descriptor, F_SETPIPE_SZ, BLOCK_SIZE); /* fewer context switches for a pipe, if granted */
        status = descriptor_read_all(descriptor, SIZE_MAX, is_stream, &bytes, &stream->mapping_size, error);
        stream->mapping = bytes;
    }
    input->at = input->start = stream->mapping;
    input->end = input->start + stream->mapping_size;
    return status;
}

/* ---- the header line of a section: "# NAME TYPE ROWS COLS [key=value ...]" ---- */

static enum status header_type(const char *word, struct section *section, struct error *error)
{
    for (enum element_type type = TYPE_I4; type <= TYPE_F8; type++) {
        if (strcmp(word, element_type_name(type)) == 0) {
            section->type = type;
            return STATUS_OK;
        }
    }
    return fail(error, STATUS_INPUT, "%.40s: type '%.40s' is none of i4, i8, f4, f8", section->name, word);
}

static enum status header_count(const char *word, const char *what, const struct section *section,
                                int64_t *count, struct error *error)
{
    const char *end = word + strlen(word);
    if (word[0] == '+' || number_parse_integer(word, end, 0, INT64_MAX, count) != end) {
        return fail(error, STATUS_INPUT, "%.40s: '%.40s' is not a number of %s", section->name, word, what);
    }
    return STATUS_OK;
}

/* Gather key=value words but enc= into section->attributes, which has room for the whole line. */
static enum status header_attributes(char *at, struct section *section, bool *binary, struct error *error)
{
    bool encoded = false;
    char *to = section->attributes;
    for (char *word = text_word(&at); *word != '\0'; word = text_word(&at)) {
        if (strncmp(word, "enc=", 4) != 0) {
            to = stpcpy(stpcpy(to, to > section->attributes ? " " : ""), word);
            continue;
        }
        if (encoded || (strcmp(word, "enc=text") != 0 && strcmp(word, "enc=bin") != 0)) {
            return fail(error, STATUS_INPUT,
                        "%.40s: '%.40s': a section has one encoding, enc=text or enc=bin", section->name,
                        word);
        }
        encoded = true;
        *binary = strcmp(word, "enc=bin") == 0;
    }
    *to = '\0';
    return STATUS_OK;
}

/* Parse and check a line without its newline; the section is empty before. */
static enum status header_parse(const char *line, size_t length, struct section *section, bool *binary,
                                struct error *error)
{
    SCRATCH char *copy = strndup(line, length);
    section->attributes = malloc(length + 1);
    if (copy == NULL || section->attributes == NULL) {
        return fail_memory(error, "header");
    }
    if (!starts_with(line, length, "# ")) {
        return fail(error, STATUS_INPUT,
                    "'%.40s' stands where a section header '# NAME TYPE ROWS COLS' should", copy);
    }
    char *at = copy + 2;
    section->name = strdup(text_word(&at));
    if (section->name == NULL) {
        return fail_memory(error, "header");
    }
    RETURN_IF_ERROR(header_type(text_word(&at), section, error));
    RETURN_IF_ERROR(header_count(text_word(&at), "rows", section, &section->rows, error));
    RETURN_IF_ERROR(header_count(text_word(&at), "columns", section, &section->cols, error));
    RETURN_IF_ERROR(header_attributes(at, section, binary, error));
    return section_validate(section, error);
}

/* ---- the stream ---- */

struct reader {
    struct input input;
    struct stream *stream;
    uLong crc;   /* of the bytes outside the payloads, so far */
    bool binary; /* some section is binary: the end line must carry the crc */
};

/* Read a line outside of payloads, without its newline, which must exist; it counts for the CRC of the end
 * line. */
static enum status frame_line(struct reader *reader, const char **line, size_t *length, struct error *error)
{
    struct input *input = &reader->input;
    size_t held = (size_t)(input->end - input->at), bound = held < LINE_LIMIT ? held : LINE_LIMIT;
    const char *newline = memchr(input->at, '\n', bound);
    if (newline == NULL) {
        return bound == LINE_LIMIT
                   ? fail(error, STATUS_INPUT, "a line longer than %d bytes: not an mts stream", LINE_LIMIT)
                   : fail(error, STATUS_INPUT,
                          "ends without its end line: cut short (did an earlier stage fail?)");
    }
    *line = input->at;
    *length = (size_t)(newline - input->at);
    input->at = newline + 1;
    return memchr(*line, '\0', *length) == NULL
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "zero byte in a header line: damaged");
}

static void frame_count(struct reader *reader, const char *line, size_t length)
{
    reader->crc = crc32_z(reader->crc, (const Bytef *)line, length);
}

/* The error of a first line that is not "# mts 1", with the remedy if it is known. */
static enum status fail_first_line(const char *line, size_t length, struct error *error)
{
    int shown = (int)(length < 40 ? length : 40);
    if (starts_with(line, length, "# mts 1") && line[length - 1] == '\r') {
        return fail(error, STATUS_INPUT, "lines end in CR LF: remove them with tr -d '\\r'");
    }
    if (starts_with(line, length, "\xef\xbb\xbf") || starts_with(line, length, "\xff\xfe") ||
        starts_with(line, length, "\xfe\xff")) {
        return fail(error, STATUS_INPUT, "begins with a byte order mark: save it as plain ASCII or UTF-8");
    }
    if (starts_with(line, length, "# mts ")) {
        return fail(error, STATUS_INPUT, "stream version '%.*s', this program reads version 1", shown - 6,
                    line + 6);
    }
    if (starts_with(line, length, "$MeshFormat")) {
        return fail(error, STATUS_INPUT, "a gmsh mesh, not an mts stream: run nodes");
    }
    return fail(error, STATUS_INPUT, "not an mts stream: begins with '%.*s', not '# mts 1'", shown, line);
}

static enum status read_first_line(struct reader *reader, struct error *error)
{
    struct input *input = &reader->input;
    static const char expected[] = FIRST_LINE;
    size_t held = (size_t)(input->end - input->at);
    if (held == 0) {
        return fail(error, STATUS_INPUT, "empty: no stream arrived (did an earlier stage fail?)");
    }
    if (!starts_with(input->at, held, expected)) {
        if (held < strlen(expected) && memcmp(input->at, expected, held) == 0) {
            return fail(error, STATUS_INPUT, "cut short in its first line (did an earlier stage fail?)");
        }
        size_t shown = held < 64 ? held : 64;
        const char *newline = memchr(input->at, '\n', shown);
        return fail_first_line(input->at, newline != NULL ? (size_t)(newline - input->at) : shown, error);
    }
    frame_count(reader, input->at, strlen(expected));
    input->at += strlen(expected);
    return STATUS_OK;
}

/* Parse exactly eight lower-case hexadecimal digits. (With upper case one flipped bit could pass.) */
static bool parse_crc(const char *text, size_t length, uLong *crc)
{
    static const char digits[] = "0123456789abcdef";
    *crc = 0;
    for (size_t i = 0; i < length; i++) {
        const char *digit = memchr(digits, text[i], 16);
        if (digit == NULL) {
            return false;
        }
        *crc = *crc << 4 | (uLong)(digit - digits);
    }
    return length == 8;
}

/* Read the newline behind a binary payload and its line "# crc32 XXXXXXXX". */
static enum status read_crc_line(struct reader *reader, const struct section *section, uLong crc,
                                 struct error *error)
{
    static const char prefix[] = "\n# crc32 ";
    enum { PREFIX = sizeof prefix - 1, SIZE = PREFIX + 8 + 1 };
    struct input *input = &reader->input;
    uLong stated;
    if (input->end - input->at < SIZE) {
        return fail_short(section, section->rows, error);
    }
    const char *at = input->at;
    if (memcmp(at, prefix, PREFIX) != 0 || !parse_crc(at + PREFIX, 8, &stated) || at[SIZE - 1] != '\n') {
        return fail(error, STATUS_INPUT, "%s: no '# crc32' line behind the payload: damaged", section->name);
    }
    if (stated != crc) {
        return fail(error, STATUS_INPUT, "%s: wrong crc32: damaged on its way or on disk", section->name);
    }
    frame_count(reader, at + 1, SIZE - 1);
    input->at += SIZE;
    return STATUS_OK;
}

static enum status read_binary(struct reader *reader, struct section *section, uLong header_crc,
                               struct error *error)
{
    struct input *input = &reader->input;
    int64_t count = section->rows * section->cols, offset = input->at - input->start;
    size_t bytes = (size_t)count * element_size(section->type), held = (size_t)(input->end - input->at);
    reader->binary = true;
    if (offset % PAYLOAD_ALIGNMENT != 0) {
        return fail(error, STATUS_INPUT, "%s: binary payload at offset %jd, not a multiple of %d: damaged",
                    section->name, offset, PAYLOAD_ALIGNMENT);
    }
    if (held < bytes) {
        return fail_short(section, (int64_t)(held / element_size(section->type)) / section->cols, error);
    }
    section->data = (char *)reader->stream->mapping + offset;
    input->at += bytes;
    uLong crc = bytes > 0 ? crc32_z(header_crc, section->data, bytes) : header_crc;
    section_give_back(reader->stream, section, false);
    return read_crc_line(reader, section, crc, error);
}

static enum status read_section(struct reader *reader, const char *line, size_t length, struct error *error)
{
    FREED_BY(section_free) struct section section = {0};
    uLong crc = crc32_z(0, (const Bytef *)line, length + 1);
    bool binary = false;
    frame_count(reader, line, length + 1);
    RETURN_IF_ERROR(header_parse(line, length, &section, &binary, error));
    if (stream_find(reader->stream, section.name) != NULL) {
        return fail(error, STATUS_INPUT, "%s: this section stands twice in the stream", section.name);
    }
    RETURN_IF_ERROR(binary ? read_binary(reader, &section, crc, error)
                           : payload_read_text(&reader->input, &section, error));
    return stream_add(reader->stream, &section, error);
}

/* Parse "# end COUNT" or "# end COUNT crc32=XXXXXXXX", with nothing behind it. */
static enum status read_end(struct reader *reader, const char *line, size_t length, struct error *error)
{
    static const char prefix[] = "# end ";
    static const char key[] = " crc32=";
    const char *end = line + length;
    const char *at = line + strlen(prefix);
    const char *behind = at;
    int64_t count = 0;
    uLong stated;
    while (behind < end && *behind >= '0' && *behind <= '9') {
        behind++;
    }
    bool has_crc = starts_with(behind, (size_t)(end - behind), key);
    if (number_parse_integer(at, behind, 0, INT64_MAX, &count) != behind || !(has_crc || behind == end)) {
        return fail(error, STATUS_INPUT, "'%.*s' is not '# end COUNT%s'", (int)(length < 60 ? length : 60),
                    line, reader->binary ? " crc32=XXXXXXXX" : "");
    }
    if (reader->binary && !has_crc) {
        return fail(error, STATUS_INPUT, "the end line lacks the crc32= of a stream with binary sections");
    }
    if (count != reader->stream->section_count) {
        return fail(error, STATUS_INPUT, "%jd sections, the end line says %jd", reader->stream->section_count,
                    count);
    }
    if (has_crc) {
        frame_count(reader, line, (size_t)(behind - line));
        const char *digits = behind + strlen(key);
        if (!parse_crc(digits, (size_t)(end - digits), &stated) || stated != reader->crc) {
            return fail(error, STATUS_INPUT, "wrong crc32 of the header lines: damaged or edited");
        }
    }
    return reader->input.at == reader->input.end
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "goes on behind its end line: two streams in one?");
}

/* Provenance is shown on terminals: no control characters but tabs. */
static enum status provenance_check(const char *line, size_t length, struct error *error)
{
    for (size_t i = 0; i < length; i++) {
        if (((unsigned char)line[i] < 0x20 && line[i] != '\t') || line[i] == 0x7f) {
            return fail(error, STATUS_INPUT, "control character in a provenance line: damaged");
        }
    }
    return STATUS_OK;
}

static enum status read_lines(struct reader *reader, struct error *error)
{
    const char *line = NULL;
    size_t length = 0;
    RETURN_IF_ERROR(read_first_line(reader, error));
    for (;;) {
        RETURN_IF_ERROR(frame_line(reader, &line, &length, error));
        if (starts_with(line, length, "# end ")) {
            return read_end(reader, line, length, error);
        }
        if (starts_with(line, length, "# stopped ")) {
            return fail(error, STATUS_INPUT, "not whole, stopped: %.*s; mts recover takes what there is",
                        (int)(length < 300 ? length - 10 : 290), line + 10);
        }
        if (!starts_with(line, length, "# @ ")) {
            RETURN_IF_ERROR(read_section(reader, line, length, error));
        } else if (reader->stream->section_count > 0) {
            return fail(error, STATUS_INPUT, "a provenance line behind a section");
        } else {
            frame_count(reader, line, length + 1);
            RETURN_IF_ERROR(provenance_check(line, length, error));
            RETURN_IF_ERROR(
                names_print(&reader->stream->provenance, error, "%.*s", (int)length - 4, line + 4));
        }
    }
    return STATUS_OK;
}

enum status stream_recover(struct stream *stream, int descriptor, const char *name, struct error *why,
                           struct error *error)
{
    struct reader reader = {.stream = stream, .crc = 0};
    stream_init(stream);
    enum status status = input_open(&reader.input, stream, descriptor, error);
    if (status == STATUS_OK) {
        status = read_lines(&reader, error);
    }
    if (status == STATUS_INPUT && why != NULL && stream->section_count > 0) {
        *why = *error;
        status = STATUS_OK;
    }
    if (!reader.binary && !stream->is_file) { /* all is copied */
        stream_free_input(stream);
    }
    if (status != STATUS_OK) {
        stream_free(stream);
    }
    return fail_in(error, status, "%s", name);
}

enum status stream_read(struct stream *stream, int descriptor, const char *name, struct error *error)
{
    return stream_recover(stream, descriptor, name, NULL, error);
}
