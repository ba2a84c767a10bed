/* What acts on a body, loads, and what surrounds it: supports, which are springs at the quadrature points of
 * facets, and dashpots; and membranes. */
#include "solid/assembly/assembly.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Append an empty dead load. */
static enum status new_load(struct solid_system *system, int32_t curve, double **force, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->acting.loads, system->acting.load_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(force, system->node_count * system->dim, error));
    system->acting.loads[system->acting.load_count++] = (struct dead_load){*force, curve};
    return STATUS_OK;
}

/* Add mass times gravity to the nodes of a row of shape functions; place: the nodes of its columns,
 * NULL: themselves. */
static void add_weight(const struct assembly *input, double mass, int64_t count, const int32_t *idx,
                       const double *phi, const int64_t *place, double *force)
{
    int dim = input->cells.dim;
    for (int64_t i = 0; i < count; i++) {
        int64_t node = place != NULL ? place[idx[i]] : idx[i];
        for (int a = 0; a < dim; a++) {
            force[node * dim + a] += mass * phi[i] * input->gravity[a];
        }
    }
}

/* The weight of smoothed cells, shared among their edges. The mean of the quadratic interpolant over a cell
 * is that of its values at the midpoints in 2D; in 3D, where values at the vertices have negative weights,
 * that of its means over the faces is taken, which is the same for linear fields. */
static enum status add_cells(const struct assembly *input, struct body *body, double *force,
                             struct error *error)
{
    const struct sparse *table = &body->rows.matrix;
    int edges = CELL_EDGES(body->dim);
    SCRATCH double *mass = NULL; /* of each edge */
    RETURN_IF_ERROR(NEW_ARRAY(&mass, table->row_count, error));
    for (int64_t q = 0; q < body->point_count * edges; q++) {
        int64_t c = body->order.points[q / edges];
        mass[smoothed_cells_edge(body, q / edges, (int)(q % edges))] +=
            input->weight[c] * input->materials.items[input->materials.of_cell[c]].density / edges;
    }
    for (int64_t r = 0; r < table->row_count; r++) {
        int64_t at = table->ptr[r];
        add_weight(input, mass[r], table->ptr[r + 1] - at, table->idx + at, table->value + at,
                   body->order.nodes, force);
    }
    body_gather(body, body->dim, force);
    return STATUS_OK;
}

static enum status add_gravity(const struct assembly *input, struct solid_system *system, struct error *error)
{
    const struct material_list *materials = &input->materials;
    double *force;
    RETURN_IF_ERROR(new_load(system, input->gravity_curve, &force, error));
    if (input->smoothed) {
        return add_cells(input, &system->body, force, error);
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        double density = materials->items[materials->of_cell[input->point_cell[q]]].density;
        int64_t at = input->lists.ptr[q];
        add_weight(input, input->weight[q] * density, input->lists.ptr[q + 1] - at, input->lists.idx + at,
                   input->phi + at, NULL, force);
    }
    return STATUS_OK;
}

/* A traction on facets, or a force on each node. */
static enum status add_dead_load(const struct assembly *input, const struct load *load,
                                 struct solid_system *system, struct error *error)
{
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    const struct neighbours *lists = &input->node_lists;
    double *force, amount[3];
    RETURN_IF_ERROR(load->kind == LOAD_TRACTION
                        ? boundary_averages_build(&input->face_table, &load->facets, &averages, error)
                        : STATUS_OK);
    RETURN_IF_ERROR(new_load(system, load->curve, &force, error));
    for (int64_t a = 0; a < averages.count; a++) {
        struct average average = average_of_boundary(&averages, a);
        for (int k = 0; k < system->dim; k++) {
            amount[k] = averages.area[a] * load->components[k];
        }
        average_spread(&average, system->dim, amount, force);
    }
    for (int64_t n = 0; n < load->node_count; n++) {
        int64_t at = lists->ptr[load->nodes[n]];
        struct average field = {lists->ptr[load->nodes[n] + 1] - at, lists->idx + at, input->node_phi + at};
        average_spread(&field, system->dim, load->components, force);
    }
    return STATUS_OK;
}

static enum status add_pressure(const struct assembly *input, const struct load *load,
                                struct solid_system *system, struct error *error)
{
    const struct facet_set *set = &load->facets;
    int64_t count = set->count * system->dim;
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->acting.pressures, system->acting.pressure_count + 1, error));
    struct pressure_load *pressure = &system->acting.pressures[system->acting.pressure_count++];
    *pressure = (struct pressure_load){
        .pressure = load->pressure, .curve = load->curve, .facet_count = set->count, .facet = set->facet};
    pressure->is_fluid = load->is_fluid;
    pressure->part = load->part;
    memcpy(pressure->weight, load->weight, sizeof load->weight);
    memcpy(pressure->level, load->level, sizeof load->level);
    RETURN_IF_ERROR(boundary_nodes_build(&input->face_table, set, &input->node_lists, input->node_phi,
                                         &pressure->corners, error));
    RETURN_IF_ERROR(boundary_points_build(&input->face_table, set, &pressure->points, error));
    RETURN_IF_ERROR(NEW_ARRAY(&pressure->corner, count, error));
    for (int64_t i = 0; i < count; i++) {
        /* Averages of node values are in the order of their nodes. */
        const int32_t *found = bsearch(&set->facet[i], pressure->corners.node,
                                       (size_t)pressure->corners.count, sizeof *found, compare_int32);
        pressure->corner[i] = (int32_t)(found - pressure->corners.node);
    }
    return STATUS_OK;
}

