/* Joins a stream (cloud, table of shape functions) and a scene into a system ready to be stepped. */
#ifndef TOOLS_MODEL_H
#define TOOLS_MODEL_H

#include "stages.h"

#include "approx/boundary.h"
#include "io/scene.h"
#include "solid/system.h"

/* Views into the stream that the parts of a model are built from. */
struct model_input {
    const struct stream *stream;
    const struct scene *scene;
    struct cells cells;
    const struct section *points, *weight, *point_cell;
    bool smoothed;            /* the points are cells */
    struct neighbours lists;  /* of the points; or, of smoothed cells, of the faces */
    const double *phi, *dphi; /* following these; dphi NULL: averages over faces */
    struct neighbours boundary_lists, node_lists;
    const double *boundary_phi, *node_phi;
    struct faces faces, boundary; /* and the first of them, on the boundary */
    struct face_table face_table;
    int32_t *cell_material; /* material of each cell; owned */
    double extent;          /* diagonal of the box of the nodes, m */
};

struct model {
    struct model_input input;
    struct solid_system system;
    const char **condition_names; /* of the scene's displacements: system.condition_names */
    struct error note;            /* a remark on the scene that is no error; empty text: none */
    double *row_force; /* system.rows.count: force of each constraint along its direction, N (2D: N/m), once
                          solved */
};

/* Check that the stream has all of it, and that it fits. Regions without a material are an error that names
 * them. */
MUST_CHECK enum status model_input_read(const struct stream *stream, const struct scene *scene,
                                        struct model_input *input, struct error *error);
void model_input_free(struct model_input *input);

/* Build the whole system; the stream and the scene must outlive
 * the model. */
MUST_CHECK enum status model_build(const struct stream *stream, const struct scene *scene,
                                   struct model *model, struct error *error);
void model_free(struct model *model);

/* The parts of model_build, in their own files. */
MUST_CHECK enum status model_add_constraints(const struct model_input *input, struct solid_system *system,
                                             struct error *note, struct error *error);
MUST_CHECK enum status model_add_points(const struct model_input *input, struct solid_system *system,
                                        struct error *note, struct error *error);
MUST_CHECK enum status model_add_loads(const struct model_input *input, struct solid_system *system,
                                       struct error *error);
MUST_CHECK enum status model_add_contacts(const struct model_input *input, struct solid_system *system,
                                          struct error *error);

/* Materials of the scene, then one for each row of its tables of points; to be freed also on failure. */
struct material_list {
    struct material *items; /* count */
    int64_t count;
    int32_t *of_point; /* of each integration point */
    int32_t *section;  /* count: the scene's section of each */
};
MUST_CHECK enum status model_materials(const struct model_input *input, struct material_list *list,
                                       struct error *error);
/* The same with softer cells at the ends of what is held by averages; smoothed cells, one point for each. The
 * list was filled by model_materials. */
MUST_CHECK enum status model_soften_ends(const struct model_input *input, struct material_list *list,
                                         struct error *error);
void material_list_free(struct material_list *list);

/* The facets of the named groups; the error lists the groups that exist. set->facet is owned by the caller
 * (free the array through *owned). */
MUST_CHECK enum status model_facets(const struct model_input *input, const struct scene_label *label,
                                    const struct name_list *names, struct facet_set *set, int32_t **owned,
                                    struct error *error);

/* The nodes of the named sets, ascending; *nodes is owned by the caller. */
MUST_CHECK enum status model_nodes(const struct model_input *input, const struct scene_label *label,
                                   const struct name_list *names, int32_t **nodes, int64_t *count,
                                   struct error *error);

/* Append the curve of a section; *index receives its number. */
MUST_CHECK enum status model_add_curve(const struct model_input *input, const struct scene_label *label,
                                       const struct scene_curve *curve, struct solid_system *system,
                                       int32_t *index, struct error *error);

/* The modulus of penalties, Pa: that of pressure waves, but at most `factor` times the shear modulus, so that
 * it does not grow with the bulk modulus; the largest of the body's materials. */
double model_penalty_modulus(const struct solid_system *system, double factor);

/* Whether displacements are prescribed to averages over the facets of the boundary, not at nodes. */
bool model_holds_averages(const struct model_input *input);

/* held[boundary.count]: whether all nodes of that face are those of facets that one displacement section
 * names; the caller's to free. */
MUST_CHECK enum status model_held_faces(const struct model_input *input, bool **held, struct error *error);

/* u, v[node_count * dim]: the state at the begin that the scene's [initial] gives, m and m/s, as parameters.
 */
MUST_CHECK enum status model_initial(const struct model_input *input, double *u, double *v,
                                     struct error *error);

/* How far the place that a table's row begins with is from x[dim], along the axis where that is most, as a
 * share of the body's extent; rows that belong to x are no further away than MODEL_SAME_PLACE. */
double model_away(const struct model_input *input, const double *row, double unit, const double *x);
#define MODEL_SAME_PLACE 1e-5

/* field[node_count * dim] = u_h at the nodes. */
void model_nodal_field(const struct model_input *input, const double *u, double *field);

#endif
