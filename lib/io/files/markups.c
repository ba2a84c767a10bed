/* Markups of 3D Slicer: what JSON (RFC 8259) says of points. */
#include "io/files/landmarks.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A file that is being read, and the last of its points. */
struct markups {
    struct table *table;
    double sign; /* of x and y, to RAS */
    char *empty; /* label */

    enum status status; /* of JSON: after the first failure nothing more is taken */
    struct error *error;
    char *at;       /* ends with a NUL; strings are decoded in place */
    int64_t line;   /* of `at`, from 1 */
    char path[256]; /* of the value: "markups[].position[]", the keys of the objects that hold it and [] for
                       each array; cut when longer */
    int64_t first;  /* row of the markup */
    bool has_units; /* said: of a code of UCUM, the unit comes first */
    char *label;
    double x[3];
    int count; /* of its coordinates */
    bool is_undefined;
    int64_t point_line; /* of its position */
};

static void json_fail(struct markups *json, const char *what)
{
    if (json->status == STATUS_OK) {
        json->status = fail(json->error, STATUS_INPUT, "%jd: %s", json->line, what);
    }
}

static bool is_text(const char *text, const char *wanted)
{
    return text != NULL && strcmp(text, wanted) == 0;
}

/* Take a value: a text, a number, or (both NULL) a word. */
static void take_value(struct markups *json, char *text, const double *number)
{
    if (is_text(json->path, "markups[].coordinateSystem")) {
        json->sign = is_text(text, "RAS") ? 1 : -1;
        if (json->sign < 0 && !is_text(text, "LPS")) {
            json_fail(json, "coordinateSystem is neither LPS nor RAS");
        }
    } else if (strncmp(json->path, "markups[].coordinateUnits", 25) == 0) { /* a text, or a list */
        if (!json->has_units && !is_text(text, "mm")) {
            json_fail(json, "coordinateUnits is not mm");
        }
        json->has_units = true;
    } else if (is_text(json->path, "markups[].controlPoints[].label")) {
        json->label = text;
        if (text == NULL) {
            json_fail(json, "a string is expected");
        }
    } else if (is_text(json->path, "markups[].controlPoints[].positionStatus")) {
        json->is_undefined = !is_text(text, "defined");
    } else if (strncmp(json->path, "markups[].controlPoints[].position[]", 36) == 0) {
        json->point_line = json->line;
        if (number == NULL || json->path[36] != '\0') {
            json_fail(json, "a finite number is expected");
        } else {
            json->x[json->count < 3 ? json->count : 2] = *number;
            json->count++;
        }
    }
}

/* An object ends: a point or a markup. */
static void end_object(struct markups *json)
{
    struct table *table = json->table;
    if (is_text(json->path, "markups[]")) {
        for (; json->first < table->rows; json->first++) {
            table->values[3 * json->first] *= json->sign;
            table->values[3 * json->first + 1] *= json->sign;
        }
        json->sign = -1; /* LPS if nothing is said */
        json->has_units = false;
    } else if (is_text(json->path, "markups[].controlPoints[]")) {
        if (json->count != 3 || json->is_undefined) {
            json_fail(json, "a control point without a position of three numbers: place it, or leave it out");
        } else {
            json->status = table_append(table, json->x, json->point_line,
                                        json->label != NULL ? json->label : json->empty, json->error);
        }
        json->label = NULL;
        json->count = 0;
        json->is_undefined = false;
    }
}

enum { DEEPEST = 64 };

/* The next character that is no blank; NUL at the end and after a failure. */
static char peek(struct markups *json)
{
    for (; json->status == STATUS_OK && *json->at != '\0' && strchr(" \t\r\n", *json->at) != NULL;
         json->at++) {
        json->line += *json->at == '\n';
    }
    if (json->status != STATUS_OK) {
        return '\0';
    }
    return *json->at;
}

static bool take(struct markups *json, char c)
{
    bool found = peek(json) == c && c != '\0';
    json->at += found;
    return found;
}

/* Append a code point in UTF-8; what is none, or a NUL, is '?'. */
static void put_utf8(unsigned code, char **to)
{
    int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    static const unsigned first[] = {0, 0xc0, 0xe0, 0xf0};
    if (code == 0 || (code >= 0xd800 && code < 0xe000)) {
        code = '?';
        more = 0;
    }
    *(*to)++ = (char)(first[more] | code >> 6 * more);
    while (more-- > 0) {
        *(*to)++ = (char)(0x80 | (code >> 6 * more & 0x3f));
    }
}

