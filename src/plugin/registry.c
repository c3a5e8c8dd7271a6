/* SPDX-License-Identifier: BSD-3-Clause */
/* registry.c -- the plugins a program has, linked in or loaded from weft-<id>.so. */
#include "plugin/plugin_check.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/grow.h"
#include "base/sized.h"
#include "plugin/loading.h"
#include "plugin/missing.h"

typedef struct entry {
    const weft_plugin *plugin;
    void *handle; /* NULL: linked in */
    char *file;
} entry;

struct weft_registry {
    char *path; /* directories, separated by ':' */
    entry *entries;
    size_t count;
    weft_log log;
    weft_status (*admit)(void *ctx, const char *file, weft_error *err);
    void *admit_ctx;
    weft_allocator memory;
};

void weft_registry_def_init(weft_registry_def *def, size_t size)
{
    const weft_registry_def start
        = { .struct_size = (uint32_t)size, .environment = true, .installed = true };
    weft__sized_write(def, size, &start, sizeof start);
}

enum { LISTS = 4 };

/* All lists as one, empty ones left out. */
static char *join_paths(const weft_allocator *memory, const char *const lists[LISTS])
{
    size_t length = 1;
    for (size_t i = 0; i < LISTS; ++i) {
        length += lists[i] == NULL ? 0 : strlen(lists[i]) + 1;
    }
    char *joined = weft__zeroed(memory, length, 1);
    for (size_t i = 0; joined != NULL && i < LISTS; ++i) {
        if (lists[i] != NULL && lists[i][0] != '\0') {
            strcat(joined, joined[0] == '\0' ? "" : ":");
            strcat(joined, lists[i]);
        }
    }
    return joined;
}

weft_status weft_registry_create(const weft_registry_def *given, weft_registry **out,
                                 weft_error *err)
{
    weft_registry_def own, *const def = &own;
    TRY(weft__given(given, out, "weft_registry_create", err));
    *out = NULL;
    TRY(WEFT__DEF_READ(weft_registry_def, def, given, WEFT__DEF_MOST, err));
    char installed[2048] = "";
    if (def->installed) {
        weft__installed_plugins(installed, sizeof installed);
    }
    const char *const lists[LISTS] = {
        def->path,
        def->environment ? getenv("WEFT_PLUGIN_PATH") : NULL,
        def->fallback,
        installed,
    };
    const weft_allocator memory = weft_allocator_or_malloc(def->allocator);
    weft_registry *registry = weft__zeroed(&memory, 1, sizeof *registry);
    char *path = join_paths(&memory, lists);
    if (registry == NULL || path == NULL) {
        WEFT__FREE_ALL(&memory, registry, path);
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a plugin registry");
    }
    registry->path = path;
    registry->log = def->log;
    registry->admit = def->admit;
    registry->admit_ctx = def->admit_ctx;
    registry->memory = memory;
    weft_status status = WEFT_OK;
    const weft_plugin *plugin;
    for (size_t i = 0; status == WEFT_OK && (plugin = weft__plugin_built_in(i)) != NULL;
         ++i) {
        status = weft_registry_add(registry, plugin, err);
    }
    if (status == WEFT_OK) {
        *out = registry;
    } else {
        weft_registry_destroy(registry);
    }
    return status;
}

void weft_registry_destroy(weft_registry *registry)
{
    if (registry == NULL) {
        return;
    }
    const weft_allocator memory = registry->memory;
    for (size_t i = 0; i < registry->count; ++i) {
        if (registry->entries[i].handle != NULL) {
            weft__plugin_close(registry->entries[i].handle);
        }
        weft__free(&memory, registry->entries[i].file);
    }
    WEFT__FREE_ALL(&memory, registry->entries, registry->path, registry);
}

static const weft_plugin *find_loaded(const weft_registry *registry, const char *id)
{
    for (size_t i = 0; i < registry->count; ++i) {
        if (strcmp(registry->entries[i].plugin->id, id) == 0) {
            return registry->entries[i].plugin;
        }
    }
    return NULL;
}

