/* What friction holds of a contact: allocated, freed, in checkpoints. */
#include "solid/contact/friction.h"

#include "base/memory.h"
#include "solid/contact/contact_between.h"

#include <stdlib.h>
#include <string.h>

enum status friction_build(struct contact *contact, double coefficient, double stiffer, bool follows,
                           struct error *error)
{
    int64_t count = contact->count, places = contact->between != NULL ? count : 0, dim = contact->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&contact->friction, 1, error));
    struct contact_friction *friction = contact->friction;
    friction->coefficient = coefficient;
    friction->follows = follows;
    RETURN_IF_ERROR(NEW_ARRAY(&friction->stiffness, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->yield, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->lag, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->anchor, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->slips, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->before, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->passed, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->slip, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->facet, places, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->place_facet, places, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->place_weight, places * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&friction->ahead, places * dim, error));
    for (int64_t p = 0; p < count; p++) {
        friction->stiffness[p] = stiffer * contact->stiffness[p];
    }
    for (int64_t i = 0; i < count * dim && contact->between == NULL; i++) {
        friction->anchor[i] = contact->rest[i];
    }
    return STATUS_OK;
}

void friction_free(struct contact *contact)
{
    struct contact_friction *friction = contact->friction;
    if (friction != NULL) {
        FREE_ALL(friction->stiffness, friction->yield, friction->lag, friction->anchor, friction->facet,
                 friction->place_facet, friction->place_weight, friction->ahead, friction->slips,
                 friction->before, friction->passed, friction->slip);
    }
    free(friction);
    contact->friction = NULL;
}

enum status friction_state(struct contact *contact, const char *prefix, const struct state *state,
                           struct error *error)
{
    struct contact_friction *friction = contact->friction;
    int64_t count = contact->count, dim = contact->dim;
    if (friction == NULL) {
        return STATUS_OK;
    }
    const struct state_value values[] = {
        {"friction_yield", STATE_NUMBERS, friction->yield, count},
        {"friction_lag", STATE_NUMBERS, friction->lag, count},
        {"friction_share", STATE_NUMBERS, &friction->share, 1},
        {"friction_lags", STATE_FLAGS, &friction->lags, 1},
        {"friction_anchor", STATE_NUMBERS, friction->anchor, count * dim},
        {"friction_slips", STATE_FLAGS, friction->slips, count},
        {"friction_before", STATE_NUMBERS, friction->before, count * dim},
        {"friction_passed", STATE_NUMBERS, friction->passed, count * dim},
        {"friction_sticks", STATE_FLAGS, &friction->sticks, 1},
        {"friction_dissipated", STATE_NUMBERS, &friction->dissipated, 1},
    };
    const struct state_value places[] = {
        {"friction_facet", STATE_COUNTS, friction->facet, count},
        {"friction_place_facet", STATE_COUNTS, friction->place_facet, count},
        {"friction_place_weight", STATE_NUMBERS, friction->place_weight, count * dim},
        {"friction_ahead", STATE_NUMBERS, friction->ahead, count * dim},
    };
    RETURN_IF_ERROR(state_visit(state, prefix, values, sizeof values / sizeof *values, error));
    if (contact->between == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(state_visit(state, prefix, places, sizeof places / sizeof *places, error));
    for (int64_t p = 0; p < count; p++) {
        int64_t facets = contact->between->opposite.surface.facet_count;
        if (friction->facet[p] > facets || friction->place_facet[p] > facets) {
            return fail(error, STATUS_INPUT, "%s.friction_facet: there is no such facet", prefix);
        }
    }
    return STATUS_OK;
}
