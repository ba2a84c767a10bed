/* NRRD and MetaImage: places, values and vectors are what the header says, and files that are not what they
 * say are refused in one line. */
#include "image_fixture.h"

static void accepted(const char *text)
{
    if (read_bytes(text, strlen(text)) != STATUS_OK) {
        fail_msg("%s: %s", text, said.text);
    }
}

#define SHORTS "NRRD0005\n# a comment\ntype: short\n"
#define NRRD SHORTS "encoding: ascii\n"
#define SIZES "dimension: 3\nsizes: 2 1 2\n"
#define NRRD3 NRRD SIZES "kinds: domain domain domain\n"
#define LONG "a name of 32 bytes, four times it"
#define MHA "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementType = MET_SHORT\nBinaryData = False\n"
#define MHA_END "ElementDataFile = LOCAL\n1 -2 3 4"
#define V "\n1 -2\n3 4\n"
#define TURNED "space directions: (0,-2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,30)\n"

TEST(places)
{
    static const struct {
        const char *text;
        double to_world[12]; /* mm */
    } cases[] = {
        {NRRD3 "space: left-posterior-superior\n" TURNED V, {0, -3, 0, -10, 2, 0, 0, -20, 0, 0, 4, 30}},
        {NRRD3 "Space: LPS\r\n" TURNED "a:=b: 1\r\n\r" V, {0, -3, 0, -10, 2, 0, 0, -20, 0, 0, 4, 30}},
        {NRRD3 "space: las\nspace units: \"cm\" \"mm\" \"m\"\n" TURNED V,
         {0, -30, 0, -100, -2, 0, 0, 20, 0, 0, 4000, 30000}},
        {NRRD3 "space: RAS\n" TURNED V, {0, 3, 0, 10, -2, 0, 0, 20, 0, 0, 4, 30}},
        {NRRD3 "space dimension: 3\n" TURNED V, {0, 3, 0, 10, -2, 0, 0, 20, 0, 0, 4, 30}},
        {NRRD3 "spacings: 2 3 4\nunits: \"mm\" \"\" \"cm\"\naxis mins: 5 6 7\n" V,
         {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 40, 70}},
        {NRRD "dimension: 2\nsizes: 2 2\nspace: LPS\nspace directions: (2,0,0) (0,0,-3)\nspace origin: "
              "(1,2,3)\n" V,
         {-2, 0, 0, -1, 0, 0, -2, -2, 0, -3, 0, 3}},
        {MHA "Offset = 10 20 30\nElementSpacing = 2 3 4\nTransformMatrix = 0 -1 0 1 0 0 0 0 1\n" MHA_END,
         {0, -3, 0, -10, 2, 0, 0, -20, 0, 0, 4, 30}},
        {MHA "Position = 10 20 30\nElementSize = 2 3 4\nORIENTATION = 0 -1 0 1 0 0 0 0 1\n" MHA_END,
         {0, -3, 0, -10, 2, 0, 0, -20, 0, 0, 4, 30}},
        {"NDims = 2\nDimSize = 2 2\nElementType = MET_LONG\nBinaryData = 0\nElementSpacing = 2 3\nOrigin = 1 "
         "2\n" MHA_END,
         {-2, 0, 0, -1, 0, -3, 0, -2, 0, 0, 2, 0}},
    };
    static const double values[4] = {1, -2, 3, 4};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        bool known = strcasestr(cases[c].text, "space: ") != NULL || strstr(cases[c].text, "NDims") != NULL;
        accepted(cases[c].text);
        for (int i = 0; i < 12; i++) {
            NEAR_TO(1e3 * image.to_world[i / 4][i % 4], cases[c].to_world[i], 1e-9);
        }
        assert_memory_equal(image.values, values, sizeof values);
        assert_true(image.slope == 1 && image.inter == 0);
        assert_int_equal(strstr(image.note, "taken to be RAS") == NULL, known);
        assert_int_equal(image.space, known ? IMAGE_SPACE_SCANNER : IMAGE_SPACE_UNKNOWN);
        image_free(&image);
    }
}

/* What the header leaves open, or spells otherwise, is noted. */
TEST(notes)
{
    static const char *const cases[][2] = {
        {NRRD3
         "space: LPS\nspace orign: (1,2,3)\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nmin: 1\nmin: 1\n" V,
         "has no space origin: the first voxel lies at 0; fields that are not known, left out: space "
         "orign"},
        {MHA "ElementSpacing = 1 1 1\nColor = 1 0 0 1\nOfset = 1 2 3\nElementSizes = 1 1 1\n" MHA_END,
         "has no Offset: the first voxel lies at 0; fields that are not known, left out: Ofset, "
         "ElementSizes"},
        {MHA "ElementSpacing = 1 1 1 9\nOffset = 1 2 3\n" MHA_END, ""},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        accepted(cases[c][0]);
        assert_string_equal(image.note, cases[c][1]);
        image_free(&image);
    }
}

