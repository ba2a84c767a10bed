/* Running a model: the work of mtled between reading and writing. */
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

/* Progress on a terminal: one line, updated a few times a second. */
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
    bool again;             /* the run ended so that run_again can repeat it */
    bool touches_itself;    /* run_again has added a contact of the body with itself; state of the run */
    const char *start_file; /* result from whose field the run starts; NULL: none */
    struct side start;      /* that result */
    double *u;              /* parameters, node_count * dim, m */
    double last_good;       /* the time of the state u, as in struct progress; negative: none */
    int64_t evaluations;    /* of forces */
    double read_seconds, prepare_seconds, solve_seconds, write_seconds;
};

/* A progress_function, whose context is the struct run: shows progress and writes checkpoints. */
bool run_tell(void *context, const struct progress *progress);
void run_clear_progress(const struct display *display);

/* End the run without result: print a message and exit with `status`, see tool_fail. If the scene requests
 * frames, those so far and the last good state are written as an incomplete stream. */
_Noreturn void run_fail(struct run *run, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* For --start: read the result from which the run starts, exits if it is not suitable; start a model at rest
 * from it. The identity is a checksum, 0 without start. */
void run_start_read(struct run *run);
void run_start(struct run *run);
uint32_t run_start_identity(const struct run *run);
void run_start_free(struct run *run);

/* If parts of a body have passed through each other (run->again), and the scene has no contact between them:
 * add to the scene a contact of the whole boundary with itself, `facets = *, against = *`, remove the
 * results, and return true: the scene is computed again. */
bool run_again(struct run *run);

/* Add that contact to the scene. */
void run_touch_itself(struct run *run);

/* Exits with a verdict where a body has a free rigid-body mode and no contact acts on it; with -v, reports
 * the modes that only contacts prevent. */
void run_check_rigid_modes(struct run *run);

/* Quasi-static: relax to the full load. Exits with a verdict if it does not converge. */
void run_quasi_static(struct run *run);

/* Exits where a rigid surface is too far from the body to come into contact; notes displacements far larger
 * than the body. */
void run_contacts_begin(const struct run *run);

/* For the final state: notes a penetration `miss` of contacts that is larger than `allowed`, m. In a
 * quasi-static scene exits with a verdict if it is larger than a tenth of the motion. */
void run_contacts_give_way(struct run *run, double miss, double allowed, double motion);

/* For the final state of a quasi-static scene, which was evaluated last: notes the share of the forces that
 * is missing because of the remaining penetration. */
void run_contacts_missing(struct run *run);

/* For the final state: exits with a verdict where a rigid surface has penetrated the body by more than
 * `slack`, m, and `share` of a facet's width, and no contact node is active. Notes contacts whose active set
 * is less than three nodes across, and contacts that were never active. */
void run_contacts_judge(struct run *run, double slack, double share);

/* Notes displacements all of whose components are prescribed on patches of less than three facets across (2D:
 * two), if the scene requests forces: these are too large. */
void run_displacements_judge(const struct run *run);

/* Dynamic: step to the end time. Exits with a verdict if this fails; adds the section energy on request. */
void run_dynamic(struct run *run);

/* A frame_function; the context is the struct run: adds the sections u.frame.NUMBER and
 * parameters.frame.NUMBER. */
void run_put_frame(void *context, int64_t number, double time, const double *u);

/* The same for a state of equilibrium, run->u, at which the system was evaluated last, with all output of the
 * scene: sections X.frame.NUMBER, and a row of reactions.frames and energy.frames. */
void run_put_equilibrium(void *context, int64_t number, double time, const double *u);

/* Whether a section of this name belongs to the frames. */
bool run_is_of_frames(const char *name);

/* Remove all sections of frames. */
void run_drop_frames(struct stream *stream);

/* Allocate zeros; exits if there is no memory. */
double *run_new_values(const struct run *run, int64_t count);

/* Part of a verbose report: the distance of the field from the measured displacements of springs. */
void run_report_springs(const struct run *run);

/* End of a verbose report: the time of each part of the computation, s, and its share. */
void run_report_cost(const struct run *run);

/* Add section `name`: rows x cols values, which the stream takes. Exits on failure. */
void run_put(const struct run *run, const char *name, int64_t rows, int64_t cols, const char *attributes,
             double *values);

/* The state of the sections to write: the final one (FRAME_NONE), or a frame. */
struct moment {
    int64_t frame;
    double time;
};

/* Append a row, the time and values[count], to the table over frames in section `name`. */
void run_append_row(const struct run *run, const char *name, double time, const double *values, int64_t count,
                    const char *attributes);

/* Add the sections reactions and moments, if requested, of the system's last evaluation, at u: a row for each
 * condition; for a frame, a row of reactions.frames and moments.frames. */
void run_put_forces(struct run *run, const struct moment *moment);

/* Add parameters.radius, by which other tools evaluate the field from its parameters (solved.h). */
void run_put_supports(const struct run *run);

/* Add u at the nodes and the optional outputs of the final state: stress, strain, reactions, gaps, and
 * in a quasi-static run its energy. */
void run_put_results(struct run *run);
