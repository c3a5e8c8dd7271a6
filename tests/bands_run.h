/* SPDX-License-Identifier: BSD-3-Clause */
/* bands_run.h -- runs of a cloth in bands, one thread each, compared with the whole
 * cloth, for the tests of bands. */
#pragma once

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../examples/thread_comm.h"
#include "program/record/checkpoint.h"
#include "support.h"

enum { BANDS = 5, FRAMES = 4, TEXT = 4096, SHAPES = 2 };

typedef enum oddity {
    NOTHING,
    WHOLE_CLOTH,
    NO_MEMORY,
    STOPS,
    ELSEWHERE, /* its checkpoint */
    FULL_DISK  /* for its parts of the saved bytes */
} oddity;

/* A run of a cloth, whole or in bands. */
typedef struct scenario {
    weft_cloth_def cloth;
    weft_sim_def sim;
    double duration;     /* [s] */
    const void *restore; /* bytes to begin with; NULL: none */
    size_t restore_size;
    const char *restore_file; /* directory of a checkpoint to begin with; or NULL */
    const char *save_file;    /* directory for one at the end; or NULL */
    size_t spoilt; /* 1 + the row that gets a NaN after the first frame; 0: none */
    bool own_only; /* but not where it is a ghost */
    oddity odd;    /* what differs in odd_band */
    int odd_band;
} scenario;

/* What it left. */
typedef struct outcome {
    char series[FRAMES + 1][TEXT]; /* of each frame */
    size_t frames;
    weft_status status;
    weft_error err;
    weft_failure failure;
    weft_totals totals;
    double *y;            /* of the whole */
    unsigned char *saved; /* on band 0; NULL: it failed */
    size_t saved_size;
    bool guarded; /* nobody wrote where the exchange was under way */
} outcome;

/* ---- a comm that sees what is written while an exchange is under way ----------------
 */

typedef struct guard {
    weft_comm real;
    weft_rows rows;
    double *before; /* all planes as they were at begin, ghosts poisoned */
    bool *good, posted;
    pthread_t thread; /* that alone makes calls */
} guard;

static const double poison = 0x1.badp300;

static inline size_t present(const weft_rows *rows)
{
    return (rows->above + rows->own + rows->below) * rows->cols;
}

/* Whether others have, or wait for, particle i of a plane. */
static inline bool exchanged(const weft_rows *rows, size_t i, bool *ghost)
{
    const size_t r = i / rows->cols, end = rows->above + rows->own;
    *ghost = r < rows->above || r >= end;
    return *ghost || (rows->above > 0 && r < rows->above + WEFT_GHOST_ROWS)
           || (rows->below > 0 && r + WEFT_GHOST_ROWS >= end);
}

static inline void guard_begin(void *self, const weft_rows *rows)
{
    guard *of = self;
    const size_t n = present(rows);
    bool ghost;
    of->rows = *rows;
    of->posted = false;
    of->thread = pthread_self();
    of->before = malloc(rows->planes * n * sizeof *of->before);
    of->real.begin(of->real.self, rows);
    for (size_t k = 0; k < rows->planes; ++k) {
        double *plane = rows->first + k * rows->stride;
        for (size_t i = 0; i < n; ++i) {
            if (exchanged(rows, i, &ghost) && ghost) {
                plane[i] = poison;
            }
        }
        memcpy(of->before + k * n, plane, n * sizeof *plane);
    }
}

static inline void guard_end(void *self)
{
    guard *of = self;
    const weft_rows *rows = &of->rows;
    const size_t n = present(rows);
    bool ghost;
    if (of->posted) {
        of->real.end(of->real.self);
        return;
    }
    for (size_t j = 0; j < rows->planes * n; ++j) {
        const double *now = rows->first + j / n * rows->stride + j % n;
        if (exchanged(rows, j % n, &ghost)) {
            *of->good = *of->good && memcmp(now, of->before + j, sizeof *now) == 0;
        }
    }
    free(of->before);
    of->real.end(of->real.self);
}

