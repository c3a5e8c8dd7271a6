/* SPDX-License-Identifier: BSD-3-Clause */
/* Vertices of a file that are one by `weld`, and files without vt. */
#include "obj_text.h"
#include "random.h"
#include "shell.h"

#include <math.h>

#define FOLDER BUILD_DIR "/tests/weld"

static void read_good(const char *text, double weld)
{
    obj_weld = weld;
    const bool good = obj_read(text, strlen(text));
    if (!good) {
        obj_end();
        ck_abort_msg("%s", all_found());
    }
}

static const char *read_bad(const char *text, double weld)
{
    obj_weld = weld;
    ck_assert(!obj_read(text, strlen(text)));
    obj_end();
    return all_found();
}

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

static void corners_are(const uint32_t *wanted, size_t triangles)
{
    ck_assert_uint_eq(obj.def.triangles, triangles);
    for (size_t i = 0; i < 3 * triangles; ++i) {
        ck_assert_uint_eq(obj.def.corners[i], wanted[i]);
    }
}

/* ---- which vertices are one ------------------------------------------------------ */

/* Two squares beside each other, whose common side is written twice, `GAP` apart. */
#define PLACES "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 3 0\nvt 4 0\nvt 4 1\nvt 3 1\n"
#define SPLIT(GAP)                                                                     \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1" GAP " 0 0\nv 2 0 0\nv 2 1 0\nv 1" GAP    \
    " 1 0\n" PLACES "g left\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\ng right\nf 5/5 6/6 7/7\n"   \
    "f 5/5 7/7 8/8\n"

START_TEST(weld_0_joins_what_coincides_exactly)
{
    static const size_t names[] = { 0, 1, 2, 3, 5, 6 };
    read_good(SPLIT(""), 0.0);
    ck_assert_uint_eq(obj.def.vertices, 6);
    ck_assert_uint_eq(obj.def.uv_count, 8); /* vt stay */
    ck_assert_uint_eq(obj.welded, 2);
    ck_assert_mem_eq(obj.def.file_index, names, sizeof names);
    corners_are((const uint32_t[]){ 0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2 }, 4);
    ck_assert_uint_eq(found.count, 0);
    obj_end();
    read_good(SPLIT(".000001"), 0.0);
    ck_assert_uint_eq(obj.def.vertices, 8);
    obj_end();
}
END_TEST

START_TEST(the_lowest_vertex_keeps_its_place)
{
    static const double start[]
        = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0 };
    read_good(SPLIT(".001"), 1.1e-3);
    ck_assert_uint_eq(obj.def.vertices, 6);
    ck_assert_mem_eq(obj.def.start, start, sizeof start);
    obj_end();
    read_good(SPLIT(".001"), 0.9e-3);
    ck_assert_uint_eq(obj.def.vertices, 8);
    ck_assert_ptr_null(obj.def.file_index);
    obj_end();
}
END_TEST

START_TEST(equal_vt_of_welded_vertices_are_one_place)
{
    read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
              "vt 1 1\nvt 0 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 4/4 5/5 6/6\n",
              0.0);
    ck_assert_uint_eq(obj.def.vertices, 4);
    ck_assert_uint_eq(obj.def.uv_count, 4);
    corners_are((const uint32_t[]){ 0, 1, 2, 0, 2, 3 }, 2);
    obj_end();
}
END_TEST

/* Each is within reach of the next, the ends are not of each other. */
START_TEST(all_of_a_chain_have_the_number_of_its_lowest)
{
    read_good("v 5 0 0\nv .3 0 0\nv .1 0 0\nv 0 5 0\nv .2 0 0\nv .4 0 0\nv 9 9 0\n"
              "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nf 1/1 3/2 4/3\nf 4/3 6/2 7/4\n",
              0.1);
    ck_assert_uint_eq(obj.def.vertices, 4);
    for (size_t v = 1; v < 6; ++v) {
        ck_assert_uint_eq(obj.vertex_of[v], v == 3 ? 2 : 1);
    }
    ck_assert_double_eq(obj.def.start[3],
                        0.3); /* its place, of a vertex without faces */
    ck_assert_uint_eq(found.count, 0);
    obj_end();
}
END_TEST

