/* The map from voxels to world coordinates: sform, qform, voxel sizes. */
#include "io/image/image_private.h"

#include "base/vector.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

void image_map(const double *m, const double x[3], double place[3])
{
    for (int r = 0; r < 3; r++, m += 4) {
        place[r] = m[0] * x[0] + m[1] * x[1] + m[2] * x[2] + m[3];
    }
}

static double column_length(double m[3][4], int c)
{
    return sqrt(m[0][c] * m[0][c] + m[1][c] * m[1][c] + m[2][c] * m[2][c]);
}

double image_step(const struct image *image, int axis)
{
    return hypot(hypot(image->to_world[0][axis], image->to_world[1][axis]), image->to_world[2][axis]);
}

void image_world(const struct image *image, const double voxel[3], double world[3])
{
    image_map(&image->to_world[0][0], voxel, world);
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

/* NIfTI-1 standard, "quaternion representation of rotation matrix"; lengths and signs in pixdim. */
static void from_qform(const struct nifti *header, double m[3][4])
{
    double b = header->quatern[0], c = header->quatern[1], d = header->quatern[2];
    double rest = 1 - b * b - c * c - d * d, a = sqrt(fmax(rest, 0));
    if (rest < 1e-7) { /* half a turn; b, c, d are rounded */
        double length = sqrt(b * b + c * c + d * d);
        a = 0, b /= length, c /= length, d /= length;
    }
    const double rotation[3][3] = {{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
                                   {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
                                   {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
    double side = header->pixdim[0] < 0 ? -1 : 1;
    for (int r = 0; r < 3; r++) {
        m[r][0] = rotation[r][0] * fabs(header->pixdim[1]);
        m[r][1] = rotation[r][1] * fabs(header->pixdim[2]);
        m[r][2] = rotation[r][2] * fabs(header->pixdim[3]) * side;
        m[r][3] = header->qoffset[r];
    }
}

bool nifti_quaternion(double matrix[3][4], double quatern[3], double pixdim[4])
{
    double r[3][3];
    for (int c = 0; c < 3; c++) {
        pixdim[1 + c] = column_length(matrix, c);
    }
    pixdim[0] = determinant3(matrix[0], matrix[1], matrix[2]) < 0 ? -1 : 1;
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < 3; i++) {
            r[i][c] = matrix[i][c] / pixdim[1 + c] * (c == 2 ? pixdim[0] : 1);
        }
    }
    for (int c = 0; c < 3; c++) {
        int e = (c + 1) % 3;
        if (fabs(r[0][c] * r[0][e] + r[1][c] * r[1][e] + r[2][c] * r[2][e]) > 1e-5) {
            return false;
        }
    }
    /* (1 + trace) / 4 is a^2; with two signs changed it is b^2, c^2 or d^2. Divide by the largest of these.
     */
    double square[4] = {1 + r[0][0] + r[1][1] + r[2][2], 1 + r[0][0] - r[1][1] - r[2][2],
                        1 - r[0][0] + r[1][1] - r[2][2], 1 - r[0][0] - r[1][1] + r[2][2]};
    double product[4][4] = {{square[0], r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]},
                            {r[2][1] - r[1][2], square[1], r[0][1] + r[1][0], r[0][2] + r[2][0]},
                            {r[0][2] - r[2][0], r[0][1] + r[1][0], square[2], r[1][2] + r[2][1]},
                            {r[1][0] - r[0][1], r[0][2] + r[2][0], r[1][2] + r[2][1], square[3]}};
    int largest = 0;
    for (int i = 1; i < 4; i++) {
        largest = square[i] > square[largest] ? i : largest;
    }
    double scale = (product[largest][0] < 0 ? -0.5 : 0.5) / sqrt(square[largest]); /* a >= 0 */
    for (int i = 0; i < 3; i++) {
        quatern[i] = scale * product[largest][1 + i];
    }
    return true;
}

/* The step across an image of one slice has no meaning: make it as long as the first one if it is zero. */
static void complete_slice(double m[3][4])
{
    if (column_length(m, 2) > 0) {
        return;
    }
    double across[3], length = 0;
    for (int i = 0; i < 3; i++) {
        int next = (i + 1) % 3, last = (i + 2) % 3;
        across[i] = m[next][0] * m[last][1] - m[next][1] * m[last][0];
        length += across[i] * across[i];
    }
    for (int i = 0; i < 3 && length > 0; i++) {
        m[i][2] = across[i] / sqrt(length) * column_length(m, 0);
    }
}

static bool is_sound(double m[3][4])
{
    double volume = column_length(m, 0) * column_length(m, 1) * column_length(m, 2);
    for (int r = 0; r < 3; r++) {
        if (!isfinite(m[r][3])) {
            return false;
        }
    }
    return isfinite(volume) && volume > 0 && fabs(determinant3(m[0], m[1], m[2])) > 1e-6 * volume;
}

/* Largest distance between the positions of the image's corners under two maps. */
static double disagreement(const struct image *image, double a[3][4], double b[3][4])
{
    double most = 0;
    for (int corner = 0; corner < 8; corner++) {
        double voxel[3], at_a[3], at_b[3];
        for (int i = 0; i < 3; i++) {
            voxel[i] = corner >> i & 1 ? (double)(image->size[i] - 1) : 0;
        }
        image_map(&a[0][0], voxel, at_a);
        image_map(&b[0][0], voxel, at_b);
        most = fmax(most, hypot(hypot(at_a[0] - at_b[0], at_a[1] - at_b[1]), at_a[2] - at_b[2]));
    }
    return most;
}

enum status image_place(struct image *image, double matrix[3][4], const char *form, struct error *error)
{
    if (image->size[2] == 1) {
        complete_slice(matrix);
    }
    if (!is_sound(matrix)) {
        return fail(error, STATUS_INPUT, "header: %s gives the voxels no place: not finite, or no volume",
                    form);
    }
    memcpy(image->to_world, matrix, sizeof image->to_world);
    return STATUS_OK;
}

enum status nifti_space(const struct nifti *header, struct image *image, struct error *error)
{
    static const double unit[] = {1e-3, 1, 1e-3, 1e-6};
    double matrix[3][4] = {{0}}, other[3][4];
    const char *form = "its voxel sizes (pixdim)";
    int units = (int)header->units & 7;
    if (units > 3) {
        return fail(error, STATUS_INPUT, "header: unknown unit of length %d: metres are 1, mm 2, um 3",
                    units);
    }
    if (units == 0) {
        image_note(image, "no unit of length: millimetres taken");
    }
    image->unit = unit[units];
    if (header->sform > 0) {
        form = "its sform";
        memcpy(matrix, header->srow, sizeof matrix);
        image->space = (int)header->sform;
    } else if (header->qform > 0) {
        form = "its qform";
        from_qform(header, matrix);
        image->space = (int)header->qform;
    } else {
        for (int i = 0; i < 3; i++) {
            matrix[i][i] = fabs(header->pixdim[1 + i]);
        }
        image_note(image, "has neither sform nor qform: first voxel at the origin, axes taken to be RAS");
    }
    if (header->sform > 0 && header->qform > 0) {
        from_qform(header, other);
        if (image->size[2] == 1) {
            complete_slice(other);
            complete_slice(matrix);
        }
        double half = 0.5 * fmin(column_length(matrix, 0), column_length(matrix, 1));
        if (!(disagreement(image, matrix, other) <= half)) {
            image_note(image, "sform and qform differ by more than half a voxel: sform taken");
        }
    }
    for (int i = 0; i < 12; i++) {
        matrix[i / 4][i % 4] *= image->unit;
    }
    return image_place(image, matrix, form, error);
}
