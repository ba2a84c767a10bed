/* Solving: the analysis of a scene, and the verdicts on its outcome. */
#include "mtled/run.h"

#include "approx/field/field_compare.h"
#include "solid/dynamics/dynamics.h"
#include "solid/equilibrium/newton.h"
#include "solid/equilibrium/relaxation.h"

#include <math.h>
#include <string.h>

static const char slides[] =
    ": friction may not hold the body, which slides then: use a smaller load or a dynamic "
    "scene";
static const char beyond_limit[] =
    "it may have passed a limit load, beyond which there is no equilibrium, or buckle: use a smaller load or "
    "a dynamic scene, or refine there; frames show up to which load it stands";

/* End the run if it has not converged: no incomplete result is given. */
static void judge_statics(struct run *run, const struct statics_report *report)
{
    const struct scene *scene = run->scene;
    char load[32] = "";
    if (report->outcome == STATICS_CONVERGED) {
        if (report->error > scene->solver.tolerance) {
            run_note(run, "estimated error %.2g, not %.2g: %s less", report->error, scene->solver.tolerance,
                     run->model->system.contact_count > 0
                         ? "contacts, whose points go from facet to facet, admit no"
                         : "round-off admits no");
        }
        if (report->lost) {
            run_note(run,
                     "what acts moves the body by no more than round-off, %.2g m: displacements and forces "
                     "are not known",
                     statics_round_off(&run->model->system));
        }
        run_stability_check(run, 1.0, true);
        run_contacts_penetrate(run, report->move, report->penetration_allowed, true);
        run_folds_judge(run);
        run_held_judge(run, report->error * report->move);
        return;
    }
    if (report->outcome == STATICS_STALLED) {
        run_contacts_penetrate(run, report->move, 0.0, false); /* as where nothing can give way */
    }
    if (report->load < 1.0) {
        bool in_time = scene->duration > 0.0;
        snprintf(load, sizeof load, in_time ? " (at t = %.3g s)" : " (at %.3g of the load)",
                 in_time ? report->load * scene->duration : report->load);
    }
    if (report->outcome != STATICS_STOPPED) {
        run_stability_check(run, report->load, false); /* as where the law itself has given way */
    }
    snprintf(run->at, sizeof run->at, "step %jd%s: ", report->steps, load);
    bool may_slide = system_held_by_friction(&run->model->system);
    const char *place = POINT_TEXT(scene->dim, run->model->system.X + report->worst_node * scene->dim);
    if (report->outcome == STATICS_STALLED) {
        const char *remedy =
            run->folds.seen ? "" /* it is named with the fold */
            : may_slide     ? slides
            : run->model->system.contact_count > 0
                ? ": a larger tolerance, a finer cloud at the contacts, sides for a rigid surface that ends "
                  "on the body, or supports against rigid motion may help"
                : ": it hardly resists some motion, as a slender body that has buckled may turn: a larger "
                  "tolerance, or supports against that motion may help";
        run_fail(run, STATUS_VERDICT,
                 "the estimated error stays at %.2g of the displacement, most of all at %s%s", report->error,
                 place, remedy);
    }
    if (report->outcome == STATICS_STOPPED) {
        run_checkpoint_stop(run, report->steps);
    }
    if (report->outcome == STATICS_INVERTED) {
        const double *x = run->model->assembly.x + report->inverted_point * scene->dim;
        run_fail(run, STATUS_VERDICT,
                 "integration point %jd at %s inverts (J = %.3g), however slowly the load "
                 "grows: %s",
                 report->inverted_point, POINT_TEXT(scene->dim, x), report->least_jacobian, beyond_limit);
    }
    if (report->outcome == STATICS_AWAY) {
        run_fail(run, STATUS_VERDICT, "the body moves on, by %.3g m so far, and does not come to rest: %s",
                 report->move, may_slide ? slides + 2 : beyond_limit);
    }
    run->at[0] = '\0';
    run_fail(run, STATUS_VERDICT,
             "not converged after %jd steps%s: estimated remaining error %.2g of the displacement, "
             "most of all at %s: allow more (max_steps), or hold the body against rigid motion",
             report->steps, load, report->error, place);
}

/* The error of steps of time that are chosen, and from which on it is noted; of the time: the longest step.
 */
static const double error_of_steps = 1e-3, error_noted = 1e-2, longest_step = 0.05;
/* Of the time between two corners of load curves: the first step. */
static const double first_of_segment = 0.1, same_time = 1e-9;

