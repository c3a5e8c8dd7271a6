/* SPDX-License-Identifier: BSD-3-Clause */
/* OBJ files: what they mean, and every mistake at its line and column. */
#include "obj_text.h"

#include "shell.h"

/* A unit square in four vertices, whose faces follow. */
#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"

static void read_good(const char *text)
{
    const bool good = obj_read(text, strlen(text));
    if (!good) {
        obj_end();
        ck_abort_msg("%s", all_found());
    }
}

static const char *read_bad(const char *text)
{
    ck_assert(!obj_read(text, strlen(text)));
    obj_end();
    return all_found();
}

static void corners_are(const uint32_t *wanted, size_t triangles)
{
    ck_assert_uint_eq(obj.def.triangles, triangles);
    for (size_t i = 0; i < 3 * triangles; ++i) {
        ck_assert_uint_eq(obj.def.corners[i], wanted[i]);
    }
}

/* ---- what a file means ---------------------------------------------------------- */

START_TEST(a_triangle_is_read_as_it_is_written)
{
    read_good(
        "# a triangle\no cloth\nmtllib a.mtl\nvn 0 0 1\nv 1 2 3\nv 4.5 -5e-1 .5 0.1\n"
        "v +7. 8E2 1e-3\nvt 0.25 0.5\nvt 1 0 0\nvt 0 1\ns off\nl 1 2\n"
        "f 1/1/1 2/2/1 3/3/1 # the face\n");
    static const double start[] = { 1, 2, 3, 4.5, -0.5, 0.5, 7, 800, 0.001 };
    static const double rest[] = { 0.25, 0.5, 1, 0, 0, 1 };
    ck_assert_uint_eq(obj.def.vertices, 3);
    ck_assert_uint_eq(obj.def.uv_count, 3);
    ck_assert_mem_eq(obj.def.start, start, sizeof start);
    ck_assert_mem_eq(obj.def.rest, rest, sizeof rest);
    ck_assert_ptr_null(obj.def.file_index);
    corners_are((const uint32_t[]){ 0, 1, 2 }, 1);
    ck_assert_uint_eq(found.count, 0);
    obj_end();
}
END_TEST

START_TEST(line_ends_continuations_and_blanks_make_no_difference)
{
    static const char *const same[] = {
        SQUARE "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
        "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0\r\nvt 1 0\r\nvt 1 1\r\n"
        "vt 0 1\r\nf 1/1 2/2 3/3\r\nf 1/1 3/3 4/4",
        "  v \\\n 0 0 0\nv 1 0 \\\r\n0\nv\t1 1 0\n# v \\\nv 0 1 0 # \\\nvt 0 0\nvt 1 "
        "0\n"
        "vt 1 1\nvt 0 1\n\n\nf 1/1 2/2 3/3 # \\\nf -4/-4 3/3 -1/-1\n\\",
        "v 0 0 0\nv 1 0 0\nvt 0 0\nvt 1 0\nf 1/1 2/2 3/3\nv 1 1 0\nvt 1 1\nv 0 1 0\n"
        "vt 0 1\nf -4/1 -2/-2 -1/-1\n",
    };
    for (size_t i = 0; i < sizeof same / sizeof same[0]; ++i) {
        static const double rest[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
        read_good(same[i]);
        ck_assert_uint_eq(obj.def.uv_count, 4);
        ck_assert_mem_eq(obj.def.rest, rest, sizeof rest);
        corners_are((const uint32_t[]){ 0, 1, 2, 0, 2, 3 }, 2);
        obj_end();
    }
}
END_TEST

START_TEST(numbers_are_rounded_correctly)
{
    static const char *const words[] = { "0.1",
                                         "9007199254740993",
                                         "0.30000000000000004",
                                         "1e22",
                                         "1e23",
                                         "1e-22",
                                         "123456e5",
                                         "0.000000000000001",
                                         "8.5e-308",
                                         "5e-324",
                                         "00012.50",
                                         "3.14159265358979323846264338327950288",
                                         "-0",
                                         "-0.0",
                                         "-.5",
                                         "5.",
                                         "+2.5",
                                         "123456789012345",
                                         "-12345678901.234",
                                         "1234567.89012345",
                                         "0.0000000000123",
                                         "1E+0000000000000000002" };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; ++i) {
        char text[400];
        (void)snprintf(text, sizeof text, "%sv %s 0 0\nf 1/1 2/2 3/3\nf 5/1 3/3 4/4\n",
                       SQUARE, words[i]);
        const double value = strtod(words[i], NULL);
        read_good(text);
        ck_assert_mem_eq(&obj.def.start[12], &value, sizeof value);
        obj_end();
    }
}
END_TEST

