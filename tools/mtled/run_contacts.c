/* Notes and verdicts on contacts: where they begin, penetration, and sides that slide. */
#include "mtled/run.h"

#include "solid/equilibrium/statics.h"
#include "solid/system/energy.h"

#include <math.h>

/* A result of which more than this share of the forces is missing, because of the remaining penetration, is
 * refused; sliding sides are reported if they leave their surface by more than this share of how far they
 * slide. */
static const double most_missing = 0.01;

/* The largest displacement prescribed by rows of conditions, m. */
static double prescribed_motion(const struct solid_system *system, const struct constraint_rows *rows)
{
    double most = 0.0;
    for (int64_t r = 0; r < rows->count; r++) {
        most = fmax(most, fabs(rows->target[r]) * curve_largest(&system->curves[rows->curve[r]]));
    }
    return most;
}

/* The largest motion of the surface at the points of its contact, m: not that at the rim of a wide surface
 * that turns. */
static double own_motion(const struct solid_system *system, const struct contact *contact)
{
    const struct rigid_motion *motion = &contact->motion;
    double length = 0.0;
    for (int64_t p = 0; p < contact->count && motion->moves; p++) {
        length = fmax(length, rigid_motion_path(motion, contact->dim, contact->rest + p * contact->dim));
    }
    return motion->moves ? length * fmax(curve_largest(&system->curves[motion->translation_curve]),
                                         curve_largest(&system->curves[motion->rotation_curve]))
                         : 0.0;
}

/* A motion of more than STATICS_MOST_SIZES sizes of the body is noted: the scene may have m in place of mm.
 * More than MODEL_MOST_SIZES is refused. */
static void check_motion(const struct run *run, const char *where, const char *what, double way)
{
    static const char text[] = "%s: a %s of %.3g m is prescribed, %.3g times the size of the body: "
                               "lengths without a unit are in m";
    double sizes = way / run->model->assembly.extent;
    if (sizes > MODEL_MOST_SIZES) {
        tool_fail(run->tool, STATUS_INPUT, text, where, what, way, sizes);
    }
    if (sizes > STATICS_MOST_SIZES) {
        tool_note(run->tool, text, where, what, way, sizes);
    }
}

void run_contacts_begin(const struct run *run)
{
    const struct solid_system *system = &run->model->system;
    check_motion(
        run, run->scene->path, "displacement",
        fmax(prescribed_motion(system, &system->rows), prescribed_motion(system, &system->penalties)));
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        if (contact->surface.facet_count > 0) {
            check_motion(run, run->model->assembly.contacts[contact->section].where, "motion",
                         own_motion(system, contact));
        }
    }
}

void run_contacts_penetrate(struct run *run, double motion, double allowed, bool final)
{
    struct solid_system *system = &run->model->system;
    const struct contact *worst = system->contacts;
    double missing = 0.0, miss;
    char forces[64] = "";
    system_measure_contacts(system, run->u, false);
    for (int64_t c = 1; c < system->contact_count; c++) {
        worst = contact_miss(&system->contacts[c]) > contact_miss(worst) ? &system->contacts[c] : worst;
    }
    miss = system_contact_miss(system);
    if (miss <= statics_round_off(system)) { /* as at the start, where nothing has moved */
        return;
    }
    if (!run->model->assembly.in_time && miss > run->scene->solver.tolerance * motion) {
        missing = system_missing_work(system) / (2.0 * energy_internal(system, run->u));
    }
    const char *name = run->scene->contacts[worst->section].label.name;
    const char *remedy = run->model->assembly.in_time
                             ? "a larger stiffness, with shorter steps, or a finer cloud there helps"
                             : "leave its stiffness out, leave facets that a [displacement] moves out of it, "
                               "refine there, or prescribe `normal` on sides that stay in contact";
    if (missing > most_missing) {
        run->last_good = -1.0; /* all frames have been given */
        run_fail(run, STATUS_VERDICT,
                 "contacts penetrate by %.2g m, most [contact %s], so that forces are too small by about "
                 "%.2g %%: %s",
                 miss, name, 100.0 * fmin(missing, 1.0), remedy);
    }
    if (missing > 0.0) {
        snprintf(forces, sizeof forces, ", so that forces may be %.2g %% too small", 100.0 * missing);
    }
    if (final && miss > allowed) {
        run_note(run, "contacts penetrate by %.2g m, not %.2g m, most [contact %s]%s: %s", miss, allowed,
                 name, forces, remedy);
    }
}

void run_contacts_touch(const struct run *run)
{
    const struct solid_system *system = &run->model->system;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        if (contact->deepest == 0.0 && contact->surface.facet_count > 0) {
            run_note(run,
                     "[contact %s]: the body never touches the rigid surface: has that the right unit "
                     "and place, and does it begin outside the body?",
                     run->scene->contacts[contact->section].label.name);
        }
    }
}

void run_sliding_judge(const struct run *run)
{
    const struct solid_system *system = &run->model->system;
    struct sliding_error worst;
    if (system->sliding.facet_count == 0) {
        return;
    }
    SCRATCH double *field = run_new_values(run, system->node_count * system->dim);
    assembly_nodal_field(&run->model->assembly, run->u, field);
    TOOL_TRY(run->tool, sliding_measure(&system->sliding, system->dim, system->node_count, system->X, field,
                                        &worst, &error));
    if (worst.share > most_missing) {
        run_note(
            run,
            "[displacement %s]: the side slides by %.2g m where its radius is %.2g m, at %s m: it leaves "
            "its surface by %.2g m, as `normal` acts along the normal at rest: use a [contact] with that "
            "surface as rigid one, or smaller loads",
            system->conditions[worst.section].name, worst.slide,
            0.5 * worst.slide * worst.slide / worst.distance, POINT_TEXT(system->dim, worst.place),
            worst.distance);
    }
}
