#include "derived.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "io/sections.h"
#include "io/vtk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void derived_free(struct derived *derived)
{
    for (int64_t i = 0; i < derived->count; i++) {
        free(derived->items[i].name);
        free(derived->items[i].attributes);
        free(derived->items[i].data);
    }
    free(derived->items);
    *derived = (struct derived){0};
}

/* Append a section of zeros: BASE.WHAT, or WHAT alone when base is NULL, with `tail` behind it. Its data is
 * in the last item. */
static enum status append(struct derived *derived, const char *base, const char *what, const char *tail,
                          enum element_type type, int64_t rows, int64_t cols, const char *attributes,
                          struct error *error)
{
    struct section *items = array_grow(derived->items, derived->count + 1, sizeof *items);
    if (items == NULL) {
        return fail_memory(error, what);
    }
    derived->items = items;
    struct section section = {.type = type, .rows = rows, .cols = cols};
    section.attributes = strdup(attributes);
    section.data = array_new(rows * cols, element_size(type));
    if (asprintf(&section.name, "%s%s%s%s", base != NULL ? base : "", base != NULL ? "." : "", what, tail) <
        0) {
        section.name = NULL;
    }
    derived->items[derived->count++] = section;
    if (section.attributes == NULL || section.data == NULL || section.name == NULL) {
        return fail_memory(error, what);
    }
    return STATUS_OK;
}

static void *last_data(const struct derived *derived)
{
    return derived->items[derived->count - 1].data;
}

