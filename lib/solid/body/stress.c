#include "solid/body/stress.h"

#include "solid/body/nodal_volume.h"
#include "base/vector.h"
#include "solid/material/ellipticity.h"
#include "solid/material/law.h"
#include "solid/material/tensor.h"

#include <math.h>
#include <string.h>

/* Volumetric pressure at a point, Pa; negative in compression. */
static double point_pressure(const struct body *body, int64_t q, double J)
{
    return body->averaged ? nodal_volume_pressure(body, q)
                          : material_pressure(&body->materials[body->material[q]], J);
}

void stress_matrix(int dim, const double *row, int64_t apart, double F[9])
{
    memset(F, 0, 9 * sizeof *F);
    F[8] = 1.0;
    for (int a = 0; a < dim; a++) {
        for (int b = 0; b < dim; b++) {
            F[3 * a + b] = row[(a * dim + b) * apart];
        }
    }
}

void stress_gradient(const struct body *body, int64_t q, double F[9])
{
    stress_matrix(body->dim, body->F + q, body->point_count, F);
}

/* The active stress T of a point, Pa. */
static double active_stress(const struct body *body, const struct material *material)
{
    return fabs(material->active) > 0.0 ? material->active * (*body->load_factors)[material->active_curve]
                                        : 0.0;
}

double stress_whole_active_energy(const struct body *body, int64_t point, const double F[9])
{
    const struct material *material = &body->materials[body->material[point]];
    double square = -1.0;
    if (!(fabs(material->active) > 0.0)) {
        return 0.0;
    }
    for (int i = 0; i < 3; i++) {
        double along = vector_dot(3, F + 3 * i, material->fibre);
        square += along * along;
    }
    return 0.5 * material->active * square;
}

double stress_active_energy(const struct body *body, int64_t point, const double F[9])
{
    const struct material *material = &body->materials[body->material[point]];
    return fabs(material->active) > 0.0
               ? stress_whole_active_energy(body, point, F) * (*body->load_factors)[material->active_curve]
               : 0.0;
}

/* Add T F a (x) a. */
static void activate(const struct body *body, int64_t q, const double F[9], double P[9])
{
    const struct material *material = &body->materials[body->material[q]];
    double T = active_stress(body, material);
    for (int i = 0; i < 3 && fabs(T) > 0.0; i++) {
        add_scaled(3, T * vector_dot(3, F + 3 * i, material->fibre), material->fibre, P + 3 * i);
    }
}

/* The energy (11b) of a cell of volume ratio J, W being W_iso(F), and its derivatives: by W_iso, by I1', and
 * by det F and J. */
struct coupling {
    double energy, of_isochoric, of_square, of_determinant, of_volume;
};

static struct coupling couple(const struct material *material, const double F[9], double J)
{
    double mu = material->shear_modulus, D = determinant(F), apart = J / D - 1.0;
    double I1 = 3.0 + 2.0 * neo_hookean_energy(1.0, F),
           part = 1.0 / sqrt(1.0 + COUPLING_CURVE * apart * apart);
    double c = COUPLING_OF_ENERGY * material_isochoric_energy(material, F) + mu * (1.0 - 3.0 / I1);
    double g = -apart * part, by_volume = -c * part * part * part / D;
    return (struct coupling){c * g, COUPLING_OF_ENERGY * g, 3.0 * mu / (I1 * I1) * g,
                             -by_volume * (apart + 1.0), by_volume};
}

/* The stress of the coupling along F, if P is that of W_iso. */
static void coupling_stress(const struct coupling *coupling, const double F[9], const double P[9],
                            double stress[9])
{
    double of_square[9], C[9];
    neo_hookean_stress(2.0, F, of_square);
    cofactor(F, C);
    for (int k = 0; k < 9; k++) {
        stress[k] = coupling->of_isochoric * P[k] + coupling->of_square * of_square[k] +
                    coupling->of_determinant * C[k];
    }
}

/* From the stress of W_iso and of c to what has relaxed; the coupling then has what has relaxed of c g'. */
static void relax(const struct body *body, int64_t q, const double F[9], double J, double P[9],
                  struct coupling *coupling)
{
    double D = determinant(F), by_ratio = coupling->of_volume * D, of_c[9];
    struct coupling c = *coupling;
    c.of_determinant = 0.0;
    coupling_stress(&c, F, P, of_c);
    for (int k = 0; k < 9; k++) {
        P[k] += of_c[k];
    }
    prony_stress(body, q, F, P, &by_ratio);
    *coupling = (struct coupling){.of_determinant = -by_ratio * J / (D * D), .of_volume = by_ratio / D};
}

