/* The mass along the coarse fields follows the contacts. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/vector.h"
#include "solid/contact/contact_between.h"

#include <math.h>
#include <string.h>

/* The share of friction that A counts in at each contact node of a body that may move as a whole. */
static const double least_sticks = 0.01;

/* Of the coarse fields, at contact node a less what is opposite: the mean along the normal, and along each
 * direction without its part along that. */
static void take_fields(const struct contact *contact, int64_t a, const double *normal,
                        struct coarse_rows *rows)
{
    int count = contact->friction != NULL ? contact->dim + 1 : 1;
    struct average average = average_of_boundary(contact_nodes(contact), a);
    double weight, direction[4 * 3] = {0.0};
    int dim = contact->dim;
    memcpy(direction, normal, (size_t)dim * sizeof *normal);
    for (int i = 0; i < dim; i++) { /* T^T T = T for the projection T = 1 - n (x) n */
        direction[(i + 1) * dim + i] = 1.0;
        add_scaled(dim, -normal[i], normal, direction + (i + 1) * dim);
    }
    coarse_rows_clear(rows);
    coarse_rows_add_average(rows, &average, 1.0, count, direction);
    for (int64_t i = 0; contact_between_part(contact, a, i, &average, &weight); i++) {
        if (weight != 0.0) {
            coarse_rows_add_average(rows, &average, -weight, count, direction);
        }
    }
}

void preconditioner_widen_by_contacts(struct preconditioner *p, const struct solid_system *system)
{
    static const double any[3] = {1.0};
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact_between *between = system->contacts[c].between;
        const struct boundary_averages *nodes = contact_nodes(&system->contacts[c]);
        const struct boundary_averages *opposite = between != NULL ? &between->opposite.rows : NULL;
        coarse_rows_clear(&p->rows);
        for (int64_t i = 0; i < nodes->count + (opposite != NULL ? opposite->count : 0); i++) {
            struct average average = i < nodes->count ? average_of_boundary(nodes, i)
                                                      : average_of_boundary(opposite, i - nodes->count);
            coarse_rows_add_average(&p->rows, &average, 1.0, 1, any);
            if (opposite == NULL) {
                coarse_rows_widen(&p->rows, &p->profile);
                coarse_rows_clear(&p->rows);
            }
        }
        coarse_rows_widen(&p->rows, &p->profile);
    }
}

void preconditioner_add_contacts(struct preconditioner *p, const struct solid_system *system, double *matrix)
{
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t a = 0; a < contact_nodes(contact)->count; a++, at++) {
            double along = p->along[at], across = p->across != NULL ? p->across[at] : 0.0;
            if (along == 0.0 && across == 0.0) {
                continue;
            }
            take_fields(contact, a, p->normal + at * p->dim, &p->rows);
            coarse_rows_square(&p->rows, 0, along, &p->profile, matrix);
            for (int i = 1; i <= p->dim && across > 0.0; i++) {
                coarse_rows_square(&p->rows, i, across, &p->profile, matrix);
            }
        }
    }
}

/* Store a value; returns whether it was another. */
static bool changes(double *value, double to)
{
    bool other = *value != to;
    *value = to;
    return other;
}

/* Take the stiffness of the nodes of a contact, the first of which has number `at`. Returns whether it is
 * another. */
static bool take_stiffness(struct preconditioner *p, const struct contact *contact, int64_t at)
{
    bool other = false;
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++, at++) {
        struct contact_node node = contact_node(contact, a);
        double stiffness = node.stiffness * contact_nodes(contact)->area[a];
        bool counts = node.pressure > 0.0 || p->has_rigid_mode;
        other = changes(&p->along[at], counts ? stiffness : 0.0) || other;
        if (contact->friction != NULL) {
            double sticks = fmax(node.sticks, p->has_rigid_mode ? least_sticks : 0.0);
            other = changes(&p->across[at], sticks * stiffness) || other;
        }
    }
    return other;
}

static void take_normals(struct preconditioner *p, const struct contact *contact, int64_t at)
{
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++, at++) {
        memcpy(p->normal + at * p->dim, contact_node(contact, a).normal, (size_t)p->dim * sizeof *p->normal);
    }
}

void preconditioner_follow(struct preconditioner *p, const struct solid_system *system)
{
    bool other = p->measured;
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        other = take_stiffness(p, &system->contacts[c], at) || other;
        other = contact_between_moves(&system->contacts[c]) || other;
        at += contact_nodes(&system->contacts[c])->count;
    }
    at = 0;
    for (int64_t c = 0; c < system->contact_count && other; c++) {
        take_normals(p, &system->contacts[c], at);
        contact_between_take(&system->contacts[c]);
        at += contact_nodes(&system->contacts[c])->count;
    }
    if (other) {
        preconditioner_factorise(p, system);
    }
}
