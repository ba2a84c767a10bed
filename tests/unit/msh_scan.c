/* The scan of mesh files: what is sound passes, whatever else gives a message and no crash. */
#include "io/msh_scan.h"
#include "msh_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

/* Scan a copy of exactly the file's size, so that a sanitizer sees a read beyond it. */
static enum status scan_copy(struct msh_scan *scan, const char *bytes, size_t size, struct error *error)
{
    char *copy = malloc(size > 0 ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    enum status status = msh_scan(scan, copy, size, error);
    free(copy);
    return status;
}

static void every_form_is_sound(void **state)
{
    (void)state;
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        struct msh_scan scan;
        struct error error = {""};
        enum status status = scan_copy(&scan, f.bytes, f.size, &error);
        assert_string_equal(error.text, "");
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(scan.version, f.version);
        assert_int_equal(scan.binary, f.binary);
        assert_int_equal(scan.node_count, FIXTURE_NODES);
        assert_int_equal(scan.element_count, FIXTURE_ELEMENTS);
        assert_int_equal(scan.name_count, 3);
        for (int n = 0; n < FIXTURE_NODES; n++) {
            assert_int_equal(scan.node_tag[n], fixture_node_tags[n]);
            assert_int_equal(msh_index_find(&scan.nodes, fixture_node_tags[n]), n);
        }
        assert_int_equal(msh_index_find(&scan.nodes, 3), -1);
        assert_int_equal(msh_index_find(&scan.nodes, 10), -1);
        for (int e = 0; e < FIXTURE_ELEMENTS; e++) {
            assert_int_equal(scan.element_tag[e], 11 + e);
            assert_int_equal(scan.element_type[e], fixture_elements[e][0]);
        }
        msh_scan_free(&scan);
    }
}

static void tags_in_any_order(void **state)
{
    (void)state;
    struct fixture f = fixture_make(ASCII_22);
    struct msh_scan scan;
    struct error error;
    assert_true(fixture_replace(&f, "\n1 0 0 0", "\n30 0 0 0"));
    assert_true(fixture_replace(&f, "5 1 1\n", "5 1 30\n"));
    assert_true(fixture_replace(&f, "3 1 1 2\n", "3 1 30 2\n"));
    assert_true(fixture_replace(&f, "2 1 1 2 4\n", "2 1 30 2 4\n"));
    assert_true(fixture_replace(&f, "2 1 1 4 7\n", "2 1 30 4 7\n"));
    assert_int_equal(scan_copy(&scan, f.bytes, f.size, &error), STATUS_OK);
    assert_int_equal(msh_index_find(&scan.nodes, 30), 0);
    assert_int_equal(msh_index_find(&scan.nodes, 2), 1);
    assert_int_equal(msh_index_find(&scan.nodes, 9), 4);
    msh_scan_free(&scan);
}

static void truncation_at_every_byte_is_found(void **state)
{
    (void)state;
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        for (size_t size = 0; size + 1 < f.size; size++) {
            struct msh_scan scan;
            struct error error = {""};
            if (scan_copy(&scan, f.bytes, size, &error) != STATUS_INPUT || error.text[0] == '\0') {
                fail_msg("form %d cut after %zu of %zu bytes passes", form, size, f.size);
            }
        }
    }
}

/* What passes may be wrong, but must be bounded and consistent in itself; a sanitizer watches. */
static void changed_bytes_do_no_harm(void **state)
{
    (void)state;
    static const unsigned char values[] = {0x00, 0x01, 0x7f, 0xff, '$', '9', '-', '\n'};
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        for (size_t at = 0; at < f.size; at++) {
            for (size_t v = 0; v < sizeof values; v++) {
                char was = f.bytes[at];
                struct msh_scan scan;
                struct error error = {""};
                f.bytes[at] = (char)values[v];
                if (scan_copy(&scan, f.bytes, f.size, &error) == STATUS_OK) {
                    assert_true(scan.node_count <= (int64_t)f.size);
                    assert_true(scan.element_count <= (int64_t)f.size);
                } else {
                    assert_true(error.text[0] != '\0');
                }
                msh_scan_free(&scan);
                f.bytes[at] = was;
            }
        }
    }
}

/* MSH 1, partitioned files and second order, as gmsh writes them, treated in the same ways; in the folder
 * that holds the tests. */
