/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long */
/* test_skin.c -- contact of a mesh with itself in a given state: forces, the search,
 * weights, thickness, slit edges. What needs a simulation is in test_skin_time.c. */
#include "folded_mesh.h"

#include "cloth/model.h"
#include "forces/contact/self/self.h"

enum { SIDE = 25, MOST = 20000 };

static test_mesh mesh;
static weft_cloth_def def;
static weft_cloth *cloth;
static weft_error err;
static double y[6 * MOST];

static void teardown(void)
{
    weft_cloth_destroy(cloth);
    cloth = NULL;
    mesh_free(&mesh);
    mesh = (test_mesh){ .rows = 0 };
}

static void define(double thickness)
{
    def = mesh_cloth(&mesh);
    def.contact.thickness = thickness;
    def.contact.self = true;
}

static size_t count_of(void)
{
    return weft_cloth_particles(cloth);
}

/* Folded along its middle into two layers 0.7 thicknesses apart, askew and wavy, which
 * part where they join. */
static void fold(uint64_t seed)
{
    mesh_sheet(&mesh, SIDE, SIDE, 1.0 / (SIDE - 1), MESH_RANDOM, 0.15, seed);
    mesh_shuffle(&mesh, seed, NULL);
    define(0.5 * mesh_least_height(&mesh));
}

static void lay(uint64_t seed)
{
    const double thick = def.contact.thickness;
    cloth = test_cloth(&def);
    const size_t n = count_of();
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < n; ++i) {
        const double u = y[i], v = y[n + i];
        const bool upper = u > 0.5;
        y[i] = upper ? 0.97 - u : u;
        y[n + i] = v * (upper ? 0.98 : 1.0) + 0.1 * u;
        y[2 * n + i] = upper ? 0.7 * thick + 0.3 * fmax(0.0, 0.65 - u)
                             : -0.3 * fmax(0.0, u - 0.35);
        for (size_t k = 0; k < 6; ++k) {
            y[k * n + i]
                += (k < 3 ? 0.1 * thick : 0.5) * (2.0 * random_uniform(&seed) - 1.0);
        }
    }
}

/* ---- forces ---------------------------------------------------------------------- */

static double contact_at(const double *d, double step)
{
    static double at[6 * MOST];
    const size_t half = 3 * count_of();
    for (size_t i = 0; i < 2 * half; ++i) {
        at[i] = y[i] + (i < half ? step * d[i] : 0.0);
    }
    return weft_cloth_energy(cloth, 0.0, at).contact;
}

/* By differences of order 6. */
static double slope_along(const double *d, double by)
{
    static const double weights[3] = { 0.75, -0.15, 1.0 / 60.0 };
    double slope = 0.0;
    for (size_t j = 0; j < 3; ++j) {
        const double step = (double)(j + 1) * by;
        slope += weights[j] / by * (contact_at(d, step) - contact_at(d, -step));
    }
    return slope;
}

/* Contact alone: what weft_cloth_force has more with it. */
static void contact_force(double *f)
{
    static double without[3 * MOST];
    const size_t all = 3 * count_of();
    weft_cloth_force(cloth, 0.0, y, f);
    cloth->self.law.self = false;
    weft_cloth_force(cloth, 0.0, y, without);
    cloth->self.law.self = true;
    for (size_t i = 0; i < all; ++i) {
        f[i] -= without[i];
    }
}

typedef struct counts {
    weft__self_law law;
    size_t pushing[4];
} counts;

static bool count_push(void *ctx, const weft__pair *pair)
{
    counts *of = ctx;
    weft__pushes push;
    double bad = 0.0;
    of->pushing[pair->kind] += weft__pair_push(&of->law, pair, y, &push, 0, &bad);
    return true;
}

START_TEST(forces_are_slopes_of_the_energy)
{
    static double d[3 * MOST], f[3 * MOST];
    uint64_t seed = 7;
    fold((uint64_t)_i + 1);
    def.contact.damping = def.contact.friction = 0.0;
    lay((uint64_t)_i + 1);
    counts of = { .law = weft__self_law_of(&cloth->self) };
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    ck_assert(weft__each_pair(&tree, def.contact.thickness, count_push, &of));
    for (size_t k = 0; k < 4; ++k) {
        ck_assert_uint_gt(of.pushing[k], 0);
    }
    contact_force(f);
    for (int k = 0; k < 10; ++k) {
        double along = 0.0, most = 0.0;
        for (size_t i = 0; i < 3 * count_of(); ++i) {
            d[i] = 2.0 * random_uniform(&seed) - 1.0;
            along += f[i] * d[i];
            most = fmax(most, fabs(f[i]));
        }
        const double slope = slope_along(d, 1e-4 * def.contact.thickness);
        ck_assert_double_gt(most, 0.0);
        ck_assert_double_le(fabs(along + slope), 1e-8 * most);
    }
}
END_TEST

