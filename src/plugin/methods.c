/* SPDX-License-Identifier: BSD-3-Clause */
#include "plugin/methods.h"

#include <math.h>
#include <string.h>

#include "base/finite.h"
#include "base/sized.h"
#include "base/suggest.h"
#include "plugin/plugin_check.h"

/* ---- settings ---------------------------------------------------------------- */

void weft_stepper_config_init(weft_stepper_config *def, size_t size)
{
    const weft_stepper_config start = {
        .struct_size = (uint32_t)size,
        .norm = WEFT_NORM_MAX,
        .rtol = 1e-6,
        .atol_position = 1e-6,
        .atol_velocity = 1e-6,
        .first_step = 1e-3,
        .min_step = 1e-12,
        .max_step = INFINITY,
    };
    weft__sized_write(def, size, &start, sizeof start);
}

const struct weft__config_numbers weft__config_numbers = {
    WEFT__FIELD(weft_stepper_config, fixed_step, "s", .strict = true, .optional = true),
    WEFT__FIELD(weft_stepper_config, rtol, NULL, .least = 0.0),
    WEFT__FIELD(weft_stepper_config, atol_position, "m", .strict = true),
    WEFT__FIELD(weft_stepper_config, atol_velocity, "m/s", .strict = true),
    WEFT__FIELD(weft_stepper_config, first_step, "s", .strict = true),
    WEFT__FIELD(weft_stepper_config, min_step, "s", .strict = true),
    WEFT__FIELD(weft_stepper_config, max_step, "s", .strict = true, .infinite = true),
};

weft_status weft__config_check(const weft_stepper_config *config, weft_error *err)
{
    weft__refusal first = { WEFT_OK, err };
    const weft__faults to = { weft__keep_first, &first };
    if (config->struct_size < WEFT_STEPPER_CONFIG_LEAST) {
        return weft_error_set(err, WEFT_INVALID,
                              "the config must begin as weft_stepper_config_default");
    }
    if (weft__positive(config->fixed_step)) {
        return WEFT_OK;
    }
    if (WEFT__NUMBERS_CHECK(weft__config_numbers, config, &to, "%s", "")
        && config->max_step < config->min_step) {
        return weft_error_set(err, WEFT_INVALID,
                              "max_step %g s is below min_step, %g s", config->max_step,
                              config->min_step);
    }
    return first.status;
}

/* ---- of a plugin ------------------------------------------------------------- */

/* Appends to a list, while there is room for the name and for ", ...". */
static void methods_append(char *list, size_t size, const char *name)
{
    const size_t used = strlen(list);
    if (used + strlen(name) + sizeof ", , ..." <= size) {
        (void)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", name);
    } else if (used < 3 || strcmp(list + used - 3, "...") != 0) {
        (void)snprintf(list + used, size - used, ", ...");
    }
}

void weft__methods_list(const weft_plugin *plugin, uint32_t flags, char *out,
                        size_t size)
{
    out[0] = '\0';
    for (size_t i = 0; plugin->types[i] != NULL; ++i) {
        if ((plugin->types[i]->flags & flags) == flags) {
            methods_append(out, size, plugin->types[i]->name);
        }
    }
}

static void guess_method(weft__guess *guess, const char *name, const weft_plugin *of)
{
    for (size_t i = 0; of->types[i] != NULL; ++i) {
        weft__guess_try(guess, name, of->types[i]->name);
    }
}

/* Another plugin that has a method of that name, or of a more similar one. */
static void near_text(const weft_plugin *plugin, const char *name,
                      const weft_plugin *const *others, char *out, size_t size)
{
    weft__guess guess = { 0 };
    const char *of = NULL;
    guess_method(&guess, name, plugin);
    for (; others != NULL && *others != NULL; ++others) {
        const char *before = guess.name;
        if (weft_plugin_method(*others, name) != NULL) {
            (void)snprintf(out, size, " (%.40s has)", (*others)->id);
            return;
        }
        guess_method(&guess, name, *others);
        of = guess.name == before ? of : (*others)->id;
    }
    if (of == NULL) {
        (void)weft__guess_text(&guess, out, size);
    } else {
        (void)snprintf(out, size, " (did you mean '%.32s/%s'?)", of, guess.name);
    }
}

