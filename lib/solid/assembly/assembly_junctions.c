/* Junctions of prescribed and free boundary, where the stress is singular: equation (35) of lib/README.md,
 * and edges whose nodes own no nodal volume. */
#include "solid/assembly/assembly.h"

#include "base/keyed.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* The share of the energy of what varies around a junction that cells there do not have (energy correction:
 * Egger, Ruede and Wohlmuth 2014). With 1/2 the mean error of the force on a bonded punch on a strip is a
 * sixth of that with 0, pushed and sheared, at nu .3 and .49. */
static const double junction_share = 0.5;

/* (*junction)[node_count], to be freed: nodes of edges of these kinds, where faces with at least `least`
 * prescribed directions end. */
static enum status find_junctions(const struct assembly *input, int kinds, int least, bool **junction,
                                  struct error *error)
{
    SCRATCH bool *held = NULL, *constrained = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, least, &held, error));
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &constrained, error));
    RETURN_IF_ERROR(NEW_ARRAY(junction, input->cells.node_count, error));
    return boundary_find_junctions(&input->face_table, kinds, held, constrained, *junction, error);
}

/* A sum of gradients of cells as a row: the gradient of u_h is sum_j gradient_j (x) u_j. */
struct gradient_row {
    const struct assembly *input;
    double *gradient; /* node_count * dim, 1/m; 0 at nodes that are not listed */
    bool *listed;     /* node_count */
    int32_t *node;    /* count: the nodes listed */
    double *phi;      /* scratch for one component: count */
    int64_t count;
};

static enum status gradient_row_new(const struct assembly *input, struct gradient_row *row,
                                    struct error *error)
{
    int64_t count = input->cells.node_count;
    *row = (struct gradient_row){.input = input};
    RETURN_IF_ERROR(NEW_ARRAY(&row->gradient, count * input->cells.dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->listed, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->node, count, error));
    return NEW_ARRAY(&row->phi, count, error);
}

static void gradient_row_free(struct gradient_row *row)
{
    FREE_ALL(row->gradient, row->listed, row->node, row->phi);
}

static void clear(struct gradient_row *row)
{
    int dim = row->input->cells.dim;
    for (int64_t i = 0; i < row->count; i++) {
        row->listed[row->node[i]] = false;
        memset(row->gradient + (int64_t)row->node[i] * dim, 0, (size_t)dim * sizeof *row->gradient);
    }
    row->count = 0;
}

/* Add `factor` times the gradient of the linear interpolant in a cell, times its volume. */
static void add_cell(struct gradient_row *row, int64_t cell, double factor)
{
    const struct cells *cells = &row->input->cells;
    const struct neighbours *lists = &row->input->node_lists;
    int dim = cells->dim;
    for (int k = 0; k <= dim; k++) {
        int32_t face[3], vertex = cells->node[cell * (dim + 1) + k];
        double area[3];
        cell_face(cells, cell, k, face);
        face_area_vector(dim, cells->x, face, area);
        for (int64_t i = lists->ptr[vertex]; i < lists->ptr[vertex + 1]; i++) {
            int32_t j = lists->idx[i];
            if (!row->listed[j]) {
                row->listed[j] = true;
                row->node[row->count++] = j;
            }
            for (int b = 0; b < dim; b++) {
                row->gradient[(int64_t)j * dim + b] -= factor / dim * area[b] * row->input->node_phi[i];
            }
        }
    }
}

/* Append the row's square, by a stiffness, as springs. */
static enum status append_springs(struct gradient_row *row, int32_t node, double stiffness,
                                  struct solid_system *system, struct error *error)
{
    int dim = system->dim;
    for (int b = 0; b < dim; b++) {
        for (int64_t i = 0; i < row->count; i++) {
            row->phi[i] = row->gradient[(int64_t)row->node[i] * dim + b];
        }
        for (int a = 0; a < dim; a++) {
            struct average average = {row->count, row->node, row->phi};
            double direction[3] = {0.0, 0.0, 0.0};
            direction[a] = 1.0;
            RETURN_IF_ERROR(
                system_append_penalty(system, &average, direction, 0.0, 0, -1, node, stiffness, 0.0, error));
            system->spring_count++;
        }
    }
    return STATUS_OK;
}

