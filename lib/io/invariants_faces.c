#include "io/invariants_private.h"

#include <inttypes.h>

static void check_multiple(struct check *check, const struct section *points, int64_t count, int64_t faces,
                           const char *which)
{
    if (points != NULL && (faces == 0 ? count != 0 : count % faces != 0)) {
        invariants_violation(check, points, "%" PRId64 " points on %" PRId64 " faces%s", count, faces, which);
    }
}

/* Counts the points of faces by their rows: three of a row that is one face's own, which stand first, one of
 * others, which are numbered as they come; -1: they do not. *count: of the rows. */
static int64_t count_face_points(struct check *check, const struct section *rows, int64_t *count)
{
    int64_t own = 0, bad = -1;
    const int32_t *row = rows->data;
    for (int64_t f = 0; f < rows->rows && bad < 0; f++) {
        if (row[3 * f] == row[3 * f + 2]) {
            bad = row[3 * f] == own && row[3 * f + 1] == own ? -1 : f;
            own++;
        }
    }
    *count = own;
    for (int64_t i = 0; i < 3 * rows->rows && bad < 0; i++) {
        if (row[i / 3 * 3] != row[i / 3 * 3 + 2]) {
            bad = row[i] >= own && row[i] <= *count ? -1 : i / 3;
            *count += row[i] == *count;
        }
    }
    if (bad >= 0) {
        invariants_violation(check, rows, "row %" PRId64 ": %d %d %d: not numbered as they come", bad,
                             row[3 * bad], row[3 * bad + 1], row[3 * bad + 2]);
        return -1;
    }
    return *count + 2 * own;
}

/* face.ptr has a row for each row of the faces, facepoints.x equally many points for each face where they
 * share none. */
static void check_face_rows(struct check *check)
{
    const struct section *faces = stream_find(check->stream, "faces.cell");
    const struct section *rows = stream_find(check->stream, "faces.row");
    const struct section *points = stream_find(check->stream, "facepoints.x");
    const struct section *ptr = stream_find(check->stream, "face.ptr");
    if (faces == NULL || (rows != NULL && (rows->type != TYPE_I4 || rows->cols != 3))) {
        return;
    }
    int64_t count = faces->rows, wanted = rows != NULL ? count_face_points(check, rows, &count) : 0;
    if (wanted < 0) {
        return;
    }
    if (rows == NULL) {
        check_multiple(check, points, points != NULL ? points->rows : 0, count, "");
    } else if (points != NULL && points->rows != wanted) {
        invariants_violation(check, points, "%" PRId64 " points, but faces.row asks for %" PRId64,
                             points->rows, wanted);
    }
    if (ptr != NULL && ptr->rows != count + 1) {
        invariants_violation(check, ptr, "%" PRId64 " rows, but faces%s has %" PRId64 ": need one more",
                             ptr->rows, rows != NULL ? ".row" : "", count);
    }
}

/* Faces on the boundary come first; boundary.ptr has equally many points on each of these. */
static void check_boundary(struct check *check)
{
    const struct section *faces = stream_find(check->stream, "faces.cell");
    const struct section *boundary = stream_find(check->stream, "boundary.ptr");
    int64_t outer = 0;
    if (faces == NULL || faces->type != TYPE_I4 || faces->cols != 2) {
        return;
    }
    const int32_t *cell = faces->data;
    for (int64_t f = 0; f < faces->rows; f++) {
        if (cell[2 * f + 1] < 0 && outer++ < f) {
            invariants_violation(check, faces, "row %" PRId64 ": on the boundary, after faces between cells",
                                 f);
            return;
        }
    }
    check_multiple(check, boundary, boundary != NULL ? boundary->rows - 1 : 0, outer, " of the boundary");
}

void invariants_check_faces(struct check *check)
{
    check_boundary(check);
    check_face_rows(check);
}
