#include "approx/labels/label_cells_private.h"
#include "base/memory.h"

#include <math.h>

/* The level of an octree whose cells have edges nearest to `size` by ratio; level 0 has cubes of edge
 * `spacing`. */
static int size_level(double spacing, double size)
{
    /* Of tetrahedra of the lattice, with two edges along axes and four half diagonals, by cells_node_spacing.
     */
    double mean_edge = (1 + sqrt(3)) / 3 * spacing;
    return (int)fmin(fmax(round(log2(mean_edge / size)), 0), OCTREE_MOST_LEVELS);
}

/* The size at a place in a cell, linear between its nodes. */
static double size_at(const struct cells *cells, const double *size, int64_t cell, const double at[3])
{
    const int32_t *node = cells->node + 4 * cell;
    double share[4], value = 0, least = INFINITY, most = 0;
    cell_barycentric(cells, cell, at, share);
    for (int k = 0; k < 4; k++) {
        value += share[k] * size[node[k]];
        least = fmin(least, size[node[k]]);
        most = fmax(most, size[node[k]]);
    }
    return fmin(fmax(value, least), most);
}

/* Raise wish[] of the finest cubes to the levels that the sizes need. There are count[3] cubes of this edge,
 * the first from low[3], m. Cubes outside of the cells with sizes keep their wish. *unsized: the share of the
 * cubes in the body outside of the cells with sizes; STATUS_INPUT if it is 1. */
static enum status sizes_wish(const struct labels *labels, const struct label_cells_options *options,
                              int levels, const int64_t count[3], const double low[3], double edge,
                              uint8_t *wish, double *unsized, struct error *error)
{
    struct cells scaled = *options->sized;
    int64_t total = count[0] * count[1] * count[2], doubly = 0, within = 0, beyond = 0;
    NEW_SCRATCH(double, x, 3 * scaled.node_count, error);
    NEW_SCRATCH(int32_t, owner, total, error);
    for (int64_t i = 0; i < 3 * scaled.node_count; i++) {
        x[i] = (options->sized->x[i] - low[i % 3]) / edge - 0.5;
    }
    scaled.x = x;
    raster_cells(&scaled, 1, count, owner, &doubly);
#pragma omp parallel for schedule(static) reduction(+ : within, beyond)
    for (int64_t c = 0; c < total; c++) {
        const int64_t cube[3] = {c % count[0], c / count[0] % count[1], c / count[0] / count[1]};
        const double at[3] = {(double)cube[0], (double)cube[1], (double)cube[2]};
        const double centre[3] = {low[0] + edge * (at[0] + 0.5), low[1] + edge * (at[1] + 0.5),
                                  low[2] + edge * (at[2] + 0.5)};
        bool inside = options->keep[labels_at(labels, centre)];
        within += inside;
        beyond += inside && owner[c] < 0;
        if (owner[c] >= 0) {
            int level = size_level(options->spacing, size_at(&scaled, options->size, owner[c], at));
            uint8_t wanted = OCTREE_WISH(level < levels - 1 ? level : levels - 1, false);
            wish[c] = wanted > wish[c] ? wanted : wish[c];
        }
    }
    if (within > 0 && beyond == within) {
        return fail(error, STATUS_INPUT,
                    "the sizes lie elsewhere: none of their cells reaches into the body");
    }
    *unsized = within > 0 ? (double)beyond / (double)within : 0;
    return STATUS_OK;
}

static const int64_t most_points = (int64_t)1 << 26;

/* All points that a lattice may have: corners of the finest cubes, first index fastest, then their centres;
 * in 2D rows of points, odd ones shifted by half a spacing. */
struct points {
    struct lattice *lattice;
    int levels, fine;       /* fine: the level of cubes at interfaces */
    double spacing, low[3]; /* of the finest level */
    int64_t count[3], corners, total;
    uint16_t *label; /* total */
    bool *near;      /* total: of a cell with a point of a label */
    bool marking;    /* points near are marked, and no cells are made */
    int32_t *node;   /* total: number of the node, -1: not used */
    int64_t room;    /* numbers allocated in lattice->cell */
    struct error *error;
};