/* `id`: the one it must have; NULL: any. On failure the caller keeps the handle. */
static weft_status add_entry(weft_registry *registry, const weft_plugin *plugin,
                             const char *id, void *handle, const char *file,
                             weft_error *err)
{
    TRY(weft__plugin_check(plugin, err));
    if (id != NULL && strcmp(plugin->id, id) != 0) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "it calls itself '%s'", plugin->id);
    }
    if (find_loaded(registry, plugin->id) != NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "a plugin '%s' is there already",
                              plugin->id);
    }
    char *copy = NULL;
    if (!weft__resized(&registry->memory, &registry->entries, registry->count + 1,
                       sizeof *registry->entries)
        || (copy = weft__copy_text(&registry->memory, file)) == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a plugin");
    }
    registry->entries[registry->count++] = (entry){ plugin, handle, copy };
    weft__log(&registry->log, WEFT_LOG_INFO, "plugin %s %s%s", plugin->id,
              file[0] == '\0' ? "linked in" : "from ", file);
    return WEFT_OK;
}

weft_status weft_registry_add(weft_registry *registry, const weft_plugin *plugin,
                              weft_error *err)
{
    return add_entry(registry, plugin, NULL, NULL, "", err);
}

/* The <id> of .../weft-<id>.so; false if the name has another shape. */
static bool id_of_file(const char *file, char *id, size_t size)
{
    const char *slash = strrchr(file, '/');
    const char *name = slash == NULL ? file : slash + 1;
    const size_t length = strlen(name);
    if (strncmp(name, "weft-", 5) != 0 || length <= 8
        || strcmp(name + length - 3, ".so") != 0 || length - 8 >= size) {
        return false;
    }
    memcpy(id, name + 5, length - 8);
    id[length - 8] = '\0';
    return true;
}

/* Whether a file may be loaded. dlopen reports a missing one. */
static weft_status check_file(const weft_registry *registry, const char *file,
                              const char *id, weft_error *err)
{
    struct stat status;
    if (id == NULL) {
        return weft_error_set(err, WEFT_BAD_PLUGIN,
                              "its name is not of the form weft-<id>.so");
    }
    if (stat(file, &status) == 0 && !S_ISREG(status.st_mode)) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "not a regular file");
    }
    return registry->admit == NULL ? WEFT_OK
                                   : registry->admit(registry->admit_ctx, file, err);
}

weft_status weft_registry_load(weft_registry *registry, const char *file,
                               weft_error *err)
{
    weft_error why = { 0 };
    char id[64];
    void *handle = NULL;
    const weft_plugin *plugin = NULL;
    weft_status status
        = check_file(registry, file, id_of_file(file, id, sizeof id) ? id : NULL, &why);
    status = status == WEFT_OK ? weft__plugin_open(file, id, &handle, &plugin, &why)
                               : status;
    status = status == WEFT_OK ? add_entry(registry, plugin, id, handle, file, &why)
                               : status;
    if (status != WEFT_OK) {
        if (handle != NULL) {
            weft__plugin_close(handle);
        }
        weft_error_set(err, status, "plugin refused: %s: %s", file, why.message);
        weft__log(&registry->log, WEFT_LOG_WARNING, "plugin refused: %s: %s", file,
                  why.message);
    }
    return status;
}

/* The next directory of a list separated by ':'; NULL at the end. Skips names
 * that are too long for a path. */
static const char *next_directory(const char *list, char *directory, size_t size)
{
    for (size_t length; *list != '\0'; list += length) {
        list += strspn(list, ":");
        length = strcspn(list, ":");
        if (length > 0 && length < size) {
            memcpy(directory, list, length);
            directory[length] = '\0';
            return list + length;
        }
    }
    return NULL;
}

/* The search path in words, with the reason at each directory that cannot be read. */
static const char *searched(const weft_registry *registry, char *out, size_t size)
{
    char directory[2048], inside[2048 + 2];
    size_t used = 0;
    const char *list = registry->path;
    (void)snprintf(out, size, "%s", weft__no_search_path);
    while (used < size
           && (list = next_directory(list, directory, sizeof directory)) != NULL) {
        (void)snprintf(inside, sizeof inside, "%s/.", directory);
        const bool readable = access(inside, R_OK | X_OK) == 0 || errno == ENOENT;
        used += (size_t)snprintf(out + used, size - used, "%s%s%s%s%s",
                                 used > 0 ? ":" : "", directory, readable ? "" : " (",
                                 readable ? "" : strerror(errno), readable ? "" : ")");
    }
    return out;
}

