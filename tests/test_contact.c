/* SPDX-License-Identifier: BSD-3-Clause */
/* test_contact.c -- contact with rigid shapes in a given state: gaps, forces, powers,
 * loads, the check of definitions. What needs a simulation is elsewhere. */
#include "support.h"

#include "cloth/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 20 };

/* Loose particles, so that contact is the only force that depends on the state. */
static weft_cloth_def def;
static weft_shape shapes[4];
static weft_cloth *cloth;
static double y[6 * N];

static double noise(uint64_t *seed) /* in (-1, 1) */
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}

/* A shape of each kind near the origin, which moves and turns; the plane below. */
static void setup(void)
{
    def = weft_cloth_def_default();
    def.rows = 4, def.cols = N / 4;
    def.origin[1] = 10.0; /* away from all shapes */
    def.density = 0.0, def.mass = 0.1;
    for (size_t k = 0; k < 4; ++k) {
        shapes[k] = weft_shape_default((weft_shape_kind)k);
        shapes[k].velocity[0] = 0.3, shapes[k].amplitude[1] = 0.02;
        shapes[k].frequency = 1.5, shapes[k].friction = 0.1 + 0.2 * (double)k;
        shapes[k].turn
            = (weft_turn){ { 0.3, -0.4, 1.2 }, { 0.1, 0.2, -0.3 }, 1.5, 0.4, 0.7 };
    }
    shapes[WEFT_PLANE].normal[0] = 0.5, shapes[WEFT_PLANE].spin[1] = 2.0;
    shapes[WEFT_PLANE].spin[0] = 1.0;
    shapes[WEFT_SPHERE].radius = 0.3, shapes[WEFT_SPHERE].spin[2] = -3.0;
    shapes[WEFT_CAPSULE].to[0] = 0.2, shapes[WEFT_CAPSULE].to[1] = 0.1;
    shapes[WEFT_CAPSULE].radius = 0.1, shapes[WEFT_CAPSULE].spin[0] = 2.0;
    shapes[WEFT_CAPSULE].spin[1] = 1.0;
    shapes[WEFT_BOX].rounding = 0.05;
    for (size_t k = 0; k < 3; ++k) {
        shapes[WEFT_BOX].half[k] = 0.1 + 0.05 * (double)k;
    }
    def.contact.thickness = 0.02;
    def.contact.shapes = shapes;
}

static void teardown(void)
{
    weft_cloth_destroy(cloth);
    cloth = NULL;
}

/* What becomes of a vector by the turn of setup, and its omega. */
static void turned(const double v[3], double t, double out[3], double omega[3])
{
    const double w = 2.0 * acos(-1.0) * 0.7, angle = 1.5 * t + 0.4 * sin(w * t);
    const double u[3] = { 0.3 / 1.3, -0.4 / 1.3, 1.2 / 1.3 };
    const double along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        out[k] = v[k] * cos(angle) + (u[a] * v[b] - u[b] * v[a]) * sin(angle)
                 + u[k] * along * (1.0 - cos(angle));
        omega[k] = (1.5 + 0.4 * w * cos(w * t)) * u[k];
    }
}

/* One shape; every particle at a gap of a tenth to nine tenths of the thickness at t.
 */
static void touch(weft_shape_kind kind, double t)
{
    uint64_t seed = 11 + (uint64_t)kind;
    double at[3];
    def.contact.shapes = &shapes[kind];
    def.contact.shape_count = 1;
    cloth = test_cloth(&def);
    weft_cloth_shape_pose(cloth, 0, t, at, NULL);
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < N; ++i) {
        const double want = (0.5 + 0.4 * noise(&seed)) * def.contact.thickness;
        double way[3];
        for (size_t k = 0; k < 3; ++k) {
            way[k] = noise(&seed);
            y[(3 + k) * N + i] = 2.0 * noise(&seed);
        }
        if (kind == WEFT_PLANE) {
            way[1] = fabs(way[1]) + 1.0, way[0] = fabs(way[0]);
        }
        /* along `way` the gap grows from inside to far away */
        double low = 0.0, high = 10.0;
        for (int j = 0; j < 60; ++j) {
            const double middle = 0.5 * (low + high);
            double one[6 * N];
            size_t particle;
            memcpy(one, y, sizeof one);
            for (size_t l = 0; l < N; ++l) {
                for (size_t k = 0; k < 3; ++k) {
                    one[k * N + l] = l == i ? at[k] + middle * way[k] : 50.0;
                }
            }
            const double gap = weft_cloth_gap(cloth, t, one, &particle, NULL);
            ck_assert_uint_eq(particle, i);
            *(gap < want ? &low : &high) = middle;
        }
        for (size_t k = 0; k < 3; ++k) {
            y[k * N + i] = at[k] + low * way[k];
        }
    }
}

