/* Faces of simplices, and items sorted by a key of node indices. */
#pragma once

#include <stdint.h>

/* face[dim]: the nodes of the face opposite a vertex of a cell, node[dim + 1], oriented outward. */
void simplex_face(int dim, const int32_t *node, int vertex, int32_t *face);

/* sorted[count]: a few node indices in ascending order. */
void sort_nodes(int count, const int32_t *node, int32_t *sorted);

/* The node indices node[dim] of a face in ascending order, in 2D -1 last. The key identifies the face
 * whatever its orientation. */
void face_key(int dim, const int32_t *node, int32_t key[3]);

/* An item by its key. */
struct keyed {
    int32_t key[3];
    int64_t item;
};

/* Ascending keys, items of one key by their numbers. */
void keyed_sort(int64_t count, struct keyed *keyed);

/* In a sorted array: the index behind the last item that has the key of item `first`; the index of the first
 * item with a key, or -1. */
int64_t keyed_end(int64_t count, const struct keyed *keyed, int64_t first);
int64_t keyed_find(int64_t count, const struct keyed *keyed, const int32_t key[3]);
