/* SPDX-License-Identifier: BSD-3-Clause */
/* test_body_files.c -- meshes in contact.shapes: their OBJ files, and runs with them.
 */
#include "scene_load.h"
#include "shell.h"

#include <math.h>

#define FOLDER BUILD_DIR "/tests/body-files"

static const char plate[] = "v -1 0 -1\\nvn 0 1 0\\nv 1 0 -1\\nv 1 0 1\\nv -1 0 1\\n"
                            "usemtl x\\nf 1//1 2 3/4/5 4\\n";

static void put(const char *name, const char *text)
{
    expect(shell("mkdir -p " FOLDER " && printf '%s' >" FOLDER "/%s", text, name), 0);
}

/* The scene with shapes, which are in a folder. */
static weft_scene *load(const char *shapes)
{
    static char text[2048];
    (void)snprintf(text, sizeof text,
                   "weft: 1\ncloth:\n  grid: {rows: 2, cols: 2, spacing: 0.1, origin: "
                   "[0, 1, 0]}\n  density: 0.2\ncontact:\n  shapes:\n%s"
                   "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.1}\n",
                   shapes);
    weft_scene_def def = scene_of_text(text);
    weft_scene *scene = NULL;
    def.file = FOLDER "/falling.yaml";
    (void)weft_scene_load(&def, &scene, &found, NULL);
    return scene;
}

static void refused(const char *shapes, const char *message, int line)
{
    ck_assert_ptr_null(load(shapes));
    ck_assert_msg(strstr(found.items[0].message, message) != NULL, "%s",
                  found.items[0].message);
    ck_assert_int_eq(found.items[0].line, line);
}

