/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow together asan-long */
/* test_embed.c -- what an embedding program hooks in: force, correction, log, threads.
 */
#include "embedded.h"

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

static void use_method(int i)
{
    run.method = test_method((size_t)i);
    run.config = weft_stepper_config_default();
    if ((run.method->flags & (WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_IMPLICIT)) != 0) {
        run.config.fixed_step = 1e-3;
    }
}

/* ---- force --------------------------------------------------------------------- */

typedef struct push {
    double f[3]; /* [N] on every particle */
    int answer;
    double from; /* [s] answered with from then on */
    size_t calls;
} push;

static int push_all(void *ctx, double t, const double *y, double *f)
{
    push *with = ctx;
    (void)y;
    ++with->calls;
    for (size_t j = 0; j < 3 * N; ++j) {
        ck_assert(f[j] == 0.0);
        f[j] += with->f[j / N];
    }
    return t < with->from ? 0 : with->answer;
}

/* Without springs and weight x = F t^2 / (2 m): exact for a method of order 2. */
START_TEST(force_accelerates_free_particles_and_no_others)
{
    push with = { .f = { 1.0, -2.0, 0.5 } };
    double x[3 * N], rest[3 * N];
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        model.springs[f].present = false;
    }
    memset(model.gravity, 0, sizeof model.gravity);
    run.force = push_all;
    run.force_ctx = &with;
    run.ledger = true;
    start();
    weft_cloth_rest(cloth, rest);
    go(0.5);
    weft_sim_positions(sim, x);
    for (size_t j = 0; j < 3 * N; ++j) {
        const double moved = j < 3 ? 0.0 : 0.5 * with.f[j % 3] / 0.25 * 0.25;
        ck_assert_double_eq_tol(x[j] - rest[j], moved, 1e-13);
    }
    const weft_ledger ledger = weft_sim_ledger(sim);
    ck_assert_double_gt(ledger.work_force, 1.0);
    ck_assert_double_eq_tol(ledger.work_force, ledger.energy.kinetic, 1e-12);
    ck_assert_double_eq_tol(ledger.residual, 0.0, 1e-12);
}
END_TEST

