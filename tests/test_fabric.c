/* SPDX-License-Identifier: BSD-3-Clause */
/* test_fabric.c -- measured fabrics: the springs that they make have their moduli on
 * every grid. */
#include <math.h>

#include "cloth/model.h"
#include "scene_load.h"

#define G    9.81
#define MOST 36 /* particles */

enum { SHEET = 17 * 17 }; /* particles of the largest sheets that settle */

/* The black denim of the presets, measured; its springs below were computed by hand. */
static const weft_fabric denim = { .density = 0.324,
                                   .stretch = { 411.0, 2028.0 },
                                   .shear = 53.4,
                                   .bend = { 24.3e-6, 16e-6 },
                                   .twist = -1.0,
                                   .damping = { 1e-5, 1e-2 } };

static weft_error err;

static weft_cloth_def grid(size_t rows, size_t cols, double along, double across)
{
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = rows, def.cols = cols;
    def.spacing[0] = along, def.spacing[1] = across;
    return def;
}

static weft_cloth_def made(const weft_fabric *fabric, size_t rows, size_t cols,
                           double along, double across)
{
    weft_cloth_def def = grid(rows, cols, along, across);
    ck_assert_msg(weft_fabric_apply(fabric, &def, &err) == WEFT_OK, "%s", err.message);
    return def;
}

static void near(double value, double expected, double relative)
{
    ck_assert_msg(fabs(value - expected) <= relative * fabs(expected),
                  "%.15g, not %.15g", value, expected);
}

START_TEST(springs_are_those_of_the_formula)
{
    const weft_cloth_def def = made(&denim, 5, 7, 0.1, 0.15);
    const weft_spring_def *stretch = &def.springs[WEFT_STRETCH];
    const weft_spring_def *across = &def.across[WEFT_STRETCH];
    const weft_spring_def *shear = &def.springs[WEFT_SHEAR];
    ck_assert(def.density == 0.324 && def.mass == 0.0 && def.rim_half);
    ck_assert(def.law == WEFT_LAW_HOOKE && across->present
              && !def.across[WEFT_SHEAR].present);
    near(stretch->stiffness, 580.9, 1e-4);
    near(across->stiffness, 1271.9, 1e-4);
    near(shear->stiffness, 57.85, 1e-4);
    near(stretch->damping, 580.9e-5, 1e-4);
    near(across->damping, 1271.9e-5, 1e-4);
    near(shear->damping, 57.85e-5, 1e-4);
    ck_assert(!def.springs[WEFT_BEND].present);
    ck_assert(def.bending.rigidity[0] == 24.3e-6 && def.bending.rigidity[1] == 16e-6);
    ck_assert(def.bending.twist < 0.0 && def.bending.damping == 1e-2);
}
END_TEST

START_TEST(chains_have_a_width_of_one_metre)
{
    const weft_fabric fabric
        = { .density = 0.2, .stretch = { 100.0, 300.0 }, .shear = 20.0 };
    weft_cloth_def def = made(&fabric, 5, 1, 0.1, 7.0);
    near(def.springs[WEFT_STRETCH].stiffness, 1000.0, 1e-15);
    ck_assert(!def.springs[WEFT_SHEAR].present);
    near(weft_fabric_of(&def).stretch[0], 100.0, 1e-12);
    def = made(&fabric, 1, 5, 7.0, 0.1);
    near(def.across[WEFT_STRETCH].stiffness, 3000.0, 1e-15);
    near(weft_fabric_of(&def).stretch[1], 300.0, 1e-12);
}
END_TEST

/* [J] of small strain, warp, weft and shear, of the whole cloth at rest: u K u / 2. */
static double quadratic_energy(const weft_cloth_def *def, const double strain[3])
{
    weft_cloth *cloth = test_cloth(def);
    const size_t n = weft_cloth_particles(cloth);
    double y[6 * MOST] = { 0 }, u[6 * MOST] = { 0 }, out[6 * MOST], energy = 0.0;
    weft_cloth_start(cloth, y);
    for (size_t i = 0; i < n; ++i) {
        const double across = y[i], along = -y[n + i];
        u[i] = strain[1] * across + 0.5 * strain[2] * along;
        u[n + i] = -(strain[0] * along + 0.5 * strain[2] * across);
    }
    ck_assert_int_eq(weft_cloth_jacobian_product(cloth, 0.0, y, u, out), 0);
    for (size_t j = 0; j < 2 * n; ++j) {
        energy -= 0.5 * weft_cloth_particle_mass(cloth, j % n) * u[j] * out[3 * n + j];
    }
    weft_cloth_destroy(cloth);
    return energy;
}

