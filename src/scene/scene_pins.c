/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_pins.c -- places on the grid, and the pins and loads that are put there. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/suggest.h"
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "mesh/track.h"
#include "scene/checks.h"

_Static_assert(offsetof(weft_pin, cols) - offsetof(weft_pin, rows)
                       == offsetof(weft__place, cols)
                   && offsetof(weft_load, cols) - offsetof(weft_load, rows)
                          == offsetof(weft__place, cols),
               "a place is put where rows and cols of a pin or a load stand");

/* Row 0 is the top, column 0 the left, -1 the last of either. */
static const char *const place_names[]
    = { "top-left", "top-right", "bottom-left", "bottom-right", "top", "bottom",
        "left",     "right",     NULL };
static const weft__place named_places[] = {
    { { 0, 0 }, { 0, 0 } },     { { 0, 0 }, { -1, -1 } },  { { -1, -1 }, { 0, 0 } },
    { { -1, -1 }, { -1, -1 } }, { { 0, 0 }, { 0, -1 } },   { { -1, -1 }, { 0, -1 } },
    { { 0, -1 }, { 0, 0 } },    { { 0, -1 }, { -1, -1 } },
};

/* ---- an index or a range of them -------------------------------------------- */

/* Of rows or of columns: 0 if the grid is wrong, and then nothing is checked. */
static size_t count_of(const weft__reader *reader, bool rows)
{
    const weft_cloth_def *cloth = &reader->scene->cloth;
    return rows ? cloth->rows : cloth->cols;
}

static bool read_one(weft__reader *reader, bool rows, const char *name,
                     const weft__node *node, ptrdiff_t *out)
{
    const ptrdiff_t count = (ptrdiff_t)count_of(reader, rows);
    long long index;
    if (!weft__integer_of(node, &index)) {
        weft__refuse(reader, node, name, "an integer", true, NULL);
        return false;
    }
    if (count > 0 && (index < -count || index >= count)) {
        ERROR_AT(reader, node,
                 "%s %lld is outside the grid: it has %s 0 to %td, or from "
                 "the end %td to -1",
                 name, index, rows ? "rows" : "columns", count - 1, -count);
        return false;
    }
    *out = (ptrdiff_t)index;
    return true;
}

static bool read_pair(weft__reader *reader, bool rows, const char *name,
                      const weft__node *node, weft_range *out)
{
    weft_range range;
    size_t from, to;
    const size_t count = count_of(reader, rows);
    const bool first = read_one(reader, rows, name, weft__item(node, 0), &range.first);
    const bool last = read_one(reader, rows, name, weft__item(node, 1), &range.last);
    if (!first || !last) {
        return false;
    }
    if (count > 0 && !weft__range_resolve(range, count, &from, &to)) {
        ERROR_AT(reader, node,
                 "%s [%td, %td] hold nothing: the first is behind the last", name,
                 range.first, range.last);
        return false;
    }
    *out = range;
    return true;
}

void weft__read_index(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    const bool rows = key->at == offsetof(weft__place, rows);
    const char *text = weft__text_of(node);
    weft_range *range = to;
    long long index;
    if (text != NULL && strcmp(text, "all") == 0) {
        *range = (weft_range){ 0, -1 };
    } else if (weft__item_count(node) == 2) {
        (void)read_pair(reader, rows, key->name, node, range);
    } else if (weft__integer_of(node, &index)) {
        if (read_one(reader, rows, key->name, node, &range->first)) {
            range->last = range->first;
        }
    } else {
        weft__refuse_value(reader, key, node);
    }
}

/* ---- places ----------------------------------------------------------------- */

void weft__read_place(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    weft__place place = { { 0, 0 }, { 0, 0 } };
    if (reader->scene->meshed) {
        return; /* weft__check_vertices tells that it has no such places */
    }
    if (node->type == WEFT__SCALAR) {
        weft__key named = *key;
        size_t name;
        named.names = place_names;
        if (weft__find_name(reader, &named, node, &name)) {
            place = named_places[name];
        }
    } else if (node->type == WEFT__MAP) {
        weft__read_section(reader, key->section, key->section->title, node, &place);
    } else if (node->count == 2) {
        ptrdiff_t row, col;
        const bool has_row = read_one(reader, true, "row", weft__item(node, 0), &row);
        if (read_one(reader, false, "column", weft__item(node, 1), &col) && has_row) {
            place = (weft__place){ { row, row }, { col, col } };
        }
    } else {
        weft__refuse_value(reader, key, node);
    }
    memcpy(to, &place, sizeof place);
}

