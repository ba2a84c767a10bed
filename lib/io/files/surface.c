#include "io/files/surface.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/files/textfile.h"
#include "base/vector.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const size_t size_limit = (size_t)1 << 31;
enum { STL_HEADER = 84, STL_TRIANGLE = 50 };

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers of STL are taken as they lie there");

/* The number of bytes of a binary STL file with this header; 0 if there is no header. */
static size_t binary_stl_size(const struct textfile *file)
{
    if (file->size < STL_HEADER) {
        return 0;
    }
    uint32_t count;
    memcpy(&count, file->text + STL_HEADER - 4, sizeof count);
    return STL_HEADER + (size_t)count * STL_TRIANGLE;
}

static enum status read_binary_stl(const char *path, const struct textfile *file, struct table *table,
                                   struct error *error)
{
    int64_t count = (int64_t)(file->size - STL_HEADER) / STL_TRIANGLE;
    for (int64_t t = 0; t < count; t++) {
        double row[9];
        float corner[9]; /* behind the normal */
        memcpy(corner, file->text + STL_HEADER + t * STL_TRIANGLE + 12, sizeof corner);
        for (int i = 0; i < 9; i++) {
            row[i] = (double)corner[i];
            if (!isfinite(row[i])) {
                return fail(error, STATUS_INPUT, "%s: triangle %jd: coordinate that is not finite", path,
                            t + 1);
            }
        }
        RETURN_IF_ERROR(table_append(table, row, t + 1, NULL, error));
    }
    return STATUS_OK;
}

/* The words of a text, with their lines. */
struct words {
    const char *path, *at;
    int64_t line;
    char word[64]; /* "" at the end; a longer one is cut */
};

/* Move to the next word; false at the end. */
static bool next_word(struct words *words)
{
    for (; *words->at != '\0' && strchr(" \t\r\n", *words->at) != NULL; words->at++) {
        words->line += *words->at == '\n';
    }
    size_t length = strcspn(words->at, " \t\r\n");
    snprintf(words->word, sizeof words->word, "%.*s", (int)(length < 64 ? length : 63), words->at);
    words->at += length;
    return length > 0;
}

static enum status fail_word(const struct words *words, const char *what, struct error *error)
{
    return fail(error, STATUS_INPUT, "%s:%jd: '%.40s' %s", words->path, words->line, words->word, what);
}

static bool is_word(const struct words *words, const char *word)
{
    return strcasecmp(words->word, word) == 0;
}

/* Read a facet, of which "facet" has been read: these words, where 0 is a coordinate, and * is not used. */
static enum status read_facet(struct words *words, struct table *table, struct error *error)
{
    char form[] = "normal * * * outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet",
         *rest = form;
    struct error why;
    int64_t line = words->line;
    double row[9], *x = row;
    for (const char *wanted = text_word(&rest); *wanted != '\0'; wanted = text_word(&rest)) {
        bool any = next_word(words);
        if (*wanted == '0' && parse_double(words->word, "", -DBL_MAX, DBL_MAX, x++, &why) != STATUS_OK) {
            return fail_word(words, "is not a finite number", error);
        }
        if (!any || (isalpha((unsigned char)*wanted) && !is_word(words, wanted))) {
            return fail_word(words, "has no place here: a facet has three lines 'vertex X Y Z'", error);
        }
    }
    return table_append(table, row, line, NULL, error);
}

/* Read solids: "solid NAME", facets, "endsolid NAME". */
static enum status read_ascii_stl(const char *path, const struct textfile *file, struct table *table,
                                  struct error *error)
{
    struct words words = {.path = path, .at = file->text, .line = 1};
    bool open = false;
    while (next_word(&words)) {
        if (is_word(&words, open ? "endsolid" : "solid")) {
            open = !open;
            words.at += strcspn(words.at, "\n");
        } else if (open && is_word(&words, "facet")) {
            RETURN_IF_ERROR(read_facet(&words, table, error));
        } else {
            return fail_word(&words,
                             open ? "instead of 'facet' or 'endsolid'"
                                  : "stands outside of 'solid' and 'endsolid'",
                             error);
        }
    }
    return open ? fail_word(&words, "instead of 'facet' or 'endsolid': truncated?", error) : STATUS_OK;
}

