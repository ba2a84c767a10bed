#include "solid/preconditioner/moved_fields.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/preconditioner/preconditioner_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Moves below this are dropped; fields are at most 1. */
static const double least_move = 1e-4;

/* Entries in the order of their centres. */
struct entries {
    int64_t count, room;
    int32_t *place; /* near node */
};

static void entries_free(struct entries *entries)
{
    free(entries->place);
}

/* field = B G^T amount */
static void spread(const struct preconditioner *p, const double *amount, double *field)
{
    memset(field, 0, (size_t)(p->node_count * p->dim) * sizeof *field);
    if (p->constraint.rows->count > 0) {
        constraint_spread(&p->constraint, amount, field);
    }
}

/* The nodes that conditions move. Returns how many. */
static int64_t find_near(const struct preconditioner *p, double *amount, double *field, int32_t *near)
{
    int64_t count = 0, dim = p->dim;
    for (int64_t r = 0; r < p->constraint.rows->count; r++) {
        amount[r] = 1.0 + fmod(0.6180339887 * (double)r, 1.0); /* any */
    }
    spread(p, amount, field);
    for (int64_t n = 0; n < p->node_count; n++) {
        bool is_near = vector_dot((int)dim, field + n * dim, field + n * dim) > 0.0;
        near[n] = is_near ? (int32_t)count++ : -1;
    }
    return count;
}

/* move[near nodes][dim][(dim + 1) * dim] = the fields of centre c. */
static void take_fields(const struct preconditioner *p, const int32_t *near, int64_t c, double *move)
{
    const struct sparse *nodes = &p->coarse.of_centre;
    int dim = p->dim, numbers = (dim + 1) * dim;
    double value[4];
    for (int64_t i = nodes->ptr[c]; i < nodes->ptr[c + 1]; i++) {
        int32_t node = nodes->idx[i];
        if (near[node] < 0) {
            continue;
        }
        coarse_space_values(&p->coarse, node, c, nodes->value[i], value);
        for (int m = 0; m <= dim; m++) {
            for (int a = 0; a < dim; a++) {
                move[((int64_t)near[node] * dim + a) * numbers + m * dim + a] = value[m];
            }
        }
    }
}

/* Subtract what P takes from the fields of centre c. */
static void subtract_held(const struct preconditioner *p, const int32_t *near, int64_t c, double *amount,
                          double *field, double *move)
{
    int64_t dim = p->dim, numbers = (dim + 1) * dim;
    for (int64_t k = 0; k < numbers; k++) {
        if (!preconditioner_constrain_field(p, c * numbers + k, amount)) {
            continue;
        }
        spread(p, amount, field);
        for (int64_t n = 0; n < p->node_count; n++) {
            for (int64_t a = 0; a < dim && near[n] >= 0; a++) {
                move[(near[n] * dim + a) * numbers + k] -= field[n * dim + a];
            }
        }
    }
}

/* Keep the moves by centre c that are large enough. */
static enum status keep(int64_t near_count, int64_t numbers, int64_t c, const double *move,
                        struct moved_fields *fields, struct entries *entries, struct error *error)
{
    for (int64_t n = 0; n < near_count; n++) {
        double most = 0.0;
        for (int64_t i = 0; i < numbers; i++) {
            most = fmax(most, fabs(move[n * numbers + i]));
        }
        if (!(most > least_move)) {
            continue;
        }
        if (entries->count == entries->room) {
            entries->room = entries->room / 4 * 5 + near_count;
            RETURN_IF_ERROR(RESIZE_ARRAY(&entries->place, entries->room, error));
            RETURN_IF_ERROR(RESIZE_ARRAY(&fields->centre, entries->room, error));
            RETURN_IF_ERROR(RESIZE_ARRAY(&fields->move, entries->room * numbers, error));
        }
        for (int64_t i = 0; i < numbers; i++) {
            fields->move[entries->count * numbers + i] = (float)move[n * numbers + i];
        }
        entries->place[entries->count] = (int32_t)n;
        fields->centre[entries->count++] = (int32_t)c;
    }
    return STATUS_OK;
}

/* The entries by nodes. */
static enum status sort(int64_t near_count, const struct entries *entries, struct moved_fields *fields,
                        struct error *error)
{
    NEW_SCRATCH(int64_t, next, near_count + 1, error);
    RETURN_IF_ERROR(NEW_ARRAY(&fields->ptr, near_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&fields->at, entries->count, error));
    for (int64_t i = 0; i < entries->count; i++) {
        fields->ptr[entries->place[i] + 1]++;
    }
    for (int64_t n = 0; n < near_count; n++) {
        next[n + 1] = fields->ptr[n + 1] += fields->ptr[n];
    }
    for (int64_t i = 0; i < entries->count; i++) {
        fields->at[next[entries->place[i]]++] = i;
    }
    return STATUS_OK;
}

enum status moved_fields_build(const struct preconditioner *p, struct moved_fields *fields,
                               struct error *error)
{
    int64_t values = p->node_count * p->dim, numbers = p->dim * (p->dim + 1) * p->dim;
    FREED_BY(entries_free) struct entries entries = {0};
    *fields = (struct moved_fields){.p = p};
    RETURN_IF_ERROR(NEW_ARRAY(&fields->near, p->node_count, error));
    NEW_SCRATCH(double, amount, p->constraint.rows->count, error);
    NEW_SCRATCH(double, field, values, error);
    int64_t count = find_near(p, amount, field, fields->near);
    NEW_SCRATCH(double, move, count * numbers, error);
    for (int64_t c = 0; c < p->coarse.centre_count && count > 0; c++) {
        memset(move, 0, (size_t)(count * numbers) * sizeof *move);
        take_fields(p, fields->near, c, move);
        subtract_held(p, fields->near, c, amount, field, move);
        RETURN_IF_ERROR(keep(count, numbers, c, move, fields, &entries, error));
    }
    return sort(count, &entries, fields, error);
}

void moved_fields_free(struct moved_fields *fields)
{
    FREE_ALL(fields->near, fields->ptr, fields->at, fields->centre, fields->move);
    *fields = (struct moved_fields){0};
}