START_TEST(v_and_f_alone_are_read)
{
    put("plate.obj", plate);
    weft_scene *scene = load("    - {shape: mesh, file: plate.obj, unit: 0.5, at: [0, "
                             "-1, 0], friction: 0.7}\n");
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(found.count, 0);
    const weft_shape *shape = weft_scene_cloth(scene)->contact.shapes;
    static const uint32_t corners[] = { 0, 1, 2, 0, 2, 3 };
    ck_assert_int_eq(shape->kind, WEFT_MESH);
    ck_assert_uint_eq(shape->body->vertices, 4);
    ck_assert_uint_eq(shape->body->triangles, 2);
    ck_assert_mem_eq(shape->body->corners, corners, sizeof corners);
    ck_assert(shape->body->positions[0] == -0.5 && shape->at[1] == -1.0);
    ck_assert(shape->friction == 0.7);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(mistakes_have_their_place)
{
    put("plate.obj", plate);
    put("flat.obj", "v 0 0 0\\nv 1 0 0\\nv 2 0 0\\nf 1 2 3\\n");
    put("two.obj", "v 0 0 0\\nv 1 0 0\\nv 2 1 0\\nv 1 2 0\\nv 0 1 0\\nf 1 2\\n");
    put("bare.obj", "v 0 0 0\\nv 1 0 0\\nv 2 1 0\\n");
    put("one-0.obj", plate);
    put("walk-1.obj", plate);
    put("walk-2.obj", "v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n");
    refused("    - {shape: mesh, file: none.obj}\n", "none.obj", 7);
    refused("    - {shape: mesh, file: bare.obj}\n", "no faces (lines 'f 1 2 3')", 1);
    refused("    - {shape: mesh}\n", "lacks the required key 'file'", 7);
    refused("    - {shape: sphere, radius: 1}\n", "lacks the required key 'at'", 7);
    refused("    - {shape: sphere, at: [0, 0, 0], radius: 1, file: a.obj}\n",
            "file does not belong to a sphere", 7);
    refused("    - {shape: mesh, file: flat.obj}\n", "no face of this body has an area",
            4);
    refused("    - {shape: mesh, file: two.obj}\n",
            "a face of 2 corners: it has 3 or more", 6);
    refused("    - {shape: mesh, file: plate.obj, fps: 30}\n", "fps needs key frames",
            7);
    refused("    - {shape: mesh, file: walk-%d.obj}\n", "key frames need fps", 7);
    refused("    - {shape: mesh, file: one-%d.obj, fps: 30}\n",
            "key frames 'one-%d.obj': there are 1 files from 0", 7);
    refused("    - {shape: mesh, file: walk-%d.obj, fps: 30}\n",
            "key frames must have the same", 4);
    refused("    - {shape: mesh, file: plate.obj, spin: [0, 1, 0]}\n",
            "a mesh cannot spin", 7);
    refused("    - {shape: mesh, file: plate.obj, at: [0.03, 0.96, 0.01]}\n",
            "through shapes[0]", 7);
}
END_TEST

/* Through all keys, whose second differences are -2: those of the second derivative
 * times h^2 / 6 are -0.4 at both inner keys. */
START_TEST(key_frames_follow_natural_cubic_splines)
{
    for (int key = 1; key <= 4; ++key) {
        char name[32], text[160];
        (void)snprintf(name, sizeof name, "wave-%03d.obj", key);
        (void)snprintf(text, sizeof text, "v %d 0 0\\nv 1 0 -1\\nv 1 0 1\\nf 1 2 3\\n",
                       -key * key);
        put(name, text);
    }
    weft_scene *scene = load("    - {shape: mesh, file: wave-%03d.obj, fps: 10}\n");
    ck_assert_ptr_nonnull(scene);
    const weft_shape *shape = weft_scene_cloth(scene)->contact.shapes;
    double x[9];
    static const double at[][2]
        = { { -1, -1 },  { 0, -1 },        { 0.05, -2.35 }, { 0.1, -4 }, { 0.15, -6.2 },
            { 0.2, -9 }, { 0.25, -12.35 }, { 0.3, -16 },    { 9, -16 } };
    for (size_t i = 0; i < sizeof at / sizeof at[0]; ++i) {
        weft_shape_vertices(shape, at[i][0], x);
        ck_assert_double_eq_tol(x[0], at[i][1], 1e-12);
    }
    weft_scene_destroy(scene);
}
END_TEST

/* Though keys far away are left out: no jump at a key, and what is straight stays so.
 */
START_TEST(splines_of_many_key_frames_are_continuous)
{
    enum { KEYS = 80 };
    static const uint32_t corners[3] = { 0, 1, 2 };
    double places[KEYS][9] = { { 0.0 } }, x[9], y[9];
    for (int k = 0; k < KEYS; ++k) {
        places[k][0] = k * k % 7, places[k][3] = k, places[k][7] = 1.0;
    }
    const weft_body body = { 3, 1, KEYS, places[0], corners, 8.0 };
    weft_shape shape = weft_shape_default(WEFT_MESH);
    shape.body = &body;
    for (int k = 1; k < KEYS; ++k) {
        weft_shape_vertices(&shape, k / 8.0 - 1e-12, x);
        weft_shape_vertices(&shape, k / 8.0, y);
        ck_assert_double_eq_tol(x[0], y[0], 1e-8);
        ck_assert_double_eq_tol(y[0], places[k][0], 1e-14);
        weft_shape_vertices(&shape, (k - 0.75) / 8.0, y);
        ck_assert_double_eq_tol(y[3], k - 0.75, 1e-8);
    }
}
END_TEST

/* Whichever of its diagonals is the shorter later. */
START_TEST(key_frames_divide_quadrilaterals_as_the_first)
{
    put("kite-0.obj",
        "v 0 0 -2\\nv 1 0 0\\nv 0 0 2\\nv -1 0 0\\nf 1 2 3 4\\nf 4 3 2\\n");
    put("kite-1.obj",
        "v 0 0 -1\\nv 2 0 0\\nv 0 0 1\\nv -2 0 0\\nf 1 2 3 4\\nf 4 3 2\\n");
    weft_scene *scene = load("    - {shape: mesh, file: kite-%d.obj, fps: 10}\n");
    ck_assert_ptr_nonnull(scene);
    const weft_body *body = weft_scene_cloth(scene)->contact.shapes[0].body;
    static const uint32_t corners[] = { 1, 2, 3, 1, 3, 0, 3, 2, 1 };
    ck_assert_uint_eq(body->keys, 2);
    ck_assert_uint_eq(body->triangles, 3);
    ck_assert_mem_eq(body->corners, corners, sizeof corners);
    weft_scene_destroy(scene);
    put("kite-1.obj",
        "v 0 0 -1\\nv 2 0 0\\nv 0 0 1\\nv -2 0 0\\nf 4 1 2 3\\nf 4 3 2\\n");
    refused("    - {shape: mesh, file: kite-%d.obj, fps: 10}\n",
            "differs from the first", 5);
}
END_TEST

START_TEST(a_run_can_be_repeated_from_its_results)
{
    put("plate.obj", plate);
    put("up-0.obj", plate);
    put("up-1.obj", "v -1 0.02 -1\\nv 1 0.02 -1\\nv 1 0 1\\nv -1 0 1\\nf 1 2 3 4\\n");
    expect(
        shell("cd " FOLDER " && rm -rf a b c && cat >fall.yaml <<'end'\n"
              "weft: 1\ncloth:\n  grid: {rows: 4, cols: 4, spacing: 0.05, origin: [0, "
              "0.03, 0], down: [0, 0, 1]}\n  density: 0.2\n  springs: {stretch: "
              "{stiffness: 20, damping: 0.02}}\ncontact:\n  shapes:\n"
              "    - {shape: mesh, file: up-%%d.obj, fps: 10}\n"
              "    - {shape: mesh, file: plate.obj, at: [0, -0.1, 0], velocity: [0, "
              "0.2, 0]}\n"
              "stepper: {plugin: arkode, method: dormand_prince}\n"
              "run: {duration: 0.2, checkpoint: 1, keep_checkpoint: true}\nend\n"),
        0);
    expect(shell("cd " FOLDER
                 " && ../../weft run fall.yaml --quiet --out a 2>&1 && ../../weft run "
                 "fall.yaml --quiet --out b --set run.duration=0.1 2>&1 && rm *.obj "
                 "&& ../../weft resume b --until 0.2 --quiet 2>&1 && ../../weft run "
                 "a/scene.yaml --quiet --out c 2>&1 && cmp a/final.csv b/final.csv "
                 "&& cmp a/final.csv c/final.csv && cmp a/shapes.csv c/shapes.csv"),
           0);
    expect(shell("cd " FOLDER
                 " && ../../weft export a --format obj --frame 2 2>&1 && grep -c "
                 "'^f' a/frames/frame-000002-shape-0.obj"),
           0);
    expect(shell("cd " FOLDER
                 " && sed -i 's/v -1 0 -1/v -1 0.01 -1/' b/scene-shape1.obj "
                 "&& ../../weft resume b --until 0.3 --quiet 2>&1"),
           3);
}
END_TEST

/* Up by 0.3 m from key 2 to key 3, of six: by SciPy's CubicSpline, 32.8 mm too far. */
START_TEST(keys_that_a_vertex_swings_beyond_are_warned_of)
{
    for (int key = 0; key < 6; ++key) {
        char name[32], text[160];
        const double y = key < 3 ? -0.5 : -0.2;
        (void)snprintf(name, sizeof name, "lift-%d.obj", key);
        (void)snprintf(text, sizeof text, "v 0 %g 0\\nv 1 %g 0\\nv 0 %g 1\\nf 1 2 3\\n",
                       y, y, y);
        put(name, text);
    }
    expect(
        shell("cd " FOLDER " && cat >lift.yaml <<'end'\n"
              "weft: 1\ncloth:\n  grid: {rows: 3, cols: 3, spacing: 0.05}\n  density: "
              "0.2\n  springs: {stretch: {stiffness: 20}}\ncontact:\n  thickness: "
              "0.01\n  shapes: [{shape: mesh, file: lift-%%d.obj, fps: 10}]\n"
              "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.5}\nend\n"
              "../../weft check lift.yaml 2>&1 >/dev/null"),
        0);
    says(
        "shapes[0]: between keys 3 and 4, at 0.3384 s, vertex 0 swings 32.8 mm beyond");
    expect(shell("cd " FOLDER " && ../../weft check lift.yaml --set "
                 "contact.thickness=0.033 2>&1 >/dev/null"),
           0);
    ck_assert_str_eq(output, "");
}
END_TEST

TEST_SUITE(body_files)
{
    Suite *suite = suite_create("body_files");
    TCase *tcase = tcase_create("files");
    tcase_set_timeout(tcase, 60.0);
    tcase_add_test(tcase, v_and_f_alone_are_read);
    tcase_add_test(tcase, mistakes_have_their_place);
    tcase_add_test(tcase, key_frames_follow_natural_cubic_splines);
    tcase_add_test(tcase, splines_of_many_key_frames_are_continuous);
    tcase_add_test(tcase, key_frames_divide_quadrilaterals_as_the_first);
    tcase_add_test(tcase, a_run_can_be_repeated_from_its_results);
    tcase_add_test(tcase, keys_that_a_vertex_swings_beyond_are_warned_of);
    suite_add_tcase(suite, tcase);
    return suite;
}
