/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/methods.h"

#include <string.h>

#include "sim/registry.h"
#include "sim/suggest.h"

/* ---- of a plugin ------------------------------------------------------------- */

/* One more of a list, while there is room for it and for what tells of others. */
static void append(char *list, size_t size, const char *name)
{
    const size_t used = strlen(list);
    if (used + strlen(name) + sizeof ", , ..." <= size) {
        (void)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", name);
    } else if (used < 3 || strcmp(list + used - 3, "...") != 0) {
        (void)snprintf(list + used, size - used, ", ...");
    }
}

void weft__methods_list(const weft_plugin *plugin, uint32_t flags, char *out,
                        size_t size)
{
    out[0] = '\0';
    for (size_t i = 0; plugin->types[i] != NULL; ++i) {
        if ((plugin->types[i]->flags & flags) == flags) {
            append(out, size, plugin->types[i]->name);
        }
    }
}

const weft_stepper_type *weft__method_named(const weft_plugin *plugin, const char *name,
                                            const char *other, weft_error *err)
{
    const weft_stepper_type *type = weft_plugin_method(plugin, name);
    weft__guess guess = { 0 };
    char near[80], names[240];
    if (type == NULL && plugin != NULL) {
        for (size_t i = 0; plugin->types[i] != NULL; ++i) {
            weft__guess_try(&guess, name, plugin->types[i]->name);
        }
        weft__methods_list(plugin, 0, names, sizeof names);
        (void)weft__guess_text(&guess, near, sizeof near);
        if (other != NULL) {
            (void)snprintf(near, sizeof near, " (%.40s has)", other);
        }
        weft_error_set(err, WEFT_INVALID,
                       "plugin '%.32s' has no method '%.40s'%s; it has %s", plugin->id,
                       name, near, names);
    }
    return type;
}

const weft_stepper_type *weft_plugin_method(const weft_plugin *plugin, const char *name)
{
    for (size_t i = 0; plugin != NULL && plugin->types[i] != NULL; ++i) {
        if (weft_stepper_is(plugin->types[i], name)) {
            return plugin->types[i];
        }
    }
    return NULL;
}

/* ---- of a registry ----------------------------------------------------------- */

const char *const weft__shipped[] = { "gsl", "arkode", "verlet", NULL };

const char *weft__plugin_guess(const char *id, char *out, size_t size)
{
    weft__guess guess = { 0 };
    bool exact = false;
    for (size_t i = 0; weft__shipped[i] != NULL; ++i) {
        weft__guess_try(&guess, id, weft__shipped[i]);
        exact = exact || strcmp(id, weft__shipped[i]) == 0;
    }
    guess.name = exact ? NULL : guess.name;
    return weft__guess_text(&guess, out, size);
}

/* Plugins that a registry has or could load. */
typedef struct choice {
    const char *wanted;
    bool there;
    size_t distance; /* of the nearest */
    char nearest[64], names[160];
} choice;

static bool is_listed(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = list; *at != '\0'; at += strcspn(at, ", ")) {
        at += strspn(at, ", ");
        if (strcspn(at, ", ") == length && strncmp(at, name, length) == 0) {
            return true;
        }
    }
    return false;
}

static void consider(void *ctx, const char *id)
{
    choice *self = ctx;
    weft__guess guess
        = { self->nearest[0] != '\0' ? self->nearest : NULL, self->distance };
    const char *before = guess.name;
    self->there = self->there || strcmp(id, self->wanted) == 0;
    if (is_listed(self->names, id)) {
        return;
    }
    append(self->names, sizeof self->names, id);
    weft__guess_try(&guess, self->wanted, id);
    if (guess.name != before) {
        (void)snprintf(self->nearest, sizeof self->nearest, "%s", id);
        self->distance = guess.distance;
    }
}

weft_status weft_registry_method(weft_registry *registry, const char *plugin,
                                 const char *method, const weft_stepper_type **out,
                                 weft_error *err)
{
    const weft_plugin *found = NULL;
    weft_error why = { 0 };
    *out = NULL;
    const weft_status status = weft_registry_find(registry, plugin, &found, &why);
    if (status == WEFT_OK) {
        *out = weft__method_named(found, method, NULL, err);
        return *out != NULL ? WEFT_OK : WEFT_INVALID;
    }
    choice all = { .wanted = plugin };
    char near[80];
    weft__registry_names(registry, consider, &all);
    const weft__guess guess = { all.nearest[0] != '\0' ? all.nearest : NULL, 0 };
    const bool refused = all.there;
    return weft_error_set(err, status, "%.300s%s%s%s", why.message,
                          refused ? "" : weft__guess_text(&guess, near, sizeof near),
                          refused || all.names[0] == '\0' ? "" : "; there are ",
                          refused ? "" : all.names);
}
