/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow kernels asan-long */
/* test_membrane.c -- the membrane of triangle meshes: exact energies of homogeneous
 * strain, gradients, invariants, the barrier, certified bounds, and the same bits
 * whatever the width of vectors and the division among threads. */
#include "meshes.h"

#include <math.h>

#include "cloth/model.h"

enum { SIDE = 20, MOST = 3000, KINDS = 5, LONG = KINDS, GRADED, ALL_KINDS };

weft__add_fn weft__membrane_wide;

static struct {
    test_mesh mesh;
    weft_cloth *cloth;
    size_t n;
    uint64_t seed;
    bool arc;
    double y[6 * MOST], f[3 * MOST], d[6 * MOST];
} m;

static void setup(void)
{
    m.seed = 5;
}

static void teardown(void)
{
    weft_cloth_destroy(m.cloth);
    mesh_free(&m.mesh);
    memset(&m, 0, sizeof m);
}

/* ---- cloths and states ----------------------------------------------------------- */

/* Of the membrane alone: without bending. */
static void make_pinned(const weft_pin *pins, size_t count)
{
    weft_fabric *fabric = &m.mesh.fabrics[0];
    fabric->bend[0] = fabric->bend[1] = fabric->twist = 0.0;
    m.mesh.def.arc = m.arc;
    weft_cloth_def def = mesh_cloth(&m.mesh);
    def.pins = pins, def.pin_count = count;
    weft_cloth_destroy(m.cloth);
    m.cloth = test_cloth(&def);
    m.n = weft_cloth_particles(m.cloth);
    weft_cloth_start(m.cloth, m.y);
}

static void make(void)
{
    make_pinned(NULL, 0);
}

/* Of mesh number k. */
static void make_kind(size_t k)
{
    static const test_diagonals diagonals[ALL_KINDS]
        = { MESH_RIGHT,  MESH_ALTERNATING, MESH_RANDOM, MESH_RIGHT,
            MESH_RANDOM, MESH_RANDOM,      MESH_RANDOM };
    static const double jitters[ALL_KINDS] = { 0.0, 0.0, 0.0, 0.25, 0.3, 0.2, 0.2 };
    mesh_free(&m.mesh);
    mesh_sheet(&m.mesh, SIDE, SIDE + 3, 0.02, diagonals[k], jitters[k], 7);
    for (size_t i = 0; k >= KINDS && i < m.mesh.def.vertices; ++i) {
        double *u = &m.mesh.rest[2 * i];
        *u = k == LONG ? 4.0 * *u : *u * (0.2 + 2.0 * *u);
        m.mesh.start[3 * i] = *u;
    }
    make();
}

static void damp(double tau)
{
    m.mesh.fabrics[0].damping[0] = tau;
}

/* x = gradient[3][2] (u, v) for each particle: plus noise, in spacings; v at random. */
static void place(const double gradient[3][2], double noise, double speed)
{
    double *rest = malloc(3 * m.n * sizeof *rest);
    for (size_t i = 0; i < m.n; ++i) {
        const double *at = &m.mesh.rest[2 * weft_cloth_vertex(m.cloth, i)];
        for (size_t k = 0; k < 3; ++k) {
            m.y[k * m.n + i] = gradient[k][0] * at[0] + gradient[k][1] * at[1]
                               + 0.02 * noise * (random_uniform(&m.seed) - 0.5);
            m.y[(k + 3) * m.n + i] = speed * (random_uniform(&m.seed) - 0.5);
        }
    }
    free(rest);
}

/* A turned sheet, stretched by a and b. */
static void place_turned(double a, double b, double noise, double speed)
{
    const double turned[3][2]
        = { { 0.36 * a, -0.8 * b }, { 0.48 * a, 0.6 * b }, { -0.8 * a, 0.0 } };
    place(turned, noise, speed);
}

static double energy_of(const double *y)
{
    const weft_energy energy = weft_cloth_energy(m.cloth, 0.0, y);
    return energy.elastic[WEFT_STRETCH] + energy.elastic[WEFT_SHEAR];
}

static double largest(const double *of, size_t count)
{
    double most = 0.0;
    for (size_t j = 0; j < count; ++j) {
        most = fmax(most, fabs(of[j]));
    }
    return most;
}

/* ---- energy and force ------------------------------------------------------------ */

