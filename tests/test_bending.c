/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* Bending rigidity: the energy and the matrix of a plate, cantilevers against the heavy
 * elastica, frequencies, and what every force must keep. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 320 }; /* particles */

static const weft_pin clamp[] = { { .rows = { 0, 0 }, .cols = { 0, 1 } } };

/* In (-1, 1). */
static double noise(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

static void close_to(double found, double wanted, double tolerance)
{
    ck_assert_msg(fabs(found - wanted) <= tolerance * fabs(wanted), "%.15g, not %.15g",
                  found, wanted);
}

/* A level sheet without gravity: columns along z, rows along x. */
static weft_cloth_def sheet(size_t rows, size_t cols, double a, double b)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows, def.cols = cols;
    def.spacing[0] = a, def.spacing[1] = b;
    def.down[1] = 0.0, def.down[2] = 1.0;
    def.gravity[1] = 0.0;
    return def;
}

/* 5 x 7, oblong, with three moduli that differ. */
static weft_cloth_def oblong(void)
{
    weft_cloth_def def = sheet(5, 7, 0.1, 0.15);
    def.bending = (weft_bending_def){ { 2e-5, 5e-5 }, 3e-5, 0.0 };
    return def;
}

/* ---- energy and matrix ----------------------------------------------------------- */

START_TEST(energy_of_a_quadratic_surface_is_exact)
{
    const weft_cloth_def def = oblong();
    weft_cloth *cloth = test_cloth(&def);
    double y[6 * 35];
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < 35; ++i) {
        const double s = 0.1 * (double)(i / 7), t = 0.15 * (double)(i % 7);
        y[35 + i] = 0.5 * 1.5 * s * s - 0.5 * 0.7 * t * t + 0.4 * s * t;
    }
    const weft_energy energy = weft_cloth_energy(cloth, 0.0, y);
    close_to(energy.elastic[WEFT_BEND], 1.1478e-5, 1e-12);
    ck_assert(energy.elastic[WEFT_STRETCH] == 0.0);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(energy_of_a_cylinder)
{
    weft_cloth_def def = sheet(9, 5, 0.125, 0.2);
    def.bending.rigidity[0] = 1.0;
    weft_cloth *cloth = test_cloth(&def);
    double y[6 * 45];
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < 45; ++i) {
        const double angle = 2.0 * 0.125 * (double)(i / 5);
        y[45 + i] = 0.5 * cos(angle);
        y[90 + i] = 0.5 * sin(angle);
    }
    close_to(weft_cloth_energy(cloth, 0.0, y).elastic[WEFT_BEND], 1.385484834258,
             1e-12);
    weft_cloth_destroy(cloth);
}
END_TEST

/* -dF_i/dx_j [N/m] of one coordinate. */
static double entry(const weft_cloth *cloth, size_t i, size_t j)
{
    const size_t n = weft_cloth_particles(cloth);
    double y[6 * MOST], dy[6 * MOST] = { 0.0 }, out[6 * MOST];
    weft_cloth_start(cloth, y);
    dy[n + j] = 1.0;
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, out), 0);
    return -out[4 * n + i] * weft_cloth_particle_mass(cloth, i);
}

