/* Decks of Abaqus and CalculiX: sets, surfaces and sections, and the groups that they become. A set of nodes
 * is a group of points. An element belongs to the set of its section, else to the last set of the deck that
 * it is in and that is not there for a surface. A surface is a group of the faces. */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- members ---- */

static void add_member(struct inp *p, struct inp_set *set, int64_t place)
{
    input_take_member(p->r);
    MSH_GROW(p->r, &set->member, set->count + 1, &set->room);
    if (p->r->status == STATUS_OK) {
        set->member[set->count++] = place;
    }
}

/* Add an element of a surface, whose group gets its key when all regions have theirs. */
static void add_of_surface(struct inp *p, const struct inp_set *set, int type, const int64_t node[])
{
    msh_add_element(p->r, MSH_NO_TAG, type, node, -set->number);
    input_take_member(p->r);
}

static void add_face(struct inp *p, const struct inp_set *set, int linear, const int64_t node[], int f)
{
    int64_t face[4];
    const int8_t *corner = msh_face_corners[linear][f];
    int count = 0;
    for (; count < 4 && corner[count] >= 0; count++) {
        face[count] = node[corner[count]];
    }
    add_of_surface(p, set, input_type(msh_type(linear).dim - 1, count), face);
}

/* S1, P1: faces, of shells their two sides, then their edges; E1: edges; SPOS, SNEG: sides. */
static void add_label(struct inp *p, struct inp_set *set, int64_t place, const char *label)
{
    struct msh_reader *r = p->r;
    int64_t node[20];
    int8_t type = r->msh->elements[place].type;
    int linear = msh_type(type).linear,
        face = label[0] != '\0' && isdigit((unsigned char)label[1]) && label[2] == '\0' ? label[1] - '0' : 0;
    int kind = toupper((unsigned char)label[0]);
    bool is_shell = r->msh->elements[place].is_shell;
    bool side = is_shell && (strcasecmp(label, "SPOS") == 0 || strcasecmp(label, "SNEG") == 0 ||
                             (kind != 'E' && (face == 1 || face == 2)));
    face -= is_shell && kind != 'E' ? 2 : 0;
    memcpy(node, &r->corners[r->msh->elements[place].first],
           (size_t)msh_type(type).node_count * sizeof *node);
    if (side) {
        add_of_surface(p, set, type, node);
    } else if (strchr("SPE", kind) == NULL || face < 1 || face > 6 || linear < 2 || linear > 7 ||
               msh_face_corners[linear][face - 1][0] == msh_face_corners[linear][face - 1][1]) {
        msh_fail(r, "a %s has no face '%s'", msh_type(type).name, label);
    } else {
        add_face(p, set, linear, node, face - 1);
    }
}

/* ---- sets ---- */

/* The set of that name, which may be new, and as "INSTANCE.NAME" is that of the part; NULL after a failure.
 */