START_TEST(homogeneous_strain_has_the_energy_of_the_fabric)
{
    m.arc = _i == 1;
    const weft_fabric *c = &mesh_fabric;
    const double f[3][2] = { { 1.1, 0.2 }, { -0.1, 0.9 }, { 0.3, -0.15 } };
    double e[3] = { -0.5, -0.5, 0.0 }; /* E11, E22, E12 */
    for (size_t k = 0; k < 3; ++k) {
        e[0] += 0.5 * f[k][0] * f[k][0];
        e[1] += 0.5 * f[k][1] * f[k][1];
        e[2] += 0.5 * f[k][0] * f[k][1];
    }
    for (size_t kind = 0; kind < KINDS; ++kind) {
        make_kind(kind);
        place(f, 0.0, 0.0);
        const double area = 0.02 * 0.02 * (SIDE - 1) * (SIDE + 2);
        const weft_energy energy = weft_cloth_energy(m.cloth, 0.0, m.y);
        const double stretch
            = 0.5 * area
              * (c->stretch[1] * e[0] * e[0] + c->stretch[0] * e[1] * e[1]
                 + 2.0 * c->coupling * e[0] * e[1]);
        ck_assert_double_eq_tol(energy.elastic[WEFT_STRETCH] / stretch, 1.0, 1e-12);
        ck_assert_double_eq_tol(energy.elastic[WEFT_SHEAR]
                                    / (0.5 * area * 4.0 * c->shear * e[2] * e[2]),
                                1.0, 1e-12);
    }
}
END_TEST

START_TEST(homogeneous_strain_has_no_force_inside)
{
    m.arc = _i == 1;
    make_kind(4);
    place_turned(1.1, 0.95, 0.0, 0.0);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    const double most = largest(m.f, 3 * m.n);
    for (size_t i = 0; i < m.n; ++i) {
        const size_t v = weft_cloth_vertex(m.cloth, i), r = v / (SIDE + 3),
                     c = v % (SIDE + 3);
        const bool inner = r > 0 && c > 0 && r + 1 < SIDE && c + 1 < SIDE + 3;
        for (size_t k = 0; inner && k < 3; ++k) {
            ck_assert_double_le(fabs(m.f[k * m.n + i]), 1e-12 * most);
        }
    }
    ck_assert_double_gt(most, 0.1);
}
END_TEST

START_TEST(cloth_at_rest_has_no_force_and_a_moved_one_none_but_roundoff)
{
    m.arc = _i == 1;
    make_kind(4);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) { /* an arc has the square of roundoff */
        ck_assert_double_le(fabs(m.f[j]), m.arc ? 1e-25 : 0.0);
    }
    place_turned(1.0, 1.0, 0.0, 0.0);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    ck_assert_double_le(largest(m.f, 3 * m.n), 1e-11);
    ck_assert_double_le(energy_of(m.y), 1e-24);
}
END_TEST

/* -dU/dx along a random direction, by differences of order 4. */
static void check_gradient(double step, double tolerance)
{
    double *z = malloc(6 * m.n * sizeof *z), slope = 0.0, work = 0.0;
    static const double at[4] = { -2.0, -1.0, 1.0, 2.0 },
                        weight[4] = { 1.0, -8.0, 8.0, -1.0 };
    for (size_t j = 0; j < 3 * m.n; ++j) {
        m.d[j] = random_uniform(&m.seed) - 0.5;
    }
    for (size_t k = 0; k < 4; ++k) {
        memcpy(z, m.y, 6 * m.n * sizeof *z);
        for (size_t j = 0; j < 3 * m.n; ++j) {
            z[j] += at[k] * step * m.d[j];
        }
        slope += weight[k] * energy_of(z) / (12.0 * step);
    }
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        work -= m.f[j] * m.d[j];
    }
    ck_assert_double_eq_tol(slope / work, 1.0, tolerance);
    free(z);
}

START_TEST(force_is_the_gradient_of_the_energy)
{
    m.arc = _i == 1;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        make_kind(kind);
        place_turned(1.1, 1.0, 0.1, 0.0); /* a polynomial of degree 4: exact */
        check_gradient(1e-4, 1e-9);
    }
}
END_TEST

START_TEST(collapsing_cloth_has_the_gradient_of_its_barrier)
{
    m.arc = _i == 1;
    make_kind(4);
    place_turned(0.6, 0.7, 0.3, 0.0);
    check_gradient(1e-7, 1e-7);
}
END_TEST

