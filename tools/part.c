static const char usage[] =
    "part - cut a body into parts, each a stream of its own\n"
    "\n"
    "usage: part -k PARTS [-w WIDEN] [-f FACTOR | -R RADIUS] [-v] [-t] [-o NAME] [FILE]\n"
    "\n"
    "Reads a stream with nodes and cells (see nodes, voxels, cloud) and cuts it into PARTS of about\n"
    "equal work, with few nodes between them, by METIS. Each part is written as a stream under NAME,\n"
    "in which %d is its number, from 0. It has the nodes and cells of the part, and a halo of those of\n"
    "others that supports reach over, so that ipoints, support and shapefn compute on it what they\n"
    "compute on the whole body: run the three, with the same options, on each part, side by side or on\n"
    "several machines, and unpart puts tables and fields together again, to the same bytes.\n"
    "\n"
    "Nodes and cells keep their order. part.node and part.cell have their numbers in the body, part.owner\n"
    "the part that each node belongs to; a cell belongs to the part with most of its vertices. Sections\n"
    "of ipoints, support and shapefn, results other than fields at the nodes, and unknown sections are\n"
    "left out, with a note. Groups are to be made before a body is cut.\n"
    "\n"
    "Options:\n"
    "  -k, --parts PARTS      how many parts\n"
    "  -w, --widen WIDEN      the most that support will widen radii (default 1.5); unpart refuses parts\n"
    "                         whose halo turns out too narrow\n"
    "  -f, --factor FACTOR    support's -k, if it is to be given (default 1.8, in 3D 2)\n"
    "  -R, --radius RADIUS    support's -R, if it is to be given\n"
    "  -v, --verbose          report on standard error, as a table of one row: parts; mean and largest\n"
    "                         number of own nodes; of nodes with the halo in the streams; of nodes of\n"
    "                         others that an evaluation needs, and of the parts that these belong to; bytes\n"
    "                         that a part exchanges in an evaluation, mean and largest; imbalance, the\n"
    "                         largest work over the mean, less 1. Without -o that is all.\n"
    "  -t, --text             write text instead of binary\n"
    "  -o, --output NAME      each part's file, which appears only when whole\n"
    "\n"
    "Examples:\n"
    "  nodes -u mm body.msh | part -k 8 -o part.%d.mts\n"
    "  ls part.?.mts | xargs -P 8 -I {} shapefn -o {}.table {} && unpart part.?.mts.table > table.mts\n";

#include "mls_options.h"
#include "stages.h"

#include "approx/partition.h"
#include "io/sections.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { PARTS, WIDEN, FACTOR, RADIUS, VERBOSE, TEXT, OUTPUT, OPTION_COUNT };

/* The body, its sections as they were read, and how it is cut. */
struct whole {
    struct tool *tool;
    struct stream *stream;
    struct section *sections; /* those of the stream when it was read */
    int64_t section_count;
    struct cells cells;
    struct cell_stars stars;
    struct point_grid grid;
    struct partition partition;
    int64_t *own_ptr;
    int32_t *own_cell;
    double *radius;
    int32_t *owner, *work;
    uint32_t cut; /* tells parts of this cut from others */
};

/* Is this a field at the nodes? */
static bool is_nodal(const struct whole *whole, const struct section *section)
{
    static const char *const fields[] = {"u", "parameters", "u.frame.", "parameters.frame."};
    for (int i = 0; i < 4; i++) {
        if (i < 2 ? strcmp(section->name, fields[i]) == 0
                  : strncmp(section->name, fields[i], strlen(fields[i])) == 0) {
            return section->rows == whole->cells.node_count;
        }
    }
    return strcmp(section->name, "parameters.radius") == 0 || strcmp(section->name, "nodes.x") == 0;
}

