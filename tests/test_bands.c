/* SPDX-License-Identifier: BSD-3-Clause */
/* test_bands.c -- a cloth in bands of rows, one thread each, has the bits of the whole
 * cloth on any number of bands: all that series.csv holds, the state, what is saved,
 * and failures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../examples/thread_comm.h"
#include "support.h"

enum { BANDS = 5, FRAMES = 4, TEXT = 4096, SHAPES = 2 };

typedef enum oddity { NOTHING, WHOLE_CLOTH, NO_MEMORY, STOPS } oddity;

/* A run of a cloth, whole or in bands. */
typedef struct scenario {
    weft_cloth_def cloth;
    weft_sim_def sim;
    double duration;     /* [s] */
    const void *restore; /* bytes to begin with; NULL: none */
    size_t restore_size;
    size_t
        spoilt; /* 1 + the row in which a number becomes NaN after a frame; 0: none */
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
    bool *good;
    pthread_t thread; /* that alone makes calls */
} guard;

static const double poison = 0x1.badp300;

static size_t present(const weft_rows *rows)
{
    return (rows->above + rows->own + rows->below) * rows->cols;
}

/* Whether others have, or wait for, particle i of a plane. */
static bool exchanged(const weft_rows *rows, size_t i, bool *ghost)
{
    const size_t r = i / rows->cols, end = rows->above + rows->own;
    *ghost = r < rows->above || r >= end;
    return *ghost || (rows->above > 0 && r < rows->above + WEFT_GHOST_ROWS)
           || (rows->below > 0 && r + WEFT_GHOST_ROWS >= end);
}

static void guard_begin(void *self, const weft_rows *rows)
{
    guard *of = self;
    const size_t n = present(rows);
    bool ghost;
    of->rows = *rows;
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

static void guard_end(void *self)
{
    guard *of = self;
    const weft_rows *rows = &of->rows;
    const size_t n = present(rows);
    bool ghost;
    for (size_t j = 0; j < rows->planes * n; ++j) {
        const double *now = rows->first + j / n * rows->stride + j % n;
        if (exchanged(rows, j % n, &ghost)) {
            *of->good = *of->good && memcmp(now, of->before + j, sizeof *now) == 0;
        }
    }
    free(of->before);
    of->real.end(of->real.self);
}

static double guard_max(void *self, double mine)
{
    guard *of = self;
    *of->good = *of->good && !(mine < 0.0) && (isnan(mine) || !signbit(mine));
    return of->real.max(of->real.self, mine);
}

static void guard_share(void *self, void *data, size_t bytes)
{
    guard *of = self;
    of->real.share(of->real.self, data, bytes);
}

static void guard_gather(void *self, const void *mine, size_t bytes, void *all)
{
    guard *of = self;
    of->real.gather(of->real.self, mine, bytes, all);
}

static void guard_poke(void *self)
{
    guard *of = self;
    *of->good = *of->good && pthread_equal(pthread_self(), of->thread);
}

static weft_comm guarded(guard *of, const weft_comm *real, bool *good)
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
    return comm;
}

/* ---- a run -------------------------------------------------------------------------
 */

static void put(char *text, const char *name, double value)
{
    const size_t used = strlen(text);
    ck_assert_uint_lt(used + 64, TEXT);
    (void)snprintf(text + used, TEXT - used, "%s %a\n", name, value);
}

/* Numbers below 2^53, all bits of others. */
static void put_hash(char *text, uint64_t hash)
{
    put(text, "hash", (double)(hash >> 32));
    put(text, "hash", (double)(hash & UINT32_MAX));
}

static void put_measures(const weft_sim *sim, char *text)
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
    put_hash(text, m.hash);
}

static void put_stiffness(const weft_sim *sim, const double *y, char *text)
{
    const weft_stiffness of = weft_sim_stiffness(sim, weft_sim_time(sim), y);
    put(text, "omega2", of.omega2);
    put(text, "damping", of.damping);
    for (size_t i = 0; i < of.count; ++i) {
        put(text, "w", of.corners[i][0]);
        put(text, "c", of.corners[i][1]);
    }
}

static void put_frame(const weft_sim *sim, char *text)
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

/* The own rows, to their place in the whole. */
static void keep_state(const weft_sim *sim, double *whole)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const weft_band band = weft_cloth_band(cloth);
    const size_t cols = weft_cloth_cols(cloth), n = weft_cloth_particles(cloth);
    for (size_t k = 0; k < 6; ++k) {
        memcpy(whole + (k * band.rows + band.first) * cols,
               weft_sim_state(sim) + k * n + band.above * cols,
               band.own * cols * sizeof *whole);
    }
}

