/* Settings of supports and shape functions: as options of command lines, and as attributes of the section of
 * radii; and those of the field that mtled computed. */
#include "stages/stages.h"

#include "approx/support/support.h"
#include "base/options.h"

#include <stdio.h>
#include <string.h>

enum { DESCRIPTION = 960 }; /* bytes of the attributes */

static enum status apply_mu(const char *text, struct mls *mls, struct error *error)
{
    int count, wanted = mls_second_order_count(mls->dim);
    RETURN_IF_ERROR(parse_double_list(text, "--mu", 0.0, 1e300, MLS_MAX_SECOND, mls->mu, &count, error));
    bool fits = mls->dim == 0 ? count == 3 || count == 6 : count == wanted;
    if (count != 1 && !fits && mls->dim == 0) {
        return fail(error, STATUS_INPUT, "--mu: %d values; give one, or in 2D 3, in 3D 6", count);
    }
    if (count != 1 && !fits) {
        return fail(error, STATUS_INPUT, "--mu: %d values; in %dD give one, or %d", count, mls->dim, wanted);
    }
    for (int k = count; k < MLS_MAX_SECOND; k++) {
        mls->mu[k] = mls->mu[count - 1];
    }
    return STATUS_OK;
}

enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error)
{
    int choice;
    if (texts->basis != NULL) {
        RETURN_IF_ERROR(parse_choice(texts->basis, "-b", basis_names, BASIS_COUNT, &choice, error));
        mls->basis = (enum basis)choice;
    }
    if (texts->weight != NULL) {
        RETURN_IF_ERROR(parse_choice(texts->weight, "-w", weight_names, WEIGHT_COUNT, &choice, error));
        mls->weight = (enum weight_function)choice;
    }
    if (texts->mu != NULL) {
        mls->mu_absolute = false;
        RETURN_IF_ERROR(apply_mu(texts->mu, mls, error));
    }
    if (texts->mu_unit != NULL) {
        double unit;
        if (texts->mu == NULL) {
            return fail(error, STATUS_INPUT, "--mu-unit: needs --mu");
        }
        RETURN_IF_ERROR(parse_length_unit(texts->mu_unit, "--mu-unit", &unit, error));
        /* mu is used as mu / s^4 with s in this unit. */
        for (int k = 0; k < MLS_MAX_SECOND; k++) {
            mls->mu[k] *= unit * unit * unit * unit;
        }
        mls->mu_absolute = true;
    }
    return STATUS_OK;
}

/* text[size] = "basis=mmls2 weight=quartic mu_absolute=0 mu=1e-07,1e-07,1e-07", each key with the prefix. */
static void describe_mls(const struct mls *mls, const char *prefix, char *text, size_t size)
{
    snprintf(text, size, "%sbasis=%s %sweight=%s %smu_absolute=%d %smu=", prefix, basis_names[mls->basis],
             prefix, weight_names[mls->weight], prefix, mls->mu_absolute, prefix);
    for (int k = 0; k < mls_second_order_count(mls->dim); k++) {
        text_append(text, size, "%s%.17g", k > 0 ? "," : "", mls->mu[k]);
    }
}

