static const char usage[] =
    "mtled - total Lagrangian explicit dynamics of a scene, meshless\n"
    "\n"
    "usage: mtled [-v] [-q] [-b] [-s FILE] [-c FILE [-e SECONDS]] [-o FILE] SCENE [FILE]\n"
    "\n"
    "Reads a stream with a table of shape functions (see shapefn) and computes the scene, an\n"
    "INI file that names materials, prescribed displacements, contacts and loads on the groups\n"
    "of the mesh (see mtled-scene(5)). Writes the nodes, the cells and u (m), the displacement\n"
    "field at the nodes, a row for each as in the mesh, as text; its parameters and supports, for\n"
    "interp and fieldcmp; and what else the scene's [output] requests. Without earlier sections the\n"
    "defaults of ipoints, support and shapefn are run first, with the same result. Under mpirun\n"
    "several processes (make mpi) read one FILE and share the work; the bytes are the same.\n"
    "\n"
    "Quasi-static scenes are solved by Newton's method until the estimated error, relative to the\n"
    "displacement, is below the scene's tolerance. Dynamic scenes are stepped to their end time by\n"
    "central differences with the true mass.\n"
    "Verdicts are: a body that may move or turn as a whole, as neither a displacement nor a contact\n"
    "prevents it; a point that is inverted; a body that folds (see mtled-scene(5)); in a dynamic scene\n"
    "a critical step that collapses (below 0.001 of the first one) and an energy balance that is\n"
    "off by more than 0.05 of the largest energy.\n"
    "\n"
    "Nothing is written by a run that ends with a verdict or by a signal, but where the scene requests\n"
    "frames: these are written as they come (-o FILE: to FILE.part), then the last good state;\n"
    "the stream says at its end that it is not whole, and mts recover makes it one.\n"
    "\n"
    "Sections on request, of the final state: stress (Cauchy), strain (Green-Lagrange), pressure\n"
    "and volume_ratio of each integration point; reactions and moments of each displacement,\n"
    "support and contact, the moments about moments_about, at the deformed places where they act; gaps and\n"
    "nominal pressures, per area at rest, of contacts; energy, J (2D: J/m): in a\n"
    "dynamic scene about 200 "
    "rows of time (s),\n"
    "kinetic, internal and contact energy, work of loads and prescribed motion, dissipated, and\n"
    "error of the balance relative to the largest energy; in a quasi-static scene one row,\n"
    "internal and contact.\n"
    "\n"
    "Of frames, intermediate states: u.frame.K, the field u at time=, K = 0, the start, 1, 2, ...,\n"
    "evenly. A quasi-static scene's time is 0 to 1; its load is that of the curve, constant until the\n"
    "error is below the tolerance. Such scenes also have the other requested sections for each\n"
    "frame: stress.frame.K and so on, and tables with a row for each frame, time first,\n"
    "reactions.frames, moments.frames, energy.frames: a load curve.\n"
    "\n"
    "With -c, the state of the run is kept in a file, from time to time and when SIGINT, SIGTERM\n"
    "or SIGHUP end it. The same command then continues the run, and ends with the same bytes;\n"
    "with another scene, cloud or version it is refused. FILE is replaced as a whole. It is a\n"
    "stream with the last field as u.last; FILE.frames has the frames so far. At the end both are\n"
    "removed.\n"
    "\n"
    "Options:\n"
    "  -v, --verbose        a report on standard error: steps, error, costs\n"
    "  -q, --quiet          no progress\n"
    "  -b, --binary         write binary instead of text\n"
    "  -s, --start FILE     begin at the whole load from u of this stream: of a coarser mesh, before a cut\n"
    "  -c, --checkpoint FILE\n"
    "                       keep the state of the run in FILE, and go on from what is there\n"
    "  -e, --every SECONDS  with -c: how often (default 60)\n"
    "  -o, --output FILE    write to FILE, which appears only when whole\n"
    "\n"
    "Exit status:\n"
    "  0        done\n"
    "  1        a verdict, as above, or not converged\n"
    "  2        wrong usage or malformed input\n"
    "  3        input, output or memory failed\n"
    "  128 + n  ended by signal n after a whole step\n"
    "\n"
    "Environment:\n"
    "  OMP_WAIT_POLICY=passive  for cores that other programs use: waiting threads sleep, else they\n"
    "                           spin: up to four times as long\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | shapefn | mtled brain2d.scene > u.dat\n"
    "  mpirun -n 4 mtled -o u.dat brain2d.scene body.mts\n";

#include "stage_options.h"
#include "process.h"
#include "mtled/run.h"

#include "io/stream/sections.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A number that mpirun gives each process in the environment, by Open MPI or by others; -1: none. */
static long from_mpirun(const char *name, const char *other)
{
    const char *value = getenv(name) != NULL ? getenv(name) : getenv(other);
    return value != NULL ? strtol(value, NULL, 10) : -1;
}

/* If mpirun has started several processes, execute mtled-mpi, which is in the folder of this program:
 * otherwise all would compute the same and write the same files. */
