/* Contact of the body with itself: the facets that a section names. */
#include "mtled/model.h"

#include "base/vector.h"

/* Mean width of a list's facets, m. */
static double mean_width(const struct model *model, const struct facet_set *set)
{
    const struct cells *cells = &model->assembly.cells;
    double sum = 0.0;
    for (int64_t f = 0; f < set->count; f++) {
        double area[3];
        face_area_vector(cells->dim, cells->x, set->facet + f * cells->dim, area);
        double size = vector_length(cells->dim, area);
        sum += cells->dim == 2 ? size : sqrt(size);
    }
    return sum / (double)set->count;
}

enum status model_between(struct model *model, const struct scene_contact *section,
                          struct contact_condition *contact, struct error *error)
{
    const struct faces *boundary = &model->assembly.boundary;
    struct facet_set lists[2] = {{0}};
    int64_t common = 0;
    RETURN_IF_ERROR(model_facets(model, &section->label, &section->facets, &lists[0], error));
    RETURN_IF_ERROR(model_facets(model, &section->label, &section->against, &lists[1], error));
    NEW_SCRATCH(bool, listed, boundary->count, error);
    NEW_SCRATCH(int64_t, face, lists[0].count > lists[1].count ? lists[0].count : lists[1].count, error);
    for (int list = 0; list < 2; list++) {
        RETURN_IF_ERROR(faces_find(boundary, lists[list].count, lists[list].facet, face, error));
        for (int64_t f = 0; f < lists[list].count; f++) {
            if (face[f] >= 0) {
                common += list == 1 && listed[face[f]];
                listed[face[f]] = true;
            }
        }
    }
    if (common > 0 && (common != lists[0].count || common != lists[1].count)) {
        return fail(error, STATUS_INPUT,
                    "%s: facets and against have %jd facets in common: name the same groups in both, of what "
                    "may touch itself, or groups without common facets",
                    section->label.where, common);
    }
    if (common > 0) {
        lists[1] = lists[0];
    }
    /* The points of the finer facets press on the others. */
    bool finer = common > 0 || mean_width(model, &lists[0]) <= mean_width(model, &lists[1]);
    contact->facets = lists[finer ? 0 : 1];
    contact->opposite = lists[finer ? 1 : 0];
    contact->sign = finer ? 1 : -1;
    contact->whole = model_is_whole(&section->facets) && model_is_whole(&section->against);
    return STATUS_OK;
}
