/* SPDX-License-Identifier: BSD-3-Clause */
/* rollback.c -- a curtain in a networked game: each frame is advanced at the longest
 * stable step and saved; when an input of the past arrives, the game goes back to its
 * frame and plays again. Two players who do so have the same bits. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { ROWS = 40, COLS = 60, FPS = 60, KEPT = 8, FRAMES = 30 };

/* The last KEPT frames, each as its own bytes. */
typedef struct history {
    void *bytes[KEPT];
    size_t size; /* of each */
} history;

/* A gust that blows from frame 20 on. */
static weft_status blow(weft_sim *sim, int frame, weft_error *err)
{
    const double gust[3] = { 0.0, 0.0, frame >= 20 ? 6.0 : 0.0 }; /* [m/s] */
    return weft_sim_set_wind(sim, gust, 0.3, err);
}

/* Plays frame `frame` and saves its end. A late gust is not yet known. */
static weft_status play(weft_sim *sim, history *past, int frame, bool known,
                        weft_error *err)
{
    weft_status status = blow(sim, known ? frame : 0, err);
    if (status == WEFT_OK) {
        status = weft_sim_advance(sim, (double)frame / FPS, err);
    }
    return status == WEFT_OK
               ? weft_sim_save(sim, past->bytes[frame % KEPT], past->size, err)
               : status;
}

/* Player `late` hears of the gust in frame 25: it goes back to the end of frame 19. */
static weft_status play_all(weft_sim *sim, history *past, bool late, weft_error *err)
{
    weft_status status = weft_sim_save(sim, past->bytes[0], past->size, err);
    for (int frame = 1; status == WEFT_OK && frame <= FRAMES; ++frame) {
        if (late && frame == 25) {
            frame = 20;
            status = weft_sim_restore(sim, past->bytes[19 % KEPT], past->size, err);
            late = false;
        }
        if (status == WEFT_OK) {
            status = play(sim, past, frame, !late, err);
        }
    }
    return status;
}

static weft_status play_as(const weft_sim_def *def, bool late, weft_error *err)
{
    weft_sim *sim = NULL;
    history past = { .size = 0 };
    weft_status status = weft_sim_create(def, &sim, err);
    past.size = status == WEFT_OK ? weft_sim_save_size(sim) : 0;
    for (int i = 0; status == WEFT_OK && i < KEPT; ++i) {
        past.bytes[i] = malloc(past.size);
        status = past.bytes[i] != NULL
                     ? WEFT_OK
                     : weft_error_set(err, WEFT_NO_MEMORY, "no memory");
    }
    status = status == WEFT_OK ? play_all(sim, &past, late, err) : status;
    if (status == WEFT_OK) {
        printf("%s: state %016" PRIx64 " after %d frames, %zu kB each\n",
               late ? "late" : "in time", weft_sim_measure(sim).hash, FRAMES,
               past.size / 1000);
    }
    for (int i = 0; i < KEPT; ++i) {
        free(past.bytes[i]);
    }
    weft_sim_destroy(sim);
    return status;
}

/* 0.9 times the longest step at which no vibration about the start grows. */
static weft_status choose_step(const weft_cloth *cloth, weft_sim_def *run,
                               weft_error *err)
{
    const weft_stiffness modes = weft_cloth_stiffness(cloth, 0.0, NULL);
    weft_stability stability;
    double longest = 0.0; /* [s] */
    weft_status status = weft_stability_create(run->method, NULL, &stability, err);
    if (status == WEFT_OK) {
        status = weft_stability_step(&stability, &modes, 0.0, &longest, err);
    }
    run->config.fixed_step = 0.9 * longest;
    return status;
}

int main(void)
{
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS;
    def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.025; /* [m] */
    def.density = 0.0;                       /* equal masses allow a longer step */
    def.mass = 1.2e-4;                       /* [kg] each */
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 200.0, .damping = 0.008 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.006 };
    def.pins = &top;
    def.pin_count = 1;

    weft_cloth *cloth = NULL;
    weft_error err;
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "symplectic_euler");
    weft_status status = weft_cloth_create(&def, &cloth, &err);
    run.cloth = cloth;
    status = status == WEFT_OK ? choose_step(cloth, &run, &err) : status;
    status = status == WEFT_OK ? play_as(&run, false, &err) : status;
    status = status == WEFT_OK ? play_as(&run, true, &err) : status;
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_cloth_destroy(cloth);
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
