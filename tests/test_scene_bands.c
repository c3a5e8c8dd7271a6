/* SPDX-License-Identifier: BSD-3-Clause */
/* What of a scene does not run in bands is a mistake at its place, and none otherwise.
 */
#include "scene_load.h"

static const weft_plugin *find_own(void *ctx, const char *id, weft_error *err)
{
    static const weft_stepper_type together
        = { .name = "together",
            .flags = WEFT_STEPPER_DISTRIBUTED | WEFT_STEPPER_QUADRATURES };
    static const weft_stepper_type alone = { .name = "alone" };
    static const weft_stepper_type *const types[] = { &together, &alone, NULL };
    static const weft_plugin plugin = { .id = "own", .types = types };
    (void)ctx, (void)id, (void)err;
    return &plugin;
}

#define SCENE                                                                          \
    "weft: 1\n"                                                                        \
    "name: bands\n"                                                                    \
    "cloth: {mass: 1, grid: {rows: 5, cols: 2, spacing: 1}, springs: {stretch: "       \
    "{stiffness: 1}}}\n"                                                               \
    "run: {duration: 1}\n"

static const struct {
    const char *rest, *told;
    size_t bands;
} scenes[] = {
    { "stepper: {plugin: own, method: together}\n", NULL, 2 },
    { "stepper: {plugin: own, method: together}\n",
      "scene.yaml:3:24: error: 5 rows are too few for 3 bands: each needs 2\n", 3 },
    { "stepper: {plugin: own, method: alone}\n",
      "scene.yaml:5:32: error: method 'alone' of plugin 'own' does not run in bands; "
      "of "
      "that plugin these do: together; or run it in one process, with threads\n",
      2 },
    { "stepper: {plugin: own, method: together, norm: rms}\n", NULL, 2 },
    { "stepper: {plugin: own, method: together}\nlimit: {method: provot}\n",
      "scene.yaml:6:1: error: a strain limit does not run in bands", 2 },
    { "stepper: {plugin: own, method: together}\nrecord: {ledger: true}\nstop: {when: "
      "max_strain > 9}\n",
      NULL, 2 },
    { "stepper: {plugin: own, method: together}\ncontact: {self: true, thickness: "
      "0.1}\n",
      NULL, 2 },
    { "stepper: {plugin: own, method: together}\ncontact: {self: true, untangle: 1, "
      "thickness: 0.1}\n",
      "scene.yaml:6:33: error: untangle does not run in bands", 2 },
};

START_TEST(bands_refuse_what_needs_the_whole_cloth)
{
    char text[600];
    (void)snprintf(text, sizeof text, SCENE "%s", scenes[_i].rest);
    weft_scene_def def = scene_of_text(text);
    def.find_plugin = find_own;
    weft_scene_destroy(good_scene(&def));
    def.bands = 1;
    weft_scene_destroy(good_scene(&def));
    def.bands = scenes[_i].bands;
    if (scenes[_i].told == NULL) {
        weft_scene_destroy(good_scene(&def));
        return;
    }
    const char *told = bad_scene(&def);
    ck_assert_msg(strstr(told, scenes[_i].told) == told, "%s", told);
    ck_assert_uint_eq(found.errors, 1);
}
END_TEST

/* 1686 vertices. */
START_TEST(triangles_run_in_bands_of_two_blocks_with_straight_edges)
{
    static const struct {
        size_t bands;
        const char *membrane, *told;
    } cases[] = { { 2, "chord", NULL },
                  { 2, "arc", "3:88: error: membrane arc does not run in bands" },
                  { 3, "chord",
                    "3:15: error: 4 blocks of 512 vertices are too few for 3 bands" } };
    char text[600];
    (void)snprintf(text, sizeof text,
                   "weft: 1\nname: bands\n"
                   "cloth: {mesh: {file: scenes/skirt.obj}, fabric: {preset: "
                   "tango-red-jet-set}, membrane: %s}\n"
                   "run: {duration: 1}\nstepper: {plugin: own, method: together}\n",
                   cases[_i].membrane);
    weft_scene_def def = scene_of_text(text);
    def.find_plugin = find_own;
    def.bands = cases[_i].bands;
    if (cases[_i].told == NULL) {
        weft_scene_destroy(good_scene(&def));
    } else {
        const char *told = bad_scene(&def);
        ck_assert_msg(strstr(told, cases[_i].told) != NULL, "%s", told);
    }
}
END_TEST

TEST_SUITE(scene_bands)
{
    Suite *suite = suite_create("scene bands");
    TCase *bands = tcase_create("bands");
    tcase_add_loop_test(bands, bands_refuse_what_needs_the_whole_cloth, 0,
                        sizeof scenes / sizeof scenes[0]);
    tcase_add_loop_test(bands, triangles_run_in_bands_of_two_blocks_with_straight_edges,
                        0, 3);
    suite_add_tcase(suite, bands);
    return suite;
}
