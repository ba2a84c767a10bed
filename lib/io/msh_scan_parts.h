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
MUST_CHECK enum status msh_scan_entities(struct msh_scan *scan, const char *start, struct msh_cursor *cursor);
/* $PartitionedEntities: they become entities like others. `start` is the first byte of the file. */
MUST_CHECK enum status msh_scan_partitions(struct msh_scan *scan, const char *start,
                                           struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_nodes(struct msh_scan *scan, struct msh_cursor *cursor);
MUST_CHECK enum status msh_scan_elements(struct msh_scan *scan, struct msh_cursor *cursor);

/* Append bytes to what libgmsh is given in place of a part. */
MUST_CHECK enum status msh_rewrite(struct msh_scan *scan, enum msh_part part, const char *bytes, size_t size,
                                   struct error *error);
MUST_CHECK enum status msh_rewrite_text(struct msh_scan *scan, enum msh_part part, const char *text,
                                        struct error *error);

#endif
