/* Decks of Abaqus and CalculiX: lines, keywords, nodes and elements. (Format: CalculiX CrunchiX user's
 * manual, "Input deck format".) */
#include "io/mesh/inp.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- lines and fields ---- */

/* Take blanks off both ends. */
static void trim(const char **text, int64_t *length)
{
    while (*length > 0 && input_is_blank(**text)) {
        ++*text;
        --*length;
    }
    while (*length > 0 && input_is_blank((*text)[*length - 1])) {
        --*length;
    }
}

static void unquote(const char **text, int64_t *length)
{
    if (*length > 1 && (*text)[0] == '"' && (*text)[*length - 1] == '"') {
        ++*text;
        *length -= 2;
    }
}

static void next_line(struct inp *p)
{
    struct msh_reader *r = p->r;
    do {
        const char *end;
        if (!msh_next_line(r, &p->line, &end)) {
            p->line = NULL;
            return;
        }
        p->length = end - p->line;
        r->record = ++p->number;
        trim(&p->line, &p->length);
    } while (p->length == 0 || (p->length > 1 && memcmp(p->line, "**", 2) == 0));
    p->field = p->line;
    p->field_end = p->line + p->length;
}

bool inp_next_data(struct inp *p)
{
    next_line(p);
    return p->r->status == STATUS_OK && p->line != NULL && p->line[0] != '*';
}

bool inp_next_field(struct inp *p, const char **text, int64_t *length)
{
    if (p->r->status != STATUS_OK || p->field == NULL) {
        return false;
    }
    const char *comma = memchr(p->field, ',', (size_t)(p->field_end - p->field));
    *text = p->field;
    *length = (comma != NULL ? comma : p->field_end) - p->field;
    p->field = comma != NULL ? comma + 1 : NULL;
    trim(text, length);
    unquote(text, length);
    return p->field != NULL || *length > 0; /* a comma at the end begins no field */
}

/* ---- keywords ---- */

/* Join the lines of a keyword: all but the last end in a comma. */
static void read_card(struct inp *p)
{
    size_t length = 0;
    for (bool more = true; more;) {
        if (p->r->status != STATUS_OK || p->line == NULL || length + (size_t)p->length >= sizeof p->card) {
            msh_fail(p->r, "the keyword is unfinished, or longer than %zu bytes", sizeof p->card);
            return;
        }
        memcpy(p->card + length, p->line, (size_t)p->length);
        length += (size_t)p->length;
        p->card[length] = '\0';
        more = p->card[length - 1] == ',';
        if (more) {
            next_line(p);
        }
    }
    size_t count = 0;
    for (const char *c = p->card; *c != '\0' && *c != ',' && count + 1 < sizeof p->keyword; c++) {
        bool blank = isspace((unsigned char)*c);
        if (!blank || (c[1] != '\0' && c[1] != ',' && !isspace((unsigned char)c[1]))) {
            p->keyword[count++] = (char)(blank ? ' ' : toupper((unsigned char)*c));
        }
    }
    p->keyword[count] = '\0';
}

bool inp_parameter(struct inp *p, const char *name, char value[], size_t size)
{
    for (const char *at = strchr(p->card, ','); at != NULL; at = strchr(at, ',')) {
        at += 1 + strspn(at + 1, " \t");
        size_t length = strcspn(at, "=, \t");
        if (length != strlen(name) || strncasecmp(at, name, length) != 0) {
            continue;
        }
        const char *text = at + length + strspn(at + length, " \t");
        text += *text == '=';
        int64_t count = (int64_t)strcspn(text, ",");
        trim(&text, &count);
        unquote(&text, &count);
        if ((size_t)count >= size) {
            msh_fail(p->r, "%s is longer than %zu bytes", name, size - 1);
            count = 0;
        }
        memcpy(value, text, (size_t)count);
        value[count] = '\0';
        return true;
    }
    return false;
}

/* ---- nodes and elements ---- */

