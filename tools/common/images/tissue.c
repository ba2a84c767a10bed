#include "images/tissue.h"

#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum status moduli_check(const double moduli[2], struct error *error)
{
    return moduli[0] > 0 && moduli[1] > -1 && moduli[1] < 0.5
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "E = %g, nu = %g: E must be positive, nu within (-1, .5)",
                      moduli[0], moduli[1]);
}

enum status tissue_read(const char *path, struct tissue *tissue, struct error *error)
{
    struct table *law = &tissue->law;
    *tissue = (struct tissue){0};
    RETURN_IF_ERROR(table_read(path, 3, 3, law, error));
    for (int64_t r = 0; r < law->rows; r++) {
        enum status status = moduli_check(law->values + 3 * r + 1, error);
        if (status == STATUS_OK && r > 0 && !(law->values[3 * r] > law->values[3 * (r - 1)])) {
            status = fail(error, STATUS_INPUT, "the values of the image (first column) must ascend");
        }
        RETURN_IF_ERROR(fail_in(error, status, "%s: line %jd", path, law->line[r]));
    }
    return STATUS_OK;
}

enum status tissue_parse(int count, const char *const text[], struct tissue *tissue, struct error *error)
{
    *tissue = (struct tissue){.count = count};
    RETURN_IF_ERROR(NEW_ARRAY(&tissue->moduli, count, error));
    for (int i = 0; i < count; i++) {
        int numbers;
        RETURN_IF_ERROR(
            parse_double_list(text[i], "--tissue", -DBL_MAX, DBL_MAX, 2, tissue->moduli[i], &numbers, error));
        if (numbers != 2) {
            return fail(error, STATUS_INPUT, "--tissue %s: two numbers, E (Pa) and nu", text[i]);
        }
        RETURN_IF_ERROR(fail_in(error, moduli_check(tissue->moduli[i], error), "--tissue"));
    }
    return STATUS_OK;
}

static void by_law(const struct table *law, double value, double moduli[2], int64_t *beyond)
{
    const double *rows = law->values;
    int64_t last = law->rows - 1, row = 0;
    *beyond += value < rows[0] || value > rows[3 * last];
    while (row < last - 1 && value > rows[3 * (row + 1)]) {
        row++;
    }
    const double *low = rows + 3 * row, *high = last > 0 ? low + 3 : low;
    double share = last > 0 ? fmin(fmax((value - low[0]) / (high[0] - low[0]), 0), 1) : 0;
    for (int i = 0; i < 2; i++) {
        moduli[i] = (1 - share) * low[1 + i] + share * high[1 + i];
    }
}

bool tissue_moduli(const struct tissue *tissue, const double *value, double moduli[2], int64_t *beyond)
{
    double sum = 0;
    if (tissue->law.rows > 0) {
        by_law(&tissue->law, value[0], moduli, beyond);
        return true;
    }
    moduli[0] = moduli[1] = 0;
    for (int i = 0; i < tissue->count; i++) {
        double share = fmax(value[i], 0);
        sum += share;
        moduli[0] += share * tissue->moduli[i][0];
        moduli[1] += share * tissue->moduli[i][1];
    }
    moduli[0] /= sum;
    moduli[1] /= sum;
    return sum > 0;
}

void tissue_free(struct tissue *tissue)
{
    table_free(&tissue->law);
    free(tissue->moduli);
    *tissue = (struct tissue){0};
}