static void rewritten_files_are_checked_as_well(void **state)
{
    (void)state;
    static const char *const names[] = {"one",     "parts22",       "binaryparts22",
                                        "parts41", "binaryparts41", "second41"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[128];
        char bytes[8192];
        struct msh_scan scan;
        struct error error = {""};
        snprintf(path, sizeof path, "tests/fuzz/corpus/msh/%s", names[i]);
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        enum status status = scan_copy(&scan, bytes, size, &error);
        assert_string_equal(error.text, "");
        assert_int_equal(status, STATUS_OK);
        msh_scan_free(&scan);
        for (size_t cut = 0; cut + 1 < size; cut++) {
            if (scan_copy(&scan, bytes, cut, &error) != STATUS_INPUT) {
                fail_msg("%s cut after %zu of %zu bytes passes", names[i], cut, size);
            }
        }
        for (size_t at = 0; at < size; at++) {
            char was = bytes[at];
            for (int value = -1; value < '9'; value += 19) {
                bytes[at] = (char)value;
                if (scan_copy(&scan, bytes, size, &error) == STATUS_OK) {
                    assert_true(scan.element_count <= (int64_t)size);
                    assert_true(scan.rewritten[MSH_ELEMENTS].size <= 4 * size);
                }
                msh_scan_free(&scan);
            }
            bytes[at] = was;
        }
    }
}

struct fault {
    int form;
    const char *from, *to, *message;
};

