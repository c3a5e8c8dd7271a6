/* SPDX-License-Identifier: BSD-3-Clause */
/* test_pace.c -- runs that hardly advance say what holds them; shapes that close on a
 * cloth are named. */
#include "bodies.h"
#include "meshes.h"
#include "scene_load.h"

#include "contact_run.h"

/* Warnings, by what they begin with or have. */
typedef struct heard {
    size_t closing, pace;
    double when; /* [s] of the first */
    char closed[512], paced[512];
} heard;

static heard all;

static void hear(void *ctx, weft_log_level level, const char *text)
{
    (void)ctx;
    if (level != WEFT_LOG_WARNING) {
        return;
    }
    if (strstr(text, "thicknesses") != NULL) {
        all.when = sim != NULL ? weft_sim_time(sim) : 0.0;
        ++all.closing;
        (void)snprintf(all.closed, sizeof all.closed, "%s", text);
    }
    if (strstr(text, " steps advance ") != NULL) {
        ++all.pace;
        (void)snprintf(all.paced, sizeof all.paced, "%s", text);
    }
}

/* A sheet of 3 x 3 on the plane y = 0, and a box that comes down: its lower face is at
 * 0.04 m - 0.1 m/s t. */
static void press(void)
{
    level_sheet();
    model.rows = model.cols = 3;
    all = (heard){ 0 };
    model.density = 0.25, model.mass = 0.0;
    model.origin[1] = 0.006;
    model.contact.thickness = 5e-3;
    model.contact.shape_count = 2;
    shapes[1] = weft_shape_default(WEFT_BOX);
    shapes[1].at[1] = 0.06;
    shapes[1].half[0] = shapes[1].half[2] = 0.2, shapes[1].half[1] = 0.02;
    shapes[1].rounding = 0.01;
    shapes[1].velocity[1] = -0.1;
    run.method = test_method_named("gsl/rkf45");
    tolerance(1e-4);
    run.log = (weft_log){ hear, NULL };
}

/* Frames of 1/30 s until a step fails. */
static weft_status frames(size_t count)
{
    weft_status status = WEFT_OK;
    start();
    for (size_t i = 1; i <= count && status == WEFT_OK; ++i) {
        status = weft_sim_advance(sim, (double)i / 30.0, &err);
    }
    return status;
}

static void has(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "no \"%s\" in: %s", part, text);
}

START_TEST(shapes_that_close_on_a_cloth_are_named_before_they_meet)
{
    press();
    run.config.min_step = 1e-7;
    ck_assert_int_eq(frames(30), WEFT_STEP_TOO_SMALL);
    ck_assert_uint_eq(all.closing, 1);
    has(all.closed, "shapes[0] and shapes[1] are ");
    has(all.closed, ", less than two thicknesses (10 mm), and meet at t = 0.4 s, with "
                    "particle (");
    ck_assert(all.when >= 0.3 - 1e-9 && all.when < 0.3 + 1.0 / 30.0);
}
END_TEST

START_TEST(the_smallest_step_names_what_holds_it)
{
    weft_failure failure;
    press();
    run.config.min_step = 1e-7;
    ck_assert_int_eq(frames(30), WEFT_STEP_TOO_SMALL);
    ck_assert(weft_sim_failure(sim, &failure) && failure.held_by_contact);
    ck_assert(failure.contact && failure.gap > 0.0 && failure.gap < 1e-3);
    ck_assert_double_eq(failure.gap, gap());
    ck_assert(failure.gap_shape + failure.other_shape == 1);
    ck_assert(failure.other_gap >= failure.gap && failure.other_gap < 1e-3);
    has(failure.held, "contact holds it: particle (");
    has(failure.held, " mm from shapes[0]");
    has(failure.held, " mm from shapes[1]");
    has(failure.held, " spring (");
    has(err.message, failure.held);
    ck_assert_ptr_null(strstr(err.message, "looser"));
}
END_TEST

START_TEST(a_run_that_hardly_advances_says_so_once_with_what_holds_it)
{
    press();
    run.method = test_method_named("verlet/velocity_verlet");
    run.config.fixed_step = 1e-10;
    ck_assert_uint_eq(all.pace, 0);
    start();
    for (size_t i = 0; i < 5000; ++i) {
        step(1.0);
    }
    ck_assert_uint_eq(all.pace, 1);
    has(all.paced, "1000 steps advance 1e-07 s at t = 1e-07 s, 2.5e-06 of a frame: the "
                   "fixed step is 1e-10 s; the run may take very long");
}
END_TEST

