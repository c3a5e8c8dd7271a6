/* SPDX-License-Identifier: BSD-3-Clause */
/* test_ledger.c -- the energy ledger: each channel against a closed form, what comes
 * from outside, and what the program shows of it. */
#include "ledger_run.h"

#include <stdlib.h>

#define WEFT BUILD_DIR "/weft"
#define OUT  BUILD_DIR "/ledger"

/* ---- one channel at a time, over 1 s in steps of 1 ms ------------------------------
 */

/* The ledger of the model after t. */
static weft_ledger after(const char *method, double t)
{
    teardown();
    cloth = test_cloth(&model);
    sim = make(test_method_named(method), fixed(1e-3), true);
    go(sim, t);
    const weft_ledger ledger = weft_sim_ledger(sim);
    ck_assert(ledger.kept);
    return ledger;
}

static void near(double is, double wanted, double tol)
{
    ck_assert_double_eq_tol(is, wanted, tol);
}

/* All but the two that are named are 0. */
static void only(const weft_ledger *l, const double *one, const double *other)
{
    const double *all[]
        = { &l->dissipated_springs, &l->dissipated_drag, &l->work_wind,
            &l->work_pins,          &l->work_limit,      &l->work_outside };
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        ck_assert(all[i] == one || all[i] == other || *all[i] == 0.0);
    }
}

/* Two particles of 0.1 kg, 1 m apart: p at (0, 0), q below it. */
static void two_particles(void)
{
    model.rows = 2;
    model.cols = 1;
    model.mass = 0.1;
    model.density = 0.0;
    memset(model.gravity, 0, sizeof model.gravity);
}

static const char *const fine[] = {
    "verlet/velocity_verlet",
    "verlet/midpoint",
#ifdef HAVE_GSL
    "gsl/rk8pd",
#endif
#ifdef HAVE_ARKODE
    "arkode/dormand_prince",
#endif
};

#define FINE ((int)(sizeof fine / sizeof *fine))

/* What the best of `fine` leaves, or one of order 2. */
static double good(int method)
{
    return method < 2 ? 5e-6 : 1e-12;
}

START_TEST(free_fall_moves_energy_and_makes_none)
{
    model.velocity[0] = 2.0;
    const weft_ledger l = after(fine[_i], 1.0);
    only(&l, NULL, NULL);
    near(l.residual, 0.0, 1e-12);
    ck_assert_double_gt(l.energy.kinetic, 5.0);
}
END_TEST

/* m v0^2 / 2 (1 - e^(-2 D t / m)) */
START_TEST(drag_turns_speed_into_heat)
{
    two_particles();
    model.damping = 0.05;
    model.velocity[2] = 3.0;
    const weft_ledger l = after(fine[_i], 1.0);
    only(&l, &l.dissipated_drag, NULL);
    near(l.dissipated_drag, 0.1 * 9.0 * -expm1(-2.0 * 0.05 / 0.1), good(_i));
    near(l.residual, 0.0, good(_i));
    near(weft_sim_dissipated(sim), l.dissipated_drag, 1e-15);
}
END_TEST

/* Of the relative velocity w0 e^(-c t / mu): mu w0^2 / 2 (1 - e^(-2 c t / mu)) */
START_TEST(a_damper_turns_relative_speed_into_heat)
{
    const double mu = 0.05, c = 0.03, w = 0.2;
    const double v[6] = { 0.0, 0.0, 0.0, 0.0, -w, 0.0 };
    weft_error err;
    two_particles();
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 0.0, .damping = c };
    (void)after(fine[_i], 1e-3);
    ck_assert_int_eq(weft_sim_set_state(sim, NULL, v, &err), WEFT_OK);
    go(sim, 1.001);
    const weft_ledger l = weft_sim_ledger(sim);
    only(&l, &l.dissipated_springs, &l.work_outside);
    near(l.work_outside, 0.5 * 0.1 * w * w, 1e-17);
    near(l.dissipated_springs, 0.5 * mu * w * w * -expm1(-2.0 * c / mu), good(_i));
    near(l.residual, 0.0, good(_i));
}
END_TEST

