/* Where two displacement sections name the same average, its rows come twice: once is enough, and twice is
 * one too many for the solution. */
#ifndef TOOLS_MODEL_REPEATS_H
#define TOOLS_MODEL_REPEATS_H

#include "model.h"

/* Drop each row, from number `first` on, that repeats an earlier one: same place, same direction, same pairs.
 * With another value it is an error that names both sections. */
MUST_CHECK enum status repeats_drop(const struct model_input *input, int64_t first,
                                    struct constraint_rows *rows, struct error *error);

#endif
