/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: asan-long */
/* Damaged scenes: whatever the text, the reader returns a scene of which a cloth can be
 * made, or mistakes that have a place. The damage is the same in every run. */
#include <stdlib.h>

#include "scene_load.h"

static const char whole[]
    = "weft: 1\n"
      "name: t\xC3\xA9st\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 6, spacing: [0.0625, 0.07], origin: [0.25, -0.5, 2]}\n"
      "  mass: 0.002\n"
      "  loads:\n"
      "    - {at: [3, 3], mass: 0.05}\n"
      "  springs:\n"
      "    law: strain\n"
      "    stretch: &soft {stiffness: 100, damping: 0.1}\n"
      "    shear: *soft\n"
      "  pins:\n"
      "    - top-left\n"
      "    - {rows: [0, 3], cols: all}\n"
      "    - {at: [0, 3], amplitude: [0, 0, 0.2], frequency: 0.5}\n"
      "forces:\n"
      "  gravity: [0, -1.62, 0]\n"
      "  wind: {velocity: [0, 0, 3], drag: 0.5}\n"
      "limit: {method: provot, springs: [stretch], velocity: \"keep\"}\n"
      "stepper:\n"
      "  plugin: arkode\n"
      "  method: custom\n"
      "  atol: {position: 1.0e-7, velocity: 1.0e-8}\n"
      "  butcher: {A: [[], [1/2]], b: [0, 1], c: [0, 1/2], order: 2, b_embedded: [1, "
      "0],\n"
      "    embedded_order: 1}\n"
      "run:\n"
      "  duration: 2.5\n"
      "  fps: 25\n";

static const char *const pieces[] = {
    "&a ",
    "*a",
    "*soft",
    "[",
    "]",
    "{",
    "}",
    ": ",
    ",",
    "- ",
    "\n",
    "\n  ",
    "\t",
    "\"",
    "'",
    "|\n",
    "!!str ",
    "!x ",
    "<<: ",
    "---\n",
    "...\n",
    "#",
    "%",
    "?",
    "~",
    "null",
    "0",
    "-1",
    "1e999",
    ".inf",
    "1e308",
    "010",
    "1/0",
    "\xC3",
    "\xFF",
    "\xE2\x80\xA8",
    "\r",
    "\x01",
    "rows",
    "cols: ",
    "at: ",
    "mass",
    "density",
    "all",
    "bend: ",
    "1e-300",
    "9999999999999999999",
    "2147483648",
    "fixed_step: 1,",
    "{at: top}",
};

#define PIECES (sizeof pieces / sizeof pieces[0])

/* Marsaglia's xorshift64. */
static uint64_t seed;

static size_t below(size_t n)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return (size_t)(seed % n);
}

static void check_items(void)
{
    char text[2048];
    ck_assert_uint_gt(found.count, 0);
    for (size_t i = 0; i < found.count; ++i) {
        const weft_diagnostic *item = &found.items[i];
        const bool in_file = strcmp(item->place, "scene.yaml") == 0;
        ck_assert_int_ge(item->column, 1);
        ck_assert(in_file ? item->line >= 1 : item->line == 0);
        ck_assert(item->message[0] != '\0' && strpbrk(item->message, "\r\n") == NULL);
        ck_assert(strpbrk(item->source, "\r\n") == NULL);
        ck_assert_int_lt(weft_diagnostic_format(item, text, sizeof text), sizeof text);
    }
}

/* What is written of a right scene with an override is a right scene. */
static void check_written(const weft_scene_def *def)
{
    static const char *const sets[] = { "run.fps=31" };
    weft_scene_def changed = *def;
    changed.sets = sets;
    changed.set_count = 1;
    weft_scene *scene = NULL, *again = NULL;
    if (weft_scene_load(&changed, &scene, &found, NULL) != WEFT_OK) {
        return; /* so many frames are too many */
    }
    changed = scene_of_text(weft_scene_text(scene));
    ck_assert_msg(weft_scene_load(&changed, &again, &found, NULL) == WEFT_OK,
                  "%s\nbecame\n%s\n%s", def->text, changed.text, all_found());
    ck_assert_str_eq(weft_scene_method(scene), weft_scene_method(again));
    weft_scene_destroy(scene);
    weft_scene_destroy(again);
}

