/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first together */
/* A simulation saved and restored goes on to the last bit as the one it was saved of,
 * and nothing that is damaged, or of another kind, is restored. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "program/record/checkpoint.h"
#include "saved_sim.h"
#include "saved_sum.h"
#include "shell.h"
#include "sim/simulation.h"

#define OUT BUILD_DIR "/checkpoint"

static void restore(weft_sim *one)
{
    ck_assert_msg(weft_sim_restore(one, saved, weft_sim_save_size(one), &err)
                      == WEFT_OK,
                  "%s", err.message);
}

static void same(const weft_sim *a, const weft_sim *b)
{
    const weft_stepper_stats p = weft_sim_stats(a), q = weft_sim_stats(b);
    const weft_ledger m = weft_sim_ledger(a), n = weft_sim_ledger(b);
    const weft_limit_stats u = weft_sim_limit_stats(a), v = weft_sim_limit_stats(b);
    ck_assert(weft_sim_time(a) == weft_sim_time(b));
    ck_assert_mem_eq(weft_sim_state(a), weft_sim_state(b), DIM * sizeof(double));
    ck_assert_uint_eq(p.steps, q.steps);
    ck_assert_uint_eq(p.rejected, q.rejected);
    ck_assert_uint_eq(p.rhs_calls, q.rhs_calls);
    ck_assert_uint_eq(p.linear_iterations, q.linear_iterations);
    ck_assert_uint_eq(p.factorisations, q.factorisations);
    ck_assert_uint_eq(p.newton_failures, q.newton_failures);
    ck_assert(p.last_step == q.last_step && p.next_step == q.next_step);
    ck_assert(m.residual == n.residual && m.work_limit == n.work_limit);
    ck_assert(m.work_outside == n.work_outside && m.work_wind == n.work_wind);
    ck_assert(m.work_force == n.work_force);
    ck_assert_uint_eq(u.corrected, v.corrected);
    ck_assert_uint_eq(u.sweeps, v.sweeps);
    ck_assert_uint_eq(u.unconverged, v.unconverged);
}

/* ---- saved and restored -------------------------------------------------------- */

/* Times that are no multiples of a step; what is restored was somewhere else before. */
static void goes_on_alike(const weft_stepper_type *method, kind wanted)
{
    weft_cloth *of = make_cloth(ROWS);
    const weft_sim_def def = define(of, method, wanted);
    weft_sim *one = make(&def), *other = make(&def);
    go(one, 0.05);
    go(other, 0.013);
    save(one, saved);
    restore(other);
    same(one, other);
    for (int i = 1; i <= 3; ++i) {
        go(one, 0.05 + 0.017 * i);
        go(other, 0.05 + 0.017 * i);
        same(one, other);
    }
    weft_sim_destroy(one);
    weft_sim_destroy(other);
    weft_cloth_destroy(of);
}

START_TEST(every_method_goes_on_alike_to_the_last_bit)
{
    const weft_stepper_type *method = test_method((size_t)_i % test_method_count());
    const size_t of = (size_t)_i / test_method_count();
    const kind wanted = { (of & 1) != 0, (of & 2) != 0 };
    if (test_needs_damping(method) || test_is_spared(method)) {
        return;
    }
    if (!wanted.ledger || (method->flags & WEFT_STEPPER_QUADRATURES) != 0) {
        goes_on_alike(method, wanted);
    }
}
END_TEST

static void begin(void)
{
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    begin_saved();
}

START_TEST(a_second_save_gives_the_same_bytes)
{
    save(sim, again);
    ck_assert_mem_eq(saved, again, weft_sim_save_size(sim));
}
END_TEST

START_TEST(a_restored_simulation_saves_the_same_bytes)
{
    go(sim, 0.06);
    restore(sim);
    save(sim, again);
    ck_assert_mem_eq(saved, again, weft_sim_save_size(sim));
}
END_TEST

START_TEST(saving_keeps_all_counts)
{
    const weft_stepper_stats before = weft_sim_stats(sim);
    ck_assert_uint_gt(before.steps, 0);
    save(sim, again);
    const weft_stepper_stats after = weft_sim_stats(sim);
    ck_assert_mem_eq(&before, &after, sizeof before);
}
END_TEST

