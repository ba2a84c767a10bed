/* Rigid surfaces: closest points against brute force, signs against winding numbers, open rims, faults. */
#include "unit.h"

#include "base/vector.h"
#include "solid/rigid/rigid.h"

enum { MAX_FACETS = 4096 };

/* A surface as corners, and its build. */
struct shape {
    int dim;
    int64_t count;
    double corners[MAX_FACETS * 9];
};

static void add_facet(struct shape *shape, const double *a, const double *b, const double *c)
{
    const double *corner[3] = {a, b, c};
    assert_true(shape->count < MAX_FACETS);
    for (int k = 0; k < shape->dim; k++) {
        memcpy(shape->corners + (shape->count * shape->dim + k) * shape->dim, corner[k],
               (size_t)shape->dim * sizeof(double));
    }
    shape->count++;
}

static struct rigid_surface built(const struct shape *shape, bool flip)
{
    struct rigid_surface surface;
    GOOD(rigid_build(shape->dim, shape->count, shape->corners, flip, &surface, &error));
    return surface;
}

/* A star-shaped polygon with sharp convex and concave corners, counter-clockwise: normals point outward. */
static void make_star(struct shape *shape, int count, struct random *random)
{
    double point[2 * MAX_FACETS];
    *shape = (struct shape){.dim = 2};
    for (int i = 0; i < count; i++) {
        double angle = 2.0 * M_PI * i / count, r = uniform(random, 0.3, 1.0);
        point[2 * i] = r * cos(angle);
        point[2 * i + 1] = r * sin(angle);
    }
    for (int i = 0; i < count; i++) {
        add_facet(shape, point + 2 * i, point + 2 * ((i + 1) % count), NULL);
    }
}

/* The surface of a cube, n x n squares on each face, each vertex moved along its ray: sharp convex and
 * concave edges and vertices. Right-handed outward. */
static void make_boulder(struct shape *shape, int n, double roughness, struct random *random)
{
    static double radius[16][16][16];
    *shape = (struct shape){.dim = 3};
    for (int i = 0; i <= n; i++) {
        for (int j = 0; j <= n; j++) {
            for (int k = 0; k <= n; k++) {
                radius[i][j][k] = uniform(random, 1.0 - roughness, 1.0 + roughness);
            }
        }
    }
    for (int face = 0; face < 6; face++) {
        int axis = face / 2, end = face % 2;
        for (int cell = 0; cell < n * n; cell++) {
            double corner[4][3];
            for (int k = 0; k < 4; k++) {
                int at[3];
                at[axis] = end * n;
                at[(axis + 1) % 3] = cell % n + (k == 1 || k == 2);
                at[(axis + 2) % 3] = cell / n + (k >= 2);
                for (int a = 0; a < 3; a++) {
                    corner[k][a] = (2.0 * at[a] / n - 1.0) * radius[at[0]][at[1]][at[2]];
                }
            }
            if (end == 1) {
                add_facet(shape, corner[0], corner[1], corner[2]);
                add_facet(shape, corner[0], corner[2], corner[3]);
            } else {
                add_facet(shape, corner[0], corner[2], corner[1]);
                add_facet(shape, corner[0], corner[3], corner[2]);
            }
        }
    }
}

static double to_segment(int dim, const double *a, const double *b, const double *x)
{
    double along[3], away[3];
    vector_subtract(dim, b, a, along);
    vector_subtract(dim, x, a, away);
    double s = fmin(fmax(vector_dot(dim, along, away) / vector_dot(dim, along, along), 0.0), 1.0);
    add_scaled(dim, -s, along, away);
    return vector_length(dim, away);
}

/* The distance to a triangle: to its plane where the foot is inside of all three edges, else to an edge. */
static double to_triangle(const double *corner, const double *x)
{
    double least = INFINITY, e0[3], e1[3], normal[3], away[3];
    bool inside = true;
    vector_subtract(3, corner + 3, corner, e0);
    vector_subtract(3, corner + 6, corner, e1);
    vector_cross(e0, e1, normal);
    for (int k = 0; k < 3; k++) {
        const double *from = corner + 3 * k, *to = corner + 3 * ((k + 1) % 3);
        double edge[3], inward[3];
        vector_subtract(3, to, from, edge);
        vector_subtract(3, x, from, away);
        vector_cross(normal, edge, inward);
        inside = inside && vector_dot(3, inward, away) >= 0.0;
        least = fmin(least, to_segment(3, from, to, x));
    }
    return inside ? fabs(vector_dot(3, normal, away)) / vector_length(3, normal) : least;
}

static double brute_distance(const struct shape *shape, const double *x)
{
    double least = INFINITY;
    for (int64_t f = 0; f < shape->count; f++) {
        const double *corner = shape->corners + f * shape->dim * shape->dim;
        least = fmin(least, shape->dim == 2 ? to_segment(2, corner, corner + 2, x) : to_triangle(corner, x));
    }
    return least;
}

