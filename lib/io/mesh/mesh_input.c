#include "io/mesh/mesh_input.h"
#include "io/stream/stream_private.h"

#include <math.h>
#include <search.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int64_t input_whole(struct msh_reader *r, const char *what, const char *word, int64_t length, int64_t least,
                    int64_t most)
{
    int64_t number = least;
    const char *end = word + length;
    if (number_parse_integer(word, end, -INT64_MAX, INT64_MAX, &number) != end) {
        msh_fail(r, "%s: '%.*s' is not a whole number", what, length < 64 ? (int)length : 64, word);
    } else if (number < least || number > most) {
        msh_fail(r, "%s: %lld is not within [%lld, %lld]", what, (long long)number, (long long)least,
                 (long long)most);
    }
    return r->status == STATUS_OK ? number : least;
}

double input_real(struct msh_reader *r, const char *what, const char *word, int64_t length)
{
    char text[64] = "";
    double number = 0;
    size_t size = length < (int64_t)sizeof text ? (size_t)length : 0;
    for (size_t i = 0; i < size; i++) {
        text[i] = word[i];
        if (word[i] == 'D' || word[i] == 'd') {
            text[i] = 'e';
        }
    }
    if (number_parse_double(text, text + size, &number) != text + size || !isfinite(number)) {
        msh_fail(r, "%s: '%.*s' is not a finite number", what, length < 64 ? (int)length : 64, word);
    }
    return r->status == STATUS_OK ? number : 0;
}

int input_type(int dim, int node_count)
{
    for (int type = 1; msh_type(type).name != NULL; type++) {
        if (msh_type(type).dim == dim && msh_type(type).node_count == node_count) {
            return type;
        }
    }
    return 0;
}

void input_reorder(int type, int64_t node[])
{
    static const int8_t tetrahedron10[] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8},
                        hexahedron27[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 16, 9,  17, 10,
                                          18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26};
    int64_t from[27];
    const int8_t *order = type == 11 ? tetrahedron10 : type == 12 ? hexahedron27 : NULL;
    for (int pass = 0; pass < 2 && order != NULL; pass++) {
        for (int k = 0; k < msh_type(type).node_count; k++) {
            *(pass == 0 ? &from[k] : &node[k]) = pass == 0 ? node[k] : from[order[k]];
        }
    }
}

const char *input_word(const char **at, const char *end, int64_t *length)
{
    static const char between[] = " ,\t\r\n";
    while (*at < end && memchr(between, **at, sizeof between - 1) != NULL) {
        ++*at;
    }
    const char *word = *at;
    while (*at < end && memchr(between, **at, sizeof between - 1) == NULL) {
        ++*at;
    }
    *length = *at - word;
    return *length > 0 ? word : NULL;
}

void input_add_node(struct mesh_input *in, int64_t tag, const double x[3])
{
    struct msh *msh = in->r->msh;
    MSH_GROW(in->r, &msh->x, 3 * (msh->node_count + 1), &in->x_room);
    MSH_GROW(in->r, &msh->node_tag, msh->node_count + 1, &in->node_room);
    MSH_GROW(in->r, &in->line, msh->node_count + 1, &in->line_room);
    if (in->r->status == STATUS_OK) {
        in->line[msh->node_count] = in->r->record;
        memcpy(&msh->x[3 * msh->node_count], x, 3 * sizeof *x);
        msh->node_tag[msh->node_count++] = tag;
    }
}

void input_add_element(struct mesh_input *in, int64_t tag, int type, const int64_t node[], int64_t key)
{
    struct msh_reader *r = in->r;
    struct msh *msh = r->msh;
    int64_t e = msh->element_count, first = e > 0 ? msh->node_ptr[e] : 0, count = msh_type(type).node_count;
    MSH_GROW(r, &msh->element_tag, e + 1, &in->tag_room);
    MSH_GROW(r, &msh->element_type, e + 1, &in->type_room);
    MSH_GROW(r, &r->element_key, e + 1, &in->key_room);
    MSH_GROW(r, &msh->node_ptr, e + 2, &in->ptr_room);
    MSH_GROW(r, &in->corners, first + count, &in->corner_room);
    if (r->status == STATUS_OK) {
        msh->element_tag[e] = tag;
        msh->element_type[e] = (int8_t)type;
        r->element_key[e] = key;
        msh->node_ptr[e] = first;
        msh->node_ptr[e + 1] = first + count;
        memcpy(&in->corners[first], node, (size_t)count * sizeof *node);
        msh->element_count++;
    }
}

int64_t input_add_group(struct mesh_input *in, int dim, const char *text, int64_t length)
{
    struct msh_reader *r = in->r;
    if (length < 1 || length > INPUT_NAME || memchr(text, '\0', (size_t)length) != NULL) {
        msh_fail(r, "a name is empty or longer than %d bytes", INPUT_NAME);
    }
    MSH_GROW(r, &r->names, r->name_count + 1, &in->name_room);
    if (r->status != STATUS_OK) {
        return 0;
    }
    char *copy = strndup(text, (size_t)length);
    r->status = owned_add(&r->texts, copy, "names", r->error);
    int64_t key = msh_key(dim, r->name_count + 1);
    r->names[r->name_count++] = (struct msh_name){key, copy, (int)length};
    return key;
}

