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
 * the number of nodes that the field at the points is made of. */
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
    double volume;        /* of the body that a node stands for: mean, m3 (2D: m2) */
    double body_size;     /* L, m */
    double model_error;   /* s, m */
    int64_t nodes;        /* that the field at the points is made of */
};

/* e, J (2D: J/m), by the points that are not exact; l is the radius of the ball with the same radius of
 * gyration, at least that of the ball that a node stands for. 0 without such points. */
double measured_energy(const struct measured *measured, const struct measured_region *region);

/* Two points, first < second. */
struct measured_pair {
    int64_t first, second; /* -1, -1: none */
    double distance;       /* of the points at rest, m */
    double apart;          /* difference of what is known of both displacements, m */
    int64_t count;         /* of all pairs of this kind */
};

/* Pairs whose displacements differ by more than their distance and six standard deviations of the difference:
 * what lies between them would be turned over. Of exact points (both), and of others; the first of each by
 * `second`. Exact points at one place, to `same` m, that know a component both are `repeated`, and in no
 * other list if they agree. Time n log n where displacements are alike. STATUS_SYSTEM: memory. */
MUST_CHECK enum status measured_compare(const struct measured *measured, double same,
                                        struct measured_pair *exact, struct measured_pair *others,
                                        struct measured_pair *repeated, struct error *error);

/* dependent[rows->count]: rows of which the part that is independent of the others is at most a tenth, so
 * that a difference between measurements would be magnified ten times beside them. */
MUST_CHECK enum status measured_dependent(const struct constraint_rows *rows, int64_t node_count,
                                          bool *dependent, struct error *error);