/* Without damping and friction the force is -dU/dx, and without a shape's work. */
START_TEST(forces_are_the_slope_of_the_energy)
{
    const double t = 0.37, h = 1e-7;
    double f[3 * N];
    def.contact.damping = 0.0, shapes[_i % 4].friction = 0.0;
    def.contact.exponent = 3 + _i % 8;
    memset(def.gravity, 0, sizeof def.gravity);
    touch((weft_shape_kind)(_i % 4), t);
    weft_cloth_force(cloth, t, y, f);
    for (size_t j = 0; j < 3 * (size_t)N; ++j) {
        const double kept = y[j];
        y[j] = kept + h;
        const double ahead = weft_cloth_energy(cloth, t, y).contact;
        y[j] = kept - h;
        const double behind = weft_cloth_energy(cloth, t, y).contact;
        y[j] = kept;
        ck_assert_double_eq_tol(f[j], (behind - ahead) / (2.0 * h),
                                1e-5 * (1.0 + fabs(f[j])));
    }
}
END_TEST

/* The formulas of docs/theory/contact.md for p = 4, once more, on a plane at rest. */
START_TEST(forces_are_those_of_the_formulas)
{
    const double m = 0.1, dh = 0.02, vc = 5.0, e = 0.5 * vc * vc, chi = 1.0, mu = 0.3;
    const double d = 0.3 * dh, s = 1.0 - d / dh, eps = 1e-3, un = -0.7, w = 2e-3;
    const double u = chi * un, z = 1.0 - s;
    const double n0 = m * e / dh * s * s * s * (4.0 - 3.0 * s) / (z * z);
    const double kn
        = m * e / (dh * dh) * s * s * (12.0 - 16.0 * s + 6.0 * s * s) / (z * z * z);
    const double n = n0 * (sqrt(1.0 + u * u) - u);
    const double q = mu * n / (10.0 * m * sqrt(kn / m));
    weft_shape floor = weft_shape_default(WEFT_PLANE);
    double f[3 * N];
    def.contact.shapes = &floor;
    def.contact.shape_count = 1;
    def.contact.law = _i == 0 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    memset(def.gravity, 0, sizeof def.gravity);
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    y[N] = d;
    y[3 * N] = _i == 2 ? 0.3 * eps : w; /* faster or slower than eps */
    y[4 * N] = un;
    weft_cloth_force(cloth, 0.0, y, f);
    const double slow = 0.3;
    const double friction = _i == 0   ? mu * n * w / sqrt(w * w + eps * eps + q * q)
                            : _i == 1 ? mu * n
                                      : mu * n * (2.0 * slow - slow * slow);
    ck_assert_double_eq_tol(f[N], n, 1e-13 * n);
    ck_assert_double_eq_tol(f[0], -friction, 1e-13 * n);
    ck_assert(f[2 * N] == 0.0);
    ck_assert_double_eq_tol(weft_cloth_energy(cloth, 0.0, y).contact,
                            m * e * s * s * s * s / z, 1e-14);
    y[N] = 0.27551 * dh; /* where a particle at the stopping speed turns */
    ck_assert_double_eq_tol(weft_cloth_energy(cloth, 0.0, y).contact, m * e, 1e-4);
}
END_TEST

