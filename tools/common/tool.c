#include "tool.h"

#include "io/files/textfile.h"
#include "output.h"
#include "process.h"

#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* State of the process, like the standard descriptors. */
static char **arguments;       /* the command line, operands first; never freed, as is */
static char **command;         /* the command line for the provenance, up to NULL */
static const char *main_input; /* the operand that replaces standard input, or NULL */
static bool stdin_read;        /* standard input has been read */
static bool stdout_closed;     /* standard output has been closed, its errors reported */
static bool ending;            /* this program ends the process, not a library */

static void print_message(const struct tool *tool, const char *format, va_list values)
{
    char text[2 * sizeof(struct error)];
    struct error message;
    vsnprintf(text, sizeof text, format, values);
    fail(&message, STATUS_OK, "%s", text); /* makes one line, whatever the names in it contain */
    fprintf(stderr, "%s: %s\n", tool->name, message.text);
}

/* Of several processes the first one prints, or one that fails alone. */
_Noreturn void tool_fail(const struct tool *tool, enum status status, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (process_speaks() || process_fails_alone()) {
        print_message(tool, format, values);
    }
    va_end(values);
    tool_exit(status);
}

void tool_exit(enum status status)
{
    ending = true;
    (void)process_fails_alone();
    process_end();
    exit((int)status);
}

void tool_note(const struct tool *tool, const char *format, ...)
{
    va_list values;
    if (process_speaks()) {
        va_start(values, format);
        print_message(tool, format, values);
        va_end(values);
    }
}

void tool_check(const struct tool *tool, enum status status, const struct error *error)
{
    if (status != STATUS_OK) {
        tool_fail(tool, status, "%s", error->text);
    }
}

void *tool_memory(const struct tool *tool, void *memory)
{
    if (memory == NULL) {
        tool_fail(tool, STATUS_SYSTEM, "out of memory");
    }
    return memory;
}

char *tool_text(const struct tool *tool, const char *format, ...)
{
    char *text;
    va_list values;
    va_start(values, format);
    text = vasprintf(&text, format, values) < 0 ? NULL : text;
    va_end(values);
    return tool_memory(tool, text);
}

static _Noreturn void print_and_exit(const struct tool *tool, const char *text)
{
    if (process_speaks()) {
        fputs(text, stdout);
    }
    exit(tool_end(tool));
}

static void parse_options(struct tool *tool, int argc)
{
    options_declare(&tool->options, tool->usage);
    TOOL_TRY(tool, options_parse(&tool->options, argc, arguments, &tool->operand_count, &error));
    if (tool_given(tool, "help")) {
        print_and_exit(tool, tool->usage);
    }
    if (tool_given(tool, "version")) {
        char text[128];
        snprintf(text, sizeof text, "%s %s\n", tool->name, MTS_VERSION);
        print_and_exit(tool, text);
    }
    if (options_has(&tool->options, "output")) {
        tool->output = tool_value(tool, "output");
        tool_leave_out(tool, "output");
    }
    tool->text = options_has(&tool->options, "text") && tool_given(tool, "text");
}

/* libgomp ends the process with status 1 if it gets no memory; here 1 would be a verdict. */
static void on_foreign_exit(int status, void *unused)
{
    (void)status, (void)unused;
    if (!ending) {
        _exit((int)STATUS_SYSTEM);
    }
}

void tool_begin(struct tool *tool, const char *usage, int least, int most, int argc, char *argv[])
{
    const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
    *tool = (struct tool){.name = slash != NULL ? slash + 1 : argc > 0 ? argv[0] : "", .usage = usage};
    /* Missing standard descriptors: using them fails, and no file that is opened later becomes one of them.
     */
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
        }
    }
    gsl_set_error_handler_off(); /* its functions return errors */
    /* If the reader closes the pipe (head), end quietly, whatever the parent process has set. */
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_IGN); /* writing beyond the size limit then fails, with a message */
    /* Return arrays from this size on to the system when they are freed; by default the bound grows. */
    (void)mallopt(M_MMAP_THRESHOLD, 1 << 20);
    (void)on_exit(on_foreign_exit, NULL);
    arguments = tool_memory(tool, array_new(argc + 1, sizeof *arguments));
    memcpy(arguments, argv, (size_t)argc * sizeof *arguments);
    command = tool_memory(tool, array_new(argc + 1, sizeof *command));
    memcpy(command, argv, (size_t)argc * sizeof *command);
    parse_options(tool, argc);
    tool->operands = arguments + 1;
    tool->operands[tool->operand_count] = NULL;
    if (tool->operand_count > most) {
        tool_fail(tool, STATUS_INPUT, "unexpected operand '%s' (see -h)", tool->operands[most]);
    }
    if (tool->operand_count < least) {
        tool_fail(tool, STATUS_INPUT, "an operand is missing (see -h)");
    }
}