/* Hanging and lifted at one speed from the start: m g V t. */
START_TEST(a_pin_that_lifts_works_against_gravity)
{
    const double k = 40.0, speed = 0.3;
    two_particles();
    model.gravity[1] = -9.81;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = k, .damping = 0.02 };
    model.scale = 1.0 + 0.1 * 9.81 / k;
    model.velocity[1] = speed;
    pins[0].velocity[1] = speed;
    model.pins = pins;
    model.pin_count = 1;
    const weft_ledger l = after(fine[_i], 1.0);
    near(l.work_pins, 0.1 * 9.81 * speed * 1.0, 1e-12);
    near(l.dissipated_springs, 0.0, 1e-12);
    near(l.residual, 0.0, 1e-12);
}
END_TEST

/* Between two pins, one swinging along the spring: k x^2 / 2 and the damper's heat
 * c A^2 w^2 (t / 2 + sin(2 w t) / (4 w)). */
START_TEST(a_swinging_pin_works_against_spring_and_damper)
{
    const double k = 7.0, c = 0.4, amplitude = 0.1, w = 6.283185307179586 * 0.9;
    const double x = amplitude * sin(w * 1.0);
    two_particles();
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = k, .damping = c };
    pins[1].rows = (weft_range){ 1, 1 };
    pins[1].amplitude[1] = amplitude;
    pins[1].frequency = 0.9;
    model.pins = pins;
    model.pin_count = 2;
    const weft_ledger l = after(fine[_i], 1.0);
    const double heat
        = c * amplitude * amplitude * w * w * (0.5 + sin(2.0 * w) / (4.0 * w));
    only(&l, &l.dissipated_springs, &l.work_pins);
    near(l.dissipated_springs, heat, good(_i));
    near(l.work_pins, 0.5 * k * x * x + heat, good(_i));
    near(l.residual, 0.0, good(_i));
}
END_TEST

/* A flat sheet that faces the wind goes with it, v = W (1 - e^(-t / tau)) with
 * tau = density / drag: all its kinetic energy is the wind's. */
START_TEST(wind_pushes_a_flat_sheet)
{
    model.rows = 4;
    model.cols = 5;
    model.spacing[0] = 0.5;
    model.spacing[1] = 0.25;
    model.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.1 };
    model.density = 0.2;
    memset(model.gravity, 0, sizeof model.gravity);
    model.wind_velocity[2] = 4.0;
    model.wind_drag = 0.3;
    const double v = 4.0 * -expm1(-0.3 / 0.2), mass = 0.2 * 1.5 * 1.0;
    const weft_ledger l = after(fine[_i], 1.0);
    only(&l, &l.work_wind, NULL);
    near(l.work_wind, 0.5 * mass * v * v, good(_i));
    near(l.residual, 0.0, good(_i));
}
END_TEST

/* ---- a step that fails ------------------------------------------------------------
 */

START_TEST(a_failed_step_leaves_it_untouched)
{
    weft_error err;
    all_at_once();
    sim = make(test_method_named("verlet/midpoint"), fixed(0.4), true);
    weft_ledger before = weft_sim_ledger(sim);
    while (weft_sim_step(sim, 1e4, &err) == WEFT_OK) {
        before = weft_sim_ledger(sim);
    }
    const weft_ledger l = weft_sim_ledger(sim);
    ck_assert_int_eq(err.status, WEFT_NOT_FINITE);
    ck_assert_double_gt(l.energy.kinetic, 1e100);
    ck_assert_mem_eq(&l.energy, &before.energy, sizeof l.energy);
    ck_assert(l.dissipated_springs == before.dissipated_springs);
    ck_assert(l.dissipated_drag == before.dissipated_drag);
    ck_assert(l.work_wind == before.work_wind && l.work_pins == before.work_pins);
}
END_TEST

/* ---- work from outside -------------------------------------------------------------
 */

