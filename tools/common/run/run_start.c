/* The start of a run from the field of another one, near its result: of a coarser mesh, before a cut, or with
 * other materials or loads. */
#include "run/run.h"

#include <math.h>
#include <string.h>

void run_start_read(struct run *run)
{
    const struct scene *scene = run->scene;
    const char *file = run->start_file;
    if (file == NULL) {
        return;
    }
    if (scene->analysis == SCENE_DYNAMIC || scene->output.frames > 0 || scene->solver.time_steps > 0) {
        tool_fail(run->tool, STATUS_INPUT,
                  "--start: the run begins at the whole load: a scene in time, with friction, or that asks "
                  "for frames, has states before");
    }
    side_read(run->tool, file, "u", &run->start);
    const struct nodal_field *field = &run->start.field;
    if (field->cells.dim != scene->dim || field->cols != scene->dim) {
        tool_fail(run->tool, STATUS_INPUT, "--start: %s: u has %lld columns in %dD, where the scene has %dD",
                  file, (long long)field->cols, field->cells.dim, scene->dim);
    }
    if (field->cells.count == 0) {
        tool_fail(run->tool, STATUS_INPUT, "--start: %s: has no cells, between which u is interpolated",
                  file);
    }
}

void run_start(struct run *run)
{
    struct solid_system *system = &run->model->system;
    const struct nodal_field *field = &run->start.field;
    if (run->start_file == NULL) {
        return;
    }
    const double *values = field->parameters != NULL ? field->parameters : field->values;
    TOOL_TRY(run->tool, fail_in(&error,
                                field_carry(&field->cells, field->cols, values, &run->model->assembly.cells,
                                            run->u, &error),
                                "--start: %s", run->start.name));
    if (!isfinite(field_largest(system->node_count, system->dim, run->u))) {
        tool_fail(run->tool, STATUS_INPUT, "--start: %s: u has values that are not finite numbers",
                  run->start.name);
    }
    TOOL_TRY(run->tool, system_start(system, run->u, &error));
}
