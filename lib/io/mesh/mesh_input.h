/* Readers of meshes that are not gmsh's; private to lib/io. As in msh_private.h, all functions return without
 * effect after the first failure of the reader. */
#pragma once

#include "io/mesh/msh_private.h"

/* Most bytes of the name of a group. */
#define INPUT_NAME 127

/* Corners of the faces S1, S2, ... that decks of Abaqus count in elements of first order, by gmsh's number;
 * -1 fills up, 0 behind the last face. (msh_split.c) */
extern const int8_t msh_face_corners[8][6][4];

/* gmsh's number of a point. */
#define INPUT_POINT 15

/* Say where the reader is, for messages: "*NODE: line 12: ..." */
static inline void input_at(struct msh_reader *r, const char *section, int64_t line)
{
    r->section = section;
    r->kind = "line";
    r->record = line;
}

/* The numbers that words of a text file are: all of the word; a real number is finite, and may have Fortran's
 * exponent D. */
int64_t input_whole(struct msh_reader *r, const char *what, const char *word, int64_t length, int64_t least,
                    int64_t most);
int64_t input_within(struct msh_reader *r, const char *what, int64_t number, int64_t least, int64_t most);
double input_real(struct msh_reader *r, const char *what, const char *word, int64_t length);

/* The number of gmsh of the elements of first or second order with this dimension and number of nodes; 0:
 * there are none. Numbers of nodes are those of one type, except that 8 in the plane are of second order. */
int input_type(int dim, int node_count);

static inline bool input_is_blank(char c)
{
    return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

/* The next word of a text, between blanks, line ends and `comma`, at *at, which moves behind it; NULL: the
 * end. */
const char *input_word(const char **at, const char *end, char comma, int64_t *length);

/* The number of a name of 1 to INPUT_NAME bytes among those of a kind, for the caller: 0 at first. NULL after
 * a failure. */
int64_t *input_name(struct msh_reader *r, int kind, const char *text, size_t length);

/* The key of a new group; of the group of that dimension and name, which may be new. */
int64_t input_add_group(struct msh_reader *r, int dim, const char *text, int64_t length);
int64_t input_group(struct msh_reader *r, int dim, const char *text);

/* Note what of the file is left out, each thing once. */
void input_leave_out(struct msh_reader *r, const char *what);

/* Append a note, printed; a statement. */
#define input_note(r, ...)                                                                                   \
    do {                                                                                                     \
        if ((r)->status == STATUS_OK) {                                                                      \
            (r)->status = names_print(&(r)->msh->notes, (r)->error, __VA_ARGS__);                            \
        }                                                                                                    \
    } while (0)

/* Read a deck of Abaqus or CalculiX; a model of FEBio; a file of VTK, in XML or legacy. */
void inp_read(struct msh_reader *r);
void feb_read(struct msh_reader *r);
void vtu_read(struct msh_reader *r);
void vtk_read(struct msh_reader *r);
