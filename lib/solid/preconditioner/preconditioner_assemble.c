/* The stiffness along the coarse fields of a body of smoothed cells, assembled in one pass over the nodes.
 *
 * With W = P Z, whose rows W_n[dim][size] are what the fields move node n by, the matrix is sum_nm W_n^T K_nm
 * W_m. The blocks K_nm are those of the linear interpolant in the cells around n, with the tangent of the
 * neo-Hookean law for all materials (as in body_diagonal) and its nodal pressures without projection: a bulk
 * modulus k of these adds sum_n E_n^T E_n / V_n, V_n the nodal volume and E_n the sum of sqrt(k) times the
 * changes of volume of its parts along the fields. The coarse fields are smooth, and P changes them near
 * conditions only, where it is kept by nodes. Then each node takes some hundreds of additions for each
 * neighbour and field, where an evaluation for each column takes thousands. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/body/merged_cells.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"

#include <math.h>
#include <string.h>

enum { MOST_ENTRIES = 1 << 23 }; /* of the chunks' matrices */
enum { NODES_FOR_THREAD = 200 }; /* see chunks_of */

struct assembly {
    const struct preconditioner *p;
    const struct solid_system *system;
    int64_t most;  /* neighbours of a node at most */
    int32_t *near; /* node_count: which node that P moves it is, or -1 */
    float *bent;   /* dim * size for each of these: P Z - Z there; in large bodies there are many */
};

/* The functions of the cells that are one domain. */
struct domain {
    int count;
    int32_t node[4 * MERGED_MOST_CELLS];       /* in the body's order */
    double gradient[4 * MERGED_MOST_CELLS][3]; /* 1/m, */
    double along[4 * MERGED_MOST_CELLS][3];    /* F times that, */
    double normal[4 * MERGED_MOST_CELLS][3];   /* and cof F times that: by how much J changes */
    double weight;
};

/* A row of blocks, and its products with the fields. */
struct block_row {
    int64_t count;
    int32_t *node; /* most, in the body's order */
    double *block; /* for each (dim + 1) * dim: K_nm, and below it what E_n is made of */
    double *taken; /* (dim + 1) * size */
    double volume;
};

/* y += a x */
ALL_SETS static void add_floats(int64_t count, double a, const float *x, double *restrict y)
{
    for (int64_t i = 0; i < count; i++) {
        y[i] += a * (double)x[i];
    }
}

/* to[rows][size] += block[rows][dim] W_n */
static void take(const struct assembly *s, int64_t node, int rows, const double *block, double *to)
{
    const struct preconditioner *p = s->p;
    int dim = p->dim, field[COARSE_MOST_AT_NODE];
    double value[COARSE_MOST_AT_NODE];
    int count = coarse_space_at_node(&p->coarse, node, field, value);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < rows * dim; k++) {
            to[k / dim * p->size + field[i] * dim + k % dim] += block[k] * value[i];
        }
    }
    for (int k = 0; k < rows * dim && s->near[node] >= 0; k++) {
        add_floats(p->size, block[k], s->bent + (s->near[node] * dim + k % dim) * p->size,
                   to + k / dim * p->size);
    }
}

/* matrix += W_n^T force[dim][size] */
static void put(const struct assembly *s, int64_t node, const double *force, double *matrix)
{
    const struct preconditioner *p = s->p;
    int64_t dim = p->dim, size = p->size;
    int field[COARSE_MOST_AT_NODE];
    double value[COARSE_MOST_AT_NODE];
    int count = coarse_space_at_node(&p->coarse, node, field, value);
    for (int64_t i = 0; i < count * dim; i++) {
        dense_add_row(size, value[i / dim], force + i % dim * size,
                      matrix + (field[i / dim] * dim + i % dim) * size);
    }
    for (int64_t i = 0; i < dim * size && s->near[node] >= 0; i++) {
        dense_add_row(size, (double)s->bent[s->near[node] * dim * size + i], force + i / size * size,
                      matrix + i % size * size);
    }
}

