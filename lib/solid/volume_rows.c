#include "solid/volume_rows.h"

#include "base/memory.h"
#include "solid/nodal_volume.h"
#include "solid/stress.h"

#include <stdlib.h>
#include <string.h>

/* kappa - s of a point, Pa. */
static double averaged_modulus(const struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    return material_bulk(material) - nodal_volume_modulus(material);
}

void volume_matrix_free(struct volume_matrix *matrix)
{
    free(matrix->ptr);
    free(matrix->idx);
    free(matrix->value);
    *matrix = (struct volume_matrix){0};
}

void volume_rows_free(struct volume_rows *rows)
{
    volume_matrix_free(&rows->faces);
    volume_matrix_free(&rows->nodes);
    volume_matrix_free(&rows->change);
    volume_matrix_free(&rows->stiffness);
    free(rows->theta);
    *rows = (struct volume_rows){0};
}

/* The table of means back from its layout (pairs.h), on the caller's nodes. */
static enum status list_means(const struct body *body, const struct pairs *pairs,
                              struct volume_matrix *matrix, struct error *error)
{
    enum status status;
    int64_t at = 0;
    TRY(NEW_ARRAY(&matrix->ptr, pairs->row_count + 1, error));
    TRY(NEW_ARRAY(&matrix->idx, pairs->pair_count, error));
    TRY(NEW_ARRAY(&matrix->value, pairs->pair_count, error));
    for (int64_t b = 0; b < pairs->block_count; b++) {
        const struct pair_block *block = &pairs->blocks[b];
        for (int64_t row = block->first_row; row < block->first_row + block->row_count; row++) {
            int64_t lane = (row - block->first_row) % PAIRS_GROUP;
            const struct pair_group *group =
                &pairs->groups[block->first_group + (row - block->first_row) / PAIRS_GROUP];
            for (int64_t e = 0; e < group->shared + group->own; e++) {
                double value = pairs->value[(group->first_entry + e) * PAIRS_GROUP + lane];
                int64_t offset =
                    e < group->shared ? e : group->shared + (e - group->shared) * PAIRS_GROUP + lane;
                int64_t local = pairs->offset[group->first_offset + offset] / PAIRS_STRIDE(pairs->dim);
                if (value != 0.0) { /* entries are filled up with zeros */
                    matrix->idx[at] = (int32_t)body->node_order[pairs->block_node[block->first_node + local]];
                    matrix->value[at++] = value;
                }
            }
            matrix->ptr[row + 1] = at;
        }
    }
done:
    return status;
}

/* The row of a table of means that a corner looks at. */
static int64_t row_of_corner(const struct means *means, int64_t corner, int dim)
{
    return means->of_corner[corner] / PAIRS_STRIDE(dim);
}

int64_t volume_matrix_note_columns(const struct volume_matrix *table, int64_t r, int64_t row, int64_t *seen,
                                   int64_t count, int32_t *idx)
{
    for (int64_t i = table->ptr[r]; i < table->ptr[r + 1]; i++) {
        if (seen[table->idx[i]] != row) {
            seen[table->idx[i]] = row;
            if (idx != NULL) {
                idx[count] = table->idx[i];
            }
            count++;
        }
    }
    return count;
}

/* Columns of row a of C, from `count` on: the nodes of all means of its cells. */
static int64_t change_columns(const struct body *body, const struct volume_rows *rows, int64_t a,
                              int64_t *seen, int64_t count, int32_t *idx)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int corners = body->dim + 1;
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        int64_t first = volumes->slot[i] / corners * corners;
        for (int64_t corner = first; corner < first + corners; corner++) {
            count = volume_matrix_note_columns(
                &rows->faces, row_of_corner(&body->cells.faces, corner, body->dim), a, seen, count, idx);
            count = volume_matrix_note_columns(
                &rows->nodes, row_of_corner(&body->cells.nodes, corner, body->dim), a, seen, count, idx);
        }
    }
    return count;
}

static enum status lay_out_change(const struct body *body, struct volume_rows *rows, struct error *error)
{
    enum status status;
    struct volume_matrix *change = &rows->change;
    int64_t *seen = NULL;
    TRY(NEW_ARRAY(&seen, body->node_count, error));
    TRY(NEW_ARRAY(&change->ptr, rows->count + 1, error));
    for (int pass = 0; pass < 2; pass++) {
        memset(seen, -1, (size_t)body->node_count * sizeof *seen);
        for (int64_t a = 0; a < rows->count; a++) {
            change->ptr[a + 1] = change_columns(body, rows, a, seen, change->ptr[a], change->idx);
        }
        if (pass == 0) {
            TRY(NEW_ARRAY(&change->idx, change->ptr[rows->count], error));
        }
    }
    TRY(NEW_ARRAY(&change->value, change->ptr[rows->count] * body->dim, error));
done:
    free(seen);
    return status;
}

