/* Checkpoints of a run: written at intervals and when it is interrupted, and restored by the same command.
 */
#pragma once

#include "io/checkpoint/checkpoint.h"

#include <signal.h>

struct run;
struct progress;

struct run_checkpoint {
    const char *file; /* NULL: none */
    double interval;  /* s */
    double last;      /* clock when the last one was written, or the run began */
    bool is_ours;     /* FILE is whole and of this run: it is kept as FILE.old */
    struct checkpoint_identity identity;
    struct stream restored; /* what was taken up; frames lie in it */
    struct state state;     /* of it */
    bool is_restored;
    const volatile sig_atomic_t *interrupted; /* number of the signal, or 0 */
    enum status status;                       /* of writing when interrupted */
    struct error error;
};

/* Before the first step: catch signals and, with a checkpoint file, take up what is there: the frames go into
 * run->stream. The model must be built. Exits when the file is of something else. */
void run_checkpoint_begin(struct run *run);

/* The state to go on from, or NULL. */
const struct state *run_checkpoint_state(const struct run *run);

/* After a step: write a checkpoint if one is due. False when a signal ends the run. */
bool run_checkpoint_tell(struct run *run, const struct progress *progress);

/* After the last step: signals act at once again. */
void run_checkpoint_end(struct run *run);

/* The run was interrupted after so many steps: say so, and exit 128 + n. */
_Noreturn void run_checkpoint_stop(struct run *run, int64_t steps);

/* The results are whole: the checkpoints have served. */
void run_checkpoint_remove(struct run *run);
