#include "solid/system/rigid_modes.h"

#include "approx/cells/cells.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "base/null_space.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = EIGEN_MOST };
/* A row constrains a rigid mode if its value for the mode is at least this share of the sum of its
 * weights. */
static const double least_value = 1e-4;
/* Least squared singular value of a free motion of a part. */
static const double least_share2 = 1e-8;
/* Least rotation, squared, of what is named a rotation: one about an axis a hundred sizes of the body away is
 * more likely a translation along facets. */
static const double least_turn2 = 1e-4;
/* Most coupled free motions that are kept. */
enum { MOST_FREE = 300 };

/* The motions of the parts of a body that conditions leave free, as coefficients of the rigid modes of each
 * part. */
struct parts {
    const struct solid_system *system;
    int32_t count;
    const int32_t *of_node; /* node_count; NULL: all nodes are of part 0 */
    struct box *box;        /* count: around the nodes of each */
    struct null_space space;
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

static int32_t part_of(const struct parts *parts, int32_t node)
{
    return parts->of_node == NULL ? 0 : parts->of_node[node];
}

/* Add to the condition that is collected: `factor` times the motion of a node along a direction, as a node of
 * part p. */
static void add_node(struct parts *parts, int32_t p, int32_t node, double factor, const double *direction)
{
    int dim = parts->system->dim, modes = parts->space.columns[p] > 0 ? mode_count(dim) : 0; /* 0: held */
    double mode[3], value[MOST_MODES] = {0.0};
    for (int k = 0; k < modes; k++) {
        rigid_mode(&parts->box[p], k, parts->system->X + (int64_t)node * dim, mode);
        value[k] = vector_dot(dim, direction, mode);
    }
    null_space_add(&parts->space, p, factor, value);
}

/* Impose that the average of row r does not move along the row's direction. */
static enum status hold_row(struct parts *parts, const struct constraint_rows *rows, int64_t r,
                            struct error *error)
{
    struct average average = constraint_rows_average(rows, r);
    double weights = 0.0;
    for (int64_t i = 0; i < average.length; i++) {
        int32_t node = average.idx[i];
        add_node(parts, part_of(parts, node), node, average.phi[i], rows->direction + r * parts->system->dim);
        weights += fabs(average.phi[i]);
    }
    return null_space_impose(&parts->space, least_value * weights, error);
}

/* Impose the rows of conditions, but not yet those on curved sides, and the springs. */
static enum status hold_rows(struct parts *parts, struct error *error)
{
    const struct solid_system *system = parts->system;
    const struct sliding *sliding = &system->sliding;
    const struct constraint_rows *rows = &system->rows, *penalties = &system->penalties;
    for (int64_t r = 0, curved = 0; r < rows->count; r++) {
        if (curved < sliding->row_count && sliding->row[curved] == r) {
            curved++;
        } else {
            RETURN_IF_ERROR(hold_row(parts, rows, r, error));
        }
    }
    for (int64_t r = penalties->count - system->spring_count; r < penalties->count; r++) {
        RETURN_IF_ERROR(hold_row(parts, penalties, r, error));
    }
    return STATUS_OK;
}

/* The motions of a part, as coefficients of its rigid modes, along the normals of curved sides. With the
 * value v_f of a motion at the middle of facet f, of area A_f: */
struct curved {
    double area;                                 /* sum of A_f */
    double correlation[MOST_MODES * MOST_MODES]; /* sum of A_f (v^2 at the nodes - v_f^2 / 2), where v at a
                                                    node is the mean over its facets */
};

/* curved[parts->count] */
static enum status measure_curved(const struct parts *parts, struct curved *curved, struct error *error)
{
    const struct solid_system *system = parts->system;
    const struct sliding *sliding = &system->sliding;
    int dim = system->dim, modes = mode_count(dim);
    NEW_SCRATCH(double, sum, system->node_count * modes, error);
    NEW_SCRATCH(double, weight, system->node_count, error);
    for (int64_t f = 0; f < sliding->facet_count; f++) {
        const int32_t *node = sliding->facet[f].node, p = part_of(parts, node[0]);
        double area[3], centre[3], mode[3], v[MOST_MODES];
        face_area_vector(dim, system->X, node, area);
        double size = vector_length(dim, area);
        vector_middle(dim, system->X, dim, node, centre);
        for (int k = 0; k < modes; k++) {
            rigid_mode(&parts->box[p], k, centre, mode);
            v[k] = vector_dot(dim, area, mode) / size;
        }
        for (int k = 0; k < modes; k++) {
            add_scaled(modes, -0.5 * size * v[k], v, curved[p].correlation + k * modes);
        }
        for (int k = 0; k < dim; k++) {
            add_scaled(modes, size / dim, v, sum + (int64_t)node[k] * modes);
            weight[node[k]] += size / dim;
        }
        curved[p].area += size;
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        struct curved *own = &curved[part_of(parts, (int32_t)n)];
        for (int k = 0; k < modes && weight[n] > 0.0; k++) {
            add_scaled(modes, sum[n * modes + k] / weight[n], sum + n * modes, own->correlation + k * modes);
        }
    }
    return STATUS_OK;
}

/* Impose what the curved sides of part p hold of its motions that are free so far. */
static enum status hold_curved(struct parts *parts, int32_t p, const struct curved *curved,
                               struct error *error)
{
    int modes = mode_count(parts->system->dim), n = parts->space.columns[p];
    double basis[MOST_MODES * MOST_MODES], reduced[MOST_MODES * MOST_MODES] = {0.0};
    double value[MOST_MODES], vector[MOST_MODES * MOST_MODES];
    memcpy(basis, parts->space.basis[p], (size_t)(modes * n) * sizeof *basis);
    for (int i = 0; i < modes * modes; i++) {
        for (int k = 0; k < n; k++) {
            add_scaled(n, curved->correlation[i] * basis[i / modes * n + k], basis + i % modes * n,
                       reduced + k * n);
        }
    }
    eigen_symmetric(n, reduced, value, vector);
    for (int k = 0; k < n; k++) {
        double motion[MOST_MODES] = {0.0};
        for (int i = 0; i < modes * n; i++) {
            motion[i / n] += basis[i] * vector[i % n * n + k];
        }
        if (value[k] > least_value * least_value * curved->area) {
            null_space_add(&parts->space, p, 1.0, motion);
            RETURN_IF_ERROR(null_space_impose(&parts->space, least_value, error));
        }
    }
    return STATUS_OK;
}

/* Impose the conditions along normals of curved sides. Facets approximate the surface: a motion along it has
 * values on them that are not 0 but change their sign from facet to facet. Such a motion is free: more than
 * half of the mean square of its values vanishes where the values of facets that meet are averaged. Parts
 * whose motions are coupled to those of others are held row by row. */
static enum status hold_sliding(struct parts *parts, struct error *error)
{
    const struct sliding *sliding = &parts->system->sliding;
    if (sliding->row_count == 0) {
        return STATUS_OK;
    }
    NEW_SCRATCH(struct curved, curved, parts->count, error);
    RETURN_IF_ERROR(measure_curved(parts, curved, error));
    NEW_SCRATCH(bool, alone, parts->count, error);
    for (int32_t p = 0; p < parts->count; p++) {
        alone[p] = parts->space.next[p] == p;
        if (alone[p] && curved[p].area > 0.0) {
            RETURN_IF_ERROR(hold_curved(parts, p, &curved[p], error));
        }
    }
    for (int64_t i = 0; i < sliding->row_count; i++) {
        if (!alone[part_of(parts, parts->system->rows.node[sliding->row[i]])]) {
            RETURN_IF_ERROR(hold_row(parts, &parts->system->rows, sliding->row[i], error));
        }
    }
    return STATUS_OK;
}

/* Impose that both parts of a joint move its node alike. */
static enum status hold_joint(struct parts *parts, const struct joint *joint, struct error *error)
{
    for (int a = 0; a < parts->system->dim; a++) {
        double direction[3] = {0.0, 0.0, 0.0};
        direction[a] = 1.0;
        add_node(parts, parts->of_node[joint->node], joint->node, 1.0, direction);
        add_node(parts, joint->part, joint->node, -1.0, direction);
        RETURN_IF_ERROR(null_space_impose(&parts->space, least_value, error));
    }
    return STATUS_OK;
}

static void parts_free(struct parts *parts)
{
    null_space_free(&parts->space);
    free(parts->box);
}

/* The null space of all conditions. Springs of measured points count as rows. Rows are imposed first: they
 * shrink the bases. */
static enum status parts_find(struct parts *parts, int64_t joint_count, const struct joint *joint,
                              struct error *error)
{
    const struct solid_system *system = parts->system;
    int dim = system->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&parts->box, parts->count, error));
    for (int32_t p = 0; p < parts->count; p++) {
        parts->box[p] = box_of(dim, 0, NULL);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        box_add(&parts->box[part_of(parts, (int32_t)n)], 1, system->X + n * dim);
    }
    for (int64_t j = 0; j < joint_count; j++) {
        box_add(&parts->box[joint[j].part], 1, system->X + (int64_t)joint[j].node * dim);
    }
    RETURN_IF_ERROR(null_space_begin(parts->count, mode_count(dim), MOST_FREE, &parts->space, error));
    RETURN_IF_ERROR(hold_rows(parts, error));
    RETURN_IF_ERROR(hold_sliding(parts, error));
    for (int64_t j = 0; j < joint_count; j++) {
        RETURN_IF_ERROR(hold_joint(parts, &joint[j], error));
    }
    return STATUS_OK;
}

