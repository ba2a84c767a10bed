/* phantom SHAPE [SEED [VOXEL]]: a label image of a shape of label_shapes.h with voxels of VOXEL mm (I or
 * I,J,K), as NIfTI on standard output. SHAPE@flipped: the same body, its voxels in the order k, i, j, the
 * first axis backwards; SHAPE@metres: numbers of mm in a file that says metres; SHAPE@slice: the slice next
 * to z = 0 alone; SHAPE@scan: values that are no labels; SHAPE@empty: no label; SHAPE@rgb: three values at a
 * voxel. */
#include "../unit/label_shapes.h"
#include "io/image/image.h"

#include <stdio.h>
#include <unistd.h>

static int fill(struct image *image, const struct label_shape *shape, const char *variant)
{
    struct error error;
    bool flipped = strcmp(variant, "flipped") == 0, slice = strcmp(variant, "slice") == 0;
    size_t size[3];
    for (int d = 0; d < 3; d++) {
        size[d] = (size_t)shape->size[flipped ? (d + 2) % 3 : d];
    }
    size[2] = slice ? 1 : size[2];
    if (image_new(image, size, strcmp(variant, "rgb") == 0 ? 3 : 1, &error) != STATUS_OK) {
        return 3;
    }
    image->datatype = strcmp(variant, "scan") == 0 ? IMAGE_FLOAT32 : IMAGE_INT16;
    image->datatype = strcmp(variant, "rgb") == 0 ? IMAGE_RGB24 : image->datatype;
    image->space = IMAGE_SPACE_SCANNER;
    image->unit = strcmp(variant, "metres") == 0 ? 1 : 1e-3;
    for (int d = 0; d < 3; d++) {
        int axis = flipped ? (d + 1) % 3 : d;
        bool backwards = flipped && axis == 0;
        double voxel = 1e-3 * shape->voxel[d], first = 1e-3 * shape->first[d];
        memset(image->to_world[d], 0, sizeof image->to_world[d]);
        image->to_world[d][axis] = backwards ? -voxel : voxel;
        image->to_world[d][3] = first + (backwards ? voxel * (double)(shape->size[d] - 1) : 0);
    }
    int64_t skipped = slice ? shape->size[2] / 2 : 0;
    image->to_world[2][3] += slice ? 1e-3 * shape->voxel[2] * (double)skipped : 0;
    for (size_t v = 0; v < image_voxels(image); v++) {
        const size_t at[3] = {v % size[0], v / size[0] % size[1], v / size[0] / size[1]};
        int64_t i = (int64_t)at[flipped ? 1 : 0], j = (int64_t)at[flipped ? 2 : 1];
        int64_t k = flipped ? (int64_t)(size[0] - 1 - at[0]) : (int64_t)at[2] + skipped;
        double label = shape->label[(k * shape->size[1] + j) * shape->size[0] + i];
        label *= strcmp(variant, "empty") == 0 ? 0 : strcmp(variant, "scan") == 0 ? 0.37 : 1;
        for (size_t c = 0; c < image->components; c++) {
            image->values[v * image->components + c] = label;
        }
    }
    for (int d = 0; d < 12 && strcmp(variant, "metres") == 0; d++) {
        image->to_world[d / 4][d % 4] *= 1e3;
    }
    return 0;
}

int main(int argc, char *argv[])
{
    struct label_shape shape;
    struct image image;
    struct error error;
    double voxel[3] = {1, 1, 1};
    char name[64] = "";
    const char *variant = argc > 1 ? strchr(argv[1], '@') : NULL;
    if (argc > 1) {
        snprintf(name, sizeof name, "%.*s", variant != NULL ? (int)(variant - argv[1]) : 63, argv[1]);
    }
    if (argc > 3 && sscanf(argv[3], "%lf,%lf,%lf", &voxel[0], &voxel[1], &voxel[2]) == 1) {
        voxel[1] = voxel[2] = voxel[0];
    }
    if (!label_shape_make(name, argc > 2 ? strtoull(argv[2], NULL, 10) : 1, voxel, &shape)) {
        fprintf(stderr, "phantom: no shape '%s'\n", name);
        return 2;
    }
    int status = fill(&image, &shape, variant != NULL ? variant + 1 : "");
    if (status == 0) {
        status = (int)image_write(&image, stdout, IMAGE_NIFTI_GZIP, NULL, &error);
    }
    image_free(&image);
    free(shape.label);
    return status;
}
