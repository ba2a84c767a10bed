#include "approx/cells/quadrature.h"

/* Points with one weight, whose barycentric coordinates are permutations of the same numbers: a letter for
 * each coordinate, a blank between points. */
struct orbit {
    const char *points;
    double weight, value[3]; /* of the letters a, b, c */
};

enum { MOST_ORBITS = 3 };

struct orbits {
    int points, vertices;
    struct orbit orbit[MOST_ORBITS];
};

/* Dunavant 1985 (triangles of 6, 7, 12 points: degrees 4, 5, 6); Hammer and Stroud 1956 and Walkington 2000
 * (tetrahedra of 4, 8, 14 points: degrees 2, 3, 5); a triangle of 4 points: the centroids of the four
 * sub-triangles. Of an edge the two points of Gauss. */
static const struct orbits rules[] = {
    {2, 2, {{"ab ba", 0.5, {0.78867513459481287, 0.21132486540518713}}}},
    {1, 3, {{"aaa", 1.0, {1.0 / 3.0}}}},
    {3, 3, {{"abb bab bba", 0.33333333333333331, {0.66666666666666674, 0.16666666666666666}}}},
    {4,
     3,
     {{"aaa", 0.25, {0.33333333333333331}},
      {"abb bab bba", 0.25, {0.66666666666666674, 0.16666666666666666}}}},
    {6,
     3,
     {{"abb bab bba", 0.22338158967801147, {0.10810301816807022, 0.44594849091596489}},
      {"abb bab bba", 0.10995174365532187, {0.81684757298045851, 0.091576213509770743}}}},
    {7,
     3,
     {{"aaa", 0.22500000000000001, {0.33333333333333331}},
      {"abb bab bba", 0.13239415278850616, {0.059715871789769892, 0.47014206410511505}},
      {"abb bab bba", 0.12593918054482717, {0.79742698535308731, 0.10128650732345633}}}},
    {12,
     3,
     {{"abb bab bba", 0.11678627572637937, {0.50142650965817914, 0.24928674517091043}},
      {"abb bab bba", 0.050844906370206819, {0.87382197101699555, 0.063089014491502227}},
      {"abc bac acb bca cab cba",
       0.082851075618373571,
       {0.053145049844816945, 0.31035245103378439, 0.63650249912139867}}}},
    {1, 4, {{"aaaa", 1.0, {0.25}}}},
    {4, 4, {{"abbb babb bbab bbba", 0.25, {0.58541019662496852, 0.1381966011250105}}}},
    {8,
     4,
     {{"abbb babb bbab bbba", 0.13852796651186214, {0.015835909865719922, 0.32805469671142667}},
      {"abbb babb bbab bbba", 0.11147203348813786, {0.67914317820120795, 0.10695227393293068}}}},
    {14,
     4,
     {{"abbb babb bbab bbba", 0.11268792571801585, {0.067342242210098213, 0.31088591926330061}},
      {"abbb babb bbab bbba", 0.073493043116361956, {0.72179424906732637, 0.092735250310891221}},
      {"aabb abab abba baab baba bbaa", 0.042546020777081466, {0.045503704125649649, 0.45449629587435036}}}},
};

static void put_orbits(const struct orbits *orbits, struct quadrature_rule *rule)
{
    int count = 0;
    *rule = (struct quadrature_rule){.points = orbits->points, .vertices = orbits->vertices};
    for (int i = 0; i < MOST_ORBITS && orbits->orbit[i].points != NULL; i++) {
        const struct orbit *orbit = &orbits->orbit[i];
        for (const char *letter = orbit->points; *letter != '\0'; letter++) {
            if (*letter != ' ') {
                rule->weight[count / rule->vertices] = orbit->weight;
                rule->barycentric[count++] = orbit->value[*letter - 'a'];
            }
        }
    }
}

/* False if there is none. */
static bool find_rule(int vertices, int points, struct quadrature_rule *rule)
{
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        if (rules[i].vertices == vertices && rules[i].points == points) {
            put_orbits(&rules[i], rule);
            return true;
        }
    }
    return false;
}

enum status quadrature_cell_rule(int dim, int points, struct quadrature_rule *rule, struct error *error)
{
    return find_rule(dim + 1, points, rule)
               ? STATUS_OK
               : fail(error, STATUS_INPUT, "no rule of %d points; there are %s", points,
                      dim == 2 ? "1, 3, 4, 6, 7 and 12 for triangles" : "1, 4, 8 and 14 for tetrahedra");
}

struct quadrature_rule quadrature_face_rule(int dim)
{
    struct quadrature_rule rule;
    (void)find_rule(dim, dim, &rule);
    return rule;
}

void quadrature_positions(const struct quadrature_rule *rule, int dim, const double *nodes,
                          const int32_t *vertex, double *x)
{
    for (int q = 0; q < rule->points; q++) {
        for (int a = 0; a < dim; a++) {
            double sum = 0.0;
            for (int k = 0; k < rule->vertices; k++) {
                sum += rule->barycentric[q * rule->vertices + k] * nodes[(int64_t)vertex[k] * dim + a];
            }
            x[q * dim + a] = sum;
        }
    }
}
