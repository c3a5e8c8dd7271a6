/* SPDX-License-Identifier: BSD-3-Clause */
/* What was saved of another definition is not restored: nothing would tell that it is
 * not the same motion that goes on. */
#include "saved_sim.h"

/* A simulation of that definition, saved to `again`. */
static void save_defined(const weft_sim_def *def)
{
    weft_sim *made = make(def);
    save(made, again);
    weft_sim_destroy(made);
}

static weft_sim_def same_definition(const weft_cloth *of)
{
    return define(of, test_method_named("verlet/velocity_verlet"),
                  (kind){ true, true });
}

/* Each of the following differs in one thing from `sim`. What `again` has is refused
 * for that reason, or restored: the last of a row of differences is none. */
static void compared(bool differs, const char *reason)
{
    const size_t size = weft_sim_save_size(sim);
    if (differs) {
        refused(size, reason);
    } else {
        ck_assert_int_eq(weft_sim_restore(sim, again, size, &err), WEFT_OK);
    }
}

START_TEST(every_other_cloth_is_refused)
{
    enum {
        STIFFNESS,
        WEFT,
        WEFT_DAMPING,
        RIM,
        DAMPING,
        PRESENCE,
        REST,
        MASS,
        HELD,
        SPEED,
        SWING,
        GRAVITY,
        DRAG,
        WIND,
        WIND_DRAG,
        WIND_TABLE,
        PATH,
        DIFFERENCES
    };
    for (int i = 0; i <= DIFFERENCES; ++i) {
        static const weft_load load
            = { .rows = { 1, 1 }, .cols = { 1, 1 }, .mass = 1e-6 };
        weft_pin pins[2] = { 0 };
        weft_cloth_def def = cloth_definition(ROWS);
        memcpy(pins, def.pins, sizeof pins);
        def.pins = pins;
        def.springs[WEFT_STRETCH].stiffness += i == STIFFNESS ? 1e-9 : 0.0;
        def.across[WEFT_STRETCH].present = i == WEFT || i == WEFT_DAMPING;
        def.across[WEFT_STRETCH].stiffness
            = def.springs[WEFT_STRETCH].stiffness + (i == WEFT ? 1e-9 : 0.0);
        def.across[WEFT_STRETCH].damping
            = def.springs[WEFT_STRETCH].damping + (i == WEFT_DAMPING ? 1e-9 : 0.0);
        def.rim_half = i == RIM;
        def.springs[WEFT_SHEAR].damping += i == DAMPING ? 1e-9 : 0.0;
        def.springs[WEFT_SHEAR].present = i != PRESENCE;
        def.spacing[0] += i == REST ? 1e-9 : 0.0;
        def.loads = &load;
        def.load_count = i == MASS ? 1 : 0;
        pins[0].cols.last += i == HELD ? 1 : 0;
        pins[1].velocity[0] += i == SPEED ? 1e-9 : 0.0;
        pins[1].amplitude[1] = i == SWING ? 0.01 : 0.0;
        pins[1].frequency = i == SWING ? 1.0 : 0.0;
        def.gravity[0] += i == GRAVITY ? 1e-9 : 0.0;
        def.damping += i == DRAG ? 1e-9 : 0.0;
        def.wind_velocity[1] += i == WIND ? 1e-9 : 0.0;
        def.wind_drag += i == WIND_DRAG ? 1e-9 : 0.0;
        def.wind_table.count -= i == WIND_TABLE ? 1 : 0;
        pins[1].path.count -= i == PATH ? 1 : 0;
        weft_cloth *other = test_cloth(&def);
        const weft_sim_def other_sim = same_definition(other);
        save_defined(&other_sim);
        compared(i < DIFFERENCES, "saved of another cloth");
        weft_cloth_destroy(other);
    }
}
END_TEST

/* Where it starts from is part of the state. */
START_TEST(a_cloth_that_starts_elsewhere_is_the_same)
{
    weft_cloth_def def = cloth_definition(ROWS);
    def.scale = 0.9;
    def.velocity[1] = 0.3;
    def.gravity[2] = -0.0;
    weft_cloth *other = test_cloth(&def);
    const weft_sim_def other_sim = same_definition(other);
    save_defined(&other_sim);
    ck_assert_int_eq(weft_sim_restore(sim, again, weft_sim_save_size(sim), &err),
                     WEFT_OK);
    weft_cloth_destroy(other);
}
END_TEST

static bool leave(void *ctx, double t, double h, double *y)
{
    (void)ctx, (void)t, (void)h, (void)y;
    return false;
}

