#include "process.h"

#include <stddef.h>

void process_begin(int *argc, char ***argv)
{
    (void)argc, (void)argv;
}

const struct ranks *process_ranks(void)
{
    return NULL;
}

bool process_fails_alone(void)
{
    return false;
}

void process_end(void)
{
}

void process_report(int64_t evaluations)
{
    (void)evaluations;
}
