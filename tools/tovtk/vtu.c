/* VTK XML files: the format is described in "VTK File Formats" (Kitware), section XML. */
#include "tovtk/plot.h"

#include <inttypes.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values are written as they lie in memory");

/* ---- sections ---- */

/* Copy the name of a column, from attribute cols=, into text[64]; false: it has none. */
static bool column_name(const struct section *section, int64_t column, char text[64])
{
    char names[1024];
    bool named = section_attribute(section, "cols", names, sizeof names);
    char *rest = names, *name = named ? strsep(&rest, ",") : NULL;
    for (; name != NULL && column > 0; column--) {
        name = strsep(&rest, ",");
    }
    return name != NULL && snprintf(text, 64, "%s", name) < 64 && text[0] != '\0';
}

static int64_t find_column(const struct section *section, const char *wanted)
{
    char name[64];
    int64_t column = section->cols - 1;
    while (column >= 0 && !(column_name(section, column, name) && strcmp(name, wanted) == 0)) {
        column--;
    }
    return column;
}

static bool is_floating(const struct section *section)
{
    return section->type == TYPE_F4 || section->type == TYPE_F8;
}

bool vtk_tensor(const struct section *section, int64_t from[6])
{
    static const char *const names[6] = {"xx", "yy", "zz", "xy", "yz", "xz"};
    int64_t found = 0;
    if (!is_floating(section) || (section->cols != 4 && section->cols != 6)) {
        return false;
    }
    for (int k = 0; k < 6; k++) {
        from[k] = find_column(section, names[k]);
        found += from[k] >= 0;
    }
    return found == section->cols && (section->cols == 6 || (from[4] < 0 && from[5] < 0));
}

/* ---- files ---- */

enum { VTK_VERTEX = 1, VTK_TRIANGLE = 5, VTK_TETRA = 10 };

/* An array that is being written, as text or base64. */
struct writer {
    FILE *file;
    bool text;
    unsigned char held[3]; /* bytes not yet encoded */
    int held_count;
};

/* The length of the character of UTF-8 that begins at `text`; 0: none does. */
static int utf8_length(const char *text)
{
    unsigned char c = (unsigned char)text[0], next = (unsigned char)text[1];
    int length = c < 0x80 ? 1 : c < 0xc2 ? 0 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : c < 0xf5 ? 4 : 0;
    for (int i = 1; i < length; i++) {
        length = ((unsigned char)text[i] & 0xc0) == 0x80 ? length : 0;
    }
    bool too_long = (c == 0xe0 && next < 0xa0) || (c == 0xf0 && next < 0x90);
    return too_long || (c == 0xed && next > 0x9f) || (c == 0xf4 && next > 0x8f) ? 0 : length;
}

/* Print a name, which may hold any bytes: those that are not UTF-8 are taken for Latin-1. */
static void print_escaped(FILE *file, const char *text)
{
    for (int length; *text != '\0'; text += length > 0 ? length : 1) {
        unsigned char c = (unsigned char)*text;
        length = utf8_length(text);
        if (length == 0 || strchr("<>&\"'", c) != NULL) {
            fprintf(file, "&#%d;", c);
        } else if (c < 0x20) {
            fputc('?', file);
        } else {
            fwrite(text, 1, (size_t)length, file);
        }
    }
}

static void put_group(struct writer *writer)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const unsigned char *b = writer->held;
    char group[4] = {digits[b[0] >> 2], digits[(b[0] & 3) << 4 | b[1] >> 4],
                     digits[(b[1] & 15) << 2 | b[2] >> 6], digits[b[2] & 63]};
    for (int i = writer->held_count + 1; i < 4; i++) {
        group[i] = '=';
    }
    fwrite(group, 1, 4, writer->file);
    memset(writer->held, 0, 3);
    writer->held_count = 0;
}

static void put_bytes(struct writer *writer, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        writer->held[writer->held_count++] = ((const unsigned char *)bytes)[i];
        if (writer->held_count == 3) {
            put_group(writer);
        }
    }
}

/* Write the start tag of an array; `size`: what `count` numbers. */
static void begin_array(struct writer *writer, const char *type, const char *name, const char *size,
                        int64_t count)
{
    fprintf(writer->file, "<DataArray type=\"%s\" Name=\"", type);
    print_escaped(writer->file, name);
    fprintf(writer->file, "\" %s=\"%" PRId64 "\"", size, count);
}

static void begin_data(struct writer *writer, int64_t count, size_t size)
{
    fprintf(writer->file, " format=\"%s\">\n", writer->text ? "ascii" : "binary");
    if (!writer->text) {
        uint64_t bytes = (uint64_t)count * size;
        put_bytes(writer, &bytes, sizeof bytes);
    }
}

static void end_array(struct writer *writer)
{
    if (writer->held_count > 0) {
        put_group(writer);
    }
    fputs(writer->text ? "</DataArray>\n" : "\n</DataArray>\n", writer->file);
}

/* Write an array of whole numbers, which is 1 in `extent`: value[count], or (NULL) first, first + step, ...
 */
static void put_numbers(struct writer *writer, const char *type, const char *name, const char *extent,
                        int64_t count, const int32_t *value, int64_t first, int64_t step)
{
    size_t size = strcmp(type, "UInt8") == 0 ? 1 : 8;
    begin_array(writer, type, name, extent, 1);
    begin_data(writer, count, size);
    for (int64_t i = 0; i < count; i++) {
        int64_t number = value != NULL ? value[i] : first + i * step;
        if (writer->text) {
            fprintf(writer->file, "%" PRId64 "\n", number);
        } else {
            put_bytes(writer, &number, size);
        }
    }
    end_array(writer);
}

