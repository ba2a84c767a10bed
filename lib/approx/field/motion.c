#include "approx/field/motion.h"

#include "approx/field/field.h"
#include "approx/shape/shape.h"
#include "approx/support/support.h"
#include "base/memory.h"
#include "base/vector.h"

#include <string.h>

static const int newton_most = 30;
static const double step_out =
    1e-6; /* a point with a barycentric coordinate below -step_out is in the next cell */

/* The columns of m: the edges of a cell from its first node; in 2D the third one is across. */
static void edges(const struct cells *cells, const double *x, int64_t cell, double m[3][3])
{
    int dim = cells->dim;
    const int32_t *node = cells->node + cell * (dim + 1);
    memset(m, 0, 9 * sizeof m[0][0]);
    m[2][2] = 1.0;
    for (int a = 0; a < dim; a++) {
        for (int i = 0; i < dim; i++) {
            m[i][a] = x[node[a + 1] * dim + i] - x[node[0] * dim + i];
        }
    }
}

/* Radii for a fit at the nodes. */
static enum status choose_radii(const struct cells *cells, const struct support_options *options,
                                double *radius, struct error *error)
{
    NEW_SCRATCH(double, spacing, cells->node_count, error);
    RETURN_IF_ERROR(field_spacing(cells, spacing, error));
    return support_radii(options, cells->node_count, spacing, radius, error);
}

/* Gradients at the nodes, of the source or of a fit. */
static enum status find_gradients(const struct cells *cells, const double *u,
                                  const struct motion_source *source, double *gradient, struct error *error)
{
    int dim = cells->dim;
    int64_t nodes = cells->node_count;
    struct support_options options = source != NULL ? *source->support : support_defaults(dim);
    struct mls shapes = source != NULL ? *source->shapes : options.mls;
    struct visibility_places places = {.nodes = true};
    FREED_BY(support_free) struct support_lists lists = {0};
    FREED_BY(support_space_free) struct support_space space = {0};
    NEW_SCRATCH(double, radius, nodes, error);
    if (source != NULL) {
        u = source->parameters;
        memcpy(radius, source->radius, (size_t)nodes * sizeof *radius);
    } else {
        options.mls.basis = shapes.basis = BASIS_QUADRATIC;
        RETURN_IF_ERROR(choose_radii(cells, &options, radius, error));
    }
    RETURN_IF_ERROR(support_space_build(&options, cells, radius, &space, error));
    RETURN_IF_ERROR(support_build(&options, &space, &places, nodes, cells->x, "nodes", &lists, error));
    NEW_SCRATCH(double, phi, lists.ptr[nodes], error);
    NEW_SCRATCH(double, dphi, lists.ptr[nodes] * dim, error);
    struct neighbours view = support_view(&lists);
    RETURN_IF_ERROR(shape_table(&shapes, cells->x, radius, &view, cells->x, "nodes", phi, dphi, error));
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t p = lists.ptr[n]; p < lists.ptr[n + 1]; p++) {
            for (int ij = 0; ij < dim * dim; ij++) {
                gradient[n * dim * dim + ij] += u[lists.idx[p] * dim + ij / dim] * dphi[p * dim + ij % dim];
            }
        }
    }
    return STATUS_OK;
}

enum status motion_build(const struct cells *cells, const double *u, bool linear,
                         const struct motion_source *source, struct motion *motion, struct error *error)
{
    int dim = cells->dim;
    *motion = (struct motion){.cells = *cells, .u = u};
    RETURN_IF_ERROR(NEW_ARRAY(&motion->shape, cells->count * dim * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&motion->across, cells->count * (dim + 1), error));
    RETURN_IF_ERROR(NEW_ARRAY(&motion->moved, cells->node_count * dim, error));
    RETURN_IF_ERROR(cells_across(cells, motion->across, error));
    for (int64_t c = 0; c < cells->count; c++) {
        double m[3][3], inverse[3][3];
        edges(cells, cells->x, c, m);
        (void)matrix_inverse(m[0], m[1], m[2], inverse);
        for (int ij = 0; ij < dim * dim; ij++) {
            motion->shape[c * dim * dim + ij] = inverse[ij / dim][ij % dim];
        }
    }
    for (int64_t i = 0; i < cells->node_count * dim; i++) {
        motion->moved[i] = cells->x[i] + u[i];
    }
    if (!linear) {
        RETURN_IF_ERROR(NEW_ARRAY(&motion->gradient, cells->node_count * dim * dim, error));
        RETURN_IF_ERROR(find_gradients(cells, u, source, motion->gradient, error));
    }
    return STATUS_OK;
}

void motion_free(struct motion *motion)
{
    FREE_ALL(motion->gradient, motion->shape, motion->across, motion->moved);
    *motion = (struct motion){0};
}

int64_t motion_folded(const struct motion *motion, int64_t *first)
{
    struct cells moved = motion->cells;
    int64_t count = 0;
    moved.x = motion->moved;
    for (int64_t c = moved.count - 1; c >= 0; c--) {
        if (!(cell_volume(&moved, c) > 0)) {
            *first = c;
            count++;
        }
    }
    return count;
}

