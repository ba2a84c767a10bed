#include "model.h"

#include "names.h"

#include <stdlib.h>
#include <string.h>

enum status model_facets(const struct model_input *input, const struct scene_label *label,
                         const struct name_list *names, struct facet_set *set, int32_t **owned,
                         struct error *error)
{
    enum status status;
    const struct section *groups;
    struct named_facets facets;
    char *present = NULL;
    bool *wanted = NULL;
    int dim = input->cells.dim;
    *set = (struct facet_set){0};
    TRY(stream_facets(input->stream, true, dim, &facets, error));
    TRY(stream_need(input->stream, "facets.set", TYPE_I4, 1, "nodes", &groups, error));
    TRY(names_of_section(groups, &present, error));
    int64_t most = (int64_t)strlen(present) + 1; /* groups, at the most */
    TRY(NEW_ARRAY(&wanted, most, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t group = names_index(present, names->names[i]);
        if (group < 0) {
            status = scene_fail(error, STATUS_INPUT, input->scene, label,
                                "the mesh has no facet group '%s'; present: %s", names->names[i],
                                present[0] != '\0' ? present : "none");
            goto done;
        }
        wanted[group] = true;
    }
    TRY(NEW_ARRAY(owned, facets.count * dim, error));
    for (int64_t f = 0; f < facets.count; f++) {
        if (facets.set[f] >= 0 && facets.set[f] < most && wanted[facets.set[f]]) {
            memcpy(*owned + set->count * dim, facets.facet + f * dim, (size_t)dim * sizeof **owned);
            set->count++;
        }
    }
    set->facet = *owned;
    if (set->count == 0) {
        status = scene_fail(error, STATUS_INPUT, input->scene, label, "its facet groups are empty");
    }
done:
    free(present);
    free(wanted);
    return status;
}

enum status model_nodes(const struct model_input *input, const struct scene_label *label,
                        const struct name_list *names, int32_t **nodes, int64_t *count, struct error *error)
{
    enum status status;
    const struct section *ptr, *idx;
    struct neighbours sets;
    char *present = NULL;
    bool *member = NULL;
    *count = 0;
    TRY(stream_need(input->stream, "sets.ptr", TYPE_I8, 1, "nodes", &ptr, error));
    TRY(stream_need(input->stream, "sets.idx", TYPE_I4, 1, "nodes", &idx, error));
    TRY(stream_neighbours(input->stream, "sets", ptr->rows - 1, input->cells.node_count, &sets, error));
    TRY(names_of_section(ptr, &present, error));
    TRY(NEW_ARRAY(&member, input->cells.node_count, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t set = names_index(present, names->names[i]);
        if (set < 0 || set >= sets.count) {
            status = scene_fail(error, STATUS_INPUT, input->scene, label,
                                "the mesh has no node set '%s'; present: %s", names->names[i],
                                present[0] != '\0' ? present : "none");
            goto done;
        }
        for (int64_t k = sets.ptr[set]; k < sets.ptr[set + 1]; k++) {
            member[sets.idx[k]] = true;
        }
    }
    TRY(NEW_ARRAY(nodes, input->cells.node_count, error));
    for (int64_t n = 0; n < input->cells.node_count; n++) {
        if (member[n]) {
            (*nodes)[(*count)++] = (int32_t)n;
        }
    }
done:
    free(present);
    free(member);
    return status;
}
