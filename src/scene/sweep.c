/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.c -- `sweep`: one scene file that stands for many runs. */
#include "scene/sweep.h"

#include <stdlib.h>
#include <string.h>

#include "base/given.h"
#include "scene/read.h"
#include "scene/scalar.h"

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
    char where[64];
    for (size_t i = 0; i < self->out->keys; ++i) {
        const weft__node *other = self->out->axis[i].key;
        if (overlap(key->text, key->count, other->text, other->count)) {
            weft__report_error(
                self->report, key->at, "%s is varied twice (first at %s)", key->text,
                weft__place_text(self->report, other->at, where, sizeof where));
        }
    }
    for (size_t i = 1; i <= self->set_count; ++i) {
        const weft__source *set = &self->report->sources[i];
        if (overlap(key->text, key->count, set->text, weft__override_path(set))) {
            weft__report_error(
                self->report, weft__source_mark(set, 0), "%s is varied by sweep (%s)",
                key->text,
                weft__place_text(self->report, key->at, where, sizeof where));
        }
    }
}

static void take_axis(taker *self, const weft__node *key, const weft__node *list)
{
    char shown[64];
    if (list->type != WEFT__LIST) {
        weft__report_error(self->report, list->at,
                           "%s must be a list of values to run, not %s", key->text,
                           weft__show(list, shown, sizeof shown));
    } else if (list->count == 0) {
        weft__report_error(self->report, list->at, "%s has no value to run", key->text);
    } else if (leads_to("sweep", 5, key->text, key->count)) {
        weft__report_error(self->report, key->at, "a sweep cannot vary itself");
    } else if (self->out->keys == WEFT__SWEEP_KEYS) {
        weft__report_error(self->report, key->at, "more than %d keys",
                           WEFT__SWEEP_KEYS);
    } else {
        check_overlap(self, key);
        self->out->axis[self->out->keys++] = (weft__axis){ key, list };
    }
}

static void take_pairs(taker *self, const weft__node *map)
{
    static const weft__key zip
        = { "zip", WEFT__BOOLEAN, .at = offsetof(weft__sweep, zip) };
    for (size_t i = 0; i < map->count; ++i) {
        const weft__node *key = map->entries[i].key, *value = map->entries[i].value;
        const char *name = weft__text_of(key);
        if (value == NULL) {
            continue; /* an override removed it */
        }
        if (name == NULL) {
            weft__report_error(self->report, key->at,
                               "the keys of a sweep are paths as stepper.method");
        } else if (strcmp(name, "zip") == 0) {
            weft__read_value(&(weft__reader){ .report = self->report }, &zip, value,
                             self->out);
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
        weft__report_error(self->report, out->at,
                           "%zu runs of a scene of %zu nodes: more than %d in all",
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
            weft__report_error(
                self->report, list->at,
                "%zu values, but %s has %zu: zip takes lists of one length",
                list->count, out->axis[0].key->text, runs);
        }
        runs = out->zip ? runs
                        : runs * (list->count < MAX_RUNS ? list->count : MAX_RUNS + 1);
        if (runs > MAX_RUNS) {
            weft__report_error(self->report, out->at, "more than %d combinations",
                               MAX_RUNS);
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
    char where[64];
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
                weft__report_error(
                    self->report, pair.key->at,
                    "duplicate key 'sweep' in the scene (the first is at %s)",
                    weft__place_text(self->report, first.key->at, where, sizeof where));
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
    char shown[64];
    *out = (weft__sweep){ .runs = 1 };
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
                           weft__show(pair.value, shown, sizeof shown));
    } else {
        take_pairs(&self, pair.value);
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

/* Which value of a list a run takes; the last key varies fastest. */
static size_t choice(const weft__sweep *sweep, size_t axis, size_t run)
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
        weft__tree_put(to, key->text, key->count, at,
                       weft__item(sweep->axis[i].list, choice(sweep, i, run)));
    }
}

/* ---- in words ------------------------------------------------------------------ */

struct weft_sweep {
    weft__base base;
    const char **value[WEFT__SWEEP_KEYS]; /* of each list, in the tree */
};

/* As YAML, but without quotes. */
static void print_value(FILE *out, const weft__node *node)
{
    const bool is_map = node != NULL && node->type == WEFT__MAP;
    if (node == NULL || node->type == WEFT__SCALAR) {
        fputs(node == NULL || weft__is_null(node) ? "null" : node->text, out);
        return;
    }
    fputc(is_map ? '{' : '[', out);
    for (size_t i = 0; i < node->count; ++i) {
        fputs(i > 0 ? ", " : "", out);
        if (is_map) {
            print_value(out, node->entries[i].key);
            fputs(": ", out);
        }
        print_value(out, node->entries[i].value);
    }
    fputc(is_map ? '}' : ']', out);
}

/* A node in one line; NULL: no memory. */
static const char *value_text(weft__tree *tree, const weft__node *node)
{
    char *printed = NULL, *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&printed, &length);
    if (stream != NULL) {
        print_value(stream, node);
        (void)fclose(stream);
    }
    text = printed == NULL ? NULL : weft__tree_text(tree, printed, length);
    free(printed);
    return text;
}

