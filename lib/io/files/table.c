#include "io/files/table.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/files/landmarks.h"
#include "io/files/textfile.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

static const size_t size_limit = (size_t)1 << 31;
enum { COLUMN_LIMIT = 64 };

enum status table_append(struct table *table, const double *row, int64_t line, char *label,
                         struct error *error)
{
    if (table->rows == table->room) {
        int64_t more = table->room > 0 ? 2 * table->room : 64;
        RETURN_IF_ERROR(RESIZE_ARRAY(&table->values, more * table->cols, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&table->line, more, error));
        RETURN_IF_ERROR(label != NULL ? RESIZE_ARRAY(&table->label, more, error) : STATUS_OK);
        table->room = more;
    }
    if (label != NULL) {
        table->label[table->rows] = label;
    }
    memcpy(table->values + table->rows * table->cols, row, (size_t)table->cols * sizeof *row);
    table->line[table->rows++] = line;
    return STATUS_OK;
}

enum status table_end_block(struct table *table, struct error *error)
{
    int64_t last = table->block_count > 0 ? table->block_ptr[table->block_count] : 0;
    if (last == table->rows) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&table->block_ptr, table->block_count + 2, error));
    table->block_ptr[0] = 0;
    table->block_ptr[++table->block_count] = table->rows;
    return STATUS_OK;
}

/* The admissible tables: number of columns; the columns open to closed - 1 may lack values. */
struct form {
    int least, most, open, closed;
};

/* Split a line, which is modified, into *count numbers; 0 for a blank or comment line. */
static enum status read_row(const char *path, int64_t line, char *text, const struct form *form,
                            double row[COLUMN_LIMIT], int *count, struct error *error)
{
    *count = 0;
    for (const char *word = text_word(&text); *word != '\0' && *word != '#'; word = text_word(&text)) {
        struct error why;
        if (*count == COLUMN_LIMIT) {
            return fail(error, STATUS_INPUT, "%s:%jd: more than %d columns", path, line, COLUMN_LIMIT);
        }
        if (*count >= form->open && *count < form->closed &&
            (strcmp(word, "-") == 0 || strcasecmp(word, "nan") == 0)) {
            row[*count] = NAN;
        } else if (parse_double(word, "", -DBL_MAX, DBL_MAX, &row[*count], &why) != STATUS_OK) {
            return fail(error, STATUS_INPUT, "%s:%jd: column %d: '%.63s' is not a finite number%s", path,
                        line, *count + 1, word,
                        strpbrk(word, ",;") != NULL ? ": write decimal points, and blanks between numbers"
                                                    : "");
        }
        ++*count;
    }
    return STATUS_OK;
}

static enum status check_columns(const char *path, int64_t line, const struct table *table, int count,
                                 const struct form *form, struct error *error)
{
    int least = form->least, most = form->most;
    if (table->rows > 0 && count != table->cols) {
        return fail(error, STATUS_INPUT, "%s:%jd: has %d columns, the rows before %jd", path, line, count,
                    table->cols);
    }
    if (count >= least && count <= most) {
        return STATUS_OK;
    }
    return least == most
               ? fail(error, STATUS_INPUT, "%s:%jd: has %d columns, not %d", path, line, count, least)
               : fail(error, STATUS_INPUT, "%s:%jd: has %d columns, not %d to %d", path, line, count, least,
                      most);
}

enum status table_read_open(const char *path, int least, int most, int open, int closed, struct table *table,
                            struct error *error)
{
    const struct form form = {least, most, open, closed};
    FREED_BY(textfile_free) struct textfile file = {0};
    int64_t line = 1;
    *table = (struct table){0};
    if (landmarks_named(path)) {
        RETURN_IF_ERROR(landmarks_read(path, table, error));
        RETURN_IF_ERROR(check_columns(path, table->line[0], table, (int)table->cols, &form, error));
        return table_end_block(table, error);
    }
    RETURN_IF_ERROR(textfile_read(path, size_limit, &file, error));
    for (char *rest = file.text; *rest != '\0'; line++) {
        double row[COLUMN_LIMIT];
        int count;
        char *text = strsep(&rest, "\n");
        if (text[strspn(text, " \t")] == '\0') { /* a blank line; a comment alone is none */
            RETURN_IF_ERROR(table_end_block(table, error));
        }
        RETURN_IF_ERROR(read_row(path, line, text, &form, row, &count, error));
        if (count > 0) {
            RETURN_IF_ERROR(check_columns(path, line, table, count, &form, error));
            table->cols = count;
            RETURN_IF_ERROR(table_append(table, row, line, NULL, error));
        }
    }
    if (table->rows == 0) {
        return fail(error, STATUS_INPUT, "%s: holds no row of numbers", path);
    }
    return table_end_block(table, error);
}

enum status table_read(const char *path, int least, int most, struct table *table, struct error *error)
{
    return table_read_open(path, least, most, 0, 0, table, error);
}

double table_unit(const char *path, double given)
{
    return landmarks_named(path) ? 1e-3 : given;
}

void table_free(struct table *table)
{
    FREE_ALL(table->values, table->line, table->block_ptr, table->label, table->text);
    *table = (struct table){0};
}