static size_t root_of(const size_t *lowest, size_t v)
{
    while (lowest[v] != v) {
        v = lowest[v];
    }
    return v;
}

/* By all pairs. */
static void weld_slowly(const double (*x)[3], size_t n, double weld, size_t *lowest)
{
    for (size_t i = 0; i < n; ++i) {
        lowest[i] = i;
        for (size_t j = 0; j < i; ++j) {
            const double d[]
                = { x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2] };
            const size_t a = root_of(lowest, i), b = root_of(lowest, j);
            if (weft__length(d) <= weld * (1.0 + 1e-9)) {
                lowest[a > b ? a : b] = a < b ? a : b;
            }
        }
    }
}

START_TEST(random_vertices_are_one_as_all_pairs_say)
{
    enum { N = 400 };
    static char text[N * 80];
    static double x[N][3];
    static const double welds[] = { 0.0, 1e-3, 0.03, 0.06, 0.09, 0.15, 1e-300 };
    size_t lowest[N], last = 0;
    uint64_t random = 7;
    char *end = text;
    for (size_t i = 0; i < N; ++i) {
        for (size_t k = 0; k < 3; ++k) { /* some coincide */
            x[i][k] = i % 7 == 3 ? x[i / 2][k]
                                 : 1e-3 * floor(1e3 * (random_uniform(&random) - 0.5));
        }
        end += sprintf(end, "v %.17g %.17g %.17g\n", x[i][0], x[i][1], x[i][2]);
    }
    (void)strcpy(end, "v 7 0 0\nv 8 0 0\nv 7 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                      "f 401/1 402/2 403/3\n");
    for (size_t w = 0; w < sizeof welds / sizeof *welds; ++w) {
        read_good(text, welds[w]);
        weld_slowly((const double(*)[3])x, N, welds[w], lowest);
        size_t welded = 0;
        for (size_t i = 0; i < N; ++i) {
            ck_assert_uint_eq(obj.lowest[i], root_of(lowest, i));
            welded += obj.lowest[i] != i;
        }
        ck_assert_uint_eq(obj.welded, welded);
        ck_assert(w == 6 || (w == 5 && welded > 300) || welded >= last);
        last = welded;
        obj_end();
    }
}
END_TEST

/* Many vertices in one cell take no time as of all pairs. */
START_TEST(a_weld_that_is_far_too_large_is_refused_soon)
{
    enum { SIDE = 300 };
    static char text[SIDE * SIDE * 80];
    char *end = text;
    for (size_t i = 0; i < SIDE * SIDE; ++i) {
        end += sprintf(end, "v %g %g 0\nvt %g %g\n", .01 * (double)(i / SIDE),
                       .01 * (double)(i % SIDE), .01 * (double)(i / SIDE),
                       .01 * (double)(i % SIDE));
    }
    for (size_t i = 0; i < 40; ++i) {
        end += sprintf(end, "f %zu/%zu %zu/%zu %zu/%zu\n", i + 1, i + 1, i + 2, i + 2,
                       i + SIDE + 1, i + SIDE + 1);
    }
    const char *told = read_bad(text, 2.0);
    ck_assert_ptr_nonnull(strstr(
        told,
        "error: 'weld' makes one vertex of corners 0 and 1 (from 0) of this face: "
        "a smaller weld keeps them apart\nf 1/1 2/2 301/301\n"));
    ck_assert_uint_eq(found.errors, 40);
}
END_TEST

START_TEST(a_face_that_loses_a_corner_is_an_error_at_its_line)
{
    ck_assert_str_eq(
        read_bad("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 .5 0\nv 1 .499 0\nvt 0 0\n"
                 "vt 1 0\nvt 1 1\nvt 0 1\nvt 1 .5\nvt 1 .499\nf 1/1 2/2 3/3 4/4\n"
                 "f 1/1 6/6 5/5\nf 1/1 2/2 6/6 5/5\n",
                 0.01),
        "shirt.obj:14:1: error: 'weld' makes one vertex of corners 5 and 4 (from 0) of "
        "this face: a smaller weld keeps them apart\nf 1/1 6/6 5/5\n^\n"
        "shirt.obj:15:1: error: 'weld' makes one vertex of corners 5 and 4 (from 0) of "
        "this face: a smaller weld keeps them apart\nf 1/1 2/2 6/6 5/5\n^\n");
}
END_TEST

/* ---- in a scene ------------------------------------------------------------------ */

static weft_scene *load(const char *cloth)
{
    static char text[2048];
    (void)snprintf(
        text, sizeof text,
        "weft: 1\ncloth:\n%s  fabric: {density: 0.2, stretch: 80, shear: 20}\n"
        "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 0.1}\n",
        cloth);
    weft_scene_def def = scene_of_text(text);
    weft_scene *scene = NULL;
    def.file = FOLDER "/test.yaml";
    (void)weft_scene_load(&def, &scene, &found, NULL);
    ck_assert_msg(scene != NULL, "%s", all_found());
    return scene;
}

/* In the unit of the scene; each number of the file is a name of its vertex. */
START_TEST(other_numbers_stay_names_in_the_scene)
{
    put("cloth.obj", SPLIT(".001"));
    weft_scene *scene
        = load("  mesh: {file: cloth.obj, unit: 0.1, weld: 1.5e-4}\n"
               "  pins: [{vertices: [4]}, {group: right}, {vertices: [7, 2, 0]}]\n"
               "  loads: [{vertices: [1, 4], mass: 1}]\n");
    const weft_cloth_def *def = weft_scene_cloth(scene);
    static const size_t right[] = { 1, 2, 4, 5 }, last[] = { 2, 0 };
    ck_assert_uint_eq(def->mesh->vertices, 6);
    ck_assert_uint_eq(def->pins[0].vertex_count, 1);
    ck_assert_uint_eq(def->pins[0].vertices[0], 1);
    ck_assert_uint_eq(def->pins[1].vertex_count, 4);
    ck_assert_mem_eq(def->pins[1].vertices, right, sizeof right);
    ck_assert_uint_eq(def->pins[2].vertex_count, 2);
    ck_assert_mem_eq(def->pins[2].vertices, last, sizeof last);
    ck_assert_uint_eq(def->loads[0].vertex_count, 1);
    ck_assert_uint_eq(found.warnings, 0);
    const char *about;
    ck_assert_str_eq(weft_scene_note(scene, 0, &about),
                     "2 of the file's 8 vertices became another");
    ck_assert_str_eq(about, "weld");
    ck_assert_ptr_null(weft_scene_note(scene, 1, &about));
    weft_scene_destroy(scene);
    scene = load("  mesh: {file: cloth.obj, unit: 0.1, weld: 0.9e-4}\n");
    ck_assert_uint_eq(weft_scene_cloth(scene)->mesh->vertices, 8);
    weft_scene_destroy(scene);
}
END_TEST

#define RUN                                                                            \
    "weft: 1\ncloth:\n  mesh: {file: %s}\n  fabric: {preset: royal-target}\n"          \
    "  pins: [{vertices: [0]}]\nstepper: {plugin: arkode, method: dormand_prince}\n"   \
    "run: {duration: 0.02, fps: 100, checkpoint: 1, keep_checkpoint: true}\n"

/* One row, of the lowest; a file welded by hand has the same motion to the last bit. */
START_TEST(a_run_writes_one_row_for_a_welded_vertex_and_goes_on)
{
    char text[1024];
    put("split.obj", SPLIT(""));
    put("hand.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n" PLACES
                    "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 2/5 5/6 6/7\nf 2/5 6/7 3/8\n");
    (void)snprintf(text, sizeof text, RUN, "split.obj, weld: 0");
    put("split.yaml", text);
    (void)snprintf(text, sizeof text, RUN, "hand.obj");
    put("hand.yaml", text);
    expect(shell("cd " FOLDER " && rm -rf a b c && ../../weft run split.yaml --quiet "
                 "--out a 2>&1 && ../../weft run hand.yaml --quiet --out b 2>&1 && "
                 "cut -d, -f1 a/final.csv | tr '\n' ' '"),
           0);
    ck_assert_str_eq(output, "vertex 0 1 2 3 5 6 ");
    expect(shell("cd " FOLDER " && cut -d, -f2- a/final.csv >a.csv && cut -d, -f2- "
                 "b/final.csv | cmp - a.csv && mv split.obj away.obj && "
                 "../../weft resume a --until 0.04 --quiet 2>&1 && mv away.obj "
                 "split.obj && ../../weft run split.yaml --quiet --out c --set "
                 "run.duration=0.04 2>&1 && cmp a/final.csv c/final.csv"),
           0);
    expect(
        shell("cd " FOLDER " && ../../weft check split.yaml | grep -E 'weld|pieces'"),
        0);
    ck_assert_str_eq(output, "  weld       2 of the file's 8 vertices became another\n"
                             "  pieces     2, sewn along 1 edges, 1 m\n");
}
END_TEST

/* ---- files without vt ------------------------------------------------------------ */

/* Where the vertices lie at rest. */
static void rests_at(const char *text, const double *rest, size_t count)
{
    read_good(text, -1.0);
    ck_assert_uint_eq(obj.def.uv_count, count);
    for (size_t i = 0; i < 3 * obj.def.triangles; ++i) {
        const double *place = &obj.def.rest[2 * (size_t)obj.def.corner_uv[i]];
        const double *wanted = &rest[2 * (size_t)obj.def.corners[i]];
        ck_assert_double_eq_tol(place[0], wanted[0], 1e-12);
        ck_assert_double_eq_tol(place[1], wanted[1], 1e-12);
    }
    obj_end();
}

START_TEST(a_flat_file_without_vt_is_its_own_rest_shape)
{
    static const double plane[] = { 0, 0, 2, 0, 2, 1, 0, 1 };
    /* v along y in upright planes, along z in others; u towards a positive axis */
    rests_at("v 0 0 7\nv 2 0 7\nv 2 1 7\nv 0 1 7\nf 1 2 3\nf 1 3 4\n", plane, 4);
    rests_at("v 7 0 0\nv 7 0 2\nv 7 1 2\nv 7 1 0\nf 1//1 2//1 3//1 4//1\n", plane, 4);
    rests_at("v 0 7 0\nv 2 7 0\nv 2 7 1\nv 0 7 1\nf 1 2 3\nf 1 3 4\n", plane, 4);
    rests_at("v 0 7 0\nv 2 7 0\nv 2 7 1\nv 0 7 1\nf 3 2 1\nf 4 3 1\n", plane, 4);
    /* 30 degrees from the upright, about x; then from the horizontal */
    rests_at("v 0 0 0\nv 2 0 0\nv 2 .8660254037844386 .5\nv 0 .8660254037844386 .5\n"
             "f 1 2 3 4\n",
             plane, 4);
    rests_at("v 0 0 0\nv 2 0 0\nv 2 .5 .8660254037844386\nv 0 .5 .8660254037844386\n"
             "f 1 2 3 4\n",
             plane, 4);
}
END_TEST

/* Coordinates in a plane along two axes are those of v to the last bit. */
START_TEST(a_flat_file_has_the_coordinates_of_its_axes_exactly)
{
    static const double rest[] = { 0.1, 0.7, 1.3, 0.2, 0.9, 2.3 };
    read_good("v .1 .7 .3\nv 1.3 .2 .3\nv .9 2.3 .3\nf 1 2 3\n", -1.0);
    ck_assert_mem_eq(obj.def.rest, rest, sizeof rest);
    ck_assert(obj.flat_rest);
    ck_assert_uint_eq(found.count, 0);
    obj_end();
}
END_TEST

START_TEST(vertices_without_faces_do_not_make_a_file_less_flat)
{
    read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 5 5\nf 1 2 3\n", -1.0);
    ck_assert_double_eq(obj.def.rest[2], 1.0);
    obj_end();
}
END_TEST

START_TEST(a_nearly_flat_file_is_laid_in_its_plane_with_a_warning)
{
    static const struct {
        const char *z;
        size_t warnings, errors;
    } bends[] = {
        { ".0000009", 0, 0 }, { ".00002", 1, 0 }, { ".003", 1, 0 }, { ".006", 0, 1 }
    };
    for (size_t i = 0; i < sizeof bends / sizeof *bends; ++i) {
        char text[200];
        (void)snprintf(text, sizeof text,
                       "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 %s\nf 1 2 3\nf 1 3 4\n",
                       bends[i].z);
        obj_weld = -1.0;
        (void)obj_read(text, strlen(text));
        obj_end();
        ck_assert_msg(found.warnings == bends[i].warnings
                          && found.errors == bends[i].errors,
                      "%s: %s", bends[i].z, all_found());
    }
    ck_assert_ptr_nonnull(strstr(all_found(), "and v is not flat: it leaves its plane "
                                              "by 0.0015 of its extent of 1"));
}
END_TEST

/* Sums and places of such numbers are not finite. */
START_TEST(a_flat_file_of_numbers_near_the_largest_is_refused)
{
    static const char *const files[]
        = { "v 1e308 0 0\nv 1e308 1e308 0\nv 1e308 0 1e308\nf 1 2 3\n",
            "v 1e308 0 0\nv 1e308 1 0\nv 1e308 0 1\nf 1 2 3\n",
            "v 1e308 1e308 1e308\nv -1e308 1e308 1\nv 2 1e308 1e308\nf 1 2 3\n" };
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i) {
        (void)read_bad(files[i], -1.0);
        ck_assert_uint_eq(found.errors, 1);
    }
}
END_TEST

