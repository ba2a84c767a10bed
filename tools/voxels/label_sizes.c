#include "voxels/label_image.h"

#include "stages/views.h"

#include <string.h>

bool *label_fine_parse(const struct tool *tool, const struct label_image *image, const char *text,
                       double spacing, double *finest)
{
    bool *fine = NULL;
    SCRATCH char *copy = tool_memory(tool, strdup(text));
    char *names = copy;
    const char *length = strsep(&names, ":");
    TOOL_TRY(tool, parse_length(length, "--fine", LEAST_LENGTH, finest, &error));
    if (*finest >= spacing) {
        tool_fail(tool, STATUS_INPUT, "--fine: %s is not less than the spacing of -h", length);
    }
    if (names != NULL) {
        TOOL_TRY(tool, NEW_ARRAY(&fine, image->labels.count, &error));
    }
    while (names != NULL) {
        const char *name = strsep(&names, ",");
        int64_t label = names_find(&image->table.names, name);
        if (label <= 0) {
            tool_fail(tool, STATUS_INPUT, "--fine: no label '%.60s'", name);
        }
        fine[label] = true;
    }
    return fine;
}

void label_sizes_read(const struct tool *tool, const struct label_image *image, const char *file,
                      struct label_sizes *sizes)
{
    const struct section *section;
    *sizes = (struct label_sizes){0};
    if (file == NULL) {
        return;
    }
    tool_read(tool, file, &sizes->stream);
    TOOL_TRY(tool, stream_cells(&sizes->stream, true, &sizes->cells, &error));
    TOOL_TRY(tool, stream_need(&sizes->stream, "size", TYPE_F8, 1, "sizefield -b", &section, &error));
    if (sizes->cells.dim != image->labels.dim) {
        tool_fail(tool, STATUS_INPUT, "--sizes: cells in %dD, the image is of a body in %dD",
                  sizes->cells.dim, image->labels.dim);
    }
    if (section->rows != sizes->cells.node_count) {
        tool_fail(tool, STATUS_INPUT, "--sizes: size: %jd rows for %jd nodes", section->rows,
                  sizes->cells.node_count);
    }
    sizes->size = section->data;
    TOOL_TRY(tool, fail_in(&error, section_check_numbers(section, POSITIVE, &error), "--sizes"));
}
