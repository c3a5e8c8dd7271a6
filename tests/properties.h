/* SPDX-License-Identifier: BSD-3-Clause */
/* properties.h -- the scenes of tests/properties and simulations of them. Comments of a
 * scene say which properties it does not have (`# not bands: why`), how it becomes
 * large enough for several threads and bands (`# large: KEY=VALUE ...`), and a fixed
 * step at which the order of a method shows (`# step: 1.0e-3`, [s]); if differences by
 * parameters need less than 1e-4 of them, how much (`# span: 1.0e-5`). */
#pragma once

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bands_run.h"
#include "program/cut/cut.h"

enum { SCENES = 32, NAME = 64, SETS = 12, SCENE_TEXT = 8192 };

/* The names of the scenes, without .yaml, in alphabetic order. */
static char scene_names[SCENES][NAME];

static inline int scene_compare(const void *a, const void *b)
{
    return strcmp(a, b);
}

static inline size_t find_scenes(void)
{
    DIR *folder = opendir("tests/properties");
    size_t count = 0;
    for (const struct dirent *of; folder != NULL && (of = readdir(folder)) != NULL;) {
        const char *end = strstr(of->d_name, ".yaml");
        if (end != NULL && count < SCENES && end < of->d_name + NAME) {
            memcpy(scene_names[count++], of->d_name, (size_t)(end - of->d_name));
        }
    }
    if (folder != NULL) {
        (void)closedir(folder);
    }
    qsort(scene_names, count, NAME, scene_compare);
    return count;
}

/* What a scene says behind `# KEY: ` in its comments; "" if it does not. */
static inline const char *scene_says(const char *text, const char *key)
{
    static char value[512];
    char line[NAME + 8];
    (void)snprintf(line, sizeof line, "\n# %s: ", key);
    const char *at = strstr(text, line);
    const size_t length = at == NULL ? 0 : strcspn(at + strlen(line), "\n");
    ck_assert_uint_lt(length, sizeof value);
    memcpy(value, at == NULL ? "" : at + strlen(line), length);
    value[length] = '\0';
    return value;
}

typedef struct subject {
    char text[SCENE_TEXT]; /* of the scene's file */
    double step, span;     /* [s] where the order shows; of parameters */
    weft_scene *scene;
    weft_scene_perturbed *perturbed;
    weft_cloth *cloth;
    weft_sim_def run; /* without sensitivity */
    weft_sim *sim;    /* NULL: not begun */
} subject;

static inline const weft_plugin *find_linked(void *ctx, const char *id, weft_error *err)
{
    (void)ctx, (void)err;
    size_t i = 0;
    while (test_plugin(i) != NULL && strcmp(test_plugin(i)->id, id) != 0) {
        ++i;
    }
    return test_plugin(i);
}

static inline void read_scene(const char *name, char text[SCENE_TEXT])
{
    char path[NAME + 32];
    (void)snprintf(path, sizeof path, "tests/properties/%s.yaml", name);
    FILE *file = fopen(path, "r");
    ck_assert_msg(file != NULL, "%s", path);
    text[fread(text, 1, SCENE_TEXT - 1, file)] = '\0';
    (void)fclose(file);
}

static inline weft_sim_def run_of(const weft_scene *scene, const weft_cloth *cloth)
{
    weft_sim_def def = weft_sim_def_default();
    const weft_run_def *run = weft_scene_run(scene);
    def.cloth = cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    def.limit = *weft_scene_limit(scene);
    def.interpolate = run->interpolate;
    def.event = run->stop.quantity != WEFT_STOP_NEVER ? weft_stop_event : NULL;
    def.event_ctx = (void *)(uintptr_t)&run->stop;
    return def;
}

typedef enum variant {
    PLAIN,
    LARGE,
    WITH_PARAMETERS /* of its `sensitivity`, which others are without */
} variant;

/* A scene with so many overrides. */
static inline subject load(const char *name, variant kind, const char *const *more,
                           size_t count)
{
    static weft_diagnostics found;
    subject of = { .sim = NULL };
    char path[NAME + 32], sets_text[512], why[1024] = "", *rest = sets_text;
    const char *sets[SETS];
    weft_error err = { 0 };
    weft_scene_def def = weft_scene_def_default();
    read_scene(name, of.text);
    of.step = strtod(scene_says(of.text, "step"), NULL);
    of.span = strtod(scene_says(of.text, "span"), NULL);
    of.span = of.span > 0.0 ? of.span : 1e-4;
    (void)snprintf(sets_text, sizeof sets_text, "%s",
                   kind == LARGE ? scene_says(of.text, "large") : "");
    while ((sets[def.set_count] = strtok_r(NULL, " ", &rest)) != NULL) {
        ck_assert_uint_lt(++def.set_count, SETS);
    }
    ck_assert_uint_lt(def.set_count + count, SETS);
    for (size_t i = 0; i < count; ++i) {
        sets[def.set_count++] = more[i];
    }
    if (kind != WITH_PARAMETERS) {
        sets[def.set_count++] = "sensitivity=null";
    }
    (void)snprintf(path, sizeof path, "tests/properties/%s.yaml", name);
    def.file = path;
    def.sets = sets;
    def.find_plugin = find_linked;
#ifdef WEFT_QHULL
    def.mesh_cut = cut_mesh;
#endif
    if (weft_scene_load(&def, &of.scene, &found, &err) != WEFT_OK) {
        if (found.count > 0) {
            (void)weft_diagnostic_format(&found.items[0], why, sizeof why);
        }
        ck_abort_msg("%s%s", err.message, why);
    }
    of.cloth = test_cloth(weft_scene_cloth(of.scene));
    of.run = run_of(of.scene, of.cloth);
    ck_assert_msg(weft_scene_perturbed_create(of.scene, &def, &of.perturbed, &err)
                      == WEFT_OK,
                  "%s", err.message);
    return of;
}

static inline void begin(subject *of)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_create(&of->run, &of->sim, &err) == WEFT_OK, "%s",
                  err.message);
}

/* To a part of the duration. */
static inline void advance(const subject *of, double part)
{
    weft_error err = { 0 };
    const double t = part * weft_scene_run(of->scene)->duration;
    ck_assert_msg(weft_sim_advance(of->sim, t, &err) == WEFT_OK, "%s", err.message);
}

static inline void finish(subject *of)
{
    weft_sim_destroy(of->sim);
    weft_scene_perturbed_destroy(of->perturbed);
    weft_cloth_destroy(of->cloth);
    weft_scene_destroy(of->scene);
}

/* All that can be asked of a simulation, and hashes of its state and of what it saves,
 * which is the last thing to be done with it. */
static inline void describe(weft_sim *sim, char text[TEXT])
{
    weft_error err = { 0 };
    const size_t size = weft_sim_save_size(sim),
                 dim = weft_cloth_dim(weft_sim_cloth(sim));
    double *bytes = calloc(size / sizeof *bytes + 1, sizeof *bytes);
    put_frame(sim, text);
    put_hash(text, test_hash(weft_sim_state(sim), dim));
    ck_assert_msg(weft_sim_save(sim, bytes, size, &err) == WEFT_OK, "%s", err.message);
    put_hash(text, test_hash(bytes, size / sizeof *bytes + 1));
    free(bytes);
}