/* Weight as a force of one's own: the cloth swings as under gravity. */
START_TEST(every_method_sees_the_force)
{
    if (test_is_spared(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    push with = { .f = { 0.0, -0.25 * 9.81, 0.0 } };
    double x[3 * N], wanted[3 * N];
    use_method(_i);
    start();
    go(0.05);
    weft_sim_positions(sim, wanted);
    memset(model.gravity, 0, sizeof model.gravity);
    run.force = push_all;
    run.force_ctx = &with;
    start();
    go(0.05);
    weft_sim_positions(sim, x);
    for (size_t j = 0; j < 3 * N; ++j) {
        ck_assert_double_eq_tol(x[j], wanted[j], 1e-8);
    }
    ck_assert_uint_eq(with.calls, weft_sim_stats(sim).rhs_calls);
}
END_TEST

START_TEST(force_may_stop_a_run_and_the_state_is_the_last_good_one)
{
    if (test_is_spared(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    push with = { .answer = -1, .from = 0.01 };
    weft_error err = { 0 };
    double y[6 * N];
    use_method(_i);
    run.force = push_all;
    run.force_ctx = &with;
    start();
    weft_status status = WEFT_OK;
    while (status == WEFT_OK && weft_sim_time(sim) < 1.0) {
        memcpy(y, weft_sim_state(sim), sizeof y);
        status = weft_sim_step(sim, 1.0, &err);
    }
    ck_assert_int_eq(status, WEFT_STOPPED);
    ck_assert_double_le(weft_sim_time(sim), 0.012);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    const char *told = strstr(err.message, " t = "); /* once, by whomever */
    ck_assert_ptr_nonnull(told);
    ck_assert_msg(strstr(told + 1, " t = ") == NULL, "%s", err.message);
    with.answer = 0; /* and it may go on */
    go(0.02);
}
END_TEST

/* At the n-th evaluation, once. */
static bool stop_once(void *ctx)
{
    size_t *left = ctx;
    return *left > 0 && --*left == 0;
}

START_TEST(stop_gives_up_a_step_and_a_later_one_goes_on)
{
    if (test_is_spared(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    size_t left = 9;
    double y[6 * N], undisturbed[6 * N];
    use_method(_i);
    start();
    go(0.02);
    memcpy(undisturbed, weft_sim_state(sim), sizeof y);
    run.stop = stop_once;
    run.stop_ctx = &left;
    start();
    weft_status status = WEFT_OK;
    double t = 0.0;
    while (status == WEFT_OK && weft_sim_time(sim) < 0.02) {
        t = weft_sim_time(sim);
        memcpy(y, weft_sim_state(sim), sizeof y);
        status = weft_sim_step(sim, 0.02, NULL);
    }
    ck_assert_int_eq(status, WEFT_STOPPED);
    ck_assert(weft_sim_time(sim) == t);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
    go(0.02);
    for (size_t j = 0; j < 6 * N; ++j) {
        ck_assert_double_eq_tol(weft_sim_state(sim)[j], undisturbed[j], 1e-5);
    }
}
END_TEST

START_TEST(force_that_is_no_number_is_never_accepted)
{
    if (test_is_spared(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    push with = { .f = { NAN, 0.0, 0.0 } };
    double y[6 * N];
    use_method(_i);
    run.force = push_all;
    run.force_ctx = &with;
    start();
    memcpy(y, weft_sim_state(sim), sizeof y);
    ck_assert_int_ne(weft_sim_step(sim, 1.0, NULL), WEFT_OK);
    ck_assert(weft_sim_time(sim) == 0.0);
    ck_assert_mem_eq(y, weft_sim_state(sim), sizeof y);
}
END_TEST

/* Pushes every particle, and one of them nowhere from a time on. */
typedef struct fault {
    size_t at;
    double from;
} fault;

static int push_wrongly(void *ctx, double t, const double *y, double *f)
{
    const fault *of = ctx;
    (void)y;
    for (size_t i = 0; i < N; ++i) {
        f[2 * N + i] += 0.01 * (double)(i + 1);
    }
    f[N + of->at] = t > of->from ? NAN : 0.0;
    return 0;
}

START_TEST(force_that_is_no_number_is_reported_with_its_particle)
{
    if (test_is_spared(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    fault with = { .at = COLS + 1, .from = 0.01 };
    weft_error err = { 0 };
    weft_failure failure;
    use_method(_i);
    run.force = push_wrongly;
    run.force_ctx = &with;
    start();
    ck_assert_int_ne(weft_sim_advance(sim, 1.0, &err), WEFT_OK);
    ck_assert(weft_sim_failure(sim, &failure));
    ck_assert(failure.force);
    ck_assert_uint_eq(failure.force_particle, COLS + 1);
    ck_assert_uint_ne(failure.particle, COLS + 1); /* the fastest */
    ck_assert_double_nan(failure.added[1]);
    ck_assert_ptr_nonnull(strstr(err.message,
                                 "; the own force on particle (1, 1) is (0, "
                                 "nan, "));
    ck_assert_ptr_null(strstr(err.message, "fastest"));
}
END_TEST

START_TEST(failure_without_a_fault_of_the_force_names_none)
{
    fault with = { .at = COLS + 1, .from = INFINITY };
    weft_failure failure;
    run.force = push_wrongly;
    run.force_ctx = &with;
    run.config.fixed_step = 1.0; /* far beyond what is stable */
    start();
    ck_assert_int_ne(weft_sim_advance(sim, 1e4, NULL), WEFT_OK);
    ck_assert(weft_sim_failure(sim, &failure));
    ck_assert(!failure.force && failure.force_particle == 0);
    ck_assert(failure.added[0] == 0.0 && failure.added[2] == 0.0);
}
END_TEST

START_TEST(force_that_is_no_number_on_a_pinned_particle_does_nothing)
{
    fault with = { .at = 0, .from = 0.0 };
    run.force = push_wrongly;
    run.force_ctx = &with;
    start();
    ck_assert(weft_cloth_pinned(weft_sim_cloth(sim), 0));
    go(0.02);
}
END_TEST

/* ---- correction and log ------------------------------------------------------------
 */

static bool above_floor(void *ctx, double t, double h, double *y)
{
    const double floor = *(const double *)ctx;
    bool changed = false;
    (void)t;
    (void)h;
    for (size_t i = N; i < 2 * N; ++i) {
        if (!(y[i] >= floor)) {
            y[i] = floor;
            y[3 * N + i] = 0.0;
            changed = true;
        }
    }
    return changed;
}

START_TEST(correction_comes_after_the_limit)
{
    double floor = -2.2, x[3 * N];
    bool touched = false;
    run.correct = above_floor;
    run.correct_ctx = &floor;
    run.limit.method = WEFT_LIMIT_PROVOT;
    start();
    for (int step = 1; step <= 500; ++step) {
        go(step * 1e-3);
        weft_sim_positions(sim, x);
        for (size_t i = 0; i < N; ++i) {
            ck_assert_double_ge(x[3 * i + 1], floor);
            touched = touched || x[3 * i + 1] == floor;
        }
    }
    ck_assert(touched);
    ck_assert_uint_gt(weft_sim_limit_stats(sim).corrected, 0);
}
END_TEST

START_TEST(correction_that_spoils_the_state_is_told_with_the_particle)
{
    double floor = NAN; /* of all; the first one is named */
    weft_error err = { 0 };
    run.correct = above_floor;
    run.correct_ctx = &floor;
    start();
    ck_assert_int_eq(weft_sim_step(sim, 1.0, &err), WEFT_NOT_FINITE);
    ck_assert_ptr_nonnull(strstr(err.message,
                                 "the correction left a state that is not finite: y of "
                                 "particle (0, 0) is nan at t = "
                                 "0.001 s, last h = 0.001 s;"));
}
END_TEST

typedef struct heard {
    size_t count[WEFT_LOG_WARNING + 1];
    char last[256];
} heard;

static void listen(void *ctx, weft_log_level level, const char *text)
{
    heard *to = ctx;
    ++to->count[level];
    (void)snprintf(to->last, sizeof to->last, "%s", text);
    ck_assert_ptr_null(strchr(text, '\n'));
}

/* ---- what a callback may not do ------------------------------------------------ */

static const weft_run_def quarter
    = { .duration = 0.25, .fps = 10.0, .threads = 1, .checkpoint = 2 };

enum { STOP, FORCE, CORRECT, EVENT, LOG, PUT, GET, TELL, FRAME, STEP, CALLBACKS };

static unsigned char bytes[16384];
static size_t refusals;
static int meddler; /* the callback that meddles; CALLBACKS: none */

static void refused(weft_status status, const weft_error *err, const char *function,
                    const char *from)
{
    char text[80];
    (void)snprintf(text, sizeof text, "%s may not be called from %s", function, from);
    ck_assert_int_eq(status, WEFT_INVALID);
    ck_assert_str_eq(err->message, text);
    ++refusals;
}

static weft_status no_put(void *ctx, uint64_t at, const void *from, size_t size,
                          weft_error *err)
{
    (void)ctx, (void)at, (void)from, (void)size;
    return weft_error_set(err, WEFT_IO, "called");
}

static weft_status no_get(void *ctx, uint64_t at, void *to, size_t size,
                          weft_error *err)
{
    (void)ctx, (void)at, (void)to, (void)size;
    return weft_error_set(err, WEFT_IO, "called");
}

static weft_status no_frame(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i;
    return weft_error_set(err, WEFT_IO, "called");
}

#define REFUSED(function, from, ...)                                                   \
    refused(function(sim, __VA_ARGS__, &why), &why, #function, from)

static void try_to_step(const char *from)
{
    static const weft_run_def second = { .duration = 9.0, .fps = 1.0 };
    const weft_play frames = { .run = &second, .last = 9, .frame = no_frame };
    weft_error why = { 0 };
    REFUSED(weft_sim_step, from, 9.0);
    refused(weft_sim_advance(sim, 9.0, &why), &why, "weft_sim_step", from);
    REFUSED(weft_sim_play, from, &frames);
    REFUSED(weft_sim_restore, from, bytes, sizeof bytes);
    REFUSED(weft_sim_restore_parts, from, no_get, NULL, sizeof bytes);
}

/* Calls every function that changes or saves the simulation. */
static void meddle(int callback)
{
    static const char from[] = "a callback";
    static const double place[3], y[6 * N];
    const weft_shape shape = weft_shape_default(WEFT_SPHERE);
    weft_error why = { 0 };
    double within[6 * N];
    if (callback != meddler) {
        return;
    }
    try_to_step(from);
    REFUSED(weft_sim_between, from, weft_sim_time(sim), within);
    REFUSED(weft_sim_set_state, from, y, y);
    REFUSED(weft_sim_pin, from, 5, NULL);
    REFUSED(weft_sim_move_pin, from, 0, place);
    REFUSED(weft_sim_unpin, from, 0);
    REFUSED(weft_sim_add_shape, from, &shape, NULL);
    REFUSED(weft_sim_move_shape, from, 0, place, NULL);
    REFUSED(weft_sim_drive_shape, from, 0, &shape);
    REFUSED(weft_sim_remove_shape, from, 0);
    refused(weft_sim_restart(sim, &why), &why, "weft_sim_restart", from);
    REFUSED(weft_sim_save, from, bytes, sizeof bytes);
    REFUSED(weft_sim_save_parts, from, no_put, NULL);
}

static bool stop(void *ctx)
{
    (void)ctx;
    meddle(STOP);
    return false;
}

static int force(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)t, (void)y, (void)f;
    meddle(FORCE);
    return 0;
}

static bool correction(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h, (void)y;
    meddle(CORRECT);
    return false;
}

static double event(void *ctx, const weft_cloth *of, double t, const double *y)
{
    (void)ctx, (void)of, (void)y;
    meddle(EVENT);
    return 0.01 - t;
}

static void hear(void *ctx, weft_log_level level, const char *text)
{
    (void)ctx, (void)text;
    if (level != WEFT_LOG_INFO) { /* of weft_sim_create */
        meddle(LOG);
    }
}

static weft_status put(void *ctx, uint64_t at, const void *from, size_t size,
                       weft_error *err)
{
    (void)ctx, (void)err;
    ck_assert_uint_le(at + size, sizeof bytes);
    memcpy(bytes + at, from, size);
    meddle(PUT);
    return WEFT_OK;
}

static weft_status get(void *ctx, uint64_t at, void *to, size_t size, weft_error *err)
{
    (void)ctx, (void)err;
    memcpy(to, bytes + at, size);
    meddle(GET);
    return WEFT_OK;
}

static void tell(void *ctx, const char *name, const char *value)
{
    (void)ctx;
    meddle(TELL);
    ck_assert_uint_gt(strlen(name) + strlen(value), 0);
}

static weft_status frame(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i, (void)err;
    if (weft_sim_is_between(sim)) {
        meddle(FRAME);
    }
    return WEFT_OK;
}

static bool each_step(void *ctx)
{
    (void)ctx;
    meddle(STEP);
    return true;
}

/* A run that calls all callbacks that it has. */
static uint64_t run_through(void)
{
    static const weft_run_def short_run = { .duration = 0.02, .fps = 700.0 };
    const weft_play frames
        = { .run = &short_run, .last = 14, .frame = frame, .step = each_step };
    weft_error err = { 0 };
    refusals = 0;
    start();
    ck_assert_msg(weft_sim_play(sim, &frames, &err) == WEFT_OK, "%s", err.message);
    ck_assert_int_eq(weft_sim_save_parts(sim, put, NULL, &err), WEFT_OK);
    const size_t size = weft_sim_save_size(sim);
    ck_assert_msg(weft_sim_restore_parts(sim, get, NULL, size, &err) == WEFT_OK, "%s",
                  err.message);
    weft_sim_options(sim, tell, NULL);
    ck_assert_int_eq(weft_sim_unpin(sim, 0, &err), WEFT_OK); /* between steps */
    return weft_sim_measure(sim).hash;
}

static void has_no_comma(void *ctx, const char *name, const char *value)
{
    (void)name;
    ck_assert_msg(strchr(value, ',') == NULL, "%s=%s", name, value);
    *(bool *)ctx |= strchr(value, '.') != NULL;
}

START_TEST(numbers_in_texts_have_points_in_any_locale)
{
    weft_error err = { 0 };
    bool point = false;
    if (!test_comma_locale()) {
        return;
    }
    char own[16];
    (void)snprintf(own, sizeof own, "%g", 0.5);
    ck_assert_str_eq(own, "0,5");
    start();
    ck_assert_int_eq(weft_sim_step(sim, -0.5, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "step from 0 s to -0.5 s");
    for (size_t i = 0; i < test_method_count(); ++i) {
        if (!test_needs_damping(test_method(i)) && !test_is_spared(test_method(i))) {
            use_method((int)i);
            run.config.fixed_step
                = test_adaptive_only(run.method) ? 0.0 : run.config.fixed_step;
            start();
            weft_sim_options(sim, has_no_comma, &point);
        }
    }
#ifdef HAVE_GSL
    ck_assert(point); /* safety=0.9 */
#endif
    weft_sim_destroy(sim);
    sim = NULL;
}
END_TEST

START_TEST(no_callback_can_change_or_save_its_simulation)
{
    if (!test_is_typical(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    use_method(_i);
    const weft_sim_def plain = run;
    for (int k = 0; k < CALLBACKS; ++k) {
        run = plain;
        run.interpolate = k == FRAME || k == STEP;
        run.stop = k == STOP ? stop : NULL;
        run.force = k == FORCE ? force : NULL;
        run.correct = k == CORRECT ? correction : NULL;
        run.event = k == EVENT ? event : NULL;
        if (k == LOG) { /* a limit that cannot be met is logged */
            run.log.write = hear;
            run.limit.method = WEFT_LIMIT_PROVOT;
            run.limit.strain = 0.0;
            run.limit.sweeps = 1;
            run.limit.tolerance = 1e-12;
        }
        meddler = CALLBACKS;
        const uint64_t hash = run_through();
        ck_assert_uint_eq(refusals, 0);
        meddler = k;
        ck_assert_uint_eq(run_through(), hash);
        ck_assert(refusals >= 16 || k == TELL || k == FRAME);
        meddler = CALLBACKS;
    }
}
END_TEST

static void hold_and_release(void)
{
    weft_error why = { 0 };
    try_to_step("a callback of weft_sim_play");
    ck_assert_int_eq(weft_sim_pin(sim, 5, NULL, &why), WEFT_OK);
    ck_assert_int_eq(weft_sim_unpin(sim, 5, &why), WEFT_OK);
}

static weft_status change_at_frame(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i, (void)err;
    hold_and_release();
    return WEFT_OK;
}

static bool change_after_step(void *ctx)
{
    (void)ctx;
    hold_and_release();
    return true;
}

static weft_status change_at_checkpoint(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i;
    hold_and_release();
    return weft_sim_save(sim, bytes, sizeof bytes, err);
}

START_TEST(callbacks_of_a_play_may_change_between_steps_but_not_step)
{
    static const weft_run_def tenth = { .duration = 0.1, .fps = 40.0, .checkpoint = 2 };
    const weft_play frames = { .run = &tenth,
                               .last = 4,
                               .frame = change_at_frame,
                               .checkpoint = change_at_checkpoint,
                               .step = change_after_step };
    weft_error err = { 0 };
    refusals = 0;
    start();
    ck_assert_msg(weft_sim_play(sim, &frames, &err) == WEFT_OK, "%s", err.message);
    ck_assert_uint_eq(refusals, 5 * (5 + 1 + weft_sim_stats(sim).steps));
}
END_TEST

START_TEST(play_without_frames_or_of_no_length_is_refused)
{
    const weft_play good = { .run = &quarter, .last = 3, .frame = no_frame };
    const double wrong[] = { NAN, 0.0, -1.0, INFINITY };
    weft_error err = { 0 };
    weft_play bad = good;
    start();
    ck_assert_int_eq(weft_sim_play(sim, &good, &err), WEFT_IO);
    ck_assert_int_eq(weft_sim_play(sim, NULL, &err), WEFT_INVALID);
    bad.frame = NULL;
    ck_assert_int_eq(weft_sim_play(sim, &bad, &err), WEFT_INVALID);
    bad = (weft_play){ .last = 3, .frame = no_frame };
    ck_assert_int_eq(weft_sim_play(sim, &bad, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "weft_sim_play needs a run and a frame callback");
    for (size_t i = 0; i < 2 * 4; ++i) {
        weft_run_def odd = quarter;
        *(i % 2 == 0 ? &odd.fps : &odd.duration) = wrong[i / 2];
        bad = good;
        bad.run = &odd;
        ck_assert_int_eq(weft_sim_play(sim, &bad, &err), WEFT_INVALID);
        ck_assert_ptr_nonnull(strstr(err.message, "must be finite and > 0"));
    }
    ck_assert(weft_sim_time(sim) == 0.0);
}
END_TEST

START_TEST(limit_that_is_not_met_is_told_once)
{
    heard all = { { 0 }, "" };
    run.log = (weft_log){ listen, &all };
    run.limit.method = WEFT_LIMIT_PROVOT;
    run.limit.strain = 0.0;
    run.limit.sweeps = 1;
    start();
    ck_assert_str_eq(all.last, "3 x 4 particles under velocity_verlet");
    go(0.5);
    ck_assert_uint_gt(weft_sim_limit_stats(sim).unconverged, 1);
    ck_assert_uint_eq(all.count[WEFT_LOG_WARNING], 1);
    ck_assert_ptr_nonnull(strstr(all.last, "limit: not met"));
}
END_TEST

#ifdef HAVE_GSL
START_TEST(rejected_attempts_are_told)
{
    heard all = { { 0 }, "" };
    run.log = (weft_log){ listen, &all };
    run.method = test_method_named("gsl/rkf45");
    run.config = weft_stepper_config_default();
    run.config.first_step = 1.0;
    start();
    go(0.5);
    ck_assert_uint_gt(weft_sim_stats(sim).rejected, 0);
    ck_assert_uint_gt(all.count[WEFT_LOG_DEBUG], 0);
    ck_assert_uint_le(all.count[WEFT_LOG_DEBUG], weft_sim_stats(sim).rejected);
}
END_TEST
#endif

START_TEST(registry_tells_what_it_loads_and_refuses)
{
    heard all = { { 0 }, "" };
    weft_registry *registry = NULL;
    weft_registry_def def = weft_registry_def_default();
    def.path = BUILD_DIR "/tests/broken";
    def.environment = false;
    def.log = (weft_log){ listen, &all };
    ck_assert_int_eq(weft_registry_create(&def, &registry, NULL), WEFT_OK);
    ck_assert_int_eq(weft_registry_add(registry, test_plugin(0), NULL), WEFT_OK);
    ck_assert_str_eq(all.last, "plugin verlet linked in");
    (void)weft_registry_load_all(registry, NULL, NULL, NULL);
    ck_assert_uint_eq(all.count[WEFT_LOG_INFO], weft_registry_count(registry));
    ck_assert_uint_gt(all.count[WEFT_LOG_WARNING], 5);
    weft_registry_destroy(registry);
}
END_TEST

/* ---- threads --------------------------------------------------------------------- */

static int no_force(void *ctx, double t, const double *y, double *f)
{
    (void)ctx;
    (void)t;
    (void)y;
    (void)f;
    return 0;
}

/* ---- frames -------------------------------------------------------------------- */

/* 0.25 s at 10 frames a second: the last frame comes sooner. */
typedef struct film {
    double times[4]; /* [s] */
    size_t frames, checkpoints, steps, steps_most;
} film;

static weft_status take_frame(void *ctx, size_t i, weft_error *err)
{
    film *self = ctx;
    (void)err;
    ck_assert_uint_eq(i, self->frames);
    self->times[self->frames++] = weft_sim_time(sim);
    return WEFT_OK;
}

static weft_status take_checkpoint(void *ctx, size_t i, weft_error *err)
{
    film *self = ctx;
    unsigned char saved[4096];
    ck_assert_uint_eq(i, 2);
    ++self->checkpoints;
    return weft_sim_save(sim, saved, sizeof saved, err);
}

static bool count_step(void *ctx)
{
    film *self = ctx;
    return ++self->steps < self->steps_most;
}

static uint64_t play(weft_play frames, film *self)
{
    *self = (film){ .steps_most = SIZE_MAX };
    frames.run = &quarter;
    frames.last = weft_run_last_frame(&quarter);
    frames.frame = take_frame;
    frames.ctx = self;
    start();
    ck_assert_int_eq(weft_sim_play(sim, &frames, NULL), WEFT_OK);
    ck_assert_uint_eq(self->frames, 4);
    return weft_sim_measure(sim).hash;
}

START_TEST(frames_come_at_their_times_and_checkpoints_do_not_change_them)
{
    if (!test_is_typical(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    static const double times[] = { 0.0, 1.0 / 10.0, 2.0 / 10.0, 0.25 };
    film kept, plain;
    use_method(_i);
    const uint64_t hash
        = play((weft_play){ .checkpoint = take_checkpoint, .step = count_step }, &kept);
    ck_assert_mem_eq(kept.times, times, sizeof times);
    ck_assert_uint_eq(kept.checkpoints, 1);
    ck_assert_uint_eq(kept.steps, weft_sim_stats(sim).steps);
    ck_assert_uint_eq(play((weft_play){ 0 }, &plain), hash);
    ck_assert_mem_eq(plain.times, times, sizeof times);
}
END_TEST

static bool has_even_steps(void *ctx)
{
    const double h = *(const double *)ctx;
    ck_assert_double_eq_tol(weft_sim_stats(sim).last_step, h, 1e-9 * h);
    return true;
}

static weft_status any_frame(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i, (void)err;
    return WEFT_OK;
}

START_TEST(fixed_steps_divide_a_frame_evenly)
{
    static const weft_run_def third = { .duration = 0.1, .fps = 30.0 };
    use_method(_i);
    if (test_is_spared(run.method) || test_needs_damping(run.method)
        || test_adaptive_only(run.method)) {
        return;
    }
    double h = run.config.fixed_step = weft_run_step(&third, 1e-3);
    const weft_play frames = {
        .run = &third, .last = 3, .frame = any_frame, .step = has_even_steps, .ctx = &h
    };
    weft_error err = { 0 };
    ck_assert(h == 1.0 / 30.0 / 34.0);
    start();
    ck_assert_msg(weft_sim_play(sim, &frames, &err) == WEFT_OK, "%s", err.message);
    ck_assert_uint_eq(weft_sim_stats(sim).steps, 3 * 34);
}
END_TEST

START_TEST(the_step_of_a_run_is_at_most_the_one_asked_for)
{
    weft_run_def of = { .duration = 2.0, .fps = 25.0 };
    ck_assert_double_eq_tol(weft_run_step(&of, 1e-3), 1e-3, 1e-18);
    ck_assert(weft_run_step(&of, 1.001e-3) == 0.04 / 40.0);
    ck_assert(weft_run_step(&of, 0.999e-3) == 0.04 / 41.0);
    ck_assert(weft_run_step(&of, 0.05) == 0.04);     /* longer than a frame */
    ck_assert(weft_run_step(&of, 5e-324) == 5e-324); /* 0 would be error control */
    of.duration = 0.03;
    ck_assert(weft_run_step(&of, 0.02) == 0.015); /* one frame, cut short */
    of.interpolate = true;
    ck_assert(weft_run_step(&of, 0.02) == 0.02);
}
END_TEST

START_TEST(a_step_callback_stops_between_two_steps)
{
    film self = { .steps_most = 3 };
    weft_error err = { 0 };
    weft_failure failure;
    const weft_play frames = { .run = &quarter,
                               .last = 3,
                               .frame = take_frame,
                               .step = count_step,
                               .ctx = &self };
    run.config.fixed_step = 0.01;
    start();
    ck_assert_int_eq(weft_sim_play(sim, &frames, &err), WEFT_STOPPED);
    ck_assert_str_eq(err.message, "stopped at t = 0.03 s");
    ck_assert(!weft_sim_failure(sim, &failure));
    ck_assert_uint_eq(self.frames, 1);
    go(0.1); /* and it may go on */
}
END_TEST

typedef struct job {
    size_t number;
    uint64_t hash;
} job;

/* A simulation with pins of its own on the cloth that all share. */
static void *work(void *ctx)
{
    job *self = ctx;
    weft_sim *own = NULL;
    const double v[3] = { 0.1 * (double)self->number, 0.0, 0.0 };
    bool good = weft_sim_create(&run, &own, NULL) == WEFT_OK;
    for (int frame = 1; good && frame <= 8; ++frame) {
        const size_t i = (self->number + (size_t)frame) % N;
        good = (frame % 3 == 0 ? weft_sim_unpin(own, i, NULL)
                               : weft_sim_pin(own, i, v, NULL))
                   == WEFT_OK
               && weft_sim_advance(own, frame / 20.0, NULL) == WEFT_OK;
    }
    self->hash = good ? weft_sim_measure(own).hash : 0;
    weft_sim_destroy(own);
    return NULL;
}

START_TEST(threads_share_a_cloth_and_nothing_else)
{
    if (!test_is_typical(test_method((size_t)_i))
        || test_needs_damping(test_method((size_t)_i))) {
        return;
    }
    enum { THREADS = 8 };
    pthread_t threads[THREADS];
    job alone[THREADS], together[THREADS];
    push with = { .f = { 0.1, 0.0, 0.0 } };
    use_method(_i);
    if ((run.method->flags & (WEFT_STEPPER_DENSE | WEFT_STEPPER_LEGACY)) != 0) {
        return; /* minutes under a sanitizer */
    }
    run.force = no_force;
    run.force_ctx = &with;
    run.limit.method = WEFT_LIMIT_PROVOT;
    cloth = test_cloth(&model);
    run.cloth = cloth;
    run.config = test_config(run.method, run.config);
    for (size_t i = 0; i < THREADS; ++i) {
        alone[i] = together[i] = (job){ .number = i };
        work(&alone[i]);
        ck_assert_uint_ne(alone[i].hash, 0);
    }
    for (size_t i = 0; i < THREADS; ++i) {
        ck_assert_int_eq(pthread_create(&threads[i], NULL, work, &together[i]), 0);
    }
    for (size_t i = 0; i < THREADS; ++i) {
        ck_assert_int_eq(pthread_join(threads[i], NULL), 0);
        ck_assert_uint_eq(together[i].hash, alone[i].hash);
    }
}
END_TEST

TEST_SUITE(embed)
{
    Suite *suite = suite_create("embed");
    TCase *tcase = tcase_create("embed");
    const int methods = (int)test_method_count();
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_set_timeout(tcase, 60.0);
    tcase_add_test(tcase, force_accelerates_free_particles_and_no_others);
    tcase_add_loop_test(tcase, every_method_sees_the_force, 0, methods);
    tcase_add_loop_test(tcase, stop_gives_up_a_step_and_a_later_one_goes_on, 0,
                        (int)test_method_count());
    tcase_add_loop_test(tcase, force_may_stop_a_run_and_the_state_is_the_last_good_one,
                        0, methods);
    tcase_add_loop_test(tcase, force_that_is_no_number_is_never_accepted, 0, methods);
    tcase_add_loop_test(tcase, force_that_is_no_number_is_reported_with_its_particle, 0,
                        methods);
    tcase_add_test(tcase, failure_without_a_fault_of_the_force_names_none);
    tcase_add_test(tcase, force_that_is_no_number_on_a_pinned_particle_does_nothing);
    tcase_add_test(tcase, correction_comes_after_the_limit);
    tcase_add_test(tcase, correction_that_spoils_the_state_is_told_with_the_particle);
    tcase_add_loop_test(tcase, no_callback_can_change_or_save_its_simulation, 0,
                        methods);
    tcase_add_test(tcase, callbacks_of_a_play_may_change_between_steps_but_not_step);
    tcase_add_test(tcase, play_without_frames_or_of_no_length_is_refused);
    tcase_add_test(tcase, numbers_in_texts_have_points_in_any_locale);
    tcase_add_test(tcase, limit_that_is_not_met_is_told_once);
#ifdef HAVE_GSL
    tcase_add_test(tcase, rejected_attempts_are_told);
#endif
    tcase_add_test(tcase, registry_tells_what_it_loads_and_refuses);
    tcase_add_loop_test(tcase,
                        frames_come_at_their_times_and_checkpoints_do_not_change_them,
                        0, methods);
    tcase_add_test(tcase, a_step_callback_stops_between_two_steps);
    tcase_add_loop_test(tcase, fixed_steps_divide_a_frame_evenly, 0, methods);
    tcase_add_test(tcase, the_step_of_a_run_is_at_most_the_one_asked_for);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("threads");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_set_timeout(tcase, 120.0);
    tcase_add_loop_test(tcase, threads_share_a_cloth_and_nothing_else, 0, methods);
    suite_add_tcase(suite, tcase);
    return suite;
}
