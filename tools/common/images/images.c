#include "images/images.h"

#include "io/files/descriptor.h"
#include "output.h"

#include <string.h>
#include <unistd.h>

void tool_read_image(const struct tool *tool, const char *file, struct image *image)
{
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, file, &name);
    TOOL_TRY(tool, image_read_from(image, descriptor, name, &error));
    if (image->note[0] != '\0') {
        tool_note(tool, "%s: %s", name, image->note);
    }
}

enum image_method tool_image_method(const struct tool *tool)
{
    return (enum image_method)tool_choice(tool, "interpolation", image_method_names, IMAGE_METHOD_COUNT,
                                          IMAGE_LINEAR);
}

/* The format that the end of a file's name asks for, or `other`. */
static int format_of(const char *name, int other)
{
    static const char *const ends[IMAGE_FORMATS] = {[IMAGE_NIFTI_GZIP] = ".nii.gz",
                                                    [IMAGE_NIFTI] = ".nii",
                                                    [IMAGE_NRRD] = ".nrrd",
                                                    [IMAGE_METAIMAGE] = ".mha"};
    for (int f = 0; f < IMAGE_FORMATS; f++) {
        if (text_ends(name, ends[f])) {
            return f;
        }
    }
    return text_ends(name, ".nhdr") ? IMAGE_NRRD : text_ends(name, ".mhd") ? IMAGE_METAIMAGE : other;
}

/* The file of the values of an image written as NAME.nhdr or NAME.mhd, NAME.raw; NULL: it is one file. */
static char *data_file(const struct tool *tool)
{
    const char *name = tool->output;
    int end = name == NULL ? 0 : text_ends(name, ".nhdr") ? 5 : text_ends(name, ".mhd") ? 4 : 0;
    return end > 0 ? tool_text(tool, "%.*s.raw", (int)strlen(name) - end, name) : NULL;
}

static const char *within_folder(const char *path)
{
    return strrchr(path, '/') != NULL ? strrchr(path, '/') + 1 : path;
}

/* A header names its data in the rest of a line, without patterns; data of another header are not replaced.
 */
static void check_data_file(const struct tool *tool)
{
    SCRATCH char *data = data_file(tool);
    const char *within = data != NULL ? within_folder(data) : "";
    if (strpbrk(within, "%\n\r") != NULL || within[0] == ' ' || within[0] == '\t' ||
        strncmp(within, "LIST", 4) == 0) {
        tool_fail(tool, STATUS_INPUT, "-o %s: a header cannot name data of such a name", tool->output);
    }
    if (data != NULL && access(data, F_OK) == 0 && access(tool->output, F_OK) != 0) {
        tool_fail(tool, STATUS_INPUT, "-o %s: replaces %s, which may be of another image: name another file",
                  tool->output, data);
    }
}

void tool_check_image_output(const struct tool *tool)
{
    if (tool->output == NULL && isatty(STDOUT_FILENO)) {
        tool_fail(tool, STATUS_INPUT, "no image to a terminal: redirect it, or name a file with -o");
    }
    const char *name = tool->output;
    if (name != NULL && format_of(name, IMAGE_FORMATS) == IMAGE_FORMATS && strchr(name, '.') != NULL &&
        strncmp(name, "/dev/", 5) != 0) {
        tool_fail(tool, STATUS_INPUT,
                  "-o %s: images are written as .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd", name);
    }
    check_data_file(tool);
}

static enum status write_image(const struct tool *tool, const struct image *image, const char *data,
                               struct error *error)
{
    int format = tool->output != NULL ? format_of(tool->output, (int)image->format) : (int)image->format;
    struct output output;
    if (data != NULL) { /* before the header, without which they are no image */
        RETURN_IF_ERROR(output_open(&output, data, false, error));
        RETURN_IF_ERROR(output_end(&output, image_write_data(image, output.file, error), error));
    }
    RETURN_IF_ERROR(output_open(&output, tool->output, false, error));
    return output_end(&output,
                      image_write(image, output.file, (enum image_format)format,
                                  data != NULL ? within_folder(data) : NULL, error),
                      error);
}

void tool_write_image(const struct tool *tool, const struct image *image)
{
    SCRATCH char *data = data_file(tool);
    TOOL_TRY(tool, write_image(tool, image, data, &error));
}

const char *image_text(const struct image *image, char text[128])
{
    snprintf(text, 128, "%zu x %zu x %zu voxels of %.4g x %.4g x %.4g mm", image->size[0], image->size[1],
             image->size[2], 1e3 * image_step(image, 0), 1e3 * image_step(image, 1),
             1e3 * image_step(image, 2));
    return text;
}
