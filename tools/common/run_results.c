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
    run_put_forces(run);
    if (output->energy && run->scene->analysis == SCENE_QUASI_STATIC) {
        put_energy(run);
    }
    if (output->gaps && model->system.contact_count > 0) {
        put_gaps(run);
    }
    model_nodal_field(&model->input, run->u, field);
    run_put(run, "u", nodes, dim, vector_attributes(dim, "m", attributes), field);
}