START_TEST(a_quadrilateral_is_divided_along_its_shorter_diagonal_at_rest)
{
    static const struct {
        const char *text;
        uint32_t corners[6];
    } quads[] = {
        /* equal: the lowest vertex, wherever the face begins */
        { SQUARE "f 1/1 2/2 3/3 4/4\n", { 0, 1, 2, 0, 2, 3 } },
        { SQUARE "f 2/2 3/3 4/4 1/1\n", { 2, 3, 0, 2, 0, 1 } },
        /* a kite, whose start says otherwise */
        { "v 0 0 0\nv 9 0 0\nv 1 1 0\nv -9 1 0\nvt 0 0\nvt 1 0\nvt 4 4\nvt 0 1\n"
          "f 1/1 2/2 3/3 4/4\n",
          { 1, 2, 3, 1, 3, 0 } },
        /* an arrow head: the shorter line lies outside of it */
        { "v 0 0 0\nv 9 0 0\nv 1 1 0\nv -9 1 0\nvt 0 5\nvt -1 0\nvt 0 1\nvt 1 0\n"
          "f 1/1 2/2 3/3 4/4\n",
          { 0, 1, 2, 0, 2, 3 } },
    };
    for (size_t i = 0; i < sizeof quads / sizeof quads[0]; ++i) {
        read_good(quads[i].text);
        corners_are(quads[i].corners, 2);
        obj_end();
    }
}
END_TEST

START_TEST(a_vertex_with_several_vt_has_a_place_for_each)
{
    read_good(SQUARE "vt 5 0\nvt 5 1\nvt 6 1\nvt 5.0 1.0\n"
                     "f 1/1 2/2 3/3\nf 1/5 3/6 4/7\nf 1/5 3/8 4/7\n");
    static const uint32_t places[] = { 0, 1, 2, 3, 4, 5, 3, 4, 5 };
    ck_assert_uint_eq(obj.def.uv_count, 6); /* equal ones are one place */
    ck_assert_mem_eq(obj.def.corner_uv, places, sizeof places);
    obj_end();
}
END_TEST

START_TEST(unused_vertices_are_dropped_and_others_keep_their_numbers)
{
    static const size_t names[] = { 1, 3, 4 };
    read_good("v 9 9 9\nv 0 0 0\nv 8 8 8\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
              "f 2/1 4/2 5/3\n");
    ck_assert_uint_eq(obj.def.vertices, 3);
    ck_assert_mem_eq(obj.def.file_index, names, sizeof names);
    ck_assert(obj.def.start[3] == 1.0);
    corners_are((const uint32_t[]){ 0, 1, 2 }, 1);
    obj_end();
    ck_assert_str_eq(all_found(),
                     "shirt.obj:1:1: warning: vertex 0 (from 0) belongs to no face and "
                     "is dropped, the first of 2\nv 9 9 9\n^\n");
}
END_TEST

static const char *members_of(const char *group)
{
    static char text[16];
    bool member[9] = { false };
    if (!weft__obj_group(&obj, group, member)) {
        return "no group";
    }
    for (size_t i = 0; i < obj.def.vertices; ++i) {
        text[i] = member[i] ? 'x' : '.';
    }
    text[obj.def.vertices] = '\0';
    return text;
}

