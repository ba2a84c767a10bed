/* Whether a run keeps to one path of equilibria. */
#include "solid/equilibrium/newton_private.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* A jump is longer than this, by the increment's motion, and by the spacing of the nodes. */
static const double by_increment = 2.0, by_spacing = 0.5;
/* An increment of this span is short. */
static const double short_span = 1.0 / 64.0;

/* Whether the path is followed until the body leaves it. */
static bool follows(const struct newton *n)
{
    return n->system->contact_count == 0 && n->system->rows.start == NULL && !n->system->stability.left;
}

void newton_begin_path(struct newton *n, double from)
{
    double length = newton_longest(n, n->load.move, NULL);
    memcpy(n->path.u, n->u, (size_t)n->size * sizeof *n->u);
    n->path.from = from;
    n->path.reach = follows(n) ? fmax(by_increment * length, by_spacing * n->scale.spacing) : INFINITY;
    n->path.returned = false;
}

void newton_leave_path(struct newton *n, int64_t node)
{
    if (follows(n)) {
        struct stability *stability = &n->system->stability;
        stability->left = true;
        stability->left_load = statics_load_share(n->system, n->load.now);
        stability->left_node = node;
    }
    n->path.reach = n->path.most = INFINITY;
}

/* Go back to the state before the increment. */
static void go_back(struct newton *n)
{
    add_scaled((int)n->size, -1.0, n->load.move, n->path.u);
    newton_set_load(n, n->path.from, n->path.from);
    newton_return(n, n->path.u);
    n->path.returned = true;
    n->load.next = n->path.most = NEWTON_SHORTER * n->load.last;
    n->load.waits = true;
    n->progress.error = INFINITY;
    n->progress.step = n->report->steps;
    n->verdict.judged = false;
    newton_estimate(n);
}

void newton_keep_to_path(struct newton *n)
{
    int64_t node;
    if (isinf(n->path.reach)) {
        return;
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->cg.scaled[i] = n->u[i] - n->path.u[i];
    }
    if (!(newton_longest(n, n->cg.scaled, &node) > n->path.reach)) {
        return;
    }
    if (n->load.last > short_span && !n->path.returned && !n->options->in_time) {
        go_back(n);
    } else {
        newton_leave_path(n, node);
    }
}
