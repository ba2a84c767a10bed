/* Whichever allocation fails while cells are made of labels, or a table of labels is read, the status is
 * STATUS_SYSTEM and nothing stays allocated. See failing_allocator.h. */
#include "approx/labels/label_cells.h"
#include "io/image/label_table.h"

#include <stdio.h>
#include <unistd.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

static char path[] = "/tmp/labels-XXXXXX";

/* Two cubes that touch by an edge, one of two labels, finer at interfaces. */
static enum status try_label_cells(struct error *error)
{
    static uint16_t label[16 * 16 * 16];
    static const bool keep[3] = {false, true, true};
    struct labels labels = {.size = {16, 16, 16}, .label = label, .count = 3, .dim = 3};
    static const double x[12] = {0, 0, 0, 40, 0, 0, 0, 40, 0, 0, 0, 40}, size[4] = {4, 4, 4, 2};
    static const int32_t corner[4] = {0, 1, 2, 3};
    const struct cells sized = {3, 4, x, 1, corner};
    struct label_cells_options options = {
        .spacing = 4, .finest = 2, .sized = &sized, .size = size, .keep = keep, .largest = true};
    FREED_BY(label_cells_free) struct label_cells mesh = {0};
    int64_t lost[3];
    for (int v = 0; v < 16 * 16 * 16; v++) {
        int i = v % 16, j = v / 16 % 16, k = v / 256;
        bool low = i > 1 && i < 8 && j > 1 && j<8, high = i> 7 && i < 14 && j > 7 && j < 14;
        label[v] = (uint16_t)(k > 1 && k < 14 && (low || high) ? 1 + (k > 7) : 0);
    }
    for (int d = 0; d < 3; d++) {
        labels.to_voxel[d][d] = 1;
    }
    enum status status = label_cells_make(&labels, &options, &mesh, error);
    if (status == STATUS_OK) {
        status = label_cells_lost(&labels, keep, &mesh, lost, error);
    }
    return status;
}

static enum status try_label_table(struct error *error)
{
    FREED_BY(label_table_free) struct label_table table = {0};
    return label_table_read(path, &table, error);
}

TEST(cells)
{
    omp_set_num_threads(1);
    fail_each(try_label_cells, 40);
}

TEST(tables)
{
    int descriptor = mkstemp(path);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    assert_non_null(file);
    fputs("1 a\n2-4,7 b -\n5 -\n* rest\n", file);
    assert_int_equal(fclose(file), 0);
    fail_each(try_label_table, 6);
    assert_int_equal(unlink(path), 0);
}

#endif

RUN_TESTS(NULL, NULL)