int tool_open(const struct tool *tool, const char *file, const char **name)
{
    bool named = file != NULL && strcmp(file, "-") != 0;
    *name = named ? file : "standard input";
    if (named) {
        int descriptor = open(file, O_RDONLY | O_CLOEXEC);
        if (descriptor < 0) {
            tool_fail(tool, STATUS_INPUT, "%s: %s", file, strerror(errno));
        }
        main_input = main_input == NULL && !stdin_read ? file : main_input;
        return descriptor;
    }
    if (stdin_read) {
        tool_fail(tool, STATUS_INPUT, "standard input cannot be read twice");
    }
    if (isatty(STDIN_FILENO)) {
        tool_fail(tool, STATUS_INPUT, "standard input is a terminal: name a file or use a pipe (see -h)");
    }
    main_input = main_input == NULL ? file : main_input;
    stdin_read = true;
    return STDIN_FILENO;
}

void tool_read(const struct tool *tool, const char *file, struct stream *stream)
{
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, file, &name);
    TOOL_TRY(tool, stream_read(stream, descriptor, name, &error));
}

/* Remove an argument from the command line of the provenance. */
static void drop(int i)
{
    for (; command[i] != NULL; i++) {
        command[i] = command[i + 1];
    }
}

void tool_leave_out(const struct tool *tool, const char *option)
{
    const char *value = tool_value(tool, option);
    for (int i = 1; command[i] != NULL && value != NULL; i++) {
        if (value < command[i] || value > command[i] + strlen(command[i])) {
            continue;
        }
        size_t before = (size_t)(value - command[i]);
        if (before == 0) { /* the option is the argument before */
            drop(i--);
            before = strlen(command[i]);
        }
        if (before > 2 && command[i][1] != '-') {
            command[i][before - 1] = '\0'; /* "-to" or "-toFILE": "-t" remains */
        } else {
            drop(i);
        }
        return;
    }
}

/* The command line has neither options that do not change the result, such as -o FILE, nor the operand that
 * was read in place of standard input. So the same input gives the same bytes from any source and to any
 * output. */
void tool_provenance(const struct tool *tool, struct stream *stream)
{
    int count = 0;
    for (; command[count] != NULL; count++) {
        if (count > 0 && command[count] == main_input && !(stdin_read && strcmp(main_input, "-") != 0)) {
            drop(count--);
        }
    }
    TOOL_TRY(tool, stream_add_provenance(stream, count, command, &error));
}

void tool_put(const struct tool *tool, struct stream *stream, const char *name, enum element_type type,
              int64_t rows, int64_t cols, const char *attributes, void *data)
{
    TOOL_TRY(tool, stream_put(stream, name, type, rows, cols, attributes, data, true, &error));
}

enum status tool_close_stdout(struct error *error)
{
    stdout_closed = close(STDOUT_FILENO) == 0;
    return stdout_closed ? STATUS_OK : fail_system(error, "standard output");
}

void tool_write(const struct tool *tool, struct stream *stream)
{
    tool_provenance(tool, stream);
    tool_copy(tool, stream);
}

/* The first of several processes writes; all get its status. */
void tool_copy(const struct tool *tool, const struct stream *stream)
{
    struct error error = {""};
    struct output output;
    enum status status = process_speaks() ? output_open_stream(&output, tool, false, &error) : STATUS_OK;
    if (process_speaks() && status == STATUS_OK) {
        status = output_end(&output, stream_write(stream, output.file, tool->text, &error), &error);
    }
    tool_check(tool, (enum status)ranks_most(process_ranks(), (int64_t)status), &error);
}

