/* Essential boundary conditions on fields whose shape functions do not interpolate (EBCIEM: Joldes,
 * Chowdhury, Wittek and Miller 2017): after the free explicit update u, the correction M^-1 G^T (G M^-1
 * G^T)^-1 (t - G u) makes the constrained averages G u meet their targets t exactly. Each row of G is one
 * average along one direction. Equations (17) and (18) of lib/README.md. */
#pragma once

#include "base/envelope.h"
#include "base/sparse.h"
#include "base/status.h"
#include "solid/constraint/average.h"

#include <stdbool.h>
#include <stdint.h>

enum { LISTS_FOR_THREAD = 500 }; /* of rows; see chunks_of */

/* The rows while they are collected. Row r prescribes direction . (sum_j phi_j u_j) = target * factor(curve,
 * time), where the sum is over the pairs of a list. Rows that follow each other share a list where they can:
 * an average that is held along several directions is taken once. */
struct constraint_rows {
    int dim;
    int64_t count, capacity;
    int64_t list_count;
    int64_t *ptr;   /* list_count + 1: pairs of each list */
    int64_t *first; /* list_count + 1: its rows */
    int64_t *list;  /* count: that of each row */
    int64_t pair_capacity;
    int32_t *idx;
    double *phi;
    double *direction; /* count * dim, unit vectors */
    double *target;    /* count, m */
    double *start; /* count; or NULL: m, is added to the target times factor(start_curve), see system_start */
    int32_t start_curve;
    int32_t *curve;   /* count: which load curve scales the target */
    int32_t *section; /* count: the caller's label, for messages and reactions */
    int32_t *node;    /* count: the node it stands for, for messages */
};

void constraint_rows_init(struct constraint_rows *rows, int dim);
void constraint_rows_free(struct constraint_rows *rows);

/* Append a row over `length` pairs. */
MUST_CHECK enum status constraint_rows_add(struct constraint_rows *rows, int64_t length, const int32_t *idx,
                                           const double *phi, const double *direction, double target,
                                           int32_t curve, int32_t section, int32_t node, struct error *error);

/* The average that row r prescribes. */
struct average constraint_rows_average(const struct constraint_rows *rows, int64_t r);

/* What row r prescribes at these values of the load curves, m. */
double constraint_rows_target(const struct constraint_rows *rows, int64_t r, const double *factor);

/* direction . (sum_j phi_j u_j) of row r. */
double constraint_rows_value(const struct constraint_rows *rows, int64_t r, const double *u);

/* value[r] = the same for all rows r of the lists from `begin` to before `end`. */
void constraint_rows_take(const struct constraint_rows *rows, int64_t begin, int64_t end, const double *u,
                          double *value);

/* The transpose, by nodes. */
struct constraint_nodes {
    const struct constraint_rows *rows; /* the caller's; must outlive this */
    struct sparse lists;                /* a row for each node: the lists that it is in, and its weights */
    bool *used;                         /* list_count: lists that have nodes here */
    double *on_list;                    /* list_count * dim: scratch */
};

/* Weights are divided by mass[node_count] unless that is NULL. With wanted[node_count] other than NULL, only
 * the nodes n with wanted[n] have rows. */
MUST_CHECK enum status constraint_nodes_build(const struct constraint_rows *rows, int64_t node_count,
                                              const double *mass, const bool *wanted,
                                              struct constraint_nodes *nodes, struct error *error);
void constraint_nodes_free(struct constraint_nodes *nodes);

/* u_j += amount_r phi_j direction_r, over the mass: in the order of the lists. Threaded. */
void constraint_nodes_spread(const struct constraint_nodes *nodes, const double *amount, double *u);

struct inverse_factor;

/* The factored system. */
struct constraint {
    int64_t node_count;
    const struct constraint_rows *rows;         /* the caller's; must outlive the constraint */
    const double *mass;                         /* node_count; the caller's */
    const struct inverse_factor *inverse;       /* NULL; or M^-1 = L^T D^-1 L with this L, and D in `mass`, */
    const struct constraint_rows *inverse_rows; /* and the rows G L^T; both the caller's */
    double *scratch;                            /* 2 * node_count * dim, with these */
    struct constraint_nodes nodes;              /* of inverse_rows, or else of `rows`, over D; of several
                                                   processes of the nodes that own rows of L^T need */
    struct envelope factor;
    const struct ranks
        *ranks;           /* processes that share `inverse`, and what follows; NULL: one. Of each process */
    int64_t *list_first;  /* the lists whose averages it takes, */
    int64_t *row_first;   /* their rows, */
    int64_t *place_first; /* and the stretch of the factor that it solves with */
    double *multiplier;   /* count: of the last projection, N s2 in the step's scaling */
};

/* Factor G M^-1 G^T; `inverse` and `inverse_rows` NULL: M is diagonal. Linearly dependent rows are dropped
 * (factor.dropped). They hold if their targets are consistent with those of the others
 * (constraint_violation), and have no force before constraint_share_out. */
MUST_CHECK enum status constraint_build(const struct constraint_rows *rows, int64_t node_count,
                                        const double *mass, const struct inverse_factor *inverse,
                                        const struct constraint_rows *inverse_rows,
                                        struct constraint *constraint, struct error *error);
void constraint_free(struct constraint *constraint);

/* value[rows->count] = G u, and x := (G M^-1 G^T)^-1 x. Of several processes all call these together. */
void constraint_values(const struct constraint *constraint, const double *u, double *value);
void constraint_solve(const struct constraint *constraint, double *x);

/* u += M^-1 G^T amount[rows->count] */
void constraint_spread(const struct constraint *constraint, const double *amount, double *u);

/* G M^-1 G^T alone, dropping rows of pivots below `least`, see envelope_factorise. */
MUST_CHECK enum status constraint_factorise(const struct constraint_rows *rows, int64_t node_count,
                                            const double *mass, double least, struct envelope *factor,
                                            struct error *error);

/* u += M^-1 G^T multiplier such that G u = target * factor[curve]. With factor == NULL the targets are zero.
 */
void constraint_project(struct constraint *constraint, const double *factor, double *u);

/* force[count]: the forces of the rows, zero on the rows that were dropped, are replaced by those with the
 * same nodal forces and the least norm sum_r (G M^-1 G^T)_rr force_r^2, so that dependent rows share the
 * force. */
MUST_CHECK enum status constraint_share_out(const struct constraint *constraint, double *force,
                                            struct error *error);

/* Largest |target * factor - G u|, m; *row, unless NULL, receives where. */
double constraint_violation(const struct constraint *constraint, const double *factor, const double *u,
                            int64_t *row);
