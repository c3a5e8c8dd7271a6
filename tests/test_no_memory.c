/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow alone */
/* test_no_memory.c -- memory runs out: at every single allocation of weft's and of
 * libyaml's, and with a heap of any size.
 *
 * GSL and SUNDIALS crash where some of their allocations fail
 * (gsl_odeiv2_control_scaled_new; ARKodeButcherTable_LoadERK, SUNContext_Create,
 * N_VClone), so the plugins ask first whether there is enough for all that follows.
 * Single allocations fail for plugin gsl alone, not for GSL, and not for the plugins
 * arkode and cvode, whose vectors allocate on behalf of N_VClone. */
#include <string.h>
#include <sys/stat.h>

#include "bodies.h"
#include "failing_malloc.h"
#include "study/conformance/oscillators.h"

#ifdef HAVE_GSL
#include <gsl/gsl_errno.h>
#endif

/* ---- scenes -----------------------------------------------------------------------
 */

static const char scene_text[]
    = "weft: 1\n"
      "name: all that allocates\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}\n"
      "  density: 0.3\n"
      "  loads: [{at: [1, 1], mass: 0.1}]\n"
      "  springs:\n"
      "    stretch: &a {stiffness: 50, damping: 0.01}\n"
      "    shear: *a\n"
      "  pins: [top-left, {at: top-right, velocity: [0.1, 0, 0]}]\n"
      "forces: {wind: {velocity: [0, 0, 1], drag: 0.1}}\n"
      "limit: {method: provot, strain: 0.1}\n"
      "record: {ledger: true}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

static const weft_plugin *find_linked(void *ctx, const char *id, weft_error *err)
{
    (void)ctx;
    (void)err;
    for (size_t i = 0; test_plugin(i) != NULL; ++i) {
        if (strcmp(test_plugin(i)->id, id) == 0) {
            return test_plugin(i);
        }
    }
    return NULL;
}