/* basis[count][MOST_MODES]: an orthonormal basis of the free motions of part p, with any motions of the
 * others. */
static int free_modes(const struct parts *parts, int32_t p, double basis[][MOST_MODES])
{
    int n = parts->space.size, columns = parts->space.columns[p], count = 0;
    const double *motion = parts->space.basis[p];
    double gram[MOST_MODES * MOST_MODES], share2[MOST_MODES], vector[MOST_MODES * MOST_MODES];
    for (int i = 0; i < n * n; i++) {
        gram[i] = vector_dot(columns, motion + i / n * columns, motion + i % n * columns);
    }
    eigen_symmetric(n, gram, share2, vector);
    for (int k = 0; k < n; k++) {
        if (share2[k] > least_share2) {
            for (int i = 0; i < n; i++) {
                basis[count][i] = vector[i * n + k];
            }
            count++;
        }
    }
    return count;
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

/* Split the free modes of part p into translations, and rotations orthogonal to these. */
static void split_modes(const struct parts *parts, int32_t p, struct rigid_modes *modes)
{
    int dim = parts->system->dim, n = mode_count(dim);
    double basis[MOST_MODES][MOST_MODES], turning[MOST_MODES * MOST_MODES], mix[MOST_MODES * MOST_MODES];
    double turned[MOST_MODES];
    int count = free_modes(parts, p, basis);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) {
            turning[i * count + k] = 0.0;
            for (int a = dim; a < n; a++) {
                turning[i * count + k] += basis[i][a] * basis[k][a];
            }
        }
    }
    eigen_symmetric(count, turning, turned, mix);
    for (int k = 0; k < count; k++) {
        double mode[MOST_MODES] = {0.0};
        for (int i = 0; i < count; i++) {
            for (int a = 0; a < n; a++) {
                mode[a] += mix[i * count + k] * basis[i][a];
            }
        }
        if (turned[k] > least_turn2) {
            put_rotation(&parts->box[p], mode, modes);
        } else {
            memcpy(modes->along[modes->translations++], mode, (size_t)dim * sizeof *mode);
        }
    }
}

enum status system_rigid_modes(const struct solid_system *system, int32_t part_count, const int32_t *part,
                               int64_t joint_count, const struct joint *joint, struct rigid_modes *modes,
                               bool *complete, struct error *error)
{
    FREED_BY(parts_free) struct parts parts = {.system = system, .count = part_count, .of_node = part};
    RETURN_IF_ERROR(parts_find(&parts, joint_count, joint, error));
    memset(modes, 0, (size_t)part_count * sizeof *modes);
    for (int32_t p = 0; p < part_count; p++) {
        for (int a = 0; a < system->dim; a++) {
            modes[p].centre[a] = middle(&parts.box[p], a);
        }
        split_modes(&parts, p, &modes[p]);
    }
    *complete = parts.space.complete;
    return STATUS_OK;
}

enum status system_has_rigid_mode(const struct solid_system *system, bool *has, struct error *error)
{
    FREED_BY(parts_free) struct parts parts = {.system = system, .count = 1};
    RETURN_IF_ERROR(parts_find(&parts, 0, NULL, error));
    *has = parts.space.columns[0] > 0;
    return STATUS_OK;
}
