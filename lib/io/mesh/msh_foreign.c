/* What a file that is no mesh of gmsh is, and the command that converts it. */
#include "io/mesh/msh_private.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define BY_MESHIO(name)                                                                                      \
    "python3 -c 'import meshio as m; m.write(\"body.vtu\", m.read(\"" name                                   \
    "\"))' makes a mesh of it, body.vtu "                                                                    \
    "(python3-meshio)"
#define BY_GMSH(name) "gmsh " name " -save -o body.msh makes a mesh of it"
#define AS_STL(name)                                                                                         \
    "make it STL (python3 -c 'import meshio as m; m.write(\"body.stl\", m.read(\"" name "\"))'); "           \
    "nodes -h tells how to fill that"

/* Files of TetGen and Triangle begin with whole numbers on a line: the number of nodes, the dimension, the
 * numbers of attributes and of marks; or the number of cells, of the nodes of each, and of attributes. */
static const char *tetgen_hint(const char *bytes, size_t size)
{
    static const char tetgen[] = ": a mesh of TetGen, by its .node and .ele: " BY_MESHIO("FILE.node");
    static const char triangle[] =
        ": a mesh of Triangle, by its .node and .ele: python3 -c 'import meshio as m; n, c = [[r.split() for "
        "r in open(\"FILE\" + e) if r.split(\"#\")[0].strip()][1:] for e in (\".node\", \".ele\")]; "
        "m.Mesh([[*map(float, r[1:3]), 0] for r in n], [(\"triangle\", [[int(k) - int(n[0][0]) for k in "
        "r[1:4]] for r in c])]).write(\"body.msh\", file_format=\"gmsh22\")' makes a mesh of it "
        "(python3-meshio)";
    const char *at = bytes, *end = bytes + size;
    char line[80] = "";
    long long count, second, third, marks;
    while (at < end && (*at == '#' || isspace((unsigned char)*at))) {
        const char *next = *at == '#' ? memchr(at, '\n', (size_t)(end - at)) : at + 1;
        at = next != NULL ? next : end;
    }
    size_t length = 0;
    while (at + length < end && length + 1 < sizeof line &&
           (isdigit((unsigned char)at[length]) || isblank((unsigned char)at[length]))) {
        length++;
    }
    memcpy(line, at, length);
    int numbers = at + length < end && (at[length] == '\n' || at[length] == '\r' || at[length] == '#')
                      ? sscanf(line, "%lld %lld %lld %lld", &count, &second, &third, &marks)
                      : 0;
    if (numbers == 4 && (second == 2 || second == 3)) {
        return second == 3 ? tetgen : triangle;
    }
    if (numbers == 3 && (second == 3 || second == 6)) {
        return triangle;
    }
    return numbers == 3 && (second == 4 || second == 10) ? tetgen : NULL;
}

const char *msh_foreign_hint(const char *bytes, size_t size)
{
    static const char stl_hint[] = ": an STL surface: nodes -h tells how to fill it";
    static const char geo_hint[] =
        ": a geometry of gmsh: gmsh -3 FILE.geo -o body.msh (in the plane -2) makes a mesh of it";
    static const struct {
        const char *begin, *hint;
    } formats[] = {
        {"<", ": an XML file, neither VTU nor of FEBio"},
        {"solid", stl_hint},
        {"MeshVersionFormatted", ": a MEDIT mesh: " BY_GMSH("FILE.mesh")},
        {"-1\n", ": a UNV mesh: " BY_GMSH("FILE.unv")},
        {"-1\r", ": a UNV mesh: " BY_GMSH("FILE.unv")},
        {"$ ", ": a Nastran deck: " BY_GMSH("FILE.bdf")},
        {"BEGIN BULK", ": a Nastran deck: " BY_GMSH("FILE.bdf")},
        {"NDIME", ": an SU2 mesh: " BY_MESHIO("FILE")},
        {"OFF\n", ": an OFF surface: " AS_STL("FILE.off")},
        {"v ", ": an OBJ surface: " AS_STL("FILE.obj")},
        {"ply",
         ": a PLY surface: make it STL (gmsh FILE.ply -save -o body.stl); nodes -h tells how to fill that"},
        {"ISO-10303-21", ": a STEP geometry: gmsh -3 FILE.step -o body.msh makes a mesh of it"},
        {"SetFactory", geo_hint},
        {"Point", geo_hint},
        {"//", geo_hint},
        {"/*", geo_hint},
        {"CDF", ": an Exodus file: " BY_MESHIO("FILE")},
        {"\x89HDF", ": an HDF5 file: if it is MED, " BY_MESHIO("FILE")},
    };
    size_t blanks = 0;
    if (tetgen_hint(bytes, size) != NULL) {
        return tetgen_hint(bytes, size);
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
