/* A body whose parts pass through each other is computed once more, with contact of its boundary with itself.
 * So this contact, whose search takes time in each step, is modelled where a scene needs it. */
#include "run.h"

#include <stdlib.h>
#include <string.h>

static char *copy(const struct run *run, const char *text)
{
    char *new = strdup(text);
    if (new == NULL) {
        tool_fail(run->tool, STATUS_SYSTEM, "out of memory");
    }
    return new;
}

/* A list of one name. */
static struct name_list list_of(const struct run *run, const char *name)
{
    struct name_list list = {.count = 1};
    TOOL_TRY(run->tool, NEW_ARRAY(&list.names, 1, &error));
    list.names[0] = copy(run, name);
    return list;
}

void run_touch_itself(struct run *run)
{
    struct scene *scene = run->scene;
    struct scene_contact *contacts;
    char where[400];
    TOOL_TRY(run->tool, NEW_ARRAY(&contacts, scene->contact_count + 1, &error));
    if (scene->contact_count > 0) {
        memcpy(contacts, scene->contacts, (size_t)scene->contact_count * sizeof *contacts);
    }
    free(scene->contacts);
    scene->contacts = contacts;
    snprintf(where, sizeof where, "%s: contact of the body with itself", scene->path);
    contacts[scene->contact_count] =
        (struct scene_contact){.label = {.name = copy(run, "itself"), .where = copy(run, where)},
                               .facets = list_of(run, "*"),
                               .against = list_of(run, "*")};
    scene->contact_count++;
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
    memset(run->model->row_force, 0, (size_t)system->rows.count * sizeof *run->model->row_force);
    run_drop_frames(run->stream);
    run_folds_forget(run);
    run_stability_free(run);
    run_stability_begin(run);
    return true;
}