/* The values as texts; false: no memory. */
static bool keep_texts(weft_sweep *self)
{
    weft__tree *tree = &self->base.tree;
    for (size_t i = 0; i < self->base.sweep.keys; ++i) {
        const weft__node *list = self->base.sweep.axis[i].list;
        self->value[i] = weft__tree_take(tree, list->count, sizeof *self->value[i]);
        for (size_t k = 0; self->value[i] != NULL && k < list->count; ++k) {
            self->value[i][k] = value_text(tree, weft__item(list, k));
            if (self->value[i][k] == NULL) {
                return false;
            }
        }
    }
    return !tree->report->no_memory;
}

void weft_sweep_destroy(weft_sweep *sweep)
{
    if (sweep != NULL) {
        weft__base_close(&sweep->base);
        free(sweep);
    }
}

size_t weft_sweep_runs(const weft_sweep *sweep)
{
    return sweep->base.sweep.runs;
}

size_t weft_sweep_keys(const weft_sweep *sweep)
{
    return sweep->base.sweep.keys;
}

const char *weft_sweep_key(const weft_sweep *sweep, size_t key)
{
    return sweep->base.sweep.axis[key].key->text;
}

const char *weft_sweep_value(const weft_sweep *sweep, size_t key, size_t run)
{
    return sweep->value[key][choice(&sweep->base.sweep, key, run)];
}

/* ---- all runs ------------------------------------------------------------------ */

/* Adds the runs to messages that concern only some of them. */
static void name_runs(const weft_sweep *sweep, const weft__report *report, size_t read)
{
    for (size_t i = 0; i < report->found->count; ++i) {
        const weft__origin *origin = &report->origin[i];
        char *message = report->found->items[i].message;
        const size_t size = sizeof report->found->items[i].message;
        size_t used = strlen(message);
        if (origin->runs == read || origin->first == 0) {
            continue;
        }
        used += (size_t)snprintf(message + used, size - used, " (in %zu of %zu runs,",
                                 origin->runs, read);
        for (size_t k = 0; k < weft_sweep_keys(sweep) && used < size; ++k) {
            used += (size_t)snprintf(message + used, size - used, "%s %s=%s%s",
                                     k == 0 ? " first" : ",", weft_sweep_key(sweep, k),
                                     weft_sweep_value(sweep, k, origin->first),
                                     k + 1 == weft_sweep_keys(sweep) ? ")" : "");
        }
        weft__fit(message, size, (int)used);
        weft__one_line(message);
    }
}

/* Reads one run after another until the report is full. */
static weft_status check_runs(weft_sweep *sweep, weft__report *report, weft_error *err)
{
    weft_status status;
    do {
        weft_scene *scene = NULL;
        ++report->run;
        report->mistakes = 0;
        status = weft__base_read(&sweep->base, report->run, report, &scene, err);
        weft_scene_destroy(scene);
    } while (report->run < weft_sweep_runs(sweep)
             && (status == WEFT_OK || status == WEFT_BAD_SCENE)
             && report->found->errors < WEFT_DIAGNOSTICS_MAX);
    name_runs(sweep, report, report->run);
    return status;
}

static weft_status no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a sweep");
}

static weft_status load(weft_sweep *sweep, const weft_scene_def *def,
                        weft__report *report, weft_error *err)
{
    weft_status status = weft__base_open(def, &sweep->base, report, err);
    if (status == WEFT_OK) {
        status = keep_texts(sweep) ? check_runs(sweep, report, err) : no_memory(err);
    }
    return status == WEFT_OK || status == WEFT_BAD_SCENE ? weft__report_end(report, err)
                                                         : status;
}

weft_status weft_sweep_load(const weft_scene_def *def, weft_sweep **out,
                            weft_diagnostics *found, weft_error *err)
{
    weft__report report = { .found = found };
    if (weft__given(def, out, "weft_sweep_load", err) != WEFT_OK) {
        return WEFT_INVALID;
    }
    weft_sweep *sweep = calloc(1, sizeof *sweep);
    *out = NULL;
    memset(found, 0, sizeof *found);
    const weft_status status
        = sweep == NULL ? no_memory(err) : load(sweep, def, &report, err);
    if (status != WEFT_OK) {
        weft_sweep_destroy(sweep);
        return status;
    }
    *out = sweep;
    return WEFT_OK;
}

weft_status weft_sweep_scene(const weft_sweep *sweep, size_t run, weft_scene **out,
                             weft_error *err)
{
    weft_diagnostics *found = calloc(1, sizeof *found);
    weft__report report = { .found = found,
                            .sources = sweep->base.sources,
                            .run = run,
                            .memory = &sweep->base.memory };
    *out = NULL;
    weft_status status
        = found == NULL ? no_memory(err)
          : run < 1 || run > weft_sweep_runs(sweep)
              ? weft_error_set(err, WEFT_INVALID, "the sweep has no run %zu", run)
              : weft__base_read(&sweep->base, run, &report, out, err);
    if (status == WEFT_BAD_SCENE) {
        status = weft__report_end(&report, err);
    }
    free(found);
    return status;
}
