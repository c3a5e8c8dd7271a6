/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.c -- `sweep` in the tree of a scene, and the values of one run. */

#include <string.h>

#include "scene/checks.h"

#define MAX_RUNS 100000
#define MAX_READ 20000000 /* nodes, in all runs: each takes a microsecond */

/* Whether a path is another, or leads to it. */
static bool leads_to(const char *path, size_t length, const char *other,
                     size_t other_length)
{
    return length <= other_length && memcmp(path, other, length) == 0
           && (length == other_length || other[length] == '.');
}

static bool overlap(const char *a, size_t a_length, const char *b, size_t b_length)
{
    return leads_to(a, a_length, b, b_length) || leads_to(b, b_length, a, a_length);
}

/* ---- reading ------------------------------------------------------------------- */

typedef struct taker {
    weft__tree *tree;
    weft__report *report; /* of the tree */
    size_t set_count;
    weft__sweep *out;
} taker;

/* Reports a key that is varied twice, or lies inside another one, which would be lost.
 */
static void check_overlap(const taker *self, const weft__node *key)
{
    for (size_t i = 0; i < self->out->keys; ++i) {
        const weft__node *other = self->out->axis[i].key;
        if (overlap(key->text, key->count, other->text, other->count)) {
            ERROR_AT(self, key, "%s is varied twice (first at %s)", key->text,
                     weft__place_text(self->report, other->at).text);
        }
    }
    for (size_t i = 1; i <= self->set_count; ++i) {
        const weft__source *set = &self->report->sources[i];
        if (overlap(key->text, key->count, set->text, weft__override_path(set))) {
            weft__report_error(self->report, weft__source_mark(set, 0),
                               "%s is varied by sweep (%s)", key->text,
                               weft__place_text(self->report, key->at).text);
        }
    }
}

static void take_axis(taker *self, const weft__node *key, const weft__node *list)
{
    if (list->type != WEFT__LIST) {
        ERROR_AT(self, list, "%s must be a list of values to run, not %s", key->text,
                 weft__show(list).text);
    } else if (list->count == 0) {
        ERROR_AT(self, list, "%s has no value to run", key->text);
    } else if (leads_to("sweep", 5, key->text, key->count)) {
        ERROR_AT(self, key, "a sweep cannot vary itself");
    } else if (self->out->keys == WEFT__SWEEP_KEYS) {
        ERROR_AT(self, key, "more than %d keys", WEFT__SWEEP_KEYS);
    } else {
        check_overlap(self, key);
        self->out->axis[self->out->keys++] = (weft__axis){ .key = key, .list = list };
    }
}

static void take_pairs(taker *self, const weft__node *map)
{
    static const weft__number runs
        = { .type = WEFT__SIZE, .least = 1, .most = MAX_RUNS },
        any = { .type = WEFT__SIZE };
    static const weft__key zip
        = { .name = "zip", .kind = WEFT__BOOLEAN },
        sample = { .name = "sample", .number = &runs, .kind = WEFT__INTEGER },
        seed = { .name = "seed", .number = &any, .kind = WEFT__INTEGER };
    weft__reader reader = { .report = self->report };
    for (size_t i = 0; i < map->count; ++i) {
        const weft__node *key = map->entries[i].key, *value = map->entries[i].value;
        const char *name = weft__text_of(key);
        if (value == NULL) {
            continue; /* an override removed it */
        }
        if (name == NULL) {
            ERROR_AT(self, key, "the keys of a sweep are paths as stepper.method");
        } else if (strcmp(name, "log") == 0) {
            self->out->log = value;
        } else if (strcmp(name, "zip") == 0) {
            weft__read_boolean(&reader, &zip, value, &self->out->zip);
        } else if (strcmp(name, "sample") == 0) {
            weft__read_integer(&reader, &sample, value, &self->out->sample);
        } else if (strcmp(name, "seed") == 0) {
            weft__read_integer(&reader, &seed, value, &self->out->seed);
        } else {
            take_axis(self, key, value);
        }
    }
}

/* Each run reads the rest of the tree and one value of each list. */
static void check_cost(const taker *self)
{
    const weft__sweep *out = self->out;
    size_t nodes = self->tree->root->size;
    for (size_t i = 0; i < out->keys; ++i) {
        nodes += out->axis[i].list->size / out->axis[i].list->count;
    }
    if (out->runs > MAX_READ / nodes) {
        ERROR_AT(self, out, "%zu runs of a scene of %zu nodes: more than %d in all",
                 out->runs, nodes, MAX_READ);
    }
}

