/* Messages on folds, and on states that are not stable: where and when, at rest and at the end, with the
 * remedy. */
#include "mtled/run.h"

#include <string.h>

/* A result is refused if the law is not strongly elliptic in more than this share of the body. It is a few
 * percent if it is so at singular corners only, and half if the body has become irregular. */
static const double most_inelliptic = 0.1;

/* text = when a state is given: "t = 0.1 s", "0.5 of the load" or "the whole load". */
static const char *when_text(const struct run *run, double time, char text[48])
{
    bool dynamic = run->scene->analysis == SCENE_DYNAMIC;
    snprintf(text, 48, dynamic ? "t = %.4g s" : time < 1.0 ? "%.4g of the load" : "the whole load", time);
    return text;
}

static const char *node_text(const struct run *run, int64_t node, char text[96])
{
    return point_text(run->scene->dim, run->model->system.X + node * run->scene->dim, text);
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

void run_folds_at_rest(const struct run *run)
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
    tool_note(run->tool, "%s: %s; later ones are not searched for", run->scene->path, text);
}

/* Whether a contact of the scene lets all of the boundary touch itself. */
static bool touches_itself(const struct scene *scene)
{
    bool whole = false;
    for (int64_t c = 0; c < scene->contact_count; c++) {
        whole = whole ||
                (model_is_whole(&scene->contacts[c].facets) && model_is_whole(&scene->contacts[c].against));
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
             words[fold->kind].touches && !touches_itself(run->scene)
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
    if (text[0] == '\0') {
        return;
    }
    if (run->scene->output.folds_allowed) {
        tool_note(run->tool, "%s: %s", run->scene->path, text);
        return;
    }
    run->folds.reported = true;
    run->last_good = -1.0; /* the frames are all there */
    run_fail(run, STATUS_VERDICT, "%s: %s, or allow it ([output] folds = allowed)", run->scene->path, text);
}

void run_stability_check(struct run *run, double load, bool final)
{
    static const char text[] =
        "%s: at %s, the material law is not strongly elliptic in %.3g %% of the body, as at %s: what it does "
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
        run->last_good = -1.0; /* all frames have been given */
        run_fail(run, STATUS_VERDICT, text, run->scene->path, when_text(run, load, when), 100.0 * found.share,
                 place);
    }
    tool_note(run->tool, text, run->scene->path, when_text(run, load, when), 100.0 * found.share, place);
}

void run_stability_left(const struct run *run)
{
    const struct stability *found = &run->model->system.stability;
    char when[48], place[96];
    if (found->left && !run->folds.seen && !run->stability.seen) {
        tool_note(
            run->tool,
            "%s: at %s the body leaves a state near equilibrium, most of all at %s: it buckles, wrinkles or "
            "snaps through, and the result may be one of several",
            run->scene->path, when_text(run, found->left_load, when),
            node_text(run, found->left_node, place));
    }
}
