#include "mtled/run.h"

#include "base/processor.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- signals: the run ends after the current step ---- */

static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
static volatile sig_atomic_t caught;

static void on_signal(int number)
{
    caught = number;
}

/* Let SIGINT, SIGTERM and SIGHUP, unless ignored, do this. */
static void handle_signals(void (*handler)(int number), unsigned flags)
{
    struct sigaction present, action = {.sa_handler = handler, .sa_flags = (int)flags};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (sigaction(numbers[i], NULL, &present) == 0 && present.sa_handler != SIG_IGN) {
            sigaction(numbers[i], &action, NULL);
        }
    }
}

/* ---- checkpoints ---- */

/* Put a section of another stream, which outlives this one. */
static void share(const struct run *run, struct stream *stream, const struct section *section)
{
    TOOL_TRY(run->tool, stream_put(stream, section->name, section->type, section->rows, section->cols,
                                   section->attributes, section->data, false, &error));
}

/* Whether all processes have the same number. */
static bool agree(int64_t number)
{
    const struct ranks *ranks = process_ranks();
    return ranks_most(ranks, number) == number && ranks_most(ranks, -number) == -number;
}

/* Exit if several processes have different scenes, inputs or checkpoints: they would not do the same. */
static void compare_processes(const struct run *run)
{
    const struct run_checkpoint *checkpoint = &run->checkpoint;
    uint64_t set = 0;
    for (const char *letter = processor_best_set(); *letter != '\0'; letter++) {
        set = 31 * set + (unsigned char)*letter;
    }
    if (!agree(checkpoint->identity.scene) || !agree(checkpoint->identity.input) ||
        !agree(checkpoint->file != NULL) || !agree((int64_t)(set >> 1))) {
        tool_fail(run->tool, STATUS_INPUT,
                  "the processes do not read the same: give all the same scene, tables, stream and options, "
                  "and processors of one kind");
    }
}

/* The state of what this program itself keeps from step to step: folds, stability, and the frames that have
 * been written. */
static enum status visit_own(struct run *run, const struct state *state, struct error *error)
{
    struct run_stability *stability = &run->stability;
    struct run_frames *frames = &run->frames;
    const struct state_value values[] = {{"stability.seen", STATE_FLAGS, &stability->seen, 1},
                                         {"stability.since", STATE_NUMBERS, &stability->since, 1},
                                         {"stability.node", STATE_COUNTS, &stability->node, 1},
                                         {"frames.next", STATE_COUNTS, &frames->next, 1},
                                         {"frames.sections", STATE_COUNTS, &frames->kept_sections, 1},
                                         {"frames.bytes", STATE_COUNTS, &frames->kept_bytes, 1}};
    RETURN_IF_ERROR(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    return run_folds_state(run, state, error);
}

static void resume(struct run *run)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    int64_t step = 0;
    TOOL_TRY(run->tool, checkpoint_read(checkpoint->file, &checkpoint->identity, &checkpoint->restored,
                                        &checkpoint->is_restored, &step, &error));
    if (!agree(step) || !agree(checkpoint->is_restored)) {
        tool_fail(run->tool, STATUS_INPUT, "%s: not the same file for all processes: put it where all see it",
                  checkpoint->file);
    }
    if (!checkpoint->is_restored) {
        return;
    }
    tool_note(run->tool, "going on from step %jd, kept in %s", step, checkpoint->file);
    checkpoint->state = checkpoint_state(&checkpoint->restored);
    for (int64_t i = 0; i < checkpoint->restored.section_count; i++) {
        const struct section *section = &checkpoint->restored.sections[i];
        if (run_is_of_frames(section->name) && section->type == TYPE_F8) {
            share(run, run->stream, section);
        }
    }
    TOOL_TRY(run->tool, visit_own(run, &checkpoint->state, &error));
}

void run_checkpoint_begin(struct run *run)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    if (checkpoint->file != NULL || process_ranks() != NULL) {
        TOOL_TRY(run->tool, checkpoint_identify(run->scene, run->stream, &checkpoint->identity, &error));
        if (run->start_file != NULL) {
            checkpoint->identity.input += checkpoint_identify_input(&run->start.stream);
        }
        compare_processes(run);
    }
    if (checkpoint->file != NULL) {
        resume(run);
    }
    checkpoint->last = omp_get_wtime();
    checkpoint->interrupted = &caught;
    handle_signals(on_signal, SA_RESTART | SA_RESETHAND); /* a second one ends the process at once */
}

/* Put sections for viewing the checkpoint: the cloud, and the field at this step; and the tables of frames.
 */
