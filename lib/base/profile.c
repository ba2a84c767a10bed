#include "base/profile.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { PANEL = 64 };                 /* columns of L that are computed at a time, and then subtracted */
enum { CACHED = 256 };               /* columns of some rows that are reduced at a time */
enum { ENTRIES_FOR_THREAD = 50000 }; /* see chunks_of */

enum status profile_begin(int64_t count, int64_t numbers, struct profile *profile, struct error *error)
{
    *profile = (struct profile){.count = count, .numbers = numbers};
    RETURN_IF_ERROR(NEW_ARRAY(&profile->first, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&profile->at, count, error));
    for (int64_t row = 0; row < count; row++) {
        profile->first[row] = row;
    }
    return STATUS_OK;
}

enum status profile_lay_out(struct profile *profile, struct error *error)
{
    profile->size = 0;
    for (int64_t row = 0; row < profile->count; row++) {
        profile->at[row] = profile->size;
        profile->size += profile_stride(profile, row) * profile->numbers;
    }
    return NEW_ARRAY(&profile->panel, PANEL * profile->count * profile->numbers, error);
}

void profile_free(struct profile *profile)
{
    FREE_ALL(profile->first, profile->at, profile->panel);
    *profile = (struct profile){0};
}

/* A row of the matrix: its entries from column `first` on. */
struct row {
    int64_t first;
    double *value;
};

static struct row row_of(const struct profile *profile, int64_t i, double *value)
{
    int64_t first = profile->first[i / profile->numbers] * profile->numbers;
    return (struct row){first, profile_entry(profile, i, first, value)};
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* Columns k to before `last` of L. */
struct panel {
    int64_t n, k, last;
    double *column; /* PANEL * n: these, by columns, with the zeros outside of the profile */
};

static double *column_of(const struct panel *panel, int64_t c)
{
    return panel->column + (c - panel->k) * panel->n;
}

/* The entries of row i of L in the panel from those of A, less what columns before it take. Those at the
 * diagonal of earlier rows are known. */
static void reduce_in_panel(const struct panel *panel, int64_t i, struct row row)
{
    int64_t end = i < panel->last ? i : panel->last;
    for (int64_t c = panel->k; c < end; c++) {
        double *column = column_of(panel, c);
        column[i] = 0.0;
        if (c >= row.first) {
            column[i] = row.value[c - row.first] /= column[c];
            dense_add_row(end - c - 1, -column[i], column + c + 1, row.value + c + 1 - row.first);
        }
    }
}

/* Rows i to before `end`, of one row of blocks, less what the panel takes, from column `begin` on: some
 * columns at a time, which stay in the cache for all of the rows. */
static void reduce_behind(const struct profile *profile, const struct panel *panel, int64_t i, int64_t end,
                          int64_t begin, double *value)
{
    int64_t first = row_of(profile, i, value).first, to;
    for (int64_t from = larger(begin, first); from < end; from = to) {
        to = lesser(from + CACHED, end);
        for (int64_t c = larger(panel->k, first); c < lesser(panel->last, end - 1); c++) {
            for (int64_t k = larger(larger(i, from), c + 1); k < end; k++) {
                double *row = row_of(profile, k, value).value;
                dense_add_row(lesser(to, k + 1) - from, -row[c - first], column_of(panel, c) + from,
                              row + from - first);
            }
        }
    }
}

/* The panel's own rows. */
static bool factorise_panel(const struct profile *profile, const struct panel *panel, double *value)
{
    for (int64_t i = panel->k; i < panel->last; i++) {
        struct row row = row_of(profile, i, value);
        reduce_in_panel(panel, i, row);
        double *pivot = row.value + i - row.first;
        reduce_behind(profile, panel, i, i + 1, i, value);
        if (!(*pivot > 0.0 && isfinite(*pivot))) {
            return false;
        }
        column_of(panel, i)[i] = *pivot = sqrt(*pivot);
    }
    return true;
}

/* The rows behind the panel. */
static void reduce(const struct profile *profile, const struct panel *panel, double *value)
{
    int64_t rows = 0, numbers = profile->numbers;
    for (int64_t i = panel->last; i < panel->n; i++) {
        rows += row_of(profile, i, value).first < panel->last;
    }
#pragma omp parallel num_threads(chunks_of(rows *rows, ENTRIES_FOR_THREAD).threads)
    {
#pragma omp for schedule(static)
        for (int64_t i = panel->last; i < panel->n; i++) {
            reduce_in_panel(panel, i, row_of(profile, i, value));
        }
#pragma omp for schedule(static, 1)
        for (int64_t row = panel->last / numbers; row < profile->count; row++) {
            reduce_behind(profile, panel, larger(panel->last, row * numbers), (row + 1) * numbers,
                          panel->last, value);
        }
    }
}

bool profile_factorise(const struct profile *profile, double *value)
{
    struct panel panel = {.n = profile->count * profile->numbers, .column = profile->panel};
    while (panel.last < panel.n) {
        panel.k = panel.last;
        panel.last = lesser(panel.n, panel.k + PANEL);
        if (!factorise_panel(profile, &panel, value)) {
            return false;
        }
        reduce(profile, &panel, value);
    }
    return true;
}

void profile_solve(const struct profile *profile, const double *factor, double *x)
{
    int64_t n = profile->count * profile->numbers;
    for (int64_t i = 0; i < n; i++) {
        struct row row = row_of(profile, i, (double *)factor);
        int64_t length = i - row.first;
        x[i] = (x[i] - dense_dot(length, row.value, x + row.first)) / row.value[length];
    }
    for (int64_t i = n - 1; i >= 0; i--) {
        struct row row = row_of(profile, i, (double *)factor);
        x[i] /= row.value[i - row.first];
        dense_add_row(i - row.first, -x[i], row.value, x + row.first);
    }
}
