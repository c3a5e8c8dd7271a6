/* SPDX-License-Identifier: BSD-3-Clause */
/* test_space_scenes.c -- scenes whose meshes rest where they start: keys, mistakes and
 * warnings, cloths of both kinds, and contact of such a cloth with itself. */
#include "scene_load.h"
#include "shell.h"

#include <math.h>

#define FOLDER BUILD_DIR "/tests/space-scenes"

/* A roof of two squares at a right angle, without vt. */
#define ROOF                                                                           \
    "v 0 0 0\nv .1 0 0\nv 0 .1 0\nv .1 .1 0\nv 0 .1 .1\nv .1 .1 .1\n"                  \
    "f 1 2 4 3\nf 3 4 6 5\n"
#define ALIKE "fabric: {density: 0.2, stretch: 80, shear: 40, coupling: 0}"
#define WOVEN                                                                          \
    "fabric: {density: 0.2, stretch: [80, 50], shear: 20, bend: [4.0e-5, 2.0e-5]}"

static void put(const char *name, const char *text)
{
    char path[256];
    expect(shell("mkdir -p " FOLDER), 0);
    (void)snprintf(path, sizeof path, "%s/%s", FOLDER, name);
    FILE *stream = fopen(path, "w");
    ck_assert_ptr_nonnull(stream);
    (void)fputs(text, stream);
    ck_assert_int_eq(fclose(stream), 0);
}

static weft_scene *load(const char *cloth, size_t refine)
{
    static char text[4096];
    (void)snprintf(text, sizeof text,
                   "weft: 1\n%s\nstepper: {plugin: gsl, method: rkf45}\n"
                   "run: {duration: 0.1}\n",
                   cloth);
    weft_scene_def def = scene_of_text(text);
    weft_scene *scene = NULL;
    def.file = FOLDER "/test.yaml";
    def.refine = refine;
    (void)weft_scene_load(&def, &scene, &found, NULL);
    return scene;
}

/* `words` are in what was found: nothing if NULL, a warning, or an error. */
static void check_says(const char *cloth, const char *words, bool error)
{
    put("roof.obj", ROOF);
    weft_scene *scene = load(cloth, 1);
    ck_assert_msg((scene == NULL) == error, "%s", all_found());
    ck_assert_uint_eq(found.warnings, words != NULL && !error);
    ck_assert_uint_eq(found.errors, error);
    ck_assert_msg(words == NULL || strstr(all_found(), words) != NULL, "%s",
                  all_found());
    weft_scene_destroy(scene);
}

static const struct {
    const char *cloth, *words;
    bool error;
} scenes_said[] = {
    { "cloth: {mesh: {file: roof.obj, rest: start}, " ALIKE "}", NULL, false },
    { "cloth: {mesh: {file: roof.obj, rest: start, warp: [1, 0, 0]}, " WOVEN "}", NULL,
      false },
    { "cloth: {mesh: {file: roof.obj, rest: start, angle: flat}, " ALIKE "}",
      "angle: flat bends 1 edges open that start folded by more than 60 degrees, by 90",
      false },
    { "cloth: {mesh: {file: roof.obj, rest: start}, " WOVEN "}",
      "no warp: the fabric is taken alike in all directions (stretch 63.75, shear "
      "21.25, bend ",
      false },
    { "cloth: {mesh: {file: roof.obj, rest: start, warp: [0, 1, 0]}, " WOVEN "}",
      "warp is within 17 degrees of the normal of 2 of 4 triangles: blended there",
      false },
    { "cloth: {mesh: {file: roof.obj, rest: start, warp: [0, 0, 0]}, " ALIKE "}",
      "warp is [0, 0, 0], which is no direction", true },
    { "cloth: {mesh: {file: roof.obj, rest: start}, seams: hinge, " ALIKE "}",
      "rest: start has no panels: seams has nothing to act on", true },
    { "cloth: {mesh: {file: roof.obj, rest: start, angle: bent}, " ALIKE "}",
      "angle must be flat or start, not 'bent'", true },
};

START_TEST(keys_mistakes_and_warnings)
{
    check_says(scenes_said[_i].cloth, scenes_said[_i].words, scenes_said[_i].error);
}
END_TEST

START_TEST(warp_needs_a_shape_in_space)
{
    put("sheet.obj", "v 0 0 0\nv .1 0 0\nv 0 .1 0\nvt 0 0\nvt .1 0\nvt 0 .1\n"
                     "f 1/1 2/2 3/3\n");
    ck_assert_ptr_null(
        load("cloth: {mesh: {file: sheet.obj, warp: [0, 1, 0]}, " ALIKE "}", 1));
    ck_assert_ptr_nonnull(strstr(
        all_found(), "warp needs rest: start; in the plane the warp lies along v"));
    ck_assert_ptr_null(load(
        "cloth: {mesh: {file: sheet.obj, rest: start, warp: [0, 0, 1]}, " ALIKE "}",
        1));
    ck_assert_ptr_nonnull(strstr(all_found(), "is normal to the cloth"));
}
END_TEST

