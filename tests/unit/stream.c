/* The stream: what is read is what was written, to the last bit; and whatever is damaged is an error. */
#include "stream_fixture.h"

TEST(round_trip)
{
    FREED_BY(stream_free) struct stream sample = sample_stream();
    for (int variant = 0; variant < 4; variant++) {
        bool text = variant % 2 == 0, from_pipe = variant / 2 == 1;
        FREED_BY(stream_free) struct stream copy = {0};
        size_t size, again_size;
        SCRATCH char *bytes = written_bytes(&sample, text, &size);
        GOOD(read_bytes(bytes, size, from_pipe, &copy, &error));
        assert_same_stream(&sample, &copy);
        SCRATCH char *again = written_bytes(&copy, text, &again_size);
        assert_int_equal(size, again_size);
        assert_memory_equal(bytes, again, size);
    }
}

#define HEAD "# mts 1\n# x f8 2 2 enc=text unit=m\n"
#define TAIL "\n\n# end 1\n"

TEST(malformed_text)
{
    static const struct {
        const char *bytes, *message; /* the message contains this */
    } cases[] = {
        {"", "empty: no stream arrived"},
        {"# mts 2\n# end 0\n", "stream version '2'"},
        {"# mts 1\r\n# end 0\r\n", "CR LF"},
        {"\xef\xbb\xbf# mts 1\n# end 0\n", "byte order mark"},
        {"$MeshFormat\n4.1 0 8\n", "run nodes"},
        {"x\ty\n0\t1\n", "not an mts stream"},
        {"# mts 1\n# end 1\n", "0 sections, the end line says 1"},
        {"# mts 1\n# end -0\n", "is not '# end COUNT'"},
        {"# mts 1\n# end 0 \n", "is not '# end COUNT'"},
        {"# mts 1\n# end 0\n\n", "goes on behind its end line"},
        {"# mts 1\n# end 0\n# mts 1\n# end 0\n", "two streams"},
        {HEAD "1 2\n3 4\n" TAIL "# end 1\n", "goes on"},
        {HEAD "1 2\n3\n" TAIL, "x: row 1: 1 numbers instead of 2"},
        {HEAD "1 2\n\n" TAIL, "x: row 1: 0 numbers instead of 2"},
        {HEAD "1 2\n3 4 5\n" TAIL, "x: row 1: more than 2 numbers"},
        {HEAD "1 2\n3 4\n5 6\n" TAIL, "x: more than 2 rows"},
        {HEAD "1 2\n3 4\n\n# end 1\n", "not two blank lines"},
        {HEAD "1 2\n3 4\n\n\n" TAIL, "stands where a section header"},
        {HEAD "1 2\n" TAIL, "x: row 1: 0 numbers instead of 2"},
        {HEAD "1 2\n# end 1\n", "fewer rows than the 2 announced"},
        {HEAD "1 2\n3 1,5\n" TAIL, "x: row 1: '1,5': write a decimal point"},
        {HEAD "1 2\r\n3 4\r\n" TAIL, "CR LF"},
        {HEAD "1 2\n3 four\n" TAIL, "x: row 1: 'four' is not a number of type f8"},
        {HEAD "1 2\n3 1e999\n" TAIL, "'1e999' is not a number"},
        {HEAD "1 2\n3 4"
              "\0"
              "\n" TAIL,
         "'4' is not a number"},
        {HEAD "1 2\n3 4\n\n\n# @ late\n# end 1\n", "a provenance line behind a section"},
        {HEAD "1 2\n3 4\n\n\n"
              "# x f8 0 1\n\n\n# end 2\n",
         "x: this section stands twice"},
        {"# mts 1\n# @ a\r\n# end 0\n", "CR LF"},
        {"# mts 1\n# @ \033[2J\n# end 0\n", "control character"},
        {"# mts 1\n# x f8 0 1 enc=text enc=text\n" TAIL, "one encoding"},
        {"# mts 1\n# x f8 0 1 enc=hex\n" TAIL, "one encoding"},
        {"# mts 1\n# x f8 0 1 unit\n" TAIL, "'unit' in the header is not key=value"},
        {"# mts 1\n# x f8 0 1 a=1 a=2\n" TAIL, "attribute a given twice"},
        {"# mts 1\n# x f9 0 1\n" TAIL, "type 'f9'"},
        {"# mts 1\n# x f8 -1 1\n" TAIL, "'-1' is not a number of rows"},
        {"# mts 1\n# x f8 1.5 1\n" TAIL, "'1.5' is not a number of rows"},
        {"# mts 1\n# x f8 1 0\n" TAIL, "out of bounds"},
        {"# mts 1\n# x f8 1\n" TAIL, "'' is not a number of columns"},
        {"# mts 1\n# x/y f8 0 1\n" TAIL, "'x/y' is no section name"},
        {"# mts 1\n# mts f8 0 1\n" TAIL, "'mts' is reserved"},
        {"# mts 1\n# 1x f8 0 1\n" TAIL, "is no section name"},
        {"# mts 1\nnodes\n" TAIL, "'nodes' stands where a section header"},
        {"# mts 1\n# x i4 1 1\n2147483648\n" TAIL, "'2147483648' is not a number of type i4"},
        {"# mts 1\n# x i8 1 1\n9223372036854775808\n" TAIL, "is not a number of type i8"},
        {"# mts 1\n# x f4 1 1\n1e39\n" TAIL, "'1e39' is not a number of type f4"},
        {"# mts 1\n# x f8 9000000000000000000 1000000\n" TAIL, "out of bounds"},
        {"# mts 1\n# x f8 100000000000 1\n1\n" TAIL, "x: row 1: 0 numbers"},
        {"# mts 1\n# x f8 100000000000 1 enc=bin                          \n" TAIL,
         "x: row 1 of 100000000000: cut short"},
        {"# mts 1\n# x f8 1 1 enc=bin\n" TAIL, "not a multiple of 64"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int from_pipe = 0; from_pipe < 2; from_pipe++) {
            struct stream stream;
            struct error error = {""};
            size_t size = strlen(cases[i].bytes);
            if (strcmp(cases[i].message, "'4' is not a number") == 0) {
                size = sizeof HEAD "1 2\n3 4"
                                   "\0"
                                   "\n" TAIL -
                       1;
            }
            enum status status = read_bytes(cases[i].bytes, size, from_pipe == 1, &stream, &error);
            if (status != STATUS_INPUT || strstr(error.text, cases[i].message) == NULL) {
                fail_msg("case %zu: status %d, message '%s', expected '%s'", i, status, error.text,
                         cases[i].message);
            }
        }
    }
}

