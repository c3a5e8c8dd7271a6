/* SPDX-License-Identifier: BSD-3-Clause */
/* page.c -- one simulation, and the functions that the playground's worker calls on it
 * (viewer/src/playground-worker.js). */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

#include "base/clock.h"
#include "weft/stability.h"
#include "weft/weft.h"

/* A function of that name for the page; nothing in C calls it. */
#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif
#define CALL(type, name, ...)                                                          \
    EXPORT(name) type page_##name(__VA_ARGS__);                                        \
    type page_##name(__VA_ARGS__)

enum { TEXT = 1 << 16, NOBODY = -1 };

static struct {
    weft_registry *registry;
    weft_scene *scene;
    weft_cloth *cloth;
    weft_sim *sim;
    weft_diagnostics found;
    weft_error err;
    size_t frame;  /* the last one */
    uint64_t hash; /* of its state */
    float *places;
    double *strain;
    char text[TEXT];
    size_t used;
    int dragged; /* particle, or NOBODY */
    bool pinned; /* it is when released */
    double to[3];
    double start, size; /* [m] of the box around the cloth */
    bool sudden;        /* it grew in the last step as no motion does */
} page = { .dragged = NOBODY };

static void put(const char *format, ...)
{
    va_list values;
    va_start(values, format);
    const int length
        = vsnprintf(page.text + page.used, TEXT - page.used, format, values);
    va_end(values);
    page.used += (size_t)length < TEXT - page.used ? (size_t)length : 0;
}

static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)ctx;
    (void)weft_registry_find(page.registry, id, &plugin, err);
    return plugin;
}

static void forget(void)
{
    weft_sim_destroy(page.sim);
    weft_cloth_destroy(page.cloth);
    weft_scene_destroy(page.scene);
    free(page.places);
    free(page.strain);
    page.sim = NULL;
    page.cloth = NULL;
    page.scene = NULL;
    page.places = NULL;
    page.strain = NULL;
    page.frame = 0;
    page.dragged = NOBODY;
}

static weft_status load(size_t count, const char *const *sets)
{
    weft_registry_def plugins = weft_registry_def_default();
    weft_scene_def def = weft_scene_def_default();
    def.file = "scene.yaml";
    def.sets = sets;
    def.set_count = count;
    def.find_plugin = find_plugin;
    if (page.registry == NULL
        && weft_registry_create(&plugins, &page.registry, &page.err) != WEFT_OK) {
        return WEFT_NO_MEMORY;
    }
    page.found = (weft_diagnostics){ .count = 0 };
    return weft_scene_load(&def, &page.scene, &page.found, &page.err);
}

/* [m] The diagonal of the box around the cloth; not finite with one of the places. */
static double box_size(void)
{
    const size_t n = weft_cloth_particles(page.cloth);
    const double *x = weft_sim_state(page.sim);
    double sum = 0.0;
    for (size_t k = 0; k < 3; ++k, x += n) {
        double lo = x[0], hi = x[0];
        for (size_t i = 1; i < n; ++i) {
            lo = fmin(lo, x[i]);
            hi = fmax(hi, x[i]);
        }
        sum += (hi - lo) * (hi - lo);
    }
    return sqrt(sum);
}

static weft_status begin(void)
{
    weft_sim_def def = weft_sim_def_default();
    weft_status status
        = weft_cloth_create(weft_scene_cloth(page.scene), &page.cloth, &page.err);
    if (status != WEFT_OK) {
        return status;
    }
    def.cloth = page.cloth;
    def.method = weft_scene_method_type(page.scene);
    def.config = *weft_scene_config(page.scene);
    def.limit = *weft_scene_limit(page.scene);
    status = weft_sim_create(&def, &page.sim, &page.err);
    const size_t n = weft_cloth_particles(page.cloth);
    page.places = malloc(n * 3 * sizeof *page.places);
    page.strain = malloc(n * sizeof *page.strain);
    if (status != WEFT_OK) {
        page.found.count = 1;
        weft_scene_refusal(page.scene, &page.err, &page.found.items[0]);
    }
    return page.places == NULL || page.strain == NULL ? WEFT_NO_MEMORY : status;
}

/* Room for text of the page, which frees nothing. */
CALL(void *, room, size_t size)
{
    return malloc(size);
}

/* scene.yaml with overrides; 0: it runs. */
CALL(int, open, size_t count, const char *const *sets)
{
    forget();
    page.err = (weft_error){ .message = "" };
    weft_status status = load(count, sets);
    status = status == WEFT_OK ? begin() : status;
    if (status == WEFT_OK) {
        page.hash = weft_sim_measure(page.sim).hash;
        page.start = page.size = box_size();
        page.sudden = false;
    }
    return (int)status;
}

static void put_json(const char *text)
{
    put("\"");
    for (; *text != '\0'; ++text) {
        put(*text == '"' || *text == '\\' ? "\\%c"
            : (unsigned char)*text < 0x20 ? "\\u%04x"
                                          : "%c",
            *text);
    }
    put("\"");
}

