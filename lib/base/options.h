/* Strict command lines: an unknown or repeated option, a missing value or trailing junk is an error. */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* The uses of options that may be given more than once, in the order of the command line. */
#define OPTION_MOST_USES 256
struct option_uses {
    int count;
    struct option_use {
        const char *name; /* of the option */
        const char *value;
    } use[OPTION_MOST_USES];
};

/* One option of a tool. `letter` may be 0 (long form only) and `name` NULL (short form only). */
struct option {
    char letter;              /* 'k' for -k */
    const char *name;         /* "tolerance" for --tolerance */
    bool takes_value;         /* -k VALUE, -kVALUE, --tolerance VALUE, --tolerance=VALUE */
    bool silent;              /* with a value that changes nothing in the result: no provenance */
    struct option_uses *uses; /* with a value and a name: may be repeated; each use is appended here, where
                                 several options may share a list */
    const char *value;        /* set by options_parse: the (last) value, NULL when not given */
    bool given;               /* set by options_parse */
};

/* Parse argv[1..]; options may stand before and after operands, "--" ends them, "-" is an operand.
 * Operands are moved, in order, to argv[1 .. *operand_count]. */
MUST_CHECK enum status options_parse(struct option options[], int option_count, int argc, char *argv[],
                                     int *operand_count, struct error *error);

/* Parse a whole text as a number within [least, most]; NaN, infinities, an empty text, leading space,
 * hexadecimal and trailing junk are errors. `what` names it in the message, e.g. "-k". */
MUST_CHECK enum status parse_double(const char *text, const char *what, double least, double most,
                                    double *value, struct error *error);
MUST_CHECK enum status parse_integer(const char *text, const char *what, int64_t least, int64_t most,
                                     int64_t *value, struct error *error);

/* Parse a comma-separated list of 1..most numbers, each within [least, largest]; *count receives how many. */
MUST_CHECK enum status parse_double_list(const char *text, const char *what, double least, double largest,
                                         int most, double values[], int *count, struct error *error);

/* Parse a unit of length into its size in metres: m, cm, mm, um, or a positive number of metres (0.0254). */
MUST_CHECK enum status parse_length_unit(const char *text, const char *what, double *metres,
                                         struct error *error);

/* Parse a length: a number with a unit (8mm, 0.8cm, 0.008m) or without one (metres), positive; *value in
 * metres. */
MUST_CHECK enum status parse_length(const char *text, const char *what, double *value, struct error *error);

/* Index of `text` among `count` choices; the error lists them. */
MUST_CHECK enum status parse_choice(const char *text, const char *what, const char *const choices[],
                                    int count, int *index, struct error *error);

#endif
