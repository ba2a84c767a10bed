#include "io/vtk_field.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

bool vtk_list_item(const char *list, int64_t index, char *text, size_t size)
{
    for (; index > 0; index--) {
        list = strchr(list, ',');
        if (list == NULL) {
            return false;
        }
        list++;
    }
    size_t length = strcspn(list, ",");
    if (length == 0 || length >= size) {
        return false;
    }
    memcpy(text, list, length);
    text[length] = '\0';
    return true;
}

bool vtk_column_name(const struct section *section, int64_t column, char *text, size_t size)
{
    char names[1024];
    return section_attribute(section, "cols", names, sizeof names) &&
           vtk_list_item(names, column, text, size);
}

/* The column of that name, or -1. */
static int64_t find_column(const struct section *section, const char *wanted)
{
    char name[64];
    for (int64_t column = 0; column < section->cols; column++) {
        if (vtk_column_name(section, column, name, sizeof name) && strcmp(name, wanted) == 0) {
            return column;
        }
    }
    return -1;
}

bool vtk_tensor(const struct section *section, int64_t from[6])
{
    static const char *const names[6] = {"xx", "yy", "zz", "xy", "yz", "xz"};
    int64_t found = 0;
    if (!vtk_is_floating(section) || (section->cols != 4 && section->cols != 6)) {
        return false;
    }
    for (int k = 0; k < 6; k++) {
        from[k] = find_column(section, names[k]);
        found += from[k] >= 0;
    }
    return found == section->cols && (section->cols == 6 || (from[4] < 0 && from[5] < 0));
}

bool vtk_is_floating(const struct section *section)
{
    return section->type == TYPE_F4 || section->type == TYPE_F8;
}

void vtk_print_element(FILE *file, const struct section *section, int64_t index)
{
    switch (section->type) {
    case TYPE_I4:
        fprintf(file, "%" PRId32, ((const int32_t *)section->data)[index]);
        break;
    case TYPE_I8:
        fprintf(file, "%" PRId64, ((const int64_t *)section->data)[index]);
        break;
    case TYPE_F4:
        fprintf(file, "%.9g", (double)((const float *)section->data)[index]);
        break;
    case TYPE_F8:
        fprintf(file, "%.17g", ((const double *)section->data)[index]);
        break;
    }
}

enum status vtk_check_written(FILE *file, struct error *error)
{
    errno = 0;
    if (fflush(file) == 0 && ferror(file) == 0) {
        return STATUS_OK;
    }
    return fail(error, STATUS_SYSTEM, "cannot write: %s", errno != 0 ? strerror(errno) : "write error");
}
