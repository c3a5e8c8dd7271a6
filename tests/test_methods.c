/* SPDX-License-Identifier: BSD-3-Clause */
/* test_methods.c -- a method by the names of its plugin and its own, and what is said
 * of one that is not there. */
#include <string.h>

#include "plugin/methods.h"
#include "plugin/missing.h"
#include "support.h"

#define PLUGINS BUILD_DIR "/plugins"
#define BROKEN  BUILD_DIR "/tests/broken"

static weft_registry *registry;
static weft_error err;

static void look_in(const char *path)
{
    const weft_registry_def def = { .struct_size = sizeof def, .path = path };
    ck_assert_int_eq(weft_registry_create(&def, &registry, &err), WEFT_OK);
}

static void end(void)
{
    weft_registry_destroy(registry);
}

static void not_found(weft_status wanted, const char *plugin, const char *method)
{
    const weft_stepper_type *type = test_method(0);
    ck_assert_int_eq(weft_registry_method(registry, plugin, method, &type, &err),
                     wanted);
    ck_assert_int_eq(err.status, wanted);
    ck_assert_ptr_null(type);
}

START_TEST(no_plugin_has_no_method)
{
    ck_assert_ptr_null(weft_plugin_method(NULL, "midpoint"));
}
END_TEST

START_TEST(a_method_is_found_or_what_there_is_told)
{
    const weft_stepper_type *type = NULL;
    look_in(PLUGINS);
    ck_assert_msg(weft_registry_method(registry, "verlet", "midpoint", &type, &err)
                      == WEFT_OK,
                  "%s", err.message);
    ck_assert_str_eq(type->name, "midpoint");
    not_found(WEFT_INVALID, "verlet", "midpiont");
    ck_assert_str_eq(err.message,
                     "plugin 'verlet' has no method 'midpiont' (did you mean "
                     "'midpoint'?); it has symplectic_euler, velocity_verlet, euler, "
                     "midpoint");
}
END_TEST

/* Each once, though it is there already or lies in two folders; nothing is loaded. */
START_TEST(a_plugin_that_is_not_there_is_told_with_those_that_are)
{
    const weft_plugin *plugin = NULL;
    look_in(PLUGINS ":" PLUGINS);
    ck_assert_int_eq(weft_registry_find(registry, "verlet", &plugin, &err), WEFT_OK);
    not_found(WEFT_BAD_PLUGIN, "velret", "midpoint");
    const char *names = strstr(err.message, " (did you mean 'verlet'?); there are ");
    ck_assert_msg(names != NULL, "%s", err.message);
    names = strstr(names, "there are ");
    ck_assert_ptr_eq(strstr(names, "verlet"), names + strlen("there are "));
    ck_assert_ptr_null(strstr(strstr(names, "verlet") + 1, "verlet"));
    ck_assert_uint_eq(weft_registry_count(registry), 1);
}
END_TEST

START_TEST(an_empty_search_path_is_told_with_what_to_do)
{
    look_in("");
    not_found(WEFT_BAD_PLUGIN, "arkode", "dormand_prince");
    ck_assert_str_eq(err.message,
                     "plugin 'arkode' not found: no weft-arkode.so in an empty search "
                     "path; set WEFT_PLUGIN_PATH or weft_registry_def.path");
}
END_TEST

START_TEST(a_plugin_that_is_refused_is_told_with_the_reason_alone)
{
    look_in(BROKEN);
    not_found(WEFT_BAD_PLUGIN, "noentry", "first");
    ck_assert_str_eq(err.message,
                     "plugin refused: " BROKEN "/weft-noentry.so: it has no function "
                     "weft_plugin_noentry() (is it exported, with "
                     "WEFT_API?)");
}
END_TEST

START_TEST(a_plugin_that_comes_with_weft_is_told_with_what_installs_it)
{
    const struct {
        const char *by, *id, *advice;
    } all[] = {
        { "source", "gsl",
          "install GSL (Debian: apt-get install libgsl-dev) and build weft again" },
        { "pip", "gsl", "pip install weft-gsl" },
        { "debian", "gsl", "apt-get install weft-plugin-gsl" },
        { "debian", "cvode", "apt-get install weft-plugins-sundials" },
        { "spack", "arkode", "spack install weft +sundials" },
        { "pip", "verlet", NULL },
        { "source", "nix", NULL },
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i) {
        ck_assert_pstr_eq(weft__plugin_advice(all[i].by, all[i].id), all[i].advice);
    }
    look_in("/nowhere");
    not_found(WEFT_BAD_PLUGIN, "gsl", "rkf45");
    ck_assert_str_eq(err.message,
                     "plugin 'gsl' not found: install GSL (Debian: apt-get install "
                     "libgsl-dev) and build weft again; no weft-gsl.so in /nowhere");
}
END_TEST

static const weft_plugin *find_shipped(void *ctx, const char *id, weft_error *why)
{
    const weft_plugin *plugin = NULL;
    const char *without = ctx;
    if (strcmp(id, without) != 0) {
        (void)weft_registry_find(registry, id, &plugin, why);
    }
    return plugin;
}

