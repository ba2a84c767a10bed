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

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct body;

/* What it is made of; the caller's arrays must outlive it. One point per cell. */
struct compatibility_input {
    const double *x;          /* nodes, node_count * dim, m */
    const int32_t *cell_node; /* point_count * (dim + 1), in the caller's order of points */
    const int64_t *node_ptr;  /* node_count + 1: the table of shape functions at the nodes */
    const int32_t *node_idx;
    const double *node_phi;
};

struct compatibility {
    struct compatibility_input input;
    bool active;         /* some a_q is worth the cost */
    int32_t *vertex;     /* point_count * (dim + 1), body's order */
    double *gradient;    /* point_count * (dim + 1) * dim: of the hat functions in each cell, 1/m */
    double *coefficient; /* point_count: a_q, Pa */
    int64_t *use_ptr;    /* node_count + 1: (point, vertex) slots of each node */
    int64_t *use;
    int64_t *back_ptr; /* node_count + 1: the node table transposed: which nodes' values a parameter enters */
    int32_t *back_node;
    double *back_phi;
    double *value;  /* node_count * dim: scratch, the field at the nodes */
    double *pull;   /* node_count * dim: scratch, forces on it */
    double *stress; /* point_count * dim * dim: scratch, w a_q (F_h - F) */
};

MUST_CHECK enum status compatibility_build(const struct body *body, const struct compatibility_input *input,
                                           struct compatibility *compatibility, struct error *error);
void compatibility_free(struct compatibility *compatibility);

/* Set a_q from the pressures of the body's last evaluation. */
void compatibility_update(struct body *body);

/* The phases of an evaluation, each over a range that threads share: values at nodes; stresses at points
 * (after F); pulls at nodes (after stresses); and the force on a parameter, added to force[dim]. */
void compatibility_value(const struct body *body, int64_t node, const double *u);
void compatibility_stress(const struct body *body, int64_t point);
void compatibility_pull(const struct body *body, int64_t node);
void compatibility_add_force(const struct body *body, int64_t node, double *force);

/* sum w a |F_h - F|^2 / 2 at the last evaluation, J. */
double compatibility_energy(const struct body *body);

#endif
