/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_stepper.c -- checks of stepper against the chosen method; scene_method.c finds
 * keys that exclude one another or have no use. */
#include <math.h>
#include <string.h>

#include "base/name.h"
#include "plugin/methods.h"
#include "scene/checks.h"

/* ---- step sizes ------------------------------------------------------------- */

/* Sizes that the scene has must be in order; min_step and max_step are also compared
 * with each other's default. */
static void check_sizes(weft__reader *reader, const weft__match *match)
{
    const weft_stepper_config *config = &reader->scene->config;
    const struct {
        const char *name;
        double h;
    } sizes[] = { { "min_step", config->min_step },
                  { "first_step", config->first_step },
                  { "max_step", config->max_step } };
    for (size_t k = 0; k < 3; ++k) {
        const size_t i = k / 2, j = k == 0 ? 2 : k; /* 0, 2; 0, 1; 1, 2 */
        const weft__node *a = weft__value_in(match, sizes[i].name);
        const weft__node *b = weft__value_in(match, sizes[j].name);
        const bool given = k == 0 ? a != NULL || b != NULL : a != NULL && b != NULL;
        if (given && sizes[i].h > sizes[j].h && sizes[j].h > 0.0) {
            ERROR_AT(reader, weft__later(a, b), "%s, %g s%s, is above %s, %g s",
                     sizes[i].name, sizes[i].h, a == NULL ? " by default" : "",
                     sizes[j].name, sizes[j].h);
        }
    }
}

/* [s], [m] and [m/s]: beyond these a unit or an exponent is likely to be wrong. */
#define SHORTEST_STEP 1e-9
#define LARGEST_ATOL  1.0

static void warn_of_sizes(weft__reader *reader, const weft__match *match)
{
    const weft_stepper_config *config = &reader->scene->config;
    const weft__node *step = weft__value_in(match, "fixed_step");
    const weft__node *atol = weft__value_in(match, "atol");
    const double most = fmax(config->atol_position, config->atol_velocity);
    if (step != NULL && config->fixed_step > 0.0
        && config->fixed_step < SHORTEST_STEP) {
        WARNING_AT(reader, step, "fixed_step %g s: a second takes %.3g steps",
                   config->fixed_step, 1.0 / config->fixed_step);
    }
    if (atol != NULL && most >= LARGEST_ATOL) {
        WARNING_AT(reader, atol,
                   "atol %g: errors of %g m or m/s in each step are accepted; the "
                   "default is 1e-6",
                   most, most);
    }
}

/* ---- plugin and method ------------------------------------------------------ */

static void report_method(weft__reader *reader, const weft__match *match,
                          const weft_plugin *plugin)
{
    const weft_plugin *others[WEFT__SHIPPED + 1] = { NULL };
    weft_error why;
    for (size_t i = 0, count = 0; i < WEFT__SHIPPED; ++i) {
        others[count]
            = reader->def->find_plugin(reader->def->find_ctx, weft__shipped[i], &why);
        count += others[count] != NULL;
    }
    (void)weft__method_named(plugin, reader->scene->method, others, &why);
    ERROR_AT(reader, weft__value_in(match, "method"), "%s", why.message);
}

/* The method that takes a table from the scene. Without its plugin such a scene is
 * still read and checked: it is valid, but cannot be run. */
static bool asks_for_table(const weft_scene *scene)
{
    return scene->plugin != NULL && strcmp(scene->plugin, "arkode") == 0
           && scene->method != NULL && strcmp(scene->method, "custom") == 0;
}

/* Reports why the method was not found, if it was looked for. */
static void report_type(weft__reader *reader, const weft__match *match)
{
    const weft_scene *scene = reader->scene;
    weft_error why = { .message = "not found" };
    if (scene->plugin == NULL || !WEFT__IS_PLUGIN_ID(scene->plugin)
        || reader->def->find_plugin == NULL) {
        if (scene->plugin != NULL && !WEFT__IS_PLUGIN_ID(scene->plugin)) {
            ERROR_AT(reader, weft__value_in(match, "plugin"),
                     "plugin '%.40s' is no plugin's name: at most 48 letters, digits "
                     "and _",
                     scene->plugin);
        }
        return;
    }
    const weft_plugin *plugin
        = reader->def->find_plugin(reader->def->find_ctx, scene->plugin, &why);
    if (plugin != NULL && scene->method != NULL) {
        report_method(reader, match, plugin);
    } else if (plugin == NULL && !asks_for_table(scene)) {
        char near[80], instead[96] = "";
        if (scene->method != NULL) {
            (void)weft__method_instead(scene->plugin, scene->method,
                                       reader->def->find_plugin, reader->def->find_ctx,
                                       instead, sizeof instead);
        }
        ERROR_AT(reader, weft__value_in(match, "plugin"), "%.280s%s%s", why.message,
                 weft__plugin_guess(scene->plugin, near, sizeof near), instead);
    }
}

