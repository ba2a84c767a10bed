/* Functions shared by the files of the preconditioner; see preconditioner.h. */
#pragma once

#include "solid/preconditioner/preconditioner.h"

/* x := P x, in two passes: of nearly dependent rows one pass leaves 1e-6 of what it takes. */
void preconditioner_project(struct preconditioner *preconditioner, double *x);

MUST_CHECK enum status coarse_mean_begin(const struct coarse_space *coarse, struct coarse_mean *mean,
                                         struct error *error);
void coarse_mean_free(struct coarse_mean *mean);

/* Set the mean to zero; add factor times that of one coarse field; take those of an average, Z^T phi, for one
 * component of the displacement, without nodes that are held; held[node_count], or NULL: none is. */
void coarse_mean_clear(const struct coarse_space *coarse, struct coarse_mean *mean);
void coarse_mean_add(const struct coarse_space *coarse, int64_t field, double value,
                     struct coarse_mean *mean);
void coarse_mean_of_average(const struct coarse_space *coarse, const struct average *average,
                            const bool *held, struct coarse_mean *mean);

/* The coarse fields' means of averages: a row for each. */
MUST_CHECK enum status coarse_mean_table(const struct coarse_space *coarse, int64_t count,
                                         struct average (*average)(const void *context, int64_t i),
                                         const void *context, const bool *held, struct coarse_mean *mean,
                                         struct sparse *table, struct error *error);

/* Set up G Z: the rows of the conditions, applied to the coarse fields. */
MUST_CHECK enum status preconditioner_build_coarse_constraints(const struct solid_system *system,
                                                               struct preconditioner *preconditioner,
                                                               struct error *error);

/* matrix[size * size], its lower triangle, += the stiffness along the coarse fields of the contact nodes that
 * A counts in; `only` those of these, or NULL: all. */
void preconditioner_add_contacts(struct preconditioner *preconditioner, const struct solid_system *system,
                                 double *matrix);

/* matrix[size * size] = the Cholesky factor of A that belongs to body + contacts. Returns the part of D that
 * it has, so that it is positive definite; 0: none makes it so. */
double preconditioner_factorise(const struct preconditioner *preconditioner, double *matrix);

/* The Cholesky factor, from what body, contacts and mass are. */
void preconditioner_factorise_both(struct preconditioner *preconditioner, const struct solid_system *system);

/* column[rows of the conditions] = (G G^T)^-1 G Z e_k: the multipliers by which P changes coarse field k.
 * False: no condition acts on it. */
bool preconditioner_constrain_field(const struct preconditioner *preconditioner, int64_t k, double *column);

/* Set the stiffness of body and penalties along the coarse fields, as it is at the last evaluation of a body
 * of smoothed cells. */
MUST_CHECK enum status preconditioner_assemble(struct preconditioner *preconditioner,
                                               struct solid_system *system, struct error *error);
