/* The headers of text that are written. */
#include "io/image/text_header.h"

#include <string.h>

/* The first name of the image's type in a format: 0 NRRD, 1 MetaImage. */
static void print_type(FILE *file, const struct image *image, int format)
{
    const char *names = nifti_type(image->datatype)->names[format];
    fwrite(names, 1, strcspn(names, "|"), file);
}

/* A column of to_world, in LPS and mm. */
static void print_vector(FILE *file, const struct image *image, int column)
{
    fprintf(file, " (%.15g,%.15g,%.15g)", 0.0 - 1e3 * image->to_world[0][column],
            0.0 - 1e3 * image->to_world[1][column], 0.0 + 1e3 * image->to_world[2][column]);
}

void nrrd_print(const struct image *image, const char *data_file, FILE *file)
{
    bool several = image->components > 1;
    bool vector = image->intent == IMAGE_INTENT_VECTOR || image->intent == IMAGE_INTENT_DISPLACEMENT;
    const char *kind = image->datatype == IMAGE_RGB24    ? " RGB-color"
                       : image->datatype == IMAGE_RGBA32 ? " RGBA-color"
                       : vector                          ? " vector"
                                                         : " list";
    fprintf(file, "NRRD0004\n# http://teem.sourceforge.net/nrrd/format.html\n");
    if (image->description[0] != '\0') {
        fprintf(file, "content: %s\n", image->description);
    }
    fputs("type: ", file);
    print_type(file, image, 0);
    fprintf(file, "\ndimension: %d\nspace: left-posterior-superior\nsizes:", several ? 4 : 3);
    if (several) {
        fprintf(file, " %zu", image->components);
    }
    fprintf(file, " %zu %zu %zu\nspace directions:%s", image->size[0], image->size[1], image->size[2],
            several ? " none" : "");
    for (int a = 0; a < 3; a++) {
        print_vector(file, image, a);
    }
    fprintf(file, "\nkinds:%s domain domain domain\nendian: little\nencoding: %s\nspace origin:",
            several ? kind : "", data_file != NULL ? "raw" : "gzip");
    print_vector(file, image, 3);
    fprintf(file, "\nspace units: \"mm\" \"mm\" \"mm\"\n");
    image_segments_print(image, file);
    data_file != NULL ? fprintf(file, "data file: %s\n", data_file) : fprintf(file, "\n");
}

void metaimage_print(const struct image *image, const char *data_file, FILE *file)
{
    fprintf(file, "ObjectType = Image\nNDims = 3\n");
    if (image->description[0] != '\0') {
        fprintf(file, "Comment = %s\n", image->description);
    }
    fprintf(file,
            "BinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix =");
    for (int a = 0; a < 3; a++) {
        double step = image_step(image, a);
        fprintf(file, " %.15g %.15g %.15g", 0.0 - image->to_world[0][a] / step,
                0.0 - image->to_world[1][a] / step, 0.0 + image->to_world[2][a] / step);
    }
    fprintf(file, "\nOffset = %.15g %.15g %.15g\nElementSpacing = %.15g %.15g %.15g\nDimSize = %zu %zu %zu\n",
            0.0 - 1e3 * image->to_world[0][3], 0.0 - 1e3 * image->to_world[1][3],
            0.0 + 1e3 * image->to_world[2][3], 1e3 * image_step(image, 0), 1e3 * image_step(image, 1),
            1e3 * image_step(image, 2), image->size[0], image->size[1], image->size[2]);
    if (image->components > 1) {
        fprintf(file, "ElementNumberOfChannels = %zu\n", image->components);
    }
    fputs("ElementType = ", file);
    print_type(file, image, 1);
    fprintf(file, "\nElementDataFile = %s\n", data_file != NULL ? data_file : "LOCAL");
}