static weft_status run_scene(const weft_scene *scene, weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_status status = weft_cloth_create(weft_scene_cloth(scene), &cloth, err);
    if (status == WEFT_OK) {
        weft_sim_def def = weft_sim_def_default();
        def.cloth = cloth;
        def.method = weft_scene_method_type(scene);
        def.config = *weft_scene_config(scene);
        def.ledger = weft_scene_record(scene)->ledger;
        def.limit = *weft_scene_limit(scene);
        status = weft_sim_create(&def, &sim, err);
    }
    for (int i = 1; status == WEFT_OK && i <= 5; ++i) {
        status = weft_sim_advance(sim, i * 2e-3, err);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

static weft_diagnostics found;

static weft_status load_and_run(const void *ctx, weft_error *err)
{
    const weft_scene_def *def = ctx;
    weft_scene *scene = NULL;
    weft_status status = weft_scene_load(def, &scene, &found, err);
    if ((status == WEFT_OK) != (scene != NULL)) {
        abort();
    }
    if (status == WEFT_OK) {
        status = run_scene(scene, err);
    }
    weft_scene_destroy(scene);
    return status;
}

static weft_scene_def whole_scene(void)
{
    weft_scene_def def = weft_scene_def_default();
    def.file = "scene.yaml";
    def.text = scene_text;
    def.length = strlen(scene_text);
    def.find_plugin = find_linked;
    return def;
}

START_TEST(scene_load_and_run_survive_every_failing_allocation)
{
    const weft_scene_def def = whole_scene();
    (void)every_allocation_fails(load_and_run, &def, "scene");
}
END_TEST

START_TEST(overrides_survive_every_failing_allocation)
{
    static const char *const sets[]
        = { "cloth.pins.1.velocity=[0, 0.1, 0]", "cloth.springs.shear.stiffness=7",
            "limit=null", "forces.gravity=[0, -1, 0]" };
    weft_scene_def def = whole_scene();
    def.sets = sets;
    def.set_count = sizeof sets / sizeof sets[0];
    (void)every_allocation_fails(load_and_run, &def, "overrides");
}
END_TEST

START_TEST(contact_survives_every_failing_allocation)
{
    static const char *const sets[]
        = { "contact={self: true, shapes: [{shape: plane, at: [0, 0, -1], normal: [0, "
            "0, 1]}]}" };
    weft_scene_def def = whole_scene();
    def.sets = sets;
    def.set_count = sizeof sets / sizeof sets[0];
    (void)every_allocation_fails(load_and_run, &def, "contact");
}
END_TEST

static weft_status load_alone(const void *ctx, weft_error *err)
{
    weft_scene *scene = NULL;
    const weft_status status = weft_scene_load(ctx, &scene, &found, err);
    weft_scene_destroy(scene);
    return status;
}

/* A flat file without vt that is welded, and a material. */
START_TEST(files_of_a_cloth_survive_every_failing_allocation)
{
    static const char text[]
        = "weft: 1\ncloth:\n  mesh: {file: apart.obj, weld: 1.0e-3}\n"
          "  fabric: {arcsim: material.json}\n  pins: [{vertices: [3, 0]}]\n"
          "stepper: {plugin: gsl, method: rkf45}\nrun: {duration: 1.0e-3}\n";
    static const char *const files[][2] = {
        { BUILD_DIR "/tests/no-memory/apart.obj",
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1e-4\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 4 5 "
          "6\n" },
        { BUILD_DIR "/tests/no-memory/material.json",
          "{\"density\": 0.2, \"stretching\": [[9,1,9,2],[9,1,9,2],[9,1,9,2],"
          "[9,1,9,2],[9,1,9,2],[9,1,9,2]], \"bending\": [[1e-6,1e-6,1e-6,1e-6,1e-6],"
          "[1e-6,1e-6,1e-6,1e-6,1e-6],[1e-6,1e-6,1e-6,1e-6,1e-6]]}" },
    };
    (void)mkdir(BUILD_DIR "/tests/no-memory", 0777);
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i) {
        FILE *stream = fopen(files[i][0], "w");
        ck_assert_ptr_nonnull(stream);
        (void)fputs(files[i][1], stream);
        ck_assert_int_eq(fclose(stream), 0);
    }
    weft_scene_def def = whole_scene();
    def.file = BUILD_DIR "/tests/no-memory/scene.yaml";
    def.text = text;
    def.length = strlen(text);
    own_only = true; /* a stream without a buffer reads all the same */
    (void)every_allocation_fails(load_alone, &def, "files of a cloth");
    own_only = false;
}
END_TEST

/* A wrong scene is told to be wrong, or that memory ran out: not that it is right. */
static weft_status load_wrong(const void *ctx, weft_error *err)
{
    weft_scene *scene = NULL;
    const weft_status status = weft_scene_load(ctx, &scene, &found, err);
    return status == WEFT_BAD_SCENE && scene == NULL && found.errors == 2 ? WEFT_OK
                                                                          : status;
}

START_TEST(mistakes_survive_every_failing_allocation)
{
    weft_scene_def def = whole_scene();
    static const char text[] = "weft: 1\ncloth: {grid: {rows: x, cols: 5, spacing: 1}, "
                               "mass: 1, masss: 2}\nstepper: {plugin: verlet, method: "
                               "euler, fixed_step: 1}\nrun: {duration: 1}\n";
    def.text = text;
    def.length = strlen(text);
    (void)every_allocation_fails(load_wrong, &def, "errors");
}
END_TEST

/* The name comes from the file's: a line in a text that has room for one, else written
 * anew. libyaml 0.2.5 leaks where it has no room for a list or mapping as the 17th node
 * (yaml_parser_load_mapping): here that is a scalar. */
START_TEST(names_of_files_survive_every_failing_allocation)
{
    static const char block[]
        = "weft: 1\n"
          "cloth: {grid: {rows: 4, cols: 5, spacing: [0.1, 0.1]}, mass: 1}\n"
          "stepper: {plugin: verlet, method: midpoint, fixed_step: 1.0e-3}\n"
          "run: {duration: 1}\n";
    static const char flow[]
        = "{weft: 1, cloth: {grid: {rows: 4, cols: 5, spacing: [0.1, 0.1]}, mass: 1}, "
          "stepper: "
          "{plugin: verlet, method: midpoint, fixed_step: 1.0e-3}, run: {duration: 1}}";
    weft_scene_def def = whole_scene();
    def.file = "in/some \"file\".yaml";
    def.text = _i == 0 ? block : flow;
    def.length = strlen(def.text);
    (void)every_allocation_fails(load_and_run, &def, "name");
}
END_TEST

static weft_status load_sweep(const void *ctx, weft_error *err)
{
    weft_sweep *sweep = NULL;
    weft_status status = weft_sweep_load(ctx, &sweep, &found, err);
    if ((status == WEFT_OK) != (sweep != NULL)) {
        abort();
    }
    const size_t runs = status == WEFT_OK ? weft_sweep_runs(sweep) : 0;
    for (size_t run = 1; run <= runs && status == WEFT_OK; ++run) {
        weft_scene *scene = NULL;
        status = weft_sweep_scene(sweep, run, &scene, err);
        weft_scene_destroy(scene);
    }
    weft_sweep_destroy(sweep);
    return status;
}

START_TEST(sweeps_survive_every_failing_allocation)
{
    static const char *const sets[] = { "cloth.springs.shear.stiffness=7" };
    static const char *const sweeps[]
        = { "sweep:\n"
            "  zip: true\n"
            "  stepper.fixed_step: [1.0e-3, 5.0e-4]\n"
            "  cloth.loads: [null, [{at: [0, 1], mass: 1}]]\n",
            "sweep: {sample: 2, stepper.fixed_step: [1.0e-3, 5.0e-4]}\n" };
    const char *sweep = sweeps[_i / 2];
    char text[sizeof scene_text + 256];
    weft_scene_def def = whole_scene();
    (void)strcpy(stpcpy(text, scene_text), sweep);
    def.text = text;
    def.length = strlen(text);
    def.sets = sets;
    def.set_count = (size_t)(_i % 2);
    (void)every_allocation_fails(load_sweep, &def, "sweep");
}
END_TEST

/* ---- a simulation under way ------------------------------------------------------ */

typedef weft_status act(weft_sim *sim, weft_error *err);

static weft_status save_and_restore(weft_sim *sim, weft_error *err)
{
    static unsigned char bytes[4096];
    weft_status status = weft_sim_advance(sim, 2e-3, err);
    status = status == WEFT_OK ? weft_sim_save(sim, bytes, sizeof bytes, err) : status;
    status = status == WEFT_OK ? weft_sim_advance(sim, 4e-3, err) : status;
    return status == WEFT_OK
               ? weft_sim_restore(sim, bytes, weft_sim_save_size(sim), err)
               : status;
}

/* More than the definition has room for, one twice, one that it had. */
static weft_status change_pins(weft_sim *sim, weft_error *err)
{
    static const double away[3] = { 0.1, 0.0, 0.0 };
    static const size_t held[] = { 6, 7, 8, 6, 0, 13, 14 };
    weft_status status = weft_sim_advance(sim, 2e-3, err);
    for (size_t i = 0; i < sizeof held / sizeof held[0] && status == WEFT_OK; ++i) {
        status = weft_sim_pin(sim, held[i], i % 2 == 0 ? away : NULL, err);
    }
    status = status == WEFT_OK ? weft_sim_move_pin(sim, 7, away, err) : status;
    status = status == WEFT_OK ? weft_sim_unpin(sim, 8, err) : status;
    return status == WEFT_OK ? weft_sim_unpin(sim, 4, err) : status;
}

static weft_status take_pins_off(weft_sim *sim, weft_error *err)
{
    return weft_sim_unpin(sim, 0, err);
}

typedef struct under_way {
    const weft_cloth *cloth;
    const weft_stepper_type *method;
    act *act;
} under_way;

/* Where it is refused for want of memory the simulation is as it was, and goes on. */
static weft_status act_under_way(const void *ctx, weft_error *err)
{
    const under_way *of = ctx;
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = of->cloth;
    def.method = of->method;
    def.config.fixed_step = 1e-3;
    def.limit.method = WEFT_LIMIT_PROVOT;
    weft_status status = weft_sim_create(&def, &sim, err);
    if (status == WEFT_OK) {
        status = of->act(sim, err);
        if (weft_sim_advance(sim, 6e-3, NULL) != WEFT_OK) {
            abort();
        }
    }
    weft_sim_destroy(sim);
    return status;
}

START_TEST(a_simulation_under_way_survives_every_failing_allocation)
{
    static act *const acts[] = { save_and_restore, change_pins, take_pins_off };
    const weft_scene_def def = whole_scene();
    weft_scene *scene = NULL;
    weft_cloth *cloth = NULL;
    ck_assert_int_eq(weft_scene_load(&def, &scene, &found, NULL), WEFT_OK);
    ck_assert_int_eq(weft_cloth_create(weft_scene_cloth(scene), &cloth, NULL), WEFT_OK);
    const under_way of
        = { cloth, test_method_named("verlet/velocity_verlet"), acts[_i] };
    (void)every_allocation_fails(act_under_way, &of, "under way");
    weft_cloth_destroy(cloth);
    weft_scene_destroy(scene);
}
END_TEST

/* ---- methods --------------------------------------------------------------------- */

typedef struct made {
    const weft_stepper_type *type;
    bool adaptive;
} made;

static weft_status make_and_step(const void *ctx, weft_error *err)
{
    const made *m = ctx;
    model oscillators = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = weft__model_rhs, .ctx = &oscillators };
    const weft_structure structure = weft__model_structure(&oscillators);
    weft_stepper_config config
        = weft__with_table(m->type, weft__usual(m->type, m->adaptive ? 0 : 1));
    config.structure = &structure;
    double t = 0.0, y[DIM];
    void *self = NULL;
    memcpy(y, weft__model_start, sizeof y);
    weft_status status = m->type->create(m->type, &ode, &config, &self, err);
    if ((status == WEFT_OK) != (self != NULL)) {
        abort();
    }
    for (int i = 0; status == WEFT_OK && i < 20 && t < 1.0; ++i) {
        status = m->type->step(self, 1.0, &t, y, err);
    }
    m->type->destroy(self);
    return status;
}

