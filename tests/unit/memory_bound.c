/* What a reader allocates is a small multiple of its input, whatever the input says about its size: measured
 * on dense inputs, and on headers that announce what is not there. */
#include "unit.h"

#include "io/mesh/msh.h"
#include "io/scene/scene.h"
#include "io/stream/stream.h"
#include "io/files/table.h"

#include <malloc.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

/* Sanitizers bring their own allocator: with them there is nothing to test. */
#if !defined(__SANITIZE_ADDRESS__) && defined(__GLIBC__)

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *memory);

static bool watched;
static long alive;         /* allocated and not yet freed while watched */
static int64_t held, most; /* bytes of these, and the most there were at a time */

static void *counted(void *memory)
{
    if (watched && memory != NULL) {
        alive++;
        held += (int64_t)malloc_usable_size(memory);
        most = held > most ? held : most;
    }
    return memory;
}

static void forget(void *memory)
{
    if (watched && memory != NULL) {
        alive--;
        held -= (int64_t)malloc_usable_size(memory);
    }
}

void *malloc(size_t size)
{
    return counted(__libc_malloc(size));
}

void *calloc(size_t count, size_t size)
{
    return counted(__libc_calloc(count, size));
}

void *realloc(void *memory, size_t size)
{
    forget(memory);
    return counted(__libc_realloc(memory, size));
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return counted(__libc_memalign(alignment, size));
}

void free(void *memory)
{
    forget(memory);
    __libc_free(memory);
}

enum { FIXED = 8 << 20 }; /* buffers of any reader, bytes */

static char *text; /* the input under test */
static size_t length, room;

static void append(const char *line)
{
    size_t size = strlen(line);
    if (length + size > room) {
        room = 2 * room + size;
        text = realloc(text, room);
        assert_non_null(text);
    }
    memcpy(text + length, line, size);
    length += size;
}

static void repeat(const char *line, int64_t times)
{
    for (int64_t i = 0; i < times; i++) {
        append(line);
    }
}

static int make_file(char path[32], bool mapped)
{
    int file = memfd_create("bound", 0);
    assert_true(file >= 0);
    assert_int_equal(write(file, "\n", !mapped), !mapped); /* what does not begin its file is not mapped */
    assert_int_equal(write(file, text, length), length);
    assert_int_equal(lseek(file, !mapped, SEEK_SET), !mapped);
    snprintf(path, 32, "/proc/self/fd/%d", file);
    return file;
}

/* Watch the allocations from here on. */
static void begin(void)
{
    alive = 0;
    held = most = 0;
    watched = true;
}

/* No more than `multiple` times the input beyond the buffers; nothing left. */
static void end(const char *what, double multiple)
{
    watched = false;
    assert_int_equal(alive, 0);
    double seen = ((double)most - FIXED) / (double)length;
    print_message("# %s: %zu bytes read, most allocated %lld: beyond buffers %.1f times\n", what, length,
                  (long long)most, seen > 0 ? seen : 0.0);
    assert_true(seen <= multiple);
    length = 0;
}

static void read_stream(const char *what, bool mapped, enum status expected, double multiple)
{
    struct stream stream;
    struct error error;
    char path[32];
    int file = make_file(path, mapped);
    begin();
    assert_int_equal(stream_read(&stream, file, "input", &error), expected);
    stream_free(&stream);
    end(what, multiple);
    close(file);
}

TEST(streams)
{
    enum { ROWS = 2000000 };
    for (int mapped = 0; mapped < 2; mapped++) {
        append("# mts 1\n# x f8 2000000 1 enc=text\n");
        repeat("0\n", ROWS);
        append("\n\n# end 1\n");
        read_stream("stream, two bytes a number", mapped, STATUS_OK, 6.5);
        append("# mts 1\n");
        char line[64];
        for (int i = 0; i < 16000; i++) {
            snprintf(line, sizeof line, "# x%d f8 0 1 enc=text\n\n\n", i);
            append(line);
        }
        append("# end 16000\n");
        read_stream("stream, empty sections", mapped, STATUS_OK, 8.0);
    }
}

TEST(announced)
{
    static const char *const sizes[] = {"f8 100000000000 1", "f8 1 100000000000", "i4 9223372036854775807 1",
                                        "f4 3000000000 3000000000"};
    for (int i = 0; i < 16; i++) {
        char line[128];
        append("# mts 1\n");
        snprintf(line, sizeof line, "# x %s enc=%s", sizes[i / 4], i % 4 / 2 == 0 ? "text" : "bin");
        append(line);
        while (length % 64 != 63) {
            append(" ");
        }
        append("\n1 2 3\n");
        read_stream(line, i % 2 == 1, STATUS_INPUT, 1.0);
    }
}

TEST(tables)
{
    struct table table;
    char path[32];
    for (int blocks = 0; blocks < 2; blocks++) {
        repeat(blocks ? "0 0\n\n" : "0 0\n", blocks ? 20000 : 1000000);
        int file = make_file(path, true);
        begin();
        GOOD(table_read(path, 2, 2, &table, &error));
        table_free(&table);
        end(blocks ? "table, a block for each row" : "table, two bytes a number", 16.0);
        close(file);
    }
}

TEST(scenes)
{
    struct scene scene;
    char path[32];
    append("[scene]\ndim = 2\nanalysis = dynamic\n");
    for (int i = 0; i < 1000; i++) {
        char line[64];
        snprintf(line, sizeof line, "[force f%d]\nnodes = a,b,c,d,e,f,g\ncomponents = 0,0\n", i);
        append(line);
    }
    int file = make_file(path, true);
    begin();
    FAILS(scene_read(path, &scene, &error), STATUS_INPUT, ""); /* no material */
    scene_free(&scene);
    end("scene of loads", 16.0);
    close(file);
}

TEST(meshes)
{
    struct msh msh;
    char line[96];
    append("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n160000\n");
    for (int i = 160000; i > 0; i--) { /* out of order: an index is made */
        snprintf(line, sizeof line, "%d 0 0 0\n", i);
        append(line);
    }
    append("$EndNodes\n$Elements\n160000\n");
    for (int i = 160000; i > 0; i--) {
        snprintf(line, sizeof line, "%d 15 0 1\n", i);
        append(line);
    }
    append("$EndElements\n");
    begin();
    GOOD(msh_parse(&msh, text, length, &error));
    msh_free(&msh);
    end("mesh of points", 6.0);
    append("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n100000000000\n1 0 0 0\n");
    begin();
    FAILS(msh_parse(&msh, text, length, &error), STATUS_INPUT, "");
    end("mesh that announces nodes", 1.0);
}

static int free_text(void **state)
{
    (void)state;
    free(text);
    return 0;
}

RUN_TESTS(NULL, free_text)

#else
RUN_TESTS(NULL, NULL)
#endif