START_TEST(a_run_between_shapes_that_meet_says_so)
{
    press();
    run.config.min_step = 1e-12;
    start();
    for (size_t i = 1; i < 13; ++i) {
        while (all.pace == 0 && weft_sim_time(sim) < (double)i / 30.0) {
            if (weft_sim_step(sim, (double)i / 30.0, &err) != WEFT_OK) {
                ck_abort_msg("%s", err.message);
            }
        }
    }
    ck_assert_uint_eq(all.pace, 1);
    has(all.paced, " of a frame: contact holds it: particle (");
    ck_assert_double_lt(0.399, weft_sim_time(sim));
}
END_TEST

/* omega is some 5e8 1/s, so 1000 steps are some 1e-5 s; a frame is 1 s, taken for 0.04
 * s.
 */
START_TEST(the_stiffest_spring_is_named)
{
    press();
    model.contact.shape_count = 0;
    model.springs[WEFT_SHEAR].stiffness = 2e13;
    model.springs[WEFT_SHEAR].damping = 0.0;
    model.velocity[0] = 1e-3;
    model.pin_count = 1;
    model.pins = &(weft_pin){ .rows = { 2, 2 }, .cols = { 2, 2 } };
    tolerance(1e-12);
    start();
    for (size_t i = 0; i < 2000; ++i) {
        step(1.0);
    }
    ck_assert_uint_eq(all.pace, 1);
    has(all.paced, "what is stiffest holds it: shear spring (");
}
END_TEST

START_TEST(the_flattest_triangle_of_a_mesh_is_named)
{
    test_mesh mesh;
    press();
    mesh_sheet(&mesh, 4, 4, 0.05, MESH_RIGHT, 0.0, 1);
    for (size_t k = 0; k < 2; ++k) { /* vertex 5 comes near to the edge 10-6 */
        mesh.rest[2 * 5 + k] = 0.02 * mesh.rest[2 * 5 + k]
                               + 0.49 * (mesh.rest[2 * 10 + k] + mesh.rest[2 * 6 + k]);
        mesh.start[3 * 5 + k] = mesh.rest[2 * 5 + k];
    }
    model.mesh = &mesh.def;
    model.rows = model.cols = 0;
    model.contact.shape_count = 0;
    memset(model.springs, 0, sizeof model.springs);
    run.method = test_method_named("stiff/ros2");
    run.config.min_step = 0.02;
    run.config.first_step = 0.02;
    tolerance(1e-14);
    ck_assert_int_eq(frames(30), WEFT_STEP_TOO_SMALL);
    weft_failure failure;
    ck_assert(weft_sim_failure(sim, &failure) && !failure.held_by_contact);
    has(failure.held, "what is stiffest holds it: triangle ");
    has(failure.held, "5");
    mesh_free(&mesh);
}
END_TEST

START_TEST(shapes_that_do_not_meet_with_cloth_between_them_are_not_named)
{
    press();
    switch (_i) {
    case 0: /* stops 2 mm above the floor */
        shapes[1].velocity[1] = 0.0;
        shapes[1].at[1] = 0.041, shapes[1].amplitude[1] = -0.019;
        shapes[1].frequency = 1.0;
        break;
    case 1: /* is beside the cloth */
        shapes[1].at[0] = 1.0;
        break;
    case 2: /* rests */
        shapes[1].velocity[1] = 0.0, shapes[1].at[1] = 0.028;
        break;
    default: /* goes away */
        shapes[1].velocity[1] = 0.1, shapes[1].at[1] = 0.029;
        break;
    }
    start();
    for (size_t i = 1; i <= 10 && _i != 0; ++i) {
        go((double)i / 30.0);
    }
    for (size_t i = 1; i <= 10 && _i == 0; ++i) {
        go((double)i / 40.0);
    }
    ck_assert_uint_eq(all.closing, 0);
}
END_TEST

/* The box as two triangles; then the floor as well. */
START_TEST(bodies_that_close_on_a_cloth_are_named)
{
    body_mesh *down = plate(1, 0.2, 0.2), *floor = plate(1, 0.3, 0.3);
    press();
    for (size_t k = 0; k < 2; ++k) {
        if (k == 1 || _i % 2 == 1) {
            shapes[k] = body_shape(k == 1 ? down : floor);
        }
    }
    shapes[1].at[1] = 0.04;
    if (_i < 2) {
        shapes[1].velocity[1] = -0.1;
    } else { /* stops 4 mm above the floor */
        shapes[1].amplitude[1] = -0.036, shapes[1].frequency = 0.5;
    }
    start();
    for (size_t i = 1; i <= 60 && weft_sim_time(sim) < 0.37; ++i) {
        go((double)i / 100.0);
    }
    ck_assert_uint_eq(all.closing, _i < 2);
    if (_i < 2) {
        has(all.closed, "shapes[0] and shapes[1] are ");
        has(all.closed, " meet at t = 0.4 s, with particle (");
    }
    free(down);
    free(floor);
}
END_TEST

