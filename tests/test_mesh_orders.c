/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow nightly asan-long */
/* test_mesh_orders.c -- every method on a small flag of triangles with a membrane,
 * bending along arcs, damping, a rim that follows a path and wind that follows a table,
 * with a row where no step ends by itself: in fixed steps its error falls by its order,
 * and under tolerances with them. */
#include <math.h>

#include "meshes.h"
#include "study/conformance/oscillators.h"
#include "verify/verify.h"

#define DURATION 0.02  /* [s] */
#define FLOOR    1e-10 /* [m], [m/s] below which iterations leave as much, */
#define ROUNDOFF 5e-12 /* or where there are none roundoff is near */
#define LARGE    4e-3  /* above which an order is not seen yet */
#define NEAR     0.35  /* of an order */

enum { ROWS = 4, COLS = 5, SIZE = 6 * ROWS * COLS, MOST_STEPS = 512 };

static weft_registry *registry;
static test_mesh mesh;
static weft_cloth *flags[2], *cloth;
static double states[2][SIZE], *exact;

/* natural: the path begins and ends within the run, where its velocity jumps. */
static weft_cloth *make_flag(bool natural)
{
    static const size_t held[ROWS] = { 0, COLS, 2 * COLS, 3 * COLS };
    mesh_sheet(&mesh, ROWS, COLS, 0.05, MESH_RANDOM, 0.2, 3);
    mesh.fabrics[0].stretch[0] = mesh.fabrics[0].stretch[1] = 60.0;
    mesh.fabrics[0].shear = 15.0, mesh.fabrics[0].coupling = 5.0;
    mesh.fabrics[0].damping[0] = mesh.fabrics[0].damping[1] = 2e-3;
    mesh.fabrics[0].bend[0] = mesh.fabrics[0].bend[1] = 1e-3;
    mesh.fabrics[0].twist = 1e-3;
    mesh.def.arc = true;
    for (size_t i = 0; i < (size_t)ROWS * COLS; ++i) {
        mesh.start[3 * i + 2] = 0.4 * mesh.start[3 * i] * mesh.start[3 * i];
    }
    static const double at = 0.5141 * DURATION;
    const double path[]
        = { 0.0, 0.0, 0.0, 0.0, at, 2e-4, 0.0, -4e-4, 0.05, 0.0, 4e-4, 0.0 };
    const double begun[] = { 0.2171 * DURATION, 0.0, 0.0,  0.0, at, 2e-5, 0.0, -4e-5,
                             0.8713 * DURATION, 0.0, 4e-5, 0.0 };
    const double gust[]
        = { -0.02, 0.0, 0.0, 2.0, at, 3.0, 0.0, 2.0, 0.06, 0.0, 5.0, 0.0 };
    const weft_pin pin = { .vertices = held,
                           .vertex_count = ROWS,
                           .path = { natural ? begun : path, 3 },
                           .path_natural = natural };
    weft_cloth_def def = mesh_cloth(&mesh);
    def.pins = &pin, def.pin_count = 1, def.pin_size = sizeof pin;
    def.gravity[1] = -9.81;
    def.wind_table = (weft_table){ gust, 3 };
    def.wind_drag = 0.5;
    def.wind_table_natural = natural;
    weft_cloth *made = test_cloth(&def);
    mesh_free(&mesh);
    return made;
}

static void take_flag(size_t i)
{
    cloth = flags[i], exact = states[i];
}

/* The state after DURATION; false: it failed. */
static bool end_state(const weft_stepper_type *type, const weft_stepper_config *config,
                      double y[SIZE])
{
    weft_error err;
    weft_sim *sim = test_sim(cloth, type, config);
    const bool done = weft_sim_advance(sim, DURATION, &err) == WEFT_OK;
    memcpy(y, weft_sim_state(sim), SIZE * sizeof *y);
    weft_sim_destroy(sim);
    return done;
}

static double error_of(const weft_stepper_type *type, double step, double tolerance)
{
    static const weft_linear tight = { .struct_size = sizeof tight, .krylov = 1e-9 };
    double y[SIZE], most = 0.0;
    weft_stepper_config config = weft_stepper_config_default();
    if (step > 0.0) {
        config = weft__with_table(type, weft__fixed(step));
        if ((type->flags & (uint32_t)WEFT_STEPPER_LINEAR) != 0) {
            config.linear = &tight;
        }
    } else {
        config.rtol = config.atol_position = config.atol_velocity = tolerance;
    }
    if (!end_state(type, &config, y)) {
        return (double)INFINITY;
    }
    for (size_t j = 0; j < SIZE; ++j) {
        most = fmax(most, fabs(y[j] - exact[j]));
    }
    return most;
}

