/* Images: every type, version and byte order is read as the standard says, written files are read back the
 * same, and files that are not what they say are refused in one line. */
#include "image_fixture.h"

#include <zlib.h>

static struct nifti_file file;
static void refused(const char *text)
{
    assert_int_equal(read_bytes(file.bytes, file.size), STATUS_INPUT);
    if (strstr(said.text, text) == NULL) {
        fail_msg("'%s' instead of '%s'", said.text, text);
    }
}

static void accepted(void)
{
    if (read_bytes(file.bytes, file.size) != STATUS_OK) {
        fail_msg("%s", said.text);
    }
}

/* A file of bytes compressed by zlib. */
static size_t compress_bytes(const unsigned char *bytes, size_t size, unsigned char *to, size_t room)
{
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (unsigned char *)(uintptr_t)bytes;
    stream.avail_in = (unsigned)size;
    stream.next_out = to;
    stream.avail_out = (unsigned)room;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    return room - stream.avail_out;
}

/* Six values as each type stores them, and what they are. */
static const struct kind {
    int code, bytes;
    uint64_t stored[6];
    double value[6];
} kinds[] = {
    {2, 1, {0, 1, 2, 127, 128, 255}, {0, 1, 2, 127, 128, 255}},
    {256, 1, {0, 1, 0xff, 0x7f, 0x80, 3}, {0, 1, -1, 127, -128, 3}},
    {4, 2, {0, 1, 0xffff, 0x7fff, 0x8000, 300}, {0, 1, -1, 32767, -32768, 300}},
    {512, 2, {0, 1, 0xffff, 0x7fff, 0x8000, 300}, {0, 1, 65535, 32767, 32768, 300}},
    {8, 4, {0, 1, 0xffffffff, 0x7fffffff, 0x80000000, 70000}, {0, 1, -1, 2147483647, -2147483648.0, 70000}},
    {768,
     4,
     {0, 1, 0xffffffff, 0x7fffffff, 0x80000000, 7},
     {0, 1, 4294967295.0, 2147483647, 2147483648.0, 7}},
    {1024,
     8,
     {0, 1, ~(uint64_t)0, 1u << 31, (uint64_t)1 << 53, 7},
     {0, 1, -1, 2147483648.0, 9007199254740992.0, 7}},
    {1280, 8, {0, 1, 2, 1u << 31, (uint64_t)1 << 53, 7}, {0, 1, 2, 2147483648.0, 9007199254740992.0, 7}},
    {16,
     4,
     {0, 0x3f800000, 0xbf000000, 0x42f6e979, 1, 0x7f7fffff},
     {0, 1, -0.5, 123.45600128173828, 1.401298464324817e-45, 3.4028234663852886e38}},
    {64,
     8,
     {0, 0x3ff0000000000000, 0xbfe0000000000000, 0x3fb999999999999a, 1, 0x7fefffffffffffff},
     {0, 1, -0.5, 0.1, 5e-324, 1.7976931348623157e308}},
};

static void make_kind(const struct kind *kind, int version, bool big)
{
    begin_nifti(&file, version, big, 3, 2, 1, kind->code, 8 * kind->bytes);
    for (int i = 0; i < 6; i++) {
        append_value(&file, kind->bytes, kind->stored[i]);
    }
}

TEST(types)
{
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        for (int way = 0; way < 8; way++) {
            unsigned char packed[4096];
            make_kind(&kinds[k], 1 + (way & 1), way & 2);
            size_t size = compress_bytes(file.bytes, file.size, packed, sizeof packed);
            assert_int_equal(way & 4 ? read_bytes(packed, size) : read_bytes(file.bytes, file.size),
                             STATUS_OK);
            assert_int_equal(image.size[0], 3);
            assert_int_equal(image.size[1], 2);
            assert_int_equal(image.size[2], 1);
            assert_int_equal(image.components, 1);
            assert_int_equal(image.datatype, kinds[k].code);
            assert_int_equal(image.version, 1 + (way & 1));
            assert_memory_equal(image.values, kinds[k].value, sizeof kinds[k].value);
            image_free(&image);
        }
    }
}

