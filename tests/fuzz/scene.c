/* SPDX-License-Identifier: BSD-3-Clause */
/* scene.c -- any bytes as the text of a scene. */
#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const sets[] = { "run.fps=31" };
    char *text = malloc(size + 1); /* so that a byte too many is seen */
    HOLDS(text != NULL);
    memcpy(text, data, size);
    weft_scene_def def = scene_of_text("");
    def.text = text;
    def.length = size;
    weft_scene *scene = fuzz_load(&def);
    if (scene != NULL) { /* what is written of it is the same scene */
        weft_scene_destroy(scene);
        def.sets = sets;
        def.set_count = 1;
        scene = fuzz_load(&def);
    }
    if (scene != NULL) {
        weft_scene_def again = scene_of_text(weft_scene_text(scene));
        weft_scene *written = fuzz_load(&again);
        HOLDS(written != NULL);
        HOLDS(strcmp(weft_scene_method(scene), weft_scene_method(written)) == 0);
        weft_scene_destroy(written);
    }
    weft_scene_destroy(scene);
    free(text);
    return 0;
}
