/* Legacy files of VTK, up to version 5.1, text and binary: unstructured grids. */
#include "io/mesh/vtk_input.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

struct legacy {
    struct vtk_input v;
    const char *at, *end; /* the rest of the line */
    bool binary;
    enum vtk_kind data; /* of what the arrays are */
    int64_t tuples;
    char keyword[64];
};

/* The next word of the line, copied; empty if there is none. */
static void copy_word(struct legacy *l, char text[], size_t size)
{
    int64_t length;
    const char *word = input_word(&l->at, l->end, ',', &length);
    if (length >= (int64_t)size) {
        msh_fail(l->v.r, "a word of more than %zu bytes", size - 1);
        length = 0;
    }
    snprintf(text, size, "%.*s", (int)length, word != NULL ? word : "");
}

static bool next_line(struct legacy *l)
{
    return msh_next_line(l->v.r, &l->at, &l->end);
}

/* The first word of the next line that has one; empty at the end. */
static void first_word(struct legacy *l, char text[], size_t size)
{
    text[0] = '\0';
    while (text[0] == '\0' && next_line(l)) {
        copy_word(l, text, size);
    }
}

static int64_t next_count(struct legacy *l, int64_t least)
{
    int64_t length;
    const char *word = input_word(&l->at, l->end, ',', &length);
    return input_whole(l->v.r, "a count", word != NULL ? word : "", length, least, INT32_MAX);
}

/* The type of texts, which are stepped over. */
static const struct nifti_type text_type;

static const struct nifti_type *next_type(struct legacy *l)
{
    char name[32];
    copy_word(l, name, sizeof name);
    const struct nifti_type *type =
        strcasecmp(name, "string") == 0 ? &text_type : nifti_type_named(NUMBERS_OF_VTK, name);
    if (type == NULL) {
        msh_fail(l->v.r, "numbers of type '%s' are not read", name);
    }
    return type;
}

/* Pass over METADATA: up to a blank line. */
static void skip_metadata(struct legacy *l)
{
    int64_t length;
    while (next_line(l) && input_word(&l->at, l->end, ',', &length) != NULL) {
    }
}

/* "%20" and the like stand for characters of names. */
static void decode_name(char name[])
{
    char *to = name;
    for (const char *from = name; *from != '\0'; to++) {
        unsigned code = 0;
        bool coded = from[0] == '%' && isxdigit((unsigned char)from[1]) && isxdigit((unsigned char)from[2]) &&
                     sscanf(from + 1, "%2x", &code) == 1 && code != 0;
        *to = *from;
        if (coded) {
            *to = (char)code;
        }
        from += coded ? 3 : 1;
    }
    *to = '\0';
}

/* ---- numbers ---- */

/* Step over texts: lines, or in binary files bytes behind their number, in 1 to 8 bytes, whose first two bits
 * say in how many. */
static void skip_texts(struct legacy *l, int64_t count)
{
    struct msh_reader *r = l->v.r;
    for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
        int width = l->binary && r->at < r->end ? 8 >> ((unsigned char)*r->at >> 6) : 0;
        uint64_t size = width > 0 ? *r->at & 0x3f : 0;
        for (int k = 1; k < width && k < r->end - r->at; k++) {
            size = size << 8 | (unsigned char)r->at[k];
        }
        if (l->binary ? width == 0 || r->end - r->at < width || size > (uint64_t)(r->end - r->at - width)
                      : !next_line(l)) {
            msh_fail(r, "only %jd of %jd texts", i, count);
        } else if (l->binary) {
            r->at += width + (int64_t)size;
        }
    }
}

/* Read `count` numbers into an array of the grid, or step over them; NULL: they are not there. */
static struct vtk_array *read_numbers(struct legacy *l, struct vtk_array *array, int64_t count)
{
    struct msh_reader *r = l->v.r;
    struct vtk_array *added = NULL;
    const struct nifti_type *type = array->type;
    if (type == NULL) { /* which has been told */
        return NULL;
    }
    int64_t left = r->end - r->at, size = type->bytes == 0 ? 1 : l->binary ? type->bytes : 2, length;
    if (r->status != STATUS_OK || count > (left + !l->binary) / size) {
        msh_fail(r, "%jd numbers cannot be in the %jd bytes that are left", count, left);
        return NULL;
    }
    array->type = type->bytes > 0 ? type : NULL;
    if (vtk_is_wanted(&l->v, array)) {
        added = vtk_add(&l->v, array, count);
    }
    if (type->bytes == 0) {
        skip_texts(l, count);
    } else if (l->binary) {
        if (added != NULL) {
            nifti_get(type, (const unsigned char *)r->at, true, (size_t)count, added->value);
        }
        r->at += count * size;
        r->at += r->at < r->end && *r->at == '\n';
    } else if (added != NULL) {
        vtk_fill_text(r, added, &r->at, r->end);
        if (r->status == STATUS_OK && count > 0 && r->at == r->end) {
            msh_fail(r, "%s: the file ends without a line's end: cut within its last number?", array->name);
        }
    } else {
        for (int64_t i = 0; r->status == STATUS_OK && i < count; i++) {
            if (input_word(&r->at, r->end, ',', &length) == NULL) {
                msh_fail(r, "%s: only %jd of %jd numbers", array->name, i, count);
            }
        }
    }
    return r->status == STATUS_OK ? added : NULL;
}

