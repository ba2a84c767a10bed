/* Report on the background cells of a body: connected bodies and poor cells. */
#pragma once

#include "approx/cells/cells.h"
#include "base/lists.h"
#include "tool.h"

/* Most cells that are reported one by one. */
#define CELL_REPORT_MOST 10

/* Larger or smaller bodies are probably read in a wrong unit: diagonal, m. */
#define CELL_REPORT_LARGEST 10.0
#define CELL_REPORT_SMALLEST 1e-3

struct cell_report {
    int32_t bodies;         /* connected bodies, see cells_parts */
    double volume;          /* m3; in 2D area, m2 */
    double least_median[2]; /* least and median quality */
    int64_t poor;           /* number of cells below the bound; the poorest of them: */
    int listed;
    struct placed poorest[CELL_REPORT_MOST]; /* the quality of each, and its number */
};

/* Cells of quality below `bound` are listed. */
MUST_CHECK enum status cell_report_make(const struct cells *cells, double bound, struct cell_report *report,
                                        struct error *error);

/* "quality 3.1e-05 at (0.01, 0.02, 0.03) m" of a poor cell. */
const char *cell_report_describe(const struct cells *cells, const struct placed *poor, char text[128]);

/* Add sentences on nodes that do not join cells (select.h): "nodes on ..."; *parts: one body parts there, by
 * the first of them. */
MUST_CHECK enum status cell_report_hanging(const struct cells *cells, int64_t named_count,
                                           const int32_t *named, bool *parts, struct names *said,
                                           struct error *error);

/* Note if most of the volume is one cell thick. Exits with a message on failure. */
void tool_note_thin(const struct tool *tool, const struct cells *cells);
