/* Joins a stream (cloud, tables of shape functions) and a scene into a system ready for time stepping. */
#pragma once

#include "stages/stages.h"

#include "base/memory.h"
#include "io/scene/scene.h"
#include "solid/assembly/assembly.h"

struct model {
    const struct stream *stream;
    const struct scene *scene;
    struct assembly assembly; /* views of the stream, and arrays in `owned` */
    struct owned owned;
    struct solid_system system;
    struct error note;       /* a remark on the scene; empty text: none */
    struct error interfaces; /* a remark on interfaces between materials */
    double *row_force; /* system.rows.count: force of each constraint along its direction, N (2D: N/m), once
                          solved */
};

/* Build the whole system; the stream and the scene must outlive the model, which stays where it is. Regions
 * without a material are an error that names them. Tables that the body copies leave the stream. */
MUST_CHECK enum status model_build(struct stream *stream, const struct scene *scene, struct model *model,
                                   struct error *error);
void model_free(struct model *model);

/* Steps of model_build, in their own files: displacements, loads and contacts, with their curves, facets,
 * nodes and tables. */
MUST_CHECK enum status model_conditions(struct model *model, struct error *error);
/* Append a curve; *index receives its number. */
MUST_CHECK enum status model_add_curve(struct model *model, const struct scene_label *label,
                                       const struct scene_curve *curve, int32_t *index, struct error *error);
/* The directions of fibres from the table of section m, or the stream: an own material for each of its
 * points. */
MUST_CHECK enum status model_fibres(struct model *model, int64_t m, struct error *error);
/* Let supports stop where the stiffness jumps within a region, as a table of moduli may, and the stiffer side
 * own each interface: number the sides by stiffness and make the tables of the stream anew. Set
 * model->interfaces if supports still reach across a jump. */
MUST_CHECK enum status model_interfaces(struct model *model, struct stream *stream, bool *renewed,
                                        struct error *error);
/* Read measured points, and set the field there; assembly compares and adds them. */
MUST_CHECK enum status model_points(struct model *model, const struct scene_displacement *section,
                                    struct condition *condition, struct error *error);

/* *pointer = zeros that the model frees. */
#define MODEL_ARRAY(model, pointer, count, error)                                                            \
    model_own((model), *(pointer) = array_new((count), sizeof **(pointer)), (error))

/* Let the model free an array, also on failure; STATUS_SYSTEM if it is NULL. */
static inline enum status model_own(struct model *model, void *array, struct error *error)
{
    return owned_add(&model->owned, array, "conditions", error);
}

/* Whether the names are an asterisk: the whole boundary. */
bool model_is_whole(const struct name_list *names);

/* The facets of the named groups, or of the whole boundary, and the nodes of the named sets, ascending: each
 * once, though groups overlap. The model owns them. An error lists the groups that exist. */
MUST_CHECK enum status model_facets(struct model *model, const struct scene_label *label,
                                    const struct name_list *names, struct facet_set *set,
                                    struct error *error);
MUST_CHECK enum status model_nodes(struct model *model, const struct scene_label *label,
                                   const struct name_list *names, const int32_t **nodes, int64_t *count,
                                   struct error *error);

/* u, v[node_count * dim]: the initial state given by the scene's [initial], as parameters, m and m/s. */
MUST_CHECK enum status model_initial(const struct model *model, double *u, double *v, struct error *error);

/* The largest distance along an axis between the place at the start of a table's row and x[dim], as a share
 * of the body's extent. A row belongs to x if this is at most MODEL_SAME_PLACE. */
double model_away(const struct model *model, const double *row, double unit, const double *x);
#define MODEL_SAME_PLACE 1e-5

/* Lengths beyond so many sizes of the body are refused. */
#define MODEL_MOST_SIZES 1e4