START_TEST(without_friction_momentum_and_angular_momentum_are_kept)
{
    static double f[3 * MOST];
    double sum[6] = { 0.0 }, most = 0.0;
    fold((uint64_t)_i + 1);
    def.contact.friction = 0.0;
    lay(3);
    const size_t n = count_of();
    contact_force(f);
    for (size_t j = 0; j < 3 * n; ++j) {
        const size_t i = j / 3, a = (j + 1) % 3 * n + i, b = (j + 2) % 3 * n + i;
        sum[j % 3] += f[j % 3 * n + i];
        sum[3 + j % 3] += y[a] * f[b] - y[b] * f[a];
        most = fmax(most, fabs(f[j % 3 * n + i]));
    }
    ck_assert_double_gt(most, 0.0);
    for (size_t k = 0; k < 6; ++k) {
        ck_assert_double_le(fabs(sum[k]), 1e-13 * (double)n * most);
    }
}
END_TEST

/* ---- weights --------------------------------------------------------------------- */

/* Adds a sheet of rows^2 vertices, flat at height z, turned by an angle about the
 * middle of a square of 0.6 m, its own middle. */
static void add_sheet(size_t rows, double spacing, double z, double angle,
                      uint64_t seed)
{
    test_mesh of;
    mesh_sheet(&of, rows, rows, spacing, MESH_RANDOM, 0.04, seed);
    const size_t n = mesh.def.vertices, more = of.def.vertices;
    const size_t t = mesh.def.triangles, all = t + of.def.triangles;
    const double half = 0.5 * spacing * (double)(rows - 1);
    mesh.start = realloc(mesh.start, 3 * (n + more) * sizeof *mesh.start);
    mesh.rest = realloc(mesh.rest, 2 * (n + more) * sizeof *mesh.rest);
    mesh.corners = realloc(mesh.corners, 3 * all * sizeof *mesh.corners);
    mesh.places = realloc(mesh.places, 3 * all * sizeof *mesh.places);
    mesh.fabrics[0] = mesh_fabric;
    for (size_t i = 0; i < more; ++i) {
        const double u = of.rest[2 * i] - half, v = of.rest[2 * i + 1] - half;
        mesh.rest[2 * (n + i)] = u, mesh.rest[2 * (n + i) + 1] = v;
        mesh.start[3 * (n + i)] = 0.3 + cos(angle) * u - sin(angle) * v;
        mesh.start[3 * (n + i) + 1] = 0.3 + sin(angle) * u + cos(angle) * v;
        mesh.start[3 * (n + i) + 2] = z;
    }
    for (size_t c = 3 * t; c < 3 * all; ++c) {
        mesh.corners[c] = mesh.places[c] = of.corners[c - 3 * t] + (uint32_t)n;
    }
    mesh_point(&mesh, n + more, n + more, all);
    mesh_free(&of);
}

typedef struct window {
    weft__self_law law;
    double energy; /* [J] of feet in its 0.3 m x 0.3 m */
} window;

static bool add_energy(void *ctx, const weft__pair *pair)
{
    window *of = ctx;
    const size_t n = count_of();
    weft__pushes push;
    weft__touch touch;
    double arm[4], bad = 0.0;
    if (weft__pair_push(&of->law, pair, y, &push, 0, &bad)
        && weft__pair_meets(&of->law, pair, y, arm, &touch)) {
        bool in = true;
        for (size_t k = 0; k < 2; ++k) {
            const double *x = y + k * n;
            const double foot
                = pair->kind == WEFT__EDGES
                      ? arm[0] * x[pair->particle[0]] + arm[1] * x[pair->particle[1]]
                      : x[pair->particle[0]];
            in = in && foot > 0.15 && foot < 0.45;
        }
        of->energy += in ? push.energy[0] : 0.0;
    }
    return true;
}

/* Of two layers half the thickness apart, the other one below or above, over rho e phi
 * times the area. */