/* A box and its default `to` may be at one place; a plane may have any radius. */
START_TEST(a_number_that_the_kind_does_not_read_changes_no_bit)
{
    static const double any[]
        = { NAN, -INFINITY, INFINITY, -1e9, 1e308, 0.0 /* where the shapes are */ };
    const double t = 0.37;
    double f[6 * N], g[6 * N];
    weft_shape *shape = &shapes[_i];
    touch((weft_shape_kind)_i, t);
    ck_assert_int_eq(weft_cloth_rhs(cloth, t, y, f), 0);
    const uint64_t hash = weft__contact_hash(&cloth->contact);
    for (size_t k = 0; k < sizeof any / sizeof any[0]; ++k) {
        const bool plane = shape->kind == WEFT_PLANE, box = shape->kind == WEFT_BOX;
        shape->radius = plane || box ? any[k] : shape->radius;
        shape->rounding = box ? shape->rounding : any[k];
        for (size_t j = 0; j < 3; ++j) {
            shape->normal[j] = plane ? shape->normal[j] : any[k];
            shape->to[j] = shape->kind == WEFT_CAPSULE ? shape->to[j] : any[k];
            shape->half[j] = box ? shape->half[j] : any[k];
        }
        weft_cloth_destroy(cloth);
        cloth = test_cloth(&def);
        ck_assert_int_eq(weft_cloth_rhs(cloth, t, y, g), 0);
        ck_assert_mem_eq(f, g, sizeof f);
        ck_assert(weft__contact_hash(&cloth->contact) == hash);
    }
}
END_TEST

/* ---- gaps ------------------------------------------------------------------------ */

/* The gap of the first particle at x; the others are pinned, and so have none. */
static double gap_at(const double x[3], double t)
{
    size_t particle = N, shape = N;
    for (size_t k = 0; k < 3; ++k) {
        y[k * N] = x[k];
    }
    const double gap = weft_cloth_gap(cloth, t, y, &particle, &shape);
    ck_assert_uint_eq(particle, 0);
    ck_assert_uint_eq(shape, 0);
    return gap;
}

static void one_free_particle(weft_shape_kind kind)
{
    static const weft_pin pins[] = { { .rows = { 1, -1 }, .cols = { 0, -1 } },
                                     { .rows = { 0, 0 }, .cols = { 1, -1 } } };
    def.pins = pins;
    def.pin_count = 2;
    def.contact.shapes = &shapes[kind];
    def.contact.shape_count = 1;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
}

/* With what moves at t = 0 the shapes are where they are defined. */
START_TEST(gaps_are_distances)
{
    static const struct {
        weft_shape_kind kind;
        double x[3], gap;
    } cases[] = {
        { WEFT_PLANE, { 0.0, 1.0, 7.0 }, 0.89442719099991588 }, /* 2 / sqrt 5 */
        { WEFT_PLANE, { -2.0, 1.0, 0.0 }, 0.0 },
        { WEFT_SPHERE, { 0.0, 0.3, 0.4 }, 0.2 },
        { WEFT_SPHERE, { 0.0, 0.0, -0.1 }, -0.2 },
        { WEFT_CAPSULE, { 0.1, 0.05, 0.3 }, 0.2 }, /* beside its middle */
        { WEFT_CAPSULE, { -0.4, -0.2, 0.0 }, 0.34721359549995796 }, /* sqrt 0.2 - 0.1 */
        { WEFT_BOX, { 0.05, 0.5, 0.1 }, 0.35 },                     /* above its top */
        { WEFT_BOX, { 0.25, 0.3, 0.1 }, 0.18784142300054420 }, /* 0.2 2^(1/4) - 0.05 */
    };
    one_free_particle(cases[_i].kind);
    ck_assert_double_eq_tol(gap_at(cases[_i].x, 0.0), cases[_i].gap, 1e-15);
}
END_TEST

/* Which the step check relies on. */
START_TEST(gaps_grow_no_faster_than_distances)
{
    uint64_t seed = 3;
    one_free_particle((weft_shape_kind)_i);
    for (int j = 0; j < 3000; ++j) {
        double a[3], b[3], square = 0.0;
        const double step = j % 3 == 0 ? 1.0 : j % 3 == 1 ? 0.05 : 1e-4;
        for (size_t k = 0; k < 3; ++k) {
            a[k] = 0.5 * noise(&seed);
            b[k] = a[k] + step * noise(&seed);
            square += (b[k] - a[k]) * (b[k] - a[k]);
        }
        const double difference = fabs(gap_at(b, 0.37) - gap_at(a, 0.37));
        ck_assert_double_le(difference, sqrt(square) + 1e-15);
    }
}
END_TEST

