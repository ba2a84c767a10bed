/* Tables and rigid surfaces: what is read is what was written, and one clear error for each fault. */
#include "unit.h"

#include "io/files/surface.h"
#include "io/files/table.h"

#include <float.h>
#include <stdio.h>
#include <unistd.h>

static char folder[] = "/tmp/table-XXXXXX";
static char path[64];     /* a text file */
static char stl_path[64]; /* one with the ending .stl */

static void write_to(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(name, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

TEST(round_trip)
{
    static const double values[] = {0.1, -DBL_MAX, 5e-324, 1.0 / 3.0, 69.1628, -0.0};
    char text[512] = "# heading, with a comma\n";
    FREED_BY(table_free) struct table table = {0};
    for (int i = 0; i < 6; i += 2) {
        size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, "\t%.17g  %.17g\t# row\n", values[i], values[i + 1]);
    }
    write_to(path, text, strlen(text));
    GOOD(table_read(path, 2, 4, &table, &error));
    assert_int_equal(table.rows, 3);
    assert_int_equal(table.cols, 2);
    assert_memory_equal(table.values, values, sizeof values);
    assert_int_equal(table.line[2], 4);
    assert_int_equal(table.block_count, 1);
    assert_int_equal(table.block_ptr[1], 3);
}

TEST(blocks)
{
    static const char text[] = "\n\n1 2\n# not a separator\n3 4\n \t \n\n5 6\n7 8\n9 10\n\n";
    static const int64_t expected[] = {0, 2, 5};
    FREED_BY(table_free) struct table table = {0};
    write_to(path, text, strlen(text));
    GOOD(table_read(path, 2, 2, &table, &error));
    assert_int_equal(table.rows, 5);
    assert_int_equal(table.block_count, 2);
    assert_memory_equal(table.block_ptr, expected, sizeof expected);
}

/* dim = 0: as a table of 2 to 4 columns, else as a surface. */
static void fails_in(const char *name, int dim, const void *bytes, size_t size, int line, const char *words)
{
    FREED_BY(table_free) struct table table = {0};
    struct error error = {""};
    char where[96];
    write_to(name, bytes, size);
    enum status status =
        dim == 0 ? table_read(name, 2, 4, &table, &error) : surface_read(name, dim, &table, &error);
    snprintf(where, sizeof where, line > 0 ? "%s:%d: " : "%s: ", name, line);
    if (status != STATUS_INPUT || strncmp(error.text, where, strlen(where)) != 0 ||
        strstr(error.text, words) == NULL) {
        fail_msg("status %d, message \"%s\" is not \"%s ... %s\"", (int)status, error.text, where, words);
    }
}

static void fails(const char *text, int line, const char *words)
{
    fails_in(path, 0, text, strlen(text), line, words);
}

TEST(faults)
{
    fails("1 2\n3 x\n", 2, "column 2: 'x' is not a finite number");
    fails("1,5 2\n", 1, "'1,5' is not a finite number: write decimal points, and blanks");
    fails("1;2\n", 1, "blanks between numbers");
    fails("1 2\n# c\n3 nan\n", 3, "'nan' is not a finite number");
    fails("1 -inf\n", 1, "'-inf' is not a finite number");
    fails("1 2#3\n", 1, "'2#3' is not a finite number");
    fails("1 2\n1 2 3\n", 2, "has 3 columns, the rows before 2");
    fails("1 2 3\n1 2\n", 2, "has 2 columns, the rows before 3");
    fails("1\n", 1, "has 1 columns, not 2 to 4");
    fails("1 2 3 4 5\n", 1, "has 5 columns, not 2 to 4");
    fails("1 2\r\n", 1, "carriage return");
    fails("\xef\xbb\xbf"
          "1 2\n",
          1, "byte order mark");
    fails("1 2\n3 4", 2, "last line without newline: truncated?");
    fails("", 0, "is empty");
    fails("# only a comment\n\n", 0, "holds no row of numbers");
    fails_in(path, 0, "1 2\n3\0 4\n", 9, 2, "control character 0x00");
    char wide[256] = "";
    for (int i = 0; i < 70; i++) {
        strcat(wide, "1 ");
    }
    strcat(wide, "\n");
    fails(wide, 1, "more than 64 columns");
    memset(wide, '1', 100);
    memcpy(wide + 100, " 2\n", 4);
    fails(wide, 1, "is not a finite number");

    struct table table;
    FAILS(table_read(folder, 1, 2, &table, &error), STATUS_INPUT, "is a folder");
    FAILS_WITH(table_read("/nonexistent", 1, 2, &table, &error), STATUS_INPUT,
               "/nonexistent: No such file or directory");
}

#define POINT(x, more) "{\"label\": \"a\\u00e4\\\"\", \"position\": [" x ", -2, 3e0]" more "}"
#define MARKUP(points, more)                                                                                 \
    "{\"a\": [1, {\"b\": [true, null]}],\n\"markups\": [{\"controlPoints\": [" points "]" more "}]}"

static const char *name_of(const char *text)
{
    static char name[80];
    snprintf(name, sizeof name, "%s%s", path, text[0] == '{' ? ".mrk.json" : ".fcsv");
    write_to(name, text, strlen(text));
    return name;
}

/* Landmarks are rows in RAS, mm, with names. */
TEST(landmarks)
{
    static const struct {
        const char *text, *label;
        double sign;
    } good[] = {
        {MARKUP(POINT("1", ""), ""), "a\xc3\xa4\"", -1},
        {MARKUP(POINT("1", ""), ", \"coordinateSystem\": \"RAS\", \"coordinateUnits\": \"mm\"") "\n",
         "a\xc3\xa4\"", 1},
        {"# CoordinateSystem = 0\n1,1,-2,3,0,0,0,1,1,1,0,\"b, c\",,\n", "b, c", 1},
        {"# CoordinateSystem = LPS\r\n# columns = label,z,y,x\r\nb,3,-2,1\r\n", "b", -1},
    };
    static const struct {
        const char *text, *words;
        int line;
    } bad[] = {
        {MARKUP(POINT("1", ", \"positionStatus\": \"undefined\""), ""), "without a position", 2},
        {MARKUP(POINT("1, 2", ""), ""), "without a position", 2},
        {MARKUP(POINT("1e999", ""), ""), "a finite number is expected", 2},
        {MARKUP("", ", \"coordinateSystem\": \"IJK\""), "neither LPS nor RAS", 2},
        {MARKUP("", ", \"coordinateUnits\": \"cm\""), "is not mm", 2},
        {MARKUP("", "") "x", "more behind the value", 2},
        {MARKUP("", ""), "holds no point", 0},
        {"{\"a\": nil}", "neither true, false nor null", 1},
        {"{\"a\" 1}", "':' is expected", 1},
        {"{\"\\x\": 1}", "unknown escape", 1},
        {"1,1,-2,3\n2,1,x,3\n", "y: 'x'", 2},
        {"# columns = x,y\n1,2\n", "no column z", 2},
        {"# CoordinateSystem = 2\n", "neither RAS nor LPS", 1},
        {"1,1,-2,3", "without newline", 1},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        FREED_BY(table_free) struct table table = {0};
        const double x[3] = {good[i].sign, -2 * good[i].sign, 3};
        const char *name = name_of(good[i].text);
        GOOD(table_read(name, 2, 3, &table, &error));
        ALL_NEAR(3, table.values, x, 0);
        assert_string_equal(table.label[0], good[i].label);
        NEAR_TO(table_unit(name, 1), 1e-3, 0);
        for (size_t cut = 0; i == 0 && cut < strlen(good[i].text); cut++) {
            FREED_BY(table_free) struct table part = {0};
            write_to(name, good[i].text, cut);
            FAILS(table_read(name, 2, 3, &part, &error), STATUS_INPUT, "");
        }
        assert_int_equal(unlink(name), 0);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const char *name = name_of(bad[i].text);
        fails_in(name, 0, bad[i].text, strlen(bad[i].text), bad[i].line, bad[i].words);
        assert_int_equal(unlink(name), 0);
    }
}

#define FACET                                                                                                \
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 .5\n  vertex 1 0 .5\n  vertex 0 1e0 .5\n "                \
    "endloop\nendfacet\n"

static const double triangle[9] = {0, 0, .5, 1, 0, .5, 0, 1, .5};

static void put_float(unsigned char *at, double value)
{
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    for (int i = 0; i < 4; i++) {
        at[i] = (unsigned char)(bits >> 8 * i);
    }
}

/* A table of 9 columns, an ASCII and a binary STL of one triangle hold the same. */
TEST(triangles)
{
    static const char text[] = "0 0 .5  1 0 .5  0 1 .5\n";
    static const char ascii[] = "solid a name\n" FACET "endsolid a name\n";
    unsigned char binary[84 + 50] = "solid is what some binary files begin with";
    binary[80] = 1;
    for (int i = 0; i < 9; i++) {
        put_float(binary + 84 + 12 + 4 * i, triangle[i]);
    }
    write_to(path, text, strlen(text));
    for (int form = 0; form < 3; form++) {
        FREED_BY(table_free) struct table table = {0};
        if (form > 0) {
            write_to(stl_path, form == 1 ? (const void *)ascii : binary,
                     form == 1 ? strlen(ascii) : sizeof binary);
        }
        GOOD(surface_read(form == 0 ? path : stl_path, 3, &table, &error));
        assert_int_equal(table.rows, 1);
        assert_int_equal(table.cols, 9);
        assert_memory_equal(table.values, triangle, sizeof triangle);
        assert_int_equal(table.block_count, 1);
    }

    fails_in(path, 3, "0 0 0 1 1 1 2 2 2\n", 18, 1, "triangle without area");
    fails_in(stl_path, 3, binary, sizeof binary - 1, 1, "truncated?"); /* begins with solid */
    binary[0] = 'x';
    fails_in(stl_path, 3, binary, sizeof binary - 1, 0, "neither ASCII STL");
    put_float(binary + 84 + 12, (double)FLT_MAX * 4);
    fails_in(stl_path, 3, binary, sizeof binary, 0, "triangle 1: coordinate that is not finite");
    memset(binary + 80, 0, 4);
    fails_in(stl_path, 3, binary, 84, 0, "holds no triangle");
    for (size_t size = 0; size < strlen(ascii) - 8;
         size++) { /* only the solid's closing name may go missing */
        FREED_BY(table_free) struct table table = {0};
        write_to(stl_path, ascii, size);
        FAILS(surface_read(stl_path, 3, &table, &error), STATUS_INPUT, "");
    }
    static const char behind[] = "solid\n" FACET "endsolid\n" FACET;
    fails_in(stl_path, 3, behind, strlen(behind), 10, "'facet' stands outside of 'solid'");
    static const char comma[] = "solid\nfacet normal 0 0 1\nouter loop\nvertex 1,0\n";
    fails_in(stl_path, 3, comma, strlen(comma), 4, "'1,0' is not a finite number");
}

/* As other programs write them: several solids, CRLF, capitals, normals that are not a number, an open end.
 */
TEST(solids)
{
    static const char text[] =
        "SOLID facet\r\n Facet Normal nan nan nan\r\n OUTER LOOP\r\n VERTEX 0 0 .5\r\nVERTEX 1 "
        "0 .5\r\nVERTEX 0 1 .5\r\nENDLOOP ENDFACET\r\nENDSOLID facet\r\nsolid\n" FACET "endsolid";
    FREED_BY(table_free) struct table table = {0};
    write_to(stl_path, text, strlen(text));
    GOOD(surface_read(stl_path, 3, &table, &error));
    assert_int_equal(table.rows, 2);
    assert_memory_equal(table.values, triangle, sizeof triangle);
    assert_memory_equal(table.values + 9, triangle, sizeof triangle);
}

static int make_folder(void **state)
{
    (void)state;
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/a.tsv", folder);
    snprintf(stl_path, sizeof stl_path, "%s/a.STL", folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    unlink(path);
    unlink(stl_path);
    return rmdir(folder);
}

RUN_TESTS(make_folder, remove_folder)