const weft_stepper_type *weft__method_named(const weft_plugin *plugin, const char *name,
                                            const weft_plugin *const *others,
                                            weft_error *err)
{
    const weft_stepper_type *type = weft_plugin_method(plugin, name);
    char near[120], names[240];
    if (type == NULL && plugin != NULL) {
        near_text(plugin, name, others, near, sizeof near);
        weft__methods_list(plugin, 0, names, sizeof names);
        weft_error_set(err, WEFT_INVALID,
                       "plugin '%.32s' has no method '%.40s'%s; it has %s", plugin->id,
                       name, near, names);
    }
    return type;
}

double weft_stepper_matrices(const weft_stepper_type *type, size_t particles,
                             char *text, size_t size)
{
    const size_t dim = 6 * particles;
    text[0] = '\0';
    if ((type->flags & WEFT_STEPPER_DENSE) == 0) {
        return 0.0;
    }
    const bool counted
        = WEFT_HAS(type, weft_stepper_type, matrices) && type->matrices > 0;
    const double bytes
        = 8.0 * (double)dim * (double)dim * (counted ? type->matrices : 1);
    (void)weft_text_format(
        text, size,
        "matrices of %zu x %zu, %.4g MB in all, about %zu evaluations for "
        "each Jacobian",
        dim, dim, 1e-6 * bytes, dim);
    return bytes;
}

const weft_stepper_type *weft_plugin_method(const weft_plugin *plugin, const char *name)
{
    for (size_t i = 0; plugin != NULL && plugin->types[i] != NULL; ++i) {
        if (weft_stepper_is(plugin->types[i], name)) {
            return plugin->types[i];
        }
    }
    return NULL;
}

/* ---- one particle ------------------------------------------------------------ */

static int stay(double t, const double *y, double *dydt, void *ctx)
{
    (void)t, (void)y, (void)ctx;
    memset(dydt, 0, 6 * sizeof *dydt);
    return 0;
}

const weft_ode weft__one_ode = { .dim = 6, .rhs = stay };

static int no_springs(double t, const double *y, double *planes, double *blocks,
                      void *ctx)
{
    (void)t, (void)y, (void)planes, (void)blocks, (void)ctx;
    return 0;
}

static size_t give_modes(double t, const double *y, double (*corners)[2], size_t room,
                         void *ctx)
{
    const weft_stiffness *polygon = ctx;
    const size_t count = polygon != NULL && polygon->count <= room ? polygon->count : 0;
    (void)t, (void)y;
    if (count > 0) {
        memcpy(corners, polygon->corners, count * sizeof *corners);
    }
    return count;
}

weft_structure weft__one_structure(const weft_stiffness *modes)
{
    static const double mass = 1.0, drag = 0.0;
    return (weft_structure){ .struct_size = sizeof(weft_structure),
                             .particles = 1,
                             .mass = &mass,
                             .drag = &drag,
                             .linearise = no_springs,
                             .modes = give_modes,
                             .ctx = (void *)modes };
}

/* ---- of a registry ----------------------------------------------------------- */

const char *const weft__shipped[WEFT__SHIPPED + 1]
    = { "gsl", "arkode", "cvode", "verlet", "stiff", NULL };

const char *weft__plugin_guess(const char *id, char *out, size_t size)
{
    weft__guess guess = { 0 };
    bool exact = false;
    for (size_t i = 0; weft__shipped[i] != NULL; ++i) {
        weft__guess_try(&guess, id, weft__shipped[i]);
        exact = exact || strcmp(id, weft__shipped[i]) == 0;
    }
    guess.name = exact ? NULL : guess.name;
    return weft__guess_text(&guess, out, size);
}

/* `same`: of the same coefficients. Of the others, one-step methods have the same
 * order. */
