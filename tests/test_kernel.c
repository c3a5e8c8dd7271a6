/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow kernels asan-long computes */
/* test_kernel.c -- the fast forms of forces against the plain loops beside them, bit
 * for bit: on every level of instructions that this machine has, and 8 lanes wide in
 * whatever instructions there are, in whatever runs of blocks. */
#include "meshes.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth/parameter_derivative.h"

enum { SEEDS = 400, MOST = 2200, SHAPES = 11 };

weft__start_fn weft__rows_wide;
weft__products_fn weft__products_wide;
weft__add_fn weft__bending_wide, weft__wind_wide, weft__contact_wide;
weft__clear_fn weft__clear_wide;
weft__pushes_fn weft__pushes_wide;
weft__slack_fn weft__slack_wide;
weft__gaps_fn weft__gaps_wide;
weft__meets_fn weft__meets_wide;
weft__within_fn weft__within_wide;
weft__drift_fn weft__drift_wide;
weft__turned_fn weft__transposed_wide;
weft__range_fn weft__range_wide;

/* Narrower and wider than any vector, one more than a multiple of it, wider than a
 * tile. */
static const size_t sizes[][2]
    = { { 2, 2 }, { 1, 2 },  { 2, 1 },  { 1, 11 },  { 11, 1 },  { 3, 3 },
        { 2, 7 }, { 7, 2 },  { 5, 8 },  { 8, 9 },   { 4, 10 },  { 3, 17 },
        { 6, 5 }, { 16, 4 }, { 5, 33 }, { 32, 32 }, { 4, 259 }, { 3, 530 } };

static struct {
    weft_cloth_def def;
    weft_pin pins[2];
    weft_load load;
    weft_shape shapes[SHAPES];
    weft_cloth *cloth;
    size_t n;
    double t, y[6 * MOST], dydt[6 * MOST];
} m;

/* 0 to 1, the same everywhere */
static double chance(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-53;
}

static void fill(double *to, double scale, uint64_t *seed)
{
    for (size_t k = 0; k < 3; ++k) {
        to[k] = scale * (2.0 * chance(seed) - 1.0);
    }
}

/* A shape as large as a cell, anywhere near the cloth or beyond it. */
static weft_shape some_shape(uint64_t *seed)
{
    weft_shape shape = weft_shape_default((weft_shape_kind)(4.0 * chance(seed)));
    const double size = 0.05 + 0.2 * chance(seed);
    shape.at[0] = 4.0 * chance(seed), shape.at[1] = -4.0 * chance(seed);
    shape.at[2] = shape.kind == WEFT_PLANE ? -0.5 - 0.3 * chance(seed)
                                           : 0.3 + 1.2 * size + 0.5 * chance(seed);
    fill(shape.to, 0.3, seed);
    for (size_t k = 0; k < 3; ++k) {
        shape.to[k] += shape.at[k];
        shape.half[k] = size * (0.2 + 0.3 * chance(seed));
    }
    shape.to[2] = shape.at[2] + 0.05;
    shape.normal[1] = 0.005, shape.normal[2] = 1.0;
    shape.radius = size, shape.rounding = 0.1 * size;
    fill(shape.velocity, 0.1, seed);
    fill(shape.amplitude, 0.05, seed);
    shape.frequency = chance(seed) < 0.5 ? 2.0 : 0.0;
    if (shape.kind != WEFT_BOX) {
        const double *way = shape.kind == WEFT_PLANE ? shape.normal : shape.to;
        for (size_t k = 0; k < 3; ++k) {
            shape.spin[k] = way[k] - (shape.kind == WEFT_PLANE ? 0.0 : shape.at[k]);
        }
    }
    if (chance(seed) < 0.5) {
        shape.turn.rate = 6.0 * chance(seed) - 3.0;
        fill(shape.turn.axis, shape.kind == WEFT_BOX ? 1.0 : 0.0, seed);
        shape.turn.axis[1] += 0.005, shape.turn.axis[2] += 1.0; /* planes keep clear */
    }
    shape.friction = chance(seed) < 0.3 ? 0.0 : 2.0 * chance(seed) - 1.0;
    return shape;
}

/* Shapes that reach as far as the cloth is wide. */
static void define_contact(uint64_t *seed)
{
    weft_contact_def *law = &m.def.contact;
    law->thickness = 0.1 + 0.9 * chance(seed);
    law->exponent = 3 + (int)(8.0 * chance(seed));
    law->damping = chance(seed) < 0.5 ? chance(seed) : 0.0;
    law->law = chance(seed) < 0.5 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB;
    law->slip = chance(seed) < 0.5 ? 1e-3 : 1.0;
    law->shapes = m.shapes;
    law->shape_count
        = chance(seed) < 0.6 ? 1 + (size_t)((SHAPES - 1) * chance(seed)) : 0;
    for (size_t k = 0; k < SHAPES; ++k) {
        m.shapes[k] = some_shape(seed);
    }
}