struct name {
    int64_t number;
    int kind;
    char text[INPUT_NAME + 1];
};

static int compare_names(const void *left, const void *right)
{
    const struct name *a = left, *b = right;
    return a->kind != b->kind ? a->kind - b->kind : strcmp(a->text, b->text);
}

int64_t *input_name(struct mesh_input *in, int kind, const char *text, size_t length)
{
    struct msh_reader *r = in->r;
    struct name wanted = {.kind = kind};
    if (length < 1 || length > INPUT_NAME) {
        msh_fail(r, "a name is empty or longer than %d bytes", INPUT_NAME);
    }
    if (r->status != STATUS_OK) {
        return NULL;
    }
    memcpy(wanted.text, text, length);
    struct name *const *found = tfind(&wanted, &in->names, compare_names);
    if (found != NULL) {
        return &(*found)->number;
    }
    SCRATCH struct name *name = malloc(sizeof *name);
    if (name == NULL || (*name = wanted, tsearch(name, &in->names, compare_names)) == NULL) {
        r->status = fail_memory(r->error, "names");
        return NULL;
    }
    return &((struct name *)array_take(&name))->number;
}

int64_t input_group(struct mesh_input *in, int dim, const char *text)
{
    int64_t *key = input_name(in, dim, text, strlen(text));
    if (key != NULL && *key == 0) {
        *key = input_add_group(in, dim, text, (int64_t)strlen(text));
    }
    return key != NULL ? *key : 0;
}

void input_leave_out(struct mesh_input *in, const char *what)
{
    char item[80] = ", ";
    text_append(item, sizeof item, "%s", what);
    const char *found = strstr(in->left_out, item);
    size_t length = strlen(item);
    bool is_new = found == NULL || (found[length] != '\0' && found[length] != ',');
    if (is_new && strlen(in->left_out) + length < sizeof in->left_out) {
        text_append(in->left_out, sizeof in->left_out, "%s", item);
    }
}

void input_note(struct mesh_input *in, const char *format, ...)
{
    char note[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(note, sizeof note, format, arguments);
    va_end(arguments);
    if (in->r->status == STATUS_OK) {
        in->r->status = mesh_add_name(&in->r->msh->notes, note, in->r->error);
    }
}

void input_index(struct mesh_input *in)
{
    struct msh_reader *r = in->r;
    if (r->status == STATUS_OK) {
        r->section = "nodes";
        r->kind = "node";
        r->line = in->line;
        msh_index_make(r, &r->nodes, r->msh->node_count, r->msh->node_tag);
        r->line = NULL;
    }
}

/* Say that an element, a set or a surface names a node that there is not. */
static void fail_corner(struct mesh_input *in, int64_t e, int64_t node)
{
    struct msh_reader *r = in->r;
    int64_t tag = r->msh->element_tag[e];
    int length = 0;
    const char *name = "";
    for (int64_t i = 0; i < r->name_count; i++) {
        if (r->names[i].key == r->element_key[e]) {
            name = r->names[i].text;
            length = r->names[i].length;
        }
    }
    if (tag != INPUT_NO_TAG) {
        msh_fail(r, "element %lld names the node %lld, which is not in the file", (long long)tag,
                 (long long)node);
    } else {
        msh_fail(r, "the set or surface '%.*s' names the node %lld, which is not in the file", length, name,
                 (long long)node);
    }
}

static void find_corners(struct mesh_input *in)
{
    struct msh_reader *r = in->r;
    struct msh *msh = r->msh;
    r->section = "elements";
    r->record = 0;
    MSH_GROW(r, &msh->node_ptr, 1, &in->ptr_room);
    if (r->status == STATUS_OK && msh->element_count == 0) {
        msh->node_ptr[0] = 0;
    }
    MSH_NEW(r, &msh->node_idx, r->status == STATUS_OK ? msh->node_ptr[msh->element_count] : 0);
    for (int64_t e = 0; e < msh->element_count; e++) {
        for (int64_t k = msh->node_ptr[e]; r->status == STATUS_OK && k < msh->node_ptr[e + 1]; k++) {
            int64_t place = msh_index_find(&r->nodes, in->corners[k]);
            msh->node_idx[k] = (int32_t)place;
            if (place < 0) {
                fail_corner(in, e, in->corners[k]);
            }
        }
    }
}

void input_finish(struct mesh_input *in)
{
    struct msh_reader *r = in->r;
    struct msh *msh = r->msh;
    int64_t tag = 0;
    find_corners(in);
    MSH_NEW(r, &r->entity_key, msh->element_count);
    for (int64_t e = 0; e < msh->element_count; e++) {
        tag = msh->element_tag[e] > tag ? msh->element_tag[e] : tag;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        msh->element_tag[e] = msh->element_tag[e] != INPUT_NO_TAG ? msh->element_tag[e] : ++tag;
    }
    if (in->left_out[0] != '\0') {
        input_note(in, "what else is in the file is left out: %s", in->left_out + 2);
    }
}

void input_free(struct mesh_input *in)
{
    tdestroy(in->names, free);
    FREE_ALL(in->line, in->corners);
}