weft_status weft_registry_locate(const weft_registry *registry, const char *id,
                                 char *file, size_t size, weft_error *err)
{
    char directory[2048], text[512];
    struct stat status;
    const char *list = strchr(id, '/') == NULL ? registry->path : "";
    while ((list = next_directory(list, directory, sizeof directory)) != NULL) {
        if ((size_t)snprintf(file, size, "%s/weft-%s.so", directory, id) < size
            && stat(file, &status) == 0) {
            return WEFT_OK;
        }
    }
    const char *advice = registry->path[0] != '\0'
                             ? weft__plugin_advice(weft__installed_by, id)
                             : NULL;
    return weft_error_set(err, WEFT_BAD_PLUGIN,
                          "plugin '%s' not found: %s%sno weft-%s.so in %s", id,
                          advice != NULL ? advice : "", advice != NULL ? "; " : "", id,
                          searched(registry, text, sizeof text));
}

weft_status weft_registry_find(weft_registry *registry, const char *id,
                               const weft_plugin **out, weft_error *err)
{
    char file[4096];
    *out = find_loaded(registry, id);
    if (*out == NULL) {
        TRY(weft_registry_locate(registry, id, file, sizeof file, err));
        TRY(weft_registry_load(registry, file, err));
        *out = find_loaded(registry, id);
    }
    return WEFT_OK;
}

/* weft-mpi.so lies among the plugins and is none (weft/comm.h). */
static int is_plugin_file(const struct dirent *item)
{
    char id[64];
    return id_of_file(item->d_name, id, sizeof id) && strcmp(id, "mpi") != 0;
}

/* Every weft-*.so of the search path that is not there yet, in the order of the
 * directories and of their names. */
static void each_file(const weft_registry *registry, weft__plugin_visit_fn *visit,
                      void *ctx)
{
    char directory[2048], id[64], file[4096];
    const char *list = registry->path;
    while ((list = next_directory(list, directory, sizeof directory)) != NULL) {
        struct dirent **items = NULL;
        const int count = scandir(directory, &items, is_plugin_file, alphasort);
        for (int i = 0; i < count; ++i) {
            (void)id_of_file(items[i]->d_name, id, sizeof id);
            (void)snprintf(file, sizeof file, "%s/%s", directory, items[i]->d_name);
            if (find_loaded(registry, id) == NULL) {
                visit(ctx, id, file);
            }
            free(items[i]); /* scandir's */
        }
        free(items);
    }
}

typedef struct loading {
    weft_registry *registry;
    void (*refused)(void *ctx, const weft_error *why);
    void *ctx;
} loading;

static void load_one(void *ctx, const char *id, const char *file)
{
    const loading *self = ctx;
    weft_error why = { 0 };
    (void)id;
    if (weft_registry_load(self->registry, file, &why) != WEFT_OK
        && self->refused != NULL) {
        self->refused(self->ctx, &why);
    }
}

void weft__registry_names(const weft_registry *registry, weft__plugin_visit_fn *visit,
                          void *ctx)
{
    for (size_t i = 0; i < registry->count; ++i) {
        visit(ctx, registry->entries[i].plugin->id, registry->entries[i].file);
    }
    each_file(registry, visit, ctx);
}

weft_status weft_registry_load_all(weft_registry *registry,
                                   void (*refused)(void *ctx, const weft_error *why),
                                   void *ctx, weft_error *err)
{
    loading self = { registry, refused, ctx };
    char text[512];
    each_file(registry, load_one, &self);
    if (registry->count == 0) {
        return weft_error_set(err, WEFT_BAD_PLUGIN, "no plugin in %s",
                              searched(registry, text, sizeof text));
    }
    return WEFT_OK;
}

size_t weft_registry_count(const weft_registry *registry)
{
    return registry->count;
}

const weft_plugin *weft_registry_at(const weft_registry *registry, size_t i)
{
    return registry->entries[i].plugin;
}

const char *weft_registry_file(const weft_registry *registry, size_t i)
{
    return registry->entries[i].file;
}
