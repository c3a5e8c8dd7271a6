/* SPDX-License-Identifier: BSD-3-Clause */
/* advice.h -- the method that `weft check` advises for a scene, from what it prints. */
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ADVICE_ACCURACIES = 2 };

static const double advice_accuracies[ADVICE_ACCURACIES] = { 1e-2, 1e-3 }; /* [m] */

/* Gains over an explicit method as line stiffness estimates them; 0: none promised.
 * The explicit method is that of line advice, or the scene's own. */
typedef struct advice {
    double rkc2, bdf[ADVICE_ACCURACIES];
    char plugin[32], method[32];
} advice;

static inline double advice_number(const char *line, const char *text)
{
    const char *at = strstr(line, text);
    return at == NULL ? 0.0 : strtod(at + strlen(text), NULL);
}

static inline void advice_read(const char *line, advice *out)
{
    const char *end = strstr(line, " at its stable step needs");
    if (strstr(line, " stiffness: ") != NULL) {
        out->rkc2 = advice_number(line, "stiff rkc2 is ");
        out->bdf[0] = advice_number(line, "cvode bdf is ");
        out->bdf[1] = advice_number(line, "faster at 1e-02 m, ");
    }
    if (end != NULL) {
        const char *from = end;
        for (int words = 2; words > 0 && from > line; words -= *from == ' ') {
            --from;
        }
        (void)sscanf(from, "%31s %31s", out->plugin, out->method);
    }
}

static inline advice advice_of(const char *scene)
{
    advice out = { .plugin = "arkode", .method = "dormand_prince" };
    char line[4096];
    (void)snprintf(line, sizeof line, "%s/weft check --yaml %s", BUILD_DIR, scene);
    FILE *from = popen(line, "r");
    while (from != NULL && fgets(line, sizeof line, from) != NULL) {
        advice_read(line, &out);
    }
    if (from == NULL || pclose(from) != 0) {
        fprintf(stderr, "%s: weft check failed\n", scene);
        exit(1);
    }
    return out;
}

/* The plugin and the method for the i-th accuracy. */
static inline void advice_for(const advice *of, size_t i, const char **plugin,
                              const char **method)
{
    const double gain = of->rkc2 > of->bdf[i] ? of->rkc2 : of->bdf[i];
    *plugin = !(gain > 0.0) ? of->plugin : gain > of->bdf[i] ? "stiff" : "cvode";
    *method = !(gain > 0.0) ? of->method : gain > of->bdf[i] ? "rkc2" : "bdf";
}