/* Instead of bend springs. */
static void define_bending(uint64_t *seed)
{
    weft_bending_def *of = &m.def.bending;
    for (size_t k = 0; k < 2; ++k) {
        of->rigidity[k] = chance(seed) < 0.8 ? chance(seed) : 0.0;
    }
    of->twist = 2.0 * chance(seed) - 1.0;
    of->damping = chance(seed) < 0.5 ? 0.1 * chance(seed) : 0.0;
    m.def.springs[WEFT_BEND].present = false;
}

/* Each feature is there as often as not. */
static void define(uint64_t *seed)
{
    const size_t *size = sizes[*seed % (sizeof sizes / sizeof sizes[0])];
    m.def = weft_cloth_def_default();
    m.def.rows = size[0], m.def.cols = size[1];
    m.def.spacing[0] = 0.7, m.def.spacing[1] = 0.4;
    m.def.law = chance(seed) < 0.5 ? WEFT_LAW_HOOKE : WEFT_LAW_STRAIN;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        m.def.springs[f].present = chance(seed) < 0.7;
        m.def.springs[f].stiffness = chance(seed) < 0.9 ? 100.0 * chance(seed) : 0.0;
        m.def.springs[f].damping = chance(seed) < 0.5 ? chance(seed) : 0.0;
        m.def.across[f].present = f != WEFT_SHEAR && chance(seed) < 0.5;
        m.def.across[f].stiffness = 100.0 * chance(seed);
        m.def.across[f].damping = chance(seed) < 0.5 ? chance(seed) : 0.0;
    }
    m.def.rim_half = chance(seed) < 0.5;
    m.def.damping = chance(seed) < 0.5 ? chance(seed) : 0.0;
    m.def.wind_drag = chance(seed) < 0.5 ? chance(seed) : 0.0;
    fill(m.def.wind_velocity, 5.0, seed);
    fill(m.def.gravity, 10.0, seed);
    m.load = (weft_load){ .rows = { 0, -1 }, .cols = { -1, -1 }, .mass = 0.3 };
    m.def.loads = &m.load;
    m.def.load_count = chance(seed) < 0.5 ? 1 : 0;
    m.pins[0] = (weft_pin){ .rows = { 0, 0 }, .cols = { 0, -1 } };
    m.pins[1] = (weft_pin){ .cols = { -1, -1 }, .rows = { -1, -1 }, .frequency = 2.0 };
    fill(m.pins[1].amplitude, 0.1, seed);
    fill(m.pins[1].velocity, 1.0, seed);
    m.def.pins = m.pins;
    m.def.pin_count = (size_t)(3.0 * chance(seed));
    define_contact(seed);
    if (chance(seed) < 0.5) {
        define_bending(seed);
    }
}

/* A cloth of this number, strained and moving. */
static void make(uint64_t number)
{
    uint64_t seed = number;
    weft_cloth_destroy(m.cloth);
    define(&seed);
    m.cloth = test_cloth(&m.def);
    m.n = weft_cloth_particles(m.cloth);
    m.t = chance(&seed);
    weft_cloth_start(m.cloth, m.y);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        m.y[j] += (j < 3 * m.n ? 0.2 : 2.0) * (chance(&seed) - 0.5);
    }
    if (number % 7 == 0) { /* springs of no length */
        for (size_t k = 0; k < 3; ++k) {
            m.y[k * m.n] = m.y[k * m.n + 1];
        }
    }
}

static uint64_t hash(void)
{
    return test_hash(m.dydt, 6 * m.n);
}

/* The forms: the plain loops, one for each level, 8 lanes. */
static size_t form_count(void)
{
    return (size_t)weft__isa_last() + 2;
}

static const char *choose(weft_cloth *cloth, size_t form)
{
    const bool wide = form + 1 == form_count();
    weft__cloth_choose(cloth, wide ? WEFT__LOOPS : (weft__isa)form);
    if (wide) {
        cloth->springs.fast = weft__rows_wide;
        cloth->springs.products = weft__products_wide;
        cloth->springs.transposed = weft__transposed_wide;
        cloth->bending.fast = weft__bending_wide;
        cloth->wind.fast = weft__wind_wide;
        cloth->contact.fast = weft__contact_wide;
        cloth->contact.clear = weft__clear_wide;
        cloth->self.pushes = weft__pushes_wide;
        cloth->self.slack = weft__slack_wide;
        cloth->self.gaps = weft__gaps_wide;
        cloth->self.meets = weft__meets_wide;
        cloth->self.within = weft__within_wide;
        cloth->self.drift = weft__drift_wide;
        cloth->self.range = weft__range_wide;
    }
    return wide ? "8 lanes" : weft_cloth_isa(cloth);
}