static double layers_energy(size_t rows, double spacing, bool below, uint64_t seed)
{
    const double s = 0.5, e = 12.5, thick = 0.3 * 0.02;
    teardown();
    for (size_t i = 0; i < 2; ++i) {
        const double z = i == 0 ? 0.0 : s * thick;
        if ((i == 0) == below) {
            add_sheet(rows, spacing, z, 0.4 * (double)seed, seed + 100);
        } else {
            add_sheet(33, 0.02, z, 0.0, seed);
        }
    }
    define(thick);
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    window of = { .law = weft__self_law_of(&cloth->self) };
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    ck_assert(weft__each_pair(&tree, thick, add_energy, &of));
    const double phi = pow(s, 4.0) / (1.0 - s);
    return of.energy / (mesh_fabric.density * e * phi * 0.09);
}

/* Areas of a vertex in ratios of 250, 56, 12, 3 and 1 and their inverses, thickness 0.3
 * edges of the finer mesh. */
START_TEST(two_layers_have_the_same_energy_whatever_their_meshes)
{
    static const struct {
        size_t rows;
        double spacing;
    } others[]
        = { { 5, 0.316 }, { 9, 0.15 }, { 15, 0.07 }, { 27, 0.035 }, { 43, 0.02 } };
    enum { SEEDS = 6 };
    double mean = 0.0;
    for (uint64_t seed = 1; seed <= SEEDS; ++seed) {
        mean += layers_energy(others[_i / 2].rows, others[_i / 2].spacing, _i % 2, seed)
                / SEEDS;
    }
    ck_assert_double_le(fabs(mean - 1.0), 0.1);
}
END_TEST

/* ---- the search ------------------------------------------------------------------ */

typedef struct found {
    double range;
    size_t count[4];
} found;

static bool count_near(void *ctx, const weft__pair *pair)
{
    found *of = ctx;
    of->count[pair->kind] += weft__pair_distance(pair, y, count_of()) < of->range;
    return true;
}

static bool shares(const uint32_t *a, size_t m, const uint32_t *b, size_t n)
{
    for (size_t k = 0; k < m * n; ++k) {
        if (a[k % m] == b[k / m]) {
            return true;
        }
    }
    return false;
}

static size_t near_one(weft__pair_kind kind, const uint32_t *a, size_t m,
                       const uint32_t *b, size_t n, double range)
{
    weft__pair pair = { .kind = kind };
    memcpy(pair.particle, a, m * sizeof *a);
    memcpy(pair.particle + m, b, n * sizeof *b);
    return !shares(a, m, b, n) && weft__pair_distance(&pair, y, count_of()) < range;
}

/* By all primitives, in numbers of particles. */
static void count_all(double range, size_t count[4])
{
    static uint32_t edges[MOST][2], triangles[MOST][3];
    const size_t t = weft_cloth_triangles(cloth, &triangles[0][0]);
    const size_t e = weft_cloth_edges(cloth, &edges[0][0]);
    for (size_t k = 0; k < 3 * t; ++k) {
        triangles[k / 3][k % 3]
            = (uint32_t)weft__particle_of(&cloth->mesh, triangles[k / 3][k % 3]);
    }
    for (size_t k = 0; k < 2 * e; ++k) {
        edges[k / 2][k % 2]
            = (uint32_t)weft__particle_of(&cloth->mesh, edges[k / 2][k % 2]);
    }
    for (uint32_t i = 0; i < count_of(); ++i) {
        for (uint32_t j = i + 1; j < count_of(); ++j) {
            count[0] += near_one(WEFT__VERTICES, &i, 1, &j, 1, range);
        }
        for (size_t j = 0; j < e; ++j) {
            count[1] += near_one(WEFT__VERTEX_EDGE, &i, 1, edges[j], 2, range);
        }
        for (size_t j = 0; j < t; ++j) {
            count[2] += near_one(WEFT__VERTEX_TRIANGLE, &i, 1, triangles[j], 3, range);
        }
    }
    for (size_t i = 0; i < e; ++i) {
        for (size_t j = i + 1; j < e; ++j) {
            count[3] += near_one(WEFT__EDGES, edges[i], 2, edges[j], 2, range);
        }
    }
}

START_TEST(search_finds_all_pairs)
{
    fold((uint64_t)_i + 1);
    lay((uint64_t)_i + 1);
    for (int k = 1; k <= 4; ++k) {
        found of = { .range = 0.7 * (double)k * def.contact.thickness };
        size_t all[4] = { 0 };
        const weft__quadtree tree = weft__tree_of(&cloth->self, y);
        ck_assert(weft__each_pair(&tree, of.range, count_near, &of));
        count_all(of.range, all);
        for (size_t kind = 0; kind < 4; ++kind) {
            ck_assert_uint_eq(of.count[kind], all[kind]);
        }
    }
}
END_TEST

