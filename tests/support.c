/* SPDX-License-Identifier: BSD-3-Clause */
#include "support.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "study/conformance/oscillators.h"

const weft_plugin *weft_plugin_verlet(void);
const weft_plugin *weft_plugin_stiff(void);
const weft_plugin *weft_plugin_gsl(void);
const weft_plugin *weft_plugin_arkode(void);
const weft_plugin *weft_plugin_cvode(void);

const weft_plugin *test_plugin(size_t i)
{
    weft_plugin_fn *const plugins[] = {
        weft_plugin_verlet, weft_plugin_stiff,
#ifdef HAVE_GSL
        weft_plugin_gsl,
#endif
#ifdef HAVE_ARKODE
        weft_plugin_arkode,
#endif
#ifdef HAVE_CVODE
        weft_plugin_cvode,
#endif
    };
    return i < sizeof plugins / sizeof plugins[0] ? plugins[i]() : NULL;
}

/* The i-th method and the plugin it is of; false past the last. */
static bool find_method(size_t i, const weft_plugin **plugin,
                        const weft_stepper_type **type)
{
    for (size_t p = 0; (*plugin = test_plugin(p)) != NULL; ++p) {
        for (size_t m = 0; (*plugin)->types[m] != NULL; ++m) {
            if (i-- == 0) {
                *type = (*plugin)->types[m];
                return true;
            }
        }
    }
    return false;
}

size_t test_method_count(void)
{
    const weft_plugin *plugin;
    const weft_stepper_type *type;
    size_t count = 0;
    while (find_method(count, &plugin, &type)) {
        ++count;
    }
    return count;
}

const weft_stepper_type *test_method(size_t i)
{
    const weft_plugin *plugin;
    const weft_stepper_type *type = NULL;
    ck_assert_msg(find_method(i, &plugin, &type), "no method %zu", i);
    return type;
}

const char *test_method_label(size_t i)
{
    static char label[128]; /* a test runs alone in its process */
    const weft_plugin *plugin;
    const weft_stepper_type *type = NULL;
    ck_assert_msg(find_method(i, &plugin, &type), "no method %zu", i);
    (void)snprintf(label, sizeof label, "%s/%s", plugin->id, type->name);
    return label;
}

const weft_stepper_type *test_method_named(const char *name)
{
    char label[128]; /* `name` may be what test_method_label returned */
    (void)snprintf(label, sizeof label, "%s", name);
    for (size_t i = 0; i < test_method_count(); ++i) {
        if (strcmp(test_method_label(i), label) == 0) {
            return test_method(i);
        }
    }
    ck_abort_msg("no method '%s'", label);
    return NULL;
}

bool test_needs_structure(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_STRUCTURE) != 0;
}

bool test_adaptive_only(const weft_stepper_type *type)
{
    return (type->flags & WEFT_STEPPER_ADAPTIVE_ONLY) != 0;
}

bool test_needs_damping(const weft_stepper_type *type)
{
    return test_needs_structure(type) && (type->flags & WEFT_STEPPER_IMPLICIT) == 0;
}

weft_stepper_config test_config(const weft_stepper_type *type,
                                weft_stepper_config config)
{
    if ((type->flags & WEFT_STEPPER_BUTCHER) != 0 && config.butcher == NULL) {
        config.butcher = merson();
    }
    if (test_adaptive_only(type) && config.fixed_step > 0.0) {
        config.first_step = config.max_step = config.fixed_step;
        config.min_step = 1e-9 * config.fixed_step;
        config.rtol = config.fixed_step = 0.0;
        config.norm = WEFT_NORM_MAX;
        config.atol_position = config.atol_velocity = 1e-6;
    }
    return config;
}

weft_cloth *test_cloth(const weft_cloth_def *def)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    const weft_status status = weft_cloth_create(def, &cloth, &err);
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
    return cloth;
}

weft_sim *test_sim(const weft_cloth *cloth, const weft_stepper_type *method,
                   const weft_stepper_config *config)
{
    weft_error err = { 0 };
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = method;
    def.config = test_config(method, *config);
    weft_sim *sim = NULL;
    const weft_status status = weft_sim_create(&def, &sim, &err);
    ck_assert_msg(status == WEFT_OK, "%s", err.message);
    return sim;
}

bool test_comma_locale(void)
{
    static const char *const names[] = { "de_DE.UTF-8", "fr_FR.UTF-8", "comma" };
    bool found = false;
    (void)!system("cd " BUILD_DIR " && mkdir -p locale && { test -d locale/comma || { "
                  "localedef -c -i de_DE -f UTF-8 locale/$$ && mv locale/$$ "
                  "locale/comma; }; } >/dev/null 2>&1");
    for (size_t i = 0; i < 3 && !found; ++i) {
        if (i == 2) {
            (void)setenv("LOCPATH", BUILD_DIR "/locale", 1);
        }
        found = setlocale(LC_ALL, names[i]) != NULL;
    }
    return found;
}

uint64_t test_hash(const double *values, size_t count)
{
    uint64_t hash = WEFT__HASH_START;
    for (size_t i = 0; i < count; ++i) {
        uint64_t word;
        memcpy(&word, &values[i], sizeof word);
        hash = weft__hash_word(hash, word);
    }
    return hash;
}

int test_rounds(int few, int many)
{
    return getenv("TEST_LONG") == NULL ? few : many;
}

bool test_is_spared(const weft_stepper_type *type)
{
    static const char *const kept[]
        = { "heun_euler", "bogacki_shampine", "fehlberg87", "sdirk212", "trbdf2" };
    static const char *const alike[] /* to another but for its table */
        = { "rk2", "rkck", "rk1imp", "rk2imp", "rk2simp", "gear1", "heun", "rk38" };
    bool spared = test_rounds(1, 0) && (type->flags & WEFT_STEPPER_CONTROLLER) != 0
                  && (type->flags & WEFT_STEPPER_BUTCHER) == 0;
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i) {
        spared = spared && !weft_stepper_is(type, kept[i]);
    }
    for (size_t i = 0; i < sizeof alike / sizeof alike[0]; ++i) {
        spared = spared || (test_rounds(1, 0) && weft_stepper_is(type, alike[i]));
    }
    return spared;
}

bool test_is_typical(const weft_stepper_type *type)
{
    static const char *const typical[]
        = { "velocity_verlet", "rkf45", "msadams", "bsimp",          "bogacki_shampine",
            "trbdf2",          "bdf",   "ros2",    "backward_euler", "rk4" };
    bool is = test_rounds(0, 1) != 0;
    for (size_t i = 0; i < sizeof typical / sizeof typical[0]; ++i) {
        is = is || weft_stepper_is(type, typical[i]);
    }
    return is;
}

TCase *test_long(Suite *suite, double timeout)
{
    TCase *tcase = tcase_create("long");
    tcase_set_tags(tcase, "long");
    tcase_set_timeout(tcase, timeout);
    suite_add_tcase(suite, tcase);
    return tcase;
}

int test_run(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
