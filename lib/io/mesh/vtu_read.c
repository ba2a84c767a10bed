/* Files of VTK in XML: unstructured grids, with data as text, in base64, or appended. */

#include "io/mesh/vtk_input.h"

#include "base/lists.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* The bytes of an array of a VTU file: base64, and blocks that zlib compressed. */

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

struct vtu {
    struct vtk_input v;
    char section[64]; /* "CellData" */
    int pieces;
    bool swap, compressed;
    int word;            /* bytes of the numbers of heads */
    struct vtk_array at; /* at hand */
    char format[16];
    int64_t appended_count, appended_room;
    struct vtk_array *appended;
};

/* A number of the head; INT64_MAX: too large. */
static int64_t head_word(const struct vtu *u, const char *bytes, int64_t index)
{
    double number;
    nifti_get(nifti_type(u->word == 8 ? IMAGE_UINT64 : IMAGE_UINT32),
              (const unsigned char *)bytes + index * u->word, u->swap, 1, &number);
    return number < 9e15 ? (int64_t)number : INT64_MAX;
}

static bool has_bytes(struct msh_reader *r, int64_t left, int64_t needed)
{
    if (needed > left) {
        msh_fail(r, "%jd bytes, where there are %jd: the file is truncated or damaged", needed, left);
    }
    return r->status == STATUS_OK;
}

/* bytes[left]: the number of blocks, the size of each, that of the last if it is another (else 0), the
 * compressed sizes, and the blocks. More than `most`, or than zlib can have packed, is refused before any is
 * unpacked: zeros are packed a thousandfold. (*data)[*size]: to be freed, also on failure. */
static void unpack(struct vtu *u, const char *bytes, int64_t left, int64_t most, char **data, int64_t *size)
{
    struct msh_reader *r = u->v.r;
    if (!has_bytes(r, left, 3L * u->word)) {
        return;
    }
    int64_t count = head_word(u, bytes, 0), block = head_word(u, bytes, 1), last = head_word(u, bytes, 2),
            whole = 0;
    bool is_short = count > 0 && last > 0;
    if (count > left / u->word - 3 || last > block) {
        msh_fail(r, "%jd blocks of %jd bytes cannot be in what is left of the file", count, block);
        return;
    }
    int64_t at = (3 + count) * u->word;
    if (__builtin_mul_overflow(count - is_short, block, &whole) ||
        __builtin_add_overflow(whole, is_short ? last : 0, &whole) || whole > most) {
        msh_fail(r, "%jd blocks of %jd bytes are more than the %jd that its numbers take", count, block,
                 most);
    } else if (whole / MOST_RATIO > left - at) {
        msh_fail(r, "a block of the compressed data is damaged");
    }
    MSH_NEW(r, data, whole);
    for (int64_t b = *size = 0; r->status == STATUS_OK && b < count; b++) {
        int64_t packed = head_word(u, bytes, 3 + b);
        uLongf wanted = (uLongf)(is_short && b == count - 1 ? last : block), got = wanted;
        packed = packed < left - at ? packed : left - at;
        int result = uncompress((Bytef *)*data + *size, &got, (const Bytef *)bytes + at, (uLong)packed);
        if (result == Z_MEM_ERROR) {
            r->status = fail_memory(r->error, "zlib");
        } else if (result != Z_OK || got != wanted) {
            msh_fail(r, "a block of the compressed data is damaged");
        }
        at += packed;
        *size += (int64_t)wanted;
    }
}

static int64_t number_of(struct vtu *u, const char **attributes, const char *name, int64_t otherwise)
{
    const char *value = xml_attribute(attributes, name);
    return value != NULL ? input_whole(u->v.r, name, value, (int64_t)strlen(value), 0, INT32_MAX) : otherwise;
}

static bool equals(const char *value, const char *wanted)
{
    return value != NULL && strcmp(value, wanted) == 0;
}

/* ---- elements ---- */

static void begin_file(struct vtu *u, const char **attributes)
{
    struct msh_reader *r = u->v.r;
    const char *type = xml_attribute(attributes, "type"),
               *compressor = xml_attribute(attributes, "compressor");
    if (!equals(type, "UnstructuredGrid")) {
        msh_fail(
            r, "type '%s': only UnstructuredGrid is read: ParaView's filter Append Datasets makes one of it",
            type != NULL ? type : "");
    }
    if (compressor != NULL && compressor[0] != '\0' && strcmp(compressor, "vtkZLibDataCompressor") != 0) {
        msh_fail(r, "compressor %s: only zlib is read: save it so, or uncompressed", compressor);
    }
    u->compressed = compressor != NULL && compressor[0] != '\0';
    u->swap = equals(xml_attribute(attributes, "byte_order"), "BigEndian");
    u->word = equals(xml_attribute(attributes, "header_type"), "UInt64") ? 8 : 4;
}

