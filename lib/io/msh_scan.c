#include "io/msh_scan.h"

#include "base/memory.h"
#include "io/msh_scan_parts.h"

#include <stdlib.h>
#include <string.h>

static const char *const part_names[MSH_PART_COUNT] = {"$MeshFormat", "$PhysicalNames", "$Entities", "$Nodes",
                                                       "$Elements"};

static bool is_end_of_line(char c)
{
    return c == '\n' || c == '\r';
}

/* MSH 1 has no $MeshFormat. */
static bool is_mesh1(const char *bytes, size_t size)
{
    return size >= MSH_MAGIC_SIZE && memcmp(bytes, "$NOD", 4) == 0 && is_end_of_line(bytes[4]);
}

bool msh_is_mesh(const char *bytes, size_t size)
{
    return is_mesh1(bytes, size) ||
           (size >= MSH_MAGIC_SIZE && memcmp(bytes, "$MeshFormat", 11) == 0 && is_end_of_line(bytes[11]));
}

const char *msh_foreign_hint(const char *bytes, size_t size)
{
#define BY_MESHIO                                                                                            \
    "python3 -c 'import meshio as m; m.write(\"body.msh\", m.read(\"FILE\"), file_format=\"gmsh22\")' "      \
    "makes a "                                                                                               \
    "mesh of it (python3-meshio)"
#define BY_GMSH(name) "gmsh " name " -save -o body.msh makes a mesh of it"
    static const char stl_hint[] = ": an STL surface: nodes -h tells how to fill it";
    static const struct {
        const char *begin, *hint;
    } formats[] = {
        {"# vtk DataFile", ": a VTK file: " BY_GMSH("FILE.vtk")},
        {"<?xml", ": an XML file: if it is VTU, " BY_MESHIO},
        {"<VTKFile", ": a VTU file: " BY_MESHIO},
        {"solid", stl_hint},
        {"MeshVersionFormatted", ": a MEDIT mesh: " BY_GMSH("FILE.mesh")},
        {"*", ": an Abaqus deck: " BY_GMSH("FILE.inp")},
        {"ply",
         ": a PLY surface: make it STL (gmsh FILE.ply -save -o body.stl); nodes -h tells how to fill that"},
        {"CDF", ": an Exodus file: " BY_MESHIO},
        {"\x89HDF", ": an HDF5 file: if it is MED, " BY_MESHIO},
    };
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        size_t length = strlen(formats[i].begin);
        if (size >= length && memcmp(bytes, formats[i].begin, length) == 0) {
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

enum status msh_rewrite(struct msh_scan *scan, enum msh_part part, const char *bytes, size_t size,
                        struct error *error)
{
    struct msh_rewritten *to = &scan->rewritten[part];
    if (to->size + size > to->room) {
        size_t room = to->room + to->room / 2 + size + 256;
        char *grown = array_grow(to->text, (int64_t)room, 1);
        if (grown == NULL) {
            return fail_memory(error, "the mesh");
        }
        to->text = grown;
        to->room = room;
    }
    memcpy(to->text + to->size, bytes, size);
    to->size += size;
    return STATUS_OK;
}

enum status msh_rewrite_text(struct msh_scan *scan, enum msh_part part, const char *text, struct error *error)
{
    return msh_rewrite(scan, part, text, strlen(text), error);
}

/* "$Name" at the cursor, into name[]. */
static enum status scan_heading(struct msh_cursor *cursor, char name[], size_t size)
{
    size_t length = 0;
    const char *at = cursor->at;
    while (at + length < cursor->end && length + 1 < size &&
           (length == 0 ? at[0] == '$' : at[length] > ' ' && at[length] < 127)) {
        name[length] = at[length];
        length++;
    }
    name[length] = '\0';
    if (length < 2) {
        return msh_cursor_fail(cursor, "followed by something that is not a section");
    }
    if (at + length == cursor->end) {
        return msh_cursor_fail(cursor, "followed by an unfinished section: the file is truncated");
    }
    cursor->at += length;
    return STATUS_OK;
}

/* "$EndName", and then white space or the end of the file; in MSH 1 "$ENDNAM". */
static enum status scan_ending(struct msh_cursor *cursor, const char *name)
{
    bool old = strcmp(name, "$NOD") == 0 || strcmp(name, "$ELM") == 0;
    const char *begin = old ? "$END" : "$End";
    cursor->record = 0;
    msh_skip_space(cursor);
    size_t length = strlen(name) - 1;
    const char *at = cursor->at;
    if ((size_t)(cursor->end - at) < length + 4) {
        return msh_cursor_fail(cursor, "no %s%s: the file is truncated", begin, name + 1);
    }
    if (memcmp(at, begin, 4) != 0 || memcmp(at + 4, name + 1, length) != 0 ||
        (at + 4 + length < cursor->end && at[4 + length] > ' ')) {
        return msh_cursor_fail(cursor, "more in the section than its head says: no %s%s where it should be",
                               begin, name + 1);
    }
    cursor->at += length + 4;
    return STATUS_OK;
}

/* A section that is not needed: step over it. */
static enum status skip_section(struct msh_cursor *cursor, const char *name)
{
    char ending[80] = "$End";
    strncat(ending, name + 1, sizeof ending - 5);
    const char *found = memmem(cursor->at, (size_t)(cursor->end - cursor->at), ending, strlen(ending));
    if (found == NULL) {
        return msh_cursor_fail(cursor, "no %s: the file is truncated", ending);
    }
    cursor->at = found;
    return scan_ending(cursor, name);
}

static enum status scan_part(struct msh_scan *scan, enum msh_part part, const char *start,
                             struct msh_cursor *cursor)
{
    switch (part) {
    case MSH_FORMAT:
        return msh_scan_format(scan, cursor);
    case MSH_NAMES:
        return msh_scan_names(scan, cursor);
    case MSH_ENTITIES:
        return scan->version < 40 ? msh_cursor_fail(cursor, "has no place in MSH 2")
                                  : msh_scan_entities(scan, start, cursor);
    case MSH_NODES:
        return msh_scan_nodes(scan, cursor);
    default:
        return msh_scan_elements(scan, cursor);
    }
}

static enum status scan_section(struct msh_scan *scan, const char *start, struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    char name[64];
    int part = MSH_PART_COUNT;
    size_t from = (size_t)(cursor->at - start);
    TRY(scan_heading(cursor, name, sizeof name));
    cursor->section = name;
    part = 0;
    while (part < MSH_PART_COUNT && strcmp(name, part_names[part]) != 0) {
        part++;
    }
    if (scan->version == 10) {
        part = strcmp(name, "$NOD") == 0   ? MSH_NODES
               : strcmp(name, "$ELM") == 0 ? MSH_ELEMENTS
                                           : MSH_PART_COUNT;
    }
    if (strcmp(name, "$PartitionedEntities") == 0) {
        TRY(msh_skip_line(cursor));
        TRY(msh_scan_partitions(scan, start, cursor));
        TRY(scan_ending(cursor, name));
        goto done;
    }
    if (part == MSH_PART_COUNT) {
        TRY(skip_section(cursor, name));
        goto done;
    }
    if (scan->part[part].to != 0) {
        status = msh_cursor_fail(cursor, "stands twice in the file");
        goto done;
    }
    TRY(msh_skip_line(cursor));
    TRY(scan_part(scan, (enum msh_part)part, start, cursor));
    TRY(scan_ending(cursor, name));
    scan->part[part].from = from;
    scan->part[part].to = (size_t)(cursor->at - start);
done:
    cursor->section = part < MSH_PART_COUNT ? part_names[part] : "a section";
    return status;
}

enum status msh_scan(struct msh_scan *scan, const char *bytes, size_t size, struct error *error)
{
    enum status status = STATUS_OK;
    struct msh_cursor cursor = {.at = bytes, .end = bytes + size, .section = "$MeshFormat", .error = error};
    *scan = (struct msh_scan){0};
    if (!msh_is_mesh(bytes, size)) {
        status = fail(error, STATUS_INPUT, "%s%s",
                      size == 0 ? "empty" : "not a gmsh mesh: the first line is not $MeshFormat",
                      msh_foreign_hint(bytes, size));
        goto done;
    }
    if (is_mesh1(bytes, size)) {
        scan->version = 10;
        scan->part[MSH_FORMAT].to = 1; /* stands nowhere */
        TRY(msh_rewrite_text(scan, MSH_FORMAT, "$MeshFormat\n2.2 0 8\n$EndMeshFormat", error));
    }
    while (cursor.at < cursor.end) {
        TRY(scan_section(scan, bytes, &cursor));
        msh_skip_space(&cursor);
    }
    if (scan->part[MSH_ELEMENTS].to == 0) {
        status = fail(error, STATUS_INPUT, "no section %s: the file is truncated, or no mesh was made",
                      scan->part[MSH_NODES].to == 0 ? "$Nodes" : "$Elements");
    }
done:
    if (status != STATUS_OK) {
        msh_scan_free(scan);
    }
    return status;
}

void msh_scan_free(struct msh_scan *scan)
{
    for (int part = 0; part < MSH_PART_COUNT; part++) {
        free(scan->rewritten[part].text);
    }
    free(scan->node_tag);
    msh_index_free(&scan->nodes);
    free(scan->element_tag);
    free(scan->element_type);
    free(scan->element_group);
    msh_index_free(&scan->elements);
    for (int64_t i = 0; i < scan->name_count; i++) {
        free(scan->names[i].name);
    }
    free(scan->names);
    *scan = (struct msh_scan){0};
}
