#include "solid/assembly/conflicts.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* Shares of the largest value that either condition prescribes: values further apart than largest_jump are an
 * error. Values below least_size of the body's size count as that
 * size. */
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

/* Compare the values of two conditions: STATUS_OK if they agree, else STATUS_INPUT and the message. */
static enum status compare(const struct assembly *input, const struct nodal_constraint *first,
                           const struct nodal_constraint *second, double most, struct error *error)
{
    char place[96];
    if (jump(first, second, input->cells.dim) <= COARSE_ROUND_OFF * most) {
        return STATUS_OK;
    }
    point_text(input->cells.dim, input->cells.x + (int64_t)second->node * input->cells.dim, place);
    return fail(error, STATUS_INPUT,
                "%s: node %d at %s is prescribed twice: %.10g m here, %.10g m in [displacement %s]",
                input->conditions[second->condition].where, second->node, place, second->value, first->value,
                input->conditions[first->condition].name);
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
            if (first->condition == second->condition ||
                compare(input, first, second, fmax(most, least_size * input->extent), error) == STATUS_OK) {
                continue;
            }
            if (!(jump(first, second, input->cells.dim) <= largest_jump * most)) {
                return STATUS_INPUT;
            }
            if (note->text[0] == '\0') {
                *note = *error;
            }
        }
    }
    return STATUS_OK;
}
