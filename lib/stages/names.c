#include "stages/names.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

enum status names_of(const struct section *section, const char *key, struct names *names, struct error *error)
{
    size_t size = strlen(section->attributes) + 1;
    *names = (struct names){0};
    /* The list, followed by a copy that is cut at the commas. */
    RETURN_IF_ERROR(NEW_ARRAY(&names->list, 2 * (int64_t)size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&names->name, (int64_t)size, error));
    char *rest = NULL;
    if (section_attribute(section, key, names->list, size) && names->list[0] != '\0') {
        rest = memcpy(names->list + size, names->list, size);
    }
    while (rest != NULL) {
        names->name[names->count++] = strsep(&rest, ",");
    }
    return STATUS_OK;
}

void names_free(struct names *names)
{
    FREE_ALL(names->list, names->name);
    *names = (struct names){0};
}

int64_t names_find(const struct names *names, const char *name)
{
    for (int64_t i = 0; i < names->count; i++) {
        if (strcmp(names->name[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

const char *names_text(const struct names *names, char text[256])
{
    snprintf(text, 256, "%s", names->count == 0 ? "none" : "");
    for (int64_t i = 0; i < names->count; i++) {
        text_append(text, 256, "%s%s", i == 0 ? "" : ", ", names->name[i]);
    }
    return text;
}
