/* Fault 25 for images and the motion of bodies: whichever allocation fails, it is reported and nothing is
 * left allocated. */
#include "approx/points/cloud.h"
#include "approx/field/motion.h"
#include "image_fixture.h"
#include "io/image/image.h"

#include <sys/mman.h>
#include <unistd.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

static struct nifti_file file;

/* A vector image is read and written, compressed. */
static enum status read_and_write(struct error *error)
{
    FREED_BY(image_free) struct image image = {0};
    int in = memfd_create("in", 0), out = memfd_create("out", 0);
    assert_int_equal(write(in, file.bytes, file.size), file.size);
    assert_int_equal(lseek(in, 0, SEEK_SET), 0);
    enum status status = image_read_from(&image, in, "file", error);
    if (status == STATUS_OK) {
        status = image_write(&image, out, true, error);
    }
    close(in);
    close(out);
    return status;
}

TEST(images)
{
    begin_nifti(&file, 1, false, 4, 3, 2, 16, 32);
    put_dim(&file, 0, 5);
    put_dim(&file, 5, 3);
    file.size += 4 * 3 * 2 * 3 * 4;
    fail_each(read_and_write, 6);
}

static struct cells cells;
static double *u;

static enum status move(struct error *error)
{
    FREED_BY(motion_free) struct motion motion = {0};
    return motion_build(&cells, u, false, NULL, &motion, error);
}

TEST(motions)
{
    struct cloud_options options = {.kind = CLOUD_REGULAR, .dim = 3, .count = {4, 4, 4}, .high = {3, 3, 3}};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    static double none[4 * 4 * 4 * 3];
    GOOD(cloud_make(&options, &cloud, &error));
    cells = (struct cells){3, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    u = none;
    fail_each(move, 10);
}

#endif

RUN_TESTS(one_thread, NULL)
