#include "mtled/run.h"

#include "stages/stages.h"

#include "approx/cells/cells.h"
#include "approx/field/field.h"
#include "solid/contact/contact.h"

#include <math.h>
#include <string.h>

/* Mark the nodes of facets that a contact keeps from going through each other. */
static void mark_facets(int dim, const struct facet_set *set, bool *marked)
{
    for (int64_t i = 0; i < set->count * dim; i++) {
        marked[set->facet[i]] = true;
    }
}

static enum status build(const struct assembly *input, struct run_folds *folds, struct error *error)
{
    const struct cells *cells = &input->cells;
    struct fold_input body = {.dim = cells->dim,
                              .node_count = cells->node_count,
                              .x = cells->x,
                              .cell_count = cells->count,
                              .cell = cells->node,
                              .facet_count = input->boundary.count,
                              .facet = input->boundary.node,
                              .ranks = process_ranks()};
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &folds->held, error));
    body.held = folds->held;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->field, cells->node_count * cells->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->stopped, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->in_contact, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->flat, cells->count, error));
    RETURN_IF_ERROR(ranks_share(body.ranks, cells->node_count, NULL, &folds->node_first, error));
    RETURN_IF_ERROR(folds_build(&body, &folds->folds, error));
    for (int32_t c = 0; c < input->contact_count; c++) {
        if (input->contacts[c].opposite.count > 0) {
            mark_facets(cells->dim, &input->contacts[c].facets, folds->in_contact);
            mark_facets(cells->dim, &input->contacts[c].opposite, folds->in_contact);
        }
    }
    folds->folds.in_contact = folds->in_contact;
    return STATUS_OK;
}

void run_folds_begin(struct run *run)
{
    TOOL_TRY(run->tool, build(&run->model->assembly, &run->folds, &error));
    run_folds_at_rest(run);
}

void run_folds_free(struct run *run)
{
    folds_free(&run->folds.folds);
    FREE_ALL(run->folds.held, run->folds.field, run->folds.node_first, run->folds.stopped,
             run->folds.in_contact, run->folds.flat);
    visibility_free(&run->folds.space);
}

/* A surface counts as in contact if it is no further away than this share of a facet's size. */
static const double near_share = 0.25;

/* Mark nodes in contact with a rigid surface. */
static void mark_stopped(const struct run *run, bool *stopped)
{
    const struct solid_system *system = &run->model->system;
    memset(stopped, 0, (size_t)system->node_count * sizeof *stopped);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *nodes = contact_nodes(contact);
        for (int64_t a = 0; contact->between == NULL && a < nodes->count; a++) {
            double area = nodes->area[a], length = contact->dim == 2 ? area : sqrt(area);
            stopped[nodes->node[a]] |= contact_node(contact, a).gap < near_share * length;
        }
    }
}

/* The field at the nodes; each process computes a share of it. */
static void evaluate_field(const struct assembly *input, const double *u, struct run_folds *folds)
{
    const struct ranks *ranks = process_ranks();
    int64_t begin = folds->node_first[ranks_rank(ranks)], end = folds->node_first[ranks_rank(ranks) + 1];
    int dim = input->cells.dim;
    field_evaluate(end - begin, input->node_lists.ptr + begin, input->node_lists.idx, input->node_phi, dim, u,
                   folds->field + begin * dim);
    ranks_gather(ranks, folds->field, (size_t)dim * sizeof *folds->field, folds->node_first);
}

/* Mark the cells, of the `count` in folds->flat, in which the field of the parameters u keeps its
 * orientation; none without radii of supports, or where a support is unfit. */
static enum status find_upright_cells(struct run *run, int64_t count, const double *u, struct error *error)
{
    struct run_folds *folds = &run->folds;
    const struct cells *cells = &run->model->assembly.cells;
    struct field_shapes recorded;
    RETURN_IF_ERROR(stage_recorded(run->stream, "support", &recorded, error));
    if (recorded.radius == NULL) {
        return STATUS_OK;
    }
    if (!folds->has_space) {
        RETURN_IF_ERROR(visibility_build(cells, recorded.radius, recorded.support.visibility,
                                         recorded.support.side, &folds->space, error));
        folds->has_space = true;
    }
    NEW_SCRATCH(double, least, count, error);
    enum status status =
        field_least_determinants(&recorded, &folds->space, count, folds->flat, u, least, error);
    for (int64_t i = 0; i < count && status == STATUS_OK; i++) {
        folds->folds.oriented[folds->flat[i]] = least[i] > 0.0;
    }
    return status == STATUS_VERDICT ? STATUS_OK : status;
}

/* Folds of the map between the nodes that are folds of the field. */
static struct fold find(struct run *run, const double *u)
{
    struct run_folds *folds = &run->folds;
    bool *oriented = folds->folds.oriented;
    memset(oriented, 0, (size_t)folds->folds.input.cell_count * sizeof *oriented);
    struct fold fold = folds_find(&folds->folds, folds->field, folds->stopped);
    int64_t count = fold.kind == FOLD_CELL ? folds_list_flat(&folds->folds, folds->flat) : 0;
    if (count > 0) {
        TOOL_TRY(run->tool, find_upright_cells(run, count, u, &error));
        fold = folds_find(&folds->folds, folds->field, folds->stopped);
    }
    return fold;
}

void run_folds_check(struct run *run, const double *u, double time, bool is_frame)
{
    struct run_folds *folds = &run->folds;
    evaluate_field(&run->model->assembly, u, folds);
    mark_stopped(run, folds->stopped);
    struct fold fold = find(run, u);
    if (is_frame && fold.kind == FOLD_NONE) {
        TOOL_TRY(run->tool, folds_find_overlaps(&folds->folds, folds->field, &fold, &error));
    }
    if (folds->stays) {
        return;
    }
    bool found = fold.kind != FOLD_NONE;
    if (!folds->seen || !found) {
        folds->since = time;
        folds->fold = fold;
    }
    folds->seen = found;
    folds->stays = found && (is_frame || run->scene->analysis == SCENE_DYNAMIC);
}

enum status run_folds_state(struct run *run, const struct state *state, struct error *error)
{
    struct run_folds *folds = &run->folds;
    struct fold *fold = &folds->fold;
    int64_t *counts = folds->kept;
    counts[0] = (int64_t)fold->kind;
    counts[1] = fold->cell + 1;
    counts[2] = fold->facet[0] + 1;
    counts[3] = fold->facet[1] + 1;
    const struct state_value values[] = {{"seen", STATE_FLAGS, &folds->seen, 1},
                                         {"stays", STATE_FLAGS, &folds->stays, 1},
                                         {"since", STATE_NUMBERS, &folds->since, 1},
                                         {"fold", STATE_COUNTS, counts, 4},
                                         {"place", STATE_NUMBERS, fold->place, 3}};
    RETURN_IF_ERROR(state_visit(state, "folds", values, sizeof values / sizeof *values, error));
    fold->kind = (enum fold_kind)counts[0];
    fold->cell = counts[1] - 1;
    fold->facet[0] = counts[2] - 1;
    fold->facet[1] = counts[3] - 1;
    return STATUS_OK;
}
