/* Mesh files: what is sound is read, in every version of the format; whatever else gives a message and no
 * crash. */
#include "io/mesh/msh.h"
#include "msh_fixture.h"

#include <sys/mman.h>
#include <unistd.h>

/* Read a file of these bytes. */
static enum status read_bytes(struct msh *msh, const char *bytes, size_t size, struct error *error)
{
    int descriptor = memfd_create("test", 0);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, bytes, size), size);
    assert_int_equal(lseek(descriptor, 0, SEEK_SET), 0);
    enum status status = msh_read(msh, descriptor, "test.msh", NULL, error);
    close(descriptor);
    return status;
}

/* Read a copy of exactly the file's size, so that a sanitizer sees a read beyond it. */
static enum status parse_copy(struct msh *msh, const char *bytes, size_t size, struct error *error)
{
    SCRATCH char *copy = malloc(size > 0 ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    return msh_parse(msh, copy, size, NULL, error);
}

/* What comes out of a file is built or refused, with a message. */
static void require_sense(const char *bytes, size_t size)
{
    struct msh msh;
    struct mesh mesh;
    struct error error = {""};
    enum status status = parse_copy(&msh, bytes, size, &error);
    if (status == STATUS_OK) {
        assert_true(msh.node_count <= (int64_t)size && msh.element_count <= (int64_t)size);
        status = mesh_build(&mesh, &msh, &(struct mesh_options){.unit = 1}, &error);
        msh_free(&msh);
        mesh_free(&mesh);
    }
    assert_true(status == STATUS_OK || status == STATUS_INPUT);
    assert_int_equal(status == STATUS_OK, error.text[0] == '\0');
    msh_free(&msh);
}

TEST(every_form_gives_the_same_mesh)
{
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        FREED_BY(msh_free) struct msh msh = {0};
        FREED_BY(mesh_free) struct mesh mesh = {0};
        GOOD(read_bytes(&msh, f.bytes, f.size, &error));
        assert_int_equal(msh.node_count, FIXTURE_NODES);
        assert_int_equal(msh.element_count, FIXTURE_ELEMENTS);
        assert_int_equal(msh.group_count, 3);
        assert_string_equal(msh.groups[0].name, "corner");
        assert_int_equal(msh.groups[2].element_count, 2);
        GOOD(mesh_build(&mesh, &msh, &(struct mesh_options){.unit = 1e-3}, &error));
        assert_int_equal(mesh.dim, 2);
        assert_int_equal(mesh.node_count, 4);
        for (int n = 0; n < 4; n++) {
            assert_true(mesh.x[2 * n] == 1e-3 * fixture_points[n][0]);
            assert_true(mesh.x[2 * n + 1] == 1e-3 * fixture_points[n][1]);
        }
        assert_int_equal(mesh.cell_count, 2);
        assert_memory_equal(mesh.cells, ((int32_t[]){0, 1, 2, 0, 2, 3}), 6 * sizeof(int32_t));
        assert_int_equal(mesh.facet_count, 1);
        assert_memory_equal(mesh.facets, ((int32_t[]){0, 1}), 2 * sizeof(int32_t));
        assert_int_equal(mesh.node_sets.count, 1);
        assert_string_equal(mesh.node_sets.name[0], "corner");
        assert_int_equal(mesh.set_ptr[1], 1);
        assert_int_equal(mesh.set_idx[0], 0);
        assert_int_equal(mesh.notes.count, 1); /* the node of no cell */
    }
}

/* In MSH 2 the elements of one entity may be in different groups, one each. */
TEST(groups_of_elements_not_of_entities)
{
    struct fixture f = fixture_make(ASCII_22);
    FREED_BY(msh_free) struct msh msh = {0};
    FREED_BY(mesh_free) struct mesh mesh = {0};
    assert_true(fixture_replace(&f, "14 2 2 2 1", "14 2 2 8 1"));
    GOOD(read_bytes(&msh, f.bytes, f.size, &error));
    GOOD(mesh_build(&mesh, &msh, &(struct mesh_options){.unit = 1}, &error));
    assert_int_equal(mesh.regions.count, 2);
    assert_string_equal(mesh.regions.name[1], "group_8");
    assert_int_equal(mesh.cell_region[0], 0);
    assert_int_equal(mesh.cell_region[1], 1);
}

