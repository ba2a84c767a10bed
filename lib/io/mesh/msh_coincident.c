#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "io/mesh/msh_build.h"

#include <math.h>
#include <stdlib.h>

static enum status fail_coincident(const struct mesh_draft *draft, int32_t a, int32_t b)
{
    int64_t tags[2] = {0, 0};
    for (int64_t n = 0; n < draft->msh->node_count; n++) {
        if (draft->node_of[n] == a || draft->node_of[n] == b) {
            tags[draft->node_of[n] == (a > b ? a : b)] = draft->msh->nodes[n].tag;
        }
    }
    return fail(
        draft->error, STATUS_INPUT,
        "nodes %lld and %lld are at the same place, in one body: merge them (Coherence Mesh), or name "
        "the facets of a slit",
        (long long)tags[0], (long long)tags[1]);
}

/* slit[node_count]: whether a node is on a facet that has a group. */
static void mark_slits(const struct mesh_draft *draft, bool *slit)
{
    const struct msh *msh = draft->msh;
    for (int64_t e = 0; e < msh->element_count; e++) {
        bool is_named = msh->elements[e].group >= 0 && mesh_element_dim(draft, e) == draft->mesh->dim - 1;
        for (int k = 0; is_named && k < mesh_corners(draft, e); k++) {
            int32_t node = draft->node_of[msh->node_idx[msh->elements[e].first + k]];
            if (node >= 0) {
                slit[node] = true;
            }
        }
    }
}

/* Nodes at one place coincide in any projection: sort them along a direction with which no lattice is
 * aligned, and compare those that are near along it. */
enum status mesh_check_coincident(struct mesh_draft *draft)
{
    static const double direction[3] = {0.7548776662466927, 0.5698402909980532, 0.3247179572447460};
    const struct mesh *mesh = draft->mesh;
    struct box box = box_of(mesh->dim, mesh->node_count, mesh->x);
    double tolerance = ROUND_OFF * box_side(&box);
    SCRATCH struct placed *order = NULL;
    SCRATCH int32_t *body = NULL;
    SCRATCH bool *slit = NULL;
    int64_t touching = 0, doubled = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&body, mesh->node_count, draft->error));
    set_join_cells(mesh->node_count, mesh->cell_count, mesh->dim + 1, mesh->cells, body);
    RETURN_IF_ERROR(NEW_ARRAY(&slit, mesh->node_count, draft->error));
    mark_slits(draft, slit);
    RETURN_IF_ERROR(NEW_ARRAY(&order, mesh->node_count, draft->error));
    for (int64_t n = 0; n < mesh->node_count; n++) {
        order[n].item = n;
        for (int k = 0; k < mesh->dim; k++) {
            order[n].place += direction[k] * (mesh->x[n * mesh->dim + k] - box.low[k]);
        }
    }
    qsort(order, (size_t)mesh->node_count, sizeof *order, compare_placed);
    for (int64_t i = 0; i < mesh->node_count; i++) {
        for (int64_t j = i + 1; j < mesh->node_count && order[j].place - order[i].place <= 2 * tolerance;
             j++) {
            int32_t a = (int32_t)order[i].item, b = (int32_t)order[j].item;
            double farthest = 0;
            for (int k = 0; k < mesh->dim; k++) {
                farthest = fmax(farthest, fabs(mesh->x[a * mesh->dim + k] - mesh->x[b * mesh->dim + k]));
            }
            if (farthest <= tolerance && set_first(body, a) != set_first(body, b)) {
                touching++;
            } else if (farthest <= tolerance && (slit[a] || slit[b])) {
                doubled++;
            } else if (farthest <= tolerance) {
                RETURN_IF_ERROR(fail_coincident(draft, a, b));
            }
        }
    }
    if (doubled > 0) {
        RETURN_IF_ERROR(
            mesh_add_note(draft,
                          "nodes at the same place, on named facets of one body: %lld pairs: it has "
                          "a slit there",
                          (long long)doubled));
    }
    if (touching > 0) {
        RETURN_IF_ERROR(mesh_add_note(
            draft,
            "nodes at the same place, of different bodies: %lld pairs: the bodies are not joined "
            "there (Coherence Mesh in gmsh joins them)",
            (long long)touching));
    }
    return STATUS_OK;
}
