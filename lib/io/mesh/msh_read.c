#include "base/memory.h"
#include "io/files/descriptor.h"
#include "io/mesh/msh_private.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number of bytes that identify a mesh. */
#define MAGIC_SIZE 12
/* Number of bytes in which the first element of an XML file, behind its comments, is searched for. */
#define XML_HEAD 4096

/* ---- what the file is ---- */

static bool is_end_of_line(char c)
{
    return c == '\n' || c == '\r';
}

/* MSH 1 has no $MeshFormat. */
static bool is_mesh1(const char *bytes, size_t size)
{
    return size >= MAGIC_SIZE && memcmp(bytes, "$NOD", 4) == 0 && is_end_of_line(bytes[4]);
}

static bool is_mesh(const char *bytes, size_t size)
{
    return is_mesh1(bytes, size) ||
           (size >= MAGIC_SIZE && memcmp(bytes, "$MeshFormat", 11) == 0 && is_end_of_line(bytes[11]));
}

/* A hint how to convert a file of another program, from its first bytes: ": a VTK file: ...", or "". */
static const char *foreign_hint(const char *bytes, size_t size)
{
#define BY_MESHIO                                                                                            \
    "python3 -c 'import meshio as m; m.write(\"body.msh\", m.read(\"FILE\"), file_format=\"gmsh22\")' "      \
    "makes a mesh of it (python3-meshio)"
#define WITH_REGIONS "; nodes -h tells how to keep an array of regions"
#define BY_GMSH(name) "gmsh " name " -save -o body.msh makes a mesh of it"
#define AS_STL(name)                                                                                         \
    "make it STL (python3 -c 'import meshio as m; m.write(\"body.stl\", m.read(\"" name "\"))'); "           \
    "nodes -h tells how to fill that"
    static const char stl_hint[] = ": an STL surface: nodes -h tells how to fill it";
    static const char geo_hint[] =
        ": a geometry of gmsh: gmsh -3 FILE.geo -o body.msh (in the plane -2) makes a mesh of it";
    static const struct {
        const char *begin, *hint;
    } formats[] = {
        {"# vtk DataFile", ": a VTK file: " BY_MESHIO WITH_REGIONS},
        {"<?xml", ": an XML file: if it is VTU, " BY_MESHIO WITH_REGIONS},
        {"<VTKFile", ": a VTU file: " BY_MESHIO WITH_REGIONS},
        {"solid", stl_hint},
        {"MeshVersionFormatted", ": a MEDIT mesh: " BY_GMSH("FILE.mesh")},
        {"-1\n", ": a UNV mesh: " BY_GMSH("FILE.unv")},
        {"-1\r", ": a UNV mesh: " BY_GMSH("FILE.unv")},
        {"$ ", ": a Nastran deck: " BY_GMSH("FILE.bdf")},
        {"BEGIN BULK", ": a Nastran deck: " BY_GMSH("FILE.bdf")},
        {"NDIME", ": an SU2 mesh: " BY_MESHIO},
        {"OFF\n", ": an OFF surface: " AS_STL("FILE.off")},
        {"v ", ": an OBJ surface: " AS_STL("FILE.obj")},
        {"*", ": an Abaqus deck: " BY_MESHIO},
        {"ply",
         ": a PLY surface: make it STL (gmsh FILE.ply -save -o body.stl); nodes -h tells how to fill that"},
        {"ISO-10303-21", ": a STEP geometry: gmsh -3 FILE.step -o body.msh makes a mesh of it"},
        {"SetFactory", geo_hint},
        {"Point", geo_hint},
        {"//", geo_hint},
        {"/*", geo_hint},
        {"CDF", ": an Exodus file: " BY_MESHIO},
        {"\x89HDF", ": an HDF5 file: if it is MED, " BY_MESHIO},
    };
    size_t blanks = 0;
    if (memmem(bytes, size < XML_HEAD ? size : XML_HEAD, "<febio_spec", 11) != NULL) {
        return ": a model of FEBio: nodes -h tells how to make a mesh of it";
    }
    while (blanks < size && isspace((unsigned char)bytes[blanks])) {
        blanks++;
    }
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        size_t length = strlen(formats[i].begin);
        if (size - blanks >= length && memcmp(bytes + blanks, formats[i].begin, length) == 0) {
            return formats[i].hint;
        }
    }
    if (size >= 84) { /* binary STL: 80 bytes of anything, a count, and 50 bytes for each triangle */
        uint32_t count;
        memcpy(&count, bytes + 80, sizeof count);
        if (count > 0 && size - 84 == 50 * (size_t)count) {
            return stl_hint;
        }
    }
    return "";
}

