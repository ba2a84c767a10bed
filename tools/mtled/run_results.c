/* The sections that a run adds to its stream. */
#include "io/stream/sections.h"
#include "mtled/run.h"

#include "approx/field/field_compare.h"
#include "base/vector.h"
#include "solid/system/energy.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Add section `name` of a state. */
static void put(const struct run *run, const struct instant *instant, const char *name, int64_t rows,
                int64_t cols, const char *attributes, double *values)
{
    char full[64], timed[192];
    if (instant->frame == FRAME_NONE) {
        run_put(run, name, rows, cols, attributes, values);
        return;
    }
    snprintf(full, sizeof full, "%s.frame.%jd", name, instant->frame);
    snprintf(timed, sizeof timed, "%s time=%.12g", attributes, instant->time);
    run_put(run, full, rows, cols, timed, values);
}

void run_put_field(const struct run *run, const struct instant *instant, const double *u)
{
    int dim = run->scene->dim;
    int64_t nodes = run->model->system.node_count;
    char vector[64];
    double *field = run_new_values(run, nodes * dim), *parameters = run_new_values(run, nodes * dim);
    assembly_nodal_field(&run->model->assembly, u, field);
    memcpy(parameters, u, (size_t)(nodes * dim) * sizeof *u);
    put(run, instant, "u", nodes, dim, vector_attributes(dim, "m", vector), field);
    put(run, instant, "parameters", nodes, dim, vector, parameters);
}

void run_put_supports(const struct run *run)
{
    static const char *const names[] = {"radius", "stretch", "sides", "side"};
    const struct section *radius = stream_find(run->stream, "support.radius"),
                         *nodes = stream_find(run->stream, "nodes.x");
    bool fits = radius != NULL && nodes != NULL && radius->rows == nodes->rows;
    for (size_t i = 0; i < sizeof names / sizeof *names && fits; i++) {
        char from[32], to[32];
        snprintf(from, sizeof from, "support.%s", names[i]);
        snprintf(to, sizeof to, "parameters.%s", names[i]);
        const struct section *given = stream_find(run->stream, from);
        if (given != NULL) {
            TOOL_TRY(run->tool, stream_put_copy(run->stream, to, given->type, given->rows, given->cols,
                                                given->attributes, given->data, &error));
        }
    }
}

bool run_is_of_frames(const char *name)
{
    size_t length;
    return frame_of(name, &length) != FRAME_NONE;
}

/* Put the symmetric components of tensors[points * 9] as section `name`. */
static void put_tensors(const struct run *run, const struct instant *instant, const char *name,
                        const char *kind, const double *tensors)
{
    static const int order[2][6] = {{0, 4, 8, 1}, {0, 4, 8, 1, 2, 5}};
    static const char *const cols[2] = {"xx,yy,zz,xy", "xx,yy,zz,xy,xz,yz"};
    int dim = run->scene->dim, count = dim == 2 ? 4 : 6;
    int64_t points = run->model->system.body.point_count;
    char attributes[96];
    double *values = run_new_values(run, points * count);
    for (int64_t i = 0; i < points * count; i++) {
        values[i] = tensors[9 * (i / count) + order[dim - 2][i % count]];
    }
    snprintf(attributes, sizeof attributes, "%s cols=%s", kind, cols[dim - 2]);
    put(run, instant, name, points, count, attributes, values);
}

/* Put the deformed directions F a of the fibres, 0 where there are none. */
static void put_fibres(const struct run *run, const struct instant *instant, const double *F)
{
    const struct material_list *list = &run->model->assembly.materials;
    int dim = run->scene->dim;
    int64_t points = run->model->system.body.point_count;
    double *values = run_new_values(run, points * dim);
    for (int64_t i = 0; i < points * dim; i++) {
        const double *fibre = list->items[list->of_point[i / dim]].fibre;
        values[i] = fibre != NULL ? vector_dot(dim, F + i / dim * 9 + i % dim * 3, fibre) : 0.0;
    }
    put(run, instant, "fibre", points, dim, "unit=1", values);
}

