/* Interfaces between materials: which side owns them, and whether supports stop there. */
#include "mtled/model.h"

#include "approx/support/support.h"
#include "base/lists.h"
#include "base/sets.h"
#include "base/vector.h"
#include "solid/equilibrium/statics.h"

#include <math.h>
#include <stdlib.h>

/* Jumps of the shear or bulk modulus by more than this count: layers in series are 2 % too stiff where
 * supports reach across a jump of 3. */
static const double least_jump = 2.0;

/* The shear moduli at the integration points of a cell, and the bulk moduli, those of an almost
 * incompressible material limited as in statics. */
struct moduli {
    double low, high, low_bulk, high_bulk;
};

static void read_moduli(const struct assembly *input, struct moduli *of)
{
    const struct material_list *materials = &input->materials;
    for (int64_t c = 0; c < input->cells.count; c++) {
        of[c] = (struct moduli){INFINITY, 0.0, INFINITY, 0.0};
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        const struct material *material = &materials->items[materials->of_point[q]];
        double shear = material->shear_modulus,
               bulk = fmin(material_bulk(material), STATICS_BULK_LIMIT * shear);
        struct moduli *cell = &of[input->point_cell[q]];
        *cell = (struct moduli){fmin(cell->low, shear), fmax(cell->high, shear), fmin(cell->low_bulk, bulk),
                                fmax(cell->high_bulk, bulk)};
    }
}

/* The ratio of the largest shear modulus of two cells to the least. */
static double shear_jump(const struct moduli *a, const struct moduli *b)
{
    return fmax(a->high, b->high) / fmin(a->low, b->low);
}

/* The same, or the ratio of the bulk moduli, if that is larger. */
static double jump_between(const struct moduli *a, const struct moduli *b)
{
    return fmax(shear_jump(a, b), fmax(a->high_bulk, b->high_bulk) / fmin(a->low_bulk, b->low_bulk));
}

/* Whether two cells are on one side of the input's interfaces. */
static bool on_one_side(const struct assembly *input, int32_t a, int32_t b)
{
    return input->cell_side == NULL || input->cell_side[a] == input->cell_side[b];
}

/* side[cells]: the parts into which jumps of the modulus within a region divide the sides of the input.
 * Returns whether there are such. Cells on both sides of a jump that hang together around it stay on one
 * side. */
static bool divide(const struct assembly *input, const struct faces *faces, const int32_t *region,
                   const struct moduli *of, int32_t *side)
{
    int64_t cells = input->cells.count;
    bool divided = false;
    for (int64_t c = 0; c < cells; c++) {
        side[c] = (int32_t)c;
    }
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t a = faces->cell[2 * f], b = faces->cell[2 * f + 1];
        if (b >= 0 && on_one_side(input, a, b) &&
            !(region[a] == region[b] && jump_between(&of[a], &of[b]) > least_jump)) {
            set_join(side, a, b);
        }
    }
    (void)set_number(cells, side);
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t a = faces->cell[2 * f], b = faces->cell[2 * f + 1];
        divided = divided || (b >= 0 && on_one_side(input, a, b) && side[a] != side[b]);
    }
    return divided;
}

/* What there is at the faces between cells. */
struct found {
    bool softer;  /* a jump where supports stop, and the softer side owns the interface */
    double ratio; /* the largest jump across which supports reach */
    int64_t face; /* there */
};

static struct found search(const struct faces *faces, const int32_t *side, const struct moduli *of)
{
    struct found found = {.ratio = least_jump};
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t a = faces->cell[2 * f], b = faces->cell[2 * f + 1];
        double ratio = b < 0 ? 1.0 : jump_between(&of[a], &of[b]);
        if (ratio > least_jump && side != NULL && side[a] != side[b]) {
            found.softer = found.softer || (shear_jump(&of[a], &of[b]) > least_jump &&
                                            (side[a] < side[b]) == (of[a].high < of[b].high));
        } else if (ratio > found.ratio) {
            found.ratio = ratio;
            found.face = f;
        }
    }
    return found;
}

/* Number the sides by falling stiffness, and make the shape functions anew: the lower side owns an interface.
 */