/* The columns written for a section: `count` columns, each a column of the section, or -1: zeros. */
struct layout {
    int64_t count;
    bool is_tensor;
    int64_t tensor[6]; /* columns of a symmetric tensor in VTK's order */
};

static struct layout layout_of(int dim, const struct section *section)
{
    struct layout layout = {.count = section->cols};
    layout.is_tensor = vtk_tensor(section, layout.tensor);
    if (layout.is_tensor) {
        layout.count = 6;
    } else if (is_floating(section) && dim == 2 && section->cols == 2) {
        layout.count = 3;
    }
    return layout;
}

static int64_t layout_column(const struct layout *layout, const struct section *section, int64_t column)
{
    return layout->is_tensor ? layout->tensor[column] : column < section->cols ? column : -1;
}

static void put_rows(struct writer *writer, const struct section *section, const struct layout *layout)
{
    static const char zeros[8];
    size_t size = element_size(section->type);
    begin_data(writer, section->rows * layout->count, size);
    for (int64_t row = 0; row < section->rows; row++) {
        for (int64_t k = 0; k < layout->count; k++) {
            int64_t column = layout_column(layout, section, k);
            int64_t index = row * section->cols + column;
            if (!writer->text) {
                put_bytes(writer, column < 0 ? zeros : (const char *)section->data + (size_t)index * size,
                          size);
                continue;
            }
            fputs(k > 0 ? " " : "", writer->file);
            char number[SECTION_NUMBER] = "0";
            size_t length = column < 0 ? 1 : section_print(section, index, number);
            fwrite(number, 1, length, writer->file);
        }
        fputs(writer->text ? "\n" : "", writer->file);
    }
    end_array(writer);
}

static void put_field(struct writer *writer, int dim, const struct plot_field *field)
{
    static const char *const types[] = {"Int32", "Int64", "Float32", "Float64"};
    static const char *const added[] = {"", "", "z", "", "yz", "xz"}; /* names of columns of zeros */
    struct layout layout = layout_of(dim, field->section);
    char name[64];
    begin_array(writer, types[field->section->type], field->name, "NumberOfComponents", layout.count);
    bool is_named = layout.count > 1 && column_name(field->section, 0, name);
    for (int64_t k = 0; is_named && k < layout.count; k++) {
        int64_t column = layout_column(&layout, field->section, k);
        if (column < 0) {
            fprintf(writer->file, " ComponentName%" PRId64 "=\"%s\"", k, added[k]);
        } else if (column_name(field->section, column, name)) {
            fprintf(writer->file, " ComponentName%" PRId64 "=\"", k);
            print_escaped(writer->file, name);
            fputc('"', writer->file);
        }
    }
    put_rows(writer, field->section, &layout);
}

/* Write the regions as arrays by name with their index in cells.region, as readers other than VTK do not
 * support arrays of strings. */
static void put_regions(struct writer *writer, const struct names *regions)
{
    char label[300];
    fputs(regions->count == 0 ? "" : "<FieldData>\n", writer->file);
    for (int64_t i = 0; i < regions->count; i++) {
        snprintf(label, sizeof label, "region.%s", regions->name[i]);
        put_numbers(writer, "Int64", label, "NumberOfTuples", 1, NULL, i, 0);
    }
    fputs(regions->count == 0 ? "" : "</FieldData>\n", writer->file);
}

static void put_cells(struct writer *writer, const struct cells *cells, int64_t count)
{
    int corners = cells->count > 0 ? cells->dim + 1 : 1;
    int type = cells->count == 0 ? VTK_VERTEX : cells->dim == 2 ? VTK_TRIANGLE : VTK_TETRA;
    static const char one[] = "NumberOfComponents";
    fputs("<Cells>\n", writer->file);
    put_numbers(writer, "Int64", "connectivity", one, count * corners, cells->count > 0 ? cells->node : NULL,
                0, 1);
    put_numbers(writer, "Int64", "offsets", one, count, NULL, corners, corners);
    put_numbers(writer, "UInt8", "types", one, count, NULL, type, 0);
    fputs("</Cells>\n", writer->file);
}

static void put_fields(struct writer *writer, const struct plot *plot, bool of_cells)
{
    const char *tag = of_cells ? "CellData" : "PointData";
    fprintf(writer->file, "<%s>\n", tag);
    for (int64_t f = 0; f < plot->field_count; f++) {
        if (plot->fields[f].of_cells == of_cells) {
            put_field(writer, plot->cells.dim, &plot->fields[f]);
        }
    }
    fprintf(writer->file, "</%s>\n", tag);
}

void vtu_write(FILE *file, const struct plot *plot, bool text)
{
    struct writer writer = {.file = file, .text = text};
    const struct cells *cells = &plot->cells;
    int64_t count = cells->count > 0 ? cells->count : cells->node_count;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
          "byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\">\n<UnstructuredGrid>\n",
          file);
    put_regions(&writer, &plot->regions.names);
    fprintf(file, "<Piece NumberOfPoints=\"%" PRId64 "\" NumberOfCells=\"%" PRId64 "\">\n<Points>\n",
            cells->node_count, count);
    begin_array(&writer, "Float64", "Points", "NumberOfComponents", 3);
    put_rows(&writer, stream_find(&plot->stream, "nodes.x"), &(struct layout){.count = 3});
    fputs("</Points>\n", file);
    put_cells(&writer, cells, count);
    put_fields(&writer, plot, false);
    put_fields(&writer, plot, true);
    fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
}

void pvd_write(FILE *file, int64_t count, char *const names[], const double *times)
{
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n", file);
    for (int64_t i = 0; i < count; i++) {
        fprintf(file, "<DataSet timestep=\"%.17g\" part=\"0\" file=\"", times[i]);
        print_escaped(file, names[i]);
        fputs("\"/>\n", file);
    }
    fputs("</Collection>\n</VTKFile>\n", file);
}
