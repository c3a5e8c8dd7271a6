/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow */
/* test_cut.c -- cloth.cut: the mesh of an outline, its holes and lines, and what of
 * them is wrong, each at its line. */
#include "scene_load.h"

#include <math.h>
#include <stdlib.h>

#include "shell.h"

#define OUT BUILD_DIR "/cut"

#ifndef WEFT_QHULL

START_TEST(a_weft_without_a_mesher_says_so)
{
    ck_assert_int_eq(shell("mkdir -p " OUT), 0);
    write_file(OUT "/cut.yaml", "weft: 1\ncloth:\n  cut: {outline: {disc: 1}, spacing: "
                                "0.1}\n  fabric: {density: 1, stretch: 1}\nstepper: "
                                "{plugin: verlet, method: velocity_verlet, fixed_step: "
                                "0.1}\nrun: {duration: 1}\n");
    expect(shell(WEFT " check " OUT "/cut.yaml 2>&1"), 3);
    says("cut needs the mesher of the program weft, built with Qhull");
}
END_TEST

TEST_SUITE(cut)
{
    Suite *all = suite_create("cut");
    TCase *none = tcase_create("none");
    tcase_add_test(none, a_weft_without_a_mesher_says_so);
    suite_add_tcase(all, none);
    return all;
}

#else

#include "program/cut/cut.h"

#define RING                                                                           \
    "outline: {disc: 0.15}\n    holes: [{disc: 0.05, at: [0.02, 0]}]\n    spacing: "   \
    "0.01"
#define L_SHAPE                                                                        \
    "outline: [[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], [0, 1]]\n    spacing: " \
    "0.05"
#define SQUARE "outline: [[0, 0], [1, 0], [1, 1], [0, 1]]\n    spacing: 0.1\n    "

static weft_scene_def with_cut(const char *keys)
{
    static char text[4096];
    (void)snprintf(text, sizeof text,
                   "weft: 1\ncloth:\n  cut:\n    %s\n  fabric: {density: 1, stretch: "
                   "1}\nstepper: {plugin: verlet, method: velocity_verlet, fixed_step: "
                   "0.001}\nrun: {duration: 1}\n",
                   keys);
    weft_scene_def def = scene_of_text(text);
    def.mesh_cut = cut_mesh;
    return def;
}

static weft_scene *good_cut(const char *keys)
{
    const weft_scene_def def = with_cut(keys);
    return good_scene(&def);
}

static void bad_cut(const char *keys, const char *wanted)
{
    const weft_scene_def def = with_cut(keys);
    const char *text = bad_scene(&def);
    ck_assert_msg(strstr(text, wanted) != NULL, "no '%s' in\n%s", wanted, text);
}

static const weft_mesh_def *mesh_of(const weft_scene *scene)
{
    return weft_scene_cloth(scene)->mesh;
}

static const double *corner(const weft_mesh_def *mesh, size_t t, size_t k)
{
    return &mesh->rest[2 * mesh->corner_uv[3 * t + k]];
}

/* u v of each vertex, which has one place. */
static const double *rest_of(const weft_mesh_def *mesh)
{
    static double rest[1 << 14];
    ck_assert_uint_le(2 * mesh->vertices, sizeof rest / sizeof *rest);
    for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
        memcpy(&rest[2 * mesh->corners[i]], corner(mesh, i / 3, i % 3),
               2 * sizeof *rest);
    }
    return rest;
}

static double twice_area(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double area_of(const weft_mesh_def *mesh)
{
    double sum = 0.0;
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const double area
            = twice_area(corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2));
        ck_assert(area > 0.0);
        sum += 0.5 * area;
    }
    return sum;
}

/* [degrees] */
static double least_angle(const weft_mesh_def *mesh)
{
    double least = 180.0;
    for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
        const double *a = corner(mesh, i / 3, i % 3),
                     *b = corner(mesh, i / 3, (i + 1) % 3),
                     *c = corner(mesh, i / 3, (i + 2) % 3);
        const double dot
            = (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
        least = fmin(least, 57.29577951308232 * atan2(twice_area(a, b, c), dot));
    }
    return least;
}

/* Edges that two triangles have, and those of one: of the border. */
typedef struct edges {
    size_t inner, border;
} edges;

static int by_ends(const void *a, const void *b)
{
    return memcmp(a, b, 2 * sizeof(uint32_t));
}

static edges edges_of(const weft_mesh_def *mesh)
{
    edges count = { 0, 0 };
    const size_t n = 3 * mesh->triangles;
    uint32_t(*list)[2] = malloc(n * sizeof *list);
    ck_assert_ptr_nonnull(list);
    for (size_t i = 0; i < n; ++i) {
        const uint32_t a = mesh->corners[i],
                       b = mesh->corners[i % 3 == 2 ? i - 2 : i + 1];
        list[i][0] = a < b ? a : b;
        list[i][1] = a < b ? b : a;
    }
    qsort(list, n, sizeof *list, by_ends);
    for (size_t i = 0; i < n; ++i) {
        const bool pair = i + 1 < n && by_ends(list[i], list[i + 1]) == 0;
        count.inner += pair;
        count.border += !pair;
        i += pair;
    }
    free(list);
    return count;
}

