/* Young's modulus and Poisson's ratio from the values of images: from an intensity by a table, or from the
 * probabilities of tissues. */
#pragma once

#include "base/options.h"
#include "base/status.h"
#include "io/files/table.h"

struct tissue {
    struct table law;    /* rows value, E, nu, the values ascending; no rows: probabilities */
    int count;           /* of tissues */
    double (*moduli)[2]; /* count: E, Pa, and nu of each */
};

/* Check that E is positive, and nu within (-1, .5). */
MUST_CHECK enum status moduli_check(const double moduli[2], struct error *error);

/* Read a table of rows value, E (Pa), nu. Errors as table_read; STATUS_INPUT for values that do not ascend,
 * and for invalid moduli. */
MUST_CHECK enum status tissue_read(const char *path, struct tissue *tissue, struct error *error);

/* From the values "E,NU" of an option, one for each tissue. */
MUST_CHECK enum status tissue_parse(int count, const char *const text[], struct tissue *tissue,
                                    struct error *error);

/* moduli[2]: E and nu. With a table: linear between the values of its rows, constant beyond them (*beyond is
 * then incremented). With probabilities value[count]: the means weighted by these, negative ones as 0; false
 * if there is no tissue. */
bool tissue_moduli(const struct tissue *tissue, const double *value, double moduli[2], int64_t *beyond);

void tissue_free(struct tissue *tissue);
