/* Values of the field on prescribed parts of the boundary: equation (17a) of lib/README.md.
 *
 * Smoothed cells take what is prescribed in place of the field's own values, at the vertices, the midpoints
 * of edges and in the mean over faces that lie there. So the volume of the cells is that within the
 * prescribed boundary, and their forces on it act on the prescribed motion alone: they do not bend the field
 * between the boundary averages, which a large pressure would do. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct body;
struct cells;
struct faces;

struct prescribed_value {
    int64_t row;  /* of field_averages.h, */
    int64_t part; /* and the first part of the forces on it */
    int nodes;    /* at rest it is in the middle of so many */
    int32_t node[3];
    int count;                    /* prescribed directions: */
    double axis[9];               /* count * dim: unit, orthogonal to each other, */
    int32_t section[3], curve[3]; /* of each: its condition, and the curve of its load factor, */
    double target[3];             /* displacement along it at load factor 1, m, */
    double start[3];              /* and more by the factor of start_curve, m */
    double force[3];              /* at the last evaluation: internal force along each, N (2D: N/m), */
    double value[3];              /* and displacement, m */
};

struct prescribed_values {
    int64_t count, room;
    struct prescribed_value *items; /* by their parts, once complete */
    int64_t *first;                 /* of each process, and the end: whose forces it sums */
    int32_t *of_row;                /* until complete: the item of each row; -1: none; */
    int64_t *of_face;               /* of each face of the boundary that in field_averages.h, */
    bool *is_face;                  /* and whether it is prescribed, in any direction */
    int32_t start_curve;
    double lag;           /* they stay behind the load factors by this share of */
    const double *change; /* a change of them; the caller's; NULL: none */
};

/* Prepare for a body that was built of cells with this boundary; complete what has been added: edges and
 * vertices of faces without conditions keep the field's own values, which are softer where the stress is
 * singular. */
MUST_CHECK enum status prescribed_values_begin(struct body *body, const struct cells *cells,
                                               const struct faces *boundary, struct error *error);
MUST_CHECK enum status prescribed_values_complete(struct body *body, const struct cells *cells,
                                                  struct error *error);
void prescribed_values_free(struct prescribed_values *values);

/* What smoothed cells take from a face of the boundary: its own row, and those of its edges and vertices. */
enum { FACE_MOST_ROWS = 7 };
struct face_rows {
    int64_t face;
    int count;
    int64_t row[FACE_MOST_ROWS];
    int nodes[FACE_MOST_ROWS]; /* each is in the middle of how many nodes, */
    int32_t node[FACE_MOST_ROWS][3];
    double place[FACE_MOST_ROWS * 3]; /* dim numbers of each, m */
};
void prescribed_values_face(const struct body *body, const struct cells *cells, int64_t face,
                            struct face_rows *rows);

/* Whether row r has values along all directions. */
bool prescribed_values_full(const struct body *body, const struct face_rows *rows, int r);

/* Prescribe the value of row r along a unit direction, if earlier ones of this row are orthogonal to it. */
MUST_CHECK enum status prescribed_values_add(struct body *body, const struct face_rows *rows, int r,
                                             const double *direction, double target, int32_t curve,
                                             int32_t section, struct error *error);

/* Inside a parallel region, by all its threads: put the prescribed values in place of the field's, and take
 * the forces on them off those on the rows. */
void prescribed_values_place(struct body *body);
void prescribed_values_take_forces(struct body *body);

/* Collect the values and forces of all processes at the last evaluation. */
void prescribed_values_collect(struct body *body);

/* The work of those forces along a change of the load factors, J (2D: J/m). Collective. */
double prescribed_values_work(struct body *body, const double *from, const double *to);

/* Let the values begin, at the load factors now, at what is prescribed and the means of start[node_count *
 * dim]. */
void prescribed_values_start(struct body *body, int32_t start_curve, const double *start);
