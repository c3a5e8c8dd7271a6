/* SPDX-License-Identifier: BSD-3-Clause */
/* test_mesh_files.c -- a scene and the files that it names: what is reported of each,
 * and where. */
#include "scene_load.h"
#include "shell.h"

#define FOLDER BUILD_DIR "/tests/mesh-files"

/* A sheet of 0.1 m that lies 0.1 m above a plate, with a group and room for more lines.
 */
#define SHEET                                                                          \
    "v 0 0 0\nv .1 0 0\nv .1 0 .1\nv 0 0 .1\nvt 0 0\nvt 0 .1\nvt .1 .1\nvt .1 0\n"     \
    "f 1/1 2/2 3/3 4/4\n"
#define PLATE  "v -1 -.1 -1\nv 1 -.1 -1\nv 1 -.1 1\nv -1 -.1 1\nf 4 3 2 1\n"
#define FABRIC "fabric: {density: 0.2, stretch: 80, shear: 20}"

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

/* The scene with a cloth, or cloths, and shapes. What was found is in `found`. */
static weft_scene *load(const char *cloth, const char *shapes)
{
    static char text[4096];
    (void)snprintf(text, sizeof text,
                   "weft: 1\n%s\ncontact: {shapes: [%s]}\n"
                   "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.1}\n",
                   cloth, shapes);
    weft_scene_def def = scene_of_text(text);
    weft_scene *scene = NULL;
    def.file = FOLDER "/test.yaml";
    (void)weft_scene_load(&def, &scene, &found, NULL);
    return scene;
}

static void accepted(const char *cloth, const char *shapes, size_t warnings)
{
    weft_scene *scene = load(cloth, shapes);
    ck_assert_msg(scene != NULL && found.warnings == warnings, "%s", all_found());
    weft_scene_destroy(scene);
}

static void refused(const char *cloth, const char *shapes)
{
    ck_assert_ptr_null(load(cloth, shapes));
    ck_assert_uint_gt(found.errors, 0);
}

/* The i-th diagnostic: a part of its message, its file, line and the text there. */
static void stands(size_t i, const char *message, const char *file, int line,
                   const char *source)
{
    const weft_diagnostic *item = &found.items[i];
    ck_assert_msg(i < found.count && strstr(item->message, message) != NULL, "%s",
                  all_found());
    ck_assert_msg(strcmp(item->place + strlen(FOLDER) + 1, file) == 0, "%s",
                  all_found());
    ck_assert_int_eq(item->line, line);
    ck_assert_str_eq(item->source, source);
}

#define CLOTH "cloth: {mesh: {file: cloth.obj}, " FABRIC "}"
#define CLOTHS                                                                         \
    "cloths: [{name: a, mesh: {file: cloth.obj}, " FABRIC                              \
    "}, {name: b, mesh: {file: cape.obj, at: [0, 1, 0]}, " FABRIC "}]"
#define BODY "{shape: mesh, file: body.obj}"

/* ---- the file of a diagnostic -----------------------------------------------------
 */

START_TEST(a_warning_about_a_cloth_names_its_file_beside_bodies)
{
    put("cloth.obj", SHEET "# 10\n# 11\nv 9 9 9\n");
    put("body.obj", PLATE);
    accepted(CLOTH, BODY, 1);
    stands(0, "vertex 4 (from 0) belongs to no face", "cloth.obj", 12, "v 9 9 9");
}
END_TEST

/* Longer than the body's by much, so that its places are beyond that file's end. */
START_TEST(a_fault_of_a_cloth_names_its_file_beside_bodies)
{
    static char text[200000];
    char *end = text + sprintf(text, "%s", SHEET);
    memset(end, '#', 150000);
    (void)strcpy(end + 150000, "\nf 1/1 2/2 2/2\n");
    put("cloth.obj", text);
    put("body.obj", PLATE);
    refused(CLOTH, BODY);
    stands(0, "corner 2/2 repeats a vertex", "cloth.obj", 11, "f 1/1 2/2 2/2");
}
END_TEST

START_TEST(mistakes_in_every_file_of_a_scene_stand_in_their_own)
{
    put("cloth.obj", "# cloth\n" SHEET "v 7 7 7\n");
    put("cape.obj", "# cape\n# cape\n" SHEET "v 8 8 8\n");
    put("body.obj", PLATE "v 1 2\n");
    put("k-0.obj", PLATE);
    put("k-1.obj", "# key\n" PLATE "f 1 2 9\n");
    refused(CLOTHS, BODY ", {shape: mesh, file: k-%d.obj, fps: 10}");
    ck_assert_uint_eq(found.count, 4);
    stands(0, "vertex 4", "cloth.obj", 11, "v 7 7 7");
    stands(1, "vertex 4", "cape.obj", 12, "v 8 8 8");
    stands(2, "needs x y z", "body.obj", 6, "v 1 2");
    stands(3, "v 9 is not there", "k-1.obj", 7, "f 1 2 9");
}
END_TEST

START_TEST(an_empty_cloth_file_is_named_beside_bodies)
{
    put("cloth.obj", "");
    put("body.obj", PLATE);
    refused(CLOTH, BODY);
    stands(0, "the file has no faces", "cloth.obj", 1, "");
}
END_TEST

TEST_SUITE(mesh_files)
{
    Suite *suite = suite_create("mesh_files");
    TCase *files = tcase_create("files");
    tcase_add_test(files, a_warning_about_a_cloth_names_its_file_beside_bodies);
    tcase_add_test(files, a_fault_of_a_cloth_names_its_file_beside_bodies);
    tcase_add_test(files, mistakes_in_every_file_of_a_scene_stand_in_their_own);
    tcase_add_test(files, an_empty_cloth_file_is_named_beside_bodies);
    suite_add_tcase(suite, files);
    return suite;
}
