static const char usage[] =
    "unpart - put the parts of a body together\n"
    "\n"
    "usage: unpart [-t] [-o FILE] PART...\n"
    "\n"
    "Reads all parts that part has written, in any order, and writes the stream of the whole body: nodes,\n"
    "cells, groups, what ipoints, support and shapefn have added to the parts, and fields at nodes and\n"
    "points, in the order of the mesh. Every row comes from the part that owns it. It equals, bit for bit,\n"
    "what these tools compute for the whole body. Tables of the body as a whole (reactions, energy) and\n"
    "unknown sections are left out, with a note.\n"
    "\n"
    "These are refused: parts of different cuts, a part that is missing or given twice, and parts on which\n"
    "different stages or options were run; and a part where a list of neighbours has nodes at the edge of\n"
    "its halo, as the list may differ from that of the whole body (then cut with a larger part -w).\n"
    "\n"
    "Options:\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output FILE      write to FILE, none of the inputs, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  unpart part.*.mts > table.mts\n";

#include "parts/rejoin.h"

#include <limits.h>

int main(int argc, char *argv[])
{
    struct tool tool;
    FREED_BY(rejoin_free) struct rejoin rejoin = {0};
    FREED_BY(stream_free) struct stream stream = {0};
    tool_begin(&tool, usage, 1, INT_MAX, argc, argv);
    rejoin_begin(&rejoin, &tool, tool.operands, tool.operand_count);
    rejoin_sections(&rejoin, &stream);
    stream_inherit(&stream, &rejoin.part[0].stream); /* all parts have the same provenance */
    tool_write(&tool, &stream);
    return tool_end(&tool);
}
