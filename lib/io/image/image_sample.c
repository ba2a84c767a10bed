#include "base/round_off.h"
#include "io/image/image.h"

#include <math.h>
#include <stdint.h>

const char *const image_method_names[IMAGE_METHOD_COUNT] = {"nearest", "linear", "cubic"};

/* Indices and weights along one axis. */
struct taps {
    int count;
    size_t index[4];
    double weight[4];
};

/* Give the weight of the value beyond the border to those beside it, whose quadratic it continues (Keys
 * 1981).
 */
static void fold(double *beyond, int step)
{
    beyond[step] += 3 * *beyond;
    beyond[2 * step] -= 3 * *beyond;
    beyond[3 * step] += *beyond;
    *beyond = 0;
}

static void find_taps(enum image_method method, double place, size_t size, struct taps *taps)
{
    method = method == IMAGE_CUBIC && size < 3 ? IMAGE_LINEAR : method;
    place = fmin(fmax(place, 0), (double)size - 1);
    place = fabs(place - rint(place)) < COARSE_ROUND_OFF ? rint(place) : place;
    double low = method == IMAGE_NEAREST ? floor(place + 0.5) : floor(place), t = place - low;
    int64_t first = (int64_t)low - (method == IMAGE_CUBIC ? 1 : 0);
    double cubic[4] = {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t),
                       t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
    if (first < 0) {
        fold(cubic, 1);
    }
    if (first + 3 == (int64_t)size) {
        fold(cubic + 3, -1);
    }
    double linear[2] = {1 - t, t};
    int width = method == IMAGE_NEAREST ? 1 : method == IMAGE_LINEAR ? 2 : 4;
    taps->count = 0;
    for (int i = 0; i < width; i++) {
        double weight = width == 1 ? 1 : width == 2 ? linear[i] : cubic[i];
        if (weight != 0) { /* so that at a voxel centre neighbours that are NaN have no effect */
            taps->index[taps->count] = (size_t)(first + i);
            taps->weight[taps->count++] = weight;
        }
    }
}

bool image_sample(const struct image *image, enum image_method method, const double voxel[3], double *values)
{
    struct taps taps[3];
    for (int i = 0; i < 3; i++) {
        /* A little more, for places on the border. */
        if (!(voxel[i] >= -0.5 - 1e-6 && voxel[i] <= (double)image->size[i] - 0.5 + 1e-6)) {
            return false;
        }
        find_taps(method, voxel[i], image->size[i], &taps[i]);
    }
    for (size_t c = 0; c < image->components; c++) {
        values[c] = 0;
    }
    for (int k = 0; k < taps[2].count; k++) {
        for (int j = 0; j < taps[1].count; j++) {
            double weight = taps[2].weight[k] * taps[1].weight[j];
            size_t row = (taps[2].index[k] * image->size[1] + taps[1].index[j]) * image->size[0];
            for (int i = 0; i < taps[0].count; i++) {
                const double *from = image->values + (row + taps[0].index[i]) * image->components;
                for (size_t c = 0; c < image->components; c++) {
                    values[c] += weight * taps[0].weight[i] * from[c];
                }
            }
        }
    }
    return true;
}
