#include "mtled/model.h"

#include <string.h>

/* The facet groups or node sets of the stream, and (*wanted)[groups->names.count], to be freed: whether each
 * is among the names. */
static enum status choose(const struct model *model, const struct scene_label *label,
                          const struct name_list *names, enum group_kind kind, struct groups *groups,
                          bool **wanted, struct error *error)
{
    bool facets = kind == GROUP_FACETS;
    RETURN_IF_ERROR(
        fail_in(error, stream_groups(model->stream, kind, false, groups, error), "%s", label->where));
    if (groups->names.count == 0) {
        return fail(error, STATUS_INPUT,
                    facets ? "%s: no named facets: give the mesh physical groups, or run tag"
                           : "%s: no node sets: run tag -n",
                    label->where);
    }
    RETURN_IF_ERROR(NEW_ARRAY(wanted, groups->names.count, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t group;
        RETURN_IF_ERROR(fail_in(
            error,
            names_need(&groups->names, facets ? "facet group" : "node set", names->names[i], &group, error),
            "%s", label->where));
        (*wanted)[group] = true;
    }
    return STATUS_OK;
}

bool model_is_whole(const struct name_list *names)
{
    return names->count == 1 && strcmp(names->names[0], "*") == 0;
}

enum status model_facets(struct model *model, const struct scene_label *label, const struct name_list *names,
                         struct facet_set *set, struct error *error)
{
    const struct faces *boundary = &model->assembly.boundary;
    FREED_BY(groups_free) struct groups facets = {0};
    SCRATCH bool *wanted = NULL;
    int32_t *chosen;
    int dim = model->assembly.cells.dim;
    *set = (struct facet_set){0};
    if (model_is_whole(names)) {
        *set = (struct facet_set){boundary->count, boundary->node};
        return STATUS_OK;
    }
    for (int64_t i = 0; i < names->count; i++) {
        if (strcmp(names->names[i], "*") == 0) {
            return fail(error, STATUS_INPUT, "%s: *, the whole boundary, stands alone", label->where);
        }
    }
    RETURN_IF_ERROR(choose(model, label, names, GROUP_FACETS, &facets, &wanted, error));
    RETURN_IF_ERROR(MODEL_ARRAY(model, &chosen, facets.count * dim, error));
    NEW_SCRATCH(int64_t, face, facets.count, error);
    RETURN_IF_ERROR(faces_find(boundary, facets.count, facets.node, face, error));
    NEW_SCRATCH(bool, taken, boundary->count, error);
    for (int64_t f = 0; f < facets.count; f++) {
        if (!wanted[facets.group[f]] || (face[f] >= 0 && taken[face[f]])) {
            continue;
        }
        if (face[f] >= 0) {
            taken[face[f]] = true;
        }
        memcpy(chosen + set->count++ * dim, facets.node + f * dim, (size_t)dim * sizeof *chosen);
    }
    set->facet = chosen;
    if (set->count == 0) {
        return fail(error, STATUS_INPUT, "%s: its facet groups are empty", label->where);
    }
    return STATUS_OK;
}

enum status model_nodes(struct model *model, const struct scene_label *label, const struct name_list *names,
                        const int32_t **nodes, int64_t *count, struct error *error)
{
    FREED_BY(groups_free) struct groups sets = {0};
    SCRATCH bool *wanted = NULL;
    int32_t *chosen;
    int64_t node_count = model->assembly.cells.node_count;
    *count = 0;
    RETURN_IF_ERROR(choose(model, label, names, GROUP_NODES, &sets, &wanted, error));
    NEW_SCRATCH(bool, member, node_count, error);
    for (int64_t i = 0; i < sets.count; i++) {
        member[sets.node[i]] |= wanted[sets.group[i]];
    }
    RETURN_IF_ERROR(MODEL_ARRAY(model, &chosen, node_count, error));
    *nodes = chosen;
    for (int64_t n = 0; n < node_count; n++) {
        if (member[n]) {
            chosen[(*count)++] = (int32_t)n;
        }
    }
    return STATUS_OK;
}
