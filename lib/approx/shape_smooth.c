/* Conforming cell smoothing: shape functions on faces to gradients in cells. */
#include "approx/shape.h"

#include "approx/quadrature.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Cells of one unit of work. */
static const int64_t chunk_cells = 256;

/* What the cells are smoothed from. */
struct smoothing {
    const struct cells *cells;
    const struct faces *faces;
    int per_face;
    const struct neighbours *lists; /* of the face points */
    const double *phi;              /* following lists->idx */
    int64_t *cell_face;             /* (dim + 1) for each cell: face index * 2 + side */
};

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

/* A set of node indices: node n is in it when place[n] < count and index[place[n]] == n, so that emptying it
 * costs nothing (Briggs and Torczon 1993). */
struct node_set {
    int32_t *place; /* for each node of the cloud; stale entries do no harm */
    int32_t *index; /* members */
    int64_t count, capacity;
    double *sums; /* capacity * 4: phi and gradient of each member */
};

static void node_set_free(struct node_set *set)
{
    free(set->place);
    free(set->index);
    free(set->sums);
}

/* Room for `count` members. */
static enum status node_set_reserve(struct node_set *set, int64_t node_count, int64_t count,
                                    struct error *error)
{
    enum status status = STATUS_OK;
    if (set->place == NULL) {
        TRY(NEW_ARRAY(&set->place, node_count, error));
    }
    if (count > set->capacity) {
        free(set->index);
        free(set->sums);
        set->index = NULL;
        set->sums = NULL;
        set->capacity = 0;
        TRY(NEW_ARRAY(&set->index, 2 * count, error));
        TRY(NEW_ARRAY(&set->sums, 2 * count * 4, error));
        set->capacity = 2 * count;
    }
done:
    return status;
}

/* Insertion sort: members come as a few ascending runs. */
static void node_set_sort(struct node_set *set)
{
    for (int64_t i = 1; i < set->count; i++) {
        int32_t value = set->index[i];
        int64_t at = i;
        for (; at > 0 && set->index[at - 1] > value; at--) {
            set->index[at] = set->index[at - 1];
        }
        set->index[at] = value;
    }
}

/* The nodes of all face points of a cell, ascending, into `set`. */
static enum status unite(const struct smoothing *smoothing, int64_t cell, struct node_set *set,
                         struct error *error)
{
    const struct neighbours *lists = smoothing->lists;
    int per_cell = smoothing->cells->dim + 1, per_face = smoothing->per_face;
    const int64_t *cell_face = smoothing->cell_face + cell * per_cell;
    int64_t most = 0;
    for (int k = 0; k < per_cell; k++) {
        int64_t first = cell_face[k] / 2 * per_face;
        most += lists->ptr[first + per_face] - lists->ptr[first];
    }
    enum status status = node_set_reserve(set, smoothing->cells->node_count, most, error);
    if (status != STATUS_OK) {
        return status;
    }
    set->count = 0;
    for (int k = 0; k < per_cell; k++) {
        int64_t first = cell_face[k] / 2 * per_face;
        for (int64_t i = lists->ptr[first]; i < lists->ptr[first + per_face]; i++) {
            int32_t node = lists->idx[i], place = set->place[node];
            if (place >= set->count || set->index[place] != node) {
                set->place[node] = (int32_t)set->count;
                set->index[set->count++] = node;
            }
        }
    }
    node_set_sort(set);
    return STATUS_OK;
}

/* The lists of one chunk of cells, and their lengths into ptr[cell + 1]. */
struct chunk {
    int32_t *index;
    int64_t count, capacity;
};

static enum status unite_chunk(const struct smoothing *smoothing, int64_t first, int64_t last,
                               struct node_set *set, struct chunk *chunk, int64_t *ptr, struct error *error)
{
    for (int64_t c = first; c < last; c++) {
        enum status status = unite(smoothing, c, set, error);
        if (status != STATUS_OK) {
            return status;
        }
        if (chunk->count + set->count > chunk->capacity) {
            int64_t capacity = 2 * (chunk->count + set->count) + 1024;
            int32_t *grown = array_grow(chunk->index, capacity, sizeof *grown);
            if (grown == NULL) {
                return fail_memory(error, "neighbours of cells");
            }
            chunk->index = grown;
            chunk->capacity = capacity;
        }
        memcpy(chunk->index + chunk->count, set->index, (size_t)set->count * sizeof *set->index);
        chunk->count += set->count;
        ptr[c + 1] = set->count;
    }
    return STATUS_OK;
}