START_TEST(every_level_and_width_has_the_bits_of_the_plain_loops)
{
    size_t touching = 0;
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        uint64_t plain = 0;
        double dissipation = 0.0;
        for (size_t i = 0; i < form_count(); ++i) {
            const char *name = choose(m.cloth, i);
            memset(m.dydt, 0xff, sizeof m.dydt);
            ck_assert_int_eq(weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt), 0);
            plain = i == 0 ? hash() : plain;
            ck_assert_msg(hash() == plain, "%u: %zu x %zu on %s", (unsigned)number,
                          m.def.rows, m.def.cols, name);
            const double heat = weft_cloth_dissipation(m.cloth, m.t, m.y);
            ck_assert(i < 2 || heat == dissipation);
            dissipation = heat;
        }
        touching += weft_cloth_touching(m.cloth, m.t, m.y);
    }
    ck_assert_uint_gt(touching, 10000);
}
END_TEST

/* The paths of the first rows: lanes beyond the last row look at those before it. */
START_TEST(every_level_finds_the_same_paths_clear)
{
    static double y1[6 * MOST];
    size_t verdicts[2] = { 0 };
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        for (double h = 1e-3; h < 1.0; h *= 4.0) {
            const weft__path path = { m.t, m.t + h, m.y, y1 };
            for (size_t j = 0; j < 6 * m.n; ++j) {
                const double way = number % 2 == 0 ? h : 4.0 * h; /* fast between */
                y1[j] = j < 3 * m.n ? m.y[j] + way * m.y[3 * m.n + j] : 0.9 * m.y[j];
            }
            for (size_t rows = 1; rows <= m.def.rows; ++rows) {
                const weft__contact *contact = &m.cloth->contact;
                const bool clear = weft__clear_loops(contact, &path, 0, rows);
                for (size_t i = 1; i < form_count(); ++i) {
                    (void)choose(m.cloth, i);
                    ck_assert(contact->clear(contact, &path, 0, rows) == clear);
                }
                verdicts[clear] += m.def.contact.shape_count > 0;
            }
        }
    }
    ck_assert_uint_gt(verdicts[0], 500);
    ck_assert_uint_gt(verdicts[1], 1000);
}
END_TEST

START_TEST(products_have_the_bits_of_the_plain_loops_on_every_level)
{
    static double dy[6 * MOST], room[9 * MOST], net[3 * MOST];
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        uint64_t seed = number + 1, plain = 0;
        for (size_t j = 0; j < 6 * m.n; ++j) {
            dy[j] = chance(&seed) - 0.5;
        }
        for (size_t i = 0; i < form_count(); ++i) {
            const char *name = choose(m.cloth, i);
            memset(m.dydt, 0xff, sizeof m.dydt);
            ck_assert_int_eq(weft_cloth_jacobian_product(m.cloth, m.t, m.y, dy, m.dydt),
                             0);
            weft__parameter_gradient by;
            const weft__state at = { .t = m.t, .y = m.y };
            uint64_t all = hash();
            ck_assert_int_eq(
                weft__rhs_transposed(m.cloth, NULL, &at, dy, room, m.dydt, net, &by),
                0);
            all = 31 * all + hash();
            all = 31 * all + test_hash(net, 3 * m.n);
            all = 31 * all + test_hash(by.stiffness, sizeof by / sizeof(double));
            plain = i == 0 ? all : plain;
            ck_assert_msg(all == plain, "%u: %zu x %zu on %s", (unsigned)number,
                          m.def.rows, m.def.cols, name);
        }
    }
}
END_TEST

