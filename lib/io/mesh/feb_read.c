/* Models of FEBio, versions 2.5 to 4.0: the mesh in <Geometry> or <Mesh>. (Format: FEBio User's Manual, "Free
 * format input".) */
#include "io/mesh/msh_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What an element of the mesh holds. */
enum content { OTHERS, NODES, ELEMENTS, SURFACE, EDGE, NODE_SET };

struct feb {
    struct msh_reader *r;
    bool in_mesh;
    enum content content;
    int type;                  /* of the elements */
    char name[INPUT_NAME + 1]; /* of the part, surface or set */
    bool is_empty;             /* nothing in it yet */
    int64_t first;             /* element at its begin */
    int64_t id;                /* of the node or element, or MSH_NO_TAG */
    char section[64];
};

/* The type of gmsh by FEBio's name, "tet4"; 0: it is not read. */
static int find_type(const char *name)
{
    static const struct {
        const char *begin;
        int linear;
    } kinds[] = {{"tet", 4}, {"hex", 5},  {"penta", 6}, {"pyra", 7},
                 {"tri", 2}, {"quad", 3}, {"line", 1},  {"truss", 1}};
    size_t begin = strcspn(name, "0123456789");
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strlen(kinds[i].begin) == begin && strncmp(name, kinds[i].begin, begin) == 0) {
            int type = input_type(msh_type(kinds[i].linear).dim, atoi(name + begin));
            return msh_type(type).linear == kinds[i].linear ? type : 0;
        }
    }
    return 0;
}

/* ---- what is in the mesh ---- */

static void begin_content(struct feb *f, const char *element, const char **attributes)
{
    static const char *const contents[] = {[NODES] = "Nodes",
                                           [ELEMENTS] = "Elements",
                                           [SURFACE] = "Surface",
                                           [EDGE] = "Edge",
                                           [NODE_SET] = "NodeSet"};
    struct msh_reader *r = f->r;
    const char *name = xml_attribute(attributes, "name"), *type = xml_attribute(attributes, "type");
    name = name != NULL ? name : xml_attribute(attributes, "elset");
    f->content = OTHERS;
    for (int k = NODES; k <= NODE_SET; k++) {
        f->content = strcmp(element, contents[k]) == 0 ? (enum content)k : f->content;
    }
    f->is_empty = true;
    f->first = f->r->msh->element_count;
    if (snprintf(f->name, sizeof f->name, "%s", name != NULL ? name : "") > INPUT_NAME) {
        msh_fail(r, "the name '%.40s...' is longer than %d bytes", name, INPUT_NAME);
    }
    if (f->content == ELEMENTS) {
        if (name == NULL) {
            const char *material = xml_attribute(attributes, "mat");
            snprintf(f->name, sizeof f->name, "material_%s", material != NULL ? material : "");
        }
        f->type = find_type(type != NULL ? type : "");
        if (f->type == 0) {
            msh_fail(
                r, "type '%s': no element that is read (tet4, hex8, penta6, pyra5, tri3, quad4, line2, ...)",
                type != NULL ? type : "");
        }
    } else if (strcmp(element, "Part") == 0 || strcmp(element, "Instance") == 0) {
        msh_fail(r, "parts with instances are not read: save the model from FEBio Studio");
    } else if (f->content == OTHERS) {
        input_leave_out(f->r, element);
    }
}

/* The nodes of a set with nodes that a name stands for, as input_name counts them: its first element, from 1,
 * and the end of these. */
enum { FIRST_OF_SET = 4, END_OF_SET };

/* Add the nodes of a set that has ended: <NodeSet node_set="a"/>. */
static void add_set(struct feb *f, const char *name)
{
    struct msh_reader *r = f->r;
    int64_t first = *input_name(f->r, FIRST_OF_SET, name, strlen(name)),
            end = *input_name(f->r, END_OF_SET, name, strlen(name));
    if (first == 0) {
        msh_fail(r, "there is no set of nodes '%s' as yet", name);
    }
    for (int64_t e = first - 1; r->status == STATUS_OK && e < end; e++) {
        int64_t node = r->corners[r->msh->elements[e].first];
        input_take_member(r);
        msh_add_element(f->r, MSH_NO_TAG, INPUT_POINT, &node, input_group(f->r, 0, f->name));
    }
    f->is_empty = false;
}

static void begin_item(struct feb *f, const char *element, const char **attributes)
{
    const char *id = xml_attribute(attributes, "id"), *set = xml_attribute(attributes, "node_set");
    f->id = MSH_NO_TAG;
    if (f->content == NODE_SET && id == NULL && set != NULL) {
        add_set(f, set);
        return;
    }
    if (id != NULL && f->content != SURFACE && f->content != EDGE) {
        f->id = input_whole(f->r, "id", id, (int64_t)strlen(id), 1, MSH_LARGEST_TAG);
    }
    if (f->content == SURFACE || f->content == EDGE) {
        f->type = find_type(element);
        if (f->type == 0) {
            msh_fail(f->r, "'%s' is no face that is read (tri3, quad4, tri6, quad8, quad9, line2, line3)",
                     element);
        }
    } else if ((f->content == NODES || f->content == NODE_SET) &&
               ((strcmp(element, "node") != 0 && strcmp(element, "n") != 0) || id == NULL)) {
        msh_fail(f->r, "'%s' is no <node id=...>", element);
    }
}

