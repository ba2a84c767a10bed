/* Fault 25: whichever allocation fails, bodies, boundary averages, rigid surfaces, contacts and folds report
 * it with STATUS_SYSTEM and leave nothing allocated. */
#include "body_fixture.h"

#define WITHOUT_LIBGOMP
#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

#include "solid/body/body.h"
#include "solid/contact/contact_between.h"
#include "solid/folds/folds.h"

static struct sample sample; /* made before any allocation fails */

static enum status try_body_of(const struct smoothed_cells_input *smoothed, struct error *error)
{
    static const struct material materials[2] = {{.shear_modulus = 1.0, .bulk_modulus = 1.0},
                                                 {.shear_modulus = 2.0, .bulk_modulus = 9.0}};
    static int32_t material[64];
    FREED_BY(body_free) struct body body = {0};
    assert_true(sample.assembly.point_count <= 64);
    material[1] = 1;
    struct body_input input = sample_input(&sample, materials, 2, material);
    input.smoothed = smoothed;
    return body_build(&input, &body, error);
}

static enum status try_body(struct error *error)
{
    return try_body_of(NULL, error);
}

static enum status try_cells(struct error *error)
{
    struct smoothed_cells_input smoothed = sample_smoothed(&sample);
    return try_body_of(&smoothed, error);
}

static enum status build_averages(struct boundary_averages *averages, struct error *error)
{
    struct face_table table = sample_face_table(&sample);
    struct facet_set set = {sample.cloud.facet_count, sample.cloud.facets};
    return boundary_averages_build(&table, &set, averages, error);
}

static enum status try_boundary(struct error *error)
{
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    return build_averages(&averages, error);
}

static enum status try_ends(struct error *error)
{
    static bool none_held[1 << 12], end[1 << 12];
    struct face_table table = sample_face_table(&sample);
    assert_true(sample.assembly.faces.count < 1 << 12 && sample.cloud.node_count < 1 << 12);
    return boundary_find_junctions(&table, BOUNDARY_JUNCTION_SMOOTH, none_held, none_held, end, error);
}

static enum status try_rigid(struct error *error)
{
    static const double corners[] = {0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                     0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    return rigid_build(3, 4, corners, false, &surface, error);
}

static enum status try_contact(struct error *error)
{
    static const double corners[] = {1, -1, -1, -1};
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    FREED_BY(contact_free) struct contact contact = {0};
    enum status status = build_averages(&averages, error);
    if (status == STATUS_OK) {
        status = rigid_build(2, 1, corners, false, &surface, error);
    }
    if (status == STATUS_OK) {
        status = contact_build(&averages, NULL, sample.cloud.x, 2, &surface, 1.0, &contact, error);
    }
    return status;
}

/* The boundary against itself. */
static enum status try_between(struct error *error)
{
    struct face_table table = sample_face_table(&sample);
    struct facet_set set = {sample.cloud.facet_count, sample.cloud.facets};
    FREED_BY(boundary_averages_free) struct boundary_averages points = {0}, averages = {0};
    FREED_BY(opposite_free) struct opposite opposite = {0};
    FREED_BY(contact_free) struct contact contact = {0};
    int32_t part[64] = {0};
    bool any;
    enum status status = opposite_parts(&sample.assembly.cells, part, error);
    status = status == STATUS_OK ? boundary_points_build(&table, &set, &points, error) : status;
    status = status == STATUS_OK ? boundary_averages_build(&table, &set, &averages, error) : status;
    status = status == STATUS_OK ? opposite_build(&table, &set, part, true, &opposite, error) : status;
    if (status == STATUS_OK) {
        status = contact_between_build(&points, &averages, 2, sample.cloud.node_count, table.per_face,
                                       &opposite, part, 0, 1.0, true, &contact, &any, error);
    }
    return status;
}

static enum status try_folds(struct error *error)
{
    static const double x[] = {0, 0, 1, 0, 1, 1, 0, 1};
    static const int32_t cell[] = {0, 1, 2, 0, 2, 3}, facet[] = {0, 1, 1, 2, 2, 3, 3, 0};
    static const bool prescribed[] = {true, false, false, false};
    FREED_BY(folds_free) struct folds folds = {0};
    struct fold_input input = {.dim = 2,
                               .node_count = 4,
                               .x = x,
                               .cell_count = 2,
                               .cell = cell,
                               .facet_count = 4,
                               .facet = facet,
                               .held = prescribed};
    return folds_build(&input, &folds, error);
}

TEST(bodies)
{
    fail_each(try_body, 20);
    fail_each(try_cells, 40);
}

TEST(boundaries)
{
    fail_each(try_boundary, 12);
    fail_each(try_ends, 0);
}

TEST(rigid_surfaces)
{
    fail_each(try_rigid, 12);
}

TEST(contacts)
{
    fail_each(try_contact, 30);
    fail_each(try_between, 60);
}

TEST(folds_of_bodies)
{
    fail_each(try_folds, 12);
}

static int make(void **state)
{
    (void)state;
    sample = make_sample(2, true, 3); /* so small that sorting allocates nothing */
    return 0;
}

static int drop(void **state)
{
    (void)state;
    sample_free(&sample);
    return 0;
}

RUN_TESTS(make, drop)

#else
RUN_TESTS(NULL, NULL)
#endif
