/* The box around points, along the axes. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct box {
    int dim;
    double low[3], high[3]; /* dim; of no points: infinity, -infinity */
};

/* The box of the points x[count * dim]. */
struct box box_of(int dim, int64_t count, const double *x);

/* The box of the nodes node[count] of x. */
struct box box_of_nodes(int dim, const double *x, const int32_t *node, int64_t count);

/* Whether two boxes overlap or touch. */
bool box_meets(const struct box *one, const struct box *other);

/* Extend the box to contain these points. */
void box_add(struct box *box, int64_t count, const double *x);

/* Its longest side, and its diagonal, in the units of x. */
double box_side(const struct box *box);
double box_diagonal(const struct box *box);

/* "0 0 0 to 0.1 0.1 0.2 m", of a box in m; returns text. */
const char *box_text(const struct box *box, char text[128]);
