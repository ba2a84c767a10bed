#include "base/names.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status names_add(struct names *names, const char *name, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&names->list, names->length + (int64_t)strlen(name) + 2, error));
    const char *end = stpcpy(stpcpy(names->list + names->length, names->count > 0 ? "," : ""), name);
    names->length = end - names->list;
    RETURN_IF_ERROR(RESIZE_ARRAY(&names->name, names->count + 1, error));
    names->name[names->count] = strdup(name);
    return names->name[names->count++] != NULL ? STATUS_OK : fail_memory(error, "names");
}

enum status names_print(struct names *names, struct error *error, const char *format, ...)
{
    SCRATCH char *name = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&name, format, arguments);
    va_end(arguments);
    name = length < 0 ? NULL : name;
    return name == NULL ? fail_memory(error, "names") : names_add(names, name, error);
}

enum status names_split(struct names *names, const char *list, struct error *error)
{
    SCRATCH char *copy = strdup(list);
    if (copy == NULL) {
        return fail_memory(error, "names");
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&names->list, names->length + 1, error));
    names->list[names->length] = '\0';
    for (char *rest = copy[0] != '\0' ? copy : NULL; rest != NULL;) {
        RETURN_IF_ERROR(names_add(names, strsep(&rest, ","), error));
    }
    return STATUS_OK;
}

enum status names_remove(struct names *names, int64_t index, struct error *error)
{
    FREED_BY(names_free) struct names old = *names;
    *names = (struct names){0};
    for (int64_t i = 0; i < old.count; i++) {
        RETURN_IF_ERROR(i != index ? names_add(names, old.name[i], error) : STATUS_OK);
    }
    return STATUS_OK;
}

void names_free(struct names *names)
{
    for (int64_t i = 0; i < names->count; i++) {
        free(names->name[i]);
    }
    FREE_ALL(names->name, names->list);
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

enum status names_need(const struct names *names, const char *what, const char *name, int64_t *index,
                       struct error *error)
{
    *index = names_find(names, name);
    return *index >= 0 ? STATUS_OK
                       : fail(error, STATUS_INPUT, "no %s '%s'; there are: %s", what, name,
                              names->count > 0 ? names->list : "none");
}
