#include "solid/assembly/assembly.h"

#include "approx/cells/quadrature.h"
#include "approx/field/field.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/sets.h"
#include "solid/assembly/prescription.h"
#include "solid/system/rigid_modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* (*part)[cells.count], to be freed: of cells that have a node on a junction of prescribed and free boundary
 * within a smooth side the number of one of these nodes; -1: of others. Of several nodes of a cell it is that
 * which has the fewest cells so far. */
static enum status junction_cells(const struct assembly *input, int32_t **part, struct error *error)
{
    const struct cells *cells = &input->cells;
    int corners = cells->dim + 1;
    SCRATCH bool *junction = NULL;
    RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SMOOTH, 1, &junction, error));
    NEW_SCRATCH(int32_t, size, cells->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(part, cells->count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        int32_t least = -1;
        for (int k = 0; k < corners; k++) {
            int32_t node = cells->node[c * corners + k];
            least = junction[node] && (least < 0 || size[node] < size[least]) ? node : least;
        }
        (*part)[c] = least;
        if (least >= 0) {
            size[least]++;
        }
    }
    return STATUS_OK;
}

static enum status build_body(const struct assembly *input, struct solid_system *system, struct error *error)
{
    const struct material_list *materials = &input->materials;
    SCRATCH bool *at_edge = NULL;
    SCRATCH int32_t *junction = NULL;
    if (input->smoothed && assembly_holds_averages(input)) {
        RETURN_IF_ERROR(junction_cells(input, &junction, error));
        /* Nodes at edges between clamped and free sides, and at re-entrant edges (2D: corners). An edge
         * between a clamped side and one that slides is not singular: it may be at a plane of symmetry. A
         * side that may come into contact counts as free: the treatment of edges does not change a uniform
         * pressure. */
        RETURN_IF_ERROR(find_junctions(input, BOUNDARY_JUNCTION_SHARP | BOUNDARY_REENTRANT, input->cells.dim,
                                       &at_edge, error));
    }
    bool any_edge = at_edge != NULL && memchr(at_edge, 1, (size_t)input->cells.node_count) != NULL;
    const struct body_input body = {.cells = input->cells,
                                    .faces = input->smoothed ? &input->faces : NULL,
                                    .point_count = input->point_count,
                                    .x = input->x,
                                    .weight = input->weight,
                                    .cell = input->pointwise_volume ? NULL : input->point_cell,
                                    .lists = &input->lists,
                                    .node_lists = &input->node_lists,
                                    .dphi = input->dphi,
                                    .phi = input->phi,
                                    .node_phi = input->node_phi,
                                    .copied = input->smoothed ? input->copied : NULL,
                                    .context = input->context,
                                    .materials = materials->items,
                                    .material = materials->of_point,
                                    .material_count = materials->count,
                                    .group = materials->group,
                                    .junction = junction,
                                    .at_edge = any_edge ? at_edge : NULL,
                                    .ranks = input->ranks};
    return body_build(&body, &system->body, error);
}

/* Lump the mass: each cell shares it equally among its nodes, which keeps total mass and centre of mass. */
static enum status lump_mass(const struct assembly *input, struct solid_system *system, struct error *error)
{
    int corners = input->cells.dim + 1;
    RETURN_IF_ERROR(NEW_ARRAY(&system->lumped_mass, input->cells.node_count, error));
    for (int64_t c = 0; c < input->cells.count; c++) {
        double density = input->materials.items[input->materials.of_cell[c]].density;
        for (int k = 0; k < corners; k++) {
            system->lumped_mass[input->cells.node[c * corners + k]] +=
                density * cell_volume(&input->cells, c) / corners;
        }
    }
    for (int64_t n = 0; n < input->cells.node_count; n++) {
        if (!(system->lumped_mass[n] > 0.0)) {
            return fail(error, STATUS_INPUT, "nodes.x: row %lld: the node is in no cell: it has no mass",
                        (long long)n);
        }
    }
    return STATUS_OK;
}

void assembly_complete(struct assembly *input)
{
    int dim = input->cells.dim;
    struct box box = box_of(dim, input->cells.node_count, input->cells.x);
    input->extent = box_diagonal(&box);
    input->boundary = input->faces;
    input->boundary.count = input->faces.boundary_count;
    input->face_table = (struct face_table){.dim = dim,
                                            .node_count = input->cells.node_count,
                                            .x = input->cells.x,
                                            .faces = &input->boundary,
                                            .per_face = quadrature_face_rule(dim).points,
                                            .lists = &input->boundary_lists,
                                            .phi = input->boundary_phi,
                                            .cell_side = input->cell_side};
}

/* The bodies of these nodes are not alike everywhere. */
static void mark_unlike(const int32_t *body, int64_t count, const int32_t *node, int32_t *alike)
{
    for (int64_t i = 0; i < count; i++) {
        alike[body[node[i]]] = -1;
    }
}

/* Find the indifferent rotations of bodies of one material without fibres on which nothing acts but contacts,
 * conditions and gravity. */
