/* SPDX-License-Identifier: BSD-3-Clause */
/* test_mesh_files.c -- a scene and the files that it names: what is reported of each,
 * and where. */
#include "scene_load.h"
#include "shell.h"

#include <math.h>

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
                   cloth,
                   shapes[0] != '\0'
                       ? shapes
                       : "{shape: plane, at: [0, -90, 0], normal: [0, 1, 0]}");
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

/* ---- where a cloth starts ----------------------------------------------------------
 */

/* A square of a side [m], whose vt are those of another side. */
static void put_square(double side, double rest)
{
    char text[512];
    (void)snprintf(text, sizeof text,
                   "v 0 0 0\nv %g 0 0\nv %g 0 %g\nv 0 0 %g\nvt 0 0\nvt 0 %g\nvt %g %g\n"
                   "vt %g 0\nf 1/1 2/2 3/3 4/4\n",
                   side, side, side, side, rest, rest, rest, rest);
    put("cloth.obj", text);
}

static void warned(const char *message)
{
    accepted(CLOTH, "", 1);
    ck_assert_msg(strstr(found.items[0].message, message) != NULL, "%s", all_found());
}

START_TEST(texture_coordinates_taken_for_lengths_are_warned_of)
{
    put_square(0.05, 1.0);
    warned(
        "the cloth starts at 0.05 times its rest shape (sqrt of the areas, median of "
        "2 triangles); vt from 0 to 1 are likely texture coordinates");
    ck_assert_ptr_nonnull(strstr(found.items[0].message, "here each times 0.05"));
    ck_assert_int_eq(found.items[0].line, 2); /* of the scene, at the file */
    put_square(3.0, 1.0);
    warned("the cloth starts at 3 times its rest shape");
}
END_TEST

START_TEST(v_and_vt_in_different_units_are_warned_of)
{
    put_square(0.5, 50.0);
    warned(
        "v and vt are likely in different units: write vt as lengths in the unit of v, "
        "here each times 0.01");
    put_square(500.0, 0.5); /* v in mm */
    accepted(CLOTH, "", 2);
    ck_assert_msg(strstr(all_found(), "v and vt are likely in different units: write "
                                      "vt as lengths in the unit of v, here each times "
                                      "1000")
                      != NULL,
                  "%s", all_found());
}
END_TEST

START_TEST(a_start_near_its_rest_shape_gets_no_warning)
{
    static const double ratios[] = { 0.81, 0.9, 1.0, 1.21, 1.24 };
    for (size_t i = 0; i < sizeof ratios / sizeof *ratios; ++i) {
        put_square(0.5 * ratios[i], 0.5);
        accepted(CLOTH, "", 0);
    }
    put_square(0.5 * 0.79, 0.5);
    warned("the cloth starts at 0.79 times");
    put_square(0.5 * 1.26, 0.5);
    warned("the cloth starts at 1.26 times");
}
END_TEST