START_TEST(groups_have_the_vertices_of_their_faces_and_points)
{
    read_good(SQUARE "v 5 5 5\ng front sleeve\nf 1/1 2/2 3/3\ng back\nf 1/1 3/3 4/4\n"
                     "g sleeve tip\np 2 -1 -2\ng back\np 2\ng\np 1\n");
    ck_assert_str_eq(members_of("front"), "xxx.");
    ck_assert_str_eq(members_of("sleeve"), "xxxx");
    ck_assert_str_eq(members_of("back"), "xxxx");
    ck_assert_str_eq(members_of("tip"), ".x.x");
    ck_assert_str_eq(members_of("fron"), "no group");
    ck_assert_str_eq(members_of("frontal"), "no group");
    char near[80];
    ck_assert_str_eq(weft__obj_near(&obj.groups, "fromt", near, sizeof near),
                     " (did you mean 'front'?)");
    obj_end();
}
END_TEST

START_TEST(a_turn_and_a_unit_move_the_start_and_scale_the_rest_shape)
{
    static const double x[] = { 2, 0, 0 }, at[] = { 1, 0, 0 };
    read_good(
        "v 0 0 0\nv 100 0 0\nv 0 100 0\nvt 0 0\nvt 100 0\nvt 0 100\nf 1/1 2/2 3/3\n");
    weft__obj_move(&obj, 0.01, x, 90.0, at);
    static const double start[] = { 1, 0, 0, 2, 0, 0, 1, 0, 1 };
    static const double rest[] = { 0, 0, 1, 0, 0, 1 };
    for (size_t i = 0; i < 9; ++i) {
        ck_assert_double_eq(obj.def.start[i], start[i]);
    }
    ck_assert_mem_eq(obj.def.rest, rest, sizeof rest);
    obj_end();
}
END_TEST

/* ---- mistakes -------------------------------------------------------------------- */

