/* Messages on folds: where and from when on, at rest and at the end, with the remedy. */
#include "mtled/run.h"

#include <string.h>

/* The name of a group that a facet of the boundary is in, or "the boundary". */
static void name_facet(const struct run *run, int64_t f, char *name, size_t size)
{
    int dim = run->scene->dim;
    FREED_BY(groups_free) struct groups facets = {0};
    struct error ignored;
    int32_t key[3], other[3];
    enum status status = stream_facets(run->stream, false, &facets, &ignored);
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
    bool dynamic = run->scene->analysis == SCENE_DYNAMIC;
    char one[64], other[64] = "", when[96];
    text[0] = '\0';
    if (!folds->seen) {
        return;
    }
    snprintf(when, sizeof when,
             dynamic              ? "from t = %.4g s on"
             : folds->since < 1.0 ? "from %.4g of the load on"
                                  : "at the whole load",
             folds->since);
    snprintf(one, sizeof one, "%lld", (long long)fold->cell);
    if (fold->facet[0] >= 0) {
        name_facet(run, fold->facet[0], one, sizeof one);
    }
    if (fold->kind == FOLD_CROSSING) {
        name_facet(run, fold->facet[1], other, sizeof other);
    }
    snprintf(text, size, "the body folds %s: %s%s at %s%s%s: %spress less, refine there", when,
             words[fold->kind].before, one, POINT_TEXT(run->scene->dim, fold->place),
             words[fold->kind].behind, other,
             words[fold->kind].touches && !touches_itself(run->scene)
                 ? "let it touch itself ([contact] with facets = *, against = *), "
                 : "");
}

void run_folds_judge(struct run *run)
{
    char text[500];
    bool folds = run->folds.seen;
    (folds ? run_folds_describe : run_stability_describe)(run, text, sizeof text);
    if (text[0] == '\0') {
        return;
    }
    if (run->scene->output.folds_allowed) {
        tool_note(run->tool, "%s: %s", run->scene->path, text);
        return;
    }
    run->folds.reported = true;
    run->last_good = -1.0; /* the frames are all there */
    run_fail(run, STATUS_VERDICT, "%s: %s%s, or allow it ([output] folds = allowed)", run->scene->path, text,
             folds ? "" : ": press less, hold it there");
}
