/* The one file that needs METIS: programs that do not cut bodies are linked without it. */
#include "approx/partition/partition.h"

#include "base/memory.h"

#include <metis.h>

/* The graph for METIS: nodes that share a cell are adjacent. The weight of a node is its share of the work of
 * its cells. */
struct graph {
    idx_t *ptr, *other, *weight;
};

static void graph_free(struct graph *graph)
{
    FREE_ALL(graph->ptr, graph->other, graph->weight);
}

/* List, unless `other` is NULL, and count the nodes that share cells with node n. */
static int64_t list_neighbours(const struct cells *cells, const struct cell_stars *stars, int64_t n,
                               int32_t *mark, idx_t *other)
{
    int vertices = cells->dim + 1;
    int64_t count = 0;
    mark[n] = (int32_t)n + 1;
    for (int64_t i = stars->ptr[n]; i < stars->ptr[n + 1]; i++) {
        const int32_t *node = cells->node + (int64_t)stars->cell[i] * vertices;
        for (int k = 0; k < vertices; k++) {
            if (mark[node[k]] != (int32_t)n + 1) {
                mark[node[k]] = (int32_t)n + 1;
                if (other != NULL) {
                    other[count] = node[k];
                }
                count++;
            }
        }
    }
    return count;
}

static enum status build_graph(const struct cells *cells, const struct cell_stars *stars, const int32_t *work,
                               struct graph *graph, struct error *error)
{
    int64_t total = 0;
    double sum = 0;
    NEW_SCRATCH(int32_t, mark, cells->node_count, error);
    for (int64_t n = 0; n < cells->node_count; n++) {
        total += list_neighbours(cells, stars, n, mark, NULL);
    }
    if (total > IDX_MAX) {
        return fail(error, STATUS_INPUT, "cells: more than %lld edges: too many for this METIS",
                    (long long)IDX_MAX / 2);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&graph->ptr, cells->node_count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&graph->other, total, error));
    RETURN_IF_ERROR(NEW_ARRAY(&graph->weight, cells->node_count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        sum += work[c];
    }
    /* METIS sums the weights in idx_t. */
    double scale = sum > 1e9 ? 1e9 / sum : 1.0;
    for (int64_t n = 0; n < cells->node_count; n++) {
        mark[n] = 0;
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        double share = 0;
        graph->ptr[n + 1] =
            graph->ptr[n] + (idx_t)list_neighbours(cells, stars, n, mark, graph->other + graph->ptr[n]);
        for (int64_t i = stars->ptr[n]; i < stars->ptr[n + 1]; i++) {
            share += work[stars->cell[i]];
        }
        graph->weight[n] = 1 + (idx_t)(scale * share / (cells->dim + 1));
    }
    return STATUS_OK;
}

enum status partition_nodes(const struct cells *cells, const struct cell_stars *stars, const int32_t *work,
                            int32_t parts, int32_t *owner, struct error *error)
{
    FREED_BY(graph_free) struct graph graph = {0};
    idx_t cut, constraints = 1, nodes = (idx_t)cells->node_count, wanted = parts;
    idx_t options[METIS_NOPTIONS];
    if (parts > cells->node_count) {
        return fail(error, STATUS_INPUT, "%d parts of %lld nodes", parts, (long long)cells->node_count);
    }
    NEW_SCRATCH(int64_t, own, parts, error);
    NEW_SCRATCH(idx_t, part, cells->node_count, error);
    if (parts > 1) {
        RETURN_IF_ERROR(build_graph(cells, stars, work, &graph, error));
        METIS_SetDefaultOptions(options);
        options[METIS_OPTION_SEED] = 1;
        options[METIS_OPTION_UFACTOR] = 10; /* balance to 1 % */
        int result = METIS_PartGraphKway(&nodes, &constraints, graph.ptr, graph.other, graph.weight, NULL,
                                         NULL, &wanted, NULL, NULL, options, &cut, part);
        if (result != METIS_OK) {
            RETURN_IF_ERROR(result == METIS_ERROR_MEMORY
                                ? fail_memory(error, "METIS")
                                : fail(error, STATUS_INPUT, "METIS cannot cut this cloud"));
        }
    }
    for (int64_t n = 0; n < cells->node_count; n++) {
        owner[n] = (int32_t)part[n];
        own[owner[n]]++;
    }
    for (int32_t k = 0; k < parts; k++) {
        if (own[k] == 0) {
            return fail(error, STATUS_INPUT, "part %d of %d would have no nodes: ask for fewer parts", k,
                        parts);
        }
    }
    return STATUS_OK;
}
