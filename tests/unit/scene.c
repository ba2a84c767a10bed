/* Scenes: what a good one holds, and one clear error with its line for each thing that can be wrong. */
#include "unit.h"

#include "io/scene/scene.h"

#include <stdio.h>
#include <unistd.h>

static char folder[] = "/tmp/scene-XXXXXX";
static char path[64];

static const char full[] =
    "# a comment\n"
    "[scene]\ndim = 2 ; trailing comment\nanalysis = dynamic\ntitle = A whole scene\n"
    "gravity = 0, -9.81\n\n"
    "[material parenchyma]\n  region = parenchyma , white_matter\n  E = 3000 # Pa\n  nu = 0.49\n"
    "  rho = 1e3\n"
    "[material tumour]\nregion = tumour\nmodel = ogden\nalpha = -4.7\ntable = sub/tumour.tsv\n"
    "unit = mm\nrho = 1000\n"
    "[displacement craniotomy]\nfacets = craniotomy\ntable = load.tsv\nunit = cm\n"
    "curve = /abs/curve.tsv\n"
    "[displacement slide]\nnodes = a,b\ncomponents = free, -1e-3\ncurve = linear\n"
    "[displacement flat]\nfacets = bottom\nnormal = 0\n"
    "[contact skull]\nfacets = surface\nrigid = skull.tsv\nunit = mm\nside = right\nstiffness = 1e7\n"
    "[pressure p]\nfacets = top\nvalue = -20\ncurve = step\n"
    "[traction t]\nfacets = top\ncomponents = 1,2\n"
    "[force f]\nnodes = tip\ncomponents = 0,.5\n"
    "[output]\ninterval = .01\nenergy = yes\n"
    "[solver]\nconstraints = direct\nconstraint_points = node\nvolume = pointwise\nend_time = 2\n"
    "damping = 3\nmax_steps = 1000000\n";

#define HEAD "[scene]\ndim = 2\nanalysis = quasi-static\n"
#define REGION "[material m]\nregion = r\n"
#define HEAD3 "[scene]\ndim = 3\nanalysis = quasi-static\n"
#define GUCCIONE REGION "model = guccione\nC = 9\nbf = 1\nbt = 1\nbfs = 1\nkappa = 1e5\n"
#define HOLZAPFEL REGION "model = holzapfel-gasser-ogden\nc = 9\nk1 = 1\nk2 = 1\ngamma = 30\nkappa = 1e5\n"
#define BODY REGION "E = 3000\nnu = .49\nrho = 1000\n"

