#include "approx/weight.h"

#include "approx/weight_formulas.h"

const char *const weight_names[WEIGHT_COUNT] = {"quartic", "cubic", "wendland", "regularised"};

void weight_evaluate(enum weight_function function, double r2, double *value, double *slope_over_r)
{
    switch (function) {
    case WEIGHT_CUBIC:
        weight_cubic(r2, value, slope_over_r);
        return;
    case WEIGHT_WENDLAND:
        weight_wendland(r2, value, slope_over_r);
        return;
    case WEIGHT_REGULARISED:
        weight_regularised(r2, value, slope_over_r);
        return;
    case WEIGHT_QUARTIC:
    case WEIGHT_COUNT:
        break;
    }
    weight_quartic(r2, value, slope_over_r);
}