TEST(whole_numbers_beyond_doubles)
{
    make_kind(&kinds[6], 1, false);
    put_number(&file, 352, 8, ((uint64_t)1 << 60) + 1);
    refused("beyond 2^53");
}

TEST(scaling)
{
    make_kind(&kinds[0], 1, true);
    put_scale(&file, 0.5, -10);
    accepted();
    NEAR_TO(image.values[3], 53.5, 0);
    image_free(&image);
    put_scale(&file, 0, 7); /* a slope of 0: no scaling */
    accepted();
    NEAR_TO(image.values[3], 127, 0);
    image_free(&image);
    put_scale(&file, NAN, NAN);
    accepted();
    NEAR_TO(image.values[3], 127, 0);
    image_free(&image);
    put_scale(&file, INFINITY, 0);
    refused("scaling");
}

static void same_space(double expected[3][4])
{
    for (int r = 0; r < 3; r++) {
        ALL_NEAR(4, image.to_world[r], expected[r], 1e-8);
    }
}

/* sform before qform before voxel sizes, and the units. */
TEST(spaces)
{
    double sform[3][4] = {{0, -2, 0, 10}, {0, 0, 3, 20}, {-1, 0, 0, 30}};
    double in_metres[3][4], turned[3][4] = {{0, -2e-3, 0, 4e-3}, {1e-3, 0, 0, 5e-3}, {0, 0, -3e-3, 6e-3}};
    double sizes[3][4] = {{1e-3, 0, 0, 0}, {0, 2e-3, 0, 0}, {0, 0, 3e-3, 0}};
    static const double offset[3] = {4, 5, 6};
    static const double unit[4] = {1e-3, 1, 1e-3, 1e-6};
    for (int version = 1; version <= 2; version++) {
        begin_nifti(&file, version, version == 2, 2, 2, 2, 2, 8);
        file.size += 8;
        put_pixdim(&file, 2, 2);
        put_pixdim(&file, 3, 3);
        accepted();
        assert_int_equal(image.space, IMAGE_SPACE_UNKNOWN);
        assert_non_null(strstr(image.note, "neither sform nor qform"));
        same_space(sizes);
        image_free(&image);
        put_pixdim(&file, 0, -1); /* a quarter turn about z, the third axis mirrored */
        put_qform(&file, 1, 0, 0, sqrt(0.5), offset);
        accepted();
        assert_int_equal(image.space, IMAGE_SPACE_SCANNER);
        assert_string_equal(image.note, "");
        same_space(turned);
        image_free(&image);
        put_sform(&file, 4, sform);
        for (int units = 0; units < 4; units++) {
            put_units(&file, units);
            accepted();
            assert_int_equal(image.space, IMAGE_SPACE_MNI);
            NEAR_TO(image.unit, unit[units], 0);
            assert_int_equal(strstr(image.note, "no unit") != NULL, units == 0);
            assert_non_null(strstr(image.note, "sform and qform differ"));
            for (int i = 0; i < 12; i++) {
                in_metres[i / 4][i % 4] = unit[units] * sform[i / 4][i % 4];
            }
            same_space(in_metres);
            image_free(&image);
        }
    }
    double back[3][4], world[3];
    accepted();
    image_to_voxel(&image, back);
    image_world(&image, (double[3]){0.25, 1, 0.5}, world);
    for (int r = 0; r < 3; r++) {
        double place = back[r][0] * world[0] + back[r][1] * world[1] + back[r][2] * world[2] + back[r][3];
        NEAR_TO(place, ((double[3]){0.25, 1, 0.5})[r], 1e-10);
    }
    image_free(&image);
}

