/* SPDX-License-Identifier: BSD-3-Clause */
/* arkode_plugin.c -- the methods: every table of the ARKODE that it is built with, its
 * stabilised methods from 7.2 on, the classics, and `custom`. Orders are measured by
 * tests/test_stepper_accuracy.c. */
#include "arkode_plugin.h"

WEFT_API const weft_plugin *weft_plugin_arkode(void);

#define KENNEDY_CARPENTER "C. A. Kennedy, M. H. Carpenter, Appl. Numer. Math. 44, 2003"
#define KENNEDY_CARPENTER_2019                                                         \
    "C. A. Kennedy, M. H. Carpenter, Appl. Numer. Math. 136, 2019"
#define VERNER_2010 "J. H. Verner, Numer. Algorithms 53, 2010"

enum {
    FIXED = WEFT_STEPPER_FIXED_ONLY,
    FSAL = WEFT_STEPPER_FSAL,
    CUSTOM = WEFT_STEPPER_BUTCHER,
    IMPLICIT = WEFT_STEPPER_IMPLICIT | WEFT_STEPPER_LINEAR | WEFT_STEPPER_COUPLINGS
};

/* Methods with an error estimate have a controller. Weighted norms can leave
 * quadratures out, but Newton's method would not know when these are accurate. Parts of
 * a state agree on a norm; not on iterations, or on bounds of modes. Explicit tables
 * are made in one pass. */
#define KIND(flags)                                                                    \
    ((flags) | ((flags)&IMPLICIT ? 0 : WEFT_STEPPER_QUADRATURES)                       \
     | ((flags) & (IMPLICIT | WEFT_STEPPER_STRUCTURE)                                  \
            ? 0                                                                        \
            : WEFT_STEPPER_DISTRIBUTED | WEFT_STEPPER_PASS)                            \
     | ((flags)&FIXED ? 0 : WEFT_STEPPER_CONTROLLER))

/* X(name, ARKODE's name after ARKODE_, order, error order, RHS calls, flags, source).
 * FSAL tables have one stage more than RHS calls. */
#define SINCE_6_4(X)                                                                   \
    X(heun_euler, HEUN_EULER_2_1_2, 2, 1, 2, 0, "K. Heun, Z. Math. Phys. 45, 1900")    \
    X(bogacki_shampine, BOGACKI_SHAMPINE_4_2_3, 3, 2, 3, FSAL,                         \
      "P. Bogacki, L. F. Shampine, Appl. Math. Lett. 2, 1989")                         \
    X(ark324l2sa, ARK324L2SA_ERK_4_2_3, 3, 2, 4, 0, KENNEDY_CARPENTER)                 \
    X(zonneveld, ZONNEVELD_5_3_4, 4, 3, 5, 0,                                          \
      "J. A. Zonneveld, Mathematisch Centrum, Amsterdam, 1963")                        \
    X(ark436l2sa, ARK436L2SA_ERK_6_3_4, 4, 3, 6, 0, KENNEDY_CARPENTER)                 \
    X(sayfy_aburub, SAYFY_ABURUB_6_3_4, 4, 3, 6, 0,                                    \
      "A. Sayfy, A. Aburub, Intern. J. Comput. Math. 79, 2002")                        \
    X(cash_karp, CASH_KARP_6_4_5, 5, 4, 6, 0,                                          \
      "J. R. Cash, A. H. Karp, ACM TOMS 16, 1990")                                     \
    X(fehlberg45, FEHLBERG_6_4_5, 5, 4, 6, 0, "E. Fehlberg, NASA TR R-315, 1969")      \
    X(dormand_prince, DORMAND_PRINCE_7_4_5, 5, 4, 6, FSAL,                             \
      "J. R. Dormand, P. J. Prince, J. Comp. Appl. Math. 6, 1980")                     \
    X(ark548l2sa, ARK548L2SA_ERK_8_4_5, 5, 4, 8, 0, KENNEDY_CARPENTER)                 \
    X(verner65, VERNER_8_5_6, 6, 5, 8, 0,                                              \
      "J. H. Verner, SIAM J. Numer. Anal. 15, 1978")                                   \
    X(fehlberg87, FEHLBERG_13_7_8, 8, 7, 13, 0, "E. Fehlberg, NASA TR R-287, 1968")    \
    X(knoth_wolke, KNOTH_WOLKE_3_3, 3, 0, 3, FIXED,                                    \
      "O. Knoth, R. Wolke, Appl. Numer. Math. 28, 1998")                               \
    X(ark437l2sa, ARK437L2SA_ERK_7_3_4, 4, 3, 7, 0, KENNEDY_CARPENTER_2019)            \
    X(ark548l2sab, ARK548L2SAb_ERK_8_4_5, 5, 4, 8, 0, KENNEDY_CARPENTER_2019)

