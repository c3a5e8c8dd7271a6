/* SPDX-License-Identifier: BSD-3-Clause */
#include "plugin/missing.h"

#include <string.h>

static const char build_gsl[]
    = "install GSL (Debian: apt-get install libgsl-dev) and build weft again";
static const char build_sundials[]
    = "install SUNDIALS (Debian: apt-get install libsundials-dev) and build weft again";
static const char debian_sundials[] = "apt-get install weft-plugins-sundials";
static const char debian_base[] = "apt-get install weft-plugins-base";
static const char spack_sundials[] = "spack install weft +sundials";

/* The packages are those of debian/control, tools/release/dist and packaging/spack. */
static const struct {
    const char *by, *id, *advice;
} known[] = {
    { "source", "gsl", build_gsl },
    { "source", "arkode", build_sundials },
    { "source", "cvode", build_sundials },
    { "pip", "gsl", "pip install weft-gsl" },
    { "debian", "gsl", "apt-get install weft-plugin-gsl" },
    { "debian", "arkode", debian_sundials },
    { "debian", "cvode", debian_sundials },
    { "debian", "verlet", debian_base },
    { "debian", "stiff", debian_base },
    { "spack", "gsl", "spack install weft +gsl" },
    { "spack", "arkode", spack_sundials },
    { "spack", "cvode", spack_sundials },
};

const char *weft__plugin_advice(const char *by, const char *id)
{
    for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i) {
        if (strcmp(known[i].by, by) == 0 && strcmp(known[i].id, id) == 0) {
            return known[i].advice;
        }
    }
    return NULL;
}
