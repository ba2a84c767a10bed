#include "base/memory.h"
#include "io/files/textfile.h"
#include "io/mesh/msh_private.h"

#include <ctype.h>
#include <search.h>
#include <stdlib.h>
#include <string.h>

/* Number of bytes that identify a mesh. */
#define HEAD_SIZE 65536

/* ---- what the file is ---- */

static bool is_end_of_line(char c)
{
    return c == '\n' || c == '\r';
}

static enum status fail_version(double version, struct error *error)
{
    return fail(error, STATUS_INPUT,
                "MSH version %#.2g: convert it: gmsh FILE -save -format msh41 -o NEW.msh", version);
}

/* ---- sections ---- */

static void read_format(struct msh_reader *r)
{
    double version = msh_real(r, "version");
    if (r->status == STATUS_OK && version != 2.2 && version != 4.1) {
        r->status = fail_version(version, r->error);
    }
    r->msh4 = version == 4.1;
    bool binary = msh_int(r, "file type", 0, 1) == 1;
    (void)msh_int(r, "size of a real number", 8, 8);
    msh_skip_line(r);
    r->binary = binary;
    if (binary && msh_int(r, "byte order", INT32_MIN, INT32_MAX) != 1) {
        msh_fail(r, "the file is of another byte order: save it as ASCII");
    }
}

/* Take a mark, "$Name" or "$EndName", or what else is there, of at most 79 bytes; returns its length. */
static size_t take_mark(struct msh_reader *r, char mark[80])
{
    size_t length = 0;
    for (; r->at < r->end && length < 79 && *r->at > ' ' && *r->at < 127; r->at++) {
        mark[length++] = *r->at;
    }
    mark[length] = '\0';
    return length;
}

static void read_heading(struct msh_reader *r, char name[80])
{
    if (take_mark(r, name) < 2 || name[0] != '$') {
        msh_fail(r, "followed by something that is not a section");
    } else if (r->at == r->end) {
        msh_fail(r, "followed by an unfinished section: the file is truncated");
    }
}

/* Read "$EndName" on a line of its own, or at the end of the file. */
static void read_ending(struct msh_reader *r)
{
    char mark[80];
    const char *name = r->section + 1;
    if (r->status != STATUS_OK) {
        return;
    }
    r->record = 0;
    msh_skip_space(r);
    bool is_ending = take_mark(r, mark) > 4 && memcmp(mark, "$End", 4) == 0 && strcmp(mark + 4, name) == 0;
    if (!is_ending) {
        msh_fail(r,
                 r->at == r->end ? "no $End%s: the file is truncated"
                                 : "more in the section than its head says: no $End%s where it should be",
                 name);
    } else if (memchr(r->at, '\n', (size_t)(r->end - r->at)) != NULL) {
        msh_skip_line(r);
    }
}

static void skip_section(struct msh_reader *r)
{
    char ending[96] = "$End";
    strncat(ending, r->section + 1, sizeof ending - 5);
    const char *found = memmem(r->at, (size_t)(r->end - r->at), ending, strlen(ending));
    if (found == NULL) {
        msh_fail(r, "no %s: the file is truncated", ending);
    } else {
        r->at = found;
    }
}

static void refuse_partitions(struct msh_reader *r)
{
    msh_fail(r,
             "the mesh is partitioned: write it whole: gmsh FILE -save -format msh22 -o NEW.msh (if it was "
             "cut into files, mesh without -part_split)");
}

/* Read the content of a section; a needed section must not be repeated. */
static void read_content(struct msh_reader *r)
{
    static const struct {
        const char *name;
        enum msh_section section;
        void (*read)(struct msh_reader *reader);
    } needed[] = {
        {"$MeshFormat", MSH_FORMAT, read_format},
        {"$PhysicalNames", MSH_NAMES, msh_read_names},
        {"$Entities", MSH_ENTITIES, msh_read_entities},
        {"$PartitionedEntities", MSH_PARTITIONS, refuse_partitions},
        {"$Nodes", MSH_NODES, msh_read_nodes},
        {"$ParametricNodes", MSH_NODES, msh_read_nodes}, /* MSH 2 */
        {"$Elements", MSH_ELEMENTS, msh_read_elements},
    };
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        if (strcmp(r->section, needed[i].name) == 0) {
            if (r->has[needed[i].section]) {
                msh_fail(r, "stands twice in the file");
            }
            if (needed[i].section != MSH_FORMAT && !r->has[MSH_FORMAT]) {
                msh_fail(r, "comes before $MeshFormat");
            }
            msh_skip_line(r);
            needed[i].read(r);
            r->has[needed[i].section] = true;
            return;
        }
    }
    skip_section(r);
}