/* A vertex that owns more than a search takes at once. */
START_TEST(search_finds_all_pairs_of_a_fan)
{
    enum { SPOKES = 40 };
    mesh_sheet(&mesh, 2, SPOKES + 1, 1.0, MESH_RIGHT, 0.0, 1);
    const size_t n = SPOKES + 2;
    for (size_t i = 0; i < n; ++i) {
        const double angle = 0.15 * (double)i, r = i == 0 ? 0.0 : 1.0;
        mesh.rest[2 * i] = mesh.start[3 * i] = r * cos(angle);
        mesh.rest[2 * i + 1] = mesh.start[3 * i + 1] = r * sin(angle);
        mesh.start[3 * i + 2] = 0.0;
    }
    for (uint32_t k = 0; k < SPOKES; ++k) {
        const uint32_t corner[3] = { 0, k + 1, k + 2 };
        memcpy(&mesh.corners[3 * (size_t)k], corner, sizeof corner);
    }
    memcpy(mesh.places, mesh.corners, 3 * SPOKES * sizeof *mesh.places);
    mesh_point(&mesh, n, n, SPOKES);
    define(0.01);
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < n; ++i) {
        y[2 * n + i] = 0.1 * (double)(i % 3);
    }
    found of = { .range = 0.5 };
    size_t all[4] = { 0 };
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    ck_assert(weft__each_pair(&tree, of.range, count_near, &of));
    count_all(of.range, all);
    for (size_t kind = 0; kind < 4; ++kind) {
        ck_assert_uint_eq(of.count[kind], all[kind]);
        ck_assert_uint_gt(all[kind], 0);
    }
}
END_TEST

/* Vertices have the areas that they have anyway; edges and triangles are all there. */
START_TEST(a_grid_has_a_skin)
{
    weft_allocator memory = weft_allocator_or_malloc(NULL);
    weft_cloth_def grid = weft_cloth_def_default();
    weft__surface_draft draft;
    grid.rows = 4 - 3 * (size_t)_i, grid.cols = 6;
    grid.spacing[0] = 0.3, grid.spacing[1] = 0.2;
    cloth = test_cloth(&grid);
    const size_t n = count_of(), triangles = weft_cloth_triangles(cloth, NULL);
    ck_assert(weft__surface_draft_create(&draft, n, triangles, &memory));
    weft__surface_draft_grid(&draft, &cloth->mesh, &grid);
    draft.thickness = 0.05;
    weft__contact_surface *surface = weft__contact_surface_create(&draft, &memory);
    ck_assert_ptr_nonnull(surface);
    ck_assert_uint_eq(surface->edges, weft_cloth_edges(cloth, NULL));
    ck_assert_uint_eq(surface->triangle_first[n], triangles);
    double area = 0.0, square = 0.0;
    for (size_t i = 0; i < n; ++i) {
        area += surface->area[i];
        ck_assert_double_eq(surface->density[i], grid.density);
    }
    for (size_t e = 0; e < surface->edges; ++e) {
        square += surface->square[e];
    }
    ck_assert_double_eq_tol(area, _i == 0 ? 0.9 : 1.0, 1e-15);
    ck_assert_double_eq_tol(
        square, _i == 0 ? 20 * 0.04 + 18 * 0.09 + 15 * 0.13 : 5 * 0.04, 1e-12);
    weft__contact_surface_destroy(surface, &memory);
    weft__surface_draft_destroy(&draft, &memory);
}
END_TEST

/* ---- thickness ------------------------------------------------------------------- */

static void expect_refusal(const char *text)
{
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, text);
}

START_TEST(thickness_beyond_half_the_smallest_height_is_an_error)
{
    mesh_sheet(&mesh, 4, 4, 0.1, MESH_RIGHT, 0.0, 1);
    define(0.5 * mesh_least_height(&mesh));
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    ck_assert_uint_eq(weft_cloth_self_touching(cloth, y), 0);
    weft_cloth_destroy(cloth);
    cloth = NULL;
    def.contact.thickness = 0.036;
    expect_refusal("contact: thickness 0.036 m is too large for self-contact: at most "
                   "0.0353553 m, half the smallest height at rest, of triangle 0-1-5");
}
END_TEST

