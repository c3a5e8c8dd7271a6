/* SPDX-License-Identifier: BSD-3-Clause */
/* test_stepper_accuracy.c -- whether methods have the order they claim, and whether
 * tolerances and norms mean what weft/stepper.h says. */
#include "stepper_run.h"

static double fixed_step_error(const weft_stepper_type *type, int steps)
{
    const weft_stepper_config config = fixed(1.0 / steps);
    run r;
    start(&r, type, &config);
    go(&r, 1.0);
    const double error = error_at_end(&r);
    end(&r);
    return error;
}

/* error ~ h^p: the exponent between h and h/2, for the smallest h that is still far
 * from roundoff: near 1e-2 s terms of higher order still hide that of dormand_prince.
 * In Verner's tables of 2010 the leading term is so small that it is never seen. */
START_TEST(measured_order_is_the_claimed_one)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    if (type->order == 0) {
        return;
    }
    const bool seems_better = strstr(type->reference, "Verner, Numer. Alg") != NULL;
    const int first = type->order < 8 && !seems_better ? 16 : 4;
    const double least = seems_better ? 1e-11 : 1e-12;
    double order = 0.0, error = fixed_step_error(type, first);
    for (int steps = 2 * first; steps <= 1024 && error > least; steps *= 2) {
        const double finer = fixed_step_error(type, steps);
        order = log2(error / finer);
        error = finer;
    }
    ck_assert_msg(order > type->order - 0.2
                      && (order < type->order + 0.2 || seems_better),
                  "%s: %.2f", type->name, order);
}
END_TEST

/* One equation for each rooted tree of at most NODES nodes: y' is the product of the y
 * of what hangs on its root, and y(0) = 0. Then y(1) = 1/gamma, and a Runge-Kutta step
 * of length 1 gives sum b_i g_i of the tree: its order is p if these are equal for all
 * trees of at most p nodes (Butcher, Numerical Methods for ODEs, 3rd ed., theorem
 * 315A). */
enum { NODES = 10, TREES = 1205, EQUATIONS = TREES + 1 /* even */ };

typedef struct forest {
    int nodes[TREES];
    size_t rest[TREES], last[TREES]; /* the tree without its last branch, that branch */
    double gamma[TREES];
} forest;

/* By size; the branches of each tree in falling order, so that none comes twice. */
static void grow(forest *f)
{
    size_t count = 1;
    *f = (forest){ .nodes = { 1 }, .gamma = { 1.0 } };
    for (int size = 2; size <= NODES; ++size) {
        const size_t smaller = count;
        for (size_t rest = 0; rest < smaller; ++rest) {
            for (size_t last = 0; last < smaller; ++last) {
                if (f->nodes[rest] + f->nodes[last] == size
                    && (rest == 0 || last <= f->last[rest])) {
                    ck_assert_uint_lt(count, TREES);
                    f->nodes[count] = size;
                    f->rest[count] = rest, f->last[count] = last;
                    f->gamma[count]
                        = size * (f->gamma[rest] / f->nodes[rest]) * f->gamma[last];
                    ++count;
                }
            }
        }
    }
    ck_assert_uint_eq(count, TREES);
}

static int grow_rate(double t, const double *y, double *dydt, void *ctx)
{
    const forest *f = ctx;
    (void)t;
    dydt[0] = 1.0;
    dydt[TREES] = 0.0;
    for (size_t k = 1; k < TREES; ++k) {
        dydt[k] = dydt[f->rest[k]] * y[f->last[k]];
    }
    return 0;
}

/* Implicit methods iterate to a tolerance; Verlet's are none of Runge and Kutta's. */
START_TEST(order_conditions_hold_up_to_the_order_and_no_further)
{
    static forest f;
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool verlet = strcmp(type->name, "velocity_verlet") == 0
                        || strcmp(type->name, "symplectic_euler") == 0;
    if (type->order == 0 || (type->flags & WEFT_STEPPER_IMPLICIT) != 0 || verlet) {
        return;
    }
    grow(&f);
    const weft_ode ode = { .dim = EQUATIONS, .rhs = grow_rate, .ctx = &f };
    const weft_stepper_config config = fixed(1.0);
    double t = 0.0, y[EQUATIONS] = { 0.0 };
    void *self = NULL;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    ck_assert_int_eq(type->step(self, 1.0, &t, y, NULL), WEFT_OK);
    type->destroy(self);
    int order = NODES; /* the trees come by size */
    for (size_t k = 0; k < TREES && order == NODES; ++k) {
        if (!(fabs(f.gamma[k] * y[k] - 1.0) <= 1e-9)) {
            order = f.nodes[k] - 1;
        }
    }
    ck_assert_int_eq(order, type->order);
}
END_TEST

typedef struct result {
    double error;
    uint64_t steps;
} result;

static result at_4_s(const weft_stepper_type *type, const weft_stepper_config *config)
{
    run r;
    start(&r, type, config);
    go(&r, 4.0);
    const result res = { error_at_end(&r), stats(&r).steps };
    end(&r);
    return res;
}

