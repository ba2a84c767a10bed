#include "model.h"

#include <math.h>
#include <stdlib.h>

/* Append an empty dead load. */
static enum status new_load(struct solid_system *system, int32_t curve, int32_t section, double **force,
                            struct error *error)
{
    struct dead_load *grown = array_grow(system->loads, system->load_count + 1, sizeof *grown);
    if (grown == NULL) {
        return fail_memory(error, "loads");
    }
    system->loads = grown;
    grown += system->load_count;
    *grown = (struct dead_load){.curve = curve, .section = section};
    enum status status = NEW_ARRAY(&grown->force, system->node_count * system->dim, error);
    if (status == STATUS_OK) {
        system->load_count++;
        *force = grown->force;
    }
    return status;
}

/* The mass that each row of the table over points or faces stands for: of a face, its cells' in equal parts.
 */
static enum status share_mass(const struct model_input *input, double **mass, struct error *error)
{
    enum status status;
    const int32_t *cell = input->point_cell->data;
    const double *weight = input->weight->data;
    TRY(NEW_ARRAY(mass, input->lists.count, error));
    for (int64_t i = 0; i < input->lists.count && !input->smoothed; i++) {
        (*mass)[i] = weight[i] * input->scene->materials[input->cell_material[cell[i]]].density;
    }
    for (int64_t i = 0; i < 2 * input->lists.count && input->smoothed; i++) {
        int32_t q = input->faces.cell[i];
        if (q >= 0) {
            (*mass)[i / 2] +=
                weight[q] * input->scene->materials[input->cell_material[q]].density / (input->cells.dim + 1);
        }
    }
done:
    return status;
}

static enum status add_gravity(const struct model_input *input, struct solid_system *system,
                               struct error *error)
{
    enum status status;
    /* In time it is there from the begin; a state of rest is approached gently. */
    bool in_time = input->scene->analysis == SCENE_DYNAMIC;
    const struct scene_curve curve_of_load = {.kind = in_time ? SCENE_CURVE_STEP : SCENE_CURVE_SMOOTH};
    const struct scene_label label = {0};
    int dim = system->dim;
    int32_t curve;
    double *force, *mass = NULL;
    TRY(model_add_curve(input, &label, &curve_of_load, system, &curve, error));
    TRY(new_load(system, curve, -1, &force, error));
    /* In time by the lumped mass, so that a free body falls as one. */
    for (int64_t i = 0; in_time && i < system->node_count * dim; i++) {
        force[i] = system->lumped_mass[i / dim] * input->scene->gravity[i % dim];
    }
    TRY(share_mass(input, &mass, error));
    for (int64_t r = 0; !in_time && r < input->lists.count; r++) {
        for (int64_t i = input->lists.ptr[r]; i < input->lists.ptr[r + 1]; i++) {
            for (int a = 0; a < dim; a++) {
                force[(int64_t)input->lists.idx[i] * dim + a] +=
                    mass[r] * input->phi[i] * input->scene->gravity[a];
            }
        }
    }
done:
    free(mass);
    return status;
}

static enum status add_traction(const struct model_input *input, const struct scene_load *load,
                                int32_t number, struct solid_system *system, struct error *error)
{
    enum status status;
    struct boundary_averages averages = {0};
    struct facet_set set;
    int32_t *owned = NULL, curve;
    double *force;
    int dim = system->dim;
    TRY(model_facets(input, &load->label, &load->facets, &set, &owned, error));
    TRY(boundary_averages_build(&input->face_table, &set, &averages, error));
    TRY(model_add_curve(input, &load->label, &load->curve, system, &curve, error));
    TRY(new_load(system, curve, number, &force, error));
    for (int64_t a = 0; a < averages.count; a++) {
        for (int64_t i = averages.ptr[a]; i < averages.ptr[a + 1]; i++) {
            for (int k = 0; k < dim; k++) {
                force[(int64_t)averages.idx[i] * dim + k] +=
                    averages.area[a] * averages.phi[i] * load->components[k];
            }
        }
    }
done:
    free(owned);
    boundary_averages_free(&averages);
    return status;
}