/* Two legs of four triangles each, joined by two others: between them a notch of 3 cm.
 */
START_TEST(a_notch_that_is_narrower_is_an_error)
{
    static const double at[][2]
        = { { 0.0, 0.0 }, { 0.5, 0.0 },   { 0.53, 0.0 }, { 1.03, 0.0 },
            { 0.0, 0.5 }, { 0.5, 0.5 },   { 0.53, 0.5 }, { 1.03, 0.5 },
            { 0.0, 1.0 }, { 0.515, 1.0 }, { 1.03, 1.0 }, { 0.515, 1.5 } };
    static const uint32_t corners[][3]
        = { { 0, 1, 5 }, { 0, 5, 4 },  { 2, 3, 7 },  { 2, 7, 6 },  { 4, 5, 8 },
            { 5, 9, 8 }, { 6, 7, 10 }, { 6, 10, 9 }, { 8, 9, 11 }, { 9, 10, 11 } };
    mesh_sheet(&mesh, 4, 4, 1.0, MESH_RIGHT, 0.0, 1);
    for (size_t i = 0; i < 12; ++i) {
        mesh.rest[2 * i] = mesh.start[3 * i] = at[i][0];
        mesh.rest[2 * i + 1] = mesh.start[3 * i + 1] = at[i][1];
        mesh.start[3 * i + 2] = 0.0;
    }
    memcpy(mesh.corners, corners, sizeof corners);
    memcpy(mesh.places, corners, sizeof corners);
    mesh_point(&mesh, 12, 12, 10);
    define(0.014);
    cloth = test_cloth(&def);
    weft_cloth_destroy(cloth);
    cloth = NULL;
    def.contact.thickness = 0.016;
    expect_refusal("contact: thickness 0.016 m is more than half the distance of "
                   "vertex 5 and edge 6-9 at rest: contact of the cloth with itself "
                   "needs at most 0.0149933 m");
}
END_TEST

/* ---- slit edges
 * ------------------------------------------------------------------------ */

/* A sheet slit along column 3 from its first row on; `opens` [m]: how far it starts
 * open; right of it other vertices have the same place in the rest shape. */
static void slit(double opens)
{
    const size_t side = 7, n = side * side, cut = 4;
    mesh_sheet(&mesh, side, side, 0.1, MESH_ALTERNATING, 0.0, 1);
    mesh.start = realloc(mesh.start, 3 * (n + cut) * sizeof *mesh.start);
    mesh.rest = realloc(mesh.rest, 2 * (n + cut) * sizeof *mesh.rest);
    for (size_t r = 0; r < cut; ++r) {
        memcpy(&mesh.start[3 * (n + r)], &mesh.start[3 * (side * r + 3)],
               3 * sizeof *mesh.start);
        memcpy(&mesh.rest[2 * (n + r)], &mesh.rest[2 * (side * r + 3)],
               2 * sizeof *mesh.rest);
        mesh.start[3 * (n + r) + 2] += opens;
    }
    for (size_t t = 0; t < mesh.def.triangles; ++t) {
        bool right = false;
        for (size_t k = 0; k < 3; ++k) {
            right = right || mesh.corners[3 * t + k] % side > 3;
        }
        for (size_t k = 0; right && k < 3; ++k) {
            uint32_t *corner = &mesh.corners[3 * t + k];
            if (*corner % side == 3 && *corner / side < cut) {
                *corner = (uint32_t)(n + *corner / side);
            }
        }
    }
    const size_t t = mesh.def.triangles;
    memcpy(mesh.places, mesh.corners, 3 * t * sizeof *mesh.places);
    mesh_point(&mesh, n + cut, n + cut, t);
    define(0.5 * mesh_least_height(&mesh));
}

static void expect_rest(void)
{
    weft_primitive pair[2];
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    ck_assert_double_infinite(weft_cloth_self_gap(cloth, y, pair));
    ck_assert_uint_eq(weft_cloth_self_touching(cloth, y), 0);
    ck_assert_uint_eq(weft_cloth_crossings(cloth, y, NULL), 0);
}

START_TEST(lips_of_a_slit_do_not_push)
{
    slit(_i == 0 ? 0.0 : 1e-4);
    expect_rest();
    ck_assert_uint_gt(cloth->self.surface->slit_pair_count, 0);
}
END_TEST

