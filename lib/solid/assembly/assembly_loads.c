#include "solid/assembly/assembly.h"

#include "approx/cells/face_edges.h"
#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Append an empty dead load. */
static enum status new_load(struct solid_system *system, int32_t curve, double **force, struct error *error)
{
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->loads, system->load_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(force, system->node_count * system->dim, error));
    system->loads[system->load_count++] = (struct dead_load){*force, curve};
    return STATUS_OK;
}

/* The mass of each row of the table over points or edges. The mean of the quadratic interpolant over a cell
 * is that of its values at the midpoints in 2D; in 3D, where values at the vertices have negative weights,
 * that of its means over the faces is taken, which is the same for linear fields. */
static enum status share_mass(const struct assembly *input, double **mass, struct error *error)
{
    const struct material_list *materials = &input->materials;
    int edges = FACE_EDGES(input->cells.dim);
    RETURN_IF_ERROR(NEW_ARRAY(mass, input->lists.count, error));
    for (int64_t i = 0; i < input->lists.count && !input->smoothed; i++) {
        (*mass)[i] = input->weight[i] * materials->items[materials->of_cell[input->point_cell[i]]].density;
    }
    for (int64_t i = 0; i < 2 * input->faces.count && input->smoothed; i++) {
        int32_t q = input->faces.cell[i];
        for (int k = 0; k < edges && q >= 0; k++) {
            (*mass)[face_edge(&input->faces, i / 2, k)] += input->weight[q] *
                                                           materials->items[materials->of_cell[q]].density /
                                                           ((input->cells.dim + 1) * edges);
        }
    }
    return STATUS_OK;
}

/* Whether each process has only some of the rows over which the weight is summed. */
static bool weighs_later(const struct assembly *input)
{
    return input->edge_reader != NULL && !input->in_time;
}

static enum status add_gravity(const struct assembly *input, struct solid_system *system, struct error *error)
{
    int dim = system->dim;
    double *force;
    SCRATCH double *mass = NULL;
    RETURN_IF_ERROR(new_load(system, input->gravity_curve, &force, error));
    /* In dynamics gravity acts on the lumped mass, so that a free body falls without deformation. */
    for (int64_t i = 0; input->in_time && i < system->node_count * dim; i++) {
        force[i] = system->lumped_mass[i / dim] * input->gravity[i % dim];
    }
    if (input->in_time || weighs_later(input)) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(share_mass(input, &mass, error));
    for (int64_t r = 0; r < input->lists.count; r++) {
        for (int64_t i = input->lists.ptr[r]; i < input->lists.ptr[r + 1]; i++) {
            for (int a = 0; a < dim; a++) {
                force[(int64_t)input->lists.idx[i] * dim + a] += mass[r] * input->phi[i] * input->gravity[a];
            }
        }
    }
    return STATUS_OK;
}

enum status assembly_complete_gravity(const struct assembly *input, struct solid_system *system,
                                      struct error *error)
{
    const struct body *body = &system->body;
    const struct average_table *faces = &body->cells.averages.given[0];
    int dim = system->dim;
    double *force;
    SCRATCH double *mass = NULL, *by_place = NULL;
    if (!assembly_has_gravity(input) || !weighs_later(input)) {
        return STATUS_OK;
    }
    force = system->loads[0].force;
    RETURN_IF_ERROR(share_mass(input, &mass, error));
    RETURN_IF_ERROR(NEW_ARRAY(&by_place, system->node_count * dim, error));
    for (int64_t r = 0; r < faces->row_count; r++) {
        for (int64_t i = faces->ptr[r]; i < faces->ptr[r + 1]; i++) {
            int64_t place = body->node_place[faces->idx[i]];
            for (int a = 0; a < dim && body_share_has_node(body, faces->idx[i]); a++) {
                by_place[place * dim + a] += mass[r] * faces->phi[i] * input->gravity[a];
            }
        }
    }
    ranks_gather(body->share.ranks, by_place, (size_t)dim * sizeof *by_place, body->share.node_first);
    for (int64_t i = 0; i < system->node_count * dim; i++) {
        force[i] = by_place[body->node_place[i / dim] * dim + i % dim];
    }
    return STATUS_OK;
}

static enum status add_traction(const struct assembly *input, const struct load *load,
                                struct solid_system *system, struct error *error)
{
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    double *force;
    RETURN_IF_ERROR(boundary_averages_build(&input->face_table, &load->facets, &averages, error));
    RETURN_IF_ERROR(new_load(system, load->curve, &force, error));
    for (int64_t a = 0; a < averages.count; a++) {
        struct average average = average_of_boundary(&averages, a);
        double amount[3];
        for (int k = 0; k < system->dim; k++) {
            amount[k] = averages.area[a] * load->components[k];
        }
        average_spread(&average, system->dim, amount, force);
    }
    return STATUS_OK;
}

static enum status add_force(const struct assembly *input, const struct load *load,
                             struct solid_system *system, struct error *error)
{
    const struct neighbours *lists = &input->node_lists;
    double *force;
    RETURN_IF_ERROR(new_load(system, load->curve, &force, error));
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
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->pressures, system->pressure_count + 1, error));
    struct pressure_load *pressure = &system->pressures[system->pressure_count++];
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
    static enum status (*const add[])(const struct assembly *, const struct load *, struct solid_system *,
                                      struct error *) = {
        [LOAD_PRESSURE] = add_pressure, [LOAD_TRACTION] = add_traction, [LOAD_FORCE] = add_force};
    if (assembly_has_gravity(input)) {
        RETURN_IF_ERROR(add_gravity(input, system, error));
    }
    for (int64_t i = 0; i < input->load_count; i++) {
        RETURN_IF_ERROR(add[input->loads[i].kind](input, &input->loads[i], system, error));
    }
    return STATUS_OK;
}
