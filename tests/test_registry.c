/* SPDX-License-Identifier: BSD-3-Clause */
/* test_registry.c -- plugins: where they are looked for, what is refused and why. The
 * broken ones are built from tests/broken, where weft-good.so has nothing wrong and
 * weft-crash.so nothing that loading could find. */
#include "support.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define PATH         1024

/* A folder with three in it, what else was made there, and a registry. */
static char root[64], a[80], b[80], c[80], plugins[PATH], broken[PATH], home[PATH - 64];
static char made[16][PATH];
static size_t made_count;
static weft_registry *registry;
static weft_error err;

static const char *in(const char *folder, const char *name)
{
    static char paths[4][2 * PATH];
    static size_t next;
    char *path = paths[next++ % COUNT(paths)];
    (void)snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void to_be_removed(const char *path)
{
    ck_assert_uint_lt(made_count, COUNT(made));
    strcpy(made[made_count++], path);
}

static void make_folder(char *path, const char *name)
{
    strcpy(path, in(root, name));
    ck_assert_int_eq(mkdir(path, 0700), 0);
    to_be_removed(path);
}

static const char *make_link(const char *from, const char *to)
{
    ck_assert_int_eq(symlink(to, from), 0);
    to_be_removed(from);
    return from;
}

static const char *make_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    fputs(text, file);
    fclose(file);
    to_be_removed(path);
    return path;
}