START_TEST(forces_have_no_resultant_and_no_moment)
{
    m.arc = _i == 1;
    make_kind(4);
    damp(0.01);
    make();
    place_turned(0.8, 0.7, 1.0, 3.0);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    double size = 0.0, sum[6] = { 0.0 };
    for (size_t i = 0; i < m.n; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            const size_t a = (k + 1) % 3 * m.n + i, b = (k + 2) % 3 * m.n + i;
            sum[k] += m.f[k * m.n + i];
            sum[k + 3] += m.y[a] * m.f[b] - m.y[b] * m.f[a];
            size += fabs(m.f[k * m.n + i]);
        }
    }
    ck_assert_double_le(largest(sum, 6), 1e-13 * size);
}
END_TEST

START_TEST(product_is_the_derivative_of_the_forces)
{
    m.arc = _i == 1;
    static double z[6 * MOST], ahead[6 * MOST], behind[6 * MOST], product[6 * MOST];
    static const double stretches[2] = { 1.05, 0.7 }; /* the barrier acts on the last */
    for (size_t k = 0; k < 2; ++k) {
        make_kind(4);
        damp(0.01);
        make();
        place_turned(stretches[k], stretches[k], 0.3, 1.0);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            m.d[j] = random_uniform(&m.seed) - 0.5;
        }
        const double step = 1e-7;
        for (size_t j = 0; j < 6 * m.n; ++j) {
            z[j] = m.y[j] + step * m.d[j];
        }
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, z, ahead), 0);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            z[j] = m.y[j] - step * m.d[j];
        }
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, z, behind), 0);
        ck_assert_int_eq(weft_cloth_jacobian_product(m.cloth, 0.0, m.y, m.d, product),
                         0);
        const double most = largest(product, 6 * m.n);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            const double slope = (ahead[j] - behind[j]) / (2.0 * step);
            ck_assert_double_eq_tol(product[j] / most, slope / most, 1e-7);
        }
    }
}
END_TEST

START_TEST(damping_turns_its_power_into_heat)
{
    m.arc = _i == 1;
    double power[WEFT_POWERS], work = 0.0;
    make_kind(4);
    damp(0.02);
    make();
    place_turned(1.1, 0.9, 0.3, 2.0);
    weft_cloth_power(m.cloth, 0.0, m.y, power);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        work += m.f[j] * m.y[3 * m.n + j];
    }
    memcpy(m.d, m.y + 3 * m.n, 3 * m.n * sizeof *m.d);
    memset(m.y + 3 * m.n, 0, 3 * m.n * sizeof *m.y);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        work -= m.f[j] * m.d[j];
    }
    ck_assert_double_gt(power[WEFT_POWER_SPRINGS], 0.0);
    ck_assert_double_eq_tol(power[WEFT_POWER_SPRINGS] / -work, 1.0, 1e-12);
}
END_TEST

START_TEST(moving_pins_put_in_the_work_of_their_forces)
{
    m.arc = _i == 1;
    static const size_t vertices[3] = { 0, 5, 40 };
    const weft_pin pin
        = { .velocity = { 1.0, -2.0, 0.5 }, .vertices = vertices, .vertex_count = 3 };
    double power[WEFT_POWERS], work = 0.0;
    mesh_sheet(&m.mesh, SIDE, SIDE, 0.02, MESH_RANDOM, 0.2, 3);
    make_pinned(&pin, 1);
    place_turned(1.1, 0.9, 0.5, 0.0);
    weft_cloth_power(m.cloth, 0.0, m.y, power);
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t v = 0; v < 3; ++v) {
        for (size_t k = 0; k < 3; ++k) {
            const size_t i = weft_cloth_index(m.cloth, vertices[v]);
            work -= m.f[k * m.n + i] * pin.velocity[k];
        }
    }
    ck_assert_double_eq_tol(power[WEFT_POWER_PINS] / work, 1.0, 1e-13);
}
END_TEST

/* ---- the barrier ----------------------------------------------------------------- */

/* The part of the energy that C:E does not have, of cloth squeezed to J = a b. */
static double barrier_of(double a, double b)
{
    const weft_fabric *c = &mesh_fabric;
    const double e = 0.5 * (a * a - 1.0), f = 0.5 * (b * b - 1.0);
    const double area = 0.02 * 0.02 * (SIDE - 1) * (SIDE + 2);
    place_turned(a, b, 0.0, 0.0);
    return energy_of(m.y) / area
           - 0.5
                 * (c->stretch[1] * e * e + c->stretch[0] * f * f
                    + 2.0 * c->coupling * e * f);
}

