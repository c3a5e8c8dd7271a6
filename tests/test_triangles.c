/* SPDX-License-Identifier: BSD-3-Clause */
/* test_triangles.c -- a mesh of triangles from its definition: order, places, pieces,
 * edges, masses, pins, what is refused. */
#include "meshes.h"

#include <math.h>

#include "cloth/model.h"
#include "mesh/triangles.h"

static weft_error err;

static weft_cloth *made(const test_mesh *of)
{
    const weft_cloth_def def = mesh_cloth(of);
    weft_cloth *cloth = NULL;
    ck_assert_msg(weft_cloth_create(&def, &cloth, &err) == WEFT_OK, "%s", err.message);
    return cloth;
}

static const char *refusal(const weft_cloth_def *def)
{
    weft_cloth *cloth = NULL;
    ck_assert_int_eq(weft_cloth_create(def, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_null(cloth);
    return err.message;
}

START_TEST(particles_are_a_permutation_of_vertices)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 31, 40, 0.01, MESH_RANDOM, 0.25, 7);
    mesh_shuffle(&mesh, 3, NULL);
    weft_cloth *cloth = made(&mesh);
    const weft__mesh *of = &cloth->mesh;
    double y[6 * 31 * 40];
    weft_cloth_start(cloth, y);
    for (size_t v = 0; v < mesh.def.vertices; ++v) {
        const size_t i = weft__particle_of(of, v);
        ck_assert_uint_eq(weft__vertex_of(of, i), v);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert(y[k * of->particles + i] == mesh.start[3 * v + k]);
        }
    }
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

START_TEST(order_does_not_depend_on_the_numbers_of_a_file)
{
    test_mesh mesh, other;
    uint32_t to[31 * 40];
    mesh_sheet(&mesh, 31, 40, 0.01, MESH_RANDOM, 0.25, 7);
    mesh_sheet(&other, 31, 40, 0.01, MESH_RANDOM, 0.25, 7);
    mesh_shuffle(&other, (uint64_t)_i + 1, to);
    weft_cloth *a = made(&mesh), *b = made(&other);
    const weft__triangles *p = a->mesh.triangles, *q = b->mesh.triangles;
    for (size_t i = 0; i < mesh.def.vertices; ++i) {
        ck_assert_uint_eq(to[p->vertex[i]], q->vertex[i]);
    }
    ck_assert_mem_eq(p->corner, q->corner, p->count * sizeof *p->corner);
    ck_assert_mem_eq(p->rest, q->rest, p->places * sizeof *p->rest);
    ck_assert_mem_eq(p->edge, q->edge, p->count * sizeof *p->edge);
    ck_assert_mem_eq(p->edge_list, q->edge_list, p->edges * sizeof *p->edge_list);
    ck_assert_uint_eq(weft__cloth_hash(a, NULL), weft__cloth_hash(b, NULL));
    weft_cloth_destroy(a);
    weft_cloth_destroy(b);
    mesh_free(&mesh);
    mesh_free(&other);
}
END_TEST

/* Euler: V - E + F = 1 of a disc, with the edges and places of its pieces. */
START_TEST(a_sewn_sheet_has_the_edges_and_places_of_two)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 5, 9, 0.1, MESH_ALTERNATING, 0.0, 1);
    mesh_sew(&mesh, 4, 0.3, 0.6, 0.8);
    weft_cloth *cloth = made(&mesh);
    const weft__triangles *of = cloth->mesh.triangles;
    ck_assert_uint_eq(of->pieces, 2);
    ck_assert_uint_eq(of->places, 2 * 5 * 5);
    ck_assert_uint_eq(of->places + of->count - of->edges, 2);
    size_t sewn = 0, rim = 0;
    for (size_t e = 0; e < of->edges; ++e) {
        const weft__edge *edge = &of->edge_list[e];
        sewn += edge->sewn != WEFT__NONE;
        rim += edge->sewn == WEFT__NONE && edge->triangle[1] == WEFT__NONE;
        if (edge->sewn != WEFT__NONE) {
            const weft__edge *twin = &of->edge_list[edge->sewn];
            ck_assert_uint_eq(twin->sewn, e);
            for (size_t k = 0; k < 2; ++k) {
                ck_assert_uint_eq(of->particle[edge->place[k]],
                                  of->particle[twin->place[k]]);
            }
        }
    }
    ck_assert_uint_eq(sewn, 2 * 4);
    ck_assert_uint_eq(rim, 2 * (4 + 8));
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

START_TEST(edges_lie_opposite_their_corners)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 6, 7, 0.1, MESH_RANDOM, 0.2, 5);
    weft_cloth *cloth = made(&mesh);
    const weft__triangles *of = cloth->mesh.triangles;
    for (size_t h = 0; h < 3 * of->count; ++h) {
        const size_t t = h / 3, k = h % 3;
        const weft__edge *edge = &of->edge_list[of->edge[t][k]];
        ck_assert(edge->triangle[0] == t || edge->triangle[1] == t);
        ck_assert(of->particle[edge->place[0]] < of->particle[edge->place[1]]);
        ck_assert(edge->place[0] != of->place[t][k]);
        ck_assert(edge->place[1] != of->place[t][k]);
        ck_assert_uint_lt(of->corner[t][0], of->corner[t][1]);
        ck_assert_uint_lt(of->corner[t][0], of->corner[t][2]);
    }
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

