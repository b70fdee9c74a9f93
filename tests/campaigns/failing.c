/* Calls of the system that fail, or kill the process, at the n-th on a library's files: writes,
   syncs, truncations and deletions. Loaded by LD_PRELOAD; library_kills.py says when. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static long seen, wanted;
static int with, stays;

/* At the n-th call fail with an error of the system, or be killed (0); 1: all later calls, too. */
void fail_at(long n, int error, int stay) {
    seen = 0;
    wanted = n;
    with = error;
    stays = stay;
}

/* How many calls there were. */
long calls(void) { return seen; }

static int is_library(int descriptor) {
    char link[64], name[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    ssize_t size = readlink(link, name, sizeof name - 1);
    if (size < 0) return 0;
    name[size] = 0;
    return strstr(name, ".mocapdb") != NULL;
}

static int fails(void) {
    seen++;
    if (!wanted || seen < wanted || (seen > wanted && !stays)) return 0;
    if (!with) kill(getpid(), SIGKILL);
    errno = with;
    return 1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))
#define FAILING(type, name, parameters, arguments)                                                 \
    type name parameters { return is_library(fd) && fails() ? -1 : REAL(name) arguments; }

FAILING(ssize_t, write, (int fd, const void *data, size_t size), (fd, data, size))
FAILING(ssize_t, pwrite, (int fd, const void *data, size_t size, off_t at), (fd, data, size, at))
FAILING(ssize_t, pwrite64, (int fd, const void *data, size_t size, off64_t at), (fd, data, size, at))
FAILING(int, ftruncate, (int fd, off_t size), (fd, size))
FAILING(int, ftruncate64, (int fd, off64_t size), (fd, size))
FAILING(int, fsync, (int fd), (fd))
FAILING(int, fdatasync, (int fd), (fd))

int unlink(const char *path) {
    return strstr(path, ".mocapdb") && fails() ? -1 : REAL(unlink)(path);
}
