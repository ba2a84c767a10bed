#include "thin_note.h"

#include "approx/support.h"
#include "approx/thin.h"

/* A body is thin where its thickness is less than this, in lengths of cells. A clamped plate of 60 x 20 x 4
 * mm, nu .49, is too stiff by half with cells as long as it is thick, by a tenth with half of that, by 4 %
 * with a third (mixed elements on the finest cells). Reported from this share of the boundary on. */
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
                  "%s m: they bend too stiffly, up to several times where thinner than their cells are long; "
                  "by about a tenth with cells half as long as they are thick",
                  100.0 * thin.share, thin.least, place);
    }
}
