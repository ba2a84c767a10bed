/* NRRD and MetaImage: places, values and vectors are what the header says, all formats hold the same image,
 * and files that are not what they say are refused in one line. */
#include "unit.h"

#include "io/image/image.h"

#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

static struct image image;
static struct error said;

static enum status read_bytes(const void *bytes, size_t size, const char *name)
{
    int descriptor = memfd_create("image", 0);
    assert_int_equal(write(descriptor, bytes, size), size);
    assert_int_equal(lseek(descriptor, 0, SEEK_SET), 0);
    enum status status = image_read_from(&image, descriptor, name, &said);
    close(descriptor);
    assert_true(status == STATUS_OK || (status == STATUS_INPUT && image.values == NULL));
    return status;
}

static void accepted(const char *text)
{
    if (read_bytes(text, strlen(text), "file") != STATUS_OK) {
        fail_msg("%s: %s", text, said.text);
    }
}

static void refused(const char *text, const char *why)
{
    if (read_bytes(text, strlen(text), "file") == STATUS_OK || strstr(said.text, why) == NULL) {
        fail_msg("'%s' instead of '%s'", said.text, why);
    }
}

#define NRRD "NRRD0005\n# a comment\ntype: short\nencoding: ascii\n"
#define NRRD3 NRRD "dimension: 3\nsizes: 2 1 2\nkinds: domain domain domain\n"
#define MHA "ObjectType = Image\nNDims = 3\nDimSize = 2 1 2\nElementType = MET_SHORT\nBinaryData = False\n"
#define MHA_END "ElementDataFile = LOCAL\n1 -2 3 4"
#define TURNED "space directions: (0,-2,0) (3,0,0) (0,0,4)\nspace origin: (10,20,30)\n"

TEST(places)
{
    static const struct {
        const char *text;
        double to_world[3][4]; /* mm */
        const char *note;
    } cases[] = {
        {NRRD3 "space: left-posterior-superior\n" TURNED "\n1 -2\n3 4\n",
         {{0, -3, 0, -10}, {2, 0, 0, -20}, {0, 0, 4, 30}},
         ""},
        {NRRD3 "Space: LPS\r\n" TURNED "key:=value: 1\r\n\r\n1 -2\r\n3 4\r\n",
         {{0, -3, 0, -10}, {2, 0, 0, -20}, {0, 0, 4, 30}},
         ""},
        {NRRD3 "space: las\nspace units: \"cm\" \"mm\" \"m\"\n" TURNED "\n1 -2 3 4",
         {{0, -30, 0, -100}, {-2, 0, 0, 20}, {0, 0, 4000, 30000}},
         ""},
        {NRRD3 "space: RAS\n" TURNED "\n1 -2 3 4", {{0, 3, 0, 10}, {-2, 0, 0, 20}, {0, 0, 4, 30}}, ""},
        {NRRD3 "space dimension: 3\n" TURNED "\n1 -2 3 4",
         {{0, 3, 0, 10}, {-2, 0, 0, 20}, {0, 0, 4, 30}},
         "taken to be RAS"},
        {NRRD3
         "spacings: 2 3 4\nunits: \"mm\" \"mm\" \"cm\"\naxis mins: 5 6 nan\naxis mins: 5 6 7\n\n1 -2 3 4",
         {{2, 0, 0, 5}, {0, 3, 0, 6}, {0, 0, 40, 70}},
         "taken to be RAS"},
        {NRRD "dimension: 2\nsizes: 2 2\nspace: LPS\nspace directions: (2,0,0) (0,0,-3)\nspace origin: "
              "(1,2,3)\n\n1 -2 3 4",
         {{-2, 0, 0, -1}, {0, 0, -2, -2}, {0, -3, 0, 3}},
         ""},
        {MHA "Offset = 10 20 30\nElementSpacing = 2 3 4\nTransformMatrix = 0 -1 0 1 0 0 0 0 1\n" MHA_END,
         {{0, -3, 0, -10}, {2, 0, 0, -20}, {0, 0, 4, 30}},
         ""},
        {MHA "Position = 10 20 30\nElementSize = 2 3 4\nORIENTATION = 0 -1 0 1 0 0 0 0 "
             "1\nAnatomicalOrientation = RAI\n" MHA_END,
         {{0, -3, 0, -10}, {2, 0, 0, -20}, {0, 0, 4, 30}},
         ""},
        {"NDims = 2\nDimSize = 2 2\nElementType = MET_LONG\nBinaryData = False\nElementSpacing = 2 3\nOrigin "
         "= 1 2\n" MHA_END,
         {{-2, 0, 0, -1}, {0, -3, 0, -2}, {0, 0, 2, 0}},
         ""},
    };
    static const double values[4] = {1, -2, 3, 4};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        accepted(cases[c].text);
        for (int i = 0; i < 12; i++) {
            NEAR_TO(1e3 * image.to_world[i / 4][i % 4], cases[c].to_world[i / 4][i % 4], 1e-9);
        }
        assert_memory_equal(image.values, values, sizeof values);
        assert_true(image.slope == 1 && image.inter == 0);
        assert_true(cases[c].note[0] == '\0' ? image.note[0] == '\0'
                                             : strstr(image.note, cases[c].note) != NULL);
        assert_int_equal(image.space, cases[c].note[0] == '\0' ? IMAGE_SPACE_SCANNER : IMAGE_SPACE_UNKNOWN);
        image_free(&image);
    }
}

