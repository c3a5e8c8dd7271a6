/* SPDX-License-Identifier: BSD-3-Clause */
/* tags: slow asan-long computes */
/* Random cloths thrown at themselves, under every adaptive method: none passes through
 * itself. `make check-self SECONDS=3600` makes new ones for so long. */
#include "random.h"
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOST = 1600, FEW_STEPS = 500, MANY_STEPS = 1000 };
#define END       1.0  /* [s] of simulated time */
#define CASE_TIME 30.0 /* [s] of a long run, for one cloth */

typedef struct trial {
    uint64_t seed, state;
    bool brief;
    weft_cloth_def def;
    weft_shape floor;
    weft_limit_def limit;
    const char *method;
    char text[160];
} trial;

static double between(trial *of, double least, double most)
{
    return least + (most - least) * random_uniform(&of->state);
}

/* Evenly by its logarithm. */
static double about(trial *of, double least, double most)
{
    return least * pow(most / least, random_uniform(&of->state));
}

static bool one_in(trial *of, int count)
{
    return random_whole(&of->state, 1, count) == 1;
}

/* ---- cloths ---------------------------------------------------------------------- */

static const weft_stepper_type *choose_method(trial *of)
{
    const weft_stepper_type *type;
    do {
        const size_t last = test_method_count() - 1;
        const size_t i = (size_t)random_whole(&of->state, 0, (int64_t)last);
        type = test_method(i);
        of->method = test_method_label(i);
    } while ((type->flags & WEFT_STEPPER_FIXED_ONLY) != 0);
    return type;
}

static void choose_springs(trial *of, bool damped)
{
    static const double stiffness[WEFT_FAMILIES] = { 100.0, 50.0, 5.0 };
    const double stiff = about(of, 0.1, 10.0);
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        const double k0 = stiff * stiffness[k];
        const double time = damped ? 0.1 : about(of, 1e-5, 1e-3); /* [s] */
        of->def.springs[k] = (weft_spring_def){ true, k0, k0 * time };
    }
    of->def.density = about(of, 0.05, 1.0);
    of->def.damping = about(of, 1e-6, 1e-4);
}

static void choose_contact(trial *of)
{
    weft_cloth_def *def = &of->def;
    const double smaller = def->rows == 1   ? def->spacing[1]
                           : def->cols == 1 ? def->spacing[0]
                                            : fmin(def->spacing[0], def->spacing[1]);
    def->contact.self = true;
    def->contact.thickness = about(of, fmin(2e-4, 0.5 * smaller), 0.5 * smaller);
    def->contact.stopping_speed = about(of, 1.0, 20.0);
    def->contact.friction = one_in(of, 3) ? 0.0 : between(of, 0.0, 1.0);
    def->contact.damping = one_in(of, 3) ? 0.0 : 1.0;
    def->contact.law = one_in(of, 4) ? WEFT_FRICTION_COULOMB : WEFT_FRICTION_SMOOTH;
    def->contact.slip = 1e-2;
    of->floor = weft_shape_default(WEFT_PLANE);
    of->floor.at[1] = -0.3;
    def->contact.shapes = &of->floor;
    def->contact.shape_count = one_in(of, 3);
}

static void choose_cloth(trial *of, const weft_stepper_type *method)
{
    weft_cloth_def *def = &of->def;
    const double most = (method->flags & WEFT_STEPPER_DENSE) != 0 ? 5.0
                        : of->brief                               ? 10.0
                                                                  : 40.0;
    *def = weft_cloth_def_default();
    def->rows = (size_t)about(of, 2.0, most + 0.9);
    def->cols = (size_t)about(of, 2.0, most + 0.9);
    def->rows = one_in(of, 10) ? 1 : def->rows;
    def->spacing[0] = def->spacing[1] = about(of, 0.005, 0.05);
    def->spacing[1] *= one_in(of, 3) ? about(of, 0.4, 2.5) : 1.0;
    def->down[1] = 0.0, def->down[2] = 1.0;
    choose_springs(of, test_needs_damping(method));
    choose_contact(of);
    of->limit = weft_sim_def_default().limit;
    of->limit.strain = 0.3; /* more than at the start */
    of->limit.method = !one_in(of, 4)      ? WEFT_LIMIT_NONE
                       : of->seed % 2 == 0 ? WEFT_LIMIT_PROVOT
                                           : WEFT_LIMIT_BRIDSON;
}

/* ---- states ---------------------------------------------------------------------- */

