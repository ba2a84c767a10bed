/* Displacements measured at any points of a body: springs for those that are known to a standard deviation,
 * points that contradict each other, and conditions that are nearly linearly dependent.
 *
 * A spring adds a term of weighted least squares to the elastic energy: e (u_h - u)^2 / (2 sigma^2) for a
 * component u that was measured with the standard deviation sigma. The equilibrium is then the most probable
 * displacement, if the error of the scene without the points is a random field whose covariance is e times
 * the compliance A of the body. The scale e is an energy. Its maximum-likelihood value is d . A^-1 d / N; d
 * holds the N differences between the measured components and the solution without the points, and d . A^-1 d
 * is twice the least elastic energy of a displacement d of the points. It is estimated as the energy that
 * moves a ball of radius l, around the points, by s, the root mean square of d, in an incompressible medium
 * (Stokes 1851; in 2D a circle, to leading order, in a body of size L):
 *
 *   e = k s^2 / N,   k = 6 pi mu l,   in 2D 4 pi mu / ln (L / l). (32)
 *
 * A single point thus moves by s^2 / (s^2 + sigma^2) of the measured displacement (Wiener 1949). The springs
 * of N points in a region together are stiffer than the region by the same ratio, s^2 / sigma^2. N is at most
 * the number of nodes that the field at the points is made of. A sigma of s tol^(1/2) leaves a difference
 * from an exact point of a share tol of s; less than that would only make the springs stiffer. */
#pragma once

#include "solid/constraint/constraint.h"

/* Points of a body; the arrays are the caller's. */
struct measured {
    int dim;
    int64_t count;
    const double *x;         /* count * dim: where they are at rest, m */
    const double *u;         /* count * dim: displacement, m; NAN: this component is not known */
    const double *deviation; /* count: of each component, m; 0: exact */
};

/* The quantities that e depends on. */
struct measured_region {
    double shear_modulus; /* mu, Pa: mean at the points */
    double volume;        /* volume of the body for each node: mean at the points, m3 (2D: m2) */
    double body_size;     /* L, m */
    double model_error;   /* s, m */
    int64_t nodes;        /* number of nodes that determine the field at the points */
};

/* e, J (2D: J/m), of the points that are not exact; 0 if there are none. l is the radius of the ball with
 * their radius of gyration, and at least that of a ball with the volume of one node. */
double measured_energy(const struct measured *measured, const struct measured_region *region);

/* Two points, first < second. */
struct measured_pair {
    int64_t first, second; /* -1, -1: none */
    double distance;       /* of the points at rest, m */
    double apart;          /* difference of their displacements, in the components known for both, m */
};

/* Find the exact points, those with the lowest `second`, whose displacements differ by more than their
 * distance: the material between them would be inverted. The time is n log n if displacements are similar.
 * STATUS_SYSTEM: memory. */
MUST_CHECK enum status measured_compare(const struct measured *measured, struct measured_pair *pair,
                                        struct error *error);

/* dependent[rows->count]: rows whose part that is independent of the others is at most a tenth. They would
 * magnify a difference between measurements ten times. */
MUST_CHECK enum status measured_dependent(const struct constraint_rows *rows, int64_t node_count,
                                          bool *dependent, struct error *error);
