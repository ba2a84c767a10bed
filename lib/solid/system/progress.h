/* Callbacks during a run: its progress, and the intermediate states that were requested. */
#pragma once

#include "base/state.h"

struct progress {
    int64_t step;
    double time;      /* s; 0..1 of the load at rest */
    double error;     /* at rest: estimated remaining error relative to the displacement; dynamics: error of
                         the energy balance relative to the largest energy */
    double remaining; /* estimated share of the steps that remain, 0..1; negative: unknown */
    const double *u;  /* parameters */
    /* state(run, ...) visits the run's state at this step. A run of the same system and options that is
     * restored from it gives the same bits. */
    state_function *state;
    void *run;
};

/* Called at regular intervals, and as soon as the run is interrupted; returns false to stop the run. */
typedef bool progress_function(void *context, const struct progress *progress);

/* Receives frame `number` (from 1; 0: the state at the start), the parameters u at `time` (as in struct
 * progress). */
typedef void frame_function(void *context, int64_t number, double time, const double *u);