/* Take out what cannot be cut, and keep what the rest was. */
static void keep_sections(struct whole *whole)
{
    static const char *const known[] = {"cells",      "cells.region", "facets",
                                        "facets.set", "sets.ptr",     "sets.idx"};
    struct error error;
    struct stream *stream = whole->stream;
    char dropped[256] = "";
    for (int64_t i = stream->section_count - 1; i >= 0; i--) {
        const struct section *section = &stream->sections[i];
        bool kept = is_nodal(whole, section);
        for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
            kept = kept || strcmp(section->name, known[k]) == 0;
        }
        if (!kept) {
            size_t length = strlen(dropped);
            snprintf(dropped + length, sizeof dropped - length, " %s", section->name);
            stream_remove(stream, section->name);
        }
    }
    if (dropped[0] != '\0') {
        tool_note(whole->tool, "left out:%s", dropped);
    }
    whole->section_count = stream->section_count;
    tool_check(whole->tool, NEW_ARRAY(&whole->sections, stream->section_count, &error), &error);
    for (int64_t i = 0; i < stream->section_count; i++) {
        struct section *kept = &whole->sections[i];
        *kept = stream->sections[i];
        stream->sections[i].owned = false; /* freed at the end: they are replaced for each part */
        kept->name = strdup(kept->name);
        kept->attributes = strdup(kept->attributes);
        if (kept->name == NULL || kept->attributes == NULL) {
            tool_fail(whole->tool, STATUS_SYSTEM, "out of memory");
        }
    }
}

static const struct section *kept_section(const struct whole *whole, const char *name)
{
    for (int64_t i = 0; i < whole->section_count; i++) {
        if (strcmp(whole->sections[i].name, name) == 0) {
            return &whole->sections[i];
        }
    }
    return NULL;
}

static void put(const struct whole *whole, const char *name, enum element_type type, int64_t rows,
                int64_t cols, const char *attributes, void *data)
{
    struct error error;
    tool_check(whole->tool, stream_put(whole->stream, name, type, rows, cols, attributes, data, true, &error),
               &error);
}

/* Put these rows of a section; where `place` is given, its values are node numbers and become places there.
 */
static void put_rows(const struct whole *whole, const struct section *section, const int32_t *row,
                     int64_t count, const int32_t *place)
{
    size_t bytes = element_size(section->type) * (size_t)section->cols;
    char *data = array_new(count, bytes);
    if (data == NULL) {
        tool_fail(whole->tool, STATUS_SYSTEM, "%s: out of memory", section->name);
    }
    for (int64_t i = 0; i < count; i++) {
        memcpy(data + (size_t)i * bytes, (const char *)section->data + (size_t)row[i] * bytes, bytes);
    }
    for (int64_t i = 0; place != NULL && i < count * section->cols; i++) {
        ((int32_t *)data)[i] = place[((int32_t *)data)[i]];
    }
    put(whole, section->name, section->type, count, section->cols, section->attributes, data);
}

/* A copy of a list of numbers as a section. */
static void put_numbers(const struct whole *whole, const char *name, const char *attributes,
                        const int32_t *number, int64_t count)
{
    struct error error;
    int32_t *copy;
    tool_check(whole->tool, NEW_ARRAY(&copy, count, &error), &error);
    if (count > 0) {
        memcpy(copy, number, (size_t)count * sizeof *copy);
    }
    put(whole, name, TYPE_I4, count, 1, attributes, copy);
}

/* Facets whose nodes are all there and belong to a cell that is. */
static void put_facets(const struct whole *whole, const int32_t *place, const bool *has_cell)
{
    struct error error;
    const struct section *facets = kept_section(whole, "facets"), *set = kept_section(whole, "facets.set");
    if (facets == NULL || set == NULL) {
        return;
    }
    const int32_t *node = facets->data;
    const struct cell_stars *stars = &whole->stars;
    int dim = whole->cells.dim;
    int64_t count = 0;
    int32_t *row;
    tool_check(whole->tool, NEW_ARRAY(&row, facets->rows, &error), &error);
    for (int64_t f = 0; f < facets->rows; f++) {
        bool there = false;
        int32_t first = node[f * dim];
        for (int64_t s = stars->ptr[first]; s < stars->ptr[first + 1] && !there; s++) {
            const int32_t *vertex = whole->cells.node + (int64_t)stars->cell[s] * (dim + 1);
            int found = 0;
            for (int i = 0; i < dim; i++) {
                for (int k = 0; k <= dim; k++) {
                    found += vertex[k] == node[f * dim + i];
                }
            }
            there = found == dim && has_cell[stars->cell[s]];
        }
        if (there) {
            row[count++] = (int32_t)f;
        }
    }
    put_rows(whole, facets, row, count, place);
    put_rows(whole, set, row, count, NULL);
    put_numbers(whole, "part.facet", "", row, count);
    free(row);
}

