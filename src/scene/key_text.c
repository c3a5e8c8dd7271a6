/* SPDX-License-Identifier: BSD-3-Clause */
/* key_text.c -- keys and sections as words: types, units, names, and hints for a key
 * that is not in the table. */
#include <string.h>

#include "base/suggest.h"
#include "scene/keys.h"

static size_t key_text_put(char *out, size_t used, size_t size, const char *text)
{
    const int added = used < size ? snprintf(out + used, size - used, "%s", text) : 0;
    return used + (size_t)added;
}

/* "a, b or c" */
static void names_text(const weft__key *key, const char *before_last, char *out,
                       size_t size)
{
    size_t used = 0;
    for (size_t i = 0; key->names[i] != NULL; ++i) {
        const char *join = i == 0 ? "" : key->names[i + 1] == NULL ? before_last : ", ";
        used = key_text_put(out, used, size, join);
        used = key_text_put(out, used, size, key->names[i]);
    }
}

const char *weft__key_names(const weft__section *section, char *out, size_t size)
{
    size_t used = 0;
    for (size_t i = 0; i < section->count; ++i) {
        used = key_text_put(out, used, size, i == 0 ? "" : ", ");
        used = key_text_put(out, used, size, section->keys[i].name);
    }
    return out;
}

const char *weft__unit_of(const weft__key *key)
{
    return key->unit == NULL && key->number != NULL ? key->number->unit : key->unit;
}

weft__words weft__unit_text(const weft__key *key)
{
    const char *unit = weft__unit_of(key);
    weft__words out = { "" };
    if (unit != NULL) {
        (void)snprintf(out.text, sizeof out.text, " [%s]", unit);
    }
    return out;
}

const char *weft__wanted(const weft__key *key, bool unit, bool bare, char *out,
                         size_t size)
{
    static const char *const texts[WEFT__KINDS]
        = { [WEFT__FRACTION] = "a number or a fraction as 19/32",
            [WEFT__SWEEP] = "a mapping {key.path: [values]}",
#define TEXT(kind, reader, text) [WEFT__##kind] = (text),
            WEFT__KIND_LIST(TEXT)
#undef TEXT
          };
    const char *more = key->kind == WEFT__PAIR || key->kind == WEFT__WARP_WEFT
                           ? " or a pair"
                       : key->kind == WEFT__ATOL ? " or a mapping"
                                                 : "";
    const char *range = "";
    char bounds[80], names[100] = "";
    if (key->kind == WEFT__CHOICE || key->kind == WEFT__EITHER) {
        names_text(key, " or ", out, size);
        return out;
    }
    if (key->number != NULL) {
        range = weft__range_text(key->number, bare, bounds, sizeof bounds);
    }
    if (key->kind == WEFT__NAMES) {
        names_text(key, ", ", names, sizeof names);
    } else if (key->kind == WEFT__ITEMS) {
        (void)key_text_put(names, 0, sizeof names, key->name);
    }
    const char *text = texts[key->kind];
    text += bare && strncmp(text, "a ", 2) == 0 ? 2 : 0;
    text += bare && strncmp(text, "an ", 3) == 0 ? 3 : 0;
    (void)snprintf(out, size, "%s%s%s%s%s%s", text, range[0] == '\0' ? "" : " ", range,
                   more, names, unit ? weft__unit_text(key).text : "");
    return out;
}

/* ---- by name ---------------------------------------------------------------- */

const weft__key *weft__key_named(const weft__section *section, const char *name)
{
    for (size_t i = 0; i < section->count; ++i) {
        if (strcmp(section->keys[i].name, name) == 0) {
            return &section->keys[i];
        }
    }
    return NULL;
}

/* The first section below `from`, other than `other`, that has a key of that name; its
 * path, as ".cloth.grid", is written to out[size]. */
static bool find_elsewhere(const weft__section *root, const weft__section *from,
                           const weft__section *other, const char *name, char *out,
                           size_t size)
{
    if (from != other && from != root && weft__key_named(from, name) != NULL) {
        return true;
    }
    for (size_t i = 0; i < from->count; ++i) {
        const weft__key *key = &from->keys[i];
        const size_t length = strlen(key->name) + 1;
        if (key->kind == WEFT__MAPPING && length < size) {
            (void)snprintf(out, size, ".%s", key->name);
            if (find_elsewhere(root, key->section, other, name, out + length,
                               size - length)) {
                return true;
            }
        }
    }
    return false;
}

/* What other programs and textbooks call a key, and its path. */
static const char *other_name(const char *name)
{
    static const struct {
        const char *names, *path;
    } keys[] = {
        { " dt timestep time_step step_size delta_t ", "stepper.fixed_step" },
        { " substeps sub_steps ", "stepper.fixed_step" },
        { " tol abstol tolerance epsilon ", "stepper.atol" },
        { " reltol relative_tolerance ", "stepper.rtol" },
        { " integrator scheme ", "stepper.method" },
        { " end_time t_end tend tmax t_max stop_time final_time ", "run.duration" },
        { " framerate frame_rate output_rate frequency_of_output ", "run.fps" },
        { " num_threads nthreads cores ", "run.threads" },
        { " air_drag air_damping air_resistance viscosity ", "forces.damping" },
        { " g gravitation ", "forces.gravity" },
        { " rho area_density mass_per_area gsm ", "cloth.density" },
        { " pinned fixed fixed_points anchors attachments ", "cloth.pins" },
        { " ks k_stretch spring_constant ", "cloth.springs.stretch.stiffness" },
        { " kd k_damping ", "cloth.springs.stretch.damping" },
        { " collision_margin margin collision_thickness ", "contact.thickness" },
        { " self_collision self_collisions self_contact ", "contact.self" },
        { " colliders obstacles collision_objects ", "contact.shapes" },
    };
    char whole[32];
    if ((size_t)snprintf(whole, sizeof whole, " %s ", name) >= sizeof whole) {
        return NULL;
    }
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        if (strstr(keys[i].names, whole) != NULL) {
            return keys[i].path;
        }
    }
    return NULL;
}

const char *weft__unknown_hint(const weft__section *root, const weft__section *section,
                               const char *title, const char *name, char *out,
                               size_t size)
{
    weft__guess guess = { 0 };
    char path[120], names[240], elsewhere[160] = "";
    for (size_t i = 0; i < section->count; ++i) {
        weft__guess_try(&guess, name, section->keys[i].name);
    }
    if (guess.name != NULL) {
        (void)weft__guess_text(&guess, out, size);
        return guess.name;
    }
    if (other_name(name) != NULL) {
        (void)snprintf(elsewhere, sizeof elsewhere, " (in weft it is %s)",
                       other_name(name));
    } else if (find_elsewhere(root, root, section, name, path, sizeof path)) {
        (void)snprintf(elsewhere, sizeof elsewhere, " (it is a key of %s)", path + 1);
    }
    const int used = snprintf(out, size, "%s; %s has %s", elsewhere, title,
                              weft__key_names(section, names, sizeof names));
    if (section->beside != NULL && section->beside == section->keys[0].section
        && (size_t)used < size) {
        (void)snprintf(out + used, size - (size_t)used, "; %s has %s",
                       section->beside->title,
                       weft__key_names(section->beside, names, sizeof names));
    }
    return NULL;
}