static void spare_libraries(void)
{
    own_only = true;
#ifdef HAVE_GSL
    (void)gsl_set_error_handler_off(); /* the default ends the program */
#endif
}

static bool of_sundials(const char *label)
{
    return strncmp(label, "arkode/", 7) == 0 || strncmp(label, "cvode/", 6) == 0;
}

START_TEST(every_method_survives_every_failing_allocation)
{
    const char *label = test_method_label((size_t)_i);
    spare_libraries();
    for (int mode = 0; mode < 2 && !of_sundials(label); ++mode) {
        const made m = { test_method((size_t)_i), mode == 0 };
        (void)every_allocation_fails(make_and_step, &m, label);
    }
}
END_TEST

/* A little more each time, up to where it is enough. */
START_TEST(every_method_survives_a_heap_of_any_size)
{
    const char *label = test_method_label((size_t)_i);
    spare_libraries();
    own_only = false;
    for (int mode = 0; mode < 2; ++mode) {
        const made m = { test_method((size_t)_i), mode == 0 };
        weft_status status = WEFT_NO_MEMORY;
        for (size_t more = 64; status != WEFT_OK; more += 64) {
            weft_error err = { 0 };
            const long before = live;
            arm(0, false);
            budget = used + more;
            status = make_and_step(&m, &err);
            armed = false;
            ck_assert_msg(live == before || !COUNTS_ALL,
                          "%s, %zu bytes: %ld blocks kept", label, more, live - before);
            ck_assert_msg(status == WEFT_OK || status == WEFT_NO_MEMORY, "%s: %s",
                          label, err.message);
            ck_assert_uint_lt(more, 1 << 20);
        }
    }
}
END_TEST

