#include "io/image/image_private.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

static const struct nifti_type image_types[] = {
    {IMAGE_UINT8, "uint8", 1, 1, 0, UINT8_MAX, "uint8|uchar|unsigned char|uint8_t",
     "MET_UCHAR|MET_UCHAR_ARRAY", "unsigned_char|vtktypeuint8"},
    {IMAGE_INT8, "int8", 1, 1, INT8_MIN, INT8_MAX, "int8|signed char|int8_t", "MET_CHAR|MET_CHAR_ARRAY",
     "char|vtktypeint8"},
    {IMAGE_INT16, "int16", 2, 1, INT16_MIN, INT16_MAX,
     "int16|short|short int|signed short|signed short int|int16_t", "MET_SHORT|MET_SHORT_ARRAY",
     "short|vtktypeint16"},
    {IMAGE_UINT16, "uint16", 2, 1, 0, UINT16_MAX, "uint16|ushort|unsigned short|unsigned short int|uint16_t",
     "MET_USHORT|MET_USHORT_ARRAY", "unsigned_short|vtktypeuint16"},
    {IMAGE_INT32, "int32", 4, 1, INT32_MIN, INT32_MAX, "int32|int|signed int|int32_t",
     "MET_INT|MET_LONG|MET_INT_ARRAY|MET_LONG_ARRAY", "int|vtktypeint32|vtkIdType"},
    {IMAGE_UINT32, "uint32", 4, 1, 0, UINT32_MAX, "uint32|uint|unsigned int|uint32_t",
     "MET_UINT|MET_ULONG|MET_UINT_ARRAY|MET_ULONG_ARRAY", "unsigned_int|vtktypeuint32"},
    {IMAGE_INT64, "int64", 8, 1, -9223372036854774784.0, 9223372036854774784.0,
     "int64|longlong|long long|long long int|signed long long|signed long long int|int64_t",
     "MET_LONG_LONG|MET_LONG_LONG_ARRAY", "long|vtktypeint64"},
    {IMAGE_UINT64, "uint64", 8, 1, 0, 18446744073709549568.0,
     "uint64|ulonglong|unsigned long long|unsigned long long int|uint64_t",
     "MET_ULONG_LONG|MET_ULONG_LONG_ARRAY", "unsigned_long|vtktypeuint64"},
    {IMAGE_FLOAT32, "float32", 4, 1, 0, 0, "float", "MET_FLOAT|MET_FLOAT_ARRAY", "float"},
    {IMAGE_FLOAT64, "float64", 8, 1, 0, 0, "double", "MET_DOUBLE|MET_DOUBLE_ARRAY", "double"},
    {IMAGE_RGB24, "RGB24", 1, 3, 0, UINT8_MAX, "uint8", "MET_UCHAR", ""},
    {IMAGE_RGBA32, "RGBA32", 1, 4, 0, UINT8_MAX, "uint8", "MET_UCHAR", ""},
};

enum { IMAGE_TYPES = sizeof image_types / sizeof *image_types };

const struct nifti_type *nifti_type(int code)
{
    for (int t = 0; t < IMAGE_TYPES; t++) {
        if (image_types[t].code == code) {
            return &image_types[t];
        }
    }
    return NULL;
}

const struct nifti_type *nifti_type_named(enum number_format format, const char *name)
{
    for (int t = 0; t < IMAGE_TYPES; t++) {
        const struct nifti_type *type = &image_types[t];
        const char *const names[] = {type->nrrd, type->metaimage, type->name, type->vtk};
        if (type->components == 1 && header_is(names[format], name)) {
            return type;
        }
    }
    return NULL;
}

void nifti_get(const struct nifti_type *type, const unsigned char *bytes, bool swapped, size_t count,
               double *values)
{
    int unused = 64 - 8 * type->bytes, code = type->code;
    bool negative = type->least < 0;
    for (size_t i = 0; i < count; i++, bytes += (64 - unused) / 8) {
        uint64_t word = 0;
        memcpy(&word, bytes, (count - i) * (size_t)type->bytes >= 8 ? 8 : (size_t)type->bytes);
        word = swapped ? __builtin_bswap64(word) : word << unused; /* the number is in its upper bytes */
        if (code == IMAGE_FLOAT32) {
            uint32_t high = (uint32_t)(word >> 32);
            float single;
            memcpy(&single, &high, sizeof single);
            values[i] = (double)single;
        } else if (code == IMAGE_FLOAT64) {
            memcpy(&values[i], &word, sizeof word);
        } else {
            values[i] = negative ? (double)((int64_t)word >> unused) : (double)(word >> unused);
        }
    }
}

