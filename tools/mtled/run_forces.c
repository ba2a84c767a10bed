/* Forces and moments of the conditions, supports and contacts of a scene. */
#include "io/stream/sections.h"
#include "base/vector.h"
#include "mtled/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Sums over the conditions, supports and contacts of a scene: a row for each displacement, then for each
 * support, then for each contact. */
struct totals {
    int dim, moment_count; /* components of a force, of a moment */
    const double *about;   /* dim: the point of the moments, m */
    double *force;         /* rows * dim, N (2D: N/m) */
    double *moment;        /* rows * moment_count, N m (2D: N) */
};

/* Add a force f[3] at a deformed position. */
static void add_force_at(const double *position, const double *f, int64_t row, struct totals *totals)
{
    double arm[3] = {0.0, 0.0, 0.0}, moment[3];
    vector_subtract(totals->dim, position, totals->about, arm);
    add_scaled(totals->dim, 1.0, f, totals->force + row * totals->dim);
    vector_cross(arm, f, moment);
    add_scaled(totals->moment_count, 1.0, moment + 3 - totals->moment_count,
               totals->moment + row * totals->moment_count); /* in 2D only the last component */
}

/* Add a force on an average. It acts at the average of the deformed positions, as the weights have the sum 1
 * and reproduce linear fields. */
static void add_force(const struct run *run, const struct average *average, const double *force, int64_t row,
                      struct totals *totals)
{
    int dim = totals->dim;
    double position[3] = {0.0, 0.0, 0.0}, f[3] = {0.0, 0.0, 0.0};
    for (int64_t i = 0; i < average->length; i++) {
        for (int a = 0; a < dim; a++) {
            int64_t at = (int64_t)average->idx[i] * dim + a;
            position[a] += average->phi[i] * (run->model->system.X[at] + run->u[at]);
        }
    }
    memcpy(f, force, (size_t)dim * sizeof *f);
    add_force_at(position, f, row, totals);
}

/* Add the forces of the cells on prescribed values. */
static void add_values(const struct run *run, struct totals *totals)
{
    struct body *body = &run->model->system.body;
    prescribed_values_collect(body);
    for (int64_t i = 0; i < body->cells.prescribed.count; i++) {
        const struct prescribed_value *item = &body->cells.prescribed.items[i];
        double position[3];
        vector_middle(totals->dim, run->model->system.X, item->nodes, item->node, position);
        add_scaled(totals->dim, 1.0, item->value, position);
        for (int k = 0; k < item->count; k++) {
            double force[3] = {0.0, 0.0, 0.0};
            add_scaled(totals->dim, item->force[k], item->axis + k * totals->dim, force);
            add_force_at(position, force, item->section[k], totals);
        }
    }
}

/* Add the forces of the conditions on averages, and those of springs. */
static void add_conditions(const struct run *run, struct totals *totals)
{
    const struct solid_system *system = &run->model->system;
    const struct constraint_rows *rows = &system->rows, *springs = &system->springs.rows;
    int dim = totals->dim;
    double force[3];
    for (int64_t r = 0; r < rows->count; r++) {
        double share = 0.0;
        struct average average = constraint_rows_average(rows, r);
        for (int64_t i = 0; i < average.length; i++) {
            share += average.phi[i]; /* 1 up to round-off */
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

static const char *name_of_row(const struct scene *scene, int64_t r)
{
    int64_t support = r - scene->displacement_count, contact = support - scene->support_count;
    return support < 0   ? scene->displacements[r].label.name
           : contact < 0 ? scene->supports[support].label.name
                         : scene->contacts[contact].label.name;
}

/* The attributes of a table of vectors, to be freed: "unit=N MORE rows=bottom,top" with a row for each
 * condition; or in one row, after the time: "unit=1,N,N,N,N MORE cols=time,bottom.x,bottom.y,top.x,top.y".
 * `components`: the letters of the components. */
static char *attributes_of_rows(const struct run *run, const char *unit, const char *more,
                                const char *components, int64_t rows, bool in_one_row)
{
    const struct scene *scene = run->scene;
    FREED_BY(names_free) struct names units = {0}, columns = {0};
    TOOL_TRY(run->tool, names_add(&units, !in_one_row ? unit : scene->duration > 0.0 ? "s" : "1", &error));
    TOOL_TRY(run->tool, names_split(&columns, in_one_row ? "time" : "", &error));
    for (int64_t r = 0; r < rows; r++) {
        for (const char *letter = components; in_one_row && *letter != '\0'; letter++) {
            TOOL_TRY(run->tool, names_add(&units, unit, &error));
            TOOL_TRY(run->tool, names_print(&columns, &error, "%s.%c", name_of_row(scene, r), *letter));
        }
        TOOL_TRY(run->tool, in_one_row ? STATUS_OK : names_add(&columns, name_of_row(scene, r), &error));
    }
    return tool_text(run->tool, "unit=%s%s %s=%s", units.list, more, in_one_row ? "cols" : "rows",
                     columns.list);
}

/* Put section `name`, or a row of its table over frames; takes values[rows * components]. */
static void put_vectors(const struct run *run, const struct instant *instant, const char *name,
                        const char *unit, const char *more, const char *components, int64_t rows,
                        double *values)
{
    SCRATCH char *attributes =
        attributes_of_rows(run, unit, more, components, rows, instant->frame != FRAME_NONE);
    run_put_table(run, instant, name, rows, (int64_t)strlen(components), attributes, values);
}

void run_put_forces(struct run *run, const struct instant *instant)
{
    const struct scene *scene = run->scene;
    const struct scene_output *output = &scene->output;
    bool is_plane = scene->dim == 2;
    int64_t rows = scene->displacement_count + scene->support_count + scene->contact_count;
    struct totals totals = {.dim = scene->dim, .moment_count = is_plane ? 1 : 3, .about = output->about};
    char more[128];
    if (!output->reactions && !output->moments) {
        return;
    }
    totals.force = run_new_values(run, rows * totals.dim);
    totals.moment = run_new_values(run, rows * totals.moment_count);
    add_conditions(run, &totals);
    add_values(run, &totals);
    for (int64_t c = 0; c < run->model->system.contact_count; c++) {
        const struct contact *contact = &run->model->system.contacts[c];
        int64_t row = scene->displacement_count + scene->support_count + contact->section;
        double force[3], moment[3];
        contact_total(contact, force);
        contact_moment(contact, totals.about, moment);
        add_scaled(totals.dim, 1.0, force, totals.force + row * totals.dim);
        add_scaled(totals.moment_count, 1.0, moment + 3 - totals.moment_count,
                   totals.moment + row * totals.moment_count);
    }
    if (output->reactions) {
        put_vectors(run, instant, "reactions", is_plane ? "N/m" : "N", "", is_plane ? "xy" : "xyz", rows,
                    totals.force);
    } else {
        free(totals.force);
    }
    if (output->moments) {
        snprintf(more, sizeof more, " about=%.12g,%.12g", output->about[0], output->about[1]);
        if (!is_plane) {
            text_append(more, sizeof more, ",%.12g", output->about[2]);
        }
        text_append(more, sizeof more, "%s",
                    instant->frame != FRAME_NONE ? ""
                    : is_plane                   ? " cols=z"
                                                 : " cols=x,y,z");
        put_vectors(run, instant, "moments", is_plane ? "N" : "N*m", more, is_plane ? "z" : "xyz", rows,
                    totals.moment);
    } else {
        free(totals.moment);
    }
}