/* Tags in any order, close together and far apart. */
TEST(tags_in_any_order)
{
    static const char *const tags[] = {"30", "2147483647"};
    for (int i = 0; i < 2; i++) {
        struct fixture f = fixture_make(ASCII_22);
        FREED_BY(msh_free) struct msh msh = {0};
        char to[64];
        static const char *const lines[4][2] = {
            {"\n1 0 0 0", "\n%s 0 0 0"},
            {"3 1 1 2\n", "3 1 %s 2\n"},
            {"2 1 1 2 4\n", "2 1 %s 2 4\n"},
            {"2 1 1 4 7\n", "2 1 %s 4 7\n"},
        };
        assert_true(fixture_replace(&f, "5 1 1\n", "5 1 9\n"));
        for (int k = 0; k < 4; k++) {
            const char *at = strchr(lines[k][1], '%');
            snprintf(to, sizeof to, "%.*s%s%s", (int)(at - lines[k][1]), lines[k][1], tags[i], at + 2);
            assert_true(fixture_replace(&f, lines[k][0], to));
        }
        GOOD(parse_copy(&msh, f.bytes, f.size, &error));
        assert_int_equal(msh.node_tag[0], atoll(tags[i]));
        assert_memory_equal(msh.node_idx, ((int32_t[]){4, 0, 1, 0, 1, 2, 0, 2, 3}), 9 * sizeof(int32_t));
        assert_memory_equal(msh.node_ptr, ((int64_t[]){0, 1, 3, 6, 9}), 5 * sizeof(int64_t));
    }
}

/* In MSH 4 a group may be of reversed orientation, and stand twice; it is the entity's. */
TEST(groups_of_entities)
{
    struct fixture f = fixture_make(ASCII_41);
    FREED_BY(msh_free) struct msh msh = {0};
    struct error said = {""};
    assert_true(fixture_replace(&f, " 1 2 1 1\n", " 4 7 -2 -7 2 1 1\n"));
    GOOD(parse_copy(&msh, f.bytes, f.size, &error));
    assert_string_equal(said.text, "");
    assert_int_equal(msh.group_count, 4);
    assert_string_equal(msh.groups[3].name, "group_7");
    assert_memory_equal(msh.member_ptr, ((int64_t[]){0, 1, 2, 4, 6}), 5 * sizeof(int64_t));
    assert_memory_equal(msh.member_idx, ((int32_t[]){0, 1, 2, 3, 2, 3}), 6 * sizeof(int32_t));
}

TEST(an_entity_stands_once)
{
    struct fixture f = fixture_make(ASCII_41);
    struct msh msh;
    assert_true(fixture_replace(&f, "\n1 1 1 0\n", "\n1 1 2 0\n"));
    assert_true(fixture_replace(&f, " 1 2 1 1\n", " 1 2 1 1\n1 0 0 0 2 2 0 0 1 1\n"));
    FAILS_WITH(parse_copy(&msh, f.bytes, f.size, &error), STATUS_INPUT, "$Entities: surface 1 stands twice");
}

/* MSH 4 without $Entities, as meshio writes it: no groups. */
TEST(entities_may_be_absent)
{
    struct fixture f = fixture_make(ASCII_41);
    FREED_BY(msh_free) struct msh msh = {0};
    char *from = strstr(f.bytes, "$Entities");
    char *to = strstr(f.bytes, "$Nodes");
    assert_true(from != NULL && to != NULL);
    memmove(from, to, (size_t)(f.bytes + f.size - to));
    f.size -= (size_t)(to - from);
    GOOD(parse_copy(&msh, f.bytes, f.size, &error));
    assert_int_equal(msh.member_ptr[FIXTURE_ELEMENTS], 0);
    assert_int_equal(msh.groups[2].element_count, 0);
}

/* Partitioned files of MSH 2 and second order, as gmsh writes them; in the folder that holds the tests. */
TEST(other_forms_are_read)
{
    static const struct {
        const char *name;
        int nodes, elements, groups, members; /* the parts of a body are in its group once each */
    } files[] = {{"parts22", 8, 10, 2, 10}, {"binaryparts22", 8, 10, 2, 10}, {"second41", 23, 10, 2, 10}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[128];
        char bytes[8192];
        struct msh msh;
        struct error said = {""};
        snprintf(path, sizeof path, "tests/fuzz/corpus/msh/%s", files[i].name);
        FILE *file = fopen(path, "rb");
        assert_non_null(file);
        size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        GOOD(parse_copy(&msh, bytes, size, &error));
        assert_string_equal(said.text, "");
        assert_int_equal(msh.node_count, files[i].nodes);
        assert_int_equal(msh.element_count, files[i].elements);
        assert_int_equal(msh.group_count, files[i].groups);
        assert_int_equal(msh.member_ptr[msh.element_count], files[i].members);
        msh_free(&msh);
        for (size_t cut = 0; cut + 1 < size; cut++) {
            if (parse_copy(&msh, bytes, cut, &said) != STATUS_INPUT) {
                fail_msg("%s cut after %zu of %zu bytes passes", files[i].name, cut, size);
            }
        }
        for (size_t at = 0; at < size; at++) {
            char was = bytes[at];
            for (int value = -1; value < '9'; value += 19) {
                bytes[at] = (char)value;
                require_sense(bytes, size);
            }
            bytes[at] = was;
        }
    }
}