/* An axis has two names: exactly one of them is needed. */
void weft__check_place(weft__reader *reader, const weft__match *match, void *base)
{
    static const char *const axes[][3] = { { "rows", "row" }, { "cols", "col" } };
    (void)base;
    for (size_t i = 0; i < 2; ++i) {
        if (!weft__check_exclusive(reader, match, axes[i])) {
            ERROR_AT(reader, match->map,
                     "%s lacks '%s': rows and cols are both needed, each an index, "
                     "[first, last] or all",
                     match->title, axes[i][0]);
        }
    }
}

/* ---- tracks ------------------------------------------------------------------- */

void weft__read_track(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    char row[64];
    size_t at;
    if (node->type == WEFT__MAP && key->section != NULL) {
        weft__splined table = { .natural = false };
        weft__read_mapping(reader, key, node, &table);
        memcpy(to, &table.track, sizeof table.track);
        *((bool *)to + key->first) = table.natural;
        return;
    }
    if (weft__is_table_file(node)) {
        return; /* its fault was reported */
    }
    if (weft__item_count(node) == 0) {
        weft__refuse_value(reader, key, node);
        return;
    }
    (void)snprintf(row, sizeof row, "[t, x, y, z] [%s]", key->unit);
    const weft_table track
        = { weft__read_table(reader, key, node, WEFT__TRACK_WIDTH, row), node->count };
    if (track.rows != NULL) {
        const char *fault = weft__track_fault(&track, &at);
        if (fault != NULL) {
            ERROR_AT(reader, weft__item(node, at), "%s[%zu] %s", key->name, at, fault);
        }
        memcpy(to, &track, sizeof track);
    }
}

/* ---- pins ------------------------------------------------------------------- */

bool weft__check_motion(weft__reader *reader, const weft__match *match,
                        const double amplitude[3], double frequency)
{
    static const double rest[3] = { 0.0 };
    const weft__motion motion = weft__motion_of(rest, amplitude, frequency);
    const bool fast = !isfinite(motion.omega * motion.omega);
    const weft__node *at = weft__value_in(match, fast ? "frequency" : "amplitude");
    if (at != NULL && !weft__motion_usable(&motion)) {
        ERROR_AT(reader, at,
                 "accelerations of (2 pi frequency)^2 amplitude, with "
                 "frequency %g Hz, are beyond %.2g m/s^2",
                 frequency, DBL_MAX);
    }
    return weft__motion_usable(&motion);
}

void weft__check_pin(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_pin *pin = base;
    (void)weft__check_motion(reader, match, pin->amplitude, pin->frequency);
    weft__check_vertices(reader, match, base);
}

/* A pin is a mapping with `at`, or the place of a pin at rest: a mapping with a key of
 * a place, which may be misspelt. */
static bool is_place(const weft__section *place, const weft__node *node)
{
    weft__guess guess = { 0 };
    if (node->type != WEFT__MAP) {
        return true;
    }
    for (size_t k = 0; k < node->count; ++k) {
        const char *name = weft__text_of(node->entries[k].key);
        for (size_t i = 0; name != NULL && i < place->count; ++i) {
            weft__guess_try(&guess, name, place->keys[i].name);
        }
    }
    return guess.name != NULL && weft__find_key(node, "at", 2) == node->count;
}

void weft__read_pin(weft__reader *reader, const weft__key *key, const weft__node *node,
                    void *to)
{
    weft_pin *pin = to;
    const weft__key at_rest = { "a pin", WEFT__PLACE, .section = key->section->beside };
    if (reader->scene->meshed ? node->type != WEFT__MAP
                              : is_place(at_rest.section, node)) {
        if (reader->scene->meshed) {
            weft__refuse(reader, node, "a pin of a mesh",
                         "{vertices: ...}, {group: "
                         "...}, {near: ...} or {inside: ...}",
                         false, NULL);
            return;
        }
        weft__read_place(reader, &at_rest, node, &pin->rows);
    } else {
        weft__read_mapping(reader, key, node, pin);
    }
}
