/* SPDX-License-Identifier: BSD-3-Clause */
/* test_forces.c -- every term of the force against a formula or an energy written out
 * here once more: springs are found among all pairs of particles, areas by neighbours
 * counted. Grids have rows != cols, two spacings, tilted axes and random states. */
#include "support.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define MOST         36 /* particles */

static const size_t grids[][2] = { { 2, 5 }, { 4, 3 }, { 5, 7 }, { 3, 3 },
                                   { 1, 6 }, { 6, 1 }, { 2, 1 }, { 1, 2 } };

typedef struct spring {
    weft_family family;
    size_t p, q;
    double s, k, c; /* [m], [N/m], [kg/s] */
} spring;

/* The one under test; the cloth of an earlier one is let go by make(). */
static struct {
    weft_cloth_def def;
    weft_pin pin; /* the only one, if any */
    weft_cloth *cloth;
    size_t n, springs;
    spring spring[7 * MOST];
    double m[MOST], y[6 * MOST], f[3 * MOST];
} m;

/* -1 to 1, the same everywhere */
static double noise(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

static void set(double *to, double x, double y, double z)
{
    to[0] = x;
    to[1] = y;
    to[2] = z;
}

/* Both in the same outer row or column of a sheet whose rim carries half. */
static bool along_rim(size_t p, size_t q)
{
    const size_t rows = m.def.rows, cols = m.def.cols;
    const size_t row = p / cols, col = p % cols;
    return m.def.rim_half && rows > 1 && cols > 1
           && ((row == q / cols && (row == 0 || row + 1 == rows))
               || (col == q % cols && (col == 0 || col + 1 == cols)));
}

static void list_springs(void)
{
    m.springs = 0;
    for (size_t p = 0; p < m.n; ++p) {
        for (size_t q = p + 1; q < m.n; ++q) {
            const size_t a = p % m.def.cols, b = q % m.def.cols;
            const size_t down = q / m.def.cols - p / m.def.cols;
            const size_t right = a > b ? a - b : b - a;
            const weft_family family = down == 1 && right == 1 ? WEFT_SHEAR
                                       : down + right == 1     ? WEFT_STRETCH
                                                               : WEFT_BEND;
            const weft_spring_def *def = down == 0 && m.def.across[family].present
                                             ? &m.def.across[family]
                                             : &m.def.springs[family];
            if (m.def.springs[family].present && down * right <= 1
                && down + right <= 2) {
                const double s = hypot((double)down * m.def.spacing[0],
                                       (double)right * m.def.spacing[1]);
                const double share = along_rim(p, q) ? 0.5 : 1.0;
                const double k
                    = share * def->stiffness / (m.def.law == WEFT_LAW_HOOKE ? 1 : s);
                const double c = share * def->damping;
                m.spring[m.springs++] = (spring){ family, p, q, s, k, c };
            }
        }
    }
}

/* The cloth of m.def, strained and moving at random. */
static void make(uint64_t seed)
{
    weft_cloth_destroy(m.cloth);
    m.cloth = test_cloth(&m.def);
    m.n = m.def.rows * m.def.cols;
    list_springs();
    weft_cloth_start(m.cloth, m.y);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        m.y[j] += (j < 3 * m.n ? 0.12 : 1.0) * noise(&seed);
    }
    for (size_t i = 0; i < m.n; ++i) {
        m.m[i] = weft_cloth_particle_mass(m.cloth, i);
    }
}

enum { ELASTIC, DAMPED };

/* Bits of families: 1 stretch, 2 shear, 4 bend. Springs, nothing else. */
static void define(const size_t size[2], unsigned families, int law, int damped)
{
    m.def = weft_cloth_def_default();
    m.def.rows = size[0], m.def.cols = size[1], m.def.law = (weft_law)law;
    m.def.spacing[0] = 0.7, m.def.spacing[1] = 0.4, m.def.pins = &m.pin;
    set(m.def.right, 2.0, 0.0, 1.0);
    set(m.def.down, 1.0, -3.0, -2.0);
    set(m.def.gravity, 0.0, 0.0, 0.0);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        m.def.springs[f].present = (families >> f & 1u) != 0;
        m.def.springs[f].stiffness = (double[]){ 120.0, 45.0, 9.0 }[f];
        m.def.springs[f].damping = (double[]){ 0.7, 1.1, 0.3 }[f] * damped;
        m.def.across[f].present = f != WEFT_SHEAR && size[1] % 2 == 1;
        m.def.across[f].stiffness = 70.0 - 30.0 * (double)f;
        m.def.across[f].damping = 0.4 * damped;
    }
    m.def.rim_half = size[0] % 2 == 1 || size[0] == 4;
}