/* N[dim + 1]: the linear shape functions of a cell at X. */
static inline void shapes(const struct motion *motion, int dim, int64_t cell, const double *X, double *N)
{
    const double *origin = motion->cells.x + motion->cells.node[cell * (dim + 1)] * dim;
    const double *shape = motion->shape + cell * dim * dim;
    N[0] = 1;
    for (int a = 0; a < dim; a++) {
        N[a + 1] = 0;
        for (int i = 0; i < dim; i++) {
            N[a + 1] += shape[a * dim + i] * (X[i] - origin[i]);
        }
        N[0] -= N[a + 1];
    }
}

/* moved = X + u(X), and the deformation gradient F unless NULL. */
static inline void place(const struct motion *motion, int dim, int64_t cell, const double *X, const double *N,
                         double *moved, double F[3][3])
{
    const int32_t *node = motion->cells.node + cell * (dim + 1);
    const double *shape = motion->shape + cell * dim * dim;
    double part[4][3], mean[3][3] = {{0}};
    for (int i = 0; i < dim; i++) {
        moved[i] = X[i];
    }
    for (int a = 0; a <= dim; a++) {
        const double *u = motion->u + node[a] * dim, *at = motion->cells.x + node[a] * dim;
        for (int i = 0; i < dim; i++) {
            part[a][i] = u[i];
        }
        if (motion->gradient != NULL) {
            const double *G = motion->gradient + node[a] * dim * dim;
            for (int i = 0; i < dim; i++) {
                for (int j = 0; j < dim; j++) {
                    part[a][i] += 0.5 * G[i * dim + j] * (X[j] - at[j]);
                    mean[i][j] += 0.5 * G[i * dim + j] * N[a];
                }
            }
        }
        add_scaled(dim, N[a], part[a], moved);
    }
    for (int i = 0; i < dim && F != NULL; i++) {
        for (int j = 0; j < dim; j++) {
            F[i][j] = (i == j) + mean[i][j];
            for (int a = 1; a <= dim; a++) {
                F[i][j] += shape[(a - 1) * dim + j] * (part[a][i] - part[0][i]);
            }
        }
    }
}

void motion_place(const struct motion *motion, int64_t cell, const double *X, double *moved)
{
    double N[4];
    shapes(motion, motion->cells.dim, cell, X, N);
    place(motion, motion->cells.dim, cell, X, N, moved, NULL);
}

/* The X that linear interpolation in the cell maps to x. */
static inline void linear_inverse(const struct motion *motion, int dim, int64_t cell, const double *x,
                                  double *X)
{
    const int32_t *node = motion->cells.node + cell * (dim + 1);
    const double *origin = motion->moved + node[0] * dim;
    double m[3][3], inverse[3][3], before[3][3];
    edges(&motion->cells, motion->moved, cell, m);
    edges(&motion->cells, motion->cells.x, cell, before);
    (void)matrix_inverse(m[0], m[1], m[2], inverse);
    for (int i = 0; i < dim; i++) {
        X[i] = motion->cells.x[node[0] * dim + i];
    }
    for (int a = 0; a < dim; a++) {
        double N = 0;
        for (int i = 0; i < dim; i++) {
            N += inverse[a][i] * (x[i] - origin[i]);
        }
        for (int i = 0; i < dim; i++) {
            X[i] += N * before[i][a];
        }
    }
}

/* The next cell on the way to X: the one beyond the face with the most negative N; the same at the
 * boundary. */
static inline int64_t next_cell(const struct motion *motion, int dim, int64_t cell, const double *N)
{
    int lowest = 0;
    for (int a = 1; a <= dim; a++) {
        lowest = N[a] < N[lowest] ? a : lowest;
    }
    int32_t beyond = motion->across[cell * (dim + 1) + lowest];
    return N[lowest] < -step_out && beyond >= 0 ? beyond : cell;
}

static inline bool inverse_in(const struct motion *motion, int dim, int64_t cell, const double *x,
                              double tolerance, double *X, double *residual)
{
    double start[3], N[4], at[3], F[3][3] = {{0}}, inverse[3][3], first = 0;
    int64_t current = cell;
    linear_inverse(motion, dim, cell, x, X);
    memcpy(start, X, (size_t)dim * sizeof *X);
    F[2][2] = 1.0; /* in 2D */
    for (int step = 0; step < newton_most; step++) {
        shapes(motion, dim, current, X, N);
        int64_t next = next_cell(motion, dim, current, N);
        if (next != current) {
            current = next;
            shapes(motion, dim, current, X, N);
        }
        place(motion, dim, current, X, N, at, F);
        vector_subtract(dim, x, at, at);
        *residual = vector_length(dim, at);
        first = step == 0 ? *residual : first;
        if (*residual <= tolerance) {
            return true;
        }
        if (!(matrix_inverse(F[0], F[1], F[2], inverse) > 0)) {
            break;
        }
        for (int i = 0; i < dim; i++) {
            for (int j = 0; j < dim; j++) {
                X[i] += inverse[i][j] * at[j];
            }
        }
    }
    memcpy(X, start, (size_t)dim * sizeof *X);
    *residual = first;
    return false;
}

bool motion_inverse(const struct motion *motion, int64_t cell, const double *x, double tolerance, double *X,
                    double *residual)
{
    return motion->cells.dim == 2 ? inverse_in(motion, 2, cell, x, tolerance, X, residual)
                                  : inverse_in(motion, 3, cell, x, tolerance, X, residual);
}
