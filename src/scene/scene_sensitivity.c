/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_sensitivity.c -- the parameters with respect to which a scene is
 * differentiated, what of it has no derivative, and the cloths with less and more of
 * each. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sized.h"
#include "base/suggest.h"
#include "scene/checks.h"

enum { KEY_LENGTH = 96 }; /* with what results put before it, the name of a column */

/* Of a parameter, to less and to more of it: what is linear in it has 5e-10 of
 * roundoff, and the difference of a length a thousand times the thickness an error of
 * 1e-8. */
#define STEP 0x1p-22

/* ---- keys ------------------------------------------------------------------------ */

static bool is_smooth(const weft__key *key)
{
    return key->kind == WEFT__NUMBER || key->kind == WEFT__VECTOR
           || key->kind == WEFT__PAIR || key->kind == WEFT__WARP_WEFT
           || key->kind == WEFT__TRACK;
}

/* The next part of a path to name[KEY_LENGTH]; NULL: there is none. */
static const char *next_part(const char *at, char *name)
{
    at += strspn(at, ".[]");
    const size_t length = strcspn(at, ".[]");
    memcpy(name, at, length);
    name[length] = '\0';
    return length > 0 ? at + length : NULL;
}

/* What a path leads to. */
typedef struct led_to {
    const weft__key *key;   /* its entry of the table; NULL: none */
    const weft__node *node; /* NULL: there is no such value */
    weft__node plain;
    const char *text;  /* a default, or what a preset has, */
    size_t by_default; /* of the first bytes of the path */
    weft__guess guess; /* for the first part that is no key */
} led_to;

/* What a key has that is not in its mapping; NULL: nothing. */
static const char *text_of(const weft__reader *reader, const weft__key *key,
                           const weft__node *mapping)
{
    const weft__node *name = mapping != NULL ? weft__value_of(mapping, "preset") : NULL;
    const char *called = name != NULL ? weft__text_of(name) : NULL;
    const weft_fabric *preset = called != NULL ? weft_fabric_find(called) : NULL;
    if (preset == NULL || !is_smooth(key)) {
        return key->fallback;
    }
    const double *of = (const void *)((const char *)preset + weft__offset_of(key));
    const bool pair = key->kind == WEFT__PAIR;
    char text[64];
    const int length
        = weft_text_format(text, sizeof text, pair ? "[%.17g, %.17g]" : "%.17g", of[0],
                           pair ? of[1] : 0.0);
    return weft__tree_text(reader->tree, text, (size_t)length);
}

static void find_value(const weft__reader *reader, const char *path, led_to *of)
{
    const weft__section *section = reader->root;
    const weft__node *node = reader->tree->root;
    const char *at = path;
    char name[KEY_LENGTH];
    bool lost = false;
    *of = (led_to){ .key = NULL };
    while ((at = next_part(at, name)) != NULL) {
        if (node == NULL || node->type == WEFT__MAP) {
            of->key = weft__key_named(section, name);
            for (size_t i = 0; of->key == NULL && !lost && i < section->count; ++i) {
                weft__guess_try(&of->guess, name, section->keys[i].name);
            }
            lost = lost || of->key == NULL;
            section = of->key != NULL && of->key->section != NULL ? of->key->section
                                                                  : section;
            const weft__node *mapping = node;
            node = node != NULL ? weft__value_of(node, name) : NULL;
            of->text = node == NULL && of->key != NULL
                           ? text_of(reader, of->key, mapping)
                           : NULL;
            if (of->text != NULL) {
                node = weft__fallback_node(reader->tree, of->text, &of->plain);
                of->by_default = (size_t)(at - path);
            }
        } else {
            const size_t i = strspn(name, "0123456789") == strlen(name)
                                 ? strtoul(name, NULL, 10)
                                 : SIZE_MAX;
            node = i < weft__item_count(node) ? weft__item(node, i) : NULL;
        }
    }
    of->node = node;
}

static bool begins(const char *path, const char *section)
{
    const size_t length = strlen(section);
    return strncmp(path, section, length) == 0 && strchr(".[", path[length]) != NULL;
}

/* What is wrong with a path; NULL: nothing. */
static const char *fault_of(const led_to *of, const char *path, double *value)
{
    return !begins(path, "cloth") && !begins(path, "cloths") && !begins(path, "forces")
                   && !begins(path, "contact")
               ? "is no parameter of cloth, forces or contact"
           : of->node == NULL ? "is not in this scene, nor a default"
           : of->node->type == WEFT__LIST && of->key != NULL && is_smooth(of->key)
               ? "is a list: add the index of an entry, for example .0"
           : of->key == NULL || !is_smooth(of->key) || !weft__number_of(of->node, value)
                   || !isfinite(*value)
               ? "has no derivative: give a number that changes the motion smoothly, "
                 "for "
                 "example forces.gravity.1"
           : strstr(path, ".cut.") != NULL ? "makes another mesh: it has no derivative"
                                           : NULL;
}

