#include "mtled/run.h"

#include "solid/equilibrium/newton.h"
#include "solid/equilibrium/relaxation.h"

static const char slides[] =
    ": friction may not hold the body, which slides then: use a smaller load or a dynamic "
    "scene";
static const char beyond_limit[] =
    "it may have passed a limit load, beyond which there is no equilibrium, or buckle: use a smaller load or "
    "a dynamic scene, or refine there; frames show up to which load it stands";

/* End the run if it has not converged: no incomplete result is given. */
static void judge(struct run *run, const struct statics_report *report)
{
    const struct scene *scene = run->scene;
    char place[96] = "", load[48] = "";
    if (report->load < 1.0) {
        snprintf(load, sizeof load, " (at %.3g of the load)", report->load);
    }
    if (report->outcome == STATICS_CONVERGED) {
        if (report->error > scene->solver.tolerance) {
            tool_note(run->tool, "%s: estimated error %.2g, not %.2g: %s less", scene->path, report->error,
                      scene->solver.tolerance,
                      run->model->system.contact_count > 0
                          ? "contacts, whose points go from facet to facet, admit no"
                          : "round-off admits no");
        }
        run_stability_elliptic(run, 1.0, true);
        run_contacts_penetrate(run, report->move, report->penetration_allowed, true);
        run_folds_judge(run);
        run_contacts_touch(run);
        run_sliding_judge(run);
        return;
    }
    point_text(scene->dim, run->model->system.X + report->worst_node * scene->dim, place);
    if (report->outcome == STATICS_STALLED) {
        run_contacts_penetrate(run, report->move, 0.0, false); /* as where nothing can give way */
        const char *remedy =
            run->folds.seen                            ? "" /* it is named with the fold */
            : system_has_friction(&run->model->system) ? slides
            : run->model->system.contact_count > 0
                ? ": a larger tolerance, a finer cloud at the contacts, or supports against rigid motion may "
                  "help"
                : ": it hardly resists some motion, as a slender body that has buckled may turn: a larger "
                  "tolerance, or supports against that motion may help";
        run_fail(
            run, STATUS_VERDICT,
            "%s: step %lld%s: the estimated error stays at %.2g of the displacement, most of all at %s%s",
            scene->path, (long long)report->steps, load, report->error, place, remedy);
    }
    if (report->outcome == STATICS_STOPPED) {
        run_checkpoint_stop(run, report->steps);
    }
    if (report->outcome == STATICS_INVERTED) {
        const double *x = run->model->assembly.x + report->inverted_point * scene->dim;
        point_text(scene->dim, x, place);
        run_fail(run, STATUS_VERDICT,
                 "%s: step %lld%s: integration point %lld at %s inverts (J = %.3g), however slowly the load "
                 "grows: %s",
                 scene->path, (long long)report->steps, load, (long long)report->inverted_point, place,
                 report->least_jacobian, beyond_limit);
    }
    if (report->outcome == STATICS_AWAY) {
        run_fail(run, STATUS_VERDICT,
                 "%s: step %lld%s: the body moves on, by %.3g m so far, and does not come to rest: %s",
                 scene->path, (long long)report->steps, load, report->move,
                 system_has_friction(&run->model->system) ? slides + 2 : beyond_limit);
    }
    run_fail(run, STATUS_VERDICT,
             "%s: not converged after %lld steps%s: estimated remaining error %.2g of the displacement, "
             "most of all at %s: allow more (max_steps), or hold the body against rigid motion",
             scene->path, (long long)report->steps, load, report->error, place);
}

/* The estimated error of the iteration, m: of the relaxation, and of the remaining penetration of
 * contacts. */
static double error_left(const struct statics_report *report)
{
    return report->error * report->move + report->penetration;
}

static void put_error(const struct run *run)
{
    double *error = run_new_values(run, 1);
    *error = run->error;
    run_put(run, "iteration", 1, 1, "unit=m cols=error", error);
}

/* Steps: as many as asked for, or the next number that is a multiple of that of the frames. */
static int64_t count_steps(const struct scene *scene)
{
    int64_t frames = scene->output.frames > 0 ? scene->output.frames : 1;
    return (scene->solver.time_steps + frames - 1) / frames * frames;
}

/* A frame_function: an equilibrium in time ends a step, and the next one begins. */
static void end_step(void *context, int64_t number, double time, const double *u)
{
    struct run *run = context;
    struct body *body = &run->model->system.body;
    int64_t steps = count_steps(run->scene), frames = run->scene->output.frames;
    body_accept(body);
    body_collect_history(body);
    if (frames > 0 && number % (steps / frames) == 0) {
        run_put_equilibrium(run, number / (steps / frames), time, u);
    }
    if (number < steps) {
        body_step(body, run->scene->duration / (double)steps);
    }
}

void run_quasi_static(struct run *run)
{
    const struct scene_solver *solver = &run->scene->solver;
    const struct body *body = &run->model->system.body;
    bool in_time = run->scene->duration > 0.0, in_steps = solver->time_steps > 0;
    struct statics_options options = {.tolerance = solver->tolerance,
                                      .time_step_margin = solver->time_step_margin,
                                      .ramp_steps = solver->ramp_steps,
                                      .most_steps = solver->max_steps,
                                      .frames =
                                          in_steps ? count_steps(run->scene) : run->scene->output.frames,
                                      .in_time = in_time,
                                      .frame = in_steps ? end_step : run_put_equilibrium,
                                      .progress = run_progress,
                                      .context = run,
                                      .restored = run_checkpoint_state(run)};
    struct statics_report report;
    struct error error;
    run_check_rigid_modes(run);
    double started = clock_seconds();
    enum status status = (solver->method == SCENE_NEWTON ? newton_run : relaxation_run)(
        &run->model->system, &options, run->u, run->model->row_force, &report, &error);
    run->solve_seconds += clock_seconds() - started;
    run_clear_progress(&run->display);
    tool_check(run->tool, status, &error);
    run->last_good = report.load;
    run->error = error_left(&report);
    run->evaluations = report.force_evaluations;
    run_folds_check(run, run->u, report.load, true);
    run_stability_check(run, report.load);
    judge(run, &report);
    put_error(run);
    if (run->verbose) {
        fprintf(stderr,
                "points\t%lld\nmerged cells\t%lld\npairs\t%lld\nsteps\t%lld\nloading steps\t%lld\nforce "
                "evaluations\t%lld\n",
                (long long)body->point_count, (long long)body->cells.merged_count,
                (long long)body->pair_count, (long long)report.steps, (long long)report.loading_steps,
                (long long)report.force_evaluations);
        fprintf(stderr, "iteration error, m\t%.3g\ndiscretisation error, m\tsee fielderr\n", run->error);
        fprintf(stderr, "estimated error\t%.3g\nfrequency ratio\t%.5g\nleast J\t%.4g\n", report.error,
                report.largest_frequency / report.lowest_frequency, report.least_jacobian);
        run_report_springs(run);
    }
}
