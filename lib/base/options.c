#include "base/options.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void declare(struct options *options, char letter, const char *name, size_t length, bool takes_value,
                    bool repeats)
{
    struct option *option = &options->option[options->count++];
    assert(options->count <= OPTIONS_MOST && length > 0 && length < sizeof option->name);
    for (const struct option *other = options->option; other < option; other++) {
        assert(letter == '\0' || other->letter != letter); /* letters are unique */
        assert(strlen(other->name) != length || strncmp(other->name, name, length) != 0);
    }
    *option = (struct option){.letter = letter, .takes_value = takes_value, .repeats = repeats};
    memcpy(option->name, name, length);
}

static void declare_line(struct options *options, const char *line)
{
    bool has_letter = strncmp(line, "  -", 3) == 0 && strncmp(line + 4, ", --", 4) == 0;
    if (!has_letter && strncmp(line, "      --", 8) != 0) {
        return;
    }
    const char *name = line + 8;
    size_t length = strcspn(name, " \n");
    const char *value = name + length, *end = value;
    while (*end != '\0' && *end != '\n' && strncmp(end, "  ", 2) != 0) {
        end++;
    }
    bool repeats = end - value > 4 && strncmp(end - 4, " ...", 4) == 0;
    const char letter = (char)(has_letter ? line[3] : '\0');
    declare(options, letter, name, length, end > value, repeats);
}

static struct option *find_letter(struct options *options, char letter)
{
    for (int i = 0; i < options->count; i++) {
        if (options->option[i].letter == letter) {
            return &options->option[i];
        }
    }
    return NULL;
}

void options_declare(struct options *options, const char *usage)
{
    static const char heading[] = "\nOptions:\n";
    const char *line = strstr(usage, heading);
    *options = (struct options){.count = 0};
    line = line != NULL ? line + strlen(heading) : "";
    while (*line != '\0' && *line != '\n') {
        declare_line(options, line);
        line += strcspn(line, "\n");
        line += *line == '\n' ? 1 : 0;
    }
    const char letter = (char)(find_letter(options, 'h') == NULL ? 'h' : '\0');
    declare(options, letter, "help", strlen("help"), false, false);
    declare(options, '\0', "version", strlen("version"), false, false);
}

static int find_name(const struct options *options, const char *name, size_t length)
{
    for (int i = 0; i < options->count; i++) {
        const char *candidate = options->option[i].name;
        if (strlen(candidate) == length && strncmp(candidate, name, length) == 0) {
            return i;
        }
    }
    return -1;
}

bool options_has(const struct options *options, const char *name)
{
    return find_name(options, name, strlen(name)) >= 0;
}

const struct option *options_find(const struct options *options, const char *name)
{
    int index = find_name(options, name, strlen(name));
    assert(index >= 0);
    return &options->option[index];
}

const char *option_text(const struct option *option, char text[32])
{
    if (option->letter != '\0') {
        snprintf(text, 32, "-%c", option->letter);
    } else {
        snprintf(text, 32, "--%s", option->name);
    }
    return text;
}

/* Note the use of an option, with this value or (NULL) the next argument if it takes one. */
static enum status use(struct options *options, struct option *option, const char *shown, const char *value,
                       int argc, char *argv[], int *at, struct error *error)
{
    if (option->given && !option->repeats) {
        return fail(error, STATUS_INPUT, "option %s given twice", shown);
    }
    option->given = true;
    if (!option->takes_value) {
        return value == NULL ? STATUS_OK : fail(error, STATUS_INPUT, "option %s takes no value", shown);
    }
    if (value == NULL && *at + 1 >= argc) {
        return fail(error, STATUS_INPUT, "option %s lacks its value", shown);
    }
    if (options->use_count == OPTIONS_MOST_USES) {
        return fail(error, STATUS_INPUT, "more than %d options --%s and the like: run it twice",
                    OPTIONS_MOST_USES, option->name);
    }
    option->value = value != NULL ? value : argv[++*at];
    options->use[options->use_count++] = (struct option_use){option, option->value};
    return STATUS_OK;
}

/* -abc (flags joined), -kVALUE or -k VALUE at argv[*at]. */
static enum status parse_short(struct options *options, int argc, char *argv[], int *at, struct error *error)
{
    const char *joined = argv[*at];
    for (const char *letter = joined + 1; *letter != '\0'; letter++) {
        char shown[3] = {'-', *letter, '\0'};
        struct option *option = find_letter(options, *letter);
        if (option == NULL) {
            return fail(error, STATUS_INPUT, "unknown option %s in %s (see -h)", shown, joined);
        }
        bool behind = option->takes_value && letter[1] != '\0';
        RETURN_IF_ERROR(use(options, option, shown, behind ? letter + 1 : NULL, argc, argv, at, error));
        if (option->takes_value) {
            break;
        }
    }
    return STATUS_OK;
}

