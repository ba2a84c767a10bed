#include "solid/preconditioner/stiffness_factor.h"

#include "base/memory.h"
#include "solid/preconditioner/block_row.h"
#include "solid/system/system.h"

#include <stdlib.h>
#include <string.h>

/* Entries of the factor by those of the table at the nodes and edges, at most: beyond, solving costs more
 * than an evaluation. */
static const int64_t most_entries = 12;
/* Part of D that is added, so that modes without stiffness have a mass, and by how much more each time, until
 * the matrix is positive definite. */
static const double kept = 1e-6, more_kept = 100.0;
enum { MOST_ATTEMPTS = 6 };
static const double least_pivot = 1e-12; /* by the diagonal entry */

/* Lists of nodes, each of which is coupled to all others of its list. */
struct couples {
    struct sparse lists, by_node; /* value[]: unused */
    int64_t room;
};

static void couples_free(struct couples *couples)
{
    sparse_free(&couples->lists);
    sparse_free(&couples->by_node);
}

static enum status add_list(int64_t length, const int32_t *node, struct couples *couples, struct error *error)
{
    struct sparse *lists = &couples->lists;
    int64_t at = lists->ptr[lists->row_count], needed = at + length;
    RETURN_IF_ERROR(GROW_ARRAY(&lists->idx, needed, &couples->room, error));
    memcpy(lists->idx + at, node, (size_t)length * sizeof *node);
    lists->ptr[++lists->row_count] = needed;
    return STATUS_OK;
}

static enum status add_rows(const struct constraint_rows *rows, struct couples *couples, struct error *error)
{
    for (int64_t l = 0; l < rows->list_count; l++) {
        struct average average = constraint_rows_average(rows, rows->first[l]);
        RETURN_IF_ERROR(add_list(average.length, average.idx, couples, error));
    }
    return STATUS_OK;
}

/* The row of node n of the body's order, with the caller's indices of its nodes. */
static void make_row(const struct body *body, int32_t n, struct block_row *row)
{
    block_row_make(body, n, row);
    for (int64_t k = 0; k < row->count; k++) {
        row->node[k] = (int32_t)body->node_order[row->node[k]];
    }
}

/* Of the elements around each node, of conditions and penalties. */
static enum status list_couples(const struct solid_system *system, struct couples *couples,
                                struct error *error)
{
    const struct body *body = &system->body;
    FREED_BY(block_row_free) struct block_row row = {0};
    int64_t lists = system->node_count + system->rows.list_count + system->penalties.list_count;
    couples->lists.column_count = system->node_count;
    RETURN_IF_ERROR(NEW_ARRAY(&couples->lists.ptr, lists + 1, error));
    RETURN_IF_ERROR(block_row_begin(body, block_row_most(body), &row, error));
    for (int32_t p = 0; p < system->node_count; p++) {
        make_row(body, p, &row);
        RETURN_IF_ERROR(add_list(row.count, row.node, couples, error));
    }
    RETURN_IF_ERROR(add_rows(&system->rows, couples, error));
    RETURN_IF_ERROR(add_rows(&system->penalties, couples, error));
    RETURN_IF_ERROR(NEW_ARRAY(&couples->lists.value, couples->lists.ptr[lists], error));
    return sparse_transpose(&couples->lists, &couples->by_node, error);
}

/* The nodes that each is coupled to. */
static enum status list_neighbours(const struct couples *couples, int64_t *ptr, int64_t **column,
                                   struct error *error)
{
    int64_t nodes = couples->by_node.row_count, count = 0, room = 0;
    NEW_SCRATCH(int64_t, seen, nodes, error); /* 1 + the last node that has it */
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t i = couples->by_node.ptr[n]; i < couples->by_node.ptr[n + 1]; i++) {
            int64_t list = couples->by_node.idx[i];
            int64_t begin = couples->lists.ptr[list], end = couples->lists.ptr[list + 1];
            RETURN_IF_ERROR(GROW_ARRAY(column, count + end - begin, &room, error));
            for (int64_t k = begin; k < end; k++) {
                int32_t other = couples->lists.idx[k];
                if (seen[other] != n + 1) {
                    seen[other] = n + 1;
                    (*column)[count++] = other;
                }
            }
        }
        ptr[n + 1] = count;
    }
    return STATUS_OK;
}

enum status stiffness_factor_begin(const struct solid_system *system, struct stiffness_factor *elements,
                                   struct error *error)
{
    FREED_BY(couples_free) struct couples couples = {0};
    struct envelope *factor = &elements->factor;
    SCRATCH int64_t *column = NULL;
    *elements = (struct stiffness_factor){0};
    if (system->dim == 3 || system->contact_count > 0) {
        return STATUS_OK;
    }
    NEW_SCRATCH(int64_t, ptr, system->node_count + 1, error);
    RETURN_IF_ERROR(list_couples(system, &couples, error));
    RETURN_IF_ERROR(list_neighbours(&couples, ptr, &column, error));
    RETURN_IF_ERROR(envelope_begin(system->node_count, ptr, column, system->dim, factor, error));
    if (factor->size > most_entries * system->body.pair_count) {
        envelope_free(factor);
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&factor->value, factor->size, error));
    return NEW_ARRAY(&elements->body, factor->size, error);
}

