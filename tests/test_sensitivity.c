/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* Derivatives of runs by numbers of their scenes: against exact solutions, and of
 * tables and of Verlet's map against differences of runs. test_properties.c has those
 * of all kinds of scenes. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "objective.h"
#include "scene_load.h"
#include "shell.h"
#include "weft/gradient.h"

/* A sheet that wind blows, over a sphere. */
#define SHEET                                                                          \
    "cloth:\n"                                                                         \
    "  grid: {rows: 5, cols: 6, spacing: [0.1, 0.08]}\n"                               \
    "  density: 0.2\n"                                                                 \
    "  springs:\n"                                                                     \
    "    stretch: {stiffness: 100, damping: 0.02}\n"                                   \
    "    shear: {stiffness: 50, damping: 0.01}\n"                                      \
    "    bend: {stiffness: 5, damping: 0.001}\n"                                       \
    "  pins:\n"                                                                        \
    "    - {at: top-left, velocity: [0.1, 0.2, -0.1]}\n"                               \
    "    - {at: top-right, amplitude: [0, 0, 0.1], frequency: 2}\n"                    \
    "forces:\n"                                                                        \
    "  gravity: [0, 0, -9.81]\n"                                                       \
    "  damping: 0.002\n"                                                               \
    "  wind: {velocity: [1, 2, 0.5], drag: 0.3}\n"                                     \
    "contact:\n"                                                                       \
    "  thickness: 0.03\n"                                                              \
    "  slip: 0.05\n"                                                                   \
    "  damping: 0.1\n"                                                                 \
    "  shapes:\n"                                                                      \
    "    - {shape: sphere, at: [0.25, -0.2, -0.22], radius: 0.2, velocity: [0.3, 0, "  \
    "0.1]}\n"

/* A strip whose lower end is lifted to the upper one, which it touches. */
#define FOLD                                                                           \
    "cloth:\n"                                                                         \
    "  grid: {rows: 12, cols: 3, spacing: 0.05, down: [0, 0, -1]}\n"                   \
    "  density: 0.2\n"                                                                 \
    "  springs:\n"                                                                     \
    "    stretch: {stiffness: 200, damping: 0.02}\n"                                   \
    "    shear: {stiffness: 100, damping: 0.01}\n"                                     \
    "    bend: {stiffness: 2, damping: 0.001}\n"                                       \
    "  pins:\n"                                                                        \
    "    - {at: {rows: 0, cols: all}}\n"                                               \
    "    - {at: {rows: 11, cols: all}, velocity: [0.04, 0, 0.6]}\n"                    \
    "forces: {gravity: [0, 0, -9.81], damping: 0.01}\n"                                \
    "contact: {thickness: 0.02, self: true, slip: 0.05}\n"

/* Pins on paths of both splines, of which one begins and ends within the run, and wind
 * that changes. */
#define TABLES                                                                         \
    "cloth:\n"                                                                         \
    "  grid: {rows: 4, cols: 4, spacing: 0.1, down: [0, -1, 0.2]}\n"                   \
    "  density: 0.2\n"                                                                 \
    "  springs:\n"                                                                     \
    "    stretch: {stiffness: 100, damping: 0.03}\n"                                   \
    "    shear: {stiffness: 50, damping: 0.01}\n"                                      \
    "  pins:\n"                                                                        \
    "    - {at: top-left, path: [[-0.02, 0, 0, 0], [0.0412, 0.01, 0, 0.02], [0.09, "   \
    "0.02, 0, -0.01], [0.2, 0, 0, 0.01]]}\n"                                           \
    "    - {at: top-right, path: {rows: [[0.03, 0, 0, 0], [0.0613, 0.01, 0, 0.01], "   \
    "[0.1017, 0.03, 0, 0.02]], spline: natural}}\n"                                    \
    "forces:\n"                                                                        \
    "  gravity: [0, -9.81, 0]\n"                                                       \
    "  wind: {table: {rows: [[-0.05, 0, 0, 1], [0.052, 1, 0, 4], [0.2, 0, 1, 2]], "    \
    "spline: natural}, drag: 0.3}\n"

#define RK4 "stepper: {plugin: gsl, method: rk4, fixed_step: 5e-4}\n"

static const weft_plugin *find_linked(void *ctx, const char *id, weft_error *err)
{
    (void)ctx;
    (void)err;
    size_t i = 0;
    while (test_plugin(i) != NULL && strcmp(test_plugin(i)->id, id) != 0) {
        ++i;
    }
    return test_plugin(i);
}

/* A run of a scene, at its end. */
typedef struct end {
    weft_scene *scene;
    weft_scene_perturbed *perturbed;
    weft_cloth *cloth;
    weft_sim *sim;
} end;

static end begin(const char *text, const char *const *sets, size_t count)
{
    end of = { .perturbed = NULL };
    weft_error err = { 0 };
    weft_scene_def def = scene_of_text(text);
    def.find_plugin = find_linked;
    def.sets = sets;
    def.set_count = count;
    of.scene = good_scene(&def);
    of.cloth = test_cloth(weft_scene_cloth(of.scene));
    ck_assert_msg(weft_scene_perturbed_create(of.scene, &def, &of.perturbed, &err)
                      == WEFT_OK,
                  "%s", err.message);
    weft_sim_def sim = weft_sim_def_default();
    sim.cloth = of.cloth;
    sim.method = weft_scene_method_type(of.scene);
    sim.config = *weft_scene_config(of.scene);
    sim.sensitivity = weft_scene_perturbed_def(of.perturbed);
    ck_assert_msg(weft_sim_create(&sim, &of.sim, &err) == WEFT_OK, "%s", err.message);
    return of;
}

static void advance(const end *of, double t)
{
    weft_error err = { 0 };
    ck_assert_msg(weft_sim_advance(of->sim, t, &err) == WEFT_OK, "%s", err.message);
}

