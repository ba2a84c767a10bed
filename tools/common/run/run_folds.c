#include "run/run.h"

#include "stages/names.h"
#include "stages/stages.h"

#include "approx/cells/cells.h"
#include "approx/field/field.h"
#include "approx/field/field_turning.h"
#include "solid/contact/contact_between.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    RETURN_IF_ERROR(assembly_sliding_faces(input, &folds->slides, error));
    body.held = folds->held;
    body.slides = folds->slides;
    RETURN_IF_ERROR(NEW_ARRAY(&folds->field, cells->node_count * cells->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->stopped, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->in_contact, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->turned, cells->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&folds->flat, cells->count, error));
    RETURN_IF_ERROR(ranks_share(body.ranks, cells->node_count, NULL, &folds->node_first, error));
    RETURN_IF_ERROR(folds_build(&body, &folds->folds, error));
    folds->folds.in_contact = folds->in_contact;
    folds->folds.turned = folds->turned;
    return STATUS_OK;
}

/* The name of a group that a facet of the boundary is in, or "the boundary". */
static void name_facet(const struct run *run, int64_t f, char *name, size_t size)
{
    int dim = run->scene->dim;
    FREED_BY(named_facets_free) struct named_facets facets = {0};
    struct error ignored;
    int32_t key[3], other[3];
    enum status status = stream_facets(run->stream, false, &run->model->assembly.cells, &facets, &ignored);
    snprintf(name, size, "the boundary");
    face_key(dim, run->folds.folds.input.facet + f * dim, key);
    for (int64_t i = 0; i < facets.count && status == STATUS_OK; i++) {
        face_key(dim, facets.facet + i * dim, other);
        if (memcmp(key, other, sizeof key) == 0) {
            snprintf(name, size, "%s", facets.names.name[facets.group[i]]);
            break;
        }
    }
}

/* Bodies that interpenetrate at rest are an error, unless the scene allows folds. */
static void tell_at_rest(const struct run *run)
{
    const struct fold *fold = &run->folds.folds.at_rest;
    char place[96], text[300], one[64];
    if (fold->kind == FOLD_NONE) {
        return;
    }
    point_text(run->scene->dim, fold->place, place);
    if (fold->kind == FOLD_WITHIN) {
        snprintf(text, sizeof text, "bodies interpenetrate at rest: cell %lld at %s lies within another body",
                 (long long)fold->cell, place);
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
    tool_note(run->tool, "%s: %s; whether others do later is not looked for", run->scene->path, text);
}

void run_folds_begin(struct run *run)
{
    const struct state *restored = run_checkpoint_state(run);
    TOOL_TRY(run->tool, build(&run->model->assembly, &run->folds, &error));
    tell_at_rest(run);
    if (restored != NULL) {
        TOOL_TRY(run->tool, run_folds_state(run, restored, &error));
    }
}

void run_folds_free(struct run *run)
{
    folds_free(&run->folds.folds);
    FREE_ALL(run->folds.held, run->folds.slides, run->folds.field, run->folds.node_first, run->folds.stopped,
             run->folds.in_contact, run->folds.turned, run->folds.flat);
    support_space_free(&run->folds.space);
}

void run_folds_forget(struct run *run)
{
    memset(run->folds.now, 0, sizeof run->folds.now);
    memset(run->folds.past, 0, sizeof run->folds.past);
}

/* A surface counts as in contact if it is no further away than this share of a facet's size. */
static const double near_share = 0.25;

/* Mark nodes in contact with a rigid surface, nodes in contact with another part of the body, and of the
 * latter those that did not face it at rest. */
static void mark_stopped(const struct run *run, bool *stopped, bool *touched, bool *turned)
{
    const struct solid_system *system = &run->model->system;
    memset(stopped, 0, (size_t)system->node_count * sizeof *stopped);
    memset(touched, 0, (size_t)system->node_count * sizeof *touched);
    memset(turned, 0, (size_t)system->node_count * sizeof *turned);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *nodes = contact_nodes(contact);
        bool *marked = contact->between == NULL ? stopped : touched;
        for (int64_t a = 0; a < nodes->count; a++) {
            double area = nodes->area[a], length = contact->dim == 2 ? area : sqrt(area);
            marked[nodes->node[a]] |= contact_node(contact, a).gap < near_share * length;
        }
        contact_between_mark(contact, near_share, touched, turned);
    }
}

