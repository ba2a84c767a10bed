/* The bytes of an array of a VTU file: base64, and blocks that zlib compressed. */
#include "io/mesh/vtk_input.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* What zlib packs is larger by this factor at most. */
#define MOST_RATIO 1032

/* The bytes that base64 stands for, up to what is none; returns their number. What is padded may go on behind
 * the padding: the head of the data is often encoded apart. */
static int64_t decode(const char *at, const char *end, char *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    int64_t count = 0;
    uint32_t bits = 0;
    for (int place = 0, padding = 0; at < end; at++) {
        const char *digit = *at != '\0' && padding == 0 ? strchr(digits, *at) : NULL;
        if (digit == NULL && input_is_blank(*at)) {
            continue;
        }
        if (digit == NULL && (*at != '=' || place < 2)) {
            break;
        }
        bits = bits << 6 | (digit != NULL ? (uint32_t)(digit - digits) : 0);
        padding += digit == NULL;
        if (++place == 4) {
            for (int k = 0; k < 3; k++) {
                bytes[count + k] = (char)(unsigned char)(bits >> (16 - 8 * k) & 255);
            }
            count += 3 - padding;
            place = padding = 0;
        }
    }
    return count;
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

static bool has_bytes(struct msh_reader *r, int64_t left, int64_t needed)
{
    if (needed > left) {
        msh_fail(r, "%jd bytes, where there are %jd: the file is truncated or damaged", needed, left);
    }
    return r->status == STATUS_OK;
}

/* bytes[left]: the size of the data, and these. */
static void copy(struct msh_reader *r, const struct vtu_source *source, const char *bytes, int64_t left,
                 struct vtu_bytes *data)
{
    data->size = has_bytes(r, left, source->word) ? head_word(source, bytes, 0) : 0;
    if (has_bytes(r, left - source->word, data->size)) {
        MSH_NEW(r, &data->bytes, data->size);
    }
    if (r->status == STATUS_OK) {
        memcpy(data->bytes, bytes + source->word, (size_t)data->size);
    }
}

/* bytes[left]: the number of blocks, the size of each, that of the last if it is another (else 0), the
 * compressed sizes, and the blocks. More than has a place, or than zlib can have packed, is refused before
 * any is unpacked: zeros are packed a thousandfold. */
static void unpack(struct msh_reader *r, const struct vtu_source *source, const char *bytes, int64_t left,
                   struct vtu_bytes *data)
{
    if (!has_bytes(r, left, 3L * source->word)) {
        return;
    }
    int64_t count = head_word(source, bytes, 0), size = head_word(source, bytes, 1),
            last = head_word(source, bytes, 2), whole = 0;
    bool is_short = count > 0 && last > 0;
    if (count > left / source->word - 3 || last > size) {
        msh_fail(r, "%jd blocks of %jd bytes cannot be in what is left of the file", count, size);
        return;
    }
    int64_t at = (3 + count) * source->word;
    if (__builtin_mul_overflow(count - is_short, size, &whole) ||
        __builtin_add_overflow(whole, is_short ? last : 0, &whole) || whole > source->most) {
        msh_fail(r, "%jd blocks of %jd bytes are more than the %jd that its numbers take", count, size,
                 source->most);
    } else if (whole / MOST_RATIO > left - at) {
        msh_fail(r, "a block of the compressed data is damaged");
    }
    MSH_NEW(r, &data->bytes, whole);
    for (int64_t b = data->size = 0; r->status == STATUS_OK && b < count; b++) {
        int64_t packed = head_word(source, bytes, 3 + b);
        uLongf wanted = (uLongf)(is_short && b == count - 1 ? last : size), got = wanted;
        packed = packed < left - at ? packed : left - at;
        int result =
            uncompress((Bytef *)data->bytes + data->size, &got, (const Bytef *)bytes + at, (uLong)packed);
        if (result == Z_MEM_ERROR) {
            r->status = fail_memory(r->error, "zlib");
        } else if (result != Z_OK || got != wanted) {
            msh_fail(r, "a block of the compressed data is damaged");
        }
        at += packed;
        data->size += (int64_t)wanted;
    }
}

void vtu_read_bytes(struct msh_reader *r, const struct vtu_source *source, struct vtu_bytes *data)
{
    SCRATCH char *decoded = NULL;
    const char *bytes = source->at;
    int64_t left = source->end - source->at;
    if (source->base64) {
        MSH_NEW(r, &decoded, left / 4 * 3 + 3);
        left = r->status == STATUS_OK ? decode(source->at, source->end, decoded) : 0;
        bytes = decoded;
    }
    (source->compressed ? unpack : copy)(r, source, bytes, left, data);
}
