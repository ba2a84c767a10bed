/* The search for folds while a run lasts, and what is said of them and of states that are not stable. */
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
    struct fold_input body = {.cells = *cells,
                              .facet_count = input->boundary.count,
                              .facet = input->boundary.node,
                              .ranks = process_ranks()};
    SCRATCH bool *held = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &held, error));
    body.held = held;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->field, cells->node_count * cells->dim, error));
    RETURN_IF_ERROR(ranks_share(body.ranks, cells->node_count, NULL, &folds->node_first, error));
    RETURN_IF_ERROR(folds_build(&body, &folds->folds, error));
    for (int32_t c = 0; c < input->contact_count; c++) {
        if (input->contacts[c].opposite.count > 0) {
            mark_facets(cells->dim, &input->contacts[c].facets, folds->folds.in_contact);
            mark_facets(cells->dim, &input->contacts[c].opposite, folds->folds.in_contact);
        }
    }
    return STATUS_OK;
}

/* The name of a group that a facet of the boundary is in, or "the boundary". */
static void name_facet(const struct run *run, int64_t f, char *name, size_t size)
{
    int dim = run->scene->dim;
    FREED_BY(groups_free) struct groups facets = {0};
    struct error ignored;
    int32_t key[3], other[3];
    enum status status = stream_groups(run->stream, GROUP_FACETS, false, &facets, &ignored);
    snprintf(name, size, "the boundary");
    face_key(dim, run->folds.folds.input.facet + f * dim, key);
    for (int64_t i = 0; i < facets.count && status == STATUS_OK; i++) {
        face_key(dim, facets.node + i * dim, other);
        if (memcmp(key, other, sizeof key) == 0) {
            snprintf(name, size, "%s", facets.names.name[facets.group[i]]);
            break;
        }
    }
}

/* Bodies that interpenetrate at rest are an error, unless the scene allows folds. */
static void judge_at_rest(const struct run *run)
{
    const struct fold *fold = &run->folds.folds.at_rest;
    char text[300], one[64];
    if (fold->kind == FOLD_NONE) {
        return;
    }
    const char *place = POINT_TEXT(run->scene->dim, fold->place);
    if (fold->kind == FOLD_WITHIN) {
        snprintf(text, sizeof text, "bodies interpenetrate at rest: cell %jd at %s lies within another body",
                 fold->cell, place);
    } else if (fold->kind == FOLD_CREASE) {
        name_facet(run, fold->facet[0], one, sizeof one);
        snprintf(text, sizeof text, "facets of %s that meet at %s pass through each other at rest", one,
                 place);
    } else {
        name_facet(run, fold->facet[0], one, sizeof one);
        snprintf(text, sizeof text,
                 "bodies, or parts of one, interpenetrate at rest: %s at %s goes through the boundary", one,
                 place);
    }
    if (!run->scene->output.folds_allowed) {
        tool_fail(run->tool, STATUS_INPUT,
                  "%s: %s: set them apart in the mesh, or allow it ([output] folds = allowed)",
                  run->scene->path, text);
    }
    run_note(run, "%s; later ones are not searched for", text);
}

void run_folds_begin(struct run *run)
{
    TOOL_TRY(run->tool, build(&run->model->assembly, &run->folds, &error));
    judge_at_rest(run);
}

void run_folds_free(struct run *run)
{
    folds_free(&run->folds.folds);
    FREE_ALL(run->folds.field, run->folds.node_first);
    visibility_free(&run->folds.space);
}

/* A surface counts as in contact if it is no further away than this share of a facet's size. */
static const double near_share = 0.25;

/* Mark nodes in contact with a rigid surface. */
static void mark_stopped(const struct run *run, bool *stopped)
{
    const struct solid_system *system = &run->model->system;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *nodes = contact_nodes(contact);
        for (int64_t a = 0; contact->between == NULL && a < nodes->count; a++) {
            double area = nodes->area[a], length = contact->dim == 2 ? area : sqrt(area);
            stopped[nodes->node[a]] |= contact_node(contact, a).gap < near_share * length;
        }
    }
}

