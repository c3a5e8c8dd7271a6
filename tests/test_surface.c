/* SPDX-License-Identifier: BSD-3-Clause */
/* test_surface.c -- the numbers, names, triangles, edges and rest shape of a cloth. */
#include "meshes.h"

#include <math.h>

static weft_cloth *cloth;

static void make_grid(void)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 3, def.cols = 4;
    def.spacing[0] = 0.5, def.spacing[1] = 0.25;
    cloth = test_cloth(&def);
}

static void destroy(void)
{
    weft_cloth_destroy(cloth);
}

START_TEST(particles_of_a_grid_are_named_by_row_and_column)
{
    const weft_spring spring = { WEFT_SHEAR, 3, 6, 0.0 };
    const weft_primitive edge = { 2, { 0, 1 } }, triangle = { 3, { 11, 7, 10 } };
    char text[64];
    ck_assert_str_eq(weft_cloth_text(cloth, text, 64), "3 x 4 particles");
    ck_assert_str_eq(weft_particle_text(cloth, 6, text, 64), "particle (1, 2)");
    ck_assert_str_eq(weft_spring_text(cloth, &spring, text, 64),
                     "shear spring (0, 3)-(1, 2)");
    ck_assert_str_eq(weft_primitive_text(cloth, &edge, text, 64), "edge (0, 0)-(0, 1)");
    ck_assert_str_eq(weft_primitive_text(cloth, &triangle, text, 64), "cell (1, 2)");
    ck_assert_str_eq(weft_cloth_text(cloth, text, 4), "3 x");
    for (size_t i = 0; i < 12; ++i) {
        ck_assert_uint_eq(weft_cloth_index(cloth, i), i);
        ck_assert_uint_eq(weft_cloth_vertex(cloth, i), i);
        ck_assert_uint_eq(weft_cloth_file_index(cloth, i), i);
    }
}
END_TEST

/* V - E + T = 1 of a disc; the two triangles of a cell share its diagonal. */
START_TEST(a_grid_has_two_triangles_for_each_cell)
{
    uint32_t corners[36], places[36], ends[46];
    double uv[24];
    ck_assert_uint_eq(weft_cloth_triangles(cloth, NULL), 12);
    ck_assert_uint_eq(weft_cloth_triangles(cloth, corners), 12);
    ck_assert_uint_eq(weft_cloth_edges(cloth, NULL), 23);
    ck_assert_uint_eq(weft_cloth_edges(cloth, ends), 23);
    ck_assert_uint_eq(weft_cloth_uv(cloth, places, uv), 12);
    ck_assert_mem_eq(places, corners, sizeof corners);
    for (size_t cell = 0; cell < 6; ++cell) {
        const uint32_t a = (uint32_t)(cell / 3 * 4 + cell % 3);
        const uint32_t two[6] = { a, a + 4, a + 1, a + 5, a + 1, a + 4 };
        ck_assert_mem_eq(&corners[6 * cell], two, sizeof two);
    }
    for (size_t e = 0; e < 23; ++e) {
        const uint32_t step = ends[2 * e + 1] - ends[2 * e];
        ck_assert(step == 1 || step == 3 || step == 4);
    }
    for (size_t i = 0; i < 12; ++i) {
        ck_assert_double_eq(uv[2 * i], 0.25 * (double)(i % 4));
        ck_assert_double_eq(uv[2 * i + 1], -0.5 * (double)(i / 4));
    }
}
END_TEST

START_TEST(hash_of_a_state_is_that_of_its_rows)
{
    double y[72];
    weft_cloth_start(cloth, y);
    ck_assert_uint_eq(weft_cloth_state_hash(cloth, y), weft_state_hash(y, 3, 4));
}
END_TEST

