/* Two streams with a nodal field each, what the fields differ by, and the lines that tell of it: what
 * fieldcmp and fielderr share. */
#pragma once

#include "stages/solved.h"
#include "tool.h"

#include "approx/field/field_compare.h"

/* The regions of a stream's cells: their names, and which nodes belong to each; none where there are none. */
struct regions {
    int64_t node_count;
    struct names names;
    bool *member; /* node_count * names.count: a node is of the region of every cell at it */
};

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

/* What the options that both programs have ask for. */
struct comparison_request {
    double tol_avg, tol_max; /* a length, or in the field's own unit; infinite: any */
    const char *field;
    const char *region; /* NULL: all */
    const char *map;    /* the file; NULL: none */
    bool skip_outside, percentiles, text;
};

/* Exits for values that cannot be. */
struct comparison_request comparison_parse(const struct tool *tool);

/* Read a stream and its field; exits on failure. */
void side_read(const struct tool *tool, const char *file, const char *field, struct side *side);

/* Exits for fields of other shapes. */
void sides_check(const struct tool *tool, const struct side *first, const struct side *second,
                 const char *name);

/* Compare at the nodes of A, or at those of one of its regions, as asked for; exits on failure. */
void findings_make(const struct tool *tool, const struct comparison_request *request, const struct side *a,
                   const struct side *b, struct findings *findings);
void findings_free(struct findings *findings);

/* "name TAB value", "name.part TAB value". */
void print_quantity(const char *name, const char *part, double value);

/* The statistics of all nodes, how many, and where the largest is. */
void print_findings(const struct findings *findings, const struct cells *cells, bool percentiles);

/* And relative to the reference. */
void print_relative(const struct findings *findings);

/* The error that the iteration of a result has left, m, as mtled estimates it; negative: not known. */
double iteration_error(const struct side *side);

/* Print the statistics of each region unless one was asked for, write the map that was asked for, section
 * `name`, free all, and end the program: returns its exit status, a verdict where a value is not a number or
 * beyond its tolerance, with a note. */
int comparison_end(struct tool *tool, const struct comparison_request *request, struct side *a,
                   struct side *b, struct findings *findings, const char *name);