/* Mark the cells, of the `count` in flat, in which the field of the parameters u keeps its
 * orientation; none without radii of supports, or where a support is unfit. */
static enum status find_upright_cells(struct run *run, int64_t count, const int32_t *flat, const double *u,
                                      struct error *error)
{
    struct run_folds *folds = &run->folds;
    const struct cells *cells = &run->model->assembly.cells;
    struct field_shapes recorded;
    RETURN_IF_ERROR(stage_recorded(run->stream, "support", &recorded, error));
    if (recorded.supports.radius == NULL) {
        return STATUS_OK;
    }
    if (!folds->has_space) {
        RETURN_IF_ERROR(visibility_build(cells, recorded.supports, recorded.support.visibility,
                                         recorded.support.side, &folds->space, error));
        folds->has_space = true;
    }
    NEW_SCRATCH(double, least, count, error);
    enum status status = field_least_determinants(&recorded, &folds->space, count, flat, u, least, error);
    for (int64_t i = 0; i < count && status == STATUS_OK; i++) {
        folds->folds.oriented[flat[i]] = least[i] > 0.0;
    }
    return status == STATUS_VERDICT ? STATUS_OK : status;
}

/* Folds of the map between the nodes that are folds of the field. */
static struct fold find(struct run *run, const double *u, const bool *stopped)
{
    struct run_folds *folds = &run->folds;
    TOOL_SCRATCH(run->tool, int32_t, flat, folds->folds.input.cells.count);
    bool *oriented = folds->folds.oriented;
    memset(oriented, 0, (size_t)folds->folds.input.cells.count * sizeof *oriented);
    struct fold fold = folds_find(&folds->folds, folds->field, stopped);
    int64_t count = fold.kind == FOLD_CELL ? folds_list_flat(&folds->folds, flat) : 0;
    if (count > 0) {
        TOOL_TRY(run->tool, find_upright_cells(run, count, flat, u, &error));
        fold = folds_find(&folds->folds, folds->field, stopped);
    }
    return fold;
}

