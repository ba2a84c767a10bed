#include "io/files/landmarks.h"

#include "base/options.h"
#include "io/files/textfile.h"

#include <float.h>
#include <string.h>

static const size_t size_limit = (size_t)1 << 28;

bool landmarks_named(const char *path)
{
    return text_ends(path, ".mrk.json") || text_ends(path, ".fcsv");
}

/* ---- fcsv ---- */

/* A file that is being read. */
struct landmarks {
    struct table *table;
    double sign; /* of x and y, to RAS */
    char *empty; /* label */
};

enum { COLUMNS = 32 };

/* Take a field of a line, which *rest moves behind, NULL at the end; quotes may stand around it, two within
 * for one. */
static char *take_field(char **rest)
{
    char *field = *rest + (**rest == '"'), *to = field, *at = field;
    if (at == *rest) {
        return strsep(rest, ",");
    }
    while (*at != '\0' && (*at != '"' || *++at == '"')) {
        *to++ = *at++;
    }
    *rest = strchr(at, ',');
    *rest += *rest != NULL;
    *to = '\0';
    return field;
}

static int split(char *line, char *field[COLUMNS])
{
    int count = 0;
    for (char *rest = line; rest != NULL && count < COLUMNS; count++) {
        field[count] = take_field(&rest);
    }
    return count;
}

static const char *const column_names[4] = {"x", "y", "z", "label"};

/* Take what a comment tells of axes and columns. */
static enum status read_comment(struct landmarks *landmarks, char *line, int column[4], struct error *error)
{
    char *equals = strchr(line, '='), *field[COLUMNS];
    if (equals == NULL) {
        return STATUS_OK;
    }
    char *value = equals + 1 + strspn(equals + 1, " ");
    if (strncmp(line, "# CoordinateSystem", 18) == 0) {
        bool ras = strcmp(value, "RAS") == 0 || strcmp(value, "0") == 0;
        landmarks->sign = ras ? 1 : -1;
        return ras || strcmp(value, "LPS") == 0 || strcmp(value, "1") == 0
                   ? STATUS_OK
                   : fail(error, STATUS_INPUT, "CoordinateSystem is neither RAS nor LPS");
    }
    if (strncmp(line, "# columns", 9) == 0) {
        int count = split(value, field);
        for (int c = 0; c < 4; c++) {
            column[c] = -1;
            for (int f = 0; f < count; f++) {
                column[c] = strcmp(field[f], column_names[c]) == 0 ? f : column[c];
            }
        }
    }
    return STATUS_OK;
}

static enum status read_line(struct landmarks *landmarks, char *line, int64_t number, int column[4],
                             struct error *error)
{
    char *field[COLUMNS];
    double x[3];
    if (line[0] == '#') {
        return read_comment(landmarks, line, column, error);
    }
    int count = line[0] == '\0' ? 0 : split(line, field);
    for (int c = 0; c < 3 && count > 0; c++) {
        if (column[c] < 0 || column[c] >= count) {
            return fail(error, STATUS_INPUT, "no column %s", column_names[c]);
        }
        RETURN_IF_ERROR(parse_double(field[column[c]], column_names[c], -DBL_MAX, DBL_MAX, &x[c], error));
        x[c] *= c < 2 ? landmarks->sign : 1;
    }
    char *label = column[3] >= 0 && column[3] < count ? field[column[3]] : landmarks->empty;
    return count == 0 ? STATUS_OK : table_append(landmarks->table, x, number, label, error);
}

static enum status read_fcsv(struct landmarks *landmarks, char *text, struct error *error)
{
    int column[4] = {1, 2, 3, 11};
    int64_t number = 1;
    landmarks->sign = 1;
    for (char *rest = text; *rest != '\0'; number++) {
        char *line = strsep(&rest, "\n");
        if (rest == NULL) {
            return fail(error, STATUS_INPUT, "%jd: last line without newline: truncated?", number);
        }
        line[strcspn(line, "\r")] = '\0';
        RETURN_IF_ERROR(fail_in(error, read_line(landmarks, line, number, column, error), "%jd", number));
    }
    return STATUS_OK;
}

enum status landmarks_read(const char *path, struct table *table, struct error *error)
{
    struct textfile file;
    struct landmarks landmarks = {.table = table};
    enum status status = bytefile_read(path, size_limit, &file, error);
    table->text = file.text;
    RETURN_IF_ERROR(status);
    landmarks.empty = file.text + file.size;
    table->cols = 3;
    if (strlen(file.text) != file.size) {
        return fail(error, STATUS_INPUT, "%s: a byte of value 0: not a text", path);
    }
    status = text_ends(path, ".fcsv") ? read_fcsv(&landmarks, file.text, error)
                                      : markups_read(file.text, landmarks.empty, table, error);
    if (status == STATUS_INPUT) {
        struct error why = *error; /* begins with the line */
        return fail(error, status, "%s:%s", path, why.text);
    }
    RETURN_IF_ERROR(fail_in(error, status, "%s", path));
    return table->rows > 0 ? STATUS_OK : fail(error, STATUS_INPUT, "%s: holds no point", path);
}

/* ---- writing ---- */

/* Print a label as it was read: with what must be escaped, and '?' for control characters. */
static void print_label(FILE *file, const char *label, int64_t row, bool json)
{
    if (label == NULL || label[0] == '\0') {
        fprintf(file, "F-%jd", row + 1);
        return;
    }
    for (; *label != '\0'; label++) {
        if (*label == '"' || (json && *label == '\\')) {
            fputc(json ? '\\' : '"', file);
        }
        fputc((unsigned char)*label < ' ' ? '?' : *label, file);
    }
}

void landmarks_print(FILE *file, const char *path, int64_t count, const double *x, const int64_t *of,
                     char *const *label)
{
    bool json = !text_ends(path, ".fcsv");
    fputs(json ? "{\"@schema\": \"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/"
                 "Markups/Resources/Schema/markups-schema-v1.0.3.json#\",\n \"markups\": [{\"type\": "
                 "\"Fiducial\", \"coordinateSystem\": \"LPS\", \"coordinateUnits\": \"mm\",\n"
                 "  \"controlPoints\": ["
               : "# Markups fiducial file version = 4.11\n# CoordinateSystem = 0\n"
                 "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n",
          file);
    for (int64_t i = 0; i < count; i++) {
        int64_t row = of != NULL ? of[i] : i;
        const char *name = label != NULL ? label[row] : NULL;
        double sign = json ? -1e3 : 1e3; /* .fcsv in RAS: not all programs read another system there */
        const double mm[3] = {sign * x[3 * i] + 0.0, sign * x[3 * i + 1] + 0.0, 1e3 * x[3 * i + 2] + 0.0};
        if (json) {
            fprintf(file, "%s\n   {\"id\": \"%jd\", \"label\": \"", i > 0 ? "," : "", i + 1);
            print_label(file, name, row, true);
            fprintf(file, "\", \"position\": [%.15g, %.15g, %.15g], \"positionStatus\": \"defined\"}", mm[0],
                    mm[1], mm[2]);
        } else {
            fprintf(file, "%jd,%.15g,%.15g,%.15g,0,0,0,1,1,1,0,\"", i + 1, mm[0], mm[1], mm[2]);
            print_label(file, name, row, false);
            fputs("\",,\n", file);
        }
    }
    fputs(json ? "\n  ]}]}\n" : "", file);
}
