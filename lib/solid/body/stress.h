/* Stresses of points and smoothed cells of any material, one at a time; private to lib/solid. */
#pragma once

#include "solid/body/kernel.h"

/* F of point q at the last evaluation. */
void stress_gradient(const struct body *body, int64_t q, double F[9]);

/* F[9]: the matrix of a point from rows with the stride `apart`; in plane strain F33 = 1. */
void stress_matrix(int dim, const double *row, int64_t apart, double F[9]);

/* Weighted stresses P of a block of points. */
void stress_points(const struct body *body, const struct block *block, block_rows P);

/* Weighted stresses of a block of cells, P on F and T on F_h: see smoothed_cells.h. */
void stress_cells(const struct body *body, const struct block *block, block_rows P, block_rows T);

/* Energy of the active stress at a point where its curve is 1, and at present, per volume, Pa. */
double stress_whole_active_energy(const struct body *body, int64_t point, const double F[9]);
double stress_active_energy(const struct body *body, int64_t point, const double F[9]);

/* Energy (11b) of a cell of volume ratio J, per volume, Pa; 0 at points without cells. */
double stress_coupling_energy(const struct body *body, int64_t point, const double F[9], double J);

/* Z = 4 (3 + F^T F)^-1 of (10). */
void stress_limit_stretch(const double F[9], double Z[9]);

/* Energy (10) of what varies within a cell at the last evaluation, J (2D: J/m); *volumetric: that of s, which
 * is not in it. */
double stress_variance_energy(const struct body *body, int64_t point, double *volumetric);