/* Nothing is there before `end`. */
static inline void guard_post(void *self, const weft_parcel *parcels, size_t count)
{
    guard *of = self;
    of->posted = true;
    of->thread = pthread_self();
    for (size_t p = 0; p < count; ++p) {
        for (size_t j = 0; j < parcels[p].ins; ++j) {
            parcels[p].in[j] = poison;
        }
    }
    of->real.post(of->real.self, parcels, count);
}

static inline double guard_max(void *self, double mine)
{
    guard *of = self;
    *of->good = *of->good && !(mine < 0.0) && (isnan(mine) || !signbit(mine));
    return of->real.max(of->real.self, mine);
}

static inline void guard_share(void *self, void *data, size_t bytes)
{
    guard *of = self;
    of->real.share(of->real.self, data, bytes);
}

static inline void guard_gather(void *self, const void *mine, size_t bytes, void *all)
{
    guard *of = self;
    of->real.gather(of->real.self, mine, bytes, all);
}

static inline void guard_poke(void *self)
{
    guard *of = self;
    *of->good = *of->good && pthread_equal(pthread_self(), of->thread);
}

static inline weft_comm guarded(guard *of, const weft_comm *real, bool *good)
{
    *of = (guard){ .real = *real, .good = good };
    weft_comm comm = *real;
    comm.self = of;
    comm.max = guard_max;
    comm.begin = guard_begin;
    comm.poke = guard_poke;
    comm.end = guard_end;
    comm.share = guard_share;
    comm.gather = guard_gather;
    comm.post = guard_post;
    return comm;
}

/* ---- a run -------------------------------------------------------------------------
 */

static inline void put(char *text, const char *name, double value)
{
    const size_t used = strlen(text);
    ck_assert_uint_lt(used + 64, TEXT);
    (void)snprintf(text + used, TEXT - used, "%s %a\n", name, value);
}

/* Numbers below 2^53, all bits of others. */
static inline void put_hash(char *text, uint64_t hash)
{
    put(text, "hash", (double)(hash >> 32));
    put(text, "hash", (double)(hash & UINT32_MAX));
}

static inline void put_measures(const weft_sim *sim, char *text)
{
    const weft_measures m = weft_sim_measure(sim);
    put(text, "kinetic", m.energy.kinetic);
    put(text, "gravitational", m.energy.gravitational);
    put(text, "contact", m.energy.contact);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        put(text, "elastic", m.energy.elastic[k]);
    }
    for (size_t k = 0; k < 3; ++k) {
        put(text, "momentum", m.momentum[k]);
        put(text, "angular momentum", m.angular_momentum[k]);
    }
    put(text, weft_family_name(m.worst.family), m.worst.strain);
    put(text, "p", (double)m.worst.p);
    put(text, "q", (double)m.worst.q);
    put(text, "gap", m.gap);
    put(text, "gap particle", (double)m.gap_particle);
    put(text, "gap shape", (double)m.gap_shape);
    put(text, "touching", (double)m.touching);
    put(text, "self gap", m.self_gap);
    put(text, "self touching", (double)m.self_touching);
    for (size_t k = 0; k < 2 * 3; ++k) {
        const weft_primitive *of = &m.self_pair[k / 3];
        put(text, "of pair", k % 3 < of->count ? (double)of->particle[k % 3] : -1.0);
    }
    put_hash(text, m.hash);
}

static inline void put_stiffness(const weft_sim *sim, const double *y, char *text)
{
    const weft_stiffness of = weft_sim_stiffness(sim, weft_sim_time(sim), y);
    put(text, "omega2", of.omega2);
    put(text, "damping", of.damping);
    for (size_t i = 0; i < of.count; ++i) {
        put(text, "w", of.corners[i][0]);
        put(text, "c", of.corners[i][1]);
    }
}

