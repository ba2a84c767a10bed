/* What Newton's method and the relaxation share. */
#include "solid/equilibrium/statics.h"

#include "base/box.h"
#include "base/round_off.h"

#include <float.h>
#include <math.h>
#include <string.h>

static bool gives_frames(const struct statics_options *options)
{
    return options->frame != NULL && options->frames > 0;
}

static int64_t next_frame(const struct statics_options *options, int64_t frames)
{
    return frames + (options->in_time ? 0 : 1);
}

double statics_load_to_hold(const struct statics_options *options, int64_t frames)
{
    return gives_frames(options) ? fmin(1.0, (double)next_frame(options, frames) / (double)options->frames)
                                 : 1.0;
}

double statics_load_share(const struct solid_system *system, double load)
{
    return system->rows.start != NULL ? 1.0 : fmax(0.0, load);
}

void statics_change_load(struct solid_system *system, double from, double load, double *change)
{
    system_load_factors(system, from);
    memcpy(change, system->factor, (size_t)system->curve_count * sizeof *change);
    system_load_factors(system, load);
    for (int64_t i = 0; i < system->curve_count; i++) {
        change[i] = system->factor[i] - change[i];
    }
}

void statics_give_frame(const struct statics_options *options, double share, const double *u, int64_t *frames)
{
    if (gives_frames(options)) {
        options->frame(options->context, next_frame(options, *frames), share, u);
        (*frames)++;
    }
}

bool statics_tell(const struct statics_options *options, const struct statics_report *report, double share,
                  const double *u, state_function *visit, void *run)
{
    struct progress progress = {.step = report->steps,
                                .time = share,
                                .error = report->error,
                                .remaining = -1.0,
                                .u = u,
                                .state = visit,
                                .run = run};
    return options->progress == NULL || options->progress(options->context, &progress);
}

/* Some units in the last place of the body's size; with contacts, which are found by places and may be all
 * that holds the body, more, of the largest coordinate. */
double statics_round_off(const struct solid_system *system)
{
    struct box box = box_of(system->dim, system->node_count, system->X);
    double reach = box_diagonal(&box);
    for (int k = 0; k < box.dim && system->contact_count > 0; k++) {
        reach = fmax(reach, fmax(fabs(box.low[k]), fabs(box.high[k])));
    }
    return (system->contact_count > 0 ? ROUND_OFF : 32.0 * DBL_EPSILON) * reach;
}

bool statics_is_away(const struct solid_system *system, const struct statics_report *report, double body_size)
{
    double own_way =
        report->move - STATICS_MOST_SIZES * body_size; /* beyond what is prescribed, if that is far */
    return own_way > 0.0 && own_way > system_longest_way(system);
}
