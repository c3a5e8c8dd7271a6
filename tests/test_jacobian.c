/* SPDX-License-Identifier: BSD-3-Clause */
/* The derivatives of the forces: the product with the Jacobian against differences of
 * the right-hand side, and the structure that a simulation gives its stepper against
 * that product. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "meshes.h"
#include "structured.h"
#include "study/conformance/oscillators.h"

enum { ROWS = 6, COLS = 7, N = ROWS * COLS, KINDS = WEFT_MESH + 1, CASES = 8 * KINDS };

/* In (-1, 1). */
static double noise(void)
{
    static uint64_t seed = 1;
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(seed >> 11) * 0x1p-52 - 1.0;
}

/* Below a sheet, which is at z = 0 and 0.6 m x 0.5 m, so that some particles touch it.
 */
static weft_shape shape_below(weft_shape_kind kind)
{
    weft_shape shape = weft_shape_default(kind);
    const double at[3] = { 0.23, 0.02 - 0.25, -0.4 };
    memcpy(shape.at, at, sizeof at);
    shape.at[2] = kind == WEFT_PLANE ? -0.06 : kind == WEFT_SPHERE ? -0.44 : -0.14;
    shape.radius = kind == WEFT_CAPSULE ? 0.1 : 0.4;
    shape.to[0] = 0.39, shape.to[1] = -0.31, shape.to[2] = -0.16;
    shape.half[0] = 0.17, shape.half[1] = 0.14, shape.half[2] = 0.1;
    shape.rounding = 0.05;
    shape.normal[0] = 0.1, shape.normal[1] = 0.05, shape.normal[2] = 1.0;
    shape.velocity[0] = 0.3, shape.velocity[1] = -0.2;
    for (size_t k = 0; k < 3 && kind != WEFT_BOX; ++k) {
        shape.spin[k] = kind == WEFT_PLANE ? 2.0 * shape.normal[k]
                                           : 9.0 * (shape.to[k] - shape.at[k]);
    }
    shape.turn = (weft_turn){ { 1.0, 2.0, 2.0 }, { 0.1, 0.0, 0.2 }, 1.0, 0.2, 0.5 };
    return shape;
}

/* Of both laws of springs and of friction, under the strain law with bending rigidity,
 * without and with wind, on each kind of shape and on none. */
static weft_cloth *make(size_t number)
{
    static const weft_pin pins[]
        = { { .rows = { 0, 0 }, .cols = { 0, 0 }, .velocity = { 1.0, 0.0, 2.0 } },
            { .rows = { 0, 0 }, .cols = { -1, -1 } } };
    const weft_shape shape = shape_below((weft_shape_kind)(number % WEFT_MESH));
    const size_t choice = number / KINDS;
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = ROWS, def.cols = COLS;
    def.spacing[0] = def.spacing[1] = 0.1;
    def.pins = pins;
    def.pin_count = 2;
    def.law = choice & 1 ? WEFT_LAW_STRAIN : WEFT_LAW_HOOKE;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f] = (weft_spring_def){ .present = true,
                                            .stiffness = 50.0 / (double)(f + 1),
                                            .damping = f == 2 ? 0.0 : 0.2 };
        def.across[f] = (weft_spring_def){ .present = f != WEFT_SHEAR && choice & 2,
                                           .stiffness = 70.0,
                                           .damping = 0.1 };
    }
    def.rim_half = choice & 1;
    if (def.law == WEFT_LAW_STRAIN) {
        def.springs[WEFT_BEND].present = false;
        def.bending = (weft_bending_def){ { 0.02, 0.05 }, -1.0, 0.003 };
    }
    def.damping = 0.01;
    def.wind_drag = choice & 2 ? 0.5 : 0.0;
    def.wind_velocity[0] = 3.0, def.wind_velocity[2] = 2.0;
    def.contact.law = choice & 4 ? WEFT_FRICTION_COULOMB : WEFT_FRICTION_SMOOTH;
    def.contact.thickness = 0.1;
    def.contact.slip = 0.5;
    def.contact.shapes = &shape;
    def.contact.shape_count = number % KINDS < WEFT_MESH ? 1 : 0;
    return test_cloth(&def);
}

