/* keep.so, to be preloaded: a file that replaces another one by rename stays also as FILE.1, FILE.2, .. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int rename(const char *from, const char *to)
{
    static int count;
    static int (*real)(const char *, const char *);
    char kept[4096];
    if (real == NULL) {
        void *found = dlsym(RTLD_NEXT, "rename");
        memcpy(&real, &found, sizeof real);
    }
    int result = real(from, to);
    if (result == 0) {
        snprintf(kept, sizeof kept, "%s.%d", to, ++count);
        if (link(to, kept) != 0) {
            perror(kept);
            abort();
        }
    }
    return result;
}
