/* Meshes in XML, element by element; private to lib/io. */
#pragma once

#include "io/mesh/msh_private.h"

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
