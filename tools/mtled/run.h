/* Running a model: the work of mtled between reading and writing. */
#pragma once

#include "comparison.h"
#include "output.h"
#include "mtled/model.h"
#include "process.h"
#include "approx/support/support.h"
#include "base/state.h"
#include "io/checkpoint/checkpoint.h"
#include "solid/folds/folds.h"
#include "solid/system/progress.h"

#include <omp.h>
#include <signal.h>

/* Progress on a terminal: one line, updated a few times a second. */
struct display {
    bool shown;
    double started, last; /* s */
};

/* Checkpoints: written at intervals and on interruption, and restored by the same command. */
struct run_checkpoint {
    const char *file; /* NULL: none */
    double interval;  /* s */
    double last;      /* time when the last one was written, or the run began, s */
    bool is_there;    /* this process has written one */
    struct checkpoint_identity identity;
    struct stream restored; /* the checkpoint that was read; owns the frames */
    struct state state;     /* the state in it */
    bool is_restored;
    const volatile sig_atomic_t *interrupted; /* number of the signal, or 0 */
    enum status status;                       /* of writing when interrupted */
    struct error error;
};

/* The frames, which are written as they come. */
struct run_frames {
    bool are_given;
    int64_t next;                /* the number of the first one that is not yet written */
    int64_t written;             /* how many sections of run->stream are */
    struct output output;        /* to which they are, */
    struct stream_writer writer; /* by this writer */
    char *kept_file;             /* FILE.frames of -c FILE, which has them as well; or NULL */
    struct stream_writer kept;
    int64_t kept_bytes, kept_sections;
};

struct run_folds {
    struct folds folds;
    double *field;       /* scratch: node_count * dim */
    int64_t *node_first; /* the nodes at which each process evaluates it */
    bool has_space;
    struct visibility space; /* for the field within cells, made when it is needed */
    bool reported;           /* in the message that ends the run */
    /* The fold that was found last, or one that stays. */
    bool seen;
    bool stays;   /* it is in a state that is given, or the run is dynamic */
    double since; /* time as in struct progress */
    struct fold fold;
    int64_t kept[4]; /* its whole numbers, as they are kept in a checkpoint: never negative */
};

/* The first equilibrium of a quasi-static run that is not stable: it would buckle, wrinkle or crease. */
struct run_stability {
    bool seen;
    double since; /* load */
    int64_t node; /* where its mode moves most */
};

struct run {
    const struct tool *tool;
    const struct scene *scene;
    struct model *model;
    struct stream *stream; /* receives what the scene's [output] requests */
    struct display display;
    struct run_checkpoint checkpoint;
    struct run_frames frames;
    struct run_folds folds;
    struct run_stability stability;
    bool verbose;
    const char *start_file; /* result from whose field the run starts; NULL: none */
    struct side start;      /* that result */
    double *u;              /* parameters, node_count * dim, m */
    double last_good;       /* the time of the state u, as in struct progress; negative: none */
    char at[64];            /* how far the run came, with a colon, for verdicts; or "" */
    int64_t evaluations;    /* of forces */
    double read_seconds, prepare_seconds, solve_seconds, write_seconds;
};

/* A progress_function, whose context is the struct run: shows progress and writes checkpoints. */
bool run_progress(void *context, const struct progress *progress);
void run_clear_progress(const struct display *display);

/* End the run without result: print a message and exit with `status`, see tool_fail. If the scene requests
 * frames, the last good state follows those so far, and the stream says that it is incomplete. The messages
 * of verdicts, and notes, begin with the name of the scene. */