/* What there is to say of the scene: [{line, column, warning, place, message}, ...],
 * else the error of the last call. */
CALL(const char *, mistakes, void)
{
    page.used = 0;
    put("[");
    for (size_t i = 0; i < page.found.count; ++i) {
        const weft_diagnostic *one = &page.found.items[i];
        put("%s{\"line\":%d,\"column\":%d,\"warning\":%s,\"place\":", i > 0 ? "," : "",
            one->line, one->column, one->warning ? "true" : "false");
        put_json(one->place);
        put(",\"message\":");
        put_json(one->message);
        put("}");
    }
    if (page.found.count == 0 && page.err.message[0] != '\0') {
        put("{\"line\":0,\"column\":0,\"warning\":false,\"place\":\"\",\"message\":");
        put_json(page.err.message);
        put("}");
    }
    put("]");
    return page.text;
}

static void put_vector(const char *name, const double v[3])
{
    put(",\"%s\":[%.17g,%.17g,%.17g]", name, v[0], v[1], v[2]);
}

static void put_turn(const weft_shape *shape)
{
    const weft_turn *turn = &shape->turn;
    if (turn->axis[0] != 0.0 || turn->axis[1] != 0.0 || turn->axis[2] != 0.0) {
        put(",\"turn\":{\"rate\":%.17g,\"amplitude\":%.17g,\"frequency\":%.17g",
            turn->rate, turn->amplitude, turn->frequency);
        put_vector("axis", turn->axis);
        put_vector("about", isnan(turn->about[0]) ? shape->at : turn->about);
        put("}");
    }
}

static void put_shapes(void)
{
    const weft_contact_def contact = weft_cloth_contact(page.cloth);
    put(",\"thickness\":%.17g,\"self\":%s,\"obstacles\":[", contact.thickness,
        contact.self ? "true" : "false");
    for (size_t k = 0; k < weft_cloth_shapes(page.cloth); ++k) {
        const weft_shape shape = weft_cloth_shape(page.cloth, k);
        put("%s{\"shape\":\"%s\",\"radius\":%.17g,\"rounding\":%.17g,\"frequency\":%."
            "17g",
            k > 0 ? "," : "", weft_shape_name(shape.kind), shape.radius, shape.rounding,
            shape.frequency);
        put_vector("at", shape.at);
        put_vector("to", shape.to);
        put_vector("normal", shape.normal);
        put_vector("half", shape.half);
        put_vector("velocity", shape.velocity);
        put_vector("amplitude", shape.amplitude);
        put_vector("spin", shape.spin);
        put_turn(&shape);
        put("}");
    }
    put("]");
}

/* The largest stable step [s] as `weft check` has it; 0: none is known. */
static double stable_step(const weft_stiffness *modes)
{
    weft_stability stability;
    weft_error err;
    double h = 0.0;
    const weft_stepper_type *type = weft_scene_method_type(page.scene);
    const double growth = log(2.0) / weft_scene_run(page.scene)->duration;
    if (weft_stability_create(type, weft_scene_config(page.scene)->butcher, &stability,
                              &err)
            != WEFT_OK
        || weft_stability_step(&stability, modes, growth, &h, &err) != WEFT_OK) {
        return 0.0;
    }
    return isfinite(h) ? h : 0.0;
}

/* The scene that runs, for drawing and for the sliders. */
CALL(const char *, describe, void)
{
    const weft_cloth_def *def = weft_scene_cloth(page.scene);
    const weft_stiffness modes
        = weft_sim_stiffness(page.sim, 0.0, weft_sim_state(page.sim));
    const char *separator = "";
    page.used = 0;
    put("{\"name\":");
    put_json(weft_scene_name(page.scene));
    put(",\"rows\":%zu,\"cols\":%zu,\"count\":%zu", weft_cloth_rows(page.cloth),
        weft_cloth_cols(page.cloth), weft_cloth_particles(page.cloth));
    put(",\"fps\":%.17g,\"plugin\":\"%s\",\"method\":\"%s\",\"step\":%.17g",
        weft_scene_run(page.scene)->fps, weft_scene_plugin(page.scene),
        weft_scene_method(page.scene), weft_scene_config(page.scene)->fixed_step);
    put(",\"limit\":%.17g,\"stable\":%.17g",
        modes.omega2 > 0.0 ? 2.0 / sqrt(modes.omega2) : 0.0, stable_step(&modes));
    put(",\"springs\":{");
    for (int k = 0; k < WEFT_FAMILIES && weft_scene_fabric(page.scene) == NULL; ++k) {
        if (def->springs[k].stiffness > 0.0) {
            put("%s\"%s\":[%.17g,%.17g]", separator, weft_family_name((weft_family)k),
                def->springs[k].stiffness, def->springs[k].damping);
            separator = ",";
        }
    }
    put("},\"pinned\":[");
    separator = "";
    for (size_t i = 0; i < weft_cloth_particles(page.cloth); ++i) {
        if (weft_cloth_pinned(page.cloth, i)) {
            put("%s%zu", separator, i);
            separator = ",";
        }
    }
    put("]");
    put_shapes();
    put("}");
    return page.text;
}

