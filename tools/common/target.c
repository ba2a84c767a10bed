#include "target.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

void target_open(const struct tool *tool, struct target *target, const char *name)
{
    *target = (struct target){.name = name, .file = stdout};
    if (name == NULL) {
        return;
    }
    TOOL_TRY(tool, output_open(&target->output, name, &error));
    int descriptor = dup(target->output.descriptor); /* the output closes its own */
    target->file = descriptor >= 0 ? fdopen(descriptor, "w") : NULL;
    if (target->file == NULL) {
        int cause = errno;
        output_abandon(&target->output);
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