static void state(const weft_cloth *cloth, double *y, double *dy)
{
    const size_t n = weft_cloth_particles(cloth);
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * n; ++j) {
        y[j] += (j < 3 * n ? 0.02 : 0.5) * noise();
        dy[j] = noise();
    }
}

static double largest(const double *a, size_t count)
{
    double most = 0.0;
    for (size_t j = 0; j < count; ++j) {
        most = fmax(most, fabs(a[j]));
    }
    return most;
}

static double distance(const double *a, const double *b, size_t count)
{
    double most = 0.0;
    for (size_t j = 0; j < count; ++j) {
        most = fmax(most, isfinite(a[j]) ? fabs(a[j] - b[j]) : (double)INFINITY);
    }
    return most;
}

/* f(y + s dy) - f(y - s dy) */
static void difference(const weft_cloth *cloth, double t, const double *y,
                       const double *dy, double s, double *out)
{
    double at[6 * N], low[6 * N];
    for (size_t j = 0; j < 6 * N; ++j) {
        at[j] = y[j] - s * dy[j];
    }
    ck_assert_int_eq(weft_cloth_rhs(cloth, t, at, low), 0);
    for (size_t j = 0; j < 6 * N; ++j) {
        at[j] = y[j] + s * dy[j];
    }
    ck_assert_int_eq(weft_cloth_rhs(cloth, t, at, out), 0);
    for (size_t j = 0; j < 6 * N; ++j) {
        out[j] -= low[j];
    }
}

/* Differences of the fourth order. Pins move by themselves. */
START_TEST(product_is_the_derivative_of_the_right_hand_side)
{
    const double s = 2e-5, t = 0.01;
    double y[6 * N], dy[6 * N], product[6 * N], near[6 * N], far[6 * N];
    weft_cloth *cloth = make((size_t)_i);
    size_t touching = 0;
    for (int round = 0; round < 10; ++round) {
        state(cloth, y, dy);
        touching += weft_cloth_touching(cloth, t, y);
        ck_assert_int_eq(weft_cloth_jacobian_product(cloth, t, y, dy, product), 0);
        difference(cloth, t, y, dy, s, near);
        difference(cloth, t, y, dy, 2.0 * s, far);
        for (size_t j = 0; j < 6 * N; ++j) {
            near[j] = (8.0 * near[j] - far[j]) / (12.0 * s);
        }
        for (size_t k = 0; k < 6; ++k) {
            ck_assert(product[k * N] == 0.0 && product[k * N + COLS - 1] == 0.0);
        }
        const double error = distance(product, near, 6 * N);
        ck_assert_msg(error <= 1e-8 * largest(product, 6 * N), "case %d: %.3g of %.3g",
                      _i, error, largest(product, 6 * N));
    }
    ck_assert(weft_cloth_shapes(cloth) == 0 || touching > 40);
    weft_cloth_destroy(cloth);
}
END_TEST

/* w.(J v) and v.(J^T w), by the sum of the sizes of the parts of the first. */
static double asymmetry(const weft_cloth *cloth, double t, const double *y,
                        const double *v, const double *w)
{
    double forth[6 * N], back[6 * N], difference = 0.0, size = 0.0;
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, t, y, v, forth), 0);
    ck_assert_int_eq(weft_cloth_jacobian_product_transposed(cloth, t, y, w, back), 0);
    for (size_t j = 0; j < 6 * N; ++j) {
        difference += w[j] * forth[j] - v[j] * back[j];
        size += fabs(w[j] * forth[j]);
    }
    return fabs(difference) / size;
}