/* Put the requested fields at the integration points: Cauchy stress, Green-Lagrange strain, pressure, volume
 * ratio. */
static void put_point_fields(struct run *run, const struct instant *instant)
{
    struct body *body = &run->model->system.body;
    const struct scene_output *output = &run->scene->output;
    int64_t points = body->point_count;
    if (output->volume_ratio) {
        double *ratio = run_new_values(run, points);
        body_volume_ratio(body, ratio);
        put(run, instant, "volume_ratio", points, 1, "unit=1", ratio);
    }
    if (!output->stress && !output->strain && !output->pressure && !output->fibre) {
        return;
    }
    double *F = run_new_values(run, points * 9), *P = run_new_values(run, points * 9);
    double *pressure = run_new_values(run, points);
    body_gradient(body, F);
    body_stress(body, P);
    if (output->fibre) {
        put_fibres(run, instant, F);
    }
    for (int64_t q = 0; q < points;
         q++) { /* Cauchy stress P F^T / J, Green-Lagrange strain (F^T F - 1) / 2 */
        double *f = F + 9 * q, *p = P + 9 * q, J = determinant(f), stress[9], strain[9];
        for (int k = 0; k < 9; k++) {
            int i = k / 3, j = k % 3;
            stress[k] = (p[3 * i] * f[3 * j] + p[3 * i + 1] * f[3 * j + 1] + p[3 * i + 2] * f[3 * j + 2]) / J;
            strain[k] = 0.5 * (f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j] - (i == j));
        }
        memcpy(f, strain, sizeof strain);
        memcpy(p, stress, sizeof stress);
        pressure[q] = (0.0 - stress[0] - stress[4] - stress[8]) / 3.0;
    }
    if (output->stress) {
        put_tensors(run, instant, "stress", "unit=Pa measure=cauchy", P);
    }
    if (output->strain) {
        put_tensors(run, instant, "strain", "unit=1 measure=green-lagrange", F);
    }
    FREE_ALL(F, P);
    if (output->pressure) {
        put(run, instant, "pressure", points, 1, "unit=Pa", pressure);
    } else {
        free(pressure);
    }
}

void run_put_table(const struct run *run, const struct instant *instant, const char *name, int64_t rows,
                   int64_t cols, const char *attributes, double *values)
{
    char table[64];
    int64_t count = rows * cols;
    if (instant->frame == FRAME_NONE) {
        run_put(run, name, rows, cols, attributes, values);
        return;
    }
    snprintf(table, sizeof table, "%s.frames", name);
    const struct section *before = stream_find(run->stream, table);
    int64_t known = before != NULL && before->cols == count + 1 ? before->rows : 0;
    double *all = run_new_values(run, (known + 1) * (count + 1)), *row = all + known * (count + 1);
    if (known > 0) {
        memcpy(all, before->data, (size_t)(known * (count + 1)) * sizeof *all);
    }
    row[0] = instant->time;
    memcpy(row + 1, values, (size_t)count * sizeof *row);
    free(values);
    run_put(run, table, known + 1, count + 1, attributes, all);
}

