/* Frames, states on the way, are written as they come, so that memory does not grow with their number, and
 * what there is stays when the run ends early: to the output, behind what does not change and before the
 * final state; with -c also to FILE.frames, from which a run that goes on takes those before its checkpoint.
 */
#include "mtled/run.h"

#include "io/stream/sections.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* The number of frames that the scene asks for, without that of the start. */
static double count_frames(const struct scene *scene)
{
    const struct scene_output *output = &scene->output;
    return output->interval > 0.0 ? floor(scene->solver.end_time / output->interval + 1e-9)
                                  : (double)output->frames;
}

void run_frames_check(const struct run *run)
{
    const struct scene_output *output = &run->scene->output;
    bool quasi_static = run->scene->analysis == SCENE_QUASI_STATIC;
    int64_t fields = output->stress + output->strain + output->pressure + output->volume_ratio +
                     output->fibre + output->gaps,
            tables = output->reactions + output->moments + output->energy;
    int64_t of_frame = 2 + (quasi_static ? fields : 0); /* u and its parameters */
    /* Besides: u, the supports of parameters, iteration. */
    int64_t others = 2 + 4 + 1 + fields + 2 * tables + run->stream->section_count;
    double frames = count_frames(run->scene);
    int64_t most = (STREAM_SECTION_LIMIT - others) / of_frame - 1;
    if (frames > (double)most) {
        tool_fail(run->tool, STATUS_INPUT,
                  "%s: [output]: %.12g frames of %jd sections each, where a stream has at most %d sections: "
                  "ask for "
                  "at most %jd frames (frames, interval)",
                  run->scene->path, frames, of_frame, STREAM_SECTION_LIMIT, most);
    }
}

/* Write the sections from the first one on that is not yet written; with `whole` those of frames, too. */
static enum status put_sections(struct run *run, bool whole, struct error *error)
{
    struct run_frames *frames = &run->frames;
    const struct stream *stream = run->stream;
    for (; frames->written < stream->section_count; frames->written++) {
        const char *name = stream->sections[frames->written].name;
        if (!whole && run_is_of_frames(name)) {
            break;
        }
        enum section_stage stage = section_stage(name);
        /* Tables of points and shape functions are not passed on. */
        if (stage < MADE_WITH_POINTS || stage > MADE_WITH_SHAPES) {
            RETURN_IF_ERROR(stream_writer_put(&frames->writer, stream, frames->written, error));
        }
    }
    return stream_writer_flush(&frames->writer, error);
}

static enum status fail_kept(const struct run *run, struct error *error)
{
    return fail(error, STATUS_INPUT, "%s: not the frames that %s goes on from: remove both to begin anew",
                run->frames.kept_file, run->checkpoint.file);
}

/* Open FILE.frames, cut to what it had at the checkpoint. */
static enum status open_kept(struct run *run, struct error *error)
{
    struct run_frames *frames = &run->frames;
    int64_t bytes = frames->kept_bytes;
    struct stat present;
    struct stream empty = {0};
    if (bytes > 0 && (stat(frames->kept_file, &present) != 0 || present.st_size < bytes)) {
        return fail_kept(run, error);
    }
    int descriptor = open(frames->kept_file, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0 || ftruncate(descriptor, bytes) != 0) {
        return fail_system(error, frames->kept_file);
    }
    FILE *file = fdopen(descriptor, "r+");
    if (file == NULL) {
        return fail_system(error, frames->kept_file);
    }
    stream_writer_begin(&frames->kept, file, false, bytes == 0 ? &empty : NULL);
    frames->kept.offset += bytes;
    frames->kept.section_count = frames->kept_sections;
    return STATUS_OK;
}

/* Copy the frames before the checkpoint to the output. */
static enum status copy_kept(struct run *run, struct error *error)
{
    FREED_BY(stream_free) struct stream stream = {0};
    struct run_frames *frames = &run->frames;
    struct error end;
    if (frames->kept_sections == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_recover(&stream, fileno(frames->kept.file), frames->kept_file, &end, error));
    if (stream.section_count != frames->kept_sections) {
        return fail_kept(run, error);
    }
    for (int64_t i = 0; i < stream.section_count; i++) {
        RETURN_IF_ERROR(stream_writer_put(&frames->writer, &stream, i, error));
    }
    return lseek(fileno(frames->kept.file), 0, SEEK_END) < 0 ? fail_system(error, frames->kept_file)
                                                             : STATUS_OK;
}

