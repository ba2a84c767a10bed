#include "io/files/json.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 64 };

void json_fail(struct json *json, const char *what)
{
    if (json->status == STATUS_OK) {
        json->status = fail(json->error, STATUS_INPUT, "%jd: %s", json->line, what);
    }
}

/* The next character that is no blank; NUL at the end and after a failure. */
static char peek(struct json *json)
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

static bool take(struct json *json, char c)
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
static int take_unit(struct json *json)
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
static bool take_escape(struct json *json, char **to)
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

static char *take_string(struct json *json)
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

static double take_number(struct json *json)
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

static void take_word(struct json *json)
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

static void give(struct json *json, enum json_kind kind, char *text, double number)
{
    if (json->status == STATUS_OK) {
        json->take(json, kind, text, number);
    }
}

static void read_value(struct json *json, int depth)
{
    char c = peek(json);
    size_t length = strlen(json->path);
    if (c == '"') {
        char *text = take_string(json);
        give(json, JSON_STRING, text, 0);
    } else if (isalpha((unsigned char)c)) {
        take_word(json);
        give(json, JSON_WORD, NULL, 0);
    } else if (c != '{' && c != '[') {
        double number = take_number(json);
        give(json, JSON_NUMBER, NULL, number);
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
        if (c == '{') {
            give(json, JSON_END, NULL, 0);
        }
    }
}

void json_read(struct json *json)
{
    json->path[0] = '\0';
    read_value(json, 0);
    if (peek(json) != '\0') {
        json_fail(json, "more behind the value");
    }
}
