/* The start of a run from the field of another one, near its result: of a coarser mesh, before a cut, or with
 * other materials or loads. */
#include "mtled/run.h"

/* The least share of a field that a run begins at. */
static const double least_start = 0.05;

void run_start_read(struct run *run)
{
    const struct scene *scene = run->scene;
    const char *file = run->start_file;
    if (file == NULL) {
        return;
    }
    if (scene->analysis == SCENE_DYNAMIC || scene->output.frames > 0 || scene->duration > 0.0 ||
        scene->solver.time_steps > 0) {
        tool_fail(run->tool, STATUS_INPUT,
                  "--start: the run begins at the whole load: a scene in time, with friction, or that asks "
                  "for frames, has states before");
    }
    side_read_displacement(run->tool, file, "u", scene->dim, &run->start);
}

/* A body that has been cut may be inverted, at the edge of an earlier cut, in a field that was none of its
 * own: then the run begins at half of that, and so on. */
static void halve_inverted(struct run *run)
{
    struct solid_system *system = &run->model->system;
    int64_t size = system->node_count * system->dim;
    SCRATCH double *force = run_new_values(run, size);
    double share = 1.0;
    while (share > least_start && !(body_force(&system->body, run->u, force).least_jacobian > 0.0)) {
        share *= 0.5;
        for (int64_t i = 0; i < size; i++) {
            run->u[i] *= 0.5;
        }
    }
    if (share < 1.0) {
        tool_note(run->tool, "--start: %s: inverts a cell: begun at %g of u", run->start.name, share);
    }
}

void run_start(struct run *run)
{
    const struct nodal_field *field = &run->start.field;
    if (run->start_file == NULL) {
        return;
    }
    const double *values = field->parameters != NULL ? field->parameters : field->values;
    TOOL_TRY(run->tool, fail_in(&error,
                                field_carry(&field->cells, field->cols, values, &run->model->assembly.cells,
                                            run->u, &error),
                                "--start: %s", run->start.name));
    halve_inverted(run);
    TOOL_TRY(run->tool, system_start(&run->model->system, run->u, &error));
}
