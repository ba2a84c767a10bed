#include "solid/assembly/prescription.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shares of the largest value that either condition prescribes: values further apart than largest_jump are an
 * error. Values below least_size of the body's size count as that size. */
static const double largest_jump = 0.1, least_size = 1e-6;

void nodal_constraints_free(struct nodal_constraints *nodal_constraints)
{
    free(nodal_constraints->list);
    *nodal_constraints = (struct nodal_constraints){0};
}

/* By node, then in the order of the conditions. */
static int compare_nodal_constraints(const void *left, const void *right)
{
    return compare_numbers(2, left, right); /* node and condition begin it */
}

/* The difference of two prescribed values along one direction; 0 when their directions differ. */
static double jump(const struct nodal_constraint *a, const struct nodal_constraint *b, int dim)
{
    double along = vector_dot(dim, a->direction, b->direction);
    return fabs(along) > 1.0 - 1e-9 ? fabs(b->value - copysign(a->value, along * a->value)) : 0.0;
}

enum status nodal_constraints_check(const struct assembly *input, struct nodal_constraints *nodal_constraints,
                                    struct error *note, struct error *error)
{
    NEW_SCRATCH(double, largest, input->condition_count, error);
    for (int64_t c = 0; c < nodal_constraints->count; c++) {
        double *most = &largest[nodal_constraints->list[c].condition];
        *most = fmax(*most, fabs(nodal_constraints->list[c].value));
    }
    if (nodal_constraints->count > 0) {
        qsort(nodal_constraints->list, (size_t)nodal_constraints->count, sizeof *nodal_constraints->list,
              compare_nodal_constraints);
    }
    for (int64_t b = 0; b < nodal_constraints->count; b++) {
        const struct nodal_constraint *second = &nodal_constraints->list[b];
        for (int64_t a = b - 1; a >= 0 && nodal_constraints->list[a].node == second->node; a--) {
            const struct nodal_constraint *first = &nodal_constraints->list[a];
            double most = fmax(largest[first->condition], largest[second->condition]);
            int dim = input->cells.dim;
            double apart = jump(first, second, dim);
            if (first->condition == second->condition ||
                apart <= COARSE_ROUND_OFF * fmax(most, least_size * input->extent)) {
                continue;
            }
            (void)fail(error, STATUS_INPUT,
                       "%s: node %d at %s is prescribed twice: %.10g m here, %.10g m in [displacement %s]",
                       input->conditions[second->condition].where, second->node,
                       POINT_TEXT(dim, input->cells.x + (int64_t)second->node * dim), second->value,
                       first->value, input->conditions[first->condition].name);
            if (!(apart <= largest_jump * most)) {
                return STATUS_INPUT;
            }
            if (note->text[0] == '\0') {
                *note = *error;
            }
        }
    }
    return STATUS_OK;
}

/* A fit that is off a row by more than this share of the largest displacement is noted. */
static const double fit_share = 0.01;

/* value[dim] = the displacement of the condition's table at x, near this node, m. */
static enum status value_at(const struct prescription *p, int32_t node, const double *x, double *value,
                            struct error *error)
{
    const struct condition *condition = p->condition;
    double distance, spacing;
    struct error why;
    char place[96];
    enum status status = scattered_fit_evaluate(&p->fit, node, x, value, &distance, &spacing, &why);
    point_text(p->input->cells.dim, x, place);
    if (status != STATUS_OK) {
        return fail(error, status, "%s: table %s: at %s: %s", condition->where, condition->table, place,
                    why.text);
    }
    if (!(distance <= fmin(SCATTERED_FIT_REACH * fmax(spacing, p->spacing[node]), p->input->extent))) {
        return fail(
            error, STATUS_INPUT,
            "%s: table %s: its nearest point is %.3g m from the boundary at %s, by node %d, its points "
            "are %.3g m apart, the nodes %.3g m: wrong unit or wrong place, else give rows there or "
            "leave these facets out",
            condition->where, condition->table, distance, place, node, spacing, p->spacing[node]);
    }
    return STATUS_OK;
}

/* The largest difference of two rows in `count` entries. */
static double apart(const double *row, const double *other, int count)
{
    double most = 0.0;
    for (int c = 0; c < count; c++) {
        most = fmax(most, fabs(row[c] - other[c]));
    }
    return most;
}

enum status prescription_check_table(const struct prescription *p, struct error *error)
{
    const struct condition *condition = p->condition;
    int dim = p->input->cells.dim;
    int64_t count = condition->row_count;
    double largest = 0.0, same = COARSE_ROUND_OFF * p->input->extent / condition->unit;
    SCRATCH struct placed *sorted = NULL; /* rows by their first coordinates */
    char place[96];
    RETURN_IF_ERROR(NEW_ARRAY(&sorted, count, error));
    for (int64_t i = 0; i < count; i++) {
        const double zeros[3] = {0.0, 0.0, 0.0};
        sorted[i] = (struct placed){condition->rows[i * 2 * dim], i};
        largest = fmax(largest, apart(condition->rows + i * 2 * dim + dim, zeros, dim));
    }
    qsort(sorted, (size_t)count, sizeof *sorted, compare_placed);
    for (int64_t s = 0; s < count; s++) {
        for (int64_t t = s + 1; t < count && sorted[t].place - sorted[s].place <= same; t++) {
            const double *a = condition->rows + sorted[s].item * 2 * dim,
                         *b = condition->rows + sorted[t].item * 2 * dim;
            double difference = apart(a + dim, b + dim, dim);
            if (apart(a, b, dim) <= same && difference > COARSE_ROUND_OFF * largest) {
                double at[3] = {0.0, 0.0, 0.0};
                for (int c = 0; c < dim; c++) {
                    at[c] = b[c] * condition->unit;
                }
                point_text(dim, at, place);
                return fail(error, STATUS_INPUT,
                            "%s: table %s: rows %lld and %lld, both at %s, differ by %.3g m: leave one out",
                            condition->where, condition->table, (long long)sorted[s].item + 1,
                            (long long)sorted[t].item + 1, place, difference * condition->unit);
            }
        }
    }
    return STATUS_OK;
}