START_TEST(homogeneous_strain_has_the_energy_of_the_fabric_on_every_grid)
{
    static const double strains[][3]
        = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 },  { 0.0, 0.0, 1.0 },
            { 1.0, 1.0, 0.0 }, { 1.0, -0.5, 0.7 }, { 0.2, 1.0, -2.0 } };
    const double *c = denim.stretch, g = denim.shear;
    for (size_t rows = 2; rows <= 6; ++rows) {
        for (size_t cols = 2; cols <= 5; ++cols) {
            const weft_cloth_def def = made(&denim, rows, cols, 0.1, 0.15);
            const double area = 0.1 * (double)(rows - 1) * 0.15 * (double)(cols - 1);
            for (size_t s = 0; s < sizeof strains / sizeof strains[0]; ++s) {
                const double *e = strains[s];
                const double exact = 0.5 * area
                                     * (c[0] * e[0] * e[0] + c[1] * e[1] * e[1]
                                        + g * (2.0 * e[0] * e[1] + e[2] * e[2]));
                near(quadratic_energy(&def, e), exact, 1e-12);
            }
            const weft_fabric back = weft_fabric_of(&def);
            near(back.stretch[0], c[0], 1e-12);
            near(back.stretch[1], c[1], 1e-12);
            near(back.shear, g, 1e-12);
        }
    }
}
END_TEST

START_TEST(full_rim_makes_coarse_grids_stiffer)
{
    weft_cloth_def def = made(&denim, 2, 2, 0.1, 0.1);
    def.rim_half = false;
    near(weft_fabric_of(&def).stretch[0], 768.6, 1e-4);
    near(2.0 * quadratic_energy(&def, (double[]){ 1.0, 0.0, 0.0 }), 7.686, 1e-4);
    def = made(&denim, 3, 5, 0.1, 0.1);
    def.rim_half = false;
    near(weft_fabric_of(&def).stretch[0], 500.4, 1e-4);
}
END_TEST

/* Bend springs stretch as well. */
START_TEST(moduli_are_those_of_any_springs)
{
    weft_cloth_def def = grid(4, 5, 0.1, 0.07);
    for (size_t f = 0; f < WEFT_FAMILIES; ++f) {
        def.springs[f]
            = (weft_spring_def){ .present = true, .stiffness = 10.0 * (double)(f + 1) };
    }
    for (int i = 0; i < 4; ++i) {
        def.law = i & 1 ? WEFT_LAW_STRAIN : WEFT_LAW_HOOKE;
        def.rim_half = i & 2;
        const weft_fabric of = weft_fabric_of(&def);
        const double area = 0.3 * 0.28, e[3] = { 1.0, 0.5, -2.0 };
        near(quadratic_energy(&def, e),
             0.5 * area
                 * (of.stretch[0] + 0.25 * of.stretch[1] + of.shear * (1.0 + 4.0)),
             1e-12);
    }
}
END_TEST

