#include "mtled/run.h"

#include "approx/field/field_compare.h"
#include "solid/dynamics/dynamics.h"

#include <string.h>

/* What lets the energy drift. Contact between facets of one body begins or ends with a jump where they turn
 * by the limit of what faces each other, whatever the time step. */
static const char drift_remedy[] =
    "lower time_step_margin, or apply the load more slowly; where facets of one body touch at about 120 "
    "degrees to each other, the contact energy jumps: round or refine the corner";

/* End the run with a verdict if it is not done, with the place of the failure and the remedy. */
static void judge(struct run *run, const struct dynamics_report *report)
{
    const struct scene *scene = run->scene;
    const struct solid_system *system = &run->model->system;
    double largest_move = field_largest(system->node_count, system->dim, run->u);
    bool inverted = report->outcome == DYNAMICS_INVERTED;
    const char *place = POINT_TEXT(scene->dim, inverted ? run->model->assembly.x + report->point * scene->dim
                                                        : system->X + report->node * scene->dim);
    switch (report->outcome) {
    case DYNAMICS_DONE:
        if (report->largest_drift > DYNAMICS_NOTED_DRIFT) {
            run_note(run, "the energy balance is off by %.2g of the largest energy: %s",
                     report->largest_drift, drift_remedy);
        }
        run_folds_judge(run);
        run_contacts_penetrate(run, largest_move, system_penetration_allowed(largest_move), true);
        run_contacts_touch(run);
        run_sliding_judge(run);
        return;
    case DYNAMICS_INVERTED:
        run_fail(run, STATUS_VERDICT,
                 "step %jd, t = %.6g s: integration point %jd at %s is inverted (J = %.3g): apply the "
                 "load more slowly, or a smaller one, lower time_step_margin (%g), or refine there",
                 report->steps, report->time, report->point, place, report->least_jacobian,
                 scene->solver.time_step_margin);
    case DYNAMICS_COLLAPSED:
        run_fail(run, STATUS_VERDICT,
                 "step %jd, t = %.6g s: the critical step has fallen below %g of the first one "
                 "(%.3g s), by node %jd at %s: apply a smaller load, or refine there",
                 report->steps, report->time, DYNAMICS_LEAST_STEP, report->first_step, report->node, place);
    case DYNAMICS_DRIFTED:
        run_fail(run, STATUS_VERDICT,
                 "step %jd, t = %.6g s: the energy balance is off by %.2g of the largest energy (most "
                 "%g), the fastest is node %jd at %s: %s",
                 report->steps, report->time, report->last_drift, DYNAMICS_MOST_DRIFT, report->node, place,
                 drift_remedy);
    case DYNAMICS_STOPPED:
        run_checkpoint_stop(run, report->steps);
    case DYNAMICS_TOO_MANY_STEPS:
    default:
        run_fail(run, STATUS_VERDICT,
                 "t = %.6g s of %.6g s after %jd steps of %.3g s: allow more (max_steps)", report->time,
                 scene->solver.end_time, report->steps, report->least_step);
    }
}

static void print_report(const struct run *run, const struct dynamics_report *report)
{
    const struct body *body = &run->model->system.body;
    fprintf(stderr, "points\t%jd\nmerged cells\t%jd\npairs\t%jd\nsteps\t%jd\nforce evaluations\t%jd\n",
            body->point_count, body->cells.merged_count, body->pair_count, report->steps,
            report->force_evaluations);
    fprintf(stderr, "critical step, s\t%.6g\nfirst step, s\t%.6g\nleast step, s\t%.6g\nstep changes\t%jd\n",
            report->critical_step, report->first_step, report->least_step, report->step_changes);
    fprintf(stderr, "largest energy error\t%.3g\nleast J\t%.4g\n", report->largest_drift,
            report->least_jacobian);
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

void run_dynamic(struct run *run)
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
        .restored = run_checkpoint_state(run)};
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
    double started = clock_seconds();
    enum status status = dynamics_run(&run->model->system, &options, run->u, velocity, run->model->row_force,
                                      output->energy ? &log : NULL, &report, &error);
    run->solve_seconds += clock_seconds() - started;
    run_clear_progress(&run->display);
    tool_check(run->tool, status, &error);
    if (output->energy) {
        put_energy(run, &log);
    }
    run->last_good = report.last_good;
    run->evaluations = report.force_evaluations;
    run_folds_check(run, run->u, report.time, true);
    judge(run, &report);
    energy_log_free(&log);
    if (run->verbose) {
        print_report(run, &report);
    }
}
