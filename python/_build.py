# SPDX-License-Identifier: BSD-3-Clause
"""Builds the extension weft._weft. Its declarations are weft's public headers, preprocessed."""
import os
import re
import shlex
import subprocess

from cffi import FFI

HERE = os.path.dirname(os.path.abspath(__file__))
TREE = os.path.dirname(HERE)
IN_TREE = os.path.exists(os.path.join(TREE, "include", "weft", "weft.h"))


def pkg_config(*arguments):
    """What pkg-config prints about an installed weft."""
    try:
        command = [*shlex.split(os.environ.get("PKG_CONFIG", "pkg-config")), *arguments, "weft"]
        return subprocess.run(command, check=True, text=True, stdout=subprocess.PIPE).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        raise SystemExit("weft was not found: install this package from weft's source tree "
                         "(pip install ./python), or install weft and set PKG_CONFIG_PATH") from None


INCLUDES = [os.path.join(TREE, "include")] if IN_TREE else [pkg_config("--variable=includedir")]


def declarations():
    """Types and functions of weft/weft.h; inline functions without what they do. cffi reads no va_list."""
    command = [*shlex.split(os.environ.get("CC", "cc")), "-E", "-std=c11", "-D__attribute__(x)=",
               "-I", INCLUDES[0], "-"]
    try:
        text = subprocess.run(command, input="#include <weft/weft.h>\n", check=True, text=True,
                              stdout=subprocess.PIPE).stdout
    except (OSError, subprocess.CalledProcessError) as error:
        raise SystemExit("weft needs a C compiler (package gcc, or the variable CC): %s" % error) from None
    kept, ours = [], False
    for line in text.splitlines():
        marker = re.match(r'# \d+ "(.*)"', line)
        if marker:
            ours = re.search(r"/weft/\w+\.h$", marker[1]) is not None
        elif ours:
            kept.append(line)
    text = re.sub(r"\bstatic inline ([^{;]*)\{(?:.*\}$|[\s\S]*?^\}$)", r"\1;", "\n".join(kept), flags=re.MULTILINE)
    return re.sub(r"\bint weft_text_format_list\([^;]*;", "", text)


OURS = """
extern "Python" int weftpy_force(void *, double, const double *, double *);
extern "Python" bool weftpy_correct(void *, double, double, double *);
extern "Python" double weftpy_event(void *, const weft_cloth *, double, const double *);
extern "Python" int weftpy_objective(void *, size_t, double, const double *, double *, double *);
extern "Python" bool weftpy_signalled(void);
bool weftpy_must_stop(void *);
extern "Python" void weftpy_log(void *, weft_log_level, const char *);
extern "Python" void weftpy_refused(void *, const weft_error *);
extern "Python" void weftpy_line(void *, const char *);
extern "Python" void weftpy_option(void *, const char *, const char *);
extern const char *const weftpy_prefix;
weft_log weftpy_log_of(void);
weft_status weftpy_scene(weft_registry *, weft_scene_def *, weft_scene **, weft_diagnostics *, weft_error *);
weft_status weftpy_perturbed(weft_registry *, const weft_scene *, weft_scene_perturbed **, weft_error *);
void weftpy_masses(const weft_cloth *, double *);
void weftpy_pinned(const weft_cloth *, bool *);
void weftpy_index(const weft_cloth *, size_t *);
weft_status weftpy_joined(const weft_cloth *, uint32_t *, size_t *, weft_error *);
void weftpy_stop(weft_sim_def *, const weft_run_def *, bool);
void weftpy_destroy(long, size_t, weft_sim *);
weft_status weftpy_advance(weft_sim *, double, double, const bool *, weft_error *);
typedef struct weftpy_added { size_t count; const double *force; } weftpy_added;
int weftpy_add(void *, double, const double *, double *);
void weftpy_advance_some(weft_sim *const *, const double *, size_t, size_t *, const bool *, weft_status *, weft_error *);
void weftpy_states(weft_sim *const *, size_t, const size_t *, double *);
"""

