#include "bench.h"

#include "base/memory.h"
#include "base/processor.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

double bench_now(enum bench_clock clock)
{
    struct timespec now;
    clock_gettime(clock == BENCH_CPU ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void bench_check(enum status status, const struct error *error)
{
    if (status != STATUS_OK) {
        fprintf(stderr, "bench: %s\n", error->text);
        exit((int)status);
    }
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void bench_repeat(enum bench_clock clock, double least,
                  enum status (*run)(void *context, struct error *error), void *context,
                  struct bench_times *times)
{
    struct error error;
    double spent = 0.0;
    times->clock = clock;
    bench_check(run(context, &error), &error);
    for (times->count = 0; times->count < BENCH_MOST_REPEATS && (spent < least || times->count < 5);) {
        double start = bench_now(clock);
        bench_check(run(context, &error), &error);
        double seconds = bench_now(clock) - start;
        times->seconds[times->count++] = seconds;
        spent += seconds;
    }
    qsort(times->seconds, (size_t)times->count, sizeof *times->seconds, compare_doubles);
}

double bench_percentile(const struct bench_times *times, double percent)
{
    double at = percent / 100.0 * (times->count - 1);
    int below = (int)at;
    int above = below + 1 < times->count ? below + 1 : below;
    return times->seconds[below] + (at - below) * (times->seconds[above] - times->seconds[below]);
}

/* Sums in several chains, so that the additions do not hold up the reads. */
static double sum_of(const double *values, int64_t count)
{
    double sum[16] = {0.0};
    for (int64_t i = 0; i + 16 <= count; i += 16) {
        for (int lane = 0; lane < 16; lane++) {
            sum[lane] += values[i + lane];
        }
    }
    for (int lane = 1; lane < 16; lane++) {
        sum[0] += sum[lane];
    }
    return sum[0];
}

double bench_plain_read(enum bench_clock clock, double bytes, int threads)
{
    int64_t count = (int64_t)(bytes / sizeof(double));
    double *values = array_new(count, sizeof *values);
    double best = 1e300;
    volatile double total = 0.0;
    if (values == NULL) {
        fprintf(stderr, "bench: out of memory\n");
        exit(STATUS_SYSTEM);
    }
    /* Small tables are read several times within one measurement, as a kernel's are: from the cache. */
    int64_t rounds = 1 + (int64_t)(1 << 22) / (count + 1);
    memset(values, 1, (size_t)count * sizeof *values);
    for (int repeat = 0; repeat < 15; repeat++) {
        double start = bench_now(clock), sum = 0.0;
#pragma omp parallel num_threads(threads) reduction(+ : sum)
        {
            int64_t part = omp_get_thread_num(), parts = omp_get_num_threads();
            int64_t first = count * part / parts, last = count * (part + 1) / parts;
            for (int64_t round = 0; round < rounds; round++) {
                sum += sum_of(values + first, last - first);
                __asm__ volatile("" ::: "memory");
            }
        }
        total += sum;
        double seconds = (bench_now(clock) - start) / (double)rounds;
        best = seconds < best ? seconds : best;
    }
    free(values);
    return best;
}

/* "Xeon(R) Platinum 8481C": the processor as the system names it. */
static void cpu_model(char *text, size_t size)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(text, size, "unknown");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon != NULL) {
            snprintf(text, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
            break;
        }
    }
    if (file != NULL) {
        fclose(file);
    }
}

void bench_print(const struct bench_row *row, const struct bench_times *times)
{
    char cpu[128];
    double units = row->pairs > 0.0 ? row->pairs : row->bytes, least = times->seconds[0];
    double read = bench_plain_read(times->clock, row->bytes, row->threads);
    cpu_model(cpu, sizeof cpu);
    printf("%s\t%s\t%d\t%.4g\t%.4g\t%.4g\t%.3f\t%.4g\t%.4g\t%.4g\t%.4g\t%s\t", row->kernel, row->size,
           row->threads, 1e9 * least / units, row->bytes / units, 1e9 * read / units, least / read,
           1e9 * bench_percentile(times, 10) / units, 1e9 * bench_percentile(times, 50) / units,
           1e9 * bench_percentile(times, 90) / units, row->rate / least, row->unit);
    if (row->memory_per_node > 0.0) {
        printf("%.0f", row->memory_per_node);
    } else {
        printf("-");
    }
    printf("\t%d\t%s\t%s, %s\t%s\n", times->count, times->clock == BENCH_CPU ? "cpu" : "wall", cpu,
           processor_best_set(), BENCH_FLAGS);
    fflush(stdout);
}
