#include "solid/compatibility.h"

#include "base/memory.h"
#include "solid/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a_q over the pressure beyond the threshold: buckling stops at about 1 in two dimensions and in three. */
static const double share_of_pressure = 1.0;
/* Pressures below this share of the shear modulus buckle nothing. */
static const double least_pressure = 0.25;
/* Share of the way to its new value that a_q goes at an update: it follows the pressures without ringing. */
static const double follow = 0.2;

enum status compatibility_build(const struct body *body, const struct compatibility_input *input,
                                struct compatibility *compatibility, struct error *error)
{
    enum status status;
    int corners = body->dim + 1;
    int64_t points = body->point_count;
    int32_t *node_of_corner = NULL;
    *compatibility = (struct compatibility){0};
    TRY(NEW_ARRAY(&compatibility->coefficient, points + BODY_POINT_PADDING, error));
    TRY(NEW_ARRAY(&compatibility->energy, points, error));
    TRY(NEW_ARRAY(&node_of_corner, points * corners, error));
    for (int64_t q = 0; q < points; q++) {
        memcpy(node_of_corner + q * corners, input->cell_node + body->order[q] * corners,
               (size_t)corners * sizeof *node_of_corner);
    }
    struct means_input nodes = {.dim = body->dim,
                                .node_count = body->node_count,
                                .row_count = body->node_count,
                                .order = body->node_order,
                                .ptr = input->node_ptr,
                                .idx = input->node_idx,
                                .phi = input->node_phi,
                                .place = body->node_place,
                                .corner_count = points * corners,
                                .row_of_corner = node_of_corner,
                                .single = body->single};
    TRY(means_build(&nodes, &compatibility->nodes, error));
done:
    free(node_of_corner);
    if (status != STATUS_OK) {
        compatibility_free(compatibility);
    }
    return status;
}

void compatibility_free(struct compatibility *compatibility)
{
    means_free(&compatibility->nodes);
    free(compatibility->coefficient);
    free(compatibility->energy);
    *compatibility = (struct compatibility){0};
}

enum status compatibility_state(struct body *body, const struct state *state, struct error *error)
{
    struct compatibility *c = body->compatibility;
    if (c == NULL) {
        return STATUS_OK;
    }
    const struct state_value values[] = {
        {"active", STATE_FLAGS, &c->active, 1},
        {"coefficient", STATE_NUMBERS, c->coefficient, body->point_count},
    };
    return state_visit(state, "ties", values, sizeof values / sizeof *values, error);
}

void compatibility_update(struct body *body)
{
    struct compatibility *c = body->compatibility;
    if (c == NULL) {
        return;
    }
    c->active = false;
    for (int64_t q = 0; q < body->point_count; q++) {
        double beyond = fabs(body_pressure(body, q)) - least_pressure * body->shear[q];
        double wanted = beyond > 0.0 ? share_of_pressure * beyond : 0.0;
        c->coefficient[q] += follow * (wanted - c->coefficient[q]);
        if (c->coefficient[q] < 1e-3 * body->shear[q]) {
            c->coefficient[q] = 0.0;
        }
        c->active = c->active || c->coefficient[q] > 0.0;
    }
}

double compatibility_energy(const struct body *body)
{
    const struct compatibility *c = body->compatibility;
    double energy = 0.0;
    for (int64_t q = 0; c != NULL && c->active && q < body->point_count; q++) {
        energy += c->energy[q];
    }
    return energy;
}