/* What an array of that name in this section is of, and how many numbers it has to have. */
static void find_kind(struct vtu *u, const char **attributes)
{
    static const struct {
        const char *section, *name;
        enum vtk_kind kind;
    } kinds[] = {{"Points", NULL, VTK_POINTS},      {"Cells", "connectivity", VTK_CONNECTIVITY},
                 {"Cells", "offsets", VTK_OFFSETS}, {"Cells", "types", VTK_TYPES},
                 {"CellData", NULL, VTK_OF_CELLS},  {"PointData", NULL, VTK_OF_POINTS},
                 {"FieldData", NULL, VTK_OF_FIELD}};
    int64_t points = u->v.point_count * u->at.components, cells = u->v.cell_count * u->at.components;
    const int64_t expected[] = {-1,
                                points,
                                -1,
                                u->v.cell_count,
                                u->v.cell_count,
                                cells,
                                points,
                                u->at.components * number_of(u, attributes, "NumberOfTuples", 1)};
    u->at.kind = VTK_OTHER;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(u->section, kinds[i].section) == 0 &&
            (kinds[i].name == NULL || strcmp(u->at.name, kinds[i].name) == 0)) {
            u->at.kind = kinds[i].kind;
        }
    }
    u->at.count = expected[u->at.kind];
}

static void begin_array(struct vtu *u, const char **attributes)
{
    struct msh_reader *r = u->v.r;
    const char *name = xml_attribute(attributes, "Name"), *type = xml_attribute(attributes, "type"),
               *format = xml_attribute(attributes, "format");
    if (snprintf(u->at.name, sizeof u->at.name, "%s", name != NULL ? name : u->section) > INPUT_NAME) {
        msh_fail(r, "the name '%.40s...' is longer than %d bytes", name, INPUT_NAME);
    }
    snprintf(u->format, sizeof u->format, "%s", format != NULL ? format : "ascii");
    u->at.components = number_of(u, attributes, "NumberOfComponents", 1);
    u->at.components += u->at.components == 0;
    find_kind(u, attributes);
    u->at.offset = number_of(u, attributes, "offset", 0);
    u->at.type = nifti_type_named(NUMBERS_OF_VTU, type != NULL ? type : "");
    if (u->at.type == NULL && u->at.kind >= VTK_POINTS && u->at.kind <= VTK_TYPES) {
        msh_fail(r, "%s: numbers of type '%s' are not read", u->at.name, type != NULL ? type : "");
    } else if (u->at.kind == VTK_POINTS && u->at.components != 3) {
        msh_fail(r, "points of %jd coordinates, not 3", u->at.components);
    } else if (u->at.kind == VTK_OTHER || !vtk_is_wanted(&u->v, &u->at)) {
        u->at.type = NULL;
    }
}

static void begin(void *context, const char *name, const char **attributes, int depth)
{
    struct vtu *u = context;
    struct msh_reader *r = u->v.r;
    bool is_array = strcmp(name, "DataArray") == 0 || strcmp(name, "Array") == 0;
    if (depth < 4 && !is_array) {
        snprintf(u->section, sizeof u->section, "%s", name);
    }
    if (depth == 0) {
        begin_file(u, attributes);
    } else if (is_array) {
        begin_array(u, attributes);
    } else if (strcmp(name, "Piece") == 0) {
        if (u->pieces++ > 0) {
            msh_fail(r, "several pieces: make them one (ParaView's filter Merge Blocks)");
        }
        u->v.point_count = number_of(u, attributes, "NumberOfPoints", 0);
        u->v.cell_count = number_of(u, attributes, "NumberOfCells", 0);
    }
}

/* ---- data ---- */

