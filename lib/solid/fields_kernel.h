/* What is done along the fields at many nodes, for several instruction sets; private to fields.c. */
#ifndef SOLID_FIELDS_KERNEL_H
#define SOLID_FIELDS_KERNEL_H

#include "solid/fields.h"

/* Amounts by monomial and direction: those of the fields of all centres at once. */
typedef of_centres field_amounts[4][3];

struct field_kernels {
    /* sum = what v, times weight unless NULL, does at the nodes from `begin` to before `end` */
    void (*collect)(const struct fields *fields, int64_t begin, int64_t end, const double *weight,
                    const double *v, field_amounts sum);
    /* u += amount there */
    void (*add)(const struct fields *fields, int64_t begin, int64_t end, const field_amounts amount,
                double *u);
};

#endif