START_TEST(transposed_product_is_that_of_the_transpose)
{
    double y[6 * N], v[6 * N], w[6 * N];
    weft_cloth *cloth = make((size_t)_i);
    for (int round = 0; round < 10; ++round) {
        state(cloth, y, v);
        state(cloth, w, w);
        ck_assert_double_le(asymmetry(cloth, 0.01, y, v, w), 1e-13);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

/* A mesh with all that triangles have, on a sphere; some triangles nearly collapse. */
START_TEST(transposed_product_of_triangles_is_that_of_the_transpose)
{
    static const size_t held[2] = { 0, 5 };
    const weft_pin pin = { .vertices = held, .vertex_count = 2 };
    const weft_shape shape = shape_below(WEFT_SPHERE);
    double y[6 * N], v[6 * N], w[6 * N];
    size_t touching = 0;
    test_mesh sheet;
    mesh_sheet(&sheet, ROWS, COLS, 0.1, MESH_RANDOM, 0.2, 3);
    sheet.fabrics[0].damping[0] = 0.02, sheet.fabrics[0].damping[1] = 0.01;
    sheet.def.arc = _i == 1;
    weft_cloth_def def = mesh_cloth(&sheet);
    def.damping = 0.01, def.wind_drag = 0.5, def.wind_velocity[2] = 2.0;
    def.pins = &pin, def.pin_count = 1;
    def.contact.thickness = 0.1, def.contact.slip = 0.5;
    def.contact.shapes = &shape, def.contact.shape_count = 1;
    weft_cloth *cloth = test_cloth(&def);
    for (int round = 0; round < 20; ++round) {
        state(cloth, y, v);
        state(cloth, w, w);
        touching += weft_cloth_touching(cloth, 0.01, y);
        ck_assert_double_le(asymmetry(cloth, 0.01, y, v, w), 1e-13);
    }
    ck_assert_uint_gt(touching, 10);
    weft_cloth_destroy(cloth);
    mesh_free(&sheet);
}
END_TEST

START_TEST(transposed_product_of_a_spring_is_by_hand)
{
    const weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    double y[12] = { 0 }, w[12] = { 0 }, out[12];
    def.rows = 2, def.cols = 1, def.spacing[0] = 1.0;
    def.mass = 2.0, def.density = 0.0, def.damping = 0.5;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 8.0, 4.0 };
    def.pins = &pin, def.pin_count = 1;
    weft_cloth *cloth = test_cloth(&def);
    y[1] = 2.0, y[7] = 3.0; /* x: twice its length, and longer by 3 m/s */
    w[7] = 10.0, w[1] = 7.0;
    w[0] = 100.0, w[6] = 1000.0; /* of the pin: nothing */
    ck_assert_int_eq(weft_cloth_jacobian_product_transposed(cloth, 0.0, y, w, out), 0);
    ck_assert_double_eq(out[0], 8.0 / 2.0 * 10.0);
    ck_assert_double_eq(out[1], -8.0 / 2.0 * 10.0);
    ck_assert_double_eq(out[6], 4.0 / 2.0 * 10.0);
    ck_assert_double_eq(out[7], 7.0 - (4.0 + 0.5) / 2.0 * 10.0);
    y[5] = (double)NAN;
    ck_assert_int_eq(weft_cloth_jacobian_product_transposed(cloth, 0.0, y, w, out), 1);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(product_is_linear_and_refuses_what_is_not_finite)
{
    double y[6 * N], a[6 * N], b[6 * N], ja[6 * N], jb[6 * N];
    weft_cloth *cloth = make(1);
    state(cloth, y, a);
    state(cloth, y, b);
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, a, ja), 0);
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, b, jb), 0);
    for (size_t j = 0; j < 6 * N; ++j) {
        a[j] = 3.0 * a[j] - b[j];
        jb[j] = 3.0 * ja[j] - jb[j];
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, a, ja), 0);
    ck_assert(distance(ja, jb, 6 * N) <= 1e-12 * largest(ja, 6 * N));
    a[5 * N + 11] = (double)NAN;
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, a, ja), 1);
    a[5 * N + 11] = 0.0;
    y[2 * N + 24] = -0.3; /* in the sphere */
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, a, ja), 1);
    y[2 * N + 24] = (double)INFINITY;
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, a, ja), 1);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- the structure of a simulation
 * ------------------------------------------------------------------- */

/* A method that only looks at its config. */
static struct {
    const weft_structure *structure;
    size_t created, changed;
} seen;

static weft_status look(const weft_stepper_type *type, const weft_ode *ode,
                        const weft_stepper_config *config, void **self, weft_error *err)
{
    (void)type, (void)ode, (void)err;
    seen.structure = weft_stepper_structure(config);
    ++seen.created;
    *self = &seen;
    return WEFT_OK;
}

