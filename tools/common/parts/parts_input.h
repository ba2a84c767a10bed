/* The parts of a body as the input of mtled: each process reads the files of some parts, with their rows of
 * the large tables; the small sections of all parts are sent to all. */
#pragma once

#include "tool.h"

struct parts_input {
    bool given;           /* the input is in parts */
    uint32_t identity;    /* checksum of all parts, whoever reads them */
    int32_t *edge_reader; /* of each row that faces are averaged over: the process that has read it; NULL:
                             each has all */
};

/* Whether an operand names the files of parts: it contains %d in place of their numbers. */
bool parts_are_named(const char *operand);

/* Read the parts and join them, as unpart does; rows of edges that other processes have read are
 * empty. Collective; on failure all processes exit with one message. */
void parts_read(const struct tool *tool, const char *operand, struct stream *stream,
                struct parts_input *parts);
void parts_free(struct parts_input *parts);
