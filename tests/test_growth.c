/* SPDX-License-Identifier: BSD-3-Clause */
/* test_growth.c -- structs of programs that were built against another version. */
#include <stddef.h>
#include <string.h>

#include "support.h"

#define COUNT(a) (sizeof(a) / sizeof(a)[0])

enum { ROOM = 2048, TAIL = 32 };

static weft_error err;

/* ---- definitions ----------------------------------------------------------------- */

typedef union any_def {
    weft_cloth_def cloth;
    weft_registry_def registry;
    weft_scene_def scene;
    weft_sim_def sim;
    unsigned char bytes[ROOM];
} any_def;

static void begin_cloth(any_def *def, size_t size)
{
    weft_cloth_def_init(&def->cloth, size);
    def->cloth.load_size = sizeof(weft_load);
    def->cloth.pin_size = sizeof(weft_pin);
    def->cloth.shape_size = sizeof(weft_shape);
}

static weft_status make_cloth(const any_def *def)
{
    weft_cloth *cloth = NULL;
    const weft_status status = weft_cloth_create(&def->cloth, &cloth, &err);
    weft_cloth_destroy(cloth);
    return status;
}

static void begin_registry(any_def *def, size_t size)
{
    weft_registry_def_init(&def->registry, size);
}

static weft_status make_registry(const any_def *def)
{
    static int other;
    weft_registry *registry = (void *)&other;
    const weft_status status = weft_registry_create(&def->registry, &registry, &err);
    ck_assert(status == WEFT_OK || registry == NULL);
    weft_registry_destroy(registry);
    return status;
}

static void begin_scene(any_def *def, size_t size)
{
    static const char text[] = "weft: 1\n";
    weft_scene_def_init(&def->scene, size);
    def->scene.text = text;
    def->scene.length = sizeof text - 1;
}

/* The scene lacks all that it needs, which only one that is read can say. */
static weft_status make_scene(const any_def *def)
{
    weft_scene *scene;
    weft_diagnostics found;
    const weft_status status = weft_scene_load(&def->scene, &scene, &found, &err);
    return status == WEFT_BAD_SCENE ? WEFT_OK : status;
}

static weft_status make_sweep(const any_def *def)
{
    weft_sweep *sweep;
    weft_diagnostics found;
    const weft_status status = weft_sweep_load(&def->scene, &sweep, &found, &err);
    return status == WEFT_BAD_SCENE ? WEFT_OK : status;
}

static void begin_sim(any_def *def, size_t size)
{
    weft_sim_def_init(&def->sim, size);
    def->sim.method = test_method_named("verlet/velocity_verlet");
    def->sim.config.fixed_step = 1e-3;
}

