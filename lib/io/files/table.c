#include "io/files/table.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/files/landmarks.h"
#include "io/files/textfile.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <strings.h>

static const size_t size_limit = (size_t)1 << 31;
enum { COLUMN_LIMIT = 64, WORD_LIMIT = 64 };

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

/* Move to the next word of a line, which ends at '\n' or a comment; returns its length, 0 at the end. */
static size_t next_word(const char **at)
{
    *at += strspn(*at, " \t");
    return **at == '#' ? 0 : strcspn(*at, " \t\n");
}

/* The admissible tables: number of columns; the columns open to closed - 1 may lack values. */
struct form {
    int least, most, open, closed;
};

static bool is_no_value(const char *word)
{
    return strcmp(word, "-") == 0 || strcasecmp(word, "nan") == 0;
}

/* Split the line at `text` into *count numbers; 0 for a blank or comment line. */
static enum status read_row(const char *path, int64_t line, const char *text, const struct form *form,
                            double row[COLUMN_LIMIT], int *count, struct error *error)
{
    *count = 0;
    for (size_t length; (length = next_word(&text)) > 0; text += length) {
        char word[WORD_LIMIT] = "";
        struct error why;
        memcpy(word, text, length < sizeof word ? length : sizeof word - 1);
        if (*count == COLUMN_LIMIT) {
            return fail(error, STATUS_INPUT, "%s:%jd: more than %d columns", path, line, COLUMN_LIMIT);
        }
        if (*count >= form->open && *count < form->closed && is_no_value(word)) {
            row[(*count)++] = NAN;
            continue;
        }
        if (length >= sizeof word ||
            parse_double(word, "", -DBL_MAX, DBL_MAX, &row[*count], &why) != STATUS_OK) {
            return fail(error, STATUS_INPUT, "%s:%jd: column %d: '%s' is not a finite number%s", path, line,
                        *count + 1, word,
                        strpbrk(word, ",;") != NULL ? ": write decimal points, and blanks between numbers"
                                                    : "");
        }
        ++*count;
    }
    return STATUS_OK;
}

/* A blank line separates blocks; a comment alone does not. */
static bool is_blank_line(const char *text)
{
    return text[strspn(text, " \t")] == '\n';
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
    for (const char *at = file.text; *at != '\0'; at = strchr(at, '\n') + 1, line++) {
        double row[COLUMN_LIMIT];
        int count;
        if (is_blank_line(at)) {
            RETURN_IF_ERROR(table_end_block(table, error));
        }
        RETURN_IF_ERROR(read_row(path, line, at, &form, row, &count, error));
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