static const struct {
    const char *text, *told;
} mistakes[] = {
    { "v 0 0 nan\nv 0 1\n v 1e999 0 0\nv 0 0 0x1\nv 1,5 0 0\nvt\nvt 1 .\nvt 1 1e\n",
      "shirt.obj:1:7: error: 'nan' is not a finite decimal number\nv 0 0 nan\n      ^\n"
      "shirt.obj:2:1: error: this line needs x y z, but has 2 numbers\nv 0 1\n^\n"
      "shirt.obj:3:4: error: '1e999' is not a finite decimal number\n v 1e999 0 0\n   "
      "^\n"
      "shirt.obj:4:7: error: '0x1' is not a finite decimal number\nv 0 0 0x1\n      ^\n"
      "shirt.obj:5:3: error: '1,5' is not a finite decimal number\nv 1,5 0 0\n  ^\n"
      "shirt.obj:6:1: error: this line needs u v, but has 0 numbers\nvt\n^\n"
      "shirt.obj:7:6: error: '.' is not a finite decimal number\nvt 1 .\n     ^\n"
      "shirt.obj:8:6: error: '1e' is not a finite decimal number\nvt 1 1e\n     ^\n" },
    { SQUARE "f 1/1 2/2 9/3\nf 1/1 2/9 3/3\nf 0/1 2/2 3/3\nf -5/1 2/2 3/3\n",
      "shirt.obj:9:11: error: v 9 is not there: the file has 1 to 4\nf 1/1 2/2 9/3\n"
      "          ^\n"
      "shirt.obj:10:9: error: vt 9 is not there: the file has 1 to 4\nf 1/1 2/9 3/3\n"
      "        ^\n"
      "shirt.obj:11:3: error: v 0 is not there: the file has 1 to 4\nf 0/1 2/2 3/3\n"
      "  ^\n"
      "shirt.obj:12:3: error: v -5 is not there: the file has 1 to 4, and negative "
      "ones "
      "count back from this line\nf -5/1 2/2 3/3\n  ^\n" },
    { SQUARE "f 1/1 2/2 99999999999999999999999/3\nf x/1 2/2 3/3\nf 1/x 2/2 3/3\n"
             "f 1 2/2 3/3\nf 1//1 2/2 3/3\np 7\np one\n",
      "shirt.obj:9:11: error: v 99999999999999999999999 is not there: the file has 1 "
      "to 4\n"
      "f 1/1 2/2 99999999999999999999999/3\n          ^\n"
      "shirt.obj:10:3: error: 'x/1' is no number of a v\nf x/1 2/2 3/3\n  ^\n"
      "shirt.obj:11:5: error: 'x' is no number of a vt\nf 1/x 2/2 3/3\n    ^\n"
      "shirt.obj:12:3: error: corner 1 has no vt, its place in the rest shape: write "
      "v/vt\n"
      "f 1 2/2 3/3\n  ^\n"
      "shirt.obj:13:3: error: corner 1//1 has no vt, its place in the rest shape: "
      "write "
      "v/vt\nf 1//1 2/2 3/3\n  ^\n"
      "shirt.obj:14:3: error: v 7 is not there: the file has 1 to 4\np 7\n  ^\n"
      "shirt.obj:15:3: error: 'one' is no number of a v\np one\n  ^\n" },
    { SQUARE "f 1/1 2/2\nf 1/1 2/2 3/3 4/4 1/1\nf 1/1 2/2 2/3\nf\n",
      "shirt.obj:9:1: error: a face of 2 corners: cloth is made of triangles and "
      "quadrilaterals\nf 1/1 2/2\n^\n"
      "shirt.obj:10:1: error: a face of 5 corners: cloth is made of triangles and "
      "quadrilaterals; triangulate the mesh on export\nf 1/1 2/2 3/3 4/4 1/1\n^\n"
      "shirt.obj:11:11: error: corner 2/3 repeats a vertex of the face\nf 1/1 2/2 2/3\n"
      "          ^\n"
      "shirt.obj:12:1: error: a face of 0 corners: cloth is made of triangles and "
      "quadrilaterals\nf\n^\n" },
    { SQUARE "f 1/1 \\\r\n\t2/2 \\\n 3/8\n",
      "shirt.obj:11:4: error: vt 8 is not there: the file has 1 to 4\n 3/8\n   ^\n" },
    { "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n",
      "shirt.obj:5:1: error: the file has no vt lines, which give the rest shape in "
      "the plane, and v is not flat: it leaves its plane by 0.433 of its extent of 1; "
      "`rest: start` takes the start as it is, or unwrap the mesh and export its UVs "
      "as "
      "lengths\nf 1 2 3\n^\n" },
    { "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/3\n",
      "shirt.obj:4:5: error: vt 1 is not there: the file has no vt\nf 1/1 2/2 3/3\n"
      "    ^\n" },
    { "v 0 0 0\nv 1 0 0\nv 0 1 x\nv 2 0 0\nv 9 9 9\nvt 0 0\nvt 1 0\nvt 0 1\nvt 2 0\n"
      "f 1/1 2/2 3/3\nf 1/1 2/2 4/4\nf 2/2 4/4 7/3\n",
      "shirt.obj:3:7: error: 'x' is not a finite decimal number\nv 0 1 x\n      ^\n"
      "shirt.obj:11:1: error: the triangle of vertices 0, 1, 3 is degenerate at rest: "
      "its height is 0 m, below 0.0001 of its longest edge of 2 m\nf 1/1 2/2 4/4\n^\n"
      "shirt.obj:12:11: error: v 7 is not there: the file has 1 to 5\n"
      "f 2/2 4/4 7/3\n          ^\n" },
    { SQUARE, "shirt.obj:1:1: error: the file has no faces (lines 'f 1/1 2/2 3/3')\n"
              "v 0 0 0\n^\n" },
};

START_TEST(every_mistake_is_told_at_its_line_and_column)
{
    ck_assert_str_eq(read_bad(mistakes[_i].text), mistakes[_i].told);
}
END_TEST

