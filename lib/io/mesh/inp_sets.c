/* Decks of Abaqus and CalculiX: sets, surfaces and sections. */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The set of that name, which may be new, and as "INSTANCE.NAME" is that of the part; NULL after a failure.
 */
static struct inp_set *find_set(struct inp *p, char kind, const char *text, size_t length)
{
    struct msh_reader *r = p->r;
    size_t prefix = strlen(p->instance);
    struct inp_set wanted = {.kind = kind, .of_assembly = p->in_assembly, .head = -1, .tail = -1};
    if (prefix > 0 && length > prefix && text[prefix] == '.' && strncasecmp(text, p->instance, prefix) == 0) {
        wanted.of_assembly = false;
        text += prefix + 1;
        length -= prefix + 1;
    }
    for (size_t i = 0; i < length && i < INPUT_NAME; i++) {
        wanted.name[i] = (char)toupper((unsigned char)text[i]);
    }
    int64_t *number = input_name(p->r, kind * 2 + wanted.of_assembly, wanted.name, length);
    MSH_GROW(r, &p->sets, p->set_count + 1, &p->set_room);
    if (r->status == STATUS_OK && *number == 0) {
        struct inp_set *set = NULL;
        MSH_NEW(r, &set, 1);
        r->status = r->status == STATUS_OK ? owned_add(&r->texts, set, "sets", r->error) : r->status;
        if (r->status == STATUS_OK) {
            *set = wanted;
            memcpy(set->name, text, length);
            p->sets[p->set_count++] = set;
            *number = p->set_count;
        }
    }
    return r->status == STATUS_OK ? p->sets[*number - 1] : NULL;
}

static void add_item(struct inp *p, const struct inp_item *item)
{
    struct msh_reader *r = p->r;
    MSH_GROW(r, &p->items, p->item_count + 1, &p->item_room);
    if (r->status == STATUS_OK) {
        p->items[p->item_count] = *item;
        p->items[p->item_count++].line = p->number;
    }
}

static void define(const struct inp *p, struct inp_set *set)
{
    set->line = set->line == 0 ? p->number : set->line;
}

void inp_add_places(struct inp *p, char kind, const char *name, int64_t first, int64_t end)
{
    struct inp_item item = {
        .set = find_set(p, kind, name, strlen(name)), .how = INP_PLACES, .first = first, .last = end - 1};
    if (item.set != NULL) {
        define(p, item.set);
        add_item(p, &item);
    }
}

static bool is_number(const char *word, int64_t length)
{
    int64_t digits = 0;
    while (digits < length && isdigit((unsigned char)word[digits])) {
        digits++;
    }
    return length > 0 && digits == length;
}

/* The members that a word names: a number, or a set. */
static void add_word(struct inp *p, struct inp_item *item, char kind, const char *word, int64_t length)
{
    size_t prefix = strlen(p->instance) + 1;
    bool numbered = prefix > 1 && (size_t)length > prefix && word[prefix - 1] == '.' &&
                    is_number(word + prefix, length - (int64_t)prefix) &&
                    strncasecmp(word, p->instance, prefix - 1) == 0;
    if (numbered) {
        word += prefix;
        length -= (int64_t)prefix;
    }
    if (is_number(word, length)) {
        item->how = INP_TAG;
        item->first = input_whole(p->r, "member", word, length, 1, MSH_LARGEST_TAG);
        if (p->is_apart && !numbered) {
            return;
        }
    } else {
        item->how = INP_SET;
        item->members = find_set(p, kind, word, (size_t)length);
        if (item->members != NULL && item->set->kind == 'S') {
            item->members->of_surface = true;
        }
    }
    add_item(p, item);
}

/* Lines of GENERATE: the first, the last, and the step. */
static void read_ranges(struct inp *p, struct inp_item *item)
{
    const char *word;
    int64_t length, number[3];
    while (inp_next_data(p)) {
        int count = 0;
        number[2] = 1;
        while (count < 3 && inp_next_field(p, &word, &length)) {
            number[count++] = input_whole(p->r, "GENERATE", word, length, 1, MSH_LARGEST_TAG);
        }
        if (count == 1 || inp_next_field(p, &word, &length)) {
            msh_fail(p->r, "GENERATE: a line is not FIRST, LAST, STEP");
        }
        if (count > 1 && number[1] < number[0]) {
            msh_fail(p->r, "GENERATE: %lld is behind %lld: write the lesser one first", (long long)number[0],
                     (long long)number[1]);
        }
        item->how = INP_RANGE;
        item->first = number[0];
        item->last = number[1];
        item->step = number[2];
        if (count > 1 && !p->is_apart) {
            add_item(p, item);
        }
    }
}

void inp_read_set(struct inp *p, char kind)
{
    char name[INPUT_NAME + 1] = "", value[INPUT_NAME + 1];
    const char *word;
    int64_t length;
    (void)inp_parameter(p, kind == 'N' ? "NSET" : "ELSET", name, sizeof name);
    struct inp_item item = {.set = find_set(p, kind, name, strlen(name))};
    if (item.set == NULL) {
        return;
    }
    p->is_apart = p->in_assembly && !inp_parameter(p, "INSTANCE", value, sizeof value);
    define(p, item.set);
    if (kind == 'N' && inp_parameter(p, "ELSET", value, sizeof value)) { /* the nodes of its elements */
        item.how = INP_SET;
        item.members = find_set(p, 'E', value, strlen(value));
        add_item(p, &item);
    }
    if (inp_parameter(p, "GENERATE", value, sizeof value)) {
        read_ranges(p, &item);
        return;
    }
    while (inp_next_data(p)) {
        while (inp_next_field(p, &word, &length)) {
            if (length > 0) {
                add_word(p, &item, kind, word, length);
            }
        }
    }
}

void inp_read_surface(struct inp *p)
{
    char name[INPUT_NAME + 1] = "", value[INPUT_NAME + 1] = "ELEMENT";
    const char *word, *label;
    int64_t length, count;
    (void)inp_parameter(p, "NAME", name, sizeof name);
    (void)inp_parameter(p, "TYPE", value, sizeof value);
    bool of_nodes = strcasecmp(value, "NODE") == 0;
    p->is_apart = p->in_assembly;
    if ((!of_nodes && strcasecmp(value, "ELEMENT") != 0) ||
        inp_parameter(p, "COMBINE", value, sizeof value)) {
        msh_fail(p->r, "only surfaces of element faces and of nodes are read: take '%s' out", name);
    }
    struct inp_item item = {.set = find_set(p, of_nodes ? 'N' : 'S', name, strlen(name))};
    while (item.set != NULL && inp_next_data(p)) {
        define(p, item.set);
        if (!inp_next_field(p, &word, &length)) {
            continue;
        }
        if (!of_nodes &&
            (!inp_next_field(p, &label, &count) || count == 0 || count >= (int64_t)sizeof item.label)) {
            msh_fail(p->r, "no face is named: as in 'SET, S1'; free faces are not found");
            return;
        }
        if (!of_nodes) {
            memcpy(item.label, label, (size_t)count);
            item.label[count] = '\0';
        }
        add_word(p, &item, of_nodes ? 'N' : 'E', word, length);
    }
}

void inp_read_section(struct inp *p)
{
    char name[INPUT_NAME + 1];
    if (inp_parameter(p, "ELSET", name, sizeof name)) {
        struct inp_item item = {.how = INP_SET, .members = find_set(p, 'E', name, strlen(name))};
        add_item(p, &item);
    }
}
