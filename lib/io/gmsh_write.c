/* MSH 2.2 with node and element data: the format is described in gmsh's reference manual, "Legacy formats".
 */
#include "io/vtk.h"

#include "io/vtk_field.h"

#include <inttypes.h>

enum { GMSH_TRIANGLE = 2, GMSH_TETRAHEDRON = 4, GMSH_POINT = 15 };

static void print_quoted(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text != '\0'; text++) {
        fputc(*text == '"' ? '\'' : *text, file);
    }
    fputc('"', file);
}

static void write_names(FILE *file, const struct vtk_mesh *mesh)
{
    char name[256];
    int64_t count = 0;
    while (vtk_list_item(mesh->region_names, count, name, sizeof name)) {
        count++;
    }
    if (mesh->region == NULL || count == 0) {
        return;
    }
    fprintf(file, "$PhysicalNames\n%" PRId64 "\n", count);
    for (int64_t i = 0; vtk_list_item(mesh->region_names, i, name, sizeof name); i++) {
        fprintf(file, "%d %" PRId64 " ", mesh->dim, i + 1);
        print_quoted(file, name);
        fputc('\n', file);
    }
    fputs("$EndPhysicalNames\n", file);
}

static void write_nodes(FILE *file, const struct vtk_mesh *mesh)
{
    fprintf(file, "$Nodes\n%" PRId64 "\n", mesh->node_count);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        const double *x = mesh->x + n * mesh->dim;
        fprintf(file, "%" PRId64 " %.17g %.17g %.17g\n", n + 1, x[0], x[1], mesh->dim == 3 ? x[2] : 0);
    }
    fputs("$EndNodes\n", file);
}

/* The tags of an element: its physical group, and its entity, both the region counted from 1. */
static void write_elements(FILE *file, const struct vtk_mesh *mesh)
{
    int corners = mesh->node != NULL ? mesh->dim + 1 : 1;
    int64_t count = mesh->node != NULL ? mesh->cell_count : mesh->node_count;
    int type = mesh->node == NULL ? GMSH_POINT : mesh->dim == 2 ? GMSH_TRIANGLE : GMSH_TETRAHEDRON;
    fprintf(file, "$Elements\n%" PRId64 "\n", count);
    for (int64_t c = 0; c < count; c++) {
        int64_t group = mesh->region != NULL ? (int64_t)mesh->region[c] + 1 : 1;
        fprintf(file, "%" PRId64 " %d 2 %" PRId64 " %" PRId64, c + 1, type, group, group);
        for (int i = 0; i < corners; i++) {
            fprintf(file, " %" PRId64, (mesh->node != NULL ? mesh->node[c * corners + i] : c) + 1);
        }
        fputc('\n', file);
    }
    fputs("$EndElements\n", file);
}

enum status gmsh_write_mesh(FILE *file, const struct vtk_mesh *mesh, struct error *error)
{
    fputs("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", file);
    write_names(file, mesh);
    write_nodes(file, mesh);
    write_elements(file, mesh);
    return vtk_check_written(file, error);
}

/* Columns [first, first + columns) of a field as one view. */
static void write_view(FILE *file, const char *name, const struct vtk_field *field, int64_t first,
                       int64_t columns, int64_t step, double time)
{
    const struct section *section = field->section;
    const char *tag = field->of_cells ? "ElementData" : "NodeData";
    fprintf(file, "$%s\n1\n", tag);
    print_quoted(file, name);
    fprintf(file, "\n1\n%.17g\n3\n%" PRId64 "\n%" PRId64 "\n%" PRId64 "\n", time, step, columns,
            section->rows);
    for (int64_t row = 0; row < section->rows; row++) {
        fprintf(file, "%" PRId64, row + 1);
        for (int64_t column = first; column < first + columns; column++) {
            fputc(' ', file);
            if (column < section->cols) {
                vtk_print_element(file, section, row * section->cols + column);
            } else {
                fputc('0', file);
            }
        }
        fputc('\n', file);
    }
    fprintf(file, "$End%s\n", tag);
}

enum status gmsh_write_field(FILE *file, const struct vtk_mesh *mesh, const struct vtk_field *field,
                             int64_t step, double time, struct error *error)
{
    int64_t columns = field->section->cols;
    bool is_vector = columns == mesh->dim && (columns == 3 || vtk_is_floating(field->section));
    if (columns == 1 || is_vector || columns == 9) {
        write_view(file, field->name, field, 0, is_vector ? 3 : columns, step, time);
        return vtk_check_written(file, error);
    }
    for (int64_t column = 0; column < columns; column++) {
        char name[256];
        char label[64];
        if (!vtk_column_name(field->section, column, label, sizeof label)) {
            snprintf(label, sizeof label, "%" PRId64, column + 1);
        }
        snprintf(name, sizeof name, "%s %s", field->name, label);
        write_view(file, name, field, column, 1, step, time);
    }
    return vtk_check_written(file, error);
}
