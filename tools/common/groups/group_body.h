/* The groups of a stream as modifiable lists: facet groups, node sets, regions; and expressions that choose
 * their items. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/points/select.h"
#include "stages/views.h"

/* "facets", "nodes", "region": as in expressions and messages. */
extern const char *const group_kind_names[GROUP_KINDS];

struct group_list {
    struct names names;
    int64_t count, room;
    struct group_member {
        int32_t group, item; /* of names; a facet of the boundary, node or cell */
    } * member;              /* count; those of a group in their order */
    bool changed;
};

struct group_body {
    struct cells cells;    /* none: only nodes can be grouped */
    struct faces boundary; /* faces of one cell, oriented outward; named facets with their order of nodes */
    int32_t *node;         /* 0, 1, ...: the nodes as items of one corner */
    struct items items[GROUP_KINDS];
    struct group_list groups[GROUP_KINDS]; /* regions are disjoint */
    double diagonal;                       /* of the box of the nodes, m */
};

/* Read nodes, cells and groups of a stream, which must outlive the body; to be freed also on failure.
 * STATUS_INPUT for sections that do not fit, and for facets that are not the face of exactly one cell. */
MUST_CHECK enum status group_body_read(const struct stream *stream, struct group_body *body,
                                       struct error *error);
void group_body_free(struct group_body *body);

/* Add a group of the chosen items, or replace the one with this name; cells of a region are removed from
 * other regions. */
MUST_CHECK enum status group_put(struct group_body *body, enum group_kind kind, const char *name,
                                 const bool *chosen, struct error *error);
MUST_CHECK enum status group_remove(struct group_list *list, int64_t index, struct error *error);

/* STATUS_INPUT for an invalid name: one with blanks, commas, quotes or colons, or a word of the
 * expressions. */
MUST_CHECK enum status group_check_name(const char *name, struct error *error);

/* Put the modified lists into the stream. STATUS_INPUT if a cell belongs to no region. */
MUST_CHECK enum status group_body_write(const struct group_body *body, struct stream *stream,
                                        struct error *error);

/* Evaluate an expression (the usage text of tag has the grammar) for a kind of items:
 * chosen[body->items[kind].count]. Its lengths are in `unit` metres. The message of an error begins with the
 * faulty term. */
MUST_CHECK enum status group_select(const struct group_body *body, enum group_kind kind,
                                    const char *expression, double unit, bool *chosen, struct error *error);

/* The same of one term, KIND:ARGUMENTS. */
MUST_CHECK enum status group_term(const struct group_body *body, enum group_kind kind, const char *term,
                                  double unit, bool *chosen, struct error *error);
