/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_bands.c -- what of a scene does not run in bands (weft/comm.h). */
#include <string.h>

#include "scene/read.h"

/* The value of section.key, or what of the section is there; key NULL: its name. */
static weft__mark place(const weft__match *root, const char *section, const char *key)
{
    const weft__found *found = weft__found_in(root, section);
    const weft__node *value
        = key == NULL ? found->key : weft__value_of(found->value, key);
    return (value == NULL ? found->value : value)->at;
}

void weft__check_bands(weft__reader *reader, const weft__match *root)
{
    const weft_scene *scene = reader->scene;
    const size_t bands = reader->def->bands, rows = scene->cloth.rows;
    const struct {
        bool wrong;
        const char *section, *key, *message;
    } rules[] = {
        { scene->meshed, "cloth", "mesh",
          "a mesh of triangles does not run in bands, which are rows of a grid" },
        { scene->limit.method != WEFT_LIMIT_NONE, "limit", NULL,
          "a strain limit does not run in bands: it corrects springs one after "
          "another, from row to row" },
        { scene->record.ledger, "record", "ledger",
          "the energy ledger is not kept in bands" },
        { scene->config.norm != WEFT_NORM_MAX && !(scene->config.fixed_step > 0.0),
          "stepper", "norm",
          "norm rms does not run in bands: its sum would depend on their number; norm "
          "max does" },
        { scene->cloth.contact.self, "contact", "self",
          "contact of the cloth with itself does not run in bands: any two rows may "
          "touch" },
        { scene->run.stop.quantity != WEFT_STOP_NEVER, "stop", NULL,
          "a run in bands ends at run.duration: the condition is one of the whole "
          "cloth" },
    };
    if (!scene->meshed && rows / bands < WEFT_GHOST_ROWS) {
        weft__report_error(reader->report, place(root, "cloth", "grid"),
                           "%zu rows are too few for %zu bands: each needs %d", rows,
                           bands, WEFT_GHOST_ROWS);
    }
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].wrong) {
            weft__report_error(reader->report,
                               place(root, rules[i].section, rules[i].key), "%s",
                               rules[i].message);
        }
    }
    weft__require_flag(reader, WEFT_STEPPER_AGREES, place(root, "stepper", "method"),
                       "does not run in bands", "these do");
}
