/* SPDX-License-Identifier: BSD-3-Clause */
/* What a right scene is read as: values, defaults, places, numbers. */
#include <math.h>

#include "scene_load.h"

#define CLOTH   "cloth:\n  grid: {rows: 3, cols: 4, spacing: 0.1}\n  mass: 0.01\n"
#define STEPPER "stepper: {plugin: gsl, method: rkf45}\n"
#define RUN     "run: {duration: 1}\n"

/* The scene of SCENE.md, without the keys that exclude others. */
static const char whole[]
    = "weft: 1\n"
      "name: hanging by two corners\n"
      "cloth:\n"
      "  grid:\n"
      "    rows: 17\n"
      "    cols: 18\n"
      "    spacing: [0.0625, 0.07]\n"
      "    origin: [0.25, -0.5, 2]\n"
      "    right: [0, 0, 2]\n"
      "    down: [0.5, -1, 0]\n"
      "    scale: 1.25\n"
      "  density: 0.2\n"
      "  velocity: [0.1, 0.2, 0.3]\n"
      "  loads:\n"
      "    - {at: [8, 8], mass: 0.05}\n"
      "    - {at: bottom, mass: 0.01}\n"
      "  springs:\n"
      "    law: strain\n"
      "    stretch: {stiffness: 100, damping: 0.1}\n"
      "    shear:   {stiffness: 50}\n"
      "    bend:    {stiffness: 5}\n"
      "  pins:\n"
      "    - top-left\n"
      "    - top\n"
      "    - [0, 8]\n"
      "    - {rows: [0, 3], cols: all}\n"
      "    - {at: top-right, velocity: [0.1, 0, 0]}\n"
      "    - {at: [0, 3], amplitude: [0, 0, 0.2], frequency: 0.5}\n"
      "forces:\n"
      "  gravity: [0, -1.62, 0]\n"
      "  damping: 0.003\n"
      "  wind: {velocity: [0, 0, 3], drag: 0.5}\n"
      "limit:\n"
      "  method: provot\n"
      "  strain: 0.15\n"
      "  springs: [stretch, bend]\n"
      "  sweeps: 50\n"
      "  tolerance: 2.0e-3\n"
      "  velocity: keep\n"
      "  solver: sweep\n"
      "stepper:\n"
      "  plugin: gsl\n"
      "  method: rkf45\n"
      "  rtol: 1.0e-5\n"
      "  atol: {position: 1.0e-7, velocity: 1.0e-8}\n"
      "  norm: rms\n"
      "  first_step: 2.0e-3\n"
      "  min_step: 1.0e-11\n"
      "  max_step: 0.01\n"
      "run:\n"
      "  duration: 2.5\n"
      "  fps: 25\n"
      "  threads: 3\n"
      "record:\n"
      "  precision: double\n"
      "  fields: [strain]\n"
      "  every: 4\n";

static void vector_is(const double *v, double x, double y, double z)
{
    ck_assert_msg(v[0] == x && v[1] == y && v[2] == z, "[%g, %g, %g]", v[0], v[1],
                  v[2]);
}

static void ranges_are(weft_range rows, weft_range cols, int r0, int r1, int c0, int c1)
{
    ck_assert_msg(rows.first == r0 && rows.last == r1 && cols.first == c0
                      && cols.last == c1,
                  "rows %td to %td, columns %td to %td", rows.first, rows.last,
                  cols.first, cols.last);
}

static void pin_is(const weft_cloth_def *cloth, size_t i, int r0, int r1, int c0,
                   int c1)
{
    ck_assert_uint_lt(i, cloth->pin_count);
    ranges_are(cloth->pins[i].rows, cloth->pins[i].cols, r0, r1, c0, c1);
}