/* Of W_iso and the coupling of a point, relaxed, and active stress: the derivatives by F, the coupling's
 * apart, and, as the value, that by J. */
static double inner_stress(const struct body *body, int64_t q, const double F[9], double J, double P[9],
                           double coupled[9])
{
    const struct material *material = &body->materials[body->material[q]];
    bool is_coupled = body->smoothed && material_is_isochoric(material);
    struct coupling coupling = {0};
    memset(coupled, 0, 9 * sizeof *coupled);
    material_isochoric_stress(material, F, P);
    if (is_coupled) {
        coupling = couple(material, F, J);
    }
    if (material->prony_terms > 0) {
        relax(body, q, F, J, P, &coupling);
    }
    if (is_coupled) {
        coupling_stress(&coupling, F, P, coupled);
    }
    activate(body, q, F, P);
    return coupling.of_volume;
}

/* P at a point: the isochoric part, and the volumetric part along the cofactor of F. */
static void point_stress(const struct body *body, int64_t q, const double F[9], double J, double P[9])
{
    double C[9], coupled[9];
    (void)inner_stress(body, q, F, J, P, coupled);
    cofactor(F, C);
    double pressure = point_pressure(body, q, J);
    for (int k = 0; k < 9; k++) {
        P[k] += pressure * C[k];
    }
}

/* Store the first dim rows and columns, times the weight, at place i of a block. */
static void put(const struct body *body, int64_t q, int64_t i, const double stress[9], block_rows P)
{
    int dim = body->dim;
    for (int k = 0; k < dim * dim; k++) {
        P[k][i] = body->weight[q] * stress[3 * (k / dim) + k % dim];
    }
}

void stress_points(const struct body *body, const struct block *block, block_rows P)
{
    for (int64_t i = 0; i < block->point_count; i++) {
        double F[9], stress[9];
        int64_t q = block->first_point + i;
        stress_gradient(body, q, F);
        point_stress(body, q, F, body->J[q], stress);
        put(body, q, i, stress, P);
    }
}

void stress_limit_stretch(const double F[9], double Z[9])
{
    double sum[9], cofactors[9];
    right_cauchy_green(F, sum);
    for (int k = 0; k < 3; k++) {
        sum[4 * k] += 3.0;
    }
    cofactor(sum, cofactors);
    for (int k = 0; k < 9; k++) {
        Z[k] = 4.0 * cofactors[k] / determinant(sum);
    }
}

/* What fibres add to the squares of a strain sym M. */
static double fibre_squares(const struct variance_fibres *fibres, const double M[9])
{
    double sum = 0.0, Ma[3];
    for (int f = 0; f < 2; f++) {
        const double *a = fibres->direction[f];
        for (int i = 0; i < 3; i++) {
            Ma[i] = 0.5 * (vector_dot(3, M + 3 * i, a) + M[i] * a[0] + M[i + 3] * a[1] + M[i + 6] * a[2]);
        }
        double along = vector_dot(3, a, Ma), dev = along - (M[0] + M[4] + M[8]) / 3.0;
        sum +=
            fibres->share[f] * dev * dev + 2.0 * fibres->turned[f] * (vector_dot(3, Ma, Ma) - along * along);
    }
    return sum;
}

double stress_variance_energy(const struct body *body, int64_t q, double *volumetric)
{
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim, edges = CELL_EDGES(dim);
    const int32_t *of_edge = averages->of_use + q * edges;
    const int32_t *of_vertex = averages->of_use + field_averages_vertices(averages, dim) + q * (dim + 1);
    double F[9], Z[9], grad_N[12], edge[6], vertex[4], variation[3][12], squares = 0.0, traces = 0.0;
    stress_gradient(body, q, F);
    smoothed_cells_linear_gradients(body, q, grad_N);
    for (int a = 0; a < dim; a++) {
        for (int e = 0; e < edges; e++) {
            edge[e] = averages->value[of_edge[e] + a];
        }
        for (int k = 0; k <= dim; k++) {
            vertex[k] = averages->value[of_vertex[k] + a];
        }
        smoothed_cells_variation(dim, grad_N, edge, vertex, variation[a]);
    }
    stress_limit_stretch(F, Z);
    for (int k = 0; k <= dim; k++) {
        double D[9] = {0.0}, half[9], M[9];
        for (int b = 0; b < dim * dim; b++) {
            for (int a = 0; a < dim; a++) {
                D[3 * (b / dim) + b % dim] += F[3 * a + b / dim] * variation[a][k * dim + b % dim];
            }
        }
        multiply(Z, D, half);
        multiply(half, Z, M);
        for (int a = 0; a < 9; a++) {
            squares += M[a] * (M[a] + M[3 * (a % 3) + a / 3]);
        }
        squares +=
            body->cells.fibres != NULL ? fibre_squares(&body->cells.fibres[body->material[q]], M) : 0.0;
        traces += (M[0] + M[4] + M[8]) * (M[0] + M[4] + M[8]);
    }
    *volumetric = 0.5 * body->cells.variance_bulk[q] * traces;
    return 0.5 * body->cells.variance_shear[q] * (squares - 2.0 / 3.0 * traces);
}

