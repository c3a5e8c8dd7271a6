/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow nightly asan-long */
/* Steps that follow from the bounds on a cloth's modes, against runs that do or do not
 * blow up. */
#include "bounds_cloths.h"
#include "meshes.h"

/* ---- runs ---------------------------------------------------------------------------
 */

/* Whether a displacement of 1e-9 m grows ten thousand fold in 1500 steps. */
static bool blows_up(const weft_cloth *cloth, const weft_stepper_type *type, double h)
{
    const size_t n = weft_cloth_particles(cloth);
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = h;
    weft_sim *sim = test_sim(cloth, type, &config);
    double *rest = malloc(6 * n * sizeof *rest), *x = malloc(3 * n * sizeof *x);
    uint64_t seed = 1;
    weft_cloth_start(cloth, rest);
    weft_sim_positions(sim, x);
    for (size_t j = 0; j < 3 * n; ++j) {
        x[j] += 1e-9 * noise(&seed);
    }
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, NULL), WEFT_OK);
    double most = 0.0;
    for (int i = 0; i < 1500 && most < 1e-5; ++i) {
        if (weft_sim_step(sim, 1e9, NULL) != WEFT_OK) {
            most = INFINITY;
        }
        const double *y = weft_sim_state(sim);
        for (size_t j = 0; j < 3 * n; ++j) {
            most = fmax(most, fabs(y[j] - rest[j]));
        }
    }
    free(rest);
    free(x);
    weft_sim_destroy(sim);
    return !(most < 1e-5);
}

static double stable_step(const weft_stiffness *modes, const weft_stepper_type *type)
{
    weft_stability stability;
    double h;
    ck_assert_int_eq(weft_stability_create(type, NULL, &stability, NULL), WEFT_OK);
    ck_assert_int_eq(weft_stability_step(&stability, modes, 0.0, &h, NULL), WEFT_OK);
    return h;
}

/* The step between safe and 2 safe from which on runs blow up. */
static double true_limit(const weft_cloth *cloth, const weft_stepper_type *type,
                         double safe)
{
    double low = safe, high = 2.0 * safe;
    for (int i = 0; i < 8; ++i) {
        const double middle = 0.5 * (low + high);
        *(blows_up(cloth, type, middle) ? &high : &low) = middle;
    }
    return high;
}

/* Destroys the cloth. */
static void bound_is_safe_and_close(weft_cloth *cloth, const char *label, double most)
{
    const weft_stepper_type *type = test_method_named(label);
    double *y = malloc(weft_cloth_dim(cloth) * sizeof *y);
    weft_cloth_start(cloth, y);
    const weft_stiffness modes = weft_cloth_stiffness(cloth, 0.0, y);
    const double h = stable_step(&modes, type);
    ck_assert_msg(!blows_up(cloth, type, h), "blows up at %g s", h);
    const double limit = true_limit(cloth, type, h);
    ck_assert_msg(limit <= most * h, "bound %g s of %g s", h, limit);
    free(y);
    weft_cloth_destroy(cloth);
}

START_TEST(stable_step_of_symplectic_euler_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close(make((size_t)_i), "verlet/symplectic_euler", 1.25);
}
END_TEST

START_TEST(stable_step_of_velocity_verlet_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close(make((size_t)_i), "verlet/velocity_verlet", 1.25);
}
END_TEST

/* Row sums, less sharp where springs and bending do not peak in the same mode. */
START_TEST(stable_step_with_rigidity_is_safe_and_within_two_fifths)
{
    bound_is_safe_and_close(make((size_t)_i), "verlet/symplectic_euler", 1.4);
    if (test_rounds(0, 1)) {
        bound_is_safe_and_close(make((size_t)_i), "verlet/velocity_verlet", 1.4);
    }
}
END_TEST

/* Three kinds of diagonals, with bending that hardly counts and with as much of it as
 * of the membrane. */
START_TEST(stable_step_of_triangles_is_safe_and_within_a_third)
{
    test_mesh sheet;
    mesh_sheet(&sheet, 10, 10, 0.01, (test_diagonals)(_i % 3), _i % 3 == 0 ? 0.0 : 0.25,
               5);
    weft_fabric *fabric = &sheet.fabrics[0];
    for (size_t k = 0; k < 2; ++k) {
        fabric->bend[k] *= _i < 3 ? 1.0 : 1e3;
        fabric->damping[k] = 2e-5 * (double)(k + 1);
    }
    fabric->twist *= _i < 3 ? 1.0 : 1e3;
    const weft_cloth_def def = mesh_cloth(&sheet);
    bound_is_safe_and_close(test_cloth(&def), "verlet/velocity_verlet",
                            1.0 + 1.0 / 3.0);
    mesh_free(&sheet);
}
END_TEST

#ifdef HAVE_ARKODE
START_TEST(stable_step_of_rk4_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close(make((size_t)_i), "arkode/rk4", 1.25);
}
END_TEST
#endif

#ifdef HAVE_GSL
START_TEST(stable_step_of_third_order_is_safe_and_within_a_quarter)
{
    bound_is_safe_and_close(make((size_t)_i), "gsl/rk2", 1.25);
}
END_TEST
#endif

TEST_SUITE(bounds)
{
    Suite *suite = suite_create("bounds");
    TCase *steps = tcase_create("steps");
    tcase_set_timeout(steps, 120.0);
    tcase_add_loop_test(
        steps, stable_step_of_symplectic_euler_is_safe_and_within_a_quarter, 0, CLOTHS);
    tcase_add_loop_test(
        steps, stable_step_of_velocity_verlet_is_safe_and_within_a_quarter, 0, CLOTHS);
    tcase_add_loop_test(steps, stable_step_of_triangles_is_safe_and_within_a_third, 0,
                        6);
    tcase_add_loop_test(steps, stable_step_with_rigidity_is_safe_and_within_two_fifths,
                        3 * CLOTHS, 3 * CLOTHS + test_rounds(4, CLOTHS));
#ifdef HAVE_ARKODE
    tcase_add_loop_test(steps, stable_step_of_rk4_is_safe_and_within_a_quarter, 0,
                        CLOTHS);
#endif
#ifdef HAVE_GSL
    tcase_add_loop_test(steps, stable_step_of_third_order_is_safe_and_within_a_quarter,
                        0, CLOTHS);
#endif
    suite_add_tcase(suite, steps);
    return suite;
}
