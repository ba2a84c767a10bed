#include "stages/solved.h"

#include <stdio.h>
#include <string.h>

static const char prefix[] = "parameters";

enum status supports_read(const struct stream *stream, const char *of, struct solved *solved,
                          struct error *error)
{
    int dim;
    int64_t node_count;
    const double *x;
    char name[64];
    snprintf(name, sizeof name, "%s.radius", of);
    const struct section *radius = stream_find(stream, name);
    *solved = (struct solved){0};
    if (radius == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_nodes(stream, &dim, &node_count, &x, error));
    RETURN_IF_ERROR(stream_need(stream, radius->name, TYPE_F8, 1, "mtled", &radius, error));
    RETURN_IF_ERROR(stage_recorded(stream, of, dim, &solved->recorded, error));
    if (radius->rows != node_count) {
        return fail(error, STATUS_INPUT, "%s: %lld rows for %lld nodes", radius->name,
                    (long long)radius->rows, (long long)node_count);
    }
    solved->radius = radius->data;
    return section_check_numbers(radius, true, error);
}

const struct section *solved_parameters(const struct stream *stream, const struct solved *solved,
                                        const struct section *field)
{
    char name[96];
    if (solved->radius == NULL ||
        (strcmp(field->name, "u") != 0 && strncmp(field->name, "u.frame.", 8) != 0)) {
        return field;
    }
    snprintf(name, sizeof name, "%s%s", prefix, field->name + 1);
    const struct section *found = stream_find(stream, name);
    bool fits = found != NULL && found->type == field->type && found->rows == field->rows &&
                found->cols == field->cols;
    return fits ? found : field;
}

bool solved_is_parameters(const struct section *section)
{
    size_t length = strlen(prefix);
    return strncmp(section->name, prefix, length) == 0 &&
           (section->name[length] == '\0' || section->name[length] == '.');
}
