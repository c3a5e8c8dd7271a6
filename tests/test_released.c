/* SPDX-License-Identifier: BSD-3-Clause */
/* What releases wrote is read for ever (VERSIONING.md): their scenes and saved states,
 * in tests/released, which tools/checks/released made. Each does what it did then: to
 * the last bit in the patches of that release, and within a hundredth of a cell later.
 */
#include <math.h>
#include <string.h>

#include "program/record/checkpoint.h"
#include "support.h"

typedef struct run {
    weft_scene *scene;
    weft_cloth *cloth;
    weft_sim *sim;
} run;

static const char *const names[][2]
    = { { "0.2.0", "springs" }, { "0.2.0", "contact" }, { "0.2.0", "mesh" } };
enum { RUNS = sizeof names / sizeof names[0] };

static weft_error err;

static const weft_plugin *linked(void *ctx, const char *id, weft_error *why)
{
    (void)ctx, (void)why;
    size_t i = 0;
    while (test_plugin(i) != NULL && strcmp(test_plugin(i)->id, id) != 0) {
        ++i;
    }
    return test_plugin(i);
}

static const char *folder(int i)
{
    static char path[128];
    (void)snprintf(path, sizeof path, "tests/released/%s/%s", names[i][0], names[i][1]);
    return path;
}

static void good(weft_status status)
{
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
}

static run open(int i)
{
    run out = { NULL, NULL, NULL };
    char file[160];
    static weft_diagnostics found;
    (void)snprintf(file, sizeof file, "%s/scene.yaml", folder(i));
    weft_scene_def def = weft_scene_def_default();
    def.file = file;
    def.find_plugin = linked;
    good(weft_scene_load(&def, &out.scene, &found, &err));
    good(weft_cloth_create(weft_scene_cloth(out.scene), &out.cloth, &err));
    weft_sim_def sim = weft_sim_def_default();
    sim.cloth = out.cloth;
    sim.method = weft_scene_method_type(out.scene);
    sim.config = *weft_scene_config(out.scene);
    sim.limit = *weft_scene_limit(out.scene);
    sim.ledger = weft_scene_record(out.scene)->ledger;
    good(weft_sim_create(&sim, &out.sim, &err));
    return out;
}

static void shut(run *one)
{
    weft_sim_destroy(one->sim);
    weft_cloth_destroy(one->cloth);
    weft_scene_destroy(one->scene);
}

/* Frame by frame, as `weft run` does. */
static void go_on(const run *one, size_t frame)
{
    const weft_run_def *def = weft_scene_run(one->scene);
    const size_t last = weft_run_last_frame(def);
    for (; frame <= last; ++frame) {
        good(weft_sim_advance(one->sim, weft_run_frame_time(def, frame), &err));
        if (frame % (size_t)def->checkpoint == 0 && frame != last) {
            good(weft_sim_restart(one->sim, &err));
        }
    }
}

/* end.txt: the hash of the last state, and the place of every vertex [m]. */
static void ends_as_then(const run *one, int i)
{
    char file[160];
    unsigned long long hash = 0;
    (void)snprintf(file, sizeof file, "%s/end.txt", folder(i));
    FILE *then = fopen(file, "r");
    ck_assert_ptr_nonnull(then);
    ck_assert_int_eq(fscanf(then, "%llx", &hash), 1);
    const double *y = weft_sim_state(one->sim);
    const size_t n = weft_cloth_particles(one->cloth);
    for (size_t vertex = 0; vertex < n; ++vertex) {
        const size_t p = weft_cloth_index(one->cloth, vertex);
        double at[3];
        ck_assert_int_eq(fscanf(then, "%lf,%lf,%lf", &at[0], &at[1], &at[2]), 3);
        for (size_t k = 0; k < 3; ++k) {
            ck_assert_double_le(fabs(y[k * n + p] - at[k]), 4e-4);
        }
    }
    (void)fclose(then);
    const size_t patch = strlen(names[i][0]) - strlen(strrchr(names[i][0], '.')) + 1;
    if (strncmp(WEFT_VERSION, names[i][0], patch) == 0) {
        ck_assert_uint_eq(weft_sim_measure(one->sim).hash, hash);
    }
}

START_TEST(a_scene_runs_as_it_did)
{
    run one = open(_i);
    go_on(&one, 1);
    ends_as_then(&one, _i);
    shut(&one);
}
END_TEST

START_TEST(a_saved_state_goes_on_as_it_did)
{
    run one = open(_i);
    record_checkpoint saved;
    good(record_checkpoint_read(folder(_i), &saved, &err));
    good(record_checkpoint_restore(&saved, one.sim, &err));
    ck_assert_uint_gt(saved.frame, 0);
    go_on(&one, saved.frame + 1);
    ends_as_then(&one, _i);
    record_checkpoint_close(&saved);
    shut(&one);
}
END_TEST

static void ignore(void *ctx, const char *line)
{
    (void)ctx, (void)line;
}

START_TEST(every_key_is_still_known)
{
    char key[128];
    int keys = 0;
    FILE *then = fopen("tests/released/0.2.0/keys.txt", "r");
    ck_assert_ptr_nonnull(then);
    for (; fscanf(then, "%127s", key) == 1; ++keys) {
        good(weft_scene_help_key(key, ignore, NULL, &err));
    }
    ck_assert_int_gt(keys, 100);
    (void)fclose(then);
}
END_TEST

TEST_SUITE(released)
{
    Suite *suite = suite_create("released");
    TCase *reading = tcase_create("reading");
    tcase_set_timeout(reading, 60);
    tcase_add_loop_test(reading, a_scene_runs_as_it_did, 0, RUNS);
    tcase_add_loop_test(reading, a_saved_state_goes_on_as_it_did, 0, RUNS);
    tcase_add_test(reading, every_key_is_still_known);
    suite_add_tcase(suite, reading);
    return suite;
}