/* K: nodal volumes meet in the points they share. */
static enum status lay_out_stiffness(const struct body *body, struct volume_rows *rows, struct error *error)
{
    enum status status;
    const struct nodal_volumes *volumes = &body->volumes;
    struct volume_matrix *K = &rows->stiffness;
    int corners = body->dim + 1;
    int64_t *place = NULL, at = 0;
    TRY(NEW_ARRAY(&place, rows->count, error));
    TRY(NEW_ARRAY(&K->ptr, rows->count + 1, error));
    TRY(NEW_ARRAY(&K->idx, volumes->ptr[rows->count] * corners, error));
    TRY(NEW_ARRAY(&K->value, volumes->ptr[rows->count] * corners, error));
    memset(place, -1, (size_t)rows->count * sizeof *place);
    for (int64_t a = 0; a < rows->count; a++) {
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int64_t q = volumes->slot[i] / corners;
            for (int64_t k = q * corners; k < (q + 1) * corners; k++) {
                int32_t b = volumes->of_point[k];
                if (place[b] < K->ptr[a]) {
                    place[b] = at;
                    K->idx[at++] = b;
                }
            }
        }
        K->ptr[a + 1] = at;
    }
done:
    free(place);
    return status;
}

enum status volume_rows_build(const struct body *body, struct volume_rows *rows, struct error *error)
{
    enum status status;
    *rows =
        (struct volume_rows){.dim = body->dim, .count = body->volumes.count, .node_count = body->node_count};
    TRY(list_means(body, &body->cells.faces.pairs, &rows->faces, error));
    TRY(list_means(body, &body->cells.nodes.pairs, &rows->nodes, error));
    TRY(lay_out_change(body, rows, error));
    TRY(lay_out_stiffness(body, rows, error));
    TRY(NEW_ARRAY(&rows->theta, 2 * rows->count, error));
done:
    if (status != STATUS_OK) {
        volume_rows_free(rows);
    }
    return status;
}

int64_t volume_rows_size(const struct volume_rows *rows)
{
    return rows->count > 0 ? rows->change.ptr[rows->count] * rows->dim : 0;
}

/* dJ of cell q: along the mean on the face opposite each corner, and along the value at the corner. */
struct cell_change {
    double face[4][3], node[4][3];
};

static void differentiate(const struct body *body, int64_t q, struct cell_change *change)
{
    int dim = body->dim;
    double F[9], H[9], D[9], C[9], T[9], hat[4][3] = {{0.0}};
    stress_matrix(dim, body->F + q, body->point_count, F);
    stress_matrix(dim, body->cells.interpolant + q, body->point_count, H);
    for (int k = 0; k < 9; k++) {
        D[k] = H[k] - F[k];
    }
    cofactor(H, C);
    cofactor_along(H, D, T);
    for (int k = 1; k <= dim; k++) {
        for (int b = 0; b < dim; b++) {
            hat[k][b] = body->cells.hat[((k - 1) * dim + b) * body->point_count + q];
            hat[0][b] -= hat[k][b];
        }
    }
    for (int k = 0; k <= dim; k++) {
        for (int a = 0; a < dim; a++) {
            change->face[k][a] = change->node[k][a] = 0.0;
            for (int b = 0; b < dim; b++) {
                change->face[k][a] -= dim * C[3 * a + b] * hat[k][b];
                change->node[k][a] -= T[3 * a + b] * hat[k][b];
            }
        }
    }
}

/* Add `by` times a mean's change along `direction` to the row whose columns stand at place[node]. */
static void add_mean(const struct volume_matrix *table, int64_t r, double by, const double *direction,
                     int dim, const int64_t *place, double *value)
{
    for (int64_t i = table->ptr[r]; i < table->ptr[r + 1]; i++) {
        double *to = value + place[table->idx[i]] * dim;
        for (int a = 0; a < dim; a++) {
            to[a] += by * table->value[i] * direction[a];
        }
    }
}

