/* Forces on a body at parameters u: loads, and the residual of all but contacts. */
#include "solid/system/system.h"

#include "base/vector.h"

#include <math.h>
#include <omp.h>
#include <string.h>

/* Deformed position of a corner: X + the average's displacement. */
static void corner_position(const struct solid_system *system, const struct boundary_averages *averages,
                            int64_t a, const double *u, double *x)
{
    int dim = system->dim;
    struct average average = average_of_boundary(averages, a);
    average_place(&average, dim, system->X + (int64_t)averages->node[a] * dim, u, x);
}

/* The pressure at quadrature point p of the deformed facets, Pa, at factor 1. */
static double pressure_at(const struct solid_system *system, const struct pressure_load *load, int64_t p,
                          const double *u)
{
    double x[3], depth = 0.0;
    struct average average = average_of_boundary(&load->points, p);
    if (!load->is_fluid) {
        return load->pressure;
    }
    average_take(&average, system->dim, u, x);
    for (int a = 0; a < system->dim; a++) {
        depth += load->weight[a] * (load->points.position[p * system->dim + a] + x[a] - load->level[a]);
    }
    bool presses = load->part == FLUID_ALL || (depth > 0.0) == (load->part == FLUID_BELOW);
    return presses ? depth : 0.0;
}

/* Add to the forces on the corners of a deformed facet what the volume within the boundary, sum V J with (9),
 * varies by as the area vector turns and grows: the mean offset of the face from its corners times the change
 * of the area vector. x: the corners; thrust: the mean pressure times that offset, N/m (2D: Pa m). */
static void add_offset_force(const struct solid_system *system, const struct pressure_load *load, int64_t f,
                             const double *x, const double *thrust, double *residual)
{
    int dim = system->dim;
    double edge[2][3], force[3][3] = {{0.0}}, half[3];
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, x + k * dim, x, edge[k - 1]);
    }
    if (dim == 2) { /* the area vector is (y, -x) of the edge */
        force[1][0] = -thrust[1];
        force[1][1] = thrust[0];
    } else { /* half the product of the edges */
        for (int a = 0; a < 3; a++) {
            half[a] = 0.5 * thrust[a];
        }
        vector_cross(edge[1], half, force[1]);
        vector_cross(half, edge[0], force[2]);
    }
    for (int k = 1; k < dim; k++) {
        add_scaled(dim, -1.0, force[k], force[0]);
    }
    for (int k = 0; k < dim; k++) {
        struct average average = average_of_boundary(&load->corners, load->corner[f * dim + k]);
        average_spread(&average, dim, force[k], residual);
    }
}

/* Forces of a following pressure: its mean over a facet times the gradient of the volume within the boundary.
 * The part by the mean of the face is divided among its quadrature points in proportion to their areas at
 * rest. */
static void add_pressure(const struct solid_system *system, const struct pressure_load *load, double factor,
                         const double *u, double *residual)
{
    int dim = system->dim;
    static const int32_t in_order[3] = {0, 1, 2};
    int64_t each = load->points.count / (load->facet_count > 0 ? load->facet_count : 1);
    for (int64_t f = 0; f < load->facet_count; f++) {
        double x[9], area[3], thrust[3] = {0.0}, mean[3] = {0.0}, at_rest = 0.0, whole = 0.0;
        for (int k = 0; k < dim; k++) {
            const int32_t *node = load->facet + f * dim;
            corner_position(system, &load->corners, load->corner[f * dim + k], u, x + k * dim);
            add_scaled(dim, -1.0 / dim, x + k * dim, mean);
            add_scaled(dim, 1.0 / dim, system->X + (int64_t)node[k] * dim, mean);
        }
        face_area_vector(dim, x, in_order, area);
        for (int64_t p = f * each; p < (f + 1) * each; p++) {
            at_rest += load->points.area[p];
        }
        for (int64_t p = f * each; p < (f + 1) * each; p++) {
            struct average average = average_of_boundary(&load->points, p);
            double value[3], share[3], part = load->points.area[p] / at_rest;
            double pressure = factor * part * pressure_at(system, load, p, u);
            average_take(&average, dim, u, value);
            add_scaled(dim, part, value, mean);
            whole += pressure;
            for (int a = 0; a < dim; a++) {
                share[a] = -pressure * area[a];
            }
            average_spread(&average, dim, share, residual);
        }
        add_scaled(dim, -whole, mean, thrust);
        add_offset_force(system, load, f, x, thrust, residual);
    }
}

bool system_has_potential(const struct solid_system *system)
{
    return system->acting.pressure_count == 0;
}

void system_add_loads(const struct solid_system *system, const double *u, double *force)
{
    int64_t size = system->node_count * system->dim;
    for (int64_t l = 0; l < system->acting.load_count; l++) {
        double factor = system->factor[system->acting.loads[l].curve];
        const double *load = system->acting.loads[l].force;
        for (int64_t i = 0; i < size; i++) {
            force[i] += factor * load[i];
        }
    }
    for (int64_t l = 0; l < system->acting.pressure_count; l++) {
        const struct pressure_load *load = &system->acting.pressures[l];
        add_pressure(system, load, system->factor[load->curve], u, force);
    }
}

static void negate(const struct solid_system *system, double *force)
{
    for (int64_t i = 0; i < system->node_count * system->dim; i++) {
        force[i] = -force[i];
    }
}

void system_resist(struct solid_system *system, const double *u, double *force)
{
    double started = omp_get_wtime();
    (void)body_own_force(&system->body, u, force);
    system->cost.force += omp_get_wtime() - started;
    negate(system, force);
    system_add_springs(system, u, force);
    (void)system_pull_membranes(system, u, force);
    negate(system, force);
    body_gather(&system->body, system->dim, force);
}

/* residual += what loads, membranes and springs do at u; with several processes at own nodes. */
static void act(struct solid_system *system, const double *u, double *residual)
{
    double started = omp_get_wtime();
    system_add_loads(system, u, residual);
    (void)system_pull_membranes(system, u, residual);
    double loaded = omp_get_wtime();
    system_add_springs(system, u, residual);
    system->cost.loads += loaded - started;
    system->cost.constraints += omp_get_wtime() - loaded;
}

struct deformation system_smooth_residual(struct solid_system *system, const double *u, double *residual)
{
    double started = omp_get_wtime();
    struct deformation deformation = body_own_force(&system->body, u, residual);
    system->cost.force += omp_get_wtime() - started;
    negate(system, residual);
    act(system, u, residual);
    started = omp_get_wtime();
    body_gather(&system->body, system->dim, residual);
    system->cost.force += omp_get_wtime() - started;
    return deformation;
}

bool system_acts_outside(const struct solid_system *system)
{
    bool active = system->body.prony.terms > 0;
    for (int64_t m = 0; m < system->body.material_count; m++) {
        active = active || fabs(system->body.materials[m].active) > 0.0;
    }
    return !active;
}

void system_change_load(struct solid_system *system, const double *u, double from, double to, double *scratch,
                        double *residual)
{
    const double load[] = {from, to};
    for (int k = 0; k < 2; k++) {
        memset(scratch, 0, (size_t)(system->node_count * system->dim) * sizeof *scratch);
        system_load_factors(system, load[k]);
        act(system, u, scratch);
        body_gather(&system->body, system->dim, scratch);
        for (int64_t i = 0; i < system->node_count * system->dim; i++) {
            residual[i] += k == 0 ? -scratch[i] : scratch[i];
        }
    }
}
