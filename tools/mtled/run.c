#include "mtled/run.h"

#include "base/vector.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static void show_progress(struct display *display, const struct progress *progress)
{
    double now = omp_get_wtime();
    if (!display->shown || now - display->last < 0.25) {
        return;
    }
    display->last = now;
    fprintf(stderr, "\rstep %jd  time %.3f  error %.1e", progress->step, progress->time, progress->error);
    if (progress->remaining >= 0.0 && progress->remaining < 1.0) {
        fprintf(stderr, "  %.0f s left  ",
                (now - display->started) * progress->remaining / (1.0 - progress->remaining));
    }
}

bool run_progress(void *context, const struct progress *progress)
{
    struct run *run = context;
    show_progress(&run->display, progress);
    run_folds_check(run, progress->u, progress->time, false);
    return run_checkpoint_step(run, progress);
}

void run_clear_progress(const struct display *display)
{
    if (display->shown && display->last > 0.0) {
        fprintf(stderr, "\r%78s\r", "");
    }
}

void run_fail(struct run *run, enum status status, const char *format, ...)
{
    struct error reason;
    char text[sizeof reason.text], folds[sizeof reason.text] = "";
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    if (status == STATUS_VERDICT && !run->folds.reported) {
        run_folds_describe(run, folds, sizeof folds);
    }
    /* fail() makes one line of it, whatever the names in it contain. */
    bool verdict = status == STATUS_VERDICT;
    fail(&reason, status, "%s%s%s%s%s%s", verdict ? run->scene->path : "", verdict ? ": " : "",
         verdict ? run->at : "", text, folds[0] != '\0' ? "; " : "", folds);
    tool_note(run->tool, "%s", reason.text);
    (void)process_fails_alone(); /* the others wait while the first one writes */
    run_frames_stop(run, reason.text);
    tool_exit(status);
}

void run_note(const struct run *run, const char *format, ...)
{
    struct error note;
    va_list values;
    va_start(values, format);
    vsnprintf(note.text, sizeof note.text, format, values);
    va_end(values);
    tool_note(run->tool, "%s: %s", run->scene->path, note.text);
}

void run_put(const struct run *run, const char *name, int64_t rows, int64_t cols, const char *attributes,
             double *values)
{
    tool_put(run->tool, run->stream, name, TYPE_F8, rows, cols, attributes, values);
}

double *run_new_values(const struct run *run, int64_t count)
{
    double *values;
    TOOL_TRY(run->tool, NEW_ARRAY(&values, count, &error));
    return values;
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

/* ---- --start: from the field of another run, near its result ---- */

void run_start_read(struct run *run)
{
    const struct scene *scene = run->scene;
    const char *file = run->start_file;
    if (file == NULL) {
        return;
    }
    if (scene->analysis == SCENE_DYNAMIC || scene->output.frames > 0 || scene->duration > 0.0 ||
        scene->solver.time_steps > 0) {
        tool_fail(run->tool, STATUS_INPUT,
                  "--start: the run begins at the whole load: a scene in time, with friction, or that asks "
                  "for frames, has states before");
    }
    side_read_displacement(run->tool, file, "u", scene->dim, &run->start);
}

/* The contact whose rigid surface the body goes through on the straight way from rest to u, in steps of a
 * spacing at most; NULL: none. It would be pushed out to whatever side is near. */
static const struct contact *passed_through(struct run *run)
{
    struct solid_system *system = &run->model->system;
    const struct contact *through = NULL;
    int64_t size = system->node_count * system->dim;
    SCRATCH double *on_way = run_new_values(run, size);
    double longest =
        vector_longest(system->dim, system->node_count, run->u, NULL) + system_longest_way(system);
    double steps = ceil(longest / system_node_spacing(system));
    for (double step = 1.0; step <= steps && through == NULL && system->contact_count > 0; step++) {
        for (int64_t i = 0; i < size; i++) {
            on_way[i] = step / steps * run->u[i];
        }
        system_load_factors(system, step / steps);
        system_measure_contacts(system, on_way, true);
        for (int64_t c = 0; c < system->contact_count; c++) {
            through = contact_is_through(&system->contacts[c]) ? &system->contacts[c] : through;
        }
    }
    return through;
}

void run_start(struct run *run)
{
    const struct nodal_field *field = &run->start.field;
    if (run->start_file == NULL) {
        return;
    }
    const double *values = field->parameters != NULL ? field->parameters : field->values;
    TOOL_TRY(run->tool, fail_in(&error,
                                field_carry(&field->cells, field->cols, values, &run->model->assembly.cells,
                                            run->u, &error),
                                "--start: %s", run->start.name));
    struct solid_system *system = &run->model->system;
    SCRATCH double *force = run_new_values(run, system->node_count * system->dim);
    /* A body that has been cut may be inverted, at the edge of an earlier cut, in a field that was none of
     * its own. */
    bool inverts = body_inverts(&system->body, run->u, force);
    const struct contact *through = inverts ? NULL : passed_through(run);
    if (inverts || through != NULL) {
        tool_note(run->tool, "--start: %s: u %s%s%s: begun at rest", run->start.name,
                  inverts ? "inverts a cell" : "goes through the surface of [contact ",
                  inverts ? "" : run->scene->contacts[through->section].label.name, inverts ? "" : "]");
        memset(run->u, 0, (size_t)(system->node_count * system->dim) * sizeof *run->u);
        return;
    }
    TOOL_TRY(run->tool, system_start(system, run->u, &error));
}
