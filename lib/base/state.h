/* The state of a run as named arrays, so that it can be saved and restored (checkpoints).
 *
 * Each module that keeps values from step to step has a function MODULE_state that lists them. The same list
 * serves to save and to restore: the visitor either copies the values, or replaces them by those that were
 * saved. What a run computes afresh in each step, or from its input, is no state. */
#pragma once

#include "base/status.h"

#include <stdint.h>

enum state_type {
    STATE_NUMBERS, /* double */
    STATE_COUNTS,  /* int64_t, never negative */
    STATE_FLAGS    /* bool */
};

struct state_value {
    const char *name; /* a letter, then letters, digits, '.', '_', '-'; each but once in a run */
    enum state_type type;
    void *values; /* count */
    int64_t count;
};

struct state {
    enum status (*visit)(void *context, const struct state_value *value, struct error *error);
    void *context;
};

/* Visits the state of *owner. */
typedef enum status state_function(void *owner, const struct state *state, struct error *error);

/* Visit `count` values, with "prefix." in front of their names unless it is NULL. STATUS_INPUT for a restored
 * count that is negative. */
MUST_CHECK enum status state_visit(const struct state *state, const char *prefix,
                                   const struct state_value values[], int64_t count, struct error *error);
