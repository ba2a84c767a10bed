#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_one(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* stat() of the folder of a name. */
static bool stat_folder(const char *name, struct stat *folder)
{
    const char *slash = strrchr(name, '/');
    SCRATCH char *path = slash == NULL ? strdup(".") : strndup(name, (size_t)(slash - name + 1));
    return path != NULL && stat(path, folder) == 0;
}

static const char *within_folder(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash == NULL ? name : slash + 1;
}

bool overwrite_is_same(const char *name, const char *other)
{
    struct stat a, b;
    bool first = stat(name, &a) == 0, second = stat(other, &b) == 0;
    if (first != second) {
        return false;
    }
    if (first) {
        return S_ISREG(a.st_mode) && is_one(&a, &b);
    }
    return strcmp(within_folder(name), within_folder(other)) == 0 && stat_folder(name, &a) &&
           stat_folder(other, &b) && is_one(&a, &b);
}

bool overwrite_is_stream(const char *name)
{
    char begin[6] = "";
    struct stat status;
    if (stat(name, &status) != 0 || !S_ISREG(status.st_mode)) { /* a pipe would lose what is read here */
        return false;
    }
    FILE *file = fopen(name, "rb");
    bool is = file != NULL && fread(begin, 1, sizeof begin, file) == sizeof begin &&
              memcmp(begin, "# mts ", sizeof begin) == 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return is;
}

/* Whether writing `output` replaces the file `input`. Devices and pipes are not replaced. */
static bool replaces(const char *output, const char *input)
{
    struct stat present;
    return stat(output, &present) == 0 && overwrite_is_same(output, input);
}

void overwrite_refuse(const struct tool *tool, const char *option, const char *suffix)
{
    const struct options *options = &tool->options;
    const char *value = tool_value(tool, option), *taken = NULL;
    char text[32];
    int files = 0;
    if (value == NULL) {
        return;
    }
    SCRATCH char *output = tool_text(tool, "%s%s", value, suffix);
    for (int i = 0; i < tool->operand_count; i++) {
        files += access(tool->operands[i], F_OK) == 0;
    }
    for (int i = 0; i < tool->operand_count && taken == NULL; i++) {
        bool filtered = files == 1 && overwrite_is_stream(tool->operands[i]);
        taken = replaces(output, tool->operands[i]) && !filtered ? tool->operands[i] : NULL;
    }
    for (int i = 0; i < options->use_count && taken == NULL; i++) {
        const struct option *used = options->use[i].option;
        if (strcmp(used->name, option) != 0 && strcmp(used->name, "output") != 0 &&
            replaces(output, options->use[i].value)) {
            taken = options->use[i].value;
        }
    }
    if (taken != NULL) {
        tool_fail(tool, STATUS_INPUT, "%s %s: replaces %s, an input of this run: name another file",
                  option_text(options_find(options, option), text), output, taken);
    }
}
