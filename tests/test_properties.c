/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first */
/* test_properties.c -- every scene of tests/properties has every property of the table
 * below, unless a comment of the scene says why not. */
#include "objective.h"
#include "products.h"
#include "properties.h"
#include "shell.h"

#include "base/isa.h"
#include "cloth/model.h"
#include "sim/simulation.h"
#include "weft/gradient.h"

/* The scene of the test. */
static const char *scene_name;

static subject open_scene(void)
{
    return load(scene_name, PLAIN, NULL, 0);
}

static subject open_with(const char *stepper, double h)
{
    char set[160];
    const char *const sets[] = { set, "stop=null", "run.frames=step" };
    (void)snprintf(set, sizeof set, "stepper={%s: %.17g}", stepper, h);
    return load(scene_name, PLAIN, sets, 3);
}

static double *copy_of(const double *y, size_t count)
{
    double *copy = malloc(count * sizeof *copy);
    ck_assert_ptr_nonnull(copy);
    return memcpy(copy, y, count * sizeof *copy);
}

/* In (-1, 1), of the velocities of free particles. */
static void shake(const weft_cloth *cloth, double *y, uint64_t *seed)
{
    const size_t n = weft_cloth_particles(cloth);
    for (size_t j = 3 * n; j < 6 * n; ++j) {
        const size_t v = weft_cloth_vertex(cloth, j % n);
        y[j] += weft_cloth_pinned(cloth, v) ? 0.0 : 2.0 * random_uniform(seed) - 1.0;
    }
}

/* ---- of a state, halfway through the run ------------------------------------------
 */

static subject halfway(void)
{
    subject of = open_scene();
    begin(&of);
    advance(&of, 0.5);
    return of;
}

/* d(energy)/dt along the motion is the sum of all powers. */
static void powers_are_the_rate_of_the_energy(void)
{
    static const double weights[4] = { 8.0, -8.0, -1.0, 1.0 };
    const double s = 1e-6;
    subject of = halfway();
    const size_t dim = weft_cloth_dim(of.cloth);
    const double t = weft_sim_time(of.sim);
    double *y = copy_of(weft_sim_state(of.sim), dim), *f = calloc(2 * dim, sizeof *f);
    double *at = f + dim, p[WEFT_POWERS];
    uint64_t seed = 7;
    for (int round = 0; round < 4; ++round) {
        double rate = 0.0, size = 0.0;
        ck_assert_int_eq(weft_cloth_rhs(of.cloth, t, y, f), 0);
        weft_cloth_power(of.cloth, t, y, p);
        for (size_t k = 0; k < 4; ++k) {
            const double way = (k % 2 == 0 ? 1.0 : -1.0) * (double)(1 + k / 2) * s;
            for (size_t i = 0; i < dim; ++i) {
                at[i] = y[i] + way * f[i];
            }
            const double energy
                = weft_energy_total(weft_cloth_energy(of.cloth, t + way, at));
            rate += weights[k] * energy / (12.0 * s);
        }
        const double heat = p[WEFT_POWER_SPRINGS] + p[WEFT_POWER_DRAG]
                            + p[WEFT_POWER_CONTACT] + p[WEFT_POWER_FRICTION];
        const double power
            = p[WEFT_POWER_WIND] + p[WEFT_POWER_PINS] + p[WEFT_POWER_SHAPES] - heat;
        ck_assert_double_eq(weft_cloth_dissipation(of.cloth, t, y), heat);
        for (size_t k = 0; k < WEFT_POWERS; ++k) {
            size += fabs(p[k]);
        }
        ck_assert_msg(fabs(rate - power) <= 1e-7 * (size + fabs(rate)),
                      "%.12g W, not %.12g W", power, rate);
        shake(of.cloth, y, &seed);
    }
    free(y);
    free(f);
    finish(&of);
}

static void products_are_derivatives(void)
{
    subject of = halfway();
    expect_products(of.cloth, weft_sim_time(of.sim), weft_sim_state(of.sim), 1e-6, 5);
    finish(&of);
}

/* No free motion of the positions is stiffer than the bound, which is not far above the
 * stiffest: the power method with products of the Jacobian. */