/* Three directions, of which one has the derivative by a number, with the state. */
START_TEST(several_directions_and_a_number_in_one_sweep_have_the_bits_of_the_loops)
{
    enum { ALL = 4 };
    static double z[6 * ALL * MOST + 16], out[6 * ALL * MOST], masses[MOST + WEFT_PAST];
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        const size_t stride = ALL * m.n;
        uint64_t seed = number + 1, plain = 0;
        weft__spring_derivative by = {
            .orientations = 0x2d, .damped = true, .drag = 0.1, .inverse_mass = masses
        };
        fill(by.gravity, 1.0, &seed);
        const size_t cols = m.def.cols, down = number % 2 == 0 ? cols : ALL * cols;
        const size_t part = number % 2 == 0 ? m.n : cols;
        for (size_t k = 0; k < 6 * stride; ++k) {
            z[k] = chance(&seed) - 0.5;
        }
        for (size_t k = 0; k < 6 * m.n; ++k) {
            z[k / m.n * stride + k % m.n / cols * down + k % cols] = m.y[k];
        }
        for (size_t i = 0; i < m.n; ++i) {
            masses[i] = chance(&seed);
        }
        for (size_t g = 0; g < WEFT_GROUPS; ++g) {
            by.laws[g]
                = (weft__law_derivative){ chance(&seed), chance(&seed), chance(&seed) };
        }
        weft__tangents tangents
            = { .y = z, .base = out, .stride = stride, .down = down, .count = ALL - 1 };
        for (size_t j = 0; j < ALL - 1; ++j) {
            const size_t at = (1 + j) * part;
            tangents.tangent[j]
                = (weft__tangent){ z + at, out + at, j == 1 ? &by : NULL };
        }
        for (size_t i = 0; i < form_count(); ++i) {
            const char *name = choose(m.cloth, i);
            const weft__springs *own = &m.cloth->springs;
            memset(out, 0xff, sizeof out);
            ck_assert_int_eq(
                own->products(own, &m.cloth->body, &tangents, 0, m.def.rows), 0);
            const uint64_t found = test_hash(out, 6 * stride);
            plain = i == 0 ? found : plain;
            ck_assert_msg(found == plain, "%u: %zu x %zu on %s", (unsigned)number,
                          m.def.rows, m.def.cols, name);
        }
        const weft__state at = { .t = m.t, .y = m.y };
        (void)weft__springs_force.law.start(&m.cloth->springs, &m.cloth->body, &at,
                                            NULL, WEFT__ACCELERATION, m.dydt, 0,
                                            m.def.rows);
        for (size_t k = 0; k < 6 * m.n; ++k) {
            ck_assert(out[k / m.n * stride + k % m.n / cols * down + k % cols]
                      == m.dydt[k]);
        }
    }
}
END_TEST

/* v' of a free particle is its force by its mass. */
START_TEST(rates_are_forces_by_masses)
{
    static double f[3 * MOST];
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        weft_cloth_force(m.cloth, m.t, m.y, f);
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt), 0);
        double largest = 1.0;
        for (size_t j = 0; j < 3 * m.n; ++j) {
            largest = fmax(largest, fabs(m.dydt[3 * m.n + j]));
        }
        for (size_t j = 0; j < 3 * m.n; ++j) {
            const double a = f[j] / weft_cloth_particle_mass(m.cloth, j % m.n);
            ck_assert(weft_cloth_pinned(m.cloth, j % m.n)
                      || fabs(m.dydt[3 * m.n + j] - a) <= 1e-13 * largest);
        }
    }
}
END_TEST

/* Backwards, so that what a run writes beyond its blocks stays. */
START_TEST(runs_of_blocks_have_the_bits_of_the_whole)
{
    for (uint64_t number = 0; number < SEEDS; ++number) {
        make(number);
        const weft__state at = { .t = m.t, .y = m.y };
        (void)weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt);
        const uint64_t whole = hash();
        for (size_t each = 1; each <= 3; ++each) {
            memset(m.dydt, 0xff, sizeof m.dydt);
            for (size_t end = m.def.rows; end > 0;) {
                const size_t first = end > each ? end - each : 0;
                (void)weft__rhs_blocks(m.cloth, &at, m.dydt, first, end);
                end = first;
            }
            ck_assert_msg(hash() == whole, "%u: %zu x %zu in %zu", (unsigned)number,
                          m.def.rows, m.def.cols, each);
        }
    }
}
END_TEST

/* Sheets of 32 x 32, whose planes are 8192 bytes apart: at some of these addresses rows
 * are written to a buffer first. */
START_TEST(rates_have_the_same_bits_at_every_address)
{
    static double room[6 * 1024 + 512];
    for (uint64_t number = 15; number < SEEDS; number += sizeof sizes / sizeof *sizes) {
        make(number);
        ck_assert_uint_eq(m.n, 1024);
        (void)weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt);
        const uint64_t elsewhere = hash();
        for (size_t shift = 0; shift < 512; ++shift) {
            (void)weft_cloth_rhs(m.cloth, m.t, m.y, room + shift);
            ck_assert_uint_eq(test_hash(room + shift, 6 * m.n), elsewhere);
        }
    }
}
END_TEST