/* d = x_q - x_p of three planes; returns |d|. */
static double apart(const double *x, const spring *s, double d[3])
{
    for (size_t k = 0; k < 3; ++k) {
        d[k] = x[k * m.n + s->q] - x[k * m.n + s->p];
    }
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static double strain(const spring *s)
{
    double d[3];
    return apart(m.y, s, d) / s->s - 1.0;
}

static double elastic(int family)
{
    double sum = 0.0, d[3];
    for (const spring *s = m.spring; s < m.spring + m.springs; ++s) {
        const double stretch = apart(m.y, s, d) - s->s;
        sum += s->family == (weft_family)family ? 0.5 * s->k * stretch * stretch : 0.0;
    }
    return sum;
}

/* -m g.x of the first particles */
static double weight(size_t particles)
{
    double sum = 0.0;
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const double mg = m.m[j % m.n] * m.def.gravity[j / m.n];
        sum -= j % m.n < particles ? mg * m.y[j] : 0.0;
    }
    return sum;
}

/* Into m.f; returns the largest component. */
static double force(void)
{
    double largest = 0.0;
    weft_cloth_force(m.cloth, 0.0, m.y, m.f);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        largest = fmax(largest, fabs(m.f[j]));
    }
    return largest;
}

static void same(const double *a, const double *b, size_t count, double tolerance)
{
    for (size_t j = 0; j < count; ++j) {
        ck_assert_msg(fabs(a[j] - b[j]) <= tolerance, "%zu: %g %g", j, a[j], b[j]);
    }
}

static void near(double a, double b, double tolerance)
{
    same(&a, &b, 1, tolerance);
}

/* sum += a cross b of all particles */
static void add_cross(const double *a, const double *b, double sum[3])
{
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const size_t i = j % m.n, k = j / m.n;
        const size_t u = (k + 1) % 3 * m.n + i, v = (k + 2) % 3 * m.n + i;
        sum[k] += a[u] * b[v] - a[v] * b[u];
    }
}

/* Five points, 1 mm apart: the error is h^4 E^(5) / 30 ~ 1e-12 k (1 m / L)^3, and that
 * of the roundoff 1e-16 E / h ~ 1e-12. */
START_TEST(force_is_minus_the_gradient_of_the_energy)
{
    for (size_t g = 0; g < 8 * COUNT(grids); ++g) {
        define(grids[g / 8], g % 8, _i, ELASTIC); /* each family alone, too */
        set(m.def.gravity, 0.3, -9.81, 2.0);
        make(g);
        const double tolerance = 1e-9 * force(), h = 1e-3;
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const double x = m.y[j];
            double e[5];
            for (int k = 0; k < 5; ++k) {
                m.y[j] = x + (k - 2) * h;
                e[k] = weight(m.n) + elastic(0) + elastic(1) + elastic(2);
            }
            m.y[j] = x;
            near(m.f[j], -(e[0] - 8 * e[1] + 8 * e[3] - e[4]) / (12 * h), tolerance);
        }
    }
}
END_TEST

START_TEST(measures_are_sums_over_free_particles_and_all_springs)
{
    for (size_t g = 0; g < COUNT(grids); ++g) {
        double kinetic = 0.0, mv[3 * MOST], sum[3] = { 0 }, moment[3] = { 0 }, p[3],
               l[3];
        define(grids[g], 7, _i, ELASTIC);
        set(m.def.gravity, 0.3, -9.81, 2.0);
        m.pin = (weft_pin){ .rows = { -1, -1 }, .cols = { -1, -1 } };
        m.def.pin_count = 1;
        make(g);
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const double v = m.y[3 * m.n + j];
            mv[j] = j % m.n == m.n - 1 ? 0.0 : m.m[j % m.n] * v;
            sum[j / m.n] += mv[j];
            kinetic += 0.5 * mv[j] * v;
        }
        add_cross(m.y, mv, moment);
        weft_cloth_momentum(m.cloth, m.y, p);
        weft_cloth_angular_momentum(m.cloth, m.y, l);
        same(p, sum, 3, 1e-14);
        same(l, moment, 3, 1e-13);
        const weft_energy energy = weft_cloth_energy(m.cloth, 0.0, m.y);
        near(energy.kinetic, kinetic, 1e-13 * kinetic);
        near(energy.gravitational, weight(m.n - 1), 1e-12);
        for (int f = 0; f < WEFT_FAMILIES; ++f) {
            near(energy.elastic[f], elastic(f), 1e-13 * elastic(f));
        }
    }
}
END_TEST

