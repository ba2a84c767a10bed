#include "approx/shape.h"

#include "approx/quadrature.h"
#include "approx/support.h"
#include "base/memory.h"

#include <stdlib.h>

static const int64_t chunk_points = 512;

static enum status chunk_of_table(const struct mls *mls, const double *nodes, const double *radius,
                                  const struct neighbours *lists, int64_t first, int64_t last,
                                  const double *x, const char *what, double *phi, double *dphi,
                                  struct error *error)
{
    enum status status = STATUS_OK;
    struct mls_work work = {0};
    int dim = mls->dim;
    for (int64_t p = first; p < last; p++) {
        enum mls_verdict verdict;
        int64_t at = lists->ptr[p];
        struct mls_support support = {.x = x + p * dim,
                                      .nodes = nodes,
                                      .radius = radius,
                                      .widen = lists->widen[p],
                                      .neighbours = lists->idx + at,
                                      .count = lists->ptr[p + 1] - at};
        TRY(mls_evaluate(mls, &support, &work, phi + at, dphi != NULL ? dphi + at * dim : NULL, &verdict,
                         error));
        if (verdict != MLS_GOOD) {
            char place[96];
            point_text(dim, support.x, place);
            status =
                fail(error, STATUS_VERDICT, "%s: row %lld at %s: %s of %s on %lld nodes: widen the support",
                     what, (long long)p, place, mls_verdict_text(verdict), basis_names[mls->basis],
                     (long long)support.count);
            goto done;
        }
    }
done:
    mls_work_free(&work);
    return status;
}

enum status shape_table(const struct mls *mls, const double *nodes, const double *radius,
                        const struct neighbours *neighbours, const double *x, const char *what, double *phi,
                        double *dphi, struct error *error)
{
    int64_t chunk_count = (neighbours->count + chunk_points - 1) / chunk_points;
    int64_t failed = chunk_count;
    enum status failure = STATUS_OK;
#pragma omp parallel for schedule(dynamic, 1)
    for (int64_t c = 0; c < chunk_count; c++) {
        struct error own;
        int64_t first = c * chunk_points;
        int64_t last = first + chunk_points < neighbours->count ? first + chunk_points : neighbours->count;
        enum status outcome =
            chunk_of_table(mls, nodes, radius, neighbours, first, last, x, what, phi, dphi, &own);
        if (outcome != STATUS_OK) {
#pragma omp critical(shape_failure)
            if (c < failed) {
                failed = c;
                failure = outcome;
                *error = own;
            }
        }
    }
    return failure;
}

/* For each cell its faces: face index * 2 + side (0: the face is oriented outward from this cell). */
static enum status faces_of_cells(const struct cells *cells, const struct faces *faces, int64_t *cell_face,
                                  struct error *error)
{
    int per_cell = cells->dim + 1;
    for (int64_t i = 0; i < cells->count * per_cell; i++) {
        cell_face[i] = -1;
    }
    for (int64_t i = 0; i < faces->count * 2; i++) {
        int64_t cell = faces->cell[i];
        if (cell < 0 || cell >= cells->count) {
            if (cell == -1 && i % 2 == 1) {
                continue;
            }
            return fail(error, STATUS_INPUT, "faces.cell: row %lld: no such cell", (long long)(i / 2));
        }
        int slot = 0;
        while (slot < per_cell && cell_face[cell * per_cell + slot] >= 0) {
            slot++;
        }
        if (slot == per_cell) {
            return fail(error, STATUS_INPUT, "faces.cell: cell %lld has too many faces", (long long)cell);
        }
        cell_face[cell * per_cell + slot] = i;
    }
    for (int64_t i = 0; i < cells->count * per_cell; i++) {
        if (cell_face[i] < 0) {
            return fail(error, STATUS_INPUT,
                        "faces.cell: cell %lld lacks a face: run ipoints for conforming cells",
                        (long long)(i / per_cell));
        }
    }
    return STATUS_OK;
}

/* Sort ascending and drop repeats; returns how many remain. */
static int64_t sort_unique(int32_t *index, int64_t count)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < count; i++) {
        int32_t value = index[i];
        int64_t low = 0, high = kept;
        while (low < high) {
            int64_t middle = (low + high) / 2;
            if (index[middle] < value) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        if (low < kept && index[low] == value) {
            continue;
        }
        for (int64_t k = kept; k > low; k--) {
            index[k] = index[k - 1];
        }
        index[low] = value;
        kept++;
    }
    return kept;
}

