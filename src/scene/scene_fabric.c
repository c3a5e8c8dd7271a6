/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_fabric.c -- the fabric of a scene, and its bending rigidity. */
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "scene/checks.h"

static const double pi = 3.14159265358979323846;

/* The names are those of the library's table. */
void weft__read_preset(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    enum { MOST = 64 };
    const char *names[MOST + 1] = { NULL };
    size_t count, index;
    const weft_fabric *presets = weft_fabric_presets(&count);
    weft__key named = *key;
    named.names = names;
    for (size_t i = 0; i < count && i < MOST; ++i) {
        names[i] = presets[i].name;
    }
    if (weft__find_name(reader, &named, node, &index)) {
        *(weft_fabric *)to = presets[index];
    }
}

/* What a sheet measures, in SI units: 1 gf/cm = 0.980665 N/m. The secant of an
 * extension in per cent; FAST's shear rigidity 123 / EB5, its bending rigidity W g C^3.
 */
void weft__read_sheet(weft__reader *reader, const weft__key *key,
                      const weft__node *node, void *to)
{
    static const struct {
        double density, stretch, shear, bend;
    } units[]
        = { [WEFT__KES] = { 1e-2, 500 * 98.0665, 180 * 0.980665 / pi, 9.80665e-5 },
            [WEFT__FAST] = { 1e-3, 100 * 98.0665, 123.0, 9.81e-12 } };
    const size_t mistakes = reader->report->mistakes;
    weft_fabric *fabric = to;
    weft__sheet sheet = { .weight = 0.0 };
    weft__read_mapping(reader, key, node, &sheet);
    if (reader->report->mistakes > mistakes) {
        return;
    }
    fabric->density = units[key->first].density * sheet.weight;
    for (size_t i = 0; i < 2; ++i) {
        const double b = sheet.bend[i];
        fabric->stretch[i] = units[key->first].stretch / sheet.extension[i];
        fabric->bend[i] = units[key->first].bend
                          * (key->first == WEFT__KES ? b : sheet.weight * b * b * b);
    }
    const double mean = 0.5 * (sheet.shear[0] + sheet.shear[1]);
    fabric->shear
        = units[key->first].shear * (key->first == WEFT__KES ? mean : 1.0 / mean);
}

/* A sheet, of which there may be one, instead of a preset. Whether there is one. */
static bool check_sheets(weft__reader *reader, const weft__match *match)
{
    static const char *const sources[] = { "preset", "kes", "fast", "arcsim", NULL };
    (void)weft__check_exclusive(reader, match, sources);
    const weft__node *sheet = weft__key_in(match, "kes");
    sheet = sheet == NULL ? weft__key_in(match, "fast") : sheet;
    const weft__node *material = weft__key_in(match, "arcsim");
    if (material != NULL) {
        static const char *const fitted[]
            = { "arcsim", "density", "stretch", "shear", "coupling", "bend", NULL };
        (void)weft__check_exclusive(reader, match, fitted);
    }
    if (sheet != NULL) {
        const char *const one[]
            = { sheet->text, "density", "stretch", "shear", "bend", NULL };
        (void)weft__check_exclusive(reader, match, one);
    }
    return sheet != NULL || material != NULL;
}

void weft__check_fabric(weft__reader *reader, const weft__match *match, void *base)
{
    static const char *const needed[] = { "density", "stretch" };
    weft_fabric *fabric = base;
    const bool sheet = check_sheets(reader, match);
    if (weft__key_in(match, "coupling") == NULL && weft__key_in(match, "preset") == NULL
        && weft__key_in(match, "arcsim") == NULL) {
        fabric->coupling = fabric->shear;
    }
    if (weft__key_in(match, "preset") != NULL) {
        return;
    }
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; ++i) {
        const weft__key *key = weft__key_named(match->section, needed[i]);
        if (!sheet && weft__lacks(match, needed[i]) && weft__lacks(match, "preset")) {
            ERROR_AT(reader, match->map,
                     "%s lacks '%s'%s, which is required without 'preset', 'kes', "
                     "'fast' or 'arcsim'",
                     match->title, needed[i], weft__unit_text(key).text);
        }
    }
    if (weft__key_in(match, "twist") == NULL && weft__key_in(match, "arcsim") == NULL) {
        fabric->twist = -1.0; /* the default */
    }
}

void weft__make_fabric(weft__reader *reader, const weft__match *cloth)
{
    static const char *const one[] = { "fabric", "mass", "density", "springs", NULL };
    const weft__found *fabric = weft__found_in(cloth, "fabric");
    const weft__found *grid = weft__found_in(cloth, "grid");
    weft_error err;
    (void)weft__check_exclusive(reader, cloth, one);
    if (fabric->wrong || grid->wrong || grid->value == NULL) {
        return;
    }
    if (weft_fabric_apply(&reader->scene->fabric, &reader->scene->cloth, &err)
        != WEFT_OK) {
        ERROR_AT(reader, weft__later(fabric->key, grid->key), "%s", err.message);
    }
}

/* With rigidity, damping is its time. */
void weft__check_bend(weft__reader *reader, const weft__match *match, void *base)
{
    weft_cloth_def *cloth = base;
    weft_spring_def *springs = &cloth->springs[WEFT_BEND];
    weft_spring_def *across = &cloth->across[WEFT_BEND];
    const weft__node *twist = weft__key_in(match, "twist");
    const weft__found *damping = weft__found_in(match, "damping");
    springs->present = weft__key_in(match, "stiffness") != NULL;
    if (weft__key_in(match, "rigidity") == NULL) {
        if (twist != NULL) {
            ERROR_AT(reader, twist, "twist has no effect without rigidity [N m]");
        }
        return;
    }
    if (twist == NULL) {
        cloth->bending.twist = -1.0; /* the default */
    }
    if (springs->damping != across->damping) {
        ERROR_AT(reader, damping->value,
                 "damping of a rigidity must be one number [s], not a pair");
    }
    cloth->bending.damping = springs->damping;
    springs->damping = across->damping = 0.0;
}
