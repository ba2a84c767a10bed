#include "groups/group_body.h"

#include "approx/cells/parts.h"
#include "base/memory.h"
#include "base/options.h"

#include <string.h>

enum joint { JOIN_OR, JOIN_AND, JOIN_WITHOUT, JOINTS };
static const char *const joints[JOINTS] = {"or", "and", "without"};

static enum joint joint_of(const char *word)
{
    int joint = 0;
    while (joint < JOINTS && strcmp(word, joints[joint]) != 0) {
        joint++;
    }
    return (enum joint)joint;
}

/* "grown:N" or "shrunk:N": grow or shrink the selection so far by N rings. */
static enum status grow(const struct group_body *body, enum group_kind kind, const char *word, bool *chosen,
                        struct error *error)
{
    const struct items *items = &body->items[kind == GROUP_NODES ? GROUP_REGION : kind];
    int64_t rings = 0;
    RETURN_IF_ERROR(parse_integer(strchr(word, ':') + 1, word, 1, 1000, &rings, error));
    int64_t edge_count = kind == GROUP_FACETS ? 0 : body->boundary.count * body->cells.dim;
    return choice_grow(items->count, items->corners, items->item, body->cells.node_count, edge_count,
                       body->boundary.node, word[0] == 's' ? -(int)rings : (int)rings, kind != GROUP_NODES,
                       chosen, error);
}

/* Evaluate terms and the words between them from left to right, into chosen[]. */
static enum status evaluate(const struct group_body *body, enum group_kind kind, char *expression,
                            double unit, bool *chosen, bool *term, struct error *error)
{
    int64_t count = body->items[kind].count;
    enum joint joint = JOIN_OR;
    bool wants_term = true;
    char *rest = NULL;
    memset(chosen, 0, (size_t)count * sizeof *chosen);
    for (char *word = strtok_r(expression, " \t\n", &rest); word != NULL;
         word = strtok_r(NULL, " \t\n", &rest)) {
        bool rings = strncmp(word, "grown:", 6) == 0 || strncmp(word, "shrunk:", 7) == 0;
        if (wants_term == (rings || joint_of(word) != JOINTS)) {
            return wants_term
                       ? fail(error, STATUS_INPUT, "'%.60s' stands where a term should: see -h", word)
                       : fail(error, STATUS_INPUT,
                              "'%.60s' stands where or, and, without, grown:N or shrunk:N should: see -h",
                              word);
        }
        if (rings) {
            RETURN_IF_ERROR(grow(body, kind, word, chosen, error));
        } else if (wants_term) {
            RETURN_IF_ERROR(group_term(body, kind, word, unit, term, error));
            for (int64_t i = 0; i < count; i++) {
                chosen[i] =
                    joint == JOIN_OR ? chosen[i] || term[i] : chosen[i] && term[i] == (joint == JOIN_AND);
            }
            wants_term = false;
        } else {
            joint = joint_of(word);
            wants_term = true;
        }
    }
    if (wants_term) {
        return fail(error, STATUS_INPUT, "the expression ends where a term should stand: see -h");
    }
    return STATUS_OK;
}

enum status group_select(const struct group_body *body, enum group_kind kind, const char *expression,
                         double unit, bool *chosen, struct error *error)
{
    SCRATCH char *copy = strdup(expression);
    if (copy == NULL) {
        return fail_memory(error, "an expression");
    }
    NEW_SCRATCH(bool, term, body->items[kind].count, error);
    return evaluate(body, kind, copy, unit, chosen, term, error);
}