static weft_status jump(void *self, double t_end, double *t, double *y, weft_error *err)
{
    (void)self, (void)y, (void)err;
    *t = t_end;
    return WEFT_OK;
}

static void nothing(void *self)
{
    (void)self;
}

static void count_change(void *self)
{
    (void)self;
    ++seen.changed;
}

static void no_stats(const void *self, weft_stepper_stats *out)
{
    (void)self, (void)out;
}

static const weft_stepper_type looks = { .abi = WEFT_STEPPER_ABI,
                                         .struct_size = sizeof looks,
                                         .name = "looks",
                                         .order = 1,
                                         .create = look,
                                         .step = jump,
                                         .state_changed = nothing,
                                         .stats = no_stats,
                                         .destroy = nothing,
                                         .ode_changed = count_change };

static weft_sim *look_with(const weft_cloth *cloth, uint32_t flags)
{
    static weft_stepper_type type;
    const weft_stepper_config config = weft_stepper_config_default();
    type = looks, type.flags = flags;
    return test_sim(cloth, &type, &config);
}

static weft_sim *simulate(const weft_cloth *cloth)
{
    weft_sim *sim = look_with(cloth, WEFT_STEPPER_COUPLINGS);
    ck_assert_ptr_nonnull(seen.structure);
    ck_assert_uint_eq(seen.structure->struct_size, sizeof *seen.structure);
    return sim;
}

/* The room for linearise. */
static double *room(const weft_structure *of)
{
    const size_t count = WEFT_PAIR_PLANES * of->pair_count
                         + WEFT_BLOCK_PLANES * of->particles
                         + WEFT_COUPLING_NUMBERS * of->block_coupling_count;
    double *planes = malloc(count * sizeof *planes);
    memset(planes, 0xff, count * sizeof *planes);
    return planes;
}

/* J dy of the structure alone. */
static void structured(const weft_structure *of, double t, const double *y,
                       const double *dy, double *out)
{
    double *planes = room(of);
    ck_assert_int_eq(structure_product(of, t, y, dy, planes, out), 0);
    free(planes);
}

/* Without wind; the coupling of friction to the speed of approach is not in C. */
START_TEST(structure_has_the_jacobian_of_the_cloth)
{
    double y[6 * N], dy[6 * N], whole[6 * N], parts[6 * N];
    weft_cloth *cloth = make((size_t)_i);
    weft_sim *sim = simulate(cloth);
    ck_assert_uint_eq(seen.structure->particles, N);
    ck_assert_uint_eq(seen.structure->block_planes,
                      weft_cloth_shapes(cloth) > 0 ? WEFT_BLOCK_PLANES : 0);
    state(cloth, y, dy);
    for (size_t j = 3 * N; j < 6 * N && weft_cloth_shapes(cloth) > 0; ++j) {
        dy[j] = 0.0;
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.01, y, dy, whole), 0);
    structured(seen.structure, 0.01, y, dy, parts);
    ck_assert(distance(parts, whole, 6 * N) <= 1e-11 * largest(whole, 6 * N));
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

/* Pulled in all directions, at rest: no stress presses. Two fabrics of other damping.
 */
static weft_cloth *stretched(test_mesh *sheet, double *y, double *dy)
{
    static const size_t held[2] = { 0, 5 };
    const weft_pin pin = { .vertices = held, .vertex_count = 2 };
    static uint32_t fabrics[2 * (ROWS - 1) * (COLS - 1)];
    mesh_sheet(sheet, ROWS, COLS, 0.1, MESH_RANDOM, 0.2, 3);
    sheet->fabrics[1] = sheet->fabrics[0];
    sheet->fabrics[0].damping[0] = 0.02, sheet->fabrics[0].damping[1] = 0.01;
    sheet->fabrics[1].damping[0] = 0.05;
    sheet->def.fabric_count = 2;
    for (size_t t = 0; t < sheet->def.triangles; ++t) {
        fabrics[t] = t % 3 == 0;
    }
    sheet->def.fabric_of = fabrics;
    weft_cloth_def def = mesh_cloth(sheet);
    def.damping = 0.01;
    def.pins = &pin, def.pin_count = 1;
    weft_cloth *cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * N; ++j) {
        y[j] = j < 3 * N ? 1.2 * y[j] + 1e-3 * noise() : 0.0;
        dy[j] = noise();
    }
    return cloth;
}