START_TEST(poses_follow_the_motion)
{
    const double w = 2.0 * acos(-1.0) * 1.5, t = 0.8;
    const double c0[3] = { 0.1, 0.2, -0.3 }, from[3] = { -0.1, -0.2, 0.3 };
    const double moved[3] = { 0.3 * t, 0.02 * sin(w * t), 0.0 };
    const double speed[3] = { 0.3, 0.02 * w * cos(w * t), 0.0 };
    double at[3], velocity[3], arm[3], o[3];
    one_free_particle(WEFT_SPHERE);
    weft_cloth_shape_pose(cloth, 0, t, at, velocity);
    turned(from, t, arm, o);
    for (size_t k = 0; k < 3; ++k) {
        const size_t a = (k + 1) % 3, b = (k + 2) % 3;
        ck_assert_double_eq_tol(at[k], c0[k] + moved[k] + arm[k], 1e-15);
        ck_assert_double_eq_tol(velocity[k], speed[k] + o[a] * arm[b] - o[b] * arm[a],
                                1e-14);
    }
    weft_cloth_shape_pose(cloth, 0, t, NULL, NULL);
    ck_assert_uint_eq(weft_cloth_shapes(cloth), 1);
    ck_assert_double_eq(weft_cloth_shape(cloth, 0).radius, 0.3);
}
END_TEST

START_TEST(without_shapes_gaps_are_infinite)
{
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    ck_assert(isinf(weft_cloth_gap(cloth, 0.0, y, NULL, NULL)));
    ck_assert_uint_eq(weft_cloth_touching(cloth, 0.0, y), 0);
    ck_assert_uint_eq(weft_cloth_shapes(cloth), 0);
}
END_TEST

/* A particle that touches two shapes counts once. */
START_TEST(touching_counts_particles)
{
    weft_shape corner[]
        = { weft_shape_default(WEFT_PLANE), weft_shape_default(WEFT_PLANE) };
    corner[1].normal[0] = 1.0, corner[1].normal[1] = 0.0;
    corner[1].at[0] = -20.0;
    def.contact.shapes = corner;
    def.contact.shape_count = 2;
    cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    y[0] = -19.99, y[N] = 0.015;      /* near both */
    y[1] = -19.985;                   /* near the wall */
    y[2] = -19.979, y[N + 2] = 0.021; /* beyond the thickness */
    size_t particle, shape;
    ck_assert_double_eq_tol(weft_cloth_gap(cloth, 0.0, y, &particle, &shape), 0.01,
                            1e-14);
    ck_assert_uint_eq(particle, 0);
    ck_assert_uint_eq(shape, 1);
    ck_assert_uint_eq(weft_cloth_touching(cloth, 0.0, y), 2);
}
END_TEST

/* ---- loads ----------------------------------------------------------------------- */

/* What the shape gives is what the particles get, and their work is that of its motion,
 * its turn and its spin, which turns with it. */
START_TEST(loads_balance_forces_and_work)
{
    const double t = 0.37;
    double f[3 * N], force[3], torque[3], velocity[3], power[WEFT_POWERS], work = 0.0;
    double spin[3], omega[3];
    turned(shapes[_i].spin, t, spin, omega);
    memset(def.gravity, 0, sizeof def.gravity);
    touch((weft_shape_kind)_i, t);
    weft_cloth_force(cloth, t, y, f);
    weft_cloth_power(cloth, t, y, power);
    weft_cloth_shape_load(cloth, t, y, 0, force, torque);
    weft_cloth_shape_pose(cloth, 0, t, NULL, velocity);
    for (size_t k = 0; k < 3; ++k) {
        double sum = 0.0;
        for (size_t i = 0; i < N; ++i) {
            sum += f[k * N + i];
        }
        ck_assert_double_eq_tol(force[k], -sum, 1e-12 * (1.0 + fabs(sum)));
        work += force[k] * velocity[k] + torque[k] * (spin[k] + omega[k]);
    }
    if (_i != WEFT_PLANE && _i != WEFT_CAPSULE) { /* those spin along their axis */
        ck_assert_double_eq_tol(power[WEFT_POWER_SHAPES], -work, 1e-11 * fabs(work));
    }
}
END_TEST