/* How often the surface winds around x: 1 inside, 0 outside. By angles; in 3D solid angles (van Oosterom and
 * Strackee 1983). */
static double winding(const struct shape *shape, const double *x)
{
    double sum = 0.0;
    for (int64_t f = 0; f < shape->count; f++) {
        const double *corner = shape->corners + f * shape->dim * shape->dim;
        double r[3][3] = {{0.0}}, turned[3], length[3];
        for (int k = 0; k < shape->dim; k++) {
            vector_subtract(shape->dim, corner + k * shape->dim, x, r[k]);
            length[k] = vector_length(3, r[k]);
        }
        vector_cross(r[0], r[1], turned);
        if (shape->dim == 2) {
            sum += atan2(turned[2], vector_dot(3, r[0], r[1])) / (2.0 * M_PI);
        } else {
            double below = length[0] * length[1] * length[2] + vector_dot(3, r[0], r[1]) * length[2] +
                           vector_dot(3, r[1], r[2]) * length[0] + vector_dot(3, r[2], r[0]) * length[1];
            sum += 2.0 * atan2(vector_dot(3, turned, r[2]), below) / (4.0 * M_PI);
        }
    }
    return sum;
}

/* Everything that must hold at x of a closed surface with outward normals, and of the same with inward ones.
 */
static void check_closed(const struct shape *shape, const struct rigid_surface *surface,
                         const struct rigid_surface *other, const double *x)
{
    int dim = shape->dim;
    double expected = brute_distance(shape, x), foot[3] = {0.0}, on_foot;
    struct rigid_contact contact = rigid_closest(surface, x, INFINITY);
    assert_true(contact.found);
    NEAR_TO(contact.distance, expected, 1e-13 * (1.0 + vector_length(dim, x)));
    NEAR_TO(fabs(contact.gap), contact.distance, 0.0);
    if (expected > 1e-9) {
        NEAR_TO(contact.gap > 0.0 ? 0.0 : 1.0, winding(shape, x), 1e-6);
        assert_true(rigid_is_behind(surface, x) == (contact.gap < 0.0));
    }
    NEAR_TO(vector_length(dim, contact.normal), 1.0, 1e-14);
    struct rigid_contact inward = rigid_closest(other, x, INFINITY);
    NEAR_TO(inward.gap, -contact.gap, 0.0);
    for (int a = 0; a < dim; a++) {
        NEAR_TO(inward.normal[a], -contact.normal[a], 0.0);
        foot[a] = x[a] - contact.gap * contact.normal[a];
    }
    on_foot = brute_distance(shape, foot);
    NEAR_TO(on_foot, 0.0, 1e-13 * (1.0 + vector_length(dim, x)));
    /* Only what is within reach is found. */
    struct rigid_contact reached = rigid_closest(surface, x, 1.01 * expected + 1e-6);
    assert_memory_equal(&reached, &contact, sizeof contact);
    reached = rigid_closest(surface, x, 0.99 * expected);
    assert_false(reached.found);
    NEAR_TO(reached.distance, 0.99 * expected, 0.0);
}

/* Points in, out, far away, on vertices and on facets. */
static void check_everywhere(const struct shape *shape, struct random *random)
{
    int dim = shape->dim;
    FREED_BY(rigid_free) struct rigid_surface surface = built(shape, false), other = built(shape, true);
    for (int i = 0; i < 2000; i++) {
        double x[3], size = i % 4 == 0 ? 50.0 : 1.3;
        for (int a = 0; a < dim; a++) {
            x[a] = uniform(random, -size, size);
        }
        check_closed(shape, &surface, &other, x);
    }
    for (int64_t c = 0; c < shape->count * dim && c < 600; c++) {
        double x[3];
        for (int a = 0; a < dim; a++) {
            x[a] = shape->corners[c * dim + a];
        }
        check_closed(shape, &surface, &other, x);
        for (int a = 0; a < dim; a++) {
            x[a] *= 1.0 + uniform(random, -1e-3, 1e-3); /* beside a vertex, where edges and faces compete */
        }
        check_closed(shape, &surface, &other, x);
    }
}

TEST(closed_curves)
{
    struct random random = {1};
    static struct shape shape;
    for (int count = 3; count < 400; count = count * 3 + 1) {
        make_star(&shape, count, &random);
        check_everywhere(&shape, &random);
    }
}

TEST(closed_surfaces)
{
    struct random random = {2};
    static struct shape shape;
    for (int n = 1; n <= 7; n += 3) {
        make_boulder(&shape, n, 0.0, &random);
        check_everywhere(&shape, &random);
        make_boulder(&shape, n, 0.35, &random);
        check_everywhere(&shape, &random);
    }
}