/* One bad number anywhere, on a sheet wider than a vector. */
START_TEST(every_level_refuses_whatever_is_not_finite)
{
    uint64_t number = 9;
    make(number);
    while (m.def.pin_count > 0 || !m.def.springs[WEFT_STRETCH].present) {
        make(number += sizeof sizes / sizeof sizes[0]);
    }
    for (size_t i = 0; i < form_count(); ++i) {
        (void)choose(m.cloth, i);
        for (size_t j = 0; j < 6 * m.n; ++j) {
            const double kept = m.y[j];
            m.y[j] = j % 2 == 0 ? (double)NAN : (double)INFINITY;
            ck_assert_int_eq(weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt), 1);
            m.y[j] = kept;
        }
        ck_assert_int_eq(weft_cloth_rhs(m.cloth, m.t, m.y, m.dydt), 0);
    }
}
END_TEST

START_TEST(sheet_at_rest_feels_gravity_alone_exactly)
{
    m.def = weft_cloth_def_default();
    m.def.rows = 9, m.def.cols = 13;
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        m.def.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 30.0, .damping = 0.1 };
    }
    m.cloth = test_cloth(&m.def);
    m.n = weft_cloth_particles(m.cloth);
    weft_cloth_start(m.cloth, m.y);
    ck_assert_int_eq(weft_cloth_rhs(m.cloth, 0.0, m.y, m.dydt), 0);
    for (size_t j = 0; j < 6 * m.n; ++j) {
        ck_assert(m.dydt[j] == (j / m.n == 4 ? -9.81 : 0.0));
    }
}
END_TEST

START_TEST(level_is_the_fastest_or_the_one_asked_for)
{
    const weft__isa last = weft__isa_last();
    weft__isa found;
    weft_error err = { 0 };
    ck_assert_int_eq(weft__isa_find(NULL, &found, NULL), WEFT_OK);
    ck_assert_int_eq(found, last);
    ck_assert_int_eq(weft__isa_find("", &found, NULL), WEFT_OK);
    ck_assert_int_eq(found, last);
    for (weft__isa i = WEFT__PLAIN; i <= last; ++i) {
        const char *name = weft__isa_name(i);
        setenv("WEFT_ISA", name, 1);
        m.def = weft_cloth_def_default();
        m.cloth = test_cloth(&m.def);
        ck_assert_str_eq(weft_cloth_isa(m.cloth), name);
        weft_cloth_destroy(m.cloth);
    }
    m.cloth = NULL;
    setenv("WEFT_ISA", "x86-64-v9", 1);
    ck_assert_int_eq(weft_cloth_create(&m.def, &m.cloth, &err), WEFT_INVALID);
    ck_assert_ptr_null(m.cloth);
    const char *said = "WEFT_ISA is 'x86-64-v9'; this machine has plain";
    ck_assert_msg(strncmp(err.message, said, strlen(said)) == 0, "%s", err.message);
    ck_assert_ptr_nonnull(strstr(err.message, weft__isa_name(last)));
}
END_TEST

/* ---- pairs of primitives --------------------------------------------------------- */

enum { KINDS = WEFT__EDGES + 1, PAIRS = 16384, PADDED = PAIRS + WEFT__BLOCK };

/* The pairs of a kind. */
typedef struct pair_list {
    weft__self_law law;
    int32_t particle[WEFT__NEAR_PLANES][PADDED];
    double slack[PADDED], mass[PADDED], rest[PADDED];
    size_t count;
} pair_list;

/* Every third one does not have to be looked at before something has moved by 1. */
static bool keep_pair(void *ctx, const weft__pair *pair)
{
    pair_list *of = (pair_list *)ctx + pair->kind;
    ck_assert_uint_lt(of->count, PAIRS);
    for (size_t k = 0; k < 4; ++k) {
        of->particle[k][of->count] = (int32_t)pair->particle[k];
    }
    of->particle[4][of->count] = (int32_t)pair->item[0];
    of->particle[5][of->count] = (int32_t)pair->item[1];
    of->mass[of->count] = weft__pair_mass(of->law.own, pair);
    of->rest[of->count] = weft__pair_rest(&of->law, pair);
    of->slack[of->count] = of->mass[of->count] == 0.0 ? (double)INFINITY
                           : of->count % 3 == 2       ? 1.0
                                                      : 0.0;
    ++of->count;
    return true;
}

/* The last `count` of them. */
static weft__near near_of(pair_list *of, size_t count)
{
    const size_t first = of->count - count;
    weft__near near = { .slack = of->slack + first,
                        .mass = of->mass + first,
                        .rest = of->rest + first };
    for (size_t k = 0; k < WEFT__NEAR_PLANES; ++k) {
        near.particle[k] = of->particle[k] + first;
    }
    return near;
}

enum { SELF_ROWS = 16, SELF_COLS = 11 };

