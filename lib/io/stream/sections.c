#include "io/stream/sections.h"

#include "base/options.h"

#include <string.h>

const struct section_kind section_kinds[SECTION_KINDS] = {
    {"nodes.x", TYPE_F8, COLS_DIM, NULL, FINITE, NULL, MADE_WITH_CLOUD},
    {"cells", TYPE_I4, COLS_DIM_PLUS_1, NULL, INDEX, "nodes.x", MADE_WITH_CLOUD},
    {"cells.region", TYPE_I4, 1, "cells", ANY, NULL, MADE_WITH_CLOUD},
    {"facets", TYPE_I4, COLS_DIM, NULL, INDEX, "nodes.x", MADE_WITH_CLOUD},
    {"facets.set", TYPE_I4, 1, "facets", ANY, NULL, MADE_WITH_CLOUD},
    {"sets.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_CLOUD},
    {"points.x", TYPE_F8, COLS_DIM, NULL, FINITE, NULL, MADE_WITH_POINTS},
    {"points.weight", TYPE_F8, 1, "points.x", POSITIVE, NULL, MADE_WITH_POINTS},
    {"points.cell", TYPE_I4, 1, "points.x", INDEX_OR_NONE, "cells", MADE_WITH_POINTS},
    {"faces", TYPE_I4, COLS_DIM, NULL, INDEX, "nodes.x", MADE_WITH_POINTS},
    {"faces.cell", TYPE_I4, 2, "faces", INDEX_OR_NONE, "cells", MADE_WITH_POINTS},
    {"faces.edge", TYPE_I4, 3, "faces", ANY, NULL, MADE_WITH_POINTS},
    {"facepoints.x", TYPE_F8, COLS_DIM, NULL, FINITE, NULL, MADE_WITH_POINTS},
    {"support.radius", TYPE_F8, 1, "nodes.x", POSITIVE, NULL, MADE_WITH_SUPPORT},
    {"support.stretch", TYPE_F8, COLS_DIM_SQUARED, "nodes.x", STRETCH, NULL, MADE_WITH_SUPPORT},
    {"support.sides", TYPE_F8, COLS_SIDES, NULL, STRETCH, NULL, MADE_WITH_SUPPORT},
    {"support.side", TYPE_I4, 1, "cells", BELOW, "cells", MADE_WITH_SUPPORT},
    {"nbr.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_SUPPORT},
    {"nbr.side", TYPE_I4, 1, "points.x", ANY, NULL, MADE_WITH_SUPPORT},
    {"nbr.widen", TYPE_F8, 1, "points.x", AT_LEAST_ONE, NULL, MADE_WITH_SUPPORT},
    {"facepoint.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_SUPPORT},
    {"facepoint.side", TYPE_I4, 1, "facepoints.x", ANY, NULL, MADE_WITH_SUPPORT},
    {"facepoint.widen", TYPE_F8, 1, "facepoints.x", AT_LEAST_ONE, NULL, MADE_WITH_SUPPORT},
    {"node.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_SUPPORT},
    {"node.side", TYPE_I4, 1, "nodes.x", ANY, NULL, MADE_WITH_SUPPORT},
    {"node.widen", TYPE_F8, 1, "nodes.x", AT_LEAST_ONE, NULL, MADE_WITH_SUPPORT},
    {"shape.phi", TYPE_F8, 1, "nbr.idx", UNITY, NULL, MADE_WITH_SHAPES},
    {"shape.dphi", TYPE_F8, COLS_DIM, "nbr.idx", FINITE, NULL, MADE_WITH_SHAPES},
    {"edge.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_SHAPES},
    {"edge.phi", TYPE_F8, 1, "edge.idx", UNITY, NULL, MADE_WITH_SHAPES},
    {"boundary.idx", TYPE_I4, 1, NULL, INDEX, "nodes.x", MADE_WITH_SHAPES},
    {"boundary.phi", TYPE_F8, 1, "boundary.idx", UNITY, NULL, MADE_WITH_SHAPES},
    {"node.phi", TYPE_F8, 1, "node.idx", UNITY, NULL, MADE_WITH_SHAPES},
    {"sets.ptr", TYPE_I8, 1, NULL, LIST, NULL, MADE_WITH_CLOUD},
    {"nbr.ptr", TYPE_I8, 1, "points.x", LIST, NULL, MADE_WITH_SUPPORT},
    {"facepoint.ptr", TYPE_I8, 1, "facepoints.x", LIST, NULL, MADE_WITH_SUPPORT},
    {"node.ptr", TYPE_I8, 1, "nodes.x", LIST, NULL, MADE_WITH_SUPPORT},
    {"edge.ptr", TYPE_I8, 1, "edges", LIST, NULL, MADE_WITH_SHAPES},
    {"boundary.ptr", TYPE_I8, 1, "boundary points", LIST, NULL, MADE_WITH_SHAPES},
    {"parameters", TYPE_F8, COLS_DIM, "nodes.x", FINITE, NULL, MADE_WITH_RESULTS},
    {"parameters.radius", TYPE_F8, 1, "nodes.x", POSITIVE, NULL, MADE_WITH_RESULTS},
    {"parameters.stretch", TYPE_F8, COLS_DIM_SQUARED, "nodes.x", STRETCH, NULL, MADE_WITH_RESULTS},
    {"parameters.sides", TYPE_F8, COLS_SIDES, NULL, STRETCH, NULL, MADE_WITH_RESULTS},
    {"parameters.side", TYPE_I4, 1, "cells", BELOW, "cells", MADE_WITH_RESULTS},
    {"iteration", TYPE_F8, 1, NULL, FINITE, NULL, MADE_WITH_RESULTS},
    {"u", TYPE_F8, COLS_ANY, "nodes.x", FINITE, NULL, MADE_WITH_RESULTS},
    {"stress", TYPE_F8, COLS_ANY, "points.x", ANY, NULL, MADE_WITH_RESULTS},
    {"strain", TYPE_F8, COLS_ANY, "points.x", ANY, NULL, MADE_WITH_RESULTS},
    {"pressure", TYPE_F8, COLS_ANY, "points.x", ANY, NULL, MADE_WITH_RESULTS},
    {"volume_ratio", TYPE_F8, COLS_ANY, "points.x", ANY, NULL, MADE_WITH_RESULTS},
    {"fibre", TYPE_F8, COLS_DIM, "points.x", ANY, NULL, MADE_WITH_RESULTS},
    {"points.fibre", TYPE_F8, COLS_DIM, "points.x", FINITE, NULL, MADE_WITH_POINTS},
    {"reactions", TYPE_F8, COLS_ANY, NULL, ANY, NULL, MADE_WITH_RESULTS},
    {"moments", TYPE_F8, COLS_ANY, NULL, ANY, NULL, MADE_WITH_RESULTS},
    {"gaps", TYPE_F8, COLS_ANY, NULL, ANY, NULL, MADE_WITH_RESULTS},
    {"energy", TYPE_F8, COLS_ANY, NULL, ANY, NULL, MADE_WITH_RESULTS},
};

const struct section_kind *section_kind_of(const char *name)
{
    size_t length;
    (void)frame_of(name, &length);
    for (int i = 0; i < SECTION_KINDS; i++) {
        if (strlen(section_kinds[i].name) == length && strncmp(section_kinds[i].name, name, length) == 0) {
            return &section_kinds[i];
        }
    }
    return NULL;
}

enum section_stage section_stage(const char *name)
{
    size_t first = strcspn(name, ".");
    const struct section_kind *own = section_kind_of(name);
    enum section_stage stage = own != NULL ? own->stage : MADE_ELSEWHERE;
    for (int i = 0; i < SECTION_KINDS && own == NULL; i++) {
        const struct section_kind *kind = &section_kinds[i];
        if (kind->stage < stage && kind->stage < MADE_WITH_RESULTS && strcspn(kind->name, ".") == first &&
            strncmp(kind->name, name, first) == 0) {
            stage = kind->stage;
        }
    }
    return stage;
}

void sections_remove(struct stream *stream, enum section_stage first, enum section_stage last)
{
    for (int64_t i = stream->section_count - 1; i >= 0; i--) {
        enum section_stage stage = section_stage(stream->sections[i].name);
        if (stage >= first && stage <= last) {
            stream_remove(stream, stream->sections[i].name);
        }
    }
}

int64_t frame_of(const char *name, size_t *length)
{
    static const char infix[] = ".frame.";
    struct error ignored;
    int64_t frame;
    const char *at = strstr(name, infix);
    *length = strlen(name);
    if (text_ends(name, ".frames")) {
        *length -= strlen(".frames");
        return FRAME_TABLE;
    }
    if (at == NULL || parse_integer(at + strlen(infix), name, 0, INT32_MAX, &frame, &ignored) != STATUS_OK) {
        return FRAME_NONE;
    }
    *length = (size_t)(at - name);
    return frame;
}