static long euler(const weft_mesh_def *mesh)
{
    const edges count = edges_of(mesh);
    return (long)mesh->vertices - (long)(count.inner + count.border)
           + (long)mesh->triangles;
}

/* ---- meshes -------------------------------------------------------------------- */

static const struct piece {
    const char *keys;
    double area;
    long euler;
} pieces[] = {
    { SQUARE, 1.0, 1 },
    { L_SHAPE, 0.64, 1 },
    { "outline: [[0, 0], [0.4, 0], [0.2, 0.6]]\n    spacing: 0.03", 0.12, 1 },
    { "outline: [[0, 0], [3, 0], [3, 0.01], [0, 0.01]]\n    spacing: 0.006", 0.03, 1 },
    { "outline: [[0, 0], [1, 0], [1, 1], [0, 1]]\n    holes: [[[0.1, 0.1], [0.2, 0.1], "
      "[0.2, 0.4]], [[0.5, 0.5], [0.5, 0.8], [0.9, 0.8], [0.9, 0.5]]]\n    spacing: "
      "0.04",
      1.0 - 0.015 - 0.12, -1 },
    { SQUARE "lines: [[[0.2, 0.2], [0.8, 0.7]]]", 1.0, 1 }, /* a slit is an edge path */
    { SQUARE "lines: [[[-1, 0.3], [2, 0.4]], [[0.51, -1], [0.5, 2]], [[0, 0], [1, 1]], "
             "[[0.5, 0], [1, 0], [0.7, 0.2]], {disc: 0.3, at: [0.5, 0.5]}]",
      1.0, 1 }, /* lines cross each other, leave the piece, and run along its border */
    { "outline: [[0, 0], [1, 0], [1, 1], [0.501, 1], [0.5, 0.99], [0.499, 1], [0, 1]]\n"
      "    spacing: 0.05",
      1.0 - 1e-5, 1 },
};

