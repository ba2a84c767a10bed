/* Interfaces between materials, and whether supports stop there. */
#include "model/model.h"

#include <stdio.h>

/* Above this jump forces may be wrong, too: on layers of three cells by 10 % at 20 : 1, by 16 % at 100 :
 * 1. */
static const double large_jump = 20.0;

/* Most regions that a remedy lists. */
enum { MOST_NAMED = 8 };

/* The interface with the largest jump: its regions, the stiffer one first, and the ratio of the moduli. */
struct worst {
    double ratio;
    int32_t region[2];
};

static double modulus_of(const struct material_list *materials, int32_t cell)
{
    return materials->items[materials->of_cell[cell]].shear_modulus;
}

/* *crossed: the interface with the largest jump of the modulus among those across which supports reach;
 * *softer: among those where supports stop, but faces and nodes on the interface belong to the softer
 * side. */
static void find_worst(const struct assembly *input, const int32_t *region, struct worst *crossed,
                       struct worst *softer)
{
    const int32_t *side = input->cell_side;
    for (int64_t f = input->faces.boundary_count; f < input->faces.count; f++) {
        int32_t stiff = input->faces.cell[2 * f], soft = input->faces.cell[2 * f + 1];
        double ratio = modulus_of(&input->materials, stiff) / modulus_of(&input->materials, soft);
        if (ratio < 1.0) {
            int32_t swap = stiff;
            stiff = soft;
            soft = swap;
            ratio = 1.0 / ratio;
        }
        struct worst *worst = side == NULL || side[stiff] == side[soft] ? crossed : softer;
        if (ratio > worst->ratio && (worst == crossed || side[soft] < side[stiff])) {
            *worst = (struct worst){ratio, {region[stiff], region[soft]}};
        }
    }
}

/* text[256] = the argument of support -i: the regions by decreasing modulus, without the last. */
static void remedy(const struct names *names, const double *modulus, char text[256])
{
    int64_t count = names->count;
    bool done[MOST_NAMED + 1] = {false};
    text[0] = '\0';
    if (count > MOST_NAMED + 1) {
        snprintf(text, 256, "the regions, the stiffest first");
    }
    for (int64_t k = 0; count <= MOST_NAMED + 1 && k + 1 < count; k++) {
        int32_t stiffest = -1;
        for (int32_t r = 0; r < count; r++) {
            stiffest = !done[r] && (stiffest < 0 || modulus[r] > modulus[stiffest]) ? r : stiffest;
        }
        done[stiffest] = true;
        text_append(text, 256, "%s%s", k > 0 ? "," : "", names->name[stiffest]);
    }
}

enum status model_interfaces(struct model *model, struct error *error)
{
    const struct assembly *input = &model->assembly;
    const struct scene_output *output = &model->scene->output;
    FREED_BY(cell_regions_free) struct cell_regions regions = {0};
    char order[256];
    struct worst crossed = {.ratio = 1.0}, softer = {.ratio = 1.0};
    RETURN_IF_ERROR(stream_regions(model->stream, &regions, error));
    NEW_SCRATCH(double, modulus, regions.names.count, error);
    for (int32_t c = 0; c < input->cells.count; c++) {
        modulus[regions.of_cell[c]] = modulus_of(&input->materials, c);
    }
    find_worst(input, regions.of_cell, &crossed, &softer);
    remedy(&regions.names, modulus, order);
    const struct worst *worst = softer.ratio > 1.0 ? &softer : &crossed;
    const char *first = regions.names.name[worst->region[0]], *second = regions.names.name[worst->region[1]];
    if (softer.ratio > 1.0) {
        (void)fail(
            &model->interfaces, STATUS_OK,
            "the interface of %s and %s has the shape functions of %s, the softer: the stress in %s is "
            "less exact: support -i %s",
            first, second, second, first, order);
    } else if (crossed.ratio > 1.0 &&
               (output->stress || output->strain || output->pressure ||
                (crossed.ratio > large_jump && (output->reactions || output->moments || output->gaps)))) {
        (void)fail(&model->interfaces, STATUS_OK,
                   "supports reach across the boundary of %s and %s, where the shear modulus jumps %.3g : 1: "
                   "the stress there is smoothed%s: support -i %s",
                   first, second, crossed.ratio,
                   crossed.ratio > large_jump ? ", and forces may be off by tens of percent" : "", order);
    }
    return STATUS_OK;
}
