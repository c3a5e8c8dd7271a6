/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact in scenes: defaults, values, warnings at their places, overrides, sweeps. The
 * errors are in tests/scenes-bad/contact*.yaml. */
#include "scene_load.h"

#define SHEET                                                                          \
    "cloth:\n"                                                                         \
    "  grid: {rows: 5, cols: 6, spacing: 0.1, right: [1, 0, 0], down: [0, 0, 1]}\n"    \
    "  mass: 0.01\n"
#define END                                                                            \
    "stepper: {plugin: gsl, method: rkf45}\n"                                          \
    "run: {duration: 2}\n"

static const char all_shapes[] = SHEET
    "contact:\n"
    "  thickness: 0.02\n"
    "  stopping_speed: 3\n"
    "  exponent: 6\n"
    "  damping: 0\n"
    "  friction: 0.4\n"
    "  law: coulomb\n"
    "  slip: 0.01\n"
    "  shapes:\n"
    "    - {shape: plane, at: [1, -4, 2], normal: [1, 2, 3], spin: [2, 4, 6]}\n"
    "    - {shape: sphere, at: [0, -2, 0], radius: 0.5, friction: 0, spin: [1, 2, 3]}\n"
    "    - {shape: capsule, from: [0, -1, 0], to: [1, -1, 0], radius: 0.1, velocity: "
    "[0, 0, 1]}\n"
    "    - {shape: box, at: [0, -3, 0], half: [0.3, 0.4, 0.5], rounding: 0.2, "
    "amplitude: [0, 0.1, 0], frequency: 2, turn: {axis: [0, 3, 4], about: [1, 2, 3], "
    "rate: 0.5, amplitude: -0.2, frequency: 3}}\n" END;

static void check_same(const weft_contact_def *a, const weft_contact_def *b)
{
    ck_assert(a->thickness == b->thickness && a->stopping_speed == b->stopping_speed);
    ck_assert(a->damping == b->damping && a->friction == b->friction);
    ck_assert(a->slip == b->slip);
    ck_assert_int_eq(a->exponent, b->exponent);
    ck_assert_int_eq(a->law, b->law);
}

START_TEST(defaults_are_those_of_the_library)
{
    const weft_cloth_def def = weft_cloth_def_default();
    weft_scene *scene = good_text(SHEET END);
    check_same(&weft_scene_cloth(scene)->contact, &def.contact);
    ck_assert_uint_eq(weft_scene_cloth(scene)->contact.shape_count, 0);
    weft_scene_destroy(scene);
    scene = good_text(SHEET "contact:\n  shapes:\n    - {shape: plane, at: [0, -1, 0], "
                            "normal: [0, 1, 0]}\n" END);
    const weft_contact_def *contact = &weft_scene_cloth(scene)->contact;
    const weft_shape plane = weft_shape_default(WEFT_PLANE), *read = contact->shapes;
    check_same(contact, &def.contact);
    ck_assert_uint_eq(contact->shape_count, 1);
    ck_assert_uint_eq(found.count, 0);
    ck_assert(read->kind == WEFT_PLANE && read->friction == plane.friction);
    ck_assert(read->frequency == 0.0 && read->spin[1] == 0.0);
    weft_scene_destroy(scene);
}
END_TEST

static void check_vector(const double v[3], double x, double y, double z)
{
    ck_assert(v[0] == x && v[1] == y && v[2] == z);
}

static void check_values(const weft_contact_def *contact)
{
    const weft_shape *shapes = contact->shapes;
    const weft_contact_def law = { .thickness = 0.02,
                                   .stopping_speed = 3.0,
                                   .exponent = 6,
                                   .friction = 0.4,
                                   .law = WEFT_FRICTION_COULOMB,
                                   .slip = 0.01 };
    check_same(contact, &law);
    ck_assert_uint_eq(contact->shape_count, WEFT_MESH);
    for (size_t k = 0; k < WEFT_MESH; ++k) {
        ck_assert_uint_eq(shapes[k].kind, k);
    }
    check_vector(shapes[0].at, 1.0, -4.0, 2.0);
    check_vector(shapes[0].normal, 1.0, 2.0, 3.0);
    check_vector(shapes[0].spin, 2.0, 4.0, 6.0);
    check_vector(shapes[1].spin, 1.0, 2.0, 3.0);
    ck_assert(shapes[1].radius == 0.5 && shapes[1].friction == 0.0);
    check_vector(shapes[2].at, 0.0, -1.0, 0.0);
    check_vector(shapes[2].to, 1.0, -1.0, 0.0);
    check_vector(shapes[2].velocity, 0.0, 0.0, 1.0);
    ck_assert(shapes[2].radius == 0.1 && shapes[2].friction < 0.0);
    check_vector(shapes[3].half, 0.3, 0.4, 0.5);
    check_vector(shapes[3].amplitude, 0.0, 0.1, 0.0);
    const weft_turn *turn = &shapes[3].turn;
    check_vector(turn->axis, 0.0, 3.0, 4.0);
    check_vector(turn->about, 1.0, 2.0, 3.0);
    ck_assert(turn->rate == 0.5 && turn->amplitude == -0.2 && turn->frequency == 3.0);
    check_vector(shapes[2].turn.axis, 0.0, 0.0, 0.0);
    ck_assert(shapes[3].rounding == 0.2 && shapes[3].frequency == 2.0);
}

