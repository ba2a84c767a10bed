/* Fields of streams; their difference, and its output: shared by fieldcmp and fielderr. */
#pragma once

#include "stages/stages.h"
#include "tool.h"

#include "approx/field/field_compare.h"

/* A stream and its field. */
struct side {
    const char *name;
    struct stream stream;
    const struct section *section; /* of the field */
    struct nodal_field field;
    struct field_shapes solved; /* parameters of that field, if there are any */
};

/* The difference of two fields. */
struct findings {
    struct groups regions; /* of A's cells; none: no names */
    struct field_comparison comparison;
    struct field_statistics statistics; /* of all nodes compared */
    double reference;                   /* largest norm of B's field */
};

/* Check the options of both programs; exits for invalid values. Returns the name of the field. */
const char *comparison_field(const struct tool *tool);

/* Read a stream (NULL or "-": standard input) and its field; exits on failure. */
void side_read(const struct tool *tool, const char *file, const char *field, struct side *side);

/* The same, where the field must be a displacement of finite values in dim dimensions (0: any), on cells. */
void side_read_displacement(const struct tool *tool, const char *file, const char *field, int dim,
                            struct side *side);

/* Exits if the fields have different dimensions or columns. */
void sides_check(const struct tool *tool, const struct side *first, const struct side *second);

/* Compare at the nodes of A, or of a region (NULL: all); exits on failure. */
void findings_make(const struct tool *tool, const char *region, const struct side *a, const struct side *b,
                   struct findings *findings);
void findings_free(struct findings *findings);

/* Print "name TAB value", or "name.part TAB value". */
void print_quantity(const char *name, const char *part, double value);

/* Print the statistics of all nodes, their number, the place of the largest difference, and what is relative
 * to the reference. */
void print_findings(const struct tool *tool, const struct findings *findings, const struct cells *cells);

/* The error of the iteration in a result, as estimated by mtled, m; negative: not known. */
double iteration_error(const struct side *side);

/* End the program: print the statistics of each region unless one was requested, write the requested map with
 * section `name`, and free everything. Returns the exit status: a verdict, with a note, if a value is not a
 * number or beyond its tolerance. */
int comparison_end(struct tool *tool, struct side *a, struct side *b, struct findings *findings,
                   const char *name);
