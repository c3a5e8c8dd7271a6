/* SPDX-License-Identifier: BSD-3-Clause */
/* installed.c -- finds the directory of the installed plugins: beside the library, also
 * after that was moved. A message names it if it is missing or cannot be read. */
#define _GNU_SOURCE /* dladdr, in POSIX since 2024 */

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "plugin/registry.h"

void weft__installed_plugins(char *directory, size_t size)
{
    static const char here = 0;
    Dl_info info;
    char library[PATH_MAX];
    struct stat status;
    directory[0] = '\0';
    if (dladdr(&here, &info) == 0 || realpath(info.dli_fname, library) == NULL) {
        return;
    }
    char *slash = strrchr(library, '/');
    if (strncmp(slash, "/libweft.so", 11) != 0) {
        return; /* linked into something else, which may lie anywhere */
    }
    *slash = '\0';
    const int length
        = snprintf(directory, size, "%s/weft/plugins-%u", library, WEFT_STEPPER_ABI);
    const bool tree
        = stat(directory, &status) != 0 && errno == ENOTDIR; /* of the build */
    if (tree || length >= (int)size) {
        directory[0] = '\0';
    }
}
