#include "mtled/run.h"

#include <stdarg.h>

static void show_progress(struct display *display, const struct progress *progress)
{
    double now = clock_seconds();
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
    fail(&reason, status, "%s%s%s", text, folds[0] != '\0' ? "; " : "", folds);
    tool_note(run->tool, "%s", reason.text);
    (void)process_fails_alone(); /* the others wait while the first one writes */
    run_frames_stop(run, reason.text);
    tool_exit(status);
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