typedef struct job {
    const scenario *of;
    const weft_comm *comm; /* NULL: whole */
    outcome *out;
    int calls; /* of stop */
} job;

static bool is_odd(const job *self, oddity how)
{
    return self->of->odd == how
           && (self->comm == NULL || self->comm->rank == self->of->odd_band);
}

static void *refuse(void *ctx, void *block, size_t size)
{
    (void)ctx;
    return size == 0 ? (free(block), NULL) : NULL;
}

/* From the 20th evaluation on. */
static bool stop(void *calls)
{
    return ++*(int *)calls >= 20;
}

static weft_status start(job *self, weft_cloth **cloth, weft_sim **sim, weft_error *err)
{
    static const weft_allocator none = { refuse, NULL };
    weft_cloth_def model = self->of->cloth;
    weft_sim_def def = self->of->sim;
    const weft_comm *comm = def.comm = self->comm;
    if (comm != NULL && !is_odd(self, WHOLE_CLOTH)) {
        ck_assert(weft_comm_band(model.rows, (size_t)comm->rank, (size_t)comm->size,
                                 &model.band_first, &model.band_rows));
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
    return status;
}

/* The state belongs to the simulation: only an error in the program does this. */
static void spoil(const scenario *of, const weft_sim *sim)
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

static double frame_time(const scenario *of, size_t i)
{
    const double part = of->duration * (double)i / FRAMES;
    return of->restore == NULL ? part : of->duration + part;
}

static void *play(void *ctx)
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
        keep_state(sim, out->y);
        out->totals = weft_sim_totals(sim);
    }
    if (out->status == WEFT_OK) {
        const bool first = self->comm == NULL || self->comm->rank == 0;
        out->saved_size = weft_sim_save_size(sim);
        out->saved = first ? malloc(out->saved_size) : NULL;
        out->status
            = weft_sim_save(sim, out->saved, first ? out->saved_size : 0, &out->err);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return NULL;
}

static size_t numbers(const scenario *of)
{
    return 6 * of->cloth.rows * of->cloth.cols;
}

static void make(const scenario *of, outcome *out)
{
    memset(out, 0, sizeof *out);
    out->y = calloc(numbers(of), sizeof *out->y);
    out->guarded = true;
}

static void drop(outcome *out)
{
    free(out->y);
    free(out->saved);
}

static void check_same(const scenario *of, const outcome *a, const outcome *b)
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
    ck_assert_uint_eq(a->saved_size, b->saved_size);
    ck_assert_uint_eq(a->totals.particles, b->totals.particles);
    ck_assert_uint_eq(a->totals.pins, b->totals.pins);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        ck_assert_uint_eq(a->totals.springs[k], b->totals.springs[k]);
    }
    ck_assert(a->totals.mass == b->totals.mass);
}

/* The outcome of band 0, with the state of the whole; those of the others agree. */
static void run_bands(const scenario *of, int bands, outcome *out)
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

static void run_whole(const scenario *of, outcome *out)
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

static void check_bits(const scenario *of, const outcome *a, const outcome *b)
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
static void check_bands(const scenario *of)
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
    { .rows = { 4, 6 }, .cols = { 2, 3 }, .velocity = { 0.1, 0.05, -0.2 } },
};
static const weft_load loads[]
    = { { { 1, -2 }, { -1, -1 }, 0.004 }, { { 5, 5 }, { 1, 2 }, 0.01 } };
static weft_shape shapes[SHAPES];

static scenario in_wind(size_t rows, size_t cols, const char *method)
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
    def->drag = 1e-3;
    def->wind_velocity[0] = 1.5, def->wind_velocity[2] = 2.0;
    def->wind_drag = 0.4;
    of.sim.method = test_method_named(method);
    of.sim.config.rtol = 1e-5;
    of.sim.config.atol_position = of.sim.config.atol_velocity = 1e-4;
    of.sim.config = test_config(of.sim.method, of.sim.config);
    if ((of.sim.method->flags & WEFT_STEPPER_FIXED_ONLY) != 0) {
        of.sim.config.fixed_step = 1e-3;
    }
    return of;
}