START_TEST(a_welded_vertex_of_a_flat_file_rests_where_the_lowest_does)
{
    static const double rest[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
    read_good("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 .001 0\nv 1 1.001 0\nv 0 1 0\nf 1 2 3\n"
              "f 4 5 6\n",
              0.002);
    ck_assert_uint_eq(obj.def.uv_count, 4);
    ck_assert_mem_eq(obj.def.rest, rest, sizeof rest);
    obj_end();
}
END_TEST

START_TEST(check_says_where_the_warp_of_a_file_without_vt_lies)
{
    put("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 4 3 2\n");
    weft_scene *scene = load("  mesh: {file: flat.obj, turn: {axis: [1, 0, 0], angle: "
                             "90}, unit: 0.1}\n");
    const char *about;
    ck_assert_str_eq(weft_scene_note(scene, 0, &about),
                     "no vt: v is flat and its own rest shape, warp along [0, 0, 1] of "
                     "the file");
    ck_assert_double_eq_tol(weft_scene_cloth(scene)->mesh->rest[5], 0.1, 1e-15);
    weft_scene_destroy(scene);
}
END_TEST

TEST_SUITE(weld)
{
    Suite *suite = suite_create("weld");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 60.0);
    tcase_add_test(all, weld_0_joins_what_coincides_exactly);
    tcase_add_test(all, the_lowest_vertex_keeps_its_place);
    tcase_add_test(all, equal_vt_of_welded_vertices_are_one_place);
    tcase_add_test(all, all_of_a_chain_have_the_number_of_its_lowest);
    tcase_add_test(all, random_vertices_are_one_as_all_pairs_say);
    tcase_add_test(all, a_weld_that_is_far_too_large_is_refused_soon);
    tcase_add_test(all, a_face_that_loses_a_corner_is_an_error_at_its_line);
    tcase_add_test(all, other_numbers_stay_names_in_the_scene);
    tcase_add_test(all, a_run_writes_one_row_for_a_welded_vertex_and_goes_on);
    tcase_add_test(all, a_flat_file_without_vt_is_its_own_rest_shape);
    tcase_add_test(all, a_flat_file_has_the_coordinates_of_its_axes_exactly);
    tcase_add_test(all, vertices_without_faces_do_not_make_a_file_less_flat);
    tcase_add_test(all, a_nearly_flat_file_is_laid_in_its_plane_with_a_warning);
    tcase_add_test(all, a_flat_file_of_numbers_near_the_largest_is_refused);
    tcase_add_test(all, a_welded_vertex_of_a_flat_file_rests_where_the_lowest_does);
    tcase_add_test(all, check_says_where_the_warp_of_a_file_without_vt_lies);
    suite_add_tcase(suite, all);
    return suite;
}
