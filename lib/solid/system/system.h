/* A scene ready for time stepping: a body, its loads, constraints and contacts, on the parameters of its
 * nodes.
 */
#pragma once

#include "solid/body/body.h"
#include "solid/constraint/constraint.h"
#include "solid/contact/contact.h"
#include "solid/system/curve.h"

/* A dead load: forces on the parameters, scaled by a load curve. */
struct dead_load {
    double *force; /* node_count * dim, N (2D: N/m) */
    int32_t curve;
};

/* The part of a fluid whose pressure acts: below its level; above it, where the pressure is negative; or all.
 */
enum fluid_part { FLUID_BELOW, FLUID_ABOVE, FLUID_ALL };

/* A pressure on facets that follows the deformation: it acts on the deformed facets, whose corners move with
 * the field at the nodes, and is transferred by the facets' own quadrature, as the cells' gradients are made,
 * so that under a constant pressure the linear patch test holds. */
struct pressure_load {
    int64_t facet_count;
    const int32_t *facet;             /* facet_count * dim, oriented outward; the caller's */
    struct boundary_averages corners; /* node values on the set: where corners are */
    int32_t *corner;                  /* facet_count * dim: the entry of each corner */
    struct boundary_averages
        points;       /* values at the quadrature points, as many for each facet: what carries it */
    double pressure;  /* Pa, positive pushes inward */
    bool is_fluid;    /* then instead: */
    double weight[3]; /* of a fluid, density times gravity, N/m3: the pressure grows along it, */
    double level[3];  /* from 0 at the level of this point, m */
    enum fluid_part part;
    int32_t curve;
};

/* Wall time spent so far on the parts of a scene, s. */
struct cost {
    double force, loads, contact, constraints;
};

/* The least eigenvalue of M^-1 K at the last equilibrium, see solid/preconditioner/frequency.h. */
struct stability {
    double least; /* by the largest; negative: the state is not stable. 0: not looked for, or lost in
                     round-off */
    int64_t node; /* negative: where its mode moves most */
};

struct condition;

struct solid_system {
    int dim;
    int64_t node_count;
    const double *X; /* reference coordinates, node_count * dim, m; the caller's */
    struct body body;
    const struct neighbours *node_lists; /* values of the shape functions at the nodes, the caller's; NULL: */
    const double *node_phi;              /* not known */
    bool has_flat_cells;                 /* 2D: half of the cells or more, see assembly.c */
    struct dead_load *loads;
    int64_t load_count;
    struct pressure_load *pressures;
    int64_t pressure_count;
    struct contact *contacts;
    struct boundary_averages *contact_points, *contact_averages; /* contact_count: what the contacts act on,
                                                                    and their nodal averages (may be empty) */
    int64_t contact_count;
    struct constraint_rows rows;
    const struct condition *conditions; /* of the rows, for messages; the caller's; NULL: not known */
    /* Penalty stabilisation of the constraints. Boundary averages do not constrain variations of the field
     * within them, which grow under a pressure of some ten shear moduli. Constraint penalties at the
     * quadrature points of the constrained facets hold the field to the same targets. Their forces vanish
     * where the field meets these, so that a linear field stays exact. */
    struct constraint_rows penalties;
    struct constraint_nodes penalty_nodes; /* what they put on nodes, of several processes on own ones */
    int64_t spring_count; /* the last of the penalties: they hold measured points and back no condition */
    double *penalty_stiffness; /* penalties.count, N/m (2D: N/m2) */
    double *penalty_force;     /* penalties.count: scratch */
    struct load_curve *curves;
    int64_t curve_count;
    double *lumped_mass; /* node_count, kg (2D: kg/m), positive: each cell shares its mass among its nodes */
    double *factor;      /* curve_count: scratch, values of the curves */
    struct stability stability;
    struct cost cost;
};

void system_free(struct solid_system *system);

/* The state that the system keeps from step to step, its contacts included. */
MUST_CHECK enum status system_state(struct solid_system *system, const struct state *state,
                                    struct error *error);

/* Let a quasi-static run begin from parameters u[node_count * dim] near its result, as of a coarser cloud, at
 * the whole load: the curves stay at their values at the end, and what each row of the conditions prescribes
 * goes from what u has there to its target. To be called before the first evaluation. STATUS_SYSTEM: memory.
 */