/* A line "OFFSETS vtktypeint64", and the numbers. */
static struct vtk_array *read_list(struct legacy *l, enum vtk_kind kind, const char *name, int64_t count)
{
    char word[32];
    struct vtk_array array = {.kind = kind, .components = 1};
    first_word(l, word, sizeof word);
    if (strcasecmp(word, name) != 0) {
        msh_fail(l->v.r, "no %s: the file is truncated", name);
    }
    snprintf(array.name, sizeof array.name, "%s", name);
    array.type = l->v.r->status == STATUS_OK ? next_type(l) : NULL;
    return read_numbers(l, &array, count);
}

/* Cells of versions before 5: for each cell the number of its points, and these. In place. */
static void split_cells(struct legacy *l)
{
    struct msh_reader *r = l->v.r;
    struct vtk_array offsets = {.kind = VTK_OFFSETS, .components = 1, .name = "offsets"};
    int64_t place = l->v.count - 1, from = 0, to = 0;
    struct vtk_array *end = vtk_add(&l->v, &offsets, l->v.cell_count);
    double *list = end != NULL ? l->v.arrays[place].value : NULL;
    for (int64_t c = 0; r->status == STATUS_OK && c < l->v.cell_count; c++) {
        int64_t left = l->v.arrays[place].count - from - 1, count = left >= 0 ? vtk_whole(list[from++]) : -1;
        if (count < 0 || count > left) {
            msh_fail(r, "cell %jd: more points than there are numbers", c);
            return;
        }
        memmove(&list[to], &list[from], (size_t)count * sizeof *list);
        from += count;
        to += count;
        end->value[c] = (double)to;
    }
    if (from < l->v.arrays[place].count) {
        msh_fail(r, "%jd numbers, where %jd cells take %jd", l->v.arrays[place].count, l->v.cell_count, from);
    }
    l->v.arrays[place].count = to;
}

/* Lists of version 5: where the points of each cell begin, with one more, and all points. */
static void read_lists(struct legacy *l, int64_t count, int64_t size)
{
    struct vtk_array *offsets = read_list(l, VTK_OFFSETS, "OFFSETS", count);
    if (offsets != NULL && offsets->count > 0) { /* without the first, which is 0 */
        if (offsets->value[0] != 0.0) {
            msh_fail(l->v.r, "OFFSETS begin with %g, not with 0", offsets->value[0]);
        }
        offsets->count--;
        memmove(offsets->value, offsets->value + 1, (size_t)offsets->count * sizeof *offsets->value);
    }
    l->v.cell_count = count > 0 ? count - 1 : 0;
    (void)read_list(l, VTK_CONNECTIVITY, "CONNECTIVITY", size);
}

static void read_cells(struct legacy *l)
{
    struct msh_reader *r = l->v.r;
    struct vtk_array array = {
        .kind = VTK_CONNECTIVITY, .components = 1, .name = "CELLS", .type = nifti_type(IMAGE_INT32)};
    int64_t count = next_count(l, 0), size = next_count(l, 0);
    const char *next = r->at;
    while (next < r->end && isspace((unsigned char)*next)) {
        next++;
    }
    if (r->end - next > 7 && strncasecmp(next, "OFFSETS", 7) == 0) {
        read_lists(l, count, size);
        return;
    }
    l->v.cell_count = count;
    if (count > size) {
        msh_fail(r, "%jd cells cannot have %jd numbers", count, size);
    }
    if (read_numbers(l, &array, size) != NULL) {
        split_cells(l);
    }
}

/* ---- keywords ---- */

static void read_array(struct legacy *l, const char *name, int64_t components, int64_t tuples,
                       const struct nifti_type *type)
{
    struct vtk_array array = {.kind = l->data, .components = components, .type = type};
    int64_t count;
    snprintf(array.name, sizeof array.name, "%s", name);
    decode_name(array.name);
    if (__builtin_mul_overflow(components, tuples, &count)) {
        msh_fail(l->v.r, "%s: %jd tuples of %jd numbers are too many", name, tuples, components);
    } else {
        (void)read_numbers(l, &array, count);
    }
}

static void read_field(struct legacy *l)
{
    char name[128];
    copy_word(l, name, sizeof name);
    int64_t count = next_count(l, 0), i = 0;
    while (i < count && next_line(l)) {
        copy_word(l, name, sizeof name);
        if (strcasecmp(name, "METADATA") == 0) {
            skip_metadata(l);
        } else if (name[0] != '\0') {
            int64_t components = next_count(l, 0), tuples = next_count(l, 0);
            read_array(l, name, components, tuples, next_type(l));
            i++;
        }
    }
    if (i < count) {
        msh_fail(l->v.r, "FIELD has %jd of %jd arrays: the file is truncated", i, count);
    }
}

