#include "threads.h"

#include <stdlib.h>
#include <unistd.h>

void threads_settle_waiting(char *argv[])
{
    if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) {
        return;
    }
    if (setenv("GOMP_SPINCOUNT", "500", 1) == 0) {
        execv("/proc/self/exe", argv);
    }
    /* Without /proc things work, only slower where the cores are busy. */
}
