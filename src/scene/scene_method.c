/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_method.c -- stepper.method as plugin/method, and which keys of stepper give way
 * where file, command line and sweep choose differently. */
#include <string.h>

#include "plugin/methods.h"
#include "scene/read.h"
#include "scene/scalar.h"

typedef struct resolver {
    weft__reader *reader;
    weft__base *base;
    int map; /* stepper, a node of the document */
} resolver;

/* A later source gives way to no earlier one. */
typedef enum rank { ABSENT, IN_FILE, ON_COMMAND_LINE, IN_SWEEP } rank;

/* A key of stepper. */
typedef struct setting {
    yaml_node_pair_t *pair; /* NULL: absent */
    yaml_mark_t at;
    rank rank;
} setting;

static yaml_node_t *node_of(const resolver *self, int id)
{
    return yaml_document_get_node(self->reader->document, id);
}

static setting find(const resolver *self, const char *name)
{
    const yaml_node_t *map = node_of(self, self->map);
    const ptrdiff_t i
        = weft__find_pair(self->reader->document, map, name, strlen(name));
    yaml_node_pair_t *pair = i < 0 ? NULL : map->data.mapping.pairs.start + i;
    char path[64];
    if (pair == NULL || pair->value == 0) {
        return (setting){ .pair = NULL };
    }
    const yaml_mark_t at = node_of(self, pair->key)->start_mark;
    (void)snprintf(path, sizeof path, "stepper.%s", name);
    return (setting){
        .pair = pair,
        .at = at,
        .rank = weft__sweep_varies(&self->base->sweep, &self->base->document, path)
                    ? IN_SWEEP
                : at.index > 0 ? ON_COMMAND_LINE
                               : IN_FILE,
    };
}

static const char *text_of(const resolver *self, const setting *of)
{
    return of->pair == NULL ? NULL : weft__text_of(node_of(self, of->pair->value));
}

/* ---- plugin/method ----------------------------------------------------------- */

/* A new node for a part of a text that begins at a node's place; 0: no memory. */
static int add_part(const resolver *self, const char *text, size_t from, size_t length,
                    yaml_mark_t at)
{
    const int id = yaml_document_add_scalar(self->reader->document, NULL,
                                            (const yaml_char_t *)text + from,
                                            (int)length, YAML_PLAIN_SCALAR_STYLE);
    if (id != 0) {
        node_of(self, id)->start_mark = at;
        node_of(self, id)->start_mark.column += from;
    }
    return id;
}

static bool put_plugin(const resolver *self, setting plugin, int value, yaml_mark_t at)
{
    if (plugin.pair != NULL) {
        plugin.pair->value = value;
        return value != 0;
    }
    const int key = value == 0 ? 0 : add_part(self, "plugin", 0, 6, at);
    return key != 0
           && yaml_document_append_mapping_pair(self->reader->document, self->map, key,
                                                value)
                  != 0;
}

static void split_method(const resolver *self)
{
    setting method = find(self, "method");
    const setting plugin = find(self, "plugin");
    const char *text = text_of(self, &method), *id = text_of(self, &plugin);
    const char *slash = text == NULL ? NULL : strchr(text, '/');
    if (slash == NULL || slash == text || slash[1] == '\0') {
        return;
    }
    const size_t length = (size_t)(slash - text);
    const yaml_mark_t at = node_of(self, method.pair->value)->start_mark;
    char where[64];
    if (id != NULL && (strncmp(id, text, length) != 0 || id[length] != '\0')
        && !(plugin.rank == IN_FILE && method.rank > IN_FILE)) {
        weft__report_error(self->reader->report, at,
                           "method '%.80s' is of another plugin than '%.40s' (%s)",
                           text, id, weft__place_text(plugin.at, where, sizeof where));
    }
    const int first = add_part(self, text, 0, length, at);
    const int second
        = first == 0 ? 0 : add_part(self, text, length + 1, strlen(slash + 1), at);
    if (second == 0) {
        self->reader->report->no_memory = true;
        return;
    }
    method.pair->value = second;
    if (!put_plugin(self, plugin, first, method.at)) {
        self->reader->report->no_memory = true;
    }
}