static enum status begin(struct run *run, struct error *error)
{
    struct run_frames *frames = &run->frames;
    if (frames->kept_file != NULL) {
        RETURN_IF_ERROR(open_kept(run, error));
    }
    RETURN_IF_ERROR(output_open_stream(&frames->output, run->tool, true, error));
    stream_writer_begin(&frames->writer, frames->output.file, run->tool->text, run->stream);
    RETURN_IF_ERROR(fail_in(error, put_sections(run, false, error), "%s", frames->output.name));
    return copy_kept(run, error);
}

/* Exit if the first process, which writes, has failed. */
static void check(const struct run *run, enum status status, struct error *error)
{
    tool_check(run->tool, ranks_agree(process_ranks(), status, error), error);
}

void run_frames_begin(struct run *run)
{
    struct run_frames *frames = &run->frames;
    struct error error = {""};
    if (!(count_frames(run->scene) > 0.0)) {
        return;
    }
    frames->are_given = true;
    if (run->checkpoint.file != NULL) {
        frames->kept_file = tool_text(run->tool, "%s.frames", run->checkpoint.file);
    }
    tool_provenance(run->tool, run->stream);
    check(run, process_speaks() ? begin(run, &error) : STATUS_OK, &error);
}

/* Append the sections of a frame to a stream. */
static enum status put_frame(const struct run *run, int64_t number, const char *name,
                             struct stream_writer *writer, struct error *error)
{
    enum status status = STATUS_OK;
    for (int64_t i = run->frames.written; i < run->stream->section_count && status == STATUS_OK; i++) {
        size_t length;
        if (frame_of(run->stream->sections[i].name, &length) == number) {
            status = stream_writer_put(writer, run->stream, i, error);
        }
    }
    if (status == STATUS_OK) {
        status = stream_writer_flush(writer, error);
    }
    return fail_in(error, status, "%s", name);
}

static enum status append(struct run *run, int64_t number, struct error *error)
{
    struct run_frames *frames = &run->frames;
    if (frames->kept_file != NULL) {
        RETURN_IF_ERROR(put_frame(run, number, frames->kept_file, &frames->kept, error));
        frames->kept_bytes = frames->kept.offset;
        frames->kept_sections = frames->kept.section_count;
    }
    return put_frame(run, number, frames->output.name, &frames->writer, error);
}

void run_frames_write(struct run *run, int64_t number)
{
    struct run_frames *frames = &run->frames;
    struct error error = {""};
    size_t length;
    if (number == frames->next) {
        check(run, process_speaks() ? append(run, number, &error) : STATUS_OK, &error);
        frames->next++;
    }
    for (int64_t i = run->stream->section_count - 1; i >= frames->written; i--) {
        if (frame_of(run->stream->sections[i].name, &length) >= 0) {
            stream_remove(run->stream, run->stream->sections[i].name);
        }
    }
}

enum status run_frames_sync(const struct run *run, struct error *error)
{
    const struct run_frames *frames = &run->frames;
    bool failed = frames->kept_file != NULL && fsync(fileno(frames->kept.file)) != 0;
    return failed ? fail_system(error, frames->kept_file) : STATUS_OK;
}

void run_frames_end(struct run *run)
{
    struct run_frames *frames = &run->frames;
    struct error error = {""};
    enum status status = STATUS_OK;
    if (!frames->are_given) {
        sections_remove(run->stream, MADE_WITH_POINTS, MADE_WITH_SHAPES);
        tool_write(run->tool, run->stream);
        return;
    }
    if (process_speaks()) {
        status = put_sections(run, true, &error);
        status = status == STATUS_OK ? stream_writer_end(&frames->writer, NULL, &error) : status;
        status = output_end(&frames->output, status, &error);
    }
    check(run, status, &error);
}

void run_frames_stop(struct run *run, const char *reason)
{
    struct run_frames *frames = &run->frames;
    struct error ignored;
    if (!frames->are_given || !process_speaks()) {
        return;
    }
    signal(SIGPIPE, SIG_IGN); /* exit with our own status */
    if (run->last_good >= 0.0) {
        run_put_field(run, &(struct instant){frames->next, run->last_good}, run->u);
    }
    if (put_sections(run, true, &ignored) == STATUS_OK &&
        stream_writer_end(&frames->writer, reason, &ignored) == STATUS_OK) {
        (void)fsync(fileno(frames->output.file));
    }
}

void run_frames_free(struct run *run)
{
    struct run_frames *frames = &run->frames;
    if (frames->kept.file != NULL) {
        (void)fclose(frames->kept.file);
    }
    free(frames->kept_file);
}