START_TEST(every_method_that_agrees_has_the_same_bits)
{
    for (size_t i = 0; i < test_method_count(); ++i) {
        const weft_stepper_type *type = test_method(i);
        if ((type->flags & WEFT_STEPPER_AGREES) != 0 && !test_is_spared(type)) {
            const scenario of = in_wind(11, 6, test_method_label(i));
            check_bands(&of);
        }
    }
}
END_TEST

START_TEST(laws_rims_and_rigidity_have_the_same_bits)
{
    scenario of = in_wind(10, 5, "arkode/dormand_prince");
    of.cloth.law = WEFT_LAW_STRAIN;
    of.cloth.rim_half = true;
    of.cloth.across[WEFT_STRETCH] = (weft_spring_def){ true, 40.0, 0.02 };
    check_bands(&of);
    of.cloth.springs[WEFT_BEND].present = false;
    of.cloth.bending = (weft_bending_def){ .rigidity = { 2e-4, 1e-4 },
                                           .twist = -1.0,
                                           .damping = 1e-3 };
    check_bands(&of);
}
END_TEST

START_TEST(narrow_long_and_short_bands_have_the_same_bits)
{
    static const size_t sizes[][2] = { { 80, 4 }, { 10, 5 }, { 13, 33 }, { 14, 1 } };
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        scenario of = in_wind(sizes[i][0], sizes[i][1], "arkode/bogacki_shampine");
        of.cloth.pin_count = of.cloth.load_count = sizes[i][1] > 4 ? 2 : 0;
        check_bands(&of);
    }
}
END_TEST

/* Chunks of inner rows, on two threads of each band. */
START_TEST(threads_of_bands_have_the_same_bits)
{
    outcome whole, parts;
    scenario of = in_wind(170, 50, "arkode/dormand_prince");
    of.duration = 0.01;
    run_whole(&of, &whole);
    of.sim.config.threads = 2;
    run_bands(&of, 2, &parts);
    check_bits(&of, &whole, &parts);
    drop(&parts);
    drop(&whole);
}
END_TEST

static scenario on_shapes(void)
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

START_TEST(contact_has_the_same_bits)
{
    scenario of = on_shapes();
    outcome whole;
    check_bands(&of);
    run_whole(&of, &whole);
    ck_assert_ptr_nonnull(strstr(whole.series[FRAMES], "touching 0x1."));
    drop(&whole);
}
END_TEST

/* A step that one band finds to pass a shape is taken back by all. */
START_TEST(bands_take_steps_back_together)
{
    static const char *const methods[]
        = { "arkode/dormand_prince", "verlet/velocity_verlet" };
    for (size_t i = 0; i < 2; ++i) {
        scenario of = on_shapes();
        outcome whole;
        of.sim.method = test_method_named(methods[i]);
        of.sim.config = test_config(of.sim.method, of.sim.config);
        of.sim.config.fixed_step = i == 0 ? 0.0 : 1e-3;
        of.sim.config.rtol = of.sim.config.atol_position = of.sim.config.atol_velocity
            = 1.0;
        shapes[1].velocity[2] = 20.0;
        check_bands(&of);
        run_whole(&of, &whole);
        ck_assert_msg(strstr(whole.series[whole.frames - 1], "vetoed 0x0") == NULL,
                      "%s", whole.series[whole.frames - 1]);
        drop(&whole);
    }
}
END_TEST

static void check_failure(const scenario *of, weft_status status, const char *part)
{
    outcome whole;
    run_whole(of, &whole);
    ck_assert_int_eq(whole.status, status);
    ck_assert_msg(strstr(whole.err.message, part) != NULL, "%s", whole.err.message);
    drop(&whole);
    check_bands(of);
}

START_TEST(failures_have_the_message_of_the_whole)
{
    scenario of = in_wind(11, 6, "arkode/euler");
    of.sim.config.fixed_step = 0.05;
    of.duration = 40.0;
    check_failure(&of, WEFT_NOT_FINITE, "fastest particle");
    of = in_wind(11, 6, "verlet/velocity_verlet");
    of.sim.config.fixed_step = 0.05;
    of.duration = 40.0;
    check_failure(&of, WEFT_NOT_FINITE, "fastest particle");
    of = in_wind(11, 6, "arkode/dormand_prince");
    of.sim.config.rtol = of.sim.config.atol_position = of.sim.config.atol_velocity
        = 1e-13;
    of.sim.config.min_step = of.sim.config.first_step = 1e-3;
    check_failure(&of, WEFT_STEP_TOO_SMALL, "fastest particle");
    of = on_shapes();
    of.sim.config.min_step = of.sim.config.first_step = 2e-3;
    shapes[1].velocity[2] = 200.0;
    check_failure(&of, WEFT_STEP_TOO_SMALL, "cannot be kept out of shapes[1]");
}
END_TEST

