/* Fault 25: whichever allocation fails, quasi-static and dynamic runs report it with STATUS_SYSTEM and leave
 * nothing allocated. */
#include "lattice_fixture.h"

#ifndef __clang__ /* whose OpenMP cannot be replaced as simply */
#define WITHOUT_LIBGOMP
#include "failing_allocator.h"
#endif

#ifdef FAILING_ALLOCATOR

#include "solid/dynamics/dynamics.h"
#include "solid/relaxation/relaxation.h"

static struct lattice lattice; /* made before any allocation fails */
static double *u, *v;

static void to_rest(void)
{
    memset(u, 0, (size_t)(lattice.system.node_count * lattice.system.dim) * sizeof *u);
    memset(v, 0, (size_t)(lattice.system.node_count * lattice.system.dim) * sizeof *v);
}

static enum status try_relaxation(struct error *error)
{
    struct relaxation_options options = {.tolerance = 1e-3, .time_step_margin = 0.9};
    struct relaxation_report report;
    to_rest();
    return relaxation_run(&lattice.system, &options, u, NULL, &report, error);
}

static enum status try_dynamics(struct error *error)
{
    struct dynamics_options options = {.end_time = 0.01, .time_step_margin = 0.9};
    struct dynamics_report report;
    FREED_BY(energy_log_free) struct energy_log log = {0};
    to_rest();
    return dynamics_run(&lattice.system, &options, u, v, NULL, &log, &report, error);
}

/* Anew, with conditions on facets, a traction, a pressure, gravity and a contact. */
static enum status try_assembly(struct error *error)
{
    static const int32_t low[] = {0, 1, 1, 2, 2, 3}, high[] = {13, 12, 14, 13, 15, 14};
    static const double plate[] = {1.0, -0.01, -1.0, -0.01};
    const struct facet_set below = {3, low}, above = {3, high};
    const struct condition conditions[] = {
        {.name = "low", .where = "low", .facets = below},
        {.name = "high", .where = "high", .facets = above, .components = {0.0, -0.001}}};
    const struct load loads[] = {{.kind = LOAD_TRACTION, .facets = above, .components = {1.0, 1.0}},
                                 {.kind = LOAD_PRESSURE, .facets = above, .pressure = 1.0}};
    const struct contact_condition contacts[] = {
        {.where = "contact", .facets = below, .corners = plate, .rigid_count = 1}};
    struct assembly assembly = lattice.assembly;
    struct material_list *list = &assembly.materials;
    FREED_BY(system_free) struct solid_system system = {0};
    struct error note;
    assembly.conditions = conditions;
    assembly.loads = loads;
    assembly.contacts = contacts;
    assembly.condition_count = assembly.load_count = 2;
    assembly.contact_count = assembly.curve_count = 1;
    assembly.gravity[1] = -9.81;
    assembly.curves = array_new(1, sizeof *assembly.curves);
    if (assembly.curves == NULL) {
        return fail_memory(error, "curves");
    }
    assembly.curves[0] = curve_of_kind(CURVE_SMOOTH);
    assembly.face_table.faces = &assembly.boundary;
    assembly.face_table.lists = &assembly.boundary_lists;
    list->count = 1;
    memset(list->of_point, 0, (size_t)assembly.point_count * sizeof *list->of_point);
    enum status status = assembly_build(&assembly, &system, &note, error);
    lattice.assembly.materials = *list; /* may have moved */
    return status;
}

/* Let each allocation fail on a block pressed between its sides. */
static void fail_each_in(int dim, enum status (*try)(struct error *error), long least)
{
    int32_t curve = lattice_begin(&lattice, dim, dim == 2 ? 4 : 3, 0.0, CURVE_SMOOTH);
    lattice_slide(&lattice, 1u << 2, curve);
    lattice_push(&lattice, 3, -0.001, curve);
    lattice_push(&lattice, 3, -0.001, curve); /* twice: dropped conditions are checked */
    u = lattice_vector(&lattice);
    v = lattice_vector(&lattice);
    fail_each(try, least);
    lattice_free(&lattice);
}

TEST(relaxation_in_2d)
{
    fail_each_in(2, try_relaxation, 15);
}

TEST(dynamics_in_2d)
{
    fail_each_in(2, try_dynamics, 15);
}

TEST(assembly_in_2d)
{
    fail_each_in(2, try_assembly, 100);
}

TEST(relaxation_in_3d)
{
    fail_each_in(3, try_relaxation, 15);
}

TEST(dynamics_in_3d)
{
    fail_each_in(3, try_dynamics, 15);
}

#endif

RUN_TESTS(NULL, NULL)
