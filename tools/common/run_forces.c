/* Forces and moments of the conditions and contacts of a scene. */
#include "run.h"

#include <stdlib.h>
#include <string.h>

/* Sums over the conditions and contacts of a scene: a row for each displacement, then for each contact. */
struct totals {
    int dim, moment_count; /* components of a force, of a moment */
    const double *about;   /* dim: the point of the moments, m */
    double *force;         /* rows * dim, N (2D: N/m) */
    double *moment;        /* rows * moment_count, N m (2D: N) */
};

/* A force on an average of the deformed body acts at the mean of its places, as the weights have the sum 1
 * and reproduce linear fields. */
static void add_force(const struct run *run, const struct average *average, const double *force, int64_t row,
                      struct totals *totals)
{
    int dim = totals->dim;
    double arm[3] = {0.0, 0.0, 0.0}, f[3] = {0.0, 0.0, 0.0};
    for (int64_t i = 0; i < average->length; i++) {
        for (int a = 0; a < dim; a++) {
            int64_t at = (int64_t)average->idx[i] * dim + a;
            arm[a] += average->phi[i] * (run->model->system.X[at] + run->u[at]);
        }
    }
    for (int a = 0; a < dim; a++) {
        arm[a] -= totals->about[a];
        f[a] = force[a];
        totals->force[row * dim + a] += f[a];
    }
    double *moment = totals->moment + row * totals->moment_count;
    if (dim == 3) {
        moment[0] += arm[1] * f[2] - arm[2] * f[1];
        moment[1] += arm[2] * f[0] - arm[0] * f[2];
    }
    moment[dim == 3 ? 2 : 0] += arm[0] * f[1] - arm[1] * f[0];
}

/* Of the conditions, and of the springs that back them. */
static void add_conditions(const struct run *run, struct totals *totals)
{
    const struct solid_system *system = &run->model->system;
    const struct constraint_rows *rows = &system->rows, *springs = &system->springs;
    int dim = totals->dim;
    double force[3];
    for (int64_t r = 0; r < rows->count; r++) {
        double share = 0.0;
        struct average average = constraint_rows_average(rows, r);
        for (int64_t i = 0; i < average.length; i++) {
            share += average.phi[i]; /* 1 but for round-off */
        }
        for (int a = 0; a < dim; a++) {
            force[a] = share * run->model->row_force[r] * rows->direction[r * dim + a];
        }
        add_force(run, &average, force, rows->section[r], totals);
    }
    for (int64_t r = 0; r < springs->count; r++) {
        double pull = system_spring_force(system, r, run->u);
        struct average average = constraint_rows_average(springs, r);
        for (int a = 0; a < dim; a++) {
            force[a] = pull * springs->direction[r * dim + a];
        }
        add_force(run, &average, force, springs->section[r], totals);
    }
}

static void add_contacts(const struct run *run, struct totals *totals)
{
    const struct solid_system *system = &run->model->system;
    int dim = totals->dim;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t h = 0; h < contact->count; h++) {
            double force[3];
            struct average average = average_of_boundary(contact->averages, h);
            for (int a = 0; a < dim; a++) {
                force[a] = contact->pressure[h] * contact->averages->area[h] * contact->normal[h * dim + a];
            }
            add_force(run, &average, force, run->scene->displacement_count + contact->section, totals);
        }
    }
}

/* The name of row r: displacements, then contacts. */
static const char *name_of_row(const struct scene *scene, int64_t r)
{
    return r < scene->displacement_count ? scene->displacements[r].label.name
                                         : scene->contacts[r - scene->displacement_count].label.name;
}

/* HEAD and " rows=bottom,top", allocated. */
static char *attributes_of_rows(const struct run *run, const char *head, int64_t rows)
{
    struct error error;
    const struct scene *scene = run->scene;
    size_t at = strlen(head), size = at + 32;
    char *attributes;
    for (int64_t r = 0; r < rows; r++) {
        size += strlen(name_of_row(scene, r)) + 1;
    }
    tool_check(run->tool, NEW_ARRAY(&attributes, (int64_t)size, &error), &error);
    memcpy(attributes, head, at + 1);
    at += (size_t)snprintf(attributes + at, size - at, " rows=");
    for (int64_t r = 0; r < rows; r++) {
        at += (size_t)snprintf(attributes + at, size - at, "%s%s", r > 0 ? "," : "", name_of_row(scene, r));
    }
    return attributes;
}

void run_put_forces(struct run *run)
{
    const struct scene *scene = run->scene;
    const struct scene_output *output = &scene->output;
    int64_t rows = scene->displacement_count + scene->contact_count;
    struct totals totals = {
        .dim = scene->dim, .moment_count = scene->dim == 3 ? 3 : 1, .about = output->about};
    char head[128];
    if (!output->reactions && !output->moments) {
        return;
    }
    totals.force = run_new_values(run, rows * totals.dim);
    totals.moment = run_new_values(run, rows * totals.moment_count);
    add_conditions(run, &totals);
    add_contacts(run, &totals);
    if (output->reactions) {
        char *attributes = attributes_of_rows(run, scene->dim == 2 ? "unit=N/m" : "unit=N", rows);
        run_put(run, "reactions", rows, totals.dim, attributes, totals.force);
        free(attributes);
    } else {
        free(totals.force);
    }
    if (output->moments) {
        if (scene->dim == 2) {
            snprintf(head, sizeof head, "unit=N about=%.12g,%.12g cols=z", output->about[0],
                     output->about[1]);
        } else {
            snprintf(head, sizeof head, "unit=N*m about=%.12g,%.12g,%.12g cols=x,y,z", output->about[0],
                     output->about[1], output->about[2]);
        }
        char *attributes = attributes_of_rows(run, head, rows);
        run_put(run, "moments", rows, totals.moment_count, attributes, totals.moment);
        free(attributes);
    } else {
        free(totals.moment);
    }
}