/* along = the derivative of cof H : D by H. */
static void cofactor_along(const double H[9], const double D[9], double along[9])
{
    double sum[9], both[9], of_H[9], of_D[9];
    for (int k = 0; k < 9; k++) {
        sum[k] = H[k] + D[k];
    }
    cofactor(sum, both);
    cofactor(H, of_H);
    cofactor(D, of_D);
    for (int k = 0; k < 9; k++) {
        along[k] = both[k] - of_H[k] - of_D[k];
    }
}

double stress_coupling_energy(const struct body *body, int64_t point, const double F[9], double J)
{
    const struct material *material = &body->materials[body->material[point]];
    return body->smoothed && material_is_isochoric(material) ? couple(material, F, J).energy : 0.0;
}

static void cell_stress(const struct body *body, int64_t q, double P[9], double T[9])
{
    double F[9], H[9], C[9], D[9], along[9], coupled[9];
    stress_gradient(body, q, F);
    stress_matrix(body->dim, body->cells.interpolant + q, body->point_count, H);
    vector_subtract(9, H, F, D);
    double pressure = point_pressure(body, q, body->J[q]);
    pressure += inner_stress(body, q, F, body->J[q], P, coupled);
    cofactor(H, C);
    cofactor_along(H, D, along);
    for (int k = 0; k < 9; k++) {
        P[k] += coupled[k] + pressure * C[k];
        T[k] = -pressure * along[k];
    }
}

void stress_cells(const struct body *body, const struct block *block, block_rows P, block_rows T)
{
    for (int64_t i = 0; i < block->point_count; i++) {
        double on_gradient[9], on_interpolant[9];
        cell_stress(body, block->first_point + i, on_gradient, on_interpolant);
        put(body, block->first_point + i, i, on_gradient, P);
        put(body, block->first_point + i, i, on_interpolant, T);
    }
}

/* P of the Cauchy stress of a cell: a small motion of gradient G changes the energy by P : G F + T : G H, so
 * that this is (P F^T + T H^T) / det F, which is symmetric, as a rotation G changes nothing. */
static void cauchy_part(const struct body *body, int64_t q, const double F[9], const double T[9], double P[9])
{
    double H[9], C[9], D = determinant(F);
    stress_matrix(body->dim, body->cells.interpolant + q, body->point_count, H);
    cofactor(F, C);
    for (int i = 0; i < 9; i++) {
        for (int k = 0; k < 3; k++) {
            P[i] += vector_dot(3, T + i / 3 * 3, H + 3 * k) * C[3 * k + i % 3] / D;
        }
    }
}

void body_stress(struct body *body, double *stress)
{
    body_share_collect(body);
    prony_prepare(body, true);
    for (int64_t q = 0; q < body->point_count; q++) {
        double *P = stress + body->order.points[q] * 9, F[9], T[9];
        stress_gradient(body, q, F);
        if (body->smoothed) {
            cell_stress(body, q, P, T);
            cauchy_part(body, q, F, T, P);
        } else {
            point_stress(body, q, F, body->J[q], P);
        }
    }
}

void body_gradient(struct body *body, double *gradient)
{
    body_share_collect(body);
    for (int64_t q = 0; q < body->point_count; q++) {
        stress_gradient(body, q, gradient + body->order.points[q] * 9);
    }
}

void body_volume_ratio(struct body *body, double *ratio)
{
    body_share_collect(body);
    for (int64_t q = 0; q < body->point_count; q++) {
        ratio[body->order.points[q]] = body->J[q];
    }
}

struct inelliptic body_inelliptic(struct body *body)
{
    struct inelliptic found = {0.0, -1};
    body_share_collect(body);
    for (int64_t q = 0; q < body->point_count; q++) {
        const struct material *material = &body->materials[body->material[q]];
        double F[9];
        stress_gradient(body, q, F);
        if (!material_is_elliptic(material, active_stress(body, material), body->dim, F)) {
            found.share += body->weight[q];
            found.point = found.point < 0 ? body->order.points[q] : found.point;
        }
    }
    found.share /= body_volume(body);
    return found;
}
