/* Fuzz target: images. What is read is consistent in itself, can be sampled, and is written and read back. */
#include "fuzz.h"

#include "io/image/image.h"

#include <math.h>
#include <string.h>

static void require_sound(const struct image *image)
{
    double inverse[3][4], corner[3], place[3];
    REQUIRE(image->values != NULL && image->components >= 1);
    REQUIRE(image->size[0] >= 1 && image->size[1] >= 1 && image->size[2] >= 1);
    REQUIRE(image->unit > 0);
    REQUIRE(isfinite(image->slope) && image->slope != 0 && isfinite(image->inter));
    for (size_t s = 0; s < image->segment_count; s++) {
        REQUIRE(image->components == 1 && image->segment[s].label > 0 && image->segment[s].name[0] != '\0');
    }
    REQUIRE(memchr(image->note, '\n', sizeof image->note) == NULL);
    for (int i = 0; i < 12; i++) {
        REQUIRE(isfinite(image->to_world[i / 4][i % 4]));
    }
    image_to_voxel(image, inverse);
    for (int i = 0; i < 3; i++) {
        corner[i] = (double)(image->size[i] - 1);
    }
    image_world(image, corner, place);
    if (image->components <= 16) {
        double values[16];
        for (int method = 0; method < IMAGE_METHOD_COUNT; method++) {
            REQUIRE(image_sample(image, (enum image_method)method, corner, values));
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct image image, again;
    struct error error = {""};
    int file = file_of_bytes(data, size, NULL);
    if (!is_accepted(image_read_from(&image, file, "image", &error), &error)) {
        REQUIRE(image.values == NULL);
        close(file);
        return 0;
    }
    close(file);
    require_sound(&image);
    for (int format = 0; format < IMAGE_FORMATS; format++) {
        file = file_of_bytes("", 0, NULL);
        FILE *written = fdopen(dup(file), "w");
        REQUIRE(image_write(&image, written, (enum image_format)format, NULL, &error) == STATUS_OK);
        REQUIRE(fclose(written) == 0 && lseek(file, 0, SEEK_SET) == 0);
        /* Places may overflow the numbers of the header; all else is as it was. */
        if (is_accepted(image_read_from(&again, file, "again", &error), &error)) {
            REQUIRE(memcmp(image.size, again.size, sizeof image.size) == 0);
            REQUIRE(image.components == again.components);
            REQUIRE(format > IMAGE_NIFTI || image.datatype == again.datatype);
            REQUIRE(format > IMAGE_NIFTI || image.slope == again.slope || image.version == 1);
            image_free(&again);
        }
        close(file);
    }
    image_free(&image);
    return 0;
}