/* Without shear each column carries itself, and stretches by density g L^2 / (2 C). */
START_TEST(hanging_sheet_stretches_by_the_same_on_every_grid)
{
    const weft_fabric fabric = { .density = 0.2, .stretch = { 100.0, 100.0 } };
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    for (size_t n = 2; n <= 6; ++n) {
        const double h = 1.0 / (double)(n - 1);
        weft_cloth_def def = made(&fabric, n, n, h, h);
        double y[6 * MOST], dydt[6 * MOST];
        def.pins = &top, def.pin_count = 1;
        weft_cloth *cloth = test_cloth(&def);
        weft_cloth_start(cloth, y);
        for (size_t i = 0; i < n * n; ++i) {
            const double s = (double)(i / n) * h; /* rho g (L s - s^2 / 2) / C */
            y[n * n + i] -= 0.2 * G * (s - 0.5 * s * s) / 100.0;
        }
        near(-1.0 - y[2 * n * n - 1], 0.00981, 1e-12);
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
        for (size_t j = 3 * n * n; j < 6 * n * n; ++j) {
            ck_assert_double_le(fabs(dydt[j]), 1e-9);
        }
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* Semi-implicit Euler of a damped motion, until it rests; `rate` [1/s]. */
static weft_cloth *settled(weft_cloth_def def, double rate, double step, double *y)
{
    enum { STEPS = 15000 };
    static double dydt[6 * SHEET];
    const size_t n = def.rows * def.cols;
    def.damping = rate * 0.2 / (double)((def.rows - 1) * (def.cols - 1));
    weft_cloth *cloth = test_cloth(&def);
    weft_cloth_start(cloth, y);
    for (int i = 0; i < STEPS; ++i) {
        ck_assert_int_eq(weft_cloth_rhs(cloth, 0.0, y, dydt), 0);
        for (size_t j = 3 * n; j < 6 * n; ++j) {
            y[j] += step * dydt[j];
            y[j - 3 * n] += step * y[j];
        }
    }
    return cloth;
}

/* With shear the pinned row keeps the sheet from contracting: values of an independent
 * solver. Gravity has pulled straight what could buckle. */
START_TEST(hanging_sheet_with_shear)
{
    static const struct {
        size_t side;
        double middle, corner; /* [m] */
    } known[] = { { 5, 0.010158801678, 0.009928091636 },
                  { 9, 0.010193071724, 0.009881848919 } };
    static double y[6 * SHEET];
    const weft_fabric fabric
        = { .density = 0.2, .stretch = { 100.0, 100.0 }, .shear = 20.0 };
    const weft_pin top = { .rows = { 0, 0 }, .cols = { 0, -1 } };
    for (size_t k = 0; k < 2; ++k) {
        const size_t side = known[k].side, n = side * side;
        const double h = 1.0 / (double)(side - 1);
        weft_cloth_def def = made(&fabric, side, side, h, h);
        def.pins = &top, def.pin_count = 1;
        weft_cloth *cloth = settled(def, 8.0, 0.016 * h, y);
        near(-1.0 - y[2 * n - 1 - side / 2], known[k].middle, 1e-9);
        near(-1.0 - y[2 * n - 1], known[k].corner, 1e-9);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* Level, all four edges pinned: how far the middle sags, by an independent solver. */
START_TEST(pinned_sheet_sags)
{
    static const struct {
        size_t side;
        double sag; /* [m] */
    } known[]
        = { { 5, 0.077003488251 }, { 9, 0.075781400332 }, { 17, 0.075486993681 } };
    static double y[6 * SHEET];
    const weft_fabric fabric = { .density = 0.2,
                                 .stretch = { 100.0, 150.0 },
                                 .shear = 20.0,
                                 .bend = { 1e-5, 2e-5 },
                                 .twist = -1.0 };
    const weft_pin edges[] = { { .rows = { 0, 0 }, .cols = { 0, -1 } },
                               { .rows = { -1, -1 }, .cols = { 0, -1 } },
                               { .rows = { 0, -1 }, .cols = { 0, 0 } },
                               { .rows = { 0, -1 }, .cols = { -1, -1 } } };
    for (size_t k = 0; k < 3; ++k) {
        const size_t side = known[k].side, n = side * side;
        const double h = 1.0 / (double)(side - 1);
        weft_cloth_def def = made(&fabric, side, side, h, h);
        def.down[1] = 0.0, def.down[2] = 1.0;
        def.pins = edges, def.pin_count = 4;
        weft_cloth *cloth = settled(def, 20.0, 0.016 * h, y);
        near(-y[n + n / 2], known[k].sag, 1e-10);
        weft_cloth_destroy(cloth);
    }
}
END_TEST

/* ---- errors, presets --------------------------------------------------------------
 */

static void refused(weft_fabric fabric, double along, double across, const char *part)
{
    weft_cloth_def def = grid(4, 4, along, across), before = def;
    ck_assert_int_eq(weft_fabric_apply(&fabric, &def, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, part) != NULL, "%s", err.message);
    ck_assert(memcmp(&def, &before, sizeof def) == 0);
}

START_TEST(impossible_fabrics_are_refused)
{
    weft_fabric wrong = denim;
    refused(denim, 0.1, 0.03,
            "springs make this fabric for b / a from 0.360456 to 6.16256: ");
    refused(denim, 0.1, 0.7, "b / a = 7;");
    wrong.shear = 1000.0;
    refused(wrong, 0.1, 0.1, "no ratio of spacings makes this fabric");
    wrong = denim, wrong.density = 0.0;
    refused(wrong, 0.1, 0.1, "fabric: density 0 kg/m^2: must be > 0");
    wrong = denim, wrong.stretch[1] = 0.0;
    refused(wrong, 0.1, 0.1, "fabric: stretch 411, 0 N/m: must be > 0");
    wrong = denim, wrong.damping[1] = (double)NAN;
    refused(wrong, 0.1, 0.1, "fabric: damping 1e-05, nan s: must be >= 0");
    refused(denim, 0.1, 0.0, "spacing 0.1, 0 m: must be > 0");
}
END_TEST

START_TEST(bounds_of_the_ratio_are_possible)
{
    const weft_fabric square
        = { .density = 0.1, .stretch = { 20.0, 20.0 }, .shear = 20.0 };
    const weft_cloth_def def = made(&square, 3, 3, 0.1, 0.1);
    ck_assert(!def.springs[WEFT_STRETCH].present && def.springs[WEFT_SHEAR].present);
    near(weft_fabric_of(&def).stretch[0], 20.0, 1e-12);
}
END_TEST

START_TEST(printed_ends_of_the_ratio_are_possible)
{
    size_t count;
    const weft_fabric *presets = weft_fabric_presets(&count);
    for (const weft_fabric *of = presets; of < presets + count; ++of) {
        weft_cloth_def def = grid(4, 4, 0.01, 1.0);
        double least, most;
        ck_assert_int_eq(weft_fabric_apply(of, &def, &err), WEFT_INVALID);
        const char *ends = strstr(err.message, "b / a from");
        ck_assert(ends != NULL
                  && sscanf(ends, "b / a from %lf to %lf", &least, &most) == 2);
        near(least, sqrt(of->shear / of->stretch[0]), 1.1e-5);
        near(most, sqrt(of->stretch[1] / of->shear), 1.1e-5);
        (void)made(of, 4, 4, 0.01, 0.01 * least);
        (void)made(of, 4, 4, 0.01, 0.01 * most);
    }
}
END_TEST

START_TEST(presets_can_be_made_of_springs)
{
    size_t count;
    const weft_fabric *all = weft_fabric_presets(&count);
    ck_assert_uint_eq(count, 9);
    for (size_t i = 0; i < count; ++i) {
        const weft_fabric *of = &all[i];
        const double ratio
            = sqrt(sqrt(of->shear / of->stretch[0] * (of->stretch[1] / of->shear)));
        const weft_cloth_def def = made(of, 9, 9, 5e-3, 5e-3 * ratio);
        weft_cloth *cloth = test_cloth(&def);
        near(weft_fabric_of(&def).stretch[1], of->stretch[1], 1e-12);
        ck_assert_ptr_eq(weft_fabric_find(of->name), of);
        const double length = weft_fabric_length(of, 0, G);
        ck_assert(length > 12e-3 && length < 26e-3);
        weft_cloth_destroy(cloth);
    }
    ck_assert_ptr_null(weft_fabric_find("denim"));
}
END_TEST

START_TEST(peirce_length)
{
    const weft_fabric fabric = { .density = 0.2, .bend = { 2e-6, 0.0 } };
    near(weft_fabric_length(&fabric, 0, 10.0), 0.01, 1e-14);
    ck_assert(weft_fabric_length(&fabric, 1, 10.0) == 0.0);
    ck_assert(weft_fabric_length(&fabric, 0, 0.0) == 0.0);
}
END_TEST

START_TEST(shear_springs_have_no_pair)
{
    weft_cloth_def def = made(&denim, 3, 3, 0.1, 0.1);
    weft_cloth *cloth;
    def.across[WEFT_SHEAR].present = true;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(
        strstr(err.message, "shear springs along a row: they lie along"));
    def = made(&denim, 3, 3, 0.1, 0.1);
    def.across[WEFT_STRETCH].stiffness = -1.0;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
    ck_assert_ptr_nonnull(
        strstr(err.message, "stretch springs along a row: stiffness -1 "));
}
END_TEST

/* ---- scenes ------------------------------------------------------------------------
 */

#define GRID  "cloth:\n  grid: {rows: 4, cols: 5, spacing: [0.01, 0.012]}\n"
#define ENDED "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 1}\n"

/* The same springs and masses; the bending is compared by its numbers. */
static void same_cloth(const weft_cloth_def *a, const weft_cloth_def *b)
{
    weft_cloth *one = test_cloth(a), *other = test_cloth(b);
    ck_assert_uint_eq(weft__cloth_hash(one, NULL), weft__cloth_hash(other, NULL));
    ck_assert(memcmp(&a->bending, &b->bending, sizeof a->bending) == 0);
    weft_cloth_destroy(one);
    weft_cloth_destroy(other);
}

START_TEST(scene_has_the_cloth_of_the_interface)
{
    weft_scene *scene = good_text(
        GRID "  fabric: {density: 0.324, stretch: [411, 2028], shear: 53.4, bend: "
             "[2.43e-5, 1.6e-5], damping: [1.0e-5, 1.0e-2]}\n" ENDED);
    const weft_cloth_def def = made(&denim, 4, 5, 0.01, 0.012);
    same_cloth(weft_scene_cloth(scene), &def);
    ck_assert_ptr_null(weft_scene_fabric(scene)->name);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(keys_beside_a_preset_replace_its_values)
{
    weft_scene *scene = good_text(
        GRID "  fabric: {preset: gray-interlock, shear: 10, damping: 1.0e-4}\n" ENDED);
    weft_fabric fabric = *weft_fabric_find("gray-interlock");
    fabric.shear = 10.0;
    fabric.damping[0] = fabric.damping[1] = 1e-4;
    const weft_cloth_def def = made(&fabric, 4, 5, 0.01, 0.012);
    same_cloth(weft_scene_cloth(scene), &def);
    ck_assert_str_eq(weft_scene_fabric(scene)->name, "gray-interlock");
    weft_scene_destroy(scene);
}
END_TEST

/* Sheets of laboratories, converted by hand: 1 gf/cm = 0.980665 N/m; 500 gf/cm / 4 % =
 * 12258.3125 N/m; 0.7 gf/(cm degree) = 39.33157593 N/m; 100 gf/cm / 4 % = 2451.6625
 * N/m; 123 / 3 = 41 N/m; 0.18 kg/m^2 x 9.81 m/s^2 x (18 mm)^3 = 1.02981456e-5 N m. */
START_TEST(sheets_of_laboratories_are_in_their_own_units)
{
    static const struct {
        const char *text;
        weft_fabric fabric;
    } sheets[]
        = { { "kes: {LT: 0.6, WT: 12, RT: 50, EMT: [4, 5], G: [0.6, 0.8], 2HG: 1.1, "
              "2HG5: [2, 2.5], B: [0.1, 0.05], 2HB: 0.04, T: 0.5, W: 18}",
              { .stretch = { 12258.3125, 9806.65 },
                .shear = 39.33157593,
                .bend = { 9.80665e-6, 4.903325e-6 } } },
            { "fast: {E5: 0.2, E20: 1, E100: [4, 5], EB5: 3, C: [18, 16], T2: 0.6, "
              "T100: 0.5, W: 180}",
              { .stretch = { 2451.6625, 1961.33 },
                .shear = 41.0,
                .bend = { 1.02981456e-5, 7.2327168e-6 } } } };
    char text[512];
    (void)snprintf(text, sizeof text, GRID "  fabric: {%s, damping: 1.0e-5}\n" ENDED,
                   sheets[_i].text);
    weft_scene *scene = good_text(text);
    const weft_fabric *fabric = weft_scene_fabric(scene), *want = &sheets[_i].fabric;
    near(fabric->density, 0.18, 1e-15);
    near(fabric->shear, want->shear, 1e-9);
    near(fabric->coupling, want->shear, 1e-9);
    for (size_t way = 0; way < 2; ++way) {
        near(fabric->stretch[way], want->stretch[way], 1e-15);
        near(fabric->bend[way], want->bend[way], 1e-15);
        ck_assert_double_eq(fabric->damping[way], 1e-5);
    }
    near(weft_fabric_of(weft_scene_cloth(scene)).twist,
         sqrt(want->bend[0] * want->bend[1]), 1e-15);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(one_sheet_stands_instead_of_own_numbers)
{
    static const struct {
        const char *fabric, *found;
    } wrong[] = {
        { "kes: {EMT: 4, G: 1, B: 0.1, W: 18}, preset: royal-target",
          ":3:48: error: preset excludes kes (line 3, column 12)" },
        { "fast: {E100: 4, EB5: 3, C: 18, W: 180}, bend: 1.0e-5",
          ":3:52: error: bend excludes fast (line 3, column 12)" },
        { "kes: {EMT: 0, G: 1, B: 0.1, W: 18}",
          ":3:23: error: EMT must be a number > 0 [%], not '0'" },
        { "kes: {EMT: 4, G: 1, B: 0.1}",
          ":3:17: error: kes lacks the required key 'W' [mg/cm^2]" },
        { "fast: {E100: 4, EB5: 3, C: 18, W: 180, G: 41}",
          ":3:51: error: unknown key 'G' in fast" },
        { "shear: 3", "which is required without 'preset', 'kes', 'fast' or 'arcsim'" },
    };
    char text[512];
    (void)snprintf(text, sizeof text, GRID "  fabric: {%s}\n" ENDED, wrong[_i].fabric);
    const weft_scene_def def = scene_of_text(text);
    const char *message = bad_scene(&def);
    ck_assert_msg(strstr(message, wrong[_i].found) != NULL, "%s", message);
}
END_TEST

START_TEST(springs_of_a_scene_have_pairs_rim_and_rigidity)
{
    weft_scene *scene = good_text(
        GRID
        "  density: 0.2\n  springs:\n    stretch: {stiffness: [3, 4], damping: [0, "
        "1]}\n    shear: {stiffness: 2}\n    bend: {rigidity: [4.0e-5, 9.0e-5], "
        "damping: 0.5}\n    rim: half\n" ENDED);
    weft_cloth_def def = grid(4, 5, 0.01, 0.012);
    def.springs[WEFT_STRETCH] = (weft_spring_def){ .present = true, .stiffness = 3 };
    def.across[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 4, .damping = 1 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ .present = true, .stiffness = 2 };
    def.rim_half = true;
    def.bending = (weft_bending_def){ { 4e-5, 9e-5 }, -1.0, 0.5 };
    same_cloth(weft_scene_cloth(scene), &def);
    ck_assert_ptr_null(weft_scene_fabric(scene));
    ck_assert_double_eq(weft_fabric_of(weft_scene_cloth(scene)).twist, 6e-5);
    weft_scene_destroy(scene);
}
END_TEST

/* Spacing and fabric must fit: the error is at the one that was changed. */
START_TEST(misfit_is_reported_where_an_override_made_it)
{
    static const struct {
        const char *set, *found;
    } misfits[] = {
        { "cloth.grid.spacing=[0.01, 0.02]",
          "override cloth.grid.spacing:7: error: spacing [a, b] = [0.01, 0.02] m" },
        { "cloth.fabric.shear=100",
          "override cloth.fabric.shear:7: error: no ratio of spacings" },
    };
    weft_scene_def def
        = scene_of_text(GRID "  fabric: {preset: gray-interlock}\n" ENDED);
    const char *const *set = &misfits[_i].set;
    def.sets = set;
    def.set_count = 1;
    const char *message = bad_scene(&def);
    ck_assert_msg(strncmp(message, misfits[_i].found, strlen(misfits[_i].found)) == 0,
                  "%s", message);
}
END_TEST

TEST_SUITE(fabric)
{
    Suite *suite = suite_create("fabric");
    TCase *tcase = tcase_create("fabric");
    tcase_add_test(tcase, springs_are_those_of_the_formula);
    tcase_add_test(tcase, chains_have_a_width_of_one_metre);
    tcase_add_test(tcase,
                   homogeneous_strain_has_the_energy_of_the_fabric_on_every_grid);
    tcase_add_test(tcase, full_rim_makes_coarse_grids_stiffer);
    tcase_add_test(tcase, moduli_are_those_of_any_springs);
    tcase_add_test(tcase, hanging_sheet_stretches_by_the_same_on_every_grid);
    tcase_add_test(tcase, hanging_sheet_with_shear);
    tcase_add_test(tcase, pinned_sheet_sags);
    tcase_add_test(tcase, impossible_fabrics_are_refused);
    tcase_add_test(tcase, bounds_of_the_ratio_are_possible);
    tcase_add_test(tcase, printed_ends_of_the_ratio_are_possible);
    tcase_add_test(tcase, presets_can_be_made_of_springs);
    tcase_add_test(tcase, peirce_length);
    tcase_add_test(tcase, shear_springs_have_no_pair);
    tcase_add_test(tcase, scene_has_the_cloth_of_the_interface);
    tcase_add_test(tcase, keys_beside_a_preset_replace_its_values);
    tcase_add_loop_test(tcase, sheets_of_laboratories_are_in_their_own_units, 0, 2);
    tcase_add_loop_test(tcase, one_sheet_stands_instead_of_own_numbers, 0, 6);
    tcase_add_test(tcase, springs_of_a_scene_have_pairs_rim_and_rigidity);
    tcase_add_loop_test(tcase, misfit_is_reported_where_an_override_made_it, 0, 2);
    suite_add_tcase(suite, tcase);
    return suite;
}
