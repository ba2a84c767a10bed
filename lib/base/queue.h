/* Priority queue of path ends, shortest path first: a binary heap, for shortest paths through a graph
 * (Dijkstra's algorithm). A zero-initialised queue is empty. */
#pragma once

#include "base/status.h"

#include <stdint.h>

struct path_end {
    double length;
    int32_t node;
};

struct queue {
    int64_t count, capacity;
    struct path_end *end;
};

/* Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status queue_push(struct queue *queue, double length, int32_t node, struct error *error);

/* Takes the shortest one out, of equal lengths that of the lower node; count > 0. */
struct path_end queue_pop(struct queue *queue);

void queue_free(struct queue *queue);