/* Row `row` of a symmetric tensor whose components lie in these columns, as a matrix. */
static void read_tensor(const struct section *section, const int64_t from[6], int64_t row, double A[9])
{
    static const int place[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    memset(A, 0, 9 * sizeof *A);
    for (int k = 0; k < 6; k++) {
        int64_t at = row * section->cols + from[k];
        double value = from[k] < 0                ? 0.0
                       : section->type == TYPE_F8 ? ((const double *)section->data)[at]
                                                  : (double)((const float *)section->data)[at];
        A[3 * place[k][0] + place[k][1]] = A[3 * place[k][1] + place[k][0]] = value;
    }
}

static void sort_descending(double values[3])
{
    for (int i = 1; i < 3; i++) {
        for (int k = i; k > 0 && values[k] > values[k - 1]; k--) {
            double swapped = values[k];
            values[k] = values[k - 1];
            values[k - 1] = swapped;
        }
    }
}

static void principal_values(const double A[9], double *row)
{
    double V[9];
    eigen_symmetric(3, A, row, V);
    sort_descending(row);
}

static void von_mises(const double A[9], double *row)
{
    double mean = (A[0] + A[4] + A[8]) / 3.0, squares = 0.0;
    for (int k = 0; k < 9; k++) {
        double deviator = A[k] - (k % 4 == 0 ? mean : 0.0);
        squares += deviator * deviator;
    }
    *row = sqrt(1.5 * squares);
}

static void mean_pressure(const double A[9], double *row)
{
    *row = (0.0 - A[0] - A[4] - A[8]) / 3.0; /* not -0 */
}

static void volume_ratio(const double A[9], double *row)
{
    double C[9];
    for (int k = 0; k < 9; k++) {
        C[k] = 2.0 * A[k] + (k % 4 == 0 ? 1.0 : 0.0);
    }
    *row = sqrt(C[0] * (C[4] * C[8] - C[5] * C[7]) - C[1] * (C[3] * C[8] - C[5] * C[6]) +
                C[2] * (C[3] * C[7] - C[4] * C[6]));
}

static const struct invariant {
    const char *of, *base, *name; /* of section `of` and its frames: BASE.NAME, or NAME */
    int cols;
    const char *attributes;
    const char *given; /* left out where the stream has this section */
    void (*compute)(const double A[9], double *row);
} invariants[] = {
    {"stress", "stress", "von_mises", 1, "unit=Pa", NULL, von_mises},
    {"stress", "stress", "principal", 3, "unit=Pa cols=1,2,3", NULL, principal_values},
    {"stress", NULL, "pressure", 1, "unit=Pa", "pressure", mean_pressure},
    {"strain", "strain", "principal", 3, "unit=1 cols=1,2,3", NULL, principal_values},
    {"strain", NULL, "J", 1, "unit=1", "volume_ratio", volume_ratio},
};

/* Does the stream have the section, in the frame that `tail` names? */
static bool has_section(const struct stream *stream, const char *name, const char *tail)
{
    char full[128];
    snprintf(full, sizeof full, "%s%s", name, tail);
    return stream_find(stream, full) != NULL;
}

enum status derived_add_invariants(const struct stream *stream, struct derived *derived, struct error *error)
{
    for (int64_t s = 0; s < stream->section_count; s++) {
        const struct section *section = &stream->sections[s];
        size_t length;
        int64_t from[6];
        (void)frame_of(section->name, &length);
        for (size_t i = 0; i < sizeof invariants / sizeof *invariants; i++) {
            const struct invariant *what = &invariants[i];
            const char *tail = section->name + length;
            if (strlen(what->of) != length || strncmp(section->name, what->of, length) != 0 ||
                !vtk_tensor(section, from) ||
                (what->given != NULL && has_section(stream, what->given, tail))) {
                continue;
            }
            RETURN_IF_ERROR(append(derived, what->base, what->name, tail, TYPE_F8, section->rows, what->cols,
                                   what->attributes, error));
            double *values = last_data(derived);
            for (int64_t row = 0; row < section->rows; row++) {
                double A[9];
                read_tensor(section, from, row, A);
                what->compute(A, values + row * what->cols);
            }
        }
    }
    return STATUS_OK;
}

/* One section of ones and zeros for each name; *first receives the index of the first, *count how many. */
static enum status append_groups(const struct section *named, const char *kind, int64_t node_count,
                                 struct derived *derived, int64_t *first, int64_t *count, struct error *error)
{
    enum status status;
    struct names names = {0};
    *first = derived->count;
    TRY(names_read(named, &names, error));
    for (int64_t i = 0; i < names.count; i++) {
        if (names.name[i][0] != '\0') {
            TRY(append(derived, kind, names.name[i], "", TYPE_I4, node_count, 1, "", error));
        }
    }
    *count = derived->count - *first;
done:
    names_free(&names);
    return status;
}

static enum status mark(struct derived *derived, int64_t item, const char *section, int64_t row, int32_t node,
                        struct error *error)
{
    struct section *group = &derived->items[item];
    if (node < 0 || node >= group->rows) {
        return fail(error, STATUS_INPUT, "%s: row %lld: no node %d", section, (long long)row, node);
    }
    ((int32_t *)group->data)[node] = 1;
    return STATUS_OK;
}

static enum status add_facet_groups(const struct stream *stream, int dim, int64_t node_count,
                                    struct derived *derived, struct error *error)
{
    struct named_facets facets;
    int64_t first, count;
    RETURN_IF_ERROR(stream_facets(stream, false, dim, &facets, error));
    if (facets.count == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(append_groups(stream_find(stream, "facets.set"), "facets", node_count, derived, &first,
                                  &count, error));
    for (int64_t f = 0; f < facets.count; f++) {
        if (facets.set[f] < 0 || facets.set[f] >= count) {
            return fail(error, STATUS_INPUT, "facets.set: row %lld: index %d is not within its %lld names",
                        (long long)f, facets.set[f], (long long)count);
        }
        for (int k = 0; k < dim; k++) {
            RETURN_IF_ERROR(
                mark(derived, first + facets.set[f], "facets", f, facets.facet[f * dim + k], error));
        }
    }
    return STATUS_OK;
}

static enum status add_node_sets(const struct stream *stream, int64_t node_count, struct derived *derived,
                                 struct error *error)
{
    struct neighbours sets;
    const struct section *ptr = stream_find(stream, "sets.ptr");
    int64_t first, count;
    if (ptr == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(append_groups(ptr, "set", node_count, derived, &first, &count, error));
    RETURN_IF_ERROR(stream_neighbours(stream, "sets", count, node_count, &sets, error));
    for (int64_t s = 0; s < count; s++) {
        for (int64_t i = sets.ptr[s]; i < sets.ptr[s + 1]; i++) {
            RETURN_IF_ERROR(mark(derived, first + s, "sets.idx", i, sets.idx[i], error));
        }
    }
    return STATUS_OK;
}

enum status derived_add_groups(const struct stream *stream, int dim, int64_t node_count,
                               struct derived *derived, struct error *error)
{
    RETURN_IF_ERROR(add_facet_groups(stream, dim, node_count, derived, error));
    return add_node_sets(stream, node_count, derived, error);
}
