#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "base/memory.h"
#include "base/round_off.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static enum status check_unity(const struct neighbours *lists, const struct section *phi, struct error *error)
{
    const double *value = phi->data;
    for (int64_t row = 0; row < lists->count; row++) {
        double sum = 0;
        for (int64_t i = lists->ptr[row]; i < lists->ptr[row + 1]; i++) {
            sum += value[i];
        }
        if (!(fabs(sum - 1) <= COARSE_ROUND_OFF)) {
            return fail(error, STATUS_INPUT, "%s: list %jd: sums to 1 %+.3g", phi->name, row, sum - 1);
        }
    }
    return STATUS_OK;
}

/* Check the lists of a section PREFIX.ptr and of PREFIX.idx, and the shape functions on them. */
static enum status check_lists(const struct stream *stream, const char *ptr_name, struct error *error)
{
    char prefix[64], idx_name[72];
    struct neighbours lists;
    snprintf(prefix, sizeof prefix, "%.*s", (int)strcspn(ptr_name, "."), ptr_name);
    snprintf(idx_name, sizeof idx_name, "%s.idx", prefix);
    const struct section *ptr = stream_find(stream, ptr_name);
    if (ptr == NULL && stream_find(stream, idx_name) == NULL) {
        return STATUS_OK;
    }
    int64_t rows = ptr != NULL && ptr->rows > 0 ? ptr->rows - 1 : 0;
    RETURN_IF_ERROR(stream_neighbours(stream, prefix, rows, &lists, error));
    for (int k = 0; k < SECTION_KINDS; k++) {
        const struct section_kind *kind = &section_kinds[k];
        const struct section *phi = stream_find(stream, kind->name);
        if (kind->content == UNITY && strcmp(kind->rows_of, idx_name) == 0 && phi != NULL) {
            RETURN_IF_ERROR(check_unity(&lists, phi, error));
        }
    }
    return STATUS_OK;
}

static enum status check_groups(const struct stream *stream, struct error *error)
{
    static const enum group_kind kinds[GROUP_KINDS] = {GROUP_REGION, GROUP_FACETS, GROUP_NODES};
    for (int k = 0; k < GROUP_KINDS; k++) {
        FREED_BY(groups_free) struct groups groups = {0};
        RETURN_IF_ERROR(stream_groups(stream, kinds[k], false, &groups, error));
    }
    return STATUS_OK;
}

/* Check the faces, and the sections with a row for each of their rows or points. */
static enum status check_faces(const struct stream *stream, struct error *error)
{
    struct faces faces;
    if (stream_find(stream, "faces") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_faces(stream, &faces, error));
    const struct {
        const char *name;
        int64_t rows;
    } expected[] = {{"facepoints.x", face_point_count(&faces)},
                    {"edge.ptr", face_row_count(&faces) + 1},
                    {"boundary.ptr", face_boundary_points(&faces) + 1}};
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const struct section *section = stream_find(stream, expected[i].name);
        if (section != NULL && section->rows != expected[i].rows) {
            return fail(error, STATUS_INPUT, "%s: %jd rows, but the faces ask for %jd", section->name,
                        section->rows, expected[i].rows);
        }
    }
    return STATUS_OK;
}

static enum status note(struct names *violations, enum status status, struct error *error)
{
    return status == STATUS_INPUT ? names_add(violations, error->text, error) : status;
}

static enum status check_together(const struct stream *stream, struct names *violations, struct error *error)
{
    struct cells cells = {0};
    if (stream_find(stream, "nodes.x") != NULL) {
        RETURN_IF_ERROR(note(violations, stream_cells(stream, false, &cells, error), error));
    }
    if (violations->count > 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(note(violations, check_groups(stream, error), error));
    RETURN_IF_ERROR(note(violations, check_faces(stream, error), error));
    for (int k = 0; k < SECTION_KINDS; k++) {
        const struct section_kind *kind = &section_kinds[k];
        if (kind->content == LIST && strcmp(kind->name, "sets.ptr") != 0) {
            RETURN_IF_ERROR(note(violations, check_lists(stream, kind->name, error), error));
        }
    }
    return STATUS_OK;
}

enum status stream_check(const struct stream *stream, struct names *violations, struct error *error)
{
    for (int64_t i = 0; i < stream->section_count; i++) {
        const struct section *section = &stream->sections[i];
        const struct section_kind *kind = section_kind_of(section->name);
        if (kind != NULL) {
            RETURN_IF_ERROR(note(violations, section_check(stream, section, kind, error), error));
        }
    }
    return violations->count == 0 ? check_together(stream, violations, error) : STATUS_OK;
}