static enum status add_force(const struct model_input *input, const struct scene_load *load, int32_t number,
                             struct solid_system *system, struct error *error)
{
    enum status status;
    int32_t *nodes = NULL, curve;
    int64_t count;
    double *force;
    int dim = system->dim;
    TRY(model_nodes(input, &load->label, &load->nodes, &nodes, &count, error));
    TRY(model_add_curve(input, &load->label, &load->curve, system, &curve, error));
    TRY(new_load(system, curve, number, &force, error));
    for (int64_t n = 0; n < count; n++) {
        for (int64_t i = input->node_lists.ptr[nodes[n]]; i < input->node_lists.ptr[nodes[n] + 1]; i++) {
            for (int k = 0; k < dim; k++) {
                force[(int64_t)input->node_lists.idx[i] * dim + k] +=
                    input->node_phi[i] * load->components[k];
            }
        }
    }
done:
    free(nodes);
    return status;
}

/* The fluid of a section that has one. */
static enum status set_fluid(const struct model_input *input, const struct scene_load *load,
                             struct pressure_load *pressure, struct error *error)
{
    static const enum fluid_part parts[] = {
        [SCENE_BELOW] = FLUID_BELOW, [SCENE_ABOVE] = FLUID_ABOVE, [SCENE_BELOW_AND_ABOVE] = FLUID_ALL};
    double length = hypot(hypot(load->gravity[0], load->gravity[1]), load->gravity[2]);
    const double *gravity = length > 0.0 ? load->gravity : input->scene->gravity;
    if (!(hypot(hypot(gravity[0], gravity[1]), gravity[2]) > 0.0)) {
        return scene_fail(error, STATUS_INPUT, input->scene, &load->label,
                          "density: a fluid without weight: give gravity here or in [scene]");
    }
    for (int a = 0; a < 3; a++) {
        pressure->weight[a] = load->density * gravity[a];
        pressure->level[a] = load->level[a];
    }
    pressure->is_fluid = true;
    pressure->part = parts[load->level_side];
    return STATUS_OK;
}

static enum status add_pressure(const struct model_input *input, const struct scene_load *load,
                                struct solid_system *system, struct error *error)
{
    enum status status;
    struct facet_set set;
    int dim = system->dim;
    struct pressure_load *grown = array_grow(system->pressures, system->pressure_count + 1, sizeof *grown);
    if (grown == NULL) {
        return fail_memory(error, "loads");
    }
    system->pressures = grown;
    struct pressure_load *pressure = &grown[system->pressure_count++];
    *pressure = (struct pressure_load){.pressure = load->pressure};
    if (load->density > 0.0) {
        TRY(set_fluid(input, load, pressure, error));
    }
    TRY(model_facets(input, &load->label, &load->facets, &set, &pressure->facet, error));
    pressure->facet_count = set.count;
    TRY(boundary_nodes_build(&input->face_table, &set, &input->node_lists, input->node_phi,
                             &pressure->corners, error));
    TRY(boundary_points_build(&input->face_table, &set, &pressure->points, error));
    TRY(model_add_curve(input, &load->label, &load->curve, system, &pressure->curve, error));
    TRY(NEW_ARRAY(&pressure->corner, set.count * dim, error));
    for (int64_t i = 0; i < set.count * dim; i++) {
        /* Averages of node values are in the order of their nodes. */
        int64_t low = 0, high = pressure->corners.count - 1;
        while (low < high) {
            int64_t middle = (low + high) / 2;
            if (pressure->corners.node[middle] < set.facet[i]) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        pressure->corner[i] = (int32_t)low;
    }
done:
    return status;
}

enum status model_add_loads(const struct model_input *input, struct solid_system *system, struct error *error)
{
    enum status status = STATUS_OK;
    const struct scene *scene = input->scene;
    if (scene->gravity[0] != 0.0 || scene->gravity[1] != 0.0 || scene->gravity[2] != 0.0) {
        TRY(add_gravity(input, system, error));
    }
    for (int64_t i = 0; i < scene->traction_count; i++) {
        TRY(add_traction(input, &scene->tractions[i], (int32_t)i, system, error));
    }
    for (int64_t i = 0; i < scene->force_count; i++) {
        TRY(add_force(input, &scene->forces[i], (int32_t)i, system, error));
    }
    for (int64_t i = 0; i < scene->pressure_count; i++) {
        TRY(add_pressure(input, &scene->pressures[i], system, error));
    }
done:
    return status;
}
