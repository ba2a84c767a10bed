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

enum { LISTS_FOR_THREAD = 500 }; /* see chunks_of */

/* Rows of G. Row r prescribes direction . (sum_j phi_j u_j) = target * factor(curve, time). The sum is over a
 * list of pairs of a node and its weight. Consecutive rows with the same list share it, so that an average
 * that is prescribed along several directions is computed once. */
struct constraint_rows {
    int dim;
    int64_t count, capacity;
    int64_t list_count;
    int64_t *ptr;   /* list_count + 1: pairs of each list */
    int64_t *first; /* list_count + 1: first row of each list */
    int64_t *list;  /* count: list of each row */
    int64_t pair_capacity;
    int32_t *idx;
    double *phi;
    double *direction; /* count * dim, unit vectors */
    double *target;    /* count, m */
    double
        *start; /* count, m, or NULL: start * factor(start_curve) is added to the target, see system_start */
    int32_t start_curve;
    int32_t *curve;   /* count: which load curve scales the target */
    int32_t *section; /* count: the caller's label, for messages and reactions */
    int32_t *node;    /* count: the node that messages name */
};

void constraint_rows_init(struct constraint_rows *rows, int dim);
void constraint_rows_free(struct constraint_rows *rows);

/* Append a row over `length` pairs. */
MUST_CHECK enum status constraint_rows_add(struct constraint_rows *rows, int64_t length, const int32_t *idx,
                                           const double *phi, const double *direction, double target,
                                           int32_t curve, int32_t section, int32_t node, struct error *error);

/* The average that row r prescribes. */
struct average constraint_rows_average(const struct constraint_rows *rows, int64_t r);

/* The lists as rows of a sparse matrix, over so many nodes. */
struct sparse constraint_rows_lists(const struct constraint_rows *rows, int64_t node_count);

/* What row r prescribes at these values of the load curves, m. */
double constraint_rows_target(const struct constraint_rows *rows, int64_t r, const double *factor);

/* direction . (sum_j phi_j u_j) of row r. */
double constraint_rows_value(const struct constraint_rows *rows, int64_t r, const double *u);

/* value[r] = the same for each row r of the lists from `begin` to before `end`. */
void constraint_rows_take(const struct constraint_rows *rows, int64_t begin, int64_t end, const double *u,
                          double *value);

/* The transpose G^T, by nodes. */
struct constraint_nodes {
    const struct constraint_rows *rows; /* the caller's; must outlive this */
    struct sparse lists;                /* a row for each node: the lists that it is in, and its weights */
    bool *used;                         /* list_count: lists that have nodes here */
    double *on_list;                    /* list_count * dim: scratch */
};

/* Weights are divided by mass[node_count], unless it is NULL. If wanted[node_count] is not NULL, nodes n
 * without wanted[n] have empty rows. */
MUST_CHECK enum status constraint_nodes_build(const struct constraint_rows *rows, int64_t node_count,
                                              const double *mass, const bool *wanted,
                                              struct constraint_nodes *nodes, struct error *error);
void constraint_nodes_free(struct constraint_nodes *nodes);

/* u_j += sum_r amount_r phi_j direction_r / mass_j, summed in the order of the lists. Threaded. */
void constraint_nodes_spread(const struct constraint_nodes *nodes, const double *amount, double *u);

/* The factored system. */
struct constraint {
    int64_t node_count;
    const struct constraint_rows *rows; /* the caller's; must outlive the constraint */
    const double *mass;                 /* node_count; the caller's; NULL: 1 */
    struct constraint_nodes nodes;      /* transpose of the rows, over the mass */
    struct envelope factor;
    double *multiplier; /* count: of the last projection, N s2 in the step's scaling */
};

/* Factor G M^-1 G^T, M diagonal. Linearly dependent rows are dropped (factor.dropped). A dropped row holds if
 * its target is consistent with those of the others (constraint_violation); it has no force until
 * constraint_share_out. */
MUST_CHECK enum status constraint_build(const struct constraint_rows *rows, int64_t node_count,
                                        const double *mass, struct constraint *constraint,
                                        struct error *error);
void constraint_free(struct constraint *constraint);

/* Only factor G M^-1 G^T, M diagonal; `least` as of envelope_factorise. */
MUST_CHECK enum status constraint_factorise(const struct constraint_rows *rows, int64_t node_count,
                                            const double *mass, double least, struct envelope *factor,
                                            struct error *error);

/* u += M^-1 G^T multiplier such that G u = target * factor[curve]. With factor == NULL the targets are zero.
 */
void constraint_project(struct constraint *constraint, const double *factor, double *u);

/* force[count]: the forces of the rows, zero for dropped rows, are replaced by those with the same nodal
 * forces and the least norm sum_r (G M^-1 G^T)_rr force_r^2. So linearly dependent rows share their force. */
MUST_CHECK enum status constraint_share_out(const struct constraint *constraint, double *force,
                                            struct error *error);

/* Largest |target * factor - G u|, m; *row, unless NULL, receives its row. */
double constraint_violation(const struct constraint *constraint, const double *factor, const double *u,
                            int64_t *row);