/* Two layers of loose particles on each other, at an angle. */
static void lie_askew(const weft_cloth *cloth, double *y, size_t n)
{
    uint64_t seed = 11;
    for (size_t vertex = 0; vertex < n; ++vertex) {
        const size_t r = vertex / SELF_COLS, c = vertex % SELF_COLS;
        const size_t i = weft__particle_of(&cloth->mesh, vertex);
        const double thick = cloth->self.law.thickness;
        const bool upper = 2 * r > SELF_ROWS;
        const double down = (double)(upper ? SELF_ROWS - r : r);
        y[i] = 0.05 * (double)c + (upper ? 0.01 * down : 0.0);
        y[n + i] = upper ? 0.5 * thick : 0.0;
        y[2 * n + i] = 0.05 * down;
        for (size_t j = i; j < 6 * n; j += n) {
            y[j] = (j < 3 * n ? y[j] : 0.0)
                   + (j < 3 * n ? 0.25 * thick : 1.0) * chance(&seed);
        }
    }
}

static weft_cloth *self_cloth(weft_friction_law law, int exponent, bool triangles)
{
    static const size_t held[] = { 0, 1, 2, 3, 4, 11, 12, 13, 14, 22, 23 };
    static const weft_pin pins[] = {
        { .rows = { 0, 2 }, .cols = { 0, 5 }, .vertices = held, .vertex_count = 11 }
    };
    weft_cloth_def def = weft_cloth_def_default();
    test_mesh mesh;
    weft_cloth *cloth;
    weft_error err;
    mesh_sheet(&mesh, SELF_ROWS, SELF_COLS, 0.05, MESH_RANDOM, 0.1, 5);
    def.mesh = triangles ? &mesh.def : NULL;
    def.rows = SELF_ROWS, def.cols = SELF_COLS;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.pins = pins, def.pin_count = 1;
    def.contact.self = true;
    def.contact.thickness = triangles ? 0.012 : 0.02;
    def.contact.law = law, def.contact.exponent = exponent;
    ck_assert_msg(weft_cloth_create(&def, &cloth, &err) == WEFT_OK, "%s", err.message);
    mesh_free(&mesh);
    return cloth;
}

static void expect_same_push(weft__pair_kind kind, const weft__pushes *a,
                             const weft__pushes *b, size_t lane)
{
    for (size_t k = 0; k < weft__kind_particles(kind); ++k) {
        ck_assert_int_eq(a->particle[k][lane], b->particle[k][lane]);
        for (size_t j = 0; j < 3; ++j) {
            ck_assert_mem_eq(&a->force[k][j][lane], &b->force[k][j][lane],
                             sizeof(double));
        }
    }
    ck_assert_mem_eq(&a->gap[lane], &b->gap[lane], sizeof(double));
    ck_assert_mem_eq(&a->energy[lane], &b->energy[lane], sizeof(double));
    ck_assert_mem_eq(&a->heat[lane], &b->heat[lane], sizeof(double));
    ck_assert_mem_eq(&a->friction[lane], &b->friction[lane], sizeof(double));
}

/* Of `count` pairs, the first of which are in subsets of 0, 1, 2, ... that have moved.
 */
static void expect_same_pushes(const weft__self *at, weft__pair_kind kind,
                               const weft__near *near, size_t count, const double *y,
                               const weft__self_law *law, size_t *found)
{
    static weft__pushes plain[PAIRS / WEFT__BLOCK], pushes[PAIRS / WEFT__BLOCK];
    enum { SUBSETS = 12 };
    weft__pair_subset subsets[SUBSETS];
    double bad = 0.0;
    for (size_t i = 0, end = 0; i < SUBSETS; ++i) {
        end = i + 1 < SUBSETS && end + i < count ? end + i : count;
        subsets[i].moved = i % 2 == 0 ? 0.5 : 2.0;
        subsets[i].end[kind] = end;
    }
    const size_t all
        = weft__pushes_loops(law, kind, near, subsets, SUBSETS, y, plain, &bad);
    ck_assert_uint_eq(at->pushes(law, kind, near, subsets, SUBSETS, y, pushes, &bad),
                      all);
    ck_assert_double_eq(bad, 0.0);
    for (size_t i = 0; i < all; ++i) {
        expect_same_push(kind, &plain[i / WEFT__BLOCK], &pushes[i / WEFT__BLOCK],
                         i % WEFT__BLOCK);
    }
    *found += all;
}

static void expect_same_waits(const weft__self *at, weft__pair_kind kind, pair_list *of,
                              const double *y)
{
    static double plain[2][PADDED], found[2][PADDED];
    for (size_t first = 0; first < 10; ++first) {
        const size_t size = (of->count - first) * sizeof(double);
        weft__near near = near_of(of, of->count);
        near.slack = plain[0];
        weft__slack_loops(at, kind, &near, first, of->count, y, 0.01, plain[1]);
        near.slack = found[0];
        at->slack(at, kind, &near, first, of->count, y, 0.01, found[1]);
        ck_assert_mem_eq(plain[0] + first, found[0] + first, size);
        ck_assert_mem_eq(plain[1] + first, found[1] + first, size);
    }
}