enum status prescription_check_fit(const struct prescription *p, struct error *note, struct error *error)
{
    const struct condition *condition = p->condition;
    const struct cells *cells = &p->input->cells;
    int dim = cells->dim;
    int64_t worst = -1;
    double largest = 0.0, most = 0.0;
    char place[96];
    NEW_SCRATCH(bool, holds, cells->node_count, error);
    for (int64_t i = 0; i < p->nodal_constraints->count; i++) {
        const struct nodal_constraint *one = &p->nodal_constraints->list[i];
        holds[one->node] = holds[one->node] || one->condition == p->number;
    }
    for (int64_t i = 0; i < condition->row_count; i++) {
        const double *row = condition->rows + i * 2 * dim, zeros[3] = {0.0, 0.0, 0.0};
        int32_t node = p->fit.paths->node[i];
        double at[3] = {0.0, 0.0, 0.0}, value[3] = {0.0, 0.0, 0.0};
        largest = fmax(largest, condition->unit * apart(row + dim, zeros, dim));
        add_scaled(dim, condition->unit, row, at);
        if (node < 0 || !holds[node] ||
            vector_distance(dim, cells->x + (int64_t)node * dim, at) > COARSE_ROUND_OFF * p->input->extent) {
            continue;
        }
        RETURN_IF_ERROR(value_at(p, node, at, value, error));
        add_scaled(dim, -condition->unit, row + dim, value);
        worst = apart(value, zeros, dim) > most ? i : worst;
        most = fmax(most, apart(value, zeros, dim));
    }
    if (most > fit_share * largest && note->text[0] == '\0') {
        point_text(dim, cells->x + (int64_t)p->fit.paths->node[worst] * dim, place);
        (void)fail(
            note, STATUS_OK,
            "%s: table %s: at %s what is prescribed is off row %lld by %.3g m: the rows are fitted, so "
            "that noise averages out, and so do kinks, steps and short waves: give exact values as "
            "points, or each smooth part its own section and table",
            condition->where, condition->table, place, (long long)worst + 1, most);
    }
    return STATUS_OK;
}

/* Whether the condition does not prescribe component i. */
static bool is_free(const struct condition *condition, int i)
{
    return condition->kind == CONDITION_COMPONENTS && condition->is_free[i];
}

/* Demand the components of a value that the condition prescribes. */
static void set_components(const struct condition *condition, int dim, const double *value,
                           struct demand *demand)
{
    for (int i = 0; i < dim; i++) {
        if (!is_free(condition, i)) {
            demand->direction[demand->count * dim + i] = 1.0;
            demand->value[demand->count++] = value[i];
        }
    }
}

int prescription_directions(const struct condition *condition, int dim)
{
    int count = 0;
    for (int i = 0; i < dim; i++) {
        count += !is_free(condition, i);
    }
    return condition->kind == CONDITION_NORMAL ? 1 : count;
}

enum status prescription_demand_at(const struct prescription *p, int32_t node, const double *x,
                                   const double *normal, struct demand *demand, struct error *error)
{
    int dim = p->input->cells.dim;
    const struct condition *condition = p->condition;
    double value[3] = {condition->components[0], condition->components[1], condition->components[2]};
    *demand = (struct demand){.count = 0};
    if (condition->kind == CONDITION_NORMAL) {
        memcpy(demand->direction, normal, (size_t)dim * sizeof *normal);
        demand->value[demand->count++] = condition->normal;
        return STATUS_OK;
    }
    if (condition->kind == CONDITION_TABLE) {
        RETURN_IF_ERROR(value_at(p, node, x, value, error));
    }
    set_components(condition, dim, value, demand);
    return STATUS_OK;
}

enum status prescription_demand(const struct prescription *p, const struct boundary_averages *averages,
                                int64_t a, bool at_node, struct demand *demand, struct error *error)
{
    int dim = p->input->cells.dim;
    int32_t node = averages->node[a];
    const struct condition *condition = p->condition;
    double mean[3] = {0.0, 0.0, 0.0};
    if (condition->kind != CONDITION_TABLE || at_node) {
        return prescription_demand_at(p, node, p->input->cells.x + (int64_t)node * dim,
                                      averages->normal + a * dim, demand, error);
    }
    for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
        double sample[3];
        RETURN_IF_ERROR(value_at(p, node, averages->sample_x + s * dim, sample, error));
        add_scaled(dim, averages->sample_share[s], sample, mean);
    }
    *demand = (struct demand){.count = 0};
    set_components(condition, dim, mean, demand);
    return STATUS_OK;
}
