#include "solid/constraint/measured.h"

#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double most_deviations = 6.0; /* a larger difference, by its standard deviation, is not noise */
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

/* A bound of the difference of any two displacements, noise included, m. */
static double farthest_apart(const struct measured *measured)
{
    double sum = 0.0, most = 0.0;
    for (int a = 0; a < measured->dim; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t i = 0; i < measured->count; i++) {
            low = fmin(low, measured->u[i * measured->dim + a]); /* of a number and NAN: the number */
            high = fmax(high, measured->u[i * measured->dim + a]);
        }
        sum += high > low ? (high - low) * (high - low) : 0.0;
    }
    for (int64_t i = 0; i < measured->count; i++) {
        most = fmax(most, measured->deviation[i]);
    }
    return sqrt(sum) + most_deviations * sqrt(2.0) * most;
}

/* The distance of two points, and the difference of their displacements in the components that are known for
 * both; -1 if there is no such component. */
static void differences(const struct measured *measured, int64_t i, int64_t k, double *distance,
                        double *apart)
{
    int dim = measured->dim, known = 0;
    double places = 0.0, moves = 0.0;
    for (int a = 0; a < dim; a++) {
        double offset = measured->x[i * dim + a] - measured->x[k * dim + a];
        double difference = measured->u[i * dim + a] - measured->u[k * dim + a];
        places += offset * offset;
        if (!isnan(difference)) {
            moves += difference * difference;
            known++;
        }
    }
    *distance = sqrt(places);
    *apart = known > 0 ? sqrt(moves) : -1.0;
}

static void note_pair(struct measured_pair *pair, int64_t i, int64_t k, double distance, double apart)
{
    int64_t first = i < k ? i : k, second = i < k ? k : i;
    if (pair->count++ == 0 || second < pair->second || (second == pair->second && first < pair->first)) {
        pair->first = first;
        pair->second = second;
        pair->distance = distance;
        pair->apart = apart;
    }
}

enum status measured_compare(const struct measured *measured, double same, struct measured_pair *exact,
                             struct measured_pair *others, struct measured_pair *repeated,
                             struct error *error)
{
    SCRATCH struct placed *sorted = NULL; /* points by their first coordinates */
    double window = fmax(same, farthest_apart(measured));
    *exact = *others = *repeated = (struct measured_pair){.first = -1, .second = -1};
    RETURN_IF_ERROR(NEW_ARRAY(&sorted, measured->count, error));
    for (int64_t i = 0; i < measured->count; i++) {
        sorted[i] = (struct placed){measured->x[i * measured->dim], i};
    }
    qsort(sorted, (size_t)measured->count, sizeof *sorted, compare_placed);
    for (int64_t s = 0; s < measured->count; s++) {
        for (int64_t t = s + 1; t < measured->count && sorted[t].place - sorted[s].place <= window; t++) {
            int64_t i = sorted[s].item, k = sorted[t].item;
            bool both = is_exact(measured, i) && is_exact(measured, k);
            double distance, apart;
            double deviation = hypot(measured->deviation[i], measured->deviation[k]);
            differences(measured, i, k, &distance, &apart);
            if (apart > distance + most_deviations * deviation) {
                note_pair(both ? exact : others, i, k, distance, apart);
            } else if (both && apart >= 0.0 && distance <= same) {
                note_pair(repeated, i, k, distance, apart);
            }
        }
    }
    return STATUS_OK;
}

enum status measured_dependent(const struct constraint_rows *rows, int64_t node_count, bool *dependent,
                               struct error *error)
{
    FREED_BY(envelope_free) struct envelope factor = {0};
    NEW_SCRATCH(double, mass, node_count, error);
    for (int64_t n = 0; n < node_count; n++) {
        mass[n] = 1.0;
    }
    RETURN_IF_ERROR(constraint_factorise(rows, node_count, mass, least_independent, 0.0, &factor, error));
    for (int64_t r = 0; r < rows->count; r++) {
        dependent[factor.order[r]] = envelope_is_dropped(&factor, r);
    }
    return STATUS_OK;
}
