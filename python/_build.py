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
        return subprocess.run(["pkg-config", *arguments, "weft"], check=True, text=True,
                              stdout=subprocess.PIPE).stdout.strip()
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
extern "Python" void weftpy_log(void *, weft_log_level, const char *);
extern "Python" void weftpy_refused(void *, const weft_error *);
extern "Python" void weftpy_line(void *, const char *);
extern "Python" void weftpy_option(void *, const char *, const char *);
extern const char *const weftpy_prefix;
weft_log weftpy_log_of(void);
weft_status weftpy_scene(weft_registry *, weft_scene_def *, weft_scene **, weft_diagnostics *, weft_error *);
void weftpy_masses(const weft_cloth *, double *);
void weftpy_pinned(const weft_cloth *, bool *);
void weftpy_index(const weft_cloth *, size_t *);
weft_status weftpy_advance(weft_sim *, double, double, const bool *, weft_error *);
"""

SOURCE = r"""
#include <time.h>
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
    return weft_scene_load(def, out, found, err);
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

static double weftpy_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* weft_sim_advance for about `seconds` on the clock, or until a callback has raised: Python handles
 * signals between two calls. */
static weft_status weftpy_advance(weft_sim *sim, double t_end, double seconds, const bool *raised,
                                  weft_error *err)
{
    const double end = weftpy_clock() + seconds;
    weft_status status = WEFT_OK;
    while (weft_sim_time(sim) != t_end && status == WEFT_OK && !*raised) {
        status = weft_sim_step(sim, t_end, err);
        if (weftpy_clock() >= end) {
            break;
        }
    }
    return status;
}
"""

ffi = FFI()
ffi.cdef(declarations() + OURS)
ffi.set_source("weft._weft", SOURCE, include_dirs=INCLUDES)