static void check_grid_and_masses(const weft_cloth_def *cloth)
{
    ck_assert_uint_eq(cloth->rows, 17);
    ck_assert_uint_eq(cloth->cols, 18);
    ck_assert(cloth->spacing[0] == 0.0625 && cloth->spacing[1] == 0.07);
    vector_is(cloth->origin, 0.25, -0.5, 2.0);
    vector_is(cloth->right, 0.0, 0.0, 2.0);
    vector_is(cloth->down, 0.5, -1.0, 0.0);
    ck_assert(cloth->scale == 1.25 && cloth->density == 0.2 && cloth->mass == 0.0);
    vector_is(cloth->velocity, 0.1, 0.2, 0.3);
    ck_assert_uint_eq(cloth->load_count, 2);
    ranges_are(cloth->loads[0].rows, cloth->loads[0].cols, 8, 8, 8, 8);
    ranges_are(cloth->loads[1].rows, cloth->loads[1].cols, -1, -1, 0, -1);
    ck_assert(cloth->loads[0].mass == 0.05 && cloth->loads[1].mass == 0.01);
}

static void check_springs_and_pins(const weft_cloth_def *cloth)
{
    ck_assert_int_eq(cloth->law, WEFT_LAW_STRAIN);
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        ck_assert(cloth->springs[i].present);
        ck_assert(cloth->springs[i].damping == (i == WEFT_STRETCH ? 0.1 : 0.0));
    }
    ck_assert(cloth->springs[WEFT_STRETCH].stiffness == 100.0);
    ck_assert(cloth->springs[WEFT_SHEAR].stiffness == 50.0);
    ck_assert(cloth->springs[WEFT_BEND].stiffness == 5.0);
    ck_assert_uint_eq(cloth->pin_count, 6);
    pin_is(cloth, 0, 0, 0, 0, 0);
    pin_is(cloth, 1, 0, 0, 0, -1);
    pin_is(cloth, 2, 0, 0, 8, 8);
    pin_is(cloth, 3, 0, 3, 0, -1);
    pin_is(cloth, 4, 0, 0, -1, -1);
    pin_is(cloth, 5, 0, 0, 3, 3);
    vector_is(cloth->pins[0].velocity, 0.0, 0.0, 0.0);
    vector_is(cloth->pins[4].velocity, 0.1, 0.0, 0.0);
    vector_is(cloth->pins[5].amplitude, 0.0, 0.0, 0.2);
    ck_assert(cloth->pins[4].frequency == 0.0 && cloth->pins[5].frequency == 0.5);
}

static void check_forces_and_limit(const weft_cloth_def *cloth,
                                   const weft_limit_def *limit)
{
    vector_is(cloth->gravity, 0.0, -1.62, 0.0);
    vector_is(cloth->wind_velocity, 0.0, 0.0, 3.0);
    ck_assert(cloth->damping == 0.003 && cloth->wind_drag == 0.5);
    ck_assert_int_eq(limit->method, WEFT_LIMIT_PROVOT);
    ck_assert(limit->strain == 0.15 && limit->tolerance == 2.0e-3);
    ck_assert(limit->families[WEFT_STRETCH] && !limit->families[WEFT_SHEAR]
              && limit->families[WEFT_BEND]);
    ck_assert_uint_eq(limit->sweeps, 50);
    ck_assert(limit->keep_velocity);
    ck_assert_int_eq(limit->solver, WEFT_LIMIT_SWEEP);
}

static void check_stepper_and_run(const weft_scene *scene)
{
    const weft_stepper_config *config = weft_scene_config(scene);
    const weft_run_def *run = weft_scene_run(scene);
    ck_assert_str_eq(weft_scene_plugin(scene), "gsl");
    ck_assert_str_eq(weft_scene_method(scene), "rkf45");
    ck_assert_str_eq(weft_scene_method_type(scene)->name, "rkf45");
    ck_assert_uint_eq(config->struct_size, sizeof *config);
    ck_assert(config->rtol == 1.0e-5 && config->atol_position == 1.0e-7
              && config->atol_velocity == 1.0e-8);
    ck_assert_int_eq(config->norm, WEFT_NORM_RMS);
    ck_assert(config->first_step == 2.0e-3 && config->min_step == 1.0e-11
              && config->max_step == 0.01 && config->fixed_step == 0.0);
    ck_assert_ptr_null(config->butcher);
    ck_assert(run->duration == 2.5 && run->fps == 25.0);
    ck_assert_uint_eq(run->threads, 3);
    ck_assert_uint_eq(config->threads, 3);
}

