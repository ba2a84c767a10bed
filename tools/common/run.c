#include "run.h"

#include "solid/energy.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static void show_progress(struct display *display, const struct progress *progress)
{
    double now = clock_seconds();
    if (!display->shown || now - display->last < 0.25) {
        return;
    }
    display->last = now;
    fprintf(stderr, "\rstep %lld  time %.3f  error %.1e", (long long)progress->step, progress->time,
            progress->error);
    if (progress->remaining >= 0.0 && progress->remaining < 1.0) {
        fprintf(stderr, "  %.0f s left  ",
                (now - display->started) * progress->remaining / (1.0 - progress->remaining));
    }
}

bool run_tell(void *context, const struct progress *progress)
{
    struct run *run = context;
    show_progress(&run->display, progress);
    return run_checkpoint_tell(run, progress);
}

void run_clear_progress(const struct display *display)
{
    if (display->shown && display->last > 0.0) {
        fprintf(stderr, "\r%78s\r", "");
    }
}

void run_drop_tables(struct stream *stream)
{
    static const char *const prefixes[] = {"points.", "faces", "facepoints.", "nbr.",
                                           "face.",   "node.", "shape.",      "support.radius"};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
        stream_remove_prefix(stream, prefixes[i]);
    }
}

/* The number behind that of the last frame. */
static int64_t next_frame(const struct stream *stream)
{
    char name[40];
    for (int64_t number = 1;; number++) {
        snprintf(name, sizeof name, "u.frame.%lld", (long long)number);
        if (stream_find(stream, name) == NULL) {
            return number;
        }
    }
}

void run_fail(struct run *run, enum status status, const char *format, ...)
{
    const struct scene_output *output = &run->scene->output;
    char text[sizeof((struct error *)0)->text];
    struct error reason;
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    fail(&reason, status, "%s", text); /* one line, whatever the names in it contain */
    tool_note(run->tool, "%s", reason.text);
    if (output->frames > 0 || output->interval > 0.0) {
        if (run->last_good >= 0.0) {
            run_put_frame(run, next_frame(run->stream), run->last_good, run->u);
        }
        run_drop_tables(run->stream);
        tool_write_stopped(run->tool, run->stream, reason.text, run->text);
    }
    tool_exit(status);
}

/* A verdict other than converged ends the run: nothing half-done passes for a result. */
static void judge(struct run *run, const struct relaxation_report *report)
{
    const struct scene *scene = run->scene;
    char place[96] = "";
    if (report->outcome == RELAXATION_CONVERGED) {
        if (report->error > scene->solver.tolerance) {
            tool_note(run->tool, "%s: estimated error %.2g, not %.2g: round-off admits no less", scene->path,
                      report->error, scene->solver.tolerance);
        }
        return;
    }
    if (report->outcome == RELAXATION_STALLED) {
        run_fail(run, STATUS_VERDICT,
                 "%s: step %lld: the estimated error stays at %.2g of the displacement: a larger tolerance, "
                 "a finer cloud at "
                 "the contacts, or supports against rigid motion may help",
                 scene->path, (long long)report->steps, report->error);
    }
    if (report->outcome == RELAXATION_STOPPED) {
        run_checkpoint_stop(run, report->steps);
    }
    if (report->outcome == RELAXATION_INVERTED) {
        const double *x =
            (const double *)run->model->input.points->data + report->inverted_point * scene->dim;
        point_text(scene->dim, x, place);
        run_fail(run, STATUS_VERDICT,
                 "%s: step %lld: integration point %lld at %s is inverted (J = %.3g): apply the load in "
                 "more steps "
                 "(ramp_steps > %lld), or a smaller one, or refine there",
                 scene->path, (long long)report->steps, (long long)report->inverted_point, place,
                 report->least_jacobian, (long long)report->ramp_steps);
    }
    run_fail(
        run, STATUS_VERDICT,
        "%s: not converged after %lld steps: estimated remaining error %.2g of the displacement: allow more "
        "(max_steps), or hold the body against rigid motion",
        scene->path, (long long)report->steps, report->error);
}

void run_quasi_static(struct run *run)
{
    const struct scene_solver *solver = &run->scene->solver;
    const struct body *body = &run->model->system.body;
    struct relaxation_options options = {.tolerance = solver->tolerance,
                                         .time_step_margin = solver->time_step_margin,
                                         .ramp_steps = solver->ramp_steps,
                                         .most_steps = solver->max_steps,
                                         .frames = run->scene->output.frames,
                                         .frame = run_put_frame,
                                         .progress = run_tell,
                                         .context = run,
                                         .interrupted = run->checkpoint.interrupted,
                                         .restored = run_checkpoint_state(run)};
    struct relaxation_report report;
    struct error error;
    double started = clock_seconds();
    enum status status =
        relaxation_run(&run->model->system, &options, run->u, run->model->row_force, &report, &error);
    run->solve_seconds = clock_seconds() - started;
    run_clear_progress(&run->display);
    tool_check(run->tool, status, &error);
    run->last_good = report.load;
    judge(run, &report);
    if (run->verbose) {
        fprintf(stderr, "points\t%lld\npairs\t%lld\nsteps\t%lld\nramp steps\t%lld\nforce evaluations\t%lld\n",
                (long long)body->point_count, (long long)body->pair_count, (long long)report.steps,
                (long long)report.ramp_steps, (long long)report.force_evaluations);
        fprintf(stderr, "estimated error\t%.3g\nfrequency ratio\t%.5g\nleast J\t%.4g\n", report.error,
                report.largest_frequency / report.lowest_frequency, report.least_jacobian);
    }
}