START_TEST(structure_of_triangles_has_the_jacobian_of_the_cloth)
{
    double y[6 * N], dy[6 * N], whole[6 * N], parts[6 * N];
    test_mesh sheet;
    weft_cloth *cloth = stretched(&sheet, y, dy);
    weft_sim *sim = simulate(cloth);
    ck_assert_uint_eq(seen.structure->pair_count, 0);
    ck_assert_uint_gt(seen.structure->block_coupling_count, 0);
    ck_assert_uint_gt(seen.structure->scalar_coupling_count, 0);
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, whole), 0);
    structured(seen.structure, 0.0, y, dy, parts);
    ck_assert(distance(parts, whole, 6 * N) <= 1e-11 * largest(whole, 6 * N));
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    mesh_free(&sheet);
}
END_TEST

START_TEST(links_are_for_methods_that_know_them)
{
    double y[6 * N], dy[6 * N];
    test_mesh sheet;
    weft_cloth *cloth = stretched(&sheet, y, dy);
    weft_sim *sim = look_with(cloth, 0);
    ck_assert_uint_eq(seen.structure->block_coupling_count
                          + seen.structure->scalar_coupling_count,
                      0);
    weft_sim_destroy(sim);
    sim = look_with(cloth, WEFT_STEPPER_IMPLICIT);
    ck_assert_ptr_null(seen.structure);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    mesh_free(&sheet);
}
END_TEST

/* On a plane z = 0 that spins: C along the plane and C against it are exact by
 * themselves, and C is never negative. */
START_TEST(damping_of_contact_is_exact_along_and_across)
{
    weft_shape plane = weft_shape_default(WEFT_PLANE);
    weft_cloth_def def = weft_cloth_def_default();
    double y[24] = { 0 }, dy[24] = { 0 }, whole[24], parts[24];
    plane.normal[1] = 0.0, plane.normal[2] = 1.0, plane.at[2] = -2e-3;
    plane.spin[2] = 3.0;
    def.contact.law = _i == 0 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    def.contact.slip = 2.0;
    def.contact.shapes = &plane;
    def.contact.shape_count = 1;
    weft_cloth *cloth = test_cloth(&def);
    weft_sim *sim = simulate(cloth);
    for (size_t k = 3; k < 6; ++k) {
        weft_cloth_start(cloth, y);
        for (size_t j = 0; j < 12; ++j) {
            y[12 + j] = noise();
            dy[12 + j] = j / 4 == k - 3 ? noise() : 0.0;
        }
        ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, whole), 0);
        structured(seen.structure, 0.0, y, dy, parts);
        for (size_t j = 12; j < 24; ++j) {
            const bool coupled = k == 5 && j < 20; /* to friction, from approach */
            ck_assert(coupled ? parts[j] == 0.0
                              : fabs(parts[j] - whole[j])
                                    <= 1e-12 * largest(whole + 12, 12));
            ck_assert(j / 4 != k || parts[j] * dy[j] < 0.0);
        }
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