static void setup(void)
{
    strcpy(root, "/tmp/weft-test-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(root));
    to_be_removed(root);
    make_folder(a, "a");
    make_folder(b, "b");
    make_folder(c, "c");
    ck_assert_ptr_nonnull(getcwd(home, sizeof home));
    strcpy(plugins, BUILD_DIR[0] == '/' ? BUILD_DIR : in(home, BUILD_DIR));
    strcpy(broken, in(plugins, "tests/broken"));
    strcat(plugins, "/plugins");
    unsetenv("WEFT_PLUGIN_PATH");
}

static void teardown(void)
{
    weft_registry_destroy(registry);
    registry = NULL;
    ck_assert_int_eq(chdir(home), 0);
    while (made_count > 0) {
        ck_assert_int_eq(remove(made[--made_count]), 0);
    }
}

/* A new registry instead of the last one. */
static void look_in(const char *path, bool environment, const char *fallback)
{
    const weft_registry_def def = { .struct_size = sizeof def,
                                    .path = path,
                                    .environment = environment,
                                    .fallback = fallback };
    weft_registry_destroy(registry);
    ck_assert_int_eq(weft_registry_create(&def, &registry, &err), WEFT_OK);
    ck_assert_uint_eq(weft_registry_count(registry), 0);
}

/* The last call failed with `text` and left no plugin. */
static void refused(weft_status status, const char *text)
{
    ck_assert_int_eq(status, WEFT_BAD_PLUGIN);
    ck_assert_int_eq(err.status, status);
    ck_assert_str_eq(err.message, text);
    ck_assert_uint_eq(weft_registry_count(registry), 0);
}

static const char *why(const char *file, const char *reason)
{
    static char text[2 * PATH];
    (void)snprintf(text, sizeof text, "plugin refused: %s: %s", file, reason);
    text[sizeof err.message - 1] = '\0'; /* a message is no longer */
    return text;
}

/* ---- files ----------------------------------------------------------------------- */

static const struct {
    const char *file, *reason; /* a number in it that depends on a size: %zu */
    size_t size;
} mistakes[] = {
    { "weft-nocreate.so", "method 'second' has no create", 0 },
    { "weft-noentry.so",
      "it has no function weft_plugin_noentry() (is it exported, with WEFT_API?)", 0 },
    { "weft-nomethods.so", "it lacks an id, a version, a solver text or methods", 0 },
    { "weft-noname.so", "method 1 has no name", 0 },
    { "weft-nostep.so", "method 'second' has no step", 0 },
    { "weft-nullplugin.so", "its entry function returned NULL", 0 },
    { "weft-shortplugin.so", "it has a struct_size of 16 bytes, abi 1 needs %zu",
      sizeof(weft_plugin) },
    { "weft-shorttype.so", "method 1 has a struct_size of 64 bytes, abi 1 needs %zu",
      WEFT_STEPPER_TYPE_LEAST },
    { "weft-twicename.so", "method 'first' is there twice", 0 },
    { "weft-typeabi.so", "method 1 is built for plugin interface 7, this weft has 1",
      0 },
    { "weft-wrongabi.so", "it is built for plugin interface 2, this weft has 1", 0 },
    { "weft-wrongid.so", "it calls itself 'other'", 0 },
};

static const char *mistake(size_t i)
{
    char reason[128];
    const char *percent = strchr(mistakes[i].reason, '%');
    const int length = percent == NULL ? 127 : (int)(percent - mistakes[i].reason);
    (void)snprintf(reason, sizeof reason, "%.*s", length, mistakes[i].reason);
    if (percent != NULL) {
        (void)snprintf(reason + length, sizeof reason - (size_t)length, "%zu",
                       mistakes[i].size);
    }
    return why(in(broken, mistakes[i].file), reason);
}

START_TEST(broken_plugins_are_refused_with_file_and_reason)
{
    look_in(NULL, false, NULL);
    const char *file = in(broken, mistakes[_i].file);
    refused(weft_registry_load(registry, file, &err), mistake((size_t)_i));
    ck_assert_int_eq(weft_registry_load(registry, file, NULL), WEFT_BAD_PLUGIN);
    ck_assert_int_eq(weft_registry_load(registry, in(broken, "weft-good.so"), NULL),
                     WEFT_OK);
}
END_TEST

START_TEST(files_that_are_no_plugin_are_refused)
{
    static const char *const names[]
        = { "verlet.so",         "weft-.so",         "weft-verlet.dll",
            "libweft-verlet.so", "weft-verlet.so.1", "" };
    look_in(NULL, false, NULL);
    for (size_t i = 0; i < COUNT(names); ++i) {
        const char *file = in(plugins, names[i]);
        refused(weft_registry_load(registry, file, &err),
                why(file, "its name is not of the form weft-<id>.so"));
    }
    const char *const files[]
        = { make_text(in(a, "weft-text.so"),
                      "no ELF, but long enough to look like a header of one\n"),
            make_text(in(a, "weft-empty.so"), ""), in(b, "weft-none.so") };
    char folder[PATH];
    make_folder(folder, "weft-folder.so");
    for (size_t i = 0; i < COUNT(files) + 1; ++i) {
        const char *file = i < COUNT(files) ? files[i] : folder;
        ck_assert_int_eq(weft_registry_load(registry, file, &err), WEFT_BAD_PLUGIN);
        const char *start = why(file, ""); /* the rest is the dynamic linker's */
        ck_assert_msg(strncmp(err.message, start, strlen(start)) == 0, "%s",
                      err.message);
        ck_assert_uint_gt(strlen(err.message), strlen(start) + 5);
    }
}
END_TEST

START_TEST(good_plugin_is_loaded)
{
    look_in(NULL, false, NULL);
    const char *file = in(broken, "weft-good.so");
    ck_assert_int_eq(weft_registry_load(registry, file, &err), WEFT_OK);
    ck_assert_uint_eq(weft_registry_count(registry), 1);
    ck_assert_str_eq(weft_registry_file(registry, 0), file);
    const weft_plugin *good = weft_registry_at(registry, 0), *found = NULL;
    ck_assert_str_eq(good->id, "good");
    ck_assert_ptr_eq(weft_plugin_method(good, "second"), good->types[1]);
    ck_assert_ptr_null(weft_plugin_method(good, "third"));
    ck_assert_int_eq(weft_registry_find(registry, "good", &found, NULL), WEFT_OK);
    ck_assert_ptr_eq(found, good);
    ck_assert_int_eq(weft_registry_load(registry, file, &err), WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message, why(file, "a plugin 'good' is there already"));
    ck_assert_uint_eq(weft_registry_count(registry), 1);
}
END_TEST

/* dlopen() itself would look for it in the linker's folders. */
START_TEST(file_name_alone_is_one_of_the_current_folder)
{
    look_in(NULL, false, NULL);
    ck_assert_int_eq(chdir(broken), 0);
    ck_assert_int_eq(weft_registry_load(registry, "weft-good.so", &err), WEFT_OK);
    ck_assert_str_eq(weft_registry_at(registry, 0)->id, "good");
}
END_TEST

/* ---- plugins that are linked in ---------------------------------------------------
 */

START_TEST(linked_plugin_is_checked_as_a_loaded_one_is)
{
    const weft_plugin *verlet = test_plugin(0);
    weft_stepper_type type = *verlet->types[0];
    const weft_stepper_type *const types[] = { &type, NULL };
    weft_plugin plugin = *verlet;
    plugin.types = types;
    look_in(NULL, false, NULL);
#define REFUSED(change, back, text)                                                    \
    do {                                                                               \
        change;                                                                        \
        refused(weft_registry_add(registry, &plugin, &err), (text));                   \
        back;                                                                          \
    } while (0)
#define MISSING(field)                                                                 \
    REFUSED(type.field = NULL, type.field = verlet->types[0]->field,                   \
            "method 'symplectic_euler' has no " #field)
#define LACKING(field, value)                                                          \
    REFUSED(plugin.field = (value), plugin.field = verlet->field,                      \
            "it lacks an id, a version, a solver text or methods")
    MISSING(create);
    MISSING(step);
    MISSING(state_changed);
    MISSING(stats);
    MISSING(destroy);
    MISSING(reference);
    MISSING(license);
    LACKING(id, NULL);
    LACKING(id, "");
    LACKING(version, NULL);
    LACKING(solver, NULL);
    REFUSED(plugin.types = NULL, plugin.types = types,
            "it lacks an id, a version, a solver text or methods");
    REFUSED(type.name = NULL, type.name = "x", "method 0 has no name");
    refused(weft_registry_add(registry, NULL, &err),
            "its entry function returned NULL");
    ++plugin.struct_size; /* of a later version: longer, and welcome */
    ++type.struct_size;
    ck_assert_int_eq(weft_registry_add(registry, &plugin, &err), WEFT_OK);
    ck_assert_ptr_eq(weft_registry_at(registry, 0), &plugin);
    ck_assert_str_eq(weft_registry_file(registry, 0), "");
}
END_TEST

START_TEST(no_plugin_is_there_twice)
{
    const weft_plugin *found = NULL;
    look_in(plugins, false, NULL);
    ck_assert_int_eq(weft_registry_add(registry, test_plugin(0), &err), WEFT_OK);
    ck_assert_int_eq(weft_registry_add(registry, test_plugin(0), &err),
                     WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message, "a plugin 'verlet' is there already");
    const char *file = in(plugins, "weft-verlet.so");
    ck_assert_int_eq(weft_registry_load(registry, file, &err), WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message, why(file, "a plugin 'verlet' is there already"));
    ck_assert_int_eq(weft_registry_find(registry, "verlet", &found, &err), WEFT_OK);
    ck_assert_ptr_eq(found, test_plugin(0));
    ck_assert_uint_eq(weft_registry_count(registry), 1);
}
END_TEST

/* ---- searching ------------------------------------------------------------------- */

static void found_in(const char *folder)
{
    const weft_plugin *plugin = NULL, *again = NULL;
    ck_assert_int_eq(weft_registry_find(registry, "good", &plugin, &err), WEFT_OK);
    ck_assert_str_eq(weft_registry_file(registry, 0), in(folder, "weft-good.so"));
    ck_assert_int_eq(weft_registry_find(registry, "good", &again, &err), WEFT_OK);
    ck_assert_ptr_eq(plugin, again);
    ck_assert_uint_eq(weft_registry_count(registry), 1);
}

START_TEST(path_comes_before_environment_before_fallback)
{
    const char *good = in(broken, "weft-good.so"), *folders[] = { a, b, c };
    for (size_t i = 0; i < 3; ++i) {
        make_link(in(folders[i], "weft-good.so"), good);
    }
    ck_assert_int_eq(setenv("WEFT_PLUGIN_PATH", b, 1), 0);
    look_in(a, true, c);
    found_in(a);
    look_in(NULL, true, c);
    found_in(b);
    look_in("", false, c);
    found_in(c);
    char list[PATH];
    (void)snprintf(list, sizeof list, ":/nowhere::%s:%s:", b, a);
    look_in(list, false, c);
    found_in(b);
    const weft_registry_def def = weft_registry_def_default();
    ck_assert(def.path == NULL && def.environment && def.fallback == NULL);
}
END_TEST

START_TEST(plugin_not_found_is_told_with_the_folders)
{
    const weft_plugin *plugin = test_plugin(0);
    char text[512];
    setenv("WEFT_PLUGIN_PATH", b, 1);
    look_in(a, true, c);
    (void)snprintf(text, sizeof text,
                   "plugin 'nix' not found: no weft-nix.so in %s:%s:%s", a, b, c);
    refused(weft_registry_find(registry, "nix", &plugin, &err), text);
    ck_assert_ptr_null(plugin);
    look_in(NULL, false, NULL);
    refused(weft_registry_find(registry, "nix", &plugin, &err),
            "plugin 'nix' not found: no weft-nix.so in an empty search path; set "
            "WEFT_PLUGIN_PATH or weft_registry_def.path");
    refused(weft_registry_load_all(registry, NULL, NULL, &err),
            "no plugin in an empty search path; set WEFT_PLUGIN_PATH or "
            "weft_registry_def.path");
}
END_TEST

/* The first file of the name is the one meant, be it good or not. */
START_TEST(search_does_not_pass_over_a_broken_file)
{
    const weft_plugin *plugin = test_plugin(0);
    const char *file
        = make_link(in(a, "weft-good.so"), in(broken, "weft-nullplugin.so"));
    look_in(a, false, broken);
    refused(
        weft_registry_find(registry, "good", &plugin, &err),
        why(file,
            "it has no function weft_plugin_good() (is it exported, with WEFT_API?)"));
    ck_assert_ptr_null(plugin);
}
END_TEST

/* Folder "weft-x" has a good plugin: that is not the plugin "x/weft-good". */
START_TEST(id_is_a_name_not_a_path)
{
    const weft_plugin *plugin = NULL;
    char folder[PATH];
    make_folder(folder, "weft-x");
    make_link(in(folder, "weft-good.so"), in(broken, "weft-good.so"));
    look_in(root, false, NULL);
    ck_assert_int_eq(weft_registry_find(registry, "x/weft-good", &plugin, &err),
                     WEFT_BAD_PLUGIN);
    ck_assert_ptr_null(plugin);
}
END_TEST

static void expect_next(void *ctx, const weft_error *refusal)
{
    size_t *next = ctx;
    ck_assert_uint_lt(*next, COUNT(mistakes));
    ck_assert_int_eq(refusal->status, WEFT_BAD_PLUGIN);
    ck_assert_str_eq(refusal->message, mistake((*next)++));
}

START_TEST(loading_all_tells_of_the_refused_and_goes_on)
{
    size_t next = 0;
    char list[2 * PATH];
    make_link(in(a, "weft-verlet.so"), in(plugins, "weft-verlet.so"));
    make_link(in(b, "weft-verlet.so"), in(plugins, "weft-verlet.so"));
    make_text(in(b, "weft-readme.txt"), "not looked at");
    (void)snprintf(list, sizeof list, "%s:%s:%s:/nowhere", a, broken, b);
    look_in(list, false, NULL);
    ck_assert_int_eq(weft_registry_load_all(registry, expect_next, &next, &err),
                     WEFT_OK);
    ck_assert_uint_eq(next, COUNT(mistakes));
    ck_assert_uint_eq(weft_registry_count(registry), 4);
    ck_assert_str_eq(weft_registry_file(registry, 0), in(a, "weft-verlet.so"));
    ck_assert_str_eq(weft_registry_at(registry, 1)->id, "crash");
    ck_assert_str_eq(weft_registry_at(registry, 2)->id, "good");
    ck_assert_int_eq(weft_registry_load_all(registry, NULL, NULL, &err), WEFT_OK);
    ck_assert_uint_eq(weft_registry_count(registry), 4);
    look_in(c, false, NULL);
    char text[PATH];
    (void)snprintf(text, sizeof text, "no plugin in %s", c);
    refused(weft_registry_load_all(registry, NULL, NULL, &err), text);
    const char *file = in(b, "weft-readme.txt");
    (void)snprintf(list, sizeof list, "%s:/nowhere:%s", file, c);
    look_in(list, false, NULL);
    (void)snprintf(text, sizeof text, "no plugin in %s (Not a directory):/nowhere:%s",
                   file, c);
    refused(weft_registry_load_all(registry, NULL, NULL, &err), text);
    weft_registry_destroy(NULL);
}
END_TEST

/* It lies among the plugins, and is loaded for --bands alone. */
START_TEST(weft_mpi_is_located_and_no_plugin)
{
    char file[PATH];
    const char *made_here = make_text(in(b, "weft-mpi.so"), "no plugin");
    char list[2 * PATH];
    make_link(in(a, "weft-verlet.so"), in(plugins, "weft-verlet.so"));
    (void)snprintf(list, sizeof list, "%s:%s", a, b);
    look_in(list, false, NULL);
    ck_assert_int_eq(weft_registry_load_all(registry, expect_next, NULL, &err),
                     WEFT_OK);
    ck_assert_uint_eq(weft_registry_count(registry), 1);
    ck_assert_int_eq(weft_registry_locate(registry, "mpi", file, sizeof file, &err),
                     WEFT_OK);
    ck_assert_str_eq(file, made_here);
    ck_assert_int_eq(weft_registry_locate(registry, "nix", file, sizeof file, &err),
                     WEFT_BAD_PLUGIN);
    ck_assert_int_eq(weft_registry_locate(registry, "mpi", file, 8, &err),
                     WEFT_BAD_PLUGIN);
}
END_TEST

/* ---- what is asked of a method --------------------------------------------------- */

static void refused_config(weft_stepper_config config, const char *text)
{
    const weft_cloth_def model = weft_cloth_def_default();
    weft_cloth *cloth = test_cloth(&model);
    weft_sim *sim = (weft_sim *)&config;
    const weft_stepper_type *verlet = test_method_named("verlet/velocity_verlet");
    const weft_sim_def def = {
        .struct_size = sizeof def, .cloth = cloth, .method = verlet, .config = config
    };
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_INVALID);
    ck_assert_ptr_null(sim);
    ck_assert_msg(strncmp(err.message, text, strlen(text)) == 0, "%s", err.message);
    weft_cloth_destroy(cloth);
}

START_TEST(bad_configs_are_refused)
{
#define FIELD(name, least, text)                                                       \
    {                                                                                  \
        offsetof(weft_stepper_config, name), (least), (text)                           \
    }
    static const struct {
        size_t at;
        double least;
        const char *text;
    } fields[] = {
        FIELD(max_step, 1e-12, "max_step "),
        FIELD(fixed_step, 0.0, "fixed_step "),
        FIELD(rtol, 0.0, "rtol "),
        FIELD(atol_position, DBL_MIN, "atol_position "),
        FIELD(atol_velocity, DBL_MIN, "atol_velocity "),
        FIELD(first_step, DBL_MIN, "first_step "),
        FIELD(min_step, DBL_MIN, "min_step "),
    };
    const double bad[]
        = { (double)NAN, -(double)INFINITY, -1.0, 0.0, (double)INFINITY };
    const weft_stepper_config good = weft_stepper_config_default();
    for (size_t i = 0; i < COUNT(fields) * COUNT(bad); ++i) {
        const size_t field = i / COUNT(bad);
        const double number = bad[i % COUNT(bad)];
        weft_stepper_config config = good;
        memcpy((char *)&config + fields[field].at, &number, sizeof number);
        if (!(number >= fields[field].least && (isfinite(number) || field == 0))) {
            refused_config(config, fields[field].text);
        }
    }
    weft_stepper_config config = good;
    config.max_step = -1.0;
    refused_config(config, "max_step -1 s: must be > 0 or infinite");
    config = good;
    config.struct_size = 8;
    refused_config(config, "the config must begin as weft_stepper_config_default");
    refused_config(good, "velocity_verlet: no error control: needs a fixed_step > 0 s");
    weft_sim_def nothing = weft_sim_def_default();
    weft_sim *sim = (weft_sim *)&config;
    ck_assert_int_eq(weft_sim_create(&nothing, &sim, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "a simulation needs a cloth: it is NULL");
    const weft_cloth_def model = weft_cloth_def_default();
    nothing.cloth = test_cloth(&model);
    ck_assert_int_eq(weft_sim_create(&nothing, &sim, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message,
                     "a simulation needs a method: it is NULL, which is what "
                     "weft_plugin_method returns for a name that the plugin does not "
                     "have; weft_registry_method also reports the nearest name");
    ck_assert_ptr_null(sim);
    weft_cloth_destroy((weft_cloth *)nothing.cloth);
}
END_TEST

static void refused_type(weft_stepper_type type, const char *text)
{
    const weft_cloth_def model = weft_cloth_def_default();
    weft_sim_def def = weft_sim_def_default();
    weft_stability stability;
    weft_sim *sim = NULL;
    def.method = &type;
    def.cloth = test_cloth(&model);
    def.config.fixed_step = 1e-3;
    ck_assert_int_eq(weft_sim_create(&def, &sim, &err), WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message, text);
    ck_assert_int_eq(weft_stability_create(&type, NULL, &stability, &err),
                     WEFT_BAD_PLUGIN);
    ck_assert_str_eq(err.message, text);
    weft_cloth_destroy((weft_cloth *)def.cloth);
}

START_TEST(method_given_directly_that_lacks_a_function_is_refused)
{
    const weft_stepper_type good = *test_method_named("verlet/velocity_verlet");
    weft_stepper_type bad = good;
    bad.create = NULL;
    refused_type(bad, "method 'velocity_verlet' has no create");
    bad = good;
    bad.step = NULL;
    refused_type(bad, "method 'velocity_verlet' has no step");
    bad = good;
    bad.state_changed = NULL;
    refused_type(bad, "method 'velocity_verlet' has no state_changed");
    bad = good;
    bad.stats = NULL;
    refused_type(bad, "method 'velocity_verlet' has no stats");
    bad = good;
    bad.destroy = NULL;
    refused_type(bad, "method 'velocity_verlet' has no destroy");
    bad = good;
    bad.name = NULL;
    refused_type(bad, "method 0 has no name");
}
END_TEST

START_TEST(without_definition_or_place_for_the_result_nothing_is_made)
{
    weft_diagnostics found;
    weft_cloth_def cloth_def = weft_cloth_def_default();
    const weft_fabric fabric = { .bend = { 0.0 } };
    weft_sim_def sim_def = weft_sim_def_default();
    sim_def.method = test_method_named("verlet/velocity_verlet");
    const weft_registry_def registry_def = weft_registry_def_default();
    const weft_scene_def scene_def = weft_scene_def_default();
    weft_stability stability;
    weft_cloth *cloth;
    weft_sim *sim;
    weft_registry *one_more;
    weft_scene *scene;
    weft_sweep *sweep;
    const struct {
        weft_status none, nowhere;
    } answers[] = {
        { weft_cloth_create(NULL, &cloth, &err),
          weft_cloth_create(&cloth_def, NULL, &err) },
        { weft_sim_create(NULL, &sim, &err), weft_sim_create(&sim_def, NULL, &err) },
        { weft_registry_create(NULL, &one_more, &err),
          weft_registry_create(&registry_def, NULL, &err) },
        { weft_scene_load(NULL, &scene, &found, &err),
          weft_scene_load(&scene_def, NULL, &found, &err) },
        { weft_sweep_load(NULL, &sweep, &found, &err),
          weft_sweep_load(&scene_def, NULL, &found, &err) },
        { weft_fabric_apply(NULL, &cloth_def, &err),
          weft_fabric_apply(&fabric, NULL, &err) },
        { weft_stability_create(NULL, NULL, &stability, &err),
          weft_stability_create(sim_def.method, NULL, NULL, &err) },
    };
    for (size_t i = 0; i < COUNT(answers); ++i) {
        ck_assert_int_eq(answers[i].none, WEFT_INVALID);
        ck_assert_int_eq(answers[i].nowhere, WEFT_INVALID);
    }
    ck_assert_int_eq(weft_sim_create(NULL, &sim, &err), WEFT_INVALID);
    ck_assert_str_eq(err.message, "weft_sim_create: the definition is NULL");
}
END_TEST

START_TEST(statuses_have_texts_of_their_own)
{
    for (int i = WEFT_OK; i <= WEFT_SOLVER; ++i) {
        for (int j = WEFT_OK; j < i; ++j) {
            ck_assert_str_ne(weft_status_text((weft_status)i),
                             weft_status_text((weft_status)j));
        }
    }
    ck_assert_str_eq(weft_status_text(WEFT_OK), "ok");
    ck_assert_str_eq(weft_status_text((weft_status)(WEFT_SOLVER + 1)),
                     "unknown status");
    ck_assert_str_eq(weft_status_text((weft_status)-1), "unknown status");
    ck_assert_str_eq(weft_version(), WEFT_VERSION);
}
END_TEST

TEST_SUITE(registry)
{
    Suite *suite = suite_create("registry");
    TCase *tcase = tcase_create("registry");
    suite_add_tcase(suite, tcase);
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, broken_plugins_are_refused_with_file_and_reason, 0,
                        (int)COUNT(mistakes));
    tcase_add_test(tcase, files_that_are_no_plugin_are_refused);
    tcase_add_test(tcase, good_plugin_is_loaded);
    tcase_add_test(tcase, file_name_alone_is_one_of_the_current_folder);
    tcase_add_test(tcase, linked_plugin_is_checked_as_a_loaded_one_is);
    tcase_add_test(tcase, no_plugin_is_there_twice);
    tcase_add_test(tcase, path_comes_before_environment_before_fallback);
    tcase_add_test(tcase, plugin_not_found_is_told_with_the_folders);
    tcase_add_test(tcase, search_does_not_pass_over_a_broken_file);
    tcase_add_test(tcase, id_is_a_name_not_a_path);
    tcase_add_test(tcase, loading_all_tells_of_the_refused_and_goes_on);
    tcase_add_test(tcase, weft_mpi_is_located_and_no_plugin);
    tcase_add_test(tcase, bad_configs_are_refused);
    tcase_add_test(tcase, method_given_directly_that_lacks_a_function_is_refused);
    tcase_add_test(tcase, without_definition_or_place_for_the_result_nothing_is_made);
    tcase_add_test(tcase, statuses_have_texts_of_their_own);
    return suite;
}