typedef struct brake {
    double taken; /* [J] */
    bool tells;
} brake;

/* Velocities of the free particles times 15/16. */
static bool slow_down(void *ctx, double t, double h, double *y)
{
    const size_t n = weft_cloth_particles(cloth);
    brake *self = ctx;
    const double before = weft_cloth_energy(cloth, 0.0, y).kinetic;
    for (size_t i = 0; i < 3 * n && self->tells; ++i) {
        y[3 * n + i] *= weft_cloth_pinned(cloth, i % n) ? 1.0 : 0.9375;
    }
    self->taken += before - weft_cloth_energy(cloth, 0.0, y).kinetic;
    return self->tells && t > 0.0 && h > 0.0;
}

START_TEST(corrections_are_accounted_for)
{
    for (int tells = 0; tells < 2; ++tells) {
        brake on = { .tells = tells == 1 };
        weft_error err = { 0 };
        weft_sim_def def = weft_sim_def_default();
        teardown();
        all_at_once();
        def.cloth = cloth;
        def.method = test_method_named("verlet/velocity_verlet");
        def.config = fixed(1.0 / 1024);
        def.correct = slow_down;
        def.correct_ctx = &on;
        def.ledger = true;
        ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
        go(sim, 1.0);
        const weft_ledger l = weft_sim_ledger(sim);
        ck_assert(tells == 0 || on.taken > 0.01);
        near(l.work_outside, -on.taken, 1e-13);
        near(l.residual, 0.0, 1e-5);
        ck_assert(l.work_limit == 0.0);
    }
}
END_TEST

START_TEST(a_state_from_outside_is_gone_on_with)
{
    double x[3 * 20], v[3 * 20];
    weft_error err;
    all_at_once();
    sim = make(test_method_named("verlet/velocity_verlet"), fixed(1.0 / 1024), true);
    go(sim, 0.5);
    const weft_ledger before = weft_sim_ledger(sim);
    weft_sim_positions(sim, x);
    weft_sim_velocities(sim, v);
    for (size_t i = 0; i < 60; ++i) {
        x[i] *= 1.0 + 0.1 * sin((double)i);
        v[i] += cos((double)i);
    }
    ck_assert_int_eq(weft_sim_set_state(sim, x, v, &err), WEFT_OK);
    const weft_ledger edited = weft_sim_ledger(sim);
    ck_assert(edited.dissipated_drag == before.dissipated_drag);
    ck_assert_double_gt(edited.work_outside, 0.1);
    near(edited.residual, before.residual, 1e-14);
    go(sim, 1.0);
    const weft_ledger l = weft_sim_ledger(sim);
    ck_assert_double_gt(l.dissipated_drag, before.dissipated_drag);
    near(l.residual, 0.0, 1e-4);
}
END_TEST

/* ---- powers ------------------------------------------------------------------------
 */

/* The energy along y + s f(t, y): its slope at s = 0, by a central difference. The
 * moved pin is each of the particles in turn. */
/* L = 0 has no direction: no power either. */
START_TEST(a_spring_without_length_has_no_power)
{
    double y[12] = { 0.0 }, power[WEFT_POWERS];
    two_particles();
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.1 };
    pins[0].velocity[0] = 1.0;
    model.pins = pins;
    model.pin_count = 1;
    cloth = test_cloth(&model);
    y[6] = y[11] = 1.0;
    weft_cloth_power(cloth, 0.0, y, power);
    for (size_t k = 0; k < WEFT_POWERS; ++k) {
        ck_assert(power[k] == 0.0);
    }
}
END_TEST

/* ---- the program -------------------------------------------------------------------
 */

static const char scene[] = "weft: 1\n"
                            "cloth:\n"
                            "  grid: {rows: 4, cols: 4, spacing: 0.1}\n"
                            "  density: 0.3\n"
                            "  springs: {stretch: {stiffness: 50, damping: 0.01}}\n"
                            "  pins: [{at: top, velocity: [0, 0, 0.2]}]\n"
                            "stepper: {plugin: verlet, method: velocity_verlet, "
                            "fixed_step: 1.0e-4}\n"
                            "run: {duration: 0.2, fps: 10}\n"
                            "record: {ledger: true}\n";

