/* A scene ready for time stepping: a body with its loads, constraints and contacts. The unknowns are the
 * parameters of its nodes. */
#pragma once

#include "base/sparse.h"
#include "solid/body/body.h"
#include "solid/constraint/constraint.h"
#include "solid/contact/contact.h"
#include "solid/system/curve.h"
#include "solid/system/membrane.h"
#include "solid/system/sliding.h"

/* A dead load: forces on the parameters, scaled by a load curve. */
struct dead_load {
    double *force; /* node_count * dim, N (2D: N/m) */
    int32_t curve;
};

/* A following pressure: it acts on the deformed facets, whose corners move with the field at the nodes. The
 * quadrature of the faces (6) transfers it to the parameters, so that the linear patch test holds under a
 * constant pressure. */
struct pressure_load {
    int64_t facet_count;
    const int32_t *facet;             /* facet_count * dim, oriented outward; the caller's */
    struct boundary_averages corners; /* node values on the set */
    int32_t *corner;                  /* facet_count * dim: the entry of each corner in `corners` */
    struct boundary_averages points;  /* values at the quadrature points, equally many for each facet */
    double pressure;                  /* Pa, positive pushes inward */
    bool is_fluid;                    /* instead the pressure of a fluid: */
    double weight[3];                 /* density times gravity, N/m3: the gradient of the pressure, */
    double level[3];                  /* which is 0 at the level of this point, m */
    enum fluid_part part;
    int32_t curve;
};

/* Wall time spent so far, s. */
struct cost {
    double force, loads, contact, constraints;
};

/* The least eigenvalue of M^-1 K at the last equilibrium, see newton_judge_stability; and what was seen on
 * the way, see newton_keep_to_path. */
struct stability {
    double least;      /* relative to the largest; negative: unstable; 0: not computed, or below round-off */
    int64_t node;      /* of an unstable state: where its mode is largest */
    bool left;         /* the body has left a state near equilibrium, */
    double left_load;  /* at this share of the load, */
    int64_t left_node; /* where it moves most */
};

/* Loads, and the membranes that resist them. */
struct acting {
    struct dead_load *loads;
    int64_t load_count;
    struct pressure_load *pressures;
    int64_t pressure_count;
    struct membrane *membranes;
    int64_t membrane_count;
};

/* Springs of supports and of measured points. */
struct springs {
    struct constraint_rows rows;
    struct constraint_nodes nodes; /* their transpose; with several processes for own nodes */
    double *stiffness;             /* rows.count, N/m (2D: N/m2) */
    double *force;                 /* rows.count: scratch */
};

struct condition;

struct solid_system {
    int dim;
    int64_t node_count;
    const double *X; /* reference coordinates, node_count * dim, m; the caller's */
    struct body body;
    const struct neighbours *node_lists; /* shape functions at the nodes, the caller's; NULL: not known */
    const double *node_phi;
    struct acting acting;
    struct contact *contacts;
    struct boundary_averages *contact_points, *contact_averages; /* contact_count: points of the contacts, and
                                                                their nodal averages (may be empty) */
    int64_t contact_count;
    bool floats; /* there are contacts, and the conditions leave a body free to move as a whole */
    struct constraint_rows rows;
    struct sliding sliding;             /* those of the rows along the normals of curved sides */
    const struct condition *conditions; /* of the rows, for messages; the caller's; NULL: not known */
    struct sparse turns;                /* node_count * dim rows: orthonormal motions that statics leaves out,
                                           indifferent rotations (rigid_modes.h); no rows: none */
    struct springs springs;
    struct load_curve *curves;
    int64_t curve_count;
    double *lumped_mass; /* node_count, kg (2D: kg/m), positive: each cell shares its mass among its nodes */
    double *dashpot;     /* node_count, N s/m (2D: N s/m2): of supports, lumped as the mass; NULL: none */
    double *factor;      /* curve_count: scratch, values of the curves */
    struct stability stability;
    struct cost cost;
};

void system_free(struct solid_system *system);

/* Visit the state that the system and its contacts keep from step to step. */
MUST_CHECK enum status system_state(struct solid_system *system, const struct state *state,
                                    struct error *error);

/* Start a quasi-static run from parameters u[node_count * dim] near its result, as of a coarser cloud. The
 * curves keep their values at the end. The value that each row prescribes goes from that of u to its target.
 * Call this before the first evaluation. STATUS_SYSTEM: memory. */
MUST_CHECK enum status system_start(struct solid_system *system, const double *u, struct error *error);

/* The value of a curve at s within [0, 1]; for s from -1 to 0 it grows from 0 to that at 0. Those of all
 * curves, into system->factor. Whether any is not 0 at 0. */
double system_load_factor(const struct solid_system *system, int64_t curve, double s);
void system_load_factors(struct solid_system *system, double s);
bool system_begins_loaded(const struct solid_system *system);

/* constraint_build for the rows of the system; the constraint keeps the pointer to `mass`. Linearly dependent
 * rows are dropped. STATUS_VERDICT, naming sections, node and place, if they are inconsistent with the
 * others. */
MUST_CHECK enum status system_constrain(const struct solid_system *system, const double *mass,
                                        struct constraint *constraint, struct error *error);