/* What is two rows from the slit pushes its slit edges. */
START_TEST(lips_push_the_rest_of_the_cloth)
{
    slit(0.0);
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    const size_t n = count_of(), lip = weft__particle_of(&cloth->mesh, 49),
                 far = weft__particle_of(&cloth->mesh, 5);
    for (size_t k = 0; k < 3; ++k) {
        y[k * n + lip] = y[k * n + far] + (k == 2 ? 0.01 : 0.0);
    }
    ck_assert_uint_gt(weft_cloth_self_touching(cloth, y), 0);
}
END_TEST

START_TEST(a_seam_does_not_push)
{
    mesh_sheet(&mesh, 7, 7, 0.1, MESH_RANDOM, 0.2, 3);
    mesh_sew(&mesh, 3, 0.5, 0.8, 0.6);
    define(0.5 * mesh_least_height(&mesh));
    expect_rest();
    ck_assert_uint_eq(cloth->self.surface->slit_pair_count, 0);
}
END_TEST

/* A wedge is cut out of the rest shape from its first row to row 4 and sewn. */
START_TEST(a_dart_does_not_push)
{
    const size_t side = 7, n = side * side;
    mesh_sheet(&mesh, side, side, 0.1, MESH_ALTERNATING, 0.0, 1);
    mesh.rest = realloc(mesh.rest, 2 * (n + 4) * sizeof *mesh.rest);
    for (size_t r = 0; r < 4; ++r) {
        double *lip = &mesh.rest[2 * (n + r)];
        memcpy(lip, &mesh.rest[2 * (side * r + 3)], 2 * sizeof *lip);
        lip[0] += 0.004 * (double)(4 - r);
    }
    for (size_t t = 0; t < mesh.def.triangles; ++t) {
        bool right = false;
        for (size_t k = 0; k < 3; ++k) {
            right = right || mesh.corners[3 * t + k] % side > 3;
        }
        for (size_t k = 0; right && k < 3; ++k) {
            const uint32_t corner = mesh.corners[3 * t + k];
            if (corner % side == 3 && corner / side < 4) {
                mesh.places[3 * t + k] = (uint32_t)(n + corner / side);
            }
        }
    }
    mesh_point(&mesh, n, n + 4, mesh.def.triangles);
    define(0.5 * mesh_least_height(&mesh));
    expect_rest();
}
END_TEST

/* ---- crossings ------------------------------------------------------------------- */

/* A corner is pushed through the cloth. */
START_TEST(a_crossing_names_its_edge_and_triangle)
{
    mesh_sheet(&mesh, 5, 5, 0.1, MESH_RIGHT, 0.0, 1);
    define(0.01);
    const double corner[6] = { 0.23, 0.22, -0.05, 0.26, 0.22, 0.05 };
    memcpy(mesh.start, corner, sizeof corner);
    expect_refusal("edge 0-1 passes through triangle 12-13-18; 3 such pairs");
}
END_TEST

TEST_SUITE(skin)
{
    Suite *suite = suite_create("skin");
    TCase *tcase = tcase_create("skin"), *slow = test_long(suite, 60);
    tcase_add_checked_fixture(tcase, NULL, teardown);
    tcase_add_checked_fixture(slow, NULL, teardown);
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, forces_are_slopes_of_the_energy, 0, test_rounds(2, 8));
    tcase_add_loop_test(tcase, without_friction_momentum_and_angular_momentum_are_kept,
                        0, 4);
    tcase_add_loop_test(tcase, two_layers_have_the_same_energy_whatever_their_meshes, 0,
                        4);
    tcase_add_loop_test(slow, two_layers_have_the_same_energy_whatever_their_meshes, 4,
                        2 * test_rounds(4, 5));
    tcase_add_loop_test(tcase, search_finds_all_pairs, 0, test_rounds(1, 4));
    tcase_add_test(tcase, search_finds_all_pairs_of_a_fan);
    tcase_add_loop_test(tcase, a_grid_has_a_skin, 0, 2);
    tcase_add_test(tcase, thickness_beyond_half_the_smallest_height_is_an_error);
    tcase_add_test(tcase, a_notch_that_is_narrower_is_an_error);
    tcase_add_loop_test(tcase, lips_of_a_slit_do_not_push, 0, 2);
    tcase_add_test(tcase, lips_push_the_rest_of_the_cloth);
    tcase_add_test(tcase, a_seam_does_not_push);
    tcase_add_test(tcase, a_dart_does_not_push);
    tcase_add_test(tcase, a_crossing_names_its_edge_and_triangle);
    suite_add_tcase(suite, tcase);
    return suite;
}