static weft_status make_sim(const any_def *def)
{
    const weft_cloth_def cloth_def = weft_cloth_def_default();
    weft_cloth *cloth = test_cloth(&cloth_def);
    any_def own = *def;
    weft_sim *sim = (void *)&own;
    own.sim.cloth = cloth;
    const weft_status status = weft_sim_create(&own.sim, &sim, &err);
    ck_assert(status == WEFT_OK || sim == NULL);
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

/* The members from `unknown` on are those that an older program does not have. */
static const struct {
    const char *name;
    size_t size, unknown;
    void (*begin)(any_def *def, size_t size);
    weft_status (*make)(const any_def *def);
} kinds[] = {
    { "weft_cloth_def", sizeof(weft_cloth_def), offsetof(weft_cloth_def, bending),
      begin_cloth, make_cloth },
    { "weft_registry_def", sizeof(weft_registry_def),
      offsetof(weft_registry_def, installed), begin_registry, make_registry },
    { "weft_scene_def", sizeof(weft_scene_def), offsetof(weft_scene_def, find_plugin),
      begin_scene, make_scene },
    { "weft_scene_def", sizeof(weft_scene_def), offsetof(weft_scene_def, find_plugin),
      begin_scene, make_sweep },
    { "weft_sim_def", sizeof(weft_sim_def), offsetof(weft_sim_def, force), begin_sim,
      make_sim },
};

START_TEST(definition_of_an_older_program_is_read_so_far_as_it_reaches)
{
    any_def def;
    memset(def.bytes, 0xff, sizeof def.bytes);
    kinds[_i].begin(&def, kinds[_i].unknown);
    for (size_t k = kinds[_i].unknown; k < ROOM; ++k) {
        ck_assert_uint_eq(def.bytes[k], 0xff);
    }
    ck_assert_msg(kinds[_i].make(&def) == WEFT_OK, "%s", err.message);
}
END_TEST

START_TEST(definition_of_a_newer_program_must_be_zero_where_it_is_unknown)
{
    any_def def;
    char wanted[64];
    memset(def.bytes, 0xff, sizeof def.bytes);
    kinds[_i].begin(&def, kinds[_i].size + TAIL);
    ck_assert_msg(kinds[_i].make(&def) == WEFT_OK, "%s", err.message);
    def.bytes[kinds[_i].size + TAIL - 1] = 1;
    ck_assert_int_eq(kinds[_i].make(&def), WEFT_INVALID);
    (void)snprintf(wanted, sizeof wanted, "%s has members that this", kinds[_i].name);
    ck_assert_msg(strncmp(err.message, wanted, strlen(wanted)) == 0, "%s", err.message);
}
END_TEST

START_TEST(definition_not_from_its_default_is_refused)
{
    any_def def;
    char wanted[96];
    for (unsigned wrong = 0; wrong < 5; ++wrong) {
        const uint32_t sizes[] = { 0, 3, 20, 4097, UINT32_MAX };
        kinds[_i].begin(&def, kinds[_i].size);
        memcpy(def.bytes, &sizes[wrong], sizeof sizes[wrong]);
        ck_assert_int_eq(kinds[_i].make(&def), WEFT_INVALID);
        (void)snprintf(wanted, sizeof wanted,
                       "%s: struct_size is %u; start from %s_default()", kinds[_i].name,
                       (unsigned)sizes[wrong], kinds[_i].name);
        ck_assert_str_eq(err.message, wanted);
    }
}
END_TEST

START_TEST(config_grows_within_its_room)
{
    any_def def;
    const size_t config = offsetof(weft_sim_def, config_room);
    memset(def.bytes, 0xff, sizeof def.bytes);
    begin_sim(&def, sizeof def.sim);
    def.sim.config.struct_size = WEFT_STEPPER_CONFIG_LEAST;
    def.sim.config.threads = 1000000; /* unknown to the program: not read */
    ck_assert_int_eq(make_sim(&def), WEFT_OK);
    def.sim.config.threads = 0;
    /* a newer program's members, which are 0; a union's copy need not have them */
    memset(def.sim.config_room + sizeof def.sim.config, 0,
           sizeof def.sim.config_room - sizeof def.sim.config);
    def.sim.config.struct_size = sizeof def.sim.config_room;
    ck_assert_int_eq(make_sim(&def), WEFT_OK);
    def.bytes[config + sizeof def.sim.config_room - 1] = 1;
    ck_assert_int_eq(make_sim(&def), WEFT_INVALID);
    def.sim.config.struct_size = sizeof def.sim.config_room + 1;
    ck_assert_int_eq(make_sim(&def), WEFT_INVALID);
}
END_TEST

START_TEST(fabric_needs_all_that_it_writes)
{
    const weft_fabric fabric = { .density = 0.2, .stretch = { 100.0, 100.0 } };
    weft_cloth_def def = weft_cloth_def_default();
    ck_assert_int_eq(weft_fabric_apply(&fabric, &def, &err), WEFT_OK);
    def.struct_size = offsetof(weft_cloth_def, across);
    ck_assert_int_eq(weft_fabric_apply(&fabric, &def, &err), WEFT_INVALID);
}
END_TEST

/* ---- arrays ---------------------------------------------------------------------- */

typedef struct arrays {
    struct {
        weft_load known;
        double more;
    } loads[2];
    struct {
        weft_pin known;
        double more;
    } pins[2];
    struct {
        weft_shape known;
        double more;
    } shapes[2];
} arrays;

static weft_cloth_def of_arrays(arrays *of)
{
    weft_cloth_def def = weft_cloth_def_default();
    memset(of, 0, sizeof *of);
    for (size_t i = 0; i < 2; ++i) {
        const weft_range at = { (ptrdiff_t)i, (ptrdiff_t)i };
        of->loads[i].known
            = (weft_load){ .rows = at, .cols = at, .mass = 1.0 + (double)i };
        of->pins[i].known = (weft_pin){ .rows = at, .cols = at };
        of->shapes[i].known = weft_shape_default(WEFT_SPHERE);
        of->shapes[i].known.at[1] = -10.0 - (double)i;
    }
    def.loads = &of->loads[0].known, def.load_count = 2;
    def.pins = &of->pins[0].known, def.pin_count = 2;
    def.contact.shapes = &of->shapes[0].known, def.contact.shape_count = 2;
    def.load_size = sizeof of->loads[0];
    def.pin_size = sizeof of->pins[0];
    def.shape_size = sizeof of->shapes[0];
    return def;
}

START_TEST(arrays_are_read_in_steps_of_the_program)
{
    arrays of;
    const weft_cloth_def def = of_arrays(&of);
    weft_cloth *cloth = test_cloth(&def);
    const double lumped = weft_cloth_particle_mass(cloth, 1);
    ck_assert_double_eq(weft_cloth_particle_mass(cloth, 0), lumped + 1.0);
    ck_assert_double_eq(weft_cloth_particle_mass(cloth, 3), lumped + 2.0);
    ck_assert_uint_eq(weft_cloth_pins(cloth), 2);
    ck_assert(weft_cloth_pinned(cloth, 0) && weft_cloth_pinned(cloth, 3));
    ck_assert_double_eq(weft_cloth_shape(cloth, 1).at[1], -11.0);
    weft_cloth_destroy(cloth);
}
END_TEST

START_TEST(elements_of_a_newer_program_must_be_zero_where_they_are_unknown)
{
    arrays of;
    any_def def = { .cloth = of_arrays(&of) };
    double *const more[] = { &of.loads[1].more, &of.pins[1].more, &of.shapes[1].more };
    *more[_i] = 1.0;
    ck_assert_int_eq(make_cloth(&def), WEFT_INVALID);
    *more[_i] = 0.0;
    ck_assert_int_eq(make_cloth(&def), WEFT_OK);
}
END_TEST

START_TEST(elements_of_an_older_program_are_zero_where_it_ends)
{
    const size_t whole = sizeof(weft_pin), part = offsetof(weft_pin, velocity);
    unsigned char pins[2 * sizeof(weft_pin)];
    const weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    memset(pins, 0xff, sizeof pins); /* NaN where it must not be read */
    memcpy(pins, &pin, part);
    ck_assert_uint_lt(part, whole);
    def.pins = (const weft_pin *)(const void *)pins;
    def.pin_count = 1;
    def.pin_size = (uint32_t)part;
    weft_cloth *cloth = test_cloth(&def);
    ck_assert(weft_cloth_pinned(cloth, 0));
    weft_cloth_destroy(cloth);
    def.pin_size = 0;
    ck_assert_int_eq(weft_cloth_create(&def, &cloth, &err), WEFT_INVALID);
}
END_TEST

/* ---- arguments and results ------------------------------------------------------- */

static weft_cloth *cloth;
static weft_sim *sim;

static void begin(void)
{
    any_def def;
    const weft_cloth_def cloth_def = weft_cloth_def_default();
    cloth = test_cloth(&cloth_def);
    begin_sim(&def, sizeof def.sim);
    def.sim.cloth = cloth;
    ck_assert_int_eq(weft_sim_create(&def.sim, &sim, &err), WEFT_OK);
    ck_assert_int_eq(weft_sim_advance(sim, 0.01, &err), WEFT_OK);
}

static void end(void)
{
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

static void write_stats(void *out, size_t size)
{
    weft_sim_stats_sized(out, size, sim);
}

static void write_ledger(void *out, size_t size)
{
    weft_sim_ledger_sized(out, size, sim);
}

static void write_measures(void *out, size_t size)
{
    weft_sim_measure_sized(out, size, sim);
}

static void write_totals(void *out, size_t size)
{
    weft_sim_totals_sized(out, size, sim);
}

static void write_limit(void *out, size_t size)
{
    weft_sim_limit_stats_sized(out, size, sim);
}

static void write_failure(void *out, size_t size)
{
    ck_assert(!weft_sim_failure_sized(sim, out, size));
}

static void write_shape(void *out, size_t size)
{
    weft_shape_default_sized(out, size, WEFT_BOX);
}

static const struct {
    void (*write)(void *out, size_t size);
    size_t size;
} results[] = {
    { write_stats, sizeof(weft_stepper_stats) },
    { write_ledger, sizeof(weft_ledger) },
    { write_measures, sizeof(weft_measures) },
    { write_totals, sizeof(weft_totals) },
    { write_limit, sizeof(weft_limit_stats) },
    { write_failure, sizeof(weft_failure) },
    { write_shape, sizeof(weft_shape) },
};

START_TEST(results_are_written_so_far_as_the_program_has_room)
{
    const size_t size = results[_i].size, less = size / 2, more = size + TAIL;
    union {
        double align;
        unsigned char bytes[ROOM];
    } whole, part, wide;
    memset(&whole, 0xaa, sizeof whole);
    memset(&part, 0xaa, sizeof part);
    memset(&wide, 0xaa, sizeof wide);
    results[_i].write(&whole, size);
    results[_i].write(&part, less);
    results[_i].write(&wide, more);
    const size_t head = sizeof(uint32_t); /* struct_size of the statistics */
    ck_assert_mem_eq(part.bytes + head, whole.bytes + head, less - head);
    ck_assert_mem_eq(wide.bytes + head, whole.bytes + head, size - head);
    for (size_t k = less; k < ROOM; ++k) {
        ck_assert_uint_eq(part.bytes[k], 0xaa);
    }
    for (size_t k = size; k < ROOM; ++k) {
        ck_assert_uint_eq(wide.bytes[k], k < more ? 0 : 0xaa);
    }
}
END_TEST

static weft_status no_frame(void *ctx, size_t i, weft_error *why)
{
    (void)ctx, (void)i, (void)why;
    return WEFT_OK;
}

START_TEST(play_and_shape_follow_the_same_rule)
{
    static const weft_run_def run = { .duration = 1.0, .fps = 50.0 };
    struct {
        weft_play known;
        double more;
    } play = { .known = { .run = &run, .first = 1, .last = 2, .frame = no_frame } };
    struct {
        weft_shape known;
        double more;
    } shape = { .known = weft_shape_default(WEFT_SPHERE) };
    shape.known.at[1] = -10.0;
    ck_assert_int_eq(weft_sim_play_sized(sim, &play.known, sizeof play, &err), WEFT_OK);
    ck_assert_double_eq(weft_sim_time(sim), 0.04);
    play.more = 1.0;
    ck_assert_int_eq(weft_sim_play_sized(sim, &play.known, sizeof play, &err),
                     WEFT_INVALID);
    play.known.first = 2; /* and without `step` and its ctx: */
    ck_assert_int_eq(
        weft_sim_play_sized(sim, &play.known, offsetof(weft_play, step), &err),
        WEFT_OK);
    ck_assert_int_eq(
        weft_sim_add_shape_sized(sim, &shape.known, sizeof shape, NULL, &err), WEFT_OK);
    shape.more = 1.0;
    ck_assert_int_eq(
        weft_sim_add_shape_sized(sim, &shape.known, sizeof shape, NULL, &err),
        WEFT_INVALID);
    shape.known.friction = (double)NAN; /* behind what an older program has */
    ck_assert_int_eq(weft_sim_add_shape_sized(
                         sim, &shape.known, offsetof(weft_shape, friction), NULL, &err),
                     WEFT_OK);
    ck_assert_double_eq(weft_cloth_shape(weft_sim_cloth(sim), 1).friction, -1.0);
    ck_assert_uint_eq(weft_cloth_shapes(weft_sim_cloth(sim)), 2);
}
END_TEST

TEST_SUITE(growth)
{
    Suite *suite = suite_create("growth");
    TCase *tcase = tcase_create("core"), *running = tcase_create("running");
    tcase_add_checked_fixture(running, begin, end);
    suite_add_tcase(suite, tcase);
    suite_add_tcase(suite, running);
    tcase_add_loop_test(tcase,
                        definition_of_an_older_program_is_read_so_far_as_it_reaches, 0,
                        COUNT(kinds));
    tcase_add_loop_test(tcase,
                        definition_of_a_newer_program_must_be_zero_where_it_is_unknown,
                        0, COUNT(kinds));
    tcase_add_loop_test(tcase, definition_not_from_its_default_is_refused, 0,
                        COUNT(kinds));
    tcase_add_test(tcase, config_grows_within_its_room);
    tcase_add_test(tcase, fabric_needs_all_that_it_writes);
    tcase_add_test(tcase, arrays_are_read_in_steps_of_the_program);
    tcase_add_loop_test(
        tcase, elements_of_a_newer_program_must_be_zero_where_they_are_unknown, 0, 3);
    tcase_add_test(tcase, elements_of_an_older_program_are_zero_where_it_ends);
    tcase_add_loop_test(running, results_are_written_so_far_as_the_program_has_room, 0,
                        COUNT(results));
    tcase_add_test(running, play_and_shape_follow_the_same_rule);
    return suite;
}
