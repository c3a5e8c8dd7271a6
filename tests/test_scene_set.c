/* SPDX-License-Identifier: BSD-3-Clause */
/* Overrides of a scene, the text that is written with them, and the help on keys. */
#include "scene_load.h"

static const char base[] = "weft: 1\n"
                           "# a comment\n"
                           "cloth:\n"
                           "  grid: {rows: 3, cols: 4, spacing: [0.1, 0.2]}\n"
                           "  mass: 1.0e-2\n"
                           "  loads: [{at: [1, 1], mass: 0.5}]\n"
                           "  springs:\n"
                           "    stretch: &soft {stiffness: 100, damping: 0.1}\n"
                           "    shear: *soft\n"
                           "  pins: [top-left, {at: top-right, velocity: [1, 0, 0]}]\n"
                           "stepper: {plugin: gsl, method: rkf45, rtol: 1e-7}\n"
                           "run: {duration: 1, fps: 30}\n";

static weft_scene_def with_sets(const char *const *sets, size_t count)
{
    weft_scene_def def = scene_of_text(base);
    def.sets = sets;
    def.set_count = count;
    return def;
}

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static weft_scene *set_scene(const char *const *sets, size_t count)
{
    const weft_scene_def def = with_sets(sets, count);
    weft_scene *scene = good_scene(&def);
    ck_assert_msg(found.count == 0, "%s", all_found());
    return scene;
}