static void check_record(const weft_record_def *record)
{
    ck_assert(record->doubles);
    ck_assert_uint_eq(record->every, 4);
    for (size_t i = 0; i < WEFT_RECORD_FIELDS; ++i) {
        ck_assert(record->fields[i] == (i == WEFT_RECORD_STRAIN));
    }
}

START_TEST(every_value_of_the_example_arrives)
{
    weft_scene *scene = good_text(whole);
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_str_eq(weft_scene_name(scene), "hanging by two corners");
    ck_assert_str_eq(weft_scene_text(scene), whole);
    check_grid_and_masses(weft_scene_cloth(scene));
    check_springs_and_pins(weft_scene_cloth(scene));
    check_forces_and_limit(weft_scene_cloth(scene), weft_scene_limit(scene));
    check_stepper_and_run(scene);
    check_record(weft_scene_record(scene));
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(defaults_are_those_of_the_definition_structs)
{
    weft_scene *scene = good_text("weft: 1\n" CLOTH STEPPER RUN);
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const weft_cloth_def wanted = weft_cloth_def_default();
    const weft_stepper_config *config = weft_scene_config(scene);
    const weft_stepper_config stepper = weft_stepper_config_default();
    ck_assert_str_eq(weft_scene_name(scene), "scene");
    ck_assert_mem_eq(cloth->origin, wanted.origin, sizeof wanted.origin);
    ck_assert_mem_eq(cloth->right, wanted.right, sizeof wanted.right);
    ck_assert_mem_eq(cloth->down, wanted.down, sizeof wanted.down);
    ck_assert_mem_eq(cloth->velocity, wanted.velocity, sizeof wanted.velocity);
    ck_assert_mem_eq(cloth->gravity, wanted.gravity, sizeof wanted.gravity);
    ck_assert_mem_eq(cloth->springs, wanted.springs, sizeof wanted.springs);
    ck_assert(cloth->scale == wanted.scale && cloth->damping == wanted.damping);
    ck_assert(cloth->wind_drag == wanted.wind_drag && cloth->law == wanted.law);
    ck_assert(cloth->spacing[0] == 0.1 && cloth->spacing[1] == 0.1);
    ck_assert_ptr_null(cloth->pins);
    ck_assert_ptr_null(cloth->loads);
    ck_assert_int_eq(config->norm, stepper.norm);
    ck_assert(config->rtol == stepper.rtol
              && config->atol_position == stepper.atol_position
              && config->atol_velocity == stepper.atol_velocity);
    ck_assert(config->first_step == stepper.first_step
              && config->min_step == stepper.min_step
              && config->max_step == stepper.max_step
              && config->fixed_step == stepper.fixed_step);
    ck_assert_int_eq(weft_scene_limit(scene)->method, WEFT_LIMIT_NONE);
    ck_assert(weft_scene_run(scene)->fps == 30.0);
    ck_assert_uint_eq(weft_scene_run(scene)->threads, 1);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(all_is_recorded_in_single_precision_unless_told_otherwise)
{
    weft_scene *scene = good_text("weft: 1\n" CLOTH STEPPER RUN);
    const weft_record_def *record = weft_scene_record(scene);
    ck_assert(!record->doubles && record->every == 1);
    for (size_t i = 0; i < WEFT_RECORD_FIELDS; ++i) {
        ck_assert(record->fields[i]);
    }
    weft_scene_destroy(scene);
    scene = good_text("weft: 1\n" CLOTH STEPPER RUN "record: {fields: []}\n");
    record = weft_scene_record(scene);
    for (size_t i = 0; i < WEFT_RECORD_FIELDS; ++i) {
        ck_assert(!record->fields[i]);
    }
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(a_limit_has_the_defaults_of_the_contract)
{
    weft_scene *scene = good_text("weft: 1\n" CLOTH
                                  "  springs: {stretch: {stiffness: 1}}\n" STEPPER RUN
                                  "limit: {method: bridson, velocity: update}\n");
    const weft_limit_def *limit = weft_scene_limit(scene);
    ck_assert_int_eq(limit->method, WEFT_LIMIT_BRIDSON);
    ck_assert(limit->strain == 0.1 && limit->tolerance == 1.0e-3);
    ck_assert(limit->families[WEFT_STRETCH] && limit->families[WEFT_SHEAR]
              && !limit->families[WEFT_BEND]);
    ck_assert_uint_eq(limit->sweeps, 100);
    ck_assert(!limit->keep_velocity);
    ck_assert_int_eq(limit->solver, WEFT_LIMIT_FAST);
    ck_assert_uint_eq(found.count, 0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(places_have_many_forms)
{
    weft_scene *scene = good_text(
        "weft: 1\n" CLOTH
        "  pins: [top-left, top-right, bottom-left, bottom-right, top, bottom, left, "
        "right, [1, -1], {row: 1, col: -2}, {rows: [-2, -1], cols: 3}, {rows: all, "
        "cols: [1, 1]}, {at: {row: 0, cols: [0, -2]}}]\n" STEPPER RUN);
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert_uint_eq(cloth->pin_count, 13);
    pin_is(cloth, 0, 0, 0, 0, 0);
    pin_is(cloth, 1, 0, 0, -1, -1);
    pin_is(cloth, 2, -1, -1, 0, 0);
    pin_is(cloth, 3, -1, -1, -1, -1);
    pin_is(cloth, 4, 0, 0, 0, -1);
    pin_is(cloth, 5, -1, -1, 0, -1);
    pin_is(cloth, 6, 0, -1, 0, 0);
    pin_is(cloth, 7, 0, -1, -1, -1);
    pin_is(cloth, 8, 1, 1, -1, -1);
    pin_is(cloth, 9, 1, 1, -2, -2);
    pin_is(cloth, 10, -2, -1, 3, 3);
    pin_is(cloth, 11, 0, -1, 1, 1);
    pin_is(cloth, 12, 0, 0, 0, -2);
    weft_scene_destroy(scene);
}
END_TEST

/* Writings of a duration that are numbers, and which. */
static const struct {
    const char *text;
    double value;
} numbers[] = {
    { "5", 5.0 },        { "+5", 5.0 },
    { "5.", 5.0 },       { ".5", 0.5 },
    { "0.5", 0.5 },      { "1e3", 1000.0 },
    { "1.5E+2", 150.0 }, { "2e-3", 2e-3 },
    { "0.1", 0.1 },      { "!!float 5", 5.0 },
    { "!!int 5", 5.0 },  { "12345678901234567890e-17", 123.45678901234568 },
};

START_TEST(decimal_numbers_are_read_to_the_last_bit)
{
    char text[512];
    (void)snprintf(text, sizeof text, "weft: 1\n" CLOTH STEPPER "run: {duration: %s}\n",
                   numbers[_i].text);
    weft_scene *scene = good_text(text);
    ck_assert(weft_scene_run(scene)->duration == numbers[_i].value);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(tables_of_times_are_read_row_by_row)
{
    const double path[] = { -1, 0, 0, 0, 2.5, 1, 2, 3 }, gust[] = { 0, 4, 5, 6 };
    weft_scene *scene = good_text(
        "weft: 1\n" CLOTH "  pins: [{at: top, path: [[-1, 0, 0, 0], [2.5, 1, 2, 3]]}]\n"
        "forces: {wind: {table: [[0, 4, 5, 6]], drag: 1}}\n" STEPPER
        "run: {duration: 1}\n");
    const weft_cloth_def *def = weft_scene_cloth(scene);
    ck_assert_uint_eq(def->pins[0].path.count, 2);
    ck_assert_mem_eq(def->pins[0].path.rows, path, sizeof path);
    ck_assert_uint_eq(def->wind_table.count, 1);
    ck_assert_mem_eq(def->wind_table.rows, gust, sizeof gust);
    weft_scene_destroy(scene);
}
END_TEST

/* Of a file as spreadsheets write it; the scene's text has the rows. */
START_TEST(tables_of_times_are_read_from_files)
{
    const double rows[] = { -1, 0, 0, 0, 2.5, 1, 2, 3 };
    FILE *file = fopen(BUILD_DIR "/tests/table.csv", "w");
    ck_assert_ptr_nonnull(file);
    fputs("\xEF\xBB\xBFt,x,y,z\r\n-1,0,0,0\r\n2.5, 1, 2, 3\r\n\r\n", file);
    ck_assert_int_eq(fclose(file), 0);
    weft_scene *scene
        = good_text("weft: 1\n" CLOTH "  pins:\n"
                    "    - {at: top, path: {rows: " BUILD_DIR
                    "/tests/table.csv, spline: natural}}\n"
                    "forces: {wind: {table: " BUILD_DIR
                    "/tests/table.csv, drag: 1}}\n" STEPPER "run: {duration: 1}\n");
    const weft_cloth_def *def = weft_scene_cloth(scene);
    ck_assert_uint_eq(def->pins[0].path.count, 2);
    ck_assert_mem_eq(def->pins[0].path.rows, rows, sizeof rows);
    ck_assert_mem_eq(def->wind_table.rows, rows, sizeof rows);
    ck_assert(def->pins[0].path_natural && !def->wind_table_natural);
    ck_assert_ptr_null(strstr(weft_scene_text(scene), ".csv"));
    ck_assert_ptr_nonnull(strstr(weft_scene_text(scene), "- [2.5, 1, 2, 3]"));
    weft_scene_destroy(scene);
    (void)remove(BUILD_DIR "/tests/table.csv");
}
END_TEST

static const char *const no_numbers[]
    = { "010",    "1_000", "0x10",     "0o10",  "\"5\"", "'5'",   "!!str 5", "! 5",
        "1,000",  "5s",    "5 s",      "one",   "yes",   ".nan",  ".inf",    "1e999",
        "--5",    "5-",    "1e",       "e5",    ".",     "-.",    "~",       "[5]",
        "{a: 5}", "0b1",   "Infinity", "1.2.3", "00.5",  "1e5.5", "\"\"" };

START_TEST(what_is_no_decimal_number_is_refused_where_it_stands)
{
    char text[512];
    (void)snprintf(text, sizeof text,
                   "weft: 1\n" CLOTH STEPPER "run:\n  duration: %s\n", no_numbers[_i]);
    const weft_scene_def def = scene_of_text(text);
    const char *told = bad_scene(&def);
    ck_assert_msg(strncmp(told, "scene.yaml:7:13: error: duration", 32) == 0
                      || strcmp(no_numbers[_i], "1,000") == 0,
                  "%s", told);
    ck_assert_uint_eq(found.errors, 1);
}
END_TEST

START_TEST(numbers_do_not_depend_on_the_locale)
{
    if (!test_comma_locale()) {
        return;
    }
    weft_scene *scene = good_text("weft: 1\n" CLOTH STEPPER "run: {duration: 2.5}\n");
    ck_assert(weft_scene_run(scene)->duration == 2.5);
    weft_scene_destroy(scene);
    const weft_scene_def bad
        = scene_of_text("weft: 1\n" CLOTH STEPPER "run: {duration: -0.5}\n");
    ck_assert_ptr_nonnull(strstr(bad_scene(&bad), "'-0.5'"));
}
END_TEST

START_TEST(a_butcher_table_is_read_with_fractions_and_short_rows)
{
    weft_scene *scene = good_text(
        "weft: 1\n" CLOTH "stepper:\n  plugin: arkode\n  method: custom\n  butcher:\n"
        "    A: [[], [1/2], [0, '3/4', 0], [\"2/9\", 1 / 3, 4/9]]\n"
        "    b: [2/9, 1/3, 4/9, 0]\n    c: [0, 0.5, 0.75, 1]\n    order: 3\n"
        "    b_embedded: [7/24, 1/4, 1/3, 1/8]\n    embedded_order: 2\n" RUN);
    static const double a[] = { 0, 0,    0, 0, 0.5,       0,         0,         0,
                                0, 0.75, 0, 0, 2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0 };
    static const double b[] = { 2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0, 0 };
    static const double c[] = { 0, 0.5, 0.75, 1 };
    static const double e[] = { 7.0 / 24.0, 0.25, 1.0 / 3.0, 0.125 };
    const weft_butcher *table = weft_scene_config(scene)->butcher;
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_int_eq(table->stages, 4);
    ck_assert_int_eq(table->order, 3);
    ck_assert_int_eq(table->embedded_order, 2);
    ck_assert_mem_eq(table->a, a, sizeof a);
    ck_assert_mem_eq(table->b, b, sizeof b);
    ck_assert_mem_eq(table->c, c, sizeof c);
    ck_assert_mem_eq(table->b_embedded, e, sizeof e);
    weft_scene_destroy(scene);
}
END_TEST

/* Ways to write the same scene. */
static const char *const writings[] = {
    "weft: 1\r\n# comment\r\ncloth: {grid: {rows: 3, cols: 4, spacing: 0.1}, mass: "
    "0.01}"
    "\r\n" STEPPER RUN,
    "\xEF\xBB\xBFweft: 1\n" CLOTH STEPPER RUN,
    "%YAML 1.1\n---\nweft: 1\n" CLOTH STEPPER RUN "...\n",
    "--- # one document\n" RUN STEPPER CLOTH "'weft': 1",
    "weft: 1\n" CLOTH
    "stepper: {plugin: 'gsl', \"method\": \"rkf45\"}\nrun: {duration: &d "
    "1, fps: 30}\n",
    ("{weft: 1, cloth: {grid: {rows: &n 3, cols: 4, spacing: [0.1, 0.1]}, mass: 0.01,\n"
     "pins: []}, stepper: {plugin: gsl, method: rkf45}, run: {duration: 1}, forces: "
     "{}}"),
};

START_TEST(the_same_scene_may_be_written_in_other_ways)
{
    weft_scene *scene = good_text(writings[_i]);
    ck_assert_msg(found.count == 0, "%s", all_found());
    ck_assert_uint_eq(weft_scene_cloth(scene)->rows, 3);
    ck_assert_uint_eq(weft_scene_cloth(scene)->cols, 4);
    ck_assert(weft_scene_cloth(scene)->spacing[1] == 0.1);
    ck_assert(weft_scene_run(scene)->duration == 1.0);
    ck_assert_str_eq(weft_scene_method(scene), "rkf45");
    ck_assert_str_eq(weft_scene_text(scene), writings[_i]);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(aliases_stand_for_what_they_name)
{
    weft_scene *scene
        = good_text("weft: 1\n" CLOTH
                    "  springs:\n    stretch: &soft {stiffness: &k 3, damping: 0.5}\n"
                    "    shear: *soft\n    bend: {stiffness: *k}\n" STEPPER RUN);
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    ck_assert(cloth->springs[WEFT_SHEAR].stiffness == 3.0);
    ck_assert(cloth->springs[WEFT_SHEAR].damping == 0.5);
    ck_assert(cloth->springs[WEFT_BEND].stiffness == 3.0);
    weft_scene_destroy(scene);
}
END_TEST

START_TEST(without_plugins_only_custom_is_known)
{
    weft_scene_def def = scene_of_text(
        "weft: 1\n" CLOTH RUN "stepper: {plugin: other, method: any, rtol: 0}\n");
    def.find_plugin = NULL;
    weft_scene *scene = good_scene(&def);
    ck_assert_ptr_null(weft_scene_method_type(scene));
    weft_scene_destroy(scene);
    def = scene_of_text("weft: 1\n" CLOTH RUN
                        "stepper: {plugin: arkode, method: custom}\n");
    def.find_plugin = NULL;
    ck_assert_ptr_nonnull(strstr(bad_scene(&def), "needs a table: butcher"));
}
END_TEST

START_TEST(the_name_defaults_to_that_of_the_file)
{
    static const char *const files[]
        = { "a/b/flag.yaml", "flag.yaml", "/flag", "flag.yml" };
    for (size_t i = 0; i < sizeof files / sizeof files[0]; ++i) {
        weft_scene_def def = scene_of_text("weft: 1\n" CLOTH STEPPER RUN);
        def.file = files[i];
        weft_scene *scene = good_scene(&def);
        ck_assert_str_eq(weft_scene_name(scene), "flag");
        weft_scene_destroy(scene);
    }
}
END_TEST

START_TEST(true_and_false_are_read)
{
    static const char *const words[] = { "true", "True", "TRUE", "false", "FALSE" };
    for (size_t i = 0; i < 5; ++i) {
        char text[512];
        (void)snprintf(text, sizeof text,
                       "cloth: {grid: {rows: 2, cols: 2, spacing: 1}, mass: 1}\n"
                       "stepper: {plugin: gsl, method: rkf45}\n"
                       "run: {duration: 1}\nrecord: {ledger: %s}\n",
                       words[i]);
        weft_scene *scene = good_text(text);
        ck_assert(weft_scene_record(scene)->ledger == (i < 3));
        weft_scene_destroy(scene);
    }
}
END_TEST

START_TEST(version_1_is_the_default)
{
    weft_scene_destroy(good_text(CLOTH STEPPER RUN));
}
END_TEST

TEST_SUITE(scene)
{
    Suite *all = suite_create("scene");
    TCase *values = tcase_create("values");
    tcase_add_test(values, version_1_is_the_default);
    tcase_add_test(values, true_and_false_are_read);
    tcase_add_test(values, every_value_of_the_example_arrives);
    tcase_add_test(values, defaults_are_those_of_the_definition_structs);
    tcase_add_test(values, all_is_recorded_in_single_precision_unless_told_otherwise);
    tcase_add_test(values, a_limit_has_the_defaults_of_the_contract);
    tcase_add_test(values, places_have_many_forms);
    tcase_add_loop_test(values, decimal_numbers_are_read_to_the_last_bit, 0,
                        sizeof numbers / sizeof numbers[0]);
    tcase_add_loop_test(values, what_is_no_decimal_number_is_refused_where_it_stands, 0,
                        sizeof no_numbers / sizeof no_numbers[0]);
    tcase_add_test(values, numbers_do_not_depend_on_the_locale);
    tcase_add_test(values, tables_of_times_are_read_row_by_row);
    tcase_add_test(values, tables_of_times_are_read_from_files);
    tcase_add_test(values, a_butcher_table_is_read_with_fractions_and_short_rows);
    suite_add_tcase(all, values);
    TCase *loading = tcase_create("loading");
    tcase_add_loop_test(loading, the_same_scene_may_be_written_in_other_ways, 0,
                        sizeof writings / sizeof writings[0]);
    tcase_add_test(loading, aliases_stand_for_what_they_name);
    tcase_add_test(loading, without_plugins_only_custom_is_known);
    tcase_add_test(loading, the_name_defaults_to_that_of_the_file);
    suite_add_tcase(all, loading);
    return all;
}