#if SUNV >= 606
#define SINCE_6_6(X)                                                                   \
    X(ark2, ARK2_ERK_3_1_2, 2, 1, 3, 0,                                                \
      "F. X. Giraldo, J. F. Kelly, E. M. Constantinescu, SIAM J. Sci. Comput. 35, "    \
      "2013")
#else
#define SINCE_6_6(X)
#endif

#if SUNV >= 607
#define SINCE_6_7(X)                                                                   \
    X(sofroniou_spaletta, SOFRONIOU_SPALETTA_5_3_4, 4, 3, 4, FSAL,                     \
      "M. Sofroniou, G. Spaletta, Math. Comput. Model. 40, 2004")                      \
    X(shu_osher, SHU_OSHER_3_2_3, 3, 2, 3, 0,                                          \
      "C.-W. Shu, S. Osher, J. Comp. Phys. 77, 1988")                                  \
    X(verner65_9, VERNER_9_5_6, 6, 5, 8, FSAL, VERNER_2010)                            \
    X(verner76, VERNER_10_6_7, 7, 6, 10, 0, VERNER_2010)                               \
    X(verner87, VERNER_13_7_8, 8, 7, 13, 0, VERNER_2010)                               \
    X(verner98, VERNER_16_8_9, 9, 8, 16, 0, VERNER_2010)
#else
#define SINCE_6_7(X)
#endif

#if SUNV >= 701
#define SINCE_7_1(X)                                                                   \
    X(forward_euler, FORWARD_EULER_1_1, 1, 0, 1, FIXED,                                \
      "L. Euler, Institutiones calculi integralis I, 1768")                            \
    X(ralston_euler, RALSTON_EULER_2_1_2, 2, 1, 2, 0,                                  \
      "A. Ralston, Math. Comput. 16, 1962")                                            \
    X(midpoint_euler, EXPLICIT_MIDPOINT_EULER_2_1_2, 2, 1, 2, 0,                       \
      "C. Runge, Math. Ann. 46, 1895")
#else
#define SINCE_7_1(X)
#endif

#if SUNV >= 703
#define SINCE_7_3(X)                                                                   \
    X(ralston, RALSTON_3_1_2, 2, 1, 2, FSAL, "A. Ralston, Math. Comput. 16, 1962")     \
    X(tsitouras, TSITOURAS_7_4_5, 5, 4, 6, FSAL,                                       \
      "Ch. Tsitouras, Comput. Math. Appl. 62, 2011")
#else
#define SINCE_7_3(X)
#endif

#define ARKODE_TABLES(X)                                                               \
    SINCE_6_4(X) SINCE_6_6(X) SINCE_6_7(X) SINCE_7_1(X) SINCE_7_3(X)

#define KENNEDY_CARPENTER_2016                                                         \
    "C. A. Kennedy, M. H. Carpenter, NASA/TM-2016-219173, 2016"
#define KVAERNO "A. Kvaerno, BIT 44, 2004"

/* X(name, ARKODE's name after ARKODE_, order, error order, flags, source): diagonally
 * implicit. */