/* ---- keys that give way -------------------------------------------------------- */

/* Removes those of the keys that an earlier source has set than `later`, and says so at
 * its place. */
static void drop_earlier(const resolver *self, const char *const *keys, size_t count,
                         setting later, const char *why)
{
    char list[340] = "", where[64];
    size_t used = 0;
    for (size_t i = 0; i < count && used < sizeof list; ++i) {
        const setting it = find(self, keys[i]);
        if (it.pair != NULL && it.rank < later.rank) {
            it.pair->value = 0;
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s (%s)",
                                     used == 0 ? "" : ", ", keys[i],
                                     weft__place_text(it.at, where, sizeof where));
        }
    }
    if (used > 0) {
        weft__report_warning(self->reader->report, later.at, "%s dropped: %s", list,
                             why);
    }
}

static void drop_unused(const resolver *self, uint32_t flags)
{
    const setting plugin = find(self, "plugin"), method = find(self, "method");
    const setting chosen = plugin.rank > method.rank ? plugin : method;
    if ((flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        drop_earlier(self, weft__adaptive_keys, WEFT__ADAPTIVE, chosen,
                     "the method has no error control");
    } else if ((flags & WEFT_STEPPER_CONTROLLER) == 0) {
        drop_earlier(self, &(const char *){ "controller" }, 1, chosen,
                     "the method has its own");
    }
    if ((flags & WEFT_STEPPER_BUTCHER) == 0) {
        drop_earlier(self, &(const char *){ "butcher" }, 1, chosen,
                     "the method takes no table");
    }
}

/* Fixed steps exclude the keys of adaptive ones: the latest choice holds. */
static void settle_steps(const resolver *self)
{
    const setting fixed = find(self, "fixed_step");
    setting last = { .pair = NULL };
    for (size_t i = 0; i < WEFT__ADAPTIVE; ++i) {
        const setting one = find(self, weft__adaptive_keys[i]);
        last = one.rank > last.rank ? one : last;
    }
    if (fixed.rank < last.rank) {
        drop_earlier(self, &(const char *){ "fixed_step" }, 1, last,
                     "error control excludes it");
    } else {
        drop_earlier(self, weft__adaptive_keys, WEFT__ADAPTIVE, fixed,
                     "fixed_step excludes error control");
    }
}

/* NULL: not known, or wrong, which is told when the key is read. */
static const weft_stepper_type *find_type(const resolver *self)
{
    const weft_scene_def *def = self->reader->def;
    const setting plugin = find(self, "plugin"), method = find(self, "method");
    const char *id = text_of(self, &plugin), *name = text_of(self, &method);
    weft_error why;
    return id == NULL || name == NULL || def->find_plugin == NULL
                   || !weft__is_plugin_id(id)
               ? NULL
               : weft_plugin_method(def->find_plugin(def->find_ctx, id, &why), name);
}

void weft__resolve_method(weft__reader *reader, weft__base *base)
{
    const yaml_node_t *root = yaml_document_get_root_node(reader->document);
    const ptrdiff_t i = weft__find_pair(reader->document, root, "stepper", 7);
    const resolver self
        = { reader, base, i < 0 ? 0 : root->data.mapping.pairs.start[i].value };
    const yaml_node_t *map = self.map == 0 ? NULL : node_of(&self, self.map);
    if (map == NULL || map->type != YAML_MAPPING_NODE) {
        return;
    }
    split_method(&self);
    const weft_stepper_type *type = find_type(&self);
    if (type != NULL) {
        drop_unused(&self, type->flags);
    }
    if (type == NULL || (type->flags & WEFT_STEPPER_FIXED_ONLY) == 0) {
        settle_steps(&self);
    }
}
