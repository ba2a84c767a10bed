#include "mtled/run.h"

/* A result is refused if the law is not strongly elliptic in more than this share of the body. It is a few
 * percent if it is so at singular corners only, and half if the body has become irregular. */
static const double most_inelliptic = 0.1;

void run_stability_check(struct run *run, double load)
{
    const struct stability *found = &run->model->system.stability;
    if (found->least < 0.0 && !run->stability.seen) {
        run->stability = (struct run_stability){true, load, found->node};
    }
}

void run_stability_elliptic(struct run *run, double load, bool final)
{
    static const char text[] =
        "%s: %s the material law is not strongly elliptic in %.2g %% of the body, as at "
        "%s: what it does there depends on the mesh: use another model, as "
        "neo-hookean, or a smaller load";
    struct inelliptic found = body_inelliptic(&run->model->system.body);
    char when[48] = "at the whole load,";
    if (found.point < 0) {
        return;
    }
    const char *place = POINT_TEXT(run->scene->dim, run->model->assembly.x + found.point * run->scene->dim);
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

/* Words for a share of the load, and for the place of a node. */
static void describe(const struct run *run, double load, int64_t node, char when[48], char place[96])
{
    const struct solid_system *system = &run->model->system;
    point_text(system->dim, system->X + node * system->dim, place);
    snprintf(when, 48, "at the whole load");
    if (load < 1.0) {
        snprintf(when, 48, "at %.4g of the load", load);
    }
}

void run_stability_left(const struct run *run)
{
    const struct stability *found = &run->model->system.stability;
    char when[48], place[96];
    if (found->left && !run->folds.seen && !run->stability.seen) {
        describe(run, found->left_load, found->left_node, when, place);
        tool_note(
            run->tool,
            "%s: %s the body leaves a state near equilibrium, most of all at %s: it buckles, wrinkles or "
            "snaps through, and the result may be one of several",
            run->scene->path, when, place);
    }
}

void run_stability_describe(const struct run *run, char *text, size_t size)
{
    const struct run_stability *stability = &run->stability;
    char when[48], place[96];
    text[0] = '\0';
    if (stability->seen) {
        describe(run, stability->since, stability->node, when, place);
        snprintf(text, size,
                 "the body folds %s: its equilibrium is not stable, and would buckle or wrinkle, most of all "
                 "at %s",
                 when, place);
    }
}
