/* What the fuzz targets share. A target is one function over bytes; libFuzzer calls it (make fuzz), and so
 * does replay.c on the files of the corpus (make check). */
#pragma once

#include "base/memory.h"
#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A broken promise is a crash, which the fuzzer keeps. */
#define REQUIRE(condition)                                                                                   \
    do {                                                                                                     \
        if (!(condition)) {                                                                                  \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                          \
            abort();                                                                                         \
        }                                                                                                    \
    } while (0)

/* A reader of untrusted bytes accepts them, or calls them malformed in one line; memory and devices, on which
 * it could also fail, are there. True when accepted. */
static inline bool is_accepted(enum status status, const struct error *error)
{
    if (status == STATUS_OK) {
        return true;
    }
    REQUIRE(status == STATUS_INPUT);
    REQUIRE(error->text[0] != '\0');
    for (const char *at = error->text; *at != '\0'; at++) {
        REQUIRE((unsigned char)*at >= ' ' && *at != 0x7f);
    }
    return false;
}

/* A file in memory, open at its beginning; close() it. `path` (may be NULL) receives a name to open it by. */
static inline int file_of_bytes(const void *bytes, size_t size, char path[32])
{
    int file = memfd_create("fuzz", 0);
    REQUIRE(file >= 0);
    REQUIRE(write(file, bytes, size) == (ssize_t)size);
    REQUIRE(lseek(file, 0, SEEK_SET) == 0);
    if (path != NULL) {
        snprintf(path, 32, "/proc/self/fd/%d", file);
    }
    return file;
}