MUST_CHECK enum status system_start(struct solid_system *system, const double *u, struct error *error);

/* Values of all curves at s within [0, 1], into system->factor. */
void system_load_factors(struct solid_system *system, double s);

/* Factor the conditions with a mass, to which the constraint keeps a pointer; `inverse` and `inverse_rows` as
 * for constraint_build. Linearly dependent conditions are dropped; STATUS_VERDICT, naming sections, node and
 * place, when they are inconsistent. */
MUST_CHECK enum status system_constrain(const struct solid_system *system, const double *mass,
                                        const struct inverse_factor *inverse,
                                        const struct constraint_rows *inverse_rows,
                                        struct constraint *constraint, struct error *error);

/* force[node_count * dim] += dead loads and pressures at system->factor, at parameters u. */
void system_add_loads(const struct solid_system *system, const double *u, double *force);

/* residual[node_count * dim] = loads at system->factor + contact - internal forces, at parameters u. */
struct deformation system_residual(struct solid_system *system, const double *u, double *residual);

/* Accept the state that was evaluated last as the next step: see contact_accept. Evaluations alone change no
 * state. */
void system_accept(struct solid_system *system);

/* Leaves a system without contacts. */
void system_free_contacts(struct solid_system *system);

/* contact_augment, the largest contact_miss, and the sum of contact_missing_work, of all contacts. */
void system_augment_contacts(struct solid_system *system, bool steady);

/* Make penalties stiffer where multipliers demand it (contact_stiffen); whether any became so. */
bool system_stiffen_contacts(struct solid_system *system);
double system_contact_miss(const struct solid_system *system);
double system_missing_work(const struct solid_system *system);

/* Gaps and pressures of the contacts at parameters u and system->factor, see contact_measure. Other
 * evaluations between may have left those of another state. */
void system_measure_contacts(struct solid_system *system, const double *u, bool all);

/* The largest displacement that a condition or a moving rigid surface prescribes, at factor 1, m. */
double system_longest_way(const struct solid_system *system);

/* That on the way of a run: begun by system_start, from what the start has to the targets, m. */
double system_longest_change(const struct solid_system *system);

/* force[node_count * dim] = internal forces of body and constraint penalties at u: minus the residual without
 * loads and contacts. */
void system_resist(struct solid_system *system, const double *u, double *force);

/* Forces of the constraint penalties, added to force, of several processes to that of own nodes; and their
 * energy. */
void system_add_penalties(struct solid_system *system, const double *u, double *force);
double system_penalty_energy(const struct solid_system *system, const double *u);

/* Append a constraint penalty; the arguments are those of constraint_rows_add, and its stiffness, N/m. */
MUST_CHECK enum status system_append_penalty(struct solid_system *system, const struct average *average,
                                             const double *direction, double target, int32_t curve,
                                             int32_t section, int32_t node, double stiffness,
                                             struct error *error);

/* Build the transpose of the penalties, once all have been appended. */
MUST_CHECK enum status system_share_penalties(struct solid_system *system, struct error *error);

/* Force of constraint penalty r at u along its direction, N (2D: N/m). */
double system_penalty_force(const struct solid_system *system, int64_t r, const double *u);

/* Whether relaxations have an inverse factor (inverse_stiffness.h): with smoothed cells and values at the
 * nodes, in three dimensions, and in two if cells are flat. Elsewhere in two, where supports are narrow, it
 * saves fewer steps than it costs where lips press on each other. */
bool system_has_inverse(const struct solid_system *system);

/* Mass for relaxation: a bound of each node's stiffness, N/m, so that all parts of the body have about the
 * same critical step (1) however the cloud is graded; contact penalties included. mass[node_count] > 0. With
 * an inverse factor, which contains the stiffness at rest, it is that of the cells at each node by their
 * linear shape functions, of which only the change since rest matters; `rest`: at rest. */
void system_relaxation_mass(struct solid_system *system, bool rest, double *mass);

/* Mean spacing of the nodes, m. */
double system_node_spacing(const struct solid_system *system);