/* Record what a search at `time` has found: a spell begins, lasts or ends. */
static void note(struct run_folds *folds, int which, const struct fold *fold, double time, bool counts)
{
    struct fold_spell *now = &folds->now[which], *past = &folds->past[which];
    if (fold->kind == FOLD_NONE) {
        if (now->seen && now->counts && !past->seen) {
            *past = *now;
            past->until = time;
        }
        *now = (struct fold_spell){.seen = false};
        return;
    }
    bool graver = now->fold.kind == FOLD_FLAT && fold->kind != FOLD_FLAT;
    if (!now->seen || graver) {
        *now = (struct fold_spell){.seen = true, .since = time, .until = INFINITY, .fold = *fold};
    }
    now->counts = now->counts || counts;
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
static enum status ask_field(struct run *run, int64_t count, const double *u, struct error *error)
{
    struct run_folds *folds = &run->folds;
    const struct cells *cells = &run->model->assembly.cells;
    const struct section *radius = stream_find(run->stream, "support.radius");
    struct recorded recorded;
    SCRATCH double *least = NULL;
    if (radius == NULL || radius->rows != cells->node_count) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stage_recorded(run->stream, "support", cells->dim, &recorded, error));
    if (!folds->has_space) {
        RETURN_IF_ERROR(support_space_build(&recorded.support, cells, radius->data, &folds->space, error));
        folds->has_space = true;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&least, count, error));
    enum status status = field_least_determinants(&recorded.support, &recorded.shapes, &folds->space, count,
                                                  folds->flat, u, least, error);
    for (int64_t i = 0; i < count && status == STATUS_OK; i++) {
        folds->folds.upright[folds->flat[i]] = least[i] > 0.0;
    }
    return status == STATUS_VERDICT ? STATUS_OK : status;
}

/* Folds of the map between the nodes that are folds of the field. */
static struct fold find(struct run *run, const double *u)
{
    struct run_folds *folds = &run->folds;
    bool *upright = folds->folds.upright;
    memset(upright, 0, (size_t)folds->folds.input.cell_count * sizeof *upright);
    struct fold fold = folds_find(&folds->folds, folds->field, folds->stopped);
    int64_t count = fold.kind == FOLD_CELL ? folds_list_flat(&folds->folds, folds->flat) : 0;
    if (count > 0) {
        TOOL_TRY(run->tool, ask_field(run, count, u, &error));
        fold = folds_find(&folds->folds, folds->field, folds->stopped);
    }
    return fold;
}

void run_folds_look(struct run *run, const double *u, double time, bool is_frame)
{
    struct run_folds *folds = &run->folds;
    bool counts = is_frame || run->scene->analysis == SCENE_DYNAMIC;
    evaluate_field(&run->model->assembly, u, folds);
    mark_stopped(run, folds->stopped, folds->in_contact, folds->turned);
    struct fold fold = find(run, u);
    if (is_frame && (fold.kind == FOLD_NONE || fold.kind == FOLD_FLAT)) {
        struct fold overlap;
        TOOL_TRY(run->tool, folds_find_overlaps(&folds->folds, folds->field, &overlap, &error));
        fold = overlap.kind != FOLD_NONE ? overlap : fold;
    }
    struct fold none = {.kind = FOLD_NONE};
    struct fold beyond = folds_find_beyond(&folds->folds, folds->field, folds->stopped);
    note(folds, FOLDED, fold.kind == FOLD_FLAT ? &none : &fold, time, counts);
    if (beyond.kind == FOLD_NONE) {
        beyond = fold.kind == FOLD_FLAT ? fold : folds_find_closed(&folds->folds, folds->field);
    }
    if (beyond.kind == FOLD_NONE) {
        beyond = folds_find_wrapped(&folds->folds);
    }
    note(folds, NOTED, &beyond, time, counts);
}

