/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* Meshes whose rest shape lies in space: what is folded along its edges has the bending
 * of its flat twin, closed and one-sided surfaces are cloth, and neither numbers nor
 * the way round of corners matter. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth/model.h"
#include "surfaces.h"

#define PI 3.14159265358979323846

static const weft_rest flat_angles
    = { .shape = WEFT_REST_START, .angle = WEFT_ANGLE_FLAT };
static const weft_rest warped
    = { .shape = WEFT_REST_START, .angle = WEFT_ANGLE_FLAT, .warp = { 0.0, 1.0, 0.0 } };

/* ---- cloths ---------------------------------------------------------------------- */

/* The same mesh, which rests where it starts. */
static weft_mesh_def in_space(const test_mesh *of, const weft_rest *rest)
{
    weft_mesh_def def = of->def;
    def.rest = NULL, def.uv_count = 0, def.corner_uv = NULL;
    def.rests = rest;
    return def;
}

/* Forces and energies of two meshes in the same state agree. */
static void check_same(const weft_mesh_def *a, const weft_mesh_def *b,
                       const double *xyz, double tolerance)
{
    const weft_mesh_def *of[2] = { a, b };
    double *force[2], energy[2][2];
    const size_t n = a->vertices;
    for (size_t k = 0; k < 2; ++k) {
        weft_cloth *cloth = surface_cloth(of[k]);
        double *y = surface_state(cloth, xyz, NULL);
        const weft_energy found = weft_cloth_energy(cloth, 0.0, y);
        energy[k][0] = found.elastic[WEFT_BEND];
        energy[k][1] = found.elastic[WEFT_STRETCH] + found.elastic[WEFT_SHEAR];
        force[k] = surface_forces(cloth, y);
        free(y);
        weft_cloth_destroy(cloth);
    }
    const double most = surface_largest(force[0], 3 * n);
    ck_assert_double_gt(most, 0.0);
    for (size_t k = 0; k < 2; ++k) {
        ck_assert_double_gt(energy[0][k], 0.0);
        ck_assert_double_eq_tol(energy[1][k] / energy[0][k], 1.0, tolerance);
    }
    for (size_t j = 0; j < 3 * n; ++j) {
        ck_assert_double_eq_tol(force[1][j] / most, force[0][j] / most, tolerance);
    }
    free(force[0]);
    free(force[1]);
}

/* ---- the accordion --------------------------------------------------------------- */

/* Folds a sheet along its columns, by turns: an isometry. */
static void fold_columns(test_mesh *of)
{
    static const double lean[] = { 0.0, 0.9, -0.7, 1.4, 0.2, -1.0, 0.5, 0.1 };
    for (size_t r = 0; r < of->rows; ++r) {
        double x = 0.0, z = 0.0;
        for (size_t c = 0; c < of->cols; ++c) {
            const size_t i = r * of->cols + c;
            if (c > 0) {
                const double step = of->rest[2 * i] - of->rest[2 * (i - 1)];
                x += step * cos(lean[c - 1]);
                z += step * sin(lean[c - 1]);
            }
            of->start[3 * i] = x;
            of->start[3 * i + 1] = of->rest[2 * i + 1];
            of->start[3 * i + 2] = z;
        }
    }
}

/* A sheet whose columns are straight, with any diagonals. */
static void make_accordion(test_mesh *of, test_diagonals diagonals)
{
    mesh_sheet(of, 6, 9, 0.05, diagonals, 0.0, 5);
    for (size_t i = 0; i < 54; ++i) { /* columns and rows of several widths */
        const double u = of->rest[2 * i], v = of->rest[2 * i + 1];
        of->rest[2 * i] = u + 0.3 * u * u, of->rest[2 * i + 1] = v - 0.8 * v * v;
    }
    fold_columns(of);
}

START_TEST(an_accordion_is_its_flat_twin)
{
    test_mesh mesh;
    make_accordion(&mesh, (test_diagonals)_i);
    const weft_mesh_def folded = in_space(&mesh, &warped);
    double *xyz = surface_shaken(mesh.start, mesh.def.vertices, 1e-3, 8);
    check_same(&mesh.def, &folded, xyz, 1e-12);
    free(xyz);
    mesh_free(&mesh);
}
END_TEST

/* Both free of bending as they start, which neither shakes. */
START_TEST(an_accordion_keeps_its_folds_as_its_flat_twin_does)
{
    static const weft_rest plane = { .angle = WEFT_ANGLE_START },
                           space
                           = { .shape = WEFT_REST_START, .warp = { 0.0, 1.0, 0.0 } };
    test_mesh mesh;
    make_accordion(&mesh, (test_diagonals)_i);
    const weft_mesh_def folded = in_space(&mesh, &space);
    weft_mesh_def pressed = mesh.def;
    pressed.rests = &plane;
    double *xyz = surface_shaken(mesh.start, mesh.def.vertices, 1e-3, 8);
    check_same(&pressed, &folded, xyz, 1e-11);
    free(xyz);
    mesh_free(&mesh);
}
END_TEST

