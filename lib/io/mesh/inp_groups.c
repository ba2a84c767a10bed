/* Decks of Abaqus and CalculiX: the groups that sets, sections and surfaces become. A set of nodes is a group
 * of points. An element belongs to the set of its section, else to the last set of the deck that it is in and
 * that is not there for a surface. A surface is a group of the faces. */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- members ---- */

void inp_add_member(struct inp *p, struct inp_set *set, int64_t place)
{
    input_take_member(p->r);
    MSH_GROW(p->r, &set->member, set->count + 1, &set->room);
    if (p->r->status == STATUS_OK) {
        set->member[set->count++] = place;
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
void inp_add_face(struct inp *p, struct inp_set *set, int64_t place, const char *label)
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

/* ---- all of it ---- */

/* region[]: the set of each element's section, else the last set that it is in and that is not there for a
 * surface. Returns how many are in several of these. */
static int64_t find_regions(struct inp *p, struct inp_set **region)
{
    int64_t overlaid[2] = {0, 0};
    bool any = false;
    for (int64_t i = 0; i < 2 * p->set_count; i++) {
        struct inp_set *set = p->sets[i % p->set_count];
        bool last = i >= p->set_count,
             wanted = last ? set->of_section > 0 : !set->of_surface || set->of_elements;
        any = any || set->of_section > 0;
        for (int64_t m = 0; m < set->count && set->kind == 'E' && wanted; m++) {
            const struct inp_set *before = region[set->member[m]];
            overlaid[last] += before != NULL && before != set && (!last || before->of_section > 0);
            region[set->member[m]] = set;
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
    msh_check_elements(r);
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