/* ---- in a scene ------------------------------------------------------------------ */

static size_t warnings(const char *box, double duration, const char *part)
{
    char text[900];
    (void)snprintf(
        text, sizeof text,
        "weft: 1\n"
        "cloth:\n"
        "  grid: {rows: 6, cols: 6, spacing: 0.05, origin: [-0.125, 0.006, -0.125], "
        "right: [1, 0, 0], down: [0, 0, 1]}\n"
        "  density: 0.25\n"
        "  springs: {stretch: {stiffness: 50}}\n"
        "contact:\n"
        "  thickness: 5.0e-3\n"
        "  shapes:\n"
        "    - {shape: plane, at: [0, 0, 0], normal: [0, 1, 0]}\n"
        "    - {shape: box, half: [0.2, 0.02, 0.2], rounding: 0.01, %s}\n"
        "stepper: {method: gsl/rkf45, rtol: 1.0e-4, atol: 1.0e-4}\n"
        "run: {duration: %g}\n",
        box, duration);
    weft_scene_destroy(good_text(text));
    size_t count = 0;
    for (size_t i = 0; i < found.count; ++i) {
        const bool closing = strstr(found.items[i].message, "thicknesses") != NULL;
        ck_assert(!closing || strstr(found.items[i].message, part) != NULL);
        count += closing;
    }
    return count;
}

START_TEST(a_scene_warns_of_shapes_that_will_meet_on_the_cloth)
{
    static const char *const part
        = "shapes[0] and shapes[1] are two thicknesses (10 mm) apart at t = 0.3 s and "
          "meet at t = 0.4 s, with particle (";
    const char *down = "at: [0, 0.06, 0], velocity: [0, -0.1, 0]";
    ck_assert_uint_eq(warnings(down, 1.0, part), 1);
    ck_assert_uint_eq(warnings(down, 0.35, part), 0);
    ck_assert_uint_eq(warnings("at: [1, 0.06, 0], velocity: [0, -0.1, 0]", 1.0, part),
                      0);
    ck_assert_uint_eq(warnings("at: [0, 0.06, 0], velocity: [0, -0.1, 0.5]", 0.2, part),
                      0);
    ck_assert_uint_eq(warnings("at: [0, 0.028, 0]", 1.0, part), 0);
    ck_assert_uint_eq(
        warnings("at: [0, 0.041, 0], amplitude: [0, -0.019, 0], frequency: 1", 1.0,
                 part),
        0);
    ck_assert_uint_eq(
        warnings(
            "at: [0, 0.06, 0], turn: {axis: [1, 0, 0], rate: 0.8, about: [0, 0.04, "
            "-0.21]}",
            1.0, "shapes[0] and shapes[1] are two thicknesses "),
        1);
}
END_TEST

TEST_SUITE(pace)
{
    Suite *suite = suite_create("pace");
    TCase *tests = tcase_create("runs");
    tcase_set_timeout(tests, 60.0);
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, shapes_that_close_on_a_cloth_are_named_before_they_meet);
    tcase_add_test(tests, the_smallest_step_names_what_holds_it);
    tcase_add_test(tests, a_run_that_hardly_advances_says_so_once_with_what_holds_it);
    tcase_add_test(tests, a_run_between_shapes_that_meet_says_so);
    tcase_add_test(tests, the_stiffest_spring_is_named);
    tcase_add_test(tests, the_flattest_triangle_of_a_mesh_is_named);
    tcase_add_loop_test(
        tests, shapes_that_do_not_meet_with_cloth_between_them_are_not_named, 0, 4);
    tcase_add_loop_test(tests, bodies_that_close_on_a_cloth_are_named, 0, 4);
    suite_add_tcase(suite, tests);
    TCase *scenes = tcase_create("scenes");
    tcase_add_test(scenes, a_scene_warns_of_shapes_that_will_meet_on_the_cloth);
    suite_add_tcase(suite, scenes);
    return suite;
}
