/* SPDX-License-Identifier: BSD-3-Clause */
/* sweep.c -- any bytes as the text of a sweep, and the names of its runs. */
#include <limits.h>
#include <stdbool.h>

#include "fuzz/fuzz.h"
#include "program/batch/batch.h"

/* What a run's directory may be called, wherever it is made. */
static void check_name(const char *stem, const weft_sweep *sweep, size_t run)
{
    char *name = batch_name(stem, sweep, run);
    HOLDS(name != NULL && name[0] != '\0' && name[0] != '.' && name[0] != '-');
    HOLDS(strlen(name) <= 120 && strcmp(name, "summary.csv") != 0);
    for (const char *c = name; *c != '\0'; ++c) {
        HOLDS(*c > ' ' && *c < 127 && *c != '/');
    }
    free(name);
}

/* Each run has a scene that stands alone. */
static void check_run(const weft_sweep *sweep, size_t run)
{
    weft_scene *scene = NULL;
    for (size_t key = 0; key < weft_sweep_keys(sweep); ++key) {
        HOLDS(weft_sweep_key(sweep, key) != NULL);
        HOLDS(weft_sweep_value(sweep, key, run) != NULL);
    }
    check_name("scene", sweep, run);
    HOLDS(weft_sweep_scene(sweep, run, &scene, NULL) == WEFT_OK);
    weft_scene_def alone = scene_of_text(weft_scene_text(scene));
    weft_scene *again = fuzz_load(&alone);
    HOLDS(again != NULL);
    HOLDS(strcmp(weft_scene_name(again), weft_scene_name(scene)) == 0);
    weft_scene_destroy(again);
    weft_scene_destroy(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    weft_sweep *sweep = NULL;
    weft_scene *none = NULL;
    weft_error err = { 0 };
    char *text = malloc(size + 1);
    HOLDS(text != NULL);
    memcpy(text, data, size);
    weft_scene_def def = scene_of_text("");
    def.text = text;
    def.length = size;
    const weft_status status = weft_sweep_load(&def, &sweep, &found, &err);
    HOLDS(status == WEFT_OK || status == WEFT_BAD_SCENE);
    HOLDS((status == WEFT_OK) == (sweep != NULL));
    if (sweep != NULL) {
        const size_t runs = weft_sweep_runs(sweep);
        for (size_t run = 1; run <= runs && run <= 3; ++run) {
            check_run(sweep, run);
        }
        check_run(sweep, runs);
        HOLDS(weft_sweep_scene(sweep, runs + 1, &none, NULL) == WEFT_INVALID);
    } else {
        fuzz_check_items();
    }
    weft_sweep_destroy(sweep);
    free(text);
    return 0;
}
