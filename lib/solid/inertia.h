/* The fictitious mass of a relaxation: a preconditioner, since a state at rest does not depend on the mass
 * (dynamic relaxation: Underwood 1983; equation (23) of lib/README.md).
 *
 * With a diagonal mass D that bounds the stiffness of each node, a load spreads by about one support in a
 * step, and modes as large as the body decide how many steps are needed. On a few smooth fields Z (fields.h)
 * the mass is therefore the stiffness itself: with the projection P onto moves that the conditions admit, and
 * A near P^T K P along the fields,
 *
 *   M^-1 = P (D^-1 + Z A^-1 Z^T) P^T
 * where, with the conditions' rows G and S = G D^-1 G^T, P^T f = f - G^T S^-1 G D^-1 f; so one look at G D^-1
 * f tells both the fields' amounts and the conditions' forces. Also
 *
 *   x . M y = x . D y - (Z^T D x) . (A + Z^T D P Z)^-1 (Z^T D y)   for moves x, y that the conditions admit,
 *
 * so that the slowest modes left are those that the fields do not resolve. In the terms of linear systems, a
 * two-level additive preconditioner with deflated constraints. Any positive definite A is sound; what it has
 * of the contacts must follow them, because a mode that suddenly becomes stiff would be unstable. */
#ifndef SOLID_INERTIA_H
#define SOLID_INERTIA_H

#include "base/state.h"
#include "solid/fields.h"
#include "solid/system.h"

struct inertia {
    int dim;
    int64_t node_count;
    double *mass;                 /* node_count: D, N/m (2D: N/m2) */
    struct constraint constraint; /* with D */
    struct fields fields;         /* count 0: none, M = D */
    int64_t size;                 /* fields.count * dim: rows and columns of the matrices */
    double *body;         /* stiffness of body and springs along the fields, P Z e_k, N/m (2D: N/m2) */
    double measured_mass; /* sum of D when it was measured */
    bool floats;          /* the conditions leave the body free to move as a whole */
    bool *touching;       /* hats of all contacts: those that A counts in, */
    double *normal;       /* hat_count * dim: and the surface's normals there */
    int64_t hat_count;
    double *weight;      /* Z^T D Z */
    double *free_weight; /* Z^T D P Z */
    double *held; /* rows of the conditions * size: (G D^-1 G^T)^-1 G Z, what they put against each field */
    double *inverse; /* A^-1 */
    double *beside;  /* (A + Z^T D P Z)^-1 */
    double *amount;  /* 2 * size: scratch */
};

/* Memory and fields for a system; `coarse` false: no fields. */
MUST_CHECK enum status inertia_build(const struct solid_system *system, bool coarse, struct inertia *inertia,
                                     struct error *error);
void inertia_free(struct inertia *inertia);

/* Set D from the system's last evaluation, and what depends on it. */
MUST_CHECK enum status inertia_set_mass(struct inertia *inertia, const struct solid_system *system,
                                        const double *mass, struct error *error);

/* Measure the stiffness along the fields at u, by differences: size + 1 evaluations of the body, whose last
 * evaluation is then another. Follows the contacts. */
MUST_CHECK enum status inertia_measure(struct inertia *inertia, struct solid_system *system, const double *u,
                                       struct error *error);

/* Whether D has changed so much that the fields should be measured again. */
bool inertia_is_stale(const struct inertia *inertia);

/* Let A follow the contacts' last evaluation: hats that begin to touch are counted in at once, those that are
 * no longer near are left out when `leave`. True when M has changed. */
bool inertia_follow(struct inertia *inertia, const struct solid_system *system, bool leave);

/* acceleration = M^-1 force. */
void inertia_accelerate(struct inertia *inertia, const double *force, double *acceleration);

/* x . D y */
double inertia_product_alone(const struct inertia *inertia, const double *x, const double *y);

/* x . M y of moves that the conditions admit. */
double inertia_product(const struct inertia *inertia, const double *x, const double *y);

/* What another run needs to go on: see base/state.h. Afterwards, in a run that was restored, inertia_restore.
 */
MUST_CHECK enum status inertia_state(struct inertia *inertia, const struct state *state, struct error *error);
MUST_CHECK enum status inertia_restore(struct inertia *inertia, const struct solid_system *system,
                                       struct error *error);

#endif
