#include "solid/system/rigid_modes.h"

#include "approx/cells/cells.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = EIGEN_MOST };
/* A row constrains a rigid mode if its value for the mode is at least this share of the sum of its
 * weights. */
static const double least_value = 1e-4;
/* Least rotation, squared, of what is named a rotation: one about an axis a hundred sizes of the body away is
 * more likely a translation along facets. */
static const double least_turn2 = 1e-4;
/* What the conditions hold of the motions of a part, as coefficients of its rigid modes, and the motions that
 * they leave free. */
struct part {
    struct box box;                       /* around its nodes */
    double held[MOST_MODES * MOST_MODES]; /* sum over rows of v^2, with the value v of a motion for the row by
                                             the sum of its weights */
    double area; /* of curved sides, sum of A_f; and with the value v_f of a motion */
    double correlation[MOST_MODES * MOST_MODES]; /* along the normal at the middle of facet f, sum of A_f (v^2
                                                    at the nodes - v_f^2 / 2), where v at a node is the mean
                                                    over its facets */
    int count;
    double basis[MOST_MODES][MOST_MODES]; /* count: orthonormal free motions */
};

struct parts {
    const struct solid_system *system;
    const int32_t *of_node; /* node_count */
    struct part *part;      /* count */
};

static int mode_count(int dim)
{
    return dim == 2 ? 3 : MOST_MODES;
}

static double middle(const struct box *box, int a)
{
    return 0.5 * (box->low[a] + box->high[a]);
}

/* Rigid mode k at X, of the order of 1: translations, then rotations about the centre, in 3D about the axes
 * z, x, y. */
static void rigid_mode(const struct box *box, int k, const double *X, double mode[3])
{
    int dim = box->dim;
    memset(mode, 0, 3 * sizeof *mode);
    if (k < dim) {
        mode[k] = 1.0;
        return;
    }
    int a = k - dim, b = (a + 1) % dim; /* turns a towards b */
    double side = box_side(box);
    mode[a] = -(X[b] - middle(box, b)) / side;
    mode[b] = (X[a] - middle(box, a)) / side;
}

/* matrix += factor v v^T */
static void add_square(int n, double factor, const double *v, double *matrix)
{
    for (int k = 0; k < n; k++) {
        add_scaled(n, factor * v[k], v, matrix + k * n);
    }
}

/* The average of row r does not move along the row's direction. A row is on nodes of one part. */
static void hold_row(struct parts *parts, const struct constraint_rows *rows, int64_t r)
{
    struct average average = constraint_rows_average(rows, r);
    int dim = parts->system->dim, modes = mode_count(dim);
    struct part *part = &parts->part[parts->of_node[average.idx[0]]];
    double weights = 0.0, mode[3], value[MOST_MODES] = {0.0};
    for (int64_t i = 0; i < average.length; i++) {
        for (int k = 0; k < modes; k++) {
            rigid_mode(&part->box, k, parts->system->X + (int64_t)average.idx[i] * dim, mode);
            value[k] += average.phi[i] * vector_dot(dim, rows->direction + r * dim, mode);
        }
        weights += fabs(average.phi[i]);
    }
    add_square(modes, 1.0 / (weights * weights), value, part->held);
}

/* The rows of conditions but for those on curved sides, and the springs. */
static void hold_rows(struct parts *parts)
{
    const struct solid_system *system = parts->system;
    const struct sliding *sliding = &system->sliding;
    const struct constraint_rows *rows = &system->rows, *springs = &system->springs.rows;
    for (int64_t r = 0, curved = 0; r < rows->count; r++) {
        if (curved < sliding->row_count && sliding->row[curved] == r) {
            curved++;
        } else {
            hold_row(parts, rows, r);
        }
    }
    for (int64_t r = 0; r < springs->count; r++) {
        hold_row(parts, springs, r);
    }
}

/* v[k] = rigid mode k of its part along the normal at the middle of a facet, which is added to those
 * measured. Returns the size of the facet. */