void nifti_put(const struct nifti_type *type, double value, unsigned char *bytes)
{
    uint64_t bits = 0;
    if (type->code == IMAGE_FLOAT32) {
        float single = (float)value;
        memcpy(&bits, &single, sizeof single);
    } else if (type->code == IMAGE_FLOAT64) {
        memcpy(&bits, &value, sizeof value);
    } else {
        double whole = isnan(value) ? 0 : fmin(fmax(rint(value), type->least), type->most);
        bits = whole < 0 ? (uint64_t)(int64_t)whole : (uint64_t)whole;
    }
    memcpy(bytes, &bits, (size_t)type->bytes);
}

enum status image_new(struct image *image, const size_t size[3], size_t components, struct error *error)
{
    size_t count = components;
    *image = (struct image){.components = components,
                            .datatype = IMAGE_FLOAT32,
                            .slope = 1,
                            .unit = 1e-3,
                            .version = 1,
                            .intent = components > 1 ? IMAGE_INTENT_VECTOR : 0};
    for (int i = 0; i < 3; i++) {
        image->size[i] = size[i];
        image->to_world[i][i] = image->unit;
        if (__builtin_mul_overflow(count, size[i], &count)) {
            return fail_memory(error, "values of the image");
        }
    }
    return count > INT64_MAX ? fail_memory(error, "values of the image")
                             : NEW_ARRAY(&image->values, (int64_t)count, error);
}

double image_whole(const struct image *image, double value)
{
    double step = fabs(image->slope), whole = rint(value);
    double half = nifti_type(image->datatype)->most > 0 && step <= 0.5 ? step / 2 : 0;
    double rounding = 2 * (double)FLT_EPSILON * (1 + fabs(value) + fabs(image->inter));
    return fabs(value - whole) <= half + rounding ? whole : NAN;
}

void image_free(struct image *image)
{
    FREE_ALL(image->values, image->segment);
    *image = (struct image){0};
}

size_t image_voxels(const struct image *image)
{
    return image->size[0] * image->size[1] * image->size[2];
}

/* ---- places of voxels ---- */

void image_map(const double *m, const double x[3], double place[3])
{
    for (int r = 0; r < 3; r++, m += 4) {
        place[r] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2] + m[3];
    }
}

double image_step(const struct image *image, int axis)
{
    return hypot(hypot(image->to_world[0][axis], image->to_world[1][axis]), image->to_world[2][axis]);
}

void image_world(const struct image *image, const double voxel[3], double world[3])
{
    image_map(&image->to_world[0][0], voxel, world);
}

double image_distance(const struct image *a, const struct image *b)
{
    double most = 0;
    for (int corner = 0; corner < 8; corner++) {
        double voxel[3], at_a[3], at_b[3];
        for (int d = 0; d < 3; d++) {
            voxel[d] = corner >> d & 1 ? (double)(a->size[d] - 1) : 0;
        }
        image_world(a, voxel, at_a);
        image_world(b, voxel, at_b);
        most = fmax(most, vector_distance(3, at_a, at_b));
    }
    return most;
}

void image_to_voxel(const struct image *image, double inverse[3][4])
{
    const double(*m)[4] = image->to_world;
    double linear[3][3];
    (void)matrix_inverse(m[0], m[1], m[2], linear);
    for (int r = 0; r < 3; r++) {
        memcpy(inverse[r], linear[r], sizeof linear[r]);
        inverse[r][3] = -(inverse[r][0] * m[0][3] + inverse[r][1] * m[1][3] + inverse[r][2] * m[2][3]);
    }
}

void image_note(struct image *image, const char *format, ...)
{
    text_append(image->note, sizeof image->note, "%s", image->note[0] != '\0' ? "; " : "");
    size_t length = strlen(image->note);
    va_list values;
    va_start(values, format);
    vsnprintf(image->note + length, sizeof image->note - length, format, values);
    va_end(values);
}

/* ---- values between the voxels ---- */

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