START_TEST(nan_in_one_band_ends_all)
{
    for (size_t row = 1; row <= 11; row += 5) {
        scenario of = in_wind(
            11, 6, row == 1 ? "verlet/velocity_verlet" : "arkode/dormand_prince");
        outcome parts;
        of.spoilt = row;
        check_failure(&of, WEFT_NOT_FINITE, "fastest particle");
        of.own_only = true;
        for (int bands = 2; bands <= BANDS; bands += 3) {
            run_bands(&of, bands, &parts); /* all have the same */
            ck_assert_int_eq(parts.status, WEFT_NOT_FINITE);
            drop(&parts);
        }
    }
}
END_TEST

/* ---- random cloths ------------------------------------------------------------------
 */

static uint64_t random_state;

/* Below `most`: an LCG of Knuth's, its upper bits. */
static size_t below(size_t most)
{
    random_state = random_state * UINT64_C(6364136223846793005) + 1442695040888963407u;
    return (size_t)(random_state >> 33) % most;
}

static double between(double low, double high)
{
    return low + (high - low) * (double)below(1000) / 1000.0;
}

static weft_range some(size_t count)
{
    const size_t first = below(count), last = first + below(count - first);
    return (weft_range){ (ptrdiff_t)first, (ptrdiff_t)last };
}

static void randomise_contact(scenario *of)
{
    for (size_t k = 0; k < SHAPES; ++k) {
        shapes[k] = weft_shape_default(below(2) > 0 ? WEFT_SPHERE : WEFT_CAPSULE);
        shapes[k].radius = between(0.02, 0.1);
        shapes[k].to[0] = 0.3;
        for (size_t j = 0; j < 3; ++j) {
            const double at = between(-0.4, 0.4) - (j == 2 ? 0.5 : 0.0);
            shapes[k].to[j] += at;
            shapes[k].at[j] = at;
        }
        shapes[k].velocity[2] = between(0.0, 8.0);
    }
    of->cloth.contact.shapes = shapes;
    of->cloth.contact.shape_count = below(SHAPES + 1);
    of->cloth.contact.law = below(2) > 0 ? WEFT_FRICTION_COULOMB : WEFT_FRICTION_SMOOTH;
}

static scenario random_scenario(weft_pin some_pins[3], weft_load *load)
{
    static const char *const methods[]
        = { "arkode/dormand_prince",  "arkode/bogacki_shampine", "arkode/heun_euler",
            "verlet/velocity_verlet", "verlet/symplectic_euler", "arkode/rk4" };
    const size_t rows = 10 + below(12), cols = 1 + below(9);
    scenario of = in_wind(rows, cols, methods[below(6)]);
    const double tolerance = between(1e-6, 1e-1);
    of.sim.config.fixed_step
        = below(2) > 0 || of.sim.config.fixed_step > 0.0 ? between(1e-4, 2e-2) : 0.0;
    of.sim.config.rtol = tolerance;
    of.sim.config.atol_position = of.sim.config.atol_velocity = tolerance;
    of.sim.config.min_step = between(1e-9, 1e-3);
    of.cloth.law = below(2) > 0 ? WEFT_LAW_STRAIN : WEFT_LAW_HOOKE;
    of.cloth.rim_half = below(2) > 0;
    of.cloth.springs[WEFT_BEND].present = below(2) > 0;
    if (!of.cloth.springs[WEFT_BEND].present) {
        of.cloth.bending.rigidity[0] = 1e-4;
        of.cloth.bending.damping = between(0.0, 1e-3);
    }
    for (size_t i = 0; i < 3; ++i) {
        some_pins[i] = (weft_pin){ .rows = some(rows),
                                   .cols = some(cols),
                                   .velocity = { 0.0, 0.1, between(-1.0, 1.0) },
                                   .amplitude = { between(0.0, 0.05) },
                                   .frequency = between(0.0, 9.0) };
    }
    *load = (weft_load){ some(rows), some(cols), 0.01 };
    of.cloth.pins = some_pins, of.cloth.pin_count = below(4);
    of.cloth.loads = load, of.cloth.load_count = below(2);
    of.cloth.wind_drag = below(2) > 0 ? 0.4 : 0.0;
    of.cloth.drag = below(2) > 0 ? 1e-3 : 0.0;
    randomise_contact(&of);
    return of;
}