static enum status find_turns(const struct assembly *input, int32_t count, const int32_t *body,
                              struct solid_system *system, struct error *error)
{
    const struct cells *cells = &input->cells;
    const struct facet_set all = {input->boundary.count, input->boundary.node};
    FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
    NEW_SCRATCH(int32_t, alike, count, error); /* 1 + the material, 0: none yet */
    for (int64_t q = 0; q < input->point_count; q++) {
        const int32_t *node = cells->node + (int64_t)input->point_cell[q] * (cells->dim + 1);
        int32_t *own = &alike[body[*node]], m = input->materials.of_point[q];
        *own = (*own == 0 || *own == m + 1) && input->materials.items[m].fibre == NULL ? m + 1 : -1;
    }
    for (int64_t i = 0; i < input->load_count; i++) {
        const struct load *load = &input->loads[i];
        mark_unlike(body, load->facets.count * cells->dim, load->facets.facet, alike);
        mark_unlike(body, load->node_count, load->nodes, alike);
    }
    for (int64_t i = 0; i < input->membrane_count; i++) {
        const struct facet_set *set = &input->membranes[i].facets;
        mark_unlike(body, set->count * cells->dim, set->facet, alike);
    }
    RETURN_IF_ERROR(boundary_averages_build(&input->face_table, &all, &averages, error));
    return system_find_turns(system, count, body, alike, &all, input->face_table.per_face, &averages, error);
}

/* Whether the conditions leave a body, of cells that are connected, free to move as a whole; and the
 * rotations of it that statics leaves out. */
static enum status find_floating(const struct assembly *input, struct solid_system *system,
                                 struct error *error)
{
    const struct cells *cells = &input->cells;
    NEW_SCRATCH(int32_t, body, cells->node_count, error);
    set_join_cells(cells->node_count, cells->count, cells->dim + 1, cells->node, body);
    int32_t count = set_number(cells->node_count, body);
    NEW_SCRATCH(struct rigid_modes, modes, count, error);
    RETURN_IF_ERROR(system_rigid_modes(system, count, body, modes, error));
    for (int64_t c = 0; c < cells->count; c++) {
        const struct rigid_modes *of_cell = &modes[body[cells->node[c * (cells->dim + 1)]]];
        system->floats = system->floats || of_cell->translations + of_cell->turns > 0;
    }
    return system->floats && !input->in_time && !system_has_friction(system)
               ? find_turns(input, count, body, system, error)
               : STATUS_OK;
}

enum status assembly_build(struct assembly *input, struct solid_system *system, struct error *note,
                           struct error *error)
{
    *system = (struct solid_system){.dim = input->cells.dim,
                                    .node_count = input->cells.node_count,
                                    .X = input->cells.x,
                                    .node_lists = &input->node_lists,
                                    .node_phi = input->node_phi,
                                    .curves = input->curves,
                                    .curve_count = input->curve_count,
                                    .conditions = input->conditions};
    input->curves = NULL;
    input->curve_count = 0;
    constraint_rows_init(&system->rows, system->dim);
    constraint_rows_init(&system->springs.rows, system->dim);
    RETURN_IF_ERROR(NEW_ARRAY(&system->factor, system->curve_count, error));
    RETURN_IF_ERROR(lump_mass(input, system, error));
    RETURN_IF_ERROR(build_body(input, system, error));
    system->body.load_factors = (const double *const *)&system->factor;
    RETURN_IF_ERROR(assembly_add_loads(input, system, error));
    RETURN_IF_ERROR(assembly_add_conditions(input, system, note, error));
    RETURN_IF_ERROR(assembly_add_supports(input, system, error));
    RETURN_IF_ERROR(assembly_add_points(input, system, error));
    RETURN_IF_ERROR(assembly_add_contacts(input, system, error));
    RETURN_IF_ERROR(system->contact_count > 0 ? find_floating(input, system, error) : STATUS_OK);
    return system_share_springs(system, error);
}

void material_list_free(struct material_list *list)
{
    FREE_ALL(list->items, list->of_point, list->of_cell, list->section, list->group);
    *list = (struct material_list){0};
}

bool assembly_holds_averages(const struct assembly *input)
{
    return !input->node_values && !input->direct;
}

enum status assembly_held_faces(const struct assembly *input, int least, bool **held, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(held, input->boundary.count, error));
    for (int64_t i = 0; i < input->condition_count; i++) {
        const struct condition *condition = &input->conditions[i];
        const struct facet_set *set = &condition->facets;
        if (prescription_directions(condition, input->cells.dim) >= least) {
            RETURN_IF_ERROR(faces_mark(&input->boundary, set->count, set->facet, *held, error));
        }
    }
    return STATUS_OK;
}

enum status assembly_penalty_modulus(const struct assembly *input, const struct facet_set *set, double factor,
                                     double *modulus, double *wave, struct error *error)
{
    NEW_SCRATCH(bool, behind, input->cells.count, error);
    NEW_SCRATCH(bool, marked, input->boundary.count, error);
    RETURN_IF_ERROR(faces_mark(&input->boundary, set->count, set->facet, marked, error));
    for (int64_t f = 0; f < input->boundary.count; f++) {
        behind[input->boundary.cell[2 * f]] |= marked[f];
    }
    *modulus = *wave = 0.0;
    for (int64_t q = 0; q < input->point_count; q++) {
        if (behind[input->point_cell[q]]) {
            const struct material *material = &input->materials.items[input->materials.of_point[q]];
            double of_waves = material_wave_modulus(material);
            *wave = fmax(*wave, of_waves);
            *modulus = fmax(*modulus, fmin(factor * material->shear_modulus, of_waves));
        }
    }
    return STATUS_OK;
}

void assembly_nodal_field(const struct assembly *input, const double *u, double *field)
{
    field_evaluate(input->cells.node_count, input->node_lists.ptr, input->node_lists.idx, input->node_phi,
                   input->cells.dim, u, field);
}