/* k [N] = k [N/m] s. In a square grid all springs of a family have one s. */
START_TEST(strain_law_is_hookes_with_k_over_s)
{
    for (size_t family = 0; family < WEFT_FAMILIES; ++family) {
        const double s = 0.3 * (double[]){ 1.0, sqrt(2.0), 2.0 }[family];
        double hooke[3 * MOST];
        for (int law = WEFT_LAW_HOOKE; law <= WEFT_LAW_STRAIN; ++law) {
            memcpy(hooke, m.f, sizeof hooke);
            define(grids[2], 1u << family, law, ELASTIC);
            m.def.spacing[0] = m.def.spacing[1] = 0.3;
            m.def.springs[family].stiffness = 40.0 * (law == WEFT_LAW_STRAIN ? s : 1.0);
            m.def.across[family].stiffness = m.def.springs[family].stiffness;
            m.def.springs[family].damping = 0.2; /* the same in both */
            make(5);
            ck_assert_double_gt(force(), 1.0);
        }
        same(m.f, hooke, 3 * m.n, 1e-14 * force());
    }
}
END_TEST

/* f_p += c (w.u) u for each spring; returns the heat, the sum of c (w.u)^2. */
static double add_dampers(double *f)
{
    double heat = 0.0;
    for (const spring *s = m.spring; s < m.spring + m.springs; ++s) {
        double d[3], w[3];
        const double length = apart(m.y, s, d);
        (void)apart(m.y + 3 * m.n, s, w);
        const double rate = (w[0] * d[0] + w[1] * d[1] + w[2] * d[2]) / length;
        for (size_t k = 0; k < 3; ++k) {
            f[k * m.n + s->p] += s->c * rate * d[k] / length;
            f[k * m.n + s->q] -= s->c * rate * d[k] / length;
        }
        heat += s->c * rate * rate;
    }
    return heat;
}

START_TEST(dampers_follow_their_formula_and_take_power)
{
    for (size_t g = 0; g < COUNT(grids); ++g) {
        double f[3 * MOST], power = 0.0;
        define(grids[g], 7, _i, ELASTIC);
        make(g);
        (void)force();
        memcpy(f, m.f, sizeof f);
        define(grids[g], 7, _i, DAMPED);
        make(g); /* in the same state */
        const double largest = force();
        for (size_t j = 0; j < 3 * m.n; ++j) {
            power += (m.f[j] - f[j]) * m.y[3 * m.n + j];
        }
        double heat = add_dampers(f);
        same(m.f, f, 3 * m.n, 1e-13 * largest);
        ck_assert_double_lt(power, 0.0);
        near(weft_cloth_dissipation(m.cloth, 0.0, m.y), heat, 1e-13 * heat);
        m.def.damping = 0.6; /* counts too, but not that of the pinned */
        m.pin = (weft_pin){ .rows = { 0, 0 }, .cols = { -1, -1 } };
        m.def.pin_count = 1;
        make(g);
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const double v = m.y[3 * m.n + j];
            heat += j % m.n == m.def.cols - 1 ? 0.0 : 0.6 * v * v;
        }
        near(weft_cloth_dissipation(m.cloth, 0.0, m.y), heat, 1e-13 * heat);
    }
}
END_TEST

/* v = V + W cross x. A damper that takes positions for velocities shows here. */
START_TEST(rigid_motion_feels_no_damper)
{
    const double w[3] = { 1.5, -0.5, 2.0 };
    double undamped[3 * MOST];
    for (int damped = ELASTIC; damped <= DAMPED; ++damped) {
        memcpy(undamped, m.f, sizeof undamped);
        define(grids[2], 7, WEFT_LAW_HOOKE, damped);
        make(3);
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const size_t k = j / m.n, i = j % m.n, a = (k + 1) % 3, b = (k + 2) % 3;
            m.y[3 * m.n + j] = 3.0 + w[a] * m.y[b * m.n + i] - w[b] * m.y[a * m.n + i];
        }
        ck_assert_double_gt(force(), 1.0);
    }
    same(m.f, undamped, 3 * m.n, 1e-13 * force());
    near(weft_cloth_dissipation(m.cloth, 0.0, m.y), 0.0, 1e-26);
}
END_TEST