static void begin(void *context, const char *name, const char **attributes, int depth)
{
    struct feb *f = context;
    struct msh_reader *r = f->r;
    const char *version = xml_attribute(attributes, "version"), *from = xml_attribute(attributes, "from");
    if (depth < 3) {
        snprintf(f->section, sizeof f->section, "<%.60s>", name);
    }
    if (depth == 0 && (version == NULL || version[0] < '2' || version[0] > '4' || version[1] != '.')) {
        msh_fail(r, "version '%s': open it in FEBio Studio and export it in the format 4.0",
                 version != NULL ? version : "");
    } else if (strcmp(name, "Include") == 0 || (depth == 1 && from != NULL)) {
        msh_fail(r, "other files are not read: put the content of that file in its place");
    } else if (depth == 1) {
        f->in_mesh = strcmp(name, "Geometry") == 0 || strcmp(name, "Mesh") == 0;
        if (!f->in_mesh) {
            input_leave_out(f->r, name);
        }
    } else if (depth == 2 && f->in_mesh) {
        begin_content(f, name, attributes);
    } else if (depth == 3 && f->in_mesh && f->content != OTHERS) {
        begin_item(f, name, attributes);
    }
}

/* ---- their numbers ---- */

static void add_node(struct feb *f, const char *text, const char *end)
{
    double x[3] = {0};
    int64_t length;
    for (int k = 0; k < 3; k++) {
        const char *word = input_word(&text, end, ',', &length);
        x[k] = input_real(f->r, "coordinate", word != NULL ? word : "", length);
    }
    if (input_word(&text, end, ',', &length) != NULL) {
        msh_fail(f->r, "node %jd has more than three coordinates", f->id);
    }
    msh_add_node(f->r, f->id, x);
}

static void add_element(struct feb *f, const char *text, const char *end)
{
    struct msh_reader *r = f->r;
    int64_t length, node[MSH_MOST_NODES];
    int count = msh_type(f->type).node_count, found = 0;
    const char *word;
    while (r->status == STATUS_OK && (word = input_word(&text, end, ',', &length)) != NULL) {
        int64_t tag = input_whole(r, "node", word, length, 1, MSH_LARGEST_TAG);
        node[found < count ? found : 0] = tag;
        found++;
    }
    if (found != count) {
        msh_fail(r, "%d nodes, where %s has %d", found, msh_type(f->type).name, count);
    }
    if (r->status != STATUS_OK) {
        return;
    }
    msh_add_element(f->r, f->id, f->type, node, input_group(f->r, msh_type(f->type).dim, f->name));
}

/* A list of the nodes of a set: of versions 3 and 4. */
static void add_list(struct feb *f, const char *text, const char *end)
{
    int64_t length;
    const char *word;
    while (f->r->status == STATUS_OK && (word = input_word(&text, end, ',', &length)) != NULL) {
        int64_t node = input_whole(f->r, "node", word, length, 1, MSH_LARGEST_TAG);
        msh_add_element(f->r, MSH_NO_TAG, INPUT_POINT, &node, input_group(f->r, 0, f->name));
        f->is_empty = false;
    }
}

/* A part, surface or set ends: one without anything in it is a group, too. */
static void end_content(struct feb *f, const char *text, const char *end)
{
    static const int dim[] = {[SURFACE] = 2, [EDGE] = 1, [NODE_SET] = 0};
    if (f->content == NODE_SET) {
        add_list(f, text, end);
    }
    if (f->content == NODE_SET && f->name[0] != '\0') {
        *input_name(f->r, FIRST_OF_SET, f->name, strlen(f->name)) = f->first + 1;
        *input_name(f->r, END_OF_SET, f->name, strlen(f->name)) = f->r->msh->element_count;
    }
    if (f->is_empty && f->content != NODES) {
        (void)input_group(f->r, f->content == ELEMENTS ? msh_type(f->type).dim : dim[f->content], f->name);
    }
    f->content = OTHERS;
}

static void end(void *context, const char *name, const char *text, int64_t size, int depth)
{
    struct feb *f = context;
    (void)name;
    if (!f->in_mesh || f->content == OTHERS || depth > 3) {
        return;
    }
    if (depth < 3) {
        end_content(f, text, text + size);
        return;
    }
    f->is_empty = false;
    if (f->content == NODES) {
        add_node(f, text, text + size);
    } else if (f->content == NODE_SET && f->id == MSH_NO_TAG) {
        return; /* another set */
    } else if (f->content == NODE_SET) {
        msh_add_element(f->r, MSH_NO_TAG, INPUT_POINT, &f->id, input_group(f->r, 0, f->name));
    } else {
        add_element(f, text, text + size);
    }
}

void feb_read(struct msh_reader *r)
{
    struct feb f = {.r = r};
    const struct xml_handler handler = {&f, begin, end};
    r->section = f.section;
    xml_parse(r, NULL, &handler);
    input_at(r, "nodes", 0);
}