/* The shear modulus that a cell keeps in the long run, Pa. */
static double lasting_modulus(const struct assembly *input, int64_t cell)
{
    const struct material *material = &input->materials.items[input->materials.of_point[cell]];
    double left = 1.0;
    for (int i = 0; i < material->prony_terms; i++) {
        left -= material->prony[2 * i];
    }
    return left * material->shear_modulus;
}

/* Add the springs of one junction's node, with `count` cells around it. */
static enum status add_junction(struct gradient_row *row, int64_t count, const struct keyed *around,
                                const bool *prescribed, struct solid_system *system, struct error *error)
{
    const struct cells *cells = &row->input->cells;
    double patch = 0.0;
    for (int64_t i = 0; i < count; i++) {
        patch += cell_volume(cells, around[i].item);
    }
    for (int64_t c = 0; c < count; c++) {
        int64_t cell = around[c].item;
        double volume = cell_volume(cells, cell);
        if (!prescribed[cell]) {
            double share = junction_share / (cells->dim - 1);
            clear(row);
            for (int64_t i = 0; i < count; i++) {
                add_cell(row, around[i].item, -1.0 / patch);
            }
            add_cell(row, cell, 1.0 / volume);
            RETURN_IF_ERROR(append_springs(
                row, around->key[0], -share * volume * lasting_modulus(row->input, cell), system, error));
        }
    }
    return STATUS_OK;
}

/* prescribed[cells.count]: cells that have a prescribed facet. */
static enum status mark_cells(const struct assembly *input, bool *prescribed, struct error *error)
{
    SCRATCH bool *held = NULL;
    RETURN_IF_ERROR(assembly_held_faces(input, 1, &held, error));
    for (int64_t f = 0; f < input->boundary.count; f++) {
        prescribed[input->boundary.cell[2 * f]] |= held[f];
    }
    return STATUS_OK;
}

enum status assembly_add_junctions(const struct assembly *input, struct solid_system *system,
                                   struct error *error)
{
    const struct cells *cells = &input->cells;
    int64_t corners = cells->dim + 1, count = 0;
    SCRATCH bool *junction = NULL;
    SCRATCH struct keyed *around = NULL; /* the cells around each node of a junction */
    FREED_BY(gradient_row_free) struct gradient_row row = {0};
    if (!input->smoothed || !assembly_holds_averages(input)) {
        return STATUS_OK;
    }
    NEW_SCRATCH(bool, prescribed, cells->count, error);
    RETURN_IF_ERROR(mark_cells(input, prescribed, error));
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, &junction, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        count += junction[cells->node[i]];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&around, count, error));
    RETURN_IF_ERROR(gradient_row_new(input, &row, error));
    count = 0;
    for (int64_t i = 0; i < cells->count * corners; i++) {
        if (junction[cells->node[i]]) {
            around[count++] = (struct keyed){{cells->node[i], -1, -1}, i / corners};
        }
    }
    keyed_sort(count, around);
    for (int64_t first = 0, end; first < count; first = end) {
        end = keyed_end(count, around, first);
        RETURN_IF_ERROR(add_junction(&row, end - first, around + first, prescribed, system, error));
    }
    return STATUS_OK;
}

/* An edge between a clamped side and one that slides is not singular: it may be at a plane of symmetry. A
 * side that may come into contact counts as free: the treatment of edges does not change a uniform pressure.
 */
enum status assembly_edge_nodes(const struct assembly *input, bool **at_edge, struct error *error)
{
    bool found = false;
    *at_edge = NULL;
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SHARP | BOUNDARY_REENTRANT, input->cells.dim,
                                   at_edge, error));
    for (int64_t n = 0; n < input->cells.node_count; n++) {
        found = found || (*at_edge)[n];
    }
    if (!found) {
        free(*at_edge);
        *at_edge = NULL;
    }
    return STATUS_OK;
}