static void bounds_hold(void)
{
    subject of = halfway();
    const size_t dim = weft_cloth_dim(of.cloth), half = dim / 2, n = dim / 6;
    const double t = weft_sim_time(of.sim), *y = weft_sim_state(of.sim);
    const weft_stiffness bound = weft_cloth_stiffness(of.cloth, t, y);
    double *v = calloc(2 * dim, sizeof *v), *jv = v + dim, found = 0.0;
    uint64_t seed = 3;
    for (size_t j = 0; j < half; ++j) {
        const bool pinned
            = weft_cloth_pinned(of.cloth, weft_cloth_vertex(of.cloth, j % n));
        v[j] = pinned ? 0.0 : random_uniform(&seed) - 0.5;
    }
    for (int k = 0; k < 60; ++k) {
        double before = 0.0, after = 0.0;
        ck_assert_int_eq(weft_cloth_jacobian_product(of.cloth, t, y, v, jv), 0);
        for (size_t j = 0; j < half; ++j) {
            const double m = weft_cloth_particle_mass(
                of.cloth, weft_cloth_vertex(of.cloth, j % n));
            before += m * v[j] * v[j];
            after += m * jv[half + j] * jv[half + j];
        }
        found = sqrt(after / before);
        for (size_t j = 0; j < half; ++j) {
            v[j] = -jv[half + j] / sqrt(after);
        }
    }
    ck_assert_msg(found <= bound.omega2, "%g > %g 1/s^2", found, bound.omega2);
    ck_assert_msg(found >= 0.1 * bound.omega2, "%g of %g 1/s^2", found, bound.omega2);
    free(v);
    finish(&of);
}

/* ---- of a run ----------------------------------------------------------------------
 */

/* The state at the end under a method, in steps of h. */
static double *end_of(const char *stepper, double h, size_t *dim)
{
    subject of = open_with(stepper, h);
    begin(&of);
    advance(&of, 1.0);
    *dim = weft_cloth_dim(of.cloth);
    double *y = copy_of(weft_sim_state(of.sim), *dim);
    finish(&of);
    return y;
}

static void expect_order(const char *stepper, double h, int order)
{
    double *y[3], apart[2] = { 0.0, 0.0 };
    size_t dim;
    for (size_t k = 0; k < 3; ++k) {
        y[k] = end_of(stepper, ldexp(h, -(int)k), &dim);
    }
    for (size_t j = 0; j < dim; ++j) {
        apart[0] = fmax(apart[0], fabs(y[1][j] - y[0][j]));
        apart[1] = fmax(apart[1], fabs(y[2][j] - y[1][j]));
    }
    const double found = log2(apart[0] / apart[1]);
    ck_assert_msg(found >= order - 0.3, "%s: order %.2f (%g, %g)", stepper, found,
                  apart[0], apart[1]);
    for (size_t k = 0; k < 3; ++k) {
        free(y[k]);
    }
}

static void methods_have_their_order(void)
{
    subject of = open_scene();
    expect_order("plugin: verlet, method: velocity_verlet, fixed_step", of.step, 2);
#ifdef HAVE_ARKODE
    expect_order("plugin: arkode, method: rk4, fixed_step", of.step, 4);
#endif
    finish(&of);
}

static void the_energy_balance_closes(void)
{
    subject of
        = open_with("plugin: arkode, method: dormand_prince, atol: 1e-9, rtol", 1e-9);
    of.run.ledger = true;
    begin(&of);
    advance(&of, 1.0);
    const weft_ledger end = weft_sim_ledger(of.sim);
    const double size = fabs(end.dissipated_springs) + fabs(end.dissipated_drag)
                        + fabs(end.work_wind) + fabs(end.work_pins)
                        + fabs(end.dissipated_contact) + fabs(end.dissipated_friction)
                        + fabs(end.shape_work) + end.energy.kinetic;
    ck_assert_msg(fabs(end.residual) <= 1e-6 * size, "%g of %g J", end.residual, size);
    finish(&of);
}

/* The first line in which they differ is shown. */
static void expect_same(const char *one, const char *other, const char *what)
{
    size_t line = 0;
    for (size_t i = 0; one[i] != '\0' && one[i] == other[i]; ++i) {
        line = one[i] == '\n' ? i + 1 : line;
    }
    ck_assert_msg(strcmp(one, other) == 0, "%s: %.*s, not %.*s", what,
                  (int)strcspn(other + line, "\n"), other + line,
                  (int)strcspn(one + line, "\n"), one + line);
}

static void keep_ledger(subject *of)
{
    of->run.ledger = (of->run.method->flags & WEFT_STEPPER_QUADRATURES) != 0;
}

