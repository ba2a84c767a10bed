#include "approx/cells/cells.h"

#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>

enum { SLABS_MOST = 16 }; /* of the last axis, which threads share */

/* A cell in grid units: barycentric coordinate a of a point y is at[a] + slope[a] . y. */
struct simplex {
    double at[4], slope[4][3];
};

/* Range of the grid points of a cell along an axis, within the grid. */
static void range(const struct cells *cells, int64_t cell, int axis, int64_t size, int64_t *low,
                  int64_t *high)
{
    const int32_t *node = cells->node + cell * (cells->dim + 1);
    double least = INFINITY, most = -INFINITY;
    for (int a = 0; a <= cells->dim; a++) {
        double y = cells->x[node[a] * cells->dim + axis];
        least = fmin(least, y);
        most = fmax(most, y);
    }
    *low = (int64_t)ceil(fmin(fmax(least - COARSE_ROUND_OFF, 0), (double)size));
    *high = (int64_t)floor(fmax(fmin(most + COARSE_ROUND_OFF, (double)(size - 1)), -1));
}

/* Set *simplex from a cell; false if the cell is inverted or flat. */
static bool place_cell(const struct cells *cells, int64_t cell, int sign, struct simplex *simplex)
{
    int dim = cells->dim;
    const int32_t *node = cells->node + cell * (dim + 1);
    const double *origin = cells->x + node[0] * dim;
    double e[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; /* rows: edges */
    for (int a = 0; a < dim; a++) {
        vector_subtract(dim, cells->x + node[a + 1] * dim, origin, e[a]);
    }
    double inverse[3][3];
    if (!(matrix_inverse(e[0], e[1], e[2], inverse) * sign > 0)) {
        return false;
    }
    *simplex = (struct simplex){.at = {1, 0, 0, 0}};
    for (int a = 0; a < dim; a++) {
        for (int i = 0; i < dim; i++) {
            double slope = inverse[i][a];
            simplex->slope[a + 1][i] = slope;
            simplex->at[a + 1] -= slope * origin[i];
            simplex->slope[0][i] -= slope;
        }
        simplex->at[0] -= simplex->at[a + 1];
    }
    return true;
}

/* Restrict *low to *high, on entry the range of the box, to the grid points of row (., j, k) in a simplex. */
static void clip_row(const struct simplex *simplex, int dim, int64_t j, int64_t k, double margin,
                     int64_t *low, int64_t *high)
{
    double first = (double)*low, last = (double)*high;
    for (int a = 0; a <= dim; a++) {
        double value =
            simplex->at[a] + simplex->slope[a][1] * (double)j + simplex->slope[a][2] * (double)k + margin;
        double slope = simplex->slope[a][0];
        if (slope > 0) {
            first = fmax(first, ceil(-value / slope));
        } else if (slope < 0) {
            last = fmin(last, floor(-value / slope));
        } else if (value < 0) {
            last = -1;
        }
    }
    *low = first <= last ? (int64_t)first : 1;
    *high = first <= last ? (int64_t)last : 0;
}

/* Draw the part of one cell in the layers begin .. end - 1 of the last axis. */
static void draw(const struct simplex *simplex, const struct cells *cells, int64_t cell,
                 const int64_t size[3], int64_t begin, int64_t end, int32_t *owner, int64_t *doubly)
{
    int dim = cells->dim, last = dim - 1;
    int64_t low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (int i = 0; i < dim; i++) {
        range(cells, cell, i, size[i], &low[i], &high[i]);
    }
    low[last] = low[last] > begin ? low[last] : begin;
    high[last] = high[last] < end - 1 ? high[last] : end - 1;
    for (int64_t k = low[2]; k <= high[2]; k++) {
        for (int64_t j = low[1]; j <= high[1]; j++) {
            int64_t from = low[0], to = high[0], inner_from = low[0], inner_to = high[0];
            int32_t *row = owner + (k * size[1] + j) * size[0];
            clip_row(simplex, dim, j, k, COARSE_ROUND_OFF, &from, &to);
            clip_row(simplex, dim, j, k, -1e-6, &inner_from, &inner_to);
            for (int64_t i = from; i <= to; i++) {
                if (row[i] < 0) {
                    row[i] = (int32_t)cell;
                } else if (i >= inner_from && i <= inner_to) {
                    ++*doubly;
                }
            }
        }
    }
}

void raster_cells(const struct cells *cells, int sign, const int64_t size[3], int32_t *owner, int64_t *doubly)
{
    int64_t layers = size[cells->dim - 1], slabs = layers < SLABS_MOST ? layers : SLABS_MOST, twice = 0;
    for (int64_t v = 0; v < size[0] * size[1] * size[2]; v++) {
        owner[v] = -1;
    }
#pragma omp parallel for schedule(dynamic) reduction(+ : twice)
    for (int64_t s = 0; s < slabs; s++) {
        int64_t begin = (s * layers + slabs - 1) / slabs, end = ((s + 1) * layers + slabs - 1) / slabs;
        for (int64_t c = 0; c < cells->count; c++) {
            struct simplex simplex;
            int64_t low, high;
            range(cells, c, cells->dim - 1, layers, &low, &high);
            if (low < end && high >= begin && place_cell(cells, c, sign, &simplex)) {
                draw(&simplex, cells, c, size, begin, end, owner, &twice);
            }
        }
    }
    *doubly = twice;
}