/* Grids of all shapes: as many springs as the cloth has, each of a family's length. */
START_TEST(runs_list_every_spring_once)
{
    static const size_t sizes[][2]
        = { { 1, 2 }, { 2, 1 }, { 2, 2 }, { 1, 9 }, { 9, 1 }, { 3, 3 }, { 5, 8 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = sizes[_i][0], def.cols = sizes[_i][1];
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f].present = true;
        def.springs[f].stiffness = 1.0;
    }
    weft_cloth *cloth = test_cloth(&def);
    weft_sim *sim = simulate(cloth);
    const weft_structure *of = seen.structure;
    bool joined[40][40] = { { false } };
    size_t count = 0;
    for (const weft_spring_run *run = of->runs; run < of->runs + of->run_count; ++run) {
        for (size_t i = 0; i < run->count; ++i, ++count) {
            const size_t p = run->p + i, q = run->q + i, cols = def.cols;
            const size_t down = q / cols - p / cols;
            const size_t right
                = q % cols > p % cols ? q % cols - p % cols : p % cols - q % cols;
            ck_assert(p < q && q < of->particles && !joined[p][q]);
            ck_assert(down + right == 1 || (down == 1 && right == 1)
                      || (down + right == 2 && down * right == 0));
            joined[p][q] = true;
        }
    }
    ck_assert_uint_eq(count, of->pair_count);
    ck_assert_uint_eq(count, weft_cloth_springs(cloth, WEFT_STRETCH)
                                 + weft_cloth_springs(cloth, WEFT_SHEAR)
                                 + weft_cloth_springs(cloth, WEFT_BEND));
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

/* The model of `weft plugin-test`, with springs alone and with links. */
START_TEST(the_string_of_beads_has_its_structure)
{
    enum { COUNT = WEFT__STRING };
    const double s = 1e-5;
    double y[COUNT], dy[COUNT], product[COUNT], above[COUNT], below[COUNT];
    double f[2][COUNT];
    weft_structure of;
    weft__string_init(&of, _i == 1);
    weft__string_start(y);
    for (size_t j = 0; j < COUNT; ++j) {
        dy[j] = sin(7.0 * (double)j);
        above[j] = y[j] + s * dy[j], below[j] = y[j] - s * dy[j];
    }
    ck_assert_int_eq(weft__string_rhs(0.0, above, f[0], NULL), 0);
    ck_assert_int_eq(weft__string_rhs(0.0, below, f[1], NULL), 0);
    structured(&of, 0.0, y, dy, product);
    for (size_t j = 0; j < COUNT; ++j) {
        f[0][j] = (f[0][j] - f[1][j]) / (2.0 * s);
    }
    ck_assert(distance(f[0], product, COUNT) < 1e-6 * largest(product, COUNT));
}
END_TEST

START_TEST(springs_of_no_length_are_zeros)
{
    double y[6 * N], dy[6 * N], out[6 * N];
    weft_cloth *cloth = make(WEFT_MESH);
    weft_sim *sim = simulate(cloth);
    const weft_structure *of = seen.structure;
    double *planes = room(of);
    state(cloth, y, dy);
    for (size_t j = 0; j < 3 * N; ++j) {
        y[j] = 0.5;
    }
    ck_assert_int_eq(of->linearise(0.0, y, planes, NULL, of->ctx), 0);
    ck_assert(largest(planes, WEFT_PAIR_PLANES * of->pair_count) == 0.0);
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, out), 0);
    const double drag = 0.01 / weft_cloth_particle_mass(cloth, N / 2);
    ck_assert(fabs(out[4 * N + N / 2] + drag * dy[4 * N + N / 2]) < 1e-14 * drag);
    y[N] = (double)NAN;
    ck_assert_int_eq(of->linearise(0.0, y, planes, NULL, of->ctx), 1);
    free(planes);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

/* The masses are those of the present pins. */
static void masses_match(const weft_sim *sim)
{
    const weft_cloth *cloth = weft_sim_cloth(sim);
    for (size_t i = 0; i < N; ++i) {
        ck_assert(seen.structure->mass[i]
                  == (weft_cloth_pinned(cloth, i)
                          ? 0.0
                          : weft_cloth_particle_mass(cloth, i)));
        ck_assert(seen.structure->drag[i] == 0.01);
    }
}