TEST(headers_that_lie)
{
    make_kind(&kinds[2], 1, false);
    file.size--;
    refused("cut short: 5 values, the header says 6");
    file.size += 2;
    refused("more data than 6 values");
    make_kind(&kinds[2], 1, false);
    put_type(&file, 4, 8);
    refused("8 bits a voxel, but int16 has 16");
    put_type(&file, 32, 64);
    refused("values of type 32");
    make_kind(&kinds[2], 1, false);
    put_dim(&file, 1, -3);
    refused("size -3 along dimension 1");
    put_dim(&file, 1, 0);
    refused("size 0 along dimension 1");
    put_dim(&file, 1, 3);
    put_dim(&file, 0, 8);
    refused("8 dimensions");
    put_dim(&file, 0, 1);
    refused("1 dimensions");
    put_dim(&file, 0, 4);
    put_dim(&file, 4, 20);
    refused("holds 20 volumes");
    make_kind(&kinds[2], 1, false);
    put_offset(&file, 100);
    refused("data from byte 100");
    put_offset(&file, 1 << 20);
    refused("cut short: 364 bytes, the header says that data begin at byte 1048576");
    make_kind(&kinds[2], 2, false);
    for (int i = 1; i <= 3; i++) {
        put_dim(&file, i, INT32_MAX);
    }
    refused("more than any memory");
    put_dim(&file, 3, 16); /* 2^66 bytes no, 2^67 values no: 2^66 values / 2 ... fits, and is not there */
    put_dim(&file, 2, 1 << 20);
    refused("cut short");
    put_dim(&file, 1, (int64_t)1 << 40);
    refused("along dimension 1");
}

/* No part of a file passes for the whole, compressed or not; no bit of compressed data can be turned unseen.
 */
