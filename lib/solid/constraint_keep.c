/* Rows of conditions, cut to some of the nodes. */
#include "base/memory.h"
#include "solid/constraint.h"

enum status constraint_rows_keep(const struct constraint_rows *rows, const bool *wanted,
                                 struct constraint_rows *kept, struct error *error)
{
    int64_t lists = rows->list_count, pairs = lists > 0 ? rows->ptr[lists] : 0, at = 0;
    *kept = *rows;
    kept->ptr = NULL;
    kept->idx = NULL;
    kept->phi = NULL;
    for (int64_t i = 0; i < pairs; i++) {
        at += wanted[rows->idx[i]];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&kept->ptr, lists + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&kept->idx, at, error));
    RETURN_IF_ERROR(NEW_ARRAY(&kept->phi, at, error));
    at = 0;
    for (int64_t l = 0; l < lists; l++) {
        for (int64_t i = rows->ptr[l]; i < rows->ptr[l + 1]; i++) {
            if (wanted[rows->idx[i]]) {
                kept->idx[at] = rows->idx[i];
                kept->phi[at++] = rows->phi[i];
            }
        }
        kept->ptr[l + 1] = at;
    }
    return STATUS_OK;
}

void constraint_rows_free_kept(struct constraint_rows *kept)
{
    FREE_ALL(kept->ptr, kept->idx, kept->phi);
    *kept = (struct constraint_rows){0};
}