static inline void put_frame(const weft_sim *sim, char *text)
{
    const weft_stepper_stats stats = weft_sim_stats(sim);
    const weft_ledger ledger = weft_sim_ledger(sim);
    double force[3], torque[3];
    text[0] = '\0';
    put(text, "t", weft_sim_time(sim));
    put(text, "steps", (double)stats.steps);
    put(text, "rejected", (double)stats.rejected);
    put(text, "rhs calls", (double)stats.rhs_calls);
    put(text, "last h", stats.last_step);
    put(text, "next h", stats.next_step);
    put(text, "vetoed", (double)weft_sim_vetoed(sim));
    put(text, "energy", weft_energy_total(ledger.energy));
    put(text, "springs", ledger.dissipated_springs);
    put(text, "wind", ledger.work_wind);
    put(text, "pins", ledger.work_pins);
    put(text, "damped", ledger.dissipated_contact);
    put(text, "rubbed", ledger.dissipated_friction);
    put(text, "residual", ledger.residual);
    put(text, "event", weft_sim_event(sim) ? 1.0 : 0.0);
    put_measures(sim, text);
    put_stiffness(sim, weft_sim_state(sim), text);
    put_stiffness(sim, NULL, text);
    for (size_t k = 0; k < weft_cloth_shapes(weft_sim_cloth(sim)); ++k) {
        weft_sim_shape_load(sim, k, force, torque);
        for (size_t j = 0; j < 3; ++j) {
            put(text, "force", force[j]);
            put(text, "torque", torque[j]);
        }
    }
}

/* Rows, or blocks of triangles; particles of each, the last one perhaps fewer. */
static inline size_t blocks_of(const weft_cloth_def *of)
{
    const size_t block = WEFT_BLOCK_VERTICES;
    return of->mesh != NULL ? (of->mesh->vertices + block - 1) / block : of->rows;
}

static inline size_t particles_of(const weft_cloth_def *of)
{
    return of->mesh != NULL ? of->mesh->vertices : of->rows * of->cols;
}

/* The own rows, to their place in the whole. */
static inline void keep_state(const weft_cloth_def *of, const weft_sim *sim,
                              double *whole)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_band band = weft_cloth_band(cloth);
    const size_t block = of->mesh != NULL ? WEFT_BLOCK_VERTICES : of->cols;
    const size_t n = weft_cloth_particles(cloth), all = particles_of(of);
    const size_t rest = all - band.first * block;
    const size_t own = band.own * block < rest ? band.own * block : rest;
    for (size_t k = 0; k < 6; ++k) {
        memcpy(whole + k * all + band.first * block,
               weft_sim_state(sim) + k * n + band.above * block, own * sizeof *whole);
    }
}

typedef struct job {
    const scenario *of;
    const weft_comm *comm; /* NULL: whole */
    outcome *out;
    int calls; /* of stop */
} job;

static inline bool is_odd(const job *self, oddity how)
{
    return self->of->odd == how
           && (self->comm == NULL || self->comm->rank == self->of->odd_band);
}

static inline void *refuse(void *ctx, void *block, size_t size)
{
    (void)ctx;
    return size == 0 ? (free(block), NULL) : NULL;
}

/* From the 20th evaluation on. */
static inline bool stop(void *calls)
{
    return ++*(int *)calls >= 20;
}

static inline weft_status start(job *self, weft_cloth **cloth, weft_sim **sim,
                                weft_error *err)
{
    static const weft_allocator none = { refuse, NULL };
    weft_cloth_def model = self->of->cloth;
    weft_sim_def def = self->of->sim;
    const weft_comm *comm = def.comm = self->comm;
    if (comm != NULL && !is_odd(self, WHOLE_CLOTH)) {
        ck_assert(weft_comm_band(blocks_of(&model), (size_t)comm->rank,
                                 (size_t)comm->size, &model.band_first,
                                 &model.band_rows));
    }
    *cloth = test_cloth(&model);
    def.cloth = *cloth;
    def.allocator = is_odd(self, NO_MEMORY) ? &none : NULL;
    def.stop = is_odd(self, STOPS) ? stop : NULL;
    def.stop_ctx = &self->calls;
    weft_status status = weft_sim_create(&def, sim, err);
    if (status == WEFT_OK && self->of->restore != NULL) {
        status = weft_sim_restore(*sim, self->of->restore, self->of->restore_size, err);
    }
    if (status == WEFT_OK && self->of->restore_file != NULL) {
        record_checkpoint from;
        status = record_checkpoint_read(self->of->restore_file, &from, err);
        status
            = status == WEFT_OK ? record_checkpoint_restore(&from, *sim, err) : status;
        record_checkpoint_close(&from);
    }
    return status;
}

