#include "parts/rejoin.h"

#include "stages/stages.h"

#include "approx/cells/face_rows.h"
#include "base/lists.h"

#include <stdlib.h>

/* The face of the whole that equals a part's face whose first cell the part owns: it has the same nodes in
 * the same order. begin, face: the faces of each cell. */
static int64_t find_face(const struct rejoin *rejoin, const struct rejoin_part *part, const int64_t *begin,
                         const int32_t *face, int64_t local)
{
    int dim = rejoin->dim;
    int32_t cell = part->cell[part->faces.cell[2 * local]];
    for (int64_t i = begin[cell]; i < begin[cell + 1]; i++) {
        int same = 0;
        for (int a = 0; a < dim; a++) {
            same += rejoin->faces.node[(int64_t)face[i] * dim + a] ==
                    part->node[part->faces.node[local * dim + a]];
        }
        if (same == dim) {
            return face[i];
        }
    }
    tool_fail(rejoin->tool, STATUS_INPUT, "%s: faces: row %lld: not a face of the body: run ipoints again",
              part->file, (long long)local);
}

/* A shared row, with its points, belongs to the part that owns the first of its faces. */
static void map_face_rows(struct rejoin *rejoin, struct rejoin_part *part, const int32_t *first_face)
{
    int rows = FACE_ROWS(rejoin->dim), per_face = OWN_POINTS(rejoin->dim);
    const struct faces *whole_faces = &rejoin->faces;
    const int32_t *face = part->to[ROWS_FACES];
    int64_t row_count = part->faces.row_count, point_count = face_row_point(&part->faces, row_count);
    int32_t *to = rejoin_new_rows(rejoin, part, ROWS_OF_FACES, row_count);
    int32_t *points = rejoin_new_rows(rejoin, part, ROWS_FACEPOINTS, point_count);
    int32_t *boundary = rejoin_new_rows(rejoin, part, ROWS_BOUNDARY, part->faces.boundary_count * per_face);
    for (int64_t r = 0; r < row_count; r++) {
        to[r] = -1;
    }
    for (int64_t i = 0; i < part->faces.count * rows; i++) {
        int64_t whole = face[i / rows];
        int32_t row = whole < 0 ? -1 : (int32_t)face_row(&rejoin->faces, whole, (int)(i % rows));
        if (row >= 0 && face_has_own_row(whole_faces, whole) != face_has_own_row(&part->faces, i / rows)) {
            tool_fail(rejoin->tool, STATUS_INPUT,
                      "%s: faces.row: row %lld: at the edge of the halo: cut again with a wider one "
                      "(part -w, now %g)",
                      part->file, (long long)(i / rows), rejoin->widen);
        }
        if (row >= 0 && first_face[row] == whole) {
            to[face_row(&part->faces, i / rows, (int)(i % rows))] = row;
        }
    }
    for (int64_t r = 0; r < row_count; r++) {
        int64_t first = face_row_point(&part->faces, r);
        for (int64_t p = first; p < face_row_point(&part->faces, r + 1); p++) {
            points[p] = to[r] < 0 ? -1 : (int32_t)(face_row_point(whole_faces, to[r]) + p - first);
        }
    }
    for (int64_t i = 0; i < part->faces.boundary_count * per_face; i++) {
        boundary[i] = face[i / per_face] < 0 ? -1 : (int32_t)(face[i / per_face] * per_face + i % per_face);
    }
}

/* The side of each cell of the whole, to be freed; NULL: supports stop at no interface. */
static int32_t *whole_sides(const struct rejoin *rejoin)
{
    int32_t *side = NULL;
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        const struct rejoin_part *part = &rejoin->part[k];
        const int32_t *of_part;
        TOOL_TRY(rejoin->tool, stage_sides(&part->stream, "support", &of_part, &error));
        if (of_part != NULL && side == NULL) {
            TOOL_TRY(rejoin->tool, NEW_ARRAY(&side, rejoin->rows[ROWS_CELLS], &error));
        }
        for (int64_t c = 0; of_part != NULL && c < part->cells.count; c++) {
            side[part->cell[c]] = of_part[c];
        }
    }
    return side;
}

void rejoin_map_faces(struct rejoin *rejoin)
{
    int32_t *side = whole_sides(rejoin);
    const struct tool *tool = rejoin->tool;
    const struct section *points = stream_find(&rejoin->part[0].stream, "points.x");
    bool boundary_only = points != NULL && !points_are_smoothed(points);
    int64_t *begin;
    int32_t *face, *first_face;
    const struct cells whole = {.dim = rejoin->dim,
                                .node_count = rejoin->rows[ROWS_NODES],
                                .x = rejoin->x,
                                .count = rejoin->rows[ROWS_CELLS],
                                .node = rejoin->cell};
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        TOOL_TRY(tool, fail_in(&error, stream_faces(&part->stream, &part->cells, &part->faces, &error), "%s",
                               part->file));
    }
    TOOL_TRY(tool, faces_build(&whole, boundary_only, &rejoin->faces, &error));
    if (side != NULL) {
        free(rejoin->faces.row);
        TOOL_TRY(tool, face_rows_number(whole.node_count, side, &rejoin->faces, &error));
        free(side);
    }
    const struct faces *faces = &rejoin->faces;
    TOOL_TRY(tool, lists_by_row(faces->count, 2, faces->cell, whole.count, &begin, &face, &error));
    TOOL_TRY(tool, NEW_ARRAY(&first_face, faces->row_count, &error));
    int rows = FACE_ROWS(rejoin->dim);
    for (int64_t i = faces->count * rows - 1; i >= 0; i--) {
        first_face[face_row(faces, i / rows, (int)(i % rows))] = (int32_t)(i / rows);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *to = rejoin_new_rows(rejoin, part, ROWS_FACES, part->faces.count);
        for (int64_t f = 0; f < part->faces.count; f++) {
            bool own = part->to[ROWS_CELLS][part->faces.cell[2 * f]] >= 0;
            to[f] = own ? (int32_t)find_face(rejoin, part, begin, face, f) : -1;
        }
        map_face_rows(rejoin, part, first_face);
    }
    FREE_ALL(begin, face, first_face);
    rejoin->rows[ROWS_FACES] = faces->count;
    rejoin->rows[ROWS_OF_FACES] = faces->row_count;
    rejoin->rows[ROWS_FACEPOINTS] = face_row_point(faces, faces->row_count);
    rejoin->rows[ROWS_BOUNDARY] = faces->boundary_count * OWN_POINTS(rejoin->dim);
    rejoin_check_rows(rejoin, ROWS_FACES, "faces");
    rejoin_check_rows(rejoin, ROWS_OF_FACES, "faces.row");
}