/* Another pin, wind and motion of a shape than those of the definition. */
static void change_much(weft_sim *sim)
{
    const double there[3] = { 0.0, 0.1, 0.05 };
    weft_error err = { 0 };
    weft_status status = weft_sim_set_wind(sim, there, 0.3, &err);
    status = status == WEFT_OK ? weft_sim_pin(sim, 3, there, &err) : status;
    if (status == WEFT_OK && weft_cloth_shapes(weft_sim_cloth(sim)) > 0) {
        status = weft_sim_move_shape(sim, 0, NULL, there, &err);
    }
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
}

/* Restored into a simulation of another cloth of the same definition, which starts at
 * other velocities. */
static void expect_restored(bool changed)
{
    static char one[TEXT], other[TEXT];
    weft_error err = { 0 };
    subject a = open_scene(), b = open_scene();
    double *start = calloc(weft_cloth_dim(b.cloth), sizeof *start);
    uint64_t seed = 11;
    weft_cloth_start(b.cloth, start);
    shake(b.cloth, start, &seed);
    b.run.start = start;
    keep_ledger(&a), keep_ledger(&b);
    begin(&a), begin(&b);
    free(start);
    advance(&a, 0.3);
    if (changed) {
        change_much(a.sim);
    }
    advance(&a, 0.5);
    const size_t size = weft_sim_save_size(a.sim);
    unsigned char *bytes = malloc(size);
    ck_assert_int_eq(weft_sim_save(a.sim, bytes, size, &err), WEFT_OK);
    ck_assert_msg(weft_sim_restore(b.sim, bytes, size, &err) == WEFT_OK, "%s",
                  err.message);
    put_frame(a.sim, one), put_frame(b.sim, other);
    expect_same(one, other, "at once");
    advance(&a, 1.0), advance(&b, 1.0);
    describe(a.sim, one), describe(b.sim, other);
    expect_same(one, other, "at the end");
    ck_assert_int_eq(weft_sim_restore(a.sim, bytes, size, &err), WEFT_OK); /* back */
    advance(&a, 1.0);
    describe(a.sim, other);
    expect_same(one, other, "the same simulation");
    free(bytes);
    finish(&a), finish(&b);
}

static void restored_runs_have_the_same_bits(void)
{
    expect_restored(false);
    expect_restored(true);
}

/* A cloth with another value of a parameter does not take what was saved. */
static void other_cloths_refuse_it(void)
{
    weft_error err = { 0 };
    subject of = load(scene_name, WITH_PARAMETERS, NULL, 0);
    const weft_sensitivity_def *all = weft_scene_perturbed_def(of.perturbed);
    begin(&of);
    const size_t size = weft_sim_save_size(of.sim);
    unsigned char *bytes = malloc(size);
    ck_assert_int_eq(weft_sim_save(of.sim, bytes, size, &err), WEFT_OK);
    for (size_t j = 0; j < all->count; ++j) {
        const weft_parameter *by = &all->parameters[j];
        weft_sim_def def = of.run;
        weft_sim *other;
        def.cloth = by->more;
        ck_assert_int_eq(weft_sim_create(&def, &other, &err), WEFT_OK);
        const weft_status status = weft_sim_restore(other, bytes, size, &err);
        const bool start = strncmp(by->name, "cloth.velocity", 14) == 0;
        ck_assert_msg(status == (start ? WEFT_OK : WEFT_INVALID), "%s", by->name);
        weft_sim_destroy(other);
    }
    free(bytes);
    finish(&of);
}

static void every_instruction_set_has_the_same_bits(void)
{
    static char first[TEXT], text[TEXT];
    for (weft__isa isa = WEFT__LOOPS; isa <= weft__isa_last(); ++isa) {
        subject of = open_scene();
        keep_ledger(&of);
        weft__cloth_choose(of.cloth, isa);
        begin(&of);
        advance(&of, 0.5);
        describe(of.sim, isa == WEFT__LOOPS ? first : text);
        expect_same(first, isa == WEFT__LOOPS ? first : text, weft__isa_name(isa));
        finish(&of);
    }
}