START_TEST(matrix_has_its_entries)
{
    static const struct {
        size_t r, c, r2, c2;
        double entry; /* [N/m] */
    } known[] = {
        { 0, 0, 0, 0, 6.240740740741e-3 },
        { 2, 0, 2, 0, 1.848148148148e-2 },
        { 1, 1, 1, 1, 3.840740740741e-2 },
        { 2, 3, 2, 3, 4.288888888889e-2 },
        { 2, 3, 1, 3, -2e-2 },
        { 2, 3, 2, 2, -1.392592592593e-2 },
        { 2, 3, 1, 2, 4e-3 },
        { 2, 3, 0, 3, 3e-3 },
        { 2, 3, 2, 1, 1.481481481481e-3 },
    };
    const weft_cloth_def def = oblong();
    weft_cloth *cloth = test_cloth(&def);
    for (size_t k = 0; k < sizeof known / sizeof known[0]; ++k) {
        const size_t i = known[k].r * 7 + known[k].c, j = known[k].r2 * 7 + known[k].c2;
        close_to(entry(cloth, i, j), known[k].entry, 2e-12);
        ck_assert(fabs(entry(cloth, i, j) - entry(cloth, j, i)) < 1e-17);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(largest_eigenvalue_and_its_bound)
{
    const weft_cloth_def def = oblong();
    weft_cloth *cloth = test_cloth(&def);
    double y[6 * 35];
    weft_stiffness fine;
    weft_cloth_start(cloth, y);
    ck_assert_int_eq(weft_cloth_stiffness_refined(cloth, 0.0, y, 20000, &fine, NULL),
                     WEFT_OK);
    close_to(fine.omega2, 40.5184592178, 1e-11);
    close_to(weft_cloth_stiffness(cloth, 0.0, NULL).omega2, 45.2345679012, 1e-11);
    close_to(weft_cloth_stiffness(cloth, 0.0, y).omega2, 45.2345679012, 1e-11);
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- forces ---------------------------------------------------------------------- */

/* Grids down to chains and single cells. */
static const size_t sizes[][2] = { { 1, 2 }, { 1, 6 }, { 6, 1 }, { 2, 2 }, { 2, 5 },
                                   { 3, 3 }, { 4, 2 }, { 5, 7 }, { 8, 12 } };
enum { SIZES = sizeof sizes / sizeof sizes[0] };

static weft_cloth_def bent(size_t i)
{
    weft_cloth_def def = sheet(sizes[i][0], sizes[i][1], 0.1, 0.15);
    def.bending = (weft_bending_def){ { 0.02, 0.05 }, i % 2 ? -1.0 : 0.04, 0.003 };
    return def;
}

START_TEST(force_is_the_slope_of_the_energy)
{
    weft_cloth_def def = bent((size_t)_i);
    def.bending.damping = 0.0;
    weft_cloth *cloth = test_cloth(&def);
    const size_t n = weft_cloth_particles(cloth);
    double y[6 * MOST], f[3 * MOST];
    uint64_t seed = 5;
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 6 * n; ++j) {
        y[j] += 0.05 * noise(&seed);
    }
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t j = 0; j < 3 * n; ++j) { /* a quadratic energy: exact */
        const double kept = y[j], s = 0.1;
        y[j] = kept + s;
        const double high = weft_cloth_energy(cloth, 0.0, y).elastic[WEFT_BEND];
        y[j] = kept - s;
        const double low = weft_cloth_energy(cloth, 0.0, y).elastic[WEFT_BEND];
        y[j] = kept;
        ck_assert_msg(fabs((low - high) / (2.0 * s) - f[j]) < 1e-10, "%zu: %g, %g", j,
                      (low - high) / (2.0 * s), f[j]);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

/* Stretched, sheared, rotated, far away, and moving so: as any affine map. */
START_TEST(flat_cloth_feels_nothing)
{
    const weft_cloth_def def = bent((size_t)_i);
    weft_cloth *cloth = test_cloth(&def);
    const size_t n = weft_cloth_particles(cloth);
    double y[6 * MOST], f[3 * MOST];
    uint64_t seed = 9;
    weft_cloth_start(cloth, y);
    for (size_t k = 0; k < 6; ++k) {
        const double a = 3.0 * noise(&seed), s = noise(&seed), t = noise(&seed);
        for (size_t i = 0; i < n; ++i) {
            y[k * n + i] = a + s * (double)(i / def.cols) + t * (double)(i % def.cols);
        }
    }
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t j = 0; j < 3 * n; ++j) {
        ck_assert(fabs(f[j]) < 1e-11);
    }
    ck_assert(weft_cloth_energy(cloth, 0.0, y).elastic[WEFT_BEND] < 1e-24);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(momentum_and_heat)
{
    const weft_cloth_def def = bent((size_t)_i);
    weft_cloth *cloth = test_cloth(&def);
    const size_t n = weft_cloth_particles(cloth);
    double y[6 * MOST], f[3 * MOST], sums[3] = { 0.0 }, turn = 0.0, work = 0.0;
    uint64_t seed = 13;
    weft_cloth_start(cloth, y);
    for (size_t j = 0; j < 3 * n; ++j) {
        y[j] += 0.1 * noise(&seed);
        y[3 * n + j] = 0.0;
    }
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t i = 0; i < n; ++i) { /* without damping torque is 0 as well */
        turn += y[i] * f[n + i] - y[n + i] * f[i];
    }
    ck_assert(fabs(turn) < 1e-13 * (double)n);
    ck_assert(weft_cloth_dissipation(cloth, 0.0, y) == 0.0);
    for (size_t j = 0; j < 3 * n; ++j) {
        y[3 * n + j] = noise(&seed);
        work += f[j] * y[3 * n + j];
    }
    weft_cloth_force(cloth, 0.0, y, f);
    for (size_t j = 0; j < 3 * n; ++j) {
        sums[j / n] += f[j];
        work -= f[j] * y[3 * n + j];
    }
    for (size_t k = 0; k < 3; ++k) {
        ck_assert(fabs(sums[k]) < 1e-12 * (double)n);
    }
    const double heat = weft_cloth_dissipation(cloth, 0.0, y); /* v. tau K v */
    ck_assert(heat >= 0.0 && fabs(heat - work) <= 1e-12 * (heat + 1.0));
    weft_cloth_destroy(cloth);
}
END_TEST

/* ---- statics: Newton's method ---------------------------------------------------- */

/* a x = b for size unknowns, by elimination with pivots; a and b are overwritten. */
static void eliminate(size_t size, double *a, double *b)
{
    for (size_t p = 0; p < size; ++p) {
        size_t best = p;
        for (size_t r = p + 1; r < size; ++r) {
            best = fabs(a[r * size + p]) > fabs(a[best * size + p]) ? r : best;
        }
        for (size_t c = 0; c < size; ++c) {
            const double kept = a[p * size + c];
            a[p * size + c] = a[best * size + c];
            a[best * size + c] = kept;
        }
        const double kept = b[p];
        b[p] = b[best], b[best] = kept;
        for (size_t r = p + 1; r < size; ++r) {
            const double factor = a[r * size + p] / a[p * size + p];
            for (size_t c = p; factor != 0.0 && c < size; ++c) {
                a[r * size + c] -= factor * a[p * size + c];
            }
            b[r] -= factor * b[p];
        }
    }
    for (size_t r = size; r-- > 0;) {
        for (size_t c = r + 1; c < size; ++c) {
            b[r] -= a[r * size + c] * b[c];
        }
        b[r] /= a[r * size + r];
    }
}

/* M^-1 K + shift I of the free coordinates among planes [first, end) in state y; writes
 * their indices to where[]. Returns their number. */
static size_t dense(const weft_cloth *cloth, const double *y, size_t first, size_t end,
                    double shift, double *a, size_t *where)
{
    const size_t n = weft_cloth_particles(cloth);
    static double dy[6 * MOST], out[6 * MOST];
    size_t size = 0;
    for (size_t j = first * n; j < end * n; ++j) {
        if (!weft_cloth_pinned(cloth, j % n)) {
            where[size++] = j;
        }
    }
    memset(dy, 0, sizeof dy);
    for (size_t c = 0; c < size; ++c) {
        dy[where[c]] = 1.0;
        ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, out), 0);
        dy[where[c]] = 0.0;
        for (size_t r = 0; r < size; ++r) {
            a[r * size + c] = -out[3 * n + where[r]] + (r == c ? shift : 0.0);
        }
    }
    return size;
}