#define DIRK_SINCE_6_4(X)                                                              \
    X(sdirk212, SDIRK_2_1_2, 2, 1, 0,                                                  \
      "D. R. Reynolds et al., ARKODE, ACM TOMS 49, 2023")                              \
    X(billington, BILLINGTON_3_3_2, 2, 3, 0,                                           \
      "S. R. Billington, MSc thesis, University of Manchester, 1983")                  \
    X(trbdf2, TRBDF2_3_3_2, 2, 3, 0, "R. E. Bank et al., IEEE Trans. CAD 4, 1985")     \
    X(kvaerno423, KVAERNO_4_2_3, 3, 2, 0, KVAERNO)                                     \
    X(dirk324, ARK324L2SA_DIRK_4_2_3, 3, 2, 0, KENNEDY_CARPENTER)                      \
    X(cash524, CASH_5_2_4, 4, 2, 0, "J. R. Cash, J. ACM 26, 1979")                     \
    X(cash534, CASH_5_3_4, 4, 3, 0, "J. R. Cash, J. ACM 26, 1979")                     \
    X(sdirk534, SDIRK_5_3_4, 4, 3, 0,                                                  \
      "E. Hairer, G. Wanner, Solving ODEs II, Springer, 1991")                         \
    X(kvaerno534, KVAERNO_5_3_4, 4, 3, 0, KVAERNO)                                     \
    X(dirk436, ARK436L2SA_DIRK_6_3_4, 4, 3, 0, KENNEDY_CARPENTER)                      \
    X(kvaerno745, KVAERNO_7_4_5, 5, 4, 0, KVAERNO)                                     \
    X(dirk548, ARK548L2SA_DIRK_8_4_5, 5, 4, 0, KENNEDY_CARPENTER)                      \
    X(dirk437, ARK437L2SA_DIRK_7_3_4, 4, 3, 0, KENNEDY_CARPENTER_2019)                 \
    X(dirk548b, ARK548L2SAb_DIRK_8_4_5, 5, 4, 0, KENNEDY_CARPENTER_2019)               \
    X(esdirk324, ESDIRK324L2SA_4_2_3, 3, 2, 0, KENNEDY_CARPENTER_2019)                 \
    X(esdirk325, ESDIRK325L2SA_5_2_3, 3, 2, 0, KENNEDY_CARPENTER_2016)                 \
    X(esdirk32i5, ESDIRK32I5L2SA_5_2_3, 3, 2, 0, KENNEDY_CARPENTER_2016)               \
    X(esdirk436, ESDIRK436L2SA_6_3_4, 4, 3, 0, KENNEDY_CARPENTER_2016)                 \
    X(esdirk43i6, ESDIRK43I6L2SA_6_3_4, 4, 3, 0, KENNEDY_CARPENTER_2016)               \
    X(qesdirk436, QESDIRK436L2SA_6_3_4, 4, 3, 0, KENNEDY_CARPENTER_2016)               \
    X(esdirk437, ESDIRK437L2SA_7_3_4, 4, 3, 0, KENNEDY_CARPENTER_2019)                 \
    X(esdirk547, ESDIRK547L2SA_7_4_5, 5, 4, 0, KENNEDY_CARPENTER_2016)                 \
    X(esdirk547_2, ESDIRK547L2SA2_7_4_5, 5, 4, 0, KENNEDY_CARPENTER_2019)

#if SUNV >= 606
#define DIRK_SINCE_6_6(X)                                                              \
    X(dirk312, ARK2_DIRK_3_1_2, 2, 1, 0,                                               \
      "F. X. Giraldo, J. F. Kelly, E. M. Constantinescu, SIAM J. Sci. Comput. 35, "    \
      "2013")
#else
#define DIRK_SINCE_6_6(X)
#endif

#if SUNV >= 701
#define DIRK_SINCE_7_1(X)                                                              \
    X(backward_euler, BACKWARD_EULER_1_1, 1, 0, FIXED,                                 \
      "L. Euler, Institutiones calculi integralis I, 1768")                            \
    X(implicit_midpoint, IMPLICIT_MIDPOINT_1_2, 2, 0, FIXED,                           \
      "J. C. Butcher, Math. Comput. 18, 1964")                                         \
    X(implicit_trapezoidal, IMPLICIT_TRAPEZOIDAL_2_2, 2, 0, FIXED,                     \
      "J. Crank, P. Nicolson, Proc. Camb. Phil. Soc. 43, 1947")
#else
#define DIRK_SINCE_7_1(X)
#endif

#define DIRK_TABLES(X) DIRK_SINCE_6_4(X) DIRK_SINCE_6_6(X) DIRK_SINCE_7_1(X)

/* X(name, ARKODE's name after ARKODE_, flags, source): stabilised, of order 2, with as
 * many stages as the damping of the cloth asks for. */
