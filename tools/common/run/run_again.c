/* If parts of a body pass through each other, it is computed again with contact of its boundary with itself.
 * The search for this contact takes time in each step, so it is only used where it is needed. */
#include "run/run.h"

#include <stdio.h>
#include <string.h>

void run_touch_itself(struct run *run)
{
    static char *whole[] = {"*"};
    const struct name_list boundary = {.names = whole, .count = 1};
    struct scene *scene = run->scene;
    char *where;
    if (asprintf(&where, "%s: contact of the body with itself", scene->path) < 0) {
        where = NULL;
    }
    TOOL_TRY(run->tool, owned_add(&scene->owned, where, scene->path, &error));
    TOOL_TRY(run->tool, RESIZE_ARRAY(&scene->contacts, scene->contact_count + 1, &error));
    scene->contacts[scene->contact_count++] = (struct scene_contact){
        .label = {.name = "itself", .where = where}, .facets = boundary, .against = boundary};
    run->touches_itself = true;
}

bool run_again(struct run *run)
{
    if (!run->again) {
        return false;
    }
    run->again = false;
    run->checkpoint.is_restored = false;
    run_touch_itself(run);
    TOOL_TRY(run->tool, model_renew_contacts(run->model, &error));
    const struct solid_system *system = &run->model->system;
    memset(run->u, 0, (size_t)(system->node_count * system->dim) * sizeof *run->u);
    run_start(run);
    memset(run->model->row_force, 0, (size_t)system->rows.count * sizeof *run->model->row_force);
    run_drop_frames(run->stream);
    stream_remove(run->stream, "energy");
    run_folds_forget(run);
    run_stability_free(run);
    run_stability_begin(run);
    return true;
}