START_TEST(area_and_topology_are_those_of_the_piece)
{
    const struct piece *of = &pieces[_i];
    weft_scene *scene = good_cut(of->keys);
    const weft_mesh_def *mesh = mesh_of(scene);
    ck_assert_double_eq_tol(area_of(mesh), of->area, 1e-12);
    ck_assert_int_eq(euler(mesh), of->euler);
    ck_assert_uint_eq(mesh->vertices, mesh->uv_count);
    ck_assert_uint_eq(found.count, 0);
    ck_assert_double_ge(least_angle(mesh), 25.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_disc_is_a_polygon_of_the_spacing)
{
    weft_scene *scene = good_cut("outline: {disc: 0.15}\n    spacing: 0.005");
    const weft_mesh_def *mesh = mesh_of(scene);
    const double n = 188.0; /* 2 pi 0.15 / 0.005 = 188.5 */
    ck_assert_double_eq_tol(area_of(mesh),
                            0.5 * n * 0.0225 * sin(6.283185307179586 / n), 1e-14);
    ck_assert_double_ge(least_angle(mesh), 25.0);
    /* regular triangles of that edge would be 3265 vertices */
    ck_assert_double_eq_tol((double)mesh->vertices, 3265.0, 0.04 * 3265.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_ring_has_no_inside)
{
    weft_scene *scene = good_cut(RING);
    const weft_mesh_def *mesh = mesh_of(scene);
    const double *rest = rest_of(mesh);
    ck_assert_int_eq(euler(mesh), 0);
    ck_assert_double_ge(least_angle(mesh), 25.0);
    for (size_t i = 0; i < mesh->vertices; ++i) {
        const double u = rest[2 * i] - 0.02, v = rest[2 * i + 1];
        ck_assert_double_ge(u * u + v * v, 0.0499 * 0.0499);
    }
    weft_scene_destroy(scene);
}
END_TEST

/* Only vertices are on a line, and no edge has its ends on both sides of it. */
START_TEST(no_edge_crosses_a_line)
{
    weft_scene *scene = good_cut(SQUARE "lines: [[[0, 0.3], [1, 0.62]]]");
    const weft_mesh_def *mesh = mesh_of(scene);
    const double a[] = { 0, 0.3 }, b[] = { 1, 0.62 };
    size_t along = 0;
    for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
        const double p = twice_area(a, b, corner(mesh, i / 3, i % 3)),
                     q = twice_area(a, b, corner(mesh, i / 3, (i + 1) % 3));
        ck_assert(!(p < -1e-12 && q > 1e-12));
        along += fabs(p) < 1e-12 && fabs(q) < 1e-12;
    }
    ck_assert_uint_ge(along, 20); /* of 10 edges and more, from both sides */
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(the_border_comes_first_in_order_and_then_rows)
{
    weft_scene *scene = good_cut(L_SHAPE);
    const weft_mesh_def *mesh = mesh_of(scene);
    static const double at[] = { 0, 0, 1, 0, 1, 0.4, 0.4, 0.4, 0.4, 1, 0, 1 };
    static const size_t number[] = { 0, 20, 28, 40, 52, 60 }; /* 0.05 m apart */
    const double *rest = rest_of(mesh);
    for (size_t i = 0; i < 6; ++i) {
        ck_assert_mem_eq(&rest[2 * number[i]], &at[2 * i], 2 * sizeof *at);
    }
    const size_t border = edges_of(mesh).border;
    ck_assert_uint_eq(border, 80);
    const double row = 0.05 * 0.8660254037844386;
    for (size_t i = border + 1; i < mesh->vertices; ++i) {
        const double a = floor(rest[2 * i - 1] / row), b = floor(rest[2 * i + 1] / row);
        ck_assert(a < b || (a == b && rest[2 * i - 2] < rest[2 * i]));
    }
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(vertices_start_on_the_plane_of_right_and_down)
{
    weft_scene *scene = good_cut(
        SQUARE "origin: [1, 2, 3]\n    right: [0, 2, 0]\n    down: [0, 0, 5]\n    "
               "scale: 0.5");
    const weft_mesh_def *mesh = mesh_of(scene);
    for (size_t i = 0; i < mesh->vertices; ++i) {
        const double *x = &mesh->start[3 * i], *place = &rest_of(mesh)[2 * i];
        ck_assert(x[0] == 1.0 && x[1] == 2.0 + 0.5 * place[0]
                  && x[2] == 3.0 + 0.5 * -place[1]);
    }
    weft_scene_destroy(scene);
}
END_TEST

static bool same_mesh(const char *one, const char *two)
{
    weft_scene *a = good_cut(one);
    char *text = strdup(weft_scene_mesh_text(a));
    weft_scene_destroy(a);
    weft_scene *b = good_cut(two);
    const bool same = strcmp(text, weft_scene_mesh_text(b)) == 0;
    weft_scene_destroy(b);
    free(text);
    return same;
}

START_TEST(the_same_cut_is_the_same_mesh)
{
    ck_assert(same_mesh(RING, RING));
    ck_assert(same_mesh(RING, RING "\n    seed: 1"));
    ck_assert(!same_mesh(RING, RING "\n    seed: 2"));
    ck_assert(same_mesh(SQUARE, "outline: [[0, 0], [0, 1], [1, 1], [1, 0]]\n    "
                                "spacing: 0.1\n    ")); /* clockwise */
}
END_TEST

START_TEST(lines_and_holes_are_groups)
{
    const weft_scene_def plain = with_cut(
        RING "\n    lines: [[[0.08, -0.2], [0.08, 0.2]]]\n  pins: [{group: outline}, "
             "{group: hole0}, {group: line0}]");
    weft_scene *scene = good_scene(&plain);
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const double *rest = rest_of(cloth->mesh);
    for (size_t p = 0; p < 3; ++p) {
        const weft_pin *pin = &cloth->pins[p];
        ck_assert_uint_ge(pin->vertex_count, 20);
        for (size_t i = 0; i < pin->vertex_count; ++i) {
            const double *x = &rest[2 * pin->vertices[i]];
            const double out = sqrt(x[0] * x[0] + x[1] * x[1]);
            const double in = sqrt((x[0] - 0.02) * (x[0] - 0.02) + x[1] * x[1]);
            ck_assert(p == 0   ? fabs(out - 0.15) < 2e-4
                      : p == 1 ? fabs(in - 0.05) < 4e-4
                               : fabs(x[0] - 0.08) < 1e-12);
        }
    }
    weft_scene_destroy(scene);
}
END_TEST

/* ---- mistakes ------------------------------------------------------------------ */

START_TEST(mistakes_stand_at_their_line)
{
    static const struct {
        const char *keys, *wanted;
    } bad[] = {
        { "outline: [[0, 0], [1, 0], [0, 1], [1, 1]]\n    spacing: 0.1",
          "scene.yaml:4:39: error: the outline crosses or touches itself" },
        { "outline: [[0, 0], [1, 0],\n      [1, 0], [1, 1]]\n    spacing: 0.1",
          "scene.yaml:5:7: error: a point that is there twice, at [1, 0] m" },
        { "outline: [[0, 0], [1, 0], [0.5, 1], [0.5, 0]]\n    spacing: 0.1",
          "the outline crosses or touches itself" },
        { "outline: [[0, 0], [1, 0], [2, 0]]\n    spacing: 0.1",
          "the outline crosses or touches itself" },
        { SQUARE "holes:\n    - {disc: 0.2, at: [0.5, 0.5]}\n    - {disc: 0.2, at: [5, "
                 "0]}",
          "scene.yaml:8:7: error: hole 1 lies outside the outline" },
        { SQUARE
          "holes:\n    - {disc: 0.2, at: [0.5, 0.5]}\n    - {disc: 0.1, at: [0.5, "
          "0.5]}",
          "scene.yaml:8:7: error: hole 1 lies in hole 0" },
        { SQUARE
          "holes:\n    - {disc: 0.2, at: [0.5, 0.5]}\n    - {disc: 0.2, at: [0.6, "
          "0.5]}",
          "scene.yaml:8:7: error: hole 1 crosses or touches hole 0" },
        { SQUARE "holes:\n    - [[0.5, 0], [0.6, 0.2], [0.4, 0.2]]",
          "error: hole 0 crosses or touches the outline" },
        { SQUARE "holes:\n    - {disc: 1.0e-4, at: [0.5, 0.5]}",
          "scene.yaml:7:7: error: a disc of 0.0001 m is 0.00628 spacings around" },
        { SQUARE "lines:\n    - [[2, 0], [3, 1]]",
          "scene.yaml:7:7: error: this line has no part of its own inside the piece" },
        { "outline: {disc: 1}\n    spacin: 0.1",
          "scene.yaml:5:5: error: unknown key 'spacin'" },
        { "outlin: {disc: 1}\n    spacing: 0.1", "error: unknown key 'outlin'" },
        { "outline: [[0, 0], [.nan, 0], [1, 1]]\n    spacing: 0.1",
          "scene.yaml:4:24: error: outline[1][0] must be a number [m], not '.nan'" },
        { "outline: [[0, 0], [1, 0]]\n    spacing: 0.1",
          "outline must be a list of 3 or more points" },
        { "outline: {disc: -1}\n    spacing: 0.1", "disc must be a number > 0" },
        { "outline: {disc: 1}\n    spacing: 3",
          "scene.yaml:5:14: error: spacing 3 m is larger than the piece of 2 x 2 m" },
        { "outline: {disc: 1}\n    spacing: 1.0e-4",
          "scene.yaml:5:14: error: spacing 0.0001 m makes some 3.63e+08 vertices" },
        { "outline: {disc: 1}\n    spacing: 1.0e-9", "spacings around" },
        { "outline: {disc: 1}\n    spacing: 0.1\n    down: [1, 0, 0]",
          "scene.yaml:6:11: error: down [1, 0, 0] is not perpendicular" },
        { "outline: {disc: 1}", "cut lacks the required key 'spacing'" },
        { SQUARE "rows: 3", "unknown key 'rows' in cut" },
        { SQUARE "\n  grid: {rows: 2, cols: 2, spacing: 1}", "excludes" },
        { SQUARE "\n  fabrics: {collar: {density: 1, stretch: 1}}",
          "the mesh has no usemtl 'collar'" },
        { SQUARE "\n  pins: [{group: hole0}]", "the mesh has no group 'hole0'" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        bad_cut(bad[i].keys, bad[i].wanted);
    }
}
END_TEST

START_TEST(all_mistakes_are_reported_at_once)
{
    const weft_scene_def def = with_cut(
        "outline: [[0, 0], [1], [0, x]]\n    holes: 3\n    lines: [{disc: 0}]\n    "
        "spacing: -1");
    (void)bad_scene(&def);
    ck_assert_uint_eq(found.errors, 5);
}
END_TEST

/* Lines that meet at small angles must not fill the corner with points without end. */
START_TEST(small_angles_between_lines_end)
{
    weft_scene *scene = good_cut(
        SQUARE
        "lines: [[[0.2, 0.2], [0.9, 0.21]], [[0.2, 0.2], [0.9, 0.2199]], [[0.2, "
        "0.2], [0.9, 0.2298]], [[0.1, 0.205], [0.8, 0.2085]], [[0.3, 0.1], [0.31, "
        "0.9]]]");
    ck_assert_uint_le(mesh_of(scene)->vertices, 2000);
    ck_assert_double_eq_tol(area_of(mesh_of(scene)), 1.0, 1e-12);
    ck_assert_ptr_nonnull(strstr(all_found(), "warning: the mesh has an angle of "));
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(sharp_corners_are_warned_of)
{
    weft_scene *scene
        = good_cut("outline: [[0, 0], [0.6, 0.05], [0, 0.1]]\n    spacing: 0.02");
    ck_assert_uint_eq(found.errors, 0);
    ck_assert_ptr_nonnull(strstr(all_found(),
                                 "scene.yaml:4:23: warning: a corner of 9.5 "
                                 "degrees"));
    ck_assert_ptr_nonnull(strstr(all_found(), "warning: the mesh has an angle of "));
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_reader_without_a_mesher_says_so)
{
    weft_scene_def def = with_cut(SQUARE);
    def.mesh_cut = NULL;
    ck_assert_ptr_nonnull(
        strstr(bad_scene(&def), "cut needs the mesher of the program weft"));
}
END_TEST

static size_t calls, fail_at, live;

static void *failing_resize(void *ctx, void *block, size_t size)
{
    (void)ctx;
    if (size == 0) {
        --live;
        free(block);
        return NULL;
    }
    if (++calls == fail_at) {
        return NULL;
    }
    live += block == NULL;
    return realloc(block, size);
}

/* Of the reader: a line that crosses, a refined cut, groups. */
START_TEST(every_failing_allocation_is_an_error)
{
    const weft_allocator memory = { failing_resize, NULL };
    weft_scene_def def
        = with_cut(SQUARE "holes: [{disc: 0.2, at: [0.5, 0.5]}]\n    lines: "
                          "[[[-1, 0.1], [2, 0.9]], [[0.1, 0], [0, 1]]]\n  "
                          "pins: [{group: line0}]");
    def.allocator = &memory;
    weft_scene_destroy(good_scene(&def));
    const size_t all = calls;
    size_t spared = 0;
    ck_assert_uint_gt(all, 40);
    for (fail_at = 1; fail_at <= all; ++fail_at) {
        weft_scene *scene = NULL;
        weft_error err = { 0 };
        calls = 0;
        const weft_status status = weft_scene_load(&def, &scene, &found, &err);
        ck_assert(status == WEFT_OK || status == WEFT_NO_MEMORY);
        spared += status == WEFT_OK;
        weft_scene_destroy(scene);
        ck_assert_uint_eq(live, 0);
    }
    ck_assert_uint_eq(spared, 1); /* a text that does not become smaller */
}
END_TEST

/* ---- runs ---------------------------------------------------------------------- */

static const char ring_scene[]
    = "weft: 1\nname: ring\ncloth:\n  cut:\n    " RING
      "\n    down: [0, 0, 1]\n  fabric: {density: 0.2, stretch: 100, shear: 20, "
      "damping: "
      "1.0e-4}\n  pins: [{group: hole0}]\nstepper: {plugin: verlet, method: "
      "velocity_verlet, fixed_step: 1.0e-4}\nrun: {duration: 0.02, fps: 100}\n";

START_TEST(a_run_keeps_its_mesh_and_repeats_from_it)
{
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/ring.yaml", ring_scene);
    expect(shell(WEFT " run " OUT "/ring.yaml --out " OUT "/a --quiet 2>&1"), 0);
    expect(shell("cp -r " OUT "/a " OUT "/b && rm -f " OUT "/b/r* " OUT
                 "/b/s*.csv && " WEFT " run " OUT "/b/scene.yaml --out " OUT
                 "/c --quiet 2>&1"),
           0);
    expect(shell("cd " OUT " && cmp a/final.csv c/final.csv && cmp a/scene.obj "
                 "c/scene.obj && cmp a/scene.yaml c/scene.yaml"),
           0);
    /* the mesh that ran is taken, not made anew */
    expect(shell("sed -i 's/^v 0.15 0 /v 0.16 0 /;s/^v 0.1499[0-9]* /v 0.16 /' " OUT
                 "/b/scene.obj && " WEFT " run " OUT "/b/scene.yaml --out " OUT
                 "/d --quiet 2>&1 && ! cmp -s " OUT "/a/final.csv " OUT "/d/final.csv"),
           0);
}
END_TEST

/* Runs ring.yaml with the mesh of a file instead of its cut, whether it ends as OUT/a.
 */
static bool same_end(const char *file, const char *out)
{
    expect(shell("awk '/^  cut:/ { print \"  mesh: {file: %s}\"; skip = 1; next } /^  "
                 "[a-z]/ { skip = 0 } !skip' " OUT "/ring.yaml >" OUT
                 "/%s.yaml && " WEFT " run " OUT "/%s.yaml --out " OUT
                 "/%s --quiet 2>&1",
                 file, out, out, out),
           0);
    return shell("cmp -s " OUT "/a/final.csv " OUT "/%s/final.csv", out) == 0;
}

START_TEST(a_garment_is_the_same_cloth)
{
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/ring.yaml", ring_scene);
    expect(shell(WEFT " run " OUT "/ring.yaml --out " OUT "/a --quiet 2>&1"), 0);
    expect(shell(WEFT " export " OUT "/ring.yaml --garment " OUT "/g.obj"), 0);
    says(OUT "/g.obj\n");
    expect(shell(WEFT " export " OUT "/a --garment " OUT "/h.obj 2>&1"), 0);
    expect(shell("cmp " OUT "/g.obj " OUT "/h.obj && cmp " OUT "/g.obj " OUT
                 "/a/scene.obj"),
           0);
    ck_assert(same_end("g.obj", "g"));
    expect(shell(WEFT " export " OUT "/g --garment " OUT "/i.obj && cmp " OUT
                      "/g.obj " OUT "/i.obj"),
           0);
    expect(shell(WEFT " export " OUT "/a --garment " OUT "/g.obj 2>&1"), 4);
    says("g.obj: the file exists");
    expect(shell(WEFT " export scenes/chain.yaml --garment " OUT "/j.obj 2>&1"), 3);
    says("a garment needs cloth.cut or cloth.mesh, not a grid");
    expect(shell(WEFT " export " OUT "/a --garment " OUT "/j.obj --format obj 2>&1"),
           2);
}
END_TEST

/* Six decimals, vt in another order, and no points: as Blender writes it. Vertices keep
 * their numbers, and places their place to half a millionth. */
START_TEST(a_garment_survives_another_program)
{
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/ring.yaml", ring_scene);
    expect(shell(WEFT
                 " export " OUT "/ring.yaml --garment " OUT "/g.obj && awk '/^v / { "
                 "printf \"v %%.6f %%.6f %%.6f\\n\", $2, $3, $4 } /^vt/ { t[++n] = "
                 "sprintf(\"vt %%.6f %%.6f\", $2, $3) } /^f/ && !done { for (i = n; i; "
                 "--i) print t[i]; done = 1 } /^f/ { for (i = 2; i < 5; ++i) { "
                 "split($i, c, \"/\"); $i = c[1] \"/\" n + 1 - c[2] } print }' " OUT
                 "/g.obj >" OUT "/b.obj"),
           0);
    weft_scene *scenes[2];
    for (int i = 0; i < 2; ++i) {
        char text[1024];
        (void)snprintf(
            text, sizeof text,
            "weft: 1\ncloth:\n  mesh: {file: %s}\n  fabric: {density: 1, "
            "stretch: 1}\nstepper: {plugin: verlet, method: velocity_verlet, "
            "fixed_step: 1.0e-3}\nrun: {duration: 1}\n",
            i == 0 ? "g.obj" : "b.obj");
        weft_scene_def def = scene_of_text(text);
        def.file = OUT "/any.yaml";
        scenes[i] = good_scene(&def);
    }
    const weft_mesh_def *a = mesh_of(scenes[0]), *b = mesh_of(scenes[1]);
    ck_assert_uint_eq(a->vertices, b->vertices);
    ck_assert_uint_eq(a->triangles, b->triangles);
    for (size_t i = 0; i < 6 * a->triangles; ++i) {
        ck_assert_uint_eq(a->corners[i / 2], b->corners[i / 2]);
        ck_assert_double_eq_tol(corner(a, i / 6, i / 2 % 3)[i % 2],
                                corner(b, i / 6, i / 2 % 3)[i % 2], 0.51e-6);
    }
    weft_scene_destroy(scenes[0]);
    weft_scene_destroy(scenes[1]);
}
END_TEST

/* ---- finer meshes -------------------------------------------------------------- */

/* Two triangles, the second of which may lie elsewhere at rest: sewn then. */
static weft_scene *refined(const char *second, size_t by, const char *pins)
{
    static char text[1024];
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    (void)snprintf(text, sizeof text,
                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 "
                   "1\nvt 5 0\nvt 6 1\nvt 5 1\ng low\nf 1/1 2/2 3/3\ng high\n%s\n",
                   second);
    write_file(OUT "/two.obj", text);
    (void)snprintf(
        text, sizeof text,
        "weft: 1\ncloth:\n  mesh: {file: two.obj, unit: 2}\n  fabric: {density: "
        "1, stretch: 1}\n  pins: [%s]\nstepper: {plugin: verlet, method: "
        "velocity_verlet, fixed_step: 1.0e-3}\nrun: {duration: 1}\n",
        pins);
    weft_scene_def def = scene_of_text(text);
    def.file = OUT "/two.yaml";
    def.refine = by;
    return good_scene(&def);
}

START_TEST(a_file_is_refined_by_splitting)
{
    static const char *const seconds[] = { "f 1/1 3/3 4/4", "f 1/5 3/6 4/7" };
    for (size_t sewn = 0; sewn < 2; ++sewn) {
        weft_scene *scene = refined(seconds[sewn], 4,
                                    "{vertices: [3]}, {group: low}, "
                                    "{near: [1, 1, 0]}");
        const weft_cloth_def *cloth = weft_scene_cloth(scene);
        const weft_mesh_def *mesh = cloth->mesh;
        static const double start[] = { 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0 };
        ck_assert_uint_eq(mesh->triangles, 32);
        ck_assert_uint_eq(mesh->vertices, 25);
        ck_assert_uint_eq(mesh->uv_count, sewn ? 30 : 25);
        ck_assert_int_eq(euler(mesh), 1);
        ck_assert_double_eq(area_of(mesh), 4.0);
        ck_assert_mem_eq(mesh->start, start, sizeof start);
        ck_assert_uint_eq(cloth->pins[0].vertices[0], 3);
        /* half a square of 5 x 5 with its diagonal, and its middle */
        ck_assert_uint_eq(cloth->pins[1].vertex_count, 15);
        const double *middle = &mesh->start[3 * cloth->pins[2].vertices[0]];
        ck_assert(middle[0] == 1.0 && middle[1] == 1.0);
        weft_cloth_destroy(test_cloth(cloth));
        weft_scene_destroy(scene);
    }
}
END_TEST

START_TEST(a_midpoint_belongs_to_a_group_if_both_ends_do)
{
    static const char second[] = "f 1/1 3/3 4/4\ng tip\np 1 4";
    weft_scene *scene = refined(second, 2, "{group: tip}");
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert_uint_eq(cloth->pins[0].vertex_count, 3); /* 0, 3 and between */
    for (size_t i = 0; i < 3; ++i) {
        ck_assert(cloth->mesh->start[3 * cloth->pins[0].vertices[i]] == 0.0);
    }
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(what_cannot_be_refined_is_refused)
{
    weft_scene_destroy(refined("f 1/1 3/3 4/4", 1, "{vertices: [3]}"));
    weft_scene_def def = weft_scene_def_default();
    def.file = OUT "/two.yaml";
    def.refine = 2;
    static const char text[]
        = "weft: 1\ncloth:\n  mesh: {file: two.obj}\n  fabric: {density: 1, stretch: "
          "1}\nstepper: {plugin: verlet, method: velocity_verlet, fixed_step: "
          "1.0e-3}\nrun: {duration: 1}\n";
    def.text = text;
    def.length = sizeof text - 1;
    weft_scene_destroy(good_scene(&def));
    for (size_t by = 3; by <= (size_t)1 << 40; by *= 3) {
        def.refine = by;
        ck_assert_ptr_nonnull(strstr(bad_scene(&def),
                                     "two.yaml:3:16: error: a mesh of 2 triangles is "
                                     "refined by 2, 4, 8, ..."));
    }
    weft_scene_def cut = with_cut(SQUARE "\n  pins:\n    - {vertices: [0]}");
    weft_scene_destroy(good_scene(&cut));
    cut.refine = 2;
    ck_assert_ptr_nonnull(
        strstr(bad_scene(&cut), "vertices have other numbers in a finer cut"));
}
END_TEST

START_TEST(a_finer_cut_has_its_spacing_divided)
{
    weft_scene_def def = with_cut(L_SHAPE);
    def.refine = 2;
    weft_scene *fine = good_scene(&def);
    char *text = strdup(weft_scene_mesh_text(fine));
    weft_scene *same
        = good_cut("outline: [[0, 0], [1, 0], [1, 0.4], [0.4, 0.4], [0.4, 1], "
                   "[0, 1]]\n    spacing: 0.025");
    ck_assert_str_eq(text, weft_scene_mesh_text(same));
    free(text);
    weft_scene_destroy(fine);
    weft_scene_destroy(same);
}
END_TEST

/* The first value is that of a run; the energy of a membrane converges, of triangles
 * that are split with order 2. */
START_TEST(converge_refines_a_cut_and_a_file)
{
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(
        OUT "/ring.yaml",
        "weft: 1\nname: ring\ncloth:\n  cut:\n    outline: [[0, 0], [1, 0], [1, 1], "
        "[0, 1]]\n    spacing: 0.2\n    "
        "scale: 1.1\n    down: [0, 0, 1]\n  fabric: {density: 0.2, stretch: 60, "
        "shear: 20}\n  pins: [{group: outline}]\nforces: {wind: {velocity: [0, 0, "
        "0], drag: 10}}\nstepper: {plugin: verlet, method: velocity_verlet, "
        "fixed_step: 2.5e-4}\nrun: {duration: 1.5, fps: 1}\n");
    expect(shell(WEFT " run " OUT "/ring.yaml --out " OUT "/a --quiet"), 0);
    ck_assert(same_end("a/scene.obj", "g"));
    for (int file = 0; file < 2; ++file) {
        double value[3], order;
        expect(shell(WEFT " converge " OUT
                          "/%s.yaml --sizes 1,2,4%s --at elastic --at 25.y "
                          "--csv --quiet >" OUT "/out && grep -c 25.y " OUT "/out",
                     file ? "g" : "ring", file ? ",8" : ""),
               0);
        says(file ? "4" : "3");
        expect(shell("awk -F, '/^.elastic/ { print $5 }' " OUT
                     "/out | tail -n 3 && awk -F, '/^.elastic/ { order = $7 } END { "
                     "print order }' " OUT "/out"),
               0);
        ck_assert_int_eq(
            sscanf(output, "%lf %lf %lf %lf", &value[0], &value[1], &value[2], &order),
            4);
        ck_assert_double_lt(fabs(value[2] - value[1]), fabs(value[1] - value[0]));
        ck_assert(!file || (order > 1.5 && order < 2.5));
        expect(shell("grep 25.y.,1, " OUT "/out | cut -d, -f5 && awk -F, '$1 == 25 { "
                     "print $3 }' " OUT "/a/final.csv"),
               0);
        ck_assert_int_eq(sscanf(output, "%lf %lf", &value[0], &value[1]), 2);
        ck_assert_double_eq(value[0], value[1]);
    }
    expect(shell(WEFT " converge " OUT "/ring.yaml --sizes 2,1 2>&1"), 2);
    says(
        "--sizes needs 2 to 16 increasing numbers from 1 to 1000000, as --sizes 1,2,4");
    expect(shell(WEFT " converge " OUT "/ring.yaml --sizes 1,2 --at tip 2>&1"), 2);
    says("no column of series.csv and no vertex of ");
    expect(shell(WEFT " converge " OUT "/g.yaml --sizes 1,3 2>&1"), 3);
    says("is refined by 2, 4, 8, ...");
}
END_TEST

/* Cloth that does not bend lies flat; cloth that is limp hangs down. */
START_TEST(the_drape_of_stiff_cloth_is_100_percent)
{
    expect(shell("mkdir -p " OUT " && cd " OUT
                 " && ../weft lab drape royal-target --set "
                 "cloth.cut.spacing=0.015 --set cloth.fabric.bend=1 --set "
                 "cloth.fabric.twist=1"),
           0);
    ck_assert_double_eq_tol(atof(strstr(output, "coefficient ") + 12), 100.0, 0.5);
    expect(shell("cd " OUT " && ../weft lab drape ivory-rib-knit --set "
                 "cloth.cut.spacing=0.015"),
           0);
    ck_assert_double_lt(atof(strstr(output, "coefficient ") + 12), 70.0);
}
END_TEST

TEST_SUITE(cut)
{
    Suite *all = suite_create("cut");
    TCase *finer = tcase_create("finer");
    tcase_set_timeout(finer, 240);
    tcase_add_test(finer, a_file_is_refined_by_splitting);
    tcase_add_test(finer, a_midpoint_belongs_to_a_group_if_both_ends_do);
    tcase_add_test(finer, what_cannot_be_refined_is_refused);
    tcase_add_test(finer, a_finer_cut_has_its_spacing_divided);
    TCase *slow = test_long(all, 240);
    tcase_add_test(slow, converge_refines_a_cut_and_a_file);
    tcase_add_test(slow, the_drape_of_stiff_cloth_is_100_percent);
    suite_add_tcase(all, finer);
    TCase *meshes = tcase_create("meshes"), *errors = tcase_create("errors"),
          *runs = tcase_create("runs");
    tcase_add_loop_test(meshes, area_and_topology_are_those_of_the_piece, 0,
                        sizeof pieces / sizeof pieces[0]);
    tcase_add_test(meshes, a_disc_is_a_polygon_of_the_spacing);
    tcase_add_test(meshes, a_ring_has_no_inside);
    tcase_add_test(meshes, no_edge_crosses_a_line);
    tcase_add_test(meshes, the_border_comes_first_in_order_and_then_rows);
    tcase_add_test(meshes, vertices_start_on_the_plane_of_right_and_down);
    tcase_add_test(meshes, the_same_cut_is_the_same_mesh);
    tcase_add_test(meshes, lines_and_holes_are_groups);
    tcase_add_test(errors, mistakes_stand_at_their_line);
    tcase_add_test(errors, all_mistakes_are_reported_at_once);
    tcase_add_test(errors, small_angles_between_lines_end);
    tcase_add_test(errors, sharp_corners_are_warned_of);
    tcase_add_test(errors, a_reader_without_a_mesher_says_so);
    tcase_add_test(errors, every_failing_allocation_is_an_error);
    tcase_add_test(runs, a_run_keeps_its_mesh_and_repeats_from_it);
    tcase_add_test(runs, a_garment_is_the_same_cloth);
    tcase_add_test(runs, a_garment_survives_another_program);
    tcase_set_timeout(runs, 120);
    suite_add_tcase(all, meshes);
    suite_add_tcase(all, errors);
    suite_add_tcase(all, runs);
    return all;
}

#endif
