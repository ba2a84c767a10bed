/* filled VOXEL LABEL SURFACE [LABEL SURFACE]...: a label image of closed surfaces, as NIfTI on standard
 * output, with voxels of VOXEL mm. A voxel has the LABEL of the last SURFACE that its centre is in. A SURFACE
 * is a table of triangles in mm, rows of nine numbers, or STL. The image holds the first of them. */
#include "base/memory.h"
#include "io/image/image.h"
#include "io/files/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MARGIN = 4 };

static enum status new_image(const struct table *surface, double voxel, struct image *image,
                             struct error *error)
{
    size_t size[3];
    double first[3];
    for (int d = 0; d < 3; d++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t v = d; v < surface->rows * 9; v += 3) {
            low = fmin(low, surface->values[v]);
            high = fmax(high, surface->values[v]);
        }
        first[d] = voxel * (floor(low / voxel) - MARGIN);
        size[d] = (size_t)ceil((high - first[d]) / voxel) + MARGIN + 1;
    }
    RETURN_IF_ERROR(image_new(image, size, 1, error));
    for (int d = 0; d < 3; d++) {
        for (int axis = 0; axis < 3; axis++) {
            image->to_world[d][axis] = axis == d ? 1e-3 * voxel : 0.0;
        }
        image->to_world[d][3] = 1e-3 * first[d];
    }
    image->datatype = IMAGE_UINT8;
    image->space = IMAGE_SPACE_SCANNER;
    return STATUS_OK;
}

/* Where a surface crosses a row of voxels along i, voxels. */
struct crossing {
    size_t row;
    double at;
};

static int ascending(const void *a, const void *b)
{
    const struct crossing *one = a, *other = b;
    int order = (one->row > other->row) - (one->row < other->row);
    return order != 0 ? order : (one->at > other->at) - (one->at < other->at);
}

/* Twice the area, across the rows, of the triangle of a, b and the row through (j, k). */
static double area(const double a[3], const double b[3], double j, double k)
{
    return (b[1] - a[1]) * (k - a[2]) - (b[2] - a[2]) * (j - a[1]);
}

/* Append where a triangle, x[9] in voxels, crosses rows; to none where crossing is NULL. Returns the count.
 */
static size_t cross(const struct image *image, const double x[9], struct crossing *crossing)
{
    size_t low[3], high[3], count = 0;
    for (int d = 1; d < 3; d++) {
        double last = (double)image->size[d] - 1;
        low[d] = (size_t)fmin(fmax(0, fmin(fmin(x[d], x[d + 3]), x[d + 6])), last);
        high[d] = (size_t)fmin(fmax(0, fmax(fmax(x[d], x[d + 3]), x[d + 6]) + 1), last);
    }
    for (size_t k = low[2]; k <= high[2]; k++) {
        for (size_t j = low[1]; j <= high[1]; j++) {
            /* Beside the voxel's centre, where no corner of a surface is likely to be. */
            double v = (double)j + 1.234567e-6, w = (double)k + 2.345678e-6;
            double a = area(x + 3, x + 6, v, w), b = area(x + 6, x, v, w), c = area(x, x + 3, v, w);
            bool within = (a > 0) == (b > 0) && (b > 0) == (c > 0) && a + b + c != 0;
            if (within && crossing != NULL) {
                double at = (a * x[0] + b * x[3] + c * x[6]) / (a + b + c);
                crossing[count] = (struct crossing){k * image->size[1] + j, at};
            }
            count += within;
        }
    }
    return count;
}

/* Voxels between odd and even crossings of their row are within. */
static enum status fill(struct image *image, double label, const struct table *surface, struct error *error)
{
    double *x = surface->values, voxel = 1e3 * image->to_world[0][0];
    size_t count = 0, room = 0;
    for (int64_t v = 0; v < surface->rows * 9; v++) {
        x[v] = (x[v] - 1e3 * image->to_world[v % 3][3]) / voxel;
    }
    for (int64_t t = 0; t < surface->rows; t++) {
        room += cross(image, x + 9 * t, NULL);
    }
    NEW_SCRATCH(struct crossing, crossing, (int64_t)room, error);
    for (int64_t t = 0; t < surface->rows; t++) {
        count += cross(image, x + 9 * t, crossing + count);
    }
    qsort(crossing, count, sizeof *crossing, ascending);
    for (size_t c = 0; c < count; c += 2) {
        size_t row = crossing[c].row;
        if (c + 1 == count || crossing[c + 1].row != row) {
            return fail(error, STATUS_INPUT, "the surface is not closed");
        }
        for (size_t i = (size_t)fmax(0, ceil(crossing[c].at));
             i < image->size[0] && (double)i <= crossing[c + 1].at; i++) {
            image->values[row * image->size[0] + i] = label;
        }
    }
    return STATUS_OK;
}

int main(int argc, char *argv[])
{
    struct image image = {0};
    struct error error = {0};
    enum status status = STATUS_OK;
    if (argc < 4 || argc % 2 != 0) {
        fprintf(stderr, "filled: VOXEL LABEL SURFACE [LABEL SURFACE]...\n");
        return STATUS_INPUT;
    }
    for (int i = 2; i < argc && status == STATUS_OK; i += 2) {
        struct table surface = {0};
        status = surface_read(argv[i + 1], 3, &surface, &error);
        if (status == STATUS_OK && i == 2) {
            status = new_image(&surface, atof(argv[1]), &image, &error);
        }
        if (status == STATUS_OK) {
            status = fail_in(&error, fill(&image, atof(argv[i]), &surface, &error), "%s", argv[i + 1]);
        }
        table_free(&surface);
    }
    if (status == STATUS_OK) {
        status = image_write(&image, stdout, IMAGE_NIFTI_GZIP, NULL, &error);
    }
    if (status != STATUS_OK) {
        fprintf(stderr, "filled: %s\n", error.text);
    }
    image_free(&image);
    return (int)status;
}