/* Coordinates of a point in halves of the finest edge. */
static void place_of(const struct points *points, int64_t point, int32_t place[3])
{
    bool centre = point >= points->corners;
    int64_t at = point - (centre ? points->corners : 0);
    place[0] = (int32_t)(2 * (at % points->count[0]) + centre);
    place[1] = (int32_t)(2 * (at / points->count[0] % points->count[1]) + centre);
    place[2] = (int32_t)(2 * (at / points->count[0] / points->count[1]) + centre);
}

static int64_t point_at(const struct points *points, const int32_t place[3])
{
    return ((int64_t)(place[2] / 2) * points->count[1] + place[1] / 2) * points->count[0] + place[0] / 2 +
           (place[0] & 1 ? points->corners : 0);
}

static void coordinates(const struct points *points, int64_t point, double x[])
{
    int32_t place[3];
    place_of(points, point, place);
    if (points->lattice->dim == 2) {
        int32_t column = place[0] / 2, row = place[1] / 2;
        x[0] = points->low[0] + points->spacing * (column + (row & 1) * 0.5);
        x[1] = points->low[1] + points->spacing * sqrt(0.75) * row;
        return;
    }
    for (int d = 0; d < 3; d++) {
        x[d] = points->low[d] + points->spacing * 0.5 * place[d];
    }
}

/* Size the lattice. It is fixed in world coordinates: its coarsest cubes are at multiples of their edge, with
 * two beyond the labels and their smoothing on each side. */
static enum status size_points(struct points *points, struct error *error)
{
    const struct labels *labels = points->lattice->labels;
    int dim = labels->dim;
    int64_t coarse = (int64_t)1 << (points->levels - 1);
    double high[3], total = dim == 3 ? 2 : 1;
    labels_box(labels, points->low, high);
    if (!(points->low[0] <= high[0])) {
        return fail(error, STATUS_INPUT, "no voxel has a label: all is outside");
    }
    points->count[2] = 1;
    for (int d = 0; d < dim; d++) {
        double step = points->spacing * (double)coarse * (dim == 2 && d == 1 ? sqrt(0.75) : 1);
        double first = floor(points->low[d] / step) - 2, last = ceil(high[d] / step) + 2;
        first -= dim == 2 && fmod(first, 2) != 0 ? 1 : 0;
        total *= (last - first) * (double)coarse + 1;
        if (!(total < (double)most_points)) {
            return fail(
                error, STATUS_INPUT,
                "spacing %g m%s: more than %lld lattice points over the labels: larger, or another unit?",
                points->spacing, points->levels > 1 ? " where it is least" : "", (long long)most_points);
        }
        points->low[d] = first * step;
        points->count[d] = (int64_t)(last - first) * coarse + 1;
    }
    points->corners = points->count[0] * points->count[1] * points->count[2];
    points->total = dim == 3 ? 2 * points->corners : points->corners;
    return STATUS_OK;
}

static enum status label_points(struct points *points, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&points->label, points->total, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->near, points->total, error));
    RETURN_IF_ERROR(NEW_ARRAY(&points->node, points->total, error));
#pragma omp parallel for schedule(static)
    for (int64_t p = 0; p < points->total; p++) {
        double x[3];
        coordinates(points, p, x);
        points->label[p] = (uint16_t)labels_at(points->lattice->labels, x);
        points->node[p] = -1;
    }
    return STATUS_OK;
}

/* ---- cells ---- */

