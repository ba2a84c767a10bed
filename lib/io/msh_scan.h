/* The check of a mesh file that comes before libgmsh sees it: the whole grammar of MSH 1, 2.x, 4.0 and 4.1 is
 * followed, number by number, so that what libgmsh reads is known to be whole and consistent. (libgmsh 4.8
 * runs as a script what does not begin with $MeshFormat, trusts counts and tags, and takes truncated files
 * for good.) */
#ifndef IO_MSH_SCAN_H
#define IO_MSH_SCAN_H

#include "base/status.h"
#include "io/msh_index.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The sections that libgmsh is given. */
enum msh_part { MSH_FORMAT, MSH_NAMES, MSH_ENTITIES, MSH_NODES, MSH_ELEMENTS, MSH_PART_COUNT };

struct msh_name {
    int dim, tag;
    char *name;
};

struct msh_scan {
    int version; /* 10, 20..22, 40 or 41: ten times the version of the file */
    bool binary;
    bool partitioned; /* MSH 2: elements name partitions */
    struct {
        size_t from,
            to; /* bytes of the file from "$Name" to the end of "$EndName"; to = 0: not in the file */
    } part[MSH_PART_COUNT];
    /* What libgmsh is given in place of a part, where text is not NULL: MSH 1 becomes MSH 2.2, and partitions
     * disappear. */
    struct msh_rewritten {
        char *text;
        size_t size, room;
    } rewritten[MSH_PART_COUNT];
    struct {
        size_t from, to; /* bytes of the file: the entities of each dimension in $Entities */
    } entities[4];
    int64_t entity_count[4];
    int64_t node_count;
    int64_t *node_tag; /* node_count, in the order of the file */
    struct msh_index nodes;
    int64_t element_count;
    int64_t *element_tag;   /* element_count, in the order of the file */
    int8_t *element_type;   /* element_count */
    int32_t *element_group; /* element_count, MSH 2 only (else NULL): tag of the physical group, 0 for none */
    struct msh_index elements;
    int64_t name_count;
    struct msh_name *names; /* $PhysicalNames, in the order of the file */
};

/* How to make a mesh of a file that is none, from its first bytes: ": a VTK file: ...", or "". */
const char *msh_foreign_hint(const char *bytes, size_t size);

/* Do these first bytes of a file begin a mesh? Call with at least MSH_MAGIC_SIZE bytes, or all there are. */
#define MSH_MAGIC_SIZE 12
bool msh_is_mesh(const char *bytes, size_t size);

/* Check a whole file of `size` bytes. STATUS_INPUT with a message naming section and record. Memory in
 * proportion to the size only. On failure *scan is empty. */
MUST_CHECK enum status msh_scan(struct msh_scan *scan, const char *bytes, size_t size, struct error *error);
void msh_scan_free(struct msh_scan *scan);

#endif
