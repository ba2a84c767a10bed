#include "io/files/textfile.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- descriptors ---- */

static enum status descriptor_read(int descriptor, void *bytes, size_t size, size_t *got, struct error *error)
{
    ssize_t count;
    do {
        count = read(descriptor, bytes, size);
    } while (count < 0 && errno == EINTR);
    *got = count > 0 ? (size_t)count : 0;
    return count >= 0        ? STATUS_OK
           : errno == EISDIR ? fail(error, STATUS_INPUT, "is a directory")
                             : fail(error, STATUS_SYSTEM, "cannot read: %s", strerror(errno));
}

enum status descriptor_read_all(int descriptor, size_t most, bool (*goes_on)(const char *bytes, size_t size),
                                char **bytes, size_t *size, struct error *error)
{
    enum { HEAD = 1 << 16 };
    int64_t room = 0;
    size_t got = 1;
    for (*size = 0; got > 0 && *size <= most; *size += got) {
        if (*size >= HEAD && goes_on != NULL && !goes_on(*bytes, *size)) {
            break;
        }
        RETURN_IF_ERROR(GROW_ARRAY(bytes, (int64_t)*size + HEAD + ROOM_BEHIND, &room, error));
        RETURN_IF_ERROR(
            descriptor_read(descriptor, *bytes + *size, (size_t)room - *size - ROOM_BEHIND, &got, error));
    }
    memset(*bytes + *size, 0, ROOM_BEHIND);
    return STATUS_OK;
}

void descriptor_close(const int *descriptor)
{
    if (*descriptor >= 0 && *descriptor != STDIN_FILENO) {
        close(*descriptor);
    }
}

/* ---- files ---- */

/* Check the kind of a file before it is opened, so that devices are not touched. If the file is replaced in
 * between, only the read fails. */
static enum status check_kind(const char *path, struct error *error)
{
    struct stat facts;
    if (stat(path, &facts) != 0) {
        return fail(error, STATUS_INPUT, "%s: %s", path, strerror(errno));
    }
    return S_ISREG(facts.st_mode) || S_ISFIFO(facts.st_mode)
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "%s: is a folder, device or socket: name a text file", path);
}

static enum status textfile_check(const char *path, const struct textfile *file, struct error *error)
{
    const unsigned char *bytes = (const unsigned char *)file->text;
    if (memcmp(file->text, "\xef\xbb\xbf", file->size < 3 ? 1 : 3) == 0 || bytes[0] >= 0xfe) {
        return fail(error, STATUS_INPUT, "%s:1: begins with a byte order mark: save as plain text", path);
    }
    int64_t line = 1;
    for (size_t i = 0; i < file->size; i++) {
        unsigned char c = bytes[i];
        if (c == '\n') {
            line++;
        } else if (c == '\r') {
            return fail(error, STATUS_INPUT, "%s:%jd: carriage return: save with Unix line ends", path, line);
        } else if ((c < 0x20 && c != '\t') || c == 0x7f) {
            return fail(error, STATUS_INPUT, "%s:%jd: control character 0x%02x", path, line, (unsigned)c);
        }
    }
    if (file->text[file->size - 1] != '\n') {
        return fail(error, STATUS_INPUT,
                    "%s:%jd: last line without newline: truncated? end it with a newline", path, line);
    }
    return STATUS_OK;
}

enum status bytefile_read(const char *path, size_t most, struct textfile *file, struct error *error)
{
    *file = (struct textfile){0};
    RETURN_IF_ERROR(check_kind(path, error));
    FREED_BY(descriptor_close) int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0) {
        return fail_system(error, path);
    }
    RETURN_IF_ERROR(fail_in(
        error, descriptor_read_all(descriptor, most, NULL, &file->text, &file->size, error), "%s", path));
    if (file->size > most) {
        return fail(error, STATUS_INPUT, "%s: larger than %zu bytes", path, most);
    }
    return file->size > 0 ? STATUS_OK : fail(error, STATUS_INPUT, "%s: is empty", path);
}

enum status textfile_read(const char *path, size_t most, struct textfile *file, struct error *error)
{
    RETURN_IF_ERROR(bytefile_read(path, most, file, error));
    return textfile_check(path, file, error);
}

void textfile_free(struct textfile *file)
{
    free(file->text);
    *file = (struct textfile){0};
}

char *text_word(char **at)
{
    char *word = *at + strspn(*at, " \t");
    char *end = word + strcspn(word, " \t");
    *at = *end != '\0' ? end + 1 : end;
    *end = '\0';
    return word;
}
