/* Displacements, loads, supports and contacts of a scene, as input of assembly. */
#include "mtled/model.h"

#include "base/box.h"
#include "base/vector.h"
#include "io/files/surface.h"
#include "io/files/table.h"

#include <math.h>
#include <string.h>

/* A group is smaller than another by its size, and far coarser by the width of its facets. */
static const double smaller = 0.9, coarser = 2.0;

enum status model_add_curve(struct model *model, const struct scene_label *label,
                            const struct scene_curve *curve, int32_t *index, struct error *error)
{
    struct assembly *input = &model->assembly;
    FREED_BY(table_free) struct table table = {0};
    RETURN_IF_ERROR(RESIZE_ARRAY(&input->curves, input->curve_count + 1, error));
    struct load_curve *added = &input->curves[input->curve_count];
    if (curve->kind != CURVE_TABLE) {
        *added = curve_of_kind(curve->kind);
    } else {
        double end = input->in_time                 ? model->scene->solver.end_time
                     : model->scene->duration > 0.0 ? model->scene->duration
                                                    : 1.0;
        RETURN_IF_ERROR(fail_in(error, table_read(curve->file, 2, 2, &table, error),
                                "%s: curve: not smooth, linear or step, and as a file", label->where));
        RETURN_IF_ERROR(fail_in(error,
                                curve_tabulate(added, table.rows, table.values, end, input->in_time, error),
                                "%s: curve %s", label->where, curve->file));
    }
    *index = (int32_t)input->curve_count++;
    return STATUS_OK;
}

static enum status add_displacement(struct model *model, const struct scene_displacement *section,
                                    struct condition *condition, struct error *error)
{
    int dim = model->assembly.cells.dim;
    FREED_BY(table_free) struct table table = {0};
    *condition = section->condition;
    condition->name = section->label.name;
    condition->where = section->label.where;
    RETURN_IF_ERROR(model_add_curve(model, &section->label, &section->curve, &condition->curve, error));
    if (condition->kind == CONDITION_POINTS) {
        return model_points(model, section, condition, error);
    }
    if (condition->kind == CONDITION_TABLE) {
        RETURN_IF_ERROR(table_read(condition->table, 2 * dim, 2 * dim, &table, error));
        condition->row_count = table.rows;
        condition->rows = table.values;
        table.values = NULL;
        RETURN_IF_ERROR(model_own(model, (void *)condition->rows, error));
    }
    if (section->facets.count > 0) {
        RETURN_IF_ERROR(model_facets(model, &section->label, &section->facets, &condition->facets, error));
    } else {
        RETURN_IF_ERROR(model_nodes(model, &section->label, &section->nodes, &condition->nodes,
                                    &condition->node_count, error));
    }
    return STATUS_OK;
}

static enum status add_load(struct model *model, const struct scene_load *section, struct load *load,
                            struct error *error)
{
    *load = section->load;
    if (load->kind == LOAD_FORCE) {
        RETURN_IF_ERROR(
            model_nodes(model, &section->label, &section->nodes, &load->nodes, &load->node_count, error));
    } else {
        RETURN_IF_ERROR(model_facets(model, &section->label, &section->facets, &load->facets, error));
    }
    if (section->density > 0.0) { /* a fluid */
        const double *own = section->gravity;
        const double *gravity = vector_dot(3, own, own) > 0.0 ? own : model->scene->gravity;
        if (!(vector_dot(3, gravity, gravity) > 0.0)) {
            return fail(error, STATUS_INPUT,
                        "%s: density: a fluid without weight: give gravity here or in [scene]",
                        section->label.where);
        }
        load->is_fluid = true;
        add_scaled(3, section->density, gravity, load->weight);
    }
    return model_add_curve(model, &section->label, &section->curve, &load->curve, error);
}

/* The diagonal of the box around some facets, and their mean width, m. */
struct extent {
    double size, width;
};

static struct extent extent_of(const struct model *model, const struct facet_set *set)
{
    const struct cells *cells = &model->assembly.cells;
    struct box box = box_of_nodes(cells->dim, cells->x, set->facet, set->count * cells->dim);
    struct extent extent = {box_diagonal(&box), 0.0};
    for (int64_t f = 0; f < set->count; f++) {
        double area[3];
        face_area_vector(cells->dim, cells->x, set->facet + f * cells->dim, area);
        double size = vector_length(cells->dim, area);
        extent.width += (cells->dim == 2 ? size : sqrt(size)) / (double)set->count;
    }
    return extent;
}

/* Whether the points of the first group press on the other, not the reverse: they do if it is smaller, as its
 * edges stand on the inside of the other one, unless its facets are far coarser; of equal groups if it is
 * finer. */
static bool has_points(struct extent first, struct extent other)
{
    if (first.size < smaller * other.size) {
        return first.width < coarser * other.width;
    }
    if (other.size < smaller * first.size) {
        return !(other.width < coarser * first.width);
    }
    return first.width <= other.width;
}

/* The facets of the body that may touch each other by a section. */
static enum status add_between(struct model *model, const struct scene_contact *section,
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
    bool first = common > 0 || has_points(extent_of(model, &lists[0]), extent_of(model, &lists[1]));
    contact->facets = lists[first ? 0 : 1];
    contact->opposite = lists[first ? 1 : 0];
    contact->sign = first ? 1 : -1;
    contact->whole = model_is_whole(&section->facets) && model_is_whole(&section->against);
    return STATUS_OK;
}