static void try_scene(const weft_scene_def *def)
{
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    const weft_status status = weft_scene_load(def, &scene, &found, &err);
    if (status != WEFT_OK) {
        ck_assert_int_eq(status, WEFT_BAD_SCENE);
        ck_assert_ptr_null(scene);
        check_items();
        return;
    }
    const weft_cloth_def *cloth_def = weft_scene_cloth(scene);
    if (cloth_def->rows * cloth_def->cols < 100000) {
        weft_cloth *cloth = NULL;
        ck_assert_msg(weft_cloth_create(cloth_def, &cloth, &err) == WEFT_OK, "%s\n%s",
                      err.message, def->text);
        weft_cloth_destroy(cloth);
    }
    weft_scene_destroy(scene);
    check_written(def);
}

START_TEST(a_scene_cut_anywhere_is_right_or_has_located_mistakes)
{
    for (size_t length = 0; length <= strlen(whole); ++length) {
        char *text = malloc(length + 1); /* so that ASan knows where it ends */
        memcpy(text, whole, length);
        text[length] = '\0';
        weft_scene_def def = scene_of_text(text);
        def.length = length;
        try_scene(&def);
        free(text);
    }
}
END_TEST

/* Replaces, removes, inserts or doubles a few bytes. */
static size_t damage(char *text, size_t length, size_t capacity)
{
    const size_t at = below(length + 1);
    const size_t rest = length - at;
    const size_t size = rest == 0 ? 0 : below(rest < 40 ? rest : 40);
    const char *piece = pieces[below(PIECES)];
    const size_t added = strlen(piece);
    switch (below(4)) {
    case 0:
        memmove(text + at, text + at + size, rest - size);
        return length - size;
    case 1:
        if (length + size > capacity) {
            return length;
        }
        memmove(text + at + size, text + at, rest);
        return length + size;
    case 2:
        memcpy(text + at, piece, added < rest ? added : rest);
        return length;
    default:
        if (length + added > capacity) {
            return length;
        }
        memmove(text + at + added, text + at, rest);
        memcpy(text + at, piece, added);
        return length + added;
    }
}

START_TEST(a_damaged_scene_is_right_or_has_located_mistakes)
{
    seed = 0x9E3779B97F4A7C15u + (uint64_t)_i;
    for (int i = 0; i < 2000; ++i) {
        char text[2 * sizeof whole];
        size_t length = strlen(whole);
        memcpy(text, whole, length);
        for (size_t hits = 1 + below(3); hits > 0; --hits) {
            length = damage(text, length, sizeof text - 1);
        }
        text[length] = '\0';
        weft_scene_def def = scene_of_text(text);
        def.length = length;
        try_scene(&def);
    }
}
END_TEST

START_TEST(a_damaged_override_is_right_or_has_located_mistakes)
{
    static const char *const sets[] = {
        "cloth.pins.0=top",     "cloth.springs.shear={stiffness: 3}",
        "cloth.loads.0.at.1=2", "stepper.butcher.b=[1/2, 1/2]",
        "limit=null",
    };
    seed = 0xD1B54A32D192ED03u;
    for (int i = 0; i < 4000; ++i) {
        char text[2][200];
        const char *given[2] = { text[0], text[1] };
        for (size_t k = 0; k < 2; ++k) {
            const char *set = sets[below(sizeof sets / sizeof sets[0])];
            memcpy(text[k], set, strlen(set));
            const size_t length = damage(text[k], strlen(set), sizeof text[k] - 1);
            text[k][length] = '\0';
        }
        weft_scene_def def = scene_of_text(whole);
        def.sets = given;
        def.set_count = 2;
        try_scene(&def);
    }
}
END_TEST

TEST_SUITE(scene_fuzz)
{
    Suite *all = suite_create("scene fuzz");
    TCase *fuzz = tcase_create("fuzz");
    tcase_set_timeout(fuzz, 120);
    tcase_add_test(fuzz, a_scene_cut_anywhere_is_right_or_has_located_mistakes);
    tcase_add_loop_test(fuzz, a_damaged_scene_is_right_or_has_located_mistakes, 0, 10);
    tcase_add_test(fuzz, a_damaged_override_is_right_or_has_located_mistakes);
    suite_add_tcase(all, fuzz);
    return all;
}
