/* Accumulation blocks of a sparse operator; private to sparse_operator. */
#ifndef SOLID_OPERATOR_ACCUMULATION_H
#define SOLID_OPERATOR_ACCUMULATION_H

#include "solid/sparse_operator.h"

/* Cut the blocks, whose nodes are known, into accumulation blocks, and list what each node sums. */
MUST_CHECK enum status accumulation_make(struct sparse_operator *op, struct error *error);

#endif