/* Read the array at hand from the bytes there. Uncompressed they are the size of the data, and these. */
static void read_binary(struct vtu *u, const char *at, const char *end, bool base64)
{
    struct msh_reader *r = u->v.r;
    SCRATCH char *decoded = NULL, *unpacked = NULL;
    int64_t left = end - at, size = u->at.type->bytes, bytes = 0, most;
    if (base64) {
        MSH_NEW(r, &decoded, left / 4 * 3 + 3);
        left = r->status == STATUS_OK ? decode(at, end, decoded) : 0;
        at = decoded;
    }
    if (u->compressed) { /* the nodes of a cell are at most 27 */
        bool many =
            __builtin_mul_overflow(u->at.count >= 0 ? u->at.count : 27 * u->v.cell_count, size, &most);
        unpack(u, at, left, many ? INT64_MAX : most, &unpacked, &bytes);
        at = unpacked;
    } else {
        bytes = has_bytes(r, left, u->word) ? head_word(u, at, 0) : 0;
        at += has_bytes(r, left - u->word, bytes) ? u->word : 0;
    }
    int64_t count = u->at.count < 0 ? bytes / size : u->at.count;
    if (count > bytes / size || count * size != bytes) {
        msh_fail(r, "%s: %jd bytes, not %jd numbers of %jd", u->at.name, bytes, count, size);
    }
    struct vtk_array *array = vtk_add(&u->v, &u->at, count);
    if (array != NULL) {
        nifti_get(array->type, (const unsigned char *)at, u->swap, (size_t)count, array->value);
    }
}

static void read_text(struct vtu *u, const char *text, const char *end)
{
    struct msh_reader *r = u->v.r;
    const char *at = text;
    int64_t length, count = 0;
    while (input_word(&at, end, ',', &length) != NULL) {
        count++;
    }
    if (u->at.count >= 0 && count != u->at.count) {
        msh_fail(r, "%s: %jd numbers, not %jd", u->at.name, count, u->at.count);
    }
    struct vtk_array *array = vtk_add(&u->v, &u->at, count);
    if (array != NULL) {
        vtk_fill_text(r, array, &text, end);
    }
}

static void end(void *context, const char *name, const char *text, int64_t size, int depth)
{
    struct vtu *u = context;
    struct msh_reader *r = u->v.r;
    (void)depth;
    if (strcmp(name, "DataArray") != 0 || u->at.type == NULL) {
        return;
    }
    if (strcmp(u->format, "ascii") == 0) {
        read_text(u, text, text + size);
    } else if (strcmp(u->format, "binary") == 0) {
        read_binary(u, text, text + size, true);
    } else if (strcmp(u->format, "appended") == 0) {
        MSH_GROW(r, &u->appended, u->appended_count + 1, &u->appended_room);
        if (r->status == STATUS_OK) {
            u->appended[u->appended_count++] = u->at;
        }
    } else {
        msh_fail(r, "%s: format '%s' is none of ascii, binary, appended", u->at.name, u->format);
    }
    u->at.type = NULL;
}

static int compare_offsets(const void *left, const void *right)
{
    const struct vtk_array *a = left, *b = right;
    return a->offset != b->offset ? compare_int64(&a->offset, &b->offset) : strcmp(a->name, b->name);
}

/* Read the appended data: behind the tag, which may be followed by blanks, and '_'. Arrays do not share their
 * bytes: they would be more than the file. */
static void read_appended(struct vtu *u)
{
    struct msh_reader *r = u->v.r;
    const char *tag = r->at, *close = tag < r->end ? memchr(tag, '>', (size_t)(r->end - tag)) : NULL;
    const char *data = close != NULL ? close + 1 : r->end;
    while (data < r->end && isspace((unsigned char)*data)) {
        data++;
    }
    input_at(r, "AppendedData", 0);
    if (data == r->end || *data++ != '_') {
        msh_fail(r, "it is missing, or does not begin with '_': the file is truncated");
    }
    bool base64 = r->status == STATUS_OK && memmem(tag, (size_t)(close - tag), "base64", 6) != NULL;
    qsort(u->appended, (size_t)u->appended_count, sizeof *u->appended, compare_offsets);
    for (int64_t i = 0; r->status == STATUS_OK && i < u->appended_count; i++) {
        int64_t end = r->end - data;
        if (i + 1 < u->appended_count && u->appended[i + 1].offset < end) {
            end = u->appended[i + 1].offset;
        }
        u->at = u->appended[i];
        if (u->at.offset >= end) {
            msh_fail(r, "%s: its offset %jd is behind the end of the file, or is also that of another array",
                     u->at.name, u->at.offset);
        } else {
            read_binary(u, data + u->at.offset, data + end, base64);
        }
    }
}

void vtu_read(struct msh_reader *r)
{
    struct vtu u = {.v = {.r = r}};
    const struct xml_handler handler = {&u, begin, end};
    r->section = u.section;
    xml_parse(r, "AppendedData", &handler);
    if (r->status == STATUS_OK && u.appended_count > 0) {
        read_appended(&u);
    }
    vtk_build(&u.v);
    free(u.appended);
}