void run_folds_check(struct run *run, const double *u, double time, bool is_frame)
{
    struct run_folds *folds = &run->folds;
    const struct assembly *input = &run->model->assembly;
    const struct ranks *ranks = process_ranks();
    int64_t begin = folds->node_first[ranks_rank(ranks)], end = folds->node_first[ranks_rank(ranks) + 1];
    int dim = input->cells.dim;
    /* The field at the nodes: each process computes a share of it. */
    field_evaluate(end - begin, input->node_lists.ptr + begin, input->node_lists.idx, input->node_phi, dim, u,
                   folds->field + begin * dim);
    ranks_gather(ranks, folds->field, (size_t)dim * sizeof *folds->field, folds->node_first);
    TOOL_SCRATCH(run->tool, bool, stopped, input->cells.node_count);
    mark_stopped(run, stopped);
    struct fold fold = find(run, u, stopped);
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

/* ---- what is told at the end ---- */

/* A result is refused if the law is not strongly elliptic in more than this share of the body. It is a few
 * percent if it is so at singular corners only, and half if the body has become irregular. */
static const double most_inelliptic = 0.1;

/* text = when a state is given: "t = 0.1 s", "0.5 of the load" or "the whole load". */
static const char *when_text(const struct run *run, double time, char text[48])
{
    double duration = run->scene->duration;
    bool in_time = run->scene->analysis == SCENE_DYNAMIC || duration > 0.0;
    snprintf(text, 48,
             in_time      ? "t = %.4g s"
             : time < 1.0 ? "%.4g of the load"
                          : "the whole load",
             duration > 0.0 ? time * duration : time);
    return text;
}

static const char *node_text(const struct run *run, int64_t node, char text[96])
{
    return point_text(run->scene->dim, run->model->system.X + node * run->scene->dim, text);
}

/* Whether a contact of the scene lets all of the boundary touch itself. */
static bool touches_itself(const struct assembly *input)
{
    bool whole = false;
    for (int64_t c = 0; c < input->contact_count; c++) {
        whole = whole || (input->contacts[c].whole && input->contacts[c].opposite.count > 0);
    }
    return whole;
}

/* Words for a kind of fold: before and behind the place; contact would prevent it. */
static const struct {
    const char *before, *behind;
    bool touches;
} words[] = {[FOLD_CELL] = {"cell ", " is turned over", false},
             [FOLD_CREASE] = {"facets of ", " pass through each other", true},
             [FOLD_CROSSING] = {"", " goes through ", true},
             [FOLD_WITHIN] = {"cell ", " is within another one", true},
             [FOLD_EVERTED] = {"", " is turned inside out", true}};

void run_folds_describe(const struct run *run, char *text, size_t size)
{
    const struct run_folds *folds = &run->folds;
    const struct fold *fold = &folds->fold;
    char one[64], other[64] = "", when[48];
    text[0] = '\0';
    if (!folds->seen) {
        return;
    }
    bool since = run->scene->analysis == SCENE_DYNAMIC || folds->since < 1.0;
    snprintf(one, sizeof one, "%jd", fold->cell);
    if (fold->facet[0] >= 0) {
        name_facet(run, fold->facet[0], one, sizeof one);
    }
    if (fold->kind == FOLD_CROSSING) {
        name_facet(run, fold->facet[1], other, sizeof other);
    }
    snprintf(text, size, "the body folds %s %s%s: %s%s at %s%s%s: %spress less, refine there",
             since ? "from" : "at", when_text(run, folds->since, when), since ? " on" : "",
             words[fold->kind].before, one, POINT_TEXT(run->scene->dim, fold->place),
             words[fold->kind].behind, other,
             words[fold->kind].touches && !touches_itself(&run->model->assembly)
                 ? "let it touch itself ([contact] with facets = *, against = *), "
                 : "");
}

void run_folds_judge(struct run *run)
{
    const struct run_stability *stability = &run->stability;
    char text[500], when[48], place[96];
    run_folds_describe(run, text, sizeof text);
    if (!run->folds.seen && stability->seen) {
        snprintf(
            text, sizeof text,
            "the body folds at %s: its equilibrium is not stable, and would buckle or wrinkle, most of all "
            "at %s: press less, hold it there",
            when_text(run, stability->since, when), node_text(run, stability->node, place));
    }
    const struct stability *found = &run->model->system.stability;
    if (text[0] == '\0' && found->left) {
        run_note(run,
                 "at %s the body leaves a state near equilibrium, most of all at %s: it buckles, wrinkles or "
                 "snaps through, and the result may be one of several",
                 when_text(run, found->left_load, when), node_text(run, found->left_node, place));
    }
    if (text[0] == '\0') {
        return;
    }
    if (run->scene->output.folds_allowed) {
        run_note(run, "%s", text);
        return;
    }
    run->folds.reported = true;
    run->last_good = -1.0; /* the frames are all there */
    run_fail(run, STATUS_VERDICT, "%s, or allow it ([output] folds = allowed)", text);
}

void run_stability_check(struct run *run, double load, bool final)
{
    static const char text[] =
        "at %s, the material law is not strongly elliptic in %.3g %% of the body, as at %s: what it does "
        "there depends on the mesh: use another model, as neo-hookean, or a smaller load";
    const struct stability *stability = &run->model->system.stability;
    struct inelliptic found = body_inelliptic(&run->model->system.body);
    char when[48];
    if (stability->least < 0.0 && !run->stability.seen) {
        run->stability = (struct run_stability){true, load, stability->node};
    }
    if (found.point < 0 || !(final || found.share > most_inelliptic)) {
        return;
    }
    const char *place = POINT_TEXT(run->scene->dim, run->model->assembly.x + found.point * run->scene->dim);
    if (found.share > most_inelliptic) {
        if (final) {
            run->last_good = -1.0; /* all frames have been given */
        }
        run_fail(run, STATUS_VERDICT, text, when_text(run, load, when), 100.0 * found.share, place);
    }
    run_note(run, text, when_text(run, load, when), 100.0 * found.share, place);
}