/* The method named in "; PLUGIN/METHOD does the same" or "comes closest". */
static const weft_stepper_type *named_in(const char *text, bool *same)
{
    char plugin[32], method[40], rest[40];
    const weft_stepper_type *type = NULL;
    ck_assert_int_eq(sscanf(text, "; %31[^/]/%39s %39[^\n]", plugin, method, rest), 3);
    *same = strcmp(rest, "does the same") == 0;
    ck_assert(*same || strcmp(rest, "comes closest") == 0);
    ck_assert_int_eq(weft_registry_method(registry, plugin, method, &type, &err),
                     WEFT_OK);
    return type;
}

START_TEST(a_method_that_is_named_instead_is_there_and_of_the_same_kind)
{
    const uint32_t kind = WEFT_STEPPER_MULTISTEP | WEFT_STEPPER_IMPLICIT;
    char text[96];
    size_t found = 0;
    look_in(PLUGINS);
    ck_assert_int_eq(weft_registry_load_all(registry, NULL, NULL, &err), WEFT_OK);
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        const weft_plugin *of = weft_registry_at(registry, i);
        for (size_t k = 0; of->types[k] != NULL; ++k) {
            const weft_stepper_type *type = of->types[k];
            bool same;
            (void)weft__method_instead(of->id, type->name, find_shipped, (void *)of->id,
                                       text, sizeof text);
            if (text[0] != '\0') {
                const weft_stepper_type *other = named_in(text, &same);
                ck_assert((type->flags & WEFT_STEPPER_MULTISTEP) != 0
                          || type->order == other->order);
                ck_assert(!same
                          || (type->order == other->order
                              && type->error_order == other->error_order
                              && type->stages == other->stages
                              && (type->flags & kind) == (other->flags & kind)));
                ++found;
            }
        }
    }
    ck_assert_uint_ge(found, 2);
    if (find_shipped("", "arkode", &err) != NULL) {
        ck_assert_str_eq(weft__method_instead("gsl", "rkf45", find_shipped, "gsl", text,
                                              sizeof text),
                         "; arkode/fehlberg45 does the same");
        ck_assert_str_eq(weft__method_instead("gsl", "rkf45", find_shipped, "arkode",
                                              text, sizeof text),
                         "");
    }
}
END_TEST

START_TEST(a_file_that_cannot_be_opened_is_named_once)
{
    static const char file[] = BUILD_DIR "/weft-text.so";
    static const char start[] = "plugin refused: " BUILD_DIR "/weft-text.so: ";
    FILE *stream = fopen(file, "w");
    ck_assert_ptr_nonnull(stream);
    fputs("no plugin\n", stream);
    fclose(stream);
    look_in("");
    ck_assert_int_eq(weft_registry_load(registry, file, &err), WEFT_BAD_PLUGIN);
    ck_assert_int_eq(strncmp(err.message, start, strlen(start)), 0);
    ck_assert_uint_gt(strlen(err.message), strlen(start));
    ck_assert_ptr_null(strstr(err.message + strlen(start), "weft-text"));
    ck_assert_int_eq(remove(file), 0);
}
END_TEST

static weft_status refuse_verlet(void *ctx, const char *file, weft_error *why)
{
    ++*(size_t *)ctx;
    return strstr(file, "verlet") == NULL
               ? WEFT_OK
               : weft_error_set(why, WEFT_BAD_PLUGIN, "not today");
}

START_TEST(a_plugin_that_is_not_admitted_is_refused_and_not_loaded)
{
    size_t asked = 0;
    const weft_plugin *plugin = NULL;
    const weft_registry_def def = { .struct_size = sizeof def,
                                    .path = PLUGINS,
                                    .admit = refuse_verlet,
                                    .admit_ctx = &asked };
    ck_assert_int_eq(weft_registry_create(&def, &registry, &err), WEFT_OK);
    ck_assert_int_eq(weft_registry_find(registry, "verlet", &plugin, &err),
                     WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message,
                     "plugin refused: " PLUGINS "/weft-verlet.so: not today");
    ck_assert_uint_eq(asked, 1);
    (void)weft_registry_load_all(registry, NULL, NULL, NULL);
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        ck_assert_str_ne(weft_registry_at(registry, i)->id, "verlet");
    }
    ck_assert_uint_eq(asked, 2 + weft_registry_count(registry));
}
END_TEST

TEST_SUITE(methods)
{
    Suite *suite = suite_create("methods");
    TCase *tcase = tcase_create("methods");
    tcase_add_checked_fixture(tcase, NULL, end);
    tcase_add_test(tcase, no_plugin_has_no_method);
    tcase_add_test(tcase, a_method_is_found_or_what_there_is_told);
    tcase_add_test(tcase, a_plugin_that_is_not_there_is_told_with_those_that_are);
    tcase_add_test(tcase, an_empty_search_path_is_told_with_what_to_do);
    tcase_add_test(tcase, a_plugin_that_is_refused_is_told_with_the_reason_alone);
    tcase_add_test(tcase, a_plugin_that_is_not_admitted_is_refused_and_not_loaded);
    tcase_add_test(tcase, a_plugin_that_comes_with_weft_is_told_with_what_installs_it);
    tcase_add_test(tcase, a_method_that_is_named_instead_is_there_and_of_the_same_kind);
    tcase_add_test(tcase, a_file_that_cannot_be_opened_is_named_once);
    suite_add_tcase(suite, tcase);
    return suite;
}