/* The state belongs to the simulation: only an error in the program does this. */
static inline void spoil(const scenario *of, const weft_sim *sim)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_band band = weft_cloth_band(cloth);
    const size_t top = band.first - band.above, r = of->spoilt - 1 - top;
    const bool own = r >= band.above && r < band.above + band.own;
    if (of->spoilt > 0 && (own || (!of->own_only && r < weft_cloth_rows(cloth)))) {
        ((double *)(uintptr_t)weft_sim_state(sim))[r * weft_cloth_cols(cloth)]
            = (double)NAN;
    }
}

static inline double frame_time(const scenario *of, size_t i)
{
    const double part = of->duration * (double)i / FRAMES;
    return of->restore == NULL && of->restore_file == NULL ? part : of->duration + part;
}

static inline weft_status put_to_disk(void *full, uint64_t at, const void *bytes,
                                      size_t size, weft_error *err)
{
    (void)at, (void)bytes, (void)size;
    return *(bool *)full ? weft_error_set(err, WEFT_IO, "the disk is full") : WEFT_OK;
}

/* To files. */
static inline weft_status keep(const job *self, weft_sim *sim, weft_error *err)
{
    const record_checkpoint head = { .frame = FRAMES };
    bool full = is_odd(self, FULL_DISK);
    return self->of->odd == FULL_DISK
               ? weft_sim_save_parts(sim, put_to_disk, &full, err)
               : record_checkpoint_write(is_odd(self, ELSEWHERE) ? BUILD_DIR "/none"
                                                                 : self->of->save_file,
                                         &head, sim, self->comm, err);
}

static inline void *play(void *ctx)
{
    job *self = ctx;
    outcome *out = self->out;
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    out->status = start(self, &cloth, &sim, &out->err);
    for (size_t i = 0; out->status == WEFT_OK; ++i) {
        put_frame(sim, out->series[i]);
        out->frames = i + 1;
        if (i == FRAMES) {
            break;
        }
        if (i == 1 && self->of->spoilt > 0) {
            spoil(self->of, sim);
            out->status = weft_sim_restart(sim, &out->err); /* which reads the state */
        }
        out->status = weft_sim_advance(sim, frame_time(self->of, i + 1), &out->err);
    }
    if (sim != NULL) {
        const bool failed = weft_sim_failure(sim, &out->failure);
        ck_assert(failed || out->failure.status == WEFT_OK);
        keep_state(&self->of->cloth, sim, out->y);
        out->totals = weft_sim_totals(sim);
    }
    if (out->status == WEFT_OK) {
        const bool first = self->comm == NULL || self->comm->rank == 0;
        out->saved_size = weft_sim_save_size(sim);
        out->saved = first ? malloc(out->saved_size) : NULL;
        out->status
            = weft_sim_save(sim, out->saved, first ? out->saved_size : 0, &out->err);
    }
    if (out->status == WEFT_OK && self->of->save_file != NULL) {
        out->status = keep(self, sim, &out->err);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return NULL;
}

static inline size_t numbers(const scenario *of)
{
    return 6 * particles_of(&of->cloth);
}

static inline void make(const scenario *of, outcome *out)
{
    memset(out, 0, sizeof *out);
    out->y = calloc(numbers(of), sizeof *out->y);
    out->guarded = true;
}

static inline void drop(outcome *out)
{
    free(out->y);
    free(out->saved);
}

static inline void check_same(const scenario *of, const outcome *a, const outcome *b)
{
    ck_assert_msg(a->status == b->status, "%s, not %s", b->err.message, a->err.message);
    ck_assert_str_eq(a->err.message, b->err.message);
    ck_assert_uint_eq(a->frames, b->frames);
    for (size_t i = 0; i < a->frames; ++i) {
        ck_assert_msg(strcmp(a->series[i], b->series[i]) == 0, "%s, frame %zu: %s\n%s",
                      of->sim.method->name, i, a->series[i], b->series[i]);
    }
    ck_assert_int_eq(a->failure.status, b->failure.status);
    ck_assert_uint_eq(a->failure.particle, b->failure.particle);
    ck_assert_uint_eq(a->failure.gap_particle, b->failure.gap_particle);
    ck_assert(a->failure.gap_step == b->failure.gap_step);
    for (size_t k = 0; k < 2; ++k) {
        const weft_primitive *p = &a->failure.self_pair[k],
                             *q = &b->failure.self_pair[k];
        ck_assert_uint_eq(p->count, q->count);
        for (size_t j = 0; j < p->count; ++j) {
            ck_assert_uint_eq(p->particle[j], q->particle[j]);
        }
    }
    ck_assert_uint_eq(a->saved_size, b->saved_size);
    ck_assert_uint_eq(a->totals.particles, b->totals.particles);
    ck_assert_uint_eq(a->totals.pins, b->totals.pins);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        ck_assert_uint_eq(a->totals.springs[k], b->totals.springs[k]);
    }
    ck_assert(a->totals.mass == b->totals.mass);
}

