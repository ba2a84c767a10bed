#include "stages/mls_settings.h"

#include "base/options.h"

#include <stdio.h>

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

void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size)
{
    snprintf(text, size, "%sbasis=%s %sweight=%s %smu_absolute=%d %smu=", prefix, basis_names[mls->basis],
             prefix, weight_names[mls->weight], prefix, mls->mu_absolute, prefix);
    for (int k = 0; k < mls_second_order_count(mls->dim); k++) {
        text_append(text, size, "%s%.17g", k > 0 ? "," : "", mls->mu[k]);
    }
}
