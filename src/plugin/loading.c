/* SPDX-License-Identifier: BSD-3-Clause */
/* loading.c -- plugins that dlopen loads. */
#define _GNU_SOURCE /* dladdr, in POSIX since 2024 */
#include "plugin/loading.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#ifndef WEFT__INSTALLED_BY /* make INSTALLED_BY=pip, debian or spack */
#define WEFT__INSTALLED_BY "source"
#endif
const char weft__installed_by[] = WEFT__INSTALLED_BY;

const char weft__no_search_path[]
    = "an empty search path; set WEFT_PLUGIN_PATH or weft_registry_def.path";

const weft_plugin *weft__plugin_built_in(size_t i)
{
    (void)i;
    return NULL;
}

/* The directory of the installed plugins: beside the library, also after that was
 * moved. A message names it if it is missing or cannot be read. "": there is none, or
 * the library is a static one. */
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

/* weft_plugin_<id> of an open plugin, called; NULL if it has none. */
static weft_status call_entry(void *handle, const char *id, const weft_plugin **plugin,
                              weft_error *err)
{
    char name[128];
    (void)snprintf(name, sizeof name, "weft_plugin_%s", id);
    void *symbol = dlsym(handle, name);
    if (symbol == NULL) {
        return weft_error_set(
            err, WEFT_BAD_PLUGIN,
            "it has no function %s() (is it exported, with WEFT_API?)", name);
    }
    /* POSIX allows this conversion, ISO C does not. */
    weft_plugin_fn *function;
    memcpy(&function, &symbol, sizeof function);
    *plugin = function();
    return WEFT_OK;
}

/* dlopen would search the system's libraries for a name without a slash. */
static void *open_file(const char *file)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s%s", strchr(file, '/') == NULL ? "./" : "",
                   file);
    return dlopen(path, RTLD_NOW | RTLD_LOCAL);
}

/* dlerror's text often begins with "file: ", the name that open_file passed. */
static const char *without_name(const char *reason, const char *file)
{
    const size_t length = strlen(file);
    reason += strchr(file, '/') == NULL && strncmp(reason, "./", 2) == 0 ? 2 : 0;
    return strncmp(reason, file, length) == 0 && strncmp(reason + length, ": ", 2) == 0
               ? reason + length + 2
               : reason;
}

weft_status weft__plugin_open(const char *file, const char *id, void **handle,
                              const weft_plugin **plugin, weft_error *err)
{
    *handle = open_file(file);
    if (*handle != NULL) {
        return call_entry(*handle, id, plugin, err);
    }
    const char *reason = dlerror();
    return weft_error_set(err, WEFT_BAD_PLUGIN, "%s",
                          reason == NULL ? "it cannot be opened"
                                         : without_name(reason, file));
}

void weft__plugin_close(void *handle)
{
    (void)dlclose(handle);
}