/* A fabric that is alike in all directions needs no warp; the arc of its membrane needs
 * the one that it has at rest taken off. */
START_TEST(an_arc_is_measured_from_its_rest)
{
    test_mesh mesh;
    make_accordion(&mesh, MESH_RANDOM);
    weft_mesh_def folded = in_space(&mesh, &flat_angles);
    folded.arc = true;
    weft_cloth *cloth = surface_cloth(&folded);
    double *y = surface_state(cloth, mesh.start, NULL);
    const weft_energy rest = weft_cloth_energy(cloth, 0.0, y);
    ck_assert_double_gt(rest.elastic[WEFT_BEND], 1e-6);
    ck_assert_double_le(rest.elastic[WEFT_STRETCH] + rest.elastic[WEFT_SHEAR],
                        1e-20 * rest.elastic[WEFT_BEND]);
    free(y);
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

/* ---- surfaces of any kind -------------------------------------------------------- */

/* x K x of one function of the vertices, by the force where x is the only coordinate.
 */
static double square_of(const surface *of, const double *f)
{
    weft_cloth *cloth = surface_cloth(&of->def);
    const size_t n = of->vertices;
    double *planes = calloc(6 * n, sizeof *planes),
           *force = calloc(3 * n, sizeof *force);
    double sum = 0.0;
    for (size_t i = 0; i < n; ++i) {
        planes[weft_cloth_index(cloth, i)] = f[i];
    }
    sum = 2.0 * weft_cloth_energy(cloth, 0.0, planes).elastic[WEFT_BEND];
    free(planes);
    free(force);
    weft_cloth_destroy(cloth);
    return sum;
}

/* On the unit sphere, int |grad grad f|^2 = (e^2 - e) int f^2 if e is the eigenvalue of
 * the Laplacian: 6 of f = x y, whose int f^2 is 4 pi / 15. */
static double sphere_error(size_t fine, double jitter)
{
    surface sphere;
    make_sphere(&sphere, fine, jitter);
    sphere.fabric.bend[0] = sphere.fabric.bend[1] = sphere.fabric.twist = 1.0;
    surface_point(&sphere, &flat_angles);
    double *f = malloc(sphere.vertices * sizeof *f);
    for (size_t i = 0; i < sphere.vertices; ++i) {
        f[i] = sphere.start[3 * i] * sphere.start[3 * i + 1];
    }
    const double found = square_of(&sphere, f);
    free(f);
    surface_free(&sphere);
    return found / (30.0 * 4.0 * PI / 15.0) - 1.0;
}

START_TEST(bending_of_a_sphere_converges)
{
    const double coarse = sphere_error(3, 0.2), middle = sphere_error(4, 0.2),
                 fine = sphere_error(5, 0.2);
    ck_assert_double_le(fabs(coarse), 0.15);
    ck_assert_double_ge(fabs(coarse / middle), 3.2);
    ck_assert_double_ge(fabs(middle / fine), 3.2);
    ck_assert_double_le(fabs(fine), 0.01);
}
END_TEST

/* A tube of radius 1 and length 1 of n x m cells with moved vertices: its energy is
 * that of the curvature 1 around it, pi B. */
static double tube_error(size_t n, size_t m)
{
    surface of;
    uint64_t seed = 6;
    surface_take(&of, n * (m + 1), 2 * n * m);
    for (size_t i = 0; i < n * (m + 1); ++i) {
        const bool inner = i % (m + 1) > 0 && i % (m + 1) < m;
        const double du = 0.2 * (2.0 * random_uniform(&seed) - 1.0);
        const double dv = 0.2 * (2.0 * random_uniform(&seed) - 1.0);
        const double a = 2.0 * PI * ((double)(i / (m + 1)) + du) / (double)n;
        of.start[3 * i] = cos(a), of.start[3 * i + 1] = sin(a);
        of.start[3 * i + 2] = ((double)(i % (m + 1)) + (inner ? dv : 0.0)) / (double)m;
    }
    for (size_t k = 0; k < n * m; ++k) {
        const size_t i = k / m, j = k % m, next = (i + 1) % n;
        const uint32_t a = (uint32_t)(i * (m + 1) + j), b = a + 1,
                       c = (uint32_t)(next * (m + 1) + j), d = c + 1;
        const bool rising = random_uniform(&seed) < 0.5;
        const uint32_t up[6] = { a, c, d, a, d, b }, down[6] = { a, c, b, c, d, b };
        memcpy(&of.corners[6 * k], rising ? up : down, sizeof up);
    }
    of.fabric.bend[0] = of.fabric.bend[1] = of.fabric.twist = 1.0;
    surface_point(&of, &flat_angles);
    weft_cloth *cloth = surface_cloth(&of.def);
    double *y = surface_state(cloth, of.start, NULL);
    const double found = weft_cloth_energy(cloth, 0.0, y).elastic[WEFT_BEND];
    free(y);
    weft_cloth_destroy(cloth);
    surface_free(&of);
    return found / PI - 1.0;
}

START_TEST(bending_of_a_tube_converges)
{
    const double coarse = tube_error(16, 3), middle = tube_error(32, 6),
                 fine = tube_error(64, 12);
    ck_assert_double_le(fabs(coarse), 0.1);
    ck_assert_double_ge(fabs(coarse / middle), 3.0);
    ck_assert_double_ge(fabs(middle / fine), 3.0);
}
END_TEST

/* Other numbers of vertices and triangles, other first corners, and four in ten turned
 * over. */
static void shuffle(const surface *of, surface *to, uint32_t *number)
{
    uint64_t seed = 17;
    surface_take(to, of->vertices, of->triangles);
    for (size_t i = 0; i < of->vertices; ++i) {
        number[i] = (uint32_t)i;
    }
    for (size_t i = of->vertices; i-- > 1;) {
        const size_t j = (size_t)(random_uniform(&seed) * (double)(i + 1));
        const uint32_t kept = number[i];
        number[i] = number[j], number[j] = kept;
    }
    for (size_t j = 0; j < 3 * of->vertices; ++j) {
        to->start[3 * number[j / 3] + j % 3] = of->start[j];
    }
    for (size_t t = 0; t < of->triangles; ++t) {
        const size_t from = (t * 7 + 3) % of->triangles, turn = t % 3;
        const bool over = random_uniform(&seed) < 0.4;
        for (size_t k = 0; k < 3; ++k) {
            const size_t c = over ? (turn + 3 - k) % 3 : (turn + k) % 3;
            to->corners[3 * t + k] = number[of->corners[3 * from + c]];
        }
    }
}

static void check_shuffled(surface *of, const weft_rest *rest)
{
    surface other;
    uint32_t *number = malloc(of->vertices * sizeof *number);
    double *force[2];
    shuffle(of, &other, number);
    surface_point(of, rest);
    surface_point(&other, rest);
    double *xyz = surface_shaken(of->start, of->vertices, 0.01, 9);
    double *moved = malloc(3 * of->vertices * sizeof *moved);
    for (size_t j = 0; j < 3 * of->vertices; ++j) {
        moved[3 * number[j / 3] + j % 3] = xyz[j];
    }
    for (size_t k = 0; k < 2; ++k) {
        weft_cloth *cloth = surface_cloth(k == 0 ? &of->def : &other.def);
        double *y = surface_state(cloth, k == 0 ? xyz : moved, NULL);
        force[k] = surface_forces(cloth, y);
        free(y);
        weft_cloth_destroy(cloth);
    }
    const double most = surface_largest(force[0], 3 * of->vertices);
    for (size_t j = 0; j < 3 * of->vertices; ++j) {
        ck_assert_double_eq_tol(force[1][3 * number[j / 3] + j % 3] / most,
                                force[0][j] / most, 1e-12);
    }
    free(force[0]);
    free(force[1]);
    free(xyz);
    free(moved);
    free(number);
    surface_free(&other);
}

START_TEST(numbers_and_turns_do_not_matter)
{
    surface of;
    if (_i % 2 == 0) {
        make_moebius(&of, 24, 4, 0.4);
    } else {
        make_sphere(&of, 3, 0.2);
    }
    static const weft_rest kept
        = { .shape = WEFT_REST_START, .warp = { 0.0, 1.0, 0.0 } };
    check_shuffled(&of, _i < 2 ? &flat_angles : _i < 4 ? &warped : &kept);
    surface_free(&of);
}
END_TEST

static weft_rest_report report_of(const surface *of)
{
    weft_cloth_def def = weft_cloth_def_default();
    weft_rest_report out;
    def.mesh = &of->def;
    ck_assert_int_eq(weft_cloth_def_rest(&def, 0, &out, NULL), WEFT_OK);
    return out;
}

START_TEST(a_report_names_what_a_surface_is)
{
    surface of;
    make_moebius(&of, 24, 4, 0.4);
    surface_point(&of, &flat_angles);
    weft_rest_report found = report_of(&of);
    ck_assert_uint_eq(found.pieces, 1);
    ck_assert_uint_eq(found.closed, 0);
    ck_assert_uint_eq(found.one_sided, 1);
    surface_free(&of);
    make_sphere(&of, 2, 0.0);
    for (size_t k = 0; k < 3; ++k) { /* three faces turned over */
        const uint32_t kept = of.corners[30 * k];
        of.corners[30 * k] = of.corners[30 * k + 1], of.corners[30 * k + 1] = kept;
    }
    surface_point(&of, &warped);
    found = report_of(&of);
    ck_assert_uint_eq(found.triangles, 128);
    ck_assert_uint_eq(found.closed, 1);
    ck_assert_uint_eq(found.one_sided, 0);
    ck_assert_uint_eq(found.flipped, 3);
    ck_assert_uint_gt(found.blended, 0);
    ck_assert_uint_eq(found.woven + found.blended, 128);
    ck_assert_double_lt(found.fold, PI / 3.0);
    ck_assert_uint_eq(found.sharp, 0);
    surface_free(&of);
    make_sphere(&of, 0, 0.0);
    surface_point(&of, &flat_angles);
    found = report_of(&of);
    ck_assert_double_eq_tol(found.defect, 2.0 * PI - 4.0 * PI / 3.0, 1e-12);
    ck_assert_double_eq_tol(found.fold, PI - acos(-1.0 / 3.0), 1e-12);
    ck_assert_uint_eq(found.sharp, 12);
    surface_free(&of);
}
END_TEST

/* K of any surface has one free motion for each coordinate, and no energy below 0. */
START_TEST(masses_and_areas_are_those_in_space)
{
    surface of;
    make_sphere(&of, 3, 0.0);
    surface_point(&of, &flat_angles);
    weft_cloth *cloth = surface_cloth(&of.def);
    double mass = 0.0;
    for (size_t i = 0; i < of.vertices; ++i) {
        mass += weft_cloth_particle_mass(cloth, i);
    }
    ck_assert_double_eq_tol(mass / (4.0 * PI * of.fabric.density), 1.0, 0.02);
    weft_cloth_destroy(cloth);
    surface_free(&of);
}
END_TEST

/* ---- what is refused ------------------------------------------------------------- */

static void check_refused(const weft_mesh_def *mesh, const char *words)
{
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    weft_error err;
    def.mesh = mesh;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, words) != NULL, "%s", err.message);
}

