/* The formats: Gmsh reference manual, "MSH file format"; Abaqus keywords, as the CalculiX manual has them. */
#include "io/mesh/mesh_write.h"

#include "base/memory.h"
#include "io/mesh/msh_build.h"

#include <inttypes.h>

/* Lengths are divided rather than multiplied, so that 0.01 m is 10 mm and not 10.000000000000002. */
static void print_place(FILE *file, const struct mesh_view *mesh, int64_t node, double unit,
                        const char *separator)
{
    for (int a = 0; a < 3; a++) {
        double x = a < mesh->dim ? mesh->x[node * mesh->dim + a] / unit : 0.0;
        fprintf(file, "%s%.17g", a == 0 ? "" : separator, x);
    }
    fputc('\n', file);
}

/* The end of the run of items of one group that begins at `first`: groups are written in runs, so that items
 * keep their order. */
static int64_t run_end(int64_t count, const int32_t *group, int64_t first)
{
    int64_t end = first + 1;
    while (end < count && group[end] == group[first]) {
        end++;
    }
    return end;
}

/* ---- MSH ---- */

/* Groups of one dimension: a physical group and an entity for each name, with the same tag, from 1. */
struct group_kind {
    int dim, type, corners; /* type: gmsh's number of the element */
    int64_t count;          /* elements */
    const int32_t *element, *group;
    const struct names *names;
};

static void print_names(FILE *file, const struct group_kind kind[3])
{
    int64_t count = 0;
    for (int k = 0; k < 3; k++) {
        count += kind[k].names->count;
    }
    fprintf(file, "$PhysicalNames\n%" PRId64 "\n", count);
    for (int k = 0; k < 3; k++) {
        for (int32_t g = 0; g < kind[k].names->count; g++) {
            fprintf(file, "%d %d \"%s\"\n", kind[k].dim, g + 1, kind[k].names->name[g]);
        }
    }
    fprintf(file, "$EndPhysicalNames\n");
}

/* Those of the lowest dimension come first. Their boxes, which readers do not use, are zeros. */
static void print_entities(FILE *file, const struct group_kind kind[3])
{
    int64_t count[4] = {0};
    for (int k = 0; k < 3; k++) {
        count[kind[k].dim] = kind[k].names->count;
    }
    fprintf(file, "$Entities\n%" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 "\n", count[0], count[1],
            count[2], count[3]);
    for (int k = 2; k >= 0; k--) {
        for (int32_t g = 0; g < kind[k].names->count; g++) {
            fprintf(file, kind[k].dim == 0 ? "%d 0 0 0 1 %d\n" : "%d 0 0 0 0 0 0 1 %d 0\n", g + 1, g + 1);
        }
    }
    fprintf(file, "$EndEntities\n");
}

static void print_elements(FILE *file, const struct group_kind kind[3])
{
    int64_t blocks = 0, elements = 0, tag = 0;
    for (int k = 0; k < 3; k++) {
        elements += kind[k].count;
        for (int64_t e = 0; e < kind[k].count; e = run_end(kind[k].count, kind[k].group, e)) {
            blocks++;
        }
    }
    fprintf(file, "$Elements\n%" PRId64 " %" PRId64 " %d %" PRId64 "\n", blocks, elements, elements > 0,
            elements);
    for (int k = 2; k >= 0; k--) {
        for (int64_t e = 0; e < kind[k].count;) {
            int64_t end = run_end(kind[k].count, kind[k].group, e);
            fprintf(file, "%d %d %d %" PRId64 "\n", kind[k].dim, kind[k].group[e] + 1, kind[k].type, end - e);
            for (; e < end; e++) {
                fprintf(file, "%" PRId64, ++tag);
                for (int c = 0; c < kind[k].corners; c++) {
                    fprintf(file, " %d", kind[k].element[e * kind[k].corners + c] + 1);
                }
                fputc('\n', file);
            }
        }
    }
    fprintf(file, "$EndElements\n");
}

