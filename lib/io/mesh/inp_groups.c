/* Decks of Abaqus and CalculiX: the groups that sets, sections and surfaces become. A set of nodes is a group
 * of points. An element belongs to the set of its section, else to the last set of the deck that it is in and
 * that is not there for a surface. A surface is a group of the faces. */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Members of all sets together, and elements of all groups, may be so many for each byte of the deck. */
#define MOST_PER_BYTE 4

/* ---- members ---- */

/* What is done with each member of an item, its place among nodes or elements. */
typedef void member_function(struct inp *p, const struct inp_item *item, int64_t place);

/* Sets of sets must not grow out of proportion to the deck. */
static void check_size(struct inp *p, int64_t count)
{
    if (count > MOST_PER_BYTE * p->size) {
        msh_fail(p->r, "the sets have too many members for the size of the deck");
    }
}

/* Those that there are of FIRST, FIRST + STEP, ..., LAST, as in CalculiX. */
static void each_in_range(struct inp *p, const struct inp_item *item, const struct msh_index *index,
                          member_function *add)
{
    int64_t low = 0;
    item->set->asked += (item->last - item->first) / item->step + 1;
    for (int64_t high = index->count; low < high;) {
        int64_t middle = (low + high) / 2;
        *(index->sorted[middle].tag < item->first ? &low : &high) =
            index->sorted[middle].tag < item->first ? middle + 1 : middle;
    }
    for (int64_t i = low; i < index->count && index->sorted[i].tag <= item->last; i++) {
        check_size(p, p->tried++);
        if ((index->sorted[i].tag - item->first) % item->step == 0) {
            item->set->found++;
            add(p, item, index->sorted[i].place);
        }
        if (p->r->status != STATUS_OK) {
            return;
        }
    }
}

/* The members of a set, which may be those of another: what is added to it meanwhile does not count. */
static void each_in_set(struct inp *p, const struct inp_item *item, member_function *add)
{
    int64_t last = item->members->tail;
    bool is_behind = item->set != NULL && item->set->kind != 'S' && item->members->line > item->line;
    if (item->members->line == 0 || is_behind) {
        msh_fail(p->r, "there is no set '%s'%s", item->members->name, is_behind ? " as yet" : "");
    }
    for (int64_t m = item->members->head; p->r->status == STATUS_OK && m >= 0; m = p->members[m].next) {
        check_size(p, p->tried++);
        add(p, item, p->members[m].place);
        if (m == last) {
            return;
        }
    }
}

/* Call `add` for all members of an item, nodes ('N') or elements. */
static void each_member(struct inp *p, const struct inp_item *item, char kind, member_function *add)
{
    struct msh_reader *r = p->r;
    const struct msh_index *index = kind == 'N' ? &r->nodes : &p->elements;
    r->record = item->line;
    if (item->how == INP_SET) {
        each_in_set(p, item, add);
    } else if (item->how == INP_RANGE) {
        each_in_range(p, item, index, add);
    } else if (item->how == INP_TAG) {
        int64_t place = msh_index_find(index, item->first);
        if (place < 0) {
            msh_fail(r, "there is no %s %lld", kind == 'N' ? "node" : "element", (long long)item->first);
        } else {
            add(p, item, place);
        }
    } else {
        for (int64_t i = item->first; r->status == STATUS_OK && i <= item->last; i++) {
            add(p, item, i);
        }
    }
}

static void add_member(struct inp *p, const struct inp_item *item, int64_t place)
{
    struct msh_reader *r = p->r;
    struct inp_set *set = item->set;
    check_size(p, p->member_count);
    MSH_GROW(r, &p->members, p->member_count + 1, &p->member_room);
    if (r->status != STATUS_OK) {
        return;
    }
    p->members[p->member_count] = (struct inp_member){place, -1};
    *(set->tail < 0 ? &set->head : &p->members[set->tail].next) = p->member_count;
    set->tail = p->member_count++;
    if (set->kind == 'E' && (item->how == INP_PLACES || !set->of_surface)) {
        p->overlaid += p->region[place] != NULL && p->region[place] != set;
        p->region[place] = set;
    }
}

/* Add the nodes of an element. */
static void add_corners(struct inp *p, const struct inp_item *item, int64_t place)
{
    const struct msh_element *element = &p->r->msh->elements[place];
    for (int k = 0; k < msh_type(element->type).node_count; k++) {
        int64_t node = msh_index_find(&p->r->nodes, p->r->corners[element->first + k]);
        if (node >= 0) { /* else found in the end */
            add_member(p, item, node);
        }
    }
}

static void add_to_region(struct inp *p, const struct inp_item *item, int64_t place)
{
    const struct inp_set *before = p->region[place];
    p->overlaid = p->sectioned++ > 0 ? p->overlaid : 0; /* where there are sections, only these count */
    p->overlaid += before != NULL && before->of_section && before != item->members;
    p->region[place] = item->members;
    item->members->of_section = true;
}

/* ---- groups ---- */

static int64_t group_of(struct inp *p, struct inp_set *set, int dim)
{
    if (set->key[dim] == 0) {
        set->key[dim] = input_add_group(p->r, dim, set->name, (int64_t)strlen(set->name));
    }
    return set->key[dim];
}

static void add_to_group(struct inp *p, struct inp_set *set, int type, const int64_t node[])
{
    int64_t key = group_of(p, set, msh_type(type).dim);
    msh_add_element(p->r, MSH_NO_TAG, type, node, key);
    check_size(p, p->r->msh->element_count);
}

