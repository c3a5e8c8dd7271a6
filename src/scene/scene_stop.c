/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_stop.c -- the earlier end of a run, frames from within steps, and what of a
 * scene does not run in bands (weft/comm.h). */
#include <math.h>
#include <string.h>

#include "base/finite.h"
#include "cloth/model.h"
#include "scene/checks.h"

void weft__read_condition(weft__reader *reader, const weft__key *key,
                          const weft__node *node, void *to)
{
    weft_stop_def *stop = to;
    const char *text = weft__text_of(node);
    const size_t length = text == NULL ? 0 : strcspn(text, " <>"); /* of the name */
    const char *sign = text == NULL ? "" : text + length + strspn(text + length, " ");
    for (unsigned i = 1; text != NULL && i <= WEFT_STOP_KINETIC; ++i) {
        const weft_stop_quantity quantity = (weft_stop_quantity)i;
        const char *name = weft_stop_name(quantity);
        if (*sign == (quantity == WEFT_STOP_STRAIN ? '>' : '<')
            && strlen(name) == length && strncmp(text, name, length) == 0) {
            weft__node value = *node;
            value.text = sign + 1 + strspn(sign + 1, " ");
            value.count = strlen(value.text);
            value.style = YAML_PLAIN_SCALAR_STYLE;
            if (weft__number_of(&value, &stop->bound) && isfinite(stop->bound)) {
                stop->quantity = quantity;
                return;
            }
        }
    }
    weft__refuse_value(reader, key, node);
}

void weft__read_rest(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    weft_stop_def *stop = to;
    const char *text = weft__text_of(node);
    double bound = 1e-6;
    const bool is_number = weft__number_of(node, &bound);
    if (is_number ? !weft__positive(bound)
                  : text == NULL
                        || (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)) {
        weft__refuse_value(reader, key, node);
    } else if (is_number || text[0] == 't') {
        stop->quantity = WEFT_STOP_REST;
        stop->bound = bound;
        stop->hold = 0.5;
    }
}

void weft__check_stop(weft__reader *reader, const weft__match *match)
{
    const weft__node *limit = weft__key_in(match, "limit");
    const weft__node *stop = weft__key_in(match, "stop");
    const double *g = reader->scene->cloth.gravity;
    if (reader->scene->run.stop.quantity == WEFT_STOP_REST && g[0] == 0.0 && g[1] == 0.0
        && g[2] == 0.0) {
        ERROR_AT(reader, stop,
                 "stop.at_rest compares with the work of gravity, and "
                 "forces.gravity is 0; 'when: kinetic < NUMBER' does not");
    }
    if (reader->scene->run.stop.quantity == WEFT_STOP_REST
        && !weft__def_slows(&reader->scene->cloth)) {
        WARNING_AT(reader, stop,
                   "stop.at_rest may never be met: nothing slows a cloth that swings, "
                   "as damping along springs does not; set forces.damping, for "
                   "example 1e-3 [kg/s], or forces.wind");
    }
    if (limit != NULL && stop != NULL) {
        weft__report_exclusive(reader->report, limit, stop);
    } else if (limit != NULL && reader->scene->run.interpolate) {
        ERROR_AT(reader, limit,
                 "limit excludes run.frames: interpolate: it changes states "
                 "at the ends of steps");
    } else if (reader->scene->run.stop.quantity == WEFT_STOP_GAP
               && !weft__def_has_gaps(&reader->scene->cloth)) {
        WARNING_AT(reader, stop,
                   "stop has no effect: min_gap is the gap to shapes, and "
                   "the scene has none");
    }
}

/* ---- bands ---------------------------------------------------------------------- */

weft__mark weft__place_in(const weft__match *root, const char *section, const char *key)
{
    const weft__found *found = weft__found_in(root, section);
    const weft__node *value
        = key == NULL ? found->key : weft__value_of(found->value, key);
    return (value == NULL ? found->value : value)->at;
}

void weft__check_bands(weft__reader *reader, const weft__match *root)
{
    const weft_scene *scene = reader->scene;
    const size_t bands = reader->def->bands;
    const size_t rows = weft_cloth_def_blocks(&scene->cloth);
    const char *cloth = scene->part_count > 0 ? "cloths" : "cloth";
    const struct {
        bool wrong;
        const char *section, *key, *message;
    } rules[] = {
        { scene->meshed && scene->obj.def.grids != NULL, cloth, NULL,
          "a grid among several cloths does not run in bands" },
        { scene->meshed && scene->obj.def.arc, cloth, "membrane",
          "membrane arc does not run in bands" },
        { scene->limit.method != WEFT_LIMIT_NONE, "limit", NULL,
          "a strain limit does not run in bands: it shortens springs one after "
          "another, from row to row" },
        { scene->cloth.untangle > 0.0, "contact", "untangle",
          "untangle does not run in bands: it moves the whole cloth" },
    };
    if (rows / bands < WEFT_GHOST_ROWS) {
        weft__report_error(reader->report,
                           weft__place_in(root, cloth, scene->meshed ? "mesh" : "grid"),
                           "%zu %s are too few for %zu bands: each needs %d", rows,
                           scene->meshed ? "blocks of 512 vertices" : "rows", bands,
                           WEFT_GHOST_ROWS);
    }
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].wrong) {
            weft__report_error(reader->report,
                               weft__place_in(root, rules[i].section, rules[i].key),
                               "%s", rules[i].message);
        }
    }
    const weft__lack lack = { "does not run in bands", "do", "does",
                              "run it in one process, with threads" };
    weft__require_flag(reader, WEFT_STEPPER_DISTRIBUTED,
                       weft__place_in(root, "stepper", "method"), &lack);
}
