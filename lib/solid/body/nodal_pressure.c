/* Nodal pressures A pi = b by Chebyshev's iteration. Let S be diagonal with the entries sum_q N_a(q) w_q (1 /
 * k_q + epsilon / ((d + 2) mu_q)). The contribution of each point to A is at most that to S, and at least rho
 * times it, rho = 1 / (1 + max_q epsilon k_q / ((d + 2) mu_q)). So the eigenvalues of S^-1 A lie between rho
 * and 1. A fixed number of iterations, such that the modulus of each mode is right to `accuracy`, is a
 * polynomial of A. Like A^-1 it is symmetric and positive definite: the pressures derive from an energy for
 * any number of iterations. It is scaled to be exact at rho, where pressures are uniform. Saad 2003,
 * algorithm 12.1. */
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/nodal_volume.h"

#include <math.h>
#include <string.h>

/* A relative error x of the bulk modulus changes the strain of a body by about x mu / kappa, which must be at
 * most `effect`; x itself must be at most `most_inaccurate`. */
static const double effect = 2e-5, most_inaccurate = 0.02;
/* With augmentations an error of A^-1 is reduced by the ratio of the limited to the whole bulk modulus; the
 * admitted error is at most this. */
static const double augmented_accuracy = 0.01;

/* idx[]: the volumes that share points with volume a, including a, each once; NULL: only count. seen:
 * scratch, no entry of which equals a. Returns their number. */
static int64_t list_neighbours(const struct nodal_volumes *volumes, int vertices, int64_t a, int64_t *seen,
                               int32_t *idx)
{
    int64_t count = 0;
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        const int32_t *of = volumes->of_point + volumes->slot[i] / vertices * vertices;
        for (int k = 0; k < vertices; k++) {
            if (seen[of[k]] == a) {
                continue;
            }
            seen[of[k]] = a;
            if (idx != NULL) {
                idx[count] = of[k];
            }
            count++;
        }
    }
    return count;
}

/* Add the contributions of the points of volume a to row a of A and S; pressures->entry[b]: the place of
 * column b in the row. */
static void add_points(const struct body *body, int64_t a, struct nodal_pressures *pressures, double *bound)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int vertices = body->dim + 1;
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        int64_t slot = volumes->slot[i], q = slot / vertices;
        const struct material *material = &body->materials[body->material[q]];
        double rest = nodal_pressure_modulus(material),
               compliance = nodal_pressure_compliance(material, body->dim);
        if (!(rest > 0.0)) {
            continue;
        }
        double share = volumes->share[slot];
        double limited = fmin(rest, pressures->most * material->shear_modulus);
        pressures->weight[a] += share * (1.0 / limited - 1.0 / rest);
        pressures->matrix.value[pressures->entry[a]] += share * (1.0 / limited + compliance);
        *bound += share * (1.0 / limited + compliance);
        for (int k = 0; k < vertices; k++) {
            int64_t other = q * vertices + k;
            pressures->matrix.value[pressures->entry[volumes->of_point[other]]] -=
                compliance * share * volumes->share[other] / body->weight[q];
        }
    }
}

/* Set the rows and columns of A. */
static enum status lay_out(const struct body *body, struct sparse *matrix, struct error *error)
{
    const struct nodal_volumes *volumes = &body->volumes;
    int64_t count = volumes->count, entries = 0;
    int vertices = body->dim + 1;
    NEW_SCRATCH(int64_t, seen, count, error);
    memset(seen, -1, (size_t)count * sizeof *seen);
    for (int64_t a = 0; a < count; a++) {
        entries += list_neighbours(volumes, vertices, a, seen, NULL);
    }
    RETURN_IF_ERROR(sparse_new(count, count, entries, matrix, error));
    memset(seen, -1, (size_t)count * sizeof *seen);
    for (int64_t a = 0; a < count; a++) {
        int64_t at = matrix->ptr[a];
        matrix->ptr[a + 1] = at + list_neighbours(volumes, vertices, a, seen, matrix->idx + at);
    }
    return STATUS_OK;
}

/* Choose the iterations for eigenvalues from rho to 1. */
static void choose_iterations(struct nodal_pressures *pressures, double largest, double accuracy)
{
    double rho = 1.0 / (1.0 + largest), rate = acosh((1.0 + rho) / fmax(1.0 - rho, 1e-3));
    pressures->iterations = 1 + (int)(acosh(1.0 / accuracy) / rate);
    pressures->centre = 0.5 * (1.0 + rho);
    pressures->half = 0.5 * fmax(1.0 - rho, 1e-3);
    pressures->scale = 1.0 / (1.0 - 1.0 / cosh(pressures->iterations * rate));
}

enum status nodal_pressures_build(struct body *body, struct error *error)
{
    struct nodal_pressures *pressures = &body->volumes.pressures;
    int64_t count = body->volumes.count;
    RETURN_IF_ERROR(lay_out(body, &pressures->matrix, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->inverse, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->held, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->change, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->weight, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->scratch, 3 * count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressures->entry, count, error));
    RETURN_IF_ERROR(body_share_pressures(body, error));
    body_limit_bulk(body, INFINITY);
    return STATUS_OK;
}

/* Set the values of A, S^-1 and the weights. */
static void set_values(struct body *body, struct nodal_pressures *pressures)
{
    const struct sparse *matrix = &pressures->matrix;
    memset(matrix->value, 0, (size_t)matrix->ptr[matrix->row_count] * sizeof *matrix->value);
    memset(pressures->weight, 0, (size_t)matrix->row_count * sizeof *pressures->weight);
    for (int64_t a = 0; a < matrix->row_count; a++) {
        double bound = 0.0;
        for (int64_t at = matrix->ptr[a]; at < matrix->ptr[a + 1]; at++) {
            pressures->entry[matrix->idx[at]] = at;
        }
        add_points(body, a, pressures, &bound);
        pressures->inverse[a] = bound > 0.0 ? 1.0 / bound : 0.0;
    }
}