START_TEST(other_settings_are_refused)
{
    enum {
        STEP,
        STRAIN,
        TOLERANCE,
        SWEEPS,
        FAMILY,
        SOLVER,
        POSITIONS,
        LIMIT,
        NO_LIMIT,
        FORCE,
        CORRECT,
        DIFFERENCES
    };
    for (int i = 0; i <= DIFFERENCES; ++i) {
        weft_sim_def def = same_definition(cloth);
        def.config.fixed_step *= i == STEP ? 1.0 + 1e-12 : 1.0;
        def.limit.strain += i == STRAIN ? 1e-9 : 0.0;
        def.limit.tolerance *= i == TOLERANCE ? 0.5 : 1.0;
        def.limit.sweeps += i == SWEEPS ? 1 : 0;
        def.limit.families[WEFT_BEND] = i == FAMILY;
        def.limit.solver = i == SOLVER ? WEFT_LIMIT_SWEEP : WEFT_LIMIT_FAST;
        def.limit.keep_velocity = i == POSITIONS;
        def.limit.method = i == LIMIT      ? WEFT_LIMIT_BRIDSON
                           : i == NO_LIMIT ? WEFT_LIMIT_NONE
                                           : def.limit.method;
        def.force = i == FORCE ? NULL : def.force;
        def.correct = i == CORRECT ? leave : NULL;
        save_defined(&def);
        compared(i < DIFFERENCES, "saved under other settings");
    }
}
END_TEST

/* Of error control, and of a table of one's own. */
START_TEST(other_tolerances_and_tables_are_refused)
{
    static const double a[] = { 0.0, 0.0, 1.0, 0.0 }, b[] = { 0.5, 0.5 };
    static const double c[] = { 0.0, 1.0 }, early[] = { 1.0, 0.0 },
                        late[] = { 0.0, 1.0 };
    static const double half[] = { 0.0, 0.0, 0.5, 0.0 }, middle[] = { 0.0, 0.5 };
    const weft_butcher heun = { 2, 2, 1, a, b, c, early };
    const weft_butcher other = { 2, 2, 1, a, b, c, late };
    const weft_butcher midpoint = { 2, 2, 1, half, late, middle, early };
    enum {
        RTOL,
        POSITION,
        VELOCITY,
        NORM,
        FIRST,
        LEAST,
        MOST_STEP,
        CONTROL,
        SAFETY,
        EMBEDDED,
        TABLE,
        DIFFERENCES
    };
    const weft_controller plain = { .type = WEFT_CONTROLLER_PI };
    const weft_controller safer = { .type = WEFT_CONTROLLER_PI, .safety = 0.8 };
    weft_sim_def def
        = define(cloth, test_method_named("arkode/custom"), (kind){ false, false });
    def.config.controller = &plain;
    def.config.butcher = &heun;
    weft_sim_destroy(sim);
    sim = make(&def);
    for (int i = 0; i <= DIFFERENCES; ++i) {
        weft_sim_def differing = def;
        weft_stepper_config *config = &differing.config;
        config->rtol *= i == RTOL ? 0.5 : 1.0;
        config->atol_position *= i == POSITION ? 0.5 : 1.0;
        config->atol_velocity *= i == VELOCITY ? 0.5 : 1.0;
        config->norm = i == NORM ? WEFT_NORM_RMS : WEFT_NORM_MAX;
        config->first_step *= i == FIRST ? 0.5 : 1.0;
        config->min_step *= i == LEAST ? 0.5 : 1.0;
        config->max_step = i == MOST_STEP ? 1.0 : config->max_step;
        config->controller = i == CONTROL ? NULL : i == SAFETY ? &safer : &plain;
        config->butcher = i == EMBEDDED ? &other : i == TABLE ? &midpoint : &heun;
        save_defined(&differing);
        compared(i < DIFFERENCES, "saved under other settings");
    }
}
END_TEST

START_TEST(threads_and_allocator_may_differ)
{
    const weft_allocator memory = { weft_malloc_resize, NULL };
    weft_sim_def def = same_definition(cloth);
    def.config.threads = 2;
    def.allocator = &memory;
    def.config.rtol = 0.5; /* which fixed steps do not look at */
    save_defined(&def);
    ck_assert_int_eq(weft_sim_restore(sim, again, weft_sim_save_size(sim), &err),
                     WEFT_OK);
}
END_TEST

TEST_SUITE(saved_definition)
{
    Suite *suite = suite_create("saved definition");
    TCase *tcase = tcase_create("definition");
    tcase_add_checked_fixture(tcase, begin_saved, end_saved);
    tcase_add_test(tcase, every_other_cloth_is_refused);
    tcase_add_test(tcase, a_cloth_that_starts_elsewhere_is_the_same);
    tcase_add_test(tcase, other_settings_are_refused);
    tcase_add_test(tcase, other_tolerances_and_tables_are_refused);
    tcase_add_test(tcase, threads_and_allocator_may_differ);
    suite_add_tcase(suite, tcase);
    return suite;
}
