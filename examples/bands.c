/* SPDX-License-Identifier: BSD-3-Clause */
/* bands.c -- one cloth in bands of rows, each in a thread of its own, with the bits of
 * the whole cloth. Processes join in the same way: only the comm differs. */
#include <inttypes.h>
#include <stdio.h>
#include <weft/plugins.h>
#include <weft/weft.h>

#include "thread_comm.h"

enum { BANDS = 3, ROWS = 24, COLS = 16 };

typedef struct job {
    weft_comm comm;
    weft_status status;
    weft_error err;
    uint64_t hash; /* of the whole state */
} job;

/* All bands call the same functions in the same order. */
static void *work(void *ctx)
{
    job *self = (job *)ctx;
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default(); /* the whole cloth */
    weft_sim_def run = weft_sim_def_default();
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    def.rows = ROWS, def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.02 };
    def.velocity[2] = 0.5;
    def.pins = &top;
    def.pin_count = 1;
    //! [band]
    (void)weft_comm_band(ROWS, (size_t)self->comm.rank, (size_t)self->comm.size,
                         &def.band_first,
                         &def.band_rows); /* and the rows of this band */
    //! [band]
    //! [agree]
    self->status = weft_cloth_create(&def, &cloth, &self->err);
    self->status = weft_comm_agree(&self->comm, self->status, &self->err);
    //! [agree]
    run.cloth = cloth;
    run.comm = &self->comm;
    run.method = weft_plugin_method(weft_plugin_verlet(), "velocity_verlet");
    run.config.fixed_step = 1e-3; /* [s] */
    if (self->status == WEFT_OK) {
        self->status = weft_sim_create(&run, &sim, &self->err);
    }
    if (sim != NULL) {
        self->status = weft_sim_advance(sim, 0.5, &self->err);
        self->hash = weft_sim_measure(sim).hash;
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return NULL;
}

static weft_status run_on(int bands, job *jobs)
{
    pthread_t threads[BANDS];
    weft_status status = WEFT_OK;
    thread_bands *all = thread_bands_create(bands);
    if (all == NULL) {
        return WEFT_NO_MEMORY;
    }
    for (int i = 0; i < bands; ++i) {
        jobs[i] = (job){ .comm = thread_bands_comm(all, i) };
        if (pthread_create(&threads[i], NULL, work, &jobs[i]) != 0) {
            exit(EXIT_FAILURE); /* the others would wait for this one */
        }
    }
    for (int i = 0; i < bands; ++i) {
        (void)pthread_join(threads[i], NULL);
        if (jobs[i].status != WEFT_OK) {
            status = jobs[i].status;
            fprintf(stderr, "band %d: %s\n", i, jobs[i].err.message);
        }
    }
    thread_bands_destroy(all);
    return status;
}

int main(void)
{
    job jobs[BANDS];
    for (int bands = 1; bands <= BANDS; ++bands) {
        if (run_on(bands, jobs) != WEFT_OK) {
            return EXIT_FAILURE;
        }
        printf("%d bands: state %016" PRIx64 "\n", bands, jobs[0].hash);
    }
    return EXIT_SUCCESS;
}