static end run(const char *text, const char *const *sets, size_t count)
{
    const end of = begin(text, sets, count);
    advance(&of, weft_scene_run(of.scene)->duration);
    return of;
}

static void finish(end *of)
{
    weft_sim_destroy(of->sim);
    weft_scene_perturbed_destroy(of->perturbed);
    weft_cloth_destroy(of->cloth);
    weft_scene_destroy(of->scene);
}

/* The state at the end of a run with a number p (1 + d). */
static double *run_with(const char *text, const char *key, double value)
{
    char set[160];
    const char *const sets[] = { set, "sensitivity=null" };
    (void)snprintf(set, sizeof set, "%s=%.17g", key, value);
    end of = run(text, sets, 2);
    const size_t dim = weft_cloth_dim(of.cloth);
    double *y = malloc(dim * sizeof *y);
    ck_assert_ptr_nonnull(y);
    memcpy(y, weft_sim_state(of.sim), dim * sizeof *y);
    finish(&of);
    return y;
}

/* Compares positions and velocities with differences of the sixth order. */
static void check_number(const end *of, const char *text, size_t j, double d,
                         double bound)
{
    const weft_scene_sensitivity *numbers = weft_scene_sensitivities(of->scene);
    const double p = numbers->values[j];
    const double weights[] = { -1.0, 9.0, -45.0, 45.0, -9.0, 1.0 };
    const double at[] = { -3.0, -2.0, -1.0, 1.0, 2.0, 3.0 };
    const size_t dim = weft_cloth_dim(of->cloth);
    double *sum = calloc(dim, sizeof *sum);
    for (size_t i = 0; i < 6; ++i) {
        double *y = run_with(text, numbers->keys[j], p * (1.0 + at[i] * d));
        for (size_t k = 0; k < dim; ++k) {
            sum[k] += weights[i] * y[k] / (60.0 * d);
        }
        free(y);
    }
    for (size_t half = 0; half < dim; half += dim / 2) {
        const double *s = weft_sim_sensitivity(of->sim, j);
        double most = 0.0, error = 0.0;
        for (size_t k = half; k < half + dim / 2; ++k) {
            most = fmax(most, fabs(sum[k]));
            error = fmax(error, fabs(s[k] - sum[k]));
        }
        ck_assert_msg(most > 1e-9 && error <= bound * most,
                      "%s: %g, of which %g is wrong", numbers->keys[j], most, error);
    }
    free(sum);
}

/* By differences of p (1 +- d). */
static void check_numbers(const char *text, double d, double bound)
{
    end of = run(text, NULL, 0);
    for (size_t j = 0; j < weft_scene_sensitivities(of.scene)->count; ++j) {
        check_number(&of, text, j, d, bound);
    }
    finish(&of);
}

static const char fold_numbers[]
    = FOLD "stepper: {plugin: gsl, method: rk4, fixed_step: 2.5e-4}\n"
           "run: {duration: 0.25}\n"
           "sensitivity:\n"
           "  of: [contact.thickness, cloth.springs.bend.stiffness, cloth.density, "
           "cloth.pins.1.velocity.2]\n";

/* Values of rows, and times. */
#define TABLE_NUMBERS                                                                  \
    "run: {duration: 0.14}\n"                                                          \
    "sensitivity:\n"                                                                   \
    "  of: [cloth.pins.0.path.1.3, cloth.pins.0.path.2.1, cloth.pins.0.path.1.0, "     \
    "cloth.pins.1.path.rows.1.3, cloth.pins.1.path.rows.2.1, "                         \
    "cloth.pins.1.path.rows.1.0, forces.wind.table.rows.1.3, "                         \
    "forces.wind.table.rows.1.0, cloth.springs.stretch.stiffness]\n"
static const char table_numbers[] = TABLES RK4 TABLE_NUMBERS;
/* A time of a row moves the ends of steps too, which a method of order 1 feels. */
static const char table_values_euler[] = TABLES
    "stepper: {plugin: verlet, method: symplectic_euler, fixed_step: 1e-3}\n"
    "run: {duration: 0.14}\n"
    "sensitivity:\n"
    "  of: [cloth.pins.0.path.1.3, cloth.pins.0.path.2.1, cloth.pins.1.path.rows.1.3, "
    "forces.wind.table.rows.1.3]\n";

START_TEST(numbers_of_tables_are_those_of_differences)
{
    check_numbers(_i == 0 ? table_numbers : table_values_euler, 5e-5, 1e-7);
}
END_TEST

/* The same map under a method of positions and velocities. */
START_TEST(verlet_has_the_derivative_of_its_own_map)
{
    check_numbers("cloth:\n"
                  "  grid: {rows: 3, cols: 3, spacing: 0.1}\n"
                  "  mass: 0.01\n"
                  "  springs: {stretch: {stiffness: 100}, shear: {stiffness: 50}}\n"
                  "  pins: [top-left]\n"
                  "forces: {gravity: [0, -9.81, 0]}\n"
                  "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: "
                  "1e-3}\n"
                  "run: {duration: 0.3}\n"
                  "sensitivity: {of: [cloth.springs.stretch.stiffness, cloth.mass, "
                  "forces.gravity.1]}\n",
                  5e-5, 1e-7);
}
END_TEST

/* The sheet at the end under a method with steps of h, and how far s is from the
 * difference of runs. */
