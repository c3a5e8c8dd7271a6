/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow asan-long */
/* test_papers.c -- scenes that repeat what papers report. Provot's table: largest
 * strain of stretch, shear and bend springs and largest speed that are left of a sheet
 * hung by two corners, as an independent program of another language has computed them.
 * Baraff's charts of x' = -k x: exact. */
#include "support.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define N            (17 * 17)

static weft_scene *scene;
static weft_cloth *cloth;
static weft_sim *sim;

static void teardown(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
    sim = NULL;
    cloth = NULL;
    scene = NULL;
}

static const weft_plugin *linked(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)ctx, (void)err;
    for (size_t i = 0; (plugin = test_plugin(i)) != NULL; ++i) {
        if (strcmp(plugin->id, id) == 0) {
            break;
        }
    }
    return plugin;
}

static void begin(const char *file, const char *const *sets, size_t count)
{
    static weft_diagnostics found;
    weft_error err = { 0 };
    weft_scene_def def = weft_scene_def_default();
    def.file = file;
    def.sets = sets;
    def.set_count = count;
    def.find_plugin = linked;
    ck_assert_msg(weft_scene_load(&def, &scene, &found, &err) == WEFT_OK, "%s",
                  err.message);
    cloth = test_cloth(weft_scene_cloth(scene));
    weft_sim_def run = weft_sim_def_default();
    run.cloth = cloth;
    run.method = weft_scene_method_type(scene);
    run.config = *weft_scene_config(scene);
    run.limit = *weft_scene_limit(scene);
    ck_assert_msg(weft_sim_create(&run, &sim, &err) == WEFT_OK, "%s", err.message);
}

/* ---- Provot 1995 -------------------------------------------------------------------
 */

typedef struct row {
    const char *file;
    const char *sets[3];
    double duration; /* [s] */
    double strain[WEFT_FAMILIES];
    double speed; /* [m/s] largest left, two digits; 0: not compared */
} row;

#define PAPER   "scenes/provot-paper.yaml"
#define STRETCH "limit.springs=[stretch]"
#define UPDATE  "limit.velocity=update"
#define ONE     "limit.sweeps=1"

static const row table[] = {
    { "scenes/provot.yaml", { NULL }, 40.0, { 1.964, 1.516, 0.999 }, 0.0 },
    { PAPER, { STRETCH, ONE }, 20.0, { 0.364, 0.592, 0.315 }, 2.4 },
    { PAPER, { STRETCH }, 20.0, { 0.101, 0.380, 0.101 }, 1.8 },
    { PAPER, { ONE }, 20.0, { 0.326, 0.260, 0.249 }, 1.6 },
    { PAPER, { "limit.sweeps=10" }, 20.0, { 0.120, 0.117, 0.115 }, 1.2 },
    { PAPER, { NULL }, 20.0, { 0.1005, 0.1003, 0.1004 }, 1.2 },
    { PAPER, { UPDATE, ONE }, 20.0, { 0.230, 0.192, 0.186 }, 0.017 },
    { PAPER, { UPDATE }, 20.0, { 0.1003, 0.1002, 0.1002 }, 0.016 },
};

/* The table's sheet starts with its pins moved 0.2 m out of its plane: to move all the
 * rest the other way is the same. */
static void move_the_sheet(void)
{
    double x[3 * N];
    weft_sim_positions(sim, x);
    for (size_t i = 0; i < N; ++i) {
        x[3 * i + 2] -= 0.2;
    }
    ck_assert_int_eq(weft_sim_set_state(sim, x, NULL, NULL), WEFT_OK);
}

static double apart(const double *x, size_t p, size_t q)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        sum += (x[3 * q + k] - x[3 * p + k]) * (x[3 * q + k] - x[3 * p + k]);
    }
    return sqrt(sum);
}

/* Of all springs from (r, c) to (r + down, c + right). */
static double largest_strain(const double *x, int down, int right)
{
    const double *spacing = weft_scene_cloth(scene)->spacing;
    const double rest = hypot(down * spacing[0], right * spacing[1]);
    double most = -1.0;
    for (int r = 0; r + down < 17; ++r) {
        for (int c = right < 0 ? -right : 0; c < 17 && c + right < 17; ++c) {
            const size_t p = (size_t)(17 * r + c);
            const size_t q = (size_t)(17 * (r + down) + c + right);
            most = fmax(most, apart(x, p, q) / rest - 1.0);
        }
    }
    return most;
}

static double fastest(void)
{
    double v[3 * N], most = 0.0;
    weft_sim_velocities(sim, v);
    for (size_t i = 0; i < N; ++i) {
        const double *w = v + 3 * i;
        most = fmax(most, sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
    }
    return most;
}

START_TEST(provots_table_is_met_to_half_a_percent)
{
    if (_i % test_rounds(2, 1) != 0) {
        return; /* the other half if there is time */
    }
    const row *want = &table[_i];
    size_t count = 0;
    while (want->sets[count] != NULL) {
        ++count;
    }
    begin(want->file, want->sets, count);
    move_the_sheet();
    double x[3 * N];
    ck_assert_int_eq(weft_sim_advance(sim, want->duration, NULL), WEFT_OK);
    weft_sim_positions(sim, x);
    const double got[] = { fmax(largest_strain(x, 0, 1), largest_strain(x, 1, 0)),
                           fmax(largest_strain(x, 1, 1), largest_strain(x, 1, -1)),
                           fmax(largest_strain(x, 0, 2), largest_strain(x, 2, 0)) };
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        ck_assert_double_eq_tol(got[f], want->strain[f], 0.005 * want->strain[f]);
    }
    ck_assert(want->speed == 0.0
              || fabs(fastest() - want->speed) <= (want->speed > 1.0 ? 0.05 : 5e-4));
}
END_TEST

/* ---- Baraff 2001 -------------------------------------------------------------------
 */

START_TEST(eulers_factor_is_1_minus_k_h)
{
    static const double k[] = { 0.5, 1.0, 1.5, 2.0, 3.0 }; /* h = 1 s */
    char text[64];
    (void)snprintf(text, sizeof text, "forces.damping=%g", k[_i]);
    const char *const set = text;
    begin("scenes/stiffness.yaml", &set, 1);
    double v[6], x[6], exact_v = 1.0, exact_x = 0.0;
    for (int n = 1; n <= 8; ++n) {
        exact_x += exact_v;
        exact_v *= 1.0 - k[_i];
        ck_assert_int_eq(weft_sim_advance(sim, n, NULL), WEFT_OK);
        weft_sim_velocities(sim, v);
        weft_sim_positions(sim, x);
        ck_assert(v[0] == exact_v && v[3] == exact_v && v[1] == 0.0);
        ck_assert(x[0] == exact_x && x[3] == 1.0 + exact_x);
    }
    ck_assert_uint_eq(weft_sim_stats(sim).steps, 8);
}
END_TEST

TEST_SUITE(papers)
{
    Suite *all = suite_create("papers");
    TCase *tests = tcase_create("papers");
    tcase_set_timeout(tests, 300);
    tcase_add_checked_fixture(tests, NULL, teardown);
    tcase_add_loop_test(tests, provots_table_is_met_to_half_a_percent, 0, COUNT(table));
    tcase_add_loop_test(tests, eulers_factor_is_1_minus_k_h, 0, 5);
    suite_add_tcase(all, tests);
    return all;
}