static enum status add_contact(struct model *model, const struct scene_contact *section,
                               struct contact_condition *contact, struct error *error)
{
    struct rigid_motion *motion = &contact->motion;
    double *corners = NULL;
    *contact = section->condition;
    contact->where = section->label.where;
    if (section->against.count > 0) {
        return add_between(model, section, contact, error);
    }
    RETURN_IF_ERROR(model_facets(model, &section->label, &section->facets, &contact->facets, error));
    RETURN_IF_ERROR(surface_facets(section->rigid, model->assembly.cells.dim, section->rigid_unit, &corners,
                                   &contact->rigid_count, error));
    contact->corners = corners;
    RETURN_IF_ERROR(model_own(model, corners, error));
    contact->flip = section->side == SCENE_LEFT || section->side == SCENE_BACK;
    if (!motion->moves) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(
        model_add_curve(model, &section->label, &section->curve, &motion->translation_curve, error));
    return model_add_curve(model, &section->label, &section->angle_curve, &motion->rotation_curve, error);
}

static enum status add_support(struct model *model, const struct scene_support *section,
                               struct support_condition *support, struct error *error)
{
    const struct scene_curve any = {.kind = CURVE_SMOOTH};
    *support = section->condition;
    support->where = section->label.where;
    RETURN_IF_ERROR(model_facets(model, &section->label, &section->facets, &support->facets, error));
    return model_add_curve(model, &section->label, &any, &support->curve, error);
}

static enum status add_membrane(struct model *model, const struct scene_membrane *section,
                                struct membrane_condition *membrane, struct error *error)
{
    *membrane = section->condition;
    membrane->where = section->label.where;
    RETURN_IF_ERROR(model_add_curve(model, &section->label, &section->curve, &membrane->law.curve, error));
    return model_facets(model, &section->label, &section->facets, &membrane->facets, error);
}

/* In time gravity acts from the start; in other scenes it grows smoothly. */
static enum status add_gravity(struct model *model, struct error *error)
{
    struct assembly *input = &model->assembly;
    bool from_start = input->in_time || model->scene->duration > 0.0;
    const struct scene_curve curve = {.kind = from_start ? CURVE_STEP : CURVE_SMOOTH};
    memcpy(input->gravity, model->scene->gravity, sizeof input->gravity);
    return vector_dot(3, input->gravity, input->gravity) > 0.0
               ? model_add_curve(model, NULL, &curve, &input->gravity_curve, error)
               : STATUS_OK;
}

/* input->ITEMs: one for each of scene->SECTIONs, made of it by `add`. */
#define ADD_EACH(type, item, section, add)                                                                   \
    do {                                                                                                     \
        struct type *added;                                                                                  \
        input->item##_count = scene->section##_count;                                                        \
        RETURN_IF_ERROR(MODEL_ARRAY(model, &added, input->item##_count, error));                             \
        input->item##s = added;                                                                              \
        for (int64_t i = 0; i < input->item##_count; i++) {                                                  \
            RETURN_IF_ERROR(add(model, &scene->section##s[i], &added[i], error));                            \
        }                                                                                                    \
    } while (0)

enum status model_conditions(struct model *model, struct error *error)
{
    const struct scene *scene = model->scene;
    struct assembly *input = &model->assembly;
    input->in_time = scene->analysis == SCENE_DYNAMIC;
    input->pointwise_volume = scene->solver.pointwise_volume;
    input->tolerance = scene->solver.tolerance;
    input->node_values = scene->solver.node_values;
    input->direct = scene->solver.direct;
    ADD_EACH(condition, condition, displacement, add_displacement);
    RETURN_IF_ERROR(add_gravity(model, error));
    ADD_EACH(load, load, load, add_load);
    ADD_EACH(support_condition, support, support, add_support);
    ADD_EACH(membrane_condition, membrane, membrane, add_membrane);
    ADD_EACH(contact_condition, contact, contact, add_contact);
    return STATUS_OK;
}

enum status model_initial(const struct model *model, double *u, double *v, struct error *error)
{
    const struct scene_initial *initial = &model->scene->initial;
    const struct cells *cells = &model->assembly.cells;
    int dim = cells->dim;
    FREED_BY(table_free) struct table table = {0};
    RETURN_IF_ERROR(table_read(initial->table, 3 * dim, 3 * dim, &table, error));
    if (table.rows != cells->node_count) {
        return fail(error, STATUS_INPUT, "%s: [initial]: table %s: %jd rows for %jd nodes: give one for each",
                    model->scene->path, initial->table, table.rows, cells->node_count);
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        const double *row = table.values + n * table.cols;
        if (!(model_away(model, row, initial->table_unit, cells->x + n * dim) <= MODEL_SAME_PLACE)) {
            return fail(error, STATUS_INPUT,
                        "%s:%jd: not the place of node %jd: give the nodes in the order of the mesh",
                        initial->table, table.line[n], n);
        }
        for (int a = 0; a < dim; a++) {
            u[n * dim + a] = row[dim + a] * initial->table_unit;
            v[n * dim + a] = row[2 * dim + a] * initial->table_unit;
        }
    }
    return STATUS_OK;
}
