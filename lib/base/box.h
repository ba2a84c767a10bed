/* The box around points, along the axes. */
#ifndef BASE_BOX_H
#define BASE_BOX_H

#include <stdint.h>

struct box {
    int dim;
    double low[3], high[3]; /* dim; of no points: infinity, -infinity */
};

/* The box of the points x[count * dim]. */
struct box box_of(int dim, int64_t count, const double *x);

/* Let it hold these points, too. */
void box_add(struct box *box, int64_t count, const double *x);

/* Its longest side, and its diagonal, in the units of x. */
double box_side(const struct box *box);
double box_diagonal(const struct box *box);

#endif