START_TEST(barrier_begins_below_six_tenths_of_the_area)
{
    make_kind(2);
    const double k = (1000.0 + 700.0) / 8.0;
    ck_assert_double_le(fabs(barrier_of(0.75, 0.8001)), 1e-11);
    const double ratio = 0.55, s = 1.0 - ratio * ratio / 0.36;
    ck_assert_double_eq_tol(barrier_of(0.55, 1.0) / (k * s * s * s * s / (1.0 - s)),
                            1.0, 1e-7);
    ck_assert_double_gt(barrier_of(1e-4, 1.0), 1e7);
}
END_TEST

START_TEST(flattened_triangle_makes_the_state_unusable)
{
    make_kind(0);
    const double flat[3][2] = { { 1.0, 0.0 }, { 0.0, 0.0 }, { 0.0, 0.0 } };
    place(flat, 0.0, 0.0);
    for (weft__isa isa = WEFT__LOOPS; isa <= weft__isa_last(); ++isa) {
        weft__cloth_choose(m.cloth, isa);
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, m.d), 1);
    }
    ck_assert_double_eq(energy_of(m.y), (double)INFINITY);
}
END_TEST

/* ---- bounds ---------------------------------------------------------------------- */

static double true_stiffness(void)
{
    weft_stiffness found;
    ck_assert_int_eq(weft_cloth_stiffness_refined(m.cloth, 0.0, m.y, 200, &found, NULL),
                     WEFT_OK);
    return found.omega2;
}

START_TEST(bound_at_rest_is_near_the_truth)
{
    m.arc = _i == 1;
    for (size_t kind = 0; kind < KINDS; ++kind) {
        make_kind(kind);
        const double bound = weft_cloth_stiffness(m.cloth, 0.0, m.y).omega2;
        const double part = bound / true_stiffness();
        ck_assert_msg(part >= 1.0 && part <= 1.75, "mesh %zu: %g", kind, part);
        ck_assert_double_ge(weft_cloth_stiffness(m.cloth, 0.0, NULL).omega2, bound);
    }
}
END_TEST

START_TEST(bound_holds_in_rough_and_in_crushed_states)
{
    m.arc = _i == 1;
    static const double stretches[][2] = { { 1.0, 1.0 }, { 2.0, 1.5 }, { 0.6, 0.7 } };
    make_kind(4);
    for (size_t k = 0; k < 3; ++k) {
        place_turned(stretches[k][0], stretches[k][1], 0.5, 0.0);
        const double bound = weft_cloth_stiffness(m.cloth, 0.0, m.y).omega2;
        const double part = bound / true_stiffness();
        ck_assert_msg(part >= 1.0 && part <= 5.0, "state %zu: %g", k, part);
    }
}
END_TEST

START_TEST(bound_without_a_state_holds_for_stretches_up_to_one_and_a_tenth)
{
    m.arc = _i == 1;
    static const double stretches[][2] = { { 1.1, 1.1 }, { 1.1, 0.6 }, { 0.6, 1.1 } };
    static const double couplings[] = { 100.0, -150.0, 700.0 };
    for (size_t c = 0; c < 3; ++c) {
        make_kind(4);
        m.mesh.fabrics[0].coupling = couplings[c];
        m.mesh.fabrics[0].shear = c == 2 ? 900.0 : 150.0;
        make();
        const double bound = weft_cloth_stiffness(m.cloth, 0.0, NULL).omega2;
        for (size_t k = c; k < (size_t)test_rounds((int)c + 1, (int)c + 3); ++k) {
            place_turned(stretches[k % 3][0], stretches[k % 3][1], 0.0, 0.0);
            ck_assert_double_ge(bound, true_stiffness());
        }
    }
}
END_TEST

/* The kinetic energy after so many steps of velocity Verlet from small noise. */
static double verlet_energy(double h, size_t steps)
{
    static double dydt[6 * MOST];
    double *x = m.y, *v = m.y + 3 * m.n, *a = dydt + 3 * m.n;
    weft_cloth_start(m.cloth, m.y);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        v[j] = 1e-6 * (random_uniform(&m.seed) - 0.5);
    }
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, dydt), 0);
    for (size_t s = 0; s < steps; ++s) {
        for (size_t j = 0; j < 3 * m.n; ++j) {
            v[j] += 0.5 * h * a[j];
            x[j] += h * v[j];
        }
        if (weft_cloth_rhs(m.cloth, 0.0, m.y, dydt) != 0) {
            return INFINITY;
        }
        for (size_t j = 0; j < 3 * m.n; ++j) {
            v[j] += 0.5 * h * a[j];
        }
    }
    return weft_cloth_energy(m.cloth, 0.0, m.y).kinetic;
}