START_TEST(structure_follows_pins_and_shapes)
{
    const weft_shape ball = { .kind = WEFT_SPHERE, .at = { 0, 0, -3 }, .radius = 1 };
    weft_cloth *cloth = make(WEFT_MESH);
    weft_sim *sim = simulate(cloth);
    const weft_structure *of = seen.structure;
    const double *mass = of->mass;
    unsigned char *saved = malloc(weft_sim_save_size(sim));
    const size_t size = weft_sim_save_size(sim);
    ck_assert_int_eq(weft_sim_save(sim, saved, size, NULL), WEFT_OK);
    masses_match(sim);
    seen.changed = 0;
    ck_assert_int_eq(weft_sim_pin(sim, 20, NULL, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_unpin(sim, 0, NULL), WEFT_OK);
    ck_assert(of->mass[20] == 0.0 && of->mass[0] > 0.0);
    masses_match(sim);
    ck_assert_int_eq(weft_sim_add_shape(sim, &ball, NULL, NULL), WEFT_OK);
    ck_assert_uint_eq(of->block_planes, WEFT_BLOCK_PLANES);
    ck_assert_uint_eq(seen.changed, 3);
    ck_assert_int_eq(weft_sim_restore(sim, saved, size, NULL), WEFT_OK);
    ck_assert_uint_eq(of->block_planes, 0);
    ck_assert_uint_eq(seen.changed, 4);
    masses_match(sim);
    ck_assert(seen.structure == of && of->mass == mass);
    free(saved);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(modes_are_those_of_the_stiffness)
{
    double y[6 * N], dy[6 * N], corners[WEFT_MODES_CORNERS + 1][2], box[4][2];
    weft_cloth *cloth = make(2);
    weft_sim *sim = simulate(cloth);
    const weft_structure *of = seen.structure;
    bool polygons = false;
    state(cloth, y, dy);
    for (int any = 0; any < 2; ++any) {
        const double *in = any ? NULL : y;
        const weft_stiffness want = weft_cloth_stiffness(cloth, 0.01, in);
        ck_assert_uint_eq(of->modes(0.01, in, corners, WEFT_MODES_CORNERS, of->ctx),
                          want.count);
        ck_assert_int_eq(memcmp(corners, want.corners, want.count * sizeof *corners),
                         0);
        if (want.count > 4) {
            ck_assert_uint_eq(of->modes(0.01, in, box, 4, of->ctx), 4);
            ck_assert(box[2][0] == want.omega2 && box[2][1] == want.damping);
            polygons = true;
        }
        ck_assert_uint_eq(of->modes(0.01, in, corners, 2, of->ctx), 0);
    }
    ck_assert(polygons);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(linearise_refuses_a_particle_in_a_shape)
{
    double y[6 * N], dy[6 * N];
    weft_cloth *cloth = make(1);
    weft_sim *sim = simulate(cloth);
    const weft_structure *of = seen.structure;
    double *planes = room(of), *blocks = planes + WEFT_PAIR_PLANES * of->pair_count;
    state(cloth, y, dy);
    y[2 * N + 24] = -0.3;
    ck_assert_int_eq(of->linearise(0.0, y, planes, NULL, of->ctx), 0);
    ck_assert_int_eq(of->linearise(0.0, y, planes, blocks, of->ctx), 1);
    free(planes);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(jacobian)
{
    Suite *suite = suite_create("jacobian");
    TCase *tcase = tcase_create("jacobian");
    tcase_add_loop_test(tcase, product_is_the_derivative_of_the_right_hand_side, 0,
                        CASES);
    tcase_add_loop_test(tcase, transposed_product_is_that_of_the_transpose, 0, CASES);
    tcase_add_loop_test(tcase, transposed_product_of_triangles_is_that_of_the_transpose,
                        0, 2);
    tcase_add_test(tcase, transposed_product_of_a_spring_is_by_hand);
    tcase_add_test(tcase, product_is_linear_and_refuses_what_is_not_finite);
    tcase_add_loop_test(tcase, structure_has_the_jacobian_of_the_cloth, 0, 2 * KINDS);
    tcase_add_test(tcase, structure_of_triangles_has_the_jacobian_of_the_cloth);
    tcase_add_test(tcase, links_are_for_methods_that_know_them);
    tcase_add_loop_test(tcase, damping_of_contact_is_exact_along_and_across, 0, 2);
    tcase_add_loop_test(tcase, runs_list_every_spring_once, 0, 7);
    tcase_add_loop_test(tcase, the_string_of_beads_has_its_structure, 0, 2);
    tcase_add_test(tcase, springs_of_no_length_are_zeros);
    tcase_add_test(tcase, structure_follows_pins_and_shapes);
    tcase_add_test(tcase, modes_are_those_of_the_stiffness);
    tcase_add_test(tcase, linearise_refuses_a_particle_in_a_shape);
    suite_add_tcase(suite, tcase);
    return suite;
}
