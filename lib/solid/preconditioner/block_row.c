/* The stiffness of a body of smoothed cells by rows of blocks, one for each node. */
#include "solid/preconditioner/block_row.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"
#include "solid/body/merged_cells.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The functions of the cells that are one domain. */
struct domain {
    int count;
    int32_t node[4 * MERGED_MOST_CELLS];       /* in the body's order */
    double gradient[4 * MERGED_MOST_CELLS][3]; /* 1/m, */
    double along[4 * MERGED_MOST_CELLS][3];    /* F times that, */
    double normal[4 * MERGED_MOST_CELLS][3];   /* and cof F times that: by how much J changes */
    double weight;
};

static void list_domain(const struct body *body, int64_t first, int64_t end, struct domain *domain)
{
    int dim = body->dim;
    double gradient[12];
    domain->count = 0;
    domain->weight = 0.0;
    for (int64_t q = first; q < end; q++) {
        domain->weight += body->weight[q];
    }
    for (int64_t q = first; q < end; q++) {
        double share = body->weight[q] / domain->weight;
        smoothed_cells_linear_gradients(body, q, gradient);
        for (int k = 0; k <= dim; k++) {
            int32_t node = smoothed_cells_node(body, q, k);
            int at = 0;
            while (at < domain->count && domain->node[at] != node) {
                at++;
            }
            if (at == domain->count) {
                domain->node[domain->count++] = node;
                memset(domain->gradient[at], 0, sizeof domain->gradient[at]);
            }
            add_scaled(dim, share, gradient + k * dim, domain->gradient[at]);
        }
    }
}

/* y = A x */
static void transform(const double A[9], const double x[3], double y[3])
{
    for (int i = 0; i < 3; i++) {
        y[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
    }
}

static double *block_of(struct block_row *row, int dim, int32_t node)
{
    int64_t at = 0;
    while (at < row->count && row->node[at] != node) {
        at++;
    }
    double *block = row->block + at * (dim + 1) * dim;
    if (at == row->count) {
        row->node[row->count++] = node;
        memset(block, 0, (size_t)((dim + 1) * dim) * sizeof *block);
    }
    return block;
}

/* Of a domain: with the gradients g, f = F g and c = cof F g of two of its functions, the block between these
 * is shear g . g' I + mixed (c f' + f c') + square c c' + turned (c c' - c' c). */
struct tangent {
    double shear, mixed, square, turned;
    double content, share; /* of each nodal volume, and that times the root of k */
};

/* The tangent of the domain that cell q is in, and F g and cof F g of its functions. */
static struct tangent find_tangent(const struct body *body, int64_t q, struct domain *domain)
{
    static const double at_rest[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const struct material *material = &body->materials[body->material[q]];
    double F[9], C[9], mu = material->shear_modulus, pressure = 0.0;
    double rest = body->averaged ? nodal_pressure_modulus(material) : 0.0;
    stress_matrix(body->dim, body->cells.interpolant + q, body->point_count, F);
    double J = determinant(F);
    if (J > 0.0 && isfinite(J)) {
        pressure = body->averaged ? nodal_volume_pressure(body, q) : material_pressure(material, body->J[q]);
    } else {
        memcpy(F, at_rest, sizeof F);
        J = 1.0;
    }
    cofactor(F, C);
    for (int k = 0; k < domain->count; k++) {
        transform(F, domain->gradient[k], domain->along[k]);
        transform(C, domain->gradient[k], domain->normal[k]);
    }
    double I1 = vector_dot(9, F, F), shear = domain->weight * mu / cbrt(J * J);
    double content = domain->weight / domain->count;
    double turned = (-shear * I1 / (3.0 * J) + domain->weight * pressure) / J;
    return (struct tangent){.shear = shear,
                            .mixed = -2.0 / 3.0 * shear / J,
                            .square = 5.0 / 9.0 * shear * I1 / (J * J) +
                                      domain->weight * (material->bulk_modulus - rest),
                            .turned = turned,
                            .content = content,
                            .share = content * sqrt(fmin(rest, body->volumes.pressures.most * mu))};
}

/* Add the domain that cell q is in to the row of its function n. */
static void add_domain(const struct body *body, int64_t q, int n, struct domain *domain,
                       struct block_row *row)
{
    int dim = body->dim;
    struct tangent t = find_tangent(body, q, domain);
    const double *g = domain->gradient[n], *f = domain->along[n], *c = domain->normal[n];
    row->volume += t.content;
    for (int m = 0; m < domain->count; m++) {
        double *block = block_of(row, dim, domain->node[m]);
        const double *fm = domain->along[m], *cm = domain->normal[m];
        double common = t.shear * vector_dot(3, g, domain->gradient[m]);
        for (int a = 0; a < dim; a++) {
            block[a * dim + a] += common;
            for (int b = 0; b < dim; b++) {
                block[a * dim + b] += t.mixed * (c[a] * fm[b] + f[a] * cm[b]) + t.square * c[a] * cm[b] +
                                      t.turned * (c[a] * cm[b] - cm[a] * c[b]);
            }
            block[dim * dim + a] += t.share * cm[a];
        }
    }
}

static bool cell_has(const struct body *body, int64_t q, int32_t node)
{
    bool has = false;
    for (int k = 0; k <= body->dim; k++) {
        has = has || smoothed_cells_node(body, q, k) == node;
    }
    return has;
}

void block_row_make(const struct body *body, int32_t node, struct block_row *row)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t r = averages->row_count - body->node_count + node;
    struct domain domain = {0};
    row->count = 0;
    row->volume = 0.0;
    for (int64_t i = averages->use_ptr[r]; i < averages->use_ptr[r + 1]; i++) {
        int64_t q = field_averages_cell(averages, body->dim, averages->use[i]);
        int64_t first = smoothed_cells_group(body, q), end = smoothed_cells_group_end(body, q);
        bool seen = false;
        for (int64_t other = first; other < q; other++) {
            seen = seen || cell_has(body, other, node);
        }
        if (seen) {
            continue;
        }
        list_domain(body, first, end, &domain);
        int n = 0;
        while (domain.node[n] != node) {
            n++;
        }
        add_domain(body, q, n, &domain, row);
    }
}

int64_t block_row_most(const struct body *body)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t most = 0;
    for (int64_t r = averages->row_count - body->node_count; r < averages->row_count; r++) {
        int64_t neighbours = 0;
        for (int64_t i = averages->use_ptr[r]; i < averages->use_ptr[r + 1]; i++) {
            int64_t q = field_averages_cell(averages, body->dim, averages->use[i]);
            neighbours +=
                (smoothed_cells_group_end(body, q) - smoothed_cells_group(body, q)) * (body->dim + 1);
        }
        most = neighbours > most ? neighbours : most;
    }
    return most;
}

enum status block_row_begin(const struct body *body, int64_t most, struct block_row *row, struct error *error)
{
    *row = (struct block_row){0};
    RETURN_IF_ERROR(NEW_ARRAY(&row->node, most, error));
    return NEW_ARRAY(&row->block, most * (body->dim + 1) * body->dim, error);
}

void block_row_free(struct block_row *row)
{
    FREE_ALL(row->node, row->block);
    *row = (struct block_row){0};
}