/* ---- sections ---- */

static void read_format(struct msh_reader *r)
{
    static const double versions[] = {2.0, 2.1, 2.2, 4.0, 4.1};
    double version = msh_real(r, "version");
    bool binary = msh_int(r, "file type", 0, 1) == 1;
    (void)msh_int(r, "size of a real number", 8, 8);
    for (size_t i = 0; i < sizeof versions / sizeof *versions; i++) {
        r->version = version == versions[i] ? (int)lround(10 * version) : r->version;
    }
    if (r->version == 0) {
        msh_fail(r, "version %g is not read: save as MSH 4.1 or 2.2", version);
    }
    if (r->version == 40 && binary) { /* gmsh does not read it either */
        msh_fail(r, "version 4.0 is read as ASCII only: save as MSH 4.1");
    }
    msh_skip_line(r);
    r->binary = binary;
    if (binary && msh_int(r, "byte order", INT32_MIN, INT32_MAX) != 1) {
        msh_fail(r, "the file is of another byte order: save it as ASCII");
    }
}

/* Read "$Name" into name[size]. */
static void read_heading(struct msh_reader *r, char name[], size_t size)
{
    size_t length = 0;
    const char *at = r->at;
    while (at + length < r->end && length + 1 < size &&
           (length == 0 ? at[0] == '$' : at[length] > ' ' && at[length] < 127)) {
        name[length] = at[length];
        length++;
    }
    name[length] = '\0';
    if (length < 2) {
        msh_fail(r, "followed by something that is not a section");
    } else if (at + length == r->end) {
        msh_fail(r, "followed by an unfinished section: the file is truncated");
    }
    r->at += length;
}

/* Read "$EndName" on a line of its own, or at the end of the file; in MSH 1 "$ENDNAM". */
static void read_ending(struct msh_reader *r)
{
    const char *name = r->section + 1;
    bool old = strcmp(name, "NOD") == 0 || strcmp(name, "ELM") == 0;
    const char *begin = old ? "$END" : "$End";
    size_t length = strlen(name);
    if (r->status != STATUS_OK) {
        return;
    }
    r->record = 0;
    msh_skip_space(r);
    if ((size_t)(r->end - r->at) < 4 + length) {
        msh_fail(r, "no %s%s: the file is truncated", begin, name);
    } else if (memcmp(r->at, begin, 4) != 0 || memcmp(r->at + 4, name, length) != 0 ||
               (r->at + 4 + length < r->end && r->at[4 + length] > ' ')) {
        msh_fail(r, "more in the section than its head says: no %s%s where it should be", begin, name);
    } else {
        r->at += 4 + length;
        if (memchr(r->at, '\n', (size_t)(r->end - r->at)) != NULL) {
            msh_skip_line(r);
        }
    }
}

/* Skip a section that is not needed. */
static void skip_section(struct msh_reader *r)
{
    char ending[80] = "$End";
    strncat(ending, r->section + 1, sizeof ending - 5);
    const char *found = memmem(r->at, (size_t)(r->end - r->at), ending, strlen(ending));
    if (found == NULL) {
        msh_fail(r, "no %s: the file is truncated", ending);
    } else {
        r->at = found;
    }
}