static double add_facet(struct parts *parts, const int32_t *node, double *v)
{
    int dim = parts->system->dim, modes = mode_count(dim);
    struct part *part = &parts->part[parts->of_node[node[0]]];
    double area[3], centre[3], mode[3];
    face_area_vector(dim, parts->system->X, node, area);
    double size = vector_length(dim, area);
    vector_middle(dim, parts->system->X, dim, node, centre);
    for (int k = 0; k < modes; k++) {
        rigid_mode(&part->box, k, centre, mode);
        v[k] = vector_dot(dim, area, mode) / size;
    }
    add_square(modes, -0.5 * size, v, part->correlation);
    part->area += size;
    return size;
}

/* Measure the motions of the parts along the normals of curved sides. */
static enum status measure_curved(struct parts *parts, struct error *error)
{
    const struct solid_system *system = parts->system;
    const struct sliding *sliding = &system->sliding;
    int dim = system->dim, modes = mode_count(dim);
    NEW_SCRATCH(double, sum, system->node_count * modes, error);
    NEW_SCRATCH(double, weight, system->node_count, error);
    for (int64_t f = 0; f < sliding->facet_count; f++) {
        const int32_t *node = sliding->facet[f].node;
        double v[MOST_MODES], size = add_facet(parts, node, v);
        for (int k = 0; k < dim; k++) {
            add_scaled(modes, size / dim, v, sum + (int64_t)node[k] * modes);
            weight[node[k]] += size / dim;
        }
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        if (weight[n] > 0.0) {
            add_square(modes, 1.0 / weight[n], sum + n * modes, parts->part[parts->of_node[n]].correlation);
        }
    }
    return STATUS_OK;
}

/* Keep of the free motions of a part those for which the form is at most `most`. */
static void keep_free(int modes, struct part *part, const double *form, double most)
{
    int n = part->count;
    double reduced[MOST_MODES * MOST_MODES] = {0.0}, value[MOST_MODES], vector[MOST_MODES * MOST_MODES];
    double kept[MOST_MODES][MOST_MODES] = {{0.0}};
    for (int i = 0; i < n * n; i++) {
        for (int k = 0; k < modes; k++) {
            reduced[i] += part->basis[i / n][k] * vector_dot(modes, form + k * modes, part->basis[i % n]);
        }
    }
    eigen_symmetric(n, reduced, value, vector);
    part->count = 0;
    for (int k = 0; k < n; k++) {
        for (int i = 0; i < n && value[k] <= most; i++) {
            add_scaled(modes, vector[i * n + k], part->basis[i], kept[part->count]);
        }
        part->count += value[k] <= most;
    }
    memcpy(part->basis, kept, sizeof kept);
}

/* Append a rotation with the coefficients `mode`: its axis, and a point on it. */
static void put_rotation(const struct box *box, const double *mode, struct rigid_modes *modes)
{
    int dim = box->dim;
    double w[3] = {0.0, 0.0, 0.0}, t[3] = {mode[0], mode[1], dim == 3 ? mode[2] : 0.0};
    double *axis = modes->axis[modes->turns], *through = modes->through[modes->turns];
    for (int k = dim; k < mode_count(dim); k++) {
        w[(k - dim + 2) % 3] = mode[k] / box_side(box);
    }
    double length2 = vector_dot(3, w, w);
    for (int a = 0; a < 3; a++) { /* where t + w x (p - centre) = 0 */
        int b = (a + 1) % 3, c = (a + 2) % 3;
        axis[a] = w[a] / sqrt(length2);
        through[a] = (a < dim ? middle(box, a) : 0.0) + (w[b] * t[c] - w[c] * t[b]) / length2;
    }
    modes->turns++;
}

