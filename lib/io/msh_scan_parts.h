/* The sections that the scan looks into. Each function is called behind the line "$Name", and stops where
 * "$EndName" should be; what it learns goes into *scan. */
#ifndef IO_MSH_SCAN_PARTS_H
#define IO_MSH_SCAN_PARTS_H

#include "io/msh_cursor.h"
#include "io/msh_scan.h"

/* libgmsh keeps many tags as int. */
#define MSH_LARGEST_TAG INT32_MAX

MUST_CHECK enum status msh_scan_format(struct msh_scan *scan, struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_names(struct msh_scan *scan, struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_entities(struct msh_scan *scan, struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_nodes(struct msh_scan *scan, struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_elements(struct msh_scan *scan, struct msh_cursor *cursor);

#endif