/* The row of one cell: its list is in the table already. */
static enum status smooth_cell(const struct smoothing *smoothing, int64_t cell, struct node_set *set,
                               struct smoothed_table *table, struct error *error)
{
    const struct cells *cells = smoothing->cells;
    const struct neighbours *lists = smoothing->lists;
    int dim = cells->dim, per_cell = dim + 1, per_face = smoothing->per_face;
    int64_t row = table->ptr[cell], count = table->ptr[cell + 1] - row;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    enum status status = node_set_reserve(set, cells->node_count, count, error);
    if (status != STATUS_OK) {
        return status;
    }
    for (int64_t i = 0; i < count; i++) {
        set->place[table->idx[row + i]] = (int32_t)i;
    }
    double volume = cell_volume(cells, cell);
    memset(set->sums, 0, (size_t)count * 4 * sizeof *set->sums);
    for (int k = 0; k < per_cell; k++) {
        int64_t oriented = smoothing->cell_face[cell * per_cell + k], face = oriented / 2;
        double area[3] = {0.0, 0.0, 0.0};
        face_area_vector(dim, cells->x, smoothing->faces->node + face * dim, area);
        for (int g = 0; g < per_face; g++) {
            int64_t point = face * per_face + g;
            double share = rule.weight[g], outward = (oriented % 2 == 0 ? share : -share) / volume;
            const double factor[4] = {share / per_cell, outward * area[0], outward * area[1],
                                      outward * area[2]};
            for (int64_t i = lists->ptr[point]; i < lists->ptr[point + 1]; i++) {
                double *sum = set->sums + 4 * (int64_t)set->place[lists->idx[i]];
                for (int a = 0; a < 4; a++) {
                    sum[a] += factor[a] * smoothing->phi[i];
                }
            }
        }
    }
    for (int64_t i = 0; i < count; i++) {
        table->phi[row + i] = set->sums[4 * i];
        for (int a = 0; a < dim; a++) {
            table->dphi[(row + i) * dim + a] = set->sums[4 * i + 1 + a];
        }
    }
    return STATUS_OK;
}

/* One pass over all cells in chunks, shared by threads: the lists into chunks[], or, when that is NULL, the
 * rows into the table. */
static enum status pass(const struct smoothing *smoothing, struct chunk *chunks, struct smoothed_table *table,
                        struct error *error)
{
    enum status failure = STATUS_OK;
    int64_t cell_count = smoothing->cells->count;
#pragma omp parallel
    {
        struct node_set set = {0};
        struct error own;
#pragma omp for schedule(dynamic, 1)
        for (int64_t first = 0; first < cell_count; first += chunk_cells) {
            int64_t last = first + chunk_cells < cell_count ? first + chunk_cells : cell_count;
            enum status outcome = STATUS_OK;
            if (chunks != NULL) {
                outcome =
                    unite_chunk(smoothing, first, last, &set, &chunks[first / chunk_cells], table->ptr, &own);
            }
            for (int64_t c = first; chunks == NULL && outcome == STATUS_OK && c < last; c++) {
                outcome = smooth_cell(smoothing, c, &set, table, &own);
            }
            if (outcome != STATUS_OK) {
#pragma omp critical(smooth_failure)
                {
                    failure = outcome;
                    *error = own;
                }
            }
        }
        node_set_free(&set);
    }
    return failure;
}

/* Lists of the cells. */
static enum status unite_lists(const struct smoothing *smoothing, struct smoothed_table *table,
                               struct error *error)
{
    enum status status;
    struct chunk *chunks = NULL;
    int64_t chunk_count = (table->count + chunk_cells - 1) / chunk_cells, at = 0;
    TRY(NEW_ARRAY(&chunks, chunk_count, error));
    TRY(pass(smoothing, chunks, table, error));
    for (int64_t c = 0; c < table->count; c++) {
        table->ptr[c + 1] += table->ptr[c];
    }
    TRY(NEW_ARRAY(&table->idx, table->ptr[table->count], error));
    for (int64_t c = 0; c < chunk_count; c++) {
        if (chunks[c].count > 0) {
            memcpy(table->idx + at, chunks[c].index, (size_t)chunks[c].count * sizeof *table->idx);
        }
        at += chunks[c].count;
    }
done:
    for (int64_t c = 0; chunks != NULL && c < chunk_count; c++) {
        free(chunks[c].index);
    }
    free(chunks);
    return status;
}

enum status shape_smooth(const struct cells *cells, const struct faces *faces, int per_face,
                         const struct neighbours *face_neighbours, const double *face_phi,
                         struct smoothed_table *table, struct error *error)
{
    enum status status;
    struct smoothing smoothing = {
        .cells = cells, .faces = faces, .per_face = per_face, .lists = face_neighbours, .phi = face_phi};
    *table = (struct smoothed_table){.count = cells->count};
    TRY(NEW_ARRAY(&smoothing.cell_face, cells->count * (cells->dim + 1), error));
    TRY(NEW_ARRAY(&table->ptr, cells->count + 1, error));
    TRY(faces_of_cells(cells, faces, smoothing.cell_face, error));
    TRY(unite_lists(&smoothing, table, error));
    TRY(NEW_ARRAY(&table->phi, table->ptr[cells->count], error));
    TRY(NEW_ARRAY(&table->dphi, table->ptr[cells->count] * cells->dim, error));
    TRY(pass(&smoothing, NULL, table, error));
done:
    free(smoothing.cell_face);
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
