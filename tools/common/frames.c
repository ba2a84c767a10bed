#include "frames.h"

#include "base/options.h"

#include <string.h>

int64_t frame_of(const char *name, size_t *length)
{
    static const char infix[] = ".frame.";
    struct error ignored;
    int64_t frame;
    const char *at = strstr(name, infix);
    *length = strlen(name);
    if (at == NULL || parse_integer(at + strlen(infix), name, 0, INT32_MAX, &frame, &ignored) != STATUS_OK) {
        return FRAME_NONE;
    }
    *length = (size_t)(at - name);
    return frame;
}
