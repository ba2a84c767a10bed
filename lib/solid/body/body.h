/* A body laid out for the force loop, equation (12) of lib/README.md: integration points in blocks of one
 * law, ordered along a Morton curve, and the sparse operator that makes their deformation gradients from
 * parameters: gradients of the shape functions at the points or, for smoothed cells, averages over their
 * faces (smoothed_cells.h). Total Lagrangian: all of it in the reference configuration (MTLED: Horton et al.
 * 2010). Any number of threads gives the same bits (base/sparse.h). */
#pragma once

#include "approx/support/support.h"
#include "base/status.h"
#include "solid/body/body_share.h"
#include "solid/body/prony.h"
#include "solid/body/smoothed_cells.h"
#include "solid/body/stiffening.h"
#include "solid/material/material.h"
#include "solid/operators/row_operator.h"

#include <stdbool.h>
#include <stdint.h>

/* The input of body_build, in the caller's arrays. */
struct body_input {
    struct cells cells;        /* nodes, m, and background cells; dim 2: plane strain */
    const struct faces *faces; /* smoothed cells, one point each, in their order: all faces, with their edges;
                                  NULL: any points */
    int64_t point_count;
    const double *x;      /* points, point_count * dim, m */
    const double *weight; /* point_count, m2 or m3 */
    const int32_t *cell;  /* point_count: of each point, for nodal volumes; NULL: the pointwise volumetric law
                             throughout */
    /* Shape functions: gradients at the points, 1/m; or of smoothed cells values on edges and at the nodes.
     */
    const struct neighbours *lists, *node_lists;
    const double *dphi, *phi, *node_phi;
    void (*copied)(void *context); /* called when the lists and phi of edges are no longer needed, and their
                                      memory has been released (memory_give_back); or NULL. Several
                                      processes need them until the body is freed, and it is not called */
    void *context;
    const struct material *materials;
    const int32_t *material; /* point_count, index into materials */
    int64_t material_count;
    const int32_t *group; /* material_count: volumes are averaged over the materials of a group, such as those
                             of a region with a table; NULL: each by itself */
    const int32_t
        *junction;       /* point_count: of cells at a junction of prescribed and free boundary a number of
                            the part of the junction, >= 0; -1: of others (merged_cells.h); NULL: none */
    const bool *at_edge; /* node_count: nodes that own no nodal volume (nodal_volume.h); NULL: none */
    const struct ranks *ranks; /* processes that compute the body together; NULL: one */
};

/* Points are processed in groups of this size. weight, material, J and F are padded by as many entries, which
 * are read but not used. */
#define BODY_POINT_PADDING 8

/* The most points of a block. */
#define BLOCK_MOST_POINTS 128

struct block {
    int64_t first_point, point_count; /* in the body's order */
    int64_t boundary_face; /* the first boundary face of these cells, or of later ones (field_averages.h) */
    bool neo_hookean;      /* all its points; else the general law */
    bool relaxes;          /* all its points are viscoelastic; else none is */
    double least_jacobian; /* at the last evaluation, and where, in the body's order */
    int64_t worst_point;
    double energy, dissipated; /* at the last call of body_energy, J (2D: J/m) */
};

/* The matrix A of the nodal pressures, m3/Pa (2D: m2/Pa), and how A^-1 is applied: see nodal_pressure.c. */
struct nodal_pressures {
    struct sparse matrix;
    double *inverse; /* of each row: S^-1; 0 where nothing carries pressure; */
    double *held;    /* pressure of the last augmentation, Pa; */
    double *change;  /* what the last augmentation changed it by, Pa; */
    double *weight;  /* by which it counts, m3/Pa (2D: m2/Pa): 0 without a limit */
    bool limited;    /* some weights are not 0 */
    int64_t *entry;  /* scratch, as */
    double *scratch; /* 3 of each row */
    int iterations;
    double centre, half, scale; /* of the interval of eigenvalues of S^-1 A; of the sum */
    double most;                /* bulk modulus by shear modulus */
    double slowest;             /* rate of augmentations where the body is confined: 1 - limited / bulk */
    double least_shear;         /* of the materials, Pa */
};

