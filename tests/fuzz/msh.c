/* Fuzz target: the check of a mesh that comes before libgmsh sees it. What passes begins as a mesh, and
 * its parts lie where the scan says. */
#include "fuzz.h"

#include "io/msh_scan.h"

#include <string.h>

static void require_parts(const struct msh_scan *scan, const char *file, size_t file_size)
{
    static const char *const names[MSH_PART_COUNT] = {"MeshFormat", "PhysicalNames", "Entities", "Nodes",
                                                      "Elements"};
    for (int part = 0; part < MSH_PART_COUNT; part++) {
        const char *bytes = file;
        size_t size = file_size;
        size_t from = scan->part[part].from, to = scan->part[part].to, length = strlen(names[part]);
        if (scan->rewritten[part].text != NULL) {
            bytes = scan->rewritten[part].text;
            from = 0;
            to = size = scan->rewritten[part].size;
        }
        if (to == 0) {
            continue;
        }
        REQUIRE(from < to && to <= size && to - from >= 2 * length + 5);
        REQUIRE(bytes[from] == '$' && memcmp(bytes + from + 1, names[part], length) == 0);
        REQUIRE(memcmp(bytes + to - length - 4, "$End", 4) == 0 &&
                memcmp(bytes + to - length, names[part], length) == 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct msh_scan scan;
    struct error error = {""};
    const char *bytes = (const char *)data;
    if (is_accepted(msh_scan(&scan, bytes, size, &error), &error)) {
        REQUIRE(msh_is_mesh(bytes, size));
        require_parts(&scan, bytes, size);
        for (int64_t n = 0; n < scan.node_count; n++) {
            REQUIRE(msh_index_find(&scan.nodes, scan.node_tag[n]) == n);
        }
        for (int64_t e = 0; e < scan.element_count; e++) {
            REQUIRE(msh_index_find(&scan.elements, scan.element_tag[e]) == e);
        }
    } else {
        REQUIRE(scan.node_tag == NULL && scan.element_tag == NULL && scan.names == NULL);
    }
    msh_scan_free(&scan);
    return 0;
}
