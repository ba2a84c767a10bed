#include "base/envelope.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Reverse Cuthill-McKee: breadth first from a node of least degree in each component. order[i] is the old
 * row. */
static enum status order_rows(int64_t n, const int64_t *ptr, const int64_t *column, int64_t *order,
                              struct error *error)
{
    enum status status;
    bool *placed = NULL;
    int64_t count = 0;
    TRY(NEW_ARRAY(&placed, n, error));
    while (count < n) {
        int64_t seed = -1;
        for (int64_t i = 0; i < n; i++) {
            if (!placed[i] && (seed < 0 || ptr[i + 1] - ptr[i] < ptr[seed + 1] - ptr[seed])) {
                seed = i;
            }
        }
        int64_t next = count;
        order[count++] = seed;
        placed[seed] = true;
        for (; next < count; next++) {
            int64_t row = order[next];
            for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
                if (!placed[column[k]]) {
                    placed[column[k]] = true;
                    order[count++] = column[k];
                }
            }
        }
    }
    for (int64_t i = 0; i < n / 2; i++) {
        int64_t swap = order[i];
        order[i] = order[n - 1 - i];
        order[n - 1 - i] = swap;
    }
done:
    free(placed);
    return status;
}

/* The envelope of the reordered matrix, filled with its lower triangle. */
static enum status fill(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                        struct envelope *factor, struct error *error)
{
    enum status status;
    int64_t *place = NULL;
    TRY(NEW_ARRAY(&place, n, error));
    for (int64_t i = 0; i < n; i++) {
        place[factor->order[i]] = i;
    }
    for (int64_t i = 0; i < n; i++) {
        int64_t row = factor->order[i];
        factor->first[i] = i;
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = place[column[k]];
            factor->first[i] = other < factor->first[i] ? other : factor->first[i];
        }
        factor->start[i + 1] = factor->start[i] + i - factor->first[i] + 1;
    }
    TRY(NEW_ARRAY(&factor->value, factor->start[n], error));
    for (int64_t i = 0; i < n; i++) {
        int64_t row = factor->order[i];
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = place[column[k]];
            if (other <= i) {
                factor->value[factor->start[i] + other - factor->first[i]] += value[k];
            }
        }
    }
done:
    free(place);
    return status;
}

enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                               double least, struct envelope *factor, struct error *error)
{
    enum status status;
    *factor = (struct envelope){.n = n};
    TRY(NEW_ARRAY(&factor->order, n, error));
    TRY(NEW_ARRAY(&factor->first, n, error));
    TRY(NEW_ARRAY(&factor->start, n + 1, error));
    TRY(NEW_ARRAY(&factor->scratch, n, error));
    TRY(order_rows(n, ptr, column, factor->order, error));
    TRY(fill(n, ptr, column, value, factor, error));
    for (int64_t i = 0; i < n; i++) {
        double *row = factor->value + factor->start[i] - factor->first[i];
        double diagonal = row[i];
        for (int64_t k = factor->first[i]; k <= i; k++) {
            const double *other = factor->value + factor->start[k] - factor->first[k];
            double sum = row[k];
            int64_t from = factor->first[i] > factor->first[k] ? factor->first[i] : factor->first[k];
            for (int64_t l = from; l < k; l++) {
                sum -= row[l] * other[l];
            }
            if (k < i) {
                row[k] = sum / other[k];
            } else if (!(sum > least * diagonal)) {
                for (int64_t l = factor->first[i]; l < i; l++) {
                    row[l] = 0.0;
                }
                row[i] = INFINITY;
                factor->dropped++;
            } else {
                row[i] = sqrt(sum);
            }
        }
    }
done:
    if (status != STATUS_OK) {
        envelope_free(factor);
    }
    return status;
}

void envelope_free(struct envelope *factor)
{
    free(factor->order);
    free(factor->first);
    free(factor->start);
    free(factor->value);
    free(factor->scratch);
    *factor = (struct envelope){0};
}

void envelope_solve(const struct envelope *factor, double *x)
{
    double *y = factor->scratch;
    for (int64_t i = 0; i < factor->n; i++) {
        const double *row = factor->value + factor->start[i] - factor->first[i];
        double sum = x[factor->order[i]];
        for (int64_t k = factor->first[i]; k < i; k++) {
            sum -= row[k] * y[k];
        }
        y[i] = sum / row[i];
    }
    for (int64_t i = factor->n - 1; i >= 0; i--) {
        const double *row = factor->value + factor->start[i] - factor->first[i];
        y[i] /= row[i];
        for (int64_t k = factor->first[i]; k < i; k++) {
            y[k] -= row[k] * y[i];
        }
    }
    for (int64_t i = 0; i < factor->n; i++) {
        x[factor->order[i]] = y[i];
    }
}