void weft__read_keys(weft__reader *reader, const weft__key *key, const weft__node *node,
                     void *to)
{
    weft_scene_sensitivity *of = &reader->scene->sensitivity;
    const size_t count = weft__item_count(node);
    (void)to;
    if (count == 0 || count > WEFT_SENSITIVITIES) {
        weft__refuse_value(reader, key, node);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        const weft__node *item = weft__item(node, i);
        const char *path = weft__text_of(item);
        if (path == NULL || strlen(path) >= KEY_LENGTH) {
            ERROR_AT(reader, item, "a key as forces.gravity.1 must be here, not %s",
                     weft__show(item).text);
            continue;
        }
        led_to at;
        find_value(reader, path, &at);
        const char *fault = fault_of(&at, path, &of->values[i]);
        for (size_t k = 0; k < i && fault == NULL; ++k) {
            fault = of->keys[k] != NULL && strcmp(of->keys[k], path) == 0
                        ? "stands here twice"
                        : NULL;
        }
        if (fault != NULL) {
            char near[80];
            ERROR_AT(reader, item, "%s %s%s", path, fault,
                     weft__guess_text(&at.guess, near, sizeof near));
        }
        of->keys[i] = weft__tree_text(reader->tree, path, strlen(path));
        if (fault == NULL && at.by_default > 0) {
            char set[KEY_LENGTH + 64];
            const int length = weft_text_format(set, sizeof set, "%.*s=%s",
                                                (int)at.by_default, path, at.text);
            of->before[i] = weft__tree_text(reader->tree, set, (size_t)length);
        }
    }
    of->count = count;
}

void weft__check_sensitivity(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_scene_sensitivity *of = base;
    const weft__node *list = weft__value_in(match, "of");
    for (size_t i = 0; of->relative && reader->report->mistakes == 0 && i < of->count;
         ++i) {
        if (of->values[i] == 0.0) {
            ERROR_AT(reader, weft__item(list, i),
                     "%s is 0, which has no logarithm; use scale: none", of->keys[i]);
        }
    }
}

void weft__check_smooth(weft__reader *reader, const weft__match *root)
{
    const weft_scene *scene = reader->scene;
    const uint32_t flags = scene->type != NULL ? scene->type->flags : 0;
    const bool adaptive = !(scene->config.fixed_step > 0.0);
    const struct {
        bool wrong;
        const char *section, *key, *message;
    } rules[] = {
        { scene->limit.method != WEFT_LIMIT_NONE, "limit", NULL,
          "limit: it is no differentiable map" },
        { scene->run.stop.quantity != WEFT_STOP_NEVER, "stop", NULL,
          "stop: its time depends on the numbers too" },
        { scene->run.interpolate, "run", "frames",
          "run.frames: interpolate: s is known at the ends of steps" },
        { scene->record.ledger, "record", "ledger",
          "record.ledger: a method integrates energies or derivatives with the state" },
        { scene->cloth.untangle > 0.0, "contact", "untangle",
          "contact.untangle: such a start has no derivative" },
        { !scene->sensitivity.control && adaptive
              && scene->config.norm != WEFT_NORM_MAX,
          "stepper", "norm",
          "the rms norm, unless sensitivity.control is true: it is a mean over s too" },
        { (flags & (uint32_t)WEFT_STEPPER_MULTISTEP) != 0, "stepper", "method",
          "methods that keep a history of steps: choose a one-step method" },
        { (flags & (uint32_t)WEFT_STEPPER_LINEAR) != 0 && scene->cloth.mesh != NULL,
          "stepper", "method",
          "implicit methods on triangles: choose an explicit one-step method" },
        { reader->def->bands > 1, "sensitivity", NULL,
          "a run in bands: run it in one process, with threads" },
        { scene->cloth.mesh != NULL && scene->cloth.mesh->grids != NULL, "cloths", NULL,
          "a grid among several cloths: derivatives ride along with one grid, or with "
          "meshes" },
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; ++i) {
        if (rules[i].wrong) {
            weft__report_error(reader->report,
                               weft__place_in(root, rules[i].section, rules[i].key),
                               "sensitivity excludes %s", rules[i].message);
        }
    }
}

/* ---- perturbed copies
 * ---------------------------------------------------------------- */

typedef struct perturbed_copy {
    weft_scene *scene;
    weft_cloth *cloth;
} perturbed_copy;

struct weft_scene_perturbed {
    weft_allocator memory;
    weft_sensitivity_def def;
    weft_parameter parameters[WEFT_SENSITIVITIES];
    perturbed_copy of[WEFT_SENSITIVITIES][2];
};

