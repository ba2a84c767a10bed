/* The facets of a set: which faces of the table they are, and their normals. */
#include "approx/boundary_private.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* A face by its sorted nodes, for look-up. */
struct keyed_face {
    int32_t key[3];
    int64_t face;
};

static int compare_faces(const void *left, const void *right)
{
    const struct keyed_face *a = left, *b = right;
    for (int i = 0; i < 3; i++) {
        if (a->key[i] != b->key[i]) {
            return a->key[i] < b->key[i] ? -1 : 1;
        }
    }
    return 0;
}

enum status boundary_find_faces(const struct face_table *table, const struct facet_set *set, int64_t *face_of,
                                struct error *error)
{
    enum status status;
    struct keyed_face *keyed = NULL;
    int dim = table->dim;
    int64_t count = 0;
    for (int64_t i = 0; i < set->count * dim; i++) {
        if (set->facet[i] < 0 || set->facet[i] >= table->node_count) {
            return fail(error, STATUS_INPUT, "facets: no node %d", set->facet[i]);
        }
    }
    TRY(NEW_ARRAY(&keyed, table->faces->count, error));
    for (int64_t f = 0; f < table->faces->count; f++) {
        if (table->faces->cell[2 * f + 1] < 0) {
            face_key(dim, table->faces->node + f * dim, keyed[count].key);
            keyed[count++].face = f;
        }
    }
    qsort(keyed, (size_t)count, sizeof *keyed, compare_faces);
    for (int64_t i = 0; i < set->count; i++) {
        struct keyed_face wanted;
        face_key(dim, set->facet + i * dim, wanted.key);
        const struct keyed_face *found = bsearch(&wanted, keyed, (size_t)count, sizeof *keyed, compare_faces);
        if (found == NULL) {
            status = fail(error, STATUS_INPUT, "facets: row %lld of the set is no boundary face of the cells",
                          (long long)i);
            goto done;
        }
        face_of[i] = found->face;
    }
done:
    free(keyed);
    return status;
}

void boundary_unit_normal(const struct face_table *table, const int32_t *facet, double *normal, double *size)
{
    normal[2] = 0.0;
    face_area_vector(table->dim, table->x, facet, normal);
    *size = vector_length(table->dim, normal);
    for (int a = 0; a < table->dim; a++) {
        normal[a] /= *size;
    }
}