static void put_view(struct run *run, const struct progress *progress, struct stream *stream)
{
    static const char *const names[] = {"nodes.x", "cells", "cells.region"};
    int64_t nodes = run->model->system.node_count, dim = run->scene->dim;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const struct section *section = stream_find(run->stream, names[i]);
        if (section != NULL) {
            share(run, stream, section);
        }
    }
    for (int64_t i = 0; i < run->stream->section_count; i++) {
        if (run_is_of_frames(run->stream->sections[i].name)) {
            share(run, stream, &run->stream->sections[i]);
        }
    }
    double *field = run_new_values(run, nodes * dim);
    assembly_nodal_field(&run->model->assembly, progress->u, field);
    tool_put(run->tool, stream, "u.last", TYPE_F8, nodes, dim, "unit=m", field);
}

/* Replace the file as a whole, by way of FILE.part: whenever the program or the machine stops, it is
 * complete. */
static enum status write_now(struct run *run, const struct progress *progress, struct error *error)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    FREED_BY(stream_free) struct stream stream = {0};
    struct output output;
    struct state state;
    put_view(run, progress, &stream);
    RETURN_IF_ERROR(run_frames_sync(run, error));
    RETURN_IF_ERROR(checkpoint_begin(&stream, &checkpoint->identity, progress->step, &state, error));
    RETURN_IF_ERROR(progress->state(progress->run, &state, error));
    RETURN_IF_ERROR(visit_own(run, &state, error));
    enum status status = output_open(&output, checkpoint->file, true, error);
    if (status == STATUS_OK) {
        status = output_end(&output, stream_write(&stream, output.file, false, error), error);
    }
    checkpoint->is_there = checkpoint->is_there || status == STATUS_OK;
    if (status != STATUS_OK) {
        SCRATCH char *part = tool_text(run->tool, "%s.part", checkpoint->file);
        unlink(part);
    }
    return status;
}

/* Write a checkpoint, by the first process. Returns a failure that must end the run. */
static enum status keep(struct run *run, const struct progress *progress, bool interrupted)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    bool is_first = !checkpoint->is_there && !checkpoint->is_restored;
    if (!process_speaks() ||
        (!interrupted && omp_get_wtime() - checkpoint->last < checkpoint->interval && !is_first)) {
        return STATUS_OK;
    }
    checkpoint->status = write_now(run, progress, &checkpoint->error);
    checkpoint->last = omp_get_wtime();
    if (checkpoint->status != STATUS_OK && !interrupted) {
        run_clear_progress(&run->display);
        if (is_first) { /* fail now rather than when the checkpoint is needed */
            struct error unused;
            enum status ignored = checkpoint_remove(checkpoint->file, &unused);
            (void)ignored;
            return checkpoint->status;
        }
        tool_note(run->tool, "no checkpoint at step %jd: %s; the one before stays", progress->step,
                  checkpoint->error.text);
    }
    return STATUS_OK;
}

bool run_checkpoint_step(struct run *run, const struct progress *progress)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    const struct ranks *ranks = process_ranks();
    bool interrupted = ranks_most(ranks, *checkpoint->interrupted) != 0;
    if (checkpoint->file != NULL) {
        enum status status = keep(run, progress, interrupted);
        tool_check(run->tool, ranks_agree(ranks, status, &checkpoint->error), &checkpoint->error);
    }
    return !interrupted;
}

void run_checkpoint_end(void)
{
    handle_signals(SIG_DFL, 0);
}

void run_checkpoint_stop(struct run *run, int64_t steps)
{
    const struct run_checkpoint *checkpoint = &run->checkpoint;
    int number = (int)ranks_most(process_ranks(), *checkpoint->interrupted);
    const char *name = sigabbrev_np(number);
    enum status status = (enum status)(128 + number);
    const char *rest = checkpoint->file == NULL          ? "to be able to go on, use -c"
                       : checkpoint->status != STATUS_OK ? "no checkpoint: "
                                                         : "the same command goes on from ";
    run_fail(run, status, "ended by SIG%s after step %jd: %s%s", name, steps, rest,
             checkpoint->file == NULL          ? ""
             : checkpoint->status != STATUS_OK ? checkpoint->error.text
                                               : checkpoint->file);
}

void run_checkpoint_remove(struct run *run)
{
    struct run_checkpoint *checkpoint = &run->checkpoint;
    stream_free(&checkpoint->restored);
    if (checkpoint->file != NULL && process_speaks()) {
        TOOL_TRY(run->tool, checkpoint_remove(checkpoint->file, &error));
    }
}
