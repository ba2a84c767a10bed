#include "run/run.h"

#include "approx/cells/cells.h"
#include "approx/field/field.h"
#include "approx/field/field_compare.h"
#include "base/eigen.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Near a stable equilibrium, with damping, moves fall. Near one that is not stable they fall until the mode
 * that leaves it has grown, and then rise exponentially. So a body has left an equilibrium when, under a load
 * that is held, the largest of the last samples' moves has risen by this factor over what it was at an
 * estimated error below `near_error`, and that by what a slow mode that was added since may have raised it;
 * moves below a share of the displacement are round-off. */
static const double growth = 4.0, near_error = 0.1, least_share = 1e-6;

/* A plane side creases when it is compressed to this stretch (Hong, Zhao and Suo 2009). An instability of a
 * body that is compressed by less is that of its shape, whose length the mesh resolves. So is one whose move
 * changes by less than this share of its largest over a cell there: it falls off over three cells or more. */
static const double crease_stretch = 0.65, most_change = 1.0 / 3.0;

/* A result is refused if the law is not strongly elliptic in more than this share of the body. It is a few
 * percent if it is so at singular corners only, and half if the body has become irregular. */
static const double most_inelliptic = 0.1;

static int64_t parameter_count(const struct run *run)
{
    return run->model->system.node_count * run->model->system.dim;
}

void run_stability_begin(struct run *run)
{
    struct run_stability *stability = &run->stability;
    const struct state *restored = run_checkpoint_state(run);
    *stability = (struct run_stability){.least = INFINITY};
    stability->near = run_new_values(run, parameter_count(run));
    if (restored != NULL) {
        TOOL_TRY(run->tool, run_stability_state(run, restored, &error));
    }
}

void run_stability_free(struct run *run)
{
    free(run->stability.near);
}

void run_stability_follow(struct run *run, const struct progress *progress)
{
    struct run_stability *stability = &run->stability;
    const struct solid_system *system = &run->model->system;
    int64_t last = (stability->samples + RUN_STABILITY_SAMPLES - 1) % RUN_STABILITY_SAMPLES;
    if (stability->left || run->scene->analysis == SCENE_DYNAMIC || system_has_touched(system)) {
        return; /* augmentations, and points that come and go, begin another problem */
    }
    if (progress->time != stability->load || !isfinite(progress->move)) {
        stability->load = progress->time;
        stability->least = INFINITY;
        stability->samples = 0;
    }
    if (!isfinite(progress->move) || (stability->samples > 0 && progress->move == stability->move[last])) {
        return; /* nothing new: an interruption comes between two samples */
    }
    stability->move[stability->samples++ % RUN_STABILITY_SAMPLES] = progress->move;
    if (stability->samples < RUN_STABILITY_SAMPLES) {
        return;
    }
    double move = 0.0;
    for (int i = 0; i < RUN_STABILITY_SAMPLES; i++) {
        move = fmax(move, stability->move[i]);
    }
    if (move < stability->least && progress->error < near_error) {
        stability->least = move;
        memcpy(stability->near, progress->u, (size_t)parameter_count(run) * sizeof *progress->u);
    } else if (move > growth * stability->least &&
               move > least_share * field_largest(system->node_count, system->dim, progress->u)) {
        stability->left = true;
        stability->since = stability->negative ? stability->since : progress->time;
    }
    stability->least *= progress->raised;
}

void run_stability_check(struct run *run, double load)
{
    struct run_stability *stability = &run->stability;
    const struct stability *found = &run->model->system.stability;
    if (found->least < 0.0 && !stability->negative) {
        stability->negative = true;
        stability->since = stability->left ? stability->since : load;
        stability->node = found->node;
    }
}

void run_stability_elliptic(struct run *run, double load, bool final)
{
    static const char text[] =
        "%s: %s the material law is not strongly elliptic in %.2g %% of the body, as at "
        "%s: what it does there depends on the mesh: use another model, as "
        "neo-hookean, or a smaller load";
    struct inelliptic found = body_inelliptic(&run->model->system.body);
    char place[96], when[48] = "at the whole load,";
    if (found.point < 0) {
        return;
    }
    point_text(run->scene->dim, run->model->assembly.x + found.point * run->scene->dim, place);
    if (load < 1.0) {
        snprintf(when, sizeof when, "at %.4g of the load,", load);
    }
    if (found.share > most_inelliptic) {
        run->last_good = -1.0; /* all frames have been given */
        run_fail(run, STATUS_VERDICT, text, run->scene->path, when, 100.0 * found.share, place);
    }
    if (final) {
        tool_note(run->tool, text, run->scene->path, when, 100.0 * found.share, place);
    }
}