/* GSL solves its dense systems with a permutation that it allocates each time. */
static bool gsl_allocates(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_DENSE) != 0;
}

START_TEST(a_step_allocates_nothing)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    for (int mode = 0; mode < 2 && !gsl_allocates(type) && !test_is_spared(type);
         ++mode) {
        model oscillators = { .k = 1.0 };
        const weft_ode ode
            = { .dim = DIM, .rhs = weft__model_rhs, .ctx = &oscillators };
        const weft_structure structure = weft__model_structure(&oscillators);
        weft_stepper_config config = weft__with_table(type, weft__usual(type, mode));
        config.structure = &structure;
        double t = 0.0, y[DIM];
        void *self = NULL;
        memcpy(y, weft__model_start, sizeof y);
        ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
        ck_assert_int_eq(type->step(self, 8.0, &t, y, NULL), WEFT_OK);
        arm(0, false);
        while (t < 8.0 && type->step(self, 8.0, &t, y, NULL) == WEFT_OK) {
            oscillators.fault = NO_FAULT;
        }
        armed = false;
        type->destroy(self);
        ck_assert_msg(t == 8.0 && calls == 0, "%s: %ld allocations up to %g s",
                      test_method_label((size_t)_i), calls, t);
    }
}
END_TEST

/* A strip before a plate, whose lower end is lifted to the upper one, so that it
 * touches both; its derivatives by the thickness, which both kinds of contact have. */