/* Take four digits behind "u"; -1: they are not there. */
static int take_unit(struct markups *json)
{
    char digits[5] = "";
    if (*json->at != 'u' || strspn(json->at + 1, "0123456789abcdefABCDEF") < 4) {
        return -1;
    }
    memcpy(digits, json->at + 1, 4);
    json->at += 5;
    return (int)strtol(digits, NULL, 16);
}

/* Take an escaped character, whose backslash has been taken; false: there is none. */
static bool take_escape(struct markups *json, char **to)
{
    static const char letters[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
    char c = *json->at;
    const char *letter = c != '\0' ? strchr(letters, c) : NULL;
    if (letter != NULL) {
        json->at++;
        *(*to)++ = meant[letter - letters];
        return true;
    }
    int code = take_unit(json);
    if (code >= 0xd800 && code < 0xdc00 && *json->at == '\\') { /* the first of a pair */
        char *behind = json->at++;
        int low = take_unit(json);
        bool is_pair = low >= 0xdc00 && low < 0xe000;
        json->at = is_pair ? json->at : behind;
        code = is_pair ? 0x10000 + ((code - 0xd800) << 10) + low - 0xdc00 : code;
    }
    if (code >= 0) {
        put_utf8((unsigned)code, to);
    }
    return code >= 0;
}

static char *take_string(struct markups *json)
{
    if (!take(json, '"')) {
        json_fail(json, "a string is expected");
    }
    char *text = json->at, *to = text;
    while (json->status == STATUS_OK && *json->at != '"') {
        char c = *json->at;
        json->at += c != '\0';
        if (c == '\\' ? !take_escape(json, &to) : (unsigned char)c < ' ') {
            json_fail(json, "a string does not end, or has a control character or an unknown escape");
        } else if (c != '\\') {
            *to++ = c;
        }
    }
    json->at += json->status == STATUS_OK;
    *to = '\0';
    return text;
}

static double take_number(struct markups *json)
{
    char word[64] = "", *end;
    size_t length = strspn(json->at, "0123456789+-.eE");
    memcpy(word, json->at, length < sizeof word ? length : 0);
    double value = strtod(word, &end);
    if (length == 0 || length >= sizeof word || *end != '\0' || !isfinite(value)) {
        json_fail(json, "a finite number is expected");
    }
    json->at += length;
    return value;
}

static void take_word(struct markups *json)
{
    static const char *const words[] = {"true", "false", "null"};
    for (int i = 0; i < 3; i++) {
        size_t length = strlen(words[i]);
        if (strncmp(json->at, words[i], length) == 0 && !isalnum((unsigned char)json->at[length])) {
            json->at += length;
            return;
        }
    }
    json_fail(json, "a word that is neither true, false nor null");
}

static void read_value(struct markups *json, int depth)
{
    char c = peek(json);
    size_t length = strlen(json->path);
    if (c == '"') {
        take_value(json, take_string(json), NULL);
    } else if (isalpha((unsigned char)c)) {
        take_word(json);
        take_value(json, NULL, NULL);
    } else if (c != '{' && c != '[') {
        double number = take_number(json);
        take_value(json, NULL, &number);
    } else if (depth == DEEPEST) {
        json_fail(json, "values within more than 64 others");
    } else {
        json->at++;
        for (bool more = !take(json, c == '{' ? '}' : ']'); more && json->status == STATUS_OK;) {
            text_append(json->path, sizeof json->path, "%s%s", c == '{' && length > 0 ? "." : "",
                        c == '{' ? take_string(json) : "[]");
            if (c == '{' && !take(json, ':')) {
                json_fail(json, "':' is expected behind a key");
            }
            read_value(json, depth + 1);
            json->path[length] = '\0';
            more = !take(json, c == '{' ? '}' : ']');
            if (more && !take(json, ',')) {
                json_fail(json, *json->at == '\0' ? "cut short: the file ends within a value"
                                                  : "',' or a closing bracket is expected");
            }
        }
        if (c == '{' && json->status == STATUS_OK) {
            end_object(json);
        }
    }
}

enum status markups_read(char *text, char *empty, struct table *table, struct error *error)
{
    struct markups json = {.table = table, .sign = -1, .empty = empty, .error = error, .at = text, .line = 1};
    read_value(&json, 0);
    if (peek(&json) != '\0') {
        json_fail(&json, "more behind the value");
    }
    return json.status;
}