/* The outcome of band 0, with the state of the whole; those of the others agree. */
static inline void run_bands(const scenario *of, int bands, outcome *out)
{
    thread_bands *all = thread_bands_create(bands);
    pthread_t threads[BANDS];
    weft_comm real[BANDS], comms[BANDS];
    guard guards[BANDS];
    outcome *outs = calloc(BANDS, sizeof *outs);
    job jobs[BANDS];
    make(of, out);
    for (int i = 0; i < bands; ++i) {
        make(of, &outs[i]);
        free(outs[i].y);
        outs[i].y = out->y; /* each its own rows */
        real[i] = thread_bands_comm(all, i);
        comms[i] = guarded(&guards[i], &real[i], &outs[i].guarded);
        jobs[i] = (job){ .of = of, .comm = &comms[i], .out = &outs[i] };
        ck_assert_int_eq(pthread_create(&threads[i], NULL, play, &jobs[i]), 0);
    }
    for (int i = 0; i < bands; ++i) {
        (void)pthread_join(threads[i], NULL);
    }
    for (int i = 0; i < bands; ++i) {
        ck_assert(outs[i].guarded);
        check_same(of, &outs[0], &outs[i]);
    }
    *out = outs[0];
    free(outs);
    thread_bands_destroy(all);
}

static inline void run_whole(const scenario *of, outcome *out)
{
    make(of, out);
    (void)play(&(job){ .of = of, .out = out });
    if (out->totals.particles > 0) { /* it was created */
        weft_cloth *cloth = test_cloth(&of->cloth);
        ck_assert_uint_eq(out->totals.pins, weft_cloth_pins(cloth));
        ck_assert(out->totals.mass == weft_cloth_mass(cloth));
        ck_assert_uint_eq(out->totals.springs[WEFT_SHEAR],
                          weft_cloth_springs(cloth, WEFT_SHEAR));
        weft_cloth_destroy(cloth);
    }
}

static inline void check_bits(const scenario *of, const outcome *a, const outcome *b)
{
    check_same(of, a, b);
    ck_assert(memcmp(a->y, b->y, numbers(of) * sizeof *a->y) == 0);
    ck_assert((a->saved == NULL) == (b->saved == NULL));
    if (a->saved != NULL) {
        ck_assert(memcmp(a->saved, b->saved, a->saved_size) == 0);
    }
}

static const int counts[] = { 1, 2, 3, 5 };
enum { COUNTS = sizeof counts / sizeof counts[0] };

/* On any number of bands what it is on none: on two of these numbers in turn, or on all
 * in `make nightly`. */