static int shell(const char *command, char *output, size_t size)
{
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    output[fread(output, 1, size - 1, pipe)] = '\0';
    return pclose(pipe);
}

START_TEST(series_has_its_columns_where_it_is_asked_for)
{
    static char text[8192];
    static const char columns[]
        = ",elastic_stretch,elastic_shear,elastic_bend,dissipated_springs,"
          "dissipated_drag,work_wind,work_pins,work_limit,residual,contact,min_gap,"
          "touching,vetoed,dissipated_contact,dissipated_friction,shape_work\n0,0,";
    FILE *stream;
    ck_assert_int_eq(shell("rm -rf " OUT " && mkdir -p " OUT, text, sizeof text), 0);
    ck_assert_ptr_nonnull(stream = fopen(OUT "/s.yaml", "w"));
    ck_assert_int_ge(fputs(scene, stream), 0);
    (void)fclose(stream);
    (void)unsetenv("WEFT_PLUGIN_PATH");
    ck_assert_int_eq(
        shell(WEFT " run " OUT "/s.yaml --out " OUT "/with 2>&1", text, sizeof text),
        0);
    ck_assert_ptr_nonnull(strstr(text, "; energy balance closes to "));
    ck_assert_int_eq(shell("cat " OUT "/with/series.csv", text, sizeof text), 0);
    ck_assert_ptr_nonnull(strstr(text, columns));
    const char *residual = text + strlen(text);
    for (int commas = 0; commas < 8; commas += *residual == ',') {
        --residual;
    }
    ++residual;
    ck_assert(fabs(strtod(residual, NULL)) < 1e-7 && strtod(residual, NULL) != 0.0);
    ck_assert_int_eq(shell("cat " OUT "/with/result.yaml", text, sizeof text), 0);
    ck_assert_ptr_nonnull(strstr(text, "  work_pins: "));
    ck_assert_int_eq(
        shell(WEFT " export " OUT "/with --frame 1 --format csv", text, sizeof text),
        0);
    ck_assert_int_eq(shell(WEFT " run " OUT "/s.yaml --quiet --out " OUT "/plain --set "
                                "record.ledger=false",
                           text, sizeof text),
                     0);
    ck_assert_int_eq(shell("cat " OUT "/plain/series.csv", text, sizeof text), 0);
    ck_assert_ptr_null(strstr(text, "residual"));
    ck_assert_int_eq(shell("cut -d, -f1-5,7-16 " OUT "/with/series.csv >" OUT "/a; "
                           "cut -d, -f1-5,7-16 " OUT "/plain/series.csv >" OUT "/b; "
                           "cmp " OUT "/a " OUT "/b",
                           text, sizeof text),
                     0);
}
END_TEST

/* ---- main --------------------------------------------------------------------------
 */

TEST_SUITE(ledger)
{
    Suite *suite = suite_create("ledger");
    add(suite, "free fall", free_fall_moves_energy_and_makes_none, FINE);
    add(suite, "drag", drag_turns_speed_into_heat, FINE);
    add(suite, "damper", a_damper_turns_relative_speed_into_heat, FINE);
    add(suite, "lift", a_pin_that_lifts_works_against_gravity, FINE);
    add(suite, "swing", a_swinging_pin_works_against_spring_and_damper, FINE);
    add(suite, "wind", wind_pushes_a_flat_sheet, FINE);
    add(suite, "failure", a_failed_step_leaves_it_untouched, 1);
    add(suite, "corrections", corrections_are_accounted_for, 1);
    add(suite, "outside", a_state_from_outside_is_gone_on_with, 1);
    add(suite, "no length", a_spring_without_length_has_no_power, 1);
    add(suite, "program", series_has_its_columns_where_it_is_asked_for, 1);
    return suite;
}
