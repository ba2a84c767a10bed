/* The scene: the problem to compute on a body, read from an INI file of sections `[kind NAME]` with lines
 * `key = value`. Its grammar and keys: mtled-scene(5). Nothing is guessed: an unknown, repeated or missing
 * key is an error with its line. Files are named relative to the scene file. A scene can only be computed: it
 * names no program and no file to write. */
#pragma once

#include "base/memory.h"
#include "solid/assembly/assembly.h"
#include "solid/material/law.h"

#include <stdbool.h>
#include <stdint.h>

enum scene_analysis { SCENE_QUASI_STATIC, SCENE_DYNAMIC };

/* The body lies left or right of the rigid curve, walked in the order of its points (2D), or in front of
 * (where the right-hand normal points) or behind the rigid triangles (3D). */
enum scene_side { SCENE_LEFT, SCENE_RIGHT, SCENE_FRONT, SCENE_BACK };

/* Different names of groups; count 0: the key is absent. */
struct name_list {
    char **names;
    int64_t count;
};

struct scene_label {
    const char *name;  /* "craniotomy" */
    const char *where; /* prefix of messages: "brain.scene:12: [displacement craniotomy]" */
};

struct scene_curve {
    enum curve_kind kind;
    const char *file; /* CURVE_TABLE: rows (time, factor); else NULL */
};

/* Terms of a Prony series; none: elastic. */
struct scene_prony {
    double values[2 * PRONY_MOST_TERMS]; /* g and tau, s, of each */
    int terms;
};

struct scene_material {
    struct scene_label label;
    struct name_list regions; /* at least one; in no other material */
    const char *model;        /* name of the law; NULL: the default */
    double youngs_modulus, poisson_ratio, bulk_modulus, compressibility; /* E, nu, kappa, D as given, or 0 */
    double parameters[LAW_NUMBERS]; /* of the law, relative to the shear modulus */
    struct material material; /* without its pointers, and with a table without moduli. A density that is not
                                 given is 1000, which has no effect at rest without gravity */
    double fibre[3], fibre_plane[3]; /* as given; zeros: not given */
    double directions[6];            /* of the fibres, as in struct material; zeros: none, or by point */
    struct scene_curve curve;        /* of material.active */
    struct scene_prony prony;
    const char *fibres;    /* NULL, or rows (dim coordinates, direction of the fibres) */
    bool fibres_of_stream; /* they are those of the stream's points */
    const char *table; /* NULL, or rows (dim coordinates, E in Pa, nu), one per integration point in order */
    double table_unit; /* m per unit of the table's coordinates */
};

/* Conditions, loads and contacts hold the struct that assembly takes of each, as far as the keys tell it:
 * without names, facets, nodes, curves and what tables hold. */

struct scene_displacement {
    struct scene_label label;
    struct name_list facets, nodes; /* exactly one is given, none with CONDITION_POINTS; nodes never with
                                       CONDITION_NORMAL */
    /* condition.table, CONDITION_TABLE: rows (dim coordinates, dim displacement components);
     * CONDITION_POINTS: the same of measured points, with an optional standard deviation; components may be
     * unknown. Its unit: m per unit of the table. Never all components are free. */
    struct condition condition;
    const char *moved; /* CONDITION_POINTS: NULL, or where they are moved to: both tables are coordinates */
    double reach;      /* CONDITION_POINTS: largest distance of a point from the body, m; 0: not given */
    struct scene_curve curve;
};

struct scene_contact {
    struct scene_label label;
    struct name_list facets;  /* at least one */
    struct name_list against; /* facets of the body, instead of a rigid surface and its keys */
    const char *rigid;        /* 2D: points of polylines; 3D: triangles (see surface_read) */
    double rigid_unit;        /* m per unit of the file */
    enum scene_side side;     /* left, right in 2D; front, back in 3D */
    struct contact_condition
        condition; /* its motion: the surface is turned, then moved; the axis of any length */
    struct scene_curve curve, angle_curve;
};

