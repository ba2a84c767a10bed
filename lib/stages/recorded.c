/* The settings of supports and shape functions, as attributes of the section of radii. */
#include "stages/mls_settings.h"
#include "stages/stages.h"

#include "base/options.h"

#include <stdio.h>
#include <string.h>

enum { DESCRIPTION = 960 }; /* bytes of the attributes */

/* The attributes that record the settings; rarely used ones only if they are set. */
static void describe(const struct recorded *recorded, char text[DESCRIPTION])
{
    const struct support_options *options = &recorded->support;
    const struct support_options usual = support_defaults(options->mls.dim);
    char mls[DESCRIPTION / 3], shapes[DESCRIPTION / 3], lists[DESCRIPTION / 6] = "";
    mls_describe(&options->mls, "", mls, sizeof mls);
    mls_describe(&recorded->shapes, "", shapes, sizeof shapes);
    bool same = strcmp(mls, shapes) == 0;
    mls_describe(&recorded->shapes, " shape_", shapes, sizeof shapes);
    if (options->least != usual.least || options->most != usual.most || options->widen != usual.widen ||
        options->gradient_bound != usual.gradient_bound) {
        snprintf(lists, sizeof lists, " least=%lld most=%lld widen=%d bound=%.17g", (long long)options->least,
                 (long long)options->most, options->widen, options->gradient_bound);
    }
    snprintf(text, DESCRIPTION, "unit=m reach=%s %s%s%s", visibility_names[options->visibility], mls, lists,
             same ? "" : shapes);
}

/* The settings of shape functions, from attributes with this prefix. */
static enum status read_mls(const struct section *section, const char *prefix, struct mls *mls,
                            struct error *error)
{
    static const char *const keys[] = {"basis", "weight", "mu", "mu_absolute"};
    char value[4][256], key[32];
    struct error own;
    bool given[4];
    for (int k = 0; k < 4; k++) {
        snprintf(key, sizeof key, "%s%s", prefix, keys[k]);
        given[k] = section_attribute(section, key, value[k], sizeof value[k]);
    }
    const struct mls_texts texts = {.basis = given[0] ? value[0] : NULL,
                                    .weight = given[1] ? value[1] : NULL,
                                    .mu = given[2] ? value[2] : NULL};
    enum status status = mls_apply(&texts, mls, &own);
    mls->mu_absolute = given[3] ? strcmp(value[3], "0") != 0 : mls->mu_absolute;
    return status == STATUS_OK ? status : fail(error, status, "%s: %s", section->name, own.text);
}

/* The value of an attribute, and its name for messages; false: there is none. */
static bool find_attribute(const struct section *section, const char *key, char value[64], char what[96])
{
    snprintf(what, 96, "%s: %s", section->name, key);
    return section_attribute(section, key, value, 64);
}

enum status stage_recorded(const struct stream *stream, const char *prefix, int dim,
                           struct recorded *recorded, struct error *error)
{
    struct support_options *options = &recorded->support;
    char name[64], value[64], what[96];
    int choice = VISIBILITY_CELLS;
    int64_t widen = 1;
    snprintf(name, sizeof name, "%s.radius", prefix);
    const struct section *radius = stream_find(stream, name);
    *options = support_defaults(dim);
    recorded->shapes = options->mls;
    if (radius == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stage_sides(stream, prefix, &options->side, error));
    RETURN_IF_ERROR(read_mls(radius, "", &options->mls, error));
    recorded->shapes = options->mls;
    RETURN_IF_ERROR(read_mls(radius, "shape_", &recorded->shapes, error));
    if (find_attribute(radius, "reach", value, what)) {
        RETURN_IF_ERROR(parse_choice(value, what, visibility_names, VISIBILITY_RULE_COUNT, &choice, error));
        options->visibility = (enum visibility_rule)choice;
    }
    const struct {
        const char *key;
        int64_t *count;
    } counts[] = {{"least", &options->least}, {"most", &options->most}, {"widen", &widen}};
    for (int i = 0; i < 3; i++) {
        if (find_attribute(radius, counts[i].key, value, what)) {
            RETURN_IF_ERROR(parse_integer(value, what, 0, 1000000, counts[i].count, error));
        }
    }
    options->widen = widen != 0;
    if (find_attribute(radius, "bound", value, what)) {
        RETURN_IF_ERROR(parse_double(value, what, 1.0, 1e6, &options->gradient_bound, error));
    }
    return STATUS_OK;
}

enum status stage_record(struct stream *stream, const struct recorded *recorded, int64_t node_count,
                         const double *radius, struct error *error)
{
    char described[DESCRIPTION];
    describe(recorded, described);
    return stream_put_copy(stream, "support.radius", TYPE_F8, node_count, 1, described, radius, error);
}