void run_report_cost(const struct run *run)
{
    const struct cost *cost = &run->model->system.cost;
    double stepping = run->solve_seconds - cost->force - cost->loads - cost->contact - cost->constraints;
    double whole = run->read_seconds + run->prepare_seconds + run->solve_seconds + run->write_seconds;
    const struct {
        const char *part;
        double seconds;
    } rows[] = {{"read", run->read_seconds}, {"prepare", run->prepare_seconds},
                {"force", cost->force},      {"loads", cost->loads},
                {"contact", cost->contact},  {"constraints", cost->constraints},
                {"stepping", stepping},      {"write", run->write_seconds}};
    fprintf(stderr, "prepare seconds\t%.3f\nsolve seconds\t%.3f\n", run->prepare_seconds, run->solve_seconds);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        fprintf(stderr, "cost %s\t%.4f s\t%.1f %%\n", rows[i].part, rows[i].seconds,
                100.0 * rows[i].seconds / whole);
    }
}

void run_put(const struct run *run, const char *name, int64_t rows, int64_t cols, const char *attributes,
             double *values)
{
    struct error error;
    tool_check(run->tool,
               stream_put(run->stream, name, TYPE_F8, rows, cols, attributes, values, true, &error), &error);
}

double *run_new_values(const struct run *run, int64_t count)
{
    struct error error;
    double *values;
    tool_check(run->tool, NEW_ARRAY(&values, count, &error), &error);
    return values;
}

static const char *vector_attributes(int dim, const char *unit, char text[64])
{
    snprintf(text, 64, "unit=%s cols=%s", unit, dim == 2 ? "x,y" : "x,y,z");
    return text;
}

void run_put_frame(void *context, int64_t number, double time, const double *u)
{
    const struct run *run = context;
    int dim = run->scene->dim;
    int64_t nodes = run->model->system.node_count;
    char name[40], vector[64], attributes[128];
    double *field = run_new_values(run, nodes * dim);
    model_nodal_field(&run->model->input, u, field);
    snprintf(name, sizeof name, "u.frame.%lld", (long long)number);
    snprintf(attributes, sizeof attributes, "%s time=%.12g", vector_attributes(dim, "m", vector), time);
    run_put(run, name, nodes, dim, attributes, field);
}

/* Components of a symmetric tensor in output order. */
static const int tensor_2d[4] = {0, 4, 8, 1}, tensor_3d[6] = {0, 4, 8, 1, 2, 5};

/* Cauchy stress P F^T / J, or Green-Lagrange strain, per integration point, with the points' places. */
static void put_tensors(struct run *run)
{
    const struct body *body = &run->model->system.body;
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

/* Total force of each displacement section and contact: a row each. */
static void put_reactions(struct run *run)
{
    struct solid_system *system = &run->model->system;
    const struct scene *scene = run->scene;
    int dim = scene->dim;
    int64_t rows = scene->displacement_count + scene->contact_count;
    double *total = run_new_values(run, rows * dim);
    size_t size = 16;
    for (int64_t i = 0; i < scene->displacement_count; i++) {
        size += strlen(scene->displacements[i].label.name) + 1;
    }
    for (int64_t i = 0; i < scene->contact_count; i++) {
        size += strlen(scene->contacts[i].label.name) + 1;
    }
    char *attributes = (char *)run_new_values(run, (int64_t)(size + 64));
    size_t at = (size_t)snprintf(attributes, size + 64, "unit=%s rows=", dim == 2 ? "N/m" : "N");
    for (int64_t i = 0; i < rows; i++) {
        const char *name = i < scene->displacement_count
                               ? scene->displacements[i].label.name
                               : scene->contacts[i - scene->displacement_count].label.name;
        at += (size_t)snprintf(attributes + at, size + 64 - at, "%s%s", i > 0 ? "," : "", name);
    }
    const struct constraint_rows *constraint = &system->rows;
    for (int64_t r = 0; r < constraint->count; r++) {
        double share = 0.0;
        for (int64_t i = constraint->ptr[r]; i < constraint->ptr[r + 1]; i++) {
            share += constraint->phi[i]; /* 1 but for round-off */
        }
        for (int a = 0; a < dim; a++) {
            total[constraint->section[r] * dim + a] +=
                share * run->model->row_force[r] * constraint->direction[r * dim + a];
        }
    }
    for (int64_t r = 0; r < system->springs.count; r++) {
        double pull = system_spring_force(system, r, run->u);
        for (int a = 0; a < dim; a++) {
            total[system->springs.section[r] * dim + a] += pull * system->springs.direction[r * dim + a];
        }
    }
    for (int64_t c = 0; c < scene->contact_count; c++) {
        contact_total(&system->contacts[c], total + (scene->displacement_count + c) * dim);
    }
    run_put(run, "reactions", rows, dim, attributes, total);
    free(attributes);
}

/* Gap, pressure and place of every hat of every contact. */
static void put_gaps(struct run *run)
{
    const struct solid_system *system = &run->model->system;
    int dim = run->scene->dim, cols = dim + 2;
    int64_t rows = 0, at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        rows += system->contacts[c].count;
    }
    double *values = run_new_values(run, rows * cols);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t a = 0; a < contact->count; a++, at++) {
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