/* Put place, gap, and nominal and true pressure of every contact node of every contact. */
static void put_gaps(const struct run *run, const struct instant *instant)
{
    const struct solid_system *system = &run->model->system;
    const struct assembly *assembly = &run->model->assembly;
    const bool friction = system_has_friction(system);
    int dim = run->scene->dim, cols = dim + 3 + (friction ? dim + 1 : 0);
    int64_t rows = 0, size = system->node_count * dim;
    SCRATCH double *x = run_new_values(run, size);
    assembly_nodal_field(assembly, run->u, x);
    for (int64_t i = 0; i < size; i++) {
        x[i] += system->X[i];
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        rows += contact_nodes(&system->contacts[c])->count;
    }
    double *values = run_new_values(run, rows * cols), *row = values;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *nodes = contact_nodes(contact);
        const struct facet_set *facets = &assembly->contacts[contact->section].facets;
        for (int64_t a = 0; a < nodes->count; a++, row += cols) {
            struct contact_node node = contact_node(contact, a);
            memcpy(row, nodes->position + a * dim, (size_t)dim * sizeof *values);
            row[dim] = node.gap;
            row[dim + 1] = node.pressure;
            row[dim + 2] = node.pressure / boundary_stretch(nodes, &assembly->face_table, facets, a, x);
            for (int k = 0; k < dim && friction; k++) {
                row[dim + 3 + k] = node.friction[k];
            }
            if (friction) {
                row[2 * dim + 3] = node.slips;
            }
        }
    }
    put(run, instant, "gaps", rows, cols,
        friction   ? dim == 2 ? "unit=m,m,m,Pa,Pa,Pa,Pa,1 "
                                "cols=x,y,gap,pressure,true_pressure,friction.x,friction.y,slips"
                              : "unit=m,m,m,m,Pa,Pa,Pa,Pa,Pa,1 "
                                "cols=x,y,z,gap,pressure,true_pressure,friction.x,friction.y,friction.z,slips"
        : dim == 2 ? "unit=m,m,m,Pa,Pa cols=x,y,gap,pressure,true_pressure"
                   : "unit=m,m,m,m,Pa,Pa cols=x,y,z,gap,pressure,true_pressure",
        values);
}

/* Put the energies of the equilibrium. The work of loads during a relaxation has no meaning. */
static void put_energy(struct run *run, const struct instant *instant)
{
    struct solid_system *system = &run->model->system;
    bool is_plane = run->scene->dim == 2;
    bool in_time = run->scene->duration > 0.0, in_steps = in_time || run->scene->solver.time_steps > 0;
    const char *unit = is_plane ? "J/m" : "J", *more = in_steps ? "," : "";
    int count = in_steps ? 3 : 2;
    char attributes[96];
    double *values = run_new_values(run, count);
    values[0] = energy_internal(system, run->u);
    values[1] = energy_contact(system);
    bool is_frame = instant->frame != FRAME_NONE;
    if (in_steps) {
        values[2] = system->body.prony.dissipated + system_friction_work(system);
    }
    snprintf(attributes, sizeof attributes, "unit=%s%s,%s%s%s cols=%sinternal,contact%s",
             !is_frame ? ""
             : in_time ? "s,"
                       : "1,",
             unit, unit, more, in_steps ? unit : "", is_frame ? "time," : "", in_steps ? ",dissipated" : "");
    run_put_table(run, instant, "energy", 1, count, attributes, values);
}

/* Put the requested output besides u, for the state run->u at which the system was evaluated last. */
static void put_state(struct run *run, const struct instant *instant)
{
    const struct scene_output *output = &run->scene->output;
    put_point_fields(run, instant);
    run_put_forces(run, instant);
    if (output->energy && run->scene->analysis == SCENE_QUASI_STATIC) {
        put_energy(run, instant);
    }
    if (output->gaps && run->model->system.contact_count > 0) {
        put_gaps(run, instant);
    }
}

void run_put_frame(void *context, int64_t number, double time, const double *u)
{
    struct run *run = context;
    const double duration = run->scene->duration;
    const struct instant now = {number, duration > 0.0 ? time * duration : time};
    run_put_field(run, &now, u);
    run->last_good = -1.0; /* it has been given */
    run_folds_check(run, u, time, true);
    if (run->scene->analysis == SCENE_QUASI_STATIC) {
        run_stability_check(run, time, false);
        run_contacts_penetrate(run, field_largest(run->model->system.node_count, run->scene->dim, u), 0.0,
                               false);
        put_state(run, &now);
    }
    run_frames_write(run, number);
}

void run_put_results(struct run *run)
{
    struct model *model = run->model;
    SCRATCH double *scratch = run_new_values(run, model->system.node_count * run->scene->dim);
    /* Evaluate F, stresses and gaps at the final state. */
    (void)system_residual(&model->system, run->u, scratch);
    system_measure_contacts(&model->system, run->u, true);
    put_state(run, &(struct instant){.frame = FRAME_NONE});
    run_put_field(run, &(struct instant){.frame = FRAME_NONE}, run->u);
}
