/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_method.c -- stepper.method as plugin/method, and the keys of stepper that
 * exclude one another or that the method would not use: where the choice of another key
 * comes from a later source, as the command line, they give way; else they are
 * mistakes. */
#include <string.h>

#include "base/name.h"
#include "plugin/methods.h"
#include "scene/checks.h"

/* Keys of error control. */
static const char *const adaptive_keys[]
    = { "rtol", "atol", "norm", "first_step", "min_step", "max_step", "controller" };
static const char *const fixed_step[] = { "fixed_step" };
enum { ADAPTIVE = sizeof adaptive_keys / sizeof adaptive_keys[0] };

typedef struct resolver {
    weft__reader *reader;
    const weft__sweep *sweep;
    const weft__node *map; /* stepper, as changed so far */
} resolver;

/* Where a key was set; the greater rank wins. */
typedef enum rank { ABSENT, IN_FILE, ON_COMMAND_LINE, IN_SWEEP } rank;

/* A key of stepper. */
typedef struct setting {
    size_t slot;
    rank rank;
    const weft__node *key, *value; /* NULL: absent */
    const char *text;              /* of the value; NULL: it is no text */
} setting;

static setting scene_method_find(const resolver *self, const char *name)
{
    setting found = { .slot = weft__find_key(self->map, name, strlen(name)) };
    char path[64];
    if (found.slot < self->map->count && self->map->entries[found.slot].value != NULL) {
        (void)snprintf(path, sizeof path, "stepper.%s", name);
        found.key = self->map->entries[found.slot].key;
        found.value = self->map->entries[found.slot].value;
        found.text = weft__text_of(found.value);
        found.rank = weft__sweep_varies(self->sweep, path) ? IN_SWEEP
                     : found.key->at.source > 0            ? ON_COMMAND_LINE
                                                           : IN_FILE;
    }
    return found;
}

/* Replaces a pair of stepper, or adds one; value NULL removes it. */
static void scene_method_put(resolver *self, size_t slot, const weft__node *key,
                             const weft__node *value)
{
    const weft__node *changed = weft__node_with(self->reader->tree, self->map, slot,
                                                (weft__entry){ key, value });
    self->map = changed == NULL ? self->map : changed;
}

/* ---- plugin/method ----------------------------------------------------------- */

/* A node for a part of the text of another one; NULL: no memory. */
static const weft__node *part_of(const resolver *self, const weft__node *node,
                                 size_t from, size_t length)
{
    weft__mark at = node->at;
    at.column += from;
    return weft__scalar_new(self->reader->tree, node->text + from, length,
                            YAML_PLAIN_SCALAR_STYLE, at);
}

static void split_method(resolver *self)
{
    const setting method = scene_method_find(self, "method"),
                  plugin = scene_method_find(self, "plugin");
    const char *text = method.text;
    const char *slash = text == NULL ? NULL : strchr(text, '/');
    if (slash == NULL || slash == text || slash[1] == '\0') {
        return;
    }
    const size_t length = (size_t)(slash - text);
    if (plugin.text != NULL
        && (strncmp(plugin.text, text, length) != 0 || plugin.text[length] != '\0')
        && !(plugin.rank == IN_FILE && method.rank > IN_FILE)) {
        ERROR_AT(self->reader, method.value,
                 "method '%.80s' is of another plugin than '%.40s' (%s)", text,
                 plugin.text,
                 weft__place_text(self->reader->report, plugin.key->at).text);
    }
    const weft__node *id = part_of(self, method.value, 0, length);
    const weft__node *name
        = part_of(self, method.value, length + 1, method.value->count - length - 1);
    const weft__node *key
        = plugin.key != NULL
              ? plugin.key
              : weft__scalar_new(self->reader->tree, "plugin", 6,
                                 YAML_PLAIN_SCALAR_STYLE, method.key->at);
    if (id != NULL && name != NULL && key != NULL) {
        scene_method_put(self, method.slot, method.key, name);
        scene_method_put(self, plugin.key == NULL ? self->map->count : plugin.slot, key,
                         id);
    }
}

/* ---- keys that give way -------------------------------------------------------- */

/* Adds "rtol (line 3, column 5)" to a list. */
static void append_place(const weft__report *report, char *list, size_t size,
                         const weft__node *key)
{
    const size_t used = strlen(list);
    (void)snprintf(list + used, size - used, "%s%s (%s)", used == 0 ? "" : ", ",
                   key->text, weft__place_text(report, key->at).text);
}

/* Removes the keys that were set by an earlier source than `later`, and warns at the
 * place of `later`. */
static void drop_earlier(resolver *self, const char *const *keys, size_t count,
                         setting later, const char *why)
{
    char list[340] = "";
    for (size_t i = 0; i < count; ++i) {
        const setting it = scene_method_find(self, keys[i]);
        if (it.key != NULL && it.rank < later.rank) {
            scene_method_put(self, it.slot, it.key, NULL);
            append_place(self->reader->report, list, sizeof list, it.key);
        }
    }
    if (list[0] != '\0') {
        WARNING_AT(self->reader, later.key, "%s dropped: %s", list, why);
    }
}

