/* Contact of the body with itself: the facets that a section names. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A facet of one of the two lists, by its nodes in order. */
struct listed {
    int32_t key[3];
    int list;
    int64_t facet;
};

static int compare_listed(const void *left, const void *right)
{
    const struct listed *a = left, *b = right;
    int order = memcmp(a->key, b->key, sizeof a->key);
    return order != 0           ? order
           : a->list != b->list ? a->list - b->list
                                : (a->facet > b->facet) - (a->facet < b->facet);
}

/* The facets of the groups; of * all on the boundary. */
static enum status read_list(struct model *model, const struct scene_contact *section,
                             const struct name_list *names, struct facet_set *set, bool *whole,
                             struct error *error)
{
    const struct faces *boundary = &model->assembly.boundary;
    *whole = names->count == 1 && strcmp(names->names[0], "*") == 0;
    if (*whole) {
        *set = (struct facet_set){boundary->count, boundary->node};
        return STATUS_OK;
    }
    return model_facets(model, &section->label, names, set, error);
}

/* Mean width of a list's facets, m. */
static double mean_width(const struct model *model, const struct facet_set *set)
{
    const struct cells *cells = &model->assembly.cells;
    double sum = 0.0;
    for (int64_t f = 0; f < set->count; f++) {
        double area[3] = {0.0, 0.0, 0.0};
        face_area_vector(cells->dim, cells->x, set->facet + f * cells->dim, area);
        double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        sum += cells->dim == 2 ? size : sqrt(size);
    }
    return sum / (double)set->count;
}

/* Sort the facets by their nodes and drop those that stand twice in one list. Returns how many are left;
 * *common receives how many facets are in both lists. */
static int64_t sort_out(struct listed *listed, int64_t count, int64_t *common)
{
    int64_t left = 0;
    qsort(listed, (size_t)count, sizeof *listed, compare_listed);
    *common = 0;
    for (int64_t i = 0; i < count; i++) {
        bool same = left > 0 && memcmp(listed[left - 1].key, listed[i].key, sizeof listed->key) == 0;
        if (!same || listed[left - 1].list != listed[i].list) {
            *common += same;
            listed[left++] = listed[i];
        }
    }
    return left;
}

static int compare_places(const void *left, const void *right)
{
    const struct listed *a = left, *b = right;
    return a->list != b->list ? a->list - b->list : (a->facet > b->facet) - (a->facet < b->facet);
}

enum status model_between(struct model *model, const struct scene_contact *section,
                          struct contact_condition *contact, struct error *error)
{
    enum status status;
    struct facet_set sets[2] = {{0}};
    bool whole[2];
    int dim = model->assembly.cells.dim;
    int64_t count = 0, common;
    struct listed *listed = NULL;
    int32_t *kept;
    TRY(read_list(model, section, &section->facets, &sets[0], &whole[0], error));
    TRY(read_list(model, section, &section->against, &sets[1], &whole[1], error));
    TRY(NEW_ARRAY(&listed, sets[0].count + sets[1].count, error));
    for (int list = 0; list < 2; list++) {
        for (int64_t f = 0; f < sets[list].count; f++, count++) {
            listed[count].list = list;
            listed[count].facet = f;
            face_key(dim, sets[list].facet + f * dim, listed[count].key);
        }
    }
    count = sort_out(listed, count, &common);
    if (common > 0 && 2 * common != count) {
        status =
            fail(error, STATUS_INPUT,
                 "%s: facets and against have %lld facets in common: name the same groups in both, of what "
                 "may touch itself, or groups without common facets",
                 section->label.where, (long long)common);
        goto done;
    }
    qsort(listed, (size_t)count, sizeof *listed, compare_places);
    TRY(NEW_ARRAY(&kept, count * dim, error));
    TRY(model_own(model, kept, error));
    struct facet_set lists[2] = {{0, kept}, {0, kept}};
    for (int64_t i = 0; i < count; i++) {
        const int32_t *nodes = sets[listed[i].list].facet + listed[i].facet * dim;
        memcpy(kept + i * dim, nodes, (size_t)dim * sizeof *kept);
        lists[listed[i].list].count++;
    }
    lists[1].facet = common > 0 ? kept : kept + lists[0].count * dim;
    /* Points of the finer ones press on the others. */
    bool finer = common > 0 || mean_width(model, &lists[0]) <= mean_width(model, &lists[1]);
    contact->facets = lists[finer ? 0 : 1];
    contact->opposite = lists[finer ? 1 : 0];
    contact->sign = finer ? 1 : -1;
    contact->whole = whole[0] && whole[1];
done:
    free(listed);
    return status;
}
