#include "io/scene_value.h"

#include "base/memory.h"
#include "base/options.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct range range_any = {-DBL_MAX, DBL_MAX, false, false};
const struct range range_positive = {0, DBL_MAX, true, false};
const struct range range_not_negative = {0, DBL_MAX, false, false};
const struct range range_open_share = {0, 1, true, true};

enum status place_fail(const struct place *place, const char *key, const char *format, ...)
{
    char message[sizeof place->error->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);

    const struct ini_section *section = place->section;
    const struct ini_entry *entry = key != NULL ? ini_find(section, key) : NULL;
    int64_t line = entry != NULL ? entry->line : section->line;
    return fail(place->error, STATUS_INPUT, "%s:%lld: [%s%s%s]: %s%s%s", place->file->path, (long long)line,
                section->kind, section->name[0] != '\0' ? " " : "", section->name, key != NULL ? key : "",
                key != NULL ? ": " : "", message);
}

bool place_has(const struct place *place, const char *key)
{
    return ini_find(place->section, key) != NULL;
}

static char *text_of(const struct place *place, const char *key)
{
    const struct ini_entry *entry = ini_find(place->section, key);
    return entry != NULL ? entry->value : NULL;
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

/* "a, b, c" of a NULL-terminated list. */
static void join(const char *const words[], char *text, size_t size)
{
    text[0] = '\0';
    for (int i = 0; words[i] != NULL; i++) {
        text_append(text, size, "%s%s", i > 0 ? ", " : "", words[i]);
    }
}

enum status place_require_one(const struct place *place, const char *const keys[])
{
    int count = 0;
    for (int i = 0; keys[i] != NULL; i++) {
        count += place_has(place, keys[i]);
    }
    char list[256];
    join(keys, list, sizeof list);
    return count == 1
               ? STATUS_OK
               : place_fail(place, NULL, "%s of %s: give exactly one", count == 0 ? "none" : "several", list);
}

enum status place_unknown(const struct place *place, const char *key, const char *what,
                          const char *const allowed[])
{
    char list[320];
    join(allowed, list, sizeof list);
    return place_fail(place, key, "unknown %s: allowed are %s", what, list);
}

enum status place_only_keys(const struct place *place, const char *const keys[])
{
    for (int64_t e = 0; e < place->section->entry_count; e++) {
        int i = 0;
        const char *key = place->section->entries[e].key;
        while (keys[i] != NULL && strcmp(keys[i], key) != 0) {
            i++;
        }
        if (keys[i] == NULL) {
            return place_unknown(place, key, "key", keys);
        }
    }
    return STATUS_OK;
}

/* A number without leading blanks; the message explains decimal commas. */
static enum status number(const struct place *place, const char *key, const char *text, double *value)
{
    struct error ignored;
    if (parse_double(text, key, -DBL_MAX, DBL_MAX, value, &ignored) == STATUS_OK) {
        return STATUS_OK;
    }
    return place_fail(place, key, "'%s' is not a finite number%s", text,
                      strchr(text, ',') != NULL   ? ": write one number, with a decimal point"
                      : strchr(text, ' ') != NULL ? ": separate components by commas"
                                                  : "");
}

enum status place_number(const struct place *place, const char *key, struct range range, double *value)
{
    const char *text = text_of(place, key);
    double given;
    if (text == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(number(place, key, text, &given));
    bool above = range.open_least ? given > range.least : given >= range.least;
    bool below = range.open_most ? given < range.most : given <= range.most;
    if (above && below) {
        *value = given;
        return STATUS_OK;
    }
    if (range.most < DBL_MAX) {
        return place_fail(place, key, "%s is not within %c%g, %g%c", text, range.open_least ? '(' : '[',
                          range.least, range.most, range.open_most ? ')' : ']');
    }
    return place_fail(place, key, "%s is not %s %g", text, range.open_least ? "above" : "at least",
                      range.least);
}

enum status place_count(const struct place *place, const char *key, int64_t most, int64_t *value)
{
    const char *text = text_of(place, key);
    if (text == NULL) {
        return STATUS_OK;
    }
    struct error why;
    return parse_integer(text, key, 1, most, value, &why) == STATUS_OK
               ? STATUS_OK
               : place_fail(place, key, "'%s' is not a whole number within [1, %lld]", text, (long long)most);
}

enum status place_choice(const struct place *place, const char *key, const char *const words[], int *index)
{
    const char *text = text_of(place, key);
    if (text == NULL) {
        return STATUS_OK;
    }
    for (int i = 0; words[i] != NULL; i++) {
        if (strcmp(text, words[i]) == 0) {
            *index = i;
            return STATUS_OK;
        }
    }
    char list[256];
    join(words, list, sizeof list);
    return place_fail(place, key, "'%s' is none of %s", text, list);
}

enum status place_yes(const struct place *place, const char *key, bool *value)
{
    static const char *const words[] = {"no", "yes", NULL};
    int index = *value;
    enum status status = place_choice(place, key, words, &index);
    *value = index == 1;
    return status;
}

/* The next item of a comma list, without blanks at its ends, cut off; NULL behind the last. */
static char *next_item(char **list)
{
    char *item = strsep(list, ",");
    if (item != NULL) {
        item += strspn(item, " \t");
        item[ini_trimmed(item, strlen(item))] = '\0';
    }
    return item;
}

enum status place_vector(const struct place *place, const char *key, int dim, double values[3],
                         bool is_free[3])
{
    char *list = text_of(place, key), *item;
    int count = 0;
    if (list == NULL) {
        return STATUS_OK;
    }
    for (; (item = next_item(&list)) != NULL; count++) {
        if (count < dim && is_free != NULL && strcmp(item, "free") == 0) {
            is_free[count] = true;
        } else if (count < dim) {
            RETURN_IF_ERROR(number(place, key, item, &values[count]));
        }
    }
    return count == dim ? STATUS_OK
                        : place_fail(place, key, "has %d components: dim = %d needs %d", count, dim, dim);
}

enum status place_names(const struct place *place, const char *key, struct name_list *list)
{
    char *rest = text_of(place, key), *item;
    if (rest == NULL) {
        return STATUS_OK;
    }
    list->names = array_new((int64_t)strlen(rest) + 1, sizeof *list->names); /* more than enough */
    RETURN_IF_ERROR(owned_add(place->owned, list->names, place->file->path, place->error));
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

enum status place_print(const struct place *place, const char **text, const char *format, ...)
{
    char *printed;
    va_list arguments;
    va_start(arguments, format);
    *text = printed = vasprintf(&printed, format, arguments) < 0 ? NULL : printed;
    va_end(arguments);
    return owned_add(place->owned, printed, place->file->path, place->error);
}

enum status place_file(const struct place *place, const char *key, const char **path)
{
    const char *text = text_of(place, key), *scene = place->file->path, *slash = strrchr(scene, '/');
    if (text == NULL) {
        return STATUS_OK;
    }
    int folder = text[0] != '/' && slash != NULL ? (int)(slash - scene) + 1 : 0;
    return place_print(place, path, "%.*s%s", folder, scene, text);
}

enum status place_table(const struct place *place, const char *key, const char **path, double *metres)
{
    const char *unit = text_of(place, "unit");
    struct error why;
    if (!place_has(place, key)) {
        return place_forbid(place, "unit", "it is the unit of a file, and none is named");
    }
    if (unit == NULL) {
        return place_fail(place, key, "needs unit = m, cm, mm or um of its lengths");
    }
    if (parse_length_unit(unit, "unit", metres, &why) != STATUS_OK) {
        return place_fail(place, "unit", "'%s' is none of m, cm, mm, um", unit);
    }
    return place_file(place, key, path);
}

void place_text(const struct place *place, const char *key, const char **value)
{
    const char *text = text_of(place, key);
    *value = text != NULL ? text : *value;
}

enum status place_curve(const struct place *place, const char *key, struct scene_curve *curve)
{
    static const char *const words[] = {"smooth", "linear", "step"};
    const char *text = text_of(place, key);
    for (int i = 0; text != NULL && i < 3; i++) {
        if (strcmp(text, words[i]) == 0) {
            curve->kind = (enum scene_curve_kind)i;
            return STATUS_OK;
        }
    }
    curve->kind = text != NULL ? SCENE_CURVE_FILE : SCENE_CURVE_SMOOTH;
    return place_file(place, key, &curve->file);
}
