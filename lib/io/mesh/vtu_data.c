/* The bytes of an array of a VTU file: base64, and blocks that zlib compressed. */
#include "io/mesh/vtk_input.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* What zlib packs is larger by this factor at most. */
#define MOST_RATIO 1032

/* The value of a digit of base64, -1: none. */
static int digit_value(char c)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *found = c != '\0' ? strchr(digits, c) : NULL;
    return found != NULL ? (int)(found - digits) : -1;
}

/* The bytes that four digits stand for, 1 to 3; 0: they are no such digits. *at moves behind them. */
static int next_group(const char **at, const char *end, char byte[3])
{
    uint32_t bits = 0;
    int count = 0, padding = 0;
    for (; *at < end && count + padding < 4; ++*at) {
        int value = digit_value(**at);
        if (value >= 0 && padding == 0) {
            bits = bits << 6 | (uint32_t)value;
            count++;
        } else if (**at == '=') {
            padding++;
        } else if (strchr(" \t\r\n", **at) == NULL) {
            return 0;
        }
    }
    if (count + padding < 4 || count < 2) {
        return 0;
    }
    bits <<= 6 * padding;
    for (int k = 0; k < 3; k++) {
        byte[k] = (char)(unsigned char)(bits >> (16 - 8 * k) & 255);
    }
    return count - 1;
}

/* The first `size` bytes, to be freed; NULL after a failure. What is padded may go on behind the padding: the
 * head of the data is often encoded apart. */
static char *read_bytes(struct msh_reader *r, const struct vtu_source *source, int64_t size)
{
    char *bytes = NULL;
    const char *at = source->at;
    int64_t left = source->end - at, got = 0;
    if (size > (source->base64 ? left / 4 * 3 : left)) {
        msh_fail(r, "%jd bytes cannot be in the %jd that are left", size, left);
        return NULL;
    }
    MSH_NEW(r, &bytes, size + 3);
    if (r->status == STATUS_OK && !source->base64) {
        memcpy(bytes, at, (size_t)size);
        return bytes;
    }
    while (r->status == STATUS_OK && got < size) {
        char byte[3];
        int count = next_group(&at, source->end, byte);
        memcpy(&bytes[got], byte, (size_t)count);
        got += count;
        if (count == 0) {
            msh_fail(r, "no data in base64, or too little: the file is truncated or damaged");
        }
    }
    if (r->status != STATUS_OK) {
        free(bytes);
        return NULL;
    }
    return bytes;
}

/* A number of the head; INT64_MAX: too large. */
static int64_t head_word(const struct vtu_source *source, const char *bytes, int64_t index)
{
    uint64_t number = 0;
    for (int k = 0; k < source->word; k++) {
        int from = source->swap ? k : source->word - 1 - k;
        number = number << 8 | (unsigned char)bytes[index * source->word + from];
    }
    return number <= INT64_MAX ? (int64_t)number : INT64_MAX;
}

static char *read_plain(struct msh_reader *r, struct vtu_source *source, int64_t *size)
{
    SCRATCH char *head = read_bytes(r, source, source->word);
    *size = head != NULL ? head_word(source, head, 0) : 0;
    if (*size > source->end - source->at) {
        msh_fail(r, "%jd bytes cannot be in what is left of the file", *size);
    }
    char *bytes = r->status == STATUS_OK ? read_bytes(r, source, source->word + *size) : NULL;
    if (bytes != NULL) {
        memmove(bytes, bytes + source->word, (size_t)*size);
        source->taken = source->word + *size;
    }
    return bytes;
}

/* Blocks, with their number, the size of each, that of the last if it is another (else 0), and the compressed
 * sizes in the head. */
struct blocks {
    int64_t count, size, last, packed; /* packed: bytes of all */
    char *head;
};

static void read_blocks(struct msh_reader *r, const struct vtu_source *source, struct blocks *blocks)
{
    int64_t left = source->end - source->at;
    SCRATCH char *first = read_bytes(r, source, 3L * source->word);
    if (first == NULL) {
        return;
    }
    blocks->count = head_word(source, first, 0);
    blocks->size = head_word(source, first, 1);
    blocks->last = head_word(source, first, 2);
    if (blocks->count > left / source->word || blocks->last > blocks->size) {
        msh_fail(r, "%jd blocks of %jd bytes cannot be in what is left of the file", blocks->count,
                 blocks->size);
        return;
    }
    blocks->head = read_bytes(r, source, (3 + blocks->count) * source->word);
    for (int64_t b = 0; blocks->head != NULL && b < blocks->count; b++) {
        int64_t packed = head_word(source, blocks->head, 3 + b);
        /* More than is there is found when it is read. */
        blocks->packed = packed > left - blocks->packed ? left : blocks->packed + packed;
    }
}

static void fail_damaged(struct msh_reader *r)
{
    msh_fail(r, "a block of the compressed data is damaged");
}

/* The bytes that the blocks are to hold. Refuse more than has a place, or than zlib can have packed, before
 * any is unpacked: zeros are packed a thousandfold. */
static int64_t check_claim(struct msh_reader *r, const struct blocks *blocks, int64_t most)
{
    int64_t size = 0;
    bool is_short = blocks->count > 0 && blocks->last > 0;
    if (__builtin_mul_overflow(blocks->count - is_short, blocks->size, &size) ||
        __builtin_add_overflow(size, is_short ? blocks->last : 0, &size) || size > most) {
        msh_fail(r, "%jd blocks of %jd bytes are more than the %jd that its numbers take", blocks->count,
                 blocks->size, most);
    } else if (size / MOST_RATIO > blocks->packed) {
        fail_damaged(r);
    }
    return size;
}

static char *read_compressed(struct msh_reader *r, struct vtu_source *source, int64_t *size)
{
    struct blocks blocks = {0};
    char *bytes = NULL;
    read_blocks(r, source, &blocks);
    SCRATCH char *head = blocks.head;
    int64_t whole = check_claim(r, &blocks, source->most);
    if (r->status != STATUS_OK) {
        return NULL;
    }
    int64_t at = (3 + blocks.count) * source->word, end = at + blocks.packed;
    SCRATCH char *packed = read_bytes(r, source, end);
    source->taken = end;
    MSH_NEW(r, &bytes, whole);
    for (int64_t b = *size = 0; r->status == STATUS_OK && b < blocks.count; b++) {
        int64_t count = head_word(source, head, 3 + b);
        bool is_last = b == blocks.count - 1 && blocks.last > 0;
        uLongf wanted = (uLongf)(is_last ? blocks.last : blocks.size), got = wanted;
        count = count < end - at ? count : end - at;
        int result = uncompress((Bytef *)bytes + *size, &got, (const Bytef *)packed + at, (uLong)count);
        if (result == Z_MEM_ERROR) {
            r->status = fail_memory(r->error, "zlib");
        } else if (result != Z_OK || got != wanted) {
            fail_damaged(r);
        }
        at += count;
        *size += (int64_t)wanted;
    }
    if (r->status != STATUS_OK) {
        free(bytes);
        return NULL;
    }
    return bytes;
}

char *vtu_bytes(struct msh_reader *r, struct vtu_source *source, int64_t *size)
{
    return source->compressed ? read_compressed(r, source, size) : read_plain(r, source, size);
}
