#include "io/mesh/msh_private.h"

#include <expat.h>
#include <string.h>

/* Most bytes that are given to expat at once: it counts them as int. */
#define STRIDE (1 << 20)

struct parsing {
    struct msh_reader *r;
    XML_Parser parser;
    const struct xml_handler *handler;
    const char *begin, *last;
    char *text; /* of the open elements, without that of their children */
    int64_t size, room;
    int64_t *start; /* where in it the text of each open element begins */
    int64_t start_room;
    int depth;
    bool is_last;
};

const char *xml_attribute(const char **attributes, const char *name)
{
    for (; attributes[0] != NULL; attributes += 2) {
        if (strcmp(attributes[0], name) == 0) {
            return attributes[1];
        }
    }
    return NULL;
}

/* Stop if a handler failed. */
static void check(struct parsing *p)
{
    if (p->r->status != STATUS_OK) {
        (void)XML_StopParser(p->parser, XML_FALSE);
    }
}

static void XMLCALL begin_element(void *data, const char *name, const char **attributes)
{
    struct parsing *p = data;
    p->r->record = (int64_t)XML_GetCurrentLineNumber(p->parser);
    MSH_GROW(p->r, &p->start, p->depth + 1, &p->start_room);
    if (p->r->status == STATUS_OK) {
        p->start[p->depth] = p->size;
    }
    if (p->last != NULL && strcmp(name, p->last) == 0) {
        p->is_last = true;
        p->r->at = p->begin + XML_GetCurrentByteIndex(p->parser);
        (void)XML_StopParser(p->parser, XML_FALSE);
        return;
    }
    if (p->r->status == STATUS_OK) {
        p->handler->begin(p->handler->context, name, attributes, p->depth++);
    }
    check(p);
}

static void XMLCALL add_text(void *data, const char *text, int length)
{
    struct parsing *p = data;
    MSH_GROW(p->r, &p->text, p->size + length + 1, &p->room);
    if (p->r->status == STATUS_OK) {
        memcpy(p->text + p->size, text, (size_t)length);
        p->size += length;
    }
    check(p);
}

static void XMLCALL end_element(void *data, const char *name)
{
    struct parsing *p = data;
    p->r->record = (int64_t)XML_GetCurrentLineNumber(p->parser);
    add_text(p, "", 0);
    if (p->r->status == STATUS_OK && !p->is_last) {
        int64_t start = p->start[--p->depth];
        p->text[p->size] = '\0';
        p->handler->end(p->handler->context, name, p->text + start, p->size - start, p->depth);
        p->size = start;
    }
    check(p);
}

static void XMLCALL refuse_doctype(void *data, const char *name, const char *system, const char *public,
                                   int internal)
{
    struct parsing *p = data;
    (void)name, (void)system, (void)public, (void)internal;
    p->r->section = "XML";
    p->r->record = (int64_t)XML_GetCurrentLineNumber(p->parser);
    msh_fail(p->r, "the file declares a document type: take <!DOCTYPE ...> out");
    check(p);
}

static void parse(struct parsing *p)
{
    struct msh_reader *r = p->r;
    const char *at = r->at, *end = r->end;
    bool more = true;
    while (r->status == STATUS_OK && more && !p->is_last) {
        int size = end - at < STRIDE ? (int)(end - at) : STRIDE;
        more = at + size < end;
        if (XML_Parse(p->parser, at, size, !more) == XML_STATUS_ERROR && !p->is_last &&
            r->status == STATUS_OK) {
            enum XML_Error cause = XML_GetErrorCode(p->parser);
            if (cause == XML_ERROR_NO_MEMORY) {
                r->status = fail_memory(r->error, "XML");
                return;
            }
            r->section = "XML";
            r->record = (int64_t)XML_GetCurrentLineNumber(p->parser);
            msh_fail(r, "%s%s", XML_ErrorString(cause),
                     !more && cause == XML_ERROR_NO_ELEMENTS ? ": the file is truncated" : "");
        }
        at += size;
    }
}

void xml_parse(struct msh_reader *r, const char *last, const struct xml_handler *handler)
{
    struct parsing p = {
        .r = r, .handler = handler, .begin = r->at, .last = last, .parser = XML_ParserCreate(NULL)};
    r->kind = "line";
    if (p.parser == NULL) {
        r->status = fail_memory(r->error, "XML");
        return;
    }
    XML_SetUserData(p.parser, &p);
    XML_SetElementHandler(p.parser, begin_element, end_element);
    XML_SetCharacterDataHandler(p.parser, add_text);
    XML_SetStartDoctypeDeclHandler(p.parser, refuse_doctype);
    parse(&p);
    XML_ParserFree(p.parser);
    r->at = p.is_last ? r->at : r->end;
    FREE_ALL(p.text, p.start);
}
