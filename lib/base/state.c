#include "base/state.h"

#include <stdio.h>

enum status state_visit(const struct state *state, const char *prefix, const struct state_value values[],
                        int64_t count, struct error *error)
{
    for (int64_t i = 0; i < count; i++) {
        char name[96];
        struct state_value value = values[i];
        if (prefix != NULL) {
            snprintf(name, sizeof name, "%s.%s", prefix, value.name);
            value.name = name;
        }
        RETURN_IF_ERROR(state->visit(state->context, &value, error));
        for (int64_t k = 0; value.type == STATE_COUNTS && k < value.count; k++) {
            if (((const int64_t *)value.values)[k] < 0) {
                return fail(error, STATUS_INPUT, "%s: %jd is negative", value.name,
                            ((const int64_t *)value.values)[k]);
            }
        }
    }
    return STATUS_OK;
}