_Noreturn void run_fail(struct run *run, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void run_note(const struct run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* For --start: read the result from which the run starts, exits if it is not suitable; start a model at rest
 * from it. */
void run_start_read(struct run *run);
void run_start(struct run *run);

/* Exits with a verdict where a body has a free rigid-body mode and no contact acts on it; with -v, reports
 * the modes that only contacts prevent. */
void run_check_rigid_modes(struct run *run);

/* Quasi-static: solve for the full load. Dynamic: step to the end time; add the section energy on request.
 * Exits with a verdict if this fails. */
void run_solve(struct run *run);

/* Notes displacements, and motions of rigid surfaces, far larger than the body; exits for impossible ones. */
void run_contacts_begin(const struct run *run);

/* For run->u, with the largest displacement `motion`, m: exits with a verdict, in a quasi-static scene, if
 * the remaining penetration of contacts takes too large a share of the forces. To first order that is half of
 * the work of the contact forces along it, by the stored energy: this is proportional to the square of the
 * motion, forces to the motion itself. In the final state notes a penetration larger than `allowed`, m. */
void run_contacts_penetrate(struct run *run, double motion, double allowed, bool final);

/* For the final state, whose displacement has this error, m; negative, of a dynamic scene: not known. Notes
 * rigid surfaces that the body has never touched; bodies that only contacts held, and that none presses any
 * more; and a curved side whose displacement is prescribed along its normal, and that slides so far that it
 * leaves its surface. */
void run_held_judge(const struct run *run, double error_left);

/* A frame_function; the context is the struct run: writes the sections u.frame.NUMBER and
 * parameters.frame.NUMBER; of a state of equilibrium, run->u, at which the system was evaluated last, all
 * output of the scene: sections X.frame.NUMBER, and a row of reactions.frames and energy.frames. */
void run_put_frame(void *context, int64_t number, double time, const double *u);

/* ---- frames: written as they come ---- */

/* Exits where a stream cannot hold as many frames as the scene asks for; before the run. */
void run_frames_check(const struct run *run);

/* Before the first step, if the scene asks for frames: begin the output, with those of a checkpoint. */
void run_frames_begin(struct run *run);

/* Write the sections of frame `number`, unless they have been written before, and remove them from
 * run->stream. Collective. */
void run_frames_write(struct run *run, int64_t number);

/* Write the final state, as run->stream has it, and end the output. */
void run_frames_end(struct run *run);

/* End the output as incomplete, with the last good state. Failures are ignored, as the program already ends
 * with an error. */
void run_frames_stop(struct run *run, const char *reason);
void run_frames_free(struct run *run);

/* Make what has been written reach the disk. */
MUST_CHECK enum status run_frames_sync(const struct run *run, struct error *error);

/* Whether a section of this name belongs to the frames. */
bool run_is_of_frames(const char *name);

/* Allocate zeros; exits if there is no memory. */
double *run_new_values(const struct run *run, int64_t count);

/* End of a verbose report: the time of each part of the computation, s, and its share. */
void run_report_cost(const struct run *run);

/* Add section `name`: rows x cols values, which the stream takes. Exits on failure. */
void run_put(const struct run *run, const char *name, int64_t rows, int64_t cols, const char *attributes,
             double *values);

/* The state of the sections to write: the final one (FRAME_NONE), or a frame. */
struct instant {
    int64_t frame;
    double time;
};

/* Add the field of parameters u at the nodes, and these. */
void run_put_field(const struct run *run, const struct instant *instant, const double *u);

/* Put section `name`, a table of rows x cols values, which are taken; of a frame its time and these values as
 * the next row of section name.frames, with the attributes of that one. */
void run_put_table(const struct run *run, const struct instant *instant, const char *name, int64_t rows,
                   int64_t cols, const char *attributes, double *values);

/* Add the sections reactions and moments, if requested, of the system's last evaluation, at u: a row for each
 * condition; for a frame, a row of reactions.frames and moments.frames. */
void run_put_forces(struct run *run, const struct instant *instant);

/* Add parameters.radius, by which other tools evaluate the field from its parameters (stages.h). */
void run_put_supports(const struct run *run);

/* Add u at the nodes and the optional outputs of the final state: stress, strain, reactions, gaps, and
 * in a quasi-static run its energy. */
void run_put_results(struct run *run);

/* ---- checkpoints ---- */

/* Before the first step: catch signals, and read the checkpoint file, if there is one: what folds, stability
 * and frames keep is restored, its tables of frames are put into run->stream. Exits if the file is of another
 * run. */
void run_checkpoint_begin(struct run *run);

/* After a step: write a checkpoint if it is due. False if a signal ends the run. */
bool run_checkpoint_step(struct run *run, const struct progress *progress);

/* After the last step: restore the default actions of signals. */
void run_checkpoint_end(void);

/* Report that the run was interrupted after `steps` steps, and exit with 128 + the number of the signal. */
_Noreturn void run_checkpoint_stop(struct run *run, int64_t steps);

/* Remove the checkpoints: the results are complete. */
void run_checkpoint_remove(struct run *run);

/* ---- folds (see solid/folds/folds.h): searched for while the run lasts, reported at its end ---- */

/* Before the first step; the model must be built. */
void run_folds_begin(struct run *run);
void run_folds_free(struct run *run);

/* Search the state of parameters u at a time of the run; `is_frame`: the state is given as a frame. */
void run_folds_check(struct run *run, const double *u, double time, bool is_frame);

/* What was seen, as state of the run. */
MUST_CHECK enum status run_folds_state(struct run *run, const struct state *state, struct error *error);

/* Where and from when on, with the remedy, into text[size]; empty when no fold was seen. */
void run_folds_describe(const struct run *run, char *text, size_t size);

/* After the last step: a body that folds, or an equilibrium that was not stable, ends the run with a verdict,
 * unless the scene allows it. Else notes where the body has left a state near equilibrium on the way. */
void run_folds_judge(struct run *run);

/* ---- stability ---- */

/* Check an equilibrium at this share of the load, which was evaluated last: exits with a verdict where the
 * material law is not strongly elliptic in a large part of the body. In the final state notes a small one. */
void run_stability_check(struct run *run, double load, bool final);
