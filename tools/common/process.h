/* The processes of a run: one, or those started by mpirun. All do the same (base/ranks.h); only the first one
 * writes and prints. tools/common/process.c implements one process; tools/mpi/process.c replaces it in
 * mtled-mpi, which mtled executes if mpirun has started several processes. */
#pragma once

#include "base/ranks.h"

#include <stdbool.h>
#include <stdint.h>

/* To be called first in main. Removes MPI's arguments from the command line. */
void process_begin(int *argc, char ***argv);

/* The communication of the processes; NULL: there is one process. */
const struct ranks *process_ranks(void);

/* Whether this process writes and prints. */
static inline bool process_speaks(void)
{
    return ranks_rank(process_ranks()) == 0;
}

/* To be called if this process fails. Returns true, after some seconds, if not all others fail, too; this
 * process must then print its message. */
bool process_fails_alone(void);

/* To be called before exit(): this process ends regularly. */
void process_end(void);

/* Report on standard error the data sent per evaluation. Collective. */
void process_report(int64_t evaluations);