SOURCE = r"""
#include <math.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>
#include <weft/weft.h>

static const char *const weftpy_prefix = WEFTPY_PREFIX;

static void weftpy_log(void *, weft_log_level, const char *);

/* Steps that were rejected are not worth a call of Python. */
static void weftpy_pass(void *ctx, weft_log_level level, const char *text)
{
    if (level > WEFT_LOG_DEBUG) {
        weftpy_log(ctx, level, text);
    }
}

static weft_log weftpy_log_of(void)
{
    return (weft_log){ weftpy_pass, NULL };
}

static bool weftpy_signalled(void);

static double weftpy_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A weft_stop_fn: lets Python handle signals, 20 times per second. */
static bool weftpy_must_stop(void *ctx)
{
    static _Thread_local double last;
    const double now = weftpy_clock();
    (void)ctx;
    if (now - last < 0.05) {
        return false;
    }
    last = now;
    return weftpy_signalled();
}

static const weft_plugin *weftpy_find(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find((weft_registry *)ctx, id, &plugin, err);
    return plugin;
}

static weft_status weftpy_scene(weft_registry *registry, weft_scene_def *def, weft_scene **out,
                                weft_diagnostics *found, weft_error *err)
{
    def->find_plugin = weftpy_find;
    def->find_ctx = registry;
    def->stop = weftpy_must_stop;
    return weft_scene_load(def, out, found, err);
}

static weft_status weftpy_perturbed(weft_registry *registry, const weft_scene *scene, weft_scene_perturbed **out,
                                weft_error *err)
{
    weft_scene_def def = weft_scene_def_default();
    def.find_plugin = weftpy_find;
    def.find_ctx = registry;
    def.stop = weftpy_must_stop;
    return weft_scene_perturbed_create(scene, &def, out, err);
}

static void weftpy_masses(const weft_cloth *cloth, double *mass)
{
    for (size_t i = 0; i < weft_cloth_particles(cloth); ++i) {
        mass[i] = weft_cloth_particle_mass(cloth, i);
    }
}

static void weftpy_index(const weft_cloth *cloth, size_t *index)
{
    for (size_t v = 0; v < weft_cloth_particles(cloth); ++v) {
        index[v] = weft_cloth_index(cloth, v);
    }
}

static void weftpy_pinned(const weft_cloth *cloth, bool *pinned)
{
    for (size_t i = 0; i < weft_cloth_particles(cloth); ++i) {
        pinned[i] = weft_cloth_pinned(cloth, i);
    }
}

/* A method that takes no step, and gets to know what forces join as an implicit one does. */
typedef struct weftpy_pairs {
    weft_stepper_type type;
    uint32_t *pairs; /* of places in a state; NULL: count alone */
    size_t count;
} weftpy_pairs;

static void weftpy_pair(weftpy_pairs *to, size_t p, size_t q)
{
    if (to->pairs != NULL) {
        to->pairs[2 * to->count] = (uint32_t)p;
        to->pairs[2 * to->count + 1] = (uint32_t)q;
    }
    ++to->count;
}

static weft_status weftpy_pairs_create(const weft_stepper_type *type, const weft_ode *ode,
                                       const weft_stepper_config *config, void **self, weft_error *err)
{
    weftpy_pairs *to = (weftpy_pairs *)type;
    const weft_structure *of = weft_stepper_structure(config);
    (void)ode, (void)err;
    *self = to;
    for (size_t i = 0; i < of->run_count; ++i) {
        for (size_t k = 0; k < of->runs[i].count; ++k) {
            weftpy_pair(to, of->runs[i].p + k, of->runs[i].q + k);
        }
    }
    for (size_t i = 0; i < of->block_coupling_count; ++i) {
        weftpy_pair(to, of->block_couplings[i].p, of->block_couplings[i].q);
    }
    for (size_t i = 0; i < of->scalar_coupling_count; ++i) {
        weftpy_pair(to, of->scalar_couplings[i].p, of->scalar_couplings[i].q);
    }
    return WEFT_OK;
}

static weft_status weftpy_no_step(void *self, double t_end, double *t, double *y, weft_error *err)
{
    (void)self, (void)t_end, (void)t, (void)y;
    return weft_error_set(err, WEFT_UNSUPPORTED, "takes no steps");
}

/* Unless it would wait for threads that a fork of `process` lacks. In C, because Python would handle a signal, and lose
 * what the handler raises, in a destructor of its own. */
static void weftpy_destroy(long process, size_t threads, weft_sim *sim)
{
    if ((long)getpid() == process || threads < 2) {
        weft_sim_destroy(sim);
    }
}

static void weftpy_nothing(void *self)
{
    (void)self;
}

static void weftpy_no_stats(const void *self, weft_stepper_stats *out)
{
    (void)self, (void)out;
}

/* Particles p and q whose forces depend on each other, by springs, membrane or bending. */
static weft_status weftpy_joined(const weft_cloth *cloth, uint32_t *pairs, size_t *count, weft_error *err)
{
    weftpy_pairs to = { { .abi = WEFT_STEPPER_ABI, .struct_size = sizeof(weft_stepper_type), .name = "pairs",
                          .reference = "", .license = "",
                          .flags = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_STRUCTURE | WEFT_STEPPER_COUPLINGS,
                          .create = weftpy_pairs_create, .step = weftpy_no_step, .state_changed = weftpy_nothing,
                          .stats = weftpy_no_stats, .destroy = weftpy_nothing },
                        pairs, 0 };
    weft_sim *sim = NULL;
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = &to.type;
    const weft_status status = weft_sim_create(&def, &sim, err);
    weft_sim_destroy(sim);
    *count = to.count;
    return status;
}

/* The end that a scene gives a run, as the program does. */
static weft_status weftpy_joined(const weft_cloth *, uint32_t *, size_t *, weft_error *);
/* `own`: of Python, which comes after it. Implicit methods see less of what happens within
 * long steps: none is longer than a frame then. */
void weftpy_stop(weft_sim_def *def, const weft_run_def *run, bool own)
{
    def->event = run->stop.quantity != WEFT_STOP_NEVER ? weft_stop_event : NULL;
    def->event_ctx = (void *)&run->stop; /* which reads it alone */
    def->event_hold = run->stop.hold;
    if ((own || def->event != NULL) && (def->method->flags & WEFT_STEPPER_IMPLICIT) != 0) {
        const double frame = fmax(1.0 / run->fps, def->config.min_step);
        def->config.max_step = fmin(def->config.max_step, frame);
    }
}

/* weft_sim_advance for about `seconds` on the clock, or until a callback has raised: Python handles
 * signals between two calls. An event ends it, too. */
static weft_status weftpy_advance(weft_sim *sim, double t_end, double seconds, const bool *raised,
                                  weft_error *err)
{
    const double end = weftpy_clock() + seconds;
    weft_status status = WEFT_OK;
    while (weft_sim_time(sim) != t_end && status == WEFT_OK && !*raised) {
        status = weft_sim_step(sim, t_end, err);
        if (weftpy_clock() >= end || weft_sim_event(sim)) {
            break;
        }
    }
    const bool there = weft_sim_time(sim) == t_end || weft_sim_event(sim);
    return status == WEFT_OK && there && !*raised ? weft_sim_check_frame(sim, err) : status;
}

/* A weft_force_fn: numbers that stay. */
typedef struct weftpy_added {
    size_t count;
    const double *force;
} weftpy_added;

static int weftpy_add(void *ctx, double t, const double *y, double *f)
{
    const weftpy_added *added = (const weftpy_added *)ctx;
    (void)t, (void)y;
    for (size_t i = 0; i < added->count; ++i) {
        f[i] += added->force[i];
    }
    return 0;
}

/* Advances one simulation after the other, each to its end or an event, until all are taken; several threads share
 * `next`. `stop` ends each after a step. */
static void weftpy_advance_some(weft_sim *const *sims, const double *ends, size_t count, size_t *next,
                                const bool *stop, weft_status *status, weft_error *errors)
{
    const volatile bool *stopped = stop;
    for (size_t i; !*stopped && (i = atomic_fetch_add((_Atomic size_t *)next, 1)) < count;) {
        bool event = false;
        while (weft_sim_time(sims[i]) != ends[i] && status[i] == WEFT_OK && !event && !*stopped) {
            status[i] = weft_sim_step(sims[i], ends[i], &errors[i]);
            event = weft_sim_event(sims[i]);
        }
        if (status[i] == WEFT_OK && !*stopped) {
            status[i] = weft_sim_check_frame(sims[i], &errors[i]);
        }
    }
}

/* (count, 2, N, 3) of the states of simulations of N particles. */
static void weftpy_states(weft_sim *const *sims, size_t count, const size_t *index, double *out)
{
    const size_t n = weft_cloth_particles(weft_sim_cloth(sims[0]));
    for (size_t i = 0; i < 2 * count; ++i) {
        const double *planes = weft_sim_state(sims[i / 2]) + i % 2 * 3 * n;
        for (size_t p = 0; p < n; ++p, out += 3) {
            const size_t at = index == NULL ? p : index[p];
            out[0] = planes[at], out[1] = planes[n + at], out[2] = planes[2 * n + at];
        }
    }
}
"""

ffi = FFI()
ffi.cdef(declarations() + OURS)
ffi.set_source("weft._weft", SOURCE, include_dirs=INCLUDES)
