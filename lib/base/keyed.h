/* Faces of simplices, and what is found by its nodes. */
#pragma once

#include <stdint.h>

/* face[dim]: the nodes of the face opposite a vertex of a cell, node[dim + 1], oriented outward. */
void simplex_face(int dim, const int32_t *node, int vertex, int32_t *face);

/* Node indices node[dim] of a face in ascending order, in 2D -1 last: what tells it, whichever way it is
 * turned. */
void face_key(int dim, const int32_t *node, int32_t key[3]);

/* An item by its key. */
struct keyed {
    int32_t key[3];
    int64_t item;
};

/* Ascending keys, items of one key by their numbers. */
void keyed_sort(int64_t count, struct keyed *keyed);

/* Of those that are sorted: where the key of the first one ends; the first one of a key, or -1. */
int64_t keyed_end(int64_t count, const struct keyed *keyed, int64_t first);
int64_t keyed_find(int64_t count, const struct keyed *keyed, const int32_t key[3]);