static void setup(void)
{
    weft_stepper_config config = weft_stepper_config_default();
    config.fixed_step = DURATION / 4096.0;
    for (size_t i = 0; i < 2; ++i) {
        flags[i] = make_flag(i == 1);
        take_flag(i);
        ck_assert(end_state(test_method_named("arkode/verner65"), &config, exact));
    }
}

static void teardown(void)
{
    weft_cloth_destroy(flags[0]);
    weft_cloth_destroy(flags[1]);
}

/* log2 of the ratio of errors with h and h / 2, for the finest steps that are not
 * roundoff and not coarse. */
static double measured(const weft_stepper_type *type)
{
    const uint32_t iterates = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_LINEAR;
    const double floor_of = (type->flags & iterates) != 0 ? FLOOR : ROUNDOFF;
    double before = (double)INFINITY, order = NAN;
    bool seen = false;
    for (int steps = 4; !seen && steps <= MOST_STEPS; steps *= 2) {
        const double error = error_of(type, DURATION / steps, 0.0);
        const bool fine = error < floor_of;
        if (before < LARGE && (!fine || isnan(order))) {
            order = log2(before / error);
        }
        seen = fine && !isnan(order);
        before = error;
    }
    return order;
}

START_TEST(every_method_has_its_order_on_a_flag_of_triangles)
{
    stepper_method m;
    ck_assert(method_at(registry, (size_t)_i / 2, &m));
    take_flag((size_t)_i % 2);
    if (!test_is_typical(m.type) && !weft_stepper_is(m.type, "rkc2")
        && !weft_stepper_is(m.type, "dormand_prince")) {
        return;
    }
    const int claimed = weft__order_claimed(m.type);
    const double order = claimed > 0 ? measured(m.type) : 0.0;
    ck_assert_msg(order >= claimed - NEAR, "%s %s: order %g", m.plugin->id,
                  m.type->name, order);
    if (weft__adapts(m.type)) {
        const double coarse = error_of(m.type, 0.0, 1e-5);
        const bool low = m.type->order == 1; /* many steps */
        const double fine = error_of(m.type, 0.0, low ? 1e-6 : 1e-8);
        ck_assert_msg(coarse <= VERIFY_ERROR_BOUND * 1e-5
                          && (fine <= (low ? 0.5 : 0.1) * coarse || fine <= FLOOR),
                      "%s %s: errors %g and %g", m.plugin->id, m.type->name, coarse,
                      fine);
    }
}
END_TEST

/* docs/reference/integrators.md lists them, and no other. */
START_TEST(methods_with_stages_outside_of_their_step_are_those_of_the_page)
{
    char page[1 << 16], line[160];
    FILE *file = fopen("docs/reference/integrators.md", "r");
    ck_assert_ptr_nonnull(file);
    page[fread(page, 1, sizeof page - 1, file)] = '\0';
    ck_assert_int_eq(fclose(file), 0);
    char *at = strstr(page, "## Stages outside of the step\n"), *next;
    ck_assert_ptr_nonnull(at);
    next = strstr(at + 1, "\n## ");
    ck_assert_ptr_nonnull(next);
    *next = '\0';
    stepper_method m;
    size_t listed = 0, found = 0;
    for (const char *row = at; (row = strstr(row, "` | ")) != NULL; ++row) {
        ++listed;
    }
    for (size_t k = 0; method_at(registry, k, &m); ++k) {
        weft_error err = { 0 };
        double range[2];
        ck_assert_msg(verify_stages_of(m.type, range, &err) == WEFT_OK, "%s %s: %s",
                      m.plugin->id, m.type->name, err.message);
        if (verify_stages_outside(range)) {
            (void)snprintf(line, sizeof line, "| %s | `%s` | %.2f | %.2f |\n",
                           m.plugin->id, m.type->name, range[0], range[1]);
            ck_assert_msg(strstr(at, line) != NULL, "the page lacks %s", line);
            ++found;
        }
    }
    ck_assert_uint_eq(listed, found);
}
END_TEST

TEST_SUITE(mesh_orders)
{
    Suite *suite = suite_create("orders on meshes");
    TCase *tcase = tcase_create("orders on meshes");
    stepper_method m;
    int methods = 0;
    registry = verify_registry();
    if (registry == NULL) {
        return NULL;
    }
    while (method_at(registry, (size_t)methods, &m)) {
        ++methods;
    }
    tcase_set_timeout(tcase, 120.0);
    tcase_add_test(tcase,
                   methods_with_stages_outside_of_their_step_are_those_of_the_page);
    tcase_add_unchecked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, every_method_has_its_order_on_a_flag_of_triangles, 0,
                        2 * methods);
    suite_add_tcase(suite, tcase);
    return suite;
}
