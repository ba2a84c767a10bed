#include "base/queue.h"

#include "base/memory.h"

#include <stdbool.h>
#include <stdlib.h>

static bool is_shorter(const struct path_end *a, const struct path_end *b)
{
    return a->length < b->length || (a->length == b->length && a->node < b->node);
}

enum status queue_push(struct queue *queue, double length, int32_t node, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&queue->end, queue->count + 1, &queue->capacity, error));
    struct path_end end = {.length = length, .node = node};
    int64_t at = queue->count++;
    for (; at > 0 && is_shorter(&end, &queue->end[(at - 1) / 2]); at = (at - 1) / 2) {
        queue->end[at] = queue->end[(at - 1) / 2];
    }
    queue->end[at] = end;
    return STATUS_OK;
}

struct path_end queue_pop(struct queue *queue)
{
    struct path_end first = queue->end[0], last = queue->end[--queue->count];
    int64_t at = 0;
    for (int64_t child = 1; child < queue->count; child = 2 * at + 1) {
        child += child + 1 < queue->count && is_shorter(&queue->end[child + 1], &queue->end[child]);
        if (!is_shorter(&queue->end[child], &last)) {
            break;
        }
        queue->end[at] = queue->end[child];
        at = child;
    }
    queue->end[at] = last;
    return first;
}

void queue_free(struct queue *queue)
{
    free(queue->end);
    *queue = (struct queue){0};
}