/* Vectors of a space turn with it, lists do not; components may be the first dimension or the last. */
TEST(vectors)
{
    static const struct {
        const char *text;
        double values[6];
        int intent;
    } cases[] = {
        {"sizes: 3 2 1 1\nkinds: vector domain domain domain\nspace: LPS\n",
         {1, 2, 3, 4, 5, 6},
         IMAGE_INTENT_VECTOR},
        {"sizes: 3 2 1 1\nkinds: 3-vector domain domain domain\nspace: RAS\n",
         {-1, -2, 3, -4, -5, 6},
         IMAGE_INTENT_VECTOR},
        {"sizes: 3 2 1 1\nkinds: covariant-vector space space space\nspace: LAS\n",
         {1, -2, 3, 4, -5, 6},
         IMAGE_INTENT_VECTOR},
        {"sizes: 3 2 1 1\nkinds: list domain domain domain\nspace: RAS\n", {1, 2, 3, 4, 5, 6}, 0},
        {"sizes: 3 2 1 1\nspace: RAS\n", {1, 2, 3, 4, 5, 6}, 0},
        {"sizes: 2 1 1 3\nkinds: domain domain domain list\nspace: RAS\n", {1, 3, 5, 2, 4, 6}, 0},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        char text[512];
        bool last = strstr(cases[c].text, "domain list") != NULL;
        snprintf(text, sizeof text,
                 NRRD "dimension: 4\n%sspace directions: %s(1,0,0) (0,1,0) (0,0,1)%s\n\n1 2 3 4 5 6",
                 cases[c].text, last ? "" : "none ", last ? " none" : "");
        accepted(text);
        assert_int_equal(image.components, 3);
        assert_int_equal(image.intent, cases[c].intent);
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
        {NRRD3 "\n1 2 x 4", "value 2, 'x'"},
        {NRRD3, "ends without an empty line"},
        {"NRRD0009\n\n", "NRRD0001 to NRRD0006"},
        {NRRD3 "encoding: bzip2\n\n1", "encoding: bzip2: raw, gzip and ascii are read"},
        {NRRD3 "encoding: raw\n\n1", "no endian"},
        {NRRD3 "encoding: gzip\nendian: little\nbyte skip: -1\n\n", "a skip of -1 goes with raw data only"},
        {NRRD3 "byte skip: -2\n\n", "byte skip: -2: from -1"},
        {NRRD3 "byte skip: 99\n\n1 2 3 4", "cut short"},
        {NRRD3 "sizes: 2 0 2\n\n", "size 0"},
        {NRRD3 "sizes: 2 1e8 1e8\n\n", "cut short"},
        {NRRD3 "sizes: 2e9 2e9 2e9\n\n", "more than any memory"},
        {NRRD3 "sizes: 2 1\n\n", "sizes: 2 1: a finite number for each dimension"},
        {"NRRD0005\nsizes: 2 1 2\n\n", "stands in front of the number of dimensions"},
        {NRRD3 "space: left-posterior-superior-time\n\n", "choose one volume"},
        {NRRD3 "space: above\n\n", "space: above: "},
        {NRRD3 TURNED "\n", "space directions"},
        {NRRD3 "space: LPS\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n\n1 2 3 4",
         "space directions gives the voxels no place"},
        {NRRD3 "space: LPS\nspace units: \"mm\" \"mm\" \"ell\"\n\n", "are read"},
        {NRRD3 "kinds: domain domain time\n\n", "choose one volume"},
        {NRRD3 "dimension: 4\nsizes: 2 1 2 2\nkinds: domain domain domain domain\n\n1", "dimension 4: "},
        {NRRD3 "kinds: domain list domain\n\n", "dimension 2 holds the values"},
        {NRRD3 "kinds: vector list domain\n\n", "dimension 2: two or three"},
        {NRRD3 "data file: data.raw\n\n", "give its name, which ends in .nhdr or .mhd"},
        {NRRD3 "nonsense\n\n", "'nonsense': no ':' behind a key"},
        {MHA, "ends without ElementDataFile"},
        {MHA "ElementDataFile = LOCAL\n1 2 3", "cut short: 3 values"},
        {MHA "ElementDataFile = LIST\na\nb\n", "several files"},
        {MHA "ElementType = MET_STRING\n" MHA_END, "ElementType= MET_STRING: integers"},
        {MHA "CompressedData = True\nHeaderSize = -1\n" MHA_END, "a skip of -1 goes with raw data only"},
        {MHA "CompressedData = perhaps\n" MHA_END, "True or False"},
        {MHA "ElementNumberOfChannels = 0\n" MHA_END, "from 1 to"},
        {MHA "ElementSpacing = 1 0 1\n" MHA_END, "no place"},
        {"ObjectType = Mesh\n", "not an image"},
        {"NDims = 3\nElementDataFile = LOCAL\n1", "no ElementType"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        refused(cases[c][0], cases[c][1]);
    }
}

/* Write an image, with its bytes, and read it back. */
static void write_and_read(const struct image *written, enum image_format format, unsigned char *bytes,
                           size_t *size)
{
    int descriptor = memfd_create("image", 0);
    GOOD(image_write(written, descriptor, format, &error));
    *size = (size_t)lseek(descriptor, 0, SEEK_CUR);
    assert_int_equal(pread(descriptor, bytes, *size, 0), *size);
    close(descriptor);
    assert_int_equal(read_bytes(bytes, *size, "file"), STATUS_OK);
}

TEST(round_trips)
{
    static const int types[] = {2, 4, 8, 16, 64, 128, 256, 512, 768, 1024, 1280, 2304};
    static unsigned char bytes[1 << 14];
    size_t size, sizes[3] = {3, 4, 1};
    for (int c = 0; c < 12 * 3; c++) {
        FREED_BY(image_free) struct image first = {0};
        size_t components = types[c / 3] == 128    ? 3
                            : types[c / 3] == 2304 ? 4
                            : c % 3 == 0 || c < 3  ? 1
                                                   : 3; /* three bytes are a colour in MetaImage */
        sizes[2] = c % 2 ? 1 : 5;
        GOOD(image_new(&first, sizes, components, &error));
        first.datatype = types[c / 3];
        first.space = IMAGE_SPACE_SCANNER;
        first.intent =
            components > 1 && c % 3 == 1 && components == 3 && types[c / 3] != 128 ? IMAGE_INTENT_VECTOR : 0;
        strcpy(first.description, "of a test");
        static const double turned[3][4] = {{-6e-4, 8e-4, 1e-4, 1}, {8e-4, 6e-4, 0, 2}, {0, 0, 2e-3, -3}};
        memcpy(first.to_world, turned, sizeof turned);
        for (size_t v = 0; v < image_voxels(&first) * components; v++) {
            first.values[v] = (double)(v * 37 % 128);
        }
        for (int f = 0; f < 2; f++) {
            write_and_read(&first, f ? IMAGE_METAIMAGE : IMAGE_NRRD, bytes, &size);
            assert_int_equal(image.format, f ? IMAGE_METAIMAGE : IMAGE_NRRD);
            assert_memory_equal(image.size, first.size, sizeof sizes);
            assert_int_equal(image.components, components);
            assert_int_equal(image.datatype, first.datatype);
            assert_true(image.intent == first.intent || f == 1);
            assert_string_equal(image.description, first.description);
            assert_memory_equal(image.values, first.values,
                                image_voxels(&first) * components * sizeof(double));
            ALL_NEAR(12, &image.to_world[0][0], &turned[0][0], 1e-14);
            image_free(&image);
            for (size_t cut = 0; cut < size && c < 2; cut++) { /* no part passes for the whole */
                assert_int_equal(read_bytes(bytes, cut, "file"), STATUS_INPUT);
            }
        }
    }
}

/* What no header of text can say is in the values: a scaling makes them real. */
TEST(scaled_values_become_real)
{
    static unsigned char bytes[1 << 12];
    size_t size;
    FREED_BY(image_free) struct image first = {0};
    GOOD(image_new(&first, (const size_t[3]){2, 1, 1}, 1, &error));
    first.datatype = IMAGE_INT16;
    first.slope = 0.25;
    first.inter = 3;
    first.values[1] = 5.75;
    write_and_read(&first, IMAGE_METAIMAGE, bytes, &size);
    assert_int_equal(image.datatype, IMAGE_FLOAT32);
    NEAR_TO(image.values[1], 5.75, 0);
    NEAR_TO(image.slope, 1, 0);
    image_free(&image);
}

static void put_file(const char *name, const void *bytes, size_t size)
{
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Data beside the header: lines and bytes in front of them, the last bytes; not outside. */
TEST(files_of_data)
{
    char folder[] = "/tmp/image_text.XXXXXX", path[64];
    static const char *const heads[][2] = {
        {"raw", "type: uint8\nencoding: raw\ndata file: "},
        {"skip", "type: uint8\nencoding: raw\nline skip: 2\nbyte skip: 1\ndatafile: "},
        {"skip", "type: uint8\nencoding: raw\nbyte skip: -1\ndatafile: ./"}};
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    put_file("raw", "\1\2\3\4", 4);
    put_file("skip", "a\nb\n-\1\2\3\4", 9);
    snprintf(path, sizeof path, "%s/x.nhdr", folder);
    for (int h = 0; h < 3; h++) {
        char text[256];
        snprintf(text, sizeof text, "NRRD0005\ndimension: 2\nsizes: 2 2\n%s%s\n", heads[h][1], heads[h][0]);
        assert_int_equal(chdir("/"), 0);
        if (read_bytes(text, strlen(text), path) != STATUS_OK) {
            fail_msg("%s", said.text);
        }
        NEAR_TO(image.values[3], 4, 0);
        image_free(&image);
    }
    static const char *const outside[] = {"/etc/passwd", "../raw", "a/../../raw", "..", "", "%d.raw"};
    for (size_t o = 0; o < sizeof outside / sizeof *outside; o++) {
        char text[256];
        snprintf(text, sizeof text,
                 "NDims = 2\nDimSize = 2 2\nElementType = MET_UCHAR\nElementDataFile = %s\n", outside[o]);
        assert_int_equal(read_bytes(text, strlen(text), path), STATUS_INPUT);
        assert_non_null(
            strstr(said.text, o < 5 ? "not a file in the folder of the header" : "several files"));
    }
    assert_int_equal(chdir(folder), 0);
    assert_int_equal(unlink("raw") + unlink("skip"), 0);
    assert_int_equal(rmdir(folder), 0);
}

RUN_TESTS(NULL, NULL)