enum status assembly_add_loads(const struct assembly *input, struct solid_system *system, struct error *error)
{
    if (vector_dot(3, input->gravity, input->gravity) > 0.0) {
        RETURN_IF_ERROR(add_gravity(input, system, error));
    }
    for (int64_t i = 0; i < input->load_count; i++) {
        const struct load *load = &input->loads[i];
        RETURN_IF_ERROR(
            (load->kind == LOAD_PRESSURE ? add_pressure : add_dead_load)(input, load, system, error));
    }
    return STATUS_OK;
}

/* axis[dim * dim]: the normal n, then unit vectors orthogonal to it and to each other. */
static void axes_of_normal(int dim, const double *n, double *axis)
{
    double across[3] = {0.0, 0.0, 0.0};
    memcpy(axis, n, (size_t)dim * sizeof *axis);
    if (dim == 2) {
        axis[2] = -n[1];
        axis[3] = n[0];
        return;
    }
    int least = 0;
    for (int a = 1; a < 3; a++) {
        least = fabs(n[a]) < fabs(n[least]) ? a : least;
    }
    across[least] = 1.0;
    vector_cross(n, across, axis + 3);
    double length = vector_length(3, axis + 3);
    for (int a = 0; a < 3; a++) {
        axis[3 + a] /= length;
    }
    vector_cross(n, axis + 3, axis + 6);
}

/* The springs of one point. Of rows of one average the stiffest comes first: the preconditioner takes the
 * average to be supported by that in all directions. */
static enum status add_springs(const struct assembly *input, int64_t number,
                               const struct boundary_averages *points, int64_t p, struct solid_system *system,
                               struct error *error)
{
    const struct support_condition *support = &input->supports[number];
    struct average average = average_of_boundary(points, p);
    int dim = system->dim;
    double axis[9];
    bool across_first = support->tangential > support->normal;
    axes_of_normal(dim, points->normal + p * dim, axis);
    for (int i = 0; i < dim; i++) {
        int k = across_first ? (i + 1) % dim : i;
        double stiffness = points->area[p] * (k == 0 ? support->normal : support->tangential);
        if (stiffness > 0.0) {
            RETURN_IF_ERROR(system_append_spring(system, &average, axis + k * dim, 0.0, support->curve,
                                                 (int32_t)(input->condition_count + number), points->node[p],
                                                 stiffness, error));
        }
    }
    return STATUS_OK;
}

/* Lump the dashpots of the facets as the mass: each facet shares its own equally among its nodes. */
static enum status add_dashpots(const struct support_condition *support,
                                const struct boundary_averages *points, struct solid_system *system,
                                struct error *error)
{
    const struct facet_set *set = &support->facets;
    int64_t each = points->count / (set->count > 0 ? set->count : 1);
    int dim = system->dim;
    if (system->dashpot == NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&system->dashpot, system->node_count, error));
    }
    for (int64_t p = 0; p < points->count; p++) {
        for (int k = 0; k < dim; k++) {
            system->dashpot[set->facet[p / each * dim + k]] += support->damping * points->area[p] / dim;
        }
    }
    return STATUS_OK;
}

static enum status add_support(const struct assembly *input, int64_t number, struct solid_system *system,
                               struct error *error)
{
    const struct support_condition *support = &input->supports[number];
    FREED_BY(boundary_averages_free) struct boundary_averages points = {0};
    RETURN_IF_ERROR(fail_in(error,
                            boundary_points_build(&input->face_table, &support->facets, &points, error), "%s",
                            support->where));
    for (int64_t p = 0; p < points.count; p++) {
        RETURN_IF_ERROR(add_springs(input, number, &points, p, system, error));
    }
    return support->damping > 0.0 ? add_dashpots(support, &points, system, error) : STATUS_OK;
}

static enum status add_membrane(const struct assembly *input, const struct membrane_condition *section,
                                struct solid_system *system, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->acting.membranes, system->acting.membrane_count + 1, error));
    struct membrane *added = &system->acting.membranes[system->acting.membrane_count++];
    return fail_in(
        error,
        membrane_build(&input->face_table, &section->facets, &system->rows, &section->law, added, error),
        "%s", section->where);
}

enum status assembly_add_supports(const struct assembly *input, struct solid_system *system,
                                  struct error *error)
{
    for (int64_t i = 0; i < input->support_count; i++) {
        RETURN_IF_ERROR(add_support(input, i, system, error));
    }
    for (int64_t i = 0; i < input->membrane_count; i++) {
        RETURN_IF_ERROR(add_membrane(input, &input->membranes[i], system, error));
    }
    return STATUS_OK;
}