START_TEST(verlet_is_stable_at_the_step_of_the_bound_and_not_far_above)
{
    m.arc = _i == 1;
    for (size_t kind = 0; kind < ALL_KINDS; ++kind) {
        make_kind(kind);
        const double h = 2.0 / sqrt(weft_cloth_stiffness(m.cloth, 0.0, m.y).omega2);
        const double before = verlet_energy(0.0, 0);
        ck_assert_double_le(verlet_energy(0.99 * h, 300), 2.0 * before);
        ck_assert_double_ge(verlet_energy(1.6 * h, 300), 1e3 * before);
    }
}
END_TEST

/* ---- arcs ------------------------------------------------------------------------ */

/* [J/m^2] of a sheet of 0.38 m x 0.44 m that is rolled up on a cylinder of radius
 * 0.12 m, at an angle to all edges, in cells of 0.02 m / `finer`. */
static double energy_of_a_roll(bool arc, size_t finer)
{
    const double spacing = 0.02 / (double)finer, radius = 0.12;
    mesh_free(&m.mesh);
    mesh_sheet(&m.mesh, 19 * finer + 1, 22 * finer + 1, spacing, MESH_RIGHT, 0.0, 1);
    m.arc = arc;
    make();
    for (size_t i = 0; i < m.n; ++i) {
        const double *at = &m.mesh.rest[2 * weft_cloth_vertex(m.cloth, i)];
        const double angle = (0.96 * at[0] + 0.28 * at[1]) / radius;
        m.y[i] = radius * sin(angle);
        m.y[m.n + i] = 0.96 * at[1] - 0.28 * at[0];
        m.y[2 * m.n + i] = radius * cos(angle);
    }
    return energy_of(m.y);
}

START_TEST(roll_is_strained_by_order_four_along_arcs_and_by_two_along_chords)
{
    const double chords[2] = { energy_of_a_roll(false, 1), energy_of_a_roll(false, 2) };
    const double arcs[2] = { energy_of_a_roll(true, 1), energy_of_a_roll(true, 2) };
    ck_assert_double_eq_tol(chords[0] / chords[1], 16.0, 0.2);
    ck_assert_double_ge(arcs[0] / arcs[1], 240.0);
    ck_assert_double_le(arcs[0], 1e-3 * chords[0]);
    (void)energy_of_a_roll(true, 1);
    const double bound = weft_cloth_stiffness(m.cloth, 0.0, m.y).omega2;
    const double part = bound / true_stiffness();
    ck_assert_msg(part >= 1.0 && part <= 1.75, "%g", part);
    ck_assert_double_ge(weft_cloth_stiffness(m.cloth, 0.0, NULL).omega2, bound);
}
END_TEST

/* ---- the matrix ------------------------------------------------------------------ */

/* K x or C x by the links of a state: their 9 numbers from `first` on. */
static void multiply_links(size_t first, const double *x, double *out)
{
    const size_t count = weft__list_block_couplings(m.cloth, NULL), n = m.n;
    weft_block_coupling *links = malloc(count * sizeof *links);
    double *numbers = malloc(WEFT_COUPLING_NUMBERS * count * sizeof *numbers);
    (void)weft__list_block_couplings(m.cloth, links);
    ck_assert_int_eq(weft__linearise_block_couplings(m.cloth, 0.0, m.y, numbers), 0);
    memset(out, 0, 3 * n * sizeof *out);
    for (size_t l = 0; l < count; ++l) {
        const double *a = numbers + WEFT_COUPLING_NUMBERS * l + first;
        const size_t p = links[l].p, q = links[l].q;
        ck_assert_uint_lt(p, q);
        for (size_t j = 0; j < 9; ++j) {
            const size_t r = j / 3 * n, c = j % 3 * n;
            out[r + p] += a[j] * (x[c + p] - x[c + q]);
            out[c + q] += a[j] * (x[r + q] - x[r + p]);
        }
    }
    free(links);
    free(numbers);
}

static double scalar(const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t j = 0; j < 3 * m.n; ++j) {
        sum += a[j] * b[j];
    }
    return sum;
}

