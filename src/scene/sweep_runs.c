/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep_runs.c -- the runs of a scene file with `sweep`: their values as texts, the
 * mistakes of all of them, and the scene of each. */
#include <stdlib.h>
#include <string.h>

#include "base/sized.h"
#include "scene/sweep.h"

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
    return sweep->value[key][weft__sweep_choice(&sweep->base.sweep, key, run)];
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

static weft_status sweep_runs_no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a sweep");
}

static weft_status sweep_runs_load(weft_sweep *sweep, const weft_scene_def *def,
                                   weft__report *report, weft_error *err)
{
    weft_status status = weft__base_open(def, &sweep->base, report, err);
    if (status == WEFT_OK) {
        status = keep_texts(sweep) ? check_runs(sweep, report, err)
                                   : sweep_runs_no_memory(err);
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
    const weft_status status = sweep == NULL
                                   ? sweep_runs_no_memory(err)
                                   : sweep_runs_load(sweep, def, &report, err);
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
        = found == NULL ? sweep_runs_no_memory(err)
          : run < 1 || run > weft_sweep_runs(sweep)
              ? weft_error_set(err, WEFT_INVALID, "the sweep has no run %zu", run)
              : weft__base_read(&sweep->base, run, &report, out, err);
    if (status == WEFT_BAD_SCENE) {
        status = weft__report_end(&report, err);
    }
    free(found);
    return status;
}
