#include "io/scene/scene_private.h"

#include "base/memory.h"
#include "base/options.h"
#include "io/files/landmarks.h"

#include <ctype.h>
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Put the place of a key, or with key NULL of the section, in front of a message. */
static enum status fail_at(const struct place *place, const char *key, enum status status)
{
    const struct ini_section *section = place->section;
    const struct ini_entry *entry = key != NULL ? ini_find(section, key) : NULL;
    return fail_in(place->error, status, "%s:%jd: [%s%s%s]", place->scene->path,
                   (entry != NULL ? entry->line : section->line), section->kind,
                   section->name[0] != '\0' ? " " : "", section->name);
}

enum status place_fail(const struct place *place, const char *key, const char *format, ...)
{
    char message[sizeof place->error->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    fail(place->error, STATUS_INPUT, "%s%s%s", key != NULL ? key : "", key != NULL ? ": " : "", message);
    return fail_at(place, key, STATUS_INPUT);
}

bool place_has(const struct place *place, const char *key)
{
    return ini_find(place->section, key) != NULL;
}

enum status place_require(const struct place *place, const char *key, const char *what)
{
    return place_has(place, key) ? STATUS_OK : place_fail(place, key, "missing: %s", what);
}

enum status place_forbid(const struct place *place, const char *key, const char *why)
{
    return !place_has(place, key) ? STATUS_OK : place_fail(place, key, "not allowed: %s", why);
}

enum status place_forbid_all(const struct place *place, const char *const keys[], const char *why)
{
    for (int i = 0; keys[i] != NULL; i++) {
        RETURN_IF_ERROR(place_forbid(place, keys[i], why));
    }
    return STATUS_OK;
}

/* Read a number; the message explains decimal commas. */
static enum status number(const struct place *place, const char *key, const char *text, double *value)
{
    struct error ignored;
    if (parse_double(text, key, -DBL_MAX, DBL_MAX, value, &ignored) == STATUS_OK) {
        return STATUS_OK;
    }
    char *rest;
    (void)strtod(text, &rest);
    bool has_unit = rest != text && isalpha((unsigned char)rest[strspn(rest, " \t")]);
    return place_fail(place, key, "'%s' is not a finite number%s", text,
                      has_unit                    ? ": write it in SI units, without the name of one"
                      : strchr(text, ',') != NULL ? ": write one number, with a decimal point"
                      : strchr(text, ' ') != NULL ? ": separate components by commas"
                                                  : "");
}

/* Bounds of a number; an open bound is excluded. */
struct range {
    double least, most;
    bool open_least, open_most;
};

static enum status read_within(const struct place *place, const char *key, const char *text,
                               struct range range, double *value)
{
    RETURN_IF_ERROR(number(place, key, text, value));
    bool above = range.open_least ? *value > range.least : *value >= range.least;
    bool below = range.open_most ? *value < range.most : *value <= range.most;
    if (above && below) {
        return STATUS_OK;
    }
    if (range.most < DBL_MAX) {
        return place_fail(place, key, "%s is not within %c%g, %g%c", text, range.open_least ? '(' : '[',
                          range.least, range.most, range.open_most ? ')' : ']');
    }
    return place_fail(place, key, "%s is not %s %g", text, range.open_least ? "above" : "at least",
                      range.least);
}

static enum status read_number(const struct place *place, const char *key, const char *text,
                               enum value_type type, double *value)
{
    static const struct range ranges[] = {[VALUE_NUMBER] = {-DBL_MAX, DBL_MAX, false, false},
                                          [VALUE_POSITIVE] = {0, DBL_MAX, true, false},
                                          [VALUE_NOT_NEGATIVE] = {0, DBL_MAX, false, false},
                                          [VALUE_SHARE] = {0, 1, true, true}};
    return read_within(place, key, text, ranges[type], value);
}

/* Read a whole number, or a word, of which there are some: its index. */
static enum status read_whole(const struct place *place, const struct scene_key *key, const char *text,
                              void *value)
{
    static const char *const no_yes[] = {"no", "yes", NULL};
    const char *const *words = key->words != NULL ? key->words : no_yes;
    bool is_dim = key->type == VALUE_DIM;
    int64_t number = 0;
    int index = 0, count = 0;
    if (is_dim || key->type == VALUE_COUNT) {
        RETURN_IF_ERROR(fail_at(place, key->name,
                                parse_integer(text, key->name, is_dim ? 2 : 1, is_dim ? 3 : key->most,
                                              is_dim ? &number : value, place->error)));
        index = (int)number;
    } else {
        while (words[count] != NULL) {
            count++;
        }
        RETURN_IF_ERROR(
            fail_at(place, key->name, parse_choice(text, key->name, words, count, &index, place->error)));
    }
    if (key->type == VALUE_YES) {
        *(bool *)value = index == 1;
    } else if (key->type != VALUE_COUNT) {
        *(int *)value = index;
    }
    return STATUS_OK;
}

/* Cut off the next item of a comma list, without blanks at its ends; NULL behind the last. */
static char *next_item(char **list)
{
    char *item = strsep(list, ",");
    if (item != NULL) {
        item += strspn(item, " \t");
        ini_trim(item);
    }
    return item;
}

/* Read dim numbers; unless is_free is NULL, `free` means an absent component. */
static enum status read_vector(const struct place *place, const char *key, char *list, int dim,
                               double values[3], bool is_free[3])
{
    char *item;
    int count = 0;
    for (; (item = next_item(&list)) != NULL; count++) {
        if (count < dim && is_free != NULL && strcmp(item, "free") == 0) {
            is_free[count] = true;
        } else if (count < dim) {
            RETURN_IF_ERROR(number(place, key, item, &values[count]));
        }
    }
    return count == dim ? STATUS_OK
                        : place_fail(place, key, "has %d components: dim = %d needs %d%s", count, dim, dim,
                                     count > dim ? ", with decimal points" : "");
}

enum status place_numbers(const struct place *place, const struct law_key *key, double *values, int *given)
{
    const struct range range = {key->least, key->most, key->open, false};
    char *item, *list = ini_find(place->section, key->name)->value;
    for (*given = 0; (item = next_item(&list)) != NULL; ++*given) {
        if (*given == key->count) {
            return place_fail(place, key->name, "has more than %d %s", key->count,
                              key->count == 1 ? "number: write it with a decimal point" : "numbers");
        }
        RETURN_IF_ERROR(read_within(place, key->name, item, range, &values[*given]));
    }
    return STATUS_OK;
}

/* Read pairs of a share and a time, s. */
static enum status read_prony(const struct place *place, const char *key, char *list,
                              struct scene_prony *prony)
{
    const struct range share = {0.0, 1.0, true, true}, time = {0.0, DBL_MAX, true, false};
    char *item;
    double sum = 0.0;
    for (prony->terms = 0; (item = next_item(&list)) != NULL; prony->terms++) {
        double *term = prony->values + 2 * prony->terms;
        char *g = strsep(&item, " \t"), *tau = item;
        if (prony->terms == PRONY_MOST_TERMS) {
            return place_fail(place, key, "has more than %d terms", PRONY_MOST_TERMS);
        }
        if (tau == NULL) {
            return place_fail(place, key, "'%s' is not a term: write g and tau in s, as 0.45 0.5", g);
        }
        RETURN_IF_ERROR(read_within(place, key, g, share, &term[0]));
        RETURN_IF_ERROR(read_within(place, key, tau + strspn(tau, " \t"), time, &term[1]));
        sum += term[0];
    }
    return sum < 1.0 ? STATUS_OK
                     : place_fail(place, key,
                                  "the sum of g is %.15g, not below 1: nothing resists in the end", sum);
}

static enum status read_names(const struct place *place, const char *key, char *rest, struct name_list *list)
{
    char *item;
    list->names = array_new((int64_t)strlen(rest) + 1, sizeof *list->names); /* more than enough */
    RETURN_IF_ERROR(owned_add(&place->scene->owned, list->names, place->scene->path, place->error));
    while ((item = next_item(&rest)) != NULL) {
        if (item[0] == '\0') {
            return place_fail(place, key, "has an empty name: write names with single commas between");
        }
        for (int64_t i = 0; i < list->count; i++) {
            if (strcmp(list->names[i], item) == 0) {
                return place_fail(place, key, "names '%s' twice", item);
            }
        }
        list->names[list->count++] = item;
    }
    return STATUS_OK;
}

enum status place_print(const struct place *place, char **text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    *text = vasprintf(text, format, arguments) < 0 ? NULL : *text;
    va_end(arguments);
    return owned_add(&place->scene->owned, *text, place->scene->path, place->error);
}

/* Read the name of a file, and add it to the files of the scene. */
static enum status read_file(const struct place *place, const char *text, const char **path)
{
    struct name_list *files = &place->scene->files;
    const char *scene = place->scene->path, *slash = strrchr(scene, '/');
    int folder = text[0] != '/' && slash != NULL ? (int)(slash - scene) + 1 : 0;
    RETURN_IF_ERROR(RESIZE_ARRAY(&files->names, files->count + 1, place->error));
    char **name = &files->names[files->count];
    RETURN_IF_ERROR(place_print(place, name, "%.*s%s", folder, scene, text));
    files->count++;
    *path = *name;
    return STATUS_OK;
}

enum status place_check_units(const struct place *place, const struct scene_key *keys)
{
    for (const struct scene_key *key = keys; key->name != NULL; key++) {
        const struct ini_entry *entry = ini_find(place->section, key->name);
        if (key->type != VALUE_TABLE || entry == NULL) {
            continue;
        }
        bool stated = landmarks_named(entry->value), given = place_has(place, "unit");
        if (stated && given && strcmp(ini_find(place->section, "unit")->value, "mm") != 0) {
            return place_fail(place, key->name, "landmarks are in mm");
        }
        if (!stated && !given) {
            return place_fail(place, key->name, "needs unit = m, cm, mm or um of its lengths");
        }
    }
    return STATUS_OK;
}

/* Read the unit of a file, which the section must name by one of its keys. */
static enum status read_unit(const struct place *place, const char *key, const char *text, double *metres)
{
    if (!place_has(place, "table") && !place_has(place, "fibres") && !place_has(place, "points") &&
        !place_has(place, "rigid")) {
        return place_forbid(place, key, "it is the unit of a file, and none is named");
    }
    return fail_at(place, key, parse_length_unit(text, key, metres, place->error));
}

static enum status read_curve(const struct place *place, const char *text, struct scene_curve *curve)
{
    static const char *const words[] = {"smooth", "linear", "step"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, words[i]) == 0) {
            curve->kind = (enum curve_kind)i;
            return STATUS_OK;
        }
    }
    curve->kind = CURVE_TABLE;
    place->scene->tabulated = true;
    return read_file(place, text, &curve->file);
}