#if SUNV >= 702
#define STABILISED(X)                                                                  \
    X(rkc, LSRK_RKC_2, WEFT_STEPPER_LIBM,                                              \
      "B. P. Sommeijer, L. F. Shampine, J. G. Verwer, J. Comput. Appl. Math. 88, "     \
      "1998")                                                                          \
    X(rkl, LSRK_RKL_2, 0,                                                              \
      "C. D. Meyer, D. S. Balsara, T. D. Aslam, J. Comput. Phys. 257, 2014")
#else
#define STABILISED(X)
#endif

/* X(name, our table, order, RHS calls, flags, source) */
#define OUR_TABLES(X)                                                                  \
    X(euler, &weft__ark_euler, 1, 1, FIXED,                                            \
      "L. Euler, Institutiones calculi integralis I, 1768")                            \
    X(midpoint, &weft__ark_midpoint, 2, 2, FIXED, "C. Runge, Math. Ann. 46, 1895")     \
    X(heun, &weft__ark_heun, 2, 2, FIXED, "K. Heun, Z. Math. Phys. 45, 1900")          \
    X(rk4, &weft__ark_rk4, 4, 4, FIXED, "W. Kutta, Z. Math. Phys. 46, 1901")           \
    X(rk38, &weft__ark_rk38, 4, 4, FIXED, "W. Kutta, Z. Math. Phys. 46, 1901")         \
    X(custom, NULL, 0, 0, CUSTOM, "the table of the scene (stepper.butcher)")

#define TYPE(label, full, p, q, calls, kind, source)                                   \
    {                                                                                  \
        .abi = WEFT_STEPPER_ABI, .struct_size = sizeof(weft_stepper_type),             \
        .name = #label, .reference = (source), .license = "BSD-3-Clause",              \
        .order = (p), .error_order = (q), .stages = (calls), .flags = KIND(kind),      \
        .create = weft__ark_create, .step = weft__ark_step,                            \
        .state_changed = weft__ark_state_changed, .stats = weft__ark_stats,            \
        .destroy = weft__ark_destroy, .full_name = (full),                             \
        .options = weft__ark_options, .ode_changed = weft__ark_ode_changed,            \
    }

#define ARKODE_METHOD(label, full, p, q, calls, kind, source)                          \
    static const ark_method method_##label                                             \
        = { TYPE(label, "ARKODE_" #full, p, q, calls, kind, source),                   \
            ARKODE_##full,                                                             \
            ARKODE_DIRK_NONE,                                                          \
            NULL,                                                                      \
            false,                                                                     \
            0 };
#define IMPLICIT_METHOD(label, full, p, q, kind, source)                               \
    static const ark_method method_##label                                             \
        = { TYPE(label, "ARKODE_" #full, p, q, 0, (kind) | IMPLICIT, source),          \
            ARKODE_ERK_NONE,                                                           \
            ARKODE_##full,                                                             \
            NULL,                                                                      \
            false,                                                                     \
            0 };
#define STABILISED_METHOD(label, full, kind, source)                                   \
    static const ark_method method_##label                                             \
        = { TYPE(label, "ARKODE_" #full, 2, 2, 0,                                      \
                 (kind) | FSAL | WEFT_STEPPER_STRUCTURE, source),                      \
            ARKODE_ERK_NONE,                                                           \
            ARKODE_DIRK_NONE,                                                          \
            NULL,                                                                      \
            true,                                                                      \
            ARKODE_##full };
#define OUR_METHOD(label, from, p, calls, kind, source)                                \
    static const ark_method method_##label                                             \
        = { TYPE(label, NULL, p, 0, calls, kind, source),                              \
            ARKODE_ERK_NONE,                                                           \
            ARKODE_DIRK_NONE,                                                          \
            from,                                                                      \
            false,                                                                     \
            0 };

ARKODE_TABLES(ARKODE_METHOD)
DIRK_TABLES(IMPLICIT_METHOD)
STABILISED(STABILISED_METHOD)
OUR_TABLES(OUR_METHOD)

WEFT_API const weft_plugin *weft_plugin_arkode(void)
{
#define ADDRESS(label, ...) &method_##label.type,
    static const weft_stepper_type *const types[] = { ARKODE_TABLES(
        ADDRESS) DIRK_TABLES(ADDRESS) STABILISED(ADDRESS) OUR_TABLES(ADDRESS) NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "arkode",
        .version = WEFT_VERSION,
        .solver = "SUNDIALS " SUNDIALS_VERSION,
        .types = types,
    };
    return &plugin;
}
