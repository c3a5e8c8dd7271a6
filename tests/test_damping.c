/* SPDX-License-Identifier: BSD-3-Clause */
/* test_damping.c -- the power that dampers take: what a sum over the springs gives. */
#include "stepper_run.h"

#include "cloth/model.h"

#include <stdlib.h>

enum { COLS_MAX = 41 };

static weft_cloth *make(size_t rows, size_t cols)
{
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    def.rows = rows;
    def.cols = cols;
    def.damping = 0.01;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        def.springs[k] = (weft_spring_def){ .present = true,
                                            .stiffness = 10.0,
                                            .damping = 0.1 * (double)(k + 1) };
    }
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, NULL), WEFT_OK);
    return cloth;
}

static double *stir(const weft_cloth *cloth)
{
    const size_t dim = weft_cloth_dim(cloth);
    double *y = malloc(dim * sizeof *y);
    ck_assert_ptr_nonnull(y);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < dim; ++i) {
        y[i] += 0.02 * sin(0.7 * (double)(i * i % 1009));
    }
    return y;
}

static double plain_power(const weft_cloth *cloth, const double *y)
{
    const size_t n = cloth->mesh.particles;
    double power = 0.0;
    for (size_t r = 0; r < cloth->mesh.rows; ++r) {
        for (weft__walk walk = weft__row_springs(&cloth->springs, y, r);
             weft__each_spring(&walk);) {
            const weft__spring *at = &walk.spring;
            const double along
                = weft__spring_rate(&cloth->mesh, at, y + 3 * n) / sqrt(at->square);
            power += at->group->damping * along * along;
        }
    }
    for (size_t j = 3 * n; j < 6 * n; ++j) {
        power += cloth->body.drag * y[j] * y[j];
    }
    return power;
}

START_TEST(it_is_the_sum_over_all_springs)
{
    for (size_t cols = 1; cols <= COLS_MAX; ++cols) {
        weft_cloth *cloth = make(4, cols);
        double *y = stir(cloth);
        const double wanted = plain_power(cloth, y);
        ck_assert_double_eq_tol(weft_cloth_dissipation(cloth, 0.0, y), wanted,
                                1e-13 * wanted);
        free(y);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

START_TEST(a_spring_without_length_takes_nothing)
{
    weft_cloth *cloth = make(1, COLS_MAX);
    double *y = stir(cloth);
    for (size_t i = 0; i < COLS_MAX; ++i) { /* all at one place: none has a direction */
        y[i] = y[COLS_MAX + i] = y[2 * COLS_MAX + i] = 1.0;
    }
    double drag = 0.0;
    for (size_t j = 3 * COLS_MAX; j < 6 * COLS_MAX; ++j) {
        drag += cloth->body.drag * y[j] * y[j];
    }
    ck_assert_double_eq_tol(weft_cloth_dissipation(cloth, 0.0, y), drag, 1e-13 * drag);
    free(y);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(damping)
{
    Suite *suite = suite_create("damping");
    TCase *tcase = tcase_create("damping");
    tcase_add_test(tcase, it_is_the_sum_over_all_springs);
    tcase_add_test(tcase, a_spring_without_length_takes_nothing);
    suite_add_tcase(suite, tcase);
    return suite;
}