/* A spell. */
static enum status spell_state(struct fold_spell *spell, const char *prefix, const struct state *state,
                               struct error *error)
{
    struct fold *fold = &spell->fold;
    int64_t *counts = spell->kept;
    counts[0] = (int64_t)fold->kind;
    counts[1] = fold->count;
    counts[2] = fold->cell + 1;
    counts[3] = fold->facet[0] + 1;
    counts[4] = fold->facet[1] + 1;
    const struct state_value values[] = {
        {"seen", STATE_FLAGS, &spell->seen, 1},     {"since", STATE_NUMBERS, &spell->since, 1},
        {"until", STATE_NUMBERS, &spell->until, 1}, {"fold", STATE_COUNTS, counts, 5},
        {"place", STATE_NUMBERS, fold->place, 3},   {"counts", STATE_FLAGS, &spell->counts, 1}};
    RETURN_IF_ERROR(state_visit(state, prefix, values, sizeof values / sizeof *values, error));
    fold->kind = (enum fold_kind)counts[0];
    fold->count = counts[1];
    fold->cell = counts[2] - 1;
    fold->facet[0] = counts[3] - 1;
    fold->facet[1] = counts[4] - 1;
    return STATUS_OK;
}

enum status run_folds_state(struct run *run, const struct state *state, struct error *error)
{
    RETURN_IF_ERROR(spell_state(&run->folds.now[FOLDED], "folds.now", state, error));
    RETURN_IF_ERROR(spell_state(&run->folds.past[FOLDED], "folds.past", state, error));
    RETURN_IF_ERROR(spell_state(&run->folds.now[NOTED], "noted.now", state, error));
    return spell_state(&run->folds.past[NOTED], "noted.past", state, error);
}

/* That of now, or else that of before. */
static const struct fold_spell *spell_of(const struct run *run, int which)
{
    const struct run_folds *folds = &run->folds;
    return folds->now[which].seen ? &folds->now[which] : &folds->past[which];
}

void run_folds_describe(const struct run *run, int which, char *text, size_t size)
{
    const struct fold_spell *spell = spell_of(run, which);
    bool dynamic = run->scene->analysis == SCENE_DYNAMIC;
    char place[96], one[64], other[64], when[96];
    text[0] = '\0';
    if (!spell->seen) {
        return;
    }
    const struct fold *fold = &spell->fold;
    point_text(run->scene->dim, fold->place, place);
    snprintf(when, sizeof when,
             dynamic              ? "from t = %.4g s on"
             : spell->since < 1.0 ? "from %.4g of the load on"
                                  : "at the whole load",
             spell->since);
    if (isfinite(spell->until)) {
        snprintf(when, sizeof when, dynamic ? "from t = %.4g to %.4g s" : "from %.4g to %.4g of the load",
                 spell->since, spell->until);
    }
    if (fold->facet[0] >= 0) {
        name_facet(run, fold->facet[0], one, sizeof one);
    }
    if (fold->facet[1] >= 0) {
        name_facet(run, fold->facet[1], other, sizeof other);
    }
    switch (fold->kind) {
    case FOLD_CELL:
        snprintf(text, size, "the body folds %s: cell %lld at %s is turned over", when, (long long)fold->cell,
                 place);
        return;
    case FOLD_CREASE:
        snprintf(text, size, "the body folds %s: facets of %s that meet at %s pass through each other", when,
                 one, place);
        return;
    case FOLD_CROSSING:
        snprintf(text, size, "the body folds %s: %s at %s goes through %s", when, one, place, other);
        return;
    case FOLD_WITHIN:
        snprintf(text, size, "the body folds %s: cell %lld at %s is within another one", when,
                 (long long)fold->cell, place);
        return;
    case FOLD_REVERSED:
        snprintf(text, size,
                 "the body folds %s: %s at %s is turned over, through the plane that it slides on", when, one,
                 place);
        return;
    case FOLD_FLAT:
        snprintf(
            text, size,
            "%s, cells are inverted between their nodes, by less than a tenth of their size, or flat ones "
            "across which the field bends: %lld, the first one cell %lld at %s",
            when, (long long)fold->count, (long long)fold->cell, place);
        return;
    case FOLD_SUPPORT:
        snprintf(text, size, "%s, %s at %s is beyond the plane of %s, where nothing in the scene stops it",
                 when, one, place, other);
        return;
    case FOLD_CLOSED:
        snprintf(text, size,
                 "%s, %s at %s has creased: there are other states, with more or fewer creases, whose forces "
                 "differ by some percent",
                 when, one, place);
        return;
    case FOLD_WRAPPED:
        snprintf(
            text, size,
            "%s, a lip of another body has turned round the corner of %s at %s, where both ended at rest: "
            "there are other states, with lips elsewhere or none, whose forces differ by some percent",
            when, one, place);
        return;
    case FOLD_NONE:
    default:
        return;
    }
}

