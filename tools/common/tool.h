/* What every tool's main needs: usage, messages, opening and closing. Tools talk; lib/ does not. */
#pragma once

#include "base/memory.h"
#include "base/options.h"
#include "base/status.h"
#include "io/stream/stream.h"

#include <stdio.h>

/* The most options of a tool that leave no trace in the provenance, -o among them. */
#define TOOL_MOST_SILENT 4

struct tool {
    const char *name;       /* argv[0] without folders */
    const char *usage;      /* the text at the top of the tool's file, which declares the options */
    struct options options; /* as given */
    int argc;               /* the command line as given, for provenance */
    char **argv;
    char **operands; /* operand_count operands, and NULL */
    int operand_count;
    const char *output;                   /* value of -o, NULL: standard output */
    const char *silent[TOOL_MOST_SILENT]; /* values of -o and those left out, as they stand in argv */
    int silent_count;
};

/* Parse the command line by the options that the usage text declares (options_declare). --help and --version
 * are handled here (text on stdout, exit 0). On a usage error prints one line and exits 2. The value of
 * --output becomes tool->output. Operand counts outside [least, most] are usage errors. */
void tool_begin(struct tool *tool, const char *usage, int least, int most, int argc, char *argv[]);

/* Whether an option was given; its value, or NULL. */
bool tool_given(const struct tool *tool, const char *option);
const char *tool_value(const struct tool *tool, const char *option);

/* The value of an option as a number or length (m), or as an index among `count` choices; `otherwise` where
 * it was not given. Exits where the value is not within [least, most], no length, or none of the choices. */
double tool_number(const struct tool *tool, const char *option, double least, double most, double otherwise);
int64_t tool_integer(const struct tool *tool, const char *option, int64_t least, int64_t most,
                     int64_t otherwise);
double tool_length(const struct tool *tool, const char *option, double otherwise);
double tool_length_unit(const struct tool *tool, const char *option, double otherwise);
int tool_choice(const struct tool *tool, const char *option, const char *const choices[], int count,
                int otherwise);

/* The name of the first option given among a list that ends with NULL; NULL: none was. */
const char *tool_first_given(const struct tool *tool, const char *const options[]);

/* The values of an option that repeats, in the order of the command line; returns how many. */
int tool_values(const struct tool *tool, const char *option, const char *values[OPTIONS_MOST_USES]);

/* Exits where both options were given, or the first one without the second. */
void tool_excludes(const struct tool *tool, const char *option, const char *other);
void tool_requires(const struct tool *tool, const char *option, const char *other);

/* Leave an option out of the provenance: its value changes nothing in the result. */
void tool_leave_out(struct tool *tool, const char *option);

/* Print "name: message" on standard error and exit with `status`; returns when the status is STATUS_OK. */
void tool_check(const struct tool *tool, enum status status, const struct error *error);

/* Evaluate an expression, with &error in it, to a status; print what is wrong and exit unless it is
 * STATUS_OK.
 */
#define TOOL_TRY(tool, expression)                                                                           \
    do {                                                                                                     \
        struct error error;                                                                                  \
        tool_check((tool), (expression), &error);                                                            \
    } while (0)

/* The memory that was asked for; exits where it is NULL. */
void *tool_memory(const struct tool *tool, void *memory);

/* Text as of printf, to be freed; exits when there is no memory. */
char *tool_text(const struct tool *tool, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A pattern such as part.%d.mts with a number in the place of its %d, to be freed; exits where it has none,
 * or several, naming the pattern by `what`. */
char *tool_numbered(const struct tool *tool, const char *what, const char *pattern, int64_t number);

/* Print "name: message" and exit; `status` may also be 128 + the number of a signal. */
_Noreturn void tool_fail(const struct tool *tool, enum status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Exit without a message. */
_Noreturn void tool_exit(enum status status);

/* "name: message" on standard error; notes that do not stop the run. */
void tool_note(const struct tool *tool, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Open a file for reading (NULL or "-": standard input, which can be had once) and return the descriptor;
 * *name receives what to call it in messages. Exits on failure. */
int tool_open(const struct tool *tool, const char *file, const char **name);

/* This operand names what is read in place of standard input, by other means than tool_open. */
void tool_names_input(const char *operand);

/* Read a stream from a file (NULL or "-": standard input); exits on failure with a message naming it. */
void tool_read(const struct tool *tool, const char *file, struct stream *stream);

/* Append the tool's provenance line and write the stream to tool->output (written under a temporary name in
 * the same folder and renamed when whole) or standard output; refuses binary to a terminal; reports delayed
 * write errors; exits on failure. */
void tool_write(const struct tool *tool, struct stream *stream, bool text);

/* The same without a provenance line: for what changes the form of a stream only. */
void tool_copy(const struct tool *tool, const struct stream *stream, bool text);

/* Write what there is of a result whose making was stopped (see stream_write_stopped): to standard output, or
 * beside tool->output under that name with ".part"; what is there under the name itself stays. Failures are
 * ignored: worse has happened. */
void tool_write_stopped(const struct tool *tool, struct stream *stream, const char *reason, bool text);

/* Close standard output, reporting delayed write errors; for tools that print tables with stdio. Returns the
 * exit status STATUS_OK or exits 3. */
int tool_end(const struct tool *tool);