/* Many of them fail: in all bands alike. */
START_TEST(random_cloths_have_the_same_bits_or_failures)
{
    for (int i = 0; i < test_rounds(12, 400); ++i) {
        weft_pin some_pins[3];
        weft_load load;
        weft_cloth *cloth = NULL;
        random_state = (uint64_t)i;
        const scenario of = random_scenario(some_pins, &load);
        if (weft_cloth_create(&of.cloth, &cloth, NULL) == WEFT_OK) {
            check_bands(&of);
        }
        weft_cloth_destroy(cloth);
    }
}
END_TEST

static void check_odd(scenario *of, oddity odd, weft_status status, const char *message)
{
    of->odd = odd;
    for (int bands = 2; bands <= 3; ++bands) {
        for (of->odd_band = 0; of->odd_band < bands; ++of->odd_band) {
            outcome parts;
            run_bands(of, bands, &parts);
            ck_assert_int_eq(parts.status, status);
            ck_assert_msg(strstr(parts.err.message, message) != NULL, "%s",
                          parts.err.message);
            drop(&parts);
        }
    }
}

START_TEST(what_fails_in_one_band_fails_in_all)
{
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    check_odd(&of, WHOLE_CLOTH, WEFT_INVALID,
              "the cloth has rows 0 to 10 of 11; band ");
    check_odd(&of, NO_MEMORY, WEFT_NO_MEMORY, "no memory");
}
END_TEST

START_TEST(stop_in_one_band_stops_all)
{
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    outcome whole, parts;
    of.odd = STOPS;
    run_whole(&of, &whole);
    ck_assert_int_eq(whole.status, WEFT_STOPPED);
    for (of.odd_band = 0; of.odd_band < 3; ++of.odd_band) {
        run_bands(&of, 3, &parts);
        check_bits(&of, &whole, &parts);
        drop(&parts);
    }
    drop(&whole);
}
END_TEST

/* ---- refusals ----------------------------------------------------------------------
 */

static bool correct(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h, (void)y;
    return false;
}

static int force(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)t, (void)y, (void)f;
    return 0;
}

static void check_refused(weft_sim_def def, weft_status status, const char *message)
{
    weft_sim *sim = NULL;
    weft_error err = { .status = WEFT_OK };
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), status);
    ck_assert_ptr_null(sim);
    ck_assert_msg(strstr(err.message, message) != NULL, "%s", err.message);
}

START_TEST(refuses_what_needs_the_whole_state)
{
    thread_bands *all = thread_bands_create(1);
    const weft_comm comm = thread_bands_comm(all, 0);
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    weft_sim_def def = of.sim, good;
    weft_cloth *cloth = test_cloth(&of.cloth);
    def.cloth = cloth;
    def.comm = &comm;
    good = def;
    for (size_t i = 0; i < test_method_count(); ++i) {
        def.method = test_method(i);
        def.config = test_config(def.method, good.config);
        if ((def.method->flags & WEFT_STEPPER_AGREES) == 0) {
            check_refused(def, WEFT_UNSUPPORTED, def.method->name);
        }
    }
    def = good, def.config.norm = WEFT_NORM_RMS;
    check_refused(def, WEFT_UNSUPPORTED, "rms norm");
    def = good, def.limit.method = WEFT_LIMIT_PROVOT;
    check_refused(def, WEFT_UNSUPPORTED, "strain limit");
    def = good, def.ledger = true;
    check_refused(def, WEFT_UNSUPPORTED, "ledger");
    def = good, def.correct = correct;
    check_refused(def, WEFT_UNSUPPORTED, "`correct`");
    def = good, def.force = force;
    check_refused(def, WEFT_UNSUPPORTED, "`force`");
    weft_cloth_destroy(cloth);
    thread_bands_destroy(all);
}
END_TEST

