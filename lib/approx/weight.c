#include "approx/weight.h"

#include "approx/weight_formulas.h"

const char *const weight_names[WEIGHT_COUNT] = {"quartic", "regularised"};

void weight_evaluate(enum weight_function function, double r2, double *value, double *slope_over_r)
{
    if (function == WEIGHT_REGULARISED) {
        weight_regularised(r2, value, slope_over_r);
        return;
    }
    weight_quartic(r2, value, slope_over_r);
}
