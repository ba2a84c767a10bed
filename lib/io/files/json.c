#include "io/files/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 64 };

void json_fail(struct json *json, const char *what)
{
    if (json->status == STATUS_OK) {
        json->status = fail(json->error, STATUS_INPUT, "%lld: %s", (long long)json->line, what);
    }
}

char json_peek(struct json *json)
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
    bool found = json_peek(json) == c && c != '\0';
    json->at += found;
    return found;
}

/* What ends an object or array. */
static char closing(char bracket)
{
    if (bracket == '{') {
        return '}';
    }
    return ']';
}

bool json_open(struct json *json, char bracket)
{
    if (!take(json, bracket) || ++json->depth > DEEPEST) {
        json_fail(json, bracket == '{' ? "an object, {...}, is expected" : "an array, [...], is expected");
        return false;
    }
    if (take(json, closing(bracket))) {
        json->depth--;
        return false;
    }
    return json->status == STATUS_OK;
}

bool json_next(struct json *json, char bracket)
{
    if (take(json, bracket)) {
        json->depth--;
        return false;
    }
    if (!take(json, ',')) {
        json_fail(json, *json->at == '\0' ? "cut short: the file ends within a value"
                                          : "',' or a closing bracket is expected");
    }
    return json->status == STATUS_OK;
}

/* The bytes of a code point in UTF-8; returns their number. A half of a pair is '?'. */
static int utf8(unsigned code, char bytes[3])
{
    bytes[0] = '?';
    if (code >= 0xd800 && code < 0xe000) {
        return 1;
    }
    if (code < 0x80) {
        bytes[0] = (char)code;
        return 1;
    }
    int more = code < 0x800 ? 1 : 2;
    bytes[0] = (char)(more == 1 ? 0xc0 | code >> 6 : 0xe0 | code >> 12);
    bytes[1] = (char)(0x80 | (code >> 6 * (unsigned)(more - 1) & 0x3f));
    bytes[2] = (char)(0x80 | (code & 0x3f));
    return more + 1;
}

/* Take an escaped character, whose backslash has been taken; returns the number of its bytes, 0: none. */
static int take_escape(struct json *json, char bytes[3])
{
    static const char letters[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
    char digits[5] = "", c = *json->at;
    const char *letter = c != '\0' ? strchr(letters, c) : NULL;
    if (letter != NULL) {
        json->at++;
        bytes[0] = meant[letter - letters];
        return 1;
    }
    if (c != 'u' || strspn(json->at + 1, "0123456789abcdefABCDEF") < 4) {
        return 0;
    }
    memcpy(digits, json->at + 1, 4);
    json->at += 5;
    return utf8((unsigned)strtoul(digits, NULL, 16), bytes);
}

void json_string(struct json *json, char *text, size_t size)
{
    size_t length = 0;
    if (!take(json, '"')) {
        json_fail(json, "a string is expected");
    }
    while (json->status == STATUS_OK && *json->at != '"') {
        char bytes[3] = {*json->at};
        json->at += bytes[0] != '\0';
        int count = bytes[0] == '\\' ? take_escape(json, bytes) : (unsigned char)bytes[0] >= ' ';
        if (count == 0) {
            json_fail(json, "a string does not end, or has a control character or an unknown escape");
            break;
        }
        if (length + (size_t)count < size) {
            memcpy(text + length, bytes, (size_t)count);
            length += (size_t)count;
        }
    }
    json->at += json->status == STATUS_OK;
    text[length] = '\0';
}

void json_key(struct json *json, char *text, size_t size)
{
    json_string(json, text, size);
    if (!take(json, ':')) {
        json_fail(json, "':' is expected behind a key");
    }
}

double json_number(struct json *json)
{
    char word[64] = "", *end;
    json_peek(json);
    size_t length = json->status == STATUS_OK ? strspn(json->at, "0123456789+-.eE") : 0;
    memcpy(word, json->at, length < sizeof word ? length : 0);
    double value = strtod(word, &end);
    if (length == 0 || *end != '\0' || !isfinite(value)) {
        json_fail(json, "a finite number is expected");
        return 0;
    }
    json->at += length;
    return value;
}

void json_skip(struct json *json)
{
    char text[1], c = json_peek(json);
    if (c == '{' || c == '[') {
        for (bool more = json_open(json, c); more; more = json_next(json, closing(c))) {
            if (c == '{') {
                json_key(json, text, sizeof text);
            }
            json_skip(json);
        }
    } else if (c == '"') {
        json_string(json, text, sizeof text);
    } else if (c >= 'a' && c <= 'z') {
        size_t length = strspn(json->at, "abcdefghijklmnopqrstuvwxyz");
        bool known =
            (length == 4 && (strncmp(json->at, "true", 4) == 0 || strncmp(json->at, "null", 4) == 0)) ||
            (length == 5 && strncmp(json->at, "false", 5) == 0);
        json->at += length;
        if (!known) {
            json_fail(json, "a word that is neither true, false nor null");
        }
    } else {
        (void)json_number(json);
    }
}

void json_end(struct json *json)
{
    if (json_peek(json) != '\0') {
        json_fail(json, "more behind the value");
    }
}