START_TEST(the_stretch_of_a_start_has_its_least_median_and_largest)
{
    /* one triangle as it is, one sheared, one twice as long in one direction */
    put("cloth.obj",
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 3 0 0\nv 4 0 0\nv 3.5 1 0\nv 6 0 0\n"
        "v 8 0 0\nv 6 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 2/1 3/2 4/3\nf 5/1 6/2 7/3\n"
        "f 8/1 9/2 10/3\n");
    weft_scene *scene = load(CLOTH, "");
    weft_stretch of;
    ck_assert_ptr_nonnull(scene);
    ck_assert_int_eq(weft_cloth_def_stretch(weft_scene_cloth(scene), 0, &of, NULL),
                     WEFT_OK);
    const double shear = 0.25 + sqrt(1.0 + 0.25 * 0.25); /* (1 s; 0 1), s = 1/2 */
    ck_assert_double_eq_tol(of.least, 1.0 / shear, 1e-15);
    ck_assert_double_eq_tol(of.largest, 2.0, 1e-15);
    ck_assert_double_eq_tol(of.median, 1.0, 1e-15);
    ck_assert_uint_eq(of.triangles, 3);
    static const size_t sheared[] = { 4, 5, 6 }, longer[] = { 7, 8, 9 };
    ck_assert_mem_eq(of.least_at, sheared, sizeof sheared);
    ck_assert_mem_eq(of.largest_at, longer, sizeof longer);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_scale_far_from_1_is_warned_of_and_is_the_stretch)
{
    static const char grid[]
        = "cloth: {grid: {rows: 3, cols: 3, spacing: 0.1, scale: %s}, density: 0.2}";
    char text[256];
    weft_stretch of;
    (void)snprintf(text, sizeof text, grid, "1.5");
    weft_scene *scene = load(text, "");
    ck_assert_uint_eq(found.warnings, 1);
    ck_assert_str_eq(
        found.items[0].message,
        "the cloth starts at 1.5 times its rest lengths: scale: 1.0 starts "
        "it at rest; another unit belongs in spacing");
    ck_assert_int_eq(weft_cloth_def_stretch(weft_scene_cloth(scene), 0, &of, NULL),
                     WEFT_OK);
    ck_assert(of.least == 1.5 && of.median == 1.5 && of.largest == 1.5);
    weft_scene_destroy(scene);
    (void)snprintf(text, sizeof text, grid, "1.25");
    accepted(text, "", 0);
}
END_TEST

START_TEST(a_cloth_in_another_unit_gets_a_hint)
{
    put_square(21.0, 21.0);
    warned(
        "the cloth has a size of 21 m: unit is the length of one unit of the file [m], "
        "1 now; with unit: 0.01 the cloth would have 0.21 m");
    put_square(0.0019, 0.0019);
    warned("the cloth has a size of 0.0019 m: unit is");
    put_square(19.0, 19.0);
    accepted(CLOTH, "", 0);
    accepted("cloth: {grid: {rows: 3, cols: 3, spacing: 20}, density: 0.2}", "", 1);
    ck_assert_str_eq(found.items[0].message,
                     "the cloth has a size of 40 m: lengths are in metres");
}
END_TEST

START_TEST(a_body_in_another_unit_gets_a_hint_but_a_floor_does_not)
{
    put_square(0.1, 0.1);
    put("body.obj", "v -50 -50 -50\nv 50 -50 -50\nv 50 -51 90\nv -50 -90 50\n"
                    "f 4 3 2 1\n");
    accepted(CLOTH, BODY, 1);
    ck_assert_msg(
        strstr(found.items[0].message, "the body has a size of 140 m: unit is") != NULL,
        "%s", all_found());
    put("body.obj",
        "v -50 -.1 -50\nv 50 -.1 -50\nv 50 -.1 50\nv -50 -.2 50\nf 4 3 2 1\n");
    accepted(CLOTH, BODY, 0);
}
END_TEST

START_TEST(vertices_that_start_in_one_place_are_counted)
{
    put("cloth.obj",
        "v 0 0 0\nv .1 0 0\nv .1 .1 0\nv 0 .1 0\nv .1 0 0\nv .2 0 0\nv .2 .1 0\n"
        "v .1 .1 0\nvt 0 0\nvt .1 0\nvt .1 .1\nvt 0 .1\nvt .2 0\nvt .2 .1\n"
        "f 1/1 2/2 3/3 4/4\nf 5/2 6/5 7/6 8/3\n");
    accepted(CLOTH, "", 1);
    stands(
        0,
        "vertex 4 (from 0) starts where vertex 1 does and is not sewn to it, the first "
        "of 2 such vertices: 'weld: 0' makes one of vertices that coincide",
        "cloth.obj", 5, "v .1 0 0");
}
END_TEST