START_TEST(links_are_symmetric_and_never_negative_in_any_state)
{
    m.arc = _i == 1;
    static double of_x[3 * MOST], of_z[3 * MOST];
    mesh_sheet(&m.mesh, SIDE, SIDE, 0.02, MESH_RANDOM, 0.3, 2);
    mesh_sew(&m.mesh, 11, 0.1, 0.6, 0.8);
    damp(0.01);
    make();
    place_turned(0.8, 0.75, 0.5, 1.0);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        m.d[j] = random_uniform(&m.seed) - 0.5;
    }
    const double *x = m.d, *z = m.d + 3 * m.n;
    for (size_t part = 0; part < 2; ++part) {
        multiply_links(9 * part, x, of_x);
        multiply_links(9 * part, z, of_z);
        const double size = scalar(x, of_x);
        ck_assert_double_gt(size, 0.0);
        ck_assert_double_ge(scalar(z, of_z), 0.0);
        ck_assert_double_eq_tol(scalar(z, of_x) / size, scalar(x, of_z) / size, 1e-12);
    }
}
END_TEST

/* Of arcs they leave out what presses at the parts of some. */
START_TEST(links_of_taut_cloth_are_its_derivative)
{
    m.arc = _i == 1;
    static double by_links[3 * MOST], product[6 * MOST];
    make_kind(4);
    damp(0.01);
    make();
    place_turned(1.3, 1.2, 0.05, 0.0);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        m.d[j] = random_uniform(&m.seed) - 0.5;
    }
    for (size_t part = 0; part < 2; ++part) {
        double direction[6 * MOST] = { 0.0 };
        const size_t at = 3 * m.n * part;
        memcpy(direction + at, m.d + at, 3 * m.n * sizeof *m.d);
        ck_assert_int_eq(
            weft_cloth_jacobian_product(m.cloth, 0.0, m.y, direction, product), 0);
        multiply_links(9 * part, m.d + at, by_links);
        const double most = largest(by_links, 3 * m.n);
        double more = 0.0, all = 0.0;
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const double mass = m.cloth->mesh.mass[j % m.n];
            const double derived = -mass * product[3 * m.n + j];
            if (!m.arc || part == 1) {
                ck_assert_double_eq_tol(derived / most, by_links[j] / most, 1e-12);
            }
            more += m.d[at + j] * (by_links[j] - derived);
            all += m.d[at + j] * by_links[j];
        }
        ck_assert(more >= -1e-12 * all && more <= 1e-2 * all);
    }
}
END_TEST

START_TEST(strains_are_those_of_the_edges)
{
    static double strain[MOST];
    make_kind(0);
    place_turned(1.2, 1.0, 0.0, 0.0);
    const weft_spring worst = weft_cloth_worst_spring(m.cloth, m.y);
    ck_assert_double_eq_tol(worst.strain, 0.2, 1e-12);
    ck_assert(worst.q == worst.p + 1 || worst.p == worst.q + 1); /* along u */
    weft_cloth_strains(m.cloth, m.y, strain);
    for (size_t i = 0; i < m.n; ++i) {
        ck_assert_double_eq_tol(strain[i], 0.2, 1e-12);
    }
}
END_TEST

/* ---- bits ------------------------------------------------------------------------ */

static size_t form_count(void)
{
    return (size_t)weft__isa_last() + 2;
}

static void choose(size_t form)
{
    const bool wide = form + 1 == form_count();
    weft__cloth_choose(m.cloth, wide ? WEFT__LOOPS : (weft__isa)form);
    m.cloth->membrane.fast = wide ? weft__membrane_wide : m.cloth->membrane.fast;
}

/* Of dy/dt, blocks taken in runs of `run`, the last one first. */
static uint64_t bits(size_t run)
{
    const weft__state at = { .y = m.y };
    const size_t blocks = weft__blocks(&m.cloth->mesh);
    for (size_t end = blocks; end > 0; end = end > run ? end - run : 0) {
        ck_assert_int_eq(
            weft__rhs_blocks(m.cloth, &at, m.d, end > run ? end - run : 0, end), 0);
    }
    return test_hash(m.d, 6 * m.n);
}

