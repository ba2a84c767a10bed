#include "run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The distance from a stable equilibrium falls: with damping, energy is lost. Where it grows, it does so
 * exponentially. A state whose estimated error is below `near_error` of the displacement is left when the
 * error has become `growth` times as large. */
static const double near_error = 0.1, growth = 10.0;

/* The estimate follows what has been changed after so many looks. One that rises by more than this in a look
 * is itself corrected: a slower mode was found. */
static const int64_t first_looks = 2;
static const double jump = 4.0;

static int64_t parameter_count(const struct run *run)
{
    return run->model->system.node_count * run->model->system.dim;
}

void run_stability_begin(struct run *run)
{
    struct error error;
    struct run_stability *stability = &run->stability;
    const struct state *restored = run_checkpoint_state(run);
    *stability = (struct run_stability){.error = INFINITY, .last = INFINITY};
    stability->near = run_new_values(run, parameter_count(run));
    if (restored != NULL) {
        tool_check(run->tool, run_stability_state(run, restored, &error), &error);
    }
}

void run_stability_free(struct run *run)
{
    free(run->stability.near);
}

void run_stability_follow(struct run *run, const struct progress *progress)
{
    struct run_stability *stability = &run->stability;
    if (stability->left || run->scene->analysis == SCENE_DYNAMIC || run->model->system.contact_count > 0) {
        return;
    }
    bool corrected = progress->error > jump * stability->last;
    stability->last = progress->error;
    if (progress->time != stability->load || corrected) {
        stability->load = progress->time;
        stability->error = INFINITY;
        stability->looks = 0;
    }
    if (++stability->looks <= first_looks) {
        return;
    }
    if (progress->error < stability->error) {
        stability->error = progress->error;
        memcpy(stability->near, progress->u, (size_t)parameter_count(run) * sizeof *progress->u);
    } else if (stability->error < near_error && progress->error > growth * stability->error) {
        stability->left = true;
        stability->since = stability->negative ? stability->since : progress->time;
    }
}

void run_stability_look(struct run *run, double load)
{
    struct run_stability *stability = &run->stability;
    const struct stability *found = &run->model->system.stability;
    if (found->least < 0.0 && !stability->negative) {
        stability->negative = true;
        stability->since = stability->left ? stability->since : load;
        stability->node = found->node;
    }
}

enum status run_stability_state(struct run *run, const struct state *state, struct error *error)
{
    struct run_stability *s = &run->stability;
    const struct state_value values[] = {
        {"load", STATE_NUMBERS, &s->load, 1},       {"error", STATE_NUMBERS, &s->error, 1},
        {"last", STATE_NUMBERS, &s->last, 1},       {"near", STATE_NUMBERS, s->near, parameter_count(run)},
        {"looks", STATE_COUNTS, &s->looks, 1},      {"left", STATE_FLAGS, &s->left, 1},
        {"negative", STATE_FLAGS, &s->negative, 1}, {"since", STATE_NUMBERS, &s->since, 1},
        {"node", STATE_COUNTS, &s->node, 1}};
    return state_visit(state, "stability", values, sizeof values / sizeof *values, error);
}

/* The largest move from the state that was left to the final one, m, and its node; *largest: displacement. */
static double moved_since(const struct run *run, int64_t *node, double *largest)
{
    const double *near = run->stability.near;
    int dim = run->scene->dim;
    double most = 0.0;
    *node = 0;
    *largest = 0.0;
    for (int64_t n = 0; n < run->model->system.node_count; n++) {
        double move2 = 0.0, size2 = 0.0;
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            move2 += (run->u[i] - near[i]) * (run->u[i] - near[i]);
            size2 += run->u[i] * run->u[i];
        }
        *largest = fmax(*largest, sqrt(size2));
        if (move2 > most * most) {
            most = sqrt(move2);
            *node = n;
        }
    }
    return most;
}

void run_stability_describe(const struct run *run, char *text, size_t size)
{
    const struct run_stability *stability = &run->stability;
    const struct solid_system *system = &run->model->system;
    char place[96], when[48];
    int64_t node;
    double largest;
    text[0] = '\0';
    snprintf(when, sizeof when, stability->since < 1.0 ? "from %.4g of the load on" : "at the whole load",
             stability->since);
    if (stability->left) {
        double moved = moved_since(run, &node, &largest);
        if (moved > growth * stability->error * largest) {
            point_text(system->dim, system->X + node * system->dim, place);
            snprintf(
                text, size,
                "the body folds %s: it buckles or wrinkles, away from an equilibrium that is not stable, "
                "most of all, by %.2g m, at %s",
                when, moved, place);
            return;
        }
    }
    if (stability->negative) {
        point_text(system->dim, system->X + stability->node * system->dim, place);
        snprintf(text, size,
                 "the body folds %s: its equilibrium is not stable, and would buckle or wrinkle, most of all "
                 "at %s",
                 when, place);
    }
}
