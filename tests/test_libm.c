/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: first slow alone asan-long computes */
/* test_libm.c -- the bits of a run do not depend on libm, on the processor or on the
 * machine: weft here and an OTHER weft leave the same bytes. OTHER is a command in the
 * environment; without one it is this weft with a libm that is wrong by up to one part
 * in 1e9 (wrong_libm.c). */
#include "shell.h"
#include "stepper_run.h"
#include "weft/elementary.h"

#define OUT BUILD_DIR "/libm"
#define WRONG                                                                          \
    "ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" BUILD_DIR                      \
    "/tests/wrong_libm.so "

static const char *other(void)
{
    const char *given = getenv("OTHER");
    return given != NULL ? given : WRONG WEFT;
}

/* A sheet that swings between two pins that swing by themselves. */
static const char scene[]
    = "weft: 1\n"
      "cloth:\n"
      "  grid: {rows: 5, cols: 5, spacing: 0.1}\n"
      "  density: 0.3\n"
      "  springs:\n"
      "    stretch: {stiffness: 80, damping: 0.01}\n"
      "    shear: {stiffness: 30}\n"
      "  pins:\n"
      "    - {at: top-left, amplitude: [0.05, 0, 0.1], frequency: 0.7}\n"
      "    - {at: top-right, amplitude: [0, 0, -0.1], frequency: 1.3}\n"
      "forces: {wind: {velocity: [2, 0, 1], drag: 0.5}}\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.2, fps: 50}\n";

#define AT_REST "--set 'cloth.pins=[top-left, top-right]' "

static void begin(void)
{
    (void)unsetenv("WEFT_PLUGIN_PATH");
    (void)shell("rm -rf " OUT " && mkdir -p " OUT);
    write_file(OUT "/scene.yaml", scene);
}

static void same_bytes(const char *file, const char *sets)
{
    const int code = shell("%s run %s --quiet --force --out " OUT "/here %s 2>&1 && "
                           "%s run %s --quiet --force --out " OUT "/there %s 2>&1 && "
                           "cd " OUT " && cmp here/series.csv there/series.csv && "
                           "cmp here/final.csv there/final.csv",
                           WEFT, file, sets, other(), file, sets);
    ck_assert_msg(code == 0, "%s %s: %s", file, sets, output);
}

/* The test program prints an exponential if it has an argument. */
START_TEST(the_other_libm_is_wrong)
{
    if (getenv("OTHER") == NULL) {
        expect(shell(BUILD_DIR "/tests/test_libm exponential"), 0);
        const double right = atof(output);
        expect(shell(WRONG BUILD_DIR "/tests/test_libm exponential"), 0);
        ck_assert_double_eq_tol(atof(output), right, 1e-8);
        ck_assert_double_ne(atof(output), right);
    }
}
END_TEST

static int powers;

/* The solvers of this process find this one before libm's. */
WEFT_API double pow(double x, double y)
{
    ++powers;
    return weft_pow(x, y);
}

/* Of rkc's coefficients. */
WEFT_API double sinh(double x)
{
    ++powers;
    return 0.5 * (exp(x) - exp(-x));
}

START_TEST(methods_that_ask_libm_for_powers_say_so)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool fixed_only = (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0;
    const weft_stepper_config config = fixed_only ? fixed(0.01) : adaptive(1e-5);
    trial_run r;
    powers = 0;
    start(&r, type, &config);
    go(&r, 1.0);
    end(&r);
    ck_assert_msg((powers > 0) == ((type->flags & WEFT_STEPPER_LIBM) != 0),
                  "%s: %d powers", test_method_label((size_t)_i), powers);
}
END_TEST

START_TEST(every_method_has_the_same_bits)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool fixed = (type->flags & WEFT_STEPPER_FIXED_ONLY) != 0;
    const bool dense = (type->flags & WEFT_STEPPER_DENSE) != 0;
    const int plugin = (int)strcspn(test_method_label((size_t)_i), "/");
    char sets[384];
    if ((type->flags & WEFT_STEPPER_BUTCHER) != 0 || test_is_spared(type)) {
        return; /* ARKODE's steps are tested by its own tables */
    }
    if (test_adaptive_only(type) || weft_stepper_is(type, "rkc")) {
        return; /* CVODE's h itself is a power, and a coefficient of rkc a logarithm */
    }
    const char *damped = test_needs_damping(type)
                             ? "--set cloth.springs.stretch.damping=5 --set "
                               "cloth.springs.shear.damping=2 "
                             : "";
    (void)snprintf(
        sets, sizeof sets, "%s%s--set 'stepper={plugin: %.*s, method: %s, %s}'", damped,
        fixed ? "" : AT_REST, plugin, test_method_label((size_t)_i), type->name,
        fixed   ? "fixed_step: 2.0e-4"
        : dense ? "atol: 1.0e-3"
                : "atol: 1.0e-5");
    same_bytes(OUT "/scene.yaml", sets);
}
END_TEST