static double error_of(const char *method, double h)
{
    char stepper[128];
    (void)snprintf(stepper, sizeof stepper, "stepper={%s, fixed_step: %.17g}", method,
                   h);
    const char *const with[] = { stepper };
    const char *text = SHEET RK4 "run: {duration: 0.1}\n"
                                 "sensitivity:\n"
                                 "  of: [cloth.springs.stretch.stiffness]\n";
    double error = 0.0, *y[2];
    for (size_t i = 0; i < 2; ++i) {
        char value[64];
        const char *const sets[] = { stepper, "sensitivity=null", value };
        (void)snprintf(value, sizeof value, "cloth.springs.stretch.stiffness=%.17g",
                       100.0 * (1.0 + (i == 0 ? -1e-4 : 1e-4)));
        end of = run(text, sets, 3);
        const size_t size = weft_cloth_dim(of.cloth) * sizeof(double);
        y[i] = malloc(size);
        memcpy(y[i], weft_sim_state(of.sim), size);
        finish(&of);
    }
    end of = run(text, with, 1);
    const double *s = weft_sim_sensitivity(of.sim, 0);
    for (size_t k = 0; k < weft_cloth_dim(of.cloth) / 2; ++k) {
        error = fmax(error, fabs(s[k] - (y[1][k] - y[0][k]) / 2e-4));
    }
    finish(&of);
    free(y[0]);
    free(y[1]);
    return error;
}

#define ROS2 "plugin: stiff, method: ros2"

/* Its stages see the matrix alone of what s' has of the state: the order stays. */
START_TEST(implicit_and_stabilised_methods_have_their_order)
{
    ck_assert_double_le(error_of("plugin: arkode, method: dirk324", 2e-3), 1e-8);
    ck_assert_double_le(error_of("plugin: arkode, method: trbdf2", 2e-3), 1e-8);
    ck_assert_double_le(error_of("plugin: stiff, method: rkc2", 4e-4), 1e-8);
    const double of_order_2 = error_of(ROS2, 2e-3) / error_of(ROS2, 1e-3);
    ck_assert_double_eq_tol(of_order_2, 4.0, 0.4);
}
END_TEST

/* Two particles 1 m apart, of 1 kg each: y = -1 - g / w^2 (1 - cos w t), w^2 = k. */
#define PENDULUM                                                                       \
    "cloth:\n"                                                                         \
    "  grid: {rows: 2, cols: 1, spacing: 1}\n"                                         \
    "  mass: 1\n"                                                                      \
    "  springs: {stretch: {stiffness: 40}}\n"                                          \
    "  pins: [{at: {row: 0, col: 0}}]\n"                                               \
    "stepper: {plugin: gsl, method: rk8pd, rtol: 1e-10, atol: 1e-10}\n"                \
    "run: {duration: 0.7}\n"                                                           \
    "sensitivity: {of: [cloth.springs.stretch.stiffness, forces.gravity.1, "           \
    "cloth.mass]}\n"

START_TEST(a_hanging_mass_is_exact)
{
    const double g = 9.81, k = 40.0, w = sqrt(k), t = 0.7;
    const double by_k = g / k * (1.0 - cos(w * t)) - 0.5 * g / k * w * t * sin(w * t);
    end of = run(PENDULUM, NULL, 0);
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 0)[3], by_k, 1e-8);
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 1)[3],
                            -g / k * (1.0 - cos(w * t)), 1e-8);
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 2)[3], -by_k, 1e-8);
    ck_assert_double_eq(weft_sim_sensitivity(of.sim, 0)[2], 0.0); /* of the pin */
    ck_assert_ptr_null(weft_sim_sensitivity(of.sim, 3));
    finish(&of);
}
END_TEST

START_TEST(a_falling_cloth_is_exact)
{
    end of = run("cloth:\n  grid: {rows: 1, cols: 2, spacing: 1}\n  density: 1\n"
                 "forces: {gravity: [0, -9.81, 0]}\n" RK4 "run: {duration: 0.5}\n"
                 "sensitivity:\n"
                 "  of: [forces.gravity.1, forces.gravity.0, cloth.density, "
                 "cloth.grid.origin.0]\n"
                 "  scale: none\n",
                 NULL, 0);
    const double *by_g = weft_sim_sensitivity(of.sim, 0);
    ck_assert_double_eq_tol(by_g[2], -9.81 * 0.125, 1e-8);   /* times p */
    ck_assert_double_eq_tol(by_g[6 + 2], -9.81 * 0.5, 1e-8); /* [m/s] */
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 1)[0], 0.125, 1e-8);
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 2)[2], 0.0, 1e-8);
    ck_assert_double_eq_tol(weft_sim_sensitivity(of.sim, 3)[0], 1.0, 1e-8);
    finish(&of);
}
END_TEST

/* The bits of the state and of s. */
static uint64_t bits(const end *of)
{
    const size_t dim = weft_cloth_dim(of->cloth);
    uint64_t hash = test_hash(weft_sim_state(of->sim), dim);
    for (size_t j = 0; weft_sim_sensitivity(of->sim, j) != NULL; ++j) {
        hash = hash * 31 + test_hash(weft_sim_sensitivity(of->sim, j), dim);
    }
    return hash;
}

#define ADAPTIVE                                                                       \
    "stepper: {plugin: gsl, method: rkf45, rtol: 1e-5, atol: 1e-5}\n"                  \
    "run: {duration: 0.2}\n"                                                           \
    "sensitivity: {of: [cloth.springs.stretch.stiffness, contact.friction]}\n"

START_TEST(without_control_the_steps_are_those_without)
{
    const char *const without[] = { "sensitivity=null" };
    const char *const uncontrolled[] = { "sensitivity.control=false" };
    end none = run(SHEET ADAPTIVE, without, 1),
        out = run(SHEET ADAPTIVE, uncontrolled, 1);
    end in = run(SHEET ADAPTIVE, NULL, 0);
    const size_t dim = weft_cloth_dim(in.cloth);
    ck_assert_mem_eq(weft_sim_state(none.sim), weft_sim_state(out.sim),
                     dim * sizeof(double));
    ck_assert_uint_eq(weft_sim_stats(none.sim).steps, weft_sim_stats(out.sim).steps);
    ck_assert_uint_eq(weft_sim_stats(none.sim).rhs_calls,
                      weft_sim_stats(out.sim).rhs_calls);
    ck_assert_uint_gt(weft_sim_stats(in.sim).steps, weft_sim_stats(out.sim).steps);
    for (size_t i = 0; i < dim / 2; ++i) {
        ck_assert_double_eq_tol(weft_sim_sensitivity(in.sim, 0)[i],
                                weft_sim_sensitivity(out.sim, 0)[i], 1e-2);
    }
    finish(&none);
    finish(&out);
    finish(&in);
}
END_TEST