START_TEST(a_step_with_sensitivities_of_contact_allocates_nothing)
{
    static const weft_pin pins[]
        = { { .rows = { 0, 0 }, .cols = { 0, -1 } },
            { .rows = { 11, 11 }, .cols = { 0, -1 }, .velocity = { 0.04, 0.0, 0.6 } } };
    body_mesh *wall = plate(2, 0.5, 1.0);
    weft_shape shape = body_shape(wall);
    weft_cloth_def def = weft_cloth_def_default();
    weft_sim_def run = weft_sim_def_default();
    weft_cloth *cloths[3];
    weft_sim *sim = NULL;
    def.rows = 12, def.cols = 3, def.pins = pins, def.pin_count = 2;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.down[1] = 0.0, def.down[2] = -1.0;
    def.springs[WEFT_STRETCH] = (weft_spring_def){ true, 200.0, 0.02 };
    def.springs[WEFT_SHEAR] = (weft_spring_def){ true, 100.0, 0.01 };
    shape.at[1] = -0.012;
    def.contact.self = true, def.contact.shapes = &shape, def.contact.shape_count = 1;
    for (size_t i = 0; i < 3; ++i) {
        def.contact.thickness = 0.02 * (1.0 + 1e-6 * ((double)i - 1.0));
        ck_assert_int_eq(weft_cloth_create(&def, &cloths[i], NULL), WEFT_OK);
    }
    const weft_parameter number = { "thickness", cloths[0], cloths[2], 2e-6 };
    const weft_sensitivity_def by = { 1, &number, true };
    run.cloth = cloths[1], run.sensitivity = &by;
    run.method = test_method_named("verlet/velocity_verlet");
    run.config.fixed_step = 2e-4;
    ck_assert_int_eq(weft_sim_create(&run, &sim, NULL), WEFT_OK);
    ck_assert_int_eq(weft_sim_advance(sim, 0.23, NULL), WEFT_OK);
    const weft_measures now = weft_sim_measure(sim);
    ck_assert_uint_gt(now.touching, 0);
    ck_assert_uint_gt(now.self_touching, 0);
    arm(0, false);
    (void)weft_sim_advance(sim, 0.24, NULL);
    armed = false;
    ck_assert_double_eq(weft_sim_time(sim), 0.24);
    ck_assert_msg(calls == 0, "%ld allocations", calls);
    weft_sim_destroy(sim);
    for (size_t i = 0; i < 3; ++i) {
        weft_cloth_destroy(cloths[i]);
    }
    free(wall);
}
END_TEST

/* ---- plugins --------------------------------------------------------------------- */

static weft_status register_all(const void *ctx, weft_error *err)
{
    (void)ctx;
    const weft_registry_def def = { .struct_size = sizeof def, .path = "nowhere" };
    weft_registry *registry = NULL;
    weft_status status = weft_registry_create(&def, &registry, err);
    for (size_t i = 0; status == WEFT_OK && test_plugin(i) != NULL; ++i) {
        status = weft_registry_add(registry, test_plugin(i), err);
    }
    weft_registry_destroy(registry);
    return status;
}

START_TEST(a_registry_survives_every_failing_allocation)
{
    (void)every_allocation_fails(register_all, NULL, "registry");
}
END_TEST

static weft_status stable_step(const void *ctx, weft_error *err)
{
    weft_stability stability;
    return weft_stability_create(ctx, NULL, &stability, err);
}

START_TEST(stability_survives_every_failing_allocation)
{
    (void)every_allocation_fails(stable_step, test_method_named("verlet/midpoint"),
                                 "stability");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("no memory");
    TCase *tcase = tcase_create("allocations");
    tcase_set_timeout(tcase, 120.0);
    tcase_add_test(tcase, scene_load_and_run_survive_every_failing_allocation);
    tcase_add_test(tcase, files_of_a_cloth_survive_every_failing_allocation);
    tcase_add_test(tcase, overrides_survive_every_failing_allocation);
    tcase_add_test(tcase, contact_survives_every_failing_allocation);
    tcase_add_test(tcase, mistakes_survive_every_failing_allocation);
    tcase_add_loop_test(tcase, names_of_files_survive_every_failing_allocation, 0, 2);
    tcase_add_loop_test(tcase, sweeps_survive_every_failing_allocation, 0, 4);
    tcase_add_loop_test(tcase, a_simulation_under_way_survives_every_failing_allocation,
                        0, 3);
    tcase_add_loop_test(tcase, every_method_survives_every_failing_allocation, 0,
                        (int)test_method_count());
    tcase_add_loop_test(tcase, every_method_survives_a_heap_of_any_size, 0,
                        COUNTS_ALL * (int)test_method_count());
    tcase_add_loop_test(tcase, a_step_allocates_nothing, 0, (int)test_method_count());
    tcase_add_test(tcase, a_step_with_sensitivities_of_contact_allocates_nothing);
    tcase_add_test(tcase, a_registry_survives_every_failing_allocation);
    tcase_add_test(tcase, stability_survives_every_failing_allocation);
    suite_add_tcase(suite, tcase);
    return test_run(suite);
}