enum status place_read(const struct place *place, const struct scene_key *key, int dim, void *item)
{
    const struct ini_entry *entry = ini_find(place->section, key->name);
    void *value = (char *)item + key->at;
    bool *is_free = key->free > 0 ? (void *)((char *)item + key->free) : NULL;
    if (entry == NULL) {
        return key->missing != NULL ? place_require(place, key->name, key->missing) : STATUS_OK;
    }
    const char *why = place->scene->analysis == SCENE_DYNAMIC ? key->not_dynamic : key->not_static;
    if (why != NULL) {
        return place_forbid(place, key->name, why);
    }
    if (key->with[0] != NULL && !place_has(place, key->with[0]) &&
        (key->with[1] == NULL || !place_has(place, key->with[1]))) {
        return place_fail(place, key->name, "not allowed: it goes with %s%s%s", key->with[0],
                          key->with[1] != NULL ? " or " : "", key->with[1] != NULL ? key->with[1] : "");
    }
    char *text = entry->value;
    switch (key->type) {
    case VALUE_NUMBER:
    case VALUE_POSITIVE:
    case VALUE_NOT_NEGATIVE:
    case VALUE_SHARE:
        return read_number(place, key->name, text, key->type, value);
    case VALUE_DIM:
    case VALUE_COUNT:
    case VALUE_CHOICE:
    case VALUE_YES:
        return read_whole(place, key, text, value);
    case VALUE_VECTOR:
        return read_vector(place, key->name, text, dim, value, is_free);
    case VALUE_NAMES:
        return read_names(place, key->name, text, value);
    case VALUE_TABLE:
        return read_file(place, text, value);
    case VALUE_UNIT:
        return read_unit(place, key->name, text, value);
    case VALUE_PRONY:
        return read_prony(place, key->name, text, value);
    case VALUE_CURVE:
        return read_curve(place, text, value);
    case VALUE_TEXT:
    default:
        *(const char **)value = text;
        return STATUS_OK;
    }
}
