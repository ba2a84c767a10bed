#include "tovtk/derived.h"

#include "base/eigen.h"
#include "base/memory.h"
#include "io/stream/sections.h"
#include "io/vtk/vtk.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void derived_free(struct derived *derived)
{
    for (int64_t i = 0; i < derived->count; i++) {
        FREE_ALL(derived->items[i].name, derived->items[i].attributes, derived->items[i].data);
    }
    free(derived->items);
    *derived = (struct derived){0};
}

/* Append a section of zeros, whose name is in two pieces. Its data is in the last item. */
static enum status append(struct derived *derived, const char *name, const char *tail, enum element_type type,
                          int64_t rows, int64_t cols, const char *attributes, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&derived->items, derived->count + 1, error));
    struct section section = {.type = type, .rows = rows, .cols = cols};
    section.attributes = strdup(attributes);
    section.data = array_new(rows * cols, element_size(type));
    section.name = asprintf(&section.name, "%s%s", name, tail) < 0 ? NULL : section.name;
    derived->items[derived->count++] = section;
    if (section.attributes == NULL || section.data == NULL || section.name == NULL) {
        return fail_memory(error, name);
    }
    return STATUS_OK;
}

static void *last_data(const struct derived *derived)
{
    return derived->items[derived->count - 1].data;
}

/* A[9]: row `row` of a symmetric tensor, whose components are in the columns from[6]. */
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
    *row = sqrt(determinant3(C, C + 3, C + 6));
}

static const struct invariant {
    const char *of, *name; /* of section `of` and its frames */
    int cols;
    const char *attributes;
    const char *given; /* left out if the stream has this section */
    void (*compute)(const double A[9], double *row);
} invariants[] = {
    {"stress", "stress.von_mises", 1, "unit=Pa", NULL, von_mises},
    {"stress", "stress.principal", 3, "unit=Pa cols=1,2,3", NULL, principal_values},
    {"stress", "pressure", 1, "unit=Pa", "pressure", mean_pressure},
    {"strain", "strain.principal", 3, "unit=1 cols=1,2,3", NULL, principal_values},
    {"strain", "J", 1, "unit=1", "volume_ratio", volume_ratio},
};

/* Whether the stream has the section in the frame that `tail` names. */
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
            RETURN_IF_ERROR(append(derived, what->name, tail, TYPE_F8, section->rows, what->cols,
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

/* Append a section of zeros for each name, behind the prefix. */
static enum status append_groups(const struct names *names, const char *prefix, int64_t node_count,
                                 struct derived *derived, struct error *error)
{
    for (int64_t i = 0; i < names->count; i++) {
        RETURN_IF_ERROR(append(derived, prefix, names->name[i], TYPE_I4, node_count, 1, "", error));
    }
    return STATUS_OK;
}

static void mark(const struct derived *derived, int64_t item, int32_t node)
{
    ((int32_t *)derived->items[item].data)[node] = 1;
}

static enum status add_facet_groups(const struct stream *stream, const struct cells *cells,
                                    struct derived *derived, struct error *error)
{
    FREED_BY(named_facets_free) struct named_facets facets = {0};
    int64_t first = derived->count;
    RETURN_IF_ERROR(stream_facets(stream, false, cells, &facets, error));
    RETURN_IF_ERROR(append_groups(&facets.names, "facets.", cells->node_count, derived, error));
    for (int64_t i = 0; i < facets.count * cells->dim; i++) {
        mark(derived, first + facets.group[i / cells->dim], facets.facet[i]);
    }
    return STATUS_OK;
}

static enum status add_node_sets(const struct stream *stream, const struct cells *cells,
                                 struct derived *derived, struct error *error)
{
    FREED_BY(named_sets_free) struct named_sets sets = {0};
    int64_t first = derived->count;
    RETURN_IF_ERROR(stream_sets(stream, false, cells->node_count, &sets, error));
    RETURN_IF_ERROR(append_groups(&sets.names, "set.", cells->node_count, derived, error));
    for (int64_t s = 0; s < sets.lists.count; s++) {
        for (int64_t i = sets.lists.ptr[s]; i < sets.lists.ptr[s + 1]; i++) {
            mark(derived, first + s, sets.lists.idx[i]);
        }
    }
    return STATUS_OK;
}

enum status derived_add_groups(const struct stream *stream, const struct cells *cells,
                               struct derived *derived, struct error *error)
{
    RETURN_IF_ERROR(add_facet_groups(stream, cells, derived, error));
    return add_node_sets(stream, cells, derived, error);
}
