#include "cell_report.h"

#include "approx/cells/parts.h"
#include "approx/support/support.h"
#include "approx/cells/thin.h"
#include "base/lists.h"
#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>

enum status cell_report_make(const struct cells *cells, double bound, struct cell_report *report,
                             struct error *error)
{
    *report = (struct cell_report){0};
    NEW_SCRATCH(int32_t, part, cells->count, error);
    RETURN_IF_ERROR(cells_parts(cells, part, &report->bodies, error));
    NEW_SCRATCH(double, quality, cells->count, error);
    for (int64_t c = 0; c < cells->count; c++) {
        quality[c] = cell_quality(cells, c);
        report->volume += cell_volume(cells, c);
    }
    qsort(quality, (size_t)cells->count, sizeof *quality, compare_double);
    report->least_median[0] = cells->count > 0 ? quality[0] : 0;
    report->least_median[1] = cells->count > 0 ? quality[cells->count / 2] : 0;
    report->poor = cells_poorest(cells, bound, CELL_REPORT_MOST, report->poorest);
    report->listed = report->poor < CELL_REPORT_MOST ? (int)report->poor : CELL_REPORT_MOST;
    return STATUS_OK;
}

const char *cell_report_describe(const struct cells *cells, const struct poor_cell *poor, char text[128])
{
    double centre[3];
    cell_centroid(cells, poor->cell, centre);
    snprintf(text, 128, "quality %.2g at", poor->quality);
    for (int k = 0; k < cells->dim; k++) {
        text_append(text, 128, " %.4g", centre[k]);
    }
    text_append(text, 128, " m");
    return text;
}

const char *cell_report_box(const struct box *box, char text[128])
{
    text[0] = '\0';
    for (int k = 0; k < 2 * box->dim; k++) {
        text_append(text, 128, "%s%.4g ", k == box->dim ? "to " : "",
                    k < box->dim ? box->low[k] : box->high[k - box->dim]);
    }
    text_append(text, 128, "m");
    return text;
}

/* A body is thin where its thickness is less than `bound` cells; this is reported if it holds for at least
 * `noted_share` of the boundary. A clamped plate of 60 x 20 x 4 mm with nu .49 is too stiff by 50 % with
 * cells as long as it is thick, by 10 % with cells of half that size, by 4 % with a third (compared with
 * mixed elements on the finest cells). */
static const double bound = 1.5, noted_share = 0.1;

void tool_note_thin(const struct tool *tool, const struct cells *cells)
{
    struct thin_report thin;
    char place[96];
    TOOL_TRY(tool, cells_find_thin(cells, bound, &thin, &error));
    if (thin.share > noted_share) {
        point_text(cells->dim, thin.place, place);
        tool_note(tool,
                  "%.0f %% of the boundary is on parts about one cell thick, the thinnest %.2g of a cell at "
                  "%s m: they bend too stiffly, by half or more, where thinner than their cells are long; "
                  "else by up to a tenth too stiffly or too softly",
                  100.0 * thin.share, thin.least, place);
    }
}
