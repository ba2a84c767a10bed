/* Reading mesh files; private to lib/io.
 *
 *   $PhysicalNames, $Entities \
 *   $Nodes                     } msh_list.c --> struct msh
 *   $Elements                 /
 *   inp_read.c, feb_read.c, vtu_read.c, vtk_read.c as well
 *
 * A reader passes through the file once, and adds nodes, elements and groups to lists. After its first
 * failure, every function of this header returns without effect, numbers are the least admitted ones, and
 * loops stop at `reader->status`. Memory grows with what is read, not with what counts say. (Format: Geuzaine
 * and Remacle, Gmsh reference manual, "File formats".) */
#pragma once

#include "base/memory.h"
#include "base/status.h"
#include "io/mesh/msh.h"

#include <stdbool.h>
#include <stdint.h>

/* Most bytes of the name of a group. */
#define INPUT_NAME 127

/* Tags are of type int in MSH 2; in MSH 4 gmsh keeps most of them as int. */
#define MSH_LARGEST_TAG INT32_MAX

/* The place of each tag, in runs in which both grow by one; ascending once it is asked. */
struct msh_index {
    int64_t count, room;
    bool unsorted;
    struct msh_run {
        int64_t tag, place, count;
    } * run;
};

/* A physical group's name in the file. */
struct msh_name {
    int64_t key; /* see msh_key */
    const char *text;
    int length;
};

/* A physical group of an entity of MSH 4. */
struct msh_entity {
    int64_t key;
    int64_t group;  /* its key; 0: the entity has none */
    int64_t record; /* number of the entity in the file */
};

/* The sections that are read; others are skipped. */
enum msh_section {
    MSH_FORMAT,
    MSH_NAMES,
    MSH_ENTITIES,
    MSH_PARTITIONS,
    MSH_NODES,
    MSH_ELEMENTS,
    MSH_SECTIONS
};

struct msh_reader {
    const char *at, *end; /* the rest of the file */
    bool msh4;            /* MSH 4.1, else 2.2 */
    bool binary;          /* numbers are little-endian values of 4 bytes (int), 8 (size) and 8 (real) */
    const char *section;  /* for messages: "$Nodes", and the kind of its records, "node" */
    const char *kind;
    int64_t record; /* number of the record, from 1; 0: the head of the section */
    enum status status;
    struct error *error;

    struct msh *msh;
    const char *region_array; /* of VTK files, or NULL */
    bool has[MSH_SECTIONS];   /* the section was read to its end */
    int64_t node_room, element_room, corner_count, corner_room, name_room;
    int64_t *corners; /* corner_count: tags of the nodes of each element, from its `first` on */
    struct msh_index nodes, elements;
    int64_t name_count;
    struct msh_name *names;
    struct owned texts; /* those of names that are not in the file */
    void *numbered;     /* a tree of what input_name numbers */
    int64_t no_number;  /* what it gives after a failure */
    int64_t members;    /* that sets and surfaces may still take from others */
    char left_out[320]; /* what is not read, ", " before each */
    int64_t entity_count, entity_room;
    struct msh_entity *entities; /* ascending in (key, group) */
};

/* ---- mesh_input.c: numbers, text or binary alike ---- */

