#include "names.h"

#include "base/memory.h"

#include <string.h>

enum status names_of_section(const struct section *section, char **names, struct error *error)
{
    size_t size = strlen(section->attributes) + 1;
    enum status status = NEW_ARRAY(names, (int64_t)size, error);
    if (status == STATUS_OK && !section_attribute(section, "names", *names, size)) {
        (*names)[0] = '\0';
    }
    return status;
}

int64_t names_index(const char *names, const char *name)
{
    size_t length = strlen(name);
    int64_t index = 0;
    for (const char *at = names;; index++) {
        size_t item = strcspn(at, ",");
        if (item == length && strncmp(at, name, length) == 0) {
            return index;
        }
        if (at[item] == '\0') {
            return -1;
        }
        at += item + 1;
    }
}
