/* The sections that a run adds to its stream. */
#include "run.h"

#include "solid/energy.h"

#include <stdlib.h>
#include <string.h>

void run_put_frame(void *context, int64_t number, double time, const double *u)
{
    struct run *run = context;
    int dim = run->scene->dim;
    int64_t nodes = run->model->system.node_count;
    char name[40], vector[64], attributes[128];
    double *field = run_new_values(run, nodes * dim);
    model_nodal_field(&run->model->input, u, field);
    snprintf(name, sizeof name, "u.frame.%lld", (long long)number);
    snprintf(attributes, sizeof attributes, "%s time=%.12g", vector_attributes(dim, "m", vector), time);
    run_put(run, name, nodes, dim, attributes, field);
    run_folds_look(run, u, time, true);
}

/* Components of a symmetric tensor in output order. */
static const int tensor_2d[4] = {0, 4, 8, 1}, tensor_3d[6] = {0, 4, 8, 1, 2, 5};

/* Cauchy stress P F^T / J, or Green-Lagrange strain, per integration point, with the points' places. */
static void put_tensors(struct run *run)
{
    struct body *body = &run->model->system.body;
    const struct scene *scene = run->scene;
    int count = scene->dim == 2 ? 4 : 6;
    const int *order = scene->dim == 2 ? tensor_2d : tensor_3d;
    const char *names = scene->dim == 2 ? "cols=xx,yy,zz,xy" : "cols=xx,yy,zz,xy,xz,yz";
    char attributes[64];
    int64_t points = body->point_count;
    double *F = run_new_values(run, points * 9), *P = run_new_values(run, points * 9);
    double *stress = run_new_values(run, points * count), *strain = run_new_values(run, points * count);
    body_gradient(body, F);
    body_stress(body, P);
    for (int64_t q = 0; q < points; q++) {
        const double *f = F + 9 * q, *p = P + 9 * q;
        double J = determinant(f);
        for (int k = 0; k < count; k++) {
            int i = order[k] / 3, j = order[k] % 3;
            double s = 0.0, e = i == j ? -1.0 : 0.0;
            for (int a = 0; a < 3; a++) {
                s += p[3 * i + a] * f[3 * j + a] / J;
                e += f[3 * a + i] * f[3 * a + j];
            }
            stress[q * count + k] = s;
            strain[q * count + k] = 0.5 * e;
        }
    }
    free(F);
    free(P);
    if (scene->output.stress) {
        snprintf(attributes, sizeof attributes, "unit=Pa measure=cauchy %s", names);
        run_put(run, "stress", points, count, attributes, stress);
    } else {
        free(stress);
    }
    if (scene->output.strain) {
        snprintf(attributes, sizeof attributes, "unit=1 measure=green-lagrange %s", names);
        run_put(run, "strain", points, count, attributes, strain);
    } else {
        free(strain);
    }
}

/* The name of row r of the reactions: displacements, then contacts. */
static const char *reaction_name(const struct scene *scene, int64_t r)
{
    return r < scene->displacement_count ? scene->displacements[r].label.name
                                         : scene->contacts[r - scene->displacement_count].label.name;
}

/* "unit=N rows=bottom,top", allocated. */
static char *reaction_attributes(const struct run *run, int64_t rows)
{
    struct error error;
    const struct scene *scene = run->scene;
    size_t size = 32, at;
    char *attributes;
    for (int64_t r = 0; r < rows; r++) {
        size += strlen(reaction_name(scene, r)) + 1;
    }
    tool_check(run->tool, NEW_ARRAY(&attributes, (int64_t)size, &error), &error);
    at = (size_t)snprintf(attributes, size, "unit=%s rows=", scene->dim == 2 ? "N/m" : "N");
    for (int64_t r = 0; r < rows; r++) {
        at += (size_t)snprintf(attributes + at, size - at, "%s%s", r > 0 ? "," : "", reaction_name(scene, r));
    }
    return attributes;
}

