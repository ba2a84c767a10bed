/* The parts of a body as the input of mtled: each process reads the files of some parts, and its rows of the
 * large tables; what is small of all parts goes to all. */
#pragma once

#include "tool.h"

struct parts_input {
    bool given;           /* the input is in parts */
    uint32_t identity;    /* checksum of all parts, whoever reads them */
    int32_t *face_reader; /* of each row that faces are averaged over: the process that has read it; NULL:
                             each has all */
};

/* Does this operand name the files of parts: has it %d, where their numbers go? */
bool parts_are_named(const char *operand);

/* Read the parts of that name and put them together, as unpart does; of averages over faces rows that other
 * processes have read are empty. All processes call this together, and exit with one message on failure. */
void parts_read(const struct tool *tool, const char *operand, struct stream *stream,
                struct parts_input *parts);
void parts_free(struct parts_input *parts);