/* Two squares that overlap: in the first one beside an edge of the second, the closest facet faces the point.
 */
TEST(crossing_curves)
{
    static const double x[2] = {0.95, 1}, beside[2] = {-0.05, 1};
    struct shape shape = {.dim = 2};
    for (int i = 0; i < 8; i++) {
        double low = i / 4, from[2] = {low + 2 * (i % 4 == 1 || i % 4 == 2), 2 * (i % 4 > 1)},
               to[2] = {low + 2 * (i % 4 < 2), 2 * (i % 4 == 1 || i % 4 == 2)};
        add_facet(&shape, from, to, NULL);
    }
    for (int flip = 0; flip < 2; flip++) {
        FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, flip != 0);
        assert_true((rigid_closest(&surface, x, INFINITY).gap > 0) == (flip == 0));
        assert_true(rigid_is_behind(&surface, x) == (flip == 0));
        assert_true(rigid_is_behind(&surface, beside) == (flip != 0));
    }
}

/* On a vertex and on a facet the normal is the surface's, not a quotient of round-off. */
TEST(normals_on_the_surface)
{
    static const double curve[][2] = {{0, 0}, {1, 0}, {1, 1}};
    struct shape shape = {.dim = 2};
    add_facet(&shape, curve[0], curve[1], NULL);
    add_facet(&shape, curve[1], curve[2], NULL);
    FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, false);
    for (double off = 0.0; off <= 2e-14; off += 1e-14) {
        struct rigid_contact contact = rigid_closest(&surface, (double[]){1.0 + off, -off}, 1.0);
        assert_true(contact.found);
        NEAR_TO(contact.normal[0], M_SQRT1_2, 1e-12);
        NEAR_TO(contact.normal[1], -M_SQRT1_2, 1e-12);
        contact = rigid_closest(&surface, (double[]){0.5, off}, 1.0);
        NEAR_TO(contact.normal[0], 0.0, 0.0);
        NEAR_TO(contact.normal[1], -1.0, 0.0);
        NEAR_TO(contact.gap, -off, 0.0);
    }
}

/* An open curve ends at the normals through its ends; a sheet at the planes through its edges. */
TEST(rims)
{
    static const double curve[][2] = {{0, 0}, {1, 0}, {2, 0}};
    struct shape line = {.dim = 2};
    add_facet(&line, curve[1], curve[2], NULL);
    add_facet(&line, curve[0], curve[1], NULL);
    struct rigid_surface surface = built(&line, false);
    for (double x = -0.95; x < 3.0; x += 0.1) {
        for (double y = -0.5; y < 0.6; y += 0.25) {
            struct rigid_contact contact = rigid_closest(&surface, (double[]){x, y}, 5.0);
            if (x > 0.0 && x < 2.0) {
                assert_true(contact.found);
                NEAR_TO(contact.gap, -y, 1e-15);
            } else {
                assert_false(contact.found);
                NEAR_TO(contact.distance, fmin(fabs(y), x < 0.0 ? -x : x - 2.0), 1e-15);
            }
        }
    }
    assert_true(rigid_closest(&surface, (double[]){0.0, -0.3}, 5.0).found); /* just over the end */
    rigid_free(&surface);

    /* A fan of four triangles about the middle of a square; all three orders of corners. */
    static const double square[][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.4, 0.6, 0}};
    struct shape sheet = {.dim = 3};
    add_facet(&sheet, square[0], square[1], square[4]);
    add_facet(&sheet, square[4], square[1], square[2]);
    add_facet(&sheet, square[3], square[4], square[2]);
    add_facet(&sheet, square[0], square[4], square[3]);
    surface = built(&sheet, false);
    for (double x = -0.25; x < 1.3; x += 0.1) {
        for (double y = -0.25; y < 1.3; y += 0.1) {
            for (double z = -0.5; z < 0.6; z += 0.25) {
                struct rigid_contact contact = rigid_closest(&surface, (double[]){x, y, z}, 5.0);
                double dx = fmax(fmax(-x, x - 1.0), 0.0), dy = fmax(fmax(-y, y - 1.0), 0.0);
                if (dx == 0.0 && dy == 0.0) {
                    assert_true(contact.found);
                    NEAR_TO(contact.gap, z, 1e-15);
                    NEAR_TO(contact.normal[2], 1.0, 1e-15);
                } else {
                    assert_false(contact.found);
                    NEAR_TO(contact.distance, fmin(fabs(z), hypot(dx, dy)), 1e-15);
                }
            }
        }
    }
    rigid_free(&surface);
}