/* Nodal volumes, whose pressures resist changes of volume: see nodal_volume.h. */
struct nodal_volumes {
    int64_t count;
    int32_t *of_point; /* point_count * (dim + 1): the nodal volume at each vertex of a point's cell */
    double *share;   /* point_count * (dim + 1): its part of the point's volume, N_a(q) w_q, m3 (2D: m2); 0 of
                        points whose material is too compressible for nodal pressures */
    int64_t *ptr;    /* count + 1 */
    int32_t *slot;   /* ptr[count]: the places of a nodal volume in these two, ascending */
    double *change;  /* point_count: J - 1 at the last evaluation */
    double *direct;  /* point_count: what s acts on: y, or near edges means of it; NULL: no edges, y itself */
    double *modulus; /* count: S of nodal volumes that have a cell at an edge, N m (2D: N); 0 of others; */
    double *mean;    /* and Y of these, 0 of others */
    double *content; /* count: b, m3 (2D: m2) */
    double *slope;   /* count: y' at the mean J; NULL: all are 1, as no law is in ln J */
    double *pressure; /* count: pi, Pa */
    struct nodal_pressures pressures;
};

struct body {
    int dim;
    int64_t node_count, point_count;
    int64_t pair_count; /* of point and neighbour; of smoothed cells, of face or node and neighbour */
    struct {
        int64_t *points; /* point_count: the caller's index of each point; */
        int64_t *nodes;  /* node_count: that of each node; */
        int32_t *places; /* node_count: the body's index of each of the caller's nodes */
    } order;
    double *weight;                    /* point_count */
    struct material *materials;        /* material_count */
    const double *const *load_factors; /* present values of the load curves, set by the caller after
                                          body_build: of active stresses; NULL: there are none */
    int64_t material_count;
    int32_t *material; /* point_count */
    int64_t block_count;
    struct block *blocks;
    struct body_share share; /* what this process computes of several; rows that others do are empty */
    bool smoothed;
    struct row_operator rows; /* gradients of the shape functions: row q dim + k has the derivatives along k
                                 at point q; or of smoothed cells field_averages.h */
    double *derivative;       /* du/dx_k, or the stress, of each row: VECTOR_STRIDE(dim) of each; */
    struct smoothed_cells cells; /* or smoothed cells instead */
    double *u, *force;  /* node_count * VECTOR_STRIDE(dim): displacements and forces in the body's order */
    double *F;          /* dim * dim rows of point_count: deformation gradients of the last evaluation */
    double *J;          /* point_count: volume ratios, det F, or of cells that of smoothed_cells.h */
    struct prony prony; /* histories of viscoelastic points */
    struct stiffening stiffening;
    bool averaged; /* nodal volumetric averaging */
    struct nodal_volumes volumes;
    int threads; /* worth using for so many pairs */
};

/* Lay out a body; the arrays are copied. STATUS_INPUT for a point without neighbours
 * or of no weight, and see smoothed_cells_build. */
MUST_CHECK enum status body_build(const struct body_input *input, struct body *body, struct error *error);
void body_free(struct body *body);

/* Of smoothed cells: the row of the value at a node, in the body's order. */
static inline int64_t body_node_row(const struct body *body, int64_t node)
{
    return body->cells.averages.row_count - body->node_count + node;
}

/* How far an evaluation is from inversion. */
struct deformation {
    double least_jacobian; /* least det F, or volume ratio of a cell */
    int64_t point;         /* where, in the caller's order */
};

/* force[node_count * dim] = internal forces - grad_u of the energy - at the parameters u[node_count * dim];
 * N, in 2D N/m. With an inverted point the forces mean nothing. */
struct deformation body_force(struct body *body, const double *u, double *force);

/* Whether the field of u itself, without what is prescribed (prescribed_values.h), inverts a cell. */
bool body_inverts(struct body *body, const double *u, double *force);

/* body_own_force: the same for the nodes of this process only. body_gather completes on all processes a
 * vector[node_count * width], width <= dim, of which each has the values at its own nodes. */
