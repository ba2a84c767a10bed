/* What is done along the coarse fields at many nodes, for several instruction sets; private to
 * coarse_space.c. */
#ifndef SOLID_COARSE_KERNEL_H
#define SOLID_COARSE_KERNEL_H

#include "solid/coarse_space.h"

/* Amounts by monomial and direction: those of the coarse fields of all centres at once. */
typedef of_centres coarse_amounts[4][3];

struct coarse_kernels {
    /* sum = what v, times weight unless NULL, does at the nodes from `begin` to before `end` */
    void (*collect)(const struct coarse_space *coarse, int64_t begin, int64_t end, const double *weight,
                    const double *v, coarse_amounts sum);
    /* u += amount there */
    void (*add)(const struct coarse_space *coarse, int64_t begin, int64_t end, const coarse_amounts amount,
                double *u);
};

#endif
