/* Joins a stream (cloud, table of shape functions) and a scene into a system ready to be stepped. */
#pragma once

#include "stages/tables.h"
#include "stages/views.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/scene/scene.h"
#include "solid/assembly/assembly.h"

struct model {
    const struct stream *stream;
    const struct scene *scene;
    struct assembly assembly; /* what they give: views into the stream, and arrays of its own */
    struct owned owned;       /* these */
    struct solid_system system;
    struct error note;       /* a remark on the scene that is no error; empty text: none */
    struct error interfaces; /* another, on interfaces between materials */
    double *row_force; /* system.rows.count: force of each constraint along its direction, N (2D: N/m), once
                          solved */
};

/* Build the whole system; the stream and the scene must outlive the model, which stays where it is. Regions
 * without a material are an error that names them. Tables that the body copies leave the stream. face_reader
 * as in struct parts_input. */
MUST_CHECK enum status model_build(struct stream *stream, const int32_t *face_reader,
                                   const struct scene *scene, struct model *model, struct error *error);
void model_free(struct model *model);

/* The parts of the scene, in their own files: materials of regions and points; and displacements, loads and
 * contacts, with their curves, facets, nodes and tables. */
MUST_CHECK enum status model_materials(struct model *model, struct error *error);
MUST_CHECK enum status model_conditions(struct model *model, struct error *error);
/* Set model->interfaces: where supports reach across an interface between materials of unequal stiffness and
 * stress is asked for, or where what lies on the interface belongs to the softer side. */
MUST_CHECK enum status model_interfaces(struct model *model, struct error *error);
/* Measured points: what is read of them, and the field there; compared and added by the assembly. */
MUST_CHECK enum status model_points(struct model *model, const struct scene_displacement *section,
                                    struct condition *condition, struct error *error);

/* *pointer = zeros that the model frees. */
#define MODEL_ARRAY(model, pointer, count, error)                                                            \
    model_own((model), *(pointer) = array_new((count), sizeof **(pointer)), (error))

/* An array that the model frees, also on failure; STATUS_SYSTEM where it is NULL. */
static inline enum status model_own(struct model *model, void *array, struct error *error)
{
    return owned_add(&model->owned, array, "conditions", error);
}

/* Whether the names are an asterisk: the whole boundary. */
bool model_is_whole(const struct name_list *names);

/* The facets of the named groups, or of the whole boundary, and the nodes of the named sets, ascending; the
 * model owns them. An error lists the groups that exist. */
MUST_CHECK enum status model_facets(struct model *model, const struct scene_label *label,
                                    const struct name_list *names, struct facet_set *set,
                                    struct error *error);
MUST_CHECK enum status model_nodes(struct model *model, const struct scene_label *label,
                                   const struct name_list *names, const int32_t **nodes, int64_t *count,
                                   struct error *error);

/* Facets of the body that may touch others of it: what the section names, each once. */
MUST_CHECK enum status model_between(struct model *model, const struct scene_contact *section,
                                     struct contact_condition *contact, struct error *error);

/* Build the contacts again, at rest, with those that have been added to the scene since. */
MUST_CHECK enum status model_renew_contacts(struct model *model, struct error *error);

/* u, v[node_count * dim]: the state at the begin that the scene's [initial] gives, m and m/s, as parameters.
 */
MUST_CHECK enum status model_initial(const struct model *model, double *u, double *v, struct error *error);

/* How far the place that a table's row begins with is from x[dim], along the axis where that is most, as a
 * share of the body's extent; rows that belong to x are no further away than MODEL_SAME_PLACE. */
double model_away(const struct model *model, const double *row, double unit, const double *x);
#define MODEL_SAME_PLACE 1e-5
