/* SPDX-License-Identifier: BSD-3-Clause */
/* derivative.c -- the right-hand side of a cloth for a program of its own, its exact
 * derivatives, and the gradient of an objective over a whole run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/plugins.h>
#include <weft/weft.h>

enum { SIDE = 6, ALL = SIDE * SIDE, DIM = 6 * ALL, FRAMES = 5 };

/* A hanging cloth whose stretch springs have this stiffness [N/m]. */
static weft_status make_cloth(double stiffness, weft_cloth **cloth, weft_error *err)
{
    static const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = def.cols = SIDE;
    def.spacing[0] = def.spacing[1] = 0.1; /* [m] */
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = stiffness, .damping = 0.02 };
    def.pins = &corner;
    def.pin_count = 1;
    return weft_cloth_create(&def, cloth, err);
}

static double dot(const double *a, const double *b)
{
    double sum = 0.0;
    for (size_t i = 0; i < DIM; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* The same number, w . J v, by both products. */
static void print_products(const weft_cloth *cloth)
{
    static double y[DIM], dydt[DIM], v[DIM], w[DIM], jv[DIM], wj[DIM];
    weft_cloth_start(cloth, y);
    //! [rhs]
    if (weft_cloth_rhs(cloth, 0.0, y, dydt) != 0) {
        return; /* y is not finite, or a particle is in a collider */
    }
    printf("the last corner accelerates by %+.2f m/s^2\n", dydt[5 * ALL - 1]);
    //! [rhs]
    for (size_t i = 0; i < DIM; ++i) {
        v[i] = (double)(i % 7) - 3.0;
        w[i] = (double)(i % 5) - 2.0;
    }
    //! [product]
    (void)weft_cloth_jacobian_product(cloth, 0.0, y, v, jv);
    (void)weft_cloth_jacobian_product_transposed(cloth, 0.0, y, w, wj);
    printf("w.(J v) = %.6f, v.(J^T w) = %.6f\n", dot(w, jv), dot(v, wj));
    //! [product]
}

/* d(dy/dt)/d(stiffness) where the cloth has come to after a while. */
static void print_parameter(const weft_parameter *of, const double *y)
{
    static double by[DIM];
    double most = 0.0;
    //! [parameter]
    (void)weft_cloth_parameter_product(of->less, of->more, of->span, 0.0, y, by);
    //! [parameter]
    for (size_t i = 0; i < DIM; ++i) {
        most = fmax(most, fabs(by[i]));
    }
    printf("1 %% more stiffness accelerates by at most %.4f m/s^2\n", most);
}

//! [objective]
/* The height of the last corner, y[2 N - 1], summed over the frames. */
static int height(void *ctx, size_t frame, double t, const double *y, double *value,
                  double *gradient)
{
    (void)ctx;
    (void)frame;
    (void)t;
    *value += y[2 * ALL - 1];
    gradient[2 * ALL - 1] = 1.0;
    return 0;
}
//! [objective]

static weft_status print_gradient(const weft_sim_def *run, const weft_parameter *of,
                                  weft_error *err)
{
    static double by_start[DIM];
    double value = 0.0, by_parameter = 0.0;
    //! [gradient]
    const double times[FRAMES] = { 0.1, 0.2, 0.3, 0.4, 0.5 }; /* [s] */
    weft_gradient_def def = weft_gradient_def_default();
    def.sim = run;
    def.count = 1;
    def.parameters = of;
    def.frames = FRAMES;
    def.times = times;
    def.objective = height;
    const weft_status status
        = weft_gradient(&def, &value, &by_parameter, by_start, err);
    //! [gradient]
    if (status == WEFT_OK) {
        printf("sum of heights %.6f m; %+.6f m per 1 %% of stiffness, %+.6f per m of "
               "the start of that corner\n",
               value, by_parameter, by_start[2 * ALL - 1]);
    }
    return status;
}

int main(void)
{
    const double stiffness = 100.0, part = 1e-7; /* [N/m] */
    weft_cloth *cloth = NULL, *less = NULL, *more = NULL;
    weft_sim *sim = NULL;
    weft_error err;
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "midpoint");
    run.config.fixed_step = 1e-3; /* [s] */
    weft_status status = make_cloth(stiffness, &cloth, &err);
    run.cloth = cloth;
    status = status == WEFT_OK ? make_cloth(stiffness * (1.0 - part), &less, &err)
                               : status;
    status = status == WEFT_OK ? make_cloth(stiffness * (1.0 + part), &more, &err)
                               : status;
    /* per 1 % of stiffness: the two differ by 2 part, which is 200 part of it */
    const weft_parameter of = { "stiffness", less, more, 200.0 * part };
    status = status == WEFT_OK ? weft_sim_create(&run, &sim, &err) : status;
    status = status == WEFT_OK ? weft_sim_advance(sim, 0.2, &err) : status;
    if (status == WEFT_OK) {
        print_products(cloth);
        print_parameter(&of, weft_sim_state(sim));
        status = print_gradient(&run, &of, &err);
    }
    if (status != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(less);
    weft_cloth_destroy(more);
    weft_cloth_destroy(cloth);
    return status == WEFT_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
