/* The cloud and the tables of shape functions in a stream, as input of assembly. */
#pragma once

#include "io/stream/stream.h"
#include "solid/assembly/assembly.h"

/* Set the first part of *input, up to cell_side, as views of the stream, and complete it
 * (assembly_complete). STATUS_INPUT for sections that are missing or do not fit. */
MUST_CHECK enum status stage_tables(const struct stream *stream, struct assembly *input, struct error *error);