START_TEST(every_level_and_division_has_the_bits_of_the_plain_loops)
{
    m.arc = _i == 1;
    static const size_t sizes[][2] = { { 2, 2 }, { 3, 2 }, { 23, 23 }, { 40, 70 } };
    for (size_t s = 0; s < 8; ++s) {
        mesh_free(&m.mesh);
        mesh_sheet(&m.mesh, sizes[s / 2][0], sizes[s / 2][1], 0.02, MESH_RANDOM, 0.3,
                   s + 1);
        damp(s % 2 == 0 ? 0.0 : 0.01);
        make();
        place_turned(0.8, 0.75, 0.8, 1.0); /* the barrier acts on some */
        choose(0);
        const uint64_t plain = bits(1);
        for (size_t form = 0; form < form_count(); ++form) {
            choose(form);
            ck_assert_uint_eq(bits(1), plain);
            ck_assert_uint_eq(bits(2), plain);
            ck_assert_uint_eq(bits(100), plain);
        }
    }
}
END_TEST

/* One vertex with more neighbours than fit beside a block in the fast form. */
START_TEST(vertex_of_a_thousand_triangles_has_the_same_bits)
{
    m.arc = _i == 1;
    const size_t rim = 1600;
    m.mesh.start = malloc(3 * (rim + 1) * sizeof *m.mesh.start);
    m.mesh.rest = malloc(2 * (rim + 1) * sizeof *m.mesh.rest);
    m.mesh.corners = malloc(3 * rim * sizeof *m.mesh.corners);
    m.mesh.places = malloc(3 * rim * sizeof *m.mesh.places);
    m.mesh.fabrics[0] = mesh_fabric;
    for (size_t i = 0; i <= rim; ++i) {
        const double angle = 6.283185307179586 * (double)i / (double)rim;
        const double at[3] = { i < rim ? cos(angle) : 0.0, i < rim ? sin(angle) : 0.0 };
        memcpy(&m.mesh.start[3 * i], at, sizeof at);
        memcpy(&m.mesh.rest[2 * i], at, 2 * sizeof *at);
    }
    for (size_t i = 0; i < rim; ++i) {
        const uint32_t corners[3]
            = { (uint32_t)rim, (uint32_t)i, (uint32_t)((i + 1) % rim) };
        memcpy(&m.mesh.corners[3 * i], corners, sizeof corners);
        memcpy(&m.mesh.places[3 * i], corners, sizeof corners);
    }
    mesh_point(&m.mesh, rim + 1, rim + 1, rim);
    make();
    place_turned(1.1, 0.9, 0.01, 1.0);
    choose(0);
    const uint64_t plain = bits(1);
    for (size_t form = 0; form < form_count(); ++form) {
        choose(form);
        ck_assert_uint_eq(bits(1), plain);
    }
}
END_TEST

START_TEST(every_level_refuses_what_is_not_finite)
{
    m.arc = _i == 1;
    mesh_sheet(&m.mesh, 5, 4, 0.02, MESH_RANDOM, 0.2, 1);
    damp(0.01);
    make();
    for (size_t form = 0; form < form_count(); ++form) {
        choose(form);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            const double kept = m.y[j];
            m.y[j] = j % 2 == 0 ? (double)NAN : (double)INFINITY;
            ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, m.d), 1);
            m.y[j] = kept;
        }
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, m.d), 0);
    }
}
END_TEST

START_TEST(numbers_of_vertices_and_triangles_do_not_matter)
{
    m.arc = _i == 1;
    static double force[3 * MOST];
    uint32_t to[MOST];
    mesh_sheet(&m.mesh, SIDE, SIDE, 0.02, MESH_RANDOM, 0.3, 1);
    make();
    place_turned(1.05, 0.9, 0.0, 0.0);
    for (size_t i = 0; i < m.n; ++i) { /* by vertex: a bent sheet */
        m.y[2 * m.n + i] += 0.01 * sin(20.0 * m.y[i]);
    }
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const size_t v = weft_cloth_vertex(m.cloth, j % m.n);
        force[j / m.n * m.n + v] = m.f[j];
        m.d[j / m.n * m.n + v] = m.y[j];
    }
    const uint64_t hash = weft__cloth_hash(m.cloth, NULL);
    mesh_shuffle(&m.mesh, 3, to);
    make();
    ck_assert_uint_eq(weft__cloth_hash(m.cloth, NULL), hash);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const size_t plane = j / m.n * m.n;
        m.y[plane + weft_cloth_index(m.cloth, to[j % m.n])] = m.d[j];
    }
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    const double most = largest(m.f, 3 * m.n);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const size_t plane = j / m.n * m.n;
        const double found = m.f[plane + weft_cloth_index(m.cloth, to[j % m.n])];
        ck_assert_double_eq_tol(found / most, force[j] / most, 1e-12);
    }
}
END_TEST