static void threads_have_the_same_bits(void)
{
    static char first[TEXT], text[TEXT];
    subject of = load(scene_name, LARGE, NULL, 0);
    keep_ledger(&of);
    for (size_t threads = 1; threads <= 3; threads += 2) {
        of.run.config.threads = threads;
        begin(&of);
        ck_assert(threads == 1 || of.sim->forces.pool != NULL);
        for (int i = 0; i < 2; ++i) {
            weft_error err = { 0 };
            ck_assert_msg(weft_sim_step(of.sim, 1.0, &err) == WEFT_OK, "%s",
                          err.message);
        }
        describe(of.sim, threads == 1 ? first : text);
        expect_same(first, threads == 1 ? first : text, "three threads");
        weft_sim_destroy(of.sim);
        of.sim = NULL;
    }
    finish(&of);
}

static void bands_have_the_same_bits(void)
{
    subject of = open_scene();
    const bool large = weft_scene_cloth(of.scene)->mesh != NULL;
    if (large) {
        finish(&of);
        of = load(scene_name, LARGE, NULL, 0);
    }
    keep_ledger(&of);
    scenario in = { .cloth = *weft_scene_cloth(of.scene), .sim = of.run };
    in.duration = weft_scene_run(of.scene)->duration;
    const size_t most = weft_cloth_def_blocks(&in.cloth) / WEFT_GHOST_ROWS;
    const int first = large ? 3 : 2; /* the second of three has others on both sides */
    outcome whole, parts;
    ck_assert_uint_ge(most, 3);
    run_whole(&in, &whole);
    for (int bands = first; bands <= 3; ++bands) {
        run_bands(&in, bands, &parts);
        check_bits(&in, &whole, &parts);
        drop(&parts);
    }
    drop(&whole);
    finish(&of);
}

static weft_status pass_frame(void *ctx, size_t i, weft_error *err)
{
    (void)ctx, (void)i, (void)err;
    return WEFT_OK;
}

static void frames_within_steps_change_nothing(void)
{
    double *y[2];
    size_t dim = 0;
    for (size_t k = 0; k < 2; ++k) {
        weft_error err = { 0 };
        subject of = open_scene();
        weft_run_def run = *weft_scene_run(of.scene);
        run.fps = k == 0 ? 1.0 / run.duration : 20.0 / run.duration;
        const weft_play play
            = { .run = &run, .last = weft_run_last_frame(&run), .frame = pass_frame };
        of.run.interpolate = true;
        begin(&of);
        ck_assert_msg(weft_sim_play(of.sim, &play, &err) == WEFT_OK, "%s", err.message);
        dim = weft_cloth_dim(of.cloth);
        y[k] = copy_of(weft_sim_state(of.sim), dim);
        finish(&of);
    }
    ck_assert_mem_eq(y[0], y[1], dim * sizeof *y[0]);
    free(y[0]), free(y[1]);
}

/* A simulation works on a copy of its cloth: which is the same, and whose changes are
 * not those of the cloth. */
static void copies_are_the_cloth_and_change_alone(void)
{
    subject of = halfway();
    const size_t dim = weft_cloth_dim(of.cloth);
    const double t = weft_sim_time(of.sim), blow[3] = { 5.0, 6.0, 7.0 };
    const weft_shape ball = { .kind = WEFT_SPHERE, .at = { 0, 9, 0 }, .radius = 0.1 };
    double *y = copy_of(weft_sim_state(of.sim), dim), *f[2], power[2][WEFT_POWERS];
    const weft_cloth *copy = weft_sim_cloth(of.sim);
    const weft_stiffness kept = weft_sim_stiffness(of.sim, t, y),
                         sought = weft_cloth_stiffness(of.cloth, t, y);
    ck_assert_mem_eq(&kept, &sought, sizeof kept);
    ck_assert_uint_eq(weft_sim_measure(of.sim).hash,
                      weft_cloth_state_hash(of.cloth, y));
    for (size_t k = 0; k < 2; ++k) {
        f[k] = calloc(3 * dim, sizeof *f[k]);
    }
    for (int round = 0; round < 2; ++round) {
        const weft_cloth *both[2] = { of.cloth, round == 0 ? copy : of.cloth };
        for (size_t k = 0; k < 2; ++k) {
            double *to = f[k];
            ck_assert_int_eq(weft_cloth_rhs(both[k], t, y, to), 0);
            ck_assert_int_eq(weft_cloth_jacobian_product(both[k], t, y, y, to + dim),
                             0);
            weft_cloth_strains(both[k], y, to + 2 * dim);
            weft_cloth_power(both[k], t, y, power[k]);
        }
        ck_assert_mem_eq(f[0], f[1], 3 * dim * sizeof *f[0]);
        ck_assert_mem_eq(power[0], power[1], sizeof power[0]);
        ck_assert_int_eq(weft_sim_set_wind(of.sim, blow, 1.0, NULL), WEFT_OK);
        ck_assert_int_eq(weft_sim_pin(of.sim, 1 + (size_t)round, blow, NULL), WEFT_OK);
        ck_assert_int_eq(weft_sim_add_shape(of.sim, &ball, NULL, NULL), WEFT_OK);
        memcpy(f[1], f[0], 3 * dim * sizeof *f[0]);
    }
    for (size_t k = 0; k < 2; ++k) {
        free(f[k]);
    }
    free(y);
    finish(&of);
}