/* Lists of the cells: first the sizes of the unions, then the unions. */
static enum status unite_lists(const struct cells *cells, int per_face, const int64_t *cell_face,
                               const struct neighbours *lists, struct smoothed_table *table,
                               struct error *error)
{
    enum status status = STATUS_OK;
    int per_cell = cells->dim + 1;
    int32_t *united = NULL;
    int64_t capacity = 0, total = 0;
    for (int64_t c = 0; c < cells->count; c++) {
        int64_t most = 0;
        for (int k = 0; k < per_cell; k++) {
            int64_t first = cell_face[c * per_cell + k] / 2 * per_face;
            most += lists->ptr[first + per_face] - lists->ptr[first];
        }
        if (total + most > capacity) {
            capacity = (total + most) * 2 + 1024;
            int32_t *grown = array_grow(table->idx, capacity, sizeof *grown);
            if (grown == NULL) {
                status = fail_memory(error, "neighbours of cells");
                goto done;
            }
            table->idx = grown;
        }
        united = table->idx + total;
        int64_t count = 0;
        for (int k = 0; k < per_cell; k++) {
            int64_t first = cell_face[c * per_cell + k] / 2 * per_face;
            for (int64_t i = lists->ptr[first]; i < lists->ptr[first + per_face]; i++) {
                united[count++] = lists->idx[i];
            }
        }
        total += sort_unique(united, count);
        table->ptr[c + 1] = total;
    }
done:
    return status;
}

static int64_t find_in(const int32_t *index, int64_t count, int32_t value)
{
    int64_t low = 0, high = count;
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (index[middle] < value) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* One row of the smoothed table. */
static void smooth_cell(const struct cells *cells, const struct faces *faces, int per_face,
                        const int64_t *cell_face, const struct neighbours *lists, const double *face_phi,
                        int64_t c, struct smoothed_table *table)
{
    int dim = cells->dim, per_cell = dim + 1;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    double volume = cell_volume(cells, c);
    int64_t row = table->ptr[c], length = table->ptr[c + 1] - row;
    for (int k = 0; k < per_cell; k++) {
        int64_t face = cell_face[c * per_cell + k] / 2;
        double sign = cell_face[c * per_cell + k] % 2 == 0 ? 1.0 : -1.0;
        double area[3];
        face_area_vector(dim, cells->x, faces->node + face * dim, area);
        for (int g = 0; g < per_face; g++) {
            int64_t point = face * per_face + g;
            for (int64_t i = lists->ptr[point]; i < lists->ptr[point + 1]; i++) {
                int64_t at = row + find_in(table->idx + row, length, lists->idx[i]);
                table->phi[at] += rule.weight[g] * face_phi[i] / per_cell;
                for (int a = 0; a < dim; a++) {
                    table->dphi[at * dim + a] += sign * area[a] * rule.weight[g] * face_phi[i] / volume;
                }
            }
        }
    }
}

enum status shape_smooth(const struct cells *cells, const struct faces *faces, int per_face,
                         const struct neighbours *face_neighbours, const double *face_phi,
                         struct smoothed_table *table, struct error *error)
{
    enum status status;
    int64_t *cell_face = NULL;
    *table = (struct smoothed_table){.count = cells->count};
    TRY(NEW_ARRAY(&cell_face, cells->count * (cells->dim + 1), error));
    TRY(NEW_ARRAY(&table->ptr, cells->count + 1, error));
    TRY(faces_of_cells(cells, faces, cell_face, error));
    TRY(unite_lists(cells, per_face, cell_face, face_neighbours, table, error));
    TRY(NEW_ARRAY(&table->phi, table->ptr[cells->count], error));
    TRY(NEW_ARRAY(&table->dphi, table->ptr[cells->count] * cells->dim, error));
#pragma omp parallel for schedule(static)
    for (int64_t c = 0; c < cells->count; c++) {
        smooth_cell(cells, faces, per_face, cell_face, face_neighbours, face_phi, c, table);
    }
done:
    free(cell_face);
    if (status != STATUS_OK) {
        smoothed_table_free(table);
    }
    return status;
}

void smoothed_table_free(struct smoothed_table *table)
{
    free(table->ptr);
    free(table->idx);
    free(table->phi);
    free(table->dphi);
    *table = (struct smoothed_table){0};
}