/* From y, in the plane of x and y. */
static void settle(const weft_cloth *cloth, double *y)
{
    static double a[4 * MOST * MOST], b[2 * MOST], dydt[6 * MOST];
    size_t where[2 * MOST];
    const size_t n = weft_cloth_particles(cloth);
    double most = 1.0;
    for (int k = 0; k < 50 && most > 1e-14; ++k) {
        const size_t size = dense(cloth, y, 0, 2, 0.0, a, where);
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
        for (size_t r = 0; r < size; ++r) {
            b[r] = dydt[3 * n + where[r]];
        }
        eliminate(size, a, b);
        most = 0.0;
        for (size_t r = 0; r < size; ++r) {
            y[where[r]] += b[r];
            most = fmax(most, fabs(b[r]));
        }
    }
    ck_assert_msg(most < 1e-11, "does not settle: %g m", most);
}

/* A chain along x whose first two particles are pinned; half way between them begins
 * the overhang of 0.1 m. */
static weft_cloth_def cantilever(size_t n, double rigidity, double stretch)
{
    weft_cloth_def def = weft_cloth_def_default();
    const double spacing = 0.1 / ((double)n - 1.5);
    def.rows = 1, def.cols = n;
    def.spacing[1] = spacing;
    def.origin[0] = -0.5 * spacing;
    def.springs[WEFT_STRETCH].present = true;
    def.springs[WEFT_STRETCH].stiffness = stretch / spacing; /* 1 m wide */
    def.bending.rigidity[1] = rigidity;
    def.pins = clamp, def.pin_count = 1;
    return def;
}

