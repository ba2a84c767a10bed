#include "approx/partition/partition.h"

#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

enum status cell_stars_build(const struct cells *cells, struct cell_stars *stars, struct error *error)
{
    *stars = (struct cell_stars){0};
    return lists_by_row(cells->count, cells->dim + 1, cells->node, cells->node_count, &stars->ptr,
                        &stars->cell, error);
}

void cell_stars_free(struct cell_stars *stars)
{
    FREE_ALL(stars->ptr, stars->cell);
    *stars = (struct cell_stars){0};
}

int32_t partition_cell_owner(const struct cells *cells, int64_t cell, const int32_t *owner)
{
    const int32_t *node = cells->node + cell * (cells->dim + 1);
    int32_t best = -1;
    int most = 0;
    for (int k = 0; k <= cells->dim; k++) {
        int count = 0;
        for (int l = 0; l <= cells->dim; l++) {
            count += owner[node[l]] == owner[node[k]];
        }
        if (count > most) {
            most = count;
            best = owner[node[k]];
        }
    }
    return best;
}

enum status partition_own_cells(const struct partition *partition, int64_t **own_ptr, int32_t **own_cell,
                                struct error *error)
{
    const struct cells *cells = partition->cells;
    *own_ptr = NULL;
    *own_cell = NULL;
    NEW_SCRATCH(int32_t, part, cells->count, error);
    for (int64_t c = 0; c < cells->count; c++) {
        part[c] = partition_cell_owner(cells, c, partition->owner);
    }
    return lists_by_row(cells->count, 1, part, partition->parts, own_ptr, own_cell, error);
}

static struct box box_of_cell(const struct cells *cells, int64_t cell)
{
    return box_of_nodes(cells->dim, cells->x, cells->node + cell * (cells->dim + 1), cells->dim + 1);
}

enum status partition_work(const struct cells *cells, const struct point_grid *grid, int32_t *work,
                           struct error *error)
{
    struct first_failure failure = {STATUS_OK};
#pragma omp parallel
    {
        struct index_list near = {0};
        struct error own;
        enum status mine = STATUS_OK;
#pragma omp for schedule(static)
        for (int64_t c = 0; c < cells->count; c++) {
            struct box box = box_of_cell(cells, c);
            near.count = 0;
            if (mine == STATUS_OK) {
                mine = point_grid_query_box(grid, box.low, box.high, 1.0, &near, &own);
            }
            work[c] = (int32_t)near.count;
        }
        note_failure(&failure, 0, mine, &own, error);
        free(near.index);
    }
    return failure.status;
}

void body_part_work_free(struct body_part_work *work)
{
    FREE_ALL(work->mark, work->cell_mark, work->part_mark, work->near.index);
    *work = (struct body_part_work){0};
}

static enum status prepare(const struct partition *partition, struct body_part_work *work,
                           struct error *error)
{
    if (work->mark == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&work->mark, partition->cells->node_count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&work->cell_mark, partition->cells->count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&work->part_mark, partition->parts, error));
    }
    return STATUS_OK;
}

/* Whether the support of node j, not widened, reaches the box. */
static bool reaches(const struct partition *partition, int32_t j, const struct box *box)
{
    const struct point_grid *grid = partition->grid;
    double square = 0;
    for (int a = 0; a < grid->dim; a++) {
        double x = grid->x[(int64_t)j * grid->dim + a];
        double d = fmax(0.0, fmax(box->low[a] - x, x - box->high[a]));
        square += d * d;
    }
    return square < grid->radius[j] * grid->radius[j];
}

/* The mark of a node while part p is built is stored as MARKS * p plus the mark; other values belong to other
 * parts. */
enum { SEEN = 1, NEEDED = 2, MARKS = 3 };

static int mark_of(const int32_t *mark, int64_t i, int32_t part)
{
    int32_t value = mark[i] - part * MARKS;
    return value > 0 && value < MARKS ? (int)value : 0;
}

