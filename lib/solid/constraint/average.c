#include "solid/constraint/average.h"
#include "base/vector.h"

struct average average_of_boundary(const struct boundary_averages *averages, int64_t a)
{
    int64_t first = averages->ptr[a];
    return (struct average){averages->ptr[a + 1] - first, averages->idx + first, averages->phi + first};
}

/* The dimension is known when compiling, here and below. */
static inline void take(const struct average *average, int dim, const double *u, double *mean)
{
    double sum[3] = {0.0, 0.0, 0.0};
    for (int64_t i = 0; i < average->length; i++) {
        const double *at = u + (int64_t)average->idx[i] * dim;
        add_scaled(dim, average->phi[i], at, sum);
    }
    for (int a = 0; a < dim; a++) {
        mean[a] = sum[a];
    }
}

void average_take(const struct average *average, int dim, const double *u, double *mean)
{
    if (dim == 2) {
        take(average, 2, u, mean);
    } else {
        take(average, 3, u, mean);
    }
}

void average_place(const struct average *average, int dim, const double *rest, const double *u, double *place)
{
    average_take(average, dim, u, place);
    for (int a = 0; a < dim; a++) {
        place[a] += rest[a];
    }
}

static inline void spread(const struct average *average, int dim, const double *amount, double *u)
{
    for (int64_t i = 0; i < average->length; i++) {
        int64_t node = average->idx[i];
        add_scaled(dim, average->phi[i], amount, u + node * dim);
    }
}

void average_spread(const struct average *average, int dim, const double *amount, double *u)
{
    if (dim == 2) {
        spread(average, 2, amount, u);
    } else {
        spread(average, 3, amount, u);
    }
}

void average_add_squares(const struct average *average, double stiffness, double *mass)
{
    for (int64_t i = 0; i < average->length; i++) {
        mass[average->idx[i]] += stiffness * average->phi[i] * average->phi[i];
    }
}