static void read_nodes(struct inp *p)
{
    struct msh_reader *r = p->r;
    char value[INPUT_NAME + 1];
    const char *word;
    int64_t length, first = p->r->msh->node_count;
    bool is_set = inp_parameter(p, "NSET", value, sizeof value);
    char system[INPUT_NAME + 1];
    if (inp_parameter(p, "SYSTEM", system, sizeof system) && strcasecmp(system, "R") != 0) {
        msh_fail(r, "the nodes are not in Cartesian coordinates: write them with SYSTEM=R");
    }
    while (inp_next_data(p)) {
        double x[3] = {0};
        if (!inp_next_field(p, &word, &length)) {
            continue;
        }
        int64_t tag = input_whole(r, "node", word, length, 1, MSH_LARGEST_TAG);
        for (int k = 0; k < 3 && inp_next_field(p, &word, &length); k++) {
            x[k] = length > 0 ? input_real(r, "coordinate", word, length) : 0;
        }
        if (!p->in_assembly) {
            msh_add_node(p->r, tag, x);
        }
    }
    if (p->in_assembly) { /* of reference points, in a count of its own */
        input_leave_out(p->r, "*NODE of the assembly");
    }
    if (is_set) {
        inp_add_places(p, 'N', value, first, p->r->msh->node_count);
    }
}

/* The type of gmsh of an element type: its beginning tells the dimension, the digits behind it the number of
 * nodes. 0: it is not read; F3D4 is a tetrahedron in CalculiX, a quadrangle in Abaqus. */
static int find_type(const char *name, bool *is_shell)
{
    static const struct {
        const char *begin;
        int dim;
        bool is_shell;
    } kinds[] = {{"C3D", 3, false},  {"SC", 3, false},  {"DC3D", 3, false}, {"AC3D", 3, false},
                 {"CPS", 2, false},  {"CPE", 2, false}, {"CPEG", 2, false}, {"DC2D", 2, false},
                 {"AC2D", 2, false}, {"S", 2, true},    {"STRI", 2, true},  {"M3D", 2, true},
                 {"SFM3D", 2, true}, {"R3D", 2, true},  {"DS", 2, true},    {"T3D", 1, false},
                 {"T2D", 1, false},  {"R2D", 1, false}};
    size_t begin = strcspn(name, "0123456789");
    begin += begin > 0 && name[begin] != '\0' && strchr("32", name[begin]) != NULL &&
                     toupper((unsigned char)name[begin + 1]) == 'D'
                 ? 2
                 : 0;
    int nodes = atoi(name + begin);
    *is_shell = false;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strlen(kinds[i].begin) == begin && strncasecmp(name, kinds[i].begin, begin) == 0) {
            *is_shell = kinds[i].is_shell;
            return nodes < 27 ? input_type(kinds[i].dim, nodes == 65 ? 6 : nodes) : 0;
        }
    }
    return 0;
}

/* gmsh's number of a line of second order. */
enum { LINE3 = 8 };

/* An element: its number and its nodes, on as many lines as these take. */
static void read_element(struct inp *p, int type, bool is_shell)
{
    struct msh_reader *r = p->r;
    const char *word;
    int64_t length, node[20], tag = -1;
    int count = msh_type(type).node_count;
    for (int k = -1; k < count && r->status == STATUS_OK;) {
        if (!inp_next_field(p, &word, &length)) {
            if (!inp_next_data(p)) {
                msh_fail(r, "element %jd ends after %d of %d nodes", tag, k, count);
            }
            continue;
        }
        int64_t number = input_whole(r, k < 0 ? "element" : "node", word, length, 1, MSH_LARGEST_TAG);
        *(k < 0 ? &tag : &node[k]) = number;
        k++;
    }
    if (inp_next_field(p, &word, &length)) {
        msh_fail(r, "element %jd has more than %d nodes", tag, count);
    }
    if (type == LINE3) { /* end, middle, end */
        int64_t end = node[2];
        node[2] = node[1];
        node[1] = end;
    }
    msh_add_element(r, tag, type, node, 0);
    if (r->status == STATUS_OK) {
        r->msh->elements[r->msh->element_count - 1].is_shell = is_shell;
    }
}

static void read_elements(struct inp *p)
{
    struct msh_reader *r = p->r;
    char name[32] = "", set[INPUT_NAME + 1];
    bool is_shell;
    bool is_set = inp_parameter(p, "ELSET", set, sizeof set);
    int64_t first = p->r->msh->element_count;
    bool has_type = inp_parameter(p, "TYPE", name, sizeof name);
    int type = find_type(name, &is_shell);
    if (type == 0) {
        msh_fail(r,
                 "%s%s: no element that is read (C3D4, C3D20, CPE3, S3, ...; no beams, fluids, C3D27): take "
                 "it out",
                 has_type ? "TYPE=" : "no TYPE", name);
    }
    while (r->status == STATUS_OK && inp_next_data(p)) {
        read_element(p, type, is_shell);
    }
    if (is_set) {
        inp_add_places(p, 'E', set, first, p->r->msh->element_count);
    }
}