static enum status read_stl(const char *path, struct table *table, struct error *error)
{
    FREED_BY(textfile_free) struct textfile file = {0};
    *table = (struct table){.cols = 9};
    RETURN_IF_ERROR(bytefile_read(path, size_limit, &file, error));
    if (binary_stl_size(&file) == file.size) {
        RETURN_IF_ERROR(read_binary_stl(path, &file, table, error));
    } else if (strncasecmp(file.text, "solid", 5) == 0) {
        RETURN_IF_ERROR(read_ascii_stl(path, &file, table, error));
    } else {
        return fail(
            error, STATUS_INPUT,
            "%s: neither ASCII STL (first word 'solid') nor binary STL of the size in its header: truncated?",
            path);
    }
    if (table->rows == 0) {
        return fail(error, STATUS_INPUT, "%s: holds no triangle", path);
    }
    return table_end_block(table, error);
}

static enum status check_curves(const char *path, const struct table *table, struct error *error)
{
    for (int64_t b = 0; b < table->block_count; b++) {
        int64_t begin = table->block_ptr[b];
        int64_t end = table->block_ptr[b + 1];
        if (end - begin < 2) {
            return fail(error, STATUS_INPUT, "%s:%jd: curve of one point: a curve has at least two", path,
                        table->line[begin]);
        }
        for (int64_t r = begin + 1; r < end; r++) {
            const double *a = table->values + 2 * (r - 1);
            if (!(hypot(a[2] - a[0], a[3] - a[1]) > 0)) {
                return fail(error, STATUS_INPUT, "%s:%jd: repeats the point before: remove it", path,
                            table->line[r]);
            }
        }
    }
    return STATUS_OK;
}

static enum status check_triangles(const char *path, const struct table *table, struct error *error)
{
    for (int64_t r = 0; r < table->rows; r++) {
        const double *a = table->values + 9 * r;
        double u[3], v[3], normal[3];
        vector_subtract(3, a + 3, a, u);
        vector_subtract(3, a + 6, a, v);
        vector_cross(u, v, normal);
        double area = hypot(hypot(normal[0], normal[1]), normal[2]);
        if (!(area > 0 && isfinite(area))) {
            return fail(error, STATUS_INPUT, "%s:%jd: triangle without area: remove it", path,
                        table->line[r]);
        }
    }
    return STATUS_OK;
}

enum status surface_read(const char *path, int dim, struct table *table, struct error *error)
{
    size_t length = strlen(path);
    if (dim == 2) {
        RETURN_IF_ERROR(table_read(path, 2, 2, table, error));
        return check_curves(path, table, error);
    }
    bool stl = length > 4 && strcasecmp(path + length - 4, ".stl") == 0;
    RETURN_IF_ERROR(stl ? read_stl(path, table, error) : table_read(path, 9, 9, table, error));
    return check_triangles(path, table, error);
}

enum status surface_facets(const char *path, int dim, double unit, double **x, int64_t *count,
                           struct error *error)
{
    FREED_BY(table_free) struct table table = {0};
    *x = NULL;
    *count = 0;
    RETURN_IF_ERROR(surface_read(path, dim, &table, error));
    RETURN_IF_ERROR(NEW_ARRAY(x, table.rows * dim * dim, error));
    for (int64_t b = 0; b < table.block_count; b++) {
        for (int64_t r = table.block_ptr[b]; r + (dim == 2) < table.block_ptr[b + 1]; r++, ++*count) {
            for (int i = 0; i < dim * dim; i++) {
                (*x)[*count * dim * dim + i] = unit * table.values[r * table.cols + i];
            }
        }
    }
    return STATUS_OK;
}