/* Append a node to the list unless it has been seen. */
static enum status see_node(struct body_part_work *work, int32_t part, int32_t node, struct index_list *list,
                            struct error *error)
{
    if (mark_of(work->mark, node, part) > 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(index_list_reserve(list, 1, error));
    work->mark[node] = part * MARKS + SEEN;
    list->index[list->count++] = node;
    return STATUS_OK;
}

/* Nodes whose supports, widened, reach the own cells; those not widened are marked NEEDED. */
static enum status list_reaching(const struct partition *partition, int32_t part, const int32_t *own_cell,
                                 int64_t count, struct body_part_work *work, struct index_list *list,
                                 struct error *error)
{
    for (int64_t i = 0; i < count; i++) {
        struct box box = box_of_cell(partition->cells, own_cell[i]);
        work->near.count = 0;
        RETURN_IF_ERROR(
            point_grid_query_box(partition->grid, box.low, box.high, partition->widen, &work->near, error));
        for (int64_t n = 0; n < work->near.count; n++) {
            int32_t j = work->near.index[n];
            RETURN_IF_ERROR(see_node(work, part, j, list, error));
            if (mark_of(work->mark, j, part) == SEEN && reaches(partition, j, &box)) {
                work->mark[j] = part * MARKS + NEEDED;
            }
        }
    }
    return STATUS_OK;
}

/* Append the cells at all nodes of the list from number `from` on, and their vertices to the list. */
static enum status add_cells(const struct partition *partition, int32_t part, struct body_part_work *work,
                             struct index_list *nodes, int64_t from, struct index_list *found,
                             struct error *error)
{
    const struct cells *cells = partition->cells;
    const struct cell_stars *stars = partition->stars;
    int vertices = cells->dim + 1;
    for (int64_t i = from, end = nodes->count; i < end; i++) {
        int32_t n = nodes->index[i];
        for (int64_t s = stars->ptr[n]; s < stars->ptr[n + 1]; s++) {
            int32_t cell = stars->cell[s];
            if (work->cell_mark[cell] == part + 1) {
                continue;
            }
            work->cell_mark[cell] = part + 1;
            RETURN_IF_ERROR(index_list_reserve(found, 1, error));
            found->index[found->count++] = cell;
            for (int k = 0; k < vertices; k++) {
                RETURN_IF_ERROR(
                    see_node(work, part, cells->node[(int64_t)cell * vertices + k], nodes, error));
            }
        }
    }
    return STATUS_OK;
}

/* Count the nodes of other parts that an evaluation needs, and these parts. */
static void count_needed(const struct partition *partition, int32_t part, struct body_part_work *work,
                         struct body_part *body)
{
    for (int64_t i = 0; i < body->node_count; i++) {
        int32_t n = body->node[i], owner = partition->owner[n];
        body->own_nodes += owner == part;
        if (owner != part && mark_of(work->mark, n, part) == NEEDED) {
            body->needed++;
            if (work->part_mark[owner] != part + 1) {
                work->part_mark[owner] = part + 1;
                body->others++;
            }
        }
    }
}

enum status body_part_build(const struct partition *partition, int32_t part, const int32_t *own_cell,
                            int64_t count, bool cells_wanted, struct body_part_work *work,
                            struct body_part *body, struct error *error)
{
    FREED_BY(index_list_free) struct index_list nodes = {0}, found = {0};
    *body = (struct body_part){.own_cells = count};
    RETURN_IF_ERROR(prepare(partition, work, error));
    for (int64_t i = 0; i < count; i++) {
        body->work += partition->work[own_cell[i]];
    }
    for (int64_t n = 0; n < partition->cells->node_count; n++) {
        if (partition->owner[n] == part) {
            RETURN_IF_ERROR(see_node(work, part, (int32_t)n, &nodes, error));
        }
    }
    RETURN_IF_ERROR(list_reaching(partition, part, own_cell, count, work, &nodes, error));
    int64_t reaching = nodes.count;
    RETURN_IF_ERROR(add_cells(partition, part, work, &nodes, 0, &found, error));
    RETURN_IF_ERROR(add_cells(partition, part, work, &nodes, reaching, &found, error));
    qsort(nodes.index, (size_t)nodes.count, sizeof *nodes.index, compare_int32);
    body->node = nodes.index;
    body->node_count = nodes.count;
    nodes.index = NULL;
    count_needed(partition, part, work, body);
    body->cell_count = found.count;
    if (cells_wanted) {
        qsort(found.index, (size_t)found.count, sizeof *found.index, compare_int32);
        body->cell = found.index;
        found.index = NULL;
    }
    return STATUS_OK;
}

void body_part_free(struct body_part *body)
{
    FREE_ALL(body->node, body->cell);
    *body = (struct body_part){0};
}
