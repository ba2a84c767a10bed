/* The mass along the coarse fields follows the contacts. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/vector.h"
#include "solid/contact/contact_between.h"

#include <math.h>
#include <string.h>

/* The share of friction that A counts in at each contact node of a body that may move as a whole. */
static const double least_sticks = 0.01;

/* The next part, from *i on, of what is opposite contact node a that has a weight; false: no more. */
static bool next_opposite(const struct contact *contact, int64_t a, int64_t *i, int64_t *corner,
                          double *weight)
{
    while (contact_between_part(contact, a, (*i)++, corner, weight)) {
        if (*weight != 0.0) {
            return true;
        }
    }
    return false;
}

/* Of the coarse fields, at contact node a less what is opposite: the mean along the normal, and along each
 * direction without its part along that. */
static void take_fields(const struct contact *contact, int64_t a, const double *normal,
                        struct coarse_rows *rows)
{
    int count = contact->friction != NULL ? contact->dim + 1 : 1;
    struct average average = average_of_boundary(contact_nodes(contact), a);
    int64_t corner;
    double weight, direction[4 * 3] = {0.0};
    int dim = contact->dim;
    memcpy(direction, normal, (size_t)dim * sizeof *normal);
    for (int i = 0; i < dim; i++) { /* T^T T = T for the projection T = 1 - n (x) n */
        direction[(i + 1) * dim + i] = 1.0;
        add_scaled(dim, -normal[i], normal, direction + (i + 1) * dim);
    }
    coarse_rows_clear(rows);
    coarse_rows_add_average(rows, &average, 1.0, count, direction);
    for (int64_t i = 0; next_opposite(contact, a, &i, &corner, &weight);) {
        average = contact_between_corner(contact, corner);
        coarse_rows_add_average(rows, &average, -weight, count, direction);
    }
}

void preconditioner_add_contacts(struct preconditioner *p, const struct solid_system *system, double *matrix)
{
    int64_t dim = p->dim, at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            double sticks = p->sticks != NULL ? p->sticks[at] : 0.0;
            if (!p->active[at] && sticks == 0.0) {
                continue;
            }
            double stiffness = contact_node(contact, a).stiffness * averages->area[a];
            take_fields(contact, a, p->normal + at * dim, &p->rows);
            if (p->active[at]) {
                coarse_rows_square(&p->rows, 0, stiffness, matrix);
            }
            for (int i = 1; i <= dim && sticks > 0.0; i++) {
                coarse_rows_square(&p->rows, i, sticks * stiffness, matrix);
            }
        }
    }
}

void preconditioner_follow(struct preconditioner *p, const struct solid_system *system)
{
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        struct contact *contact = &system->contacts[c];
        for (int64_t a = 0; a < contact_nodes(contact)->count; a++, at++) {
            struct contact_node node = contact_node(contact, a);
            p->active[at] = node.pressure > 0.0 || p->has_rigid_mode;
            memcpy(p->normal + at * contact->dim, node.normal, (size_t)contact->dim * sizeof *node.normal);
            if (contact->friction != NULL) {
                p->sticks[at] = fmax(node.sticks, p->has_rigid_mode ? least_sticks : 0.0);
            }
        }
        contact_between_take(contact);
    }
    if (p->size > 0 && system->contact_count > 0) {
        preconditioner_factorise(p, system);
    }
}
