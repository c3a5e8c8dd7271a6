/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_bands.c -- what of a scene does not run in bands (weft/comm.h). */
#include <string.h>

#include "scene/read.h"

/* The value of section.key, or what of the section is there. */
static weft__mark place(const weft__match *root, const char *section, const char *key)
{
    const weft__node *map = weft__value_in(root, section);
    const size_t slot
        = map->type == WEFT__MAP ? weft__find_key(map, key, strlen(key)) : map->count;
    return slot < map->count && map->entries[slot].value != NULL
               ? map->entries[slot].value->at
               : map->at;
}

void weft__check_bands(weft__reader *reader, const weft__match *root)
{
    const weft_scene *scene = reader->scene;
    const size_t bands = reader->def->bands, rows = scene->cloth.rows;
    if (scene->meshed) {
        weft__report_error(
            reader->report, place(root, "cloth", "mesh"),
            "a mesh of triangles does not run in bands, which are rows of "
            "a grid");
    } else if (rows / bands < WEFT_GHOST_ROWS) {
        weft__report_error(reader->report, place(root, "cloth", "grid"),
                           "%zu rows are too few for %zu bands: each needs %d", rows,
                           bands, WEFT_GHOST_ROWS);
    }
    if (scene->limit.method != WEFT_LIMIT_NONE) {
        weft__report_error(reader->report, weft__found_in(root, "limit")->key->at,
                           "a strain limit does not run in bands: it corrects springs "
                           "one after another, from row to row");
    }
    if (scene->record.ledger) {
        weft__report_error(reader->report, place(root, "record", "ledger"),
                           "the energy ledger is not kept in bands");
    }
    if (scene->config.norm != WEFT_NORM_MAX && !(scene->config.fixed_step > 0.0)) {
        weft__report_error(reader->report, place(root, "stepper", "norm"),
                           "norm rms does not run in bands: its sum would depend on "
                           "their number; norm max does");
    }
    if (scene->cloth.contact.self) {
        weft__report_error(
            reader->report, place(root, "contact", "self"),
            "contact of the cloth with itself does not run in bands: any "
            "two rows may touch");
    }
    if (scene->run.stop.quantity != WEFT_STOP_NEVER) {
        weft__report_error(
            reader->report, weft__found_in(root, "stop")->key->at,
            "a run in bands ends at run.duration: the condition is one of "
            "the whole cloth");
    }
    weft__require_flag(reader, WEFT_STEPPER_AGREES, place(root, "stepper", "method"),
                       "does not run in bands", "these do");
}