/* Data sets of one array: "SCALARS name type", ... */
static bool read_attribute(struct legacy *l)
{
    static const struct {
        const char *keyword;
        int components; /* 0: the line tells it, behind the type; -1: before it */
    } attributes[] = {{"SCALARS", 0},    {"VECTORS", 3},      {"NORMALS", 3},
                      {"TENSORS", 9},    {"TENSORS6", 6},     {"TEXTURE_COORDINATES", -1},
                      {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"COLOR_SCALARS", -2}};
    struct msh_reader *r = l->v.r;
    char name[128];
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++) {
        if (strcasecmp(l->keyword, attributes[i].keyword) != 0) {
            continue;
        }
        int64_t components = attributes[i].components;
        copy_word(l, name, sizeof name);
        components = components < 0 ? next_count(l, 1) : components;
        const struct nifti_type *type = attributes[i].components == -2
                                            ? nifti_type(l->binary ? IMAGE_UINT8 : IMAGE_FLOAT32)
                                            : next_type(l);
        while (l->at < l->end && isspace((unsigned char)*l->at)) {
            l->at++;
        }
        components = components > 0 ? components : l->at < l->end ? next_count(l, 1) : 1;
        const char *table = r->at; /* the line LOOKUP_TABLE, which may be left out */
        if (attributes[i].components == 0 && next_line(l)) {
            copy_word(l, l->keyword, sizeof l->keyword);
            r->at = strcasecmp(l->keyword, "LOOKUP_TABLE") == 0 ? r->at : table;
        }
        read_array(l, name, components, l->tuples, type);
        return true;
    }
    return false;
}

static void read_keyword(struct legacy *l)
{
    const char *key = l->keyword;
    if (strcasecmp(key, "POINTS") == 0) {
        struct vtk_array array = {.kind = VTK_POINTS, .components = 3, .name = "points"};
        l->v.point_count = next_count(l, 0);
        array.type = next_type(l);
        (void)read_numbers(l, &array, 3 * l->v.point_count);
    } else if (strcasecmp(key, "CELLS") == 0) {
        read_cells(l);
    } else if (strcasecmp(key, "CELL_TYPES") == 0) {
        struct vtk_array array = {
            .kind = VTK_TYPES, .components = 1, .name = "types", .type = nifti_type(IMAGE_INT32)};
        (void)read_numbers(l, &array, next_count(l, 0));
    } else if (strcasecmp(key, "CELL_DATA") == 0 || strcasecmp(key, "POINT_DATA") == 0) {
        l->data = toupper((unsigned char)key[0]) == 'C' ? VTK_OF_CELLS : VTK_OF_POINTS;
        l->tuples = next_count(l, 0);
    } else if (strcasecmp(key, "FIELD") == 0) {
        read_field(l);
    } else if (strcasecmp(key, "METADATA") == 0) {
        skip_metadata(l);
    } else if (strcasecmp(key, "LOOKUP_TABLE") == 0) {
        char name[64];
        copy_word(l, name, sizeof name);
        enum vtk_kind data = l->data;
        l->data = VTK_OTHER;
        read_array(l, name, 4, next_count(l, 0), nifti_type(l->binary ? IMAGE_UINT8 : IMAGE_FLOAT32));
        l->data = data;
    } else if (!read_attribute(l)) {
        msh_fail(l->v.r, "what this is, is not known: the file is damaged, or of another kind");
    }
}

/* The head: version, title, ASCII or BINARY, the kind of data. */
static void read_head(struct legacy *l)
{
    struct msh_reader *r = l->v.r;
    char word[64];
    (void)(next_line(l) && next_line(l));
    first_word(l, word, sizeof word);
    l->binary = strcasecmp(word, "BINARY") == 0;
    if (!l->binary && strcasecmp(word, "ASCII") != 0) {
        msh_fail(r, "the third line is neither ASCII nor BINARY");
    }
    first_word(l, word, sizeof word);
    if (strcasecmp(word, "FIELD") == 0) {
        read_field(l);
        first_word(l, word, sizeof word);
    }
    if (strcasecmp(word, "DATASET") == 0) {
        copy_word(l, word, sizeof word);
    }
    if (strcasecmp(word, "UNSTRUCTURED_GRID") != 0) {
        msh_fail(r, "'%s' is no UNSTRUCTURED_GRID: ParaView's filter Append Datasets makes one of it", word);
    }
}

void vtk_read(struct msh_reader *r)
{
    struct legacy l = {.v = {.r = r}, .data = VTK_OF_FIELD, .at = r->at, .end = r->at};
    input_at(r, "head", 0);
    read_head(&l);
    r->section = l.keyword;
    for (;;) {
        first_word(&l, l.keyword, sizeof l.keyword);
        if (l.keyword[0] == '\0') {
            break;
        }
        read_keyword(&l);
    }
    vtk_build(&l.v);
}
