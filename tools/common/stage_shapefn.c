#include "stages.h"

#include "approx/quadrature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status stage_recorded_mls(const struct stream *stream, int dim, struct mls *mls, struct error *error)
{
    const struct section *radius = stream_find(stream, "support.radius");
    char value[256];
    int choice, count;
    enum status status = STATUS_OK;
    *mls = mls_default(dim);
    if (radius == NULL) {
        return STATUS_OK;
    }
    if (section_attribute(radius, "basis", value, sizeof value)) {
        TRY(parse_choice(value, "support.radius: basis", basis_names, BASIS_COUNT, &choice, error));
        mls->basis = (enum basis)choice;
    }
    if (section_attribute(radius, "weight", value, sizeof value)) {
        TRY(parse_choice(value, "support.radius: weight", weight_names, WEIGHT_COUNT, &choice, error));
        mls->weight = (enum weight_function)choice;
    }
    if (section_attribute(radius, "mu_absolute", value, sizeof value)) {
        mls->mu_absolute = strcmp(value, "0") != 0;
    }
    if (section_attribute(radius, "mu", value, sizeof value)) {
        TRY(parse_double_list(value, "support.radius: mu", 0.0, 1e300, MLS_MAX_SECOND, mls->mu, &count,
                              error));
        if (count != mls_second_order_count(dim)) {
            status = fail(error, STATUS_INPUT, "support.radius: mu: %d values, not %d", count,
                          mls_second_order_count(dim));
        }
    }
done:
    return status;
}

enum status stage_recorded_reach(const struct stream *stream, enum reach_rule *reach, struct error *error)
{
    const struct section *radius = stream_find(stream, "support.radius");
    char value[64];
    int choice = REACH_CELLS;
    enum status status = STATUS_OK;
    if (radius != NULL && section_attribute(radius, "reach", value, sizeof value)) {
        status = parse_choice(value, "support.radius: reach", reach_names, REACH_RULE_COUNT, &choice, error);
    }
    *reach = (enum reach_rule)choice;
    return status;
}

/* Sections may come from anywhere: finite coordinates, radii and factors that are finite and positive. */
static enum status check_numbers(const struct section *section, bool positive, struct error *error)
{
    const double *values = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (!isfinite(values[i]) || (positive && !(values[i] > 0.0))) {
            return fail(error, STATUS_INPUT, "%s: row %lld: %g is not a %s", section->name,
                        (long long)(i / section->cols), values[i],
                        positive ? "positive length" : "finite coordinate");
        }
    }
    return STATUS_OK;
}

/* Tabulate phi (and gradients) at the points of one section on the lists of one prefix. */
static enum status tabulate(struct stream *stream, const struct mls *mls, const char *section,
                            const char *prefix, const char *phi_name, bool gradients, struct error *error)
{
    enum status status;
    struct neighbours lists;
    int dim;
    int64_t node_count;
    const double *nodes;
    const struct section *points, *radius;
    double *phi = NULL, *dphi = NULL;
    char attributes[64];
    TRY(stream_nodes(stream, &dim, &node_count, &nodes, error));
    TRY(stream_need(stream, section, TYPE_F8, dim, "ipoints", &points, error));
    TRY(stream_need(stream, "support.radius", TYPE_F8, 1, "support", &radius, error));
    TRY(stream_neighbours(stream, prefix, points->rows, node_count, &lists, error));
    if (radius->rows != node_count || lists.widen == NULL) {
        status = fail(error, STATUS_INPUT, "support.radius, %s.widen: do not fit: run support again", prefix);
        goto done;
    }
    TRY(check_numbers(points, false, error));
    TRY(check_numbers(radius, true, error));
    for (int64_t p = 0; p < points->rows; p++) {
        if (!(lists.widen[p] >= 1.0) || !isfinite(lists.widen[p])) {
            status = fail(error, STATUS_INPUT, "%s.widen: row %lld: %g is no factor", prefix, (long long)p,
                          lists.widen[p]);
            goto done;
        }
    }
    int64_t pairs = lists.ptr[points->rows];
    TRY(NEW_ARRAY(&phi, pairs, error));
    if (gradients) {
        TRY(NEW_ARRAY(&dphi, pairs * dim, error));
    }
    TRY(shape_table(mls, nodes, radius->data, &lists, points->data, section, phi, dphi, error));
    status = stream_put(stream, phi_name, TYPE_F8, pairs, 1, "", phi, true, error);
    phi = NULL;
    if (status == STATUS_OK && gradients) {
        status = stream_put(stream, "shape.dphi", TYPE_F8, pairs, dim,
                            vector_attributes(dim, "1/m", attributes), dphi, true, error);
        dphi = NULL;
    }
done:
    free(phi);
    free(dphi);
    return status;
}

/* Replace the points' lists and table by those of the conforming cells. */
static enum status put_smoothed(struct stream *stream, struct error *error)
{
    enum status status, next;
    struct cells cells;
    struct smoothed_table table = {0};
    struct neighbours lists;
    struct faces faces;
    const struct section *phi, *points;
    char attributes[64];
    TRY(stream_cells(stream, true, &cells, error));
    int per_face = quadrature_face_rule(cells.dim).points;
    TRY(stream_faces(stream, &cells, &faces, error)); /* their cells: shape_smooth */
    TRY(stream_need(stream, "face.phi", TYPE_F8, 1, "shapefn", &phi, error));
    TRY(stream_need(stream, "points.x", TYPE_F8, cells.dim, "ipoints", &points, error));
    TRY(stream_neighbours(stream, "face", faces.count * per_face, cells.node_count, &lists, error));
    if (points->rows != cells.count || phi->rows != lists.ptr[lists.count]) {
        status = fail(error, STATUS_INPUT, "points.x, face.phi: do not fit the cells: run ipoints again");
        goto done;
    }
    TRY(shape_smooth(&cells, &faces, per_face, &lists, phi->data, &table, error));
    int64_t pairs = table.ptr[cells.count];
    status = stream_put(stream, "nbr.ptr", TYPE_I8, cells.count + 1, 1, "", table.ptr, true, error);
    next = stream_put(stream, "nbr.idx", TYPE_I4, pairs, 1, "", table.idx, true, error);
    status = status != STATUS_OK ? status : next;
    next = stream_put(stream, "shape.phi", TYPE_F8, pairs, 1, "", table.phi, true, error);
    status = status != STATUS_OK ? status : next;
    next = stream_put(stream, "shape.dphi", TYPE_F8, pairs, cells.dim,
                      vector_attributes(cells.dim, "1/m", attributes), table.dphi, true, error);
    status = status != STATUS_OK ? status : next;
    table = (struct smoothed_table){0};
done:
    smoothed_table_free(&table);
    return status;
}

enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error)
{
    enum status status;
    const struct section *points;
    TRY(stream_need(stream, "points.x", TYPE_F8, mls->dim, "ipoints", &points, error));
    bool conforming = points_are_conforming(points);
    if (conforming || stream_find(stream, "facepoints.x") != NULL) {
        TRY(tabulate(stream, mls, "facepoints.x", "face", "face.phi", false, error));
    }
    if (conforming) {
        TRY(put_smoothed(stream, error));
    } else {
        TRY(tabulate(stream, mls, "points.x", "nbr", "shape.phi", true, error));
    }
    TRY(tabulate(stream, mls, "nodes.x", "node", "node.phi", false, error));
done:
    return status;
}
