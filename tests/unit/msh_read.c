/* Mesh files through the scan and libgmsh (this test links with gmsh). */
#include "io/msh.h"
#include "msh_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

/* What libgmsh leaks when it gives up on a file is not ours to judge. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libgmsh\n";
}

static enum status read_bytes(struct msh *msh, const char *bytes, size_t size, struct error *error)
{
    int descriptor = memfd_create("test", 0);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, bytes, size), size);
    assert_int_equal(lseek(descriptor, 0, SEEK_SET), 0);
    enum status status = msh_read(msh, descriptor, "test.msh", error);
    close(descriptor);
    return status;
}

static void every_form_gives_the_same_mesh(void **state)
{
    (void)state;
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        struct msh msh;
        struct mesh mesh;
        struct error error = {""};
        enum status status = read_bytes(&msh, f.bytes, f.size, &error);
        assert_string_equal(error.text, "");
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(msh.node_count, FIXTURE_NODES);
        assert_int_equal(msh.element_count, FIXTURE_ELEMENTS);
        assert_int_equal(msh.group_count, 3);
        assert_string_equal(msh.groups[0].name, "corner");
        assert_int_equal(msh.groups[2].element_count, 2);
        assert_int_equal(mesh_build(&mesh, &msh, 1e-3, NULL, &error), STATUS_OK);
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
        mesh_free(&mesh);
        msh_free(&msh);
    }
}

/* In MSH 2 the elements of one entity may be in different groups, one each. */
static void groups_of_elements_not_of_entities(void **state)
{
    (void)state;
    struct fixture f = fixture_make(ASCII_22);
    struct msh msh;
    struct mesh mesh;
    struct error error = {""};
    assert_true(fixture_replace(&f, "14 2 2 2 1", "14 2 2 8 1"));
    assert_int_equal(read_bytes(&msh, f.bytes, f.size, &error), STATUS_OK);
    assert_int_equal(mesh_build(&mesh, &msh, 1, NULL, &error), STATUS_OK);
    assert_int_equal(mesh.regions.count, 2);
    assert_string_equal(mesh.regions.name[1], "group_8");
    assert_int_equal(mesh.cell_region[0], 0);
    assert_int_equal(mesh.cell_region[1], 1);
    mesh_free(&mesh);
    msh_free(&msh);
}

/* Whatever the scan lets pass, libgmsh must survive, and what comes out of both must be built or refused. */
static void changed_bytes_do_no_harm(void **state)
{
    (void)state;
    static const unsigned char values[] = {0x00, 0x02, 0xff, '7', '-'};
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        for (size_t at = (size_t)form; at < f.size; at += 7) {
            char was = f.bytes[at];
            struct msh msh;
            struct mesh mesh;
            struct error error = {""};
            f.bytes[at] = (char)values[at % sizeof values];
            enum status status = read_bytes(&msh, f.bytes, f.size, &error);
            if (status == STATUS_OK) {
                status = mesh_build(&mesh, &msh, 1, NULL, &error);
                msh_free(&msh);
                mesh_free(&mesh);
            }
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            assert_int_equal(status == STATUS_OK, error.text[0] == '\0');
            f.bytes[at] = was;
        }
    }
}

static void truncated_files_are_refused(void **state)
{
    (void)state;
    for (int form = 0; form < FIXTURE_FORMS; form++) {
        struct fixture f = fixture_make(form);
        for (size_t size = 0; size + 1 < f.size; size += 13) {
            struct msh msh;
            struct error error = {""};
            assert_int_equal(read_bytes(&msh, f.bytes, size, &error), STATUS_INPUT);
            assert_ptr_equal(strstr(error.text, "test.msh: "), error.text);
            assert_null(msh.x);
        }
    }
}

static void pipes_are_read_whole(void **state)
{
    (void)state;
    struct fixture f = fixture_make(BINARY_41);
    int ends[2];
    struct msh msh;
    struct error error = {""};
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], f.bytes, f.size), f.size);
    close(ends[1]);
    assert_int_equal(msh_read(&msh, ends[0], "pipe", &error), STATUS_OK);
    assert_int_equal(msh.element_count, FIXTURE_ELEMENTS);
    msh_free(&msh);
    close(ends[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_gives_the_same_mesh),
        cmocka_unit_test(groups_of_elements_not_of_entities),
        cmocka_unit_test(changed_bytes_do_no_harm),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(pipes_are_read_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