/* Vectors of a space turn with it, lists do not; components may be the first dimension or the last. */
TEST(vectors)
{
    static const struct {
        const char *kinds, *space;
        double values[6];
        bool vector;
    } cases[] = {
        {"kinds: vector domain domain domain\n", "LPS", {1, 2, 3, 4, 5, 6}, true},
        {"kinds: 3-vector domain domain domain\n", "RAS", {-1, -2, 3, -4, -5, 6}, true},
        {"kinds: covariant-vector space space space\n", "LAS", {1, -2, 3, 4, -5, 6}, true},
        {"kinds: list domain domain domain\n", "RAS", {1, 2, 3, 4, 5, 6}, false},
        {"", "RAS", {1, 2, 3, 4, 5, 6}, false},
        {"kinds: domain domain domain list\n", "RAS", {1, 3, 5, 2, 4, 6}, false},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        char text[512];
        bool last = strstr(cases[c].kinds, "domain list") != NULL;
        snprintf(text, sizeof text,
                 NRRD "dimension: 4\nsizes: %s\n%sspace: %s\nspace directions: %s(1,0,0) (0,1,0) "
                      "(0,0,1)%s\n\n1 2 3 4 5 6",
                 last ? "2 1 1 3" : "3 2 1 1", cases[c].kinds, cases[c].space, last ? "" : "none ",
                 last ? " none" : "");
        accepted(text);
        assert_int_equal(image.components, 3);
        assert_int_equal(image.intent, cases[c].vector ? IMAGE_INTENT_VECTOR : 0);
        assert_memory_equal(image.values, cases[c].values, sizeof cases[c].values);
        image_free(&image);
    }
}

TEST(headers_that_lie)
{
    static const char *const cases[][2] = {
        {NRRD3 "\n1 2 3", "cut short: 3 values, the header says 4"},
        {NRRD3 "\n1 2 3 4 5", "more data than 4 values"},
        {NRRD3 "\n1 2 3 4e9", "value 3, '4e9': not of the type int16"},
        {NRRD3, "ends without an empty line"},
        {"NRRD0009\n\n", "NRRD0001 to NRRD0006"},
        {SHORTS "encoding: bzip2\n\n1", "encoding: bzip2: one of these is read: raw gzip|gz ascii|text|txt"},
        {SHORTS SIZES "encoding: raw\n\n1", "no endian"},
        {SHORTS SIZES "encoding: gzip\nendian: little\nbyte skip: -1\n\n",
         "a skip of -1 goes with raw data only"},
        {NRRD3 "byte skip: 99\n\n1 2 3 4", "cut short"},
        {NRRD "dimension: 3\nsizes: 2 0 2\n\n", "size 0"},
        {NRRD "dimension: 3\nsizes: 2 1e8 1e8\n\n", "cut short"},
        {NRRD "dimension: 3\nsizes: 2e9 2e9 2e9\n\n", "more than any memory"},
        {"NRRD0005\nsizes: 2 1 2\n\n", "stands in front of the number of dimensions"},
        {NRRD3 "space: left-posterior-superior-time\n\n", "choose one volume"},
        {NRRD3 TURNED "\n", "space directions"},
        {NRRD3 "space: LPS\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n\n1 2 3 4",
         "space directions gives the voxels no place"},
        {NRRD3 "space: LPS\nspace units: \"mm\" \"mm\" \"ell\"\n\n", "are read"},
        {NRRD "dimension: 4\nsizes: 2 1 2 2\nkinds: domain domain domain domain\n\n1", "dimension 4: "},
        {NRRD SIZES "kinds: domain list domain\n\n", "dimension 2 holds the values"},
        {NRRD SIZES "kinds: vector list domain\n\n", "dimension 2: two or three"},
        {NRRD3 "data file: data.raw\n\n", "give its name, which ends in .nhdr or .mhd"},
        {NRRD3 "Segment0_Name:=" LONG LONG LONG LONG "\n\n", "a name of more than 127 bytes"},
        {NRRD3 "nonsense\n\n", "'nonsense': no ':' behind a key"},
        {MHA, "ends without ElementDataFile"},
        {MHA "ElementDataFile = LIST\na\nb\n", "several files"},
        {MHA "ElementType = MET_STRING\n" MHA_END, "ElementType= MET_STRING: integers"},
        {MHA "CompressedData = True\nHeaderSize = -1\n" MHA_END, "a skip of -1 goes with raw data only"},
        {NRRD3 "sizes: 2 2 1\n" V, "sizes: 2 2 1: stands twice"},
        {MHA "DimSize = 2 2 1\n" MHA_END, "DimSize= 2 2 1: stands twice"},
        {MHA "BinaryDataByteOrderMSB = True\nElementByteOrderMSB = False\n" MHA_END, "contradict"},
        {MHA "DistanceUnits = cm\n" MHA_END, "one of these is read: mm"},
        {MHA "CompressedData = perhaps\n" MHA_END, "True or False"},
        {MHA "ElementNumberOfChannels = 0\n" MHA_END, "from 1 to"},
        {"ObjectType = Mesh\n", "one of these is read: Image"},
        {"NDims = 3\nElementDataFile = LOCAL\n1", "no ElementType"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        if (read_bytes(cases[c][0], strlen(cases[c][0])) == STATUS_OK ||
            strstr(said.text, cases[c][1]) == NULL) {
            fail_msg("'%s' instead of '%s'", said.text, cases[c][1]);
        }
    }
}

RUN_TESTS(NULL, NULL)