enum status options_parse(struct options *options, int argc, char *argv[], int *operand_count,
                          struct error *error)
{
    bool options_ended = false;
    *operand_count = 0;
    for (int at = 1; at < argc; at++) {
        if (options_ended || argv[at][0] != '-' || argv[at][1] == '\0') {
            argv[++*operand_count] = argv[at];
        } else if (strcmp(argv[at], "--") == 0) {
            options_ended = true;
        } else if (argv[at][1] == '-') {
            const char *shown = argv[at], *equals = strchr(shown, '=');
            int index = find_name(options, shown + 2, strcspn(shown + 2, "="));
            if (index < 0) {
                return fail(error, STATUS_INPUT, "unknown option %s (see -h)", shown);
            }
            RETURN_IF_ERROR(use(options, &options->option[index], shown, equals != NULL ? equals + 1 : NULL,
                                argc, argv, &at, error));
        } else {
            RETURN_IF_ERROR(parse_short(options, argc, argv, &at, error));
        }
    }
    return STATUS_OK;
}

/* Whether a text has only decimal digits, sign, point and exponent, before it is passed to strtod. */
static bool looks_decimal(const char *text)
{
    return text[0] != '\0' && strspn(text, "+-.0123456789eE") == strlen(text);
}

enum status parse_double(const char *text, const char *what, double least, double most, double *value,
                         struct error *error)
{
    char *end = NULL;
    *value = looks_decimal(text) ? strtod(text, &end) : NAN;
    if (end == NULL || end == text || *end != '\0' || !isfinite(*value)) {
        return fail(error, STATUS_INPUT, "%s: '%s' is not a number", what, text);
    }
    if (!(*value >= least && *value <= most)) {
        return fail(error, STATUS_INPUT, "%s: %s is not within [%g, %g]", what, text, least, most);
    }
    return STATUS_OK;
}

enum status parse_integer(const char *text, const char *what, int64_t least, int64_t most, int64_t *value,
                          struct error *error)
{
    char *end = NULL;
    errno = 0;
    long long number = 0;
    if (text[0] != '\0' && strspn(text, "+-0123456789") == strlen(text)) {
        number = strtoll(text, &end, 10);
    }
    if (end == NULL || end == text || *end != '\0') {
        return fail(error, STATUS_INPUT, "%s: '%s' is not a whole number", what, text);
    }
    if (errno == ERANGE || number < least || number > most) {
        return fail(error, STATUS_INPUT, "%s: %s is not within [%jd, %jd]", what, text, least, most);
    }
    *value = number;
    return STATUS_OK;
}

enum status parse_double_list(const char *text, const char *what, double least, double largest, int most,
                              double values[], int *count, struct error *error)
{
    *count = 0;
    for (const char *at = text;; at++) {
        char item[64];
        size_t length = strcspn(at, ",");
        if (*count == most || length >= sizeof item) {
            return fail(error, STATUS_INPUT, "%s: '%s' is not a list of at most %d numbers", what, text,
                        most);
        }
        memcpy(item, at, length);
        item[length] = '\0';
        RETURN_IF_ERROR(parse_double(item, what, least, largest, &values[*count], error));
        ++*count;
        at += length;
        if (*at == '\0') {
            return STATUS_OK;
        }
    }
}

enum status parse_length_unit(const char *text, const char *what, double *metres, struct error *error)
{
    static const char *const units[] = {"m", "cm", "mm", "um"};
    static const double sizes[] = {1.0, 1e-2, 1e-3, 1e-6};
    int index = 0;
    struct error why;
    if (looks_decimal(text) && parse_double(text, what, 1e-12, 1e12, metres, &why) == STATUS_OK) {
        return STATUS_OK;
    }
    enum status status = parse_choice(text, what, units, 4, &index, error);
    if (status != STATUS_OK) {
        text_append(error->text, sizeof error->text, ", nor a number of metres");
    }
    *metres = sizes[index];
    return status;
}

enum status parse_length(const char *text, const char *what, double least, double *value, struct error *error)
{
    char number[64];
    double unit = 1.0;
    size_t length = strspn(text, "+-.0123456789eE");
    if (length == 0 || length >= sizeof number) {
        return fail(error, STATUS_INPUT, "%s: '%s' is not a length", what, text);
    }
    memcpy(number, text, length);
    number[length] = '\0';
    RETURN_IF_ERROR(parse_double(number, what, least, 1e12, value, error));
    if (text[length] != '\0') {
        RETURN_IF_ERROR(parse_length_unit(text + length, what, &unit, error));
    }
    *value *= unit;
    return STATUS_OK;
}

enum status parse_choice(const char *text, const char *what, const char *const choices[], int count,
                         int *index, struct error *error)
{
    char list[256] = "";
    for (int i = 0; i < count; i++) {
        if (strcmp(text, choices[i]) == 0) {
            *index = i;
            return STATUS_OK;
        }
        text_append(list, sizeof list, "%s%s", i > 0 ? ", " : "", choices[i]);
    }
    return fail(error, STATUS_INPUT, "%s: '%s' is none of %s", what, text, list);
}