/* Split the free modes of a part into translations, and rotations orthogonal to these. */
static void split_modes(int dim, const struct part *part, struct rigid_modes *modes)
{
    int n = mode_count(dim), count = part->count;
    double turning[MOST_MODES * MOST_MODES] = {0.0}, mix[MOST_MODES * MOST_MODES], turned[MOST_MODES];
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) {
            for (int a = dim; a < n; a++) {
                turning[i * count + k] += part->basis[i][a] * part->basis[k][a];
            }
        }
    }
    eigen_symmetric(count, turning, turned, mix);
    for (int k = 0; k < count; k++) {
        double mode[MOST_MODES] = {0.0};
        for (int i = 0; i < count; i++) {
            for (int a = 0; a < n; a++) {
                mode[a] += mix[i * count + k] * part->basis[i][a];
            }
        }
        if (turned[k] > least_turn2) {
            put_rotation(&part->box, mode, modes);
        } else {
            memcpy(modes->along[modes->translations++], mode, (size_t)dim * sizeof *mode);
        }
    }
}

static void parts_free(struct parts *parts)
{
    free(parts->part);
}

/* Keep the motions of a part along its curved facets, or its whole surface. Facets approximate a surface: a
 * motion along it has values on them that are not 0 but change their sign from facet to facet. Such a motion
 * is free: more than half of the mean square of its values vanishes where the values of facets that meet are
 * averaged. */
static void keep_along(int modes, struct part *part)
{
    if (part->area > 0.0) {
        keep_free(modes, part, part->correlation, least_value * least_value * part->area);
    }
}

/* Find the parts and their free motions. */
static enum status find_free(struct parts *parts, int32_t part_count, struct error *error)
{
    const struct solid_system *system = parts->system;
    int dim = system->dim, count = mode_count(dim);
    RETURN_IF_ERROR(NEW_ARRAY(&parts->part, part_count, error));
    for (int32_t p = 0; p < part_count; p++) {
        parts->part[p].box = box_of(dim, 0, NULL);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        box_add(&parts->part[parts->of_node[n]].box, 1, system->X + n * dim);
    }
    hold_rows(parts);
    RETURN_IF_ERROR(measure_curved(parts, error));
    for (int32_t p = 0; p < part_count; p++) {
        struct part *own = &parts->part[p];
        for (own->count = 0; own->count < count; own->count++) {
            own->basis[own->count][own->count] = 1.0;
        }
        keep_free(count, own, own->held, least_value * least_value);
        keep_along(count, own);
    }
    return STATUS_OK;
}

enum status system_rigid_modes(const struct solid_system *system, int32_t part_count, const int32_t *part,
                               struct rigid_modes *modes, struct error *error)
{
    FREED_BY(parts_free) struct parts parts = {.system = system, .of_node = part};
    memset(modes, 0, (size_t)part_count * sizeof *modes);
    RETURN_IF_ERROR(find_free(&parts, part_count, error));
    for (int32_t p = 0; p < part_count; p++) {
        for (int a = 0; a < system->dim; a++) {
            modes[p].centre[a] = middle(&parts.part[p].box, a);
        }
        split_modes(system->dim, &parts.part[p], &modes[p]);
    }
    return STATUS_OK;
}

/* Measure the motions of the parts along their whole surface instead. At a sharp edge the facets of either
 * side have an average of their own. */
static enum status measure_surface(struct parts *parts, int32_t part_count, const struct facet_set *surface,
                                   int per_face, const struct boundary_averages *averages,
                                   struct error *error)
{
    int dim = parts->system->dim, modes = mode_count(dim);
    NEW_SCRATCH(double, v, surface->count * modes, error);
    for (int32_t p = 0; p < part_count; p++) {
        memset(parts->part[p].correlation, 0, sizeof parts->part[p].correlation);
        parts->part[p].area = 0.0;
    }
    for (int64_t f = 0; f < surface->count; f++) {
        add_facet(parts, surface->facet + f * dim, v + f * modes);
    }
    for (int64_t a = 0; a < averages->count; a++) {
        double mean[MOST_MODES] = {0.0};
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            add_scaled(modes, averages->sample_share[s], v + averages->sample_point[s] / per_face * modes,
                       mean);
        }
        add_square(modes, averages->area[a], mean,
                   parts->part[parts->of_node[averages->node[a]]].correlation);
    }
    return STATUS_OK;
}