static void write_bytes(const char *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void same(double value, double expected)
{
    assert_true(fabs(value - expected) <= 1e-15 * fabs(expected));
}

TEST(reads_everything)
{
    struct scene scene;
    char expected[128];
    write_bytes(full, sizeof full - 1);
    GOOD(scene_read(path, &scene, &error));
    assert_int_equal(scene.dim, 2);
    assert_int_equal(scene.analysis, SCENE_DYNAMIC);
    assert_string_equal(scene.title, "A whole scene");
    same(scene.gravity[1], -9.81);
    assert_int_equal(scene.material_count, 2);
    assert_int_equal(scene.materials[0].regions.count, 2);
    assert_string_equal(scene.materials[0].regions.names[1], "white_matter");
    same(scene.materials[0].youngs_modulus, 3000);
    same(scene.materials[0].poisson_ratio, .49);
    same(scene.materials[0].material.density, 1000);
    same(scene.materials[0].material.bulk_modulus, 50000);
    assert_non_null(strstr(scene.materials[0].label.where, ".scene:8: [material "));
    assert_int_equal(scene.materials[1].material.model, law_find("ogden"));
    same(scene.materials[1].parameters[6], -4.7);
    snprintf(expected, sizeof expected, "%s/sub/tumour.tsv", folder);
    assert_string_equal(scene.materials[1].table, expected);
    same(scene.materials[1].table_unit, 1e-3);
    assert_int_equal(scene.displacement_count, 3);
    assert_int_equal(scene.displacements[0].condition.kind, CONDITION_TABLE);
    assert_int_equal(scene.displacements[0].curve.kind, CURVE_TABLE);
    assert_string_equal(scene.displacements[0].curve.file, "/abs/curve.tsv");
    same(scene.displacements[0].condition.unit, 1e-2);
    assert_int_equal(scene.displacements[1].condition.kind, CONDITION_COMPONENTS);
    assert_int_equal(scene.displacements[1].nodes.count, 2);
    assert_true(scene.displacements[1].condition.is_free[0]);
    assert_false(scene.displacements[1].condition.is_free[1]);
    same(scene.displacements[1].condition.components[1], -1e-3);
    assert_int_equal(scene.displacements[1].curve.kind, CURVE_LINEAR);
    assert_int_equal(scene.displacements[2].condition.kind, CONDITION_NORMAL);
    assert_int_equal(scene.displacements[2].curve.kind, CURVE_SMOOTH);
    assert_int_equal(scene.contacts[0].side, SCENE_RIGHT);
    same(scene.contacts[0].condition.stiffness, 1e7);
    same(scene.loads[0].load.pressure, -20);
    assert_int_equal(scene.loads[0].curve.kind, CURVE_STEP);
    same(scene.loads[1].load.components[1], 2);
    assert_int_equal(scene.loads[2].load.kind, LOAD_FORCE);
    same(scene.loads[2].load.components[1], .5);
    assert_string_equal(scene.loads[2].nodes.names[0], "tip");
    assert_true(scene.output.energy);
    assert_false(scene.output.stress);
    same(scene.output.interval, .01);
    assert_true(scene.solver.direct && scene.solver.node_values && scene.solver.pointwise_volume);
    assert_int_equal(scene.solver.max_steps, 1000000);
    same(scene.solver.end_time, 2);
    same(scene.solver.damping, 3);

    snprintf(expected, sizeof expected, "%s:32: [contact skull]", path);
    assert_string_equal(scene.contacts[0].label.where, expected);
    scene_free(&scene);
    assert_null(scene.materials);
}

TEST(defaults)
{
    FREED_BY(scene_free) struct scene scene = {0};
    write_bytes(HEAD BODY, sizeof(HEAD BODY) - 1);
    GOOD(scene_read(path, &scene, &error));
    assert_string_equal(scene.title, "");
    assert_int_equal(scene.materials[0].material.model, MATERIAL_NEO_HOOKEAN);
    assert_true(!scene.solver.direct && !scene.solver.node_values && !scene.solver.pointwise_volume);
    same(scene.solver.tolerance, 1e-5);
    same(scene.solver.time_step_margin, .9);
    assert_int_equal(scene.displacement_count + scene.contact_count + scene.load_count, 0);
    assert_int_equal(scene.output.frames, 0);
}

/* Reading `bytes` fails with STATUS_INPUT, names the file and the line, and says `words`. */
static void fails_bytes(const char *bytes, size_t size, int line, const char *words)
{
    FREED_BY(scene_free) struct scene scene = {0};
    struct error error = {""};
    char where[96];
    write_bytes(bytes, size);
    enum status status = scene_read(path, &scene, &error);
    if (status != STATUS_INPUT || strstr(error.text, words) == NULL) {
        fail_msg("status %d, message \"%s\" without \"%s\"", (int)status, error.text, words);
    }
    snprintf(where, sizeof where, line > 0 ? "%s:%d: " : "%s: ", path, line);
    if (strncmp(error.text, where, strlen(where)) != 0) {
        fail_msg("message \"%s\" does not begin with \"%s\"", error.text, where);
    }
}

static void fails(const char *text, int line, const char *words)
{
    fails_bytes(text, strlen(text), line, words);
}

/* Fault 10 of tests/faults.bats, and what else is no scene. */
TEST(strict_form)
{
    fails(HEAD BODY "[materials m]\n", 9, "unknown section: allowed are scene, material");
    fails(HEAD BODY "[output]\n[output]\n", 10, "already in line 9");
    fails(HEAD BODY "E = 4000\n", 9, "[material m]: E: already in line 6");
    fails(HEAD BODY "[scene x]\n", 9, "takes no name");
    fails(HEAD BODY "[contact]\n", 9, "lacks its name");
    fails(HEAD BODY "[contact a b]\n", 9, "section header");
    fails(HEAD BODY "[contact a] junk\n", 9, "section header");
    fails(HEAD BODY "[contact a\n", 9, "section header");
    fails(HEAD BODY "[]\n", 9, "section header");
    fails("dim = 2\n" HEAD BODY, 1, "before the first [section]");
    fails(HEAD BODY "junk\n", 9, "nor key = value");
    fails(HEAD BODY "two words = 3\n", 9, "not one word");
    fails(HEAD BODY "= 3\n", 9, "not one word");
    fails(HEAD BODY "model =\n", 9, "model: has no value");
    fails("# nothing\n", 0, "no section [scene]");
    fails(BODY, 0, "no section [scene]");
    fails(HEAD, 0, "no section [material NAME]");
    fails("[scene]\ndim = 2\n" BODY, 1, "[scene]: analysis: missing");
    fails("[scene]\nanalysis = quasi-static\n" BODY, 1, "[scene]: dim: missing");
    fails("[scene]\ndim = 2.5\nanalysis = dynamic\n" BODY, 2, "dim: '2.5' is not a whole number");
    fails("[scene]\ndim = 2\nanalysis = static\n" BODY, 3, "none of quasi-static, dynamic");
    fails("[scene]\ndim = 2\nanalysis = dynamic\n" BODY, 0, "end_time: missing");
    fails(HEAD "[material m]\nregion = r\nE = 3000 Pa\nnu = .49\nrho = 1\n", 6,
          "'3000 Pa' is not a finite number: write it in SI units, without the name of one");
    fails(HEAD "[material m]\nregion = r\nE = 0x10\nnu = .49\nrho = 1\n", 6, "'0x10' is not a finite number");
    fails("\xff\xfe" HEAD BODY, 1, "byte order mark");
    fails_bytes("[scene]\nd\0m = 2\n", 16, 2, "control character 0x00");
    fails("", 0, "is empty");
    fails(HEAD BODY "[output]", 9, "last line without newline");
}

TEST(long_lines)
{
    char text[4000];
    FREED_BY(scene_free) struct scene scene = {0};
    snprintf(text, sizeof text,
             "[scene]\n  title = %01000d    # a comment %0200d\ndim = 2\nanalysis = quasi-static\n" BODY, 7,
             8);
    write_bytes(text, strlen(text));
    GOOD(scene_read(path, &scene, &error));
    assert_int_equal(strlen(scene.title), 1000);
}

/* At rest without weight nobody need give a density. */
TEST(density_that_is_not_felt)
{
    static const char text[] = HEAD "[material m]\nregion = r\nE = 3\nnu = .3\n";
    FREED_BY(scene_free) struct scene scene = {0};
    write_bytes(text, sizeof text - 1);
    GOOD(scene_read(path, &scene, &error));
    assert_true(scene.materials[0].material.density > 0);
}

TEST(material_keys)
{
    fails(HEAD "[material m]\nregion = r\nnu = .3\nrho = 1\n", 4, "E: missing: give Young's modulus in Pa");
    fails(HEAD "gravity = 0, -9.81\n[material m]\nregion = r\nE = 3\nnu = .3\n", 5,
          "rho: missing: give the density in kg/m3");
    fails("[scene]\ndim = 2\nanalysis = dynamic\n[material m]\nregion = r\nE = 3\nnu = .3\n", 4,
          "rho: missing: give the density in kg/m3");
    fails(HEAD "[material m]\nE = 3\nnu = .3\nrho = 1\n", 4, "region: missing");
    fails(HEAD BODY "model = hooke\n", 9, "model: 'hooke' is none of neo-hookean, neo-hookean-log");
    fails(HEAD BODY "model = ogden\n", 4, "alpha: missing");
    fails(HEAD BODY "model = ogden\nalpha = 0\n", 10, "must not be 0");
    fails(HEAD BODY "ratio = 1\n", 9, "not allowed: it belongs to model mooney-rivlin");
    fails(HEAD BODY "model = mooney-rivlin\nratio = -1\n", 10, "-1 is not at least 0");
    fails(HEAD BODY "model = ogden\nalpha = 1, 2\n", 10, "alpha: E goes with one number");
    fails(HEAD BODY "kappa = 1\n", 9, "kappa: not allowed: nu gives the volume: give one of nu, kappa, D");
    fails(HEAD BODY "mu = 1\n", 9, "mu: not allowed: the stiffness is given by E");
    fails(HEAD REGION "E = 9\nkappa = 1\n", 6, "E: is not below 9 kappa");
    fails(HEAD REGION "mu = 1\nD = 1e-320\n", 4, "the moduli are too small or too large");
    fails(HEAD REGION "model = yeoh\nc1 = 1e-300\nc2 = 1e300\nnu = 0\n", 4,
          "the moduli are too small or too large");
    fails(HEAD REGION "mu = 1, 2\nkappa = 1\n", 6, "mu: has more than 1 number");
    fails(HEAD REGION "model = ogden\nmu = 1, -1\nalpha = 2, 3\nnu = 0\n", 7, "mu: the sum is not positive");
    fails(HEAD REGION "model = ogden\nmu = 1, 2\nalpha = 3\nnu = 0\n", 8,
          "alpha: mu and alpha have different");
    fails(HEAD REGION "model = mooney-rivlin\nc1 = 1\nc2 = -1\nnu = 0\n", 7, "c1: c1 + c2 is not positive");
    fails(HEAD REGION "model = mooney-rivlin\nc1 = 1\nratio = 1\n", 8, "ratio: not allowed: it goes with E");
    fails(HEAD BODY "fibre = 1, 0\n", 9, "fibre: not allowed: the law has no fibres, and no active");
    fails(HEAD BODY "curve = step\n", 9, "curve: not allowed: it goes with active");
    fails(HEAD BODY "prony = .45 .5, .55 50\n", 9, "prony: the sum of g is 1, not below 1");
    fails(HEAD BODY "prony = .45 .5, .365 0\n", 9, "prony: 0 is not above 0");
    fails(HEAD BODY "prony = 0 .5\n", 9, "prony: 0 is not within (0, 1)");
    fails(HEAD BODY "prony = .45, .5\n", 9, "prony: '.45' is not a term: write g and tau in s");
    fails(HEAD BODY "prony = .1 1, .1 2, .1 3, .1 4, .1 5, .1 6, .1 7\n", 9, "prony: has more than 6 terms");
    fails(HEAD BODY "prony = .45 .5\n", 9, "prony: the scene has no time: give duration in [scene], s");
    fails(HEAD BODY "[solver]\ntime_steps = 5\n", 0,
          "time_steps: not allowed: the scene has neither duration nor friction");
    fails(HEAD "duration = 1\n" BODY "[solver]\nmethod = relaxation\n", 11,
          "method: a scene with duration takes newton");
    fails("[scene]\ndim = 2\nanalysis = dynamic\nduration = 1\n" BODY, 4,
          "duration: not allowed: a dynamic scene");
    fails(HEAD "duration = 1\n" BODY, 0, "[scene]: duration: of no use");
    fails(HEAD GUCCIONE "fibre = 0, -0\n", 12, "fibre: has no length: give a direction, as 1, 0, 0");
    fails(HEAD GUCCIONE "fibre = 0, 0, 1\n", 12, "fibre: has 3 components: dim = 2 needs 2");
    fails(HEAD GUCCIONE "fibre = 0, 1\nfibre_plane = 0, 1\n", 13, "fibre_plane: not allowed: in 2D it is");
    fails(HEAD3 GUCCIONE "fibre = 0, 1, 0\nfibre_plane = 1, 0, 0\n", 13, "the law has one family of fibres");
    fails(HEAD3 HOLZAPFEL "fibre = 0, 1, 0\n", 4, "fibre_plane: missing: give a direction that spans");
    fails(HEAD3 HOLZAPFEL "fibre = 0, 1, 0\nfibre_plane = 0, 2, 1e-7\n", 13, "no direction other than fibre");
    fails(HEAD3 HOLZAPFEL "dispersion = .4\nfibre = 0, 1, 0\nfibre_plane = 1, 0, 0\n", 12,
          "dispersion: .4 is not within [0, 0.333333]");
    fails(HEAD REGION "model = trans-iso\nc1 = 1\nc3 = 1\nc4 = 1\nc5 = 2\nfibre = 0, 1\n", 10,
          "c5: not allowed: it goes with lambda_max");
    fails(HEAD BODY "model = yeoh\n", 6, "E: not allowed: the law has its own moduli");
    fails(HEAD REGION "model = yeoh\nc1 = 1\n", 4, "nu: missing: give Poisson's ratio, or kappa in Pa, or D");
    fails(HEAD BODY "table = t\n", 6, "E: not allowed: the table gives E and nu");
    fails(HEAD "[material m]\nregion = r\nrho = 1\ntable = t\n", 7, "table: needs unit");
    fails(HEAD BODY "[material n]\nregion = q,r\nE = 1\nnu = 0\nrho = 1\n", 9,
          "[material n]: region: 'r' is of material m already");
    fails(HEAD "[material m]\nregion = r, q, r\n", 5, "region: names 'r' twice");
}

/* The moduli of laws by the parameters of each, and the volume by each of its keys. */
TEST(moduli)
{
    static const struct {
        const char *keys;
        double shear, bulk, parameter;
    } cases[] = {
        {"E = 3000\nkappa = 50000\n", 3000 / 2.98, 50000, 0},
        {"mu = 3\nnu = 0.25\n", 3, 5, 0},
        {"model = st-venant-kirchhoff\nmu = 3\nD = 0.5\n", 3, 4, 0},
        {"model = mooney-rivlin\nc1 = 2\nc2 = 3\nkappa = 7\n", 10, 7, 1.5},
        {"model = mooney-rivlin\nratio = 3\nE = 9\nnu = 0\n", 4.5, 3, 3},
        {"model = ogden\nmu = 1, 2, 5\nalpha = 2, -3, .5\nkappa = 7\n", 8, 7, .125},
        {"model = yeoh\nc1 = 2\nc3 = 1\nkappa = 7\n", 4, 7, .5},
        {"model = trans-iso\nc1 = 1\nc3 = 5\nc4 = 6\nfibre = 3, 4\nkappa = 7\n", 4, 7, .25},
        {"model = guccione\nC = 2\nbf = 8\nbt = 2\nbfs = 4\nfibre = 1, 0\nkappa = 7\n", 3.6, 7, 2 / 3.6},
        {"model = holzapfel-gasser-ogden\nc = 1\nk1 = 15\nk2 = 2\nfibre = 1, 0\nkappa = 7\n", 9, 7, 1. / 9}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        FREED_BY(scene_free) struct scene scene = {0};
        char text[256];
        int length = snprintf(text, sizeof text, HEAD REGION "%s", cases[i].keys);
        write_bytes(text, (size_t)length);
        GOOD(scene_read(path, &scene, &error));
        NEAR_TO(scene.materials[0].material.shear_modulus, cases[i].shear, 1e-9);
        NEAR_TO(scene.materials[0].material.bulk_modulus, cases[i].bulk, 1e-9);
        NEAR_TO(scene.materials[0].parameters[0], cases[i].parameter, 1e-15);
    }
}

TEST(conditions)
{
    fails(HEAD BODY "[displacement d]\nfacets = f\n", 9,
          "none of table, components, normal: give exactly one");
    fails(HEAD BODY "[displacement d]\nfacets = f\nnormal = 0\ncomponents = 0,0\n", 9, "several of table");
    fails(HEAD BODY "[displacement d]\n\n", 9, "none of facets, nodes");
    fails(HEAD BODY "[displacement d]\nnodes = f\nnormal = 0\n", 11,
          "normal: not allowed: it goes with facets");
    fails(HEAD BODY "[displacement d]\nfacets = f\ntable = t\n", 11, "table: needs unit = m, cm, mm or um");
    fails(HEAD BODY "[displacement d]\nfacets = f\ncomponents = 0,1,2\n", 11,
          "has 3 components: dim = 2 needs 2, with decimal points");
    fails(HEAD BODY "[displacement d]\nfacets = f\ncomponents = free,free\n", 11, "all are free");
    fails(HEAD BODY "[displacement d]\nfacets = f\ncomponents = 0,\n", 11, "'' is not a finite number");
    fails(HEAD BODY "[force d]\nnodes = f\ncomponents = 0,free\n", 11, "'free' is not a finite number");
    fails(HEAD BODY "[force d]\nfacets = f\ncomponents = 0,1\n", 10, "facets: unknown key");
    fails(HEAD BODY "[force d]\nnodes = f\n", 9, "components: missing: give the force on each node in N");
    fails(HEAD BODY "[pressure d]\nfacets = f\n", 9, "none of value, density");
    fails(HEAD BODY "[contact c]\nfacets = f\nrigid = s\nunit = m\n", 9, "side: missing: left or right");
    fails(HEAD BODY "[contact c]\nfacets = f\nrigid = s\nunit = m\nside = front\n", 13,
          "none of left, right");
    fails("[scene]\ndim = 3\nanalysis = quasi-static\n" BODY
          "[contact c]\nfacets = f\nrigid = s\nunit = m\nside = left\n",
          13, "none of front, back");
}

TEST(solver_and_output)
{
    fails(HEAD BODY "[solver]\ntolerance = 1\n", 10, "tolerance: 1 is not within (0, 1)");
    fails(HEAD BODY "[solver]\nend_time = 1\n", 10, "a quasi-static scene has duration, in [scene]");
    fails(HEAD BODY "[solver]\nmax_steps = 0\n", 10, "max_steps: 0 is not within [1,");
    fails(HEAD BODY "[solver]\nmax_steps = 1e3\n", 10, "'1e3' is not a whole number");
    fails(HEAD BODY "[solver]\nconstraints = penalty\n", 10, "none of ebciem, direct");
    fails("[scene]\ndim = 2\nanalysis = dynamic\n" BODY "[solver]\nend_time = 1\ntolerance = .1\n", 11,
          "not allowed");
    fails(HEAD BODY "[initial]\ntable = t\nunit = m\n", 10, "only dynamic scenes begin somewhere");
    fails(HEAD BODY "[output]\ninterval = .1\n", 10, "a quasi-static scene has no time: use frames");
    fails(HEAD BODY "[output]\nenergy = /etc/passwd\n", 10,
          "is none of no, yes"); /* no scene names an output */
}

TEST(wrong_files)
{
    const char *const files[][2] = {{folder, "is a folder"}, {"/dev/zero", "is a device"}};
    for (int i = 0; i < 2; i++) {
        FREED_BY(scene_free) struct scene scene = {0};
        FAILS(scene_read(files[i][0], &scene, &error), STATUS_INPUT, files[i][1]);
    }
}

static int make_folder(void **state)
{
    (void)state;
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/a.scene", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    unlink(path);
    return rmdir(folder);
}

RUN_TESTS(make_folder, remove_folder)