START_TEST(faults_are_refused)
{
    static const weft_rest plane = { .warp = { 0.0, 1.0, 0.0 } }, normal = {
        .shape = WEFT_REST_START, .angle = WEFT_ANGLE_FLAT, .warp = { 0.0, 0.0, 1.0 }
    };
    test_mesh sheet;
    mesh_sheet(&sheet, 3, 3, 0.1, MESH_RIGHT, 0.0, 1);
    weft_mesh_def def = in_space(&sheet, &normal);
    check_refused(&def, "is normal to the cloth");
    def = sheet.def;
    def.rests = &plane;
    check_refused(&def, "warp needs rest: start");
    def = in_space(&sheet, &flat_angles);
    uint32_t *more = malloc(30 * sizeof *more);
    memcpy(more, sheet.corners, 24 * sizeof *more);
    memcpy(more + 24, (uint32_t[]){ 0, 4, 2, 4, 0, 6 }, 6 * sizeof *more);
    def.corners = more;
    def.triangles = 10;
    check_refused(&def, "triangles; an edge has one or two");
    free(more);
    def = in_space(&sheet, &flat_angles);
    memcpy(&sheet.start[3], &sheet.start[0], 3 * sizeof(double));
    check_refused(&def, "in the start shape, which `rest: start` makes the rest shape");
    mesh_free(&sheet);
}
END_TEST

TEST_SUITE(space)
{
    Suite *suite = suite_create("space");
    TCase *tc = tcase_create("space");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, an_accordion_is_its_flat_twin, 0, 3);
    tcase_add_loop_test(tc, an_accordion_keeps_its_folds_as_its_flat_twin_does, 0, 3);
    tcase_add_test(tc, an_arc_is_measured_from_its_rest);
    tcase_add_test(tc, bending_of_a_sphere_converges);
    tcase_add_test(tc, bending_of_a_tube_converges);
    tcase_add_loop_test(tc, numbers_and_turns_do_not_matter, 0, 6);
    tcase_add_test(tc, a_report_names_what_a_surface_is);
    tcase_add_test(tc, masses_and_areas_are_those_in_space);
    tcase_add_test(tc, faults_are_refused);
    suite_add_tcase(suite, tc);
    return suite;
}