/* Far too long steps: some are taken, then one fails. */
START_TEST(an_advance_leaves_the_state_of_its_last_step)
{
    static const char scene[]
        = "cloth: {grid: {rows: 3, cols: 3, spacing: 0.1}, density: 0.2, springs: "
          "{stretch: {stiffness: 1000}}, pins: [top-left]}\n"
          "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 0.1}\n"
          "run: {duration: 1000}\nsensitivity: {of: [cloth.density]}\n";
    end a = begin(scene, NULL, 0), b = begin(scene, NULL, 0);
    const size_t size = weft_cloth_dim(a.cloth) * sizeof(double);
    for (double t = 1.0; t < 1e4; t *= 1000.0) {
        const weft_status status = weft_sim_advance(a.sim, t, NULL);
        ck_assert_int_eq(status, t < 2.0 ? WEFT_OK : WEFT_NOT_FINITE);
        while (weft_sim_time(b.sim) < t && weft_sim_step(b.sim, t, NULL) == WEFT_OK) {
        }
        ck_assert_uint_ge(weft_sim_stats(a.sim).steps, 10);
        ck_assert(weft_sim_time(a.sim) == weft_sim_time(b.sim));
        ck_assert_mem_eq(weft_sim_state(a.sim), weft_sim_state(b.sim), size);
    }
    finish(&a);
    finish(&b);
}
END_TEST

START_TEST(threads_do_not_change_a_bit)
{
    const char *const sets[]
        = { "cloth.grid.rows=72", "cloth.grid.cols=70",      "cloth.grid.spacing=0.01",
            "run.duration=0.003", "contact.thickness=0.005", "run.threads=1" };
    const char *two[sizeof sets / sizeof sets[0]];
    memcpy(two, sets, sizeof sets);
    two[5] = "run.threads=2";
    end a = run(SHEET ADAPTIVE, sets, 6), b = run(SHEET ADAPTIVE, two, 6);
    ck_assert_uint_eq(bits(&a), bits(&b));
    finish(&a);
    finish(&b);
}
END_TEST