/* A pressure, traction or force, load.kind. */
struct scene_load {
    struct scene_label label;
    struct name_list facets; /* pressure, traction: at least one */
    struct name_list nodes;  /* force: at least one node set */
    struct load load;
    double density;    /* pressure: of a fluid, kg/m3; 0: none */
    double gravity[3]; /* of a fluid: m/s2; zeros: that of the scene */
    struct scene_curve curve;
};

/* Elastic surroundings that hold facets: stiffness along the normals and across them, not both 0. */
struct scene_support {
    struct scene_label label;
    struct name_list facets; /* at least one */
    struct support_condition condition;
};

/* A membrane on facets. */
struct scene_membrane {
    struct scene_label label;
    struct name_list facets; /* at least one */
    struct membrane_condition condition;
    struct scene_curve curve; /* of the prestress */
};

/* The initial state of a dynamic scene. */
struct scene_initial {
    const char
        *table; /* NULL: at rest; or rows (dim coordinates, displacement, velocity), one per node in order */
    double table_unit; /* m per unit of the table, whose velocities are in that unit per second */
};

struct scene_output {
    int64_t frames;  /* evenly spaced frames besides the final state; 0: none */
    double interval; /* s between frames (dynamic); 0: none. Not both. */
    bool stress, strain, pressure, volume_ratio, fibre, energy, reactions, moments, gaps;
    double about[3];    /* the point of the moments, m; default the origin */
    bool folds_allowed; /* a body that folds is not refused */
};

enum scene_method { SCENE_NEWTON, SCENE_RELAXATION };

struct scene_solver {
    enum scene_method method; /* quasi-static */
    bool direct;              /* conditions prescribe the parameters of nodes */
    bool node_values;         /* conditions prescribe values at nodes, not averages */
    bool pointwise_volume;    /* no nodal volumes */
    double tolerance;         /* estimated remaining error relative to the displacement; default 1e-5 */
    int64_t max_steps;        /* 0: not given */
    int64_t ramp_steps;       /* steps over which a quasi-static load is applied; 0: not given */
    int64_t time_steps;       /* of a quasi-static scene with duration or friction; 0: of others, or
                                 to be chosen */
    double end_time;          /* s, dynamic */
    double time_step_margin;  /* share of the estimated critical step; default .9, dynamic .8 */
    double damping;           /* 1/s, dynamic; default 0 */
};

struct scene {
    const char *path;  /* the scene file */
    uint32_t checksum; /* CRC-32 of its bytes */
    const char *title; /* "" when absent */
    int dim;           /* 2 or 3 */
    enum scene_analysis analysis;
    double duration; /* s, of a quasi-static scene in time; 0: of loads alone, whose curves run from 0 to 1 */
    bool tabulated;  /* a curve is a file */
    double gravity[3]; /* m/s2 */
    struct scene_material *materials;
    int64_t material_count; /* >= 1 */
    struct scene_displacement *displacements;
    int64_t displacement_count;
    struct scene_contact *contacts;
    int64_t contact_count;
    struct scene_support *supports;
    int64_t support_count;
    struct scene_membrane *membranes;
    int64_t membrane_count;
    struct scene_load *loads;
    int64_t load_count;
    struct scene_initial initial;
    struct scene_output output;
    struct scene_solver solver;
    struct name_list files; /* all files that it names: tables, surfaces, curves */
    struct owned owned;     /* the texts and lists of names above */
};

/* Read a scene file. Tables are only named by path; the caller reads them. STATUS_INPUT for anything
 * malformed, with a message `FILE:LINE: [kind NAME]: key: what: remedy`; STATUS_SYSTEM for read failures and
 * memory. To be freed also on failure. */
MUST_CHECK enum status scene_read(const char *path, struct scene *scene, struct error *error);

/* Release everything the scene owns; it becomes empty. */
void scene_free(struct scene *scene);
