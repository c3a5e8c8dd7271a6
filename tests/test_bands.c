/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_bands.c -- a cloth in bands of rows has the bits of the whole cloth on any
 * number of bands: all that series.csv holds, the state, what is saved, and failures.
 */
#include "bands_run.h"

static void check_runs(const scenario *of)
{
    outcome whole;
    run_whole(of, &whole);
    ck_assert_msg(whole.status == WEFT_OK, "%s: %s", of->sim.method->name,
                  whole.err.message);
    drop(&whole);
    check_bands(of);
}

START_TEST(every_method_that_agrees_has_the_same_bits)
{
    for (size_t i = 0; i < test_method_count(); ++i) {
        const weft_stepper_type *type = test_method(i);
        if ((type->flags & WEFT_STEPPER_DISTRIBUTED) != 0 && !test_is_spared(type)) {
            scenario of = in_wind(11, 6, test_method_label(i));
            check_runs(&of);
            of.sim.config.norm = WEFT_NORM_RMS;
            check_runs(&of);
        }
    }
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
    for (int norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS; ++norm) {
        of.sim.config.norm = (weft_norm)norm;
        of.sim.config.threads = 1;
        run_whole(&of, &whole);
        of.sim.config.threads = 2;
        run_bands(&of, 2, &parts);
        check_bits(&of, &whole, &parts);
        drop(&parts);
        drop(&whole);
    }
}
END_TEST

/* With events that end a step. */
static void check_event(scenario *of, weft_event_fn *event, void *ctx, const char *what)
{
    outcome whole;
    bool found = false;
    of->sim.event = event;
    of->sim.event_ctx = ctx;
    check_runs(of);
    run_whole(of, &whole);
    for (size_t f = 0; f < whole.frames; ++f) {
        found = found || strstr(whole.series[f], "event 0x1") != NULL;
    }
    ck_assert_msg(found, "%s never ends a step: %s", what, whole.series[FRAMES]);
    drop(&whole);
}

/* All bands find it, and end the step at the same time. */
START_TEST(runs_stop_at_the_same_time)
{
    weft_stop_def at[] = { { WEFT_STOP_STRAIN, 0.058, 0.0 },
                           { WEFT_STOP_GAP, 0.01, 0.0 },
                           { WEFT_STOP_KINETIC, 0.007, 0.0 },
                           { WEFT_STOP_REST, 3.0, 0.0 } };
    for (size_t i = 0; i < sizeof at / sizeof at[0]; ++i) {
        scenario of = on_shapes();
        check_event(&of, weft_stop_event, &at[i], weft_stop_name(at[i].quantity));
    }
}
END_TEST

/* How far the first particle of the last row is above *z; NaN where it is not. */
static double last_row(void *z, const weft_cloth *cloth, double t, const double *y)
{
    const weft_band band = weft_cloth_band(cloth);
    const size_t n = weft_cloth_particles(cloth), i = n - n / weft_cloth_rows(cloth);
    (void)t;
    return band.first + band.own < band.rows ? (double)NAN
                                             : y[2 * n + i] - *(const double *)z;
}

/* Of all bands' values the smallest counts, and NaN does not. */
START_TEST(events_of_the_embedder_are_the_smallest_of_all_bands)
{
    double low = -0.0125, last = -0.002;
    scenario of = on_shapes();
    check_event(&of, lowest, &low, "the lowest particle");
    check_event(&of, last_row, &last, "the last row");
    of.sim.event_hold = 0.01;
    check_event(&of, lowest, &low, "the lowest particle");
    low = -0.005;
    of = in_wind(11, 6, "verlet/velocity_verlet");
    check_event(&of, lowest, &low, "the lowest particle");
    const weft_stop_def never = { .quantity = WEFT_STOP_NEVER };
    of.sim.event = weft_stop_event;
    of.sim.event_ctx = (void *)&never;
    check_runs(&of);
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
    *load = (weft_load){ .rows = some(rows), .cols = some(cols), .mass = 0.01 };
    of.cloth.pins = some_pins, of.cloth.pin_count = below(4);
    of.cloth.loads = load, of.cloth.load_count = below(2);
    of.cloth.wind_drag = below(2) > 0 ? 0.4 : 0.0;
    of.cloth.damping = below(2) > 0 ? 1e-3 : 0.0;
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

TEST_SUITE(bands)
{
    Suite *suite = suite_create("bands");
    TCase *same = tcase_create("same bits"), *slow = test_long(suite, 120);
    tcase_set_timeout(same, 120);
    tcase_add_test(same, every_method_that_agrees_has_the_same_bits);
    tcase_add_test(same, narrow_long_and_short_bands_have_the_same_bits);
    tcase_add_test(same, threads_of_bands_have_the_same_bits);
    tcase_add_test(slow, runs_stop_at_the_same_time);
    tcase_add_test(same, events_of_the_embedder_are_the_smallest_of_all_bands);
    tcase_add_test(slow, bands_take_steps_back_together);
    tcase_add_test(same, random_cloths_have_the_same_bits_or_failures);
    suite_add_tcase(suite, same);
    return suite;
}