/* Of shapes; and of the cloth with itself, whose list of pairs the second has not. */
START_TEST(a_restored_run_goes_on_to_the_same_bits)
{
    weft_error err = { 0 };
    const char *text = _i == 0 ? SHEET ADAPTIVE : fold_numbers;
    end a = begin(text, NULL, 0), b = begin(text, NULL, 0);
    const char *const other[] = { "sensitivity.of.1=contact.damping" };
    end c = begin(text, other, 1);
    const double at = _i == 0 ? 0.1 : 0.21;
    const size_t size = weft_sim_save_size(a.sim);
    unsigned char *bytes = malloc(size);
    advance(&a, at);
    ck_assert_int_eq(weft_sim_save(a.sim, bytes, size, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_restore(b.sim, bytes, size, &err), WEFT_OK);
    ck_assert_uint_eq(bits(&a), bits(&b));
    ck_assert_int_eq(weft_sim_restore(c.sim, bytes, size, &err), WEFT_INVALID);
    advance(&a, at + 0.02);
    advance(&b, at + 0.02);
    ck_assert_uint_eq(bits(&a), bits(&b));
    bytes[size - 1] ^= 1; /* of s */
    ck_assert_int_eq(weft_sim_restore(b.sim, bytes, size, &err), WEFT_INVALID);
    free(bytes);
    finish(&a);
    finish(&b);
    finish(&c);
}
END_TEST

/* A cloth that is dropped on a sphere: the error control must see s. */
#define DROP                                                                           \
    "cloth:\n"                                                                         \
    "  grid: {rows: 7, cols: 7, spacing: 0.08, down: [0, 0, -1], right: [1, 0, 0], "   \
    "origin: [-0.24, 0, 0.24]}\n"                                                      \
    "  density: 0.2\n"                                                                 \
    "  springs:\n"                                                                     \
    "    stretch: {stiffness: 100, damping: 0.02}\n"                                   \
    "    shear: {stiffness: 50, damping: 0.01}\n"                                      \
    "    bend: {stiffness: 5, damping: 0.001}\n"                                       \
    "forces: {damping: 8e-4}\n"                                                        \
    "contact: {thickness: 0.02, shapes: [{shape: sphere, at: [0.01, -0.25, 0.02], "    \
    "radius: 0.15}]}\n"                                                                \
    "stepper: {plugin: gsl, method: rk8pd, rtol: 1e-4, atol: 1e-4}\n"                  \
    "run: {duration: 0.3}\n"                                                           \
    "sensitivity: {of: [cloth.springs.stretch.stiffness, contact.shapes.0.radius]}\n"

START_TEST(a_landing_is_right_at_loose_tolerances)
{
    const char *const tight[] = { "stepper.rtol=1e-9", "stepper.atol=1e-9" };
    end loose = run(DROP, NULL, 0), exact = run(DROP, tight, 2);
    ck_assert_uint_gt(weft_sim_measure(exact.sim).touching, 0);
    for (size_t j = 0; j < 2; ++j) {
        const double *s = weft_sim_sensitivity(loose.sim, j);
        const double *right = weft_sim_sensitivity(exact.sim, j);
        for (size_t i = 0; i < weft_cloth_dim(exact.cloth) / 2; ++i) {
            ck_assert_double_eq_tol(s[i], right[i], 5e-3 * (1.0 + fabs(right[i])));
        }
    }
    finish(&loose);
    finish(&exact);
}
END_TEST

START_TEST(scale_is_that_of_the_results_alone)
{
    const char *const none[] = { "sensitivity.scale=none" };
    end a = run(SHEET ADAPTIVE, NULL, 0), b = run(SHEET ADAPTIVE, none, 1);
    ck_assert_uint_eq(bits(&a), bits(&b));
    ck_assert(weft_scene_sensitivities(a.scene)->relative);
    ck_assert(!weft_scene_sensitivities(b.scene)->relative);
    finish(&a);
    finish(&b);
}
END_TEST

/* ---- gradients --------------------------------------------------------------------
 */

enum { FRAMES = 3 };

/* The simulation of a scene, forwards with sensitivities: by cloths that are further
 * apart than those of a scene, so that their differences have less roundoff, and both
 * modes the same derivative of f. */
typedef struct wide {
    weft_parameter numbers[WEFT_SENSITIVITIES];
    end ends[2 * WEFT_SENSITIVITIES];
    weft_sensitivity_def def;
} wide;

static weft_sim_def definition(const end *of, const char *text, const char *stepper,
                               wide *to)
{
    const weft_scene_sensitivity *numbers = weft_scene_sensitivities(of->scene);
    weft_sim_def def = weft_sim_def_default();
    char set[160];
    const char *const sets[] = { set, "sensitivity=null", stepper };
    for (size_t i = 0; text != NULL && i < 2 * numbers->count; ++i) {
        (void)snprintf(set, sizeof set, "%s=%.17g", numbers->keys[i / 2],
                       numbers->values[i / 2] * (i % 2 == 0 ? 1.0 - 1e-3 : 1.0 + 1e-3));
        to->ends[i] = begin(text, sets, 3);
        to->numbers[i / 2]
            = (weft_parameter){ numbers->keys[i / 2], to->ends[i - i % 2].cloth,
                                to->ends[i].cloth, 2e-3 };
    }
    to->def = (weft_sensitivity_def){ numbers->count, to->numbers, false };
    def.cloth = of->cloth;
    def.method = weft_scene_method_type(of->scene);
    def.config = *weft_scene_config(of->scene);
    def.sensitivity = &to->def;
    return def;
}

/* Against forward mode of the same map; returns how many steps contact took back. */
static uint64_t check_gradient(const char *text, const char *stepper)
{
    end of = begin(text, &stepper, 1);
    size_t dim = weft_cloth_dim(of.cloth);
    const double end_time = weft_scene_run(of.scene)->duration;
    const double times[FRAMES] = { 0.0, 0.4 * end_time, end_time };
    double value = 0.0, whole, sums[WEFT_SENSITIVITIES] = { 0.0 }, most = 0.0;
    double by_parameter[WEFT_SENSITIVITIES], *slope = calloc(2 * dim, sizeof *slope);
    weft_error err = { 0 };
    weft_sim *sim;
    static wide perturbed;
    const weft_sensitivity_def *numbers = &perturbed.def;
    const weft_sim_def run = definition(&of, text, stepper, &perturbed);
    weft_gradient_def def = weft_gradient_def_default();
    def.sim = &run, def.count = numbers->count, def.parameters = numbers->parameters;
    def.frames = FRAMES, def.times = times;
    def.objective = objective, def.ctx = &dim;
    ck_assert_msg(weft_gradient(&def, &whole, by_parameter, slope + dim, &err)
                      == WEFT_OK,
                  "%s", err.message);
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
    for (size_t frame = 0; frame < FRAMES; ++frame) {
        if (frame > 0) {
            ck_assert_int_eq(weft_sim_advance(sim, times[frame], &err), WEFT_OK);
        }
        memset(slope, 0, dim * sizeof *slope);
        (void)objective(&dim, frame, times[frame], weft_sim_state(sim), &value, slope);
        for (size_t j = 0; j < numbers->count; ++j) {
            for (size_t i = 0; i < dim; ++i) {
                sums[j] += slope[i] * weft_sim_sensitivity(sim, j)[i];
            }
        }
    }
    ck_assert_double_eq_tol(whole, value, 1e-11 * fabs(value));
    for (size_t j = 0; j < numbers->count; ++j) {
        most = fmax(most, fabs(sums[j]));
        ck_assert_msg(fabs(by_parameter[j] - sums[j])
                          <= 1e-10 * fabs(sums[j]) + 1e-12 * most,
                      "%s: %.17g, not %.17g", numbers->parameters[j].name,
                      by_parameter[j], sums[j]);
    }
    ck_assert_double_gt(most, 0.0);
    for (size_t i = 0; i < 2 * numbers->count; ++i) {
        finish(&perturbed.ends[i]);
    }
    const uint64_t taken_back = weft_sim_vetoed(sim);
    weft_sim_destroy(sim);
    free(slope);
    finish(&of);
    return taken_back;
}

#define ALL_NUMBERS                                                                    \
    "run: {duration: 0.15}\n"                                                          \
    "sensitivity:\n"                                                                   \
    "  of: [cloth.springs.stretch.stiffness, cloth.springs.bend.damping, "             \
    "cloth.density, cloth.grid.spacing.0, forces.gravity.2, forces.damping, "          \
    "forces.wind.velocity.1, forces.wind.drag, contact.friction, "                     \
    "contact.thickness, contact.shapes.0.radius, contact.shapes.0.velocity.0, "        \
    "cloth.pins.0.velocity.1, cloth.pins.1.amplitude.2, cloth.pins.1.frequency]\n"

/* In fixed steps, and in the recorded ones of adaptive methods. */
START_TEST(gradient_is_that_of_forward_mode)
{
    static const char *const steppers[] = {
        "stepper={plugin: verlet, method: velocity_verlet, fixed_step: 5e-4}",
        "stepper={plugin: verlet, method: symplectic_euler, fixed_step: 5e-4}",
        "stepper={plugin: verlet, method: midpoint, fixed_step: 1e-3}",
        "stepper={plugin: gsl, method: rk4, fixed_step: 1e-3}",
        "stepper={plugin: gsl, method: rkf45, rtol: 1e-5, atol: 1e-5}",
        "stepper={plugin: gsl, method: rk8pd, rtol: 1e-5, atol: 1e-5}",
        "stepper={plugin: arkode, method: dormand_prince, rtol: 1e-5, atol: 1e-5}",
        "stepper={plugin: gsl, method: gear2, rtol: 1e-5, atol: 1e-5}",
    };
    (void)check_gradient(SHEET ALL_NUMBERS, steppers[_i]);
}
END_TEST

/* Velocity Verlet takes the rates of a step over to the next one, but not at a row. */
START_TEST(gradient_of_tables_is_that_of_forward_mode)
{
    static const char *const steppers[] = {
        "stepper={plugin: verlet, method: velocity_verlet, fixed_step: 5e-4}",
        "stepper={plugin: gsl, method: rk4, fixed_step: 1e-3}",
        "stepper={plugin: arkode, method: dormand_prince, rtol: 1e-5, atol: 1e-5}",
        "stepper={plugin: verlet, method: symplectic_euler, fixed_step: 1e-3}",
    };
    (void)check_gradient(TABLES TABLE_NUMBERS, steppers[_i]);
}
END_TEST

/* Half the height squared of a particle; stops at frame *ctx. */
static int height(void *ctx, size_t frame, double t, const double *y, double *value,
                  double *slope)
{
    (void)t;
    *value += 0.5 * y[2] * y[2];
    slope[2] += y[2];
    return frame == *(const size_t *)ctx;
}

/* y = g t^2 / 2, twice at 0.5 s: the sum is y^2, and its derivative by log g 2 y^2. */
START_TEST(gradient_of_a_fall_is_exact)
{
    end of = begin("cloth:\n  grid: {rows: 1, cols: 2, spacing: 1}\n  density: 1\n"
                   "forces: {gravity: [0, -10, 0]}\n" RK4 "run: {duration: 0.5}\n"
                   "sensitivity: {of: [forces.gravity.1]}\n",
                   NULL, 0);
    const double times[] = { 0.0, 0.5, 0.5 }, falling[] = { 0.5, 0.4 };
    size_t stops_at = 3;
    double value, by_parameter, by_start[12];
    weft_error err = { 0 };
    wide perturbed = { .def = { 0, NULL, false } };
    weft_sim_def run = definition(&of, NULL, "", &perturbed);
    weft_gradient_def def = weft_gradient_def_default();
    def.sim = &run, def.count = 1,
    def.parameters = weft_scene_perturbed_def(of.perturbed)->parameters;
    def.frames = 3, def.times = times, def.objective = height, def.ctx = &stops_at;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, by_start, &err),
                     WEFT_OK);
    ck_assert_double_eq_tol(value, 1.5625, 1e-12);
    ck_assert_double_eq_tol(by_parameter, 3.125, 1e-9);
    ck_assert_double_eq_tol(by_start[2], -2.5, 1e-12);
    ck_assert_double_eq_tol(by_start[8], -1.25, 1e-12); /* by vy */
    ck_assert(by_start[0] == 0.0);
    stops_at = 1;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, NULL, &err),
                     WEFT_STOPPED);
    ck_assert_ptr_nonnull(strstr(err.message, "frame 1, t = 0.5 s"));
    weft_parameter nameless = def.parameters[0]; /* and without cloths */
    nameless.name = NULL;
    nameless.less = NULL;
    def.parameters = &nameless;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, NULL, &err),
                     WEFT_INVALID);
    ck_assert_ptr_nonnull(
        strstr(err.message, "gradient, parameter 0, unnamed: two cloths"));
    def.parameters = weft_scene_perturbed_def(of.perturbed)->parameters;
    def.times = falling, def.frames = 2;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, NULL, &err),
                     WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "times[1] = 0.4 s"));
    def.times = times;
    ck_assert_int_eq(weft_gradient(&def, &value, NULL, NULL, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(strstr(err.message, "by_parameter"));
    def.objective = NULL;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, NULL, &err),
                     WEFT_INVALID);
    def.objective = height, def.frames = 0;
    ck_assert_int_eq(weft_gradient(&def, &value, &by_parameter, NULL, &err), WEFT_OK);
    ck_assert(value == 0.0 && by_parameter == 0.0);
    finish(&of);
}
END_TEST