static void tip_of(const weft_cloth_def *def, const double *y, double tip[2])
{
    tip[0] = y[def->cols - 1];
    tip[1] = y[(def->rows + 1) * def->cols - 1];
}

/* Under gravity that grows; writes where it is, y[6 MOST], and its tip, from the clamp
 * [m]. */
static void hang_in(weft_cloth_def def, double *y, double tip[2])
{
    enum { LOADS = 24 };
    for (int k = 1; k <= LOADS; ++k) {
        const double part = (double)k / LOADS;
        def.gravity[1] = -9.81 * part * part * part;
        weft_cloth *cloth = test_cloth(&def);
        if (k == 1) {
            weft_cloth_start(cloth, y);
        }
        settle(cloth, y);
        weft_cloth_destroy(cloth);
    }
    tip_of(&def, y, tip);
}

static void hang(weft_cloth_def def, double tip[2])
{
    static double y[6 * MOST];
    hang_in(def, y, tip);
}

/* Tips of an overhang of 0.1 m by an independent solver. */
static const struct {
    double rigidity;
    size_t n;
    double tip[2];
} tips[] = {
    { 2.4525e-4, 9, { .0722899384, -.0637931402 } },
    { 2.4525e-4, 17, { .0724026965, -.0640078674 } },
    { 3.065625e-5, 9, { .0202694316, -.0908031288 } },
    { 3.065625e-5, 17, { .0206620624, -.0918387888 } },
};
enum { TIPS = sizeof tips / sizeof tips[0] };

static void hangs_at(weft_cloth_def def, const double wanted[2])
{
    double tip[2];
    hang(def, tip);
    ck_assert_msg(fabs(tip[0] - wanted[0]) < 1e-9 && fabs(tip[1] - wanted[1]) < 1e-9,
                  "%.10f, %.10f", tip[0], tip[1]);
}

START_TEST(chain_hangs_where_another_solver_has_it)
{
    hangs_at(cantilever(tips[_i].n, tips[_i].rigidity, 1000.0), tips[_i].tip);
}
END_TEST

/* Three rows, side by side along z, of a fabric without shear. */
START_TEST(strip_hangs_as_the_chain)
{
    static const weft_pin ends[] = { { .rows = { 0, -1 }, .cols = { 0, 1 } } };
    const weft_fabric fabric = { .density = 0.2,
                                 .stretch = { 500.0, 1000.0 },
                                 .bend = { 0.0, tips[_i].rigidity } };
    weft_cloth_def def = cantilever(tips[_i].n, 0.0, 1.0);
    def.rows = 3;
    def.spacing[0] = 0.03;
    def.down[1] = 0.0, def.down[2] = 1.0;
    def.pins = ends;
    ck_assert_int_eq(weft_fabric_apply(&fabric, &def, NULL), WEFT_OK);
    hangs_at(def, tips[_i].tip);
}
END_TEST

/* The overhang l by Peirce's length c = (B / (density g))^(1/3), and the tip by l of
 * the heavy elastica that is not stretched: of order 2 in the spacing. */
START_TEST(cantilever_converges_to_the_heavy_elastica)
{
    static const double elastica[][3] = {
        { 1.0, .9912463953, -.1234714020 }, { 2.0, .7244247341, -.6406307174 },
        { 3.0, .3672894251, -.8635516468 }, { 4.0, .2092013380, -.9201128447 },
        { 8.0, .0650775960, -.9734425775 },
    };
    const double *wanted = elastica[_i], c = 0.1 / wanted[0];
    const double rigidity = 0.2 * 9.81 * c * c * c;
    double error[3];
    for (size_t k = 0; k < 3; ++k) {
        double tip[2];
        hang(cantilever((size_t)8 * ((size_t)1 << k) + 1, rigidity, 1e6), tip);
        error[k] = 10.0 * hypot(tip[0] - 0.1 * wanted[1], tip[1] - 0.1 * wanted[2]);
    }
    ck_assert_msg(log2(error[0] / error[1]) > 1.9 && log2(error[1] / error[2]) > 1.9,
                  "%g %g %g", error[0], error[1], error[2]);
    ck_assert_msg(error[0] < 0.05, "%g", error[0]);
}
END_TEST

