/* Compatibility of the smoothed gradients, needed under pressures of the order of the shear modulus and
 * above.
 *
 * A conforming cell's gradient F is the mean of the field's over the cell. Such means are no gradients of one
 * continuous piecewise linear map, so that sum V det F is not the volume that the boundary encloses: under a
 * pressure of some shear moduli the field buckles within the cells and lets volume leak, silently. The
 * gradient F_h of the linear interpolant of the field at a cell's vertices is compatible. The energy sum_q w
 * a_q |F_h - F|^2 / 2 ties the two where a_q, a multiple of the pressure in the cell, makes buckling pay; it
 * vanishes for linear fields, and where there is no pressure. */
#ifndef SOLID_COMPATIBILITY_H
#define SOLID_COMPATIBILITY_H

#include "base/state.h"
#include "solid/means.h"

struct body;

/* The table of shape functions at the nodes, node_ptr[node_count + 1], and the vertices of the cells. */
struct compatibility_input {
    const int32_t *cell_node; /* point_count * (dim + 1), in the caller's order of points */
    const int64_t *node_ptr;
    const int32_t *node_idx;
    const double *node_phi;
};

struct compatibility {
    bool active;         /* some a_q is worth the cost */
    double *coefficient; /* point_count: a_q, Pa */
    struct means nodes;  /* values of the field at the vertices of the cells, used while active */
    double *energy;      /* point_count: w a_q |F_h - F|^2 / 2 at the last evaluation, J */
};

/* For a body of conforming cells. */
MUST_CHECK enum status compatibility_build(const struct body *body, const struct compatibility_input *input,
                                           struct compatibility *compatibility, struct error *error);
void compatibility_free(struct compatibility *compatibility);

/* What the ties keep from step to step: a_q. */
MUST_CHECK enum status compatibility_state(struct body *body, const struct state *state, struct error *error);

/* Set a_q from the pressures of the body's last evaluation. */
void compatibility_update(struct body *body);

/* sum w a |F_h - F|^2 / 2 at the last evaluation, J. */
double compatibility_energy(const struct body *body);

#endif
