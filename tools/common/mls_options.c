#include "mls_options.h"

#include <stdio.h>
#include <string.h>

static enum status apply_mu(const char *text, struct mls *mls, struct error *error)
{
    int count, wanted = mls_second_order_count(mls->dim);
    enum status status = parse_double_list(text, "--mu", 0.0, 1e300, MLS_MAX_SECOND, mls->mu, &count, error);
    if (status != STATUS_OK) {
        return status;
    }
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

enum status mls_apply_options(const struct option options[MLS_OPTION_COUNT], struct mls *mls,
                              struct error *error)
{
    enum status status = STATUS_OK;
    int choice;
    if (options[0].given) {
        status = parse_choice(options[0].value, "-b", basis_names, BASIS_COUNT, &choice, error);
        if (status != STATUS_OK) {
            return status;
        }
        mls->basis = (enum basis)choice;
    }
    if (options[1].given) {
        status = parse_choice(options[1].value, "-w", weight_names, WEIGHT_COUNT, &choice, error);
        if (status != STATUS_OK) {
            return status;
        }
        mls->weight = (enum weight_function)choice;
    }
    if (options[2].given) {
        mls->mu_absolute = false;
        status = apply_mu(options[2].value, mls, error);
    }
    if (status == STATUS_OK && options[3].given) {
        double unit;
        if (!options[2].given) {
            return fail(error, STATUS_INPUT, "--mu-unit: needs --mu");
        }
        status = parse_length_unit(options[3].value, "--mu-unit", &unit, error);
        /* mu enters as mu / s^4 with s in that unit. */
        for (int k = 0; status == STATUS_OK && k < MLS_MAX_SECOND; k++) {
            mls->mu[k] *= unit * unit * unit * unit;
        }
        mls->mu_absolute = true;
    }
    return status;
}

enum status radius_apply_options(const struct option *factor, const struct option *radius,
                                 struct support_options *support, struct error *error)
{
    if (factor->given && radius->given) {
        return fail(error, STATUS_INPUT, "give one of -k and -R");
    }
    if (factor->given) {
        return parse_double(factor->value, "-k", 0.1, 100, &support->factor, error);
    }
    return radius->given ? parse_length(radius->value, "-R", &support->radius, error) : STATUS_OK;
}

void mls_describe(const struct mls *mls, const char *prefix, char *text, size_t size)
{
    snprintf(text, size, "%sbasis=%s %sweight=%s %smu_absolute=%d %smu=", prefix, basis_names[mls->basis],
             prefix, weight_names[mls->weight], prefix, mls->mu_absolute, prefix);
    for (int k = 0; k < mls_second_order_count(mls->dim); k++) {
        size_t length = strlen(text);
        snprintf(text + length, size - length, "%s%.17g", k > 0 ? "," : "", mls->mu[k]);
    }
}