void nodal_pressures_renew(struct body *body)
{
    struct nodal_pressures *pressures = &body->volumes.pressures;
    double most = pressures->most, largest = 0.0, bulk = 0.0, limited_bulk = 0.0, least_share = 1.0,
           least_shear = INFINITY;
    for (int64_t m = 0; m < body->material_count; m++) {
        const struct material *material = &body->materials[m];
        double rest = nodal_pressure_modulus(material), limited = fmin(rest, most * material->shear_modulus);
        largest = fmax(largest, limited * nodal_pressure_compliance(material, body->dim));
        bulk = fmax(bulk, rest / material->shear_modulus);
        limited_bulk = fmax(limited_bulk, limited / material->shear_modulus);
        least_share = rest > 0.0 ? fmin(least_share, limited / rest) : least_share;
        least_shear = fmin(least_shear, material->shear_modulus);
    }
    pressures->least_shear = least_shear;
    pressures->slowest = 1.0 - least_share;
    pressures->limited = bulk > limited_bulk;
    choose_iterations(pressures, largest,
                      pressures->limited ? augmented_accuracy * limited_bulk / bulk
                                         : fmin(most_inaccurate, effect * fmax(bulk, 1.0)));
    set_values(body, pressures);
}

void body_limit_bulk(struct body *body, double most)
{
    struct nodal_pressures *pressures = &body->volumes.pressures;
    if (!body->averaged) {
        return;
    }
    pressures->most = most;
    nodal_pressures_renew(body);
    memset(pressures->held, 0, (size_t)body->volumes.count * sizeof *pressures->held);
    memset(pressures->change, 0, (size_t)body->volumes.count * sizeof *pressures->change);
}

bool body_is_limited(const struct body *body)
{
    return body->averaged && body->volumes.pressures.limited;
}

double body_augment(struct body *body, bool steady, double most, double strain)
{
    struct nodal_pressures *pressures = &body->volumes.pressures;
    const double *value = body->volumes.pressure, *weight = pressures->weight;
    body_share_collect_pressures(body);
    double now2 = 0.0, before2 = 0.0, both = 0.0, value2 = 0.0, least = strain * pressures->least_shear;
    int64_t count = body->volumes.count;
    for (int64_t a = 0; a < count; a++) {
        double change = value[a] - pressures->held[a];
        now2 += weight[a] * change * change;
        before2 += weight[a] * pressures->change[a] * pressures->change[a];
        both += weight[a] * change * pressures->change[a];
        value2 += weight[a] * fmax(value[a] * value[a], least * least);
    }
    double rate = fmin(before2 > 0.0 ? sqrt(now2 / before2) : INFINITY, pressures->slowest);
    double ahead = rate / (1.0 - rate), lack = now2 > 0.0 ? ahead * sqrt(now2 / value2) : 0.0;
    bool jumps = steady && lack > most && both > GEOMETRIC_SEQUENCE * sqrt(now2 * before2);
    for (int64_t a = 0; a < count; a++) {
        double change = value[a] - pressures->held[a];
        pressures->held[a] = value[a] + (jumps ? ahead * change : 0.0);
        pressures->change[a] = jumps ? 0.0 : change;
    }
    return jumps ? INFINITY : lack;
}

/* residual -= A move; next = keep move + add S^-1 residual; value += scale next; of row a. */
static inline void iterate(const struct nodal_pressures *pressures, int64_t a, double keep, double add,
                           const double *move, double *residual, double *next, double *value)
{
    const struct sparse *matrix = &pressures->matrix;
    double sum = 0.0;
    for (int64_t i = matrix->ptr[a]; i < matrix->ptr[a + 1]; i++) {
        sum += matrix->value[i] * move[matrix->idx[i]];
    }
    residual[a] -= sum;
    next[a] = keep * move[a] + add * pressures->inverse[a] * residual[a];
    value[a] += pressures->scale * next[a];
}

void nodal_pressures_solve(struct body *body)
{
    const struct nodal_pressures *pressures = &body->volumes.pressures;
    const double *content = body->volumes.content;
    struct body_share *share = &body->share;
    int64_t count = body->volumes.count;
    int64_t begin = share->volume_first[ranks_rank(share->ranks)];
    int64_t end = share->volume_first[ranks_rank(share->ranks) + 1];
    double *residual = pressures->scratch, *move = residual + count, *next = move + count;
    double *value = body->volumes.pressure;
    double centre = pressures->centre / pressures->half, last = 1.0 / centre;
#pragma omp for schedule(static)
    for (int64_t a = begin; a < end; a++) {
        residual[a] = content[a] + pressures->weight[a] * pressures->held[a];
        move[a] = pressures->inverse[a] * residual[a] / pressures->centre;
        value[a] = pressures->scale * move[a];
    }
    for (int k = 1; k < pressures->iterations; k++) {
        double now = 1.0 / (2.0 * centre - last), *swap = move;
        body_share_exchange(share, &share->pressures, 1, move);
#pragma omp for schedule(static)
        for (int64_t a = begin; a < end; a++) {
            iterate(pressures, a, now * last, 2.0 * now / pressures->half, move, residual, next, value);
        }
        move = next;
        next = swap;
        last = now;
    }
    body_share_exchange(share, &share->pressures, 1, value);
}

void nodal_pressures_free(struct nodal_pressures *pressures)
{
    sparse_free(&pressures->matrix);
    FREE_ALL(pressures->inverse, pressures->held, pressures->change, pressures->weight, pressures->entry,
             pressures->scratch);
    *pressures = (struct nodal_pressures){0};
}
