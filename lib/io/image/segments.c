/* Segmentations of 3D Slicer (.seg.nrrd): pairs SegmentN_KEY:=VALUE in an NRRD header, and one or more layers
 * of labels. _Extent only repeats where the voxels of a segment are. */
#include "io/image/text_header.h"

#include "base/memory.h"

#include <string.h>
#include <strings.h>

enum { MOST_SEGMENTS = 1000 };

/* Find the segment with a number of the header, or add it: they stand in the order of their numbers. */
static enum status find_segment(struct image *image, int number, struct image_segment **found,
                                struct error *error)
{
    size_t at = 0, count = image->segment_count;
    while (at < count && image->segment[at].number < number) {
        at++;
    }
    if (at == count || image->segment[at].number != number) {
        if (count == MOST_SEGMENTS) {
            return fail(error, STATUS_INPUT, "header: more than %d segments", MOST_SEGMENTS);
        }
        RETURN_IF_ERROR(RESIZE_ARRAY(&image->segment, (int64_t)count + 1, error));
        memmove(image->segment + at + 1, image->segment + at, (count - at) * sizeof *image->segment);
        image->segment[at] = (struct image_segment){.number = number, .label = 1, .layer = -1};
        snprintf(image->segment[at].name, sizeof image->segment->name, "Segment_%d", number + 1);
        image->segment_count++;
    }
    *found = image->segment + at;
    return STATUS_OK;
}

enum status image_segment_field(struct image *image, const struct text_header *header, struct error *error)
{
    int number, length = 0;
    struct image_segment *segment = NULL;
    if (text_ends(header->key, "Representation") && strncasecmp(header->value, "Fractional", 10) == 0) {
        return header_fail(header, "convert it to a binary labelmap in 3D Slicer", error);
    }
    if (sscanf(header->key, "Segment%6d_%n", &number, &length) != 1 || length == 0 || number < 0) {
        return STATUS_OK;
    }
    const char *key = header->key + length;
    RETURN_IF_ERROR(find_segment(image, number, &segment, error));
    if (strcmp(key, "Name") == 0 && header->value[0] != '\0') {
        if (snprintf(segment->name, sizeof segment->name, "%s", header->value) >= (int)sizeof segment->name) {
            return header_fail(header, "a name of more than 127 bytes: shorten it", error);
        }
        for (char *at = segment->name; *at != '\0'; at++) {
            if ((unsigned char)*at < ' ' || *at == 0x7f) {
                *at = '?';
            }
        }
    } else if (strcmp(key, "LabelValue") == 0) {
        return header_integer(header, 1, INT32_MAX, &segment->label, error);
    } else if (strcmp(key, "Layer") == 0) {
        return header_integer(header, 0, INT32_MAX, &segment->layer, error);
    }
    return STATUS_OK;
}

/* Set the layers that are not given: in files before 2020 each segment is one, with the label 1. Refuse those
 * that are not there, and two segments of the same voxels. */
static enum status check_layers(struct image *image, struct error *error)
{
    struct image_segment *segment = image->segment;
    for (size_t s = 0; s < image->segment_count; s++) {
        segment[s].layer = segment[s].layer >= 0 ? segment[s].layer : image->components > 1 ? (int64_t)s : 0;
        if (segment[s].layer >= (int64_t)image->components) {
            return fail(error, STATUS_INPUT, "header: segment '%s' is in layer %jd of %zu (from 0)",
                        segment[s].name, segment[s].layer, image->components);
        }
        for (size_t o = 0; o < s; o++) {
            if (segment[o].layer == segment[s].layer && segment[o].label == segment[s].label) {
                return fail(error, STATUS_INPUT, "header: segments '%s' and '%s' have the same label, %jd",
                            segment[o].name, segment[s].name, segment[s].label);
            }
        }
    }
    return STATUS_OK;
}

/* What is found while layers are merged. */
struct merge {
    size_t unnamed;  /* values that are of no segment */
    size_t shared;   /* voxels of several segments, */
    size_t first[2]; /* and those of the first one */
};

/* The segment of a voxel's values, the last one of several; segment_count: none. *guess: of the value before.
 */
static size_t find_label(const struct image *image, const double *values, size_t *guess, struct merge *merge)
{
    size_t none = image->segment_count, found = none;
    for (size_t layer = 0; layer < image->components; layer++) {
        size_t s = *guess, tries = 0;
        if (values[layer] == 0) {
            continue;
        }
        while (tries < none && !(image->segment[s].layer == (int64_t)layer &&
                                 (double)image->segment[s].label == values[layer])) {
            s = (s + 1) % none;
            tries++;
        }
        if (tries == none) {
            merge->unnamed++;
            continue;
        }
        *guess = s;
        if (found != none && merge->shared++ == 0) {
            merge->first[0] = found;
            merge->first[1] = s;
        }
        found = found == none || s > found ? s : found;
    }
    return found;
}

static void note_merge(struct image *image, const struct merge *merge)
{
    for (size_t s = 0; s < image->segment_count; s++) {
        if (image->segment[s].voxels == 0) {
            image_note(image, "segment '%.100s' has no voxel", image->segment[s].name);
        }
    }
    if (merge->shared > 0) {
        image_note(image, "segments overlap in %zu voxels, first '%.40s' and '%.40s': the later is taken",
                   merge->shared, image->segment[merge->first[0]].name, image->segment[merge->first[1]].name);
    }
    if (merge->unnamed > 0) {
        image_note(image, "%zu voxels have a label of no segment: left out", merge->unnamed);
    }
}

enum status image_segments_merge(struct image *image, struct error *error)
{
    size_t layers = image->components, count = image_voxels(image), guess = 0;
    struct merge merge = {0};
    if (image->segment_count == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(check_layers(image, error));
    for (size_t v = 0; v < count; v++) {
        size_t s = find_label(image, image->values + v * layers, &guess, &merge);
        image->values[v] = 0;
        if (s < image->segment_count) {
            image->values[v] = layers > 1 ? (double)(s + 1) : (double)image->segment[s].label;
            image->segment[s].voxels++;
        }
    }
    note_merge(image, &merge);
    for (size_t s = 0; s < image->segment_count; s++) {
        image->segment[s].label = layers > 1 ? (int64_t)s + 1 : image->segment[s].label;
    }
    if (layers > 1) {
        image->components = 1;
        image->datatype = IMAGE_INT16;
        image->intent = 0;
    }
    return RESIZE_ARRAY(&image->values, (int64_t)count, error);
}

void image_segments_print(const struct image *image, FILE *file)
{
    if (image->segment_count > 0) {
        fprintf(file, "Segmentation_ContainedRepresentationNames:=Binary labelmap|\n"
                      "Segmentation_MasterRepresentation:=Binary labelmap\n"
                      "Segmentation_ReferenceImageExtentOffset:=0 0 0\n");
    }
    for (size_t s = 0; s < image->segment_count; s++) {
        fprintf(file,
                "Segment%zu_ID:=Segment_%zu\nSegment%zu_Name:=%s\nSegment%zu_LabelValue:=%jd\n"
                "Segment%zu_Layer:=0\nSegment%zu_Extent:=0 %zu 0 %zu 0 %zu\n",
                s, s + 1, s, image->segment[s].name, s, image->segment[s].label, s, s, image->size[0] - 1,
                image->size[1] - 1, image->size[2] - 1);
    }
}