/* Of triangles: their corners, three each; 0: a grid. */
CALL(size_t, triangles, uint32_t *corners)
{
    return weft_cloth_cols(page.cloth) > 0 ? 0
                                           : weft_cloth_triangles(page.cloth, corners);
}

/* Coordinate k of the dragged particle [m]. */
static double dragged_at(size_t k)
{
    const size_t at = weft_cloth_index(page.cloth, (size_t)page.dragged);
    return weft_sim_state(page.sim)[k * weft_cloth_particles(page.cloth) + at];
}

/* Moves the dragged particle so that it arrives at `until`, at no more than ten metres
 * per second: a jump would tear its springs. */
static weft_status pull(double until)
{
    enum { FASTEST = 10 };
    double velocity[3], speed = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        velocity[k] = (page.to[k] - dragged_at(k)) / (until - weft_sim_time(page.sim));
        speed = hypot(speed, velocity[k]);
    }
    for (size_t k = 0; k < 3; ++k) {
        velocity[k] *= speed > FASTEST ? FASTEST / speed : 1.0;
    }
    return weft_sim_pin(page.sim, (size_t)page.dragged, velocity, &page.err);
}

/* After a step: by a few per cent of its size a cloth grows only if the method is not
 * stable. */
static void watch(void)
{
    const double before = page.size;
    page.size = box_size();
    page.sudden = page.size > 1.2 * page.start && page.size > 1.03 * before;
}

/* Steps, cut by frames alone, until the time is `until` [s] or `budget` [s] of the
 * clock are over, or after one in which the cloth grew suddenly. 0: all is well. */
CALL(int, advance, double until, double budget)
{
    const double fps = weft_scene_run(page.scene)->fps;
    const double end = weft__wall_clock() + budget;
    weft_status status = page.dragged != NOBODY && until > weft_sim_time(page.sim)
                             ? pull(until)
                             : WEFT_OK;
    while (status == WEFT_OK && weft_sim_time(page.sim) < until) {
        const double next = (double)(page.frame + 1) / fps;
        status = weft_sim_step(page.sim, next, &page.err);
        if (status == WEFT_OK && weft_sim_time(page.sim) == next) {
            ++page.frame;
            page.hash = weft_sim_measure(page.sim).hash;
        }
        watch();
        if (page.sudden || weft__wall_clock() >= end) {
            break;
        }
    }
    return (int)status;
}

/* Particle i follows `drag` from now on; NOBODY: it is released where it is. */
CALL(int, grab, int i)
{
    weft_status status = WEFT_OK;
    if (page.dragged != NOBODY) {
        const size_t last = (size_t)page.dragged;
        status = page.pinned ? weft_sim_pin(page.sim, last, NULL, &page.err)
                             : weft_sim_unpin(page.sim, last, &page.err);
    }
    page.dragged = i;
    page.pinned = i != NOBODY && weft_cloth_pinned(weft_sim_cloth(page.sim), (size_t)i);
    for (size_t k = 0; i != NOBODY && k < 3; ++k) {
        page.to[k] = dragged_at(k);
    }
    return (int)status;
}

CALL(void, drag, double x, double y, double z)
{
    page.to[0] = x;
    page.to[1] = y;
    page.to[2] = z;
}

/* x y z of particle 0 [m], x y z of particle 1, ... */
CALL(const float *, places, void)
{
    weft_sim_vertices(page.sim, page.places, NULL, 0);
    return page.places;
}

/* The largest strain of the springs at each particle. */
CALL(const double *, strains, void)
{
    weft_cloth_strains(page.cloth, weft_sim_state(page.sim), page.strain);
    return page.strain;
}

/* The time, the energies, what the stepper did, and the last frame. */
CALL(const char *, measure, void)
{
    const weft_energy energy = weft_cloth_energy(
        weft_sim_cloth(page.sim), weft_sim_time(page.sim), weft_sim_state(page.sim));
    const weft_stepper_stats stats = weft_sim_stats(page.sim);
    const double numbers[]
        = { weft_sim_time(page.sim), energy.kinetic,         weft_energy_total(energy),
            stats.last_step,         (double)stats.steps,    (double)stats.rhs_calls,
            (double)page.frame,      page.size / page.start, page.sudden };
    static const char *const names[] = { "time",  "kinetic", "total", "step",  "steps",
                                         "calls", "frame",   "size",  "sudden" };
    page.used = 0;
    put("{\"hash\":\"%016" PRIx64 "\"", page.hash);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
        if (isfinite(numbers[i])) {
            put(",\"%s\":%.17g", names[i], numbers[i]);
        }
    }
    put("}");
    return page.text;
}