/* Whether the steps are chosen by their error. */
static bool chooses_steps(const struct run *run)
{
    return run->scene->duration > 0.0 && run->scene->solver.time_steps == 0;
}

static int64_t count_frames(const struct scene *scene)
{
    return scene->output.frames > 0 ? scene->output.frames : 1;
}

/* Steps: as many as asked for, or the next number that is a multiple of that of the frames. */
static int64_t count_steps(const struct scene *scene)
{
    int64_t frames = count_frames(scene);
    return (scene->solver.time_steps + frames - 1) / frames * frames;
}

/* The times of corners of load curves before and after, as shares of the whole: before <= time < after, but
 * for round-off; and the largest share of its largest factor that a curve has reached by then. */
struct loading {
    double before, after, reached;
};

static struct loading loading_at(const struct solid_system *system, double time)
{
    struct loading loading = {.after = 1.0};
    for (int64_t c = 0; c < system->curve_count; c++) {
        const struct load_curve *curve = &system->curves[c];
        double factor = fabs(curve_value(curve, time));
        for (int64_t i = 0; curve->kind == CURVE_TABLE && i < curve->count; i++) {
            double at = curve->time[i] / curve->end;
            if (at <= time + same_time) {
                loading.before = fmax(loading.before, at);
                factor = fmax(factor, fabs(curve->factor[i]));
            } else {
                loading.after = fmin(loading.after, at);
            }
        }
        loading.reached = fmax(loading.reached, factor / fmax(curve_largest(curve), factor));
    }
    return loading;
}

/* A hold function: when the next step ends, which begins. Steps end at frames and at corners of load curves,
 * behind which they are short again. */
static double begin_step(void *context, double time)
{
    const struct run *run = context;
    struct body *body = &run->model->system.body;
    double duration = run->scene->duration, frames = (double)count_frames(run->scene);
    if (!(time < 1.0)) {
        return 1.0;
    }
    struct loading loading = loading_at(&run->model->system, time);
    double least = fmin(body_first_step(body, error_of_steps) / duration,
                        first_of_segment * (loading.after - loading.before));
    double by = body_next_step(body, error_of_steps / loading.reached);
    double step = by * body->prony.step / duration;
    if (!(time > loading.before + same_time)) {
        body_turn(body);
        step = least;
    }
    step = fmin(fmax(step, least), longest_step);
    double frame = floor((time + same_time) * frames + 1.0) / frames;
    double end = loading.after < frame - same_time ? loading.after : frame, left = end - time;
    end = left <= step + same_time ? end : left < 2.0 * step ? time + 0.5 * left : time + step;
    body_step(body, (end - time) * duration);
    return end;
}

/* A frame_function: an equilibrium in time ends a step, and the next one begins. */
static void end_step(void *context, int64_t number, double time, const double *u)
{
    struct run *run = context;
    const struct scene *scene = run->scene;
    struct body *body = &run->model->system.body;
    double frames = (double)count_frames(scene), frame = round(time * frames);
    int64_t steps = count_steps(scene);
    bool ends_frame =
        chooses_steps(run) ? time == frame / frames : number % (steps / count_frames(scene)) == 0;
    body_accept(body);
    body_collect_history(body);
    if (scene->output.frames > 0 && ends_frame) {
        run_put_frame(run, (int64_t)frame, time, u);
    }
    if (time < 1.0) {
        body_fade(body);
    }
    if (number < steps) {
        body_step(body, scene->duration / (double)steps);
    }
}

/* Note an error of the steps of time that shows: of the stress, and beside what the iteration may leave. */
static void judge_steps(const struct run *run, const struct statics_report *report)
{
    const struct body *body = &run->model->system.body;
    double error = body_time_error(body), shear_modulus = 0.0;
    double left = run->scene->solver.tolerance * report->move / system_node_spacing(&run->model->system);
    for (int64_t m = 0; m < body->material_count; m++) {
        shear_modulus = fmax(shear_modulus, body->materials[m].shear_modulus);
    }
    if (error > error_noted && error * body->prony.time_error.stress > shear_modulus * left) {
        run_note(run,
                 "the steps of time make an error of up to about %.2g of the largest stress: more of them "
                 "(time_steps) make less",
                 error);
    }
}