/* Fail with "$Nodes: node 12: message", unless the reader has failed before. */
void msh_fail(struct msh_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The next whole number, within [least, most]: an int, or a size in binary files. */
int64_t msh_int(struct msh_reader *reader, const char *what, int64_t least, int64_t most);
int64_t msh_size(struct msh_reader *reader, const char *what, int64_t least, int64_t most);

/* The tag of a node or an element: an int in MSH 2, a size in MSH 4. */
int64_t msh_tag(struct msh_reader *reader, const char *what, int64_t least, int64_t most);

/* The count at the head of a section of MSH 2, which is a line of text in all files. */
int64_t msh_count_line(struct msh_reader *reader, const char *what);

/* The next real number. */
double msh_real(struct msh_reader *reader, const char *what);

/* Skip white space; skip the rest of the line, which must be blank. */
void msh_skip_space(struct msh_reader *reader);
void msh_skip_line(struct msh_reader *reader);

/* Unless the reader has failed, its status becomes that of a call; a statement, as those below. */
#define MSH_TRY(reader, call)                                                                                \
    do {                                                                                                     \
        if ((reader)->status == STATUS_OK) {                                                                 \
            (reader)->status = (call);                                                                       \
        }                                                                                                    \
    } while (0)

/* Allocate *pointer, an array of `count` zeros. */
#define MSH_NEW(reader, pointer, count) MSH_TRY(reader, NEW_ARRAY(pointer, count, (reader)->error))

/* Let *pointer, an array of *room elements, have room for `needed`. */
#define MSH_GROW(reader, pointer, needed, room)                                                              \
    MSH_TRY(reader, GROW_ARRAY(pointer, needed, room, (reader)->error))

/* ---- msh_sections.c: the sections, from the line behind "$Name" to where "$EndName" should be ---- */

void msh_read_names(struct msh_reader *reader);
void msh_read_entities(struct msh_reader *reader);
void msh_read_nodes(struct msh_reader *reader);
void msh_read_elements(struct msh_reader *reader);

/* ---- entities and groups ---- */

/* "point", "curve", "surface" or "volume". */
const char *msh_entity_kind(int dim);

/* Dimension and tag as one number, ascending in (dimension, tag); never 0. */
static inline int64_t msh_key(int64_t dim, int64_t tag)
{
    return ((dim + 1) << 32) + tag;
}
static inline int msh_key_dim(int64_t key)
{
    return (int)((key + MSH_LARGEST_TAG) >> 32) - 1;
}

/* Set the groups of the file, and that of each element: the last step. */
void msh_join_groups(struct msh_reader *reader);

/* ---- msh_list.c: nodes and elements as they are read, and finding them by their tags ---- */

/* The elements whose tags are given at the end, behind the others. */
#define MSH_NO_TAG (-1)

/* Add a node; an element with these tags of nodes, in gmsh's order, and the key of its group (0: none). */
void msh_add_node(struct msh_reader *reader, int64_t tag, const double x[3]);
void msh_add_element(struct msh_reader *reader, int64_t tag, int type, const int64_t node[], int64_t key);

/* A repeated tag, of nodes or of elements, is a failure. */
void msh_check_tags(struct msh_reader *reader, struct msh_index *index);

/* Place of `tag`, or -1; the first run that does not end before it. */
int64_t msh_index_find(struct msh_index *index, int64_t tag);
int64_t msh_index_from(struct msh_index *index, int64_t tag);

/* Find the nodes of all elements, and give tags to those without: before the groups are set. */
void msh_finish_lists(struct msh_reader *reader);

/* ---- mesh_input.c: what readers of meshes share that are not gmsh's ---- */

/* Corners of the faces S1, S2, ... that decks of Abaqus count in elements of first order, by gmsh's number;
 * -1 fills up, 0 behind the last face. (msh_build.c) */
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

/* The next line, *at to before *end; false at the end of the file. */
bool msh_next_line(struct msh_reader *r, const char **at, const char **end);

/* The number of a name of 1 to INPUT_NAME bytes among those of a kind, for the caller: 0 at first. */
int64_t *input_name(struct msh_reader *r, int kind, const char *text, size_t length);

/* The key of a new group; of the group of that dimension and name, which may be new. */
int64_t input_add_group(struct msh_reader *r, int dim, const char *text, int64_t length);
int64_t input_group(struct msh_reader *r, int dim, const char *text);

/* A set or surface takes a member from another one: they may take so many for each byte of the file. */
enum { MEMBERS_PER_BYTE = 8 };
void input_take_member(struct msh_reader *r);

/* Note what of the file is left out, each thing once. */
void input_leave_out(struct msh_reader *r, const char *what);

/* Append a note, printed. */
#define input_note(r, ...) MSH_TRY(r, names_print(&(r)->msh->notes, (r)->error, __VA_ARGS__))

/* Read a deck of Abaqus or CalculiX; a model of FEBio; a file of VTK, in XML or legacy. */
void inp_read(struct msh_reader *r);
void feb_read(struct msh_reader *r);
void vtu_read(struct msh_reader *r);
void vtk_read(struct msh_reader *r);

/* ---- xml.c: files in XML, element by element ---- */

/* What is done at the start and the end of each element. `depth`: 0 for the root. Failures are those of the
 * reader, whose record is the line. */
struct xml_handler {
    void *context;
    void (*begin)(void *context, const char *name, const char **attributes, int depth);
    /* text[size], and a NUL behind it: the characters of the element, without those of its children. */
    void (*end)(void *context, const char *name, const char *text, int64_t size, int depth);
};

/* The value of an attribute, or NULL. */
const char *xml_attribute(const char **attributes, const char *name);

/* Parse the rest of the file. It must be whole, unless it has an element `last`, at which parsing stops;
 * reader->at is then at the '<' of its tag. Entities are not declared: a document type is refused. */
void xml_parse(struct msh_reader *reader, const char *last, const struct xml_handler *handler);