/* Read the content of a section; a needed section must not be repeated. */
static void read_content(struct msh_reader *r)
{
    static const struct {
        const char *name, *in_mesh1;
        void (*read)(struct msh_reader *reader);
    } needed[MSH_SECTIONS] = {
        [MSH_FORMAT] = {"$MeshFormat", "", read_format},
        [MSH_NAMES] = {"$PhysicalNames", "", msh_read_names},
        [MSH_ENTITIES] = {"$Entities", "", msh_read_entities},
        [MSH_PARTITIONS] = {"$PartitionedEntities", "", msh_read_partitions},
        [MSH_NODES] = {"$Nodes", "$NOD", msh_read_nodes},
        [MSH_ELEMENTS] = {"$Elements", "$ELM", msh_read_elements},
    };
    for (int i = 0; i < MSH_SECTIONS; i++) {
        if (strcmp(r->section, r->version == 10 ? needed[i].in_mesh1 : needed[i].name) == 0) {
            if (r->has[i]) {
                msh_fail(r, "stands twice in the file");
            }
            msh_skip_line(r);
            needed[i].read(r);
            r->has[i] = true;
            return;
        }
    }
    skip_section(r);
}

static void read_sections(struct msh_reader *r)
{
    char name[64], last[64] = "$MeshFormat";
    while (r->status == STATUS_OK && r->at < r->end) {
        r->section = last;
        read_heading(r, name, sizeof name);
        if (r->status == STATUS_OK) {
            r->section = name;
            read_content(r);
            read_ending(r);
            msh_skip_space(r);
            memcpy(last, name, sizeof last);
        }
    }
    if (r->status == STATUS_OK && !r->has[MSH_ELEMENTS]) {
        r->status = fail(r->error, STATUS_INPUT, "no section %s: the file is truncated, or no mesh was made",
                         r->has[MSH_NODES] ? "$Elements" : "$Nodes");
    }
}

enum status msh_parse(struct msh *msh, const char *bytes, size_t size, struct error *error)
{
    struct msh_reader reader = {.at = bytes, .end = bytes + size, .error = error, .msh = msh};
    *msh = (struct msh){0};
    if (!is_mesh(bytes, size)) {
        return fail(error, STATUS_INPUT, "%s%s",
                    size == 0 ? "empty" : "not a gmsh mesh: the first line is not $MeshFormat",
                    foreign_hint(bytes, size));
    }
    reader.version = is_mesh1(bytes, size) ? 10 : 0;
    read_sections(&reader);
    msh_join_groups(&reader);
    msh_index_free(&reader.nodes);
    FREE_ALL(reader.element_key, reader.whole_key, reader.names, reader.entities, reader.physicals,
             reader.partitions);
    if (reader.status != STATUS_OK) {
        msh_free(msh);
    }
    return reader.status;
}

/* ---- bytes ---- */

/* Read to the end; only the first bytes if they do not begin a mesh. */
static enum status read_all(int descriptor, char **bytes, size_t *size, struct error *error)
{
    int64_t room = 0;
    for (;;) {
        size_t got;
        RETURN_IF_ERROR(GROW_ARRAY(bytes, (int64_t)*size + 65536, &room, error));
        RETURN_IF_ERROR(descriptor_read(descriptor, *bytes + *size, (size_t)room - *size, &got, error));
        *size += got;
        if (got == 0 || (*size >= MAGIC_SIZE && !is_mesh(*bytes, *size))) {
            return STATUS_OK;
        }
    }
}

enum status msh_read(struct msh *msh, int descriptor, const char *name, struct error *error)
{
    SCRATCH char *bytes = NULL;
    size_t size = 0;
    *msh = (struct msh){0};
    enum status status = read_all(descriptor, &bytes, &size, error);
    if (status == STATUS_OK) {
        status = msh_parse(msh, bytes, size, error);
    }
    return fail_in(error, status, "%s", name);
}

void msh_free(struct msh *msh)
{
    FREE_ALL(msh->x, msh->node_tag, msh->element_tag, msh->element_type, msh->node_ptr, msh->node_idx,
             msh->member_ptr, msh->member_idx);
    for (int32_t i = 0; i < msh->group_count; i++) {
        FREE_ALL(msh->groups[i].name, msh->groups[i].written);
    }
    free(msh->groups);
    *msh = (struct msh){0};
}