static struct inp_set *find_set(struct inp *p, char kind, const char *text, size_t length)
{
    struct msh_reader *r = p->r;
    size_t prefix = strlen(p->instance);
    bool of_assembly = p->in_assembly;
    struct inp_set wanted = {.kind = kind};
    if (prefix > 0 && length > prefix && text[prefix] == '.' && strncasecmp(text, p->instance, prefix) == 0) {
        of_assembly = false;
        text += prefix + 1;
        length -= prefix + 1;
    }
    for (size_t i = 0; i < length && i < INPUT_NAME; i++) {
        wanted.name[i] = (char)toupper((unsigned char)text[i]);
    }
    int64_t *number = input_name(p->r, kind * 2 + of_assembly, wanted.name, length);
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

void inp_add_places(struct inp *p, char kind, const char *name, int64_t first, int64_t end)
{
    struct inp_set *set = find_set(p, kind, name, strlen(name));
    if (set != NULL) {
        set->line = p->number;
        set->of_elements = set->of_elements || kind == 'E';
    }
    for (int64_t i = first; p->r->status == STATUS_OK && i < end; i++) {
        add_member(p, set, i);
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
            add_label(p, set, member[i], label);
        } else {
            add_member(p, set, member[i]);
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
                add_member(p, set, index->run[i].place + k);
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
            add_member(p, set, node);
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
    set->line = p->number;
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
        set->line = p->number;
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

/* ---- groups ---- */

static int64_t group_of(struct inp *p, struct inp_set *set, int dim)
{
    if (set->key[dim] == 0) {
        set->key[dim] = input_add_group(p->r, dim, set->name, (int64_t)strlen(set->name));
    }
    return set->key[dim];
}

/* region[]: the set of each element's last section, else the last set that it is in and that is not there for
 * a surface. Returns how many are in several of these. */
static int64_t find_regions(struct inp *p, struct inp_set **region)
{
    int64_t overlaid[2] = {0, 0};
    bool any = false;
    for (int64_t s = 0; s < p->set_count; s++) {
        struct inp_set *set = p->sets[s];
        bool wanted = set->of_section > 0 || !set->of_surface || set->of_elements;
        any = any || set->of_section > 0;
        for (int64_t m = 0; m < set->count && set->kind == 'E' && wanted; m++) {
            struct inp_set **now = &region[set->member[m]];
            bool both = *now != NULL && *now != set && ((*now)->of_section > 0) == (set->of_section > 0);
            overlaid[set->of_section > 0] += both;
            *now = *now == NULL || set->of_section >= (*now)->of_section ? set : *now;
        }
    }
    return overlaid[any];
}

/* Give each element the key of its group: of its region, then of its surface. */
static void join_elements(struct inp *p, struct inp_set *const *region)
{
    struct msh *msh = p->r->msh;
    for (int64_t i = 0; p->r->status == STATUS_OK && i < 2 * msh->element_count; i++) {
        int64_t e = i % msh->element_count, *key = &msh->elements[e].key;
        struct inp_set *set = i < msh->element_count ? region[e] : *key < 0 ? p->sets[-*key - 1] : NULL;
        if (set != NULL) {
            *key = group_of(p, set, msh_type(msh->elements[e].type).dim);
        }
    }
}

/* Note what becomes of sets of elements that are not regions. */
static void note_sets(struct inp *p, int64_t overlaid)
{
    char left[300] = "";
    for (int64_t s = 0; s < p->set_count; s++) {
        const struct inp_set *set = p->sets[s];
        if (set->found < set->asked) {
            input_note(p->r, "set '%s': of what its lines of GENERATE name, only %jd of %jd exist", set->name,
                       set->found, set->asked);
        }
        if (set->kind == 'E' && !set->of_surface && (set->key[1] | set->key[2] | set->key[3]) == 0) {
            text_append(left, sizeof left, "%s%s", left[0] != '\0' ? ", " : "", set->name);
        }
    }
    if (left[0] != '\0') {
        input_note(p->r, "sets of elements that are not regions, left out: %s", left);
    }
    if (overlaid > 0) {
        input_note(p->r, "elements in several sets, taken for the last: %jd", overlaid);
    }
}

static void join_nodes(struct inp *p)
{
    for (int64_t s = 0; p->r->status == STATUS_OK && s < p->set_count; s++) {
        struct inp_set *set = p->sets[s];
        int64_t key = set->kind == 'N' ? group_of(p, set, 0) : 0;
        for (int64_t m = 0; p->r->status == STATUS_OK && set->kind == 'N' && m < set->count; m++) {
            msh_add_element(p->r, MSH_NO_TAG, INPUT_POINT, &p->r->msh->nodes[set->member[m]].tag, key);
        }
    }
}

void inp_join_sets(struct inp *p)
{
    struct msh_reader *r = p->r;
    SCRATCH struct inp_set **region = NULL; /* of each element, or NULL */
    r->section = "elements";
    msh_check_tags(r, &r->elements);
    input_at(r, "sets", 0);
    for (int64_t s = 0; s < p->set_count; s++) {
        if (p->sets[s]->of_section > 0 && p->sets[s]->line == 0) {
            r->record = p->sets[s]->of_section;
            msh_fail(r, "there is no set '%s'", p->sets[s]->name);
        }
    }
    MSH_NEW(r, &region, r->msh->element_count);
    if (r->status == STATUS_OK) {
        int64_t overlaid = find_regions(p, region);
        join_elements(p, region);
        note_sets(p, overlaid);
        join_nodes(p);
    }
}

void inp_free_sets(struct inp *p)
{
    for (int64_t s = 0; s < p->set_count; s++) {
        free(p->sets[s]->member);
    }
    free(p->sets);
}
