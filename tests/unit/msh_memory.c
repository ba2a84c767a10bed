/* Fault 25 for meshes and clouds: whichever allocation fails, it is reported and nothing is left allocated.
 */
#include "approx/points/cloud.h"
#include "io/mesh/msh.h"

#include <gsl/gsl_errno.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR
#include "msh_fixture.h"

static int form;

static enum status try_read(struct error *error)
{
    struct fixture f = fixture_make(form);
    FREED_BY(msh_free) struct msh msh = {0};
    if (form == ASCII_22) { /* tags far apart need an index of their own */
        assert_true(fixture_replace(&f, "\n9 ", "\n300000 "));
        assert_true(fixture_replace(&f, "\"body\"", "\"the body\""));
    }
    return msh_parse(&msh, f.bytes, f.size, error);
}

/* Two squares side by side, their border, a named corner, and a node of no cell. */
static enum status try_build(struct error *error)
{
    static double x[3 * 7] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 5, 5, 0};
    static int64_t node_tag[7] = {1, 2, 3, 4, 5, 6, 7};
    static int64_t element_tag[5] = {1, 2, 3, 4, 5};
    static int8_t type[5] = {3, 3, 1, 1, 15};
    static int64_t node_ptr[6] = {0, 4, 8, 10, 12, 13};
    static int32_t node_idx[13] = {0, 1, 4, 3, 1, 2, 5, 4, 0, 1, 1, 4, 2};
    static int64_t member_ptr[6] = {0, 1, 1, 2, 3, 4};
    static int32_t member_idx[4] = {3, 1, 2, 0};
    static char names[4][8] = {"corner", "side", "between", "body"};
    struct msh_group groups[4] = {{0, 1, names[0], 1, NULL},
                                  {1, 1, names[1], 1, NULL},
                                  {1, 2, names[2], 1, NULL},
                                  {2, 1, names[3], 1, NULL}};
    struct msh msh = {7,        x,          node_tag,   5, element_tag, type, node_ptr,
                      node_idx, member_ptr, member_idx, 4, groups,      0,    0};
    FREED_BY(mesh_free) struct mesh mesh = {0};
    FREED_BY(stream_free) struct stream stream = {0};
    enum status status = mesh_build(&mesh, &msh, &(struct mesh_options){.unit = 1e-3}, error);
    if (status == STATUS_OK) {
        status = mesh_put(&mesh, &stream, error);
    }
    return status;
}

static enum status try_cloud(struct error *error)
{
    struct cloud_options options = {
        .kind = CLOUD_JITTERED, .dim = 3, .count = {3, 3, 3}, .high = {1, 1, 1}, .jitter = 0.1, .seed = 1};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    return cloud_make(&options, &cloud, error);
}

TEST(files)
{
    for (form = 0; form < FIXTURE_FORMS; form++) {
        fail_each(try_read, 15);
    }
}

TEST(meshes)
{
    fail_each(try_build, 25);
}

TEST(clouds)
{
    gsl_set_error_handler_off(); /* as the tool does */
    fail_each(try_cloud, 8);
}

#endif

RUN_TESTS(NULL, NULL)
