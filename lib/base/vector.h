/* Vectors of dim components, 2 or 3, and determinants. */
#pragma once

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Cosine from which unit vectors have about the same direction (60 degrees): a facet's normal and another's,
 * reversed, if the facets face each other. And from which two consecutive changes are a geometric sequence.
 */
#define SAME_DIRECTION 0.5
#define GEOMETRIC_SEQUENCE 0.99

static inline double vector_dot(int64_t size, const double *a, const double *b)
{
    double sum = 0.0;
    for (int64_t i = 0; i < size; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* Length of the longest of `count` vectors; *which, unless NULL: its number. */
static inline double vector_longest(int dim, int64_t count, const double *x, int64_t *which)
{
    double most = 0.0;
    for (int64_t n = 0; n < count; n++) {
        double length2 = vector_dot(dim, x + n * dim, x + n * dim);
        if (length2 > most) {
            most = length2;
            if (which != NULL) {
                *which = n;
            }
        }
    }
    return sqrt(most);
}

/* |a - b|^2 */
static inline double vector_distance2(int dim, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < dim; i++) {
        double difference = a[i] - b[i];
        sum += difference * difference;
    }
    return sum;
}

static inline double vector_length(int dim, const double *a)
{
    return sqrt(vector_dot(dim, a, a));
}

/* |A v|^2 with A[dim * dim], by rows; NULL: |v|^2. */
static inline double vector_square(int dim, const double *A, const double *v)
{
    double square = 0.0;
    if (A == NULL) {
        return vector_dot(dim, v, v);
    }
    for (int a = 0; a < dim; a++) {
        double along = vector_dot(dim, A + a * dim, v);
        square += along * along;
    }
    return square;
}

static inline double vector_distance(int dim, const double *a, const double *b)
{
    return sqrt(vector_distance2(dim, a, b));
}

/* difference = a - b */
static inline void vector_subtract(int dim, const double *a, const double *b, double *difference)
{
    for (int i = 0; i < dim; i++) {
        difference[i] = a[i] - b[i];
    }
}

/* x = a + share (b - a); x may be a or b. */
static inline void vector_between(int dim, const double *a, const double *b, double share, double *x)
{
    for (int i = 0; i < dim; i++) {
        x[i] = a[i] + share * (b[i] - a[i]);
    }
}

/* The middle of the corners corner[count], which are indices of x. */
static inline void vector_middle(int dim, const double *x, int count, const int32_t *corner, double *middle)
{
    for (int i = 0; i < dim; i++) {
        middle[i] = 0.0;
        for (int k = 0; k < count; k++) {
            middle[i] += x[(int64_t)corner[k] * dim + i] / count;
        }
    }
}

/* sum = sum + factor x */
static inline void add_scaled(int dim, double factor, const double *x, double *sum)
{
    for (int i = 0; i < dim; i++) {
        sum[i] += factor * x[i];
    }
}

/* Make x a unit vector; zeros stay zeros. */
static inline void vector_normalise(int dim, double *x)
{
    double length = vector_length(dim, x);
    for (int i = 0; i < dim && length > 0.0; i++) {
        x[i] /= length;
    }
}

/* w = u x v, in three dimensions */
static inline void vector_cross(const double *u, const double *v, double *w)
{
    w[0] = u[1] * v[2] - u[2] * v[1];
    w[1] = u[2] * v[0] - u[0] * v[2];
    w[2] = u[0] * v[1] - u[1] * v[0];
}

/* Determinants of the rows a and b in two dimensions, and of a, b and c in three. */
static inline double determinant2(const double *a, const double *b)
{
    return a[0] * b[1] - a[1] * b[0];
}

static inline double determinant3(const double *a, const double *b, const double *c)
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* The inverse of the matrix with the rows a, b and c; returns its determinant. */
static inline double matrix_inverse(const double *a, const double *b, const double *c, double inverse[3][3])
{
    const double *row[3] = {a, b, c};
    double determinant = determinant3(a, b, c);
    for (int i = 0; i < 3; i++) {
        const double *next = row[(i + 1) % 3], *last = row[(i + 2) % 3];
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            inverse[k][i] = (next[p] * last[q] - next[q] * last[p]) / determinant;
        }
    }
    return determinant;
}