/* Append a cell of these points, unless it is far outside. */
static enum status add_cell(struct points *points, int64_t corner[4])
{
    struct lattice *lattice = points->lattice;
    int corners = lattice->dim + 1;
    bool labelled = false, near = false;
    for (int k = 0; k < corners; k++) {
        labelled = labelled || points->label[corner[k]] != 0;
        near = near || points->near[corner[k]];
    }
    for (int k = 0; k < corners && points->marking && labelled; k++) {
        points->near[corner[k]] = true;
    }
    if (points->marking || !near) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(
        GROW_ARRAY(&lattice->cell, (lattice->cell_count + 1) * corners, &points->room, points->error));
    for (int k = 0; k < corners; k++) {
        lattice->cell[lattice->cell_count * corners + k] = (int32_t)corner[k];
        points->node[corner[k]] = 0;
    }
    lattice->cell_count++;
    return STATUS_OK;
}

static enum status add_tetrahedron(void *context, const int32_t corner[4][3])
{
    struct points *points = context;
    int64_t point[4], edge[3][3];
    for (int k = 0; k < 4; k++) {
        point[k] = point_at(points, corner[k]);
        for (int d = 0; d < 3 && k > 0; d++) {
            edge[k - 1][d] = corner[k][d] - corner[0][d];
        }
    }
    int64_t volume = edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) -
                     edge[0][1] * (edge[1][0] * edge[2][2] - edge[1][2] * edge[2][0]) +
                     edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
    if (volume < 0) {
        int64_t swap = point[0];
        point[0] = point[1];
        point[1] = swap;
    }
    return add_cell(points, point);
}

/* Add the two triangles above the edge from each point to the next in its row. */
static enum status add_triangles(struct points *points)
{
    for (int64_t p = 0; p < points->total; p++) {
        int64_t i = p % points->count[0], j = p / points->count[0];
        int64_t above = p + points->count[0] + (j & 1);
        int64_t up[4] = {p, p + 1, above}, down[4] = {p + 1, above + 1, above};
        if (i + 2 >= points->count[0] || j + 1 >= points->count[1]) {
            continue;
        }
        RETURN_IF_ERROR(add_cell(points, up));
        RETURN_IF_ERROR(add_cell(points, down));
    }
    return STATUS_OK;
}

/* Wish for the finest cubes that contain an interface of a label of fine[] (NULL: of any) their level. */
static void find_fine(const struct points *points, const bool *fine, const int64_t cubes[3], uint8_t *wish)
{
#pragma omp parallel for schedule(static)
    for (int64_t c = 0; c < cubes[0] * cubes[1] * cubes[2]; c++) {
        const int32_t at[3] = {(int32_t)(c % cubes[0]), (int32_t)(c / cubes[0] % cubes[1]),
                               (int32_t)(c / cubes[0] / cubes[1])};
        const int32_t centre[3] = {2 * at[0] + 1, 2 * at[1] + 1, 2 * at[2] + 1};
        uint16_t first = points->label[point_at(points, centre)];
        bool mixed = false, named = fine == NULL || fine[first];
        for (int k = 0; k < 8; k++) {
            const int32_t corner[3] = {2 * (at[0] + (k & 1)), 2 * (at[1] + (k >> 1 & 1)),
                                       2 * (at[2] + (k >> 2))};
            uint16_t label = points->label[point_at(points, corner)];
            mixed = mixed || label != first;
            named = named || fine[label];
        }
        wish[c] = mixed && named ? OCTREE_WISH(points->fine, true) : 0;
    }
}

static enum status add_tetrahedra(struct points *points, const struct label_cells_options *options)
{
    SCRATCH uint8_t *wish = NULL;
    FREED_BY(octree_free) struct octree octree = {0};
    const int64_t cubes[3] = {points->count[0] - 1, points->count[1] - 1, points->count[2] - 1};
    RETURN_IF_ERROR(NEW_ARRAY(&wish, cubes[0] * cubes[1] * cubes[2], points->error));
    if (points->fine > 0) {
        find_fine(points, options->fine, cubes, wish);
    }
    if (options->size != NULL) {
        RETURN_IF_ERROR(sizes_wish(points->lattice->labels, options, points->levels, cubes, points->low,
                                   points->spacing, wish, &points->lattice->unsized, points->error));
    }
    RETURN_IF_ERROR(octree_make(points->levels, cubes, wish, &octree, points->error));
    points->marking = true;
    RETURN_IF_ERROR(octree_cells(&octree, add_tetrahedron, points));
    points->marking = false;
    return octree_cells(&octree, add_tetrahedron, points);
}