/* force[node_count * dim] += dead loads and pressures at system->factor, at parameters u. */
void system_add_loads(const struct solid_system *system, const double *u, double *force);

/* force[node_count * dim] -= internal forces of the membranes at u; returns their energy. force NULL: only
 * that. */
double system_pull_membranes(const struct solid_system *system, const double *u, double *force);

/* residual[node_count * dim] = loads at system->factor + contact - internal forces, at parameters u. */
struct deformation system_residual(struct solid_system *system, const double *u, double *residual);

/* Its two parts: without contacts; and what contacts add to force[node_count * dim]. */
struct deformation system_smooth_residual(struct solid_system *system, const double *u, double *residual);
void system_add_contacts(struct solid_system *system, const double *u, double *force);

/* Let the residual[node_count * dim] of system_smooth_residual at u follow the load from `from` to `to`, at
 * which system->factor is then, without evaluating the body: where the load acts on it from outside alone,
 * that is, no material is active or viscoelastic. scratch: node_count * dim. */
bool system_acts_outside(const struct solid_system *system);
void system_change_load(struct solid_system *system, const double *u, double from, double to, double *scratch,
                        double *residual);

/* Accept the state that was evaluated last as the next step: see contact_accept. Evaluations alone do not
 * change the state. */
void system_accept(struct solid_system *system);

/* Whether the loads have a potential, so that the stiffness is symmetric: at the rim of a part of the
 * boundary a following pressure has none. */
bool system_has_potential(const struct solid_system *system);

/* Whether a contact has friction; functions of friction.h for all contacts; and what friction has dissipated,
 * J (2D: J/m). */
bool system_has_friction(const struct solid_system *system);

/* Whether friction alone may hold a body, which slides if it does not. */
bool system_held_by_friction(const struct solid_system *system);

void system_predict_friction(struct solid_system *system, bool sticks);
void system_relax_friction(struct solid_system *system);
void system_hold_friction(struct solid_system *system, bool sticks);
void system_slide(struct solid_system *system);
double system_friction_work(const struct solid_system *system);

/* Free the contacts; the system then has none. */
void system_free_contacts(struct solid_system *system);

/* contact_augment of all contacts, the largest contact_miss, and the sum of contact_missing_work. */
void system_augment_contacts(struct solid_system *system);
double system_contact_miss(const struct solid_system *system);
double system_missing_work(const struct solid_system *system);

/* The penetration of contacts that an equilibrium may have, m, where a node has moved by `move`; whether
 * there is more at u, or the work of the contact forces along it is more than a share of the elastic energy.
 * A penetration within the tolerance of the displacements cannot be distinguished from their error. */
double system_penetration_allowed(double move);
bool system_contacts_give_way(struct solid_system *system, const double *u, double move, double tolerance);

/* Whether a contact has pressed in an accepted state. */
bool system_has_touched(const struct solid_system *system);

/* contact_stiffen of all contacts; whether any penalty has changed. */
bool system_stiffen(struct solid_system *system);

/* contact_measure of all contacts at parameters u and system->factor. */
void system_measure_contacts(struct solid_system *system, const double *u, bool all);

/* The largest displacement that a condition or a moving rigid surface prescribes, at factor 1, m. */
double system_longest_way(const struct solid_system *system);

/* The width of the narrowest rigid surface, m; INFINITY without any. */
double system_narrowest_tool(const struct solid_system *system);

/* The largest prescribed change during a run, m: after system_start, from the values of the start to the
 * targets. */
double system_longest_change(const struct solid_system *system);

/* force[node_count * dim] = internal forces of body, membranes and springs at u, that is, minus the residual
 * without loads and contacts. */
void system_resist(struct solid_system *system, const double *u, double *force);

/* Add the forces of the springs to force[node_count * dim], with several processes at own nodes; their
 * energy; and the force of spring r along its direction, N (2D: N/m). */
void system_add_springs(struct solid_system *system, const double *u, double *force);
double system_spring_energy(const struct solid_system *system, const double *u);
double system_spring_force(const struct solid_system *system, int64_t r, const double *u);

/* Append a spring: the arguments of constraint_rows_add, and the stiffness, N/m (2D: N/m2). */
MUST_CHECK enum status system_append_spring(struct solid_system *system, const struct average *average,
                                            const double *direction, double target, int32_t curve,
                                            int32_t section, int32_t node, double stiffness,
                                            struct error *error);

/* Build the transpose of the springs, once all have been appended. */
MUST_CHECK enum status system_share_springs(struct solid_system *system, struct error *error);

/* Whether there can be an inverse factor (inverse_stiffness.h): with smoothed cells and node values. */
bool system_has_inverse(const struct solid_system *system);

/* mass[node_count] > 0: the fictitious mass, a bound of each node's stiffness, N/m (2D: N/m2). Without an
 * inverse factor: (24) with springs and the penalties of contacts, so that all parts of the body have
 * about the same critical step, 1, however the cloud is graded. With one: (24) with the linear shape
 * functions of the cells, without these; only its ratio to the value at rest matters. `rest`: at rest. */
void system_relaxation_mass(struct solid_system *system, bool rest, double *mass);

/* Mean spacing of the nodes, m. */
double system_node_spacing(const struct solid_system *system);