static void put_sets(const struct whole *whole, const int32_t *place)
{
    struct error error;
    const struct section *ptr = kept_section(whole, "sets.ptr"), *idx = kept_section(whole, "sets.idx");
    if (ptr == NULL || idx == NULL) {
        return;
    }
    const int64_t *begin = ptr->data;
    const int32_t *node = idx->data;
    int64_t *own, count = 0;
    int32_t *row;
    tool_check(whole->tool, NEW_ARRAY(&own, ptr->rows, &error), &error);
    tool_check(whole->tool, NEW_ARRAY(&row, idx->rows, &error), &error);
    for (int64_t s = 0; s + 1 < ptr->rows; s++) {
        for (int64_t i = begin[s]; i < begin[s + 1]; i++) {
            if (place[node[i]] >= 0) {
                row[count++] = (int32_t)i;
            }
        }
        own[s + 1] = count;
    }
    put(whole, "sets.ptr", TYPE_I8, ptr->rows, 1, ptr->attributes, own);
    put_rows(whole, idx, row, count, place);
    put_numbers(whole, "part.set", "", row, count);
    free(row);
}

/* The stream becomes that of one part. */
static void make_part(const struct whole *whole, int32_t number, const struct body_part *body)
{
    struct error error;
    int32_t *place, *owner;
    bool *has_cell;
    char attributes[192];
    tool_check(whole->tool, NEW_ARRAY(&place, whole->cells.node_count, &error), &error);
    tool_check(whole->tool, NEW_ARRAY(&has_cell, whole->cells.count, &error), &error);
    tool_check(whole->tool, NEW_ARRAY(&owner, body->node_count, &error), &error);
    for (int64_t n = 0; n < whole->cells.node_count; n++) {
        place[n] = -1;
    }
    for (int64_t i = 0; i < body->node_count; i++) {
        place[body->node[i]] = (int32_t)i;
        owner[i] = whole->owner[body->node[i]];
    }
    for (int64_t i = 0; i < body->cell_count; i++) {
        has_cell[body->cell[i]] = true;
    }
    for (int64_t i = 0; i < whole->section_count; i++) {
        const struct section *section = &whole->sections[i];
        if (is_nodal(whole, section)) {
            put_rows(whole, section, body->node, body->node_count, NULL);
        } else if (strncmp(section->name, "cells", 5) == 0) {
            put_rows(whole, section, body->cell, body->cell_count, section->cols > 1 ? place : NULL);
        }
    }
    snprintf(attributes, sizeof attributes, "part=%d parts=%d cut=%08x nodes=%lld cells=%lld widen=%.17g",
             number, whole->partition.parts, whole->cut, (long long)whole->cells.node_count,
             (long long)whole->cells.count, whole->partition.widen);
    put_numbers(whole, "part.node", attributes, body->node, body->node_count);
    put(whole, "part.owner", TYPE_I4, body->node_count, 1, "", owner);
    put_numbers(whole, "part.cell", "", body->cell, body->cell_count);
    put_facets(whole, place, has_cell);
    put_sets(whole, place);
    free(place);
    free(has_cell);
}

/* "NAME with %d" with a number in its place; to be freed. */
static char *numbered(const struct tool *tool, const char *name, int32_t number)
{
    char *text;
    const char *at = strstr(name, "%d");
    if (at == NULL || strstr(at + 1, "%d") != NULL) {
        tool_fail(tool, STATUS_INPUT, "-o %s: has to have one %%d, where the number of the part goes", name);
    }
    if (asprintf(&text, "%.*s%d%s", (int)(at - name), name, number, at + 2) < 0) {
        tool_fail(tool, STATUS_SYSTEM, "out of memory");
    }
    return text;
}