START_TEST(refuses_a_comm_that_is_not_whole)
{
    thread_bands *all = thread_bands_create(1);
    const weft_comm good = thread_bands_comm(all, 0);
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    weft_cloth *whole = test_cloth(&of.cloth);
    weft_sim_def def = of.sim;
    weft_comm comm = good;
    def.cloth = whole;
    def.comm = &comm;
    comm.max = NULL;
    check_refused(def, WEFT_INVALID, "lacks a function");
    comm = good, comm.rank = 1;
    check_refused(def, WEFT_INVALID, "rank");
    comm = good, comm.struct_size = 16;
    check_refused(def, WEFT_INVALID, "struct_size");
    of.cloth.band_first = 4, of.cloth.band_rows = 3;
    weft_cloth *band = test_cloth(&of.cloth);
    comm = good, def.cloth = band;
    check_refused(def, WEFT_INVALID,
                  "has rows 4 to 6 of 11; band 0 of 1 is rows 0 to 10");
    def.comm = NULL;
    check_refused(def, WEFT_INVALID, "rows 4 to 6 of 11: its simulation needs a comm");
    weft_cloth_destroy(band);
    weft_cloth_destroy(whole);
    thread_bands_destroy(all);
}
END_TEST

START_TEST(refuses_changes_from_outside)
{
    thread_bands *all = thread_bands_create(1);
    const weft_comm comm = thread_bands_comm(all, 0);
    scenario of = on_shapes();
    weft_cloth *cloth = test_cloth(&of.cloth);
    weft_sim *sim;
    weft_error err;
    const double zero[3] = { 0.0 };
    const weft_shape shape = weft_shape_default(WEFT_SPHERE);
    of.sim.cloth = cloth;
    of.sim.comm = &comm;
    ck_assert_int_eq(weft_sim_create(&of.sim, &sim, &err), WEFT_OK);
    const weft_status statuses[] = { weft_sim_set_state(sim, NULL, NULL, &err),
                                     weft_sim_pin(sim, 40, zero, &err),
                                     weft_sim_unpin(sim, 0, &err),
                                     weft_sim_move_pin(sim, 0, zero, &err),
                                     weft_sim_add_shape(sim, &shape, NULL, &err),
                                     weft_sim_move_shape(sim, 0, zero, zero, &err),
                                     weft_sim_remove_shape(sim, 0, &err) };
    for (size_t i = 0; i < sizeof statuses / sizeof statuses[0]; ++i) {
        ck_assert_msg(statuses[i] == WEFT_UNSUPPORTED, "%zu", i);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    thread_bands_destroy(all);
}
END_TEST

/* ---- the cloth of a band ------------------------------------------------------------
 */

static void check_bad_band(size_t rows, size_t first, size_t count, const char *message)
{
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth;
    weft_error err;
    def.rows = rows, def.band_first = first, def.band_rows = count;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, message) != NULL, "%s", err.message);
}

START_TEST(band_lies_inside_and_has_two_rows)
{
    check_bad_band(6, 2, 1, "2 or more");
    check_bad_band(6, 5, 2, "inside");
    check_bad_band(6, 0, 7, "inside");
    check_bad_band(6, SIZE_MAX, 2, "inside");
    check_bad_band(6, 2, SIZE_MAX, "inside");
}
END_TEST

START_TEST(band_counts_its_own_rows)
{
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    of.cloth.rim_half = true;
    weft_cloth *whole = test_cloth(&of.cloth);
    size_t pinned = 0, springs[WEFT_FAMILIES] = { 0 };
    double mass = 0.0;
    for (size_t rank = 0; rank < 4; ++rank) {
        ck_assert(
            weft_comm_band(11, rank, 4, &of.cloth.band_first, &of.cloth.band_rows));
        weft_cloth *part = test_cloth(&of.cloth);
        const weft_band band = weft_cloth_band(part);
        ck_assert_uint_eq(band.first, of.cloth.band_first);
        ck_assert_uint_eq(band.own, of.cloth.band_rows);
        ck_assert_uint_eq(band.above, rank > 0 ? 2 : 0);
        ck_assert_uint_eq(band.below, rank < 3 ? 2 : 0);
        ck_assert_uint_eq(weft_cloth_rows(part), band.above + band.own + band.below);
        for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
            springs[k] += weft_cloth_springs(part, (weft_family)k);
        }
        pinned += weft_cloth_pins(part);
        mass += weft_cloth_mass(part);
        weft_cloth_destroy(part);
    }
    ck_assert(!weft_comm_band(11, 4, 4, &of.cloth.band_first, &of.cloth.band_rows));
    ck_assert(!weft_comm_band(11, 0, 6, &of.cloth.band_first, &of.cloth.band_rows));
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        ck_assert_uint_eq(springs[k], weft_cloth_springs(whole, (weft_family)k));
    }
    ck_assert_uint_eq(pinned, weft_cloth_pins(whole));
    ck_assert_double_eq_tol(mass, weft_cloth_mass(whole), 1e-15);
    weft_cloth_destroy(whole);
}
END_TEST