static inline void check_bands(const scenario *of)
{
    static size_t turn;
    outcome whole, parts;
    run_whole(of, &whole);
    for (int i = 0; i < test_rounds(2, COUNTS); ++i) {
        run_bands(of, counts[turn++ % COUNTS], &parts);
        check_bits(of, &whole, &parts);
        drop(&parts);
    }
    drop(&whole);
}

/* ---- scenarios ---------------------------------------------------------------------
 */

static const weft_pin pins[] = {
    { .rows = { 0, 0 }, .cols = { 0, -1 } },
    { .rows = { 2, -3 },
      .cols = { 0, 0 },
      .amplitude = { 0.02, 0.0, 0.03 },
      .frequency = 3.0 },
    { .rows = { 4, 6 },
      .cols = { 2, 3 },
      .velocity = { 0.1, 0.05, -0.2 },
      .path = { (const double[]){ 0.01, 0, 0, 0, 0.023, 0.001, 0, 0.002 }, 2 } },
};
static const weft_load loads[]
    = { { .rows = { 1, -2 }, .cols = { -1, -1 }, .mass = 0.004 },
        { .rows = { 5, 5 }, .cols = { 1, 2 }, .mass = 0.01 } };
static weft_shape shapes[SHAPES];

static inline scenario in_wind(size_t rows, size_t cols, const char *method)
{
    scenario of = { .cloth = weft_cloth_def_default(),
                    .sim = weft_sim_def_default(),
                    .duration = 0.04 };
    weft_cloth_def *def = &of.cloth;
    def->rows = rows, def->cols = cols;
    def->spacing[0] = 0.05, def->spacing[1] = 0.04;
    def->origin[0] = 0.1, def->origin[1] = 1.0 / 3.0;
    def->right[2] = 0.3;
    def->scale = 1.05;
    def->density = 0.3;
    def->velocity[0] = 0.1, def->velocity[2] = -0.3;
    def->loads = loads, def->load_count = 2;
    def->pins = pins, def->pin_count = 3;
    def->springs[WEFT_STRETCH] = (weft_spring_def){ true, 60.0, 0.03 };
    def->springs[WEFT_SHEAR] = (weft_spring_def){ true, 12.0, 0.01 };
    def->springs[WEFT_BEND] = (weft_spring_def){ true, 2.0, 0.005 };
    def->damping = 1e-3;
    static const double gust[] = { 0.0, 1.5, 0, 2, 0.017, 0, 0, 4, 0.05, 1, 1, 1 };
    def->wind_table = (weft_table){ gust, 3 };
    def->wind_drag = 0.4;
    of.sim.method = test_method_named(method);
    for (size_t k = 0; test_needs_damping(of.sim.method) && k < WEFT_FAMILIES; ++k) {
        def->springs[k].damping = 0.01 * def->springs[k].stiffness;
    }
    of.sim.config.rtol = 1e-5;
    of.sim.config.atol_position = of.sim.config.atol_velocity = 1e-4;
    of.sim.config = test_config(of.sim.method, of.sim.config);
    if ((of.sim.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        of.sim.config.fixed_step = 1e-3;
    }
    return of;
}

/* How far the lowest particle is above *z; of a band its own and its ghosts. */
static inline double lowest(void *z, const weft_cloth *cloth, double t, const double *y)
{
    const size_t n = weft_cloth_particles(cloth);
    double least = (double)INFINITY;
    (void)t;
    for (size_t i = 0; i < n; ++i) {
        least = fmin(least, y[2 * n + i]);
    }
    return least - *(const double *)z;
}

static inline scenario on_shapes(void)
{
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    shapes[0] = weft_shape_default(WEFT_PLANE);
    shapes[0].at[1] = -0.2;
    shapes[0].friction = 0.4;
    shapes[1] = weft_shape_default(WEFT_SPHERE);
    shapes[1].radius = 0.1;
    shapes[1].at[0] = 0.2, shapes[1].at[1] = 0.05, shapes[1].at[2] = -0.25;
    shapes[1].velocity[2] = 2.0;
    of.cloth.pin_count = 1;
    of.cloth.contact.shapes = shapes;
    of.cloth.contact.shape_count = SHAPES;
    of.duration = 0.12;
    return of;
}
