/* Checkpoints of a run: written at intervals and on interruption, and restored by the same command. */
#pragma once

#include "io/checkpoint/checkpoint.h"

#include <signal.h>

struct run;
struct progress;

struct run_checkpoint {
    const char *file; /* NULL: none */
    double interval;  /* s */
    double last;      /* time when the last one was written, or the run began, s */
    bool is_ours;     /* FILE is complete and of this run, so it is kept as FILE.old */
    struct checkpoint_identity identity;
    struct stream restored; /* the checkpoint that was read; owns the frames */
    struct state state;     /* the state in it */
    bool is_restored;
    const volatile sig_atomic_t *interrupted; /* number of the signal, or 0 */
    enum status status;                       /* of writing when interrupted */
    struct error error;
};

/* Before the first step: catch signals, and read the checkpoint file, if there is one; its frames are put
 * into run->stream. The model must be built. Exits if the file is of another run. */
void run_checkpoint_begin(struct run *run);

/* The state from which the run continues, or NULL. */
const struct state *run_checkpoint_state(const struct run *run);

/* After a step: write a checkpoint if it is due. False if a signal ends the run. */
bool run_checkpoint_tell(struct run *run, const struct progress *progress);

/* After the last step: restore the default actions of signals. */
void run_checkpoint_end(void);

/* Report that the run was interrupted after `steps` steps, and exit with 128 + the number of the signal. */
_Noreturn void run_checkpoint_stop(struct run *run, int64_t steps);

/* Remove the checkpoints: the results are complete. */
void run_checkpoint_remove(struct run *run);
