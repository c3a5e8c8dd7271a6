/* SPDX-License-Identifier: BSD-3-Clause */
/* set.c -- any lines as --set KEY.PATH=VALUE of a scene that is right. */
#include "fuzz/fuzz.h"

static const char whole[]
    = "weft: 1\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 6, spacing: [0.0625, 0.07]}\n"
      "  mass: 0.002\n"
      "  loads: [{at: [3, 3], mass: 0.05}]\n"
      "  springs: {stretch: &soft {stiffness: 100}, shear: *soft}\n"
      "  pins: [top-left, {rows: [0, 3], cols: all}]\n"
      "limit: {method: provot}\n"
      "stepper: {plugin: arkode, method: custom, butcher: {A: [[], [1/2]], b: [0, 1],\n"
      "  c: [0, 1/2], order: 2, b_embedded: [1, 0], embedded_order: 1}}\n"
      "run: {duration: 2.5}\n";

enum { SETS = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *sets[SETS];
    char *text = malloc(size + 1);
    HOLDS(text != NULL);
    memcpy(text, data, size);
    text[size] = '\0';
    weft_scene_def def = scene_of_text(whole);
    def.sets = sets;
    for (char *line = text; line != NULL && def.set_count < SETS; ++def.set_count) {
        char *end = strchr(line, '\n');
        sets[def.set_count] = line;
        if (end != NULL) {
            *end++ = '\0';
        }
        line = end;
    }
    weft_scene_destroy(fuzz_load(&def));
    free(text);
    return 0;
}
