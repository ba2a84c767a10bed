/* Messages on folds: where and from when on, at rest and at the end, with the remedy. */
#include "run/run.h"

#include <string.h>

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

void run_folds_at_rest(const struct run *run)
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

/* That of now, or else that of before. */
static const struct fold_spell *spell_of(const struct run *run, int which)
{
    const struct run_folds *folds = &run->folds;
    return folds->now[which].seen ? &folds->now[which] : &folds->past[which];
}

/* Words for a kind of fold: between the time and the cell or facet, between that and its place, and behind.
 * With `last` the second facet is named, between the two. */
static const struct {
    const char *first, *second, *third, *last;
} words[] = {
    [FOLD_CELL] = {": ", " at ", " is turned over", NULL},
    [FOLD_CREASE] = {": facets of ", " that meet at ", " pass through each other", NULL},
    [FOLD_CROSSING] = {": ", " at ", " goes through ", ""},
    [FOLD_WITHIN] = {": ", " at ", " is within another one", NULL},
    [FOLD_REVERSED] = {": ", " at ", " is turned over, through the plane that it slides on", NULL},
    [FOLD_FLAT] =
        {", cells are inverted between their nodes, by less than a tenth of their size, or flat ones "
         "across which the field bends: ",
         " at ", "", NULL},
    [FOLD_SUPPORT] = {", ", " at ", " is beyond the plane of ", ", where nothing in the scene stops it"},
    [FOLD_CLOSED] =
        {", ", " at ",
         " has creased: there are other states, with more or fewer creases, whose forces differ by "
         "some percent",
         NULL},
    [FOLD_WRAPPED] = {
        ", a lip of another body has turned round the corner of ", " at ",
        ", where both ended at rest: there are other states, with lips elsewhere or none, whose "
        "forces differ by some percent",
        NULL}};

void run_folds_describe(const struct run *run, int which, char *text, size_t size)
{
    const struct fold_spell *spell = spell_of(run, which);
    const struct fold *fold = &spell->fold;
    bool dynamic = run->scene->analysis == SCENE_DYNAMIC;
    char place[96], one[64], other[64] = "", when[96];
    text[0] = '\0';
    if (!spell->seen || fold->kind == FOLD_NONE) {
        return;
    }
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
    if (fold->kind == FOLD_FLAT) {
        snprintf(one, sizeof one, "%lld, the first one cell %lld", (long long)fold->count,
                 (long long)fold->cell);
    } else if (fold->kind == FOLD_CELL || fold->kind == FOLD_WITHIN) {
        snprintf(one, sizeof one, "cell %lld", (long long)fold->cell);
    } else {
        name_facet(run, fold->facet[0], one, sizeof one);
    }
    if (words[fold->kind].last != NULL && fold->facet[1] >= 0) {
        name_facet(run, fold->facet[1], other, sizeof other);
    }
    snprintf(text, size, "%s%s%s%s%s%s%s%s%s", which == FOLDED ? "the body folds " : "", when,
             words[fold->kind].first, one, words[fold->kind].second, place, words[fold->kind].third, other,
             words[fold->kind].last != NULL ? words[fold->kind].last : "");
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
        *whole = *whole || (model_is_whole(against) && model_is_whole(facets));
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
    if (run->again) {
        return true;
    }
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