START_TEST(a_file_that_is_no_text_is_refused_at_its_first_nul)
{
    ck_assert(!obj_read("v 0 0 0\nab\0c\n", 13));
    obj_end();
    ck_assert_str_eq(all_found(),
                     "shirt.obj:2:3: error: a NUL byte: this is not the text of an "
                     "OBJ file\nab?c\n  ^\n");
    ck_assert(!obj_read("", 0));
    obj_end();
    ck_assert_uint_eq(found.errors, 1);
}
END_TEST

START_TEST(of_many_mistakes_the_first_twenty_of_the_file_are_shown)
{
    static char text[16384];
    size_t used = 0;
    for (int i = 0; i < 1000; ++i) {
        used += (size_t)snprintf(text + used, sizeof text - used, "v 0 0 x\n");
    }
    (void)read_bad(text);
    ck_assert_uint_eq(found.errors, 1000);
    ck_assert_uint_eq(found.count, WEFT_DIAGNOSTICS_MAX);
    for (size_t i = 0; i < found.count; ++i) {
        ck_assert_int_eq(found.items[i].line, (int)i + 1);
        ck_assert_int_eq(found.items[i].column, 7);
    }
}
END_TEST

START_TEST(faults_of_the_mesh_stand_at_the_line_of_their_part)
{
    read_good(
        "v 0 0 0\nv 7 7 7\n v 1 0 0\nv 1 1 0\nv 0 1 0\nvt 3 3\nvt 0 0\nvt 1 0\nvt 1 1\n"
        "vt 0 1\n\nf 1/2 3/3 4/4 5/5\n f 5/5 4/4 3/3\n");
    weft__obj_fault(&obj, WEFT__MESH_TRIANGLE, 2, "third triangle");
    weft__obj_fault(&obj, WEFT__MESH_TRIANGLE, 1, "second triangle");
    weft__obj_fault(&obj, WEFT__MESH_VERTEX, 1, "second vertex");
    weft__obj_fault(&obj, WEFT__MESH_PLACE, 0, "first place");
    weft__obj_fault(&obj, WEFT__MESH_DEF, 0, "all of it");
    obj_end();
    static const int lines[] = { 0, 2, 3, 7, 12, 13 };
    ck_assert_uint_eq(found.count, 6);
    for (size_t i = 0; i < 6; ++i) {
        ck_assert_int_eq(found.items[i].line, lines[i]);
    }
    ck_assert_str_eq(found.items[2].message, "second vertex");
    ck_assert_int_eq(found.items[2].column, 2);
}
END_TEST

START_TEST(a_vertex_of_very_many_places_is_refused_at_once)
{
    enum { FACES = 3000, EACH = 60 };
    char *text = malloc(FACES * EACH);
    size_t used = (size_t)snprintf(text, EACH, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for (int i = 0; i < FACES; ++i) {
        used += (size_t)snprintf(text + used, EACH,
                                 "vt %d 0\nvt %d 1\nvt %d 2\nf 1/-3 2/-2 3/-1\n", i, i,
                                 i);
    }
    ck_assert(!obj_read(text, used));
    obj_end();
    free(text);
    ck_assert_ptr_nonnull(strstr(found.items[0].message, "more than 1000 places"));
}
END_TEST

/* ---- files ------------------------------------------------------------------------
 */

START_TEST(what_cannot_be_a_file_of_triangles_is_refused_unread)
{
    static const char path[] = BUILD_DIR "/tests/sparse.obj";
    FILE *stream = fopen(path, "w");
    ck_assert(stream != NULL && ftruncate(fileno(stream), (off_t)10 << 30) == 0);
    (void)fclose(stream);
    const struct {
        const char *path, *told;
    } files[] = {
        { path,
          BUILD_DIR "/tests/sparse.obj has 10737418240 bytes; an OBJ file has at most "
                    "1073741824" },
        { "tests", "tests: Is a directory" },
        { "tests/none.obj", "tests/none.obj: No such file or directory" },
        { "/dev/zero", "/dev/zero: not a regular file" },
    };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; ++i) {
        (void)obj_read("", 0);
        weft__obj_forget(&obj);
        memset(&found, 0, sizeof found);
        obj = (weft__obj){ .report = &obj_report };
        ck_assert(!weft__obj_load(&obj, files[i].path));
        obj_end();
        ck_assert_str_eq(found.items[0].message, files[i].told);
    }
    (void)unlink(path);
}
END_TEST

