#include "model_claims.h"

#include <math.h>
#include <stdlib.h>

/* Of the largest value that either section prescribes: claims further apart are an error, and claims that are
 * nearer than the second, also of that part of the body's size, are the same. */
static const double largest_jump = 0.1, same_jump = 1e-9, least_size = 1e-6;

enum status claims_add(struct claims *claims, const struct claim *claim, struct error *error)
{
    if (claims->count == claims->room) {
        int64_t room = 2 * claims->room + 64;
        struct claim *grown = array_grow(claims->list, room, sizeof *grown);
        if (grown == NULL) {
            return fail_memory(error, "displacements");
        }
        claims->list = grown;
        claims->room = room;
    }
    claims->list[claims->count++] = *claim;
    return STATUS_OK;
}

void claims_free(struct claims *claims)
{
    free(claims->list);
    *claims = (struct claims){0};
}

/* By node, then in the order of the scene. */
static int compare_claims(const void *left, const void *right)
{
    const struct claim *a = left, *b = right;
    return a->node != b->node ? (a->node > b->node) - (a->node < b->node)
                              : (a->section > b->section) - (a->section < b->section);
}

/* The difference of two claims along one direction; 0 when their directions differ. */
static double jump(const struct claim *a, const struct claim *b, int dim)
{
    double along = 0.0;
    for (int i = 0; i < dim; i++) {
        along += a->direction[i] * b->direction[i];
    }
    return fabs(along) > 1.0 - 1e-9 ? fabs(b->value - copysign(a->value, along * a->value)) : 0.0;
}

/* What two sections claim: STATUS_OK when they agree, else the message. */
static enum status compare(const struct model_input *input, const struct claim *first,
                           const struct claim *second, double most, struct error *error)
{
    const struct scene *scene = input->scene;
    char place[96];
    if (jump(first, second, input->cells.dim) <= same_jump * most) {
        return STATUS_OK;
    }
    point_text(input->cells.dim, input->cells.x + (int64_t)second->node * input->cells.dim, place);
    return scene_fail(error, STATUS_INPUT, scene, &scene->displacements[second->section].label,
                      "node %d at %s is prescribed twice: %g m here, %g m in [displacement %s]", second->node,
                      place, second->value, first->value, scene->displacements[first->section].label.name);
}

enum status claims_check(const struct model_input *input, struct claims *claims, struct error *note,
                         struct error *error)
{
    enum status status;
    const struct scene *scene = input->scene;
    double *largest = NULL;
    note->text[0] = '\0';
    TRY(NEW_ARRAY(&largest, scene->displacement_count, error));
    for (int64_t c = 0; c < claims->count; c++) {
        double *most = &largest[claims->list[c].section];
        *most = fmax(*most, fabs(claims->list[c].value));
    }
    if (claims->count > 0) {
        qsort(claims->list, (size_t)claims->count, sizeof *claims->list, compare_claims);
    }
    for (int64_t b = 0; b < claims->count; b++) {
        const struct claim *second = &claims->list[b];
        for (int64_t a = b - 1; a >= 0 && claims->list[a].node == second->node; a--) {
            const struct claim *first = &claims->list[a];
            double most = fmax(largest[first->section], largest[second->section]);
            if (first->section == second->section ||
                compare(input, first, second, fmax(most, least_size * input->extent), error) == STATUS_OK) {
                continue;
            }
            if (!(jump(first, second, input->cells.dim) <= largest_jump * most)) {
                status = STATUS_INPUT;
                goto done;
            }
            if (note->text[0] == '\0') {
                *note = *error;
            }
        }
    }
done:
    free(largest);
    return status;
}
