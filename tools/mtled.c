static const char usage[] =
    "mtled - total Lagrangian explicit dynamics of a scene, meshless\n"
    "\n"
    "usage: mtled [-v] [-q] [-b] [-o FILE] SCENE [FILE]\n"
    "\n"
    "Reads a stream with a table of shape functions (see shapefn) and computes the scene, an INI file that\n"
    "names materials, prescribed displacements, contacts and loads on the groups of the mesh. Writes the nodes,\n"
    "the cells and u (m), the displacement field at the nodes, one row per node in the order of the mesh, as\n"
    "text; and what else the scene's [output] asks for. Without earlier sections the defaults of ipoints,\n"
    "support and shapefn are run first, with the same result.\n"
    "\n"
    "Quasi-static scenes are relaxed until the estimated remaining error, relative to the displacement, is below\n"
    "the scene's tolerance. On a terminal, progress is shown with step, time, error and time left.\n"
    "\n"
    "Options:\n"
    "  -v, --verbose        end with a report on standard error: steps, error, cost of each part\n"
    "  -q, --quiet          no progress\n"
    "  -b, --binary         write binary instead of text\n"
    "  -o, --output FILE    write to FILE, which appears only when whole\n"
    "\n"
    "Exit status:\n"
    "  0 converged; 1 diverged, inverted, or out of steps (nothing is written); 2 usage or malformed input;\n"
    "  3 input/output or memory\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | shapefn | mtled brain2d.scene > u.dat\n"
    "  nodes -u mm body.msh | ipoints -g 4 | support -k 2 | shapefn | mtled -v brain2d.scene > u.dat\n";

#include "model.h"
#include "solid/relaxation.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { VERBOSE, QUIET, BINARY, OUTPUT, OPTION_COUNT };

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct display {
    bool shown;
    double started, last;
};

/* One line on the terminal, a few times a second. */
static bool show_progress(void *context, const struct progress *progress)
{
    struct display *display = context;
    double now = seconds();
    if (!display->shown || now - display->last < 0.25) {
        return true;
    }
    display->last = now;
    fprintf(stderr, "\rstep %lld  time %.3f  error %.1e", (long long)progress->step, progress->time, progress->error);
    if (progress->remaining >= 0.0 && progress->remaining < 1.0) {
        fprintf(stderr, "  %.0f s left  ",
                (now - display->started) * progress->remaining / (1.0 - progress->remaining));
    }
    return true;
}

static void clear_progress(const struct display *display)
{
    if (display->shown && display->last > 0.0) {
        fprintf(stderr, "\r%78s\r", "");
    }
}

static void report_outcome(const struct tool *tool, const struct scene *scene, const struct model *model,
                           const struct relaxation_report *report)
{
    char place[96] = "";
    const double *x = (const double *)model->input.points->data + report->inverted_point * scene->dim;
    switch (report->outcome) {
    case RELAXATION_CONVERGED:
        return;
    case RELAXATION_INVERTED:
        point_text(scene->dim, x, place);
        tool_fail(tool, STATUS_VERDICT,
                  "%s: step %lld: integration point %lld at %s is inverted (J = %.3g): apply the load in more "
                  "steps (ramp_steps > %lld), or a smaller one, or refine there",
                  scene->path, (long long)report->steps + 1, (long long)report->inverted_point, place,
                  report->least_jacobian, (long long)report->ramp_steps);
    case RELAXATION_TOO_MANY_STEPS:
    case RELAXATION_STOPPED:
        break;
    }
    tool_fail(tool, STATUS_VERDICT,
              "%s: not converged after %lld steps: estimated remaining error %.2g of the displacement: allow more "
              "(max_steps), or hold the body against rigid motion",
              scene->path, (long long)report->steps, report->error);
}

/* The sections that only the computation needs leave the stream; the rest passes through. */
static void drop_tables(struct stream *stream)
{
    static const char *const prefixes[] = {"points.", "faces", "facepoints.", "nbr.", "face.",
                                           "node.",   "shape.", "support.radius"};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
        stream_remove_prefix(stream, prefixes[i]);
    }
}

static void put_field(const struct tool *tool, struct stream *stream, const char *name, int dim, int64_t rows,
                      const char *unit, double *values)
{
    struct error error;
    char attributes[64];
    snprintf(attributes, sizeof attributes, "unit=%s cols=%s", unit, dim == 2 ? "x,y" : "x,y,z");
    tool_check(tool, stream_put(stream, name, TYPE_F8, rows, dim, attributes, values, true, &error), &error);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct stream stream;
    struct scene scene;
    struct model model;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [VERBOSE] = {.letter = 'v', .name = "verbose"},
        [QUIET] = {.letter = 'q', .name = "quiet"},
        [BINARY] = {.letter = 'b', .name = "binary"},
        [OUTPUT] = {.letter = 'o', .name = "output", .takes_value = true},
    };
    tool_begin(&tool, usage, options, OPTION_COUNT, 1, 2, argc, argv);
    tool_check(&tool, scene_read(tool.operands[0], &scene, &error), &error);
    tool_read(&tool, tool.operand_count > 1 ? tool.operands[1] : NULL, &stream);
    stage_fill(&tool, &stream, "shapefn");

    double started = seconds();
    tool_check(&tool, model_build(&stream, &scene, &model, &error), &error);
    double *u, *field;
    int64_t size = model.system.node_count * scene.dim;
    tool_check(&tool, NEW_ARRAY(&u, size, &error), &error);
    tool_check(&tool, NEW_ARRAY(&field, size, &error), &error);

    struct display display = {.shown = !options[QUIET].given && isatty(STDERR_FILENO), .started = seconds()};
    struct relaxation_options relaxation = {.tolerance = scene.solver.tolerance,
                                            .time_step_margin = scene.solver.time_step_margin,
                                            .ramp_steps = scene.solver.ramp_steps,
                                            .most_steps = scene.solver.max_steps,
                                            .progress = show_progress,
                                            .context = &display};
    struct relaxation_report report;
    double prepared = seconds();
    tool_check(&tool, relaxation_run(&model.system, &relaxation, u, NULL, &report, &error), &error);
    double solved = seconds();
    clear_progress(&display);
    report_outcome(&tool, &scene, &model, &report);

    model_nodal_field(&model.input, u, field);
    if (options[VERBOSE].given) {
        fprintf(stderr, "points\t%lld\npairs\t%lld\nsteps\t%lld\nramp steps\t%lld\nforce evaluations\t%lld\n",
                (long long)model.system.body.point_count, (long long)model.system.body.pair_count,
                (long long)report.steps, (long long)report.ramp_steps, (long long)report.force_evaluations);
        fprintf(stderr, "estimated error\t%.3g\nfrequency ratio\t%.5g\nleast J\t%.4g\n", report.error,
                report.largest_frequency / report.lowest_frequency, report.least_jacobian);
        fprintf(stderr, "prepare seconds\t%.3f\nsolve seconds\t%.3f\n", prepared - started, solved - prepared);
    }
    model_free(&model);
    drop_tables(&stream);
    put_field(&tool, &stream, "u", scene.dim, size / scene.dim, "m", field);
    tool_write(&tool, &stream, !options[BINARY].given);
    free(u);
    scene_free(&scene);
    stream_free(&stream);
    return tool_end(&tool);
}