/* What verbose reports of both analyses begin with. */
static void print_counts(const struct run *run, int64_t steps, int64_t loading_steps)
{
    const struct body *body = &run->model->system.body;
    fprintf(stderr, "points\t%jd\nmerged cells\t%jd\npairs\t%jd\nsteps\t%jd\n", body->point_count,
            body->cells.merged_count, body->pair_count, steps);
    if (loading_steps >= 0) {
        fprintf(stderr, "loading steps\t%jd\n", loading_steps);
    }
    fprintf(stderr, "force evaluations\t%jd\n", run->evaluations);
}

static void run_quasi_static(struct run *run)
{
    const struct scene_solver *solver = &run->scene->solver;
    struct body *body = &run->model->system.body;
    bool in_time = run->scene->duration > 0.0, chosen = chooses_steps(run);
    struct statics_options options = {.tolerance = solver->tolerance,
                                      .time_step_margin = solver->time_step_margin,
                                      .ramp_steps = solver->ramp_steps,
                                      .most_steps = solver->max_steps,
                                      .frames = chosen    ? 1
                                                : in_time ? count_steps(run->scene)
                                                          : run->scene->output.frames,
                                      .steps = in_time ? 0 : count_steps(run->scene),
                                      .in_time = in_time,
                                      .hold = chosen ? begin_step : NULL,
                                      .frame = in_time ? end_step : run_put_frame,
                                      .progress = run_progress,
                                      .context = run,
                                      .restored =
                                          run->checkpoint.is_restored ? &run->checkpoint.state : NULL};
    struct statics_report report;
    struct error error;
    run_check_rigid_modes(run);
    if (in_time) {
        tool_check(run->tool, body_estimate_time_error(body, &error), &error);
    }
    double started = omp_get_wtime();
    enum status status = (solver->method == SCENE_NEWTON ? newton_run : relaxation_run)(
        &run->model->system, &options, run->u, run->model->row_force, &report, &error);
    run->solve_seconds += omp_get_wtime() - started;
    run_clear_progress(&run->display);
    tool_check(run->tool, status, &error);
    run->last_good = report.load;
    run->evaluations = report.force_evaluations;
    run_folds_check(run, run->u, report.load, true);
    judge_statics(run, &report);
    judge_steps(run, &report);
    double *left = run_new_values(run, 1);
    *left = report.error * report.move + report.penetration;
    run_put(run, "iteration", 1, 1, "unit=m cols=error", left);
    if (run->verbose) {
        print_counts(run, report.steps, report.loading_steps);
        fprintf(stderr, "iteration error, m\t%.3g\ndiscretisation error, m\tsee fielderr\n", *left);
        if (in_time) {
            fprintf(stderr, "error of the steps of time\t%.2g\n", body_time_error(body));
        }
        fprintf(stderr, "estimated error\t%.3g\nleast J\t%.4g\n", report.error, report.least_jacobian);
    }
}

/* ---- dynamics ---- */

/* What lets the energy drift. Contact between facets of one body begins or ends with a jump where they turn
 * by the limit of what faces each other, whatever the time step. */
static const char drift_remedy[] =
    "lower time_step_margin, or apply the load more slowly; where facets of one body touch at about 120 "
    "degrees to each other, the contact energy jumps: round or refine the corner";

/* End the run with a verdict if it is not done, with the place of the failure and the remedy. */
static void judge_dynamic(struct run *run, const struct dynamics_report *report)
{
    const struct scene *scene = run->scene;
    const struct solid_system *system = &run->model->system;
    double largest_move = field_largest(system->node_count, system->dim, run->u);
    bool inverted = report->outcome == DYNAMICS_INVERTED;
    const char *place = POINT_TEXT(scene->dim, inverted ? run->model->assembly.x + report->point * scene->dim
                                                        : system->X + report->node * scene->dim);
    snprintf(run->at, sizeof run->at, "step %jd, t = %.6g s: ", report->steps, report->time);
    switch (report->outcome) {
    case DYNAMICS_DONE:
        run->at[0] = '\0';
        if (report->largest_drift > DYNAMICS_NOTED_DRIFT) {
            run_note(run, "the energy balance is off by %.2g of the largest energy: %s",
                     report->largest_drift, drift_remedy);
        }
        run_folds_judge(run);
        run_contacts_penetrate(run, largest_move, system_penetration_allowed(largest_move), true);
        run_held_judge(run, -1.0);
        return;
    case DYNAMICS_INVERTED:
        run_fail(run, STATUS_VERDICT,
                 "integration point %jd at %s is inverted (J = %.3g): apply the "
                 "load more slowly, or a smaller one, lower time_step_margin (%g), or refine there",
                 report->point, place, report->least_jacobian, scene->solver.time_step_margin);
    case DYNAMICS_COLLAPSED:
        run_fail(run, STATUS_VERDICT,
                 "the critical step has fallen below %g of the first one "
                 "(%.3g s), by node %jd at %s: apply a smaller load, or refine there",
                 DYNAMICS_LEAST_STEP, report->first_step, report->node, place);
    case DYNAMICS_DRIFTED:
        run_fail(run, STATUS_VERDICT,
                 "the energy balance is off by %.2g of the largest energy (most "
                 "%g), the fastest is node %jd at %s: %s",
                 report->last_drift, DYNAMICS_MOST_DRIFT, report->node, place, drift_remedy);
    case DYNAMICS_STOPPED:
        run_checkpoint_stop(run, report->steps);
    case DYNAMICS_TOO_MANY_STEPS:
    default:
        run->at[0] = '\0';
        run_fail(run, STATUS_VERDICT,
                 "t = %.6g s of %.6g s after %jd steps of %.3g s: allow more (max_steps)", report->time,
                 scene->solver.end_time, report->steps, report->least_step);
    }
}