void preconditioner_add_square(int64_t size, double stiffness, const double *row, double *matrix)
{
    for (int64_t k = 0; k < size; k++) {
        if (row[k] != 0.0) {
            dense_add_row(size, stiffness * row[k], row, matrix + k * size);
        }
    }
}

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
    return (struct tangent){.shear = shear,
                            .mixed = -2.0 / 3.0 * shear / J,
                            .square = 5.0 / 9.0 * shear * I1 / (J * J) +
                                      domain->weight * (material->bulk_modulus - rest),
                            .turned = (-shear * I1 / (3.0 * J) + domain->weight * pressure) / J,
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

/* The row of a node, in the body's order. */
static void make_row(const struct body *body, int32_t node, struct block_row *row)
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

static void add_node(const struct assembly *s, int32_t node, struct block_row *row, double *matrix)
{
    const struct body *body = &s->system->body;
    int dim = body->dim;
    make_row(body, node, row);
    memset(row->taken, 0, (size_t)((dim + 1) * s->p->size) * sizeof *row->taken);
    for (int64_t m = 0; m < row->count; m++) {
        take(s, body->node_order[row->node[m]], dim + 1, row->block + m * (dim + 1) * dim, row->taken);
    }
    put(s, body->node_order[node], row->taken, matrix);
    preconditioner_add_square(s->p->size, 1.0 / row->volume, row->taken + dim * s->p->size, matrix);
}

static void add_penalty(const struct assembly *s, int64_t r, double *taken, double *matrix)
{
    const struct constraint_rows *penalties = &s->system->penalties;
    struct average average = constraint_rows_average(penalties, r);
    int dim = s->p->dim;
    memset(taken, 0, (size_t)s->p->size * sizeof *taken);
    for (int64_t i = 0; i < average.length; i++) {
        double block[3];
        for (int a = 0; a < dim; a++) {
            block[a] = average.phi[i] * penalties->direction[r * dim + a];
        }
        take(s, average.idx[i], 1, block, taken);
    }
    preconditioner_add_square(s->p->size, s->system->penalty_stiffness[r], taken, matrix);
}

/* field = B G^T amount */
static void spread(const struct preconditioner *p, int64_t rows, const double *amount, double *field)
{
    memset(field, 0, (size_t)(p->node_count * p->dim) * sizeof *field);
    if (rows > 0) {
        constraint_spread(&p->constraint, amount, field);
    }
}

/* Where the conditions bend the fields, and by how much. */
static enum status find_bent(struct assembly *s, struct error *error)
{
    const struct preconditioner *p = s->p;
    int64_t nodes = p->node_count, dim = p->dim, size = p->size, count = 0;
    int64_t rows = s->system->rows.count;
    SCRATCH double *amount = NULL, *field = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&s->near, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&amount, rows, error));
    RETURN_IF_ERROR(NEW_ARRAY(&field, nodes * dim, error));
    for (int64_t r = 0; r < rows; r++) {
        amount[r] = 1.0 + fmod(0.6180339887 * (double)r, 1.0); /* any */
    }
    spread(p, rows, amount, field);
    for (int64_t n = 0; n < nodes; n++) {
        bool bent = vector_dot((int)dim, field + n * dim, field + n * dim) > 0.0;
        s->near[n] = bent ? (int32_t)count++ : -1;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&s->bent, count * dim * size, error));
    for (int64_t k = 0; k < size && count > 0; k++) {
        for (int64_t r = 0; r < rows; r++) {
            amount[r] = -p->held[k * rows + r];
        }
        spread(p, rows, amount, field);
        for (int64_t i = 0; i < nodes * dim; i++) {
            if (s->near[i / dim] >= 0) {
                s->bent[(s->near[i / dim] * dim + i % dim) * size + k] = (float)field[i];
            }
        }
    }
    return STATUS_OK;
}

static enum status make_rows(struct assembly *s, int64_t count, struct block_row *rows, struct error *error)
{
    const struct body *body = &s->system->body;
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    for (int64_t r = averages->row_count - body->node_count; r < averages->row_count; r++) {
        int64_t neighbours = 0;
        for (int64_t i = averages->use_ptr[r]; i < averages->use_ptr[r + 1]; i++) {
            int64_t q = field_averages_cell(averages, dim, averages->use[i]);
            neighbours += (smoothed_cells_group_end(body, q) - smoothed_cells_group(body, q)) * (dim + 1);
        }
        s->most = neighbours > s->most ? neighbours : s->most;
    }
    for (int64_t c = 0; c < count; c++) {
        RETURN_IF_ERROR(NEW_ARRAY(&rows[c].node, s->most, error));
        RETURN_IF_ERROR(NEW_ARRAY(&rows[c].block, s->most * (dim + 1) * dim, error));
        RETURN_IF_ERROR(NEW_ARRAY(&rows[c].taken, (dim + 1) * s->p->size, error));
    }
    return STATUS_OK;
}

/* Nodes and penalties by chunks, each into a matrix of its own; each process some chunks. */
static enum status sum_chunks(struct assembly *s, double *matrix, struct error *error)
{
    const struct solid_system *system = s->system;
    const struct ranks *ranks = system->body.share.ranks;
    int64_t cells = s->p->size * s->p->size;
    struct chunks nodes = chunks_of(s->p->node_count, NODES_FOR_THREAD), penalties;
    struct block_row rows[CHUNKS_MOST] = {{0}};
    SCRATCH int64_t *first = NULL;
    SCRATCH double *part = NULL;
    enum status status;
    int64_t most = MOST_ENTRIES / cells > 8 ? MOST_ENTRIES / cells : 8;
    nodes.count = nodes.count < most ? nodes.count : most;
    penalties = nodes;
    penalties.items = system->penalties.count;
    TRY(ranks_share(ranks, nodes.count, NULL, &first, error));
    TRY(NEW_ARRAY(&part, nodes.count * cells, error));
    TRY(make_rows(s, nodes.count, rows, error));
#pragma omp parallel for schedule(dynamic) num_threads(nodes.threads)
    for (int64_t c = first[ranks_rank(ranks)]; c < first[ranks_rank(ranks) + 1]; c++) {
        for (int64_t n = chunks_begin(&nodes, c); n < chunks_begin(&nodes, c + 1); n++) {
            add_node(s, (int32_t)n, &rows[c], part + c * cells);
        }
        for (int64_t r = chunks_begin(&penalties, c); r < chunks_begin(&penalties, c + 1); r++) {
            add_penalty(s, r, rows[c].taken, part + c * cells);
        }
    }
    ranks_gather(ranks, part, (size_t)cells * sizeof *part, first);
    memset(matrix, 0, (size_t)cells * sizeof *matrix);
    for (int64_t c = 0; c < nodes.count; c++) {
        dense_add_row(cells, 1.0, part + c * cells, matrix);
    }
done:
    for (int64_t c = 0; c < nodes.count; c++) {
        FREE_ALL(rows[c].node, rows[c].block, rows[c].taken);
    }
    return status;
}

enum status preconditioner_assemble(struct preconditioner *p, struct solid_system *system,
                                    struct error *error)
{
    struct assembly s = {.p = p, .system = system};
    body_share_collect(&system->body);
    enum status status = find_bent(&s, error);
    if (status == STATUS_OK) {
        status = sum_chunks(&s, p->body, error);
    }
    FREE_ALL(s.near, s.bent);
    return status;
}