/* Zipped lists must have one length; the combinations of others must not be too many.
 */
static void count_runs(taker *self)
{
    weft__sweep *out = self->out;
    size_t runs = out->zip ? out->axis[0].list->count : 1;
    for (size_t i = 0; i < out->keys; ++i) {
        const weft__node *list = out->axis[i].list;
        if (out->zip && list->count != runs) {
            ERROR_AT(self, list,
                     "%zu values, but %s has %zu: zip takes lists of one length",
                     list->count, out->axis[0].key->text, runs);
        }
        runs = out->zip ? runs
                        : runs * (list->count < MAX_RUNS ? list->count : MAX_RUNS + 1);
        if (runs > MAX_RUNS) {
            ERROR_AT(self, out, "more than %d combinations", MAX_RUNS);
            return;
        }
    }
    out->runs = runs;
    check_cost(self);
}

/* Removes the values of all pairs with key `sweep`. Returns the first pair; it has no
 * key if there is none, or no memory. */
static weft__entry take_out(const taker *self)
{
    const weft__node *old = self->tree->root;
    weft__entry first = { NULL, NULL };
    weft__node *root = weft__find_key(old, "sweep", 5) == old->count
                           ? NULL
                           : weft__node_new(self->tree, *old);
    for (size_t i = 0; root != NULL && i < old->count; ++i) {
        weft__entry pair = old->entries[i];
        const char *name = weft__text_of(pair.key);
        if (pair.value != NULL && name != NULL && strcmp(name, "sweep") == 0) {
            if (first.key == NULL) {
                first = pair;
            } else {
                ERROR_AT(self, pair.key,
                         "duplicate key 'sweep' in the scene (the first is at %s)",
                         weft__place_text(self->report, first.key->at).text);
            }
            pair.value = NULL;
        }
        if (!weft__node_add(self->tree, root, pair)) {
            return (weft__entry){ NULL, NULL };
        }
    }
    self->tree->root = root == NULL ? old : root;
    return first;
}

void weft__sweep_take(weft__tree *tree, size_t set_count, weft__sweep *out)
{
    weft__report *report = tree->report;
    taker self = { tree, report, set_count, out };
    const size_t errors = report->found->errors;
    *out = (weft__sweep){ .runs = 1, .seed = 1 };
    const weft__entry pair = take_out(&self);
    if (pair.key == NULL) {
        return;
    }
    out->at = pair.key->at;
    out->present = true;
    if (pair.value->type != WEFT__MAP) {
        weft__report_error(report, pair.value->at,
                           "sweep must be a mapping as {stepper.method: [rk4, rkf45]}, "
                           "not %s",
                           weft__show(pair.value).text);
    } else {
        take_pairs(&self, pair.value);
        weft__sweep_sample(tree, out);
    }
    if (report->found->errors == errors && out->keys == 0) {
        weft__report_error(report, out->at, "sweep varies no key");
    } else if (report->found->errors == errors) {
        count_runs(&self);
    }
    out->runs = report->found->errors == errors ? out->runs : 0;
}

/* ---- one run ------------------------------------------------------------------- */

bool weft__sweep_varies(const weft__sweep *sweep, const char *path)
{
    bool varies = false;
    for (size_t i = 0; i < sweep->keys; ++i) {
        const weft__node *key = sweep->axis[i].key;
        varies = varies || overlap(path, strlen(path), key->text, key->count);
    }
    return varies;
}

size_t weft__sweep_choice(const weft__sweep *sweep, size_t axis, size_t run)
{
    size_t index = run - 1;
    for (size_t i = sweep->keys; !sweep->zip && i-- > axis + 1;) {
        index /= sweep->axis[i].list->count;
    }
    return sweep->zip ? index : index % sweep->axis[axis].list->count;
}

void weft__sweep_apply(weft__tree *to, const weft__sweep *sweep, size_t run)
{
    for (size_t i = 0; i < sweep->keys; ++i) {
        const weft__node *key = sweep->axis[i].key;
        weft__mark at = key->at;
        at.column += key->style != YAML_PLAIN_SCALAR_STYLE; /* the quote */
        weft__tree_put(
            to, key->text, key->count, at,
            weft__item(sweep->axis[i].list, weft__sweep_choice(sweep, i, run)));
    }
}
