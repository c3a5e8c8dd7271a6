/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_bands_ends.c -- where bands end: failures, stops and refusals, which all bands
 * share; saved bytes on another number of bands; the cloth of one band. */
#include "bands_run.h"
#include "bodies.h"
#include "shell.h"

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
        if ((def.method->flags & WEFT_STEPPER_DISTRIBUTED) == 0) {
            check_refused(def, WEFT_UNSUPPORTED, def.method->name);
        }
    }
    def = good, def.limit.method = WEFT_LIMIT_PROVOT;
    check_refused(def, WEFT_UNSUPPORTED, "strain limit");
    def = good, def.correct = correct;
    check_refused(def, WEFT_UNSUPPORTED, "`correct`");
    def = good, def.force = force;
    check_refused(def, WEFT_UNSUPPORTED, "`force`");
    weft_cloth_destroy(cloth);
    thread_bands_destroy(all);
}
END_TEST

START_TEST(refuses_mesh_colliders)
{
    thread_bands *all = thread_bands_create(1);
    const weft_comm comm = thread_bands_comm(all, 0);
    scenario of = in_wind(11, 6, "arkode/dormand_prince");
    body_mesh *far = plate(1, 0.1, 0.1);
    weft_shape shape = body_shape(far);
    shape.at[1] = -10.0;
    of.cloth.contact.shapes = &shape, of.cloth.contact.shape_count = 1;
    weft_sim_def def = of.sim;
    weft_cloth *cloth = test_cloth(&of.cloth);
    def.cloth = cloth;
    def.comm = &comm;
    check_refused(def, WEFT_UNSUPPORTED, "mesh");
    weft_cloth_destroy(cloth);
    free(far);
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
    comm = good, comm.post = NULL;
    of.cloth.contact.self = true;
    weft_cloth *touching = test_cloth(&of.cloth);
    def.cloth = touching;
    check_refused(def, WEFT_UNSUPPORTED, "need a comm with `post`");
    def.cloth = whole;
    of.cloth.contact.self = false;
    comm = good, comm.size = 6;
    check_refused(def, WEFT_INVALID, "11 rows are too few for 6 bands: each needs 2");
    of.cloth.band_first = 4, of.cloth.band_rows = 3;
    weft_cloth *band = test_cloth(&of.cloth);
    comm = good, def.cloth = band;
    check_refused(def, WEFT_INVALID,
                  "has rows 4 to 6 of 11; band 0 of 1 is rows 0 to 10");
    def.comm = NULL;
    check_refused(def, WEFT_INVALID, "rows 4 to 6 of 11: its simulation needs a comm");
    weft_cloth_destroy(band);
    weft_cloth_destroy(touching);
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
                                     weft_sim_drive_shape(sim, 0, &shape, &err),
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
    double xyz[6 * 6 * 3];
    of.cloth.band_first = 6, of.cloth.band_rows = 2; /* rows 4 to 9 are here */
    of.cloth.pin_count = 0;
    of.cloth.scale = 1.0;
    cloth = test_cloth(&of.cloth);
    ck_assert_uint_eq(weft_cloth_particles(cloth), 6 * 6);
    weft_cloth_rest(cloth, xyz);
    weft_cloth_destroy(cloth);
    shapes[0] = weft_shape_default(WEFT_SPHERE);
    shapes[0].radius = 0.01;
    memcpy(shapes[0].at, xyz + 3 * (3 * 6 + 4), sizeof shapes[0].at);
    of.cloth.contact.shapes = shapes, of.cloth.contact.shape_count = 1;
    ck_assert_int_eq(weft_cloth_create(&of.cloth, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, "particle (7, 4) is 10 mm inside shapes[0]")
                      != NULL,
                  "%s", err.message);
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

#define OUT BUILD_DIR "/bands-ends"

/* Written by bands, the file of the whole, and the other way round. */
START_TEST(checkpoints_of_bands_restore_on_any_number)
{
    scenario of = on_shapes();
    outcome whole, parts;
    ck_assert_int_eq(shell("rm -rf " OUT " && mkdir -p " OUT "/1 " OUT "/3"), 0);
    of.save_file = OUT "/1";
    run_whole(&of, &whole);
    of.save_file = OUT "/3";
    run_bands(&of, 3, &parts);
    check_bits(&of, &whole, &parts);
    ck_assert_int_eq(shell("cmp " OUT "/1/checkpoint.weft " OUT "/3/checkpoint.weft"),
                     0);
    ck_assert_int_eq(shell("ls " OUT "/3 | wc -l | grep -qx 1"), 0);
    drop(&whole), drop(&parts);
    of.save_file = NULL, of.restore_file = OUT "/3";
    run_whole(&of, &whole);
    ck_assert_int_eq(whole.status, WEFT_OK);
    for (size_t i = 0; i < COUNTS; ++i) {
        run_bands(&of, counts[i], &parts);
        check_bits(&of, &whole, &parts);
        drop(&parts);
    }
    drop(&whole);
}
END_TEST

/* Also where one band alone reads it. */
START_TEST(a_flipped_byte_of_a_checkpoint_is_found_by_all)
{
    scenario of = on_shapes();
    outcome parts;
    ck_assert_int_eq(shell("rm -rf " OUT " && mkdir -p " OUT), 0);
    of.save_file = OUT;
    run_bands(&of, 3, &parts);
    drop(&parts);
    of.save_file = NULL, of.restore_file = OUT;
    FILE *stream = fopen(OUT "/checkpoint.weft", "r+b");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_eq(fseek(stream, 0, SEEK_END), 0);
    const long size = ftell(stream);
    for (long at = 3; at < size; at += size / 12) {
        for (int twice = 0; twice < 2; ++twice) {
            ck_assert_int_eq(fseek(stream, at, SEEK_SET), 0);
            const int byte = getc(stream);
            ck_assert_int_eq(fseek(stream, at, SEEK_SET), 0);
            ck_assert_int_ne(putc(byte ^ 4, stream), EOF);
            ck_assert_int_eq(fflush(stream), 0);
            run_bands(&of, 3, &parts);
            ck_assert_int_eq(parts.status, twice == 0 ? WEFT_IO : WEFT_OK);
            drop(&parts);
        }
    }
    ck_assert_int_eq(fclose(stream), 0);
}
END_TEST

START_TEST(a_band_that_cannot_write_its_rows_fails_all_and_leaves_no_file)
{
    static const struct {
        oddity odd;
        const char *says;
    } ways[] = { { ELSEWHERE, "bands need a directory that all ranks share" },
                 { FULL_DISK, "the disk is full" } };
    ck_assert_int_eq(shell("rm -rf " OUT " && mkdir -p " OUT), 0);
    for (size_t i = 0; i < 2; ++i) {
        scenario of = on_shapes();
        outcome parts;
        of.save_file = OUT;
        of.odd = ways[i].odd, of.odd_band = 1;
        run_bands(&of, 3, &parts); /* where all agree */
        ck_assert_int_eq(parts.status, WEFT_IO);
        ck_assert_msg(strstr(parts.err.message, ways[i].says) != NULL, "%s",
                      parts.err.message);
        ck_assert_int_eq(shell("ls " OUT " | wc -l | grep -qx 0"), 0);
        drop(&parts);
    }
}
END_TEST

static weft_status put_nothing(void *calls, uint64_t at, const void *bytes, size_t size,
                               weft_error *err)
{
    (void)at, (void)bytes, (void)size;
    return ++*(int *)calls == 3 ? weft_error_set(err, WEFT_IO, "the disk is full")
                                : WEFT_OK;
}

START_TEST(a_part_that_fails_is_told_and_the_others_are_still_put)
{
    scenario of = on_shapes();
    weft_error err = { 0 };
    weft_cloth *cloth = test_cloth(&of.cloth);
    weft_sim *sim = NULL;
    int calls = 0;
    of.sim.cloth = cloth;
    ck_assert_int_eq(weft_sim_create(&of.sim, &sim, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_save_parts(sim, put_nothing, &calls, &err), WEFT_IO);
    ck_assert_str_eq(err.message, "the disk is full");
    ck_assert_int_eq(calls, 8);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
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

TEST_SUITE(bands_ends)
{
    Suite *suite = suite_create("bands ends");
    TCase *same = tcase_create("together");
    tcase_set_timeout(same, 120);
    tcase_add_test(same, failures_have_the_message_of_the_whole);
    tcase_add_test(same, nan_in_one_band_ends_all);
    tcase_add_test(same, what_fails_in_one_band_fails_in_all);
    tcase_add_test(same, stop_in_one_band_stops_all);
    tcase_add_test(same, saved_bands_restore_on_any_number);
    tcase_add_test(same, checkpoints_of_bands_restore_on_any_number);
    tcase_add_test(same, a_flipped_byte_of_a_checkpoint_is_found_by_all);
    tcase_add_test(same,
                   a_band_that_cannot_write_its_rows_fails_all_and_leaves_no_file);
    tcase_add_test(same, a_part_that_fails_is_told_and_the_others_are_still_put);
    tcase_add_test(same, damaged_bytes_are_refused_by_all);
    suite_add_tcase(suite, same);
    TCase *alone = tcase_create("one band");
    tcase_add_test(alone, refuses_what_needs_the_whole_state);
    tcase_add_test(alone, refuses_mesh_colliders);
    tcase_add_test(alone, refuses_a_comm_that_is_not_whole);
    tcase_add_test(alone, refuses_changes_from_outside);
    tcase_add_test(alone, band_lies_inside_and_has_two_rows);
    tcase_add_test(alone, band_counts_its_own_rows);
    tcase_add_test(alone, errors_name_rows_of_the_whole);
    suite_add_tcase(suite, alone);
    return suite;
}
