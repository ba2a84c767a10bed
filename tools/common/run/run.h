/* Running a model: what mtled does between reading and writing. */
#pragma once

#include "comparison.h"
#include "model/model.h"
#include "parts/parts_input.h"
#include "process.h"
#include "run/run_checkpoint.h"
#include "run/run_folds.h"
#include "run/run_stability.h"
#include "base/clock.h"
#include "solid/system/progress.h"

/* Progress on a terminal: one line, a few times a second. */
struct display {
    bool shown;
    double started, last; /* s */
};

struct run {
    const struct tool *tool;
    struct scene *scene; /* see run_again */
    struct model *model;
    const struct parts_input *parts;
    struct stream *stream; /* receives what the scene's [output] asks for */
    struct display display;
    struct run_checkpoint checkpoint;
    struct run_folds folds;
    struct run_stability stability;
    bool verbose;
    bool text;              /* the form of what is written */
    bool again;             /* the run has ended for run_again */
    bool touches_itself;    /* the scene has got a contact of the body with itself: state of the run */
    const char *start_file; /* NULL: none; or the run begins from the field of another one, */
    struct side start;      /* this */
    double *u;              /* parameters, node_count * dim, m */
    double last_good;       /* the time, as in struct progress, of which u is the state; negative: none */
    int64_t evaluations;    /* of forces */
    double read_seconds, prepare_seconds, solve_seconds, write_seconds;
};

/* A progress_function; the context is the struct run: show how far it is, write checkpoints. */
bool run_tell(void *context, const struct progress *progress);
void run_clear_progress(const struct display *display);

/* The run ends without a result: say why and exit. Where the scene asks for frames, those so far and the last
 * good state are written, as a stream that is not whole. `status` as in tool_fail. */
_Noreturn void run_fail(struct run *run, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Of --start: read the stream that the run begins from, exits where that cannot be; and let it begin there,
 * the model being at rest. The identity is a checksum, 0 where there is none. */
void run_start_read(struct run *run);
void run_start(struct run *run);
uint32_t run_start_identity(const struct run *run);
void run_start_free(struct run *run);

/* Where the parts of a body have passed through each other (run->again), and the scene has no contact between
 * them, add to the scene a contact of the whole boundary with itself, as `facets = *, against = *`, remove
 * the results, and return true: the scene is to be computed again. */
bool run_again(struct run *run);

/* Add that contact to the scene. */
void run_touch_itself(struct run *run);

/* The sections that only the computation needs leave the stream; the rest passes through. */
void run_drop_tables(struct stream *stream);

/* Exits with a verdict where a body has a free rigid-body mode and no contact acts on it; with -v, reports
 * the modes that only contacts prevent. */
void run_check_rigid_modes(struct run *run);

/* Quasi-static: relax to the full load. Exits with a verdict when it does not converge. */
void run_quasi_static(struct run *run);

/* Exits where a rigid surface is too far from the body to come into contact; notes displacements far larger
 * than the body. */
void run_contacts_begin(const struct run *run);

/* For the final state: notes a penetration of contacts of `miss`, if it is more than `allowed`, m; in a
 * quasi-static scene exits with a verdict where it is more than a tenth of the motion. */
void run_contacts_give_way(struct run *run, double miss, double allowed, double motion);

/* For the final state of a quasi-static scene, which was evaluated last: notes the part of the forces that is
 * missing because of the remaining penetration. */
void run_contacts_missing(struct run *run);

/* For the final state: exits with a verdict where a rigid surface has penetrated the body by more than
 * `slack`, m, and `share` of a facet's width, and no contact node is active. Notes contacts whose active set
 * is less than three nodes across, and contacts that were never active. */
void run_contacts_judge(struct run *run, double slack, double share);

/* Notes displacements all of whose components are prescribed on patches of less than three facets across (2D:
 * two), if the scene requests forces: these are too large. */
void run_displacements_judge(const struct run *run);

/* Dynamic: step to the end time. Exits with a verdict when it cannot; adds the section energy on request. */
void run_dynamic(struct run *run);

/* A frame_function; the context is the struct run: adds the sections u.frame.NUMBER and
 * parameters.frame.NUMBER. */
void run_put_frame(void *context, int64_t number, double time, const double *u);

/* The same of a state of equilibrium, run->u, at which the system was evaluated last, with all that the scene
 * asks for: sections X.frame.NUMBER, and a row more in reactions.frames and energy.frames. */
void run_put_equilibrium(void *context, int64_t number, double time, const double *u);

/* Does a section of this name belong to the frames? */
bool run_is_of_frames(const char *name);

/* Remove all sections of frames. */
void run_drop_frames(struct stream *stream);

/* Zeros; exits when there is no memory. */
double *run_new_values(const struct run *run, int64_t count);

/* Of a verbose report: how far the springs of measured points are from what was measured. */
void run_report_springs(const struct run *run);

/* End of a verbose report: what each part of the scene cost, s and share of the whole. */
void run_report_cost(const struct run *run);

/* Add section `name`: rows x cols values, which the stream takes. Exits on failure. */
void run_put(const struct run *run, const char *name, int64_t rows, int64_t cols, const char *attributes,
             double *values);

/* The state that sections are of: the final one (FRAME_NONE), or a frame. */
struct moment {
    int64_t frame;
    double time;
};

/* Add a row, the time and values[count], to section `name`, a table over the frames. */
void run_append_row(const struct run *run, const char *name, double time, const double *values, int64_t count,
                    const char *attributes);

/* Add the sections reactions and moments, if asked for, of the system's last evaluation, at u: a row for each
 * condition; of a frame, a row of reactions.frames and moments.frames. */
void run_put_forces(struct run *run, const struct moment *moment);

/* Add parameters.radius: with it and the parameters of a field others evaluate the field (solved.h). */
void run_put_supports(const struct run *run);

/* Add u at the nodes and the optional outputs of the final state: stress, strain, reactions, gaps, and
 * in a quasi-static run its energy. */
void run_put_results(struct run *run);
