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

/* The packages are those of debian/control, tools/dist and packaging/spack. */
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
