/* Interfaces between materials: which side owns them, and whether supports stop there. */
#include "model/model.h"

#include "approx/support/support.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* Jumps of the shear modulus by more than this count: layers in series are 2 % too stiff where supports reach
 * across a jump of 3. */
static const double least_jump = 2.0;

/* The shear moduli at the integration points of a cell. */
struct moduli {
    double low, high;
};

static void read_moduli(const struct assembly *input, struct moduli *of)
{
    const struct material_list *materials = &input->materials;
    for (int64_t c = 0; c < input->cells.count; c++) {
        of[c] = (struct moduli){INFINITY, 0.0};
    }
    for (int64_t q = 0; q < input->point_count; q++) {
        double modulus = materials->items[materials->of_point[q]].shear_modulus;
        struct moduli *cell = &of[input->point_cell[q]];
        *cell = (struct moduli){fmin(cell->low, modulus), fmax(cell->high, modulus)};
    }
}

/* What there is at the faces between cells. */
struct found {
    bool softer;  /* a jump where supports stop, and the softer side owns the interface */
    double ratio; /* the largest jump across which supports reach */
    int64_t face; /* there */
};

static struct found search(const struct assembly *input, const struct faces *faces, const struct moduli *of)
{
    struct found found = {.ratio = least_jump};
    const int32_t *side = input->cell_side;
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t a = faces->cell[2 * f], b = faces->cell[2 * f + 1];
        double ratio = b < 0 ? 1.0 : fmax(of[a].high, of[b].high) / fmin(of[a].low, of[b].low);
        if (ratio > least_jump && side != NULL && side[a] != side[b]) {
            found.softer = found.softer || (side[a] < side[b]) == (of[a].high < of[b].high);
        } else if (ratio > found.ratio) {
            found.ratio = ratio;
            found.face = f;
        }
    }
    return found;
}

/* A side, and the mean shear modulus of its cells. */
struct ranked {
    double modulus;
    int32_t side;
};

static int compare_ranked(const void *a, const void *b)
{
    const struct ranked *first = a, *second = b;
    return first->modulus != second->modulus ? (first->modulus < second->modulus ? 1 : -1)
                                             : (first->side > second->side) - (first->side < second->side);
}

/* Number the sides by falling stiffness, and make the shape functions anew: the lower side owns an interface.
 */
static enum status stiffest_first(struct stream *stream, const struct assembly *input,
                                  const struct moduli *of, struct error *error)
{
    const int32_t *side = input->cell_side;
    int64_t cells = input->cells.count, sides = 0;
    NEW_SCRATCH(int32_t, renewed, cells, error);
    for (int64_t c = 0; c < cells; c++) {
        sides = side[c] >= sides ? side[c] + 1 : sides;
    }
    NEW_SCRATCH(int64_t, count, sides, error);
    NEW_SCRATCH(int32_t, rank, sides, error);
    NEW_SCRATCH(struct ranked, ranked, sides, error);
    for (int64_t c = 0; c < cells; c++) {
        count[side[c]]++;
        ranked[side[c]].modulus += of[c].high;
    }
    for (int64_t s = 0; s < sides; s++) {
        ranked[s] = (struct ranked){count[s] > 0 ? ranked[s].modulus / (double)count[s] : 0.0, (int32_t)s};
    }
    qsort(ranked, (size_t)sides, sizeof *ranked, compare_ranked);
    for (int64_t s = 0; s < sides; s++) {
        rank[ranked[s].side] = (int32_t)s;
    }
    for (int64_t c = 0; c < cells; c++) {
        renewed[c] = rank[side[c]];
    }
    return stage_renew(stream, renewed, error);
}

/* Say where supports reach across a jump. */
static enum status note_jump(struct model *model, const struct faces *faces, const struct found *found,
                             struct error *error)
{
    const struct cells *cells = &model->assembly.cells;
    const int32_t *cell = faces->cell + 2 * found->face, *node = faces->node + found->face * cells->dim;
    FREED_BY(cell_regions_free) struct cell_regions regions = {0};
    double middle[3];
    char place[96];
    RETURN_IF_ERROR(stream_regions(model->stream, &regions, error));
    vector_middle(cells->dim, cells->x, cells->dim, node, middle);
    point_text(cells->dim, middle, place);
    int32_t first = regions.of_cell[cell[0]], second = regions.of_cell[cell[1]];
    (void)fail(
        &model->interfaces, STATUS_OK,
        "the shear modulus jumps %.3g : 1 between cells of %s%s%s at %s, and supports reach across: stress "
        "and forces are wrong there: %s",
        found->ratio, regions.names.name[first], first == second ? "" : " and ",
        first == second ? "" : regions.names.name[second], place,
        first == second ? "make a region of each side (tag -r, voxels), and supports stop there"
                        : "let supports stop there (support without -i and --reach)");
    return STATUS_OK;
}

enum status model_interfaces(struct model *model, struct stream *stream, bool *renewed, struct error *error)
{
    const struct assembly *input = &model->assembly;
    FREED_BY(faces_free) struct faces built = {0};
    NEW_SCRATCH(struct moduli, of, input->cells.count, error);
    if (!input->smoothed) {
        RETURN_IF_ERROR(faces_build(&input->cells, false, &built, error));
    }
    const struct faces *faces = input->smoothed ? &input->faces : &built;
    read_moduli(input, of);
    struct found found = search(input, faces, of);
    if (found.ratio > least_jump) {
        RETURN_IF_ERROR(note_jump(model, faces, &found, error));
    }
    *renewed = found.softer;
    return found.softer ? stiffest_first(stream, input, of, error) : STATUS_OK;
}