int tool_end(const struct tool *tool)
{
    bool failed = !stdout_closed && ferror(stdout) != 0;
    ending = true;
    errno = 0;
    if (!stdout_closed && (fflush(stdout) != 0 || failed)) {
        tool_fail(tool, STATUS_SYSTEM, "standard output: %s", errno != 0 ? strerror(errno) : "write error");
    }
    TOOL_TRY(tool, stdout_closed ? STATUS_OK : tool_close_stdout(&error));
    process_end();
    return (int)STATUS_OK;
}

/* ---- options ---- */

bool tool_given(const struct tool *tool, const char *option)
{
    return options_find(&tool->options, option)->given;
}

const char *tool_value(const struct tool *tool, const char *option)
{
    return options_find(&tool->options, option)->value;
}

/* Parse the value of the option if it is given. */
#define PARSE_GIVEN(parse, ...)                                                                              \
    do {                                                                                                     \
        char what[32];                                                                                       \
        const struct option *found = options_find(&tool->options, option);                                   \
        if (found->given) {                                                                                  \
            TOOL_TRY(tool, parse(found->value, option_text(found, what), __VA_ARGS__, &error));              \
        }                                                                                                    \
    } while (0)

double tool_number(const struct tool *tool, const char *option, double least, double most, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_double, least, most, &value);
    return value;
}

int64_t tool_integer(const struct tool *tool, const char *option, int64_t least, int64_t most,
                     int64_t otherwise)
{
    int64_t value = otherwise;
    PARSE_GIVEN(parse_integer, least, most, &value);
    return value;
}

double tool_length(const struct tool *tool, const char *option, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_length, LEAST_LENGTH, &value);
    return value;
}

double tool_length_unit(const struct tool *tool, const char *option, double otherwise)
{
    double value = otherwise;
    PARSE_GIVEN(parse_length_unit, &value);
    return value;
}

int tool_choice(const struct tool *tool, const char *option, const char *const choices[], int count,
                int otherwise)
{
    int choice = otherwise;
    PARSE_GIVEN(parse_choice, choices, count, &choice);
    return choice;
}

void tool_whole_numbers(const struct tool *tool, const char *option, double least, double most, int dim,
                        int64_t numbers[3])
{
    double values[3];
    int count = 1;
    char what[32];
    const struct option *found = options_find(&tool->options, option);
    TOOL_TRY(tool, parse_double_list(found->value, option_text(found, what), least, most, 3, values, &count,
                                     &error));
    if (count != 1 && dim > 0 && count != dim) {
        tool_fail(tool, STATUS_INPUT, dim == 1 ? "%s: %d numbers, not 1" : "%s: %d numbers, not 1 or %d",
                  what, count, dim);
    }
    for (int a = 0; a < 3; a++) {
        double value = values[a < count ? a : 0];
        numbers[a] = (int64_t)value;
        if ((double)numbers[a] != value) {
            tool_fail(tool, STATUS_INPUT, "%s: %g is not a whole number", what, value);
        }
    }
}

const char *tool_first_given(const struct tool *tool, const char *const options[])
{
    for (int i = 0; options[i] != NULL; i++) {
        if (tool_given(tool, options[i])) {
            return options[i];
        }
    }
    return NULL;
}

/* Exit with the message if the first option was given, and the other one was or was not. */
static void refuse_pair(const struct tool *tool, const char *option, const char *other, bool both,
                        const char *between)
{
    char one[32], two[32];
    const struct option *first = options_find(&tool->options, option),
                        *second = options_find(&tool->options, other);
    if (first->given && second->given == both) {
        tool_fail(tool, STATUS_INPUT, "%s%s %s %s", both ? "give one of " : "", option_text(first, one),
                  between, option_text(second, two));
    }
}

void tool_excludes(const struct tool *tool, const char *option, const char *other)
{
    refuse_pair(tool, option, other, true, "and");
}

void tool_requires(const struct tool *tool, const char *option, const char *other)
{
    refuse_pair(tool, option, other, false, "goes with");
}