static void set_stiffness(const struct body *body, struct volume_rows *rows, int64_t *place)
{
    const struct nodal_volumes *volumes = &body->volumes;
    struct volume_matrix *K = &rows->stiffness;
    int corners = body->dim + 1;
    memset(K->value, 0, (size_t)K->ptr[rows->count] * sizeof *K->value);
    for (int64_t a = 0; a < rows->count; a++) {
        for (int64_t i = K->ptr[a]; i < K->ptr[a + 1]; i++) {
            place[K->idx[i]] = i;
        }
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
            int64_t slot = volumes->slot[i], q = slot / corners;
            double by = averaged_modulus(body, q) * volumes->share[slot] / body->weight[q];
            for (int64_t k = q * corners; k < (q + 1) * corners; k++) {
                K->value[place[volumes->of_point[k]]] += by * volumes->share[k];
            }
        }
    }
}

enum status volume_rows_set(const struct body *body, struct volume_rows *rows, struct error *error)
{
    enum status status;
    const struct nodal_volumes *volumes = &body->volumes;
    struct volume_matrix *C = &rows->change;
    int dim = body->dim, corners = dim + 1;
    int64_t *place = NULL;
    TRY(NEW_ARRAY(&place, body->node_count + rows->count, error));
    set_stiffness(body, rows, place);
    memset(C->value, 0, (size_t)(C->ptr[rows->count] * dim) * sizeof *C->value);
    for (int64_t a = 0; a < rows->count; a++) {
        for (int64_t i = C->ptr[a]; i < C->ptr[a + 1]; i++) {
            place[C->idx[i]] = i;
        }
        for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1] && volumes->volume[a] > 0.0; i++) {
            struct cell_change change;
            int64_t slot = volumes->slot[i], first = slot / corners * corners;
            double by = volumes->share[slot] / volumes->volume[a];
            differentiate(body, slot / corners, &change);
            for (int k = 0; k < corners; k++) {
                add_mean(&rows->faces, row_of_corner(&body->cells.faces, first + k, dim), by, change.face[k],
                         dim, place, C->value);
                add_mean(&rows->nodes, row_of_corner(&body->cells.nodes, first + k, dim), by, change.node[k],
                         dim, place, C->value);
            }
        }
    }
done:
    free(place);
    return status;
}

/* theta = C x */
static void change_along(const struct volume_rows *rows, const double *x, double *theta)
{
    const struct volume_matrix *C = &rows->change;
    int dim = rows->dim;
    for (int64_t a = 0; a < rows->count; a++) {
        double sum = 0.0;
        for (int64_t i = C->ptr[a]; i < C->ptr[a + 1]; i++) {
            for (int k = 0; k < dim; k++) {
                sum += C->value[i * dim + k] * x[(int64_t)C->idx[i] * dim + k];
            }
        }
        theta[a] = sum;
    }
}

/* y = K x */
static void press(const struct volume_rows *rows, const double *x, double *y)
{
    const struct volume_matrix *K = &rows->stiffness;
    for (int64_t a = 0; a < rows->count; a++) {
        double sum = 0.0;
        for (int64_t i = K->ptr[a]; i < K->ptr[a + 1]; i++) {
            sum += K->value[i] * x[K->idx[i]];
        }
        y[a] = sum;
    }
}

void volume_rows_force(const struct volume_rows *rows, const double *x, double *force)
{
    change_along(rows, x, rows->theta);
    press(rows, rows->theta, force);
}

void volume_rows_spread(const struct volume_rows *rows, const double *amount, const double *mass, double *x)
{
    const struct volume_matrix *C = &rows->change;
    int dim = rows->dim;
    press(rows, amount, rows->theta);
    for (int64_t a = 0; a < rows->count; a++) {
        for (int64_t i = C->ptr[a]; i < C->ptr[a + 1]; i++) {
            double by = rows->theta[a] / mass[C->idx[i]];
            for (int k = 0; k < dim; k++) {
                x[(int64_t)C->idx[i] * dim + k] += by * C->value[i * dim + k];
            }
        }
    }
}

double volume_rows_product(const struct volume_rows *rows, const double *x, const double *y)
{
    double *along_x = rows->theta, *pressure = rows->theta + rows->count, sum = 0.0;
    change_along(rows, x, along_x);
    press(rows, along_x, pressure);
    if (y != x) {
        change_along(rows, y, along_x);
    }
    for (int64_t a = 0; a < rows->count; a++) {
        sum += along_x[a] * pressure[a];
    }
    return sum;
}
