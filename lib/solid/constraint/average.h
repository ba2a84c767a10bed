/* One average of a nodal field, sum_j phi_j u_j over a list of nodes (equation (17) of lib/README.md), and
 * its transpose: conditions, springs, contacts and following pressures act through such averages. */
#pragma once

#include "approx/shape/boundary.h"

#include <stdint.h>

struct average {
    int64_t length;
    const int32_t *idx; /* length: nodes, */
    const double *phi;  /* length: and their weights; both arrays are the caller's */
};

/* Average a of a boundary. */
struct average average_of_boundary(const struct boundary_averages *averages, int64_t a);

/* mean[dim] = sum_j phi_j u_j of u[node_count * dim]. */
void average_take(const struct average *average, int dim, const double *u, double *mean);

/* place[dim] = rest + sum_j phi_j u_j, m: the position of a point that moves with the average, and is at
 * rest[dim] for u = 0. */
void average_place(const struct average *average, int dim, const double *rest, const double *u,
                   double *place);

/* The transpose: u_j += phi_j amount[dim]. */
void average_spread(const struct average *average, int dim, const double *amount, double *u);

/* mass_j += stiffness phi_j^2: what a spring on the average adds to the diagonal of its nodes. */
void average_add_squares(const struct average *average, double stiffness, double *mass);