/* The error at the end is not the error of a step, so a factor stays between them. */
START_TEST(error_follows_the_tolerance)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const double low = type->order == 1 ? 1e-5 : type->order == 2 ? 1e-7 : 1e-9;
    const double most = type->order == 1 ? 2000.0 : 150.0;
    for (int norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS && can_adapt(type); ++norm) {
        weft_stepper_config config = adaptive(1e-3);
        config.norm = (weft_norm)norm;
        const result rough = at_4_s(type, &config);
        config = adaptive(low);
        config.norm = (weft_norm)norm;
        const result fine = at_4_s(type, &config);
        ck_assert_double_le(rough.error, most * 1e-3);
        ck_assert_double_le(fine.error,
                            (norm == WEFT_NORM_MAX ? 1.0 : 2.0) * most * low);
        ck_assert_double_le(fine.error, 0.11 * rough.error);
        ck_assert_uint_gt(fine.steps, rough.steps);
    }
}
END_TEST

START_TEST(each_tolerance_counts)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const double low = type->order == 1 ? 1e-5 : type->order == 2 ? 1e-6 : 1e-9;
    for (int norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS && can_adapt(type); ++norm) {
        weft_stepper_config config = adaptive(1e-3);
        config.norm = (weft_norm)norm;
        const uint64_t loose = at_4_s(type, &config).steps;
        config.atol_position = low;
        const uint64_t position = at_4_s(type, &config).steps;
        config.atol_velocity = low;
        const uint64_t both = at_4_s(type, &config).steps;
        config.atol_position = 1e-3;
        const uint64_t velocity = at_4_s(type, &config).steps;
        config.atol_position = low;
        config.rtol = 1e-2;
        const uint64_t relative = at_4_s(type, &config).steps;
        ck_assert_uint_gt(position, loose);
        ck_assert_uint_gt(velocity, loose);
        ck_assert_uint_gt(both, relative);
    }
}
END_TEST

/* Pendulums that do not know of each other. All rest but one. */
enum { PENDULUMS = 50, KICKED = 37 };

static int pendulums(double t, const double *y, double *dydt, void *ctx)
{
    (void)t;
    (void)ctx;
    for (int i = 0; i < PENDULUMS; ++i) {
        dydt[i] = y[PENDULUMS + i];
        dydt[PENDULUMS + i] = -7.3 * sin(y[i]);
    }
    return 0;
}

/* Of the kicked one, after 2 s. */
static result kick(const weft_stepper_type *type, weft_norm norm, double tolerance)
{
    const weft_ode ode = { .dim = (size_t)2 * PENDULUMS, .rhs = pendulums };
    weft_stepper_config config = test_config(type, adaptive(tolerance));
    config.norm = norm;
    double y[2 * PENDULUMS] = { 0 }, t = 0.0;
    y[PENDULUMS + KICKED] = 1.9;
    void *self = NULL;
    ck_assert_int_eq(type->create(type, &ode, &config, &self, NULL), WEFT_OK);
    while (t < 2.0) {
        ck_assert_int_eq(type->step(self, 2.0, &t, y, NULL), WEFT_OK);
    }
    weft_stepper_stats s = { .struct_size = sizeof s };
    type->stats(self, &s);
    type->destroy(self);
    /* by the classical Runge-Kutta method with 2^-14 s, to 1e-12 */
    const double want[2] = { -0.6262190417261715, 0.9163182761308935 };
    const double dx = fabs(y[KICKED] - want[0]);
    return (result){ fmax(dx, fabs(y[PENDULUMS + KICKED] - want[1])), s.steps };
}

/* An error e in one of n components has the rms e / sqrt(n). A multistep method chooses
 * its order in a norm of its own and may need fewer steps all the same. bsimp errs by
 * 1e-10 here with steps as long as they may grow, whatever is asked of it. */
START_TEST(the_largest_norm_sees_one_particle_where_rms_does_not)
{
    const weft_stepper_type *type = test_method((size_t)_i);
    const bool multistep = (type->flags & WEFT_STEPPER_MULTISTEP) != 0;
    if (!can_adapt(type) || (type->order == 0 && !multistep)) {
        return;
    }
    const double tolerance = type->order == 1 || type->order == 2 ? 1e-3 : 1e-9;
    const result max = kick(type, WEFT_NORM_MAX, tolerance);
    const result rms = kick(type, WEFT_NORM_RMS, tolerance);
    ck_assert(max.steps > rms.steps || multistep);
    ck_assert_double_lt(max.error, rms.error);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("stepper accuracy");
    add_for_every_method(suite, "order", measured_order_is_the_claimed_one);
    add_for_every_method(suite, "conditions",
                         order_conditions_hold_up_to_the_order_and_no_further);
    add_for_every_method(suite, "tolerance", error_follows_the_tolerance);
    add_for_every_method(suite, "tolerances", each_tolerance_counts);
    add_for_every_method(suite, "norms",
                         the_largest_norm_sees_one_particle_where_rms_does_not);
    return test_run(suite);
}