/* A back that uses the places of the front: a mirror image, sewn round its rim. */
START_TEST(a_mirrored_piece_shares_places_with_its_twin)
{
    const double start[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    const double rest[] = { 0, 0, 1, 0, 0, 1 };
    const uint32_t corners[] = { 0, 1, 2, 0, 2, 1 };
    weft_mesh_def def = weft_mesh_def_default();
    def.vertices = def.uv_count = 3, def.triangles = 2;
    def.start = start, def.rest = rest, def.corners = corners;
    def.fabrics = &mesh_fabric, def.fabric_count = 1;
    weft_cloth_def cloth_def = weft_cloth_def_default();
    cloth_def.mesh = &def;
    /* one rest shape for both would be joined edges, turned over */
    ck_assert_msg(strstr(refusal(&cloth_def), "turned over") != NULL, "%s",
                  err.message);
    const double twice[] = { 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1 };
    const uint32_t places[] = { 0, 1, 2, 3, 5, 4 };
    def.rest = twice, def.uv_count = 6, def.corner_uv = places;
    weft_cloth *cloth = NULL;
    ck_assert_msg(weft_cloth_create(&cloth_def, &cloth, &err) == WEFT_OK, "%s",
                  err.message);
    const weft__triangles *of = cloth->mesh.triangles;
    ck_assert_uint_eq(of->pieces, 2);
    ck_assert_uint_eq(of->edges, 6);
    for (size_t t = 0; t < 2; ++t) {
        ck_assert(of->area[t] == 0.5);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(masses_are_thirds_of_triangles_and_loads)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 2, 2, 0.5, MESH_RIGHT, 0.0, 1);
    const size_t heavy[] = { 3 };
    const weft_load load = { .mass = 2.0, .vertices = heavy, .vertex_count = 1 };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.loads = &load, def.load_count = 1;
    weft_cloth *cloth = NULL;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_OK);
    const double third = 0.2 * 0.125 / 3.0;
    const double mass[] = { 2.0 * third, third, third, 2.0 * third + 2.0 };
    for (size_t v = 0; v < 4; ++v) {
        ck_assert_double_eq_tol(cloth->mesh.mass[weft__particle_of(&cloth->mesh, v)],
                                mass[v], 1e-15);
    }
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

START_TEST(without_fabric_forces_it_falls)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 30, 30, 0.01, MESH_RIGHT, 0.0, 1);
    const size_t held[] = { 0, 29 };
    const weft_pin pin = { .vertices = held, .vertex_count = 2 };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.gravity[1] = -9.81;
    def.pins = &pin, def.pin_count = 1;
    weft_cloth *cloth = NULL;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_OK);
    ck_assert_uint_eq(weft_cloth_pins(cloth), 2);
    double y[6 * 900], dydt[6 * 900];
    weft_cloth_start(cloth, y);
    ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
    for (size_t i = 0; i < 900; ++i) {
        const size_t v = weft__vertex_of(&cloth->mesh, i);
        ck_assert_double_eq_tol(dydt[4 * 900 + i], v == 0 || v == 29 ? 0.0 : -9.81,
                                1e-9);
    }
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

/* ---- what is refused ------------------------------------------------------------- */

static void flip(test_mesh *of)
{
    const uint32_t kept = of->corners[0];
    of->corners[0] = of->places[0] = of->corners[1];
    of->corners[1] = of->places[1] = kept;
}

static void thrice(test_mesh *of)
{
    const uint32_t third[] = { 0, 3, 1 };
    of->corners = realloc(of->corners, 9 * sizeof *of->corners);
    memcpy(&of->corners[6], third, sizeof third);
    of->def.corners = of->corners, of->def.corner_uv = NULL, of->def.triangles = 3;
}

static void thin(test_mesh *of)
{
    of->rest[2] = of->rest[2 * of->cols + 2] = 0.5e-6;
}

static void flat(test_mesh *of)
{
    of->rest[2] = 0.0;
}

static void nowhere(test_mesh *of)
{
    of->start[4] = NAN;
}

static void far_away(test_mesh *of)
{
    of->rest[3] = INFINITY;
}

static void outside(test_mesh *of)
{
    of->corners[5] = 4000000000;
}

static void no_place(test_mesh *of)
{
    of->places[5] = 77;
}

static void unused(test_mesh *of)
{
    of->def.vertices = 5;
}

static void twice(test_mesh *of)
{
    of->corners[1] = of->corners[0];
}

static void coupled(test_mesh *of)
{
    of->fabrics[0].coupling = -900.0;
}

static void no_density(test_mesh *of)
{
    of->fabrics[0].density = 0.0;
}

static void no_fabric(test_mesh *of)
{
    of->def.fabric_count = 0;
}

static void no_arrays(test_mesh *of)
{
    of->def.corners = NULL;
}