static void become_mpi(char *argv[])
{
    char file[PATH_MAX + sizeof "-mpi"];
    ssize_t length = readlink("/proc/self/exe", file, PATH_MAX);
    if (process_ranks() != NULL || from_mpirun("OMPI_COMM_WORLD_SIZE", "PMI_SIZE") <= 1) {
        return;
    }
    if (length > 0) {
        memcpy(file + length, "-mpi", sizeof "-mpi");
        execv(file, argv);
    }
    if (from_mpirun("OMPI_COMM_WORLD_RANK", "PMI_RANK") > 0) {
        sleep(10); /* mpirun ends this process after the first one has printed the message */
    } else {
        fprintf(stderr, "mtled: no mtled-mpi beside it, which mpirun needs: it is built by make mpi\n");
    }
    exit((int)STATUS_INPUT);
}

/* The checkpoint and the frames are removed at the end: none of them may be the result. */
static void check_checkpoint(const struct tool *tool)
{
    static const char *const suffixes[] = {"", ".frames"};
    const char *file = tool_value(tool, "checkpoint");
    for (int i = 0; i < 2 && file != NULL; i++) {
        SCRATCH char *name = tool_text(tool, "%s%s", file, suffixes[i]);
        if (tool->output != NULL && strcmp(name, tool->output) == 0) {
            tool_fail(tool, STATUS_INPUT,
                      "-o %s: is the checkpoint of -c %s, which is removed at the end: name another file",
                      tool->output, file);
        }
    }
}

/* Check options before any input is read; returns the time between checkpoints, s. */
static double parse(struct tool *tool)
{
    const char *input = tool->operands[1];
    tool_requires(tool, "every", "checkpoint");
    tool_leave_out(tool, "checkpoint");
    tool_leave_out(tool, "every");
    check_checkpoint(tool);
    if (process_ranks() != NULL && (input == NULL || strcmp(input, "-") == 0)) {
        tool_fail(tool, STATUS_INPUT,
                  "several processes cannot share standard input: name the stream's file");
    }
    return tool_number(tool, "every", 0.0, 1e9, 60.0);
}

/* Build the model, at rest or in the state of a checkpoint. */
static void prepare(struct run *run)
{
    struct model *model = run->model;
    run_put_supports(run);
    run_checkpoint_begin(run);
    TOOL_TRY(run->tool, model_build(run->stream, run->scene, model, &error));
    run_put_supports(run); /* the sides may have been numbered anew */
    if (model->note.text[0] != '\0') {
        tool_note(run->tool, "%s", model->note.text);
    }
    if (model->interfaces.text[0] != '\0') {
        tool_note(run->tool, "%s", model->interfaces.text);
    }
    run->u = run_new_values(run, model->system.node_count * run->scene->dim);
    run->prepare_seconds = omp_get_wtime() - run->display.started;
    run_start(run);
    run_contacts_begin(run);
    run_folds_begin(run);
    run_frames_begin(run);
    stream_give_back(run->stream);
}

/* Write the results; with -v report the time. */
static void write_results(struct run *run)
{
    run_put_results(run);
    double started = omp_get_wtime();
    run_frames_end(run);
    run->write_seconds = omp_get_wtime() - started;
    run_checkpoint_remove(run);
    if (run->verbose) {
        run_report_cost(run);
    }
    if (tool_given(run->tool, "verbose")) {
        process_report(run->evaluations);
    }
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct error error;
    FREED_BY(stream_free) struct stream stream = {0};
    FREED_BY(scene_free) struct scene scene = {0};
    FREED_BY(model_free) struct model model = {0};
    process_begin(&argc, &argv);
    become_mpi(argv);
    tool_begin(&tool, usage, 1, 2, argc, argv);
    tool.text = !tool_given(&tool, "binary");
    struct run run = {
        .tool = &tool,
        .scene = &scene,
        .model = &model,
        .stream = &stream,
        .verbose = tool_given(&tool, "verbose") && process_speaks(),
        .start_file = tool_value(&tool, "start"),
        .checkpoint = {.file = tool_value(&tool, "checkpoint"), .interval = parse(&tool)},
        .display = {.shown = !tool_given(&tool, "quiet") && process_speaks() && isatty(STDERR_FILENO)}};
    double started = omp_get_wtime();
    enum status status = scene_read(tool.operands[0], &scene, &error);
    if (status != STATUS_OK) {
        tool_fail(&tool, status, "%s%s", error.text,
                  text_ends(tool.operands[0], ".mts") ? ": a stream, not a scene? mtled SCENE [FILE]" : "");
    }
    tool_read(&tool, tool.operands[1], &stream);
    sections_remove(&stream, MADE_WITH_RESULTS, MADE_WITH_RESULTS); /* earlier ones */
    run_frames_check(&run);
    run.read_seconds = omp_get_wtime() - started;
    stage_fill(&tool, &stream, "shapefn");
    run_start_read(&run);
    run.display.started = omp_get_wtime();
    prepare(&run);
    run_solve(&run);
    write_results(&run);
    run_folds_free(&run);
    run_frames_free(&run);
    stream_free(&run.start.stream);
    free(run.u);
    return tool_end(&tool);
}