START_TEST(swinging_pins_have_the_same_bits)
{
    same_bytes(OUT "/scene.yaml", "--set record.ledger=true");
    same_bytes(OUT "/scene.yaml", "--set run.threads=2 --set run.fps=1.0e-2 "
                                  "--set run.duration=100");
}
END_TEST

#ifdef HAVE_ARKODE

#define NAME(label, name, gains) #name,
static const char *const controllers[] = { WEFT_CONTROLLERS(NAME) };
#undef NAME

START_TEST(every_controller_has_the_same_bits)
{
    char sets[384];
    (void)snprintf(sets, sizeof sets,
                   AT_REST "--set 'stepper={plugin: arkode, method: cash_karp, "
                           "controller: {type: %s}}'",
                   controllers[_i]);
    same_bytes(OUT "/scene.yaml", sets);
}
END_TEST

#ifdef HAVE_GSL

static const char *const shipped[]
    = { "flag", "curtain", "trampoline", "two-corners", "hammock" };

START_TEST(shipped_scenes_have_the_same_bits)
{
    static const char *const methods[]
        = { "{plugin: arkode, method: dormand_prince}", "{plugin: gsl, method: rkck}" };
    char file[64], sets[128];
    for (size_t m = (size_t)_i % 2; m < 2; m += (size_t)test_rounds(2, 1)) {
        (void)snprintf(file, sizeof file, "scenes/%s.yaml", shipped[_i]);
        (void)snprintf(sets, sizeof sets, "--set run.duration=0.1 --set 'stepper=%s'",
                       methods[m]);
        same_bytes(file, sets);
    }
}
END_TEST

/* All but the times it took. */
START_TEST(compare_has_the_same_numbers)
{
    const char *what = "compare " OUT "/scene.yaml --quiet --force "
                       "--methods rkck,velocity_verlet --until 0.5";
    const int code
        = shell("%s %s --out " OUT "/here 2>&1 && %s %s --out " OUT "/there 2>&1 && "
                "cd " OUT " && cut -d, -f1-14 here/compare.csv >here.csv && "
                "cut -d, -f1-14 there/compare.csv >there.csv && cmp here.csv there.csv",
                WEFT, what, other(), what);
    ck_assert_msg(code == 0, "%s", output);
    ck_assert_ptr_nonnull(strstr(read_file(OUT "/here.csv"), "fixed_step"));
}
END_TEST

#endif
#endif

int main(int argc, char **argv)
{
    (void)argv;
    if (argc > 1) {
        return printf("%a\n", exp(0.1 * argc)) > 0 ? 0 : 1;
    }
    Suite *suite = suite_create("libm");
    TCase *tcase = tcase_create("libm");
    tcase_add_checked_fixture(tcase, begin, NULL);
    tcase_add_test(tcase, the_other_libm_is_wrong);
    tcase_add_loop_test(tcase, methods_that_ask_libm_for_powers_say_so, 0,
                        (int)test_method_count());
    tcase_add_loop_test(tcase, every_method_has_the_same_bits, 0,
                        (int)test_method_count());
    tcase_add_test(tcase, swinging_pins_have_the_same_bits);
#ifdef HAVE_ARKODE
    tcase_add_loop_test(tcase, every_controller_has_the_same_bits, 0,
                        (int)(sizeof controllers / sizeof controllers[0]));
#ifdef HAVE_GSL
    tcase_add_loop_test(tcase, shipped_scenes_have_the_same_bits, 0,
                        (int)(sizeof shipped / sizeof shipped[0]));
    tcase_add_test(tcase, compare_has_the_same_numbers);
#endif
#endif
    suite_add_tcase(suite, tcase);
    return test_run(suite);
}
