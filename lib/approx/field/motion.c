#include "approx/field/motion.h"

#include "approx/field/field.h"
#include "approx/support/support.h"
#include "base/memory.h"
#include "base/vector.h"

#include <string.h>

static const int newton_most = 30;
static const double step_out =
    1e-6; /* a point with a barycentric coordinate below -step_out is in the next cell */

/* Gradients at the nodes, of the parameters or of a fit. */
static enum status find_gradients(const struct nodal_field *field, double *gradient, struct error *error)
{
    const struct cells *cells = &field->cells;
    int dim = cells->dim;
    int64_t nodes = cells->node_count;
    struct field_shapes fit = {.support = support_defaults(dim)};
    const struct field_shapes *shapes = field->shapes != NULL ? field->shapes : &fit;
    const double *u = field->shapes != NULL ? field->parameters : field->values;
    struct visibility_places places = {.nodes = true};
    FREED_BY(visibility_free) struct visibility space = {0};
    FREED_BY(field_table_free) struct field_table table = {0};
    NEW_SCRATCH(double, radius, nodes, error);
    fit.support.mls.basis = BASIS_QUADRATIC;
    fit.shapes = fit.support.mls;
    fit.supports.radius = radius;
    if (shapes == &fit) {
        NEW_SCRATCH(double, spacing, nodes, error);
        RETURN_IF_ERROR(field_spacing(cells, spacing, error));
        RETURN_IF_ERROR(support_radii(&fit.support, nodes, spacing, radius, error));
    }
    RETURN_IF_ERROR(visibility_build(cells, shapes->supports, shapes->support.visibility,
                                     shapes->support.side, &space, error));
    RETURN_IF_ERROR(field_table_at(shapes, &space, &places, nodes, cells->x, "nodes", true, &table, error));
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t p = table.lists.ptr[n]; p < table.lists.ptr[n + 1]; p++) {
            for (int ij = 0; ij < dim * dim; ij++) {
                gradient[n * dim * dim + ij] +=
                    u[table.lists.idx[p] * dim + ij / dim] * table.dphi[p * dim + ij % dim];
            }
        }
    }
    return STATUS_OK;
}

enum status motion_build(const struct nodal_field *field, bool linear, struct motion *motion,
                         struct error *error)
{
    const struct cells *cells = &field->cells;
    const double *u = field->values;
    int dim = cells->dim;
    *motion = (struct motion){.cells = *cells, .u = u};
    RETURN_IF_ERROR(NEW_ARRAY(&motion->across, cells->count * (dim + 1), error));
    RETURN_IF_ERROR(NEW_ARRAY(&motion->moved, cells->node_count * dim, error));
    RETURN_IF_ERROR(cells_across(cells, motion->across, error));
    for (int64_t i = 0; i < cells->node_count * dim; i++) {
        motion->moved[i] = cells->x[i] + u[i];
    }
    if (!linear) {
        RETURN_IF_ERROR(NEW_ARRAY(&motion->gradient, cells->node_count * dim * dim, error));
        RETURN_IF_ERROR(find_gradients(field, motion->gradient, error));
    }
    return STATUS_OK;
}

void motion_free(struct motion *motion)
{
    FREE_ALL(motion->gradient, motion->across, motion->moved);
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

/* N[dim + 1]: the linear shape functions of a cell at X; slope[dim]: the gradients of N_1 to N_dim, 1/m. */
static void shapes(const struct motion *motion, int64_t cell, const double *X, double *N, double slope[3][3])
{
    const struct cells *cells = &motion->cells;
    int dim = cells->dim;
    const int32_t *node = cells->node + cell * (dim + 1);
    const double *origin = cells->x + node[0] * dim;
    /* The columns of m: the edges of the cell from its first node; in 2D the third one is across. */
    double m[3][3] = {{0}, {0}, {0, 0, 1}};
    for (int i = 0; i < dim; i++) {
        for (int j = 0; j < dim; j++) {
            m[i][j] = cells->x[node[j + 1] * dim + i] - origin[i];
        }
    }
    (void)matrix_inverse(m[0], m[1], m[2], slope);
    N[0] = 1;
    for (int a = 0; a < dim; a++) {
        N[a + 1] = 0;
        for (int i = 0; i < dim; i++) {
            N[a + 1] += slope[a][i] * (X[i] - origin[i]);
        }
        N[0] -= N[a + 1];
    }
}

/* moved = X + u(X), and the deformation gradient F, by the shape functions. */
static void place(const struct motion *motion, int64_t cell, const double *X, const double *N,
                  double slope[3][3], double *moved, double F[3][3])
{
    int dim = motion->cells.dim;
    const int32_t *node = motion->cells.node + cell * (dim + 1);
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
    for (int i = 0; i < dim; i++) {
        for (int j = 0; j < dim; j++) {
            F[i][j] = (i == j) + mean[i][j];
            for (int a = 1; a <= dim; a++) {
                F[i][j] += slope[a - 1][j] * (part[a][i] - part[0][i]);
            }
        }
    }
}

void motion_place(const struct motion *motion, int64_t cell, const double *X, double *moved)
{
    double N[4], slope[3][3], F[3][3];
    shapes(motion, cell, X, N, slope);
    place(motion, cell, X, N, slope, moved, F);
}

/* The X that linear interpolation in the cell maps to x. */
static void linear_inverse(const struct motion *motion, int64_t cell, const double *x, double *X)
{
    struct cells moved = motion->cells;
    int dim = moved.dim;
    double N[4];
    moved.x = motion->moved;
    cell_barycentric(&moved, cell, x, N);
    memset(X, 0, (size_t)dim * sizeof *X);
    for (int k = 0; k <= dim; k++) {
        add_scaled(dim, N[k], motion->cells.x + moved.node[cell * (dim + 1) + k] * dim, X);
    }
}

/* The next cell on the way to X: the one beyond the face with the most negative N; the same at the
 * boundary. */
static int64_t next_cell(const struct motion *motion, int64_t cell, const double *N)
{
    int dim = motion->cells.dim, lowest = 0;
    for (int a = 1; a <= dim; a++) {
        lowest = N[a] < N[lowest] ? a : lowest;
    }
    int32_t beyond = motion->across[cell * (dim + 1) + lowest];
    return N[lowest] < -step_out && beyond >= 0 ? beyond : cell;
}

bool motion_inverse(const struct motion *motion, int64_t cell, const double *x, double tolerance, double *X,
                    double *residual)
{
    int dim = motion->cells.dim;
    double start[3], N[4], slope[3][3], at[3], F[3][3] = {{0}}, inverse[3][3], first = 0;
    int64_t current = cell;
    linear_inverse(motion, cell, x, X);
    memcpy(start, X, (size_t)dim * sizeof *X);
    F[2][2] = 1.0; /* in 2D */
    for (int step = 0; step < newton_most; step++) {
        shapes(motion, current, X, N, slope);
        int64_t next = next_cell(motion, current, N);
        if (next != current) {
            current = next;
            shapes(motion, current, X, N, slope);
        }
        place(motion, current, X, N, slope, at, F);
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