static const struct {
    void (*spoil)(test_mesh *of);
    const char *message;
} faults[] = {
    { flip, "run along edge 0-3 in the same direction" },
    { thrice, "edge 0-3 has 3 triangles" },
    { thin, "too thin at rest" },
    { flat, "degenerate at rest" },
    { nowhere, "vertex 1 starts at" },
    { far_away, "place 1 of the rest shape" },
    { outside, "triangle 1 has corner 4000000000" },
    { no_place, "at place 77" },
    { unused, "vertex 4 is in no triangle" },
    { twice, "vertex 0 at two corners" },
    { coupled, "coupling -900 N/m" },
    { no_density, "density 0 kg/m^2" },
    { no_fabric, "and 0 fabrics" },
    { no_arrays, "corners is NULL" },
};

START_TEST(a_bad_mesh_is_refused_with_its_place)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 2, 2, 0.5, MESH_RIGHT, 0.0, 1);
    mesh.start = realloc(mesh.start, 15 * sizeof *mesh.start);
    mesh.start[12] = mesh.start[13] = mesh.start[14] = 0.0;
    mesh.def.start = mesh.start;
    faults[_i].spoil(&mesh);
    const weft_cloth_def def = mesh_cloth(&mesh);
    ck_assert_msg(strstr(refusal(&def), faults[_i].message) != NULL, "%s", err.message);
    mesh_free(&mesh);
}
END_TEST

/* The call that fails, counted from 1; the others are malloc's. */
typedef struct one_failure {
    size_t calls, fails;
} one_failure;

static void *fail_once(void *ctx, void *block, size_t size)
{
    one_failure *at = ctx;
    if (size > 0 && ++at->calls == at->fails) {
        return NULL;
    }
    return weft_malloc_resize(NULL, block, size);
}

/* One allocation fails, those after it do not: nothing goes unchecked. */
START_TEST(a_bad_cloth_is_refused_whatever_allocation_fails)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 3, 3, 0.5, MESH_RIGHT, 0.0, 1);
    const size_t held[] = { 0 };
    const weft_pin pin
        = { .velocity = { NAN, 0.0, 0.0 }, .vertices = held, .vertex_count = 1 };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.pins = &pin, def.pin_count = 1;
    one_failure at = { .calls = SIZE_MAX / 2 };
    for (size_t fails = 1; at.calls >= fails; ++fails) {
        const weft_allocator memory = { fail_once, &at };
        weft_cloth *cloth = NULL;
        at = (one_failure){ 0, fails };
        def.allocator = &memory;
        ck_assert_int_ne(weft_cloth_create(&def, &cloth, &err), WEFT_OK);
        ck_assert_ptr_null(cloth);
    }
    mesh_free(&mesh);
}
END_TEST

START_TEST(pins_and_loads_outside_are_refused)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 2, 2, 0.5, MESH_RIGHT, 0.0, 1);
    const size_t far[] = { 1, 4 };
    const weft_load load = { .mass = 2.0, .vertices = far, .vertex_count = 2 };
    const weft_pin pin = { .vertices = far, .vertex_count = 2 };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.loads = &load, def.load_count = 1;
    ck_assert_str_eq(refusal(&def), "load 0: vertex 4 of 4");
    def.load_count = 0, def.pins = &pin, def.pin_count = 1;
    ck_assert_str_eq(refusal(&def), "pin 0: vertex 4 of 4");
    mesh_free(&mesh);
}
END_TEST

START_TEST(a_strain_limit_is_refused)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 3, 3, 0.1, MESH_RIGHT, 0.0, 1);
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    weft_cloth *cloth = made(&mesh);
    def.cloth = cloth, def.method = test_method_named("verlet/velocity_verlet");
    def.config.fixed_step = 1e-3;
    def.limit.method = WEFT_LIMIT_PROVOT;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_UNSUPPORTED);
    ck_assert_str_eq(err.message, "a strain limit needs a grid: it shortens springs");
    weft_cloth_destroy(cloth);
    mesh_free(&mesh);
}
END_TEST

TEST_SUITE(triangles)
{
    Suite *suite = suite_create("triangles");
    TCase *tcase = tcase_create("triangles");
    tcase_add_test(tcase, particles_are_a_permutation_of_vertices);
    tcase_add_loop_test(tcase, order_does_not_depend_on_the_numbers_of_a_file, 0, 4);
    tcase_add_test(tcase, a_sewn_sheet_has_the_edges_and_places_of_two);
    tcase_add_test(tcase, edges_lie_opposite_their_corners);
    tcase_add_test(tcase, a_mirrored_piece_shares_places_with_its_twin);
    tcase_add_test(tcase, masses_are_thirds_of_triangles_and_loads);
    tcase_add_test(tcase, without_fabric_forces_it_falls);
    tcase_add_loop_test(tcase, a_bad_mesh_is_refused_with_its_place, 0,
                        sizeof faults / sizeof faults[0]);
    tcase_add_test(tcase, a_bad_cloth_is_refused_whatever_allocation_fails);
    tcase_add_test(tcase, pins_and_loads_outside_are_refused);
    tcase_add_test(tcase, a_strain_limit_is_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