/* Random ones of the pairs, some of them twice. */
static void choose_pairs(const pair_list *of, uint64_t *seed, uint32_t *which,
                         size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        which[i] = (uint32_t)((0.5 + 0.499 * chance(seed)) * (double)of->count);
    }
}

static void expect_gaps_of_single_pairs(const weft__self *at, weft__pair_kind kind,
                                        pair_list *of, const double *y)
{
    enum { SOME = 40 };
    const weft__near near = near_of(of, of->count);
    uint64_t seed = 3;
    for (size_t count = 0; count < SOME; ++count) {
        uint32_t which[SOME];
        double gaps[SOME + 1];
        choose_pairs(of, &seed, which, count);
        gaps[count] = 7.0; /* is not written */
        at->gaps(at, kind, &near, which, count, y, gaps);
        for (size_t i = 0; i < count; ++i) {
            const weft__pair pair = weft__near_pair(kind, &near, which[i]);
            const double gap = weft__pair_distance(&pair, y, at->points);
            ck_assert_mem_eq(&gaps[i], &gap, sizeof gap);
        }
        ck_assert_double_eq(gaps[count], 7.0);
    }
}

/* Returns how many of them push. */
static size_t expect_those_that_push(const weft__self *at, weft__pair_kind kind,
                                     pair_list *of, const double *y)
{
    enum { SOME = 40 };
    const weft__near near = near_of(of, of->count);
    uint64_t seed = 9;
    size_t all = 0;
    for (size_t count = 0; count < SOME; ++count) {
        uint32_t which[SOME], out[SOME];
        choose_pairs(of, &seed, which, count);
        const size_t found = at->meets(at, kind, &near, which, count, y, out);
        size_t j = 0;
        for (size_t i = 0; i < count; ++i) {
            const weft__pair pair = weft__near_pair(kind, &near, which[i]);
            weft__pushes push;
            double bad = 0.0;
            if (weft__pair_push(&of->law, &pair, y, &push, 0, &bad)) {
                while (j < found && out[j] != which[i]) { /* those of no mass */
                    ck_assert_double_eq(near.mass[out[j++]], 0.0);
                }
                ck_assert_uint_lt(j++, found);
                ++all;
            }
        }
        while (j < found) {
            ck_assert_double_eq(near.mass[out[j++]], 0.0);
        }
    }
    return all;
}

/* Of random numbers, some of which are the bound and some NaN. */
static void expect_those_within(const weft__self *at)
{
    enum { SOME = 60 };
    double numbers[SOME + WEFT__BLOCK] = { 0.0 };
    uint64_t seed = 5;
    for (size_t i = 0; i < SOME; ++i) {
        numbers[i] = i % 7 == 3 ? NAN : i % 5 == 2 ? 0.25 : chance(&seed);
    }
    for (size_t k = 0; k < (size_t)SOME * SOME; ++k) {
        const size_t first = k / SOME, end = k % SOME;
        uint32_t plain[SOME + WEFT__BLOCK], which[SOME + WEFT__BLOCK];
        const size_t count = weft__within_loops(numbers, first, end, 0.25, plain);
        ck_assert_uint_eq(at->within(numbers, first, end, 0.25, which), count);
        ck_assert_mem_eq(which, plain, count * sizeof *which);
        for (size_t i = 0, j = first; j < end; ++j) {
            const bool has = i < count && which[i] == j;
            ck_assert(has == !(numbers[j] > 0.25));
            i += has;
        }
    }
}

static void drift_patches(const weft__self *at, bool loops, const double *y,
                          weft__drift *to)
{
    const size_t level = weft__tile_level(weft__nodes_of(at)), n = at->points;
    for (size_t i = 0; i < weft__tile_count(at); ++i) {
        weft__range range = { NULL, y, n, n, { 0, 0 }, NULL, 0 };
        size_t more[2];
        if (at->surface == NULL) {
            (loops ? weft__drift_loops : at->drift)(at, NULL, y, level, i, i + 1, to);
            continue;
        }
        weft__patch_points(at->surface, level, true, i, range.run, more);
        range.more = at->surface->tile_point + more[0];
        range.count = more[1] - more[0];
        (loops ? weft__range_loops : at->range)(&range, &to[i]);
    }
}

