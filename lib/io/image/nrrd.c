/* NRRD headers (teem.sourceforge.net/nrrd/format.html), and segmentations as 3D Slicer writes them. */
#include "io/image/text_header.h"

#include "base/options.h"

#include <math.h>
#include <string.h>
#include <strings.h>

enum { AXES = 4 };

/* What an axis of the array is. */
enum kind { DOMAIN, LIST, VECTOR, COLOUR };

/* The fields of a header as they stand. */
struct nrrd {
    struct image *image;
    struct image_layout layout;
    int64_t dimension, space_dimension;
    double size[AXES], direction[AXES][3], spacing[AXES], first[AXES], origin[3];
    bool has_direction[AXES], has_directions, is_cell_centred;
    int endian, encoding; /* 1: big; enum image_encoding */
    enum kind kind[AXES];
    double sign[3];      /* of the space's axes, to RAS */
    double frame[3][3];  /* the axes of vectors in the space */
    double unit[3];      /* of the space's axes, m */
    double length[AXES]; /* unit of an axis, m */
};

static enum status set_space(void *context, const struct text_header *header, struct error *error)
{
    static const struct {
        const char *names;
        double sign[3];
        int space;
    } spaces[] = {{"right-anterior-superior|RAS", {1, 1, 1}, IMAGE_SPACE_SCANNER},
                  {"left-anterior-superior|LAS", {-1, 1, 1}, IMAGE_SPACE_SCANNER},
                  {"left-posterior-superior|LPS", {-1, -1, 1}, IMAGE_SPACE_SCANNER},
                  {"scanner-xyz|3D-right-handed", {1, 1, 1}, IMAGE_SPACE_UNKNOWN}};
    struct nrrd *nrrd = context;
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++) {
        if (header_is(spaces[s].names, header->value)) {
            memcpy(nrrd->sign, spaces[s].sign, sizeof nrrd->sign);
            nrrd->image->space = spaces[s].space;
            nrrd->space_dimension = 3;
            return STATUS_OK;
        }
    }
    return header_fail(header,
                       text_ends(header->value, "time") || text_ends(header->value, "T")
                           ? "choose one volume and save it as an image of its own"
                           : "spaces of left, right, anterior, posterior and superior are read",
                       error);
}

static enum status set_centers(void *context, const struct text_header *header, struct error *error)
{
    (void)error;
    ((struct nrrd *)context)->is_cell_centred = strstr(header->value, "cell") != NULL;
    return STATUS_OK;
}

/* Vectors "(1,0,0)" of the space: the origin, the measurement frame; or for each dimension one, or none. */
static enum status set_vectors(void *context, const struct text_header *header, struct error *error)
{
    struct nrrd *nrrd = context;
    bool origin = header_is("space origin", header->key), axes = header_is("space directions", header->key);
    bool good = nrrd->space_dimension > 0;
    int64_t count = origin ? 1 : axes ? nrrd->dimension : nrrd->space_dimension;
    const char *at = header->value;
    for (int v = 0; v < count && good; v++) {
        double *vector = origin ? nrrd->origin : axes ? nrrd->direction[v] : nrrd->frame[v];
        at += strspn(at, " \t");
        if (axes && strncasecmp(at, "none", 4) == 0) {
            at += 4;
            continue;
        }
        good = *at++ == '(' && header_numbers(&at, (int)nrrd->space_dimension, vector) && *at == ')' &&
               (origin || axes || isfinite(vector[0] + vector[1] + vector[2]));
        at += good;
        nrrd->has_direction[v] = nrrd->has_direction[v] || axes;
        nrrd->has_directions = nrrd->has_directions || axes;
    }
    return good && *at == '\0' && (!axes || nrrd->has_directions)
               ? STATUS_OK
               : header_fail(header,
                             axes ? "a vector (X,Y,Z) of the space, or none, for each dimension is expected"
                                  : "a vector (X,Y,Z) of the space is expected",
                             error);
}

/* Words in quotes, each a unit of length; "" is mm: of the axes of the space or of the array. */
static enum status set_units(void *context, const struct text_header *header, struct error *error)
{
    struct nrrd *nrrd = context;
    bool of_space = header_is("space units", header->key);
    int64_t count = of_space ? nrrd->space_dimension : nrrd->dimension;
    double *unit = of_space ? nrrd->unit : nrrd->length;
    const char *at = header->value;
    for (int i = 0; i < count; i++) {
        char word[16];
        struct error why;
        at += strcspn(at, "\"");
        size_t length = *at == '"' ? strcspn(at + 1, "\"") : 0;
        if (*at == '\0' || at[1 + length] != '"' || length >= sizeof word) {
            return header_fail(header, "a unit in quotes for each dimension is expected, as \"mm\"", error);
        }
        memcpy(word, at + 1, length);
        word[length] = '\0';
        at += length + 2;
        if (length > 0 && parse_length_unit(word, "unit", &unit[i], &why) != STATUS_OK) {
            return header_fail(header, "\"m\", \"cm\", \"mm\" and \"um\" are read", error);
        }
    }
    return STATUS_OK;
}

