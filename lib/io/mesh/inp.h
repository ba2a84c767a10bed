/* Decks of Abaqus and CalculiX; private to lib/io. */
#pragma once

#include "io/mesh/msh_private.h"

/* A set of nodes or elements, or a surface. Names are compared without regard to case; those of an assembly
 * are apart from those of its part. */
struct inp_set {
    char kind; /* 'N', 'E' or 'S' */
    char name[INPUT_NAME + 1];
    int64_t number;       /* from 1, of inp->sets */
    int64_t line;         /* where it is defined; 0: it is only named by others */
    bool of_elements;     /* *ELEMENT names it */
    bool of_surface;      /* elements: a surface uses it */
    int64_t of_section;   /* elements: the line of a section that uses it, or 0 */
    int64_t count, room;  /* of its members */
    int64_t *member;      /* their places among nodes or elements */
    int64_t asked, found; /* members of its ranges: those that exist are found */
    int64_t key[4];       /* of its group of each dimension, 0: none yet */
};

struct inp {
    struct msh_reader *r;
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

    int64_t set_count, set_room;
    struct inp_set **sets; /* in the order of the deck; of r->texts */
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

/* Make groups of sets, sections and surfaces: when all of the deck is read. */
void inp_join_sets(struct inp *p);
void inp_free_sets(struct inp *p);
