/* The processes of a run: one, or those that mpirun has started. All do the same (base/ranks.h); the first
 * one alone writes and says what is to be said. tools/common/process.c is of one process, and costs nothing;
 * tools/mpi/process.c stands in its place in mtled-mpi, which mtled calls where mpirun has started several.
 */
#pragma once

#include "base/ranks.h"

#include <stdbool.h>
#include <stdint.h>

/* To be called first in main. Takes from the command line what is MPI's. */
void process_begin(int *argc, char ***argv);

/* How the processes talk; NULL: there is one. */
const struct ranks *process_ranks(void);

/* Is this the one that writes? */
bool process_speaks(void);

/* This process fails. True, after some seconds, when not all of the others do: then they wait for it in vain,
 * and it has to say why. */
bool process_fails_alone(void);

/* To be called last, and before exit(): the end of this process is in order. */
void process_end(void);

/* A report on standard error of what was sent, by so many evaluations; by all together. */
void process_report(int64_t evaluations);