/* Kinds that are not here are lists of values. */
static enum status set_kinds(void *context, const struct text_header *header, struct error *error)
{
    static const char *const names[] = {
        [DOMAIN] = "domain|space|???|none",
        [LIST] = "",
        [VECTOR] = "vector|covariant-vector|normal|3-vector|3-gradient|3-normal|2-vector",
        [COLOUR] = "RGB-color|3-color|RGBA-color|4-color"};
    struct nrrd *nrrd = context;
    const char *at = header->value;
    for (int a = 0; a < nrrd->dimension; a++) {
        char word[32];
        size_t length = strcspn(at, " \t");
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : 0), at);
        nrrd->kind[a] = LIST;
        for (int k = DOMAIN; k <= COLOUR; k++) {
            nrrd->kind[a] = header_is(names[k], word) ? (enum kind)k : nrrd->kind[a];
        }
        if (length == 0) {
            return header_fail(header, "a word for each dimension is expected", error);
        }
        if (header_is("time", word)) {
            return header_fail(header, "choose one volume and save it as an image of its own", error);
        }
        at += length + strspn(at + length, " \t");
    }
    return STATUS_OK;
}

/* Fields of which it counts whether they are there. */
enum { SIZES, SPACINGS, MINS, MAXS, ENDIAN, ORIGIN };

#define AT(member) offsetof(struct nrrd, member)

static const struct header_field fields[] = {
    [SIZES] = {"sizes", HEADER_VECTOR, AT(size)},
    [SPACINGS] = {"spacings", HEADER_VECTOR, AT(spacing)},
    [MINS] = {"axis mins|axismins", HEADER_VECTOR, AT(first)},
    [MAXS] = {"axis maxs|axismaxs", .set = NULL},
    [ENDIAN] = {"endian", HEADER_WORD, AT(endian), .words = "little big"},
    [ORIGIN] = {"space origin", .set = set_vectors},
    {"type", HEADER_TYPE, AT(layout)},
    {"dimension", HEADER_INTEGER, AT(dimension), 2, AXES},
    {"space dimension", HEADER_INTEGER, AT(space_dimension), 2, 3},
    {"space", .set = set_space},
    {"centers|centerings", .set = set_centers},
    {"space directions", .set = set_vectors},
    {"measurement frame", .set = set_vectors},
    {"space units", .set = set_units},
    {"units", .set = set_units},
    {"kinds", .set = set_kinds},
    {"encoding", HEADER_WORD, AT(encoding), .words = "raw gzip|gz ascii|text|txt"},
    {"line skip|lineskip", HEADER_INTEGER, AT(layout.skip_lines), 0, INT32_MAX},
    {"byte skip|byteskip", HEADER_INTEGER, AT(layout.skip_bytes), -1, HEADER_SKIP},
    {"data file|datafile", HEADER_FILE, AT(layout)},
    {"content", HEADER_TEXT, AT(image)},
    {"number|block size|blocksize|min|max|old min|oldmin|old max|oldmax|labels|thicknesses|sample units|"
     "sampleunits",
     HEADER_LEFT},
};

enum { FIELDS = sizeof fields / sizeof *fields };

/* Find the axis of the values at a voxel, -1: none; the others are those of the voxels. */
static enum status find_component(const struct nrrd *nrrd, int *component, struct error *error)
{
    int places = 0;
    for (int a = 0; a < nrrd->dimension; a++) {
        bool is_place = nrrd->kind[a] == DOMAIN && (!nrrd->has_directions || nrrd->has_direction[a]);
        if (is_place ? ++places > 3 : *component >= 0) {
            return fail(error, STATUS_INPUT,
                        "header: dimension %d: two or three of voxels and one of the values there are read: "
                        "choose one volume and save it as an image of its own",
                        a + 1);
        }
        *component = is_place ? *component : a;
    }
    if (places < 2) {
        return fail(error, STATUS_INPUT, "header: %d dimensions of voxels: an image has 2 or 3", places);
    }
    return *component > 0 && *component < nrrd->dimension - 1
               ? fail(error, STATUS_INPUT,
                      "header: dimension %d holds the values at a voxel: the first or last can",
                      *component + 1)
               : STATUS_OK;
}

/* Vectors have the axes of the measurement frame, else of the space; in memory they are LPS, as in NIfTI
 * files of ITK. Unsigned numbers are lists: colours are called vectors, too. */
static void set_values(struct nrrd *nrrd, int component)
{
    struct image *image = nrrd->image;
    nrrd->layout.together = component == 0;
    const struct nifti_type *type = nrrd->layout.type;
    if (component < 0 || nrrd->kind[component] != VECTOR || nrrd->size[component] > 3 ||
        (type->least == 0 && type->most > 0)) {
        return;
    }
    image->intent = IMAGE_INTENT_VECTOR;
    nrrd->layout.turned = true;
    for (int r = 0; r < 3; r++) {
        double sign = r < 2 && image->space != IMAGE_SPACE_UNKNOWN ? -nrrd->sign[r] : 1;
        for (int c = 0; c < 3; c++) {
            nrrd->layout.turn[r][c] = sign * nrrd->frame[c][r];
        }
    }
}