/* ---- scenes -----------------------------------------------------------------------
 */

/* Four triangles about vertex 2 of five, and vertex 0 that has none. */
#define SHEET                                                                          \
    "v 9 9 9\nv 0 0 0\nv 1 1 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 9 9\nvt 0 0\nvt 1 1\n"   \
    "vt 2 0\nvt 2 2\nvt 0 2\ng left\nf 2/2 3/3 6/6\nusemtl collar\ng right\n"          \
    "f 4/4 5/5 3/3\ng\nf 2/2 4/4 3/3\nusemtl none\nf 5/5 6/6 3/3\ng tip\np 5\n"

#define SHEET_PRINTF                                                                   \
    "v 9 9 9\\nv 0 0 0\\nv 1 1 0\\nv 2 0 0\\nv 2 2 0\\nv 0 2 0\\nvt 9 9\\nvt 0 "       \
    "0\\nvt 1 1\\n"                                                                    \
    "vt 2 0\\nvt 2 2\\nvt 0 2\\nf 2/2 3/3 6/6\\nf 4/4 5/5 3/3\\nf 2/2 4/4 3/3\\nf "    \
    "5/5 6/6 3/3\\n"

static weft_scene *sheet_scene(const char *cloth)
{
    static const char path[] = BUILD_DIR "/tests/sheet.obj";
    static char text[2000];
    FILE *stream = fopen(path, "w");
    ck_assert(stream != NULL && fputs(SHEET, stream) >= 0 && fclose(stream) == 0);
    (void)snprintf(text, sizeof text,
                   "weft: 1\ncloth:\n  fabric: {density: 0.1, stretch: [100, 200], "
                   "shear: 10}\n%s"
                   "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 1}\n",
                   cloth);
    weft_scene_def def = scene_of_text(text);
    def.file = BUILD_DIR "/tests/scene.yaml";
    weft_scene *scene = good_scene(&def);
    (void)unlink(path);
    return scene;
}

static void pin_has(const weft_scene *scene, size_t pin, size_t count,
                    const size_t *wanted)
{
    const weft_pin *of = &weft_scene_cloth(scene)->pins[pin];
    ck_assert_uint_eq(of->vertex_count, count);
    ck_assert_mem_eq(of->vertices, wanted, count * sizeof *wanted);
}