/* ---- states that cannot be used -------------------------------------------------- */

static void refuse_on_every_level(size_t j, double value)
{
    double dydt[6 * N];
    const double kept = y[j];
    for (size_t i = 0; i < (size_t)weft__isa_last(); ++i) {
        weft__cloth_choose(cloth, (weft__isa)(i + 1));
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
        y[j] = value;
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 1);
        y[j] = kept;
    }
}

START_TEST(a_free_particle_inside_or_nowhere_is_refused)
{
    one_free_particle((weft_shape_kind)_i);
    refuse_on_every_level(0, (double)NAN);
    y[0] = 0.05, y[2 * N] = 0.02;
    y[1] = y[N + 1] = y[2 * N + 1] = 0.0; /* a pinned particle may be anywhere */
    refuse_on_every_level(N, -0.03);
    y[N] = -0.03;
    ck_assert(isinf(weft_cloth_energy(cloth, 0.0, y).contact));
    ck_assert_double_le(weft_cloth_gap(cloth, 0.0, y, NULL, NULL), 1e-3);
}
END_TEST

/* ---- definitions ----------------------------------------------------------------- */

static void expect_refusal(const char *words)
{
    weft_error err = { 0 };
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, words) != NULL, "%s", err.message);
}

START_TEST(wrong_shapes_are_refused)
{
    static const struct {
        weft_shape shape;
        const char *words;
    } cases[] = {
        { { .kind = WEFT_SHAPES }, "kind 5 is unknown" },
        { { .kind = WEFT_PLANE, .at = { NAN } }, "at nan, 0, 0 m: must be finite" },
        { { .kind = WEFT_PLANE }, "normal must be finite and not zero" },
        { { .kind = WEFT_PLANE, .normal = { 0, 1, 0 }, .spin = { 1, 1, 0 } },
          "spins about its normal only" },
        { { .kind = WEFT_SPHERE }, "radius 0 m: must be > 0" },
        { { .kind = WEFT_SPHERE, .radius = NAN }, "radius nan m: must be > 0" },
        { { .kind = WEFT_CAPSULE, .radius = 1 }, "ends must be finite and apart" },
        { { .kind = WEFT_CAPSULE, .radius = 1, .to = { 1, 0, 0 }, .spin = { 0, 1, 0 } },
          "spins about its axis only" },
        { { .kind = WEFT_BOX, .half = { 1, 1, 1 } }, "rounding 0 m: must be > 0" },
        { { .kind = WEFT_BOX, .half = { 1, 1, 0.1 }, .rounding = 0.1 }, "> rounding" },
        { { .kind = WEFT_BOX, .half = { 1, 1, 1 }, .rounding = 0.1, .spin = { 1 } },
          "a box cannot spin" },
        { { .kind = WEFT_SPHERE, .radius = 1, .velocity = { INFINITY } }, "velocity" },
        { { .kind = WEFT_SPHERE, .radius = 1, .amplitude = { NAN } }, "amplitude" },
        { { .kind = WEFT_SPHERE, .radius = 1, .frequency = -1 }, "frequency" },
        { { .kind = WEFT_SPHERE, .radius = 1, .friction = NAN }, "friction" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const weft_shape both[] = { shapes[0], cases[i].shape };
        def.contact.shapes = both;
        def.contact.shape_count = 2;
        expect_refusal(cases[i].words);
        expect_refusal("shapes[1]: ");
    }
}
END_TEST

START_TEST(wrong_contact_is_refused)
{
    def.contact.shapes = shapes;
    def.contact.shape_count = 1;
    const weft_contact_def with = def.contact;
    def.contact.thickness = 0.0;
    expect_refusal("contact: thickness 0 m: must be > 0");
    def.contact = with, def.contact.stopping_speed = NAN;
    expect_refusal("contact: stopping_speed nan m/s: must be > 0");
    def.contact = with, def.contact.exponent = 2;
    expect_refusal("contact: exponent 2: must be >= 3 and <= 10");
    def.contact = with, def.contact.damping = -1.0;
    expect_refusal("contact: damping -1 s/m: must be >= 0");
    def.contact = with, def.contact.friction = INFINITY;
    expect_refusal("contact: friction inf: must be >= 0");
    def.contact = with, def.contact.slip = 0.0;
    expect_refusal("contact: slip 0 m/s: must be > 0");
    def.contact = with, def.contact.thickness = 1e308;
    expect_refusal("contact: stopping_speed^2 / (2 thickness^2) is too large or too "
                   "small for a double");
    def.contact = with, def.contact.stopping_speed = 1e200;
    expect_refusal("contact: stopping_speed^2 / 2 is too");
    def.contact = with, def.contact.damping = 1e300;
    expect_refusal("contact: (damping * stopping_speed)^2 is too");
    def.contact = with, def.contact.friction = 1e200;
    expect_refusal("contact: friction^2 is too");
    def.contact = with, def.contact.slip = 1e-200;
    expect_refusal("contact: slip^2 is too");
}
END_TEST

/* The deepest particle of each shape, if it is free. */
START_TEST(a_start_inside_a_shape_is_refused_with_its_place)
{
    weft_pin pin = { .rows = { 3, 3 }, .cols = { 0, -1 } };
    weft_shape both[] = { shapes[WEFT_SPHERE], weft_shape_default(WEFT_PLANE) };
    def.origin[1] = 2.998; /* the last row is at -0.002 */
    both[0].at[1] = -9.0;
    def.contact.shapes = both;
    def.contact.shape_count = 2;
    expect_refusal("particle (3, 0) is 2 mm inside shapes[1]");
    def.pins = &pin;
    def.pin_count = 1;
    cloth = test_cloth(&def);
}
END_TEST

/* ---- bounds ---------------------------------------------------------------------- */

/* Into matrix[3][3]: minus the slope of the acceleration of particle i by its position
 * (half 0) or velocity (half 1), but for what is not symmetric. */
static void slopes(double t, size_t i, size_t half, double matrix[3][3])
{
    const double h = 1e-7, mass = weft_cloth_particle_mass(cloth, i);
    double ahead[3 * N], behind[3 * N], a[3][3];
    for (size_t c = 0; c < 3; ++c) {
        double *at = &y[(3 * half + c) * N + i];
        const double kept = *at;
        *at = kept + h;
        weft_cloth_force(cloth, t, y, ahead);
        *at = kept - h;
        weft_cloth_force(cloth, t, y, behind);
        *at = kept;
        for (size_t r = 0; r < 3; ++r) {
            a[r][c] = (behind[r * N + i] - ahead[r * N + i]) / (2.0 * h * mass);
        }
    }
    for (size_t j = 0; j < 9; ++j) {
        matrix[j / 3][j % 3] = 0.5 * (a[j / 3][j % 3] + a[j % 3][j / 3]);
    }
}

static double quotient(double a[3][3], const double x[3])
{
    double sum = 0.0;
    for (size_t j = 0; j < 9; ++j) {
        sum += x[j / 3] * a[j / 3][j % 3] * x[j % 3];
    }
    return sum / (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

static bool holds(const weft_stiffness *of, double w2, double c)
{
    bool inside = w2 <= of->omega2 && c <= of->damping;
    for (size_t i = 0; i < of->count; ++i) {
        const double *p = of->corners[i], *q = of->corners[(i + 1) % of->count];
        const double side = (q[0] - p[0]) * (c - p[1]) - (q[1] - p[1]) * (w2 - p[0]);
        inside = inside && side >= -1e-6 * of->omega2 * of->damping;
    }
    return inside;
}

/* Sliding particles, so that friction couples directions, and curved shapes. */
START_TEST(bounds_hold_every_direction_of_touching_particles)
{
    const double t = 0.37;
    uint64_t seed = 5;
    def.contact.law = _i % 8 < 4 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    def.contact.exponent = 3 + _i % 8;
    def.contact.slip = 0.05;
    shapes[_i % 4].friction = 0.05 * (double)_i;
    touch((weft_shape_kind)(_i % 4), t);
    const weft_stiffness bound = weft_cloth_stiffness(cloth, t, y);
    for (size_t i = 0; i < N; ++i) {
        double k[3][3], c[3][3];
        slopes(t, i, 0, k);
        slopes(t, i, 1, c);
        for (int j = 0; j < 400; ++j) {
            const double x[3] = { noise(&seed), noise(&seed), noise(&seed) };
            const double w2 = quotient(k, x);
            ck_assert(w2 < 0.0 || holds(&bound, w2, quotient(c, x)));
        }
    }
}
END_TEST

/* Particles at any gap that one arriving at the stopping speed reaches, and as fast as
 * it is there. */
START_TEST(bounds_without_a_state_hold_up_to_the_stopping_speed)
{
    const double t = 0.37, fastest = def.contact.stopping_speed;
    def.contact.law = _i % 8 < 4 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    def.contact.exponent = 3 + _i % 8;
    memset(shapes[_i % 4].spin, 0, sizeof shapes[_i % 4].spin);
    touch((weft_shape_kind)(_i % 4), t);
    const weft_stiffness any = weft_cloth_stiffness(cloth, 0.0, NULL);
    double velocity[3];
    weft_cloth_shape_pose(cloth, 0, t, NULL, velocity);
    for (size_t i = 0; i < N; ++i) {
        double one[6 * N], square = 0.0;
        for (size_t j = 0; j < 6 * (size_t)N; ++j) {
            one[j] = j % N == i ? y[j] : 50.0;
        }
        const double reached = weft_cloth_energy(cloth, t, one).contact
                               / (0.5 * 0.1 * fastest * fastest);
        for (size_t k = 0; k < 3; ++k) {
            square += y[(3 + k) * N + i] * y[(3 + k) * N + i];
        }
        for (size_t k = 0; k < 3; ++k) { /* too deep: out of reach */
            double *v = &y[(3 + k) * N + i];
            y[k * N + i] = reached < 1.0 ? y[k * N + i] : 50.0;
            *v = velocity[k] + *v * sqrt(fmax(0.0, 1.0 - reached) / square) * fastest;
        }
    }
    const weft_stiffness now = weft_cloth_stiffness(cloth, t, y);
    ck_assert_uint_gt(weft_cloth_touching(cloth, t, y), N / 4);
    ck_assert_double_le(now.omega2, (1.0 + 1e-11) * any.omega2);
    ck_assert_double_le(now.damping, (1.0 + 1e-11) * any.damping);
}
END_TEST

TEST_SUITE(contact)
{
    Suite *suite = suite_create("contact");
    TCase *tcase = tcase_create("contact");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, forces_are_the_slope_of_the_energy, 0, 16);
    tcase_add_loop_test(tcase, forces_are_those_of_the_formulas, 0, 3);
    tcase_add_loop_test(tcase, a_number_that_the_kind_does_not_read_changes_no_bit, 0,
                        4);
    tcase_add_loop_test(tcase, gaps_are_distances, 0, 8);
    tcase_add_loop_test(tcase, gaps_grow_no_faster_than_distances, 0, WEFT_MESH);
    tcase_add_test(tcase, poses_follow_the_motion);
    tcase_add_test(tcase, without_shapes_gaps_are_infinite);
    tcase_add_test(tcase, touching_counts_particles);
    tcase_add_loop_test(tcase, loads_balance_forces_and_work, 0, WEFT_MESH);
    tcase_add_loop_test(tcase, a_free_particle_inside_or_nowhere_is_refused, 0,
                        WEFT_MESH);
    tcase_add_test(tcase, wrong_shapes_are_refused);
    tcase_add_test(tcase, wrong_contact_is_refused);
    tcase_add_test(tcase, a_start_inside_a_shape_is_refused_with_its_place);
    tcase_add_loop_test(tcase, bounds_hold_every_direction_of_touching_particles, 0,
                        16);
    tcase_add_loop_test(tcase, bounds_without_a_state_hold_up_to_the_stopping_speed, 0,
                        16);
    suite_add_tcase(suite, tcase);
    return suite;
}
