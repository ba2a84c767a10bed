#include "base/state.h"

#include <stdio.h>

static enum status check_counts(const struct state_value *value, struct error *error)
{
    const int64_t *counts = value->values;
    for (int64_t i = 0; value->type == STATE_COUNTS && i < value->count; i++) {
        if (counts[i] < 0) {
            return fail(error, STATUS_INPUT, "%s: %jd is negative", value->name, counts[i]);
        }
    }
    return STATUS_OK;
}

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
        RETURN_IF_ERROR(check_counts(&value, error));
    }
    return STATUS_OK;
}