/* `why`: the reason, as in "the method has no error control". */
static void refuse_unused(resolver *self, const char *const *keys, size_t count,
                          const char *why)
{
    const setting plugin = scene_method_find(self, "plugin"),
                  method = scene_method_find(self, "method");
    char reason[80];
    (void)snprintf(reason, sizeof reason, "the method %s", why);
    drop_earlier(self, keys, count, plugin.rank > method.rank ? plugin : method,
                 reason);
    for (size_t i = 0; i < count; ++i) {
        const weft__node *key = scene_method_find(self, keys[i]).key;
        if (key != NULL) {
            ERROR_AT(
                self->reader, key,
                "%s would not be used by method '%.40s' of plugin '%.40s', which %s",
                keys[i], method.text, plugin.text, why);
        }
    }
}

static void check_use(resolver *self, uint32_t flags)
{
    static const char *const controller[]
        = { "controller" },
        *const butcher[] = { "butcher" }, *const solver[] = { "solver" };
    if ((flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        refuse_unused(self, adaptive_keys, ADAPTIVE, "has no error control");
    } else if ((flags & WEFT_STEPPER_CONTROLLER) == 0) {
        refuse_unused(self, controller, 1, "has its own");
    }
    if ((flags & WEFT_STEPPER_ADAPTIVE_ONLY) != 0) {
        refuse_unused(self, fixed_step, 1, "chooses every step itself");
    }
    if ((flags & WEFT_STEPPER_BUTCHER) == 0) {
        refuse_unused(self, butcher, 1, "takes no table; arkode/custom does");
    }
    if ((flags & WEFT_STEPPER_LINEAR) == 0) {
        refuse_unused(self, solver, 1, "has no linear solver to set");
    }
}

/* Reported at the later key of each pair: at fixed_step once for all before it. */
static void check_exclusive(const resolver *self)
{
    const weft__node *fixed = scene_method_find(self, "fixed_step").key;
    weft__report *report = self->reader->report;
    char before[320] = "";
    for (size_t i = 0; fixed != NULL && i < ADAPTIVE; ++i) {
        const weft__node *key = scene_method_find(self, adaptive_keys[i]).key;
        if (key != NULL && weft__mark_before(fixed->at, key->at)) {
            weft__report_exclusive(report, fixed, key);
        } else if (key != NULL) {
            append_place(self->reader->report, before, sizeof before, key);
        }
    }
    if (before[0] != '\0') {
        weft__report_error(report, fixed->at, "fixed_step excludes %s", before);
    }
}

/* Fixed steps exclude the keys of adaptive ones: the latest choice holds. */
static void choose_steps(resolver *self)
{
    const setting fixed = scene_method_find(self, fixed_step[0]);
    setting last = { .key = NULL };
    for (size_t i = 0; i < ADAPTIVE; ++i) {
        const setting one = scene_method_find(self, adaptive_keys[i]);
        last = one.rank > last.rank ? one : last;
    }
    if (fixed.rank < last.rank) {
        drop_earlier(self, fixed_step, 1, last, "error control excludes it");
    } else {
        drop_earlier(self, adaptive_keys, ADAPTIVE, fixed,
                     "fixed_step excludes error control");
    }
    check_exclusive(self);
}

/* NULL: not known, or wrong, which is reported when the key is read. */
static const weft_stepper_type *find_type(const resolver *self)
{
    const weft_scene_def *def = self->reader->def;
    const char *id = scene_method_find(self, "plugin").text,
               *name = scene_method_find(self, "method").text;
    weft_error why;
    return id == NULL || name == NULL || def->find_plugin == NULL
                   || !WEFT__IS_PLUGIN_ID(id)
               ? NULL
               : weft_plugin_method(def->find_plugin(def->find_ctx, id, &why), name);
}

void weft__resolve_method(weft__reader *reader, const weft__sweep *sweep)
{
    weft__tree *tree = reader->tree;
    const size_t slot = weft__find_key(tree->root, "stepper", 7);
    const weft__entry *stepper
        = slot < tree->root->count ? &tree->root->entries[slot] : NULL;
    if (stepper == NULL || stepper->value == NULL
        || stepper->value->type != WEFT__MAP) {
        return;
    }
    resolver self = { reader, sweep, stepper->value };
    split_method(&self);
    const weft_stepper_type *type = reader->scene->type = find_type(&self);
    if (type != NULL) {
        check_use(&self, type->flags);
    }
    if (type == NULL || (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0) {
        choose_steps(&self);
    }
    if (self.map != stepper->value) {
        const weft__node *root = weft__node_with(
            tree, tree->root, slot, (weft__entry){ stepper->key, self.map });
        tree->root = root == NULL ? tree->root : root;
    }
}