START_TEST(slivers_of_a_file_are_warned_of_with_their_number)
{
    put("cloth.obj", "v 0 0 0\nv 1 0 0\nv .5 .01 0\nv .5 .9 0\nvt 0 0\nvt 1 0\n"
                     "vt .5 .01\nvt .5 .9\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    accepted(CLOTH, "", 1);
    stands(0, "an angle of 1.1 degrees at rest; 1 of 2 triangles have one below 15",
           "cloth.obj", 9, "f 1/1 2/2 3/3");
}
END_TEST

/* ---- key frames --------------------------------------------------------------------
 */

START_TEST(a_gap_in_key_frames_is_an_error_that_names_it)
{
    put_square(0.1, 0.1);
    expect(shell("rm -f " FOLDER "/gap-*.obj"), 0);
    put("gap-00.obj", PLATE);
    put("gap-01.obj", PLATE);
    accepted(CLOTH, "{shape: mesh, file: gap-%02d.obj, fps: 10}", 0);
    put("gap-3.obj", PLATE); /* by no pattern of two digits */
    accepted(CLOTH, "{shape: mesh, file: gap-%02d.obj, fps: 10}", 0);
    put("gap-12.obj", PLATE);
    put("gap-07.obj", PLATE);
    refused(CLOTH, "{shape: mesh, file: gap-%02d.obj, fps: 10}");
    ck_assert_str_eq(found.items[0].message,
                     "key frame 02 of 'gap-%02d.obj' is missing, but 07 is there: key "
                     "frames are numbered one after another");
}
END_TEST

START_TEST(a_gap_in_folders_of_key_frames_is_an_error)
{
    put_square(0.1, 0.1);
    expect(shell("cd " FOLDER " && mkdir -p at-1 at-2 at-4"), 0);
    put("at-1/k.obj", PLATE);
    put("at-2/k.obj", PLATE);
    put("at-4/k.obj", PLATE);
    refused(CLOTH, "{shape: mesh, file: at-%d/k.obj, fps: 10}");
    ck_assert_str_eq(
        found.items[0].message,
        "key frame 3 of 'at-%d/k.obj' is missing, but 4 is there: key frames "
        "are numbered one after another");
}
END_TEST

START_TEST(check_and_run_print_the_stretch_and_the_span_of_the_keys)
{
    put_square(0.55, 0.5);
    put("key-0.obj", PLATE);
    put("key-1.obj", PLATE);
    put("key-2.obj", PLATE);
    put("keys.yaml",
        "weft: 1\n" CLOTH "\ncontact: {shapes: [{shape: mesh, file: key-%d.obj, fps: "
        "20}]}\nstepper: {plugin: arkode, method: dormand_prince}\n"
        "run: {duration: 0.05, fps: 20}\n");
    expect(
        shell(
            "cd " FOLDER " && ../../weft check keys.yaml >check.txt && rm -rf out && "
            "../../weft run keys.yaml --out out >run.txt 2>/dev/null && grep -h -A1 "
            "-e stretch -e 'keys ' check.txt run.txt | tr -s ' ' | grep -c -e 'stretch "
            "1.1 to 1.1 of the rest lengths at the start, median 1.1;' -e 'shapes.0.: "
            "3 "
            "key frames, 0 to 0.1 s, in a run of 0.05 s; 1 come' | grep -x 4"),
        0);
    put_square(0.5, 0.5);
    expect(shell("cd " FOLDER " && ../../weft check keys.yaml | grep stretch"), 0);
    ck_assert_str_eq(output,
                     "  stretch    none: the cloth starts with its rest lengths\n");
}
END_TEST

/* ---- statements, marks and faces of real files -------------------------------------
 */

START_TEST(a_byte_order_mark_is_no_part_of_the_first_statement)
{
    put("cloth.obj", "\xEF\xBB\xBF" SHEET);
    accepted(CLOTH, "", 0);
    put("cloth.obj", "\xEF\xBB\xBFv 0 0 x\n" SHEET);
    refused(CLOTH, "");
    stands(0, "'x' is not a finite decimal number", "cloth.obj", 1, "v 0 0 x");
}
END_TEST

static void put_bytes(const char *name, const char *bytes, size_t size)
{
    put(name, "");
    FILE *stream = fopen(FOLDER "/cloth.obj", "w");
    ck_assert(stream != NULL && fwrite(bytes, 1, size, stream) == size);
    ck_assert_int_eq(fclose(stream), 0);
}

START_TEST(nul_bytes_behind_the_text_do_not_matter)
{
    static const char text[] = SHEET "\0\0"; /* and a third */
    static const char within[] = SHEET "v 1\0 2 3\n";
    static const char wide[] = "\xFF\xFEv\0 \0001\0";
    put_bytes("cloth.obj", text, sizeof text);
    accepted(CLOTH, "", 0);
    put_bytes("cloth.obj", within, sizeof within - 1);
    refused(CLOTH, "");
    stands(0, "a NUL byte: this is not the text of an OBJ file", "cloth.obj", 10,
           "v 1? 2 3");
    put_bytes("cloth.obj", wide, sizeof wide - 1);
    refused(CLOTH, "");
    ck_assert_ptr_nonnull(strstr(found.items[0].message, "it looks like UTF-16"));
}
END_TEST

START_TEST(lines_may_end_with_cr_alone)
{
    char text[] = SHEET;
    for (char *at = text; (at = strchr(at, '\n')) != NULL;) {
        *at = '\r';
    }
    put("cloth.obj", text);
    accepted(CLOTH, "", 0);
    put_bytes("cloth.obj", text, sizeof text); /* with a NUL, which does not count */
    accepted(CLOTH, "", 0);
    text[sizeof text - 1] = '\n'; /* as a shell ends them */
    put_bytes("cloth.obj", text, sizeof text);
    accepted(CLOTH, "", 0);
}
END_TEST

START_TEST(unknown_statements_are_warned_of_once)
{
    put("cloth.obj", SHEET "vn 0 1 0\no x\ns off\nl 1 2\nmtllib a.mtl\n# e\n\n");
    accepted(CLOTH, "", 0);
    put("cloth.obj", SHEET "stitch 1 2\ne 1 2\nnl 3\n");
    put("body.obj", "V 1 2 3\n" PLATE);
    accepted(CLOTH, BODY, 2);
    stands(0,
           "'stitch' is no statement that weft reads, and is left out, the first of 3 "
           "lines",
           "cloth.obj", 10, "stitch 1 2");
    stands(1, "'V' is no statement that weft reads, and is left out", "body.obj", 1,
           "V 1 2 3");
}
END_TEST

/* The only shape, whose body is returned. */
static const weft_body *body_of(const weft_scene *scene)
{
    ck_assert_msg(scene != NULL, "%s", all_found());
    return weft_scene_cloth(scene)->contact.shapes[0].body;
}

START_TEST(faces_of_a_body_with_many_corners_are_fans)
{
    static const uint32_t corners[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 1, 0, 6 };
    put("cloth.obj", SHEET);
    put("body.obj", "v 1 -1 0\nv 1 -1 1\nv 0 -1 2\nv -1 -1 1\nv -1 -1 0\nv 0 -1 -1\n"
                    "v 2 -1 0\nf 1 2 3 4 5 6\nf 2 1 7\n");
    weft_scene *scene = load(CLOTH, BODY);
    const weft_body *body = body_of(scene);
    ck_assert_uint_eq(found.count, 0);
    ck_assert_uint_eq(body->triangles, 5);
    ck_assert_mem_eq(body->corners, corners, sizeof corners);
    weft_scene_destroy(scene);
}
END_TEST

/* An arrow head, whose wings are nearer to one another than its tip to its notch, from
 * each of its corners; and a bow tie, which no line divides. */
START_TEST(a_concave_quadrilateral_of_a_body_is_divided_inside_of_it)
{
    static const char *const faces[] = { "f 1 2 3 4\n", "f 2 3 4 1\n", "f 4 3 2 1\n" };
    put("cloth.obj", SHEET);
    for (size_t i = 0; i < 3; ++i) {
        char text[128];
        (void)snprintf(text, sizeof text,
                       "v 0 -1 1\nv -.1 -1 0\nv 0 -1 .2\nv .1 -1 0\n%s", faces[i]);
        put("body.obj", text);
        weft_scene *scene = load(CLOTH, BODY);
        const weft_body *body = body_of(scene);
        ck_assert_uint_eq(found.count, 0);
        ck_assert_uint_eq(body->triangles, 2);
        for (size_t t = 0; t < 2; ++t) { /* none has both wings */
            const uint32_t *v = &body->corners[3 * t];
            ck_assert_uint_ne(v[0] % 2 + v[1] % 2 + v[2] % 2, 2);
        }
        weft_scene_destroy(scene);
    }
    put("body.obj", "v 0 -1 0\nv 1 -1 0\nv 0 -1 1\nv 1 -1 2\nf 1 2 3 4\n");
    weft_scene *scene = load(CLOTH, BODY);
    ck_assert_ptr_nonnull(scene);
    stands(0, "1 face of this body, the first here, is concave", "body.obj", 5,
           "f 1 2 3 4");
    weft_scene_destroy(scene);
}
END_TEST

/* A square with a notch: the second fan covers it. */
START_TEST(concave_faces_of_a_body_are_warned_of)
{
    put("cloth.obj", SHEET);
    put("body.obj", "v 0 -1 0\nv 1 -1 0\nv 1 -1 1\nv .5 -1 .1\nv 0 -1 1\n"
                    "f 4 5 1 2 3\nf 1 2 3 4 5\n");
    weft_scene *scene = load(CLOTH, BODY);
    ck_assert_ptr_nonnull(scene);
    ck_assert_uint_eq(found.count, 1);
    stands(0,
           "1 face of this body, the first here, is concave: the triangles that weft "
           "makes of it go beyond its outline; triangulate the mesh on export",
           "body.obj", 7, "f 1 2 3 4 5");
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_corner_that_a_face_of_a_body_repeats_adds_nothing)
{
    static const uint32_t corners[] = { 0, 1, 2, 0, 2, 3 };
    put("cloth.obj", SHEET);
    put("body.obj", "v 1 -1 0\nv 1 -1 1\nv 0 -1 2\nv -1 -1 1\nf 1 1 2\nf 1 2 2 3 1\n"
                    "f 1 3 4 4 4\n");
    weft_scene *scene = load(CLOTH, BODY);
    const weft_body *body = body_of(scene);
    ck_assert_uint_eq(body->triangles, 2);
    ck_assert_mem_eq(body->corners, corners, sizeof corners);
    ck_assert_uint_eq(found.count, 1);
    stands(0, "1 triangle of this body has no area, the first here, and is left out",
           "body.obj", 5, "f 1 1 2");
    weft_scene_destroy(scene);
}
END_TEST

/* Vertices 1 and 4 (from 0) are of flat triangles alone. */
START_TEST(triangles_of_a_body_without_area_are_left_out_with_their_vertices)
{
    static const uint32_t corners[] = { 0, 1, 2 };
    static const double places[] = { 0, -1, 0, 0, -1, 1, 1, -1, 1 };
    put("cloth.obj", SHEET);
    put("body.obj", "v 0 -1 0\nv 5 -1 0\nv 0 -1 1\nv 1 -1 1\nv 9 -1 0\nf 1 2 5\n"
                    "f 1 3 4\nf 1 5 2\n");
    weft_scene *scene = load(CLOTH, BODY);
    const weft_body *body = body_of(scene);
    ck_assert_uint_eq(body->triangles, 1);
    ck_assert_uint_eq(body->vertices, 3);
    ck_assert_mem_eq(body->corners, corners, sizeof corners);
    ck_assert_mem_eq(body->positions, places, sizeof places);
    stands(0, "2 triangles of this body have no area, the first here, and are left out",
           "body.obj", 6, "f 1 2 5");
    weft_scene_destroy(scene);
    put("body.obj", "v 0 -1 0\nv 5 -1 0\nv 9 -1 0\nf 1 2 3\n");
    refused(CLOTH, BODY);
    stands(0, "no face of this body has an area", "body.obj", 4, "f 1 2 3");
}
END_TEST

START_TEST(a_triangle_that_is_flat_at_one_key_is_left_out_at_all)
{
    static const double places[]
        = { 0, -1, 0, 0, -1, 1, 1, -1, 1, 0, -2, 0, 0, -2, 1, 1, -2, 1 };
    put("cloth.obj", SHEET);
    put("flat-0.obj", "v 9 -1 0\nv 0 -1 0\nv 0 -1 1\nv 1 -1 1\nf 2 3 4\nf 1 2 4\n");
    put("flat-1.obj", "v 0 -2 0\nv 0 -2 0\nv 0 -2 1\nv 1 -2 1\nf 2 3 4\nf 1 2 4\n");
    weft_scene *scene = load(CLOTH, "{shape: mesh, file: flat-%d.obj, fps: 10}");
    const weft_body *body = body_of(scene);
    ck_assert_uint_eq(body->triangles, 1);
    ck_assert_uint_eq(body->vertices, 3);
    ck_assert_mem_eq(body->positions, places, sizeof places);
    stands(0,
           "1 triangle of this body has no area, the first here, and is left out of "
           "every key frame",
           "flat-1.obj", 6, "f 1 2 4");
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(every_face_of_a_cloth_with_many_corners_is_named)
{
    put("cloth.obj", SHEET "v 5 5 5\nf 1/1 2/2 3/3 4/4 5/1\nf 1/1 2/2 3/3 5/2 4/4\n");
    refused(CLOTH, "");
    ck_assert_uint_eq(found.errors, 2);
    stands(1,
           "a face of 5 corners: cloth is made of triangles and quadrilaterals; "
           "triangulate the mesh on export",
           "cloth.obj", 12, "f 1/1 2/2 3/3 5/2 4/4");
}
END_TEST

/* The other faces are checked in the start shape. */
START_TEST(a_face_with_many_corners_is_the_one_fault_of_a_mesh_in_space)
{
    put("cloth.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nv 2 0 .1\nv 2.5 .5 .1\n"
                     "v 2 1 .2\nf 1 2 3 4\nf 2 5 6 7 3\n");
    refused("cloth: {mesh: {file: cloth.obj, rest: start, angle: flat}, " FABRIC "}",
            "");
    ck_assert_uint_eq(found.errors, 1);
    stands(0, "a face of 5 corners", "cloth.obj", 9, "f 2 5 6 7 3");
}
END_TEST

START_TEST(a_cloth_without_vt_that_is_not_flat_is_told_a_way_out)
{
    put("cloth.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .3\nf 1 2 3\nf 1 3 4\n");
    refused(CLOTH, "");
    stands(0, "and v is not flat: it leaves its plane by", "cloth.obj", 5, "f 1 2 3");
}
END_TEST

/* The Moebius band of five vertices, whose triangle i has vertices i, i + 1, i + 2, and
 * a sheet one of whose triangles is turned over. */
START_TEST(a_moebius_band_is_not_called_flipped)
{
    put("cloth.obj",
        "v 1 0 0\nv .3 1 .1\nv -.8 .6 .3\nv -.8 -.6 .7\nv .3 -1 .9\nvt 0 0\nvt 1 0\n"
        "vt 0 1\nf 1/1 2/2 3/3\nf 2/1 3/2 4/3\nf 3/1 4/2 5/3\nf 4/1 5/2 1/3\n"
        "f 5/1 1/2 2/3\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nvt 1 1\nf 6/1 7/2 8/4\n"
        "f 6/1 9/3 8/4\n");
    refused(CLOTH, "");
    size_t flipped = 0, one_sided = 0;
    for (size_t i = 0; i < found.count; ++i) {
        const bool sheet = found.items[i].line > 13;
        const char *wanted
            = sheet ? "edge 5-7 in the same direction: one of them is flipped"
                    : "direction: the surface has one side alone, as a "
                      "Moebius band: cut it open";
        const bool about = strstr(found.items[i].message, wanted) != NULL;
        ck_assert_msg(about || strstr(found.items[i].message, "turned over") != NULL,
                      "%s", all_found());
        flipped += about && sheet;
        one_sided += about && !sheet;
    }
    ck_assert_uint_eq(flipped, 1);
    ck_assert_uint_ge(one_sided, 1);
}
END_TEST

START_TEST(a_triangle_that_is_one_point_at_rest_is_described_without_nan)
{
    put("cloth.obj", "v 0 0 0\nv .1 0 0\nv 0 .1 0\nvt .5 .5\nf 1/1 2/1 3/1\n");
    refused(CLOTH, "");
    stands(
        0,
        "the triangle of vertices 0, 1, 2 is degenerate at rest: its corners have the "
        "same place in the rest shape",
        "cloth.obj", 5, "f 1/1 2/1 3/1");
    put("cloth.obj", "v 0 0 0\nv .1 0 0\nv 0 .1 0\nvt 0 0\nvt 1e200 0\nvt 0 1e200\n"
                     "f 1/1 2/2 3/3\n");
    refused(CLOTH, "");
    stands(0, "the triangle of vertices 0, 1, 2 is too large at rest for a double",
           "cloth.obj", 7, "f 1/1 2/2 3/3");
}
END_TEST

START_TEST(a_triangle_that_is_written_twice_is_not_called_flipped)
{
    put("cloth.obj", "v 0 0 0\nv .1 0 0\nv 0 .1 0\nvt 0 0\nvt .1 0\nvt 0 .1\n"
                     "f 1/1 2/2 3/3\nf 2/2 3/3 1/1\n");
    refused(CLOTH, "");
    stands(0,
           "two triangles run along edge 0-1 in the same direction: one is there twice",
           "cloth.obj", 8, "f 2/2 3/3 1/1");
}
END_TEST

/* ---- vertices without faces ---------------------------------------------------------
 */

START_TEST(exports_that_count_points_keep_vertices_without_faces_at_their_place)
{
    put("cloth.obj",
        "v 9 0 0\nv 0 0 0\nv .1 0 0\nv 8 0 0\nv .1 0 .1\nv 0 0 .1\nv 7 1 0\nvt 0 0\n"
        "vt 0 .1\nvt .1 .1\nvt .1 0\nf 2/1 3/2 5/3 6/4\n");
    put("loose.yaml",
        "weft: 1\ncloths: [{name: a, mesh: {file: cloth.obj}, " FABRIC
        "}, {name: b, mesh: "
        "{file: cloth.obj, unit: 2, at: [0, 3, 0], turn: {angle: 90}}, " FABRIC "}]\n"
        "stepper: {plugin: arkode, method: dormand_prince}\nforces: {gravity: [0, 0, "
        "0]}\n"
        "run: {duration: 0.1, fps: 20}\n");
    expect(
        shell(
            "cd " FOLDER " && rm -rf loose && ../../weft run loose.yaml --out loose "
            "--quiet 2>/dev/null && ../../weft export loose --format pc2 >/dev/null && "
            "../../weft export loose --format obj >/dev/null && ../../weft export "
            "loose "
            "--format csv >/dev/null"),
        0);
    /* 14 points of 3 frames */
    expect(shell("cd " FOLDER
                 "/loose && od -An -td4 -j16 -N4 run.pc2 | tr -d ' ' | grep -x 14 "
                 "&& test $(wc -c <run.pc2) = $((32 + 3 * 14 * 12))"),
           0);
    expect(
        shell(
            "cd " FOLDER "/loose && cat >wanted <<'end'\n"
            "v 9 0 0\nv 0 0 0\nv 0.1 0 0\nv 8 0 0\nv 0.1 0 0.1\nv 0 0 0.1\nv 7 1 0\n"
            "v 0 3 -18\nv 0 3 0\nv 0 3 -0.2\nv 0 3 -16\nv 0.2 3 -0.2\nv 0.2 3 0\n"
            "v 0 5 -14\nend\n"
            "for file in rest.obj final.obj; do grep '^v ' $file | sed 's/-0$/0/; s/ "
            "-0 / 0 "
            "/g; s/[0-9.]*e-1[0-9]/0/g; s/-0 / 0 /g' | diff - wanted || exit 1; done"),
        0);
    expect(
        shell("cd " FOLDER
              "/loose && grep -e '^g' -e '^f' final.obj | sed 's|/[0-9]*||g' | "
              "tr '\n' ' ' | grep -x 'g a f 2 3 5 f 2 5 6 g b f 9 10 12 f 9 12 13 '"),
        0);
}
END_TEST

TEST_SUITE(mesh_files)
{
    Suite *suite = suite_create("mesh_files");
    TCase *files = tcase_create("files");
    tcase_set_timeout(files, 60.0);
    tcase_add_test(files, a_warning_about_a_cloth_names_its_file_beside_bodies);
    tcase_add_test(files, a_fault_of_a_cloth_names_its_file_beside_bodies);
    tcase_add_test(files, mistakes_in_every_file_of_a_scene_stand_in_their_own);
    tcase_add_test(files, an_empty_cloth_file_is_named_beside_bodies);
    tcase_add_test(files, texture_coordinates_taken_for_lengths_are_warned_of);
    tcase_add_test(files, v_and_vt_in_different_units_are_warned_of);
    tcase_add_test(files, a_start_near_its_rest_shape_gets_no_warning);
    tcase_add_test(files, the_stretch_of_a_start_has_its_least_median_and_largest);
    tcase_add_test(files, a_scale_far_from_1_is_warned_of_and_is_the_stretch);
    tcase_add_test(files, a_cloth_in_another_unit_gets_a_hint);
    tcase_add_test(files, a_body_in_another_unit_gets_a_hint_but_a_floor_does_not);
    tcase_add_test(files, vertices_that_start_in_one_place_are_counted);
    tcase_add_test(files, slivers_of_a_file_are_warned_of_with_their_number);
    tcase_add_test(files, a_gap_in_key_frames_is_an_error_that_names_it);
    tcase_add_test(files, a_gap_in_folders_of_key_frames_is_an_error);
    tcase_add_test(files, check_and_run_print_the_stretch_and_the_span_of_the_keys);
    tcase_add_test(files, a_byte_order_mark_is_no_part_of_the_first_statement);
    tcase_add_test(files, nul_bytes_behind_the_text_do_not_matter);
    tcase_add_test(files, lines_may_end_with_cr_alone);
    tcase_add_test(files, unknown_statements_are_warned_of_once);
    tcase_add_test(files, faces_of_a_body_with_many_corners_are_fans);
    tcase_add_test(files, a_concave_quadrilateral_of_a_body_is_divided_inside_of_it);
    tcase_add_test(files, concave_faces_of_a_body_are_warned_of);
    tcase_add_test(files, a_corner_that_a_face_of_a_body_repeats_adds_nothing);
    tcase_add_test(files,
                   triangles_of_a_body_without_area_are_left_out_with_their_vertices);
    tcase_add_test(files, a_triangle_that_is_flat_at_one_key_is_left_out_at_all);
    tcase_add_test(files, every_face_of_a_cloth_with_many_corners_is_named);
    tcase_add_test(files, a_face_with_many_corners_is_the_one_fault_of_a_mesh_in_space);
    tcase_add_test(files, a_cloth_without_vt_that_is_not_flat_is_told_a_way_out);
    tcase_add_test(files, a_triangle_that_is_written_twice_is_not_called_flipped);
    tcase_add_test(files, a_moebius_band_is_not_called_flipped);
    tcase_add_test(files,
                   a_triangle_that_is_one_point_at_rest_is_described_without_nan);
    tcase_add_test(
        files, exports_that_count_points_keep_vertices_without_faces_at_their_place);
    suite_add_tcase(suite, files);
    return suite;
}