/* ---- what the method needs -------------------------------------------------- */

static void check_table(weft__reader *reader, const weft__match *match)
{
    const weft_scene *scene = reader->scene;
    const weft__node *table = weft__key_in(match, "butcher");
    if (weft__lacks(match, "butcher")) {
        ERROR_AT(reader, weft__value_in(match, "method"),
                 "method '%.40s' of plugin '%.40s' needs a table: butcher "
                 "with A, b, c and order",
                 scene->method, scene->plugin);
    } else if (table != NULL && weft__value_in(match, "fixed_step") == NULL
               && scene->tableau.b_embedded.side == 0
               && scene->tableau.set.embedded_order == 0) {
        ERROR_AT(reader, table,
                 "without b_embedded and embedded_order there is no error "
                 "control: fixed_step [s] is needed");
    }
}

/* The law takes a certain number of gains. */
void weft__check_controller(weft__reader *reader, const weft__match *match, void *base)
{
    static const size_t counts[] = { 0,
#define COUNT(label, name, gains) gains,
                                     WEFT_CONTROLLERS(COUNT)
#undef COUNT
    };
    weft__control *control = base;
    weft_controller *set = &control->set;
    reader->scene->config.controller = set;
    const weft__node *gains = weft__value_in(match, "gains");
    if (gains != NULL && set->type == WEFT_CONTROLLER_DEFAULT) {
        ERROR_AT(reader, gains, "gains need the type that they are for");
    } else if (control->gains.count > 0 && control->gains.count != counts[set->type]) {
        ERROR_AT(reader, gains, "%zu gains, where this type takes %zu",
                 control->gains.count, counts[set->type]);
    } else {
        for (size_t i = 0; i < control->gains.count; ++i) {
            set->gains[i] = control->gains.values[i];
        }
        set->gain_count = (int)control->gains.count;
    }
}

void weft__check_solver(weft__reader *reader, const weft__match *match, void *base)
{
    (void)match;
    reader->scene->solver.struct_size = sizeof reader->scene->solver;
    reader->scene->config.linear = base;
}

/* [bytes] */
#define LARGE_MATRICES 1e9

/* For the cloth, which was read before. */
static void check_matrices(weft__reader *reader, const weft__match *match)
{
    const weft_scene *scene = reader->scene;
    const size_t particles = weft__particles_in(scene);
    const weft__mark at = weft__value_in(match, "method")->at;
    char text[160];
    const double bytes
        = weft_stepper_matrices(scene->type, particles, text, sizeof text);
    if (bytes > LARGE_MATRICES && !scene->large_matrices) {
        weft__report_error(reader->report, at,
                           "method '%.40s' keeps %s: more than %g MB need "
                           "stepper.large_matrices: true",
                           scene->method, text, 1e-6 * LARGE_MATRICES);
    } else if (bytes > 0.0 && particles > WEFT__DENSE_MOST) {
        weft__report_warning(reader->report, at,
                             "method '%.40s' keeps %s: for small cloths only",
                             scene->method, text);
    }
}

/* The keys of a section that were not among the options of a stepper. */
typedef struct unused {
    const weft__node *map;
    bool used[WEFT__MAX_KEYS]; /* in the order of the map's pairs */
} unused;

static void mark_used(void *ctx, const char *name, const char *value)
{
    unused *keys = ctx;
    const size_t slot = weft__find_key(keys->map, name, strlen(name));
    (void)value;
    if (slot < keys->map->count) {
        keys->used[slot] = true;
    }
}

/* Which keys of stepper.solver a method uses, its options say. */
static void check_solver_use(weft__reader *reader, const weft__match *match,
                             const void *stepper)
{
    const weft_scene *scene = reader->scene;
    unused keys = { .map = weft__value_in(match, "solver") };
    if (keys.map == NULL || !WEFT_HAS(scene->type, weft_stepper_type, options)
        || scene->type->options == NULL) {
        return;
    }
    scene->type->options(stepper, mark_used, &keys);
    for (size_t i = 0; i < keys.map->count; ++i) {
        const weft__node *key = keys.map->entries[i].key;
        if (!keys.used[i]) {
            ERROR_AT(reader, key,
                     "%s would not be used by method '%.40s' of plugin '%.40s'",
                     key->text, scene->method, scene->plugin);
        }
    }
}

/* Creates a stepper for one particle to find what only the method can refuse, such as a
 * table that is not of its order. */