void stiffness_factor_free(struct stiffness_factor *elements)
{
    envelope_free(&elements->factor);
    free(elements->body);
    *elements = (struct stiffness_factor){0};
}

/* matrix += block[dim * dim] between nodes n and m. */
static void add_block(const struct envelope *envelope, int dim, int64_t n, int64_t m, const double *block,
                      double *matrix)
{
    for (int a = 0; a < dim && envelope_has(envelope, n * dim, m * dim); a++) {
        for (int b = 0; b < dim; b++) {
            envelope_add(envelope, n * dim + a, m * dim + b, block[a * dim + b], matrix);
        }
    }
}

/* The elements around node n of the body's order, and its nodal volume. */
static void add_elements(const struct body *body, int32_t n, struct block_row *row,
                         const struct envelope *envelope, double *matrix)
{
    int dim = body->dim, values = (dim + 1) * dim;
    double block[9];
    make_row(body, n, row);
    for (int64_t k = 0; k < row->count; k++) {
        const double *left = row->block + k * values;
        add_block(envelope, dim, body->node_order[n], row->node[k], left, matrix);
        for (int64_t l = 0; l < row->count; l++) {
            const double *right = row->block + l * values + dim * dim;
            for (int v = 0; v < dim * dim; v++) {
                block[v] = left[dim * dim + v / dim] * right[v % dim] / row->volume;
            }
            add_block(envelope, dim, row->node[k], row->node[l], block, matrix);
        }
    }
}

/* The squares of rows. stiffness[]: of each; NULL: `usual`. */
static void add_squares(const struct constraint_rows *rows, const double *stiffness, double usual,
                        const struct envelope *envelope, double *matrix)
{
    int dim = rows->dim;
    for (int64_t l = 0; l < rows->list_count; l++) {
        struct average average = constraint_rows_average(rows, rows->first[l]);
        double sum[9] = {0.0}, block[9];
        for (int64_t r = rows->first[l]; r < rows->first[l + 1]; r++) {
            const double *along = rows->direction + r * dim;
            for (int v = 0; v < dim * dim; v++) {
                sum[v] += (stiffness != NULL ? stiffness[r] : usual) * along[v / dim] * along[v % dim];
            }
        }
        for (int64_t i = 0; i < average.length * average.length; i++) {
            int64_t n = average.idx[i / average.length], m = average.idx[i % average.length];
            double factor = average.phi[i / average.length] * average.phi[i % average.length];
            for (int v = 0; v < dim * dim; v++) {
                block[v] = factor * sum[v];
            }
            add_block(envelope, dim, n, m, block, matrix);
        }
    }
}

enum status stiffness_factor_take(const struct solid_system *system, const double *mass,
                                  struct stiffness_factor *elements, struct error *error)
{
    FREED_BY(block_row_free) struct block_row row = {0};
    const struct envelope *envelope = &elements->factor;
    double mean = 0.0;
    for (int64_t n = 0; n < system->node_count; n++) {
        mean += mass[n] / (double)system->node_count;
    }
    RETURN_IF_ERROR(block_row_begin(&system->body, block_row_most(&system->body), &row, error));
    row.bounded = true;
    memset(elements->body, 0, (size_t)envelope->size * sizeof *elements->body);
    for (int32_t n = 0; n < system->node_count; n++) {
        add_elements(&system->body, n, &row, envelope, elements->body);
    }
    add_squares(&system->rows, NULL, mean, envelope, elements->body);
    add_squares(&system->penalties, system->penalty_stiffness, 0.0, envelope, elements->body);
    return STATUS_OK;
}

void stiffness_factor_make(struct stiffness_factor *elements, int dim, const double *mass)
{
    struct envelope *factor = &elements->factor;
    double keep = kept;
    elements->definite = false;
    for (int attempt = 0; attempt < MOST_ATTEMPTS && !elements->definite; attempt++) {
        memcpy(factor->value, elements->body, (size_t)factor->size * sizeof *factor->value);
        for (int64_t i = 0; i < factor->n; i++) {
            envelope_add(factor, i, i, keep * mass[i / dim], factor->value);
        }
        envelope_factor(factor, least_pivot, 0.0);
        elements->definite = factor->dropped == 0;
        keep *= more_kept; /* of an unstable body the stiffness is indefinite */
    }
}

void stiffness_factor_solve(const struct stiffness_factor *elements, const double *x, double *y)
{
    memcpy(y, x, (size_t)elements->factor.n * sizeof *y);
    envelope_solve(&elements->factor, y);
}