struct fault {
    int form;
    const char *from, *to, *message;
};

TEST(each_fault_has_its_message)
{
    static const struct fault faults[] = {
        {ASCII_41, "$Nodes\n1 5 ", "$Nodes\n1 100000000000 ",
         "$Nodes: number of nodes: 100000000000 cannot be in"},
        {ASCII_41, "$Nodes\n1 5 ", "$Nodes\n99999999999 5 ", "number of blocks: 99999999999 cannot be in"},
        {ASCII_41, "2 1 0 5\n", "2 1 0 99999999999\n", "cannot be in"},
        {ASCII_22, "$Elements\n4\n", "$Elements\n99999999999999999999\n", "is not a whole number"},
        {ASCII_22, "\n2 2 0 0", "\n2 2 0 -inf", "$Nodes: node 2: coordinate 3 is not finite"},
        {ASCII_41, "\n2 0 0\n", "\n2 1e999 0\n", "$Nodes: node 2: coordinate 2 is not finite"},
        {ASCII_22, "\n2 2 0 0", "\n2 2,5 0 0", "'2,5' is not a number"},
        {ASCII_22, "\n2 2 0 0", "\n-2 2 0 0", "$Nodes: node 2: tag: -2 is not within"},
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
        {BINARY_41, "4.1 1 8", "4 1 8", "MSH version 4.0: convert it: gmsh FILE -save -format msh41 -o"},
        {ASCII_22, "2.2 0 8", "2.2 0 4", "size of a real number: 4"},
        {ASCII_22, "13 2 2 2 1 ", "13 2 257 2 1 ", "number of tags: 257 is not within [0, 256]"},
        {ASCII_22, "\"body\"", "body", "$PhysicalNames: name 3: no name in quotation marks"},
        {ASCII_22, "\"body\"", "\"body", "the name is empty, unfinished"},
        {ASCII_22, "\"body\"", "\"\"", "the name is empty, unfinished"},
        {ASCII_22, "$Elements\n", "junk\n$Elements\n", "followed by something that is not a section"},
        {BINARY_41, "$MeshFormat\n4.1 1 8\n\x01", "$MeshFormat\n4.1 1 8\n\x02", "another byte order"},
        {ASCII_41, "2 1 2 2\n13", "2 4 2 2\n13", "element 13 is on surface 4, which is not in $Entities"},
        {ASCII_41, "1 1 1 0\n", "15 15 15 15\n", "60 entities cannot be in what is left of the file"},
        {ASCII_41, " 1 3 0\n", " 1 3 100000000000\n", "cannot be in"},
        {ASCII_41, " 1 3 0\n", " 70 3 0\n", "$Entities: curve 1: 70 physical groups are more than 64"},
        {ASCII_22, "1 3 \"bottom\"\n2 2", "1 3 \"bottom\"\n1 3", "group 3 of dimension 1 is named twice"},
        {ASCII_22, "$MeshFormat\n", "$MeshFormatX\n", "not a mesh of gmsh"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        struct fixture f = fixture_make(faults[i].form);
        struct msh msh;
        if (!fixture_replace(&f, faults[i].from, faults[i].to)) {
            fail_msg("no '%s' in form %d", faults[i].from, faults[i].form);
        }
        FAILS(parse_copy(&msh, f.bytes, f.size, &error), STATUS_INPUT, faults[i].message);
    }
}

/* Sections that are not needed are stepped over, whatever is in them. */
TEST(other_sections_are_left_out)
{
    struct fixture f = fixture_make(ASCII_22);
    FREED_BY(msh_free) struct msh msh = {0};
    assert_true(
        fixture_replace(&f, "$EndNodes\n", "$EndNodes\n$Comments\n$Nodes\n1 0 0\n$EndNodes\n$EndComments\n"));
    GOOD(parse_copy(&msh, f.bytes, f.size, &error));
    assert_int_equal(msh.node_count, FIXTURE_NODES);
}

TEST(lines_may_end_as_in_dos)
{
    struct fixture f = fixture_make(ASCII_41);
    struct fixture dos = {.size = 0};
    FREED_BY(msh_free) struct msh msh = {0};
    for (size_t i = 0; i < f.size; i++) {
        if (f.bytes[i] == '\n') {
            dos.bytes[dos.size++] = '\r';
        }
        dos.bytes[dos.size++] = f.bytes[i];
    }
    GOOD(parse_copy(&msh, dos.bytes, dos.size, &error));
    assert_int_equal(msh.node_count, FIXTURE_NODES);
}

RUN_TESTS(NULL, NULL)
