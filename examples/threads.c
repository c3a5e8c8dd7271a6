/* SPDX-License-Identifier: BSD-3-Clause */
/* threads.c -- many simulations at once: all threads share one constant cloth, each
 * simulation belongs to one thread. A run gives the same bits in every thread. */
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { THREADS = 8 };

typedef struct job {
    const weft_cloth *cloth;
    double step; /* [s] */
    weft_status status;
    weft_error err;
    uint64_t hash; /* of the final state */
    double height; /* [m] of the last particle */
} job;

static void *work(void *ctx)
{
    job *self = (job *)ctx;
    weft_sim *sim = NULL;
    weft_sim_def run = weft_sim_def_default();
    run.cloth = self->cloth;
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = self->step;
    self->status = weft_sim_create(&run, &sim, &self->err);
    if (self->status == WEFT_OK) {
        self->status = weft_sim_advance(sim, 1.0, &self->err);
        const double *y = weft_sim_state(sim);
        self->hash = weft_sim_measure(sim).hash;
        self->height = y[2 * weft_cloth_particles(self->cloth) - 1];
    }
    weft_sim_destroy(sim);
    return NULL;
}

int main(void)
{
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    weft_error err;
    pthread_t threads[THREADS];
    job jobs[THREADS];
    def.rows = def.cols = 20;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 50.0, .damping = 0.01 };
    def.velocity[2] = 0.5;
    def.pins = &top;
    def.pin_count = 1;
    if (weft_cloth_create(&def, &cloth, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        return EXIT_FAILURE;
    }
    for (int i = 0; i < THREADS; ++i) { /* four step sizes, two threads each */
        jobs[i] = (job){ .cloth = cloth, .step = 1e-3 / (1 + i / 2) };
        if (pthread_create(&threads[i], NULL, work, &jobs[i]) != 0) {
            return EXIT_FAILURE;
        }
    }
    int code = EXIT_SUCCESS;
    for (int i = 0; i < THREADS; ++i) {
        (void)pthread_join(threads[i], NULL);
        printf("h = %.6f s: height %+.6f m, state %016" PRIx64 "\n", jobs[i].step,
               jobs[i].height, jobs[i].hash);
        code = jobs[i].status == WEFT_OK ? code : EXIT_FAILURE;
    }
    weft_cloth_destroy(cloth);
    return code;
}