START_TEST(vertices_of_a_mesh_have_their_names)
{
    test_mesh mesh;
    mesh_sheet(&mesh, 2, 2, 0.5, MESH_RIGHT, 0.0, 1);
    const size_t names[] = { 40, 30, 20, 10 };
    const weft_spring spring = { WEFT_STRETCH, 0, 3, 0.0 };
    const weft_primitive edge = { 2, { 1, 2 } }, triangle = { 3, { 3, 0, 1 } };
    char text[64];
    mesh.def.file_index = names;
    const weft_cloth_def def = mesh_cloth(&mesh);
    cloth = test_cloth(&def);
    ck_assert_uint_eq(weft_cloth_rows(cloth) + weft_cloth_cols(cloth), 0);
    ck_assert_str_eq(weft_cloth_text(cloth, text, 64), "4 vertices, 2 triangles");
    ck_assert_str_eq(weft_particle_text(cloth, 2, text, 64), "vertex 20");
    ck_assert_str_eq(weft_spring_text(cloth, &spring, text, 64), "edge 40-10");
    ck_assert_str_eq(weft_primitive_text(cloth, &edge, text, 64), "edge 30-20");
    ck_assert_str_eq(weft_primitive_text(cloth, &triangle, text, 64),
                     "triangle 10-40-30");
    destroy();
    mesh_free(&mesh);
}
END_TEST

