/* The processes of a run under mpirun; see process.h. */
#include "process.h"

#include <omp.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* Time that a failing process waits for the others to fail as well, s. */
static const double most_wait = 10.0;

/* State of the process. */
static struct {
    struct ranks ranks;
    int *count, *place;    /* scratch: of each process */
    MPI_Request *requests; /* 2 for each process */
    MPI_Comm ends;         /* communicator for failures of processes */
    double sent;           /* bytes */
    bool patient;          /* waiting processes sleep; false: they spin */
    bool failing, alone, ended;
    MPI_Request failed;
} own;

static MPI_Datatype type_of(size_t size)
{
    MPI_Datatype type;
    MPI_Type_contiguous((int)size, MPI_BYTE, &type);
    MPI_Type_commit(&type);
    return type;
}

/* Wait until these requests are complete. */
static void wait_for(int count, MPI_Request *requests)
{
    static const int spins = 200, most_nap = 200; /* us */
    int done = 0, nap = 10;
    if (!own.patient) {
        MPI_Waitall(count, requests, MPI_STATUSES_IGNORE);
        return;
    }
    for (int i = 0; !done; i++) {
        MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE);
        if (!done && i > spins) {
            usleep((useconds_t)nap);
            nap = 2 * nap < most_nap ? 2 * nap : most_nap;
        }
    }
}

static void gather(const struct ranks *ranks, void *items, size_t size, const int64_t *first)
{
    MPI_Datatype type = type_of(size);
    for (int r = 0; r < ranks->count; r++) {
        own.count[r] = first != NULL ? (int)(first[r + 1] - first[r]) : 1;
        own.place[r] = first != NULL ? (int)first[r] : r;
    }
    MPI_Iallgatherv(MPI_IN_PLACE, 0, type, items, own.count, own.place, type, MPI_COMM_WORLD, own.requests);
    wait_for(1, own.requests);
    MPI_Type_free(&type);
    own.sent += (double)own.count[ranks->rank] * (double)size * (ranks->count - 1);
}

static void exchange(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                     void *receive, const int64_t *receive_first)
{
    MPI_Datatype type = type_of(size);
    int requests = 0;
    for (int r = 0; r < ranks->count; r++) {
        int count = (int)(receive_first[r + 1] - receive_first[r]);
        char *to = (char *)receive + receive_first[r] * (int64_t)size;
        if (r != ranks->rank && count > 0) {
            MPI_Irecv(to, count, type, r, 0, MPI_COMM_WORLD, &own.requests[requests++]);
        }
    }
    for (int r = 0; r < ranks->count; r++) {
        int count = (int)(send_first[r + 1] - send_first[r]);
        const char *from = (const char *)send + send_first[r] * (int64_t)size;
        if (r == ranks->rank) {
            memmove((char *)receive + receive_first[r] * (int64_t)size, from, (size_t)count * size);
        } else if (count > 0) {
            MPI_Isend(from, count, type, r, 0, MPI_COMM_WORLD, &own.requests[requests++]);
            own.sent += (double)count * (double)size;
        }
    }
    MPI_Type_free(&type); /* takes effect when the requests are complete */
    wait_for(requests, own.requests);
}

static int64_t most(const struct ranks *ranks, int64_t value)
{
    int64_t largest = value;
    (void)ranks;
    MPI_Iallreduce(&value, &largest, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD, own.requests);
    wait_for(1, own.requests);
    return largest;
}

void process_begin(int *argc, char ***argv)
{
    static char name[] = "mtled"; /* the same provenance and messages */
    int provided;
    struct ranks *ranks = &own.ranks;
    *ranks = (struct ranks){.gather = gather, .exchange = exchange, .most = most};
    const char *policy = getenv("OMP_WAIT_POLICY");
    own.patient = policy != NULL && strcasecmp(policy, "passive") == 0;
    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks->count);
    MPI_Comm_rank(MPI_COMM_WORLD, &ranks->rank);
    MPI_Comm_dup(MPI_COMM_WORLD, &own.ends);
    own.count = calloc((size_t)ranks->count, sizeof *own.count);
    own.place = calloc((size_t)ranks->count, sizeof *own.place);
    own.requests = calloc(2 * (size_t)ranks->count, sizeof(MPI_Request));
    if (own.count == NULL || own.place == NULL || own.requests == NULL) {
        fprintf(stderr, "mtled: out of memory\n");
        _exit((int)STATUS_SYSTEM);
    }
    if (*argc > 0) {
        (*argv)[0] = name;
    }
}

const struct ranks *process_ranks(void)
{
    return own.ranks.count > 1 ? &own.ranks : NULL;
}

bool process_fails_alone(void)
{
    int all = 0;
    double started = omp_get_wtime();
    if (own.failing || own.ended) {
        return own.alone;
    }
    own.failing = true;
    MPI_Ibarrier(own.ends, &own.failed);
    MPI_Test(&own.failed, &all, MPI_STATUS_IGNORE);
    while (!all && omp_get_wtime() - started < most_wait) {
        usleep(1000);
        MPI_Test(&own.failed, &all, MPI_STATUS_IGNORE);
    }
    own.alone = !all;
    return own.alone;
}

/* If a process ends without this, mpirun ends the others. */
void process_end(void)
{
    if (!own.ended && !own.alone) {
        own.ended = true;
        MPI_Finalize();
    }
}

void process_report(int64_t evaluations)
{
    double all, most_sent;
    int count = own.ranks.count;
    if (count == 1) {
        return;
    }
    MPI_Allreduce(&own.sent, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(&own.sent, &most_sent, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (process_speaks()) {
        fprintf(stderr, "processes\t%d\n", count);
        fprintf(stderr, "bytes sent by a process in an evaluation\t%.0f\tmost\t%.0f\n",
                all / count / (double)evaluations, most_sent / (double)evaluations);
    }
}