/* Of steps that contact has taken back, whose method begins anew. */
START_TEST(gradient_goes_through_steps_that_were_taken_back)
{
    const uint64_t taken_back = check_gradient(
        "cloth:\n"
        "  grid: {rows: 3, cols: 3, spacing: 0.1, down: [0, 1, 0]}\n"
        "  density: 0.2\n"
        "  springs: {stretch: {stiffness: 20, damping: 0.01}, shear: "
        "{stiffness: 10}}\n"
        "  velocity: [0.1, 0.2, -3]\n"
        "contact:\n"
        "  thickness: 2e-3\n"
        "  stopping_speed: 6\n"
        "  shapes: [{shape: sphere, at: [0.1, 0.1, -0.3], radius: 0.2}]\n"
        "run: {duration: 0.1}\n"
        "sensitivity: {of: [cloth.springs.stretch.stiffness, "
        "cloth.velocity.2]}\n",
        "stepper={plugin: verlet, method: velocity_verlet, fixed_step: 1e-3}");
    ck_assert_uint_gt(taken_back, 0);
}
END_TEST

/* ---- files -------------------------------------------------------------------------
 */

static void run_scene(const char *name, const char *text)
{
    char file[256];
    (void)snprintf(file, sizeof file, BUILD_DIR "/tests/%s.yaml", name);
    write_file(file, text);
    expect(
        shell(WEFT " run %s --force --out " BUILD_DIR "/tests/%s.run 2>&1", file, name),
        0);
}

