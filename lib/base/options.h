/* Strict command lines: an unknown or repeated option, a missing value or trailing junk is an error. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* One option of a tool. */
struct option {
    char letter;       /* 'k' for -k; 0: long form only */
    char name[24];     /* "tolerance" for --tolerance */
    bool takes_value;  /* -k VALUE, -kVALUE, --tolerance VALUE, --tolerance=VALUE */
    bool repeats;      /* may be given more than once */
    bool given;        /* set by options_parse, as is value */
    const char *value; /* the last one given; NULL: not given */
};

/* One use of an option that takes a value. */
struct option_use {
    const struct option *option;
    const char *value;
};

/* The options of a tool and, once parsed, their uses in the order of the command line. */
#define OPTIONS_MOST 32
#define OPTIONS_MOST_USES 256
struct options {
    int count, use_count;
    struct option option[OPTIONS_MOST];
    struct option_use use[OPTIONS_MOST_USES];
};

/* The options that a usage text declares in its block "Options:", and behind them --help (-h, unless a tool's
 * own option has that letter) and --version:
 *   "  -k, --factor FACTOR  text"        takes a value
 *   "      --no-widen  text"             does not, and has no letter
 *   "      --part NAME=PLACE ...  text"  may be given more than once
 * Two blanks end a declaration. A text that declares an option otherwise is a fault of the program. */
void options_declare(struct options *options, const char *usage);

/* Parse argv[1..]; options may stand before and after operands, "--" ends them, "-" is an operand.
 * Operands are moved, in order, to argv[1 .. *operand_count]. */
MUST_CHECK enum status options_parse(struct options *options, int argc, char *argv[], int *operand_count,
                                     struct error *error);

/* Whether an option of that name has been declared, and the option, which has been. */
bool options_has(const struct options *options, const char *name);
const struct option *options_find(const struct options *options, const char *name);

/* "-k", or "--no-widen" without a letter: what to call it in messages. */
const char *option_text(const struct option *option, char text[32]);

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

/* Parse a length or coordinate: a number within [least, 1e12] with a unit (8mm, 0.8cm, 0.008m) or without one
 * (metres); *value in metres. */
#define LEAST_LENGTH 1e-12
MUST_CHECK enum status parse_length(const char *text, const char *what, double least, double *value,
                                    struct error *error);

/* Index of `text` among `count` choices; the error lists them. */
MUST_CHECK enum status parse_choice(const char *text, const char *what, const char *const choices[],
                                    int count, int *index, struct error *error);
