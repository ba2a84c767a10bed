#include "base/box.h"

#include "base/status.h"
#include "base/vector.h"

struct box box_of(int dim, int64_t count, const double *x)
{
    struct box box = {
        .dim = dim, .low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}};
    box_add(&box, count, x);
    return box;
}

struct box box_of_nodes(int dim, const double *x, const int32_t *node, int64_t count)
{
    struct box box = box_of(dim, 0, x);
    for (int64_t i = 0; i < count; i++) {
        box_add(&box, 1, x + (int64_t)node[i] * dim);
    }
    return box;
}

void box_add(struct box *box, int64_t count, const double *x)
{
    for (int64_t i = 0; i < count; i++) {
        for (int a = 0; a < box->dim; a++) {
            box->low[a] = fmin(box->low[a], x[i * box->dim + a]);
            box->high[a] = fmax(box->high[a], x[i * box->dim + a]);
        }
    }
}

bool box_meets(const struct box *one, const struct box *other)
{
    bool meet = true;
    for (int a = 0; a < one->dim; a++) {
        meet = meet && one->low[a] <= other->high[a] && other->low[a] <= one->high[a];
    }
    return meet;
}

double box_side(const struct box *box)
{
    double side = 0.0;
    for (int a = 0; a < box->dim; a++) {
        side = fmax(side, box->high[a] - box->low[a]);
    }
    return side;
}

double box_diagonal(const struct box *box)
{
    return vector_distance(box->dim, box->high, box->low);
}

const char *box_text(const struct box *box, char text[128])
{
    text[0] = '\0';
    for (int k = 0; k < 2 * box->dim; k++) {
        text_append(text, 128, "%s%.4g ", k == box->dim ? "to " : "",
                    k < box->dim ? box->low[k] : box->high[k - box->dim]);
    }
    text_append(text, 128, "m");
    return text;
}
