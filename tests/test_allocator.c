/* SPDX-License-Identifier: BSD-3-Clause */
/* test_allocator.c -- memory from an allocator of the embedder's own, and what happens
 * when it has none left. */
#include "embedded.h"

#include <stdlib.h>

static int no_force(void *ctx, double t, const double *y, double *f)
{
    (void)ctx;
    (void)t;
    (void)y;
    (void)f;
    return 0;
}

/* ---- memory ---------------------------------------------------------------------- */

typedef struct pool {
    size_t calls, fail_at; /* the call that fails; 0: none */
    size_t live;           /* blocks */
} pool;

static void *pool_resize(void *ctx, void *block, size_t size)
{
    pool *from = ctx;
    if (size == 0) {
        ck_assert_ptr_nonnull(block);
        --from->live;
        free(block);
        return NULL;
    }
    if (++from->calls == from->fail_at) {
        return NULL;
    }
    from->live += block == NULL;
    return realloc(block, size);
}

/* Everything that a cloth and a simulation of it allocate. */
static weft_status live_a_life(const weft_allocator *memory, weft_error *err)
{
    weft_stiffness bounds;
    model.allocator = memory;
    run.allocator = memory;
    run.force = no_force;
    run.limit.method = WEFT_LIMIT_PROVOT;
    weft_status status = weft_cloth_create(&model, &cloth, err);
    run.cloth = cloth;
    status = status != WEFT_OK ? status : weft_sim_create(&run, &sim, err);
    for (size_t i = 2; status == WEFT_OK && i < 6; ++i) {
        status = weft_sim_pin(sim, i, NULL, err);
    }
    status = status != WEFT_OK ? status : weft_sim_unpin(sim, 3, err);
    status = status != WEFT_OK
                 ? status
                 : weft_cloth_stiffness_refined(weft_sim_cloth(sim), 0.0,
                                                weft_sim_state(sim), 3, &bounds, err);
    status = status != WEFT_OK ? status : weft_sim_advance(sim, 0.01, err);
    teardown();
    return status;
}

START_TEST(memory_comes_from_where_it_should_and_goes_back)
{
    pool from = { 0 };
    const weft_allocator memory = { pool_resize, &from };
    ck_assert_int_eq(live_a_life(&memory, NULL), WEFT_OK);
    ck_assert_uint_eq(from.live, 0);
    const size_t calls = from.calls;
    ck_assert_uint_gt(calls, 12);
    for (size_t n = 1; n <= calls; ++n) {
        weft_error err = { 0 };
        from = (pool){ .fail_at = n };
        ck_assert_int_eq(live_a_life(&memory, &err), WEFT_NO_MEMORY);
        ck_assert_int_eq(err.status, WEFT_NO_MEMORY);
        ck_assert_str_ne(err.message, "");
        ck_assert_uint_eq(from.live, 0);
    }
}
END_TEST

START_TEST(steps_allocate_nothing)
{
    pool from = { 0 };
    const weft_allocator memory = { pool_resize, &from };
    run.allocator = &memory;
    run.limit.method = WEFT_LIMIT_BRIDSON;
    run.force = no_force;
    run.ledger = true;
    start();
    const size_t calls = from.calls;
    go(0.2);
    ck_assert_uint_eq(from.calls, calls);
    teardown();
    ck_assert_uint_eq(from.live, 0);
}
END_TEST

static const char scene_text[]
    = "weft: 1\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}\n"
      "  density: 0.3\n"
      "  springs: {stretch: {stiffness: 50}}\n"
      "  loads: [{at: [1, 1], mass: 0.1}]\n"
      "  pins: [top-left, bottom, top, left, right]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

static weft_status load_scene(const weft_allocator *memory)
{
    static weft_diagnostics found;
    const char *const sets[] = { "run.fps=25" };
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    weft_scene_def def = weft_scene_def_default();
    def.text = scene_text;
    def.length = sizeof scene_text - 1;
    def.sets = sets;
    def.set_count = 1;
    def.file = "folder/a scene.yaml";
    def.allocator = memory;
    const weft_status status = weft_scene_load(&def, &scene, &found, &err);
    ck_assert_msg(status == WEFT_OK || err.status == status, "%s", err.message);
    ck_assert((status == WEFT_OK) == (scene != NULL));
    if (scene != NULL) {
        ck_assert_str_eq(weft_scene_name(scene), "a scene");
        ck_assert(weft_scene_run(scene)->fps == 25.0);
        ck_assert_uint_eq(weft_scene_cloth(scene)->pin_count, 5);
    }
    weft_scene_destroy(scene);
    return status;
}

START_TEST(scenes_take_their_memory_from_there_too)
{
    pool from = { 0 };
    const weft_allocator memory = { pool_resize, &from };
    ck_assert_int_eq(load_scene(NULL), WEFT_OK);
    ck_assert_uint_eq(from.calls, 0);
    ck_assert_int_eq(load_scene(&memory), WEFT_OK);
    ck_assert_uint_eq(from.live, 0);
    const size_t calls = from.calls;
    ck_assert_uint_gt(calls, 2);
    for (size_t n = 1; n <= calls; ++n) {
        from = (pool){ .fail_at = n };
        ck_assert_int_eq(load_scene(&memory), WEFT_NO_MEMORY);
        ck_assert_uint_eq(from.live, 0);
    }
}
END_TEST

static weft_status use_registry(const weft_allocator *memory)
{
    const weft_plugin *plugin = NULL;
    weft_registry *registry = NULL;
    weft_registry_def def = weft_registry_def_default();
    def.path = BUILD_DIR "/tests/broken:" BUILD_DIR "/plugins";
    def.allocator = memory;
    weft_status status = weft_registry_create(&def, &registry, NULL);
    status = status != WEFT_OK ? status
                               : weft_registry_find(registry, "verlet", &plugin, NULL);
    status = status != WEFT_OK ? status
                               : weft_registry_find(registry, "good", &plugin, NULL);
    weft_registry_destroy(registry);
    return status;
}

START_TEST(so_do_registries)
{
    pool from = { 0 };
    const weft_allocator memory = { pool_resize, &from };
    ck_assert_int_eq(use_registry(&memory), WEFT_OK);
    ck_assert_uint_eq(from.live, 0);
    const size_t calls = from.calls;
    ck_assert_uint_ge(calls, 6);
    for (size_t n = 1; n <= calls; ++n) {
        from = (pool){ .fail_at = n };
        ck_assert_int_eq(use_registry(&memory), WEFT_NO_MEMORY);
        ck_assert_uint_eq(from.live, 0);
    }
}
END_TEST

TEST_SUITE(allocator)
{
    Suite *suite = suite_create("allocator");
    TCase *tcase = tcase_create("allocator");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, memory_comes_from_where_it_should_and_goes_back);
    tcase_add_test(tcase, steps_allocate_nothing);
    tcase_add_test(tcase, scenes_take_their_memory_from_there_too);
    tcase_add_test(tcase, so_do_registries);
    suite_add_tcase(suite, tcase);
    return suite;
}