/* Corners of the faces S1, S2, ... of elements of first order, by gmsh's number; -1 fills up. */
static const int8_t face_corners[8][6][4] = {
    [2] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}},
    [3] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}},
    [4] = {{0, 1, 2, -1}, {0, 3, 1, -1}, {1, 3, 2, -1}, {2, 3, 0, -1}},
    [5] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}},
    [6] = {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}},
    [7] = {{0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}},
};

/* Add face `f` of an element. */
static void add_face(struct inp *p, struct inp_set *set, int linear, const int64_t node[], int f)
{
    int64_t face[4];
    const int8_t *corner = face_corners[linear][f];
    int count = 0;
    for (; count < 4 && corner[count] >= 0; count++) {
        face[count] = node[corner[count]];
    }
    add_to_group(p, set, input_type(msh_type(linear).dim - 1, count), face);
}

/* S1, P1: faces, of shells their two sides, then their edges; E1: edges; SPOS, SNEG: sides. */
static void add_surface(struct inp *p, const struct inp_item *item, int64_t place)
{
    struct msh_reader *r = p->r;
    int64_t node[20];
    int8_t type = r->msh->elements[place].type;
    const char *label = item->label;
    int linear = msh_type(type).linear,
        face = label[0] != '\0' && isdigit((unsigned char)label[1]) && label[2] == '\0' ? label[1] - '0' : 0;
    int kind = toupper((unsigned char)label[0]);
    bool side = p->is_shell[place] && (strcasecmp(label, "SPOS") == 0 || strcasecmp(label, "SNEG") == 0 ||
                                       (kind != 'E' && (face == 1 || face == 2)));
    face -= p->is_shell[place] && kind != 'E' ? 2 : 0;
    memcpy(node, &r->corners[r->msh->elements[place].first],
           (size_t)msh_type(type).node_count * sizeof *node);
    if (side) {
        add_to_group(p, item->set, type, node);
    } else if (strchr("SPE", kind) == NULL || face < 1 || face > 6 || linear < 2 || linear > 7 ||
               face_corners[linear][face - 1][0] == face_corners[linear][face - 1][1]) {
        msh_fail(r, "a %s has no face '%s'", msh_type(type).name, label);
    } else {
        add_face(p, item->set, linear, node, face - 1);
    }
}

/* ---- all of it ---- */

static void index_elements(struct inp *p)
{
    struct msh_reader *r = p->r;
    MSH_NEW(r, &p->region, r->msh->element_count);
    if (r->status == STATUS_OK) {
        r->section = "elements";
        msh_index_elements(r, &p->elements);
    }
}

static void join_regions(struct inp *p)
{
    struct msh_reader *r = p->r;
    for (int64_t e = 0; r->status == STATUS_OK && e < r->msh->element_count; e++) {
        if (p->region[e] != NULL) {
            r->msh->elements[e].key = group_of(p, p->region[e], msh_type(r->msh->elements[e].type).dim);
        }
    }
}

/* Note what becomes of sets of elements that are not regions. */
static void note_sets(struct inp *p)
{
    char left[300] = "";
    for (int64_t s = 0; s < p->set_count; s++) {
        const struct inp_set *set = p->sets[s];
        if (set->found < set->asked) {
            input_note(p->r, "set '%s': of what its lines of GENERATE name, only %lld of %lld exist",
                       set->name, (long long)set->found, (long long)set->asked);
        }
        if (set->kind == 'E' && !set->of_surface && (set->key[1] | set->key[2] | set->key[3]) == 0) {
            text_append(left, sizeof left, "%s%s", left[0] != '\0' ? ", " : "", set->name);
        }
    }
    if (left[0] != '\0') {
        input_note(p->r, "sets of elements that are not regions, left out: %s", left);
    }
    if (p->overlaid > 0) {
        input_note(p->r, "elements in several sets, taken for the last: %lld", (long long)p->overlaid);
    }
}

static void join_nodes(struct inp *p)
{
    for (int64_t s = 0; p->r->status == STATUS_OK && s < p->set_count; s++) {
        if (p->sets[s]->kind != 'N') {
            continue;
        }
        (void)group_of(p, p->sets[s], 0);
        for (int64_t m = p->sets[s]->head; p->r->status == STATUS_OK && m >= 0; m = p->members[m].next) {
            add_to_group(p, p->sets[s], INPUT_POINT, &p->r->msh->nodes[p->members[m].place].tag);
        }
    }
}

void inp_join_sets(struct inp *p)
{
    struct msh_reader *r = p->r;
    index_elements(p);
    input_at(r, "sets", 0);
    for (int64_t i = 0; r->status == STATUS_OK && i < p->item_count; i++) {
        const struct inp_item *item = &p->items[i];
        if (item->set != NULL && item->set->kind != 'S') {
            bool of_elements = item->set->kind == 'N' && item->how == INP_SET && item->members->kind == 'E';
            each_member(p, item, item->set->kind, of_elements ? add_corners : add_member);
        }
    }
    for (int64_t i = 0; r->status == STATUS_OK && i < p->item_count; i++) {
        if (p->items[i].set == NULL) {
            each_member(p, &p->items[i], 'E', add_to_region);
        }
    }
    join_regions(p);
    note_sets(p);
    for (int64_t i = 0; r->status == STATUS_OK && i < p->item_count; i++) {
        if (p->items[i].set != NULL && p->items[i].set->kind == 'S') {
            each_member(p, &p->items[i], 'E', add_surface);
        }
    }
    join_nodes(p);
}

void inp_free_sets(struct inp *p)
{
    msh_index_free(&p->elements);
    FREE_ALL(p->is_shell, p->items, p->sets, p->members, p->region);
}
