#include "solid/constraint/measured.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
/* The part of a condition that must be independent of the others, squared. */
static const double least_independent = 0.01;

static bool is_exact(const struct measured *measured, int64_t i)
{
    return !(measured->deviation[i] > 0.0);
}

/* The mean squared distance from their centre of the points that are not exact; *count of them. */
static double gyration2(const struct measured *measured, int64_t *count)
{
    double sum = 0.0, centre[3] = {0.0, 0.0, 0.0};
    *count = 0;
    for (int64_t i = 0; i < measured->count; i++) {
        for (int a = 0; a < measured->dim && !is_exact(measured, i); a++) {
            centre[a] += measured->x[i * measured->dim + a];
        }
        *count += !is_exact(measured, i);
    }
    for (int64_t i = 0; i < measured->count; i++) {
        for (int a = 0; a < measured->dim && !is_exact(measured, i); a++) {
            double offset = measured->x[i * measured->dim + a] - centre[a] / (double)*count;
            sum += offset * offset / (double)*count;
        }
    }
    return sum;
}

double measured_energy(const struct measured *measured, const struct measured_region *region)
{
    int64_t count;
    int dim = measured->dim;
    double ball = dim == 2 ? sqrt(region->volume / pi) : cbrt(0.75 * region->volume / pi);
    double radius = fmax(ball, sqrt((dim + 2.0) / dim * gyration2(measured, &count)));
    double stiffness = dim == 2 ? 4.0 * pi * region->shear_modulus / log(region->body_size / radius)
                                : 6.0 * pi * region->shear_modulus * radius;
    double independent = (double)(count < region->nodes ? count : region->nodes);
    return count > 0 ? stiffness * region->model_error * region->model_error / independent : 0.0;
}

/* A bound of the difference of any two displacements, m. */
static double farthest_apart(const struct measured *measured)
{
    double sum = 0.0;
    for (int a = 0; a < measured->dim; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t i = 0; i < measured->count; i++) {
            low = fmin(low, measured->u[i * measured->dim + a]); /* of a number and NAN: the number */
            high = fmax(high, measured->u[i * measured->dim + a]);
        }
        sum += high > low ? (high - low) * (high - low) : 0.0;
    }
    return sqrt(sum);
}

/* The distance of two points, and the difference of their displacements in the components that are known for
 * both. */
static void differences(const struct measured *measured, struct measured_pair *pair)
{
    int dim = measured->dim;
    double moves = 0.0;
    for (int a = 0; a < dim; a++) {
        double difference = measured->u[pair->first * dim + a] - measured->u[pair->second * dim + a];
        moves += isnan(difference) ? 0.0 : difference * difference;
    }
    pair->distance = vector_distance(dim, measured->x + pair->first * dim, measured->x + pair->second * dim);
    pair->apart = sqrt(moves);
}

enum status measured_compare(const struct measured *measured, struct measured_pair *found,
                             struct error *error)
{
    SCRATCH struct placed *sorted = NULL; /* exact points by their first coordinates */
    double window = farthest_apart(measured);
    int64_t count = 0;
    *found = (struct measured_pair){.first = -1, .second = -1};
    RETURN_IF_ERROR(NEW_ARRAY(&sorted, measured->count, error));
    for (int64_t i = 0; i < measured->count; i++) {
        if (is_exact(measured, i)) {
            sorted[count++] = (struct placed){measured->x[i * measured->dim], i};
        }
    }
    qsort(sorted, (size_t)count, sizeof *sorted, compare_placed);
    for (int64_t s = 0; s < count; s++) {
        for (int64_t t = s + 1; t < count && sorted[t].place - sorted[s].place <= window; t++) {
            int64_t i = sorted[s].item, k = sorted[t].item;
            struct measured_pair pair = {.first = i < k ? i : k, .second = i < k ? k : i};
            differences(measured, &pair);
            bool before = found->second < 0 || pair.second < found->second ||
                          (pair.second == found->second && pair.first < found->first);
            *found = pair.apart > pair.distance && before ? pair : *found;
        }
    }
    return STATUS_OK;
}

enum status measured_dependent(const struct constraint_rows *rows, int64_t node_count, bool *dependent,
                               struct error *error)
{
    FREED_BY(envelope_free) struct envelope factor = {0};
    RETURN_IF_ERROR(constraint_factorise(rows, node_count, NULL, least_independent, &factor, error));
    for (int64_t r = 0; r < rows->count; r++) {
        dependent[factor.order[r]] = envelope_is_dropped(&factor, r);
    }
    return STATUS_OK;
}