/* ---- of derivatives ----------------------------------------------------------------
 */

enum { TIMES = 3 };

/* The gradient backwards is that forwards. */
static void adjoints_are_derivatives(void)
{
    const char *const sets[] = { "stepper={plugin: arkode, method: dormand_prince, "
                                 "rtol: 1e-4, atol: 1e-4}" };
    subject of = load(scene_name, WITH_PARAMETERS, sets, 1);
    size_t dim = weft_cloth_dim(of.cloth);
    const double end = weft_scene_run(of.scene)->duration;
    const double times[TIMES] = { 0.0, 0.4 * end, end };
    const weft_sensitivity_def *all = weft_scene_perturbed_def(of.perturbed);
    double value = 0.0, whole, sums[WEFT_SENSITIVITIES] = { 0.0 }, most = 0.0;
    double by_parameter[WEFT_SENSITIVITIES], *slope = calloc(dim, sizeof *slope);
    weft_error err = { 0 };
    ck_assert_ptr_nonnull(all);
    const weft_sim_def plain = of.run;
    weft_gradient_def def = weft_gradient_def_default();
    def.sim = &plain, def.count = all->count, def.parameters = all->parameters;
    def.frames = TIMES, def.times = times;
    def.objective = objective, def.ctx = &dim;
    ck_assert_msg(weft_gradient(&def, &whole, by_parameter, NULL, &err) == WEFT_OK,
                  "%s", err.message);
    const weft_sensitivity_def held = { all->count, all->parameters, false };
    of.run.sensitivity = &held;
    begin(&of);
    for (size_t frame = 0; frame < TIMES; ++frame) {
        ck_assert_int_eq(weft_sim_advance(of.sim, times[frame], &err), WEFT_OK);
        memset(slope, 0, dim * sizeof *slope);
        (void)objective(&dim, frame, times[frame], weft_sim_state(of.sim), &value,
                        slope);
        for (size_t j = 0; j < all->count; ++j) {
            for (size_t i = 0; i < dim; ++i) {
                sums[j] += slope[i] * weft_sim_sensitivity(of.sim, j)[i];
            }
            most = fmax(most, fabs(sums[j]));
        }
    }
    ck_assert_double_eq_tol(whole, value, 1e-11 * fabs(value));
    for (size_t j = 0; j < all->count; ++j) {
        ck_assert_msg(
            fabs(by_parameter[j] - sums[j]) <= 1e-6 * fabs(sums[j]) + 1e-8 * most,
            "%s: %.12g, not %.12g", all->parameters[j].name, by_parameter[j], sums[j]);
    }
    free(slope);
    finish(&of);
}

#define RK4 "stepper={plugin: arkode, method: rk4, fixed_step: %.17g}"

/* The state at the end with a parameter p (1 + d). */
static double *end_with(const char *stepper, const char *key, double value, size_t *dim)
{
    char set[160];
    const char *const sets[] = { stepper, set };
    (void)snprintf(set, sizeof set, "%s=%.17g", key, value);
    subject of = load(scene_name, PLAIN, sets, 2);
    begin(&of);
    advance(&of, 1.0);
    *dim = weft_cloth_dim(of.cloth);
    double *y = copy_of(weft_sim_state(of.sim), *dim);
    finish(&of);
    return y;
}

/* What a cloth with a parameter p (1 + d) adds to the rates at (t, y), by its weight.
 */
static void add_rates(const char *key, double value, double weight, double t,
                      const double *y, double *sum)
{
    char set[160];
    const char *const sets[] = { set };
    (void)snprintf(set, sizeof set, "%s=%.17g", key, value);
    subject of = load(scene_name, PLAIN, sets, 1);
    const size_t dim = weft_cloth_dim(of.cloth);
    double *rates = calloc(dim, sizeof *rates);
    ck_assert_int_eq(weft_cloth_rhs(of.cloth, t, y, rates), 0);
    for (size_t i = 0; i < dim; ++i) {
        sum[i] += weight * rates[i];
    }
    free(rates);
    finish(&of);
}

