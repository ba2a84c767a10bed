/* Edges of faces, and the points on faces with their cells. */
#include "box_fixture.h"

#include "approx/cells/face_edges.h"
#include "base/vector.h"

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

/* The mean of the points of each row is the middle of its edge, or of its face on the boundary. */
static void check_points(const struct cells *cells, const struct faces *faces)
{
    int dim = faces->dim, count;
    double *x = zeros(face_point_count(faces) * dim, sizeof *x);
    int32_t *ends = zeros(faces->edge_count * 2, sizeof *ends);
    face_points(faces, cells->x, x);
    GOOD(face_edges_ends(faces, ends, &error));
    for (int64_t r = 0; r < face_row_count(faces); r++) {
        bool of_face = r >= faces->edge_count;
        const int32_t *node = of_face ? faces->node + (r - faces->edge_count) * dim : ends + 2 * r;
        double middle[3], mean[3] = {0.0, 0.0, 0.0};
        int64_t first = face_row_points(faces, r, &count);
        vector_middle(dim, cells->x, of_face ? dim : 2, node, middle);
        for (int k = 0; k < count; k++) {
            add_scaled(dim, 1.0 / count, x + (first + k) * dim, mean);
        }
        AT_MOST(vector_distance(dim, mean, middle), 1e-15);
    }
}

/* The cells at the points of an edge, or of a face on the boundary, are those with all of its nodes. */
static void check_cells(const struct cells *cells, const struct faces *faces)
{
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *cell = NULL;
    int dim = faces->dim;
    int64_t of_faces = faces->boundary_count;
    int32_t *ends = zeros(faces->edge_count * 2, sizeof *ends);
    GOOD(face_edges_ends(faces, ends, &error));
    GOOD(face_points_cells(faces, &ptr, &cell, &error));
    for (int64_t row = 0; row < of_faces + faces->edge_count; row++) {
        const int32_t *node = row < of_faces ? faces->node + row * dim : ends + 2 * (row - of_faces);
        int64_t with = 0;
        for (int64_t c = 0; c < cells->count; c++) {
            bool listed = false,
                 at = has_all(cells->node + c * (dim + 1), dim + 1, node, row < of_faces ? dim : 2);
            for (int64_t j = ptr[row]; j < ptr[row + 1]; j++) {
                listed = listed || cell[j] == c;
            }
            assert_true(listed == at);
            with += at;
        }
        assert_int_equal(with, ptr[row + 1] - ptr[row]);
    }
}

TEST_IN_EACH_DIM(edges_of_faces)
{
    FREED_BY(cloud_free) struct cloud cloud = box_cloud(dim, 5, 0.1, 0.0);
    struct cells cells = cells_of(&cloud);
    struct faces faces;
    GOOD(faces_build(&cells, false, &faces, &error));
    check_points(&cells, &faces);
    check_cells(&cells, &faces);
    faces_free(&faces);
    GOOD(faces_build(&cells, true, &faces, &error));
    assert_null(faces.edge);
    assert_int_equal(face_point_count(&faces), faces.count * FACE_POINTS(dim));
    faces_free(&faces);
}

RUN_TESTS(NULL, NULL)
