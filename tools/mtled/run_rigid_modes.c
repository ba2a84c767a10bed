/* Free rigid-body modes: reported before the first step. */
#include "mtled/run.h"

#include "approx/support/support.h"
#include "base/sets.h"
#include "solid/contact/contact_between.h"
#include "solid/system/rigid_modes.h"

#include <math.h>
#include <string.h>

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

/* The number of bodies from `first` on that may move or turn, and on which no contact acts. */
static int64_t count_free(const struct bodies *bodies, int64_t first)
{
    int64_t count = 0;
    for (int64_t b = first; b < bodies->count; b++) {
        count += !bodies->touches[b] && is_loose(bodies, b);
    }
    return count;
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
            int64_t more = count_free(&bodies, b + 1);
            char others[64] = "";
            if (more > 0) {
                snprintf(others, sizeof others, "; %jd more bod%s free as well", more,
                         more == 1 ? "y is" : "ies are");
            }
            run_fail(run, STATUS_VERDICT, "nothing holds %s: it %s: add a [displacement] that forbids that%s",
                     told.body, told.what, others);
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
                int64_t corner = between->opposite.surface.facet[between->view[p].facet * system->dim];
                bodies->touches[bodies->of_node[between->opposite.rows.node[corner]]] = true;
            }
        }
    }
}

void run_check_lost(const struct run *run, double error_left)
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