static enum status stiffest_first(struct stream *stream, int64_t cells, const int32_t *side,
                                  const struct moduli *of, struct error *error)
{
    int64_t sides = 0;
    NEW_SCRATCH(int32_t, renewed, cells, error);
    for (int64_t c = 0; c < cells; c++) {
        sides = side[c] >= sides ? side[c] + 1 : sides;
    }
    NEW_SCRATCH(int64_t, count, sides, error);
    NEW_SCRATCH(int32_t, rank, sides, error);
    NEW_SCRATCH(struct placed, by_modulus, sides, error); /* less the mean modulus of each side's cells */
    for (int64_t c = 0; c < cells; c++) {
        count[side[c]]++;
        by_modulus[side[c]].place -= of[c].high;
    }
    for (int64_t s = 0; s < sides; s++) {
        by_modulus[s].place /= count[s] > 0 ? (double)count[s] : 1.0;
        by_modulus[s].item = s;
    }
    qsort(by_modulus, (size_t)sides, sizeof *by_modulus, compare_placed);
    for (int64_t s = 0; s < sides; s++) {
        rank[by_modulus[s].item] = (int32_t)s;
    }
    for (int64_t c = 0; c < cells; c++) {
        renewed[c] = rank[side[c]];
    }
    return stage_renew(stream, renewed, error);
}

/* Nodal volumes end at a jump, as the pressure jumps there: the materials of a table on one side are a group.
 */
static enum status divide_table(struct model *model, int32_t section, const int32_t *side,
                                struct error *error)
{
    struct material_list *list = &model->assembly.materials;
    NEW_SCRATCH(int32_t, first, model->assembly.cells.count, error); /* of each side, by its number */
    for (int64_t q = 0; q < model->assembly.point_count; q++) {
        int32_t m = list->of_point[q], *group = first + side[model->assembly.point_cell[q]];
        if (list->section[m] == section) {
            *group = *group > 0 ? *group : m;
            list->group[m] = *group;
        }
    }
    return STATUS_OK;
}

/* Say where supports reach across a jump; `distance`: they reach across everything. */
static void note_jump(struct model *model, const struct faces *faces, const struct groups *regions,
                      const struct found *found, bool distance)
{
    const struct cells *cells = &model->assembly.cells;
    const int32_t *cell = faces->cell + 2 * found->face, *node = faces->node + found->face * cells->dim;
    double middle[3];
    vector_middle(cells->dim, cells->x, cells->dim, node, middle);
    int32_t first = regions->group[cell[0]], second = regions->group[cell[1]];
    (void)fail(&model->interfaces, STATUS_OK,
               "the stiffness jumps %.3g : 1 between cells of %s%s%s at %s, and supports reach across: "
               "stress and forces are wrong there: %s",
               found->ratio, regions->names.name[first], first == second ? "" : " and ",
               first == second ? "" : regions->names.name[second], POINT_TEXT(cells->dim, middle),
               first == second && !distance ? "smooth the table, or refine the mesh"
                                            : "let supports stop there (support without -i and --reach)");
}

enum status model_interfaces(struct model *model, struct stream *stream, bool *renewed, struct error *error)
{
    const struct assembly *input = &model->assembly;
    FREED_BY(faces_free) struct faces built = {0};
    FREED_BY(groups_free) struct groups regions = {0};
    struct field_shapes recorded;
    bool divided = false;
    NEW_SCRATCH(struct moduli, of, input->cells.count, error);
    NEW_SCRATCH(int32_t, divided_side, input->cells.count, error);
    if (!input->smoothed) {
        RETURN_IF_ERROR(faces_build(&input->cells, false, &built, error));
    }
    const struct faces *faces = input->smoothed ? &input->faces : &built;
    RETURN_IF_ERROR(stream_groups(stream, GROUP_REGION, true, &regions, error));
    RETURN_IF_ERROR(stage_recorded(stream, "support", &recorded, error));
    read_moduli(input, of);
    const int32_t *side = input->cell_side;
    bool distance = recorded.support.visibility == VISIBILITY_DISTANCE;
    if (!distance) {
        divided = divide(input, faces, regions.group, of, divided_side);
        side = divided ? divided_side : side;
    }
    struct found found = search(faces, side, of);
    if (found.ratio > least_jump) {
        note_jump(model, faces, &regions, &found, distance);
    }
    for (int64_t m = 0; divided && m < model->scene->material_count; m++) {
        if (model->scene->materials[m].table != NULL) {
            RETURN_IF_ERROR(divide_table(model, (int32_t)m, side, error));
        }
    }
    *renewed = divided || found.softer;
    return *renewed ? stiffest_first(stream, input->cells.count, side, of, error) : STATUS_OK;
}
