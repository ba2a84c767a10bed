/* Two streams with a nodal field each, what the fields differ by, and the lines that tell of it: what
 * fieldcmp and fielderr share. */
#ifndef TOOLS_COMPARISON_H
#define TOOLS_COMPARISON_H

#include "regions.h"
#include "solved.h"
#include "tool.h"

#include "approx/field_compare.h"

/* A stream and its field. */
struct side {
    const char *name;
    struct stream stream;
    const struct section *section; /* of the field */
    struct nodal_field field;
    struct solved solved;
};

/* What two fields differ by. */
struct findings {
    struct regions regions; /* of A */
    struct field_comparison comparison;
    struct field_statistics statistics; /* of all nodes compared */
    double reference;                   /* largest norm of B's field */
};

/* The value of a tolerance: a length, or a number of the field's own unit; 0 is allowed. Infinite when it is
 * not given. */
double comparison_tolerance(const struct tool *tool, const struct option *option);

/* Read a stream and its field; exits on failure. */
void side_read(const struct tool *tool, const char *file, const char *field, struct side *side);

/* Notes the first value that is not finite; returns whether there is one. */
bool side_has_unknown(const struct tool *tool, const struct side *side, const char *field);

/* Exits for fields of other shapes. */
void sides_check(const struct tool *tool, const struct side *first, const struct side *second,
                 const char *name);

/* Compare at the nodes of A, or at those of one of its regions (unless NULL); exits on failure. */
void findings_make(const struct tool *tool, const char *region, bool skip_outside, const char *field,
                   const struct side *a, const struct side *b, struct findings *findings);
void findings_free(struct findings *findings);

/* "name TAB value", "name.part TAB value". */
void print_quantity(const char *name, const char *part, double value);

/* The statistics of all nodes, how many, and where the largest is. */
void print_findings(const struct findings *findings, const struct cells *cells, bool percentiles);

/* And relative to the reference. */
void print_relative(const struct findings *findings);

/* Statistics of the nodes of each region. */
MUST_CHECK enum status print_regions(const struct findings *findings, struct error *error);

/* Write A's nodes and cells with a value at each node, section `name`, to a file. */
void comparison_write_map(struct tool *tool, struct side *a, const char *name, double *value,
                          const char *file, bool text);

/* Whether a value is within its tolerance; NaN is not. Notes if it is beyond. */
bool comparison_within(const struct tool *tool, const char *name, double value, double tolerance);

#endif