static int by_value(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Each from its lowest corner on, in order. */
static void sort(uint32_t *corners, size_t count)
{
    for (size_t t = 0; t < count; ++t) {
        uint32_t *of = corners + 3 * t;
        while (of[0] > of[1] || of[0] > of[2]) {
            const uint32_t first = of[0];
            of[0] = of[1], of[1] = of[2], of[2] = first;
        }
    }
    qsort(corners, count, 3 * sizeof *corners, by_value);
}

/* Two pieces, of which one is a mirror image in (u, v). A seam's edges are one edge. */
START_TEST(a_mesh_gives_back_what_defined_it)
{
    enum { TRIANGLES = 2 * 4 * 8, PLACES = 50, EDGES = 45 + TRIANGLES - 1 };
    test_mesh mesh;
    uint32_t corners[3 * TRIANGLES], places[3 * TRIANGLES], ends[2 * EDGES];
    double uv[2 * PLACES];
    mesh_sheet(&mesh, 5, 9, 0.1, MESH_ALTERNATING, 0.0, 1);
    mesh_sew(&mesh, 4, 0.3, 0.6, 0.8);
    for (size_t i = 45; i < 90; ++i) {
        mesh.rest[2 * i] = -mesh.rest[2 * i];
    }
    mesh_shuffle(&mesh, 2, NULL);
    const weft_cloth_def def = mesh_cloth(&mesh);
    cloth = test_cloth(&def);
    ck_assert_uint_eq(weft_cloth_triangles(cloth, corners), TRIANGLES);
    ck_assert_uint_eq(weft_cloth_uv(cloth, places, uv), PLACES);
    for (size_t j = 0; j < 3 * TRIANGLES; ++j) {
        size_t at = 0; /* a corner of the same vertex at the same place */
        while (mesh.corners[at] != corners[j]
               || memcmp(&mesh.rest[2 * (size_t)mesh.places[at]],
                         &uv[2 * (size_t)places[j]], 2 * sizeof *uv)
                      != 0) {
            ck_assert_uint_lt(++at, 3 * TRIANGLES);
        }
    }
    sort(corners, TRIANGLES);
    sort(mesh.corners, TRIANGLES);
    ck_assert_mem_eq(corners, mesh.corners, sizeof corners);
    ck_assert_uint_eq(weft_cloth_edges(cloth, ends), EDGES);
    for (size_t v = 0; v < 45; ++v) {
        const size_t at = weft_cloth_index(cloth, v);
        ck_assert_uint_eq(weft_cloth_vertex(cloth, at), v);
    }
    destroy();
    mesh_free(&mesh);
}
END_TEST

/* Own forces see a mesh in the order of its states; the index is that of
 * weft_cloth_index. */
typedef struct lifted {
    size_t place, particles;
    double force, lowest; /* [N] upwards on the vertex there; [m] its height */
} lifted;

static int lift(void *ctx, double t, const double *y, double *f)
{
    lifted *of = ctx;
    (void)t;
    f[of->particles + of->place] = of->force;
    of->lowest = y[of->particles + of->place];
    return 0;
}

START_TEST(own_force_acts_on_the_vertex_of_the_definition)
{
    test_mesh mesh;
    weft_error err = { 0 };
    weft_failure failure;
    mesh_sheet(&mesh, 5, 9, 0.1, MESH_ALTERNATING, 0.0, 1);
    mesh_shuffle(&mesh, 2, NULL);
    const weft_cloth_def def = mesh_cloth(&mesh);
    cloth = test_cloth(&def);
    size_t moved = 0;
    for (size_t v = 0; v < 45; ++v) {
        double xyz[3 * 45], before[3 * 45];
        lifted of = { weft_cloth_index(cloth, v), 45, 100.0, 0.0 };
        weft_sim_def run = weft_sim_def_default();
        weft_sim *sim = NULL;
        run.cloth = cloth;
        run.method = test_method_named("verlet/symplectic_euler");
        run.config.fixed_step = 1e-6;
        run.force = lift;
        run.force_ctx = &of;
        ck_assert_int_eq(weft_sim_create(&run, &sim, &err), WEFT_OK);
        weft_sim_positions(sim, before);
        ck_assert_int_eq(weft_sim_step(sim, 1e-6, &err), WEFT_OK);
        weft_sim_velocities(sim, xyz);
        for (size_t i = 0; i < 45; ++i) { /* the weight of the others: g h */
            ck_assert((xyz[3 * i + 1] > 1e-5) == (i == v));
        }
        ck_assert(of.lowest == before[3 * v + 1]);
        of.force = NAN;
        ck_assert_int_ne(weft_sim_step(sim, 2e-6, &err), WEFT_OK);
        ck_assert(weft_sim_failure(sim, &failure) && failure.force);
        ck_assert_uint_eq(failure.force_particle, v);
        moved += of.place != v;
        weft_sim_destroy(sim);
    }
    ck_assert_uint_gt(moved, 20);
    destroy();
    mesh_free(&mesh);
}
END_TEST

/* What weft_sim_vertices must give, the slow way: from the lists of triangles. */
static void expect_vertices(const weft_sim *sim)
{
    enum { MOST = 100, STRIDE = 9 };
    const size_t n = weft_cloth_particles(cloth), t = weft_cloth_triangles(cloth, NULL);
    double x[3 * MOST], sum[3 * MOST] = { 0.0 };
    float mixed[STRIDE * MOST], bare[3 * MOST];
    uint32_t corners[6 * MOST];
    ck_assert_uint_le(n, MOST);
    weft_sim_positions(sim, x);
    (void)weft_cloth_triangles(cloth, corners);
    for (size_t j = 0; j < 9 * t; ++j) {
        const uint32_t *of = corners + j / 9 * 3;
        const size_t k = j % 3, p = (k + 1) % 3, q = (k + 2) % 3;
        const double *a = x + 3 * (size_t)of[0], *b = x + 3 * (size_t)of[1],
                     *c = x + 3 * (size_t)of[2];
        sum[3 * (size_t)of[j % 9 / 3] + k]
            += (b[p] - a[p]) * (c[q] - a[q]) - (b[q] - a[q]) * (c[p] - a[p]);
    }
    memset(mixed, 0x55, sizeof mixed);
    weft_sim_vertices(sim, mixed, mixed + 4, STRIDE * sizeof *mixed);
    weft_sim_vertices(sim, bare, NULL, 0);
    for (size_t i = 0; i < n; ++i) {
        const double *of = sum + 3 * i,
                     length = sqrt(of[0] * of[0] + of[1] * of[1] + of[2] * of[2]);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert(mixed[STRIDE * i + k] == (float)x[3 * i + k]);
            ck_assert(bare[3 * i + k] == (float)x[3 * i + k]);
            ck_assert_double_eq_tol((double)mixed[STRIDE * i + 4 + k], of[k] / length,
                                    1e-6);
        }
        for (size_t k = 3; k < STRIDE;
             k += k == 3 ? 4 : 1) { /* what is between stays */
            ck_assert_mem_eq(&mixed[STRIDE * i + k], "UUUU", sizeof *mixed);
        }
    }
    weft_sim_vertices(sim, NULL, bare, 0);
    for (size_t j = 0; j < 3 * n; ++j) {
        ck_assert(bare[j] == mixed[STRIDE * (j / 3) + 4 + j % 3]);
    }
}