/* What -v tells. */
struct report {
    double own, nodes, needed, others, work;
    double most_own, most_nodes, most_needed, most_others, most_work;
};

static void add(double value, double *sum, double *most)
{
    *sum += value;
    *most = value > *most ? value : *most;
}

static void print_report(const struct whole *whole, const struct report *report)
{
    int32_t parts = whole->partition.parts;
    /* Displacements of the nodes of others come in, forces on them go out; and the same for one's own nodes.
     */
    double bytes = 2.0 * whole->cells.dim * sizeof(double);
    fprintf(stderr, "parts\town_nodes\tmost\tstored_nodes\tmost\tneeded_nodes\tmost\tother_parts\tmost\tbytes"
                    "\tmost\timbalance\n");
    fprintf(stderr, "%d\t%.0f\t%.0f\t%.0f\t%.0f\t%.0f\t%.0f\t%.1f\t%.0f\t%.0f\t%.0f\t%.4f\n", parts,
            report->own / parts, report->most_own, report->nodes / parts, report->most_nodes,
            report->needed / parts, report->most_needed, report->others / parts, report->most_others,
            bytes * report->needed / parts, bytes * report->most_needed,
            report->most_work * parts / report->work - 1.0);
}

static void write_parts(const struct whole *whole, bool wanted, bool text, struct report *report)
{
    struct error error;
    struct body_part_work work = {0};
    const char *name = whole->tool->output;
    for (int32_t k = 0; k < whole->partition.parts; k++) {
        struct body_part body;
        tool_check(whole->tool,
                   body_part_build(&whole->partition, k, whole->own_cell + whole->own_ptr[k],
                                   whole->own_ptr[k + 1] - whole->own_ptr[k], wanted, &work, &body, &error),
                   &error);
        add((double)body.own_nodes, &report->own, &report->most_own);
        add((double)body.node_count, &report->nodes, &report->most_nodes);
        add((double)body.needed, &report->needed, &report->most_needed);
        add((double)body.others, &report->others, &report->most_others);
        add(body.work, &report->work, &report->most_work);
        if (wanted) {
            make_part(whole, k, &body);
            char *file = numbered(whole->tool, name, k);
            whole->tool->output = file;
            if (k == 0) {
                tool_write(whole->tool, whole->stream, text); /* and how it was made, for all */
            } else {
                tool_copy(whole->tool, whole->stream, text);
            }
            whole->tool->output = name;
            free(file);
        }
        body_part_free(&body);
    }
    body_part_work_free(&work);
}

/* What parts of one cut have in common, and those of another have not. */
static uint32_t identify(const struct whole *whole)
{
    const struct cells *cells = &whole->cells;
    uLong crc = crc32_z(0, NULL, 0);
    crc = crc32_z(crc, (const Bytef *)cells->x, (size_t)(cells->node_count * cells->dim) * sizeof *cells->x);
    crc = crc32_z(crc, (const Bytef *)cells->node,
                  (size_t)(cells->count * (cells->dim + 1)) * sizeof *cells->node);
    crc = crc32_z(crc, (const Bytef *)whole->owner, (size_t)cells->node_count * sizeof *whole->owner);
    return (uint32_t)crc32_z(crc, (const Bytef *)&whole->partition.widen, sizeof whole->partition.widen);
}

