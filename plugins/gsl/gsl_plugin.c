/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gsl_plugin.c -- the methods of GSL, one record each.
 *
 * Orders are measured (tests/test_stepper_accuracy.c), not taken from GSL's order():
 * rk2 carries on the sum of order 3. Where the error order is the order, a step is
 * compared with two half steps, and these are carried on.
 *
 * gear1, gear2 and rk2simp exist in the older odeiv only. GSL's gear2 is faulty: it
 * takes y_{n-1} for a point half as far back as it is, so that steps of equal length
 * solve y' = 7/6 f [measured, GSL 2.7.1]. The plugin resets it before every step, so
 * that it always uses its starting method, an implicit Runge-Kutta method at
 * Gaussian points with three functional iterations.
 *
 * Quadratures go with methods that treat every component alike and by itself: those of
 * explicit stages or of a fixed number of functional iterations. Newton's pivots and
 * tolerances, and the order of a multistep method, depend on all components.
 *
 * bsimp takes a change of y_i by more than some 100 dim |y_i| for a runaway and asks
 * for a smaller step, so that components near 0, of which a symmetric cloth has many,
 * would stop it. It is given y_i + 1 or y_i - 1, whichever is away from 0. */
#include "gsl_plugin.h"

WEFT_API const weft_plugin *weft_plugin_gsl(void);

#define ASCHER_PETZOLD                                                                 \
    "U. M. Ascher, L. R. Petzold, Computer Methods for ODEs and DAEs, SIAM, 1998"
#define VODE                                                                           \
    "P. N. Brown, G. D. Byrne, A. C. Hindmarsh, SIAM J. Sci. Stat. Comput. 10, 1989"

enum {
    LIBM = WEFT_STEPPER_LIBM, /* GSL compares powers: of orders, iterations, columns */
    MULTISTEP = WEFT_STEPPER_MULTISTEP,
    NEWTON = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_DENSE,
    APART = WEFT_STEPPER_QUADRATURES,
    FUNCTIONAL = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_LEGACY | APART
};

/* id, order, error order, RHS calls, flags, source; then the rest of the record */
#define METHOD(id, p, q, calls, kind, source, ...)                                     \
    {                                                                                  \
        .type = { .abi = WEFT_STEPPER_ABI,                                             \
                  .struct_size = sizeof(weft_stepper_type),                            \
                  .name = #id,                                                         \
                  .reference = (source),                                               \
                  .license = "GPL-3.0-or-later",                                       \
                  .order = (p),                                                        \
                  .error_order = (q),                                                  \
                  .stages = (calls),                                                   \
                  .flags = (kind),                                                     \
                  .create = weft__gsl_create,                                          \
                  .step = weft__gsl_step,                                              \
                  .state_changed = weft__gsl_state_changed,                            \
                  .stats = weft__gsl_stats,                                            \
                  .destroy = weft__gsl_destroy,                                        \
                  .options = weft__gsl_options },                                      \
        __VA_ARGS__                                                                    \
    }
#define V2(id) .v2 = &gsl_odeiv2_step_##id
#define V1(id) .v1 = &gsl_odeiv_step_##id

/* solver_tol: 0 where no equations are iterated to an accuracy. Newton's iteration ends
 * well above roundoff, where it would be taken for divergence. A multistep method also
 * chooses its order by it: the order rises where the error is far below, and stays at 1
 * with a small one. */
static const gsl_method methods[] = {
    METHOD(rk2, 3, 2, 3, APART, "W. Kutta, Z. Math. Phys. 46, 1901 (third order)",
           V2(rk2), .vectors = 8),
    METHOD(rk4, 4, 4, 11, APART, "W. Kutta, Z. Math. Phys. 46, 1901", V2(rk4),
           .vectors = 9),
    METHOD(rkf45, 5, 4, 6, APART, "E. Fehlberg, NASA TR R-315, 1969", V2(rkf45),
           .vectors = 12),
    METHOD(rkck, 5, 4, 6, APART, "J. R. Cash, A. H. Karp, ACM TOMS 16, 1990", V2(rkck),
           .vectors = 12),
    METHOD(rk8pd, 8, 7, 13, APART,
           "P. J. Prince, J. R. Dormand, J. Comp. Appl. Math. 7, 1981", V2(rk8pd),
           .vectors = 19),
    METHOD(msadams, 0, 0, 0, MULTISTEP | LIBM, VODE, V2(msadams), .vectors = 37,
           .solver_tol = 1e-2),
    METHOD(rk1imp, 1, 1, 0, NEWTON | LIBM, ASCHER_PETZOLD, V2(rk1imp), .vectors = 24,
           .type.matrices = 2, .solver_tol = 1e-9),
    METHOD(rk2imp, 2, 2, 0, NEWTON | LIBM, ASCHER_PETZOLD, V2(rk2imp), .vectors = 24,
           .type.matrices = 2, .solver_tol = 1e-9),
    METHOD(rk4imp, 4, 4, 0, NEWTON | LIBM, ASCHER_PETZOLD, V2(rk4imp), .vectors = 32,
           .type.matrices = 5, .solver_tol = 1e-9),
    METHOD(bsimp, 0, 0, 0, NEWTON | LIBM,
           "G. Bader, P. Deuflhard, Numer. Math. 41, 1983", V2(bsimp), .vectors = 34,
           .type.matrices = 2, .shift = true),
    METHOD(msbdf, 0, 0, 0, NEWTON | MULTISTEP | LIBM, VODE, V2(msbdf), .vectors = 36,
           .type.matrices = 2, .solver_tol = 1e-2),
    METHOD(gear1, 1, 1, 9, FUNCTIONAL, "C. W. Gear, Prentice-Hall, 1971", V1(gear1),
           .vectors = 10),
    METHOD(gear2, 4, 4, 20, FUNCTIONAL, ASCHER_PETZOLD, V1(gear2), .vectors = 18,
           .forget = true),
    METHOD(rk2simp, 2, 2, 0, NEWTON | WEFT_STEPPER_LEGACY, ASCHER_PETZOLD, V1(rk2simp),
           .vectors = 16, .type.matrices = 1),
};

WEFT_API const weft_plugin *weft_plugin_gsl(void)
{
    static const weft_stepper_type *const types[] = {
        &methods[0].type,  &methods[1].type,  &methods[2].type,
        &methods[3].type,  &methods[4].type,  &methods[5].type,
        &methods[6].type,  &methods[7].type,  &methods[8].type,
        &methods[9].type,  &methods[10].type, &methods[11].type,
        &methods[12].type, &methods[13].type, NULL,
    };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "gsl",
        .version = WEFT_VERSION,
        .solver = "GSL " GSL_VERSION,
        .types = types,
    };
    return &plugin;
}
