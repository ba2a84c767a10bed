/* Assembly: a system ready for time stepping from a cloud of nodes with its tables of shape functions,
 * materials, and conditions. All arrays are the caller's, who keeps them as long as the system. */
#pragma once

#include "solid/system/condition.h"
#include "solid/system/system.h"

enum load_kind { LOAD_PRESSURE, LOAD_TRACTION, LOAD_FORCE };

struct load {
    enum load_kind kind;
    struct facet_set facets; /* of a pressure or a traction */
    const int32_t *nodes;    /* node_count: of forces */
    int64_t node_count;
    double pressure; /* Pa, positive pushes inward; and with is_fluid: */
    bool is_fluid;
    enum fluid_part part;
    double weight[3], level[3]; /* N/m3, and a place at its level, m */
    double components[3];       /* traction: Pa; force: N on each node (2D: N/m) */
    int32_t curve;
};

/* Contact of facets with a rigid surface, or with others of the body. */
struct contact_condition {
    const char *where; /* as of a condition */
    struct facet_set facets;
    struct facet_set opposite; /* unless empty: the facets touch these, or themselves if both are the same */
    bool whole; /* the facets are the whole boundary: then none needs to face another one at rest */
    int sign;   /* as of the contact, with opposite facets */
    const double *corners; /* rigid_count * dim * dim: facets of the surface, see rigid_build, m */
    int64_t rigid_count;
    bool flip;
    double stiffness; /* of the penalty, Pa/m; 0: that of a layer of cells */
    double friction;  /* coefficient; 0: none */
    struct rigid_motion motion;
};

/* Elastic surroundings of facets: springs and dashpots between the points of the facets and the ground. */
struct support_condition {
    const char *where; /* as of a condition */
    struct facet_set facets;
    double normal, tangential; /* stiffness along the normals at rest, and across them, Pa/m */
    double damping;            /* in all directions, Pa s/m; for dynamics */
    int32_t curve;             /* any: the springs are at rest where u = 0 */
};

/* A thin skin on facets, see membrane.h. */
struct membrane_condition {
    const char *where; /* as of a condition */
    struct facet_set facets;
    struct membrane_law law;
};

/* Materials: one for each section, or one for each integration point of a section with a table. */
struct material_list {
    struct material *items; /* count */
    int64_t count;
    int32_t *of_point; /* of each integration point */
    int32_t *of_cell;  /* of each cell: that of its section */
    int32_t *section;  /* count: of each */
    int32_t *group;    /* count: see struct body_input */
};
void material_list_free(struct material_list *list);

struct assembly {
    /* The cloud, its cells, and all their faces; without smoothed cells only those on the boundary. */
    struct cells cells;
    struct faces faces;
    /* Integration points: each in a cell; smoothed cells are one point each, in their order. */
    bool smoothed;
    int64_t point_count;
    const double *x, *weight; /* point_count * dim, m; point_count, m2 or m3 */
    const int32_t *point_cell;
    /* Shape functions: at the points, with gradients; or, of smoothed cells, averages over the faces; at the
     * quadrature points of the boundary (quadrature_face_rule); at the nodes. */
    struct neighbours lists, boundary_lists, node_lists;
    const double *phi, *dphi; /* dphi NULL: averages over faces */
    const double *boundary_phi, *node_phi;
    /* Called, unless NULL, when `lists`, phi and dphi, which take most of the memory, are no longer needed.
     */
    void (*copied)(void *context);
    void *context;

    const int32_t
        *cell_side; /* of each cell: its side of the interfaces at which supports stop; NULL: none */
    const struct ranks *ranks; /* processes that compute the body together; NULL: one */

    struct material_list materials; /* the caller's to free */
    bool pointwise_volume;          /* no nodal volumes */

    struct load_curve *curves; /* curve_count; taken over by the system */
    int64_t curve_count;
    const struct condition *conditions;
    int64_t condition_count;
    bool node_values; /* conditions on facets prescribe values at nodes, not averages */
    bool direct;      /* conditions on facets prescribe the parameters of nodes */
    const struct load *loads;
    int64_t load_count;
    double gravity[3]; /* m/s2; 0: none */
    int32_t gravity_curve;
    const struct contact_condition *contacts;
    int64_t contact_count;
    const struct support_condition *supports;
    int64_t support_count;
    const struct membrane_condition *membranes;
    int64_t membrane_count;
    double tolerance; /* of the displacement: what springs of measured points need not resolve */
    bool in_time;     /* for dynamics */

    /* Set by assembly_complete. */
    struct faces boundary; /* the faces on the boundary */
    struct face_table face_table;
    double extent; /* diagonal of the box of the nodes, m */
};

/* Set the last members from the cells, their faces and the tables. The assembly must not be moved
 * afterwards. */
void assembly_complete(struct assembly *input);

/* Build the system. `note` receives a remark that is not an error, or an empty text. STATUS_INPUT for a node
 * without cell, and for conditions that disagree; further errors are those of the parts. */
MUST_CHECK enum status assembly_build(struct assembly *input, struct solid_system *system, struct error *note,
                                      struct error *error);

/* Steps of assembly_build, in their own files: displacements; measured points, loads of a body that is built,
 * contacts, and supports with membranes. */
MUST_CHECK enum status assembly_add_conditions(const struct assembly *input, struct solid_system *system,
                                               struct error *note, struct error *error);
typedef enum status assembly_step(const struct assembly *input, struct solid_system *system,
                                  struct error *error);
assembly_step assembly_add_points, assembly_add_loads, assembly_add_contacts, assembly_add_supports;

/* fail() at a row of measured points: "FILE:LINE: [displacement NAME]: points TABLE:LINE: at PLACE: what". */
enum status condition_fail_at(const struct condition *condition, int64_t row, struct error *error,
                              const char *what);

/* Whether conditions on facets prescribe boundary averages, and not values at nodes. */
bool assembly_holds_averages(const struct assembly *input);

/* (*held)[boundary.count], to be freed: whether the face is a facet of a condition that prescribes at least
 * `least` directions. */
MUST_CHECK enum status assembly_held_faces(const struct assembly *input, int least, bool **held,
                                           struct error *error);

/* The modulus of penalties on facets, Pa: the P-wave modulus, but at most `factor` times the shear modulus,
 * so that it does not grow with the bulk modulus; and the P-wave modulus: the largest values in the cells
 * behind the facets. */
MUST_CHECK enum status assembly_penalty_modulus(const struct assembly *input, const struct facet_set *set,
                                                double factor, double *modulus, double *wave,
                                                struct error *error);

/* field[node_count * dim] = u_h at the nodes. */
void assembly_nodal_field(const struct assembly *input, const double *u, double *field);
