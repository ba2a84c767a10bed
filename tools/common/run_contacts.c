/* What a run tells of its contacts: those that the body's facets are too large for, and what gives way. */
#include "run.h"

#include "solid/contact_patch.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More than this part of a contact's force on patches that are less than three nodes across. */
static const double most_thin = 0.5;

/* Positions of the nodes. */
static double *deformed(const struct run *run)
{
    const struct solid_system *system = &run->model->system;
    double *x = run_new_values(run, system->node_count * system->dim);
    assembly_nodal_field(&run->model->assembly, run->u, x);
    for (int64_t i = 0; i < system->node_count * system->dim; i++) {
        x[i] += system->X[i];
    }
    return x;
}

/* Whether the scene asks for what such patches are wrong about. */
static bool wants_forces(const struct scene_output *output)
{
    return output->reactions || output->moments || output->gaps;
}

/* Exits where a surface has gone into the body between its nodes. */
static void judge_patch(struct run *run, const struct contact *contact, const struct contact_patch *patch,
                        double slack)
{
    const struct solid_system *system = &run->model->system;
    const char *name = run->scene->contacts[contact->section].label.name;
    char place[96];
    if (patch->inside > slack) {
        point_text(system->dim, patch->place, place);
        run->last_good = -1.0; /* the frames are all there */
        run_fail(
            run, STATUS_VERDICT,
            "%s: [contact %s]: the rigid surface is %.2g m inside the body at %s, between its nodes, and "
            "nothing presses: begin with the surface outside, and refine the body there until its facets are "
            "smaller than the contact",
            run->scene->path, name, patch->inside, place);
    }
    if (patch->thin > most_thin && wants_forces(&run->scene->output)) {
        point_text(system->dim, system->X + (int64_t)patch->node * system->dim, place);
        tool_note(
            run->tool,
            "%s: [contact %s]: presses on %lld node%s, most of it about %s, where that is less than three "
            "across: the force may be off by tens of percent: refine the body there to a third of the "
            "contact's radius",
            run->scene->path, name, (long long)patch->pressing, patch->pressing == 1 ? "" : "s", place);
    }
}

void run_contacts_judge(struct run *run, double slack, double share)
{
    struct solid_system *system = &run->model->system;
    struct error error;
    double *x = system->contact_count > 0 ? deformed(run) : NULL;
    struct cells cells = run->model->assembly.cells;
    cells.x = x;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct facet_set *set = &run->model->assembly.contacts[contact->section].facets;
        struct contact_patch patch;
        tool_check(run->tool, contact_patch_find(contact, set, &cells, &patch, &error), &error);
        judge_patch(run, contact, &patch, fmax(slack, share * patch.width));
    }
    free(x);
}
