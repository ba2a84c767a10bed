#include "stages.h"

#include "mls_options.h"

#include <stdlib.h>

/* Radii by the local spacing: from the cells where there are any, else from the nearest nodes. */
static enum status local_radii(const struct stream *stream, const struct support_options *options,
                               int64_t node_count, const double *x, double *radius, struct error *error)
{
    enum status status;
    struct cells cells;
    double *spacing = NULL;
    TRY(NEW_ARRAY(&spacing, node_count, error));
    TRY(stream_cells(stream, false, &cells, error));
    if (cells.count > 0) {
        TRY(cells_node_spacing(&cells, spacing, error));
    } else {
        TRY(nodes_spacing(options->mls.dim, node_count, x, spacing, error));
    }
    TRY(support_radii(options, node_count, spacing, radius, error));
done:
    free(spacing);
    return status;
}

enum status stage_radii(const struct stream *stream, const struct support_options *options,
                        int64_t node_count, const double *x, double *radius, struct error *error)
{
    return options->radius > 0.0 ? support_radii(options, node_count, NULL, radius, error)
                                 : local_radii(stream, options, node_count, x, radius, error);
}

/* Radii of the nodes, put into the stream with the settings they were made for. */
static enum status put_radii(struct stream *stream, const struct support_options *options, int64_t node_count,
                             const double *x, struct error *error)
{
    enum status status;
    double *radius = NULL;
    char attributes[512];
    TRY(NEW_ARRAY(&radius, node_count, error));
    TRY(stage_radii(stream, options, node_count, x, radius, error));
    mls_describe(&options->mls, attributes, sizeof attributes - 8);
    char described[sizeof attributes + 8];
    snprintf(described, sizeof described, "unit=m %s", attributes);
    status = stream_put(stream, "support.radius", TYPE_F8, node_count, 1, described, radius, true, error);
    radius = NULL;
done:
    free(radius);
    return status;
}

/* Lists PREFIX.ptr, .idx, .widen of the points of one section, which the report calls `called`. */
static enum status put_lists(struct stream *stream, const struct support_options *options,
                             const struct point_grid *grid, const struct section *points, const char *prefix,
                             const char *called, struct support_report *report, struct error *error)
{
    enum status status, next;
    struct support_lists lists = {0};
    char name[64];
    int64_t count = points->rows;
    TRY(support_build(options, grid, count, points->data, points->name, &lists, error));
    int64_t pairs = lists.ptr[count];
    int entry = report->lists++;
    report->list[entry].what = called;
    report->list[entry].points = count;
    report->list[entry].pairs = pairs;
    report->list[entry].fewest = lists.fewest;
    report->list[entry].most = lists.most;
    report->list[entry].widened = lists.widened;
    report->list[entry].widest = lists.widest;
    snprintf(name, sizeof name, "%s.ptr", prefix);
    status = stream_put(stream, name, TYPE_I8, count + 1, 1, "", lists.ptr, true, error);
    snprintf(name, sizeof name, "%s.idx", prefix);
    next = stream_put(stream, name, TYPE_I4, pairs, 1, "", lists.idx, true, error);
    status = status != STATUS_OK ? status : next;
    snprintf(name, sizeof name, "%s.widen", prefix);
    next = stream_put(stream, name, TYPE_F8, count, 1, "", lists.widen, true, error);
    status = status != STATUS_OK ? status : next;
    lists = (struct support_lists){0};
done:
    support_free(&lists);
    return status;
}

enum status stage_support(struct stream *stream, const struct support_options *options,
                          struct support_report *report, struct error *error)
{
    enum status status;
    struct point_grid grid = {0};
    int dim;
    int64_t node_count;
    const double *x;
    const struct section *points, *facepoints;
    static const char *const void_prefixes[] = {"nbr.", "face.", "node.", "support.radius", "shape."};
    *report = (struct support_report){0};
    for (size_t i = 0; i < sizeof void_prefixes / sizeof *void_prefixes; i++) {
        stream_remove_prefix(stream, void_prefixes[i]);
    }
    TRY(stream_nodes(stream, &dim, &node_count, &x, error));
    TRY(stream_need(stream, "points.x", TYPE_F8, dim, "ipoints", &points, error));
    TRY(put_radii(stream, options, node_count, x, error));
    TRY(point_grid_build(&grid, dim, node_count, x, stream_find(stream, "support.radius")->data, error));
    if (!points_are_conforming(points)) { /* else shapefn makes their lists from those of the faces */
        TRY(put_lists(stream, options, &grid, points, "nbr", "integration points", report, error));
    }
    if (stream_find(stream, "facepoints.x") != NULL) {
        TRY(stream_need(stream, "facepoints.x", TYPE_F8, dim, "ipoints", &facepoints, error));
        TRY(put_lists(stream, options, &grid, facepoints, "face", "points on faces", report, error));
    }
    TRY(put_lists(stream, options, &grid, stream_find(stream, "nodes.x"), "node", "nodes", report, error));
done:
    point_grid_free(&grid);
    return status;
}