static enum status place(struct nrrd *nrrd, const struct text_header *header, struct error *error)
{
    double size[3] = {1, 1, 1}, matrix[3][4] = {{0}};
    struct image *image = nrrd->image;
    int component = -1, places = 0;
    RETURN_IF_ERROR(find_component(nrrd, &component, error));
    image->unit = nrrd->has_directions ? nrrd->unit[0] : nrrd->length[component == 0 ? 1 : 0];
    if (!nrrd->has_directions) {
        image->space = IMAGE_SPACE_UNKNOWN;
    }
    set_values(nrrd, component);
    for (int a = 0; a < nrrd->dimension; a++) {
        if (a == component) {
            continue;
        }
        size[places] = nrrd->size[a];
        for (int r = 0; r < 3 && nrrd->has_directions; r++) {
            matrix[r][places] = nrrd->sign[r] * nrrd->unit[r] * nrrd->direction[a][r];
            matrix[r][3] = nrrd->sign[r] * nrrd->unit[r] * nrrd->origin[r];
        }
        if (!nrrd->has_directions) {
            matrix[places][places] = nrrd->length[a] * nrrd->spacing[a];
            matrix[places][3] = nrrd->length[a] * nrrd->first[a];
        }
        places++;
    }
    if (image->space == IMAGE_SPACE_UNKNOWN) {
        image_note(image, "%s",
                   nrrd->has_directions || header_has(header, SPACINGS)
                       ? "has no anatomical space: axes taken to be RAS"
                       : "has neither spacing nor anatomical space: 1 mm, and axes RAS, taken");
    }
    if (nrrd->has_directions && !header_has(header, ORIGIN)) {
        image_note(image, "has no space origin: the first voxel lies at 0");
    }
    header_note_unknown(header, image);
    RETURN_IF_ERROR(header_sizes(size, component < 0 ? 1 : nrrd->size[component],
                                 component >= 0 && nrrd->kind[component] == COLOUR, &nrrd->layout, image,
                                 error));
    return image_place(image, matrix, nrrd->has_directions ? "space directions" : "spacings", error);
}

static enum status check(const struct nrrd *nrrd, const struct text_header *header, struct error *error)
{
    const struct image_layout *layout = &nrrd->layout;
    bool ends_alone = header_has(header, MAXS) && !header_has(header, SPACINGS);
    bool cells = header_has(header, MINS) && nrrd->is_cell_centred;
    if (layout->type == NULL || !header_has(header, SIZES)) {
        return fail(error, STATUS_INPUT, "header: no %s: cut short?",
                    layout->type == NULL ? "type" : "sizes");
    }
    if (header->cut && layout->data_file[0] == '\0') {
        return fail(error, STATUS_INPUT, "cut short: the header ends without an empty line");
    }
    if (!nrrd->has_directions && (nrrd->space_dimension > 0 || ends_alone || cells)) {
        return fail(
            error, STATUS_INPUT,
            "header: %s without space directions: where the voxels lie is not known: save it with these",
            nrrd->space_dimension > 0 ? "a space"
            : ends_alone              ? "axis maxs"
                                      : "axis mins of cells");
    }
    if (layout->type->bytes > 1 && layout->encoding != IMAGE_ASCII && !header_has(header, ENDIAN)) {
        return fail(error, STATUS_INPUT, "header: no endian: the byte order of %s is not known",
                    layout->type->name);
    }
    return STATUS_OK;
}

enum status nrrd_header(struct image_bytes *file, struct image *image, struct image_layout *layout,
                        struct error *error)
{
    struct text_header header = {.file = file, .separator = ':'};
    struct nrrd nrrd = {.image = image,
                        .sign = {1, 1, 1},
                        .frame = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        .spacing = {1, 1, 1, 1},
                        .unit = {1e-3, 1e-3, 1e-3},
                        .length = {1e-3, 1e-3, 1e-3, 1e-3}};
    header.dimension = &nrrd.dimension;
    RETURN_IF_ERROR(header_line(&header, error));
    if (strlen(header.line) != 8 || strncmp(header.line, "NRRD000", 7) != 0 ||
        strchr("123456", header.line[7]) == NULL) {
        return fail(error, STATUS_INPUT, "begins with '%.20s': NRRD0001 to NRRD0006 are read", header.line);
    }
    RETURN_IF_ERROR(header_next(&header, error));
    while (header.key != NULL) {
        RETURN_IF_ERROR(header.is_pair ? image_segment_field(image, &header, error)
                                       : header_set(&header, fields, FIELDS, &nrrd, error));
        RETURN_IF_ERROR(header_next(&header, error));
    }
    nrrd.layout.swapped = nrrd.endian == 1;
    nrrd.layout.encoding = (enum image_encoding)nrrd.encoding;
    RETURN_IF_ERROR(check(&nrrd, &header, error));
    RETURN_IF_ERROR(place(&nrrd, &header, error));
    *layout = nrrd.layout;
    return STATUS_OK;
}