/* Of the rates, to the fourth order; and their sums backwards. */
static void parameter_products_are_derivatives(void)
{
    static const double weights[4] = { 8.0, -8.0, -1.0, 1.0 };
    subject plain = halfway(), of = load(scene_name, WITH_PARAMETERS, NULL, 0);
    const size_t dim = weft_cloth_dim(plain.cloth);
    const double t = weft_sim_time(plain.sim), *y = weft_sim_state(plain.sim);
    const weft_scene_sensitivity *all = weft_scene_sensitivities(of.scene);
    const double d = 0.2 * of.span;
    double *out = calloc(2 * dim, sizeof *out), *sum = out + dim, rate = 0.0;
    ck_assert_int_eq(weft_cloth_rhs(plain.cloth, t, y, out), 0);
    for (size_t i = 0; i < dim; ++i) {
        rate = fmax(rate, fabs(out[i]));
    }
    for (size_t j = 0; j < all->count; ++j) {
        const weft_parameter *by
            = &weft_scene_perturbed_def(of.perturbed)->parameters[j];
        const double roundoff = 4e-15 * rate / fmin(by->span, d);
        double most = 0.0, error = 0.0, forth = 0.0, back;
        memset(sum, 0, dim * sizeof *sum);
        for (size_t k = 0; k < 4; ++k) {
            const double way = (k % 2 == 0 ? 1.0 : -1.0) * (double)(1 + k / 2) * d;
            add_rates(all->keys[j], all->values[j] * (1.0 + way),
                      weights[k] / (12.0 * d), t, y, sum);
        }
        ck_assert_int_eq(
            weft_cloth_parameter_product(by->less, by->more, by->span, t, y, out), 0);
        ck_assert_int_eq(weft_cloth_parameter_product_transposed(
                             by->less, by->more, by->span, t, y, y, &back),
                         0);
        for (size_t i = 0; i < dim; ++i) {
            most = fmax(most, fabs(sum[i]));
            error = fmax(error, fabs(out[i] - sum[i]));
            forth += y[i] * out[i];
        }
        ck_assert_msg(error <= 1e-6 * most + roundoff, "%s: %g, of which %g is wrong",
                      all->keys[j], most, error);
        ck_assert_double_eq(back, forth);
    }
    free(out);
    finish(&plain), finish(&of);
}

/* Those of runs in fixed steps, to the fourth order, by differences of p (1 +- d). */
static void derivatives_are_those_of_differences(void)
{
    static const double weights[4] = { 8.0, -8.0, -1.0, 1.0 };
    char stepper[160];
    subject first = open_scene();
    (void)snprintf(stepper, sizeof stepper, RK4, first.step);
    finish(&first);
    const char *const sets[] = { stepper };
    subject of = load(scene_name, WITH_PARAMETERS, sets, 1);
    const double d = of.span, bound = fmax(1e-7, 2e-11 / d);
    const weft_scene_sensitivity *all = weft_scene_sensitivities(of.scene);
    of.run.sensitivity = weft_scene_perturbed_def(of.perturbed);
    begin(&of);
    advance(&of, 1.0);
    for (size_t j = 0; j < all->count; ++j) {
        const double *s = weft_sim_sensitivity(of.sim, j);
        size_t dim = weft_cloth_dim(of.cloth);
        double *sum = calloc(dim, sizeof *sum), most = 0.0, error = 0.0;
        for (size_t k = 0; k < 4; ++k) {
            const double way = (k % 2 == 0 ? 1.0 : -1.0) * (double)(1 + k / 2) * d;
            double *y
                = end_with(stepper, all->keys[j], all->values[j] * (1.0 + way), &dim);
            for (size_t i = 0; i < dim; ++i) {
                sum[i] += weights[k] * y[i] / (12.0 * d);
            }
            free(y);
        }
        for (size_t i = 0; i < dim; ++i) {
            most = fmax(most, fabs(sum[i]));
            error = fmax(error, fabs(s[i] - sum[i]));
        }
        ck_assert_msg(most > 1e-9 && error <= bound * most + 1e-13 / d,
                      "%s: %g, of which %g is wrong", all->keys[j], most, error);
        free(sum);
    }
    finish(&of);
}