static const struct {
    const char *plugin, *method, *other, *instead;
    bool same;
} instead_of[] = {
    { "gsl", "rkf45", "arkode", "fehlberg45", true },
    { "gsl", "rkck", "arkode", "cash_karp", true },
    { "gsl", "rk8pd", "arkode", "fehlberg87", false },
    { "gsl", "rk4", "arkode", "zonneveld", false },
    { "gsl", "rk2", "arkode", "bogacki_shampine", false },
    { "gsl", "msadams", "cvode", "adams", false },
    { "gsl", "msbdf", "cvode", "bdf", false },
    { "gsl", "rk1imp", "stiff", "backward_euler", false },
    { "arkode", "fehlberg45", "gsl", "rkf45", true },
    { "arkode", "cash_karp", "gsl", "rkck", true },
    { "arkode", "dormand_prince", "gsl", "rkf45", false },
    { "arkode", "fehlberg87", "gsl", "rk8pd", false },
    { "arkode", "rk4", "gsl", "rk4", false },
    { "arkode", "euler", "verlet", "euler", true },
    { "arkode", "midpoint", "verlet", "midpoint", true },
    { "cvode", "adams", "gsl", "msadams", false },
    { "cvode", "bdf", "stiff", "ros2", false },
};

const char *weft__method_instead(const char *plugin, const char *method,
                                 const weft_plugin *(*find)(void *ctx, const char *id,
                                                            weft_error *err),
                                 void *ctx, char *text, size_t size)
{
    text[0] = '\0';
    for (size_t i = 0; i < sizeof instead_of / sizeof instead_of[0]; ++i) {
        weft_error why;
        if (strcmp(instead_of[i].plugin, plugin) == 0
            && strcmp(instead_of[i].method, method) == 0
            && weft_plugin_method(find(ctx, instead_of[i].other, &why),
                                  instead_of[i].instead)
                   != NULL) {
            (void)snprintf(text, size, "; %s/%s %s", instead_of[i].other,
                           instead_of[i].instead,
                           instead_of[i].same ? "does the same" : "comes closest");
        }
    }
    return text;
}

/* Plugins that a registry has or could load. */
typedef struct choice {
    const char *wanted;
    bool there;
    size_t distance; /* of the nearest */
    char nearest[64], names[160];
} choice;

static bool is_listed(const char *list, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = list; *at != '\0'; at += strcspn(at, ", ")) {
        at += strspn(at, ", ");
        if (strcspn(at, ", ") == length && strncmp(at, name, length) == 0) {
            return true;
        }
    }
    return false;
}

static void consider(void *ctx, const char *id, const char *file)
{
    choice *self = ctx;
    (void)file;
    weft__guess guess
        = { self->nearest[0] != '\0' ? self->nearest : NULL, self->distance };
    const char *before = guess.name;
    self->there = self->there || strcmp(id, self->wanted) == 0;
    if (is_listed(self->names, id)) {
        return;
    }
    methods_append(self->names, sizeof self->names, id);
    weft__guess_try(&guess, self->wanted, id);
    if (guess.name != before) {
        (void)snprintf(self->nearest, sizeof self->nearest, "%s", id);
        self->distance = guess.distance;
    }
}

weft_status weft_registry_method(weft_registry *registry, const char *plugin,
                                 const char *method, const weft_stepper_type **out,
                                 weft_error *err)
{
    const weft_plugin *found = NULL;
    weft_error why = { 0 };
    *out = NULL;
    const weft_status status = weft_registry_find(registry, plugin, &found, &why);
    if (status == WEFT_OK) {
        *out = weft__method_named(found, method, NULL, err);
        return *out != NULL ? WEFT_OK : WEFT_INVALID;
    }
    choice all = { .wanted = plugin };
    char near[80];
    weft__registry_names(registry, consider, &all);
    const weft__guess guess = { all.nearest[0] != '\0' ? all.nearest : NULL, 0 };
    const bool refused = all.there;
    return weft_error_set(err, status, "%.300s%s%s%s", why.message,
                          refused ? "" : weft__guess_text(&guess, near, sizeof near),
                          refused || all.names[0] == '\0' ? "" : "; there are ",
                          refused ? "" : all.names);
}
