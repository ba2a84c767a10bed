/* Checked allocation: sizes are overflow-checked, failures become a status. */
#pragma once

#include "base/status.h"

#include <stdint.h>

/* Zeroed array of `count` elements of `size` bytes, aligned to 64 bytes, or NULL (out of memory, or
 * count < 0, or count * size overflows). A count of 0 gives a valid pointer. A page of a large one takes
 * memory when it is first touched. Release with free(). */
void *array_new(int64_t count, size_t size);

/* Resize an array from malloc, array_grow or NULL to `count` elements; new bytes are not zeroed. On failure
 * returns NULL and the old array stays valid. The result is not 64-byte aligned. */
void *array_grow(void *array, int64_t count, size_t size);

/* The array that *pointer points to; *pointer becomes NULL. For an array that a function takes over, whose
 * former owner then frees nothing: put(array_take(&x)). */
void *array_take(void *pointer);

/* Release the memory of the whole pages within [begin, begin + bytes). Pages of a mapped file are read again
 * on the next access; others become zeros. */
void memory_give_back(const void *begin, size_t bytes);

/* *pointer = array_new(count, sizeof **pointer); evaluates to a status, with an error naming the array. */
#define NEW_ARRAY(pointer, count, error)                                                                     \
    ((*(pointer) = array_new((count), sizeof **(pointer))) != NULL ? STATUS_OK                               \
                                                                   : fail_memory((error), #pointer))

/* Resize *pointer, an array from malloc or NULL, to `count` elements; a status, as above. */
#define RESIZE_ARRAY(pointer, count, error)                                                                  \
    array_resize((void *)(pointer), (count), sizeof **(pointer), #pointer, (error))
enum status array_resize(void *pointer, int64_t count, size_t size, const char *name, struct error *error);

/* Let *pointer, an array of *room elements from malloc or NULL, have room for `needed`, and more than that,
 * so that a list may grow one by one; a status, as above. On failure the array stays valid. */
#define GROW_ARRAY(pointer, needed, room, error)                                                             \
    ((needed) <= *(room)                                                                                     \
         ? STATUS_OK                                                                                         \
         : array_grow_list((void *)(pointer), (needed), (room), sizeof **(pointer), #pointer, (error)))
enum status array_grow_list(void *pointer, int64_t needed, int64_t *room, size_t size, const char *name,
                            struct error *error);

/* free() each of these arrays. */
#define FREE_ALL(...) free_all(sizeof((void *[]){__VA_ARGS__}) / sizeof(void *), (void *[]){__VA_ARGS__})
void free_all(size_t count, void *const array[]);

/* For a local array, NULL to begin with, that is freed wherever its function is left: SCRATCH double *x =
 * NULL;
 */
#define SCRATCH __attribute__((cleanup(scratch_free)))
void scratch_free(void *pointer);

/* Such an array that is allocated at once, of zeros; on failure, return its status. */
#define NEW_SCRATCH(type, pointer, count, error)                                                             \
    SCRATCH type *pointer = NULL;                                                                            \
    RETURN_IF_ERROR(NEW_ARRAY(&pointer, (count), (error)))

/* The same for another local variable, initialised as empty: function(&variable) is called when its function
 * is left. */
#define FREED_BY(function) __attribute__((cleanup(function)))

/* Memory of one owner, freed all at once. */
struct owned {
    int64_t count;
    void **item; /* count */
};

/* Add memory from malloc, which is freed on failure; STATUS_SYSTEM, with an error naming it, also for NULL.
 */
MUST_CHECK enum status owned_add(struct owned *owned, void *memory, const char *name, struct error *error);
void owned_free(struct owned *owned);
