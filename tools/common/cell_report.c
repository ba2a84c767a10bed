#include "cell_report.h"

#include "approx/cells/parts.h"
#include "approx/cells/quality.h"
#include "approx/support/support.h"
#include "approx/points/select.h"
#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status cell_report_make(const struct cells *cells, double bound, struct cell_report *report,
                             struct error *error)
{
    *report = (struct cell_report){0};
    NEW_SCRATCH(int32_t, part, cells->count, error);
    RETURN_IF_ERROR(cells_parts(cells, part, &report->bodies, error));
    NEW_SCRATCH(struct placed, quality, cells->count, error);
    for (int64_t c = 0; c < cells->count; c++) {
        quality[c] = (struct placed){cell_quality(cells, c, NULL), c};
        report->volume += cell_volume(cells, c);
    }
    qsort(quality, (size_t)cells->count, sizeof *quality, compare_placed);
    report->least_median[0] = cells->count > 0 ? quality[0].place : 0;
    report->least_median[1] = cells->count > 0 ? quality[cells->count / 2].place : 0;
    while (report->poor < cells->count && quality[report->poor].place < bound) {
        report->poor++;
    }
    report->listed = report->poor < CELL_REPORT_MOST ? (int)report->poor : CELL_REPORT_MOST;
    memcpy(report->poorest, quality, (size_t)report->listed * sizeof *quality);
    return STATUS_OK;
}

const char *cell_report_describe(const struct cells *cells, const struct placed *poor, char text[128])
{
    double centre[3];
    cell_centroid(cells, poor->item, centre);
    snprintf(text, 128, "quality %.2g at %s m", poor->place, POINT_TEXT(cells->dim, centre));
    return text;
}

enum status cell_report_hanging(const struct cells *cells, int64_t named_count, const int32_t *named,
                                bool *parts, struct names *said, struct error *error)
{
    struct hanging_nodes found;
    RETURN_IF_ERROR(cells_find_hanging(cells, named_count, named, &found, error));
    bool joined = found.joined.count > 0;
    *parts = joined || found.twice.count > 0;
    if (found.twice.count > 0) {
        RETURN_IF_ERROR(names_print(
            said, error,
            "nodes at the same place, in one body: %jd pairs, the first at %s m: merge them (Coherence "
            "Mesh), or name the facets of a slit",
            found.twice.count, POINT_TEXT(cells->dim, found.twice.place)));
    }
    if (joined || found.apart.count > 0) {
        RETURN_IF_ERROR(names_print(
            said, error,
            "nodes on a facet of another %s, without being its corners: %jd, the first at %s m: the "
            "sides are not joined there: mesh both alike (in gmsh: BooleanFragments, or Coherence, "
            "before meshing); %s",
            joined ? "cell" : "body or face of a slit", joined ? found.joined.count : found.apart.count,
            POINT_TEXT(cells->dim, joined ? found.joined.place : found.apart.place),
            joined ? "the faces of a slit need names (physical groups)"
                   : "where they are to touch, the scene needs a contact"));
    }
    return found.touching.count == 0
               ? STATUS_OK
               : names_print(said, error,
                             "nodes at the same place, of different bodies: %jd pairs: the bodies are not "
                             "joined there (Coherence Mesh in gmsh joins them)",
                             found.touching.count);
}

/* More of the boundary than this is noted. */
static const double noted_share = 0.5;

void tool_note_thin(const struct tool *tool, const struct cells *cells)
{
    struct thin_report thin;
    TOOL_TRY(tool, cells_find_thin(cells, &thin, &error));
    if (thin.share > noted_share) {
        tool_note(tool,
                  "%.0f %% of the boundary is on parts one cell thick, as at %s m: they bend too stiffly, by "
                  "up to a "
                  "half, or more where the cells are flat: two cells over the thickness bend well",
                  100.0 * thin.share, POINT_TEXT(cells->dim, thin.place));
    }
}