/* total[rows * dim]: the forces of the conditions and of the springs that back them, by section. */
static void add_condition_forces(const struct run *run, double *total)
{
    const struct solid_system *system = &run->model->system;
    const struct constraint_rows *rows = &system->rows, *springs = &system->springs;
    int dim = run->scene->dim;
    for (int64_t r = 0; r < rows->count; r++) {
        double share = 0.0;
        struct average average = constraint_rows_average(rows, r);
        for (int64_t i = 0; i < average.length; i++) {
            share += average.phi[i]; /* 1 but for round-off */
        }
        for (int a = 0; a < dim; a++) {
            total[rows->section[r] * dim + a] +=
                share * run->model->row_force[r] * rows->direction[r * dim + a];
        }
    }
    for (int64_t r = 0; r < springs->count; r++) {
        double pull = system_spring_force(system, r, run->u);
        for (int a = 0; a < dim; a++) {
            total[springs->section[r] * dim + a] += pull * springs->direction[r * dim + a];
        }
    }
}

/* Total force of each displacement section and contact: a row each. */
static void put_reactions(struct run *run)
{
    const struct scene *scene = run->scene;
    int64_t rows = scene->displacement_count + scene->contact_count;
    double *total = run_new_values(run, rows * scene->dim);
    char *attributes = reaction_attributes(run, rows);
    add_condition_forces(run, total);
    for (int64_t c = 0; c < run->model->system.contact_count; c++) {
        const struct contact *contact = &run->model->system.contacts[c];
        double sum[3];
        contact_total(contact, sum);
        for (int i = 0; i < scene->dim; i++) {
            total[(scene->displacement_count + contact->section) * scene->dim + i] += sum[i];
        }
    }
    run_put(run, "reactions", rows, scene->dim, attributes, total);
    free(attributes);
}

/* Gap, pressure and place of every hat of every contact. */
static void put_gaps(struct run *run)
{
    const struct solid_system *system = &run->model->system;
    int dim = run->scene->dim, cols = dim + 2;
    int64_t rows = 0, at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        rows += system->contacts[c].penalty_only ? 0 : system->contacts[c].count;
    }
    double *values = run_new_values(run, rows * cols);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t a = 0; a < contact->count && !contact->penalty_only; a++, at++) {
            memcpy(values + at * cols, contact->averages->position + a * dim, (size_t)dim * sizeof *values);
            values[at * cols + dim] = contact->gap[a];
            values[at * cols + dim + 1] = contact->pressure[a];
        }
    }
    run_put(run, "gaps", rows, cols,
            dim == 2 ? "unit=m,m,m,Pa cols=x,y,gap,pressure" : "unit=m,m,m,m,Pa cols=x,y,z,gap,pressure",
            values);
}

/* Of the state of rest. What the loads did on the way there means nothing: relaxation is no motion. */
static void put_energy(struct run *run)
{
    struct solid_system *system = &run->model->system;
    double *values = run_new_values(run, 2);
    values[0] = energy_internal(system, run->u);
    values[1] = energy_contact(system);
    run_put(run, "energy", 1, 2,
            run->scene->dim == 2 ? "unit=J/m,J/m cols=internal,contact" : "unit=J,J cols=internal,contact",
            values);
}

void run_put_results(struct run *run)
{
    const struct scene_output *output = &run->scene->output;
    struct model *model = run->model;
    char attributes[64];
    int dim = run->scene->dim;
    int64_t nodes = model->system.node_count;
    double *field = run_new_values(run, nodes * dim), *scratch = run_new_values(run, nodes * dim);
    /* Bring F, stresses and gaps to the final state. */
    (void)system_residual(&model->system, run->u, scratch);
    system_measure_contacts(&model->system, run->u, true);
    free(scratch);
    if (output->stress || output->strain) {
        put_tensors(run);
    }
    if (output->reactions) {
        put_reactions(run);
    }
    if (output->energy && run->scene->analysis == SCENE_QUASI_STATIC) {
        put_energy(run);
    }
    if (output->gaps && model->system.contact_count > 0) {
        put_gaps(run);
    }
    model_nodal_field(&model->input, run->u, field);
    run_put(run, "u", nodes, dim, vector_attributes(dim, "m", attributes), field);
}