/* Put the log as section `energy`. */
static void put_energy(const struct run *run, const struct energy_log *log)
{
    _Static_assert(sizeof(struct energy) == ENERGY_COLUMNS * sizeof(double), "a row of numbers");
    double *values = run_new_values(run, log->count * ENERGY_COLUMNS);
    memcpy(values, log->rows, (size_t)log->count * sizeof *log->rows);
    run_put(run, "energy", log->count, ENERGY_COLUMNS,
            run->scene->dim == 2 ? "unit=s,J/m,J/m,J/m,J/m,J/m,1 "
                                   "cols=time,kinetic,internal,contact,work,dissipated,error"
                                 : "unit=s,J,J,J,J,J,1 "
                                   "cols=time,kinetic,internal,contact,work,dissipated,error",
            values);
}

static void run_dynamic(struct run *run)
{
    const struct scene_solver *solver = &run->scene->solver;
    const struct scene_output *output = &run->scene->output;
    struct dynamics_options options = {
        .end_time = solver->end_time,
        .time_step_margin = solver->time_step_margin,
        .damping = solver->damping,
        .most_steps = solver->max_steps,
        .frame_interval = output->frames > 0 ? solver->end_time / (double)output->frames : output->interval,
        .frame = run_put_frame,
        .progress = run_progress,
        .context = run,
        .interrupted = run->checkpoint.interrupted,
        .restored = run->checkpoint.is_restored ? &run->checkpoint.state : NULL};
    struct dynamics_report report;
    struct energy_log log = {0};
    struct error error;
    SCRATCH double *velocity = NULL;
    if (run->scene->initial.table != NULL) {
        velocity = run_new_values(run, run->model->system.node_count * run->scene->dim);
        tool_check(run->tool, model_initial(run->model, run->u, velocity, &error), &error);
    }
    if (options.frame_interval > 0.0 && options.restored == NULL) {
        run_put_frame(run, 0, 0.0, run->u);
    }
    double started = omp_get_wtime();
    enum status status = dynamics_run(&run->model->system, &options, run->u, velocity, run->model->row_force,
                                      output->energy ? &log : NULL, &report, &error);
    run->solve_seconds += omp_get_wtime() - started;
    run_clear_progress(&run->display);
    tool_check(run->tool, status, &error);
    if (output->energy) {
        put_energy(run, &log);
    }
    run->last_good = report.last_good;
    run->evaluations = report.force_evaluations;
    run_folds_check(run, run->u, report.time, true);
    judge_dynamic(run, &report);
    energy_log_free(&log);
    if (run->verbose) {
        print_counts(run, report.steps, -1);
        fprintf(stderr,
                "critical step, s\t%.6g\nfirst step, s\t%.6g\nleast step, s\t%.6g\nstep changes\t%jd\n",
                report.critical_step, report.first_step, report.least_step, report.step_changes);
        fprintf(stderr, "largest energy error\t%.3g\nleast J\t%.4g\n", report.largest_drift,
                report.least_jacobian);
    }
}

void run_solve(struct run *run)
{
    if (run->scene->analysis == SCENE_DYNAMIC) {
        run_dynamic(run);
    } else {
        run_quasi_static(run);
    }
    run_checkpoint_end();
}
