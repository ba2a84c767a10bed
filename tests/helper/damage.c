/* damage [-a] FILE...: cut each stream short at every byte, flip one bit of every byte (-a: each bit of it),
 * and have that read. A cut stream must be refused, and so must a binary one with a flipped bit. A text
 * stream has no checksum: there a flipped bit may turn a number into another one, or a name; but no shape,
 * and no number into anything else. Prints for each file its bytes and how many cuts and flips were refused;
 * status 1 when one was taken that must not be. */
#include "io/stream/stream.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct target {
    const char *name;
    char *bytes;
    size_t size;
    int file; /* in memory, with these bytes */
    struct stream whole;
    bool binary;
};

static void need(bool condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "damage: %s\n", what);
        exit(3);
    }
}

static bool is_read(const struct target *target, struct stream *stream)
{
    struct error error;
    need(lseek(target->file, 0, SEEK_SET) == 0, "cannot seek");
    return stream_read(stream, target->file, target->name, &error) == STATUS_OK;
}

static void open_target(struct target *target, const char *name)
{
    FILE *file = fopen(name, "rb");
    need(file != NULL, name);
    target->name = name;
    target->bytes = malloc(1 << 24);
    need(target->bytes != NULL, "out of memory");
    target->size = fread(target->bytes, 1, 1 << 24, file);
    fclose(file);
    target->file = memfd_create("damage", 0);
    need(target->file >= 0 && write(target->file, target->bytes, target->size) == (ssize_t)target->size,
         "cannot write");
    need(is_read(target, &target->whole), "the undamaged stream is refused");
    target->binary = memmem(target->bytes, target->size, "\n# crc32 ", 9) != NULL;
}

/* May a reader take this stream, with byte `at` damaged, for good? */
static bool is_excused(const struct target *target, size_t at, char damaged, const struct stream *stream)
{
    if (target->binary || stream->section_count != target->whole.section_count) {
        return false;
    }
    for (int64_t s = 0; s < stream->section_count; s++) {
        const struct section *a = &stream->sections[s], *b = &target->whole.sections[s];
        if (a->type != b->type || a->rows != b->rows || a->cols != b->cols) {
            return false;
        }
    }
    size_t line = at;
    while (line > 0 && target->bytes[line - 1] != '\n') {
        line--;
    }
    return target->bytes[line] == '#' || strchr("0123456789+-.eEnNaAiIfF \t", damaged) != NULL;
}

static bool is_flip_noticed(const struct target *target, size_t at, int bit, bool *good)
{
    char damaged = (char)(target->bytes[at] ^ (1 << bit));
    struct stream stream;
    need(pwrite(target->file, &damaged, 1, (off_t)at) == 1, "cannot write");
    bool noticed = !is_read(target, &stream);
    if (!noticed && !is_excused(target, at, damaged, &stream)) {
        printf("%s: bit %d of byte %zu flipped, and not noticed\n", target->name, bit, at);
        *good = false;
    }
    stream_free(&stream);
    need(pwrite(target->file, &target->bytes[at], 1, (off_t)at) == 1, "cannot write");
    return noticed;
}

static int64_t flip(const struct target *target, bool every_bit, bool *good)
{
    int64_t refused = 0;
    for (size_t at = 0; at < target->size; at++) {
        for (int bit = 0; bit < 8; bit++) {
            if (every_bit || bit == (int)(at % 8)) {
                refused += is_flip_noticed(target, at, bit, good);
            }
        }
    }
    return refused;
}

static int64_t cut(const struct target *target, bool *good)
{
    int64_t refused = 0;
    for (size_t length = target->size; length-- > 0;) {
        struct stream stream;
        need(ftruncate(target->file, (off_t)length) == 0, "cannot cut");
        if (!is_read(target, &stream)) {
            refused++;
        } else {
            printf("%s: cut to %zu of %zu bytes, and not noticed\n", target->name, length, target->size);
            *good = false;
        }
        stream_free(&stream);
    }
    return refused;
}

int main(int argc, char *argv[])
{
    bool good = true;
    bool every_bit = argc > 1 && strcmp(argv[1], "-a") == 0;
    for (int i = every_bit ? 2 : 1; i < argc; i++) {
        struct target target;
        open_target(&target, argv[i]);
        int64_t flips = flip(&target, every_bit, &good);
        int64_t cuts = cut(&target, &good);
        printf("%s, %s: %lld of %zu flips and %lld of %zu cuts refused\n", argv[i],
               target.binary ? "binary" : "text", (long long)flips, target.size * (every_bit ? 8 : 1),
               (long long)cuts, target.size);
        stream_free(&target.whole);
        close(target.file);
        free(target.bytes);
    }
    return good ? 0 : 1;
}
