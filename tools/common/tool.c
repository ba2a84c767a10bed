#include "tool.h"

#include "output.h"
#include "overwrite.h"
#include "process.h"

#include "io/files/descriptor.h"

#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* State of the process, like the standard descriptors. */
static char **arguments;         /* the command line, operands first; never freed */
static const char *process_name; /* tool->name, for the handler of SIGBUS */
static const char *main_input;   /* the operand that replaces standard input, or NULL */
static bool stdin_read;          /* standard input has been read */
static bool stdout_closed;       /* standard output has been closed, its errors reported */
static bool ending;              /* this program ends the process, not a library */

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

char *tool_numbered(const struct tool *tool, const char *what, const char *pattern, int64_t number)
{
    const char *at = strstr(pattern, "%d");
    if (at != NULL && strstr(at + 1, "%d") == NULL) {
        return tool_text(tool, "%.*s%lld%s", (int)(at - pattern), pattern, (long long)number, at + 2);
    }
    tool_fail(tool, STATUS_INPUT, "%s%s: has to have one %%d, where the number of the part goes", what,
              pattern);
}

/* Open missing standard descriptors so that using them fails: a file opened later must not become standard
 * input, output or error. */
static void fill_descriptors(void)
{
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
        }
    }
}

static _Noreturn void print_and_exit(const struct tool *tool, const char *text)
{
    if (process_speaks()) {
        fputs(text, stdout);
    }
    exit(tool_end(tool));
}

static void parse_options(struct tool *tool)
{
    options_declare(&tool->options, tool->usage);
    TOOL_TRY(tool, options_parse(&tool->options, tool->argc, arguments, &tool->operand_count, &error));
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
}

/* SIGBUS: another program has cut a mapped input file short while it was read. */
static void on_lost_mapping(int number)
{
    static const char message[] = ": an input file was cut short or could not be read while in use\n";
    (void)number;
    if (write(STDERR_FILENO, process_name, strlen(process_name)) < 0 ||
        write(STDERR_FILENO, message, sizeof message - 1) < 0) {
        _exit((int)STATUS_SYSTEM);
    }
    _exit((int)STATUS_SYSTEM);
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
    *tool = (struct tool){.name = slash != NULL ? slash + 1
                                  : argc > 0    ? argv[0]
                                                : "",
                          .usage = usage,
                          .argc = argc,
                          .argv = argv};
    fill_descriptors();
    gsl_set_error_handler_off(); /* its functions return errors */
    /* If the reader closes the pipe (head), end quietly, whatever the parent process has set. */
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_IGN); /* writing beyond the size limit then fails, with a message */
    process_name = tool->name;
    signal(SIGBUS, on_lost_mapping);