/* The attributes that record the settings; rarely used ones only if they are set. */
static void describe(const struct field_shapes *recorded, char text[DESCRIPTION])
{
    const struct support_options *options = &recorded->support;
    const struct support_options usual = support_defaults(options->mls.dim);
    char mls[DESCRIPTION / 3], shapes[DESCRIPTION / 3], lists[DESCRIPTION / 6] = "", constant[40] = "";
    describe_mls(&options->mls, "", mls, sizeof mls);
    describe_mls(&recorded->shapes, "", shapes, sizeof shapes);
    bool same = strcmp(mls, shapes) == 0;
    describe_mls(&recorded->shapes, " shape_", shapes, sizeof shapes);
    if (options->least != usual.least || options->most != usual.most || options->widen != usual.widen ||
        options->gradient_bound != usual.gradient_bound) {
        snprintf(lists, sizeof lists, " least=%jd most=%jd widen=%d bound=%.17g", options->least,
                 options->most, options->widen, options->gradient_bound);
    }
    if (options->radius > 0.0) {
        snprintf(constant, sizeof constant, " constant=%.17g", options->radius);
    }
    snprintf(text, DESCRIPTION, "unit=m reach=%s%s%s%s %s%s%s", visibility_names[options->visibility],
             recorded->supports.stretch != NULL ? " stretch=yes" : "",
             recorded->supports.side_count > 0 ? " sides=yes" : "", constant, mls, lists, same ? "" : shapes);
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

enum status stage_recorded(const struct stream *stream, const char *prefix, struct field_shapes *recorded,
                           struct error *error)
{
    struct support_options *options = &recorded->support;
    char name[64], value[64];
    int dim, choice = VISIBILITY_CELLS;
    int64_t widen = 1;
    const struct section *radius;
    snprintf(name, sizeof name, "%s.radius", prefix);
    RETURN_IF_ERROR(stream_nodes(stream, &dim, NULL, NULL, error));
    *recorded = (struct field_shapes){.support = support_defaults(dim)};
    recorded->shapes = options->mls;
    if (stream_find(stream, name) == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, name, &radius, error));
    RETURN_IF_ERROR(stream_supports(stream, prefix, &recorded->supports, error));
    RETURN_IF_ERROR(stage_sides(stream, prefix, &options->side, error));
    RETURN_IF_ERROR(read_mls(radius, "", &options->mls, error));
    recorded->shapes = options->mls;
    RETURN_IF_ERROR(read_mls(radius, "shape_", &recorded->shapes, error));
    if (section_attribute(radius, "reach", value, sizeof value)) {
        RETURN_IF_ERROR(parse_choice(value, name, visibility_names, VISIBILITY_RULE_COUNT, &choice, error));
        options->visibility = (enum visibility_rule)choice;
    }
    const struct {
        const char *key;
        int64_t *count;
    } counts[] = {{"least", &options->least}, {"most", &options->most}, {"widen", &widen}};
    for (int i = 0; i < 3; i++) {
        if (section_attribute(radius, counts[i].key, value, sizeof value)) {
            RETURN_IF_ERROR(parse_integer(value, name, 0, 1000000, counts[i].count, error));
        }
    }
    options->widen = widen != 0;
    if (section_attribute(radius, "bound", value, sizeof value)) {
        RETURN_IF_ERROR(parse_double(value, name, 1.0, 1e6, &options->gradient_bound, error));
    }
    if (section_attribute(radius, "constant", value, sizeof value)) {
        RETURN_IF_ERROR(parse_double(value, name, 0.0, 1e300, &options->radius, error));
    }
    return STATUS_OK;
}

enum status stage_record(struct stream *stream, const struct field_shapes *recorded, int64_t node_count,
                         struct error *error)
{
    char described[DESCRIPTION];
    describe(recorded, described);
    RETURN_IF_ERROR(stream_put_copy(stream, "support.radius", TYPE_F8, node_count, 1, described,
                                    recorded->supports.radius, error));
    const struct supports *supports = &recorded->supports;
    int dim = recorded->support.mls.dim;
    RETURN_IF_ERROR(supports->stretch != NULL
                        ? stream_put_copy(stream, "support.stretch", TYPE_F8, node_count, dim * dim, "",
                                          supports->stretch, error)
                        : STATUS_OK);
    return supports->side_count > 0 ? stream_put_copy(stream, "support.sides", TYPE_F8, supports->side_count,
                                                      SIDE_COLUMNS(dim), "unit=m", supports->sides, error)
                                    : STATUS_OK;
}

/* ---- the field that mtled computed ---- */

static const char parameters[] = "parameters";

const struct section *solved_parameters(const struct stream *stream, const struct field_shapes *recorded,
                                        const struct section *field)
{
    char name[96];
    if (recorded->supports.radius == NULL ||
        (strcmp(field->name, "u") != 0 && strncmp(field->name, "u.frame.", 8) != 0)) {
        return field;
    }
    snprintf(name, sizeof name, "%s%s", parameters, field->name + 1);
    const struct section *found = stream_find(stream, name);
    bool fits = found != NULL && found->type == field->type && found->rows == field->rows &&
                found->cols == field->cols;
    return fits ? found : field;
}

bool solved_is_parameters(const struct section *section)
{
    size_t length = strlen(parameters);
    return strncmp(section->name, parameters, length) == 0 &&
           (section->name[length] == '\0' || section->name[length] == '.');
}