/* Whether parts of the boundary pass through each other, which contact stops. */
static bool is_crossed(const struct run *run)
{
    enum fold_kind kind = spell_of(run, FOLDED)->fold.kind;
    return kind == FOLD_CREASE || kind == FOLD_CROSSING || kind == FOLD_WITHIN;
}

/* How many of the scene's contacts let parts of the boundary touch; `whole`: whether one of them lets all. */
static int64_t count_touching(const struct scene *scene, bool *whole)
{
    int64_t count = 0;
    *whole = false;
    for (int64_t c = 0; c < scene->contact_count; c++) {
        const struct name_list *facets = &scene->contacts[c].facets, *against = &scene->contacts[c].against;
        count += against->count > 0;
        *whole = *whole || (against->count > 0 && strcmp(against->names[0], "*") == 0 &&
                            strcmp(facets->names[0], "*") == 0);
    }
    return count;
}

/* Whether a free side has gone through a support and its plane, where a rigid surface would stop it. */
static bool is_through_support(const struct run *run)
{
    const struct fold *fold = &spell_of(run, FOLDED)->fold;
    const bool *held = run->folds.held;
    return spell_of(run, NOTED)->fold.kind == FOLD_SUPPORT && fold->kind == FOLD_CROSSING &&
           (held[fold->facet[0]] || held[fold->facet[1]]);
}

bool run_folds_let_touch(struct run *run)
{
    char text[400];
    bool whole;
    if (run->scene->output.folds_allowed || count_touching(run->scene, &whole) > 0 || !is_crossed(run) ||
        is_through_support(run)) {
        return false;
    }
    run_folds_describe(run, FOLDED, text, sizeof text);
    tool_note(run->tool, "%s: %s: once more, with contact of the body with itself", run->scene->path, text);
    run->again = true;
    return true;
}

bool run_touches_in_part(const struct run *run)
{
    bool whole;
    return count_touching(run->scene, &whole) > 0 && !whole;
}

bool run_folds_touch_in_part(const struct run *run)
{
    bool is_through = is_crossed(run) || spell_of(run, FOLDED)->fold.kind == FOLD_REVERSED;
    return is_through && run_touches_in_part(run);
}

void run_folds_judge(struct run *run)
{
    char text[400];
    run_folds_describe(run, FOLDED, text, sizeof text);
    const char *remedy = "press less, refine there";
    if (spell_of(run, FOLDED)->fold.kind == FOLD_REVERSED) {
        remedy = "let a rigid surface in place of that support stop it, press less";
    }
    if (run_folds_touch_in_part(run)) {
        remedy = "let all of it touch (facets = *, against = *), press less, refine there";
    }
    if (is_through_support(run)) {
        remedy = "let a rigid surface beside the support stop it, press less, refine there";
    }
    if (text[0] == '\0') {
        if (run_stability_describe(run, text, sizeof text)) {
            tool_note(run->tool, "%s: %s", run->scene->path, text);
            text[0] = '\0';
        }
        remedy = "press less, hold it there";
    }
    if (text[0] != '\0' && !run->scene->output.folds_allowed) {
        run->folds.reported = true;
        run->last_good = -1.0; /* the frames are all there */
        run_fail(run, STATUS_VERDICT, "%s: %s: %s, or allow it ([output] folds = allowed)", run->scene->path,
                 text, remedy);
    }
    if (text[0] == '\0') {
        run_folds_describe(run, NOTED, text, sizeof text);
    }
    if (text[0] != '\0') {
        tool_note(run->tool, "%s: %s", run->scene->path, text);
    }
}