#ifdef M_MMAP_THRESHOLD
    /* Return arrays from this size on to the system when they are freed; by default the bound grows. */
    (void)mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
    (void)on_exit(on_foreign_exit, NULL);
    arguments = tool_memory(tool, array_new(argc + 1, sizeof *arguments));
    memcpy(arguments, argv, (size_t)argc * sizeof *arguments);
    parse_options(tool);
    tool->operands = arguments + 1;
    tool->operands[tool->operand_count] = NULL;
    if (tool->operand_count > most) {
        tool_fail(tool, STATUS_INPUT, "unexpected operand '%s' (see -h)", tool->operands[most]);
    }
    if (tool->operand_count < least) {
        tool_fail(tool, STATUS_INPUT, "an operand is missing (see -h)");
    }
    if (tool->output != NULL) {
        overwrite_refuse(tool, "output", "");
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
        tool_names_input(file);
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

void tool_names_input(const char *operand)
{
    main_input = main_input == NULL && !stdin_read ? operand : main_input;
}

void tool_read(const struct tool *tool, const char *file, struct stream *stream)
{
    const char *name;
    FREED_BY(descriptor_close) int descriptor = tool_open(tool, file, &name);
    TOOL_TRY(tool, stream_read(stream, descriptor, name, &error));
}

/* The value of a silent option that is this argument or within it, or NULL. */
static const char *silent_value(const struct tool *tool, const char *argument)
{
    for (int i = 0; i < tool->silent_count; i++) {
        if (tool->silent[i] >= argument && tool->silent[i] <= argument + strlen(argument)) {
            return tool->silent[i];
        }
    }
    return NULL;
}

/* The rest of an argument without the silent option in it, whose letter is the last of `length`: "-t" of
 * "-to" or "-toFILE"; NULL if nothing remains. */
static char *without_silent(const struct tool *tool, const char *argument, size_t length)
{
    if (length <= 2 || argument[1] == '-') {
        return NULL;
    }
    return tool_memory(tool, strndup(argument, length - 1));
}

/* Add the command line without options that do not change the result, such as -o FILE, and without the
 * operand that was read in place of standard input. So the same input gives the same bytes from any source
 * and to any output. */
static void add_provenance(const struct tool *tool, struct stream *stream)
{
    int count = 0, rest_count = 0;
    char *rests[TOOL_MOST_SILENT], **kept = tool_memory(tool, array_new(tool->argc + 1, sizeof *kept));
    for (int i = 0; i < tool->argc; i++) {
        char *argument = tool->argv[i];
        const char *value = silent_value(tool, argument);
        if (value != NULL) {
            count -= value == argument; /* the option is the previous argument */
            char *rest = value > argument ? without_silent(tool, argument, (size_t)(value - argument))
                                          : without_silent(tool, kept[count], strlen(kept[count]));
            if (rest != NULL) {
                rests[rest_count++] = rest;
                kept[count++] = rest;
            }
        } else if (i == 0 || argument != main_input || (stdin_read && strcmp(argument, "-") != 0)) {
            kept[count++] = argument;
        }
    }
    TOOL_TRY(tool, stream_add_provenance(stream, count, kept, &error));
    while (rest_count > 0) {
        free(rests[--rest_count]);
    }
    free(kept);
}

static void close_stdout(const struct tool *tool)
{
    if (close(STDOUT_FILENO) != 0) {
        tool_fail(tool, STATUS_SYSTEM, "standard output: %s", strerror(errno));
    }
    stdout_closed = true;
}

void tool_write(const struct tool *tool, struct stream *stream, bool text)
{
    add_provenance(tool, stream);
    tool_copy(tool, stream, text);
}

static enum status write_stdout(const struct stream *stream, bool text, struct error *error)
{
    if (!text && isatty(STDOUT_FILENO)) {
        return fail(error, STATUS_INPUT,
                    "no binary to a terminal: redirect it, name a file by -o, or ask for text");
    }
    RETURN_IF_ERROR(fail_in(error, stream_write(stream, STDOUT_FILENO, text, error), "standard output"));
    stdout_closed = close(STDOUT_FILENO) == 0;
    return stdout_closed ? STATUS_OK : fail(error, STATUS_SYSTEM, "standard output: %s", strerror(errno));
}

static enum status write_output(const struct tool *tool, const struct stream *stream, bool text,
                                struct error *error)
{
    struct output output;
    if (tool->output == NULL) {
        return write_stdout(stream, text, error);
    }
    RETURN_IF_ERROR(output_open(&output, tool->output, error));
    return output_end(&output, stream_write(stream, output.descriptor, text, error), error);
}

/* The first of several processes writes; all get its status. */
void tool_copy(const struct tool *tool, const struct stream *stream, bool text)
{
    struct error error = {""};
    enum status status = process_speaks() ? write_output(tool, stream, text, &error) : STATUS_OK;
    tool_check(tool, (enum status)ranks_most(process_ranks(), (int64_t)status), &error);
}

/* Open NAME.part for an incomplete result, beside a regular or new file, but not beside a device. */
static int open_part(const char *output)
{
    struct stat present;
    SCRATCH char *name = NULL;
    if ((stat(output, &present) == 0 && !S_ISREG(present.st_mode)) ||
        asprintf(&name, "%s.part", output) < 0) {
        return -1;
    }
    return open(name, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
}

void tool_write_stopped(const struct tool *tool, struct stream *stream, const char *reason, bool text)
{
    struct error ignored;
    if (!process_speaks()) {
        return;
    }
    int descriptor = tool->output != NULL ? open_part(tool->output) : STDOUT_FILENO;
    if (descriptor < 0 || (tool->output == NULL && !text && isatty(STDOUT_FILENO))) {
        return;
    }
    signal(SIGPIPE, SIG_IGN); /* exit with our own status */
    add_provenance(tool, stream);
    if (stream_write_stopped(stream, reason, descriptor, text, &ignored) == STATUS_OK) {
        (void)fsync(descriptor);
    }
    close(descriptor);
}

int tool_end(const struct tool *tool)
{
    ending = true;
    if (stdout_closed) {
        process_end();
        return (int)STATUS_OK;
    }
    bool failed = ferror(stdout) != 0;
    errno = 0;
    if (fflush(stdout) != 0 || failed) {
        tool_fail(tool, STATUS_SYSTEM, "standard output: %s", errno != 0 ? strerror(errno) : "write error");
    }
    close_stdout(tool);
    process_end();
    return (int)STATUS_OK;
}
