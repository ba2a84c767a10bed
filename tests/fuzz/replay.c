/* Run a fuzz target on each file named, without a fuzzer: replay FILE... */
#include "fuzz.h"

int main(int argc, char *argv[])
{
    for (int i = 1; i < argc; i++) {
        FILE *file = fopen(argv[i], "rb");
        REQUIRE(file != NULL);
        uint8_t *bytes = malloc(1 << 20);
        REQUIRE(bytes != NULL);
        size_t size = fread(bytes, 1, 1 << 20, file);
        fclose(file);
        /* In a block of its own size, so that reading beyond its end is seen. */
        uint8_t *exact = realloc(bytes, size > 0 ? size : 1);
        REQUIRE(exact != NULL);
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    printf("%d files\n", argc - 1);
    return 0;
}