static void cut(struct whole *whole, const struct support_options *support)
{
    struct error error;
    struct tool *tool = whole->tool;
    struct cells *cells = &whole->cells;
    tool_check(tool, NEW_ARRAY(&whole->radius, cells->node_count, &error), &error);
    tool_check(tool, NEW_ARRAY(&whole->owner, cells->node_count, &error), &error);
    tool_check(tool, NEW_ARRAY(&whole->work, cells->count, &error), &error);
    tool_check(tool, stage_radii(whole->stream, support, cells->node_count, cells->x, whole->radius, &error),
               &error);
    tool_check(tool,
               point_grid_build(&whole->grid, cells->dim, cells->node_count, cells->x, whole->radius, &error),
               &error);
    tool_check(tool, cell_stars_build(cells, &whole->stars, &error), &error);
    tool_check(tool, partition_work(cells, &whole->grid, whole->work, &error), &error);
    tool_check(
        tool,
        partition_nodes(cells, &whole->stars, whole->work, whole->partition.parts, whole->owner, &error),
        &error);
    whole->partition.cells = cells;
    whole->partition.stars = &whole->stars;
    whole->partition.grid = &whole->grid;
    whole->partition.owner = whole->owner;
    whole->partition.work = whole->work;
    tool_check(tool, partition_own_cells(&whole->partition, &whole->own_ptr, &whole->own_cell, &error),
               &error);
    whole->cut = identify(whole);
}

static void whole_free(struct whole *whole)
{
    free(whole->radius);
    free(whole->owner);
    free(whole->work);
    free(whole->own_ptr);
    free(whole->own_cell);
    cell_stars_free(&whole->stars);
    point_grid_free(&whole->grid);
    for (int64_t i = 0; i < whole->section_count; i++) {
        free(whole->sections[i].name);
        free(whole->sections[i].attributes);
        if (whole->sections[i].owned) {
            free(whole->sections[i].data);
        }
    }
    free(whole->sections);
}

int main(int argc, char *argv[])
{
    struct tool tool;
    struct stream stream;
    struct error error;
    struct option options[OPTION_COUNT] = {
        [PARTS] = {.letter = 'k', .name = "parts", .takes_value = true},
        [WIDEN] = {.letter = 'w', .name = "widen", .takes_value = true},
        [FACTOR] = {.letter = 'f', .name = "factor", .takes_value = true},
        [RADIUS] = {.letter = 'R', .name = "radius", .takes_value = true},
        [VERBOSE] = {.letter = 'v', .name = "verbose"},
        [TEXT] = {.letter = 't', .name = "text"},
        [OUTPUT] = {.letter = 'o', .name = "output", .takes_value = true},
    };
    int64_t parts = 0;
    struct whole whole = {.tool = &tool, .stream = &stream, .partition = {.widen = 1.5}};
    struct support_options support = support_defaults(2);
    tool_begin(&tool, usage, options, OPTION_COUNT, 0, 1, argc, argv);
    if (!options[PARTS].given) {
        tool_fail(&tool, STATUS_INPUT, "give -k PARTS (see -h)");
    }
    tool_check(&tool, parse_integer(options[PARTS].value, "-k", 1, 1000000, &parts, &error), &error);
    whole.partition.parts = (int32_t)parts;
    if (options[WIDEN].given) {
        tool_check(&tool, parse_double(options[WIDEN].value, "-w", 1.0, 8.0, &whole.partition.widen, &error),
                   &error);
    }
    tool_check(&tool, radius_apply_options(&options[FACTOR], &options[RADIUS], &support, &error), &error);
    if (tool.output != NULL) {
        free(numbered(&tool, tool.output, 0));
    } else if (!options[VERBOSE].given) {
        tool_fail(&tool, STATUS_INPUT, "nothing to do: give -o NAME or -v (see -h)");
    }
    tool_read(&tool, tool.operands[0], &stream);
    if (stream_find(&stream, "part.node") != NULL) {
        tool_fail(&tool, STATUS_INPUT, "part.node: the input is a part already");
    }
    tool_check(&tool, stream_cells(&stream, true, &whole.cells, &error), &error);
    support = support_defaults(whole.cells.dim);
    tool_check(&tool, radius_apply_options(&options[FACTOR], &options[RADIUS], &support, &error), &error);
    cut(&whole, &support);
    keep_sections(&whole);
    struct report report = {0};
    write_parts(&whole, tool.output != NULL, options[TEXT].given, &report);
    if (options[VERBOSE].given) {
        print_report(&whole, &report);
    }
    stream_free(&stream);
    whole_free(&whole);
    return tool_end(&tool);
}