START_TEST(springs_and_dampers_give_no_force_and_no_torque_in_all)
{
    for (size_t g = 0; g < COUNT(grids); ++g) {
        double sum[3] = { 0 }, torque[3] = { 0 };
        define(grids[g], 7, _i, DAMPED);
        make(g);
        const double largest = force();
        for (size_t j = 0; j < 3 * m.n; ++j) {
            sum[j / m.n] += m.f[j];
        }
        add_cross(m.y, m.f, torque);
        same(sum, (double[3]){ 0 }, 3, 1e-14 * largest * (double)m.n);
        same(torque, (double[3]){ 0 }, 3, 1e-13 * largest * (double)m.n);
    }
}
END_TEST

static void wind_on(size_t i, double f[3])
{
    const size_t cols = m.def.cols;
    const bool left = i % cols > 0, right = i % cols + 1 < cols;
    const bool up = i >= cols, low = i + cols < m.n;
    const double area = 0.7 * 0.4 * (left + right) * (up + low) / 4.0;
    double a[3], b[3], n[3], flow = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double *x = m.y + k * m.n;
        a[k] = x[i + right] - x[i - left];
        b[k] = x[low ? i + cols : i] - x[up ? i - cols : i];
    }
    for (size_t k = 0; k < 3; ++k) {
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        flow += n[k] * (m.def.wind_velocity[k] - m.y[(k + 3) * m.n + i]);
    }
    const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    for (size_t k = 0; k < 3; ++k) {
        f[k] = square > 0.0 ? m.def.wind_drag * area * flow * n[k] / square : 0.0;
    }
}

START_TEST(wind_pushes_along_the_normal_and_drag_against_the_velocity)
{
    for (size_t g = 0; g < COUNT(grids); ++g) {
        const bool chain = grids[g][0] == 1 || grids[g][1] == 1;
        define(grids[g], 0, _i, ELASTIC);
        set(m.def.wind_velocity, 1.0, -2.0, 3.0);
        m.def.wind_drag = 0.8;
        m.def.damping = chain ? 0.0 : 0.25;
        m.pin = (weft_pin){ .rows = { 0, 0 } };
        m.def.pin_count = 1; /* makes no odds */
        make(g);
        const double largest = force();
        ck_assert((largest > 0.0) != chain); /* which feels no wind */
        for (size_t j = 0; j < 3 * m.n; ++j) {
            double wind[3];
            wind_on(j % m.n, wind);
            wind[j / m.n] -= m.def.damping * m.y[3 * m.n + j];
            near(m.f[j], wind[j / m.n], 1e-14 * largest);
        }
    }
}
END_TEST

/* Blowing at 4 m/s at a sheet of 2.4 m x 2.8 m that moves away at 1 m/s. */
START_TEST(wind_on_a_flat_sheet_is_drag_times_area_times_speed)
{
    double sum[3] = { 0 };
    define(grids[2], 0, WEFT_LAW_HOOKE, ELASTIC);
    set(m.def.right, 1.0, 0.0, 0.0);
    set(m.def.down, 0.0, -1.0, 0.0);
    set(m.def.wind_velocity, 5.0, -7.0, 4.0);
    set(m.def.velocity, 0.0, 2.0, 1.0);
    m.def.wind_drag = 0.5;
    make(0);
    weft_cloth_start(m.cloth, m.y);
    (void)force();
    for (size_t j = 0; j < 3 * m.n; ++j) {
        sum[j / m.n] += m.f[j];
    }
    same(sum, (double[]){ 0.0, 0.0, 0.5 * 2.4 * 2.8 * 3.0 }, 3, 1e-13);
    for (size_t i = 0; i < m.n; ++i) { /* all on one line: no normal */
        m.y[i] = 0.1 * (double)(i % 7), m.y[m.n + i] = 0.0;
    }
    ck_assert_double_eq(force(), 0.0);
}
END_TEST

