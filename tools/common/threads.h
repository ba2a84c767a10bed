/* How the threads of OpenMP wait for each other. */
#ifndef TOOLS_THREADS_H
#define TOOLS_THREADS_H

/* Call first in the main of a tool that uses threads in short turns.
 *
 * GNU's OpenMP lets a waiting thread spin for milliseconds, which is quick on idle cores and ruins everything
 * on busy ones: twenty times slower than one thread was seen. Here they spin for some ten microseconds, then
 * sleep, unless the user has set OMP_WAIT_POLICY or GOMP_SPINCOUNT. The library reads them when it is loaded,
 * before main: so the program sets the variable and starts itself anew, once. */
void threads_settle_waiting(char *argv[]);

#endif
