/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_bands_self.c -- a cloth in bands that touches itself has the bits of the whole
 * cloth on any number of bands: those of events and threads, of steps that are taken
 * back, and of failures. */
#include "bands_run.h"
#include "folded.h"

/* A run that begins in this state of the whole, saved there. */
static void begin_at(scenario *of, const double *xyz, const double *v, outcome *saved)
{
    weft_sim_def def = of->sim;
    weft_sim *sim;
    weft_error err;
    def.cloth = test_cloth(&of->cloth);
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    ck_assert_msg(weft_sim_set_state(sim, xyz, v, &err) == WEFT_OK, "%s", err.message);
    make(of, saved);
    saved->saved_size = weft_sim_save_size(sim);
    saved->saved = malloc(saved->saved_size);
    ck_assert_int_eq(weft_sim_save(sim, saved->saved, saved->saved_size, &err),
                     WEFT_OK);
    of->restore = saved->saved, of->restore_size = saved->saved_size;
    weft_sim_destroy(sim);
    weft_cloth_destroy((weft_cloth *)(uintptr_t)def.cloth);
}

static scenario run_by(const char *method)
{
    scenario of = in_wind(11, 6, method);
    of.sim.config.fixed_step = of.sim.config.fixed_step > 0.0 ? 1e-4 : 0.0;
    of.duration = 0.02;
    return of;
}

/* A grid that is folded across its rows, or along them. */
static scenario grid_in(folded_shape *shape, const char *method, outcome *saved)
{
    static double xyz[3 * 1200], v[3 * 1200];
    scenario of = run_by(method);
    of.cloth = folded_model(37, 31);
    for (size_t k = 0; test_needs_damping(of.sim.method) && k < WEFT_FAMILIES; ++k) {
        of.cloth.springs[k].damping = 2e-3 * of.cloth.springs[k].stiffness;
    }
    folded_start(&of.cloth, shape, xyz, v);
    begin_at(&of, xyz, v, saved);
    return of;
}

static void across(double u, double w, double x[3], double v[3])
{
    folded_u(w, u, 6.0, x, v);
    x[2] += 0.01 * x[1];
    v[2] += 0.3 * x[1];
}

static void along(double u, double w, double x[3], double v[3])
{
    folded_u(u, w, 6.0, x, v);
    v[0] += x[1];
}

static void check_touching(const scenario *of, const char *what)
{
    outcome whole;
    run_whole(of, &whole);
    ck_assert_msg(whole.status == WEFT_OK, "%s", whole.err.message);
    ck_assert_msg(strstr(whole.series[FRAMES], what) != NULL, "%s",
                  whole.series[FRAMES]);
    drop(&whole);
    check_bands(of);
}

START_TEST(ledgers_events_and_threads_have_the_same_bits)
{
    outcome saved, whole, parts;
    weft_stop_def at = { WEFT_STOP_KINETIC, 0.1, 0.0 };
    scenario of = grid_in(across, "arkode/dormand_prince", &saved);
    drop(&saved);
    of.sim.ledger = true;
    of.sim.event = weft_stop_event, of.sim.event_ctx = &at;
    static double xyz[3 * 1200], v[3 * 1200];
    folded_start(&of.cloth, across, xyz, v);
    begin_at(&of, xyz, v, &saved);
    check_touching(&of, "rubbed 0x1.");
    run_whole(&of, &whole);
    of.sim.config.threads = 2;
    run_bands(&of, 2, &parts);
    check_bits(&of, &whole, &parts);
    drop(&parts), drop(&whole), drop(&saved);
}
END_TEST

/* Thin cloth and long steps. */
START_TEST(steps_are_taken_back_together)
{
    static double xyz[3 * 1200], v[3 * 1200];
    outcome saved, whole;
    scenario of = grid_in(along, "verlet/velocity_verlet", &saved);
    drop(&saved);
    of.cloth.contact.thickness = 5e-4;
    of.cloth.rows = 19, of.cloth.cols = 17;
    of.cloth.spacing[0] = of.cloth.spacing[1] = 1.0 / 18.0;
    of.sim.config.fixed_step = 4e-4;
    of.duration = 0.004;
    folded_start(&of.cloth, folded_slam, xyz, v);
    begin_at(&of, xyz, v, &saved);
    run_whole(&of, &whole);
    ck_assert_msg(strstr(whole.series[whole.frames - 1], "vetoed 0x0") == NULL, "%s %s",
                  whole.series[whole.frames - 1], whole.err.message);
    drop(&whole);
    check_bands(&of);
    drop(&saved);
}
END_TEST

/* Two layers 1 um apart, joined by one row of edges. */
static void shut(double u, double w, double x[3], double v[3])
{
    x[0] = u < 0.5 ? u : 1.0 - u, x[1] = u < 0.5 ? 0.0 : 1e-6, x[2] = w;
    v[0] = v[2] = 0.0;
    v[1] = u < 0.5 ? 20.0 : -20.0;
}

/* Of the pair that is the first one of the whole. */
START_TEST(failures_have_the_message_of_the_whole)
{
    static double xyz[3 * 1200], v[3 * 1200];
    outcome saved, whole;
    scenario of = grid_in(along, "verlet/velocity_verlet", &saved);
    drop(&saved);
    of.cloth.rows = 19, of.cloth.cols = 18;
    of.cloth.spacing[0] = of.cloth.spacing[1] = 1.0 / 17.0;
    of.sim.config.fixed_step = 1e-3;
    folded_start(&of.cloth, shut, xyz, v);
    begin_at(&of, xyz, v, &saved);
    run_whole(&of, &whole);
    ck_assert_msg(strstr(whole.err.message, "cannot be kept apart") != NULL, "%s",
                  whole.err.message);
    drop(&whole);
    check_bands(&of);
    drop(&saved);
}
END_TEST

TEST_SUITE(bands_self)
{
    Suite *suite = suite_create("bands that touch themselves");
    TCase *same = tcase_create("same bits");
    tcase_set_timeout(same, 240);
    tcase_add_test(same, ledgers_events_and_threads_have_the_same_bits);
    tcase_add_test(same, steps_are_taken_back_together);
    tcase_add_test(same, failures_have_the_message_of_the_whole);
    suite_add_tcase(suite, same);
    return suite;
}