static weft_sim *falling(const weft_cloth_def *def)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = 1e-3;
    cloth = test_cloth(def);
    weft_sim *sim
        = test_sim(cloth, test_method_named("verlet/velocity_verlet"), &config);
    ck_assert_int_eq(weft_sim_advance(sim, 0.1, NULL), WEFT_OK);
    return sim;
}

START_TEST(vertices_are_positions_and_normals_of_the_triangles)
{
    test_mesh mesh;
    const weft_pin corner
        = { .rows = { 0, 0 }, .cols = { 0, 0 }, .velocity = { 0, 0, 2 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 6, def.cols = 9;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ .present = true, .stiffness = 50.0 };
    def.pins = &corner, def.pin_count = 1;
    weft_sim *sim = falling(&def);
    expect_vertices(sim);
    weft_sim_destroy(sim);
    destroy();
    mesh_sheet(&mesh, 7, 9, 0.1, MESH_RANDOM, 0.2, 1);
    mesh_shuffle(&mesh, 2, NULL);
    for (size_t i = 0; i < 63; ++i) {
        mesh.start[3 * i + 2] = 0.3 * mesh.start[3 * i] * mesh.start[3 * i + 1];
    }
    def = mesh_cloth(&mesh);
    sim = falling(&def);
    expect_vertices(sim);
    weft_sim_destroy(sim);
    destroy();
    mesh_free(&mesh);
}
END_TEST

START_TEST(normals_of_a_chain_are_zero)
{
    float normals[15];
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 1, def.cols = 5;
    weft_sim *sim = falling(&def);
    weft_sim_vertices(sim, NULL, normals, 0);
    for (size_t j = 0; j < 15; ++j) {
        ck_assert(normals[j] == 0.0F);
    }
    weft_sim_destroy(sim);
    destroy();
}
END_TEST

/* malloc's, with the size in front of each block. */
static void *counting(void *ctx, void *block, size_t size)
{
    size_t *held = ctx, *from = block == NULL ? NULL : (size_t *)block - 2;
    *held -= from == NULL ? 0 : *from;
    if (size == 0) {
        free(from);
        return NULL;
    }
    from = realloc(from, size + 2 * sizeof *from);
    *from = size;
    *held += size;
    return from + 2;
}

START_TEST(bytes_of_a_mesh_are_those_it_takes)
{
    size_t held = 0;
    const weft_allocator memory = { counting, &held };
    test_mesh mesh;
    mesh_sheet(&mesh, 60, 70, 0.01, MESH_RANDOM, 0.2, 1);
    weft_cloth_def def = mesh_cloth(&mesh);
    def.allocator = &memory;
    cloth = test_cloth(&def);
    const double bytes = (double)weft_cloth_bytes(cloth);
    ck_assert_double_le(fabs(bytes - (double)held), 0.1 * (double)held);
    destroy();
    ck_assert_uint_eq(held, 0);
    mesh_free(&mesh);
}
END_TEST

TEST_SUITE(surface)
{
    Suite *suite = suite_create("surface");
    TCase *grid = tcase_create("grid");
    tcase_add_checked_fixture(grid, make_grid, destroy);
    tcase_add_test(grid, particles_of_a_grid_are_named_by_row_and_column);
    tcase_add_test(grid, a_grid_has_two_triangles_for_each_cell);
    tcase_add_test(grid, hash_of_a_state_is_that_of_its_rows);
    suite_add_tcase(suite, grid);
    TCase *triangles = tcase_create("triangles");
    tcase_add_test(triangles, vertices_of_a_mesh_have_their_names);
    tcase_add_test(triangles, a_mesh_gives_back_what_defined_it);
    tcase_add_test(triangles, own_force_acts_on_the_vertex_of_the_definition);
    tcase_add_test(triangles, vertices_are_positions_and_normals_of_the_triangles);
    tcase_add_test(triangles, normals_of_a_chain_are_zero);
    tcase_add_test(triangles, bytes_of_a_mesh_are_those_it_takes);
    suite_add_tcase(suite, triangles);
    return suite;
}
