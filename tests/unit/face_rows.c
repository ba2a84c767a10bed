/* Rows of faces: which share them, their points and their cells. */
#include "box_fixture.h"

#include "approx/cells/face_rows.h"

/* Whether a cell or a face of `corners` nodes has all of those. */
static bool has_all(const int32_t *vertex, int corners, const int32_t *node, int count)
{
    for (int i = 0; i < count; i++) {
        bool has = false;
        for (int k = 0; k < corners; k++) {
            has = has || vertex[k] == node[i];
        }
        if (!has) {
            return false;
        }
    }
    return true;
}

/* Whether the node is of a face on the boundary, or between sides. */
static bool is_outer(const struct faces *faces, const int32_t *side, int32_t node)
{
    for (int64_t f = 0; f < faces->count; f++) {
        const int32_t *cell = faces->cell + 2 * f;
        bool outer = cell[1] < 0 || (side != NULL && side[cell[0]] != side[cell[1]]);
        if (outer && has_all(faces->node + f * faces->dim, faces->dim, &node, 1)) {
            return true;
        }
    }
    return false;
}

/* The mean of the points of each face is its centre; points of edges are their middles. */
static void check_points(const struct cells *cells, const struct faces *faces)
{
    int dim = faces->dim;
    double *x = zeros((face_row_point(faces, faces->row_count) * dim), sizeof *x);
    face_rows_points(faces, cells->x, x);
    for (int64_t f = 0; f < faces->count; f++) {
        for (int a = 0; a < dim; a++) {
            double mean = 0.0, centre = 0.0;
            for (int k = 0; k < FACE_ROWS(dim); k++) {
                int64_t row = face_row(faces, f, k), first = face_row_point(faces, row);
                int64_t count = face_row_point(faces, row + 1) - first;
                assert_int_equal(count, face_has_own_row(faces, f) ? OWN_POINTS(dim) : 1);
                for (int64_t p = first; p < first + count; p++) {
                    mean += x[p * dim + a] / (double)(count * FACE_ROWS(dim));
                }
                if (!face_has_own_row(faces, f)) {
                    const int32_t *node = faces->node + f * dim;
                    double middle = cells->x[(int64_t)node[k] * dim + a];
                    middle = 0.5 * (middle + cells->x[(int64_t)node[(k + 1) % dim] * dim + a]);
                    AT_MOST(fabs(x[first * dim + a] - middle), 1e-16);
                }
            }
            for (int k = 0; k < dim; k++) {
                centre += cells->x[(int64_t)faces->node[f * dim + k] * dim + a] / dim;
            }
            AT_MOST(fabs(mean - centre), 1e-15);
        }
    }
}

/* The cells of a row are those with all of the nodes: of the face, or of the edge. */
static void check_cells(const struct cells *cells, const struct faces *faces)
{
    SCRATCH int64_t *ptr = NULL;
    int64_t next = 0;
    SCRATCH int32_t *cell = NULL;
    int dim = faces->dim;
    GOOD(face_rows_cells(cells->node_count, faces, &ptr, &cell, &error));
    for (int64_t i = 0; i < faces->count * FACE_ROWS(dim); i++) {
        int64_t f = i / FACE_ROWS(dim), k = i % FACE_ROWS(dim), row = face_row(faces, f, (int)k), with = 0;
        bool own = face_has_own_row(faces, f);
        const int32_t *node = faces->node + f * dim, edge[2] = {node[k], node[(k + 1) % dim]};
        if (own ? k > 0 : row < next) {
            continue;
        }
        for (int64_t c = 0; c < cells->count; c++) {
            bool listed = false,
                 at = has_all(cells->node + c * (dim + 1), dim + 1, own ? node : edge, own ? dim : 2);
            for (int64_t j = ptr[row]; j < ptr[row + 1]; j++) {
                listed = listed || cell[j] == c;
            }
            assert_true(listed == at);
            with += at;
        }
        assert_int_equal(with, ptr[row + 1] - ptr[row]);
        next = own ? next : row + 1;
    }
}

/* Own rows first, in the order of the faces; two faces share one where they share an edge. */
static void check_rows(const struct faces *faces, const int32_t *side)
{
    int64_t own = 0, next = faces->own_count;
    for (int64_t f = 0; f < faces->count; f++) {
        bool alone = faces->dim == 2;
        for (int k = 0; k < 3 && !alone; k++) {
            alone = is_outer(faces, side, faces->node[3 * f + k]);
        }
        assert_true(alone == face_has_own_row(faces, f));
        if (alone) {
            assert_int_equal(face_row(faces, f, 0), own);
            own++;
        }
    }
    assert_int_equal(own, faces->own_count);
    for (int64_t i = 0; faces->dim == 3 && i < faces->count * 3; i++) {
        const int32_t *node = faces->node + i / 3 * 3;
        int32_t edge[2] = {node[i % 3], node[(i % 3 + 1) % 3]};
        int64_t row = face_row(faces, i / 3, (int)(i % 3));
        if (face_has_own_row(faces, i / 3)) {
            continue;
        }
        bool found = false;
        for (int64_t j = 0; j < i; j++) {
            const int32_t *other = faces->node + j / 3 * 3;
            int32_t before[2] = {other[j % 3], other[(j % 3 + 1) % 3]};
            if (!face_has_own_row(faces, j / 3)) {
                bool same = has_all(before, 2, edge, 2);
                assert_true(same == (face_row(faces, j / 3, (int)(j % 3)) == row));
                found = found || same;
            }
        }
        assert_true(found ? row < next : row == next);
        next += !found;
    }
    assert_int_equal(next, faces->row_count);
}

TEST_IN_EACH_DIM(rows_of_faces)
{
    FREED_BY(cloud_free) struct cloud cloud = box_cloud(dim, 6, 0.1, 0.0);
    struct cells cells = cells_of(&cloud);
    int32_t *side = zeros(cells.count, sizeof *side);
    struct faces faces;
    int64_t own[2];
    for (int64_t c = 0; c < cells.count; c++) {
        double middle[3];
        cell_centroid(&cells, c, middle);
        side[c] = middle[0] > 0.045;
    }
    GOOD(faces_build(&cells, false, &faces, &error));
    for (int sides = 0; sides < 2; sides++) {
        free(faces.row);
        GOOD(face_rows_number(cells.node_count, sides ? side : NULL, &faces, &error));
        check_rows(&faces, sides ? side : NULL);
        check_points(&cells, &faces);
        check_cells(&cells, &faces);
        own[sides] = faces.own_count;
    }
    assert_true(dim == 2 ? own[0] == faces.count : own[0] < own[1] && own[1] < faces.count);
    faces_free(&faces);
    GOOD(faces_build(&cells, true, &faces, &error));
    assert_null(faces.row);
    assert_int_equal(faces.row_count, faces.boundary_count);
    faces_free(&faces);
}

RUN_TESTS(NULL, NULL)
