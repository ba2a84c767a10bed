/* The diagonal mass, on the nodes and on the coarse fields. */
#include "solid/preconditioner/preconditioner_private.h"

#include <string.h>

/* weight = Z^T D Z */
static void weigh_coarse_space(struct preconditioner *p)
{
    const struct coarse_space *coarse = &p->coarse;
    const struct sparse *shares = &coarse->shares;
    int64_t fields = p->dim + 1;
    double one[4], other[4];
    memset(p->weight, 0, (size_t)(coarse->count * coarse->count) * sizeof *p->weight);
    for (int64_t n = 0; n < p->node_count; n++) {
        for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
            coarse_space_values(coarse, n, shares->idx[i], shares->value[i], one);
            for (int64_t k = shares->ptr[n]; k < shares->ptr[n + 1]; k++) {
                double *to = p->weight + shares->idx[i] * fields * coarse->count + shares->idx[k] * fields;
                coarse_space_values(coarse, n, shares->idx[k], shares->value[k], other);
                for (int64_t m = 0; m < fields * fields; m++) {
                    to[m / fields * coarse->count + m % fields] +=
                        p->stiffness[n] * one[m / fields] * other[m % fields];
                }
            }
        }
    }
}

void preconditioner_set_mass(struct preconditioner *p, const double *stiffness)
{
    for (int64_t n = 0; n < p->node_count; n++) {
        p->stiffness[n] = stiffness[n];
        p->mass[n] = p->at_rest != NULL ? stiffness[n] / p->at_rest[n] : stiffness[n];
    }
    if (p->size > 0) {
        weigh_coarse_space(p);
    }
}

void preconditioner_restore(struct preconditioner *p, const struct solid_system *system)
{
    if (p->size > 0) {
        weigh_coarse_space(p);
    }
    preconditioner_factorise_both(p, system);
}
