/* Decks of Abaqus and CalculiX: sets, surfaces and sections. */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* The set of that name, which may be new, and as "INSTANCE.NAME" is that of the part; NULL after a failure.
 */
static struct inp_set *find_set(struct inp *p, char kind, const char *text, size_t length)
{
    struct msh_reader *r = p->r;
    size_t prefix = strlen(p->instance);
    struct inp_set wanted = {.kind = kind, .of_assembly = p->in_assembly};
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
            set->number = *number = p->set_count;
        }
    }
    return r->status == STATUS_OK ? p->sets[*number - 1] : NULL;
}

static void define(const struct inp *p, struct inp_set *set)
{
    set->line = set->line == 0 ? p->number : set->line;
}

void inp_add_places(struct inp *p, char kind, const char *name, int64_t first, int64_t end)
{
    struct inp_set *set = find_set(p, kind, name, strlen(name));
    for (int64_t i = first; set != NULL && p->r->status == STATUS_OK && i < end; i++) {
        inp_add_member(p, set, i);
    }
    if (set != NULL) {
        define(p, set);
        set->of_elements = set->of_elements || kind == 'E';
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

/* Add the members that a word names, a number or a set, to a set; to a surface their faces of that label. */
static void add_word(struct inp *p, struct inp_set *set, char kind, const char *word, int64_t length,
                     const char *label)
{
    size_t prefix = strlen(p->instance) + 1;
    int64_t one[1], count = 1;
    const int64_t *member = one;
    bool numbered = prefix > 1 && (size_t)length > prefix && word[prefix - 1] == '.' &&
                    is_number(word + prefix, length - (int64_t)prefix) &&
                    strncasecmp(word, p->instance, prefix - 1) == 0;
    if (numbered) {
        word += prefix;
        length -= (int64_t)prefix;
    }
    if (is_number(word, length)) {
        int64_t tag = input_whole(p->r, "member", word, length, 1, MSH_LARGEST_TAG);
        one[0] = msh_index_find(kind == 'N' ? &p->r->nodes : &p->r->elements, tag);
        if (p->is_apart && !numbered) {
            return;
        }
        if (one[0] < 0) {
            msh_fail(p->r, "there is no %s %jd as yet", kind == 'N' ? "node" : "element", tag);
        }
    } else {
        struct inp_set *other = find_set(p, kind, word, (size_t)length);
        if (other == NULL || other == set) {
            return;
        }
        if (other->line == 0) {
            msh_fail(p->r, "there is no set '%s' as yet", other->name);
        }
        other->of_surface = other->of_surface || label != NULL;
        member = other->member;
        count = other->count;
    }
    for (int64_t i = 0; p->r->status == STATUS_OK && i < count; i++) {
        if (label != NULL) {
            inp_add_face(p, set, member[i], label);
        } else {
            inp_add_member(p, set, member[i]);
        }
    }
}

/* Those that there are of FIRST, FIRST + STEP, ..., LAST, as in CalculiX. */
static void add_range(struct inp *p, struct inp_set *set, const int64_t range[3])
{
    struct msh_index *index = set->kind == 'N' ? &p->r->nodes : &p->r->elements;
    set->asked += (range[1] - range[0]) / range[2] + 1;
    for (int64_t i = msh_index_from(index, range[0]); i < index->count && index->run[i].tag <= range[1];
         i++) {
        for (int64_t k = 0; p->r->status == STATUS_OK && k < index->run[i].count; k++) {
            int64_t tag = index->run[i].tag + k;
            input_take_member(p->r);
            if (tag >= range[0] && tag <= range[1] && (tag - range[0]) % range[2] == 0) {
                set->found++;
                inp_add_member(p, set, index->run[i].place + k);
            }
        }
    }
}

/* Lines of GENERATE: the first, the last, and the step. */
static void read_ranges(struct inp *p, struct inp_set *set)
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
            msh_fail(p->r, "GENERATE: %jd is behind %jd: write the lesser one first", number[0], number[1]);
        }
        if (count > 1 && !p->is_apart && p->r->status == STATUS_OK) {
            add_range(p, set, number);
        }
    }
}

static void add_corners(struct inp *p, struct inp_set *set, const char *name)
{
    const struct inp_set *from = find_set(p, 'E', name, strlen(name));
    if (from != NULL && from->line == 0) {
        msh_fail(p->r, "there is no set '%s' as yet", from->name);
    }
    for (int64_t i = 0; p->r->status == STATUS_OK && i < from->count; i++) {
        const struct msh_element *element = &p->r->msh->elements[from->member[i]];
        for (int k = 0; k < msh_type(element->type).node_count; k++) {
            int64_t tag = p->r->corners[element->first + k], node = msh_index_find(&p->r->nodes, tag);
            if (node < 0) {
                msh_fail(p->r, "there is no node %jd as yet", tag);
            }
            inp_add_member(p, set, node);
        }
    }
}

void inp_read_set(struct inp *p, char kind)
{
    char name[INPUT_NAME + 1] = "", value[INPUT_NAME + 1];
    const char *word;
    int64_t length;
    (void)inp_parameter(p, kind == 'N' ? "NSET" : "ELSET", name, sizeof name);
    struct inp_set *set = find_set(p, kind, name, strlen(name));
    if (set == NULL) {
        return;
    }
    p->is_apart = p->in_assembly && !inp_parameter(p, "INSTANCE", value, sizeof value);
    define(p, set);
    if (kind == 'N' && inp_parameter(p, "ELSET", value, sizeof value)) {
        add_corners(p, set, value);
    }
    if (inp_parameter(p, "GENERATE", value, sizeof value)) {
        read_ranges(p, set);
        return;
    }
    while (inp_next_data(p)) {
        while (inp_next_field(p, &word, &length)) {
            if (length > 0) {
                add_word(p, set, kind, word, length, NULL);
            }
        }
    }
}

void inp_read_surface(struct inp *p)
{
    char name[INPUT_NAME + 1] = "", value[INPUT_NAME + 1] = "ELEMENT", label[8];
    const char *word, *face;
    int64_t length, count;
    (void)inp_parameter(p, "NAME", name, sizeof name);
    (void)inp_parameter(p, "TYPE", value, sizeof value);
    bool of_nodes = strcasecmp(value, "NODE") == 0;
    p->is_apart = p->in_assembly;
    if ((!of_nodes && strcasecmp(value, "ELEMENT") != 0) ||
        inp_parameter(p, "COMBINE", value, sizeof value)) {
        msh_fail(p->r, "only surfaces of element faces and of nodes are read: take '%s' out", name);
    }
    struct inp_set *set = find_set(p, of_nodes ? 'N' : 'S', name, strlen(name));
    while (set != NULL && inp_next_data(p)) {
        define(p, set);
        if (!inp_next_field(p, &word, &length)) {
            continue;
        }
        if (of_nodes) {
            add_word(p, set, 'N', word, length, NULL);
            continue;
        }
        if (!inp_next_field(p, &face, &count) || count == 0 || count >= (int64_t)sizeof label) {
            msh_fail(p->r, "no face is named: as in 'SET, S1'; free faces are not found");
            return;
        }
        snprintf(label, sizeof label, "%.*s", (int)count, face);
        add_word(p, set, 'E', word, length, label);
    }
}

void inp_read_section(struct inp *p)
{
    char name[INPUT_NAME + 1];
    struct inp_set *set = NULL;
    if (inp_parameter(p, "ELSET", name, sizeof name)) {
        set = find_set(p, 'E', name, strlen(name));
    }
    if (set != NULL) {
        set->of_section = p->number;
    }
}