/* ---- parts ---- */

#define FLAT "write the deck without parts (Abaqus: Model, Edit attributes, Do not use parts and assemblies)"

/* Data lines move the instance of a part. */
static void read_instance(struct inp *p)
{
    const char *word;
    int64_t length;
    (void)inp_parameter(p, "NAME", p->instance, sizeof p->instance);
    while (inp_next_data(p)) {
        while (inp_next_field(p, &word, &length)) {
            if (length > 0 && input_real(p->r, "place", word, length) != 0) {
                msh_fail(p->r, "the instance is moved: " FLAT);
            }
        }
    }
}

/* Whether the keyword is one of parts and assemblies: one part and one instance are read. */
static bool is_of_parts(struct inp *p)
{
    const char *key = p->keyword;
    bool begins = strcmp(key, "*ASSEMBLY") == 0, ends = strcmp(key, "*END ASSEMBLY") == 0;
    bool part = strcmp(key, "*PART") == 0, instance = strcmp(key, "*INSTANCE") == 0;
    bool behind = strcmp(key, "*END INSTANCE") == 0;
    p->in_assembly = begins || behind || (p->in_assembly && !ends && !instance);
    p->parts += part;
    p->instances += instance;
    if (p->parts > 1 || p->instances > 1) {
        msh_fail(p->r, "more than one part or instance: " FLAT);
    }
    return begins || ends || part || instance || behind || strcmp(key, "*END PART") == 0;
}

/* ---- the deck ---- */

static bool is_one_of(const char *keyword, const char *const list[])
{
    while (*list != NULL && strcmp(keyword, *list) != 0) {
        list++;
    }
    return *list != NULL;
}

static void skip_data(struct inp *p)
{
    while (inp_next_data(p)) {
    }
}

/* Read one keyword with its data; the next keyword is then in the current line. */
static void read_keyword(struct inp *p)
{
    static const char *const made[] = {"*NGEN",   "*NFILL",  "*NCOPY",  "*NMAP", "*ELGEN",
                                       "*ELCOPY", "*SYSTEM", "*IMPORT", NULL};
    static const char *const read[] = {"*NODE", "*ELEMENT", "*NSET", "*ELSET", "*INCLUDE", NULL};
    const char *key = p->keyword;
    char value[INPUT_NAME + 1];
    bool of_parts = is_of_parts(p);
    if (is_one_of(key, read) && inp_parameter(p, "INPUT", value, sizeof value)) {
        msh_fail(p->r, "other files are not read: put the lines of that file in its place");
    } else if (strcmp(key, "*NODE") == 0) {
        read_nodes(p);
    } else if (strcmp(key, "*ELEMENT") == 0 && !p->in_assembly) {
        read_elements(p);
    } else if (strcmp(key, "*NSET") == 0 || strcmp(key, "*ELSET") == 0) {
        inp_read_set(p, key[1]);
    } else if (strcmp(key, "*SURFACE") == 0) {
        inp_read_surface(p);
    } else if (strcmp(key, "*INSTANCE") == 0) {
        read_instance(p);
    } else if (is_one_of(key, made)) {
        msh_fail(p->r, "nodes and elements made of others are not read: write all of them out");
    } else {
        if (text_ends(key, " SECTION")) {
            inp_read_section(p);
        } else if (!of_parts && strcmp(key, "*HEADING") != 0) {
            input_leave_out(p->r, key);
        }
        skip_data(p);
    }
}

void inp_read(struct msh_reader *r)
{
    struct inp p = {.r = r};
    input_at(r, "deck", 0);
    skip_data(&p); /* there is none: a deck begins with a keyword */
    while (p.line != NULL && r->status == STATUS_OK) {
        read_card(&p);
        input_at(r, p.keyword, p.number);
        read_keyword(&p);
    }
    input_at(r, "nodes", 0);
    msh_check_tags(r, &r->nodes);
    inp_join_sets(&p);
    inp_free_sets(&p);
}