static void check_creation(weft__reader *reader, const weft__match *match)
{
    const weft_scene *scene = reader->scene;
    const weft__node *table = weft__key_in(match, "butcher");
    const weft__node *solver = weft__key_in(match, "solver");
    const weft_structure structure = weft__one_structure(NULL);
    weft_stepper_config config = scene->config;
    weft_error why = { 0 };
    void *stepper = NULL;
    config.structure = &structure;
    config.allocator = reader->report->memory;
    const weft_status status
        = scene->type->create(scene->type, &weft__one_ode, &config, &stepper, &why);
    if (status == WEFT_OK) {
        check_solver_use(reader, match, stepper);
        scene->type->destroy(stepper);
    } else if (status == WEFT_NO_MEMORY) {
        reader->report->no_memory = true;
    } else {
        ERROR_AT(reader,
                 table != NULL    ? table
                 : solver != NULL ? solver
                                  : weft__value_in(match, "method"),
                 "%s", why.message);
    }
}

void weft__check_stepper(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_scene *scene = base;
    const weft_stepper_type *type = scene->type;
    const weft__node *method = weft__value_in(match, "method");
    weft__report_place(reader->report, (method == NULL ? match->map : method)->at,
                       &reader->scene->refusal);
    check_sizes(reader, match);
    warn_of_sizes(reader, match);
    if (type == NULL) {
        report_type(reader, match);
    } else {
        check_matrices(reader, match);
        if ((type->flags & WEFT_STEPPER_FIXED_ONLY) != 0
            && weft__lacks(match, "fixed_step")) {
            ERROR_AT(
                reader, weft__value_in(match, "method"),
                "method '%.40s' has no error control: it needs stepper.fixed_step [s]",
                scene->method);
        }
    }
    if (type == NULL ? asks_for_table(scene)
                     : (type->flags & WEFT_STEPPER_BUTCHER) != 0) {
        check_table(reader, match);
    }
    if (type != NULL && type->create != NULL && reader->report->mistakes == 0) {
        check_creation(reader, match);
    }
}

/* Of weft's own plugins the first method that has a flag and is of a method's kind:
 * implicit, or explicit and of order 5 or more, both with error control. */
static void name_other(const weft_scene_def *def, const weft_stepper_type *than,
                       uint32_t flag, char *out, size_t size)
{
    const uint32_t unfit = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_LEGACY
                           | WEFT_STEPPER_DENSE | WEFT_STEPPER_BUTCHER;
    const uint32_t kind = WEFT_STEPPER_IMPLICIT;
    weft_error why;
    out[0] = '\0';
    for (size_t i = 0; i < WEFT__SHIPPED && out[0] == '\0'; ++i) {
        const weft_plugin *plugin
            = def->find_plugin(def->find_ctx, weft__shipped[i], &why);
        for (size_t k = 0; plugin != NULL && plugin->types[k] != NULL; ++k) {
            const weft_stepper_type *type = plugin->types[k];
            const bool same = ((type->flags ^ than->flags) & kind) == 0;
            if ((type->flags & flag) != 0 && (type->flags & unfit) == 0 && same
                && ((type->flags & kind) != 0 || type->order > 4)) {
                (void)snprintf(out, size, "%.40s/%.40s", plugin->id, type->name);
                break;
            }
        }
    }
}

void weft__require_flag(weft__reader *reader, uint32_t flag, weft__mark at,
                        const weft__lack *lack)
{
    const weft_scene *scene = reader->scene;
    weft_error why;
    char names[240], hint[400] = "";
    if (scene->type == NULL || (scene->type->flags & flag) != 0) {
        return;
    }
    weft__methods_list(
        reader->def->find_plugin(reader->def->find_ctx, scene->plugin, &why), flag,
        names, sizeof names);
    if (names[0] != '\0') {
        (void)snprintf(hint, sizeof hint, "; of that plugin these %s: %s", lack->can,
                       names);
    } else {
        name_other(reader->def, scene->type, flag, names, sizeof names);
        if (names[0] != '\0') {
            (void)snprintf(hint, sizeof hint, "; %s %s", names, lack->does);
        }
    }
    weft__report_error(reader->report, at,
                       "method '%.40s' of plugin '%.40s' %s%s; or %s", scene->method,
                       scene->plugin, lack->lacks, hint, lack->instead);
}

/* Reported where the ledger is asked for; the stepper has been read before. */
void weft__check_record(weft__reader *reader, const weft__match *match, void *base)
{
    const weft_record_def *record = base;
    if (record->ledger) {
        const weft__lack lack = { "cannot keep the energy balance", "can", "can",
                                  "set record.ledger to false" };
        weft__require_flag(reader, WEFT_STEPPER_QUADRATURES,
                           weft__value_in(match, "ledger")->at, &lack);
    }
}
