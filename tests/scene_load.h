/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_load.h -- scenes loaded by the tests, with plugins that only have names. */
#pragma once

#include <string.h>

#include "support.h"

/* The i-th fake plugin; NULL past the last. */
static inline const weft_plugin *fake_plugin(size_t i)
{
    static const weft_stepper_type rk4 = { .name = "rk4" };
    static const weft_stepper_type rkf45
        = { .name = "rkf45", .flags = WEFT_STEPPER_QUADRATURES };
    static const weft_stepper_type rk8pd = { .name = "rk8pd" };
    static const weft_stepper_type verlet
        = { .name = "velocity_verlet", .flags = WEFT_STEPPER_FIXED_ONLY };
    static const weft_stepper_type custom
        = { .name = "custom", .flags = WEFT_STEPPER_BUTCHER };
    static const weft_stepper_type cash_karp
        = { .name = "cash_karp", .flags = WEFT_STEPPER_CONTROLLER };
    static const weft_stepper_type ros2
        = { .name = "ros2", .flags = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_LINEAR };
    static const weft_stepper_type bdf
        = { .name = "bdf", .flags = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_MULTISTEP };
    static const weft_stepper_type *const cvode_types[] = { &bdf, NULL };
    static const weft_stepper_type *const stiff_types[] = { &ros2, NULL };
    static const weft_stepper_type *const gsl_types[] = { &rk4, &rkf45, &rk8pd, NULL };
    static const weft_stepper_type *const verlet_types[] = { &verlet, NULL };
    static const weft_stepper_type *const arkode_types[]
        = { &custom, &cash_karp, NULL };
    static const weft_plugin plugins[] = {
        { .id = "gsl", .types = gsl_types },
        { .id = "verlet", .types = verlet_types },
        { .id = "arkode", .types = arkode_types },
        { .id = "stiff", .types = stiff_types },
        { .id = "cvode", .types = cvode_types },
    };
    return i < sizeof plugins / sizeof plugins[0] ? &plugins[i] : NULL;
}

static inline const weft_plugin *find_fake(void *ctx, const char *id, weft_error *err)
{
    (void)ctx;
    for (size_t i = 0; fake_plugin(i) != NULL; ++i) {
        if (strcmp(fake_plugin(i)->id, id) == 0) {
            return fake_plugin(i);
        }
    }
    weft_error_set(err, WEFT_BAD_PLUGIN, "plugin '%s' not found: no weft-%s.so here",
                   id, id);
    return NULL;
}

/* What was found in the last scene loaded; a test runs alone in its process. */
static weft_diagnostics found;

static inline weft_scene_def scene_of_text(const char *text)
{
    weft_scene_def def = weft_scene_def_default();
    def.file = "scene.yaml";
    def.text = text;
    def.length = strlen(text);
    def.find_plugin = find_fake;
    return def;
}

/* All that was found, as it is printed, a line break after each. */
static inline const char *all_found(void)
{
    static char text[64 * 1024];
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < found.count; ++i) {
        used += (size_t)weft_diagnostic_format(&found.items[i], text + used,
                                               sizeof text - used);
        used += (size_t)snprintf(text + used, sizeof text - used, "\n");
    }
    return text;
}

/* A scene that must load, whatever the warnings; ends the test if it does not. */
static inline weft_scene *good_scene(const weft_scene_def *def)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    const weft_status status = weft_scene_load(def, &scene, &found, &err);
    ck_assert_msg(status == WEFT_OK, "%s\n%s", err.message, all_found());
    ck_assert_uint_eq(found.errors, 0);
    return scene;
}

static inline weft_scene *good_text(const char *text)
{
    const weft_scene_def def = scene_of_text(text);
    return good_scene(&def);
}

/* A text that must not load; returns all_found(). */
static inline const char *bad_scene(const weft_scene_def *def)
{
    weft_error err = { 0 };
    weft_scene *scene = NULL;
    const weft_status status = weft_scene_load(def, &scene, &found, &err);
    ck_assert_msg(status == WEFT_BAD_SCENE, "status %d", (int)status);
    ck_assert_ptr_null(scene);
    ck_assert_uint_gt(found.errors, 0);
    return all_found();
}
