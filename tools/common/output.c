#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The temporary file of the output in progress, for the handlers below; NULL: none. */
static char *volatile pending;

static void remove_pending(void)
{
    if (pending != NULL) {
        unlink(pending);
        pending = NULL;
    }
}

static void on_signal(int number)
{
    remove_pending();
    signal(number, SIG_DFL);
    raise(number);
}

/* Handle the signals that are neither ignored nor handled by the tool itself. */
static void handle_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction present;
        if (sigaction(numbers[i], NULL, &present) == 0 && present.sa_handler == SIG_DFL) {
            signal(numbers[i], on_signal);
        }
    }
}

/* Open the temporary file, with the mode of the one that is to be replaced (NULL: none); -1: it fails. With
 * `grows` it is TARGET.part; else FOLDER/.NAME.XXXXXX beside it, a long name shortened to fit, which is
 * removed if the program ends before it is complete. */
static int open_temporary(struct output *output, bool grows, const struct stat *present)
{
    static bool prepared;
    const char *target = output->target, *slash = strrchr(target, '/');
    int folder = slash != NULL ? (int)(slash - target + 1) : 0, descriptor;
    int length = grows ? asprintf(&output->temporary, "%s.part", target)
                       : asprintf(&output->temporary, "%.*s.%.200s.XXXXXX", folder, target, target + folder);
    if (length < 0) {
        output->temporary = NULL;
        return -1;
    }
    if (grows) {
        descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
    } else {
        if (!prepared) {
            atexit(remove_pending);
            prepared = true;
        }
        handle_signals();
        descriptor = mkostemp(output->temporary, O_CLOEXEC);
        pending = descriptor >= 0 ? output->temporary : NULL;
    }
    mode_t mask = umask(0);
    umask(mask);
    mode_t mode = present != NULL ? present->st_mode & 07777 : 0666 & ~mask;
    return descriptor >= 0 && fchmod(descriptor, mode) == 0 ? descriptor : -1;
}

/* Close and remove the temporary file; the former file stays unchanged. */
static void abandon(struct output *output)
{
    if (output->file != NULL && output->file != stdout) {
        (void)fclose(output->file);
    }
    remove_pending();
    FREE_ALL(output->temporary, output->target);
    *output = (struct output){.name = output->name};
}

static enum status open_named(struct output *output, bool grows, struct error *error)
{
    struct stat present;
    const char *name = output->name;
    bool exists = stat(name, &present) == 0;
    if (exists && S_ISDIR(present.st_mode)) {
        return fail(error, STATUS_INPUT, "%s: is a directory", name);
    }
    int descriptor = -1;
    if (exists && !S_ISREG(present.st_mode)) {
        descriptor = open(name, O_WRONLY | O_CLOEXEC);
    } else {
        output->target = exists ? realpath(name, NULL) : strdup(name);
        descriptor = output->target != NULL ? open_temporary(output, grows, exists ? &present : NULL) : -1;
    }
    output->file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    return output->file != NULL ? STATUS_OK : fail_system(error, output->name);
}

enum status output_open(struct output *output, const char *name, bool grows, struct error *error)
{
    enum status status = STATUS_OK;
    *output = (struct output){.file = stdout, .name = "standard output"};
    if (name != NULL) {
        *output = (struct output){.name = name};
        status = open_named(output, grows, error);
    }
    if (status != STATUS_OK) {
        abandon(output);
    }
    errno = 0;
    return status;
}

enum status output_open_stream(struct output *output, const struct tool *tool, bool grows,
                               struct error *error)
{
    return tool->output == NULL && !tool->text && isatty(STDOUT_FILENO)
               ? fail(error, STATUS_INPUT,
                      "no binary to a terminal: redirect it, name a file by -o, or ask for text")
               : output_open(output, tool->output, grows, error);
}

enum status output_end(struct output *output, enum status status, struct error *error)
{
    int cause = ferror(output->file) != 0 ? errno + (errno == 0) * EIO : 0;
    if (cause == 0 && fflush(output->file) != 0) {
        cause = errno;
    }
    if (status == STATUS_OK && cause != 0) {
        status = fail(error, STATUS_SYSTEM, "%s", strerror(cause));
    }
    if (status != STATUS_OK || output->file == stdout) {
        bool is_stdout = output->file == stdout;
        abandon(output);
        status = fail_in(error, status, "%s", output->name);
        return status == STATUS_OK && is_stdout ? tool_close_stdout(error) : status;
    }
    /* Some file systems report only now that there is no space. */
    if (output->temporary != NULL && fsync(fileno(output->file)) != 0) {
        status = fail_system(error, output->name);
    }
    if (fclose(output->file) != 0 && status == STATUS_OK) {
        status = fail_system(error, output->name);
    }
    output->file = NULL;
    if (status == STATUS_OK && output->temporary != NULL) {
        if (rename(output->temporary, output->target) == 0) {
            pending = NULL;
        } else {
            status = fail_system(error, output->name);
        }
    }
    abandon(output);
    return status;
}