START_TEST(overrides_replace_and_add)
{
    static const char *const sets[] = {
        "cloth.grid.rows=5",
        "cloth.grid.rows=40",
        "cloth.grid.spacing.1=0.25",
        "cloth.springs.bend={stiffness: 2}",
        "cloth.springs.law = strain",
        "forces.wind.drag=0.5",
        "forces.wind.velocity=[0, 0, 3]",
        "name=a new name",
        "stepper.method=rk4",
        "run.fps=2.4e+1",
    };
    weft_scene *scene = set_scene(sets, COUNT(sets));
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert_uint_eq(cloth->rows, 40);
    ck_assert(cloth->spacing[0] == 0.1 && cloth->spacing[1] == 0.25);
    ck_assert(cloth->springs[WEFT_BEND].present);
    ck_assert(cloth->springs[WEFT_BEND].stiffness == 2.0);
    ck_assert_int_eq(cloth->law, WEFT_LAW_STRAIN);
    ck_assert(cloth->wind_drag == 0.5 && cloth->wind_velocity[2] == 3.0);
    ck_assert_str_eq(weft_scene_name(scene), "a new name");
    ck_assert_str_eq(weft_scene_method_type(scene)->name, "rk4");
    ck_assert(weft_scene_run(scene)->fps == 24.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(overrides_reach_into_lists)
{
    static const char *const sets[] = {
        "cloth.pins.0=bottom",
        "cloth.pins.1.velocity=[0, 2, 0]",
        "cloth.pins.2=[1, 1]",
        "cloth.loads.0.mass=0.25",
        "cloth.loads.1={at: left, mass: 1}",
        "cloth.loads.2.at=right",
        "cloth.loads.2.mass=2",
        "cloth.loads.1=null",
    };
    weft_scene *scene = set_scene(sets, COUNT(sets));
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert_uint_eq(cloth->pin_count, 3);
    ck_assert_int_eq(cloth->pins[0].rows.first, -1);
    ck_assert(cloth->pins[1].velocity[0] == 0.0 && cloth->pins[1].velocity[1] == 2.0);
    ck_assert_int_eq(cloth->pins[2].cols.last, 1);
    ck_assert_uint_eq(cloth->load_count, 2);
    ck_assert(cloth->loads[0].mass == 0.25 && cloth->loads[1].mass == 2.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(null_removes_a_key)
{
    static const char *const sets[] = {
        "cloth.mass=null",   "cloth.density=0.2", "cloth.pins=~",
        "cloth.loads=null",  "stepper.rtol=null", "stepper.fixed_step=1e-3",
        "limit.strain=null", "forces=null",       "cloth.springs.stretch.damping=~",
    };
    weft_scene *scene = set_scene(sets, COUNT(sets));
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert(cloth->mass == 0.0 && cloth->density == 0.2);
    ck_assert_uint_eq(cloth->pin_count, 0);
    ck_assert_uint_eq(cloth->load_count, 0);
    ck_assert(weft_scene_step(scene) == 1e-3);
    ck_assert_int_eq(weft_scene_limit(scene)->method, WEFT_LIMIT_NONE);
    ck_assert_ptr_null(strstr(weft_scene_text(scene), "rtol"));
    ck_assert_ptr_null(strstr(weft_scene_text(scene), "limit"));
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(an_override_changes_its_own_path_and_no_alias)
{
    static const char *const sets[]
        = { "cloth.springs.shear.stiffness=7", "cloth.springs.shear.damping=null" };
    weft_scene *scene = set_scene(sets, COUNT(sets));
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert(cloth->springs[WEFT_STRETCH].stiffness == 100.0);
    ck_assert(cloth->springs[WEFT_STRETCH].damping == 0.1);
    ck_assert(cloth->springs[WEFT_SHEAR].stiffness == 7.0);
    ck_assert(cloth->springs[WEFT_SHEAR].damping == 0.0);
    weft_scene_destroy(scene);
}
END_TEST

/* Wrong overrides, each the second of two, and what is said of them. */
static const struct {
    const char *set, *told;
} wrong[] = {
    { "run.fps", ":1: error: there is no '=': write key.path=value\nrun.fps\n^\n" },
    { "=5", ":1: error: a key is missing here: write key.path=value\n=5\n^\n" },
    { "run..fps=5",
      ":5: error: a key is missing here: write key.path=value\nrun..fps=5\n    ^\n" },
    { "run.=5",
      ":5: error: a key is missing here: write key.path=value\nrun.=5\n    ^\n" },
    { "run.fps=", ":9: error: there is no value; null would remove the key\nrun.fps=\n "
                  "       ^\n" },
    { "run.fps=-1",
      ":9: error: fps must be a number > 0 [1/s], not '-1'\nrun.fps=-1\n        ^\n" },
    { "run.f\xC3\xA4s=1",
      ":6: error: no key has such a character\nrun.f\xC3\xA4s=1\n     ^\n" },
    { "run.fsp=60", ":5: error: unknown key 'fsp' in run (did you mean 'fps'?)\n"
                    "run.fsp=60\n    ^\n" },
    { "run.fsp=null", ":5: error: unknown key 'fsp' in run (did you mean 'fps'?)\n"
                      "run.fsp=null\n    ^\n" },
    { "runs.duration=1", ":1: error: unknown key 'runs' in the scene (did you mean "
                         "'run'?)\nruns.duration=1\n^\n" },
    { "run.fps.rate=60",
      ":9: error: 'fps' is a single value: nothing can be set inside\n"
      "run.fps.rate=60\n        ^\n" },
    { "cloth.pins.00=top",
      ":12: error: '00' is no element of this list of 2; the first is 0, the next "
      "free one 2\n"
      "cloth.pins.00=top\n           ^\n" },
    { "cloth.pins.first=top",
      ":12: error: 'first' is no element of this list of 2; the first is 0, the next "
      "free one 2\n"
      "cloth.pins.first=top\n           ^\n" },
    { "cloth.pins.3=top",
      ":12: error: '3' is no element of this list of 2; the first is "
      "0, the next free one 2\ncloth.pins.3=top\n           ^\n" },
    { "cloth.pins.2=null",
      ":12: error: '2' is no element of this list of 2; the first is 0\n"
      "cloth.pins.2=null\n           ^\n" },
    { "cloth.pins=[top, botom]",
      ":18: error: a pin must be a corner, an edge, [row, column] or {rows, cols}, not "
      "'botom' (did you mean 'bottom'?)\n"
      "cloth.pins=[top, botom]\n                 ^\n" },
    { "cloth.pins=[top",
      ":12: error: did not find expected ',' or ']' (while parsing a "
      "flow sequence that begins here; the text ends at column 16)\ncloth.pins=[top\n  "
      "         ^\n" },
    { "run.duration=*d",
      ":14: error: found undefined alias\nrun.duration=*d\n             ^\n" },
    { "cloth.density=0.2", ":7: error: density excludes mass (line 5, column "
                           "3)\ncloth.density=0.2\n      ^\n" },
    { "stepper={plugin: gsl, method: rk4, rtol: 1, fixed_step: 0.01}",
      ":45: error: fixed_step excludes rtol (override stepper)\n"
      "stepper={plugin: gsl, method: rk4, rtol: 1, fixed_step: 0.01}\n"
      "                                            ^\n" },
    { "forces.wind.drag=1",
      ":8: error: wind lacks 'velocity' [m/s] or 'table' [s, m/s]: exactly one is "
      "required\nforces.wind.drag=1\n       ^\n" },
    { "run=\xFF", ":5: error: this is not UTF-8 (byte FF)\nrun=?\n    ^\n" },
};

START_TEST(wrong_overrides_are_placed_at_their_key)
{
    const char *const sets[] = { "run.fps=25", wrong[_i].set };
    const weft_scene_def def = with_sets(sets, 2);
    char wanted[600];
    (void)snprintf(wanted, sizeof wanted, "override %.*s%s",
                   (int)strcspn(wrong[_i].set, "="), wrong[_i].set, wrong[_i].told);
    ck_assert_str_eq(bad_scene(&def), wanted);
    ck_assert_int_eq(found.items[0].line, 0);
    ck_assert_uint_eq(found.errors, 1);
}
END_TEST

START_TEST(mistakes_of_file_and_overrides_are_told_together)
{
    static const char *const sets[] = { "run.threads=0", "run.duration=0" };
    weft_scene_def def = scene_of_text("weft: 2\n");
    def.sets = sets;
    def.set_count = 2;
    const char *told = bad_scene(&def);
    const char *version = strstr(told, "scene.yaml:1:7: error: version 2");
    const char *threads = strstr(told, "override run.threads:13: error: threads");
    const char *duration = strstr(told, "override run.duration:14: error: duration");
    ck_assert_msg(version != NULL && version < threads && threads < duration, "%s",
                  told);
}
END_TEST

/* ---- the text that is written ----------------------------------------------- */

static void ranges_equal(weft_range a, weft_range b)
{
    ck_assert(a.first == b.first && a.last == b.last);
}

static void cloths_equal(const weft_cloth_def *a, const weft_cloth_def *b)
{
    weft_cloth_def x = *a, y = *b;
    ck_assert_uint_eq(a->pin_count, b->pin_count);
    ck_assert_uint_eq(a->load_count, b->load_count);
    for (size_t i = 0; i < a->pin_count; ++i) {
        ranges_equal(a->pins[i].rows, b->pins[i].rows);
        ranges_equal(a->pins[i].cols, b->pins[i].cols);
        ck_assert_mem_eq(a->pins[i].velocity, b->pins[i].velocity, 3 * sizeof(double));
        ck_assert_mem_eq(a->pins[i].amplitude, b->pins[i].amplitude,
                         3 * sizeof(double));
        ck_assert(a->pins[i].frequency == b->pins[i].frequency);
    }
    for (size_t i = 0; i < a->load_count; ++i) {
        ranges_equal(a->loads[i].rows, b->loads[i].rows);
        ck_assert(a->loads[i].mass == b->loads[i].mass);
    }
    x.pins = y.pins = NULL;
    x.loads = y.loads = NULL;
    ck_assert_mem_eq(&x, &y, sizeof x);
}

START_TEST(the_text_with_overrides_loads_to_an_equal_scene)
{
    static const char *const sets[] = {
        "name=\"a name: with 'quotes', \\u00e4 and \\\\\"",
        "cloth.pins.2={rows: [1, 2], cols: all}",
        "cloth.springs.shear.stiffness=33.250",
        "forces.gravity=[0, 0, -9.810]",
        "stepper.atol={position: 1e-9, velocity: 1.50e-8}",
        "stepper.max_step=.inf",
        "limit={method: provot, springs: [stretch]}",
    };
    weft_scene *scene = set_scene(sets, COUNT(sets));
    weft_scene *again = good_text(weft_scene_text(scene));
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_str_eq(weft_scene_name(again), weft_scene_name(scene));
    ck_assert_str_eq(weft_scene_name(again), "a name: with 'quotes', \xC3\xA4 and \\");
    cloths_equal(weft_scene_cloth(scene), weft_scene_cloth(again));
    ck_assert_mem_eq(weft_scene_limit(scene), weft_scene_limit(again),
                     sizeof(weft_limit_def));
    ck_assert_mem_eq(weft_scene_config(scene), weft_scene_config(again),
                     sizeof(weft_stepper_config));
    ck_assert_mem_eq(weft_scene_run(scene), weft_scene_run(again),
                     sizeof(weft_run_def));
    ck_assert_ptr_nonnull(strstr(weft_scene_text(scene), "gravity: [0, 0, -9.810]\n"));
    ck_assert_ptr_nonnull(strstr(weft_scene_text(scene), "velocity: 1.50e-8\n"));
    ck_assert_ptr_nonnull(strstr(weft_scene_text(scene), "mass: 1.0e-2\n"));
    weft_scene_destroy(scene);
    weft_scene_destroy(again);
}
END_TEST

START_TEST(without_overrides_the_text_is_that_of_the_file)
{
    weft_scene *scene = good_text(base);
    ck_assert_str_eq(weft_scene_text(scene), base);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(name_of_the_file_is_added_below_comments)
{
    char text[1024], wanted[1024];
    (void)snprintf(text, sizeof text, "# washed twice\n# dried flat\n%s", base);
    (void)snprintf(wanted, sizeof wanted,
                   "# washed twice\n# dried flat\nname: \"towel\"\n%s", base);
    weft_scene_def def = scene_of_text(text);
    def.file = "towel.yaml";
    weft_scene *scene = good_scene(&def);
    ck_assert_str_eq(weft_scene_text(scene), wanted);
    weft_scene_destroy(scene);
}
END_TEST

/* ---- help ------------------------------------------------------------------- */

typedef struct page {
    char text[40 * 1024];
    size_t length, widest;
} page;

static void add_line(void *ctx, const char *text)
{
    page *out = ctx;
    const size_t length = strlen(text);
    ck_assert_uint_lt(out->length + length + 2, sizeof out->text);
    out->length += (size_t)snprintf(out->text + out->length,
                                    sizeof out->text - out->length, "%s\n", text);
    out->widest = length > out->widest ? length : out->widest;
}

static const char *const keys[] = {
    "weft",
    "name",
    "cloth.grid.rows",
    "cloth.grid.cols",
    "cloth.grid.spacing",
    "cloth.grid.origin",
    "cloth.grid.right",
    "cloth.grid.down",
    "cloth.grid.scale",
    "cloth.mass",
    "cloth.density",
    "cloth.velocity",
    "cloth.loads",
    "cloth.loads[].at",
    "cloth.loads[].mass",
    "cloth.springs.law",
    "cloth.springs.stretch.stiffness",
    "cloth.springs.stretch.damping",
    "cloth.springs.shear.stiffness",
    "cloth.springs.shear.damping",
    "cloth.springs.bend.stiffness",
    "cloth.springs.bend.damping",
    "cloth.pins",
    "cloth.pins[].at",
    "cloth.pins[].at.rows",
    "cloth.pins[].at.cols",
    "cloth.pins[].velocity",
    "cloth.pins[].amplitude",
    "cloth.pins[].frequency",
    "forces.gravity",
    "forces.damping",
    "forces.wind.velocity",
    "forces.wind.drag",
    "limit.method",
    "limit.strain",
    "limit.springs",
    "limit.sweeps",
    "limit.tolerance",
    "limit.velocity",
    "limit.solver",
    "stepper.plugin",
    "stepper.method",
    "stepper.rtol",
    "stepper.atol",
    "stepper.atol.position",
    "stepper.atol.velocity",
    "stepper.norm",
    "stepper.first_step",
    "stepper.min_step",
    "stepper.max_step",
    "stepper.fixed_step",
    "stepper.butcher.A",
    "stepper.butcher.b",
    "stepper.butcher.c",
    "stepper.butcher.order",
    "stepper.butcher.b_embedded",
    "stepper.butcher.embedded_order",
    "run.duration",
    "run.fps",
    "run.threads",
    "record.precision",
    "record.fields",
    "record.every",
};

START_TEST(help_lists_every_key_with_unit_and_default)
{
    static page markdown, text;
    weft_scene_help(WEFT_HELP_MARKDOWN, add_line, &markdown);
    weft_scene_help(WEFT_HELP_TEXT, add_line, &text);
    for (size_t i = 0; i < COUNT(keys); ++i) {
        char row[100];
        const char *dot = strrchr(keys[i], '.');
        (void)snprintf(row, sizeof row, "| `%s` |", keys[i]);
        ck_assert_msg(strstr(markdown.text, row) != NULL, "no %s", keys[i]);
        ck_assert_msg(strstr(text.text, dot == NULL ? keys[i] : dot + 1) != NULL,
                      "no %s", keys[i]);
    }
    ck_assert_uint_le(text.widest, 80);
    ck_assert_ptr_nonnull(strstr(markdown.text, "[m/s^2] | `[0, -9.81, 0]` |"));
    ck_assert_ptr_nonnull(
        strstr(markdown.text, "[s] | **required** | simulated time |"));
    ck_assert_ptr_nonnull(strstr(text.text, "number >= 0 [kg/(m^2 s)]"));
}
END_TEST

TEST_SUITE(scene_set)
{
    Suite *all = suite_create("scene set");
    TCase *sets = tcase_create("overrides");
    tcase_add_test(sets, overrides_replace_and_add);
    tcase_add_test(sets, overrides_reach_into_lists);
    tcase_add_test(sets, null_removes_a_key);
    tcase_add_test(sets, an_override_changes_its_own_path_and_no_alias);
    tcase_add_loop_test(sets, wrong_overrides_are_placed_at_their_key, 0, COUNT(wrong));
    tcase_add_test(sets, mistakes_of_file_and_overrides_are_told_together);
    suite_add_tcase(all, sets);
    TCase *texts = tcase_create("texts");
    tcase_add_test(texts, the_text_with_overrides_loads_to_an_equal_scene);
    tcase_add_test(texts, without_overrides_the_text_is_that_of_the_file);
    tcase_add_test(texts, name_of_the_file_is_added_below_comments);
    tcase_add_test(texts, help_lists_every_key_with_unit_and_default);
    suite_add_tcase(all, texts);
    return all;
}
