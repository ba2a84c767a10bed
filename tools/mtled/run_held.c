/* Notes and verdicts on what holds a body: contacts, where they begin, and their penetration; sides that
 * slide; and motions as a whole that nothing prevents. */
#include "mtled/run.h"

#include "approx/support/support.h"
#include "base/sets.h"
#include "solid/contact/contact_between.h"
#include "solid/equilibrium/statics.h"
#include "solid/system/energy.h"
#include "solid/system/rigid_modes.h"

#include <math.h>
#include <string.h>

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
        fmax(prescribed_motion(system, &system->rows), prescribed_motion(system, &system->springs.rows)));
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
    if (!(motion > 0.0) || miss <= statics_round_off(system)) { /* as at the start, where nothing has moved */
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

/* Note rigid surfaces that the body has never touched. */
static void judge_touch(const struct run *run)
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

/* Note a curved side that leaves its surface. */
static void judge_sliding(const struct run *run)
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

/* ---- bodies that may move as a whole ---- */

/* The bodies of a model: parts that are connected by cells. */
struct bodies {
    int32_t count;
    int32_t *of_node;          /* node_count; nodes without cell are bodies of their own */
    int64_t *cell;             /* count: one of its cells, whose region is named in messages */
    bool *touches;             /* count: a contact acts on it, with a rigid surface or a constrained body */
    struct rigid_modes *modes; /* count */
};

/* Find the bodies on which contacts act: with a rigid surface; or with other bodies, if any of those that
 * hang together by contacts is constrained or touches a rigid surface. */
static enum status find_touching(const struct solid_system *system, struct bodies *bodies,
                                 struct error *error)
{
    int all = system->dim == 2 ? 3 : 6;
    NEW_SCRATCH(int32_t, first, bodies->count, error); /* see sets.h */
    NEW_SCRATCH(int32_t, joined, bodies->count, error);
    NEW_SCRATCH(bool, stays, bodies->count, error);
    for (int32_t b = 0; b < bodies->count; b++) {
        first[b] = b;
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact_between *between = system->contacts[c].between;
        const struct boundary_averages *points = &system->contact_points[c];
        for (int64_t p = 0; p < points->count; p++) {
            int32_t b = bodies->of_node[points->node[p]];
            bodies->touches[b] |= between == NULL;
            set_join(first, bodies->of_node[points->node[0]], b);
        }
        for (int64_t p = 0; between != NULL && p < between->opposite.rows.count; p++) {
            set_join(first, bodies->of_node[points->node[0]],
                     bodies->of_node[between->opposite.rows.node[p]]);
        }
    }
    for (int32_t b = 0; b < bodies->count; b++) {
        joined[set_first(first, b)]++;
        stays[set_first(first, b)] |=
            bodies->touches[b] || bodies->modes[b].translations + bodies->modes[b].turns < all;
    }
    for (int32_t b = 0; b < bodies->count; b++) {
        bodies->touches[b] |= joined[set_first(first, b)] > 1 && stays[set_first(first, b)];
    }
    return STATUS_OK;
}

static enum status bodies_find(const struct model *model, struct bodies *bodies, struct error *error)
{
    const struct cells *cells = &model->assembly.cells;
    const struct solid_system *system = &model->system;
    *bodies = (struct bodies){0};
    RETURN_IF_ERROR(NEW_ARRAY(&bodies->of_node, cells->node_count, error));
    set_join_cells(cells->node_count, cells->count, cells->dim + 1, cells->node, bodies->of_node);
    bodies->count = set_number(cells->node_count, bodies->of_node);
    RETURN_IF_ERROR(NEW_ARRAY(&bodies->cell, bodies->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&bodies->touches, bodies->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&bodies->modes, bodies->count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        bodies->cell[bodies->of_node[cells->node[c * (cells->dim + 1)]]] = c;
    }
    RETURN_IF_ERROR(system_rigid_modes(system, bodies->count, bodies->of_node, bodies->modes, error));
    return find_touching(system, bodies, error);
}

static void bodies_free(struct bodies *bodies)
{
    FREE_ALL(bodies->of_node, bodies->cell, bodies->touches, bodies->modes);
}

/* text = a direction with positive largest component, without round-off. */
static void direction_text(int dim, const double *direction, char text[96])
{
    double x[3];
    int largest = 0;
    for (int a = 0; a < dim; a++) {
        largest = fabs(direction[a]) > fabs(direction[largest]) + 1e-6 ? a : largest;
    }
    for (int a = 0; a < dim; a++) {
        x[a] = fabs(direction[a]) > 1e-6 ? direction[a] * copysign(1.0, direction[largest]) : 0.0;
    }
    point_text(dim, x, text);
}

/* text = "may move along (1, 0), may turn about (0, 0.1)". */
static void modes_text(int dim, double size, const struct rigid_modes *modes, char *text, size_t room)
{
    char what[96];
    snprintf(text, room, "%s", modes->translations == dim ? "may move along any direction" : "");
    for (int k = 0; k < modes->translations && modes->translations < dim; k++) {
        direction_text(dim, modes->along[k], what);
        text_append(text, room, "%smay move along %s", text[0] != '\0' ? ", " : "", what);
    }
    if (modes->turns == (dim == 2 ? 1 : 3) && modes->translations == dim) {
        text_append(text, room, " and turn about any axis");
        return;
    }
    for (int k = 0; k < modes->turns; k++) {
        double through[3];
        for (int a = 0; a < dim; a++) {
            through[a] = fabs(modes->through[k][a]) > 1e-9 * size ? modes->through[k][a] : 0.0;
        }
        direction_text(dim, modes->axis[k], what);
        text_append(text, room, "%smay turn about %s%s%s%s", text[0] != '\0' ? ", " : "",
                    dim == 2 ? "" : "the axis through ", POINT_TEXT(dim, through), dim == 2 ? "" : " along ",
                    dim == 2 ? "" : what);
    }
}

/* What a body may do, and its name: "the body", or "body 2 (region lump, near (0.1, 0.2))", from 1. */
struct told {
    char body[256], what[512];
};

static struct told tell(const struct run *run, const struct bodies *bodies, int64_t b)
{
    const struct assembly *input = &run->model->assembly;
    FREED_BY(groups_free) struct groups regions = {0};
    struct told told = {.body = "the body"};
    modes_text(input->cells.dim, input->extent, &bodies->modes[b], told.what, sizeof told.what);
    if (bodies->count > 1) {
        TOOL_TRY(run->tool, stream_groups(run->stream, GROUP_REGION, true, &regions, &error));
        snprintf(told.body, sizeof told.body, "body %jd (region %s, near %s)", b + 1,
                 regions.names.name[regions.group[bodies->cell[b]]],
                 POINT_TEXT(input->cells.dim, bodies->modes[b].centre));
    }
    return told;
}

static bool is_loose(const struct bodies *bodies, int64_t b)
{
    return bodies->modes[b].translations + bodies->modes[b].turns > 0;
}

void run_check_rigid_modes(struct run *run)
{
    FREED_BY(bodies_free) struct bodies bodies = {0};
    TOOL_TRY(run->tool, bodies_find(run->model, &bodies, &error));
    for (int64_t b = 0; b < bodies.count; b++) {
        if (!is_loose(&bodies, b)) {
            continue;
        }
        struct told told = tell(run, &bodies, b);
        if (!bodies.touches[b]) {
            run_fail(run, STATUS_VERDICT, "nothing holds %s: it %s: add a [displacement] that forbids that",
                     told.body, told.what);
        }
        if (run->verbose) {
            run_note(run, "only contact holds %s: it %s otherwise", told.body, told.what);
        }
    }
}

/* Let only those bodies touch that contacts press at the end, by more than an error of the displacement
 * gives, m. */
static void mark_pressed(const struct run *run, const struct bodies *bodies, double error)
{
    const struct solid_system *system = &run->model->system;
    memset(bodies->touches, 0, (size_t)bodies->count * sizeof *bodies->touches);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct contact_between *between = contact->between;
        for (int64_t p = 0; p < contact->count; p++) {
            if (contact->pressure[p] <= contact->stiffness[p] * error) {
                continue;
            }
            bodies->touches[bodies->of_node[contact->points->node[p]]] = true;
            if (between != NULL) {
                int64_t corner = between->opposite.surface.facet[contact->view[p].facet * system->dim];
                bodies->touches[bodies->of_node[between->opposite.rows.node[corner]]] = true;
            }
        }
    }
}

/* Note bodies that no contact presses any more. */
static void judge_lost(const struct run *run, double error_left)
{
    FREED_BY(bodies_free) struct bodies bodies = {0};
    if (run->model->system.contact_count == 0) {
        return;
    }
    TOOL_TRY(run->tool, bodies_find(run->model, &bodies, &error));
    mark_pressed(run, &bodies, error_left);
    for (int64_t b = 0; b < bodies.count; b++) {
        if (!is_loose(&bodies, b) || bodies.touches[b]) {
            continue;
        }
        struct told told = tell(run, &bodies, b);
        run_note(run,
                 "at the end no contact presses %s, which nothing else holds: it %s, and lies anywhere; it "
                 "may have slipped out of its contacts or turned over: frames show when",
                 told.body, told.what);
    }
}

void run_held_judge(const struct run *run, double error_left)
{
    judge_touch(run);
    if (error_left >= 0.0) {
        judge_lost(run, error_left);
    }
    judge_sliding(run);
}