START_TEST(hash_tells_apart_what_moves_differently)
{
    uint64_t hashes[7];
    for (size_t k = 0; k < 7; ++k) {
        mesh_free(&m.mesh);
        mesh_sheet(&m.mesh, 5, 4, 0.02, k == 1 ? MESH_ALTERNATING : MESH_RIGHT, 0.2, 1);
        weft_fabric *of = &m.mesh.fabrics[0];
        of->stretch[0] += k == 2 ? 1.0 : 0.0;
        of->coupling += k == 3 ? 1.0 : 0.0;
        of->damping[0] += k == 4 ? 1e-3 : 0.0;
        m.mesh.rest[2 * 6] += k == 5 ? 1e-6 : 0.0;
        m.arc = k == 6;
        make();
        hashes[k] = weft__cloth_hash(m.cloth, NULL);
        for (size_t j = 0; j < k; ++j) {
            ck_assert_uint_ne(hashes[j], hashes[k]);
        }
    }
}
END_TEST

START_TEST(membranes_that_cannot_be_are_refused)
{
    weft_error err;
    mesh_sheet(&m.mesh, 4, 4, 1e-3, MESH_RIGHT, 0.0, 1);
    weft_cloth_def def = mesh_cloth(&m.mesh);
    m.mesh.fabrics[0].stretch[0] = 1e300;
    ck_assert_int_eq(weft_cloth_create(&def, &m.cloth, &err), WEFT_INVALID);
    ck_assert_str_eq(
        err.message,
        "the membrane of triangle 0 is too stiff or too small for a double "
        "at its height of 0.000707 m");
}
END_TEST

TEST_SUITE(membrane)
{
    Suite *suite = suite_create("membrane");
    TCase *tcase = tcase_create("membrane");
    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, homogeneous_strain_has_the_energy_of_the_fabric, 0, 2);
    tcase_add_loop_test(tcase, homogeneous_strain_has_no_force_inside, 0, 2);
    tcase_add_loop_test(
        tcase, cloth_at_rest_has_no_force_and_a_moved_one_none_but_roundoff, 0, 2);
    tcase_add_loop_test(tcase, force_is_the_gradient_of_the_energy, 0, 2);
    tcase_add_loop_test(tcase, collapsing_cloth_has_the_gradient_of_its_barrier, 0, 2);
    tcase_add_loop_test(tcase, forces_have_no_resultant_and_no_moment, 0, 2);
    tcase_add_loop_test(tcase, product_is_the_derivative_of_the_forces, 0, 2);
    tcase_add_loop_test(tcase, damping_turns_its_power_into_heat, 0, 2);
    tcase_add_loop_test(tcase, moving_pins_put_in_the_work_of_their_forces, 0, 2);
    tcase_add_test(tcase,
                   roll_is_strained_by_order_four_along_arcs_and_by_two_along_chords);
    tcase_add_test(tcase, barrier_begins_below_six_tenths_of_the_area);
    tcase_add_test(tcase, flattened_triangle_makes_the_state_unusable);
    tcase_add_loop_test(tcase, bound_at_rest_is_near_the_truth, 0, 2);
    tcase_add_loop_test(tcase, bound_holds_in_rough_and_in_crushed_states, 0, 2);
    tcase_add_loop_test(
        tcase, bound_without_a_state_holds_for_stretches_up_to_one_and_a_tenth, 0, 2);
    tcase_add_loop_test(
        tcase, verlet_is_stable_at_the_step_of_the_bound_and_not_far_above, 0, 2);
    tcase_add_loop_test(tcase, links_are_symmetric_and_never_negative_in_any_state, 0,
                        2);
    tcase_add_loop_test(tcase, links_of_taut_cloth_are_its_derivative, 0, 2);
    tcase_add_test(tcase, strains_are_those_of_the_edges);
    tcase_add_loop_test(tcase, every_level_and_division_has_the_bits_of_the_plain_loops,
                        0, 2);
    tcase_add_loop_test(tcase, vertex_of_a_thousand_triangles_has_the_same_bits, 0, 2);
    tcase_add_loop_test(tcase, every_level_refuses_what_is_not_finite, 0, 2);
    tcase_add_loop_test(tcase, numbers_of_vertices_and_triangles_do_not_matter, 0, 2);
    tcase_add_test(tcase, hash_tells_apart_what_moves_differently);
    tcase_add_test(tcase, membranes_that_cannot_be_are_refused);
    suite_add_tcase(suite, tcase);
    return suite;
}