TEST(cut_and_damaged)
{
    unsigned char packed[4096];
    int silent = 0;
    make_kind(&kinds[9], 1, false);
    for (int i = 0; i < 48; i++) { /* not to be compressed well */
        file.bytes[352 + i] = (unsigned char)(i * 37 + i * i * 11);
    }
    size_t whole = file.size, size = compress_bytes(file.bytes, whole, packed, sizeof packed);
    for (size_t at = 0; at < whole; at++) {
        assert_int_equal(read_bytes(file.bytes, at), STATUS_INPUT);
    }
    for (size_t at = 0; at < size; at++) {
        assert_int_equal(read_bytes(packed, at), STATUS_INPUT);
    }
    for (size_t bit = 80; bit < 8 * size; bit++) { /* behind gzip's own header */
        packed[bit / 8] ^= (unsigned char)(1 << bit % 8);
        if (read_bytes(packed, size) == STATUS_OK) { /* a bit that says nothing, between data and checksum */
            assert_memory_equal(image.values, file.bytes + 352, 48);
            image_free(&image);
            silent++;
        }
        packed[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    assert_true(silent < 8);
    assert_int_equal(read_bytes(packed, size), STATUS_OK);
    image_free(&image);
}

/* A file of many blocks, cut within its checksum, which is all that is missing. */
TEST(without_checksum)
{
    static unsigned char packed[1 << 18];
    uint32_t random = 1;
    begin_nifti(&file, 1, false, 100, 100, 10, 2, 8);
    for (int i = 0; i < 100000; i++) {
        random = random * 1664525 + 1013904223;
        append_value(&file, 1, random >> 24);
    }
    size_t size = compress_bytes(file.bytes, file.size, packed, sizeof packed);
    for (size_t missing = 1; missing < 20; missing++) {
        assert_int_equal(read_bytes(packed, size - missing), STATUS_INPUT);
    }
    memcpy(packed + size, "more", 4);
    assert_int_equal(read_bytes(packed, size + 4), STATUS_INPUT);
    assert_int_equal(read_bytes(packed, size), STATUS_OK);
    image_free(&image);
    /* Two members, one behind the other, are one file. */
    size_t first = compress_bytes(file.bytes, 1000, packed, sizeof packed);
    size = first + compress_bytes(file.bytes + 1000, file.size - 1000, packed + first, sizeof packed - first);
    assert_int_equal(read_bytes(packed, size), STATUS_OK);
    NEAR_TO(image.values[99999], random >> 24, 0);
    image_free(&image);
}

static unsigned char written_bytes[1 << 12];

/* Write an image and read it back; returns the size of the file. */
static size_t write_and_read(const struct image *written, enum image_format format)
{
    FILE *written_file = tmpfile();
    GOOD(image_write(written, written_file, format, NULL, &error));
    size_t size = (size_t)ftell(written_file);
    rewind(written_file);
    assert_int_equal(fread(written_bytes, 1, sizeof written_bytes, written_file), size);
    (void)fclose(written_file);
    assert_int_equal(read_bytes(written_bytes, size), STATUS_OK);
    return size;
}

/* A header of text has no code of the space and intent, and is in mm. */
static void assert_same(const struct image *a, const struct image *b, bool text)
{
    assert_memory_equal(a->size, b->size, sizeof a->size);
    assert_int_equal(a->components, b->components);
    assert_int_equal(a->datatype, b->datatype);
    assert_int_equal(text ? IMAGE_SPACE_SCANNER : a->space, b->space);
    assert_int_equal(text ? 0 : a->intent, b->intent);
    assert_string_equal(text ? "" : a->intent_name, b->intent_name);
    assert_string_equal(a->description, b->description);
    NEAR_TO(text ? 1e-3 : a->unit, b->unit, 0);
    assert_memory_equal(a->values, b->values, image_voxels(a) * a->components * sizeof(double));
    for (int i = 0; i < 12; i++) {
        NEAR_TO(a->to_world[i / 4][i % 4], b->to_world[i / 4][i % 4], 1e-7 * a->unit);
    }
}

TEST(round_trips)
{
    double oblique[3][4] = {{-0.6, 0.8, 0, 1}, {0.8, 0.6, 0, 2}, {0, 0, 2, -3}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        for (int version = 1; version <= 2; version++) {
            make_kind(&kinds[k], version, version == 1);
            put_sform(&file, 2, oblique);
            accepted();
            FREED_BY(image_free) struct image first = image;
            strcpy(first.description, "made by hand");
            strcpy(first.intent_name, "what");
            first.intent = IMAGE_INTENT_LABEL;
            for (int format = 0; format < IMAGE_FORMATS; format++) {
                size_t size = write_and_read(&first, (enum image_format)format);
                assert_same(&first, &image, format > IMAGE_NIFTI);
                assert_int_equal(image.version, format > IMAGE_NIFTI ? 1 : version);
                assert_string_equal(image.note, ""); /* the quaternion tells the same as the matrix */
                image_free(&image);
                for (size_t cut = 0; cut < size && k == 9 && format > IMAGE_NIFTI; cut++) {
                    assert_int_equal(read_bytes(written_bytes, cut), STATUS_INPUT);
                }
            }
        }
    }
}

/* What a type cannot hold becomes the nearest that it can. */
TEST(rounding)
{
    FREED_BY(image_free) struct image written = {0};
    const size_t size[3] = {6, 1, 1};
    static const double values[6] = {-5, 1e9, 1.5001, NAN, 254.4, INFINITY};
    static const double expected[6] = {0, 255, 2, 0, 254, 255};
    GOOD(image_new(&written, size, 1, &error));
    written.datatype = IMAGE_UINT8;
    memcpy(written.values, values, sizeof values);
    write_and_read(&written, IMAGE_NIFTI);
    assert_memory_equal(image.values, expected, sizeof expected);
    image_free(&image);
    written.slope = 2; /* stored = (value - 3) / 2 */
    written.inter = 3;
    written.values[4] = 13;
    write_and_read(&written, IMAGE_NIFTI);
    NEAR_TO(image.values[4], 13, 0);
    image_free(&image);
    write_and_read(&written, IMAGE_NRRD); /* which knows no scaling: the values become real */
    assert_int_equal(image.datatype, IMAGE_FLOAT32);
    NEAR_TO(image.values[4], 13, 0);
    image_free(&image);
}

RUN_TESTS(NULL, NULL)
