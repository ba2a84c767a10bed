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

static enum status add_invariants(struct stream *stream, int64_t frame, struct error *error)
{
    char name[160];
    int64_t count = stream->section_count;
    for (int64_t s = 0; s < count; s++) {
        const struct section *section = &stream->sections[s];
        size_t length;
        int64_t from[6];
        bool wanted = frame_of(section->name, &length) == frame && vtk_tensor(section, from);
        for (size_t i = 0; i < sizeof invariants / sizeof *invariants; i++) {
            const struct invariant *what = &invariants[i];
            const char *tail = section->name + length;
            if (!wanted || strlen(what->of) != length || strncmp(section->name, what->of, length) != 0 ||
                (what->given != NULL && has_section(stream, what->given, tail))) {
                continue;
            }
            NEW_SCRATCH(double, values, section->rows *what->cols, error);
            for (int64_t row = 0; row < section->rows; row++) {
                double A[9];
                read_tensor(section, from, row, A);
                what->compute(A, values + row * what->cols);
            }
            snprintf(name, sizeof name, "%s%s", what->name, tail);
            RETURN_IF_ERROR(stream_put(stream, name, TYPE_F8, section->rows, what->cols, what->attributes,
                                       array_take(&values), true, error));
        }
    }
    return STATUS_OK;
}

/* Put a section for each name: 1 at the nodes node[i * per] and following of the items i of its group, 0
 * elsewhere. */
static enum status add_groups(struct stream *stream, const char *prefix, const struct names *names,
                              int64_t node_count, int64_t count, int per, const int32_t *node,
                              const int32_t *group, struct error *error)
{
    for (int64_t g = 0; g < names->count; g++) {
        char name[64];
        SCRATCH char *label = NULL;
        NEW_SCRATCH(int32_t, value, node_count, error);
        for (int64_t i = 0; i < count * per; i++) {
            value[node[i]] |= group[i / per] == g;
        }
        snprintf(name, sizeof name, DERIVED_GROUP "%s%lld", prefix, (long long)g);
        if (asprintf(&label, "label=%s.%s", prefix, names->name[g]) < 0) {
            label = NULL;
            return fail_memory(error, "labels");
        }
        RETURN_IF_ERROR(
            stream_put(stream, name, TYPE_I4, node_count, 1, label, array_take(&value), true, error));
    }
    return STATUS_OK;
}

enum status derived_add(struct stream *stream, const struct cells *cells, int64_t frame, struct error *error)
{
    FREED_BY(named_facets_free) struct named_facets facets = {0};
    FREED_BY(named_sets_free) struct named_sets sets = {0};
    const struct neighbours *lists = &sets.lists;
    RETURN_IF_ERROR(add_invariants(stream, frame, error));
    RETURN_IF_ERROR(stream_facets(stream, false, cells, &facets, error));
    RETURN_IF_ERROR(add_groups(stream, "facets", &facets.names, cells->node_count, facets.count, cells->dim,
                               facets.facet, facets.group, error));
    RETURN_IF_ERROR(stream_sets(stream, false, cells->node_count, &sets, error));
    int64_t count = lists->count > 0 ? lists->ptr[lists->count] : 0;
    NEW_SCRATCH(int32_t, group, count, error);
    for (int64_t i = 0, s = 0; i < count; i++) {
        while (i >= lists->ptr[s + 1]) {
            s++;
        }
        group[i] = (int32_t)s;
    }
    return add_groups(stream, "set", &sets.names, cells->node_count, count, 1, lists->idx, group, error);
}
