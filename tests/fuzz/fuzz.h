/* SPDX-License-Identifier: BSD-3-Clause */
/* fuzz.h -- what the targets of `make fuzz` share: libFuzzer calls one function of each
 * with bytes that it made up. What must hold is told by HOLDS. */
#pragma once

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "scene_load.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define HOLDS(condition)                                                               \
    do {                                                                               \
        if (!(condition)) {                                                            \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);    \
            abort();                                                                   \
        }                                                                              \
    } while (0)

/* Every mistake has a place, a text and fits on a line. */
static inline void fuzz_check_items(void)
{
    char text[2048];
    HOLDS(found.count > 0 && found.count <= WEFT_DIAGNOSTICS_MAX);
    for (size_t i = 0; i < found.count; ++i) {
        const weft_diagnostic *item = &found.items[i];
        HOLDS(item->column >= 1);
        HOLDS(item->message[0] != '\0' && strpbrk(item->message, "\r\n") == NULL);
        HOLDS(strpbrk(item->source, "\r\n") == NULL);
        HOLDS(weft_diagnostic_format(item, text, sizeof text) < (int)sizeof text);
    }
}

/* A scene that is right, of which a cloth can be made, or mistakes. NULL: mistakes. */
static inline weft_scene *fuzz_load(const weft_scene_def *def)
{
    weft_scene *scene = NULL;
    weft_cloth *cloth = NULL;
    weft_error err = { 0 };
    const weft_status status = weft_scene_load(def, &scene, &found, &err);
    HOLDS(status == WEFT_OK || status == WEFT_BAD_SCENE);
    HOLDS((status == WEFT_OK) == (scene != NULL));
    if (scene == NULL) {
        fuzz_check_items();
        return NULL;
    }
    const weft_cloth_def *of = weft_scene_cloth(scene);
    if (of->rows * of->cols < 10000) {
        HOLDS(weft_cloth_create(of, &cloth, &err) == WEFT_OK);
        weft_cloth_destroy(cloth);
    }
    return scene;
}
