#include "model_prescription.h"

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

bool model_holds_averages(const struct model_input *input)
{
    const struct scene_solver *solver = &input->scene->solver;
    return solver->constraint_points == SCENE_HAT_AVERAGES && solver->constraints == SCENE_EBCIEM;
}

/* Mark the faces whose nodes are all stamped with the section's number. */
static void hold_faces(const struct faces *faces, int dim, const int64_t *stamp, int64_t section, bool *held)
{
    for (int64_t f = 0; f < faces->count; f++) {
        bool is_held = true;
        for (int k = 0; k < dim; k++) {
            is_held = is_held && stamp[faces->node[f * dim + k]] == section;
        }
        held[f] = held[f] || is_held;
    }
}

enum status model_held_faces(const struct model_input *input, int least, bool **held, struct error *error)
{
    enum status status;
    int dim = input->cells.dim;
    int64_t *stamp = NULL; /* of each node: the last section that names it, from 1 on */
    int32_t *owned = NULL;
    TRY(NEW_ARRAY(held, input->boundary.count, error));
    TRY(NEW_ARRAY(&stamp, input->cells.node_count, error));
    for (int64_t i = 0; i < input->scene->displacement_count; i++) {
        const struct scene_displacement *section = &input->scene->displacements[i];
        struct facet_set set;
        if (section->facets.count == 0 || prescription_directions(section, dim) < least) {
            continue;
        }
        TRY(model_facets(input, &section->label, &section->facets, &set, &owned, error));
        for (int64_t k = 0; k < set.count * dim; k++) {
            stamp[set.facet[k]] = i + 1;
        }
        hold_faces(&input->boundary, dim, stamp, i + 1, *held);
        free(owned);
        owned = NULL;
    }
done:
    free(owned);
    free(stamp);
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