/* A smooth field of so many metres or metres per second. */
typedef struct wave {
    double size[3], way[3][2], phase[3];
} wave;

static wave random_wave(trial *of, double size)
{
    wave out;
    for (size_t k = 0; k < 3; ++k) {
        out.size[k] = between(of, -size, size);
        out.phase[k] = between(of, 0.0, 6.28);
        out.way[k][0] = between(of, -9.0, 9.0), out.way[k][1] = between(of, -9.0, 9.0);
    }
    return out;
}

/* A sheet that is bent along its rows: its slope is a wave and a spiral of the length,
 * times `share`; and noise. */
static void place(trial *of, double share, double *xyz)
{
    const weft_cloth_def *def = &of->def;
    const double length = (double)def->rows * def->spacing[0];
    const double swing = share * between(of, 0.8, 2.4), turns = between(of, 0.5, 2.0);
    const double phase = between(of, 0.0, 6.28),
                 spiral = share * between(of, -3.0, 3.0);
    const double noise = one_in(of, 2) ? 0.3 * share * def->contact.thickness : 0.0;
    double x[3] = { 0.0, 0.0, 0.0 };
    for (size_t i = 0; i < def->rows * def->cols; ++i) {
        const size_t r = i / def->cols, c = i % def->cols;
        const double s = (double)r / (double)def->rows;
        const double slope = swing * sin(6.28 * turns * s + phase) + spiral * s * s;
        if (c == 0 && r > 0) {
            x[1] += def->spacing[0] * sin(slope), x[2] += def->spacing[0] * cos(slope);
        }
        const double at[3]
            = { (double)c * def->spacing[1], x[1] + 0.1 * s * length, x[2] };
        for (size_t k = 0; k < 3; ++k) {
            xyz[3 * i + k] = at[k] + between(of, -noise, noise);
        }
    }
}

/* Imploding, pressed flat, waves, or each particle by itself. */
static void push(trial *of, const double *xyz, double *v)
{
    const size_t n = of->def.rows * of->def.cols;
    const double speed = about(of, 1.0, 20.0);
    const wave field = random_wave(of, speed);
    const int64_t kind = random_whole(&of->state, 0, 3);
    double middle[3] = { 0.0, 0.0, 0.0 }, reach = 1e-9;
    for (size_t i = 0; i < 3 * n; ++i) {
        middle[i % 3] += xyz[i] / (double)n;
    }
    for (size_t i = 0; i < 3 * n; ++i) {
        reach = fmax(reach, fabs(xyz[i] - middle[i % 3]));
    }
    for (size_t i = 0; i < 3 * n; ++i) {
        const size_t k = i % 3, r = i / 3 / of->def.cols, c = i / 3 % of->def.cols;
        const double angle = field.way[k][0] * (double)r / (double)of->def.rows
                             + field.way[k][1] * (double)c / (double)of->def.cols;
        v[i] = kind == 0   ? speed * (middle[k] - xyz[i]) / reach
               : kind == 1 ? (k == 1 ? copysign(speed, middle[k] - xyz[i]) : 0.0)
               : kind == 2 ? field.size[k] * sin(angle + field.phase[k])
                           : between(of, -speed, speed);
    }
}

/* The strongest bend that does not pass through itself. */
static void start(trial *of, weft_sim *sim)
{
    static double xyz[3 * MOST], v[3 * MOST];
    weft_error err = { 0 };
    double share = 1.0;
    weft_status status;
    do {
        place(of, share, xyz);
        push(of, xyz, v);
        status = weft_sim_set_state(sim, xyz, v, &err);
        share *= share > 1e-3 ? 0.5 : 0.0;
    } while (status != WEFT_OK && share > 0.0);
    if (one_in(of, 3)) { /* the first row is held */
        const double pulled[3]
            = { between(of, -1.0, 1.0), between(of, -1.0, 1.0), 0.0 };
        for (size_t i = 0; i < of->def.cols; ++i) {
            ck_assert_int_eq(weft_sim_pin(sim, i, pulled, &err), WEFT_OK);
        }
    }
    if (weft_cloth_crossings(weft_sim_cloth(sim), weft_sim_state(sim), NULL) > 0) {
        ck_abort_msg("%s: starts in itself", of->text);
    }
}

/* ---- runs ------------------------------------------------------------------------ */