static void each_fault_has_its_message(void **state)
{
    (void)state;
    static const struct fault faults[] = {
        {ASCII_22, "$Nodes\n5\n", "$Nodes\n100000000000\n",
         "$Nodes: number of nodes: 100000000000 cannot be in"},
        {ASCII_41, "$Nodes\n1 5 ", "$Nodes\n1 100000000000 ",
         "$Nodes: number of nodes: 100000000000 cannot be in"},
        {ASCII_41, "$Nodes\n1 5 ", "$Nodes\n99999999999 5 ", "number of blocks: 99999999999 cannot be in"},
        {ASCII_41, "2 1 0 5\n", "2 1 0 99999999999\n", "cannot be in"},
        {ASCII_22, "$Elements\n4\n", "$Elements\n100000000000\n",
         "$Elements: number of elements: 100000000000 cannot"},
        {ASCII_22, "$Elements\n4\n", "$Elements\n99999999999999999999\n", "is not a whole number"},
        {ASCII_22, "\n2 2 0 0", "\n2 nan 0 0", "$Nodes: node 2: coordinate 1 is not finite"},
        {ASCII_22, "\n2 2 0 0", "\n2 2 0 -inf", "$Nodes: node 2: coordinate 3 is not finite"},
        {ASCII_41, "\n2 0 0\n", "\n2 1e999 0\n", "$Nodes: node 2: coordinate 2 is not finite"},
        {ASCII_22, "\n2 2 0 0", "\n2 2,5 0 0", "'2,5' is not a number"},
        {ASCII_22, "\n2 2 0 0", "\n-2 2 0 0", "$Nodes: node 2: tag: -2 is not within"},
        {ASCII_22, "\n2 2 0 0", "\n1 2 0 0", "node tag 1 stands twice"},
        {ASCII_22, "1 1 2 4\n", "1 1 2 3\n",
         "$Elements: element 3: element 13 names the node 3, which is not in $Nodes"},
        {ASCII_41, "1 2 4\n", "1 2 8\n", "element 13 names the node 8, which is not in $Nodes"},
        {ASCII_22, "14 2 2", "13 2 2", "element tag 13 stands twice"},
        {ASCII_22, "13 2 2", "13 21 2", "type 21 is no element of first or second order: mesh with order 1"},
        {ASCII_41, "\n2 1 2 2\n", "\n3 1 2 2\n", "a triangle on an entity of dimension 3"},
        {ASCII_41, "1 5 1 9\n", "1 5 1 4\n", "tag: 7 is not within [1, 4]"},
        {ASCII_41, "1 5 1 9\n", "1 4 1 9\n", "more nodes than the 4 that the section's head says"},
        {ASCII_41, "1 5 1 9\n", "1 6 1 9\n", "5 nodes, not the 6"},
        {ASCII_22, "$Nodes\n5\n", "$Nodes\n4\n", "no $EndNodes where it should be"},
        {ASCII_22, "$EndNodes", "$EndNode", "no $EndNodes"},
        {ASCII_22, "$Nodes\n", "$Nodess\n", "$Nodess: no $EndNodess"},
        {ASCII_22, "$EndElements\n", "$EndElements\n$Nodes\n0\n$EndNodes\n",
         "$Nodes: stands twice in the file"},
        {ASCII_22, "2.2 0 8", "3 0 8", "version 3 is not read"},
        {ASCII_22, "2.2 0 8", "1 0 8", "version 1 is not read"},
        {BINARY_41, "4.1 1 8", "4 1 8", "version 4.0 is read as ASCII only"},
        {ASCII_22, "2.2 0 8", "2.2 0 4", "size of a real number: 4"},
        {ASCII_22, "13 2 2 2 1 ", "13 2 257 2 1 ", "number of tags: 257 is not within [0, 256]"},
        {ASCII_22, "\"body\"", "body", "$PhysicalNames: name 3: no name in quotation marks"},
        {ASCII_22, "\"body\"", "\"body", "the name is empty, unfinished"},
        {ASCII_22, "\"body\"", "\"\"", "the name is empty, unfinished"},
        {ASCII_22, "$Elements\n", "junk\n$Elements\n", "followed by something that is not a section"},
        {ASCII_41, "$Entities\n", "$PartitionedEntities\n", "stands in MSH 4 only, once, behind $Entities"},
        {ASCII_22, "$Nodes\n", "$PartitionedEntities\n", "stands in MSH 4 only, once, behind $Entities"},
        {BINARY_41, "$MeshFormat\n4.1 1 8\n\x01", "$MeshFormat\n4.1 1 8\n\x02", "another byte order"},
        {ASCII_22, "$MeshFormat\n", "SystemCall \"true\";\n",
         "not a gmsh mesh: the first line is not $MeshFormat"},
        {ASCII_22, "$MeshFormat\n", "$MeshFormatX\n", "not a gmsh mesh"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        struct fixture f = fixture_make(faults[i].form);
        struct msh_scan scan;
        struct error error = {""};
        if (!fixture_replace(&f, faults[i].from, faults[i].to)) {
            fail_msg("no '%s' in form %d", faults[i].from, faults[i].form);
        }
        assert_int_equal(scan_copy(&scan, f.bytes, f.size, &error), STATUS_INPUT);
        if (strstr(error.text, faults[i].message) == NULL) {
            fail_msg("'%s' does not say '%s'", error.text, faults[i].message);
        }
    }
}

/* Sections that are not needed are stepped over, whatever is in them, and are not among the parts handed on.
 */
static void other_sections_are_left_out(void **state)
{
    (void)state;
    struct fixture f = fixture_make(ASCII_22);
    struct msh_scan scan;
    struct error error;
    assert_true(
        fixture_replace(&f, "$EndNodes\n", "$EndNodes\n$Comments\nSystemCall \"true\";\n$EndComments\n"));
    assert_int_equal(scan_copy(&scan, f.bytes, f.size, &error), STATUS_OK);
    for (int part = 0; part < MSH_PART_COUNT; part++) {
        size_t from = scan.part[part].from;
        size_t length = scan.part[part].to - from;
        assert_int_equal(length == 0, part == MSH_ENTITIES);
        assert_null(memmem(f.bytes + from, length, "SystemCall", 10));
        assert_true(length == 0 || f.bytes[from] == '$');
    }
    msh_scan_free(&scan);
}

static void lines_may_end_as_in_dos(void **state)
{
    (void)state;
    struct fixture f = fixture_make(ASCII_41);
    struct fixture dos = {.size = 0};
    struct msh_scan scan;
    struct error error = {""};
    for (size_t i = 0; i < f.size; i++) {
        if (f.bytes[i] == '\n') {
            dos.bytes[dos.size++] = '\r';
        }
        dos.bytes[dos.size++] = f.bytes[i];
    }
    assert_int_equal(scan_copy(&scan, dos.bytes, dos.size, &error), STATUS_OK);
    assert_int_equal(scan.node_count, FIXTURE_NODES);
    msh_scan_free(&scan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_is_sound),
        cmocka_unit_test(tags_in_any_order),
        cmocka_unit_test(truncation_at_every_byte_is_found),
        cmocka_unit_test(rewritten_files_are_checked_as_well),
        cmocka_unit_test(changed_bytes_do_no_harm),
        cmocka_unit_test(each_fault_has_its_message),
        cmocka_unit_test(other_sections_are_left_out),
        cmocka_unit_test(lines_may_end_as_in_dos),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
