/* Signals that ask a long run to end: it finishes its step, puts away what there is, and exits 128 + n. */
#ifndef TOOLS_INTERRUPT_H
#define TOOLS_INTERRUPT_H

#include <signal.h>

/* From now on SIGINT, SIGTERM and SIGHUP, unless ignored, only set the flag returned: their number, 0 before.
 * The second one of a kind ends the process at once. */
const volatile sig_atomic_t *interrupt_catch(void);

/* Let them do what they do by default again. */
void interrupt_release(void);

#endif
