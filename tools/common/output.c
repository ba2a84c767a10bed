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

/* Remove the temporary file and raise the signal with its default action. */
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

/* Permissions of the file to be replaced, or of a new file. */
static mode_t file_mode(const struct stat *present)
{
    if (present != NULL) {
        return present->st_mode & 07777;
    }
    mode_t mask = umask(0);
    umask(mask);
    return 0666 & ~mask;
}

/* FOLDER/.NAME.XXXXXX beside `target`; a long name is shortened to fit. */
static char *temporary_name(const char *target)
{
    const char *slash = strrchr(target, '/');
    int folder = slash != NULL ? (int)(slash - target + 1) : 0;
    char *name;
    return asprintf(&name, "%.*s.%.200s.XXXXXX", folder, target, target + folder) < 0 ? NULL : name;
}

static char *part_name(const char *target)
{
    char *name;
    return asprintf(&name, "%s.part", target) < 0 ? NULL : name;
}

static enum status fail_output(const struct output *output, struct error *error)
{
    return fail(error, STATUS_SYSTEM, "%s: %s", output->name, strerror(errno));
}

/* Open a file of a new name, which is removed if the program ends before it is complete. */
static int open_new(struct output *output)
{
    static bool prepared;
    if (!prepared) {
        atexit(remove_pending);
        prepared = true;
    }
    handle_signals();
    int descriptor = mkostemp(output->temporary, O_CLOEXEC);
    pending = descriptor >= 0 ? output->temporary : NULL;
    return descriptor;
}

static enum status open_temporary(struct output *output, bool grows, const struct stat *present,
                                  struct error *error)
{
    output->temporary = grows ? part_name(output->target) : temporary_name(output->target);
    if (output->temporary == NULL) {
        return fail_memory(error, output->name);
    }
    output->descriptor =
        grows ? open(output->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666)
              : open_new(output);
    if (output->descriptor < 0) {
        return fail_output(output, error);
    }
    if (fchmod(output->descriptor, file_mode(present)) != 0) {
        return fail_output(output, error);
    }
    return STATUS_OK;
}

/* Close and remove the temporary file; the former file stays unchanged. */
static void abandon(struct output *output)
{
    if (output->descriptor >= 0) {
        close(output->descriptor);
    }
    remove_pending();
    FREE_ALL(output->temporary, output->target);
    *output = (struct output){.descriptor = -1, .name = output->name};
}

static enum status open_output(struct output *output, const char *name, bool grows, struct error *error)
{
    struct stat present;
    enum status status = STATUS_OK;
    bool exists = stat(name, &present) == 0;
    *output = (struct output){.descriptor = -1, .name = name};
    if (exists && S_ISDIR(present.st_mode)) {
        return fail(error, STATUS_INPUT, "%s: is a directory", name);
    }
    if (exists && !S_ISREG(present.st_mode)) {
        output->descriptor = open(name, O_WRONLY | O_CLOEXEC);
        return output->descriptor < 0 ? fail_output(output, error) : STATUS_OK;
    }
    output->target = exists ? realpath(name, NULL) : strdup(name);
    status = output->target == NULL ? fail_output(output, error)
                                    : open_temporary(output, grows, exists ? &present : NULL, error);
    if (status != STATUS_OK) {
        abandon(output);
    }
    return status;
}

enum status output_open(struct output *output, const char *name, struct error *error)
{
    return open_output(output, name, false, error);
}

enum status output_open_part(struct output *output, const char *name, struct error *error)
{
    return open_output(output, name, true, error);
}

enum status output_end(struct output *output, enum status status, struct error *error)
{
    int descriptor = output->descriptor;
    if (status != STATUS_OK) {
        abandon(output);
        return fail_in(error, status, "%s", output->name);
    }
    output->descriptor = -1;
    /* Some file systems report only now that there is no space. */
    if (output->temporary != NULL && fsync(descriptor) != 0) {
        status = fail_output(output, error);
    }
    if (close(descriptor) != 0 && status == STATUS_OK) {
        status = fail_output(output, error);
    }
    if (status == STATUS_OK && output->temporary != NULL) {
        if (rename(output->temporary, output->target) == 0) {
            pending = NULL;
        } else {
            status = fail_output(output, error);
        }
    }
    abandon(output);
    return status;
}

/* ---- printing ---- */

void target_open(const struct tool *tool, struct target *target, const char *name)
{
    *target = (struct target){.name = name, .file = stdout, .output.descriptor = STDOUT_FILENO};
    if (name == NULL) {
        return;
    }
    TOOL_TRY(tool, output_open(&target->output, name, &error));
    int descriptor = dup(target->output.descriptor); /* the output closes the original */
    target->file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    if (target->file == NULL) {
        int cause = errno;
        abandon(&target->output);
        tool_fail(tool, STATUS_SYSTEM, "%s: %s", name, strerror(cause));
    }
    errno = 0;
}

void target_close(const struct tool *tool, struct target *target, enum status status, struct error *error)
{
    bool named = target->name != NULL;
    int cause = named && ferror(target->file) != 0 ? errno : 0;
    if (named && fclose(target->file) != 0 && cause == 0) {
        cause = errno;
    }
    if (status == STATUS_OK && cause != 0) {
        status = fail(error, STATUS_SYSTEM, "%s", strerror(cause));
    }
    tool_check(tool,
               named ? output_end(&target->output, status, error) : fail_in(error, status, "standard output"),
               error);
}

void target_end(const struct tool *tool, struct target *target)
{
    struct error error;
    target_close(tool, target, STATUS_OK, &error);
}