START_TEST(every_key_is_read_and_survives_a_round_trip)
{
    weft_scene *scene = good_text(all_shapes);
    check_values(&weft_scene_cloth(scene)->contact);
    weft_scene_destroy(scene);
    /* an override makes the text anew */
    const char *const sets[] = { "run.duration=1" };
    weft_scene_def def = scene_of_text(all_shapes);
    def.sets = sets, def.set_count = 1;
    scene = good_scene(&def);
    weft_scene *again = good_text(weft_scene_text(scene));
    check_values(&weft_scene_cloth(again)->contact);
    ck_assert_str_eq(weft_scene_text(again), weft_scene_text(scene));
    weft_scene_destroy(again);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(overrides_reach_shapes)
{
    static const char ball[]
        = "contact.shapes.4={shape: sphere, at: [0, -9, 0], radius: 1}";
    const char *const sets[]
        = { "contact.shapes.1.radius=0.2", "contact.friction=0.7", ball };
    weft_scene_def def = scene_of_text(all_shapes);
    def.sets = sets, def.set_count = 3;
    weft_scene *scene = good_scene(&def);
    const weft_contact_def *contact = &weft_scene_cloth(scene)->contact;
    ck_assert_uint_eq(contact->shape_count, 5);
    ck_assert(contact->shapes[1].radius == 0.2 && contact->shapes[4].radius == 1.0);
    ck_assert(contact->friction == 0.7);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(sweeps_vary_shapes)
{
    weft_sweep *sweep = NULL;
    weft_error err = { 0 };
    char text[2048];
    (void)snprintf(text, sizeof text,
                   "%ssweep: {contact.shapes.1.radius: [0.1, 0.2], contact.exponent: "
                   "[3, 10]}\n",
                   all_shapes);
    const weft_scene_def def = scene_of_text(text);
    ck_assert_msg(weft_sweep_load(&def, &sweep, &found, &err) == WEFT_OK, "%s",
                  all_found());
    ck_assert_uint_eq(weft_sweep_runs(sweep), 4);
    for (size_t run = 1; run <= 4; ++run) {
        weft_scene *scene = NULL;
        ck_assert_int_eq(weft_sweep_scene(sweep, run, &scene, &err), WEFT_OK);
        const weft_contact_def *contact = &weft_scene_cloth(scene)->contact;
        ck_assert(contact->shapes[1].radius == (run <= 2 ? 0.1 : 0.2));
        ck_assert_int_eq(contact->exponent, run % 2 == 1 ? 3 : 10);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
}
END_TEST

/* ---- triangles of a shape ---------------------------------------------------------
 */

#define BALL "contact:\n  shapes:\n    - {shape: sphere, at: [0, -1, 0], radius: 0.4"

START_TEST(a_shape_with_triangles_is_a_mesh)
{
    size_t triangles[3];
    static const char *const of[] = { "true", "0.2", "false" };
    for (size_t i = 0; i < 3; ++i) {
        char text[600];
        (void)snprintf(text, sizeof text,
                       SHEET BALL ", velocity: [0, 1, 0], triangles: %s}\n" END, of[i]);
        weft_scene *scene = good_text(text);
        const weft_shape *shape = &weft_scene_cloth(scene)->contact.shapes[0];
        const bool mesh = strcmp(of[i], "false") != 0;
        ck_assert_int_eq(shape->kind, mesh ? WEFT_MESH : WEFT_SPHERE);
        ck_assert_int_eq(weft_scene_shape_made(scene, 0), mesh);
        ck_assert(shape->velocity[1] == 1.0 && shape->at[1] == -1.0);
        triangles[i] = mesh ? shape->body->triangles : 0;
        weft_scene *again = good_text(weft_scene_text(scene));
        const weft_shape *same = &weft_scene_cloth(again)->contact.shapes[0];
        ck_assert(!mesh
                  || memcmp(same->body->positions, shape->body->positions,
                            3 * shape->body->vertices * sizeof(double))
                         == 0);
        weft_scene_destroy(again);
        weft_scene_destroy(scene);
    }
    ck_assert_uint_gt(triangles[0], triangles[1]);
    ck_assert_uint_gt(triangles[1], 40);
}
END_TEST

START_TEST(triangles_that_cannot_be_are_refused)
{
    static const char *const wrong[][2] = {
        { BALL ", spin: [0, 1, 0], triangles: true}\n", "cannot spin: it turns" },
        { BALL ", triangles: 0}\n",
          "must be true, false or a number > 0 [m], not '0'" },
        { BALL ", triangles: 1.0e-3}\n", "more than 200000: write triangles: 0.0" },
        { "contact:\n  shapes:\n    - {shape: plane, at: [0, -1, 0], normal: [0, 1, "
          "0], "
          "triangles: true}\n",
          "triangles" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        char text[600];
        (void)snprintf(text, sizeof text, SHEET "%s" END, wrong[i][0]);
        weft_scene_def def = scene_of_text(text);
        weft_scene *scene = NULL;
        ck_assert_int_eq(weft_scene_load(&def, &scene, &found, NULL), WEFT_BAD_SCENE);
        ck_assert_uint_eq(found.errors, 1);
        ck_assert_msg(strstr(found.items[0].message, wrong[i][1]) != NULL, "%s",
                      found.items[0].message);
    }
}
END_TEST

/* ---- warnings ------------------------------------------------------------------ */

typedef struct warned {
    const char *text; /* between the sheet and the end */
    const char *end;
    const char *told; /* the first line of what is told; "": nothing */
} warned;

static const warned warnings[] = {
    { "contact: {friction: 0.2}\n", END,
      "scene.yaml:4:10: warning: contact has no effect: it has no shapes, and self is "
      "not "
      "true" },
    { "contact:\n  shapes:\n    - {shape: sphere, at: [0, -1, 0], radius: 0.2}\n", END,
      "scene.yaml:6:7: warning: between particles 0.1 m apart the cloth dips 6.25 mm "
      "into shapes[0], more than the thickness of 5 mm: the shape shows through, "
      "unless it has triangles: true, or the cloth a finer mesh" },
    { "contact:\n  thickness: 6.26e-3\n  shapes:\n    - {shape: sphere, at: [0, -1, "
      "0], radius: 0.2}\n",
      END, "" },
    { "contact:\n  shapes:\n    - {shape: capsule, from: [0, -1, 0], to: [1, -1, 0], "
      "radius: 0.1}\n",
      END,
      "scene.yaml:6:7: warning: between particles 0.1 m apart the cloth dips 12.5 mm "
      "into shapes[0], more than the thickness of 5 mm: the shape shows through, "
      "unless it has triangles: true, or the cloth a finer mesh" },
    { "contact:\n  shapes:\n    - {shape: capsule, from: [0, -1, 0], to: [1, -1, 0], "
      "radius: 0.002}\n",
      END,
      "scene.yaml:6:7: warning: shapes[0] is 4 mm thick and can pass between particles "
      "0.1 m apart, unless it has triangles: true, or the cloth a finer mesh" },
    { "contact:\n  shapes:\n    - {shape: box, at: [0, -1, 0], half: [0.1, 0.1, 0.04], "
      "rounding: 0.03}\n",
      END,
      "scene.yaml:6:7: warning: shapes[0] is 80 mm thick and can pass between "
      "particles "
      "0.1 m apart, unless it has triangles: true, or the cloth a finer mesh" },
    /* sqrt(2) r <= a: a / 2 - (sqrt(2) - 2^(1/4)) r = 41 mm */
    { "contact:\n  shapes:\n    - {shape: box, at: [0, -1, 0], half: [0.1, 0.1, 0.1], "
      "rounding: 0.04}\n",
      END,
      "scene.yaml:6:7: warning: between particles 0.1 m apart the cloth dips 41 mm "
      "into the edges of shapes[0], more than the thickness of 5 mm: the shape shows "
      "through, unless it has triangles: true, or the cloth a finer mesh" },
    /* along x^4 + y^4 = r^4: 2^(1/4) - sqrt(sqrt(2.5) - 0.75) of r = 0.1 m */
    { "contact:\n  shapes:\n    - {shape: box, at: [0, -1, 0], half: [0.2, 0.2, 0.2], "
      "rounding: 0.1}\n",
      END,
      "scene.yaml:6:7: warning: between particles 0.1 m apart the cloth dips 27.8 mm "
      "into the edges of shapes[0], more than the thickness of 5 mm: the shape shows "
      "through, unless it has triangles: true, or the cloth a finer mesh" },
    { "  pins: [top-left, {at: right, velocity: [0, -1, 0]}]\ncontact:\n  shapes:\n    "
      "- {shape: plane, at: [0, -0.5, 0], normal: [0, 1, 0]}\n",
      END,
      "scene.yaml:4:20: warning: pinned particle (0, 5) is inside shapes[0] at t = "
      "0.5015 s: contact does not stop it" },
    /* a later pin holds the particles */
    { "  pins: [{at: right, velocity: [0, -1, 0]}, right]\ncontact:\n  shapes:\n    - "
      "{shape: plane, at: [0, -0.5, 0], normal: [0, 1, 0]}\n",
      END, "" },
    { "  pins: [top-left]\ncontact:\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], "
      "normal: [0, 1, 0], velocity: [0, 1, 0]}\n",
      END,
      "scene.yaml:4:10: warning: pinned particle (0, 0) is inside shapes[0] at t = "
      "0.5015 s: contact does not stop it" },
    { "contact:\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], normal: [0, 1, "
      "0]}\n",
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 5.0e-4}\nrun: "
      "{duration: 2}\n",
      "scene.yaml:7:35: warning: velocity_verlet takes friction explicitly, which "
      "makes large errors of the energy: use a Runge-Kutta method" },
    { "contact:\n  friction: 0\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], "
      "normal: [0, 1, 0]}\n",
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 5.0e-4}\nrun: "
      "{duration: 2}\n",
      "" },
    { "contact:\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], normal: [0, 1, "
      "0]}\n",
      "stepper: {plugin: gsl, method: rk4, fixed_step: 5.1e-4}\nrun: {duration: 2}\n",
      "scene.yaml:7:49: warning: fixed_step 0.000505051 s is longer than "
      "contact.thickness / (2 stopping_speed) = 0.0005 s: steps that may pass "
      "through a surface are rejected and halved" },
    { "contact:\n  law: coulomb\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], "
      "normal: [0, 1, 0], friction: 100}\n",
      END,
      "scene.yaml:7:7: warning: friction 100 of shapes[0] with law coulomb and slip "
      "0.001 m/s needs steps of some 1e-06 s: raise slip, or use law smooth" },
    { "contact:\n  law: coulomb\n  friction: 10\n  shapes:\n    - {shape: plane, at: "
      "[0, -0.5, 0], normal: [0, 1, 0]}\n",
      END, "" },
    { "contact:\n  shapes:\n    - {shape: plane, at: [0, -0.5, 0], normal: [0, 1, 0], "
      "friction: 100}\n",
      END, "" },
};

START_TEST(warnings_have_their_place)
{
    const warned *one = &warnings[_i];
    char text[1024];
    (void)snprintf(text, sizeof text, SHEET "%s%s", one->text, one->end);
    weft_scene_destroy(good_text(text));
    const char *told = all_found();
    const size_t length = strcspn(told, "\n");
    ck_assert_msg(length == strlen(one->told) && strncmp(told, one->told, length) == 0,
                  "%s", told);
    ck_assert_uint_eq(found.count, one->told[0] == '\0' ? 0 : 1);
}
END_TEST

TEST_SUITE(scene_contact)
{
    Suite *suite = suite_create("scene contact");
    TCase *tcase = tcase_create("scene contact");
    tcase_add_test(tcase, defaults_are_those_of_the_library);
    tcase_add_test(tcase, every_key_is_read_and_survives_a_round_trip);
    tcase_add_test(tcase, overrides_reach_shapes);
    tcase_add_test(tcase, sweeps_vary_shapes);
    tcase_add_loop_test(tcase, warnings_have_their_place, 0,
                        (int)(sizeof warnings / sizeof warnings[0]));
    tcase_add_test(tcase, a_shape_with_triangles_is_a_mesh);
    tcase_add_test(tcase, triangles_that_cannot_be_are_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