START_TEST(rhs_is_velocity_and_force_over_mass_but_for_pins)
{
    const double t = 0.3, w = 3.0 * acos(-1.0);
    double expected[6 * MOST], dydt[6 * MOST];
    define(grids[2], 7, WEFT_LAW_HOOKE, DAMPED);
    set(m.def.gravity, 0.5, -9.81, 2.0);
    m.def.damping = 0.1;
    m.def.wind_drag = 0.3;
    m.pin = (weft_pin){ .rows = { 0, 0 },
                        .cols = { 0, 2 },
                        .velocity = { 0.5, 0, -1 },
                        .amplitude = { 0, 2, 3 },
                        .frequency = 1.5 };
    m.def.pin_count = 1;
    make(9);
    (void)force();
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, t, m.y, dydt), 0);
    for (size_t j = 0; j < 3 * m.n; ++j) {
        const size_t k = j / m.n, i = j % m.n;
        const double a = m.pin.amplitude[k], v = m.pin.velocity[k];
        expected[j] = i < 3 ? v + w * a * cos(w * t) : m.y[3 * m.n + j];
        expected[3 * m.n + j] = i < 3 ? -w * w * a * sin(w * t) : m.f[j] / m.m[i];
    }
    same(dydt, expected, 6 * m.n, 1e-12);
}
END_TEST

START_TEST(spring_of_no_length_pulls_nothing)
{
    double dydt[12];
    define(grids[7], 7, _i, DAMPED);
    make(2);
    m.y[0] = m.y[1], m.y[2] = m.y[3], m.y[4] = m.y[5]; /* but they move apart */
    ck_assert_double_eq(force(), 0.0);
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, dydt), 0);
    ck_assert_double_eq(weft_cloth_dissipation(m.cloth, 0.0, m.y), 0.0);
}
END_TEST

START_TEST(rhs_refuses_whatever_is_not_finite)
{
    const double bad[] = { (double)NAN, (double)INFINITY, -(double)INFINITY, 1e300 };
    double dydt[6 * MOST];
    define(grids[1], 7, WEFT_LAW_HOOKE, DAMPED);
    make(4);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        for (size_t b = 0; b < COUNT(bad); ++b) {
            const double kept = m.y[j];
            m.y[j] = bad[b]; /* 1e300 m squared is infinite, 1e300 m/s can be used */
            ck_assert(weft_cloth_rhs(m.cloth, 0, m.y, dydt) == (j < 3 * m.n || b < 3));
            m.y[j] = kept;
        }
    }
}
END_TEST

START_TEST(worst_spring_is_the_most_strained_or_not_a_number)
{
    for (size_t g = 0; g < COUNT(grids); ++g) {
        define(grids[g], 7, _i, ELASTIC);
        make(g);
        const spring *worst = m.spring;
        for (const spring *s = m.spring; s < m.spring + m.springs; ++s) {
            worst = strain(s) > strain(worst) ? s : worst;
        }
        weft_spring found = weft_cloth_worst_spring(m.cloth, m.y);
        ck_assert_int_eq(found.family, worst->family);
        ck_assert(found.p == worst->p + worst->q - found.q);
        near(found.strain, strain(worst), 1e-14);
        m.y[0] = (double)NAN; /* of the first spring */
        found = weft_cloth_worst_spring(m.cloth, m.y);
        ck_assert(isnan(found.strain) && (found.p == 0 || found.q == 0));
        define(grids[g], 0, _i, ELASTIC);
        make(g);
        found = weft_cloth_worst_spring(m.cloth, m.y);
        ck_assert(found.p == 0 && found.q == 0 && found.strain == 0.0);
    }
}
END_TEST

TEST_SUITE(forces)
{
    const TTest *const tests[] = {
        force_is_minus_the_gradient_of_the_energy,
        measures_are_sums_over_free_particles_and_all_springs,
        dampers_follow_their_formula_and_take_power,
        springs_and_dampers_give_no_force_and_no_torque_in_all,
        spring_of_no_length_pulls_nothing,
        worst_spring_is_the_most_strained_or_not_a_number,
        strain_law_is_hookes_with_k_over_s,
        rigid_motion_feels_no_damper,
        wind_pushes_along_the_normal_and_drag_against_the_velocity,
        wind_on_a_flat_sheet_is_drag_times_area_times_speed,
        rhs_is_velocity_and_force_over_mass_but_for_pins,
        rhs_refuses_whatever_is_not_finite,
    };
    Suite *suite = suite_create("forces");
    TCase *tcase = tcase_create("forces");
    suite_add_tcase(suite, tcase);
    for (size_t i = 0; i < COUNT(tests); ++i) { /* the first six under both laws */
        tcase_add_loop_test(tcase, tests[i], 0, i < 6 ? 2 : 1);
    }
    return suite;
}
