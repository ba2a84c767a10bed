/* Decks of Abaqus and CalculiX: shared by inp_read.c, inp_sets.c and inp_groups.c; private to lib/io. */
#pragma once

#include "io/mesh/mesh_input.h"

/* A set of nodes or elements, or a surface. Names are compared without regard to case; those of an assembly
 * are apart from those of its part. */
struct inp_set {
    char kind; /* 'N', 'E' or 'S' */
    bool of_assembly;
    char name[INPUT_NAME + 1];
    int64_t line;         /* where it is first defined; 0: it is only named by others */
    bool of_surface;      /* elements: a surface uses it */
    bool of_section;      /* elements: a section uses it */
    int64_t head, tail;   /* the members: of inp->members, -1: none */
    int64_t asked, found; /* members of its ranges: those that exist are found */
    int64_t key[4];       /* of its group of each dimension, 0: none yet */
};

/* What the deck adds to a set. */
struct inp_item {
    struct inp_set *set; /* NULL: a section, which makes a region of a set of elements */
    enum { INP_TAG, INP_RANGE, INP_PLACES, INP_SET } how;
    int64_t first, last, step; /* tags, of which those of a range need not exist; or places in the deck */
    struct inp_set *members;
    int64_t line;
    char label[8]; /* of a face: "S1" */
};

struct inp {
    struct msh_reader *r;
    int64_t size;     /* of the deck, bytes */
    int64_t number;   /* of the line, from 1 */
    const char *line; /* without blanks at its ends; NULL: the end of the deck */
    int64_t length;
    const char *field, *field_end; /* the rest of it; NULL: no more fields */
    char card[1024];               /* the keyword line, joined */
    char keyword[64];              /* "*SOLID SECTION": upper case, one blank between words */
    int parts, instances;
    bool in_assembly; /* and not in an instance */
    bool is_apart;    /* the numbers of a set are those of the assembly itself, which are left out */
    char instance[INPUT_NAME + 1];

    bool *is_shell; /* of each element */
    int64_t shell_room;
    int64_t item_count, item_room, set_count, set_room, member_count, member_room;
    struct inp_item *items;
    struct inp_set **sets; /* in the order of the deck; of r->texts */
    struct inp_member {
        int64_t place, next;
    } * members;
    int64_t tried; /* members of ranges and sets */
    struct msh_index elements;
    struct inp_set **region;     /* of each element, or NULL */
    int64_t overlaid, sectioned; /* elements in several sets, or those of sections; in sets of sections */
};

/* ---- inp_read.c ---- */

/* The next data line of the keyword; false if the next line is a keyword, or there is none. */
bool inp_next_data(struct inp *p);

/* The next field of the line; false if there is none. An empty field has length 0. */
bool inp_next_field(struct inp *p, const char **text, int64_t *length);

/* The value of a parameter of the keyword, in value[size]; false if it is not given. */
bool inp_parameter(struct inp *p, const char *name, char value[], size_t size);

/* ---- inp_sets.c ---- */

/* Add to the set of that name: the elements or nodes at places first <= i < end. */
void inp_add_places(struct inp *p, char kind, const char *name, int64_t first, int64_t end);

/* *NSET, *ELSET; *SURFACE; *SOLID SECTION and the like. */
void inp_read_set(struct inp *p, char kind);
void inp_read_surface(struct inp *p);
void inp_read_section(struct inp *p);

/* ---- inp_groups.c ---- */

/* Make groups of sets, sections and surfaces: when all of the deck is read. */
void inp_join_sets(struct inp *p);
void inp_free_sets(struct inp *p);