struct deformation body_own_force(struct body *body, const double *u, double *force);
void body_gather(struct body *body, int width, double *vector);

/* Limit the bulk modulus to `most` shear moduli; INFINITY: no limit. Augmentations of the nodal pressures,
 * which begin at zero, supply the rest (augmented Lagrangian: Simo and Taylor 1991). Without nodal volumes
 * this has no effect. */
void body_limit_bulk(struct body *body, double most);
bool body_is_limited(const struct body *body);

/* Augmentation: the nodal pressures of the last evaluation become those of the augmentation. Where the body
 * can change its volume, few augmentations suffice; where it is confined, each one supplies only the share
 * limited / bulk of what the pressures lack. `steady`: the load was the same at the last two augmentations;
 * where their changes form a geometric sequence, and they lack more than `most`, its limit is taken (Aitken's
 * extrapolation). Returns an estimate of what the pressures still lack, relative to the pressures or to the
 * shear stress at `strain`, whichever is larger; INFINITY: not known yet. */
double body_augment(struct body *body, bool steady, double most, double strain);

/* The largest relative lack of the pressures in an accepted state. */
#define NODAL_PRESSURE_LACK 1e-3

/* Whether fibres of a material bear no pressure: see law.h. */
bool body_slackens(const struct body *body);

/* Volume at rest, the sum of the weights of the points, m3 (2D: m2). */
double body_volume(const struct body *body);

/* Elastic energy at u, J (2D: J/m). Of viscoelastic materials what they store; body->prony.dissipated becomes
 * what they have dissipated up to the last accepted state. */
double body_energy(struct body *body, const double *u);

/* The derivative of the energy by the load factor of active stresses, J (2D: J/m), at the deformation
 * evaluated last. */
double body_active_energy(struct body *body, int32_t curve);

/* Viscoelastic materials: a step of dt from the last accepted state begins, 0: a jump; evaluations are then
 * at its end. And the state evaluated last is accepted. Other bodies have no use for either. */
void body_step(struct body *body, double dt);
void body_accept(struct body *body);

/* Collect the histories of all processes, so that each of them may write a checkpoint. */
void body_collect_history(struct body *body);

/* With collected histories: where mu only stabilises, in s of (10), (13) and (14), it becomes that of each
 * material in the last accepted state, by the work of its stress on its strain, with and without memory. */
void body_fade(struct body *body);

/* Let the moduli of (10), (13) and (14) follow the state evaluated last (stiffening.h), unless they would
 * change by less than `most`, by the work. Returns whether they have. */
bool body_stiffen(struct body *body, double most);

/* First Piola stress of each point at the last evaluation: stress[point_count * 9], caller's order, Pa. */
void body_stress(struct body *body, double *stress);

/* F of each point at the last evaluation, gradient[point_count * 9], caller's order. */
void body_gradient(struct body *body, double *gradient);

/* Volume ratio of each point at the last evaluation that its volumetric law takes, ratio[point_count],
 * caller's order: det F, or of smoothed cells that of smoothed_cells.h. */
void body_volume_ratio(struct body *body, double *ratio);

/* The share of the volume whose law is not strongly elliptic at F of the last evaluation (ellipticity.h), and
 * a point there, -1: none; caller's index. */
struct inelliptic {
    double share;
    int64_t point;
};
struct inelliptic body_inelliptic(struct body *body);

/* stiffness[node_count], N/m (2D: N/m2): bounds the diagonal of the stiffness at the last evaluation's F, or
 * with `rest` at F = I, as sum_q w W''(y (x) grad phi), the second derivative of the energy along the
 * rank-one change of F that is stiffest, y = F^-T grad phi; at rest sum_q w (lambda + 2 mu) |grad phi|^2. The
 * neo-Hookean formula serves all materials. Of smoothed cells phi are the linear shape functions, so that the
 * bound holds approximately. A limit of the bulk modulus (body_limit_bulk) counts. Collective. */
void body_diagonal(struct body *body, bool rest, double *stiffness);