const weft_sensitivity_def *
weft_scene_perturbed_def(const weft_scene_perturbed *perturbed)
{
    return perturbed != NULL && perturbed->def.count > 0 ? &perturbed->def : NULL;
}

void weft_scene_perturbed_destroy(weft_scene_perturbed *perturbed)
{
    if (perturbed != NULL) {
        const weft_allocator memory = perturbed->memory;
        for (size_t i = 0; i < 2 * WEFT_SENSITIVITIES; ++i) {
            weft_cloth_destroy(perturbed->of[i / 2][i % 2].cloth);
            weft_scene_destroy(perturbed->of[i / 2][i % 2].scene);
        }
        weft__free(&memory, perturbed);
    }
}

/* The scene with another value of a key. */
static weft_status load_perturbed(const weft_scene *scene, const weft_scene_def *given,
                                  size_t i, double value, perturbed_copy *out,
                                  weft_error *err)
{
    const char *key = scene->sensitivity.keys[i],
               *before = scene->sensitivity.before[i];
    char set[KEY_LENGTH + 32];
    const char *const sets[] = { set }, *const both[] = { before, set };
    weft_scene_def def = weft_scene_def_default();
    const weft_status taken
        = WEFT__DEF_READ(weft_scene_def, &def, given, WEFT__DEF_MOST, err);
    weft_diagnostics *found = weft__zeroed(&scene->memory, 1, sizeof *found);
    if (taken != WEFT_OK || found == NULL) {
        weft__free(&scene->memory, found);
        return found == NULL
                   ? weft_error_set(err, WEFT_NO_MEMORY, "no memory for sensitivities")
                   : taken;
    }
    (void)weft_text_format(set, sizeof set, "%s=%.*g", key, weft_text_digits(value),
                           value);
    def.file = scene->file;
    def.text = scene->text;
    def.length = strlen(scene->text);
    def.sets = before != NULL ? both : sets;
    def.set_count = before != NULL ? 2 : 1;
    weft_status status = weft_scene_load(&def, &out->scene, found, err);
    if (status == WEFT_BAD_SCENE) {
        (void)weft_error_set(err, status, "%s=%.*g: %s", key, weft_text_digits(value),
                             value, found->items[0].message);
    }
    weft__free(&scene->memory, found);
    if (status == WEFT_OK && !weft__same_shapes(scene, out->scene)) {
        return weft_error_set(err, WEFT_UNSUPPORTED,
                              "%s=%.17g makes another number of triangles of a shape: "
                              "another `triangles` [m] of it avoids that",
                              key, value);
    }
    return status == WEFT_OK
               ? weft_cloth_create(weft_scene_cloth(out->scene), &out->cloth, err)
               : status;
}

static weft_status make_pair(weft_scene_perturbed *of, const weft_scene *scene,
                             const weft_scene_def *def, size_t i, weft_error *err)
{
    const char *key = scene->sensitivity.keys[i];
    const double p = scene->sensitivity.values[i], u = p != 0.0 ? p : 1.0;
    double at[2] = { p - STEP * u, p + STEP * u };
    weft_status status = WEFT_OK, outside = WEFT_OK;
    for (size_t side = 0; status == WEFT_OK && side < 2; ++side) {
        perturbed_copy *one = &of->of[i][side];
        status = load_perturbed(scene, def, i, at[side], one, err);
        if (status == WEFT_BAD_SCENE || status == WEFT_INVALID) { /* out of range */
            outside = status;
            weft_scene_destroy(one->scene);
            *one = (perturbed_copy){ NULL, NULL };
            at[side] = p;
            status = load_perturbed(scene, def, i, p, one, err);
        }
    }
    of->parameters[i] = (weft_parameter){ key, of->of[i][0].cloth, of->of[i][1].cloth,
                                          (at[1] - at[0]) / u };
    return status == WEFT_OK && at[0] == at[1] ? outside : status;
}

weft_status weft_scene_perturbed_create(const weft_scene *scene,
                                        const weft_scene_def *def,
                                        weft_scene_perturbed **out, weft_error *err)
{
    weft_scene_perturbed *of = weft__zeroed(&scene->memory, 1, sizeof *of);
    *out = of;
    if (of == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for sensitivities");
    }
    of->memory = scene->memory;
    of->def = (weft_sensitivity_def){ scene->sensitivity.count, of->parameters,
                                      scene->sensitivity.control };
    weft_status status = WEFT_OK;
    for (size_t i = 0; status == WEFT_OK && i < of->def.count; ++i) {
        status = make_pair(of, scene, def, i, err);
    }
    if (status != WEFT_OK) {
        weft_scene_perturbed_destroy(of);
        *out = NULL;
    }
    return status;
}
