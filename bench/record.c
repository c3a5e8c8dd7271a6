/* SPDX-License-Identifier: BSD-3-Clause */
/* What run.vtkhdf costs a run of 100 x 100 particles at 30 frames a second: the program
 * with all frames, in both precisions, against the program with the first and the last;
 * and what a checkpoint at each of them costs.
 * The stepper is the cheapest there is, at the longest step that is stable: any other
 * spends more on a frame. */
#include <stdio.h>

#include "bench.h"

#define OUT BUILD_DIR "/bench"

static const char scene[]
    = "weft: 1\n"
      "cloth:\n"
      "  grid: {rows: 100, cols: 100, spacing: 0.01, down: [0, 0, 1]}\n"
      "  density: 0.2\n"
      "  springs:\n"
      "    stretch: {stiffness: 100, damping: 0.002}\n"
      "    shear: {stiffness: 50, damping: 0.001}\n"
      "    bend: {stiffness: 5}\n"
      "  pins: [top-left, top-right]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 2.0e-4}\n"
      "run: {duration: 0.5}\n";

static void run_program(void *set)
{
    char command[512];
    (void)snprintf(command, sizeof command,
                   "rm -rf " OUT "/r; " BUILD_DIR "/weft run " OUT
                   "/scene.yaml --out " OUT "/r --quiet --set record.%s",
                   (const char *)set);
    if (system(command) != 0) {
        abort();
    }
}

int main(void)
{
    static char few[] = "every=1000000", single[] = "precision=single",
                doubles[] = "precision=double",
                checkpoints[] = "precision=single --set run.checkpoint=1";
    bench_case cases[] = { { "first and last frame", run_program, few, 0.0 },
                           { "all, single precision", run_program, single, 0.0 },
                           { "all, double precision", run_program, doubles, 0.0 },
                           { "single, checkpoints", run_program, checkpoints, 0.0 } };
    FILE *stream = NULL;
    if (system("mkdir -p " OUT) != 0 || (stream = fopen(OUT "/scene.yaml", "w")) == NULL
        || fputs(scene, stream) < 0 || fclose(stream) != 0) {
        perror(OUT "/scene.yaml");
        return 1;
    }
    bench_interleaved(cases, 4, 7);
    puts("run.vtkhdf, 100 x 100 particles, 30 frames a second, 0.5 s:");
    for (size_t i = 0; i < 4; ++i) {
        printf("  %-22s %6.3f s  %+.1f %%\n", cases[i].name, cases[i].median,
               100.0 * (cases[i].median / cases[0].median - 1.0));
    }
    return 0;
}