START_TEST(errors_name_rows_of_the_whole)
{
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    weft_cloth *cloth;
    weft_error err;
    of.cloth.band_first = 6, of.cloth.band_rows = 2;
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    of.cloth.contact.shapes = shapes, of.cloth.contact.shape_count = 1;
    of.cloth.pin_count = 0;
    of.cloth.scale = 1.0;
    shapes[0].radius = 0.01;
    weft_cloth *other;
    of.cloth.contact.shape_count = 0;
    other = test_cloth(&of.cloth);
    double *xyz = malloc(3 * weft_cloth_particles(other) * sizeof *xyz);
    weft_cloth_rest(other, xyz);
    memcpy(shapes[0].at, xyz + 3 * (3 * 6 + 4), sizeof shapes[0].at);
    of.cloth.contact.shape_count = 1; /* row 3 here is row 4 + 3 */
    ck_assert_int_eq(weft_cloth_create(&of.cloth, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, "particle (7, 4) is 10 mm inside shapes[0]")
                      != NULL,
                  "%s", err.message);
    free(xyz);
    weft_cloth_destroy(other);
}
END_TEST

/* ---- restoring ---------------------------------------------------------------------
 */

START_TEST(saved_bands_restore_on_any_number)
{
    scenario of = on_shapes();
    outcome saved, whole, parts;
    run_bands(&of, 3, &saved);
    of.restore = saved.saved, of.restore_size = saved.saved_size;
    run_whole(&of, &whole);
    ck_assert_int_eq(whole.status, WEFT_OK);
    for (size_t i = 0; i < COUNTS; ++i) {
        run_bands(&of, counts[i], &parts);
        check_bits(&of, &whole, &parts);
        drop(&parts);
    }
    drop(&whole);
    drop(&saved);
}
END_TEST

START_TEST(damaged_bytes_are_refused_by_all)
{
    scenario of = on_shapes();
    outcome saved;
    run_bands(&of, 3, &saved);
    of.restore = saved.saved, of.restore_size = saved.saved_size;
    saved.saved[saved.saved_size / 2] ^= 1;
    check_failure(&of, WEFT_INVALID, "damaged");
    saved.saved[saved.saved_size / 2] ^= 1;
    of.cloth.density *= 2.0; /* rows of another cloth */
    check_failure(&of, WEFT_INVALID, "another cloth");
    drop(&saved);
}
END_TEST

TEST_SUITE(bands)
{
    Suite *suite = suite_create("bands");
    TCase *same = tcase_create("same bits");
    tcase_set_timeout(same, 120);
    tcase_add_test(same, every_method_that_agrees_has_the_same_bits);
    tcase_add_test(same, laws_rims_and_rigidity_have_the_same_bits);
    tcase_add_test(same, narrow_long_and_short_bands_have_the_same_bits);
    tcase_add_test(same, threads_of_bands_have_the_same_bits);
    tcase_add_test(same, contact_has_the_same_bits);
    tcase_add_test(same, bands_take_steps_back_together);
    tcase_add_test(same, failures_have_the_message_of_the_whole);
    tcase_add_test(same, nan_in_one_band_ends_all);
    tcase_add_test(same, random_cloths_have_the_same_bits_or_failures);
    tcase_add_test(same, what_fails_in_one_band_fails_in_all);
    tcase_add_test(same, stop_in_one_band_stops_all);
    tcase_add_test(same, saved_bands_restore_on_any_number);
    tcase_add_test(same, damaged_bytes_are_refused_by_all);
    suite_add_tcase(suite, same);
    TCase *alone = tcase_create("one band");
    tcase_add_test(alone, refuses_what_needs_the_whole_state);
    tcase_add_test(alone, refuses_a_comm_that_is_not_whole);
    tcase_add_test(alone, refuses_changes_from_outside);
    tcase_add_test(alone, band_lies_inside_and_has_two_rows);
    tcase_add_test(alone, band_counts_its_own_rows);
    tcase_add_test(alone, errors_name_rows_of_the_whole);
    suite_add_tcase(suite, alone);
    return suite;
}
