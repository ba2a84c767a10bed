/* What the writers of vtk.h share. Inside of lib/io only. */
#ifndef IO_VTK_FIELD_H
#define IO_VTK_FIELD_H

#include "io/vtk.h"

/* Copy the name of a column, from attribute cols=, into text[size]; false when it has none. */
bool vtk_column_name(const struct section *section, int64_t column, char *text, size_t size);

/* Copy item `index` of a comma list into text[size]; false when there is none. */
bool vtk_list_item(const char *list, int64_t index, char *text, size_t size);

/* Whether the values are floating-point numbers. */
bool vtk_is_floating(const struct section *section);

/* Print an element of a section so that it reads back exactly. */
void vtk_print_element(FILE *file, const struct section *section, int64_t index);

/* Flush; the status of all that was written to the file. */
MUST_CHECK enum status vtk_check_written(FILE *file, struct error *error);

#endif
