#include "model.h"

#include <stdlib.h>
#include <string.h>

enum status model_facets(struct model *model, const struct scene_label *label, const struct name_list *names,
                         struct facet_set *set, struct error *error)
{
    enum status status;
    const struct section *groups;
    struct named_facets facets;
    struct names present = {0};
    bool *wanted = NULL;
    int32_t *chosen;
    int dim = model->assembly.cells.dim;
    *set = (struct facet_set){0};
    if (stream_find(model->stream, "facets") == NULL || stream_find(model->stream, "facets.set") == NULL) {
        return fail(error, STATUS_INPUT, "%s: no named facets: give the mesh physical groups, or run groups",
                    label->where);
    }
    TRY(stream_facets(model->stream, true, dim, &facets, error));
    for (int64_t i = 0; i < facets.count * dim; i++) {
        if (facets.facet[i] < 0 || facets.facet[i] >= model->assembly.cells.node_count) {
            TRY(fail(error, STATUS_INPUT, "facets: no node %d", facets.facet[i]));
        }
    }
    TRY(stream_need(model->stream, "facets.set", TYPE_I4, 1, "nodes", &groups, error));
    TRY(names_read(groups, &present, error));
    TRY(NEW_ARRAY(&wanted, present.count, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t group = names_find(&present, names->names[i]);
        if (group < 0) {
            status = fail(error, STATUS_INPUT, "%s: the mesh has no facet group '%s'; present: %s",
                          label->where, names->names[i], present.count > 0 ? present.list : "none");
            goto done;
        }
        wanted[group] = true;
    }
    TRY(MODEL_ARRAY(model, &chosen, facets.count * dim, error));
    for (int64_t f = 0; f < facets.count; f++) {
        if (facets.set[f] >= 0 && facets.set[f] < present.count && wanted[facets.set[f]]) {
            memcpy(chosen + set->count * dim, facets.facet + f * dim, (size_t)dim * sizeof *chosen);
            set->count++;
        }
    }
    set->facet = chosen;
    if (set->count == 0) {
        status = fail(error, STATUS_INPUT, "%s: its facet groups are empty", label->where);
    }
done:
    names_free(&present);
    free(wanted);
    return status;
}

enum status model_nodes(struct model *model, const struct scene_label *label, const struct name_list *names,
                        const int32_t **nodes, int64_t *count, struct error *error)
{
    enum status status;
    const struct section *ptr, *idx;
    struct neighbours sets;
    struct names present = {0};
    bool *member = NULL;
    int32_t *chosen;
    int64_t node_count = model->assembly.cells.node_count;
    *count = 0;
    TRY(stream_need(model->stream, "sets.ptr", TYPE_I8, 1, "nodes", &ptr, error));
    TRY(stream_need(model->stream, "sets.idx", TYPE_I4, 1, "nodes", &idx, error));
    TRY(stream_neighbours(model->stream, "sets", ptr->rows - 1, node_count, &sets, error));
    TRY(names_read(ptr, &present, error));
    TRY(NEW_ARRAY(&member, node_count, error));
    for (int64_t i = 0; i < names->count; i++) {
        int64_t set = names_find(&present, names->names[i]);
        if (set < 0 || set >= sets.count) {
            status = fail(error, STATUS_INPUT, "%s: the mesh has no node set '%s'; present: %s", label->where,
                          names->names[i], present.count > 0 ? present.list : "none");
            goto done;
        }
        for (int64_t k = sets.ptr[set]; k < sets.ptr[set + 1]; k++) {
            member[sets.idx[k]] = true;
        }
    }
    TRY(MODEL_ARRAY(model, &chosen, node_count, error));
    *nodes = chosen;
    for (int64_t n = 0; n < node_count; n++) {
        if (member[n]) {
            chosen[(*count)++] = (int32_t)n;
        }
    }
done:
    names_free(&present);
    free(member);
    return status;
}