/* A place where the surface is open only by round-off is no rim; a rim on another facet is. */
TEST(seams)
{
    struct shape shape = {.dim = 2};
    struct random random = {6};
    for (int i = 0; i < 40; i++) { /* the same point written twice with different round-off */
        double a[2] = {cos(0.1 * i) + 1e-13, sin(0.1 * i)}, b[2] = {cos(0.1 * (i + 1)), sin(0.1 * (i + 1))};
        add_facet(&shape, a, b, NULL);
    }
    FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, false);
    assert_int_equal(surface.vertex_count, 41);
    int64_t rims = 0;
    for (int64_t v = 0; v < surface.vertex_count; v++) {
        rims += surface.is_rim[v];
    }
    assert_int_equal(rims, 2);
    for (int i = 0; i < 1000; i++) {
        double angle = uniform(&random, 0.1, 3.9), r = uniform(&random, 0.5, 1.5);
        struct rigid_contact contact =
            rigid_closest(&surface, (double[]){r * cos(angle), r * sin(angle)}, INFINITY);
        assert_true(contact.found);
        NEAR_TO(contact.gap, r - 1.0, 2e-3);
    }
}

/* Straight over the end of a facet, however it lies: found; straight over a place where the rim of one facet
 * stands on another: that one is. */
TEST(over_the_rim)
{
    struct random random = {7};
    static struct shape shape;
    for (int round = 0; round < 1000; round++) {
        int dim = 2 + round % 2;
        double corner[9], x[3], height = uniform(&random, -0.5, 0.5), part = uniform(&random, 0.0, 1.0);
        shape = (struct shape){.dim = dim};
        for (int i = 0; i < dim * dim; i++) {
            corner[i] = uniform(&random, -1.0, 1.0);
        }
        add_facet(&shape, corner, corner + dim, corner + 2 * dim);
        FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, false);
        part = round % 4 < 2 ? 0.0 : part; /* over a corner, over an edge */
        for (int a = 0; a < dim; a++) {
            x[a] = corner[a] + (dim == 3 ? part * (corner[3 + a] - corner[a]) : 0.0) +
                   height * surface.normal[a];
        }
        struct rigid_contact contact = rigid_closest(&surface, x, INFINITY);
        assert_true(contact.found);
        NEAR_TO(contact.gap, height, 1e-14);
    }
    static const double floor[][2] = {{1, 0}, {-1, 0}}, wall[][2] = {{0, 1}, {0, 0}};
    for (int order = 0; order < 2; order++) {
        shape = (struct shape){.dim = 2};
        add_facet(&shape, order ? floor[0] : wall[0], order ? floor[1] : wall[1], NULL);
        add_facet(&shape, order ? wall[0] : floor[0], order ? wall[1] : floor[1], NULL);
        FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, false);
        struct rigid_contact contact = rigid_closest(&surface, (double[]){0.0, -0.3}, INFINITY);
        assert_true(contact.found);
        NEAR_TO(contact.gap, -0.3, 1e-15);
    }
}

static void fails(int dim, int64_t count, const double *corners, const char *expected)
{
    FREED_BY(rigid_free) struct rigid_surface surface = {0};
    FAILS_WITH(rigid_build(dim, count, corners, false, &surface, &error), STATUS_INPUT, expected);
}

TEST(faults)
{
    fails(2, 0, NULL, "rigid surface: 0 facets: none, or too many");
    fails(2, 2, (double[]){0, 0, 1, 0, 1, 0, 1, 0}, "rigid surface: facet 2 has no size: remove it");
    fails(3, 1, (double[]){0, 0, 0, 1, 1, 1, 2, 2, 2}, "rigid surface: facet 1 has no size: remove it");
    fails(2, 2, (double[]){0, 0, 1, 0, 1, 0, 2, (double)NAN},
          "rigid surface: facet 2: coordinate is not finite");
    fails(2, 3, (double[]){5, 5, 6, 6, 0, 0, 1, 0, 2, 0, 1, 0},
          "rigid surface: facets 2 and 3 meet but disagree on the side: turn one around");
    fails(3, 2, (double[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5},
          "rigid surface: facets 1 and 2 meet but disagree on the side: turn one around");
    fails(2, 3, (double[]){0, 0, 1, 0, 1, 0, 2, 0, 0, 0, 1, 0},
          "rigid surface: facets 1 and 3 are the same: remove one");
    fails(3, 3, (double[]){0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0},
          "rigid surface: facets 1 and 3 are the same: remove one");
}

/* Not a number is not found, and is looked at again. */
TEST(not_a_number)
{
    struct shape shape = {.dim = 2};
    add_facet(&shape, (double[]){0, 0}, (double[]){1, 0}, NULL);
    FREED_BY(rigid_free) struct rigid_surface surface = built(&shape, false);
    struct rigid_contact contact = rigid_closest(&surface, (double[]){(double)NAN, 0.0}, INFINITY);
    assert_false(contact.found);
    NEAR_TO(contact.distance, 0.0, 0.0);
}

RUN_TESTS(NULL, NULL)
