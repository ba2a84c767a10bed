/* Functions for the main of every tool: usage, messages, opening and closing. Only tools print; lib/ does
 * not. */
#pragma once

#include "base/memory.h"
#include "base/options.h"
#include "base/status.h"
#include "io/stream/stream.h"

#include <stdio.h>

struct tool {
    const char *name;       /* argv[0] without folders */
    const char *usage;      /* the text at the top of the tool's file, which declares the options */
    struct options options; /* as given */
    char **operands;        /* operand_count operands, and NULL */
    int operand_count;
    const char *output; /* value of -o, NULL: standard output */
    bool text;          /* streams are written as text: -t, if there is such an option; a tool may set it */
};

/* Parse the command line by the options that the usage text declares (options_declare). Handles --help and
 * --version (text on stdout, exit 0). On a usage error prints one line and exits 2; operand counts outside of
 * [least, most] are usage errors. The value of --output becomes tool->output. */
void tool_begin(struct tool *tool, const char *usage, int least, int most, int argc, char *argv[]);

/* Whether an option was given; its value, or NULL. */
bool tool_given(const struct tool *tool, const char *option);
const char *tool_value(const struct tool *tool, const char *option);

/* The value of an option as a number or length (m), or as an index among `count` choices; `otherwise` if it
 * was not given. Exits if the value is not within [least, most], not a length, or not one of the choices. */
double tool_number(const struct tool *tool, const char *option, double least, double most, double otherwise);
int64_t tool_integer(const struct tool *tool, const char *option, int64_t least, int64_t most,
                     int64_t otherwise);
double tool_length(const struct tool *tool, const char *option, double otherwise);
double tool_length_unit(const struct tool *tool, const char *option, double otherwise);
int tool_choice(const struct tool *tool, const char *option, const char *const choices[], int count,
                int otherwise);

/* The whole numbers of an option for each of dim axes, or the only one for all. Exits if there are as many of
 * neither, unless dim is 0: not known yet; and if one is not whole, or not within [least, most]. */
void tool_whole_numbers(const struct tool *tool, const char *option, double least, double most, int dim,
                        int64_t numbers[3]);

/* The name of the first option given among a list that ends with NULL; NULL: none was. */
const char *tool_first_given(const struct tool *tool, const char *const options[]);

/* Exit if both options were given; exit if the first one was given without the second. */
void tool_excludes(const struct tool *tool, const char *option, const char *other);
void tool_requires(const struct tool *tool, const char *option, const char *other);

/* Leave an option out of the provenance: its value does not change the result. */
void tool_leave_out(const struct tool *tool, const char *option);

/* Unless `status` is STATUS_OK, print "name: message" on standard error and exit with it. */
void tool_check(const struct tool *tool, enum status status, const struct error *error);

/* Evaluate an expression with &error in it to a status; print the message and exit unless it is STATUS_OK. */
#define TOOL_TRY(tool, expression)                                                                           \
    do {                                                                                                     \
        struct error error;                                                                                  \
        tool_check((tool), (expression), &error);                                                            \
    } while (0)

/* A local array of zeros that is freed wherever its function is left; exits if there is no memory. */
#define TOOL_SCRATCH(tool, type, pointer, count)                                                             \
    SCRATCH type *pointer = NULL;                                                                            \
    TOOL_TRY(tool, NEW_ARRAY(&pointer, (count), &error))

/* Return memory; exits if it is NULL. */
void *tool_memory(const struct tool *tool, void *memory);

/* Print a text, to be freed; exits if there is no memory. */
char *tool_text(const struct tool *tool, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Print "name: message" and exit; `status` may also be 128 + the number of a signal. */
_Noreturn void tool_fail(const struct tool *tool, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Exit without a message. */
_Noreturn void tool_exit(enum status status);

/* Print a note "name: message" on standard error. */
void tool_note(const struct tool *tool, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Open a file for reading (NULL or "-": standard input, only once) and return the descriptor; *name receives
 * its name for messages. Exits on failure. */
int tool_open(const struct tool *tool, const char *file, const char **name);

/* Read a stream from a file (NULL or "-": standard input); exits on failure with a message naming it. */
void tool_read(const struct tool *tool, const char *file, struct stream *stream);

/* Put a section into a stream, which takes the data; exits on failure. */
void tool_put(const struct tool *tool, struct stream *stream, const char *name, enum element_type type,
              int64_t rows, int64_t cols, const char *attributes, void *data);

/* Append the tool's provenance line. */
void tool_provenance(const struct tool *tool, struct stream *stream);

/* Append the tool's provenance line and write the stream to tool->output (under a temporary name in the same
 * folder, renamed when complete) or standard output. Refuses to write binary to a terminal; reports delayed
 * write errors; exits on failure. */
void tool_write(const struct tool *tool, struct stream *stream);

/* The same without a provenance line, for a change of only the form of a stream. */
void tool_copy(const struct tool *tool, const struct stream *stream);

/* Close standard output, once all is written to it, and report delayed write errors. */
MUST_CHECK enum status tool_close_stdout(struct error *error);

/* The same, unless it is closed, for tools that print with stdio. Returns STATUS_OK, or exits with 3. */
int tool_end(const struct tool *tool);