/* Number the points of cells. */
static enum status make_nodes(struct points *points, struct error *error)
{
    struct lattice *lattice = points->lattice;
    int dim = lattice->dim;
    for (int64_t p = 0; p < points->total; p++) {
        if (points->node[p] >= 0) {
            points->node[p] = (int32_t)lattice->node_count++;
        }
    }
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->x, lattice->node_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->label, lattice->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lattice->place, lattice->node_count * 3, error));
    for (int64_t p = 0; p < points->total; p++) {
        int64_t n = points->node[p];
        if (n >= 0) {
            coordinates(points, p, lattice->x + n * dim);
            lattice->label[n] = points->label[p];
            if (dim == 3) {
                place_of(points, p, lattice->place + 3 * n);
            }
        }
    }
    for (int64_t i = 0; i < lattice->cell_count * (dim + 1); i++) {
        lattice->cell[i] = points->node[lattice->cell[i]];
    }
    return STATUS_OK;
}

/* Count the levels of cubes needed at interfaces and for sizes. */
static enum status count_levels(const struct label_cells_options *options, struct points *points,
                                struct error *error)
{
    double least = INFINITY;
    while (options->finest > 0 && ldexp(points->spacing, -points->fine) > options->finest * (1 + 1e-9)) {
        if (++points->fine == OCTREE_MOST_LEVELS) {
            return fail(error, STATUS_INPUT,
                        "spacing %g m at interfaces: at least 1/%d of the spacing inside, %g m",
                        options->finest, 1 << (OCTREE_MOST_LEVELS - 1), options->spacing);
        }
    }
    for (int64_t n = 0; options->size != NULL && n < options->sized->node_count; n++) {
        least = fmin(least, options->size[n]);
    }
    int level = least < INFINITY ? size_level(points->spacing, least) : 0;
    if (level >= OCTREE_MOST_LEVELS) {
        return fail(error, STATUS_INPUT, "a size of %g m: at least 1/%d of the spacing, %g m", least,
                    1 << (OCTREE_MOST_LEVELS - 1), options->spacing);
    }
    points->levels = 1 + (level > points->fine ? level : points->fine);
    points->spacing = ldexp(points->spacing, 1 - points->levels);
    return STATUS_OK;
}

static void points_free(struct points *points)
{
    FREE_ALL(points->label, points->near, points->node);
}

enum status lattice_make(const struct labels *labels, const struct label_cells_options *options,
                         struct lattice *lattice, struct error *error)
{
    FREED_BY(points_free)
    struct points points = {.lattice = lattice, .levels = 1, .spacing = options->spacing, .error = error};
    *lattice = (struct lattice){.labels = labels, .keep = options->keep, .dim = labels->dim};
    if ((options->finest > 0 || options->size != NULL) && labels->dim == 2) {
        return fail(error, STATUS_INPUT, "%s are for bodies in space, not for slices",
                    options->finest > 0 ? "finer interfaces" : "sizes");
    }
    RETURN_IF_ERROR(count_levels(options, &points, error));
    RETURN_IF_ERROR(size_points(&points, error));
    RETURN_IF_ERROR(label_points(&points, error));
    points.marking = labels->dim == 2;
    RETURN_IF_ERROR(labels->dim == 3 ? add_tetrahedra(&points, options) : add_triangles(&points));
    points.marking = false;
    RETURN_IF_ERROR(labels->dim == 3 ? STATUS_OK : add_triangles(&points));
    return make_nodes(&points, error);
}

void lattice_free(struct lattice *lattice)
{
    FREE_ALL(lattice->x, lattice->label, lattice->place, lattice->cell, lattice->end, lattice->cut,
             lattice->edge_ptr, lattice->edge_idx, lattice->on);
    *lattice = (struct lattice){0};
}