enum status run_stability_state(struct run *run, const struct state *state, struct error *error)
{
    struct run_stability *s = &run->stability;
    const struct state_value values[] = {
        {"load", STATE_NUMBERS, &s->load, 1},       {"move", STATE_NUMBERS, s->move, RUN_STABILITY_SAMPLES},
        {"least", STATE_NUMBERS, &s->least, 1},     {"near", STATE_NUMBERS, s->near, parameter_count(run)},
        {"looks", STATE_COUNTS, &s->samples, 1},    {"left", STATE_FLAGS, &s->left, 1},
        {"negative", STATE_FLAGS, &s->negative, 1}, {"since", STATE_NUMBERS, &s->since, 1},
        {"node", STATE_COUNTS, &s->node, 1}};
    return state_visit(state, "stability", values, sizeof values / sizeof *values, error);
}

/* The largest move from the state that was left to the final one, m, and its node. */
static double moved_since(const struct run *run, int64_t *node)
{
    const double *near = run->stability.near;
    int dim = run->scene->dim;
    double most = 0.0;
    *node = 0;
    for (int64_t n = 0; n < run->model->system.node_count; n++) {
        double move2 = vector_distance2(dim, run->u + n * dim, near + n * dim);
        if (move2 > most * most) {
            most = sqrt(move2);
            *node = n;
        }
    }
    return most;
}

/* The least principal stretch of a cell whose nodes move by the field. */
static double least_stretch(const struct cells *cells, int64_t c, const double *field)
{
    int dim = cells->dim;
    double F[9] = {0.0}, C[9] = {0.0}, value[3], directions[9], least = INFINITY;
    for (int k = 0; k <= dim; k++) {
        int32_t face[3];
        double area[3];
        const double *u = field + (int64_t)cells->node[c * (dim + 1) + k] * dim;
        cell_face(cells, c, k, face);
        face_area_vector(dim, cells->x, face, area); /* -dim V grad N_k */
        for (int i = 0; i < dim * dim; i++) {
            F[i] +=
                (i / dim == i % dim && k == 0) - u[i / dim] * area[i % dim] / (dim * cell_volume(cells, c));
        }
    }
    for (int i = 0; i < dim * dim; i++) {
        for (int k = 0; k < dim; k++) {
            C[i] += F[k * dim + i / dim] * F[k * dim + i % dim];
        }
    }
    eigen_symmetric(dim, C, value, directions);
    for (int k = 0; k < dim; k++) {
        least = fmin(least, value[k]);
    }
    return sqrt(fmax(least, 0.0));
}

/* Whether the body left a state by an instability of its shape: at `node`, which moved most, the cells were
 * compressed by less than what makes a side crease, or what it moved by varies little over them. */
static bool is_of_shape(const struct run *run, int64_t node)
{
    const struct cells *cells = &run->model->assembly.cells;
    int dim = cells->dim;
    SCRATCH double *near = run_new_values(run, parameter_count(run)),
                   *move = run_new_values(run, parameter_count(run));
    double stretch = INFINITY, change = 0.0;
    assembly_nodal_field(&run->model->assembly, run->stability.near, near);
    assembly_nodal_field(&run->model->assembly, run->u, move);
    for (int64_t i = 0; i < parameter_count(run); i++) {
        move[i] -= near[i];
    }
    for (int64_t i = 0; i < cells->count * (dim + 1); i++) {
        int64_t c = i / (dim + 1);
        if (cells->node[i] != node) {
            continue;
        }
        stretch = fmin(stretch, least_stretch(cells, c, near));
        for (int k = 0; k <= dim; k++) {
            int64_t other = cells->node[c * (dim + 1) + k];
            change = fmax(change, vector_distance(dim, move + node * dim, move + other * dim));
        }
    }
    bool is_long = change < most_change * vector_length(dim, move + node * dim);
    return stretch > crease_stretch || is_long;
}

bool run_stability_describe(const struct run *run, char *text, size_t size)
{
    const struct run_stability *stability = &run->stability;
    const struct solid_system *system = &run->model->system;
    char place[96], when[48];
    int64_t node = 0;
    text[0] = '\0';
    snprintf(when, sizeof when, stability->since < 1.0 ? "from %.4g of the load on" : "at the whole load",
             stability->since);
    double moved = stability->left ? moved_since(run, &node) : 0.0;
    if (moved > run->error) { /* else it is the same state */
        bool stands = !stability->negative && is_of_shape(run, node);
        point_text(system->dim, system->X + node * system->dim, place);
        snprintf(text, size,
                 stands
                     ? "%s, the body has buckled, most of all, by %.2g m, at %s: the state that it left was "
                       "not stable, this one is, and so may be others, as its mirror image"
                     : "the body folds %s: it buckles or wrinkles, away from an equilibrium that is not "
                       "stable, most of all, by %.2g m, at %s",
                 when, moved, place);
        return stands;
    }
    if (system->stability.left > 0.0 && !stability->negative) {
        snprintf(text, size,
                 "at %.4g of the load the body has left an equilibrium that is not stable: this one is, and "
                 "so may be "
                 "others, as its mirror image",
                 system->stability.left);
        return true;
    }
    if (stability->negative) {
        point_text(system->dim, system->X + stability->node * system->dim, place);
        snprintf(text, size,
                 "the body folds %s: its equilibrium is not stable, and would buckle or wrinkle, most of all "
                 "at %s",
                 when, place);
    }
    return false;
}
