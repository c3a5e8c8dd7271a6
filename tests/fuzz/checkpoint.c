/* SPDX-License-Identifier: BSD-3-Clause */
/* checkpoint.c -- any bytes as checkpoint.weft, first as they are and then with both
 * checksums made right: refused with nothing changed, or restored and stepped. The
 * simulation is of the method and has the ledger that the bytes tell. */
#include <math.h>
#include <stdbool.h>

#include "base/bytes.h"
#include "fuzz/file.h"
#include "program/record/checkpoint.h"
#include "saved_sum.h"

/* [words] Of the state: src/sim/save.c. */
enum { QUADRATURES = 4, NAME = 7, MOST = 512 };

static const weft_plugin *find_linked(void *ctx, const char *id, weft_error *err)
{
    (void)ctx;
    for (size_t i = 0; test_plugin(i) != NULL; ++i) {
        if (strcmp(test_plugin(i)->id, id) == 0) {
            return test_plugin(i);
        }
    }
    (void)weft_error_set(err, WEFT_BAD_PLUGIN, "no plugin %s", id);
    return NULL;
}

static const weft_scene *scene;
static const weft_cloth *cloth;

static void make_cloth(void)
{
    weft_scene_def def = weft_scene_def_default();
    weft_cloth *made = NULL;
    weft_scene *loaded = NULL;
    def.file = "tests/fuzz/checkpoint.yaml";
    def.find_plugin = find_linked;
    HOLDS(weft_scene_load(&def, &loaded, &found, NULL) == WEFT_OK);
    HOLDS(weft_cloth_create(weft_scene_cloth(loaded), &made, NULL) == WEFT_OK);
    scene = loaded;
    cloth = made;
}

/* The method of that name, or the scene's. */
static const weft_stepper_type *method_named(const char *name)
{
    const weft_stepper_type *method = NULL;
    for (size_t i = 0; method == NULL && test_plugin(i) != NULL; ++i) {
        method = weft_plugin_method(test_plugin(i), name);
    }
    return method == NULL || (method->flags & WEFT_STEPPER_BUTCHER) != 0
               ? weft_scene_method_type(scene)
               : method;
}

/* As the state wants it, if it may be so. */
static weft_sim *make_sim(const unsigned char *state, size_t size)
{
    char name[64] = "";
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    if (size >= NAME * WEFT__WORD + sizeof name) {
        memcpy(name, state + NAME * WEFT__WORD, sizeof name);
        name[sizeof name - 1] = '\0';
        def.ledger = state[QUADRATURES * WEFT__WORD] != 0;
    }
    def.cloth = cloth;
    def.method = method_named(name);
    def.config = *weft_scene_config(scene);
    if ((def.method->flags & WEFT_STEPPER_FIXED_ONLY) == 0) {
        def.config.fixed_step = 0.0;
    }
    def.ledger = def.ledger && (def.method->flags & WEFT_STEPPER_QUADRATURES) != 0;
    def.limit = *weft_scene_limit(scene);
    HOLDS(weft_sim_create(&def, &sim, NULL) == WEFT_OK);
    return sim;
}

/* A little further, or an error that tells why not. */
static void step(weft_sim *sim)
{
    weft_error err = { 0 };
    const double t = weft_sim_time(sim);
    const double t_end = t + 1e-2 > t ? t + 1e-2 : nextafter(t, INFINITY);
    if (weft_sim_step(sim, t_end, &err) != WEFT_OK) {
        HOLDS(err.message[0] != '\0' && weft_sim_time(sim) == t);
        return;
    }
    HOLDS(weft_sim_time(sim) > t && weft_sim_time(sim) <= t_end);
    for (size_t i = 0; i < weft_cloth_dim(cloth); ++i) {
        HOLDS(isfinite(weft_sim_state(sim)[i]));
    }
    (void)weft_sim_ledger(sim);
    (void)weft_sim_limit_worst(sim);
}

/* Refused, it goes on as if nothing had been. */
static void restore(weft_sim *sim, record_checkpoint *from)
{
    weft_error err = { 0 };
    double y[MOST];
    const size_t size = weft_cloth_dim(cloth) * sizeof *y;
    HOLDS(size <= sizeof y);
    HOLDS(weft_sim_step(sim, 1e-2, NULL) == WEFT_OK);
    const double t = weft_sim_time(sim);
    const weft_stepper_stats stats = weft_sim_stats(sim);
    memcpy(y, weft_sim_state(sim), size);
    if (record_checkpoint_restore(from, sim, &err) == WEFT_OK) {
        for (size_t i = 0; i < weft_cloth_dim(cloth); ++i) {
            HOLDS(isfinite(weft_sim_state(sim)[i]));
        }
        HOLDS(isfinite(weft_sim_time(sim)));
    } else {
        const weft_stepper_stats now = weft_sim_stats(sim);
        HOLDS(err.status == WEFT_IO && err.message[0] != '\0');
        HOLDS(weft_sim_time(sim) == t && memcmp(y, weft_sim_state(sim), size) == 0);
        HOLDS(now.steps == stats.steps && now.next_step == stats.next_step);
        HOLDS(weft_sim_step(sim, t + 1e-2, NULL) == WEFT_OK);
    }
    step(sim);
}

static void try_bytes(const unsigned char *bytes, size_t size)
{
    record_checkpoint from;
    weft_error err = { 0 };
    fuzz_write(RECORD_CHECKPOINT, bytes, size);
    if (record_checkpoint_read(fuzz_directory, &from, &err) != WEFT_OK) {
        HOLDS(err.status == WEFT_IO && strstr(err.message, RECORD_CHECKPOINT) != NULL);
        HOLDS(from.stream == NULL);
        return;
    }
    HOLDS(strlen(from.program) < sizeof from.program);
    weft_sim *sim = make_sim(bytes + RECORD_CHECKPOINT_HEAD, from.state_size);
    restore(sim, &from);
    weft_sim_destroy(sim);
    record_checkpoint_close(&from);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    unsigned char *bytes = malloc(size + 1);
    HOLDS(bytes != NULL);
    memcpy(bytes, data, size);
    if (cloth == NULL) {
        make_cloth();
    }
    try_bytes(bytes, size);
    if (size >= RECORD_CHECKPOINT_HEAD) {
        const size_t sum = RECORD_CHECKPOINT_HEAD - WEFT__WORD;
        weft__word_put(bytes + 2 * WEFT__WORD, size);
        weft__word_put(bytes + sum, weft__words_sum(bytes, sum / WEFT__WORD));
        saved_mend(bytes + RECORD_CHECKPOINT_HEAD, size - RECORD_CHECKPOINT_HEAD);
        try_bytes(bytes, size);
    }
    free(bytes);
    return 0;
}
