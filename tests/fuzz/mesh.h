/* Fuzz targets of meshes: one for each family of formats, with its corpus and words. What is read is
 * consistent in itself, and is built or refused in one line. */
#pragma once

#include "fuzz.h"

#include "io/mesh/msh.h"

#include <math.h>

/* Sizes, indices and orders are as the header says. */
static void require_sound(const struct msh *msh, size_t size)
{
    int64_t members = 0;
    REQUIRE(msh->node_count <= (int64_t)size && msh->element_count <= 4 * (int64_t)size);
    for (int64_t i = 0; i < 3 * msh->node_count; i++) {
        REQUIRE(isfinite(msh->nodes[i / 3].x[i % 3]));
    }
    int64_t corners = 0;
    for (int64_t e = 0; e < msh->element_count; e++) {
        const struct msh_element *element = &msh->elements[e];
        REQUIRE(msh_type(element->type).name != NULL && element->first == corners);
        for (int end = (int)corners + msh_type(element->type).node_count; corners < end; corners++) {
            REQUIRE(msh->node_idx[corners] >= 0 && msh->node_idx[corners] < msh->node_count);
        }
        REQUIRE(element->group >= -1 && element->group < msh->group_count);
        REQUIRE(element->group < 0 || msh->groups[element->group].dim == msh_type(element->type).dim);
        members += element->group >= 0;
    }
    for (int32_t g = 0; g < msh->group_count; g++) {
        const struct msh_group *group = &msh->groups[g];
        REQUIRE(group->name[0] != '\0' && group->tag >= 0);
        REQUIRE(g == 0 || group->dim > group[-1].dim ||
                (group->dim == group[-1].dim && group->tag > group[-1].tag));
        members -= group->element_count;
    }
    REQUIRE(members == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FREED_BY(msh_free) struct msh msh = {0};
    FREED_BY(stream_free) struct stream stream = {0};
    struct error error = {""};
    if (!is_accepted(msh_parse(&msh, (const char *)data, size, NULL, &error), &error)) {
        REQUIRE(msh.nodes == NULL && msh.node_idx == NULL && msh.groups == NULL);
        return 0;
    }
    require_sound(&msh, size);
    (void)is_accepted(mesh_build(&msh, 1, NULL, &stream, &error), &error);
    return 0;
}
