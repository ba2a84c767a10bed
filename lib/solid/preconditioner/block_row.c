/* The stiffness of a body of smoothed cells by rows of blocks, one for each node. */
#include "solid/preconditioner/block_row.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"
#include "solid/body/merged_cells.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"
#include "solid/material/tensor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    double content, share;                   /* of each nodal volume, and that times the root of k */
    double along[4 * MERGED_MOST_CELLS][3];  /* f of each function, */
    double normal[4 * MERGED_MOST_CELLS][3]; /* and c: by how much J changes */
};

static void find_tangent(const struct body *body, int64_t q, const struct domain *domain,
                         struct tangent *tangent)
{
    static const double at_rest[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const struct material *material = &body->materials[body->material[q]];
    double F[9], C[9], mu = stiffening_at(body, q) * material->shear_modulus, pressure = 0.0;
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
        transform(F, domain->gradient[k], tangent->along[k]);
        transform(C, domain->gradient[k], tangent->normal[k]);
    }
    double I1 = vector_dot(9, F, F), shear = domain->weight * mu / cbrt(J * J);
    tangent->shear = shear;
    tangent->mixed = -2.0 / 3.0 * shear / J;
    tangent->square = 5.0 / 9.0 * shear * I1 / (J * J) + domain->weight * (material->bulk_modulus - rest);
    tangent->turned = (-shear * I1 / (3.0 * J) + domain->weight * pressure) / J;
    tangent->content = domain->weight / domain->count;
    tangent->share =
        tangent->content * sqrt(fmin(rest, body->volumes.pressures.most * material->shear_modulus));
}

/* Add the domain that cell q is in to the row of its function n. */
static void add_domain(const struct body *body, int64_t q, int n, const struct domain *domain,
                       struct block_row *row)
{
    int dim = body->dim;
    struct tangent t;
    find_tangent(body, q, domain, &t);
    const double *g = domain->gradient[n], *f = t.along[n], *c = t.normal[n];
    row->volume += t.content;
    for (int m = 0; m < domain->count; m++) {
        double *block = block_of(row, dim, domain->node[m]);
        const double *fm = t.along[m], *cm = t.normal[m];
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

void block_row_make(const struct body *body, int32_t node, struct block_row *row)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t r = body_node_row(body, node);
    struct domain domain;
    row->count = 0;
    row->volume = 0.0;
    for (int64_t i = averages->use_ptr[r]; i < averages->use_ptr[r + 1]; i++) {
        int64_t q = field_averages_cell(averages, body->dim, averages->use[i]);
        int n = merged_cells_domain(body, q, node, &domain);
        if (n >= 0) {
            add_domain(body, q, n, &domain, row);
        }
    }
}

int64_t block_row_most(const struct body *body)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t most = 0;
    for (int64_t r = body_node_row(body, 0); r < averages->row_count; r++) {
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
