#include "solid/system/rigid_modes.h"

#include "base/box.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = EIGEN_MOST };
/* A rigid mode is free when the squared norm of G times it is below this share of the largest one. */
static const double least_constrained = 1e-8;

/* A body, and the Gram matrix of the conditions on its rigid modes: sum over the rows of value value^T. */
struct mode_gram {
    struct box box;
    double matrix[MOST_MODES * MOST_MODES]; /* rows of as many as there are rigid modes */
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

/* Add the values of row r on each rigid mode of a body; body NULL: of all nodes. */
static void add_row(const struct solid_system *system, const struct constraint_rows *rows, int64_t r,
                    const int32_t *body, int32_t number, struct mode_gram *gram)
{
    int dim = system->dim, modes = mode_count(dim);
    double value[MOST_MODES] = {0.0};
    struct average average = constraint_rows_average(rows, r);
    for (int64_t i = 0; i < average.length; i++) {
        for (int k = 0; k < modes && (body == NULL || body[average.idx[i]] == number); k++) {
            double mode[3];
            rigid_mode(&gram->box, k, system->X + (int64_t)average.idx[i] * dim, mode);
            for (int a = 0; a < dim; a++) {
                value[k] += average.phi[i] * rows->direction[r * dim + a] * mode[a];
            }
        }
    }
    for (int i = 0; i < modes; i++) {
        add_scaled(modes, value[i], value, gram->matrix + i * modes);
    }
}

/* free[count][MOST_MODES]: an orthonormal basis of the null space of the conditions. */
static int free_modes(int dim, const struct mode_gram *gram, double basis[][MOST_MODES])
{
    int n = mode_count(dim), count = 0;
    double value_of_mode[MOST_MODES], vector[MOST_MODES * MOST_MODES], largest = 0.0;
    eigen_symmetric(n, gram->matrix, value_of_mode, vector);
    for (int k = 0; k < n; k++) {
        largest = fmax(largest, value_of_mode[k]);
    }
    for (int k = 0; k < n; k++) {
        if (!(value_of_mode[k] > least_constrained * largest)) {
            for (int i = 0; i < n; i++) {
                basis[count][i] = vector[i * n + k];
            }
            count++;
        }
    }
    return count;
}

/* A rotation of coefficients `mode`: its axis, and a point of it. */
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

/* The free modes as translations, and rotations across them. */
static void split_modes(int dim, const struct mode_gram *gram, struct rigid_modes *modes)
{
    int n = mode_count(dim);
    double basis[MOST_MODES][MOST_MODES], turning[MOST_MODES * MOST_MODES], mix[MOST_MODES * MOST_MODES];
    double turned[MOST_MODES];
    int count = free_modes(dim, gram, basis);
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
        if (turned[k] > least_constrained) {
            put_rotation(&gram->box, mode, modes);
        } else {
            memcpy(modes->along[modes->translations++], mode, (size_t)dim * sizeof *mode);
        }
    }
}

/* The springs of measured points hold as rows do. */
static int64_t first_spring(const struct solid_system *system)
{
    return system->penalties.count - system->spring_count;
}

/* Rows from `first` on, on the bodies that they hold. */
static void add_rows(const struct solid_system *system, const struct constraint_rows *rows, int64_t first,
                     const int32_t *body, struct mode_gram *gram)
{
    for (int64_t r = first; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        int32_t last = -1;
        for (int64_t i = 0; i < average.length; i++) { /* a body twice: weighs twice */
            if (body[average.idx[i]] != last && body[average.idx[i]] >= 0) {
                last = body[average.idx[i]];
                add_row(system, rows, r, body, last, &gram[last]);
            }
        }
    }
}

/* Add the rows of a fixed node at X to the Gram matrix. */
static void add_fixed_node(int dim, const double *X, struct mode_gram *gram)
{
    int modes = mode_count(dim);
    double mode[MOST_MODES][3], value[MOST_MODES];
    for (int k = 0; k < modes; k++) {
        rigid_mode(&gram->box, k, X, mode[k]);
    }
    for (int a = 0; a < dim; a++) {
        for (int k = 0; k < modes; k++) {
            value[k] = mode[k][a];
        }
        for (int i = 0; i < modes; i++) {
            add_scaled(modes, value[i], value, gram->matrix + i * modes);
        }
    }
}

enum status system_rigid_modes(const struct solid_system *system, int64_t body_count, const int32_t *body,
                               int64_t hinge_count, const struct hinge *hinge, struct rigid_modes *modes,
                               struct error *error)
{
    SCRATCH struct mode_gram *gram = NULL;
    int dim = system->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&gram, body_count, error));
    memset(modes, 0, (size_t)body_count * sizeof *modes);
    for (int64_t b = 0; b < body_count; b++) {
        gram[b].box = box_of(dim, 0, NULL);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        if (body[n] >= 0) {
            box_add(&gram[body[n]].box, 1, system->X + n * dim);
            modes[body[n]].nodes++;
        }
    }
    for (int64_t h = 0; h < hinge_count; h++) {
        box_add(&gram[hinge[h].body].box, 1, system->X + (int64_t)hinge[h].node * dim);
    }
    for (int64_t h = 0; h < hinge_count; h++) {
        add_fixed_node(dim, system->X + (int64_t)hinge[h].node * dim, &gram[hinge[h].body]);
    }
    add_rows(system, &system->rows, 0, body, gram);
    add_rows(system, &system->penalties, first_spring(system), body, gram);
    for (int64_t b = 0; b < body_count; b++) {
        for (int a = 0; a < dim; a++) {
            modes[b].centre[a] = middle(&gram[b].box, a);
        }
        split_modes(dim, &gram[b], &modes[b]);
    }
    return STATUS_OK;
}

bool system_has_rigid_mode(const struct solid_system *system)
{
    double basis[MOST_MODES][MOST_MODES];
    struct mode_gram gram = {.box = box_of(system->dim, system->node_count, system->X)};
    for (int64_t r = 0; r < system->rows.count; r++) {
        add_row(system, &system->rows, r, NULL, 0, &gram);
    }
    for (int64_t r = first_spring(system); r < system->penalties.count; r++) {
        add_row(system, &system->penalties, r, NULL, 0, &gram);
    }
    return free_modes(system->dim, &gram, basis) > 0;
}