/* Free fall: 1 % of gravity moves it by 0.01 g t^2 / 2. */
START_TEST(a_run_leaves_its_derivatives)
{
    static const char scene[]
        = "cloth: {grid: {rows: 2, cols: 2, spacing: 0.02}, density: 1}\n"
          "forces: {gravity: [0, -10, 0]}\n"
          "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1e-2}\n"
          "run: {duration: 2, fps: 2}\n"
          "sensitivity: {of: [forces.gravity.1, cloth.density], scale: log}\n";
    run_scene("fall", scene);
    ck_assert_ptr_nonnull(
        strstr(output, "1 % of forces.gravity.1 moves a particle by"));
    ck_assert_ptr_nonnull(strstr(output, "warning: that is more than the cloth's"));
    expect(shell("cd " BUILD_DIR
                 "/tests/fall.run && head -2 sensitivity.csv && wc -l < "
                 "sensitivity.csv && head -1 series.csv && tail -1 series.csv && grep "
                 "warnings: result.yaml && grep -ao s_forces.gravity.1 run.vtkhdf"),
           0);
    ck_assert_ptr_nonnull(strstr(output, "key,row,col,x,y,z,vx,vy,vz\n"
                                         "forces.gravity.1,0,0,0,-20.0000000"));
    ck_assert_ptr_nonnull(strstr(output, "\n9\n"));
    ck_assert_ptr_nonnull(strstr(
        output, ",sensitivity_forces.gravity.1,sensitivity_cloth.density\n4,2,"));
    ck_assert_ptr_nonnull(strstr(output, "warnings: 1"));
    ck_assert_ptr_nonnull(strstr(output, "\ns_forces.gravity.1"));
}
END_TEST

/* A step is longer than what the cloth may move before it is past the sphere. */
START_TEST(many_steps_taken_back_are_warned_of)
{
    static const char scene[]
        = "cloth: {grid: {rows: 3, cols: 3, spacing: 0.1, down: [0, 1, 0]}, density: "
          "0.2, velocity: [0, 0, -3], springs: {stretch: {stiffness: 20}}}\n"
          "contact: {thickness: 2.0e-3, shapes: [{shape: sphere, at: [0.1, 0.1, -0.3], "
          "radius: 0.2}]}\n"
          "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 4.0e-3}\n"
          "run: {duration: 0.1}\n"
          "sensitivity: {of: [cloth.density]}\n";
    run_scene("hit", scene);
    says("warning: contact rolled back more than half of the steps");
}
END_TEST

/* ---- refusals ----------------------------------------------------------------------
 */

static bool keep(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h, (void)y;
    return false;
}

static int push(void *ctx, double t, const double *y, double *f)
{
    (void)ctx, (void)t, (void)y, (void)f;
    return 0;
}

static double never(void *ctx, const weft_cloth *cloth, double t, const double *y)
{
    (void)ctx, (void)cloth, (void)t, (void)y;
    return 1.0;
}

static void refuse(const weft_sim_def *def, const char *why)
{
    const double t = 0.1;
    double value, by[WEFT_SENSITIVITIES];
    weft_error err = { 0 };
    weft_sim *sim = NULL;
    weft_gradient_def gradient = weft_gradient_def_default();
    gradient.sim = def, gradient.frames = 1, gradient.times = &t;
    gradient.objective = height, gradient.ctx = &value;
    if (def->sensitivity->control) {
        ck_assert_int_eq(weft_gradient(&gradient, &value, by, NULL, &err),
                         WEFT_UNSUPPORTED);
        ck_assert_msg(strstr(err.message, why) != NULL, "%s", err.message);
    }
    ck_assert_int_eq(weft_sim_create(def, &sim, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_null(sim);
    ck_assert_msg(strstr(err.message, why) != NULL, "%s", err.message);
}

START_TEST(what_has_no_derivative_is_refused)
{
    end of = begin(SHEET ADAPTIVE, NULL, 0);
    weft_sim_def def = weft_sim_def_default(), start;
    def.cloth = of.cloth;
    def.method = weft_scene_method_type(of.scene);
    def.config = *weft_scene_config(of.scene);
    def.sensitivity = weft_scene_perturbed_def(of.perturbed);
    start = def;
    def.correct = keep, refuse(&def, "`correct`"), def = start;
    def.force = push, refuse(&def, "`force`"), def = start;
    def.event = never, refuse(&def, "event"), def = start;
    def.ledger = true, refuse(&def, "energy balance"), def = start;
    def.interpolate = true, refuse(&def, "interpolate"), def = start;
    def.limit.method = WEFT_LIMIT_PROVOT, refuse(&def, "strain limit"), def = start;
    def.method = test_method_named("gsl/msadams"), refuse(&def, "history"), def = start;
    weft_sensitivity_def uncontrolled = *def.sensitivity;
    uncontrolled.control = false;
    def.sensitivity = &uncontrolled, def.config.norm = WEFT_NORM_RMS;
    refuse(&def, "rms");
    finish(&of);
}
END_TEST

/* Forces jump with the velocity of the pin, when a spline begins. */
START_TEST(times_at_which_a_natural_spline_begins_or_ends_are_refused)
{
    static const char *const times[]
        = { "cloth.pins.1.path.rows.0.0=0.031", "cloth.pins.1.path.rows.2.0=0.11",
            "cloth.pins.1.path.rows.1.0=0.061" };
    for (size_t i = 0; i < 3; ++i) {
        end one = begin(table_numbers, NULL, 0),
            other = begin(table_numbers, &times[i], 1);
        weft_error err = { 0 };
        weft_sim *sim = NULL;
        const weft_parameter number = { "a time", one.cloth, other.cloth, 1e-3 };
        const weft_sensitivity_def numbers = { 1, &number, true };
        weft_sim_def def = weft_sim_def_default();
        def.cloth = one.cloth;
        def.method = weft_scene_method_type(one.scene);
        def.config = *weft_scene_config(one.scene);
        def.sensitivity = &numbers;
        const weft_status status = weft_sim_create(&def, &sim, &err);
        ck_assert_int_eq(status, i < 2 ? WEFT_UNSUPPORTED : WEFT_OK);
        ck_assert(i == 2 || strstr(err.message, "begins or ends") != NULL);
        weft_sim_destroy(sim);
        finish(&one);
        finish(&other);
    }
}
END_TEST

START_TEST(wrong_numbers_are_refused)
{
    end of = begin(SHEET ADAPTIVE, NULL, 0);
    weft_error err = { 0 };
    weft_sim *sim = NULL;
    weft_parameter numbers[WEFT_SENSITIVITIES + 1] = { { "a", NULL, NULL, 1.0 } };
    weft_sensitivity_def none = { 1, numbers, true };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = of.cloth;
    def.method = weft_scene_method_type(of.scene);
    def.sensitivity = &none;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_INVALID);
    none.count = WEFT_SENSITIVITIES + 1;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_INVALID);
    none.count = 0;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_INVALID);
    ck_assert_int_eq(weft_sim_unpin(of.sim, 0, &err), WEFT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(err.message, "not possible with sensitivities"));
    finish(&of);
}
END_TEST