/* It carries nothing from step to step but h. */
START_TEST(a_restart_is_nothing_to_a_one_step_method)
{
    const weft_sim_def def
        = define(cloth, test_method_named("verlet/midpoint"), (kind){ false, true });
    weft_sim *plain = make(&def), *restarted = make(&def);
    for (int i = 1; i <= 5; ++i) {
        go(plain, 0.017 * i);
        go(restarted, 0.017 * i);
        ck_assert_int_eq(weft_sim_restart(restarted, &err), WEFT_OK);
    }
    same(plain, restarted);
    weft_sim_destroy(plain);
    weft_sim_destroy(restarted);
}
END_TEST

/* ---- refused ------------------------------------------------------------------- */

START_TEST(a_flipped_bit_anywhere_is_refused)
{
    const size_t size = weft_sim_save_size(sim);
    memcpy(again, saved, size);
    go(sim, 0.06);
    for (size_t bit = 0; bit < 8 * size; ++bit) {
        again[bit / 8] ^= (unsigned char)(1u << bit % 8);
        refused(size, "saved");
        again[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
}
END_TEST

START_TEST(bytes_that_are_cut_off_anywhere_are_refused)
{
    const size_t size = weft_sim_save_size(sim);
    memcpy(again, saved, size);
    for (size_t length = 0; length < size; ++length) {
        refused(length, "saved");
    }
    again[size] = 0;
    refused(size + 1, "damaged or cut off");
    refused(size + 8, "damaged or cut off");
}
END_TEST

static void save_other(const weft_cloth *other, const char *method, kind wanted)
{
    const weft_sim_def def = define(other, test_method_named(method), wanted);
    weft_sim *made = make(&def);
    save(made, again);
    weft_sim_destroy(made);
}

START_TEST(another_kind_of_simulation_is_told_apart)
{
    const size_t size = weft_sim_save_size(sim);
    weft_cloth *larger = make_cloth(ROWS + 1);
    save_other(larger, "verlet/velocity_verlet", (kind){ true, true });
    refused(size + 8 * 7 * COLS, "saved of 4 x 4 particles, and these are 3 x 4");
    weft_cloth_destroy(larger);
    save_other(cloth, "verlet/midpoint", (kind){ true, true });
    refused(size, "saved under method 'midpoint', and this is 'velocity_verlet'");
    save_other(cloth, "verlet/velocity_verlet", (kind){ false, true });
    refused(size - 8 * WEFT__QUADRATURES, "saved without energy balance");
    memcpy(again, saved, size);
    again[8] = 2;
    refused(size, "saved in format 2, and this is 10");
}
END_TEST

/* Bytes made up with a checksum that is right: t, the next h, the first x and the last
 * vz, each in its word (bench/NOTES.md). */
START_TEST(numbers_that_are_not_finite_are_refused)
{
    const size_t size = weft_sim_save_size(sim), first = saved_front(saved, size);
    const size_t words[] = { 15, 16, first, first + DIM - 1 };
    const double odd[] = { (double)NAN, (double)INFINITY };
    for (size_t i = 0; i < sizeof words / sizeof words[0] * 2; ++i) {
        memcpy(again, saved, size);
        weft__real_put(again + 8 * words[i / 2], odd[i % 2]);
        saved_mend(again, size);
        refused(size, "not finite");
    }
}
END_TEST

static void refused_with(size_t word, double value, const char *text)
{
    const size_t size = weft_sim_save_size(sim);
    save(sim, again);
    weft__real_put(again + 8 * word, value);
    saved_mend(again, size);
    refused(size, text);
}

/* A wind that was changed is saved; one that was not is the definition's again. */
START_TEST(a_changed_wind_is_part_of_a_saved_simulation)
{
    const double gust[3] = { 3.0, 0.0, -8.0 };
    const weft_sim_def def = define(cloth, test_method_named("verlet/velocity_verlet"),
                                    (kind){ true, true });
    weft_sim *windy = make(&def);
    go(windy, 0.02);
    ck_assert_int_eq(weft_sim_set_wind(windy, gust, 0.7, &err), WEFT_OK);
    go(windy, 0.06);
    save(windy, again);
    ck_assert_int_eq(weft_sim_restore(sim, again, weft_sim_save_size(sim), &err),
                     WEFT_OK);
    go(windy, 0.1);
    go(sim, 0.1);
    same(windy, sim);
    restore(windy); /* of begin_saved, without a change */
    restore(sim);
    weft_sim *plain = make(&def);
    restore(plain);
    go(plain, 0.1);
    go(windy, 0.1);
    same(plain, windy);
    weft_sim_destroy(plain);
    weft_sim_destroy(windy);
}
END_TEST

/* What 0.2 wrote: the words of the wind are fields, of contact behind the sums. */
static size_t in_format_9(const unsigned char *now, size_t size, unsigned char *to)
{
    enum { FLAGS = 33, SUMS = 35, QUADRATURES = WEFT__QUADRATURES, WIND = 2 + 5 };
    const unsigned char *parts = now + 8 * (SUMS + QUADRATURES);
    const size_t contact = (size_t)saved_word(now, SUMS + QUADRATURES + WIND + 1);
    const unsigned char *end = parts + 8 * (WIND + 2 + contact);
    unsigned char *at = to + 8 * (FLAGS + 5);
    memcpy(to, now, 8 * FLAGS);
    weft__word_put(to + 8, 9);
    weft__word_put(to + 8 * FLAGS,
                   2 * saved_word(now, FLAGS) + weft__word_at(parts + 16));
    memcpy(to + 8 * (FLAGS + 1), parts + 24, 8 * 4);
    memcpy(at, now + 8 * SUMS, 8 * QUADRATURES);
    memcpy(at + 8 * QUADRATURES, parts + 8 * (WIND + 2), 8 * contact);
    at += 8 * (QUADRATURES + contact);
    memcpy(at, end, (size_t)(now + size - end));
    at += now + size - end;
    saved_mend(to, (size_t)(at - to));
    return (size_t)(at - to);
}

START_TEST(a_wind_of_an_older_format_is_restored)
{
    static unsigned char old[MOST];
    const double gust[3] = { 3.0, 0.0, -8.0 };
    const weft_sim_def def = define(cloth, test_method_named("verlet/velocity_verlet"),
                                    (kind){ true, true });
    for (size_t changed = 0; changed < 2; ++changed) {
        weft_sim *windy = make(&def), *heir = make(&def);
        ck_assert_int_eq(weft_sim_set_wind(heir, gust, 0.1, &err), WEFT_OK);
        go(windy, 0.02);
        ck_assert_int_eq(
            weft_sim_set_wind(windy, changed == 1 ? gust : NULL, 0.7, &err), WEFT_OK);
        save(windy, again);
        const size_t size = in_format_9(again, weft_sim_save_size(windy), old);
        ck_assert_msg(weft_sim_restore(heir, old, size, &err) == WEFT_OK, "%s",
                      err.message);
        go(windy, 0.06);
        go(heir, 0.06);
        same(windy, heir);
        weft_sim_destroy(windy);
        weft_sim_destroy(heir);
    }
}
END_TEST

START_TEST(saved_winds_that_make_no_sense_are_refused)
{
    enum { WIND = SAVED_ENERGIES + WEFT__QUADRATURES + 1 };
    refused_with(33, 2.0, "a saved flag makes no sense");
    refused_with(WIND, 2.0, "damaged or cut off");              /* so many words */
    refused_with(WIND + 1, 2.0, "a saved wind makes no sense"); /* neither 0 nor 1 */
    refused_with(WIND + 2, (double)NAN, "a saved wind makes no sense");
    refused_with(WIND + 5, -1.0, "a saved wind makes no sense");
}
END_TEST

/* Words of bench/NOTES.md: the sums of a ledger. */
START_TEST(ledgers_that_are_not_finite_are_refused)
{
    const double odd[] = { (double)NAN, (double)INFINITY, -(double)INFINITY };
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; ++i) {
        for (size_t word = 18; word < 21; ++word) {
            refused_with(word, odd[i], "an energy balance that is not finite");
        }
        for (size_t k = 0; k < WEFT__QUADRATURES; ++k) {
            refused_with(SAVED_ENERGIES + k, odd[i],
                         "an energy balance that is not finite");
        }
    }
}
END_TEST

static bool spoil(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h;
    y[DIM - 1] = (double)NAN;
    return true;
}

START_TEST(what_a_correction_spoiled_is_not_saved)
{
    weft_sim_def def = define(cloth, test_method_named("verlet/velocity_verlet"),
                              (kind){ false, false });
    def.correct = spoil;
    weft_sim *spoiled = make(&def);
    save(spoiled, again);
    ck_assert_int_eq(weft_sim_step(spoiled, 1.0, &err), WEFT_NOT_FINITE);
    ck_assert_int_eq(weft_sim_save(spoiled, again, sizeof again, &err),
                     WEFT_NOT_FINITE);
    ck_assert_str_eq(
        err.message,
        "the state that `correct` left is not finite: it could not be restored");
    weft_sim_destroy(spoiled);
}
END_TEST

/* The energy of pinned particles does not count. */
START_TEST(a_ledger_is_restored_whatever_the_pins_are_by_then)
{
    static const double fast[3] = { 1e200, 0.0, 0.0 };
    const size_t size = weft_sim_save_size(sim);
    ck_assert_int_eq(weft_sim_pin(sim, 7, fast, &err), WEFT_OK);
    save(sim, again);
    ck_assert_int_eq(weft_sim_unpin(sim, 7, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_restore(sim, again, size, &err), WEFT_OK);
    ck_assert(isfinite(weft_sim_ledger(sim).residual));
}
END_TEST

START_TEST(a_ledger_that_is_not_finite_is_not_saved)
{
    double far[DIM / 2];
    for (size_t i = 0; i < DIM / 2; ++i) {
        far[i] = 1e200; /* m/s */
    }
    const double end = weft_sim_time(sim);
    ck_assert_int_eq(weft_sim_set_state(sim, NULL, far, &err), WEFT_OK);
    ck_assert(!isfinite(weft_sim_ledger(sim).residual));
    const weft_status status = weft_sim_save(sim, saved, sizeof saved, &err);
    ck_assert_int_eq(status, WEFT_NOT_FINITE);
    ck_assert_str_eq(err.message,
                     "the energy balance is not finite: it could not be restored");
    memset(far, 0, sizeof far);
    ck_assert_int_eq(weft_sim_set_state(sim, NULL, far, &err), WEFT_OK);
    ck_assert(weft_sim_time(sim) == end);
}
END_TEST

/* One held, one let go, one that moves; into a simulation that has other pins. */
START_TEST(changed_pins_are_saved_and_restored)
{
    static const double up[3] = { 0.0, 0.5, 0.0 };
    const weft_sim_def def = define(cloth, test_method_named("verlet/velocity_verlet"),
                                    (kind){ true, true });
    weft_sim *other = make(&def);
    ck_assert(weft_cloth_pinned(cloth, 0) && !weft_cloth_pinned(cloth, 7));
    ck_assert_int_eq(weft_sim_pin(sim, 7, NULL, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_unpin(sim, 0, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_pin(sim, 9, up, &err), WEFT_OK);
    go(sim, 0.06);
    const size_t size = weft_sim_save_size(sim);
    save(sim, saved);
    for (size_t twice = 0; twice < 2; ++twice) {
        ck_assert_int_eq(weft_sim_restore(other, saved, size, &err), WEFT_OK);
        for (size_t i = 0; i < PARTICLES; ++i) {
            ck_assert(weft_cloth_pinned(weft_sim_cloth(other), i)
                      == weft_cloth_pinned(weft_sim_cloth(sim), i));
        }
        same(sim, other);
        ck_assert_int_eq(weft_sim_unpin(other, 9, &err), WEFT_OK);
        ck_assert_int_eq(weft_sim_pin(other, 4, up, &err), WEFT_OK);
        go(other, 0.08);
    }
    ck_assert_int_eq(weft_sim_restore(other, saved, size, &err), WEFT_OK);
    go(sim, 0.09);
    go(other, 0.09);
    same(sim, other);
    weft_sim_destroy(other);
}
END_TEST

START_TEST(what_was_saved_before_a_pin_brings_the_old_pins_back)
{
    const size_t size = weft_sim_save_size(sim);
    const weft_cloth *before = weft_sim_cloth(sim);
    ck_assert_int_eq(weft_sim_pin(sim, 7, NULL, &err), WEFT_OK);
    ck_assert_uint_eq(weft_sim_save_size(sim), size);
    ck_assert_int_eq(weft_sim_restore(sim, saved, size, &err), WEFT_OK);
    ck_assert(!weft_cloth_pinned(weft_sim_cloth(sim), 7));
    ck_assert_ptr_eq(weft_sim_cloth(sim), before); /* who holds it may go on */
    save(sim, again);
    ck_assert_mem_eq(saved, again, size);
}
END_TEST

/* With a checksum that is right. */
START_TEST(saved_pins_that_make_no_sense_are_refused)
{
    static const uint64_t wrong[][2]
        = { { 0, 3 }, { 0, UINT64_MAX }, { 7, 1 }, { 11, UINT64_C(1) << 32 } };
    ck_assert_int_eq(weft_sim_pin(sim, 7, NULL, &err), WEFT_OK);
    const size_t size = weft_sim_save_size(sim), holds = size - 8 * PARTICLES;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        save(sim, again);
        weft__word_put(again + holds + 8 * wrong[i][0], wrong[i][1]);
        saved_mend(again, size);
        refused(size, "makes no sense");
    }
    saved_mend(again, size - 8);
    refused(size - 8, "cut off");
    ck_assert(weft_cloth_pinned(weft_sim_cloth(sim), 7));
}
END_TEST

START_TEST(too_little_room_is_refused)
{
    ck_assert_int_eq(weft_sim_save(sim, again, weft_sim_save_size(sim) - 1, &err),
                     WEFT_INVALID);
}
END_TEST

/* Verlet, until there is no memory left. */
static bool exhausted;

static weft_status make_or_fail(const weft_stepper_type *type, const weft_ode *ode,
                                const weft_stepper_config *config, void **self,
                                weft_error *why)
{
    const weft_stepper_type *verlet = test_method_named("verlet/velocity_verlet");
    (void)type;
    *self = NULL;
    return exhausted ? weft_error_set(why, WEFT_NO_MEMORY, "no memory")
                     : verlet->create(verlet, ode, config, self, why);
}

START_TEST(a_restart_that_fails_changes_nothing)
{
    weft_stepper_type fragile = *test_method_named("verlet/velocity_verlet");
    fragile.create = make_or_fail;
    const weft_sim_def def = define(cloth, &fragile, (kind){ false, false });
    weft_sim *made = make(&def), *other = make(&def);
    go(made, 0.05);
    go(other, 0.05);
    exhausted = true;
    ck_assert_int_eq(weft_sim_restart(made, &err), WEFT_NO_MEMORY);
    same(made, other);
    ck_assert_int_eq(weft_sim_save(made, again, MOST, &err), WEFT_NO_MEMORY);
    go(made, 0.06);
    go(other, 0.06);
    same(made, other);
    weft_sim_destroy(made);
    weft_sim_destroy(other);
}
END_TEST

/* ---- the file ------------------------------------------------------------------ */

static unsigned char bytes[2 * MOST];

static size_t write_checkpoint(void)
{
    const record_checkpoint wanted = {
        .scene = 42,
        .program = "the tests",
        .frame = 30,
        .series = { 12345, 77 },
        .shapes = { 54321, 76 },
        .vtkhdf = { .page = "first page", .head = { 4096, 78 }, .frames = { 31, 79 } },
        .extremes = { 0.25, 0.5, 0.75, { WEFT_SHEAR, 3, 4, 0.125 } },
        .wall_time = 1.5,
    };
    ck_assert_int_eq(record_checkpoint_write(OUT, &wanted, sim, NULL, &err), WEFT_OK);
    FILE *stream = fopen(OUT "/" RECORD_CHECKPOINT, "rb");
    const size_t size = fread(bytes, 1, sizeof bytes, stream);
    ck_assert_int_eq(fclose(stream), 0);
    return size;
}

START_TEST(a_checkpoint_is_read_as_it_was_written)
{
    record_checkpoint read;
    (void)write_checkpoint();
    ck_assert_int_eq(record_checkpoint_read(OUT, &read, &err), WEFT_OK);
    ck_assert_uint_eq(read.scene, 42);
    ck_assert_str_eq(read.program, "the tests");
    ck_assert_uint_eq(read.frame, 30);
    ck_assert_uint_eq(read.series.length, 12345);
    ck_assert_uint_eq(read.series.sum, 77);
    ck_assert_uint_eq(read.shapes.length, 54321);
    ck_assert_uint_eq(read.shapes.sum, 76);
    ck_assert_str_eq((const char *)read.vtkhdf.page, "first page");
    ck_assert_uint_eq(read.vtkhdf.head.length, 4096);
    ck_assert_uint_eq(read.vtkhdf.head.sum, 78);
    ck_assert_uint_eq(read.vtkhdf.frames.length, 31);
    ck_assert_uint_eq(read.vtkhdf.frames.sum, 79);
    ck_assert(read.extremes.short_step == 0.25 && read.extremes.long_step == 0.5);
    ck_assert(read.extremes.strain_time == 0.75);
    ck_assert_int_eq(read.extremes.strain.family, WEFT_SHEAR);
    ck_assert_uint_eq(read.extremes.strain.p, 3);
    ck_assert_uint_eq(read.extremes.strain.q, 4);
    ck_assert(read.extremes.strain.strain == 0.125);
    ck_assert(read.wall_time == 1.5);
    ck_assert_uint_eq(read.state_size, weft_sim_save_size(sim));
    ck_assert_mem_eq(bytes + RECORD_CHECKPOINT_HEAD, saved, read.state_size);
    go(sim, 0.06);
    ck_assert_int_eq(record_checkpoint_restore(&read, sim, &err), WEFT_OK);
    save(sim, again);
    ck_assert_mem_eq(again, saved, read.state_size);
    record_checkpoint_close(&read);
    ck_assert(!exists(OUT "/" RECORD_CHECKPOINT ".tmp"));
}
END_TEST

static void file_refused(size_t size)
{
    record_checkpoint read;
    const uint64_t hash = weft_sim_measure(sim).hash;
    rewrite_file(OUT "/" RECORD_CHECKPOINT, bytes, size);
    if (record_checkpoint_read(OUT, &read, &err) == WEFT_OK) {
        ck_assert_int_eq(record_checkpoint_restore(&read, sim, &err), WEFT_IO);
        ck_assert_uint_eq(weft_sim_measure(sim).hash, hash);
        record_checkpoint_close(&read);
    }
    ck_assert_ptr_null(read.stream);
    ck_assert_msg(strstr(err.message, OUT "/" RECORD_CHECKPOINT ": ") != NULL, "%s",
                  err.message);
}

START_TEST(a_checkpoint_with_a_flipped_bit_is_refused_by_name)
{
    const size_t size = write_checkpoint();
    for (size_t bit = 0; bit < 8 * size; bit += 1 + bit % 5) {
        bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
        file_refused(size);
        bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
}
END_TEST

START_TEST(a_checkpoint_that_is_cut_off_is_refused_by_name)
{
    const size_t size = write_checkpoint();
    for (size_t length = 0; length < size; ++length) {
        file_refused(length);
    }
    file_refused(size + 8);
}
END_TEST

TEST_SUITE(checkpoint)
{
    Suite *all = suite_create("checkpoint");
    TCase *methods = tcase_create("methods"), *one = tcase_create("one");
    tcase_set_timeout(methods, 120);
    const int count = (int)test_method_count();
    tcase_add_loop_test(methods, every_method_goes_on_alike_to_the_last_bit, 0, count);
    tcase_add_loop_test(test_long(all, 120), every_method_goes_on_alike_to_the_last_bit,
                        count, 4 * count);
    tcase_add_checked_fixture(one, begin, end_saved);
    tcase_set_timeout(one, 120);
    tcase_add_test(one, a_second_save_gives_the_same_bytes);
    tcase_add_test(one, a_restored_simulation_saves_the_same_bytes);
    tcase_add_test(one, saving_keeps_all_counts);
    tcase_add_test(one, a_restart_is_nothing_to_a_one_step_method);
    tcase_add_test(one, a_flipped_bit_anywhere_is_refused);
    tcase_add_test(one, bytes_that_are_cut_off_anywhere_are_refused);
    tcase_add_test(one, another_kind_of_simulation_is_told_apart);
    tcase_add_test(one, numbers_that_are_not_finite_are_refused);
    tcase_add_test(one, ledgers_that_are_not_finite_are_refused);
    tcase_add_test(one, a_changed_wind_is_part_of_a_saved_simulation);
    tcase_add_test(one, a_wind_of_an_older_format_is_restored);
    tcase_add_test(one, saved_winds_that_make_no_sense_are_refused);
    tcase_add_test(one, a_ledger_that_is_not_finite_is_not_saved);
    tcase_add_test(one, what_a_correction_spoiled_is_not_saved);
    tcase_add_test(one, a_ledger_is_restored_whatever_the_pins_are_by_then);
    tcase_add_test(one, changed_pins_are_saved_and_restored);
    tcase_add_test(one, what_was_saved_before_a_pin_brings_the_old_pins_back);
    tcase_add_test(one, saved_pins_that_make_no_sense_are_refused);
    tcase_add_test(one, too_little_room_is_refused);
    tcase_add_test(one, a_restart_that_fails_changes_nothing);
    tcase_add_test(one, a_checkpoint_is_read_as_it_was_written);
    tcase_add_test(one, a_checkpoint_with_a_flipped_bit_is_refused_by_name);
    tcase_add_test(one, a_checkpoint_that_is_cut_off_is_refused_by_name);
    suite_add_tcase(all, methods);
    suite_add_tcase(all, one);
    return all;
}
