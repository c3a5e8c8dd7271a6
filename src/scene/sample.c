/* SPDX-License-Identifier: BSD-3-Clause */
/* sample.c -- `sample` of a sweep: the values of a Latin hypercube (M. D. McKay et al.,
 * Technometrics 21, 1979) in place of the lists, whose ranges it fills. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/random.h"
#include "scene/sweep.h"
#include "weft/elementary.h"

/* Marks the keys that `log` lists; reports what is no list of keys of the sweep. */
static void mark_log(weft__tree *tree, weft__sweep *sweep)
{
    const weft__node *log = sweep->log;
    for (size_t i = 0; log != NULL && i < weft__item_count(log); ++i) {
        const weft__node *name = weft__item(log, i);
        const char *text = weft__text_of(name);
        size_t k = 0;
        while (k < sweep->keys
               && (text == NULL || strcmp(text, sweep->axis[k].key->text) != 0)) {
            ++k;
        }
        if (k < sweep->keys) {
            sweep->axis[k].log = true;
        } else {
            ERROR_AT(tree, name, "log must name keys of the sweep, not %s",
                     weft__show(name).text);
        }
    }
    if (log != NULL && log->type != WEFT__LIST) {
        ERROR_AT(tree, log, "log must be a list of keys of the sweep, not %s",
                 weft__show(log).text);
    }
}

typedef struct interval {
    double least, most;
} interval;

/* The smallest and largest number of a list; false: reported. */
static bool find_interval(weft__tree *tree, const weft__axis *axis, interval *out)
{
    const weft__node *list = axis->list;
    *out = (interval){ HUGE_VAL, -HUGE_VAL };
    for (size_t i = 0; i < list->count; ++i) {
        const weft__node *item = weft__item(list, i);
        double value;
        if (!weft__number_of(item, &value) || !isfinite(value)
            || (axis->log && !(value > 0.0))) {
            ERROR_AT(tree, item, "a sample draws %s from finite numbers%s, not %s",
                     axis->key->text, axis->log ? " > 0" : "", weft__show(item).text);
            return false;
        }
        out->least = fmin(out->least, value);
        out->most = fmax(out->most, value);
    }
    const double size = axis->log ? out->most / out->least : out->most - out->least;
    if (!(out->least < out->most && isfinite(size))) {
        ERROR_AT(tree, list, "a sample needs a range of %s: two numbers that differ%s",
                 axis->key->text, isfinite(size) ? "" : " less");
        return false;
    }
    return true;
}

/* The number at a part x, from 0 to 1, of a range, in the fewest digits that are it. */
static void print_at(const interval *of, bool log, double x, char out[32])
{
    const double there = log ? of->least * weft_pow(of->most / of->least, x)
                             : of->least + (of->most - of->least) * x;
    const double value = fmax(of->least, fmin(there, of->most));
    for (int digits = 15; digits <= 17; ++digits) {
        (void)snprintf(out, 32, "%.*g", digits, value);
        if (strtod(out, NULL) == value) {
            break;
        }
    }
}

/* A number in each of `count` equal parts of the range, in random order. The numbers
 * depend on seed, key, count and range alone. NULL: reported, or no memory. */
static const weft__node *draw(weft__tree *tree, const weft__axis *axis,
                              const interval *of, size_t count, uint64_t state)
{
    char text[32];
    uint32_t *part = weft__tree_take(tree, count, sizeof *part);
    weft__node *list = weft__node_new(tree, *axis->list);
    for (const char *c = axis->key->text; *c != '\0'; ++c) {
        state = weft__hash_byte(state, (unsigned char)*c);
    }
    for (size_t i = 0; part != NULL && i < count; ++i) { /* Fisher and Yates */
        const size_t k = (size_t)(weft__random(&state) % (i + 1));
        part[i] = part[k];
        part[k] = (uint32_t)i;
    }
    for (size_t i = 0; part != NULL && list != NULL && i < count; ++i) {
        const double within = ((double)(weft__random(&state) >> 32) + 0.5) * 0x1p-32;
        print_at(of, axis->log, ((double)part[i] + within) / (double)count, text);
        const weft__node *value = weft__scalar_new(
            tree, text, strlen(text), YAML_PLAIN_SCALAR_STYLE, axis->list->at);
        if (value == NULL
            || !weft__node_add(tree, list, (weft__entry){ NULL, value })) {
            return NULL;
        }
    }
    return part == NULL ? NULL : list;
}

void weft__sweep_sample(weft__tree *tree, weft__sweep *sweep)
{
    mark_log(tree, sweep);
    if (sweep->sample > 0 && sweep->zip) {
        ERROR_AT(tree, sweep, "sample and zip exclude each other");
    }
    for (size_t i = 0; sweep->sample > 0 && i < sweep->keys; ++i) {
        weft__axis *axis = &sweep->axis[i];
        interval of;
        const weft__node *drawn
            = find_interval(tree, axis, &of)
                  ? draw(tree, axis, &of, sweep->sample,
                         weft__hash_word(WEFT__HASH_START, sweep->seed))
                  : NULL;
        axis->list = drawn == NULL ? axis->list : drawn;
    }
    sweep->zip = sweep->zip || sweep->sample > 0;
}