static void expect_same_bounds(const weft__self *at, double *y)
{
    const size_t n = at->points, count = weft__tile_count(at);
    weft__drift tiles[2][4];
    ck_assert_uint_eq(count, at->surface != NULL ? 3 : 4);
    const weft__range whole = { NULL, y, n, n, { 0, n }, NULL, 0 };
    weft__range_loops(&whole, tiles[0]);
    ck_assert_double_eq(weft__extent(at, NULL, y),
                        weft__drift_extent(&tiles[0][0], &tiles[0][0]));
    drift_patches(at, false, y, tiles[0]);
    drift_patches(at, true, y, tiles[1]);
    for (size_t i = 0; i < 3 * count; ++i) { /* vectors may reach beyond a tile */
        ck_assert_double_le(tiles[0][i / 3].low[i % 3], tiles[1][i / 3].low[i % 3]);
        ck_assert_double_ge(tiles[0][i / 3].high[i % 3], tiles[1][i / 3].high[i % 3]);
    }
    for (size_t size = 1; size < 20; ++size) {
        const weft__range range = { y + 3 * n, y, n, n - 30, { 3, 3 + size }, NULL, 0 };
        at->range(&range, tiles[0]);
        weft__range_loops(&range, tiles[1]);
        ck_assert_mem_eq(tiles[0], tiles[1], sizeof tiles[0][0]);
    }
    const double kept = y[n + 3];
    y[n + 3] = NAN;
    ck_assert_double_infinite(weft__extent(at, NULL, y));
    drift_patches(at, false, y, tiles[0]);
    drift_patches(at, true, y, tiles[1]);
    ck_assert_double_infinite(weft__drift_extent(&tiles[0][0], &tiles[0][count - 1]));
    ck_assert_double_infinite(weft__drift_extent(&tiles[1][0], &tiles[1][count - 1]));
    y[n + 3] = kept;
}

/* Laws of friction, exponents, grids and triangles; numbers of pairs that fill no
 * vector. */
START_TEST(pairs_have_the_bits_of_the_plain_loops)
{
    static pair_list lists[KINDS];
    static double y[6 * 16 * 11];
    weft_cloth *cloth
        = self_cloth(_i % 2 == 0 ? WEFT_FRICTION_SMOOTH : WEFT_FRICTION_COULOMB,
                     _i / 2 % 2 == 0 ? 4 : 7, _i >= 4);
    lie_askew(cloth, y, weft_cloth_particles(cloth));
    const weft__quadtree tree = weft__tree_of(&cloth->self, y);
    for (size_t kind = 0; kind < KINDS; ++kind) {
        lists[kind].count = 0;
        lists[kind].law = weft__self_law_of(&cloth->self);
    }
    ck_assert(weft__each_pair(&tree, 0.03, keep_pair, lists));
    for (size_t i = 0; i < KINDS * (form_count() - 1); ++i) {
        (void)choose(cloth, i / KINDS + 1);
        pair_list *of = &lists[i % KINDS];
        const weft__pair_kind kind = (weft__pair_kind)(i % KINDS);
        size_t found = 0;
        for (size_t count = 0; count <= of->count; count += count < 20 ? 1 : 97) {
            const weft__near near = near_of(of, count);
            expect_same_pushes(&cloth->self, kind, &near, count, y, &of->law, &found);
        }
        ck_assert_uint_gt(found, 50);
        expect_same_waits(&cloth->self, kind, of, y);
        expect_gaps_of_single_pairs(&cloth->self, kind, of, y);
        expect_those_within(&cloth->self);
        ck_assert_uint_gt(expect_those_that_push(&cloth->self, kind, of, y), 10);
        expect_same_bounds(&cloth->self, y);
    }
    weft_cloth_destroy(cloth);
}
END_TEST

TEST_SUITE(kernel)
{
    Suite *suite = suite_create("kernel");
    TCase *tcase = tcase_create("kernel");
    tcase_set_timeout(tcase, 60);
    tcase_add_test(tcase, every_level_and_width_has_the_bits_of_the_plain_loops);
    tcase_add_test(tcase, every_level_finds_the_same_paths_clear);
    tcase_add_test(tcase, products_have_the_bits_of_the_plain_loops_on_every_level);
    tcase_add_test(
        tcase, several_directions_and_a_number_in_one_sweep_have_the_bits_of_the_loops);
    tcase_add_test(tcase, rates_are_forces_by_masses);
    tcase_add_test(tcase, runs_of_blocks_have_the_bits_of_the_whole);
    tcase_add_test(tcase, rates_have_the_same_bits_at_every_address);
    tcase_add_test(tcase, every_level_refuses_whatever_is_not_finite);
    tcase_add_test(tcase, sheet_at_rest_feels_gravity_alone_exactly);
    tcase_add_test(tcase, level_is_the_fastest_or_the_one_asked_for);
    tcase_add_loop_test(tcase, pairs_have_the_bits_of_the_plain_loops, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