static double clock_now(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static trial make_trial(uint64_t seed, bool brief, const weft_stepper_type **method)
{
    trial out
        = { .seed = seed, .state = seed * 0x9E3779B97F4A7C15u | 1, .brief = brief };
    for (int i = 0; i < 10; ++i) {
        (void)random_uniform(&out.state);
    }
    *method = choose_method(&out);
    choose_cloth(&out, *method);
    (void)snprintf(out.text, sizeof out.text,
                   "cloth %llu: %zu x %zu, thickness %.3g of %.3g m, %s%s",
                   (unsigned long long)seed, out.def.rows, out.def.cols,
                   out.def.contact.thickness, out.def.spacing[0], out.method,
                   out.limit.method != WEFT_LIMIT_NONE ? ", limit" : "");
    return out;
}

typedef struct counts {
    size_t cloths, refused, steps, vetoed, failed, touched;
} counts;

static void run(trial *of, weft_sim *sim, counts *all)
{
    weft_error err = { 0 };
    const double begin = clock_now();
    const int steps = of->brief ? FEW_STEPS : MANY_STEPS;
    bool touched = false;
    for (int i = 0;
         i < steps && weft_sim_time(sim) < END && clock_now() - begin < CASE_TIME;
         ++i) {
        const weft_status status = weft_sim_step(sim, END, &err);
        const double *y = weft_sim_state(sim);
        const size_t found = weft_cloth_crossings(weft_sim_cloth(sim), y, NULL);
        ck_assert_msg(found == 0, "%s: %zu crossings at t = %.17g s, step %d", of->text,
                      found, weft_sim_time(sim), i);
        touched = touched || weft_sim_measure(sim).self_touching > 0;
        all->steps += status == WEFT_OK;
        if (status != WEFT_OK) { /* pressed too hard, or for an implicit solver */
            ++all->failed;
            if (!of->brief) {
                printf("%s: %s\n", of->text, err.message);
            }
            break;
        }
    }
    all->touched += touched;
    all->vetoed += weft_sim_vetoed(sim);
}

static void run_cloth(uint64_t seed, bool brief, counts *all)
{
    const weft_stepper_type *method;
    weft_error err = { 0 };
    trial of = make_trial(seed, brief, &method);
    of.def.contact.shapes = &of.floor;
    weft_cloth *cloth = test_cloth(&of.def);
    weft_sim_def def = weft_sim_def_default();
    weft_sim *sim = NULL;
    def.cloth = cloth, def.method = method, def.limit = of.limit;
    def.config.rtol = about(&of, 1e-6, 1e-2);
    def.config.atol_position = def.config.atol_velocity = def.config.rtol;
    def.config = test_config(method, def.config);
    const weft_status status = weft_sim_create(&def, &sim, &err);
    ++all->cloths;
    if (status == WEFT_UNSUPPORTED && test_needs_damping(method)) {
        ++all->refused; /* contact may be stiffer than the springs' damping allows */
    } else {
        ck_assert_msg(status == WEFT_OK, "%s: %s", of.text, err.message);
        start(&of, sim);
        run(&of, sim, all);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
}

static double seconds(void)
{
    const char *text = getenv("SELF_SECONDS");
    return text != NULL ? atof(text) : 0.0;
}

START_TEST(random_cloths_do_not_pass_through_themselves)
{
    const double until = clock_now() + seconds();
    counts all = { .cloths = 0 };
    if (seconds() > 0.0) {
        for (uint64_t seed = (uint64_t)time(NULL) << 20; clock_now() < until; ++seed) {
            run_cloth(seed, false, &all);
        }
        printf("%zu cloths, %zu refused for their damping, %zu touched themselves, "
               "%zu steps, %zu taken back; %zu ended early; no crossing\n",
               all.cloths, all.refused, all.touched, all.steps, all.vetoed, all.failed);
        (void)fflush(stdout);
        ck_assert_uint_le(100 * all.refused, all.cloths);
        return;
    }
    for (uint64_t seed = 1; seed <= (uint64_t)test_rounds(40, 600); ++seed) {
        run_cloth(seed, true, &all);
    }
    ck_assert_uint_le(20 * all.refused, all.cloths);
    ck_assert_uint_gt(5 * all.touched, all.cloths);
    ck_assert_uint_lt(10 * all.failed, all.cloths);
}
END_TEST

TEST_SUITE(self_random)
{
    Suite *suite = suite_create("random cloths");
    TCase *tcase = tcase_create("self");
    tcase_set_timeout(tcase, 300.0 + 2.0 * seconds());
    tcase_add_test(tcase, random_cloths_do_not_pass_through_themselves);
    suite_add_tcase(suite, tcase);
    return suite;
}
