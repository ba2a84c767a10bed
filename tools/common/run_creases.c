/* Why a contact chatters: a node that is pressed into a crease of the rigid surface. Two facets are as near
 * there, the closest one changes, and with it the direction of the force, by as much as the surface turns. */
#include "run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How far to look beside a contact node, by the mean spacing of the nodes; and the turn that is none. */
static const double beside = 0.01, least_turn = 0.1; /* rad */

/* normals[count * dim] of a contact where all nodes are moved by `way` along axis a. */
static void look_beside(struct contact *contact, int64_t nodes, int a, double way, double *u, double *normals)
{
    int dim = contact->dim;
    for (int64_t n = 0; n < nodes; n++) {
        u[n * dim + a] += way;
    }
    contact_measure(contact, u, true);
    memcpy(normals, contact->normal, (size_t)(contact->count * dim) * sizeof *normals);
    for (int64_t n = 0; n < nodes; n++) {
        u[n * dim + a] -= way;
    }
}

/* The angle between two unit normals, one of which may be 0 beyond a rim: then none. */
static double angle(int dim, const double *one, const double *other)
{
    double cosine = 0.0, square = 0.0;
    for (int a = 0; a < dim; a++) {
        cosine += one[a] * other[a];
        square += other[a] * other[a];
    }
    return square > 0.5 ? acos(fmin(fmax(cosine, -1.0), 1.0)) : 0.0;
}

/* The largest turn beside pressed contact nodes; *node receives where. */
static double sharpest(struct run *run, struct contact *contact, int32_t *node)
{
    struct solid_system *system = &run->model->system;
    int dim = contact->dim;
    int64_t size = contact->count * dim;
    double *u = run_new_values(run, system->node_count * dim), *at = run_new_values(run, size);
    double *next = run_new_values(run, size), *pressure = run_new_values(run, contact->count), most = 0.0;
    double way = beside * system_node_spacing(system);
    memcpy(u, run->u, (size_t)(system->node_count * dim) * sizeof *u);
    contact_measure(contact, u, true);
    memcpy(at, contact->normal, (size_t)size * sizeof *at);
    memcpy(pressure, contact->pressure, (size_t)contact->count * sizeof *pressure);
    for (int k = 0; k < 2 * dim; k++) {
        look_beside(contact, system->node_count, k / 2, k % 2 == 0 ? way : -way, u, next);
        for (int64_t c = 0; c < contact->count; c++) {
            double turn = pressure[c] > 0.0 ? angle(dim, at + c * dim, next + c * dim) : 0.0;
            if (turn > most) {
                most = turn;
                *node = contact->points->node[c];
            }
        }
    }
    free(u);
    free(at);
    free(next);
    free(pressure);
    return most;
}

void run_creases_text(struct run *run, char text[512])
{
    struct solid_system *system = &run->model->system;
    double most = least_turn;
    text[0] = '\0';
    for (int64_t c = 0; c < system->contact_count; c++) {
        struct contact *contact = &system->contacts[c];
        int32_t node = -1;
        double turn = sharpest(run, contact, &node);
        if (turn > most) {
            char place[96];
            most = turn;
            point_text(system->dim, system->X + (int64_t)node * system->dim, place);
            (void)snprintf(
                text, 512,
                ": [contact %.60s]: node %d at %s is pressed into a crease of the rigid surface, where the "
                "closest facet changes and turns by %.0f degrees: make the surface smoother there (voxels "
                "--surface at a finer spacing), or round it off",
                run->scene->contacts[contact->section].label.name, node, place, turn * 180.0 / acos(-1.0));
        }
    }
}