/* Provot's springs, fitted on the second grid, from where the rigid chain hangs. */
START_TEST(bend_springs_soften_as_the_grid_is_refined)
{
    static const double depths[] = { .793, .920, .967 };
    static double y[6 * MOST];
    for (size_t k = 0; k < sizeof depths / sizeof depths[0]; ++k) {
        double tip[2];
        weft_cloth_def def
            = cantilever((size_t)8 * ((size_t)1 << k) + 1, 3.065625e-5, 1000.0);
        hang_in(def, y, tip);
        def.gravity[1] = -9.81;
        def.bending.rigidity[1] = 0.0;
        def.springs[WEFT_BEND].present = true;
        def.springs[WEFT_BEND].stiffness = 2942.0;
        weft_cloth *cloth = test_cloth(&def);
        settle(cloth, y);
        tip_of(&def, y, tip);
        ck_assert_msg(fabs(tip[1] + 0.1 * depths[k]) < 6e-5, "%g", tip[1]);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

START_TEST(hanging_chain_is_as_long_with_any_rigidity)
{
    for (double rigidity = 0.0; rigidity < 1.0; rigidity += 0.3) {
        weft_cloth_def def = weft_cloth_def_default();
        const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, 0 } };
        double y[6 * 11];
        def.rows = 11, def.cols = 1;
        def.spacing[0] = 0.1;
        def.springs[WEFT_STRETCH].present = true;
        def.springs[WEFT_STRETCH].stiffness = 1000.0;
        def.bending.rigidity[0] = rigidity;
        def.pins = &top, def.pin_count = 1;
        weft_cloth *cloth = test_cloth(&def);
        weft_cloth_start(cloth, y);
        y[11 + 10] -= 1e-3;
        if (rigidity > 0.0) { /* a mechanism without */
            settle(cloth, y);
            close_to(-y[11 + 10] - 1.0, 0.2 * 9.81 / (2.0 * 100.0), 1e-9);
        }
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* ---- frequencies ----------------------------------------------------------------- */

/* [1/s^2] The eigenvalue of M^-1 K nearest to -shift, in plane y, by inverse iteration
 * from x[n], which becomes the mode. */
static double softest(const weft_cloth *cloth, double shift, double *x)
{
    static double a[MOST * MOST], copy[MOST * MOST], b[MOST], y[6 * MOST];
    size_t where[MOST];
    const size_t n = weft_cloth_particles(cloth);
    weft_cloth_start(cloth, y);
    const size_t size = dense(cloth, y, 1, 2, shift, a, where);
    double value = 0.0;
    for (int k = 0; k < 20; ++k) {
        double before = 0.0, both = 0.0;
        memcpy(copy, a, size * size * sizeof *a);
        for (size_t r = 0; r < size; ++r) {
            b[r] = x[where[r] - n];
        }
        eliminate(size, copy, b);
        for (size_t r = 0; r < size; ++r) {
            const double m = weft_cloth_particle_mass(cloth, where[r] - n);
            before += m * x[where[r] - n] * b[r];
            both += m * b[r] * b[r];
        }
        value = before / both - shift;
        for (size_t r = 0; r < size; ++r) {
            x[where[r] - n] = b[r] / sqrt(both);
        }
    }
    return value;
}

START_TEST(cantilever_swings_at_its_frequency)
{
    static const double known[][2]
        = { { 9, 2.4791014328 }, { 17, 2.4845577678 }, { 33, 2.4858022284 } };
    for (size_t k = 0; k < 3; ++k) {
        const size_t n = (size_t)known[k][0];
        weft_cloth_def def = cantilever(n, 1e-5, 1000.0);
        double x[MOST];
        for (size_t i = 0; i < n; ++i) {
            x[i] = (double)(i * i);
        }
        def.gravity[1] = 0.0;
        weft_cloth *cloth = test_cloth(&def);
        close_to(sqrt(softest(cloth, 0.0, x)), known[k][1], 1e-9);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* The rate is damping omega^2 / 2: in the mode, damping matches stiffness exactly. */
START_TEST(damped_cantilever_decays_at_its_rate)
{
    enum { N = 17 };
    weft_cloth_def def = cantilever(N, 1e-5, 1000.0);
    double x[MOST], y[6 * N], dy[6 * N] = { 0.0 }, out[6 * N];
    def.gravity[1] = 0.0;
    def.bending.damping = 0.01;
    for (size_t i = 0; i < N; ++i) {
        x[i] = (double)(i * i);
    }
    weft_cloth *cloth = test_cloth(&def);
    (void)softest(cloth, 0.0, x);
    weft_cloth_start(cloth, y);
    for (size_t i = 2; i < N; ++i) {
        dy[4 * N + i] = x[i];
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, dy, out), 0);
    for (size_t i = 2; i < N; ++i) {
        close_to(-0.5 * out[4 * N + i] / x[i], 0.0308651365, 1e-8);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

/* A square of 1 m, B = 1 N m in all directions, 1 kg/m^2: omega^2 of the saddle by
 * Ritz's method with 49 products of Legendre's polynomials is 250.3557. */
START_TEST(free_plate_swings_at_its_frequency)
{
    double error[2];
    for (size_t k = 0; k < 2; ++k) {
        const size_t n = 8 * (k + 1) + 1;
        const double a = 1.0 / (double)(n - 1);
        weft_cloth_def def = sheet(n, n, a, a);
        double x[MOST];
        def.density = 1.0;
        def.bending = (weft_bending_def){ { 1.0, 1.0 }, -1.0, 0.0 };
        for (size_t i = 0; i < n * n; ++i) {
            x[i] = ((double)(i / n) * a - 0.5) * ((double)(i % n) * a - 0.5);
        }
        weft_cloth *cloth = test_cloth(&def);
        error[k] = fabs(softest(cloth, 1000.0, x) / 250.3557 - 1.0);
        weft_cloth_destroy(cloth);
    }
    ck_assert_msg(error[1] < 0.02 && log2(error[0] / error[1]) > 1.9, "%g %g", error[0],
                  error[1]);
}
END_TEST

/* ---- definitions ----------------------------------------------------------------- */

static void refused(const weft_cloth_def *def, const char *said)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    ck_assert_int_eq(weft_cloth_create(def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, said) != NULL, "%s", err.message);
}

START_TEST(definitions_that_make_no_sense_are_refused)
{
    weft_cloth_def def = oblong();
    def.springs[WEFT_BEND].present = true;
    refused(&def, "bending rigidity excludes bend springs");
    def = oblong();
    def.bending.rigidity[1] = -1e-5;
    refused(&def, "bending: rigidity 2e-05, -1e-05 N m: must be >= 0");
    def = oblong();
    def.bending.damping = -1.0;
    refused(&def, "bending: damping -1 s: must be >= 0");
    def.bending.damping = (double)NAN;
    refused(&def, "bending: damping");
    def = oblong();
    def.bending.twist = (double)INFINITY;
    refused(&def, "bending: twist");
    def = oblong();
    def.bending.rigidity[0] = 1e307;
    refused(&def, "bending rigidities are too large");
    def = oblong();
    def.bending.damping = 1e308;
    def.bending.rigidity[0] = 1e10;
    refused(&def, "bending rigidities are too large");
}
END_TEST

/* Bend springs are allowed beside moduli of 0, a negative twist is the default. */
START_TEST(twist_has_a_default)
{
    weft_cloth_def def = oblong();
    def.bending.twist = -1.0;
    weft_cloth *cloth = test_cloth(&def);
    const double found = entry(cloth, 15, 23); /* twist alone: 2 twist / (a b) */
    close_to(found, 2.0 * sqrt(2e-5 * 5e-5) / (0.1 * 0.15), 1e-12);
    weft_cloth_destroy(cloth);
    def = sheet(3, 3, 0.1, 0.1);
    def.springs[WEFT_BEND].present = true;
    ck_assert(def.bending.twist < 0.0);
    weft_cloth_destroy(test_cloth(&def));
}
END_TEST

/* ---- runs ------------------------------------------------------------------------ */

/* Stretched, sheared and bent, with two pins, one of which moves. */
static weft_cloth *flag(double damping, double spring_damping)
{
    static const weft_pin pins[] = { { .rows = { 0, 0 }, .cols = { 0, 0 } },
                                     { .rows = { 0, 0 },
                                       .cols = { -1, -1 },
                                       .velocity = { 0.1, 0.0, 0.2 },
                                       .amplitude = { 0.0, 0.02, 0.0 },
                                       .frequency = 2.0 } };
    weft_cloth_def def = sheet(8, 9, 0.1, 0.1);
    for (size_t f = WEFT_STRETCH; f <= WEFT_SHEAR; ++f) {
        def.springs[f].present = true;
        def.springs[f].stiffness = 50.0;
        def.springs[f].damping = spring_damping;
    }
    def.gravity[1] = -9.81;
    def.bending = (weft_bending_def){ { 0.02, 0.01 }, -1.0, damping };
    def.pins = pins, def.pin_count = 2;
    return test_cloth(&def);
}

static weft_sim *fly(const weft_cloth *cloth, const char *method, double tolerance,
                     double step, bool ledger)
{
    weft_sim_def def = weft_sim_def_default();
    weft_error err = { 0 };
    weft_sim *sim = NULL;
    def.cloth = cloth;
    def.method = test_method_named(method);
    def.config.fixed_step = step;
    if (tolerance > 0.0) {
        def.config.rtol = def.config.atol_position = def.config.atol_velocity
            = tolerance;
    }
    def.config = test_config(def.method, def.config);
    def.ledger = ledger;
    ck_assert_msg(weft_sim_create(&def, &sim, &err) == WEFT_OK, "%s", err.message);
    return sim;
}

/* Methods that use the structure end where Verlet's does; rkc2 needs strong damping. */
START_TEST(implicit_methods_bend_the_same_way)
{
    static const char *const methods[] = {
        "stiff/ros2",
        "stiff/rkc2",
#ifdef HAVE_CVODE
        "cvode/bdf",
#endif
    };
    weft_cloth *cloth = flag(0.02, 2.0);
    const size_t dim = weft_cloth_dim(cloth);
    weft_sim *exact = fly(cloth, "verlet/velocity_verlet", 0.0, 2e-5, false);
    ck_assert_int_eq(weft_sim_advance(exact, 0.2, NULL), WEFT_OK);
    for (size_t k = 0; k < sizeof methods / sizeof methods[0]; ++k) {
        weft_sim *sim = fly(cloth, methods[k], 1e-5, 0.0, false);
        double apart = 0.0;
        ck_assert_int_eq(weft_sim_advance(sim, 0.2, NULL), WEFT_OK);
        for (size_t j = 0; j < dim / 2; ++j) {
            apart
                = fmax(apart, fabs(weft_sim_state(sim)[j] - weft_sim_state(exact)[j]));
        }
        ck_assert_msg(apart < 5e-4, "%s: %g m", methods[k], apart);
        weft_sim_destroy(sim);
    }
    weft_sim_destroy(exact);
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(bending)
{
    Suite *suite = suite_create("bending");
    TCase *tcase = tcase_create("bending");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, energy_of_a_quadratic_surface_is_exact);
    tcase_add_test(tcase, energy_of_a_cylinder);
    tcase_add_test(tcase, matrix_has_its_entries);
    tcase_add_test(tcase, largest_eigenvalue_and_its_bound);
    tcase_add_loop_test(tcase, force_is_the_slope_of_the_energy, 0, SIZES);
    tcase_add_loop_test(tcase, flat_cloth_feels_nothing, 0, SIZES);
    tcase_add_loop_test(tcase, momentum_and_heat, 0, SIZES);
    tcase_add_loop_test(tcase, chain_hangs_where_another_solver_has_it, 0, TIPS);
    tcase_add_loop_test(tcase, strip_hangs_as_the_chain, 0, TIPS);
    tcase_add_loop_test(tcase, cantilever_converges_to_the_heavy_elastica, 0, 5);
    tcase_add_test(tcase, bend_springs_soften_as_the_grid_is_refined);
    tcase_add_test(tcase, hanging_chain_is_as_long_with_any_rigidity);
    tcase_add_test(tcase, cantilever_swings_at_its_frequency);
    tcase_add_test(tcase, damped_cantilever_decays_at_its_rate);
    tcase_add_test(tcase, free_plate_swings_at_its_frequency);
    tcase_add_test(tcase, definitions_that_make_no_sense_are_refused);
    tcase_add_test(tcase, twist_has_a_default);
    tcase_add_test(tcase, implicit_methods_bend_the_same_way);
    suite_add_tcase(suite, tcase);
    return suite;
}
