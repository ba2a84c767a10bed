#include "base/memory.h"
#include "io/msh.h"
#include "io/msh_gmsh.h"
#include "io/msh_scan.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file's bytes in memory. */
struct bytes {
    char *data;
    size_t size;
    bool mapped;
};

static void bytes_free(struct bytes *bytes)
{
    if (bytes->mapped) {
        munmap(bytes->data, bytes->size);
    } else {
        free(bytes->data);
    }
    *bytes = (struct bytes){0};
}

static enum status fail_read(struct error *error)
{
    return fail(error, STATUS_SYSTEM, "%s", strerror(errno));
}

/* Read to the end; but no further than the first bytes where those do not begin a mesh. */
static enum status read_all(struct bytes *bytes, int descriptor, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t capacity = 0;
    for (;;) {
        if ((int64_t)bytes->size == capacity) {
            capacity = capacity == 0 ? 65536 : 2 * capacity;
            char *grown = array_grow(bytes->data, capacity, 1);
            if (grown == NULL) {
                status = fail_memory(error, "the mesh");
                break;
            }
            bytes->data = grown;
        }
        ssize_t got = read(descriptor, bytes->data + bytes->size, (size_t)capacity - bytes->size);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            status = fail_read(error);
            break;
        }
        bytes->size += (size_t)got;
        if (got == 0 || (bytes->size >= MSH_MAGIC_SIZE && !msh_is_mesh(bytes->data, bytes->size))) {
            break;
        }
    }
    return status;
}

static enum status take_in(struct bytes *bytes, int descriptor, struct error *error)
{
    struct stat info;
    if (fstat(descriptor, &info) != 0) {
        return fail_read(error);
    }
    if (S_ISDIR(info.st_mode)) {
        return fail(error, STATUS_INPUT, "is a directory");
    }
    if (!S_ISREG(info.st_mode) || info.st_size == 0 || lseek(descriptor, 0, SEEK_CUR) != 0) {
        return read_all(bytes, descriptor, error);
    }
    void *data = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (data == MAP_FAILED) {
        return fail_read(error);
    }
    *bytes = (struct bytes){data, (size_t)info.st_size, true};
    return STATUS_OK;
}

static enum status write_all(int descriptor, const char *data, size_t size, struct error *error)
{
    while (size > 0) {
        ssize_t put = write(descriptor, data, size);
        if (put < 0 && errno == EINTR) {
            continue;
        }
        if (put < 0) {
            return fail_read(error);
        }
        data += put;
        size -= (size_t)put;
    }
    return STATUS_OK;
}

/* libgmsh takes a file by its name, and runs NAME.opt beside it: give it one in memory that has neither name
 * nor neighbours, and only those sections that were checked. */
static enum status load_checked(struct msh *msh, const struct msh_scan *scan, const struct bytes *bytes,
                                struct error *error)
{
    enum status status = STATUS_OK;
    char path[64];
    int copy = memfd_create("mesh", MFD_CLOEXEC);
    if (copy < 0) {
        return fail_read(error);
    }
    for (int part = 0; part < MSH_PART_COUNT; part++) {
        const struct msh_rewritten *rewritten = &scan->rewritten[part];
        bool other = rewritten->text != NULL;
        const char *data = other ? rewritten->text : bytes->data + scan->part[part].from;
        size_t size = other ? rewritten->size : scan->part[part].to - scan->part[part].from;
        if (size > 0) {
            TRY(write_all(copy, data, size, error));
            TRY(write_all(copy, "\n", 1, error));
        }
    }
    snprintf(path, sizeof path, "/proc/self/fd/%d", copy);
    TRY(msh_load(msh, scan, path, error));
done:
    if (close(copy) != 0 && status == STATUS_OK) {
        status = fail_read(error);
    }
    return status;
}

enum status msh_read(struct msh *msh, int descriptor, const char *name, struct error *error)
{
    enum status status = STATUS_OK;
    struct bytes bytes = {0};
    struct msh_scan scan = {0};
    *msh = (struct msh){0};
    TRY(take_in(&bytes, descriptor, error));
    TRY(msh_scan(&scan, bytes.data, bytes.size, error));
    TRY(load_checked(msh, &scan, &bytes, error));
done:
    msh_scan_free(&scan);
    bytes_free(&bytes);
    if (status != STATUS_OK) {
        msh_free(msh);
        fail_in(error, status, "%s", name);
    }
    return status;
}

void msh_free(struct msh *msh)
{
    free(msh->x);
    free(msh->node_tag);
    free(msh->element_tag);
    free(msh->element_type);
    free(msh->node_ptr);
    free(msh->node_idx);
    free(msh->member_ptr);
    free(msh->member_idx);
    for (int32_t i = 0; i < msh->group_count; i++) {
        free(msh->groups[i].name);
        free(msh->groups[i].written);
    }
    free(msh->groups);
    *msh = (struct msh){0};
}