/* Make the motions of a part orthonormal by the products of the rigid modes; those that depend on others
 * become 0. */
static void orthonormalise(int modes, const double *square, struct part *part)
{
    for (int k = 0; k < part->count; k++) {
        for (int i = 0; i <= k; i++) {
            double product = 0.0;
            for (int m = 0; m < modes; m++) {
                product += part->basis[k][m] * vector_dot(modes, square + m * modes, part->basis[i]);
            }
            double factor = i < k ? -product : product > DBL_EPSILON ? 1.0 / sqrt(product) - 1.0 : -1.0;
            add_scaled(modes, factor, part->basis[i], part->basis[k]);
        }
    }
}

/* Keep of the free motions of a part those along its surface; each with what it needs of the others to be
 * orthogonal, at the nodes, to all that turn about no axis of these. */
static void keep_turns(const struct parts *parts, int32_t p)
{
    const struct solid_system *system = parts->system;
    int dim = system->dim, modes = mode_count(dim);
    struct part *part = &parts->part[p], all = *part;
    double square[MOST_MODES * MOST_MODES] = {0.0}, mode[MOST_MODES][3];
    keep_along(modes, part);
    if (part->count == 0) {
        return;
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        for (int k = 0; k < modes && parts->of_node[n] == p; k++) {
            rigid_mode(&part->box, k, system->X + n * dim, mode[k]);
        }
        for (int i = 0; i < modes * modes && parts->of_node[n] == p; i++) {
            square[i] += vector_dot(dim, mode[i / modes], mode[i % modes]);
        }
    }
    orthonormalise(modes, square, &all);
    for (int k = 0; k < part->count; k++) {
        double turn[MOST_MODES] = {0.0};
        for (int i = 0; i < all.count; i++) {
            double share = vector_dot(modes - dim, all.basis[i] + dim, part->basis[k] + dim);
            add_scaled(modes, share, all.basis[i], turn);
        }
        memcpy(part->basis[k], turn, sizeof turn);
    }
    orthonormalise(modes, square, part);
}

enum status system_find_turns(struct solid_system *system, int32_t part_count, const int32_t *part,
                              const int32_t *alike, const struct facet_set *surface, int per_face,
                              const struct boundary_averages *averages, struct error *error)
{
    FREED_BY(parts_free) struct parts parts = {.system = system, .of_node = part};
    struct sparse *turns = &system->turns;
    int dim = system->dim, modes = mode_count(dim);
    NEW_SCRATCH(int32_t, first, part_count + 1, error);
    RETURN_IF_ERROR(find_free(&parts, part_count, error));
    RETURN_IF_ERROR(measure_surface(&parts, part_count, surface, per_face, averages, error));
    for (int32_t p = 0; p < part_count; p++) {
        parts.part[p].count *= alike[p] > 0;
        keep_turns(&parts, p);
        first[p + 1] = first[p] + parts.part[p].count;
    }
    int64_t rows = first[part_count] > 0 ? system->node_count * dim : 0, at = 0;
    RETURN_IF_ERROR(sparse_new(rows, first[part_count], rows * (modes - dim), turns, error));
    for (int64_t r = 0; r < rows; r++) {
        const struct part *own = &parts.part[part[r / dim]];
        for (int k = 0; k < own->count; k++) {
            turns->idx[at] = first[part[r / dim]] + k;
            for (int m = 0; m < modes; m++) {
                double mode[3];
                rigid_mode(&own->box, m, system->X + r / dim * dim, mode);
                turns->value[at] += own->basis[k][m] * mode[r % dim];
            }
            at++;
        }
        turns->ptr[r + 1] = at;
    }
    return STATUS_OK;
}