/* ---- of files ----------------------------------------------------------------------
 */

#define OUT BUILD_DIR "/properties/%s"

/* A shell command with the scene's name for each %s, up to six. */
static void command(const char *format)
{
    char text[1024];
    const char *name = scene_name;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    (void)snprintf(text, sizeof text, format, name, name, name, name, name, name);
#pragma GCC diagnostic pop
    expect(shell("%s", text), 0);
}

/* The scene that a run keeps makes the same files again, also frames that are computed
 * for an export because run.vtkhdf is gone. */
static void results_make_the_run_again(void)
{
    command("rm -rf " OUT ".a " OUT ".b && mkdir -p " BUILD_DIR "/properties");
    command(WEFT " run tests/properties/%s.yaml --set sensitivity=null --out " OUT
                 ".a --quiet 2>&1 && " WEFT " run " OUT ".a/scene.yaml --out " OUT
                 ".b --quiet 2>&1");
    command("for f in run.vtkhdf series.csv final.csv; do cmp " OUT ".a/$f " OUT
            ".b/$f 2>&1 || exit 1; done; rm " OUT ".b/run.vtkhdf");
    command("for d in a b; do " WEFT " export " OUT ".$d --format pc2 2>&1 || exit 1; "
            "done; cmp " OUT ".a/run.pc2 " OUT ".b/run.pc2 2>&1");
}

/* ---- the table ---------------------------------------------------------------------
 */

static void comments_name_properties(void);

static const struct {
    const char *name; /* in `# not NAME: why` of a scene */
    void (*check)(void);
} properties[] = {
    { "powers", powers_are_the_rate_of_the_energy },
    { "products", products_are_derivatives },
    { "bounds", bounds_hold },
    { "order", methods_have_their_order },
    { "balance", the_energy_balance_closes },
    { "saved", restored_runs_have_the_same_bits },
    { "refused", other_cloths_refuse_it },
    { "isa", every_instruction_set_has_the_same_bits },
    { "threads", threads_have_the_same_bits },
    { "bands", bands_have_the_same_bits },
    { "frames", frames_within_steps_change_nothing },
    { "copy", copies_are_the_cloth_and_change_alone },
    { "adjoint", adjoints_are_derivatives },
    { "parameters", parameter_products_are_derivatives },
    { "derivatives", derivatives_are_those_of_differences },
    { "results", results_make_the_run_again },
    { "comments", comments_name_properties },
};

enum { PROPERTIES = sizeof properties / sizeof properties[0] };

static void comments_name_properties(void)
{
    char text[SCENE_TEXT], key[NAME];
    read_scene(scene_name, text);
    for (const char *at = text; (at = strstr(at, "\n# not ")) != NULL;) {
        bool known = false;
        at += strlen("\n# not ");
        for (size_t k = 0; k < PROPERTIES; ++k) {
            (void)snprintf(key, sizeof key, "%s: ", properties[k].name);
            known = known || strncmp(at, key, strlen(key)) == 0;
        }
        ck_assert_msg(known, "no property: %.20s", at);
    }
}

/* Test number _i is of property _i % PROPERTIES. */
static void holds(int _i)
{
    char text[SCENE_TEXT], key[NAME];
    const char *property = properties[_i % PROPERTIES].name;
    scene_name = scene_names[_i / PROPERTIES];
    read_scene(scene_name, text);
    (void)snprintf(key, sizeof key, "not %s", property);
    if (scene_says(text, key)[0] == '\0') {
        properties[_i % PROPERTIES].check();
    }
}

TEST_SUITE(properties)
{
    static TTest tests[PROPERTIES];
    Suite *suite = suite_create("properties");
    const size_t scenes = find_scenes();
    for (size_t k = 0; k < PROPERTIES; ++k) {
        tests[k] = (TTest){ properties[k].name, holds, __FILE__, __LINE__ };
    }
    for (size_t s = 0; s < scenes; ++s) {
        TCase *tcase = tcase_create(scene_names[s]);
        tcase_set_timeout(tcase, 120.0);
        for (size_t k = 0; k < PROPERTIES; ++k) {
            const int i = (int)(s * PROPERTIES + k);
            tcase_add_loop_test(tcase, &tests[k], i, i + 1);
        }
        suite_add_tcase(suite, tcase);
    }
    return scenes > 0 ? suite : NULL;
}