enum status mesh_write_msh(FILE *file, const struct mesh_view *mesh, double unit, struct error *error)
{
    bool solid = mesh->dim == 3;
    int64_t set_size = mesh->node_sets.count > 0 ? mesh->set_ptr[mesh->node_sets.count] : 0;
    NEW_SCRATCH(int32_t, set, set_size, error);
    for (int32_t g = 0; g < mesh->node_sets.count; g++) {
        for (int64_t i = mesh->set_ptr[g]; i < mesh->set_ptr[g + 1]; i++) {
            set[i] = g;
        }
    }
    const struct group_kind kind[3] = {{mesh->dim, solid ? 4 : 2, mesh->dim + 1, mesh->cell_count,
                                        mesh->cells, mesh->region, &mesh->regions},
                                       {mesh->dim - 1, solid ? 2 : 1, mesh->dim, mesh->facet_count,
                                        mesh->facets, mesh->facet_set, &mesh->facet_sets},
                                       {0, 15, 1, set_size, mesh->set_idx, set, &mesh->node_sets}};
    fprintf(file, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    print_names(file, kind);
    print_entities(file, kind);
    fprintf(file, "$Nodes\n1 %" PRId64 " 1 %" PRId64 "\n%d 1 0 %" PRId64 "\n", mesh->node_count,
            mesh->node_count, mesh->dim, mesh->node_count);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        fprintf(file, "%" PRId64 "\n", n + 1);
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        print_place(file, mesh, n, unit, " ");
    }
    fprintf(file, "$EndNodes\n");
    print_elements(file, kind);
    return STATUS_OK;
}

/* ---- decks of Abaqus and CalculiX ---- */

/* A comma-separated list, eight to a line. */
static void print_item(FILE *file, int64_t place, int64_t count, int64_t number)
{
    fprintf(file, "%" PRId64 "%s", number, place + 1 == count ? "\n" : place % 8 == 7 ? ",\n" : ", ");
}

static void print_cells(FILE *file, const struct mesh_view *mesh)
{
    for (int64_t c = 0; c < mesh->cell_count;) {
        int64_t end = run_end(mesh->cell_count, mesh->region, c);
        fprintf(file, "*ELEMENT, TYPE=%s, ELSET=%s\n", mesh->dim == 3 ? "C3D4" : "CPE3",
                mesh->regions.name[mesh->region[c]]);
        for (; c < end; c++) {
            fprintf(file, "%" PRId64, c + 1);
            for (int k = 0; k <= mesh->dim; k++) {
                fprintf(file, ", %d", mesh->cells[c * (mesh->dim + 1) + k] + 1);
            }
            fputc('\n', file);
        }
    }
}

/* The faces of an element by the corner that each lies opposite. */
static const char *const face_names[2][4] = {{"S2", "S3", "S1", ""}, {"S3", "S4", "S2", "S1"}};

static enum status print_surfaces(FILE *file, const struct mesh_view *mesh, struct error *error)
{
    FREED_BY(msh_faces_free) struct msh_faces faces = {0};
    RETURN_IF_ERROR(msh_faces_make(&faces, mesh->dim, mesh->cell_count, mesh->cells, error));
    for (int32_t g = 0; g < mesh->facet_sets.count; g++) {
        fprintf(file, "*SURFACE, TYPE=ELEMENT, NAME=%s\n", mesh->facet_sets.name[g]);
        for (int64_t f = 0; f < mesh->facet_count; f++) {
            int sides;
            if (mesh->facet_set[f] != g) {
                continue;
            }
            int64_t at = msh_faces_find(&faces, &mesh->facets[f * mesh->dim], &sides);
            if (at < 0) {
                return fail(error, STATUS_INPUT, "facets: row %" PRId64 ": no face of a cell", f);
            }
            int64_t slot = faces.face[at].item, corners = mesh->dim + 1;
            fprintf(file, "%" PRId64 ", %s\n", slot / corners + 1,
                    face_names[mesh->dim == 3][slot % corners]);
        }
    }
    return STATUS_OK;
}

enum status mesh_write_inp(FILE *file, const struct mesh_view *mesh, double unit, struct error *error)
{
    fprintf(file, "*NODE\n");
    for (int64_t n = 0; n < mesh->node_count; n++) {
        fprintf(file, "%" PRId64 ", ", n + 1);
        print_place(file, mesh, n, unit, ", ");
    }
    print_cells(file, mesh);
    for (int32_t g = 0; g < mesh->node_sets.count; g++) {
        int64_t first = mesh->set_ptr[g], count = mesh->set_ptr[g + 1] - first;
        fprintf(file, "*NSET, NSET=%s\n", mesh->node_sets.name[g]);
        for (int64_t i = 0; i < count; i++) {
            print_item(file, i, count, mesh->set_idx[first + i] + 1);
        }
    }
    return print_surfaces(file, mesh, error);
}