/* Written by hand or by awk: blanks and tabs, any spelling of a number, no enc=, a checksum that is right. */
TEST(tolerated_text)
{
    static const char bytes[] = "# mts 1\n# @ awk\n#  x  f8\t2 3 \tunit=m \n"
                                " 1\t2.50  +.5e1 \n-inf NaN -nan\n \n\t\n# end 1\n";
    FREED_BY(stream_free) struct stream stream = {0};
    GOOD(read_bytes(bytes, strlen(bytes), true, &stream, &error));
    assert_int_equal(stream.section_count, 1);
    const double *x = stream.sections[0].data;
    assert_true(x[0] == 1 && x[1] == 2.5 && x[2] == 5 && isinf(x[3]) && x[3] < 0 && isnan(x[4]) &&
                isnan(x[5]));
    assert_string_equal(stream.sections[0].attributes, "unit=m");
    assert_string_equal(stream.provenance.name[0], "awk");
}

TEST(sections_by_name)
{
    FREED_BY(stream_free) struct stream stream = sample_stream();
    const struct section *section;
    const struct section *first = stream_find(&stream, "a.i4");
    char value[8];
    assert_true(section_attribute(first, "unit", value, sizeof value));
    assert_string_equal(value, "m");
    assert_true(section_attribute(first, "cols", value, sizeof value));
    assert_string_equal(value, "x,y");
    assert_false(section_attribute(first, "col", value, sizeof value));
    assert_false(section_attribute(first, "cols", value, 3));

    GOOD(stream_need(&stream, "D.f8", TYPE_F8, 2, "nodes", &section, &error));
    assert_ptr_equal(section->data, sample_f8);
    FAILS_WITH(stream_need(&stream, "shape.phi", TYPE_F8, 1, "shapefn", &section, &error), STATUS_INPUT,
               "no section shape.phi: run shapefn");
    FAILS(stream_need(&stream, "D.f8", TYPE_I4, 2, "nodes", &section, &error), STATUS_INPUT, "");
    FAILS(stream_need(&stream, "D.f8", TYPE_F8, 3, "nodes", &section, &error), STATUS_INPUT, "");

    /* Adding moves nothing; replacing keeps the place; data may be the section's own. */
    for (int i = 0; i < 300; i++) {
        char name[32];
        snprintf(name, sizeof name, "more.%d", i);
        int32_t *data = array_new(1, sizeof *data);
        GOOD(stream_put(&stream, name, TYPE_I4, 1, 1, NULL, data, true, &error));
    }
    assert_ptr_equal(first, stream_find(&stream, "a.i4"));
    section = stream_find(&stream, "more.7");
    GOOD(stream_put(&stream, "more.7", TYPE_I4, 1, 1, "key=1", section->data, true, &error));
    assert_string_equal(section->attributes, "key=1");
    GOOD(stream_put(&stream, section->name, TYPE_I4, 1, 1, section->attributes, array_new(1, sizeof(int32_t)),
                    true, &error));
    FAILS(stream_put(&stream, "no/name", TYPE_I4, 1, 1, "", array_new(1, 4), true, &error), STATUS_INPUT, "");
    FAILS(stream_put(&stream, "x", TYPE_I4, 1, 1, "enc=text", array_new(1, 4), true, &error), STATUS_INPUT,
          "");
    FAILS(stream_put(&stream, "x", TYPE_I4, 1, 1, "a=b\n# end 0", array_new(1, 4), true, &error),
          STATUS_INPUT, "");
    FAILS(stream_put(&stream, "end", TYPE_I4, 1, 1, "", array_new(1, 4), true, &error), STATUS_INPUT, "");
    while (strncmp(stream.sections[stream.section_count - 1].name, "more.", 5) == 0) {
        stream_remove(&stream, stream.sections[stream.section_count - 1].name);
    }
    stream_remove(&stream, "b-i8");
    stream_remove(&stream, "absent");
    assert_int_equal(stream.section_count, 4);
    assert_string_equal(stream.sections[2].name, "c_f4");
}

TEST(provenance_is_quoted_for_a_shell)
{
    FREED_BY(stream_free) struct stream stream = sample_stream();
    assert_string_equal(stream.provenance.name[0],
                        "nodes " MTS_VERSION " nodes -u mm 'it'\\''s a file' '' $'line\\x0aend'");
}

RUN_TESTS(NULL, NULL)