static void read_sections(struct msh_reader *r)
{
    char name[80], last[80] = "$MeshFormat";
    while (r->status == STATUS_OK && r->at < r->end) {
        r->section = last;
        read_heading(r, name);
        if (r->status == STATUS_OK) {
            r->section = name;
            read_content(r);
            read_ending(r);
            msh_skip_space(r);
            memcpy(last, name, sizeof last);
        }
    }
    r->section = "mesh";
    if (r->status == STATUS_OK && !r->has[MSH_ELEMENTS]) {
        r->status = fail(r->error, STATUS_INPUT, "no section %s: the file is truncated, or no mesh was made",
                         r->has[MSH_NODES] ? "$Elements" : "$Nodes");
    }
}

/* ---- formats ---- */

/* A deck of Abaqus begins with a keyword or a comment. */
static bool is_deck(const char *bytes, size_t size)
{
    size_t blanks = 0;
    while (blanks < size && (bytes[blanks] == ' ' || is_end_of_line(bytes[blanks]))) {
        blanks++;
    }
    return size - blanks > 1 && bytes[blanks] == '*' &&
           (bytes[blanks + 1] == '*' || isalpha((unsigned char)bytes[blanks + 1]));
}

/* A file in XML, also in UTF-16, with this element near its beginning. */
static bool is_xml(const char *bytes, size_t size, const char *element)
{
    char head[HEAD_SIZE];
    size_t count = 0;
    for (size_t i = 0; i < size && i < HEAD_SIZE; i++) {
        head[count] = bytes[i];
        count += bytes[i] != '\0';
    }
    const char *first = memchr(head, '<', count);
    return first != NULL && first - head < 4 && memmem(head, count, element, strlen(element)) != NULL;
}

/* The formats: the file begins so, is in XML with such an element, or (neither) is a deck. */
static const struct format {
    const char *begin, *element;
    void (*read)(struct msh_reader *reader);
} formats[] = {{"$MeshFormat", NULL, read_sections}, {"$Comments", NULL, read_sections},
               {"# vtk DataFile", NULL, vtk_read},   {NULL, "<febio_spec", feb_read},
               {NULL, "<VTKFile", vtu_read},         {NULL, NULL, inp_read}};

/* Bytes of a byte order mark of UTF-8, which editors put before any text. */
static size_t mark_size(const char *bytes, size_t size)
{
    return size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

/* The format that a file of these first bytes has, or NULL. */
static const struct format *find_format(const char *bytes, size_t size)
{
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const char *begin = formats[i].begin, *element = formats[i].element;
        if (begin != NULL     ? size > strlen(begin) && memcmp(bytes, begin, strlen(begin)) == 0
            : element != NULL ? is_xml(bytes, size, element)
                              : is_deck(bytes, size)) {
            return &formats[i];
        }
    }
    return NULL;
}

enum status msh_parse(struct msh *msh, const char *bytes, size_t size, const char *region_array,
                      struct error *error)
{
    size_t mark = mark_size(bytes, size);
    bytes += mark;
    size -= mark;
    struct msh_reader reader = {
        .at = bytes, .end = bytes + size, .error = error, .msh = msh, .region_array = region_array};
    reader.members = MEMBERS_PER_BYTE * (int64_t)size;
    const struct format *format = find_format(bytes, size);
    *msh = (struct msh){0};
    if (size > 4 && memcmp(bytes, "$NOD", 4) == 0 && is_end_of_line(bytes[4])) { /* no $MeshFormat */
        return fail_version(1, error);
    }
    if (format == NULL) {
        return fail(error, STATUS_INPUT,
                    size == 0 ? "empty"
                              : "not a mesh of gmsh, Abaqus, CalculiX, FEBio or VTK: nodes -h says how to "
                                "make one of other files");
    }
    format->read(&reader);
    msh_finish_lists(&reader);
    msh_join_groups(&reader);
    if (reader.left_out[0] != '\0') {
        input_note(&reader, "what else is in the file is left out: %s", reader.left_out + 2);
    }
    owned_free(&reader.texts);
    tdestroy(reader.numbered, free);
    FREE_ALL(reader.corners, reader.names, reader.entities, reader.nodes.run, reader.elements.run);
    if (reader.status != STATUS_OK) {
        msh_free(msh);
    }
    return reader.status;
}

static bool goes_on(const char *bytes, size_t size)
{
    size_t mark = mark_size(bytes, size);
    return find_format(bytes + mark, size - mark) != NULL;
}

enum status msh_read(struct msh *msh, int descriptor, const char *name, const char *region_array,
                     struct error *error)
{
    SCRATCH char *bytes = NULL;
    size_t size = 0;
    *msh = (struct msh){0};
    enum status status = descriptor_read_all(descriptor, SIZE_MAX, goes_on, &bytes, &size, error);
    if (status == STATUS_OK) {
        status = msh_parse(msh, bytes, size, region_array, error);
    }
    return fail_in(error, status, "%s", name);
}

void msh_free(struct msh *msh)
{
    FREE_ALL(msh->nodes, msh->elements, msh->node_idx);
    for (int32_t i = 0; i < msh->group_count; i++) {
        free(msh->groups[i].name);
    }
    free(msh->groups);
    names_free(&msh->notes);
    *msh = (struct msh){0};
}
