/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* test_examples.c -- the examples run, and print what is true. */
#include <math.h>

#include "shell.h"

#define EXAMPLE(name) BUILD_DIR "/examples/" name

static const char *line(int number)
{
    const char *at = output;
    while (number-- > 0) {
        at = strchr(at, '\n');
        ck_assert_ptr_nonnull(at);
        ++at;
    }
    return at;
}

static size_t lines(void)
{
    size_t count = 0;
    for (const char *at = output; *at != '\0'; ++at) {
        count += *at == '\n';
    }
    return count;
}

/* A sheet of 20 x 20, 5 cm apart, swings about the corner that it hangs by: the last
 * corner falls as anything does while no wave of the springs has reached it. */
START_TEST(minimal_prints_a_frame_a_line)
{
    double t, height;
    expect(shell(EXAMPLE("minimal") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 30);
    for (int i = 0; i < 30; ++i) {
        ck_assert_int_eq(
            sscanf(line(i), "%lf s: last corner at height %lf", &t, &height), 2);
        ck_assert_double_eq_tol(t, (i + 1) / 30.0, 6e-4);
        if (i < 3) {
            const double exact = (i + 1) / 30.0;
            ck_assert_double_eq_tol(height, -0.95 - 0.5 * 9.81 * exact * exact, 1e-3);
        }
    }
}
END_TEST

/* One hangs, the other falls freely from a throw of 2 m/s. */
START_TEST(two_cloths_are_where_each_of_them_goes)
{
    expect(shell(EXAMPLE("two_cloths") " 2>&1"), 0);
    ck_assert_str_eq(output, "flag: 36 vertices, at a height of -0.1250 m\n"
                             "leaf: 36 vertices, at a height of -0.1098 m\n");
}
END_TEST

START_TEST(dragged_corner_is_where_the_hand_is)
{
    expect(shell(EXAMPLE("game_loop") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 12);
    double last[3] = { 0.0 };
    for (int i = 0; i < 12; ++i) {
        double printed, x[3];
        char state[8];
        ck_assert_int_eq(sscanf(line(i), "%lf s %7s %lf %lf %lf", &printed, state,
                                &x[0], &x[1], &x[2]),
                         5);
        const double t = (i + 1) / 6.0;
        const bool held = i >= 2 && i <= 8;
        ck_assert_str_eq(state, held ? "held" : "free");
        if (held) {
            ck_assert_double_eq_tol(x[0], 0.95 - 0.4 * (t - 0.5), 1e-6);
            ck_assert_double_eq_tol(x[1], -0.7 + 0.3 * (t - 0.5), 1e-6);
            ck_assert_double_eq_tol(x[2], 0.5 * (t - 0.5), 1e-6);
        }
        memcpy(last, x, sizeof x);
    }
    ck_assert_double_lt(last[2], 0.3); /* it has swung back */
}
END_TEST

START_TEST(dragged_sphere_pushes_the_cloth)
{
    expect(shell(EXAMPLE("dragged_sphere") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 9);
    for (int i = 0; i < 9; ++i) {
        double t, gap, force;
        ck_assert_int_eq(
            sscanf(line(i), "%lf s gap %lf m force %lf N", &t, &gap, &force), 3);
        ck_assert_double_gt(gap, 0.0);
        if (i < 3) { /* it arrives at (0.6 - 0.15 - 0.005) / 0.8 s */
            ck_assert(force == 0.0);
        } else {
            ck_assert_double_lt(gap, 0.005);
            ck_assert_double_lt(force, 0.0);
        }
    }
}
END_TEST

START_TEST(own_force_and_floor_are_accounted_for)
{
    expect(shell(EXAMPLE("own_force") " 2>&1"), 0);
    says("info: 8 x 12 particles under velocity_verlet");
    ck_assert_uint_eq(lines(), 12);
    for (int i = 0; i <= 10; ++i) {
        double t, height, force, floor_work, residual;
        ck_assert_int_eq(sscanf(line(i + 1),
                                "%lf s height %lf m, force did %lf J, floor %lf J, "
                                "residual %lf J",
                                &t, &height, &force, &floor_work, &residual),
                         5);
        const double fall = -0.5 * 9.81 * t * t;
        ck_assert_double_eq_tol(height, fmax(fall, -1.0), 1e-4);
        ck_assert_double_eq_tol(residual, 0.0, 1e-5);
        ck_assert(i == 0 || force > 0.0);
        ck_assert(i < 5 ? floor_work == 0.0 : floor_work < -1.0);
    }
}
END_TEST

/* A flat pillow of side a that cannot stretch holds 0.19 a^3: 5.1 l. This one has cells
 * of 3 cm, which press 20 Pa (3 cm)^2 on a vertex at first. */
START_TEST(pressure_on_a_mesh_inflates_a_pillow_and_sums_to_zero)
{
    expect(shell(EXAMPLE("pillow") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 11);
    for (int i = 0; i <= 10; ++i) {
        double t, litres, largest, sum[3];
        ck_assert_int_eq(
            sscanf(line(i),
                   "%lf s: %lf l, at most %lf N on a vertex, in all %lf %lf "
                   "%lf N",
                   &t, &litres, &largest, &sum[0], &sum[1], &sum[2]),
            6);
        ck_assert_double_eq_tol(t, 0.02 * i, 1e-9);
        for (int k = 0; k < 3; ++k) {
            ck_assert_double_eq_tol(sum[k], 0.0, 1e-14);
        }
        ck_assert_double_eq_tol(largest, 0.018, 1e-3);
        ck_assert(i < 4 || fabs(litres - 4.7) < 0.3);
    }
}
END_TEST

START_TEST(own_stepper_is_of_order_4)
{
    expect(shell(EXAMPLE("own_stepper") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 4);
    for (int i = 1; i < 4; ++i) {
        double error, order;
        int n;
        ck_assert_int_eq(
            sscanf(line(i), "h = 1/%d s: error %lf m, order %lf", &n, &error, &order),
            3);
        ck_assert_double_eq_tol(order, 4.0, 0.1);
    }
}
END_TEST

START_TEST(plugin_of_one_file_keeps_every_promise)
{
    expect(shell(WEFT " plugin-test " EXAMPLE("weft-bogacki.so") " --all"), 0);
    says("pass tolerance ");
    says("pass min step ");
    says("meets every requirement with 1 method");
}
END_TEST

/* The laws of ARKODE's controller are others: no more than the same price is asked. */
START_TEST(plugin_of_one_file_reaches_its_tolerance_at_a_fair_price)
{
    static const char scene[]
        = WEFT " run " BUILD_DIR "/plugin.yaml --plugin-path " BUILD_DIR
               "/examples:" BUILD_DIR "/plugins --force --quiet --out " BUILD_DIR
               "/plugin --set 'stepper={plugin: %s, method: %s, rtol: 1e-6, atol: "
               "1e-6}' && awk '$1 == \"rhs_calls:\" { print $2 }' " BUILD_DIR
               "/plugin/result.yaml 2>&1";
    write_file(BUILD_DIR "/plugin.yaml", small_scene);
    expect(shell(scene, "bogacki", "bs32"), 0);
    const double own = atof(output);
    ck_assert_double_gt(own, 0.0);
    expect(shell("grep 'safety: 0.9' " BUILD_DIR "/plugin/manifest.yaml"), 0);
#ifdef HAVE_ARKODE
    expect(shell(scene, "arkode", "bogacki_shampine"), 0);
    ck_assert_double_lt(own, 1.5 * atof(output));
#endif
}
END_TEST

START_TEST(bands_have_the_bits_of_the_whole_cloth)
{
    char whole[20], part[20];
    int bands;
    expect(shell(EXAMPLE("bands") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 3);
    for (int i = 0; i < 3; ++i) {
        ck_assert_int_eq(
            sscanf(line(i), "%d bands: state %16s", &bands, i == 0 ? whole : part), 2);
        ck_assert_int_eq(bands, i + 1);
        ck_assert_str_eq(i == 0 ? whole : part, whole);
    }
}
END_TEST

START_TEST(same_run_in_two_threads_has_the_same_bits)
{
    char before[200] = "";
    expect(shell(EXAMPLE("threads") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 8);
    for (int i = 0; i < 8; i += 2) {
        const char *a = line(i), *b = line(i + 1);
        const size_t length = (size_t)(b - a);
        ck_assert(strncmp(a, b, length) == 0);
        ck_assert(strncmp(a, before, length) != 0);
        memcpy(before, a, length);
    }
}
END_TEST

#ifdef HAVE_ARKODE
/* Inside, m = 0.002 kg; a row swings with w2 = 4 k / m at most, and h = 2 / w. Where a
 * particle is lighter, on the rim, h is shorter. */
START_TEST(restored_simulation_ends_in_the_same_state)
{
    double h;
    expect(shell(EXAMPLE("adaptive") " " BUILD_DIR "/plugins 2>&1"), 0);
    ck_assert_uint_eq(lines(), 4);
    ck_assert_int_eq(sscanf(line(0), "velocity_verlet is stable up to %lf s", &h), 1);
    ck_assert(h > 1e-3 && h < 2.0 / sqrt(4.0 * 100.0 / 0.002));
    ck_assert_int_eq(strncmp(line(1), "1.0 s: ", 7), 0);
    ck_assert_int_eq(strncmp(line(2), "2.0 s: ", 7), 0);
    ck_assert_mem_eq(line(2), line(3), (size_t)(line(3) - line(2)));
}
END_TEST
#endif

START_TEST(player_who_goes_back_ends_in_the_same_state)
{
    char state[2][20];
    expect(shell(EXAMPLE("rollback") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 2);
    ck_assert_int_eq(sscanf(line(0), "in time: state %16s after 30 frames", state[0]),
                     1);
    ck_assert_int_eq(sscanf(line(1), "late: state %16s after 30 frames", state[1]), 1);
    ck_assert_str_eq(state[0], state[1]);
}
END_TEST

START_TEST(scene_from_memory_is_that_of_a_file)
{
    static char from_memory[sizeof output];
    expect(shell(EXAMPLE("scene") " '' " BUILD_DIR "/plugins 2>&1"), 0);
    ck_assert_uint_eq(lines(), 10);
    memcpy(from_memory, output, sizeof output);
    /* the text of the example, taken from its source */
    expect(
        shell(
            "sed -n 's/^ *[=]* *\"\\(.*\\)\\\\n\".*/\\1/p' examples/scene.c >" BUILD_DIR
            "/scene-example.yaml && " EXAMPLE("scene") " " BUILD_DIR
                                                       "/scene-example.yaml " BUILD_DIR
                                                       "/plugins 2>&1"),
        0);
    ck_assert_str_eq(output, from_memory);
    write_file(BUILD_DIR "/scene-example.yaml", "weft: 2\n");
    expect(shell(EXAMPLE("scene") " " BUILD_DIR "/scene-example.yaml " BUILD_DIR
                                  "/plugins 2>&1"),
           1);
    says("scene-example.yaml:1:7: error: ");
}
END_TEST

/* 30 frames at 0.5 m/s: of the flag, whose last corner starts at 0.25 m. */
START_TEST(scene_whose_corner_is_dragged)
{
    double t, height;
    expect(shell("WEFT_PLUGIN_PATH=" BUILD_DIR
                 "/plugins " EXAMPLE("drag_scene") " scenes/flag.yaml 2>&1"),
           0);
    ck_assert_uint_eq(lines(), 30);
    ck_assert_int_eq(
        sscanf(line(29), "%lf s: last corner at height %lf m", &t, &height), 2);
    ck_assert_double_eq_tol(t, 1.0, 5e-4);
    ck_assert_double_eq_tol(height, 0.75, 1e-4);
    write_file(BUILD_DIR "/drag-example.yaml", "weft: 2\n");
    expect(shell("WEFT_PLUGIN_PATH=" BUILD_DIR "/plugins " EXAMPLE(
               "drag_scene") " " BUILD_DIR "/drag-example.yaml 2>&1"),
           1);
    says("drag-example.yaml:1:7: error: ");
}
END_TEST

#ifdef HAVE_CXX
/* The gust blows from frame 10 to 40; the corner is hauled in at 0.5 m/s from 30 to 50.
 */
START_TEST(sail_in_cpp_blows_and_is_hauled_in)
{
    double t, x[6][3], n[3];
    expect(shell(EXAMPLE("sail") " 2>&1"), 0);
    ck_assert_uint_eq(lines(), 9);
    ck_assert_int_eq(strncmp(line(0), "500 particles, 912 triangles\n", 29), 0);
    for (int i = 0; i < 6; ++i) {
        ck_assert_int_eq(sscanf(line(i + 1), "%lf s %lf %lf %lf normal %lf %lf %lf", &t,
                                &x[i][0], &x[i][1], &x[i][2], &n[0], &n[1], &n[2]),
                         7);
        ck_assert_double_eq_tol(t, (i + 1) / 6.0, 6e-4);
        ck_assert_double_eq_tol(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 3e-3);
    }
    ck_assert_double_eq_tol(x[0][2], 0.0, 2e-3); /* of one frame of the gust */
    ck_assert_double_gt(x[2][2], 0.1);
    const double hauled[3] = { -0.5 / 6.0, 0.2 / 6.0, 0.0 }; /* ten frames */
    for (int k = 0; k < 3; ++k) {
        ck_assert_double_eq_tol(x[3][k] - x[2][k], hauled[k], 1.1e-4);
    }
    ck_assert_int_eq(strncmp(line(7), "the same again\nrefused: no particle 500", 39),
                     0);
}
END_TEST
#endif

/* The frames go on until the kinetic energy is 1 mJ, whose time is that of the event.
 */
START_TEST(frames_end_where_the_energy_is_left)
{
    double t = 0.0, kinetic = 0.0, end = 0.0, before = 1.0;
    char rest[32];
    expect(shell(EXAMPLE("frames") " 2>&1"), 0);
    ck_assert_int_eq(strncmp(line(0), "bends in 2.0 cm of its weight", 29), 0);
    int i = 0;
    while (sscanf(line(i + 1), "frame %*d at %lf s: kinetic %lf J%31[^\n]", &t,
                  &kinetic, rest)
           >= 2) {
        ck_assert(i == 0 || (kinetic < before && strcmp(rest, ", within a step") == 0));
        before = kinetic;
        ++i;
    }
    ck_assert_double_eq_tol(kinetic, 1e-3, 5e-7);
    ck_assert_int_eq(
        sscanf(line(i + 1), "1 mJ of kinetic energy is left after %lf s", &end), 1);
    ck_assert_double_eq_tol(end, t, 1e-12);
    ck_assert_int_eq(strncmp(line(i + 3), "half a step before ", 19), 0);
    ck_assert_int_eq(strncmp(line(i + 4), "state is not finite: particle (", 31), 0);
}
END_TEST

/* The sum of heights of examples/derivative.c at another stiffness [N/m]. */
static double sum_of_heights(double stiffness)
{
    const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    double sum = 0.0;
    def.rows = def.cols = 6;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = stiffness, .damping = 0.02 };
    def.pins = &corner;
    def.pin_count = 1;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, NULL), WEFT_OK);
    weft_sim_def run = weft_sim_def_default();
    run.cloth = cloth;
    run.method = test_method_named("verlet/midpoint");
    run.config.fixed_step = 1e-3;
    ck_assert_int_eq(weft_sim_create(&run, &sim, NULL), WEFT_OK);
    for (int i = 1; i <= 5; ++i) {
        ck_assert_int_eq(weft_sim_advance(sim, i / 10.0, NULL), WEFT_OK);
        sum += weft_sim_state(sim)[2 * 36 - 1];
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return sum;
}

START_TEST(derivatives_are_those_of_runs_that_differ)
{
    double forwards = 0.0, back = 1.0, value = 0.0, slope = 0.0, most = 0.0;
    expect(shell(EXAMPLE("derivative") " 2>&1"), 0);
    ck_assert_ptr_nonnull(strstr(line(0), "accelerates by -9.81 m/s^2"));
    ck_assert_int_eq(
        sscanf(line(1), "w.(J v) = %lf, v.(J^T w) = %lf", &forwards, &back), 2);
    ck_assert_double_eq_tol(forwards, back, 1e-6 * fabs(forwards));
    ck_assert_int_eq(
        sscanf(line(2), "1 %% more stiffness accelerates by at most %lf", &most), 1);
    ck_assert_double_gt(most, 0.0);
    ck_assert_int_eq(sscanf(line(3),
                            "sum of heights %lf m; %lf m per 1 %% of stiffness", &value,
                            &slope),
                     2);
    ck_assert_double_eq_tol(value, sum_of_heights(100.0), 1e-6);
    ck_assert_double_eq_tol(slope, (sum_of_heights(100.1) - sum_of_heights(99.9)) / 0.2,
                            2e-6);
}
END_TEST

TEST_SUITE(examples)
{
    Suite *suite = suite_create("examples");
    TCase *tcase = tcase_create("examples");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_test(tcase, minimal_prints_a_frame_a_line);
    tcase_add_test(tcase, frames_end_where_the_energy_is_left);
    tcase_add_test(tcase, derivatives_are_those_of_runs_that_differ);
    tcase_add_test(tcase, two_cloths_are_where_each_of_them_goes);
    tcase_add_test(tcase, dragged_corner_is_where_the_hand_is);
    tcase_add_test(tcase, dragged_sphere_pushes_the_cloth);
    tcase_add_test(tcase, own_force_and_floor_are_accounted_for);
    tcase_add_test(tcase, pressure_on_a_mesh_inflates_a_pillow_and_sums_to_zero);
    tcase_add_test(tcase, own_stepper_is_of_order_4);
    tcase_add_test(tcase, plugin_of_one_file_keeps_every_promise);
    tcase_add_test(tcase, plugin_of_one_file_reaches_its_tolerance_at_a_fair_price);
    tcase_add_test(tcase, bands_have_the_bits_of_the_whole_cloth);
    tcase_add_test(tcase, same_run_in_two_threads_has_the_same_bits);
#ifdef HAVE_ARKODE
    tcase_add_test(tcase, restored_simulation_ends_in_the_same_state);
#endif
    tcase_add_test(tcase, player_who_goes_back_ends_in_the_same_state);
    tcase_add_test(tcase, scene_from_memory_is_that_of_a_file);
    tcase_add_test(tcase, scene_whose_corner_is_dragged);
#ifdef HAVE_CXX
    tcase_add_test(tcase, sail_in_cpp_blows_and_is_hauled_in);
#endif
    suite_add_tcase(suite, tcase);
    return suite;
}