START_TEST(a_scene_takes_its_mesh_from_the_file_beside_it)
{
    weft_scene *scene
        = sheet_scene("  mesh: {file: sheet.obj, unit: 0.5, at: [0, 0, 1]}\n"
                      "  seams: hinge\n  membrane: chord\n");
    const weft_mesh_def *mesh = weft_scene_cloth(scene)->mesh;
    ck_assert_uint_eq(mesh->vertices, 5);
    ck_assert_uint_eq(mesh->triangles, 4);
    ck_assert_uint_eq(mesh->file_index[0], 1);
    ck_assert(mesh->seams == WEFT_SEAM_HINGE && !mesh->arc);
    ck_assert(mesh->start[3] == 0.5 && mesh->start[5] == 1.0);
    ck_assert_uint_eq(mesh->fabric_count, 1);
    ck_assert_double_eq(mesh->fabrics[0].coupling, 10.0);
    ck_assert_double_eq(mesh->fabrics[0].twist, -1.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(triangles_have_the_fabric_of_their_usemtl_or_that_of_the_cloth)
{
    static const uint32_t of[] = { 0, 1, 1, 0 };
    weft_scene *scene
        = sheet_scene("  mesh: {file: sheet.obj}\n"
                      "  fabrics: {collar: {preset: royal-target, coupling: 3}}\n");
    const weft_mesh_def *mesh = weft_scene_cloth(scene)->mesh;
    ck_assert_uint_eq(mesh->fabric_count, 2);
    ck_assert_mem_eq(mesh->fabric_of, of, sizeof of);
    ck_assert_double_eq(mesh->fabrics[0].density, 0.1);
    ck_assert_double_eq(mesh->fabrics[1].density, 0.22);
    ck_assert_double_eq(mesh->fabrics[1].coupling, 3.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(pins_and_loads_find_their_vertices)
{
    weft_scene *scene = sheet_scene(
        "  mesh: {file: sheet.obj}\n"
        "  pins:\n    - {vertices: [5, 1]}\n    - {group: left, velocity: [0, 0, 1]}\n"
        "    - {near: [2, 1, 0]}\n"
        "    - {inside: {shape: sphere, at: [2, 1, 0], radius: 1}, amplitude: [0, 1, "
        "0],\n"
        "       frequency: 2}\n    - {group: tip}\n"
        "  loads: [{inside: {shape: plane, at: [0, 1, 0], normal: [0, 1, 0]}, mass: "
        "1}]\n");
    /* 0 to 4 are 1 to 5 of the file */
    pin_has(scene, 0, 2, (const size_t[]){ 4, 0 });
    pin_has(scene, 1, 3, (const size_t[]){ 0, 1, 4 });
    pin_has(scene, 2, 1, (const size_t[]){ 1 }); /* of three as near */
    pin_has(scene, 3, 3, (const size_t[]){ 1, 2, 3 });
    pin_has(scene, 4, 1, (const size_t[]){ 3 });
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert_double_eq(cloth->pins[1].velocity[2], 1.0);
    ck_assert_double_eq(cloth->pins[3].frequency, 2.0);
    ck_assert_uint_eq(cloth->loads[0].vertex_count, 3);
    ck_assert_uint_eq(cloth->loads[0].vertices[2], 2);
    weft_scene_destroy(scene);
}
END_TEST

/* The longest edge has 2 m. */
START_TEST(a_point_that_is_far_from_the_mesh_gives_a_warning)
{
    weft_scene_destroy(sheet_scene("  mesh: {file: sheet.obj}\n"
                                   "  pins: [{near: [3.9, 2, 0]}]\n"
                                   "  loads: [{near: [0, 2, 1.9], mass: 1}]\n"));
    ck_assert_ptr_null(strstr(all_found(), "nearest"));
    weft_scene_destroy(sheet_scene("  mesh: {file: sheet.obj}\n"
                                   "  pins: [{near: [200, 2, 0]}]\n"
                                   "  loads: [{near: [0, 2, 2.5], mass: 1}]\n"));
    ck_assert_ptr_nonnull(
        strstr(all_found(), "warning: the nearest vertex, 4 at (2, 2, 0) m, is 198 "
                            "m away from this point, and the longest edge has 2 "
                            "m: the point is in metres, as the mesh is after "
                            "`unit`"));
    ck_assert_ptr_nonnull(strstr(all_found(), "5 at (0, 2, 0) m, is 2.5 m away"));
}
END_TEST

START_TEST(a_mesh_that_is_all_pinned_gives_a_warning)
{
    weft_scene_destroy(
        sheet_scene("  mesh: {file: sheet.obj}\n"
                    "  pins: [{inside: {shape: sphere, at: [1, 1, 0], radius: 2}}]\n"));
    ck_assert_ptr_nonnull(strstr(all_found(), "all 5 particles are pinned"));
}
END_TEST

/* What a run needs of its mesh lies in its results. */
START_TEST(a_run_goes_on_without_the_file_of_its_mesh)
{
    static const char folder[] = BUILD_DIR "/tests/mesh-run";
    expect(
        shell("rm -rf %s && mkdir -p %s/shapes && cd %s && printf '%s' "
              ">shapes/sheet.obj && cat >hung.yaml <<'end'\n"
              "weft: 1\ncloth:\n  mesh: {file: shapes/sheet.obj}\n"
              "  fabric: {preset: royal-target}\n  pins: [{vertices: [5]}]\n"
              "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
              "run: {duration: 0.1, checkpoint: 1, keep_checkpoint: true}\nend\n",
              folder, folder, folder, SHEET_PRINTF),
        0);
    expect(shell(WEFT " run %s/hung.yaml --quiet --out %s/a 2>&1", folder, folder), 0);
    expect(shell(WEFT
                 " run %s/hung.yaml --quiet --out %s/b --set run.duration=0.2 2>&1",
                 folder, folder),
           0);
    expect(shell("rm %s/shapes/sheet.obj && " WEFT
                 " resume %s/a --until 0.2 --quiet 2>&1 && "
                 "cmp %s/a/final.csv %s/b/final.csv",
                 folder, folder, folder, folder),
           0);
    /* another place, other numbers */
    static const char *const changes[] = {
        "s/v 0 2 0/v 0 3 0/",
        "s_^v 9 9 9_&\\n&_;s_2/2_3/2_;s_3/3_4/3_;s_4/4_5/4_;s_5/5_6/5_;s_6/6_7/6_"
    };
    for (size_t i = 0; i < 2; ++i) {
        expect(shell("cp %s/a/scene.obj %s/kept && sed -i '%s' %s/a/scene.obj && " WEFT
                     " resume %s/a --until 0.3 --quiet 2>&1",
                     folder, folder, changes[i], folder, folder),
               3);
        ck_assert_ptr_nonnull(strstr(output, "scene.obj"));
        expect(shell("cp %s/kept %s/a/scene.obj", folder, folder), 0);
    }
}
END_TEST

TEST_SUITE(obj)
{
    Suite *suite = suite_create("obj");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 60.0);
    tcase_add_test(all, a_triangle_is_read_as_it_is_written);
    tcase_add_test(all, line_ends_continuations_and_blanks_make_no_difference);
    tcase_add_test(all, numbers_are_rounded_correctly);
    tcase_add_test(all, a_quadrilateral_is_divided_along_its_shorter_diagonal_at_rest);
    tcase_add_test(all, a_vertex_with_several_vt_has_a_place_for_each);
    tcase_add_test(all, unused_vertices_are_dropped_and_others_keep_their_numbers);
    tcase_add_test(all, groups_have_the_vertices_of_their_faces_and_points);
    tcase_add_test(all, a_turn_and_a_unit_move_the_start_and_scale_the_rest_shape);
    tcase_add_loop_test(all, every_mistake_is_told_at_its_line_and_column, 0,
                        sizeof mistakes / sizeof mistakes[0]);
    tcase_add_test(all, a_file_that_is_no_text_is_refused_at_its_first_nul);
    tcase_add_test(all, of_many_mistakes_the_first_twenty_of_the_file_are_shown);
    tcase_add_test(all, faults_of_the_mesh_stand_at_the_line_of_their_part);
    tcase_add_test(all, a_vertex_of_very_many_places_is_refused_at_once);
    tcase_add_test(all, what_cannot_be_a_file_of_triangles_is_refused_unread);
    tcase_add_test(all, a_scene_takes_its_mesh_from_the_file_beside_it);
    tcase_add_test(all, triangles_have_the_fabric_of_their_usemtl_or_that_of_the_cloth);
    tcase_add_test(all, pins_and_loads_find_their_vertices);
    tcase_add_test(all, a_point_that_is_far_from_the_mesh_gives_a_warning);
    tcase_add_test(all, a_mesh_that_is_all_pinned_gives_a_warning);
    tcase_add_test(all, a_run_goes_on_without_the_file_of_its_mesh);
    suite_add_tcase(suite, all);
    return suite;
}