START_TEST(flat_angles_are_not_refined)
{
    put("roof.obj", ROOF);
    ck_assert_ptr_null(load(
        "cloth: {mesh: {file: roof.obj, rest: start, angle: flat}, " ALIKE "}", 2));
    ck_assert_ptr_nonnull(strstr(all_found(), "is not refined"));
    weft_scene *scene
        = load("cloth: {mesh: {file: roof.obj, rest: start}, " ALIKE "}", 2);
    ck_assert_msg(scene != NULL, "%s", all_found());
    ck_assert_uint_eq(weft_scene_cloth(scene)->mesh->triangles, 16);
    weft_scene_destroy(scene);
}
END_TEST

/* With vt, the angles are of a start that is 1.2 times as long. */
START_TEST(angles_of_a_stretched_start_are_warned_of)
{
    put("sheet.obj", "v 0 0 0\nv .12 0 0\nv 0 .1 0\nv .12 .1 .02\nvt 0 0\nvt .1 0\n"
                     "vt 0 .1\nvt .1 .1\nf 1/1 2/2 4/4 3/3\n");
    weft_scene *scene
        = load("cloth: {mesh: {file: sheet.obj, angle: start}, " ALIKE "}", 1);
    ck_assert_msg(scene != NULL && found.warnings == 1, "%s", all_found());
    ck_assert_ptr_nonnull(strstr(all_found(), "start more than 1 % longer or shorter"));
    weft_scene_destroy(scene);
}
END_TEST

/* One cloth in the plane, half as large there as it starts, and one in space. */
START_TEST(cloths_of_both_kinds_stand_together)
{
    put("roof.obj", ROOF);
    put("sheet.obj", "v 0 0 1\nv .1 0 1\nv 0 .1 1\nv .1 .1 1\nvt 0 0\nvt .095 0\n"
                     "vt 0 .1\nvt .095 .1\nf 1/1 2/2 4/4 3/3\n");
    weft_scene *scene
        = load("cloths: [{name: a, mesh: {file: sheet.obj}, " ALIKE
               "}, {name: b, mesh: {file: roof.obj, rest: start}, " ALIKE "}]",
               1);
    ck_assert_msg(scene != NULL, "%s", all_found());
    weft_cloth *cloth = test_cloth(weft_scene_cloth(scene));
    double mass[2] = { 0.0, 0.0 };
    for (size_t v = 0; v < 10; ++v) {
        mass[v / 4 > 0] += weft_cloth_particle_mass(cloth, v);
    }
    ck_assert_double_eq_tol(mass[0], 0.2 * 0.0095, 1e-12);
    ck_assert_double_eq_tol(mass[1], 0.2 * 0.02, 1e-12);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
}
END_TEST

/* ---- contact with itself -----------------------------------------------------------
 */

/* A strip of cells of 2 cm that is folded in the middle: its halves are so many degrees
 * apart. */
static void put_strip(double apart)
{
    static char text[8192];
    size_t at = 0;
    const double half = apart * 3.14159265358979323846 / 360.0;
    for (size_t i = 0; i < 39; ++i) {
        const double s = 0.02 * ((double)(i / 3) - 6.0);
        at += (size_t)snprintf(text + at, sizeof text - at, "v %.17g %.17g %.17g\n",
                               fabs(s) * cos(half), s * sin(half),
                               0.02 * (double)(i % 3));
    }
    for (size_t k = 0; k < 24; ++k) {
        const size_t i = k / 2 * 3 + k % 2 + 1;
        at += (size_t)snprintf(text + at, sizeof text - at, "f %zu %zu %zu %zu\n", i,
                               i + 1, i + 4, i + 3);
    }
    put("strip.obj", text);
}

static double contact_energy(double apart)
{
    put_strip(apart);
    weft_scene *scene = load("cloth: {mesh: {file: strip.obj, rest: start}, " ALIKE
                             "}\ncontact: {thickness: 6.5e-3, self: true}",
                             1);
    ck_assert_msg(scene != NULL, "%s", all_found());
    weft_cloth *cloth = test_cloth(weft_scene_cloth(scene));
    double *y = calloc(weft_cloth_dim(cloth), sizeof *y);
    weft_cloth_start(cloth, y);
    const double energy = weft_cloth_energy(cloth, 0.0, y).contact;
    free(y);
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
    return energy;
}

/* 4 cm from the fold the halves are 2.1 mm apart, or 9.1 mm; 2 cm from it, in the
 * second case, 4.5 mm, but two edges join them there. */
START_TEST(layers_at_rest_touch_and_neighbours_do_not)
{
    ck_assert_double_gt(contact_energy(3.0), 0.0);
    ck_assert_double_eq(contact_energy(13.0), 0.0);
}
END_TEST

TEST_SUITE(space_scenes)
{
    Suite *suite = suite_create("space_scenes");
    TCase *tc = tcase_create("space_scenes");
    tcase_add_loop_test(tc, keys_mistakes_and_warnings, 0,
                        sizeof scenes_said / sizeof scenes_said[0]);
    tcase_add_test(tc, warp_needs_a_shape_in_space);
    tcase_add_test(tc, flat_angles_are_not_refined);
    tcase_add_test(tc, angles_of_a_stretched_start_are_warned_of);
    tcase_add_test(tc, cloths_of_both_kinds_stand_together);
    tcase_add_test(tc, layers_at_rest_touch_and_neighbours_do_not);
    suite_add_tcase(suite, tc);
    return suite;
}