START_TEST(a_preset_has_numbers)
{
    const weft_fabric *denim = weft_fabric_find("11oz-black-denim");
    end of = begin("cloth:\n  grid: {rows: 2, cols: 2, spacing: 0.1}\n"
                   "  fabric: {preset: 11oz-black-denim, shear: 70}\n" RK4
                   "run: {duration: 1}\nsensitivity: {of: [cloth.fabric.bend.1, "
                   "cloth.fabric.density, cloth.fabric.shear]}\n",
                   NULL, 0);
    const weft_scene_sensitivity *numbers = weft_scene_sensitivities(of.scene);
    ck_assert(numbers->values[0] == denim->bend[1]);
    ck_assert(numbers->values[1] == denim->density);
    ck_assert(numbers->values[2] == 70.0);
    finish(&of);
}
END_TEST

/* Neither less nor more of them makes a cloth. */
START_TEST(numbers_that_cannot_change_alone_are_named)
{
    static const char *const keys[][2] = {
        { "cloth.grid.right.0", "not perpendicular" },
        { "contact.shapes.0.spin.0", "spins about its normal only" },
    };
    for (size_t i = 0; i < 2; ++i) {
        char set[80];
        const char *const sets[] = { set };
        weft_error err = { 0 };
        weft_scene_perturbed *perturbed = NULL;
        (void)snprintf(set, sizeof set, "sensitivity={of: [%s], scale: none}",
                       keys[i][0]);
        weft_scene_def def = scene_of_text(
            "cloth:\n"
            "  grid: {rows: 2, cols: 2, spacing: 1, right: [1, 0.1, 0], down: [0.1, "
            "-1, 0]}\n"
            "  density: 1\n"
            "contact: {shapes: [{shape: plane, at: [0, -9, 0], normal: [0, 1, 0], "
            "spin: [0, 2, 0]}]}\n" RK4 "run: {duration: 1}\n");
        def.find_plugin = find_linked, def.sets = sets, def.set_count = 1;
        weft_scene *scene = good_scene(&def);
        ck_assert_int_ne(weft_scene_perturbed_create(scene, &def, &perturbed, &err),
                         WEFT_OK);
        ck_assert_ptr_null(perturbed);
        ck_assert_ptr_nonnull(strstr(err.message, keys[i][0]));
        ck_assert_ptr_nonnull(strstr(err.message, keys[i][1]));
        weft_scene_destroy(scene);
    }
}
END_TEST

TEST_SUITE(sensitivity)
{
    Suite *suite = suite_create("sensitivity");
    TCase *tests = tcase_create("runs");
    tcase_set_timeout(tests, 300);
    tcase_add_loop_test(tests, numbers_of_tables_are_those_of_differences, 0, 2);
    tcase_add_test(tests, verlet_has_the_derivative_of_its_own_map);
    tcase_add_test(tests, a_hanging_mass_is_exact);
    tcase_add_test(tests, implicit_and_stabilised_methods_have_their_order);
    tcase_add_test(tests, a_falling_cloth_is_exact);
    tcase_add_test(tests, without_control_the_steps_are_those_without);
    tcase_add_test(tests, an_advance_leaves_the_state_of_its_last_step);
    tcase_add_test(tests, threads_do_not_change_a_bit);
    tcase_add_loop_test(tests, a_restored_run_goes_on_to_the_same_bits, 0, 2);
    tcase_add_test(tests, a_landing_is_right_at_loose_tolerances);
    tcase_add_test(tests, scale_is_that_of_the_results_alone);
    tcase_add_loop_test(tests, gradient_is_that_of_forward_mode, 0, 8);
    tcase_add_loop_test(tests, gradient_of_tables_is_that_of_forward_mode, 0, 4);
    tcase_add_test(tests, gradient_of_a_fall_is_exact);
    tcase_add_test(tests, gradient_goes_through_steps_that_were_taken_back);
    tcase_add_test(tests, a_run_leaves_its_derivatives);
    tcase_add_test(tests, many_steps_taken_back_are_warned_of);
    tcase_add_test(tests, what_has_no_derivative_is_refused);
    tcase_add_test(tests, wrong_numbers_are_refused);
    tcase_add_test(tests, times_at_which_a_natural_spline_begins_or_ends_are_refused);
    tcase_add_test(tests, a_preset_has_numbers);
    tcase_add_test(tests, numbers_that_cannot_change_alone_are_named);
    suite_add_tcase(suite, tests);
    return suite;
}
