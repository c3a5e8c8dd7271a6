/* SPDX-License-Identifier: BSD-3-Clause */
/* own_stepper.c -- a user's own time stepper, linked in: classical Runge-Kutta of order
 * 4 in fixed steps. docs/guides/write-an-integrator.md shows how to make a plugin file
 * of it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <weft/weft.h>

typedef struct kutta {
    weft_ode ode;
    double h; /* [s] */
    weft_stepper_stats stats;
    double *y, *k, *sum; /* dim each, in one block after the struct */
} kutta;

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **out,
                          weft_error *err)
{
    *out = NULL;
    //! [half]
    if (!(config->fixed_step > 0.0) || config->butcher != NULL
        || weft_stepper_half(ode, config) == 0) {
        return weft_error_set(err, WEFT_INVALID, "%s: needs a fixed_step", type->name);
    }
    //! [half]
    kutta *self = (kutta *)malloc(sizeof *self + 3 * ode->dim * sizeof(double));
    //! [create]
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    //! [create]
    *self = (kutta){ .ode = *ode, .h = config->fixed_step };
    self->y = (double *)(self + 1);
    self->k = self->y + ode->dim;
    self->sum = self->k + ode->dim;
    *out = self;
    return WEFT_OK;
}

/* k = f(t + c h, y0 + c h k), sum += b k: one of the four stages; returns f's result */
static int stage(kutta *self, double t, double h, double c, double b, const double *y0)
{
    for (size_t i = 0; i < self->ode.dim; ++i) {
        self->y[i] = y0[i] + c * h * self->k[i];
    }
    const int failed = self->ode.rhs(t + c * h, self->y, self->k, self->ode.ctx);
    ++self->stats.rhs_calls;
    for (size_t i = 0; i < self->ode.dim; ++i) {
        self->sum[i] += b * self->k[i];
    }
    return failed;
}

/* One accepted step, never past t_end; a failure leaves t and y unchanged. */
static weft_status step(void *instance, double t_end, double *t, double *y,
                        weft_error *err)
{
    static const double c[4] = { 0.0, 0.5, 0.5, 1.0 }, b[4] = { 1.0, 2.0, 2.0, 1.0 };
    kutta *self = (kutta *)instance;
    const double rest = t_end - *t;
    const bool last = self->h >= rest * (1.0 - 1e-6);
    const double h = last ? rest : self->h;
    int failed = 0;
    for (size_t i = 0; i < self->ode.dim; ++i) {
        self->k[i] = self->sum[i] = 0.0;
    }
    for (int i = 0; i < 4 && failed == 0; ++i) {
        failed = stage(self, *t, h, c[i], b[i], y);
    }
    for (size_t i = 0; i < self->ode.dim && failed == 0; ++i) {
        self->y[i] = y[i] + h / 6.0 * self->sum[i];
        failed = isfinite(self->y[i]) ? 0 : 1;
    }
    if (failed != 0) {
        return weft_error_set(err, failed < 0 ? WEFT_STOPPED : WEFT_NOT_FINITE,
                              "kutta: no step of %g s", h);
    }
    for (size_t i = 0; i < self->ode.dim; ++i) {
        y[i] = self->y[i];
    }
    *t = last ? t_end : *t + h; /* ends on t_end bit for bit */
    ++self->stats.steps;
    self->stats.last_step = h;
    return WEFT_OK;
}

static void state_changed(void *instance)
{
    (void)instance; /* nothing is carried from step to step */
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    const kutta *self = (const kutta *)instance;
    weft_stepper_stats_copy(&self->stats, out);
}

//! [type]
static const weft_stepper_type kutta_type = {
    .abi = WEFT_STEPPER_ABI,
    .struct_size = sizeof(weft_stepper_type),
    .name = "kutta",
    .reference = "W. Kutta, Z. Math. Phys. 46, 1901",
    .license = "BSD-3-Clause",
    .order = 4,
    .error_order = 0,
    .stages = 4,
    .flags = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_QUADRATURES,
    .create = create,
    .step = step,
    .state_changed = state_changed,
    .stats = stats,
    .destroy = free,
};
//! [type]

/* Height [m] of the last corner after 1 s in steps of h [s]; NAN on failure. */
static double corner_after(const weft_cloth *cloth, double h)
{
    weft_error err;
    weft_sim *sim = NULL;
    double height = NAN;
    weft_sim_def run = weft_sim_def_default();
    run.cloth = cloth;
    run.method = &kutta_type; /* needs no registry */
    run.config.fixed_step = h;
    if (weft_sim_create(&run, &sim, &err) == WEFT_OK
        && weft_sim_advance(sim, 1.0, &err) == WEFT_OK) {
        height = weft_sim_state(sim)[2 * weft_cloth_particles(cloth) - 1];
    } else {
        fprintf(stderr, "%s\n", err.message);
    }
    weft_sim_destroy(sim);
    return height;
}

int main(void)
{
    const weft_pin corner = { .rows = { 0, 0 }, .cols = { 0, 0 } };
    weft_cloth_def def = weft_cloth_def_default();
    weft_cloth *cloth = NULL;
    weft_error err;
    def.rows = 3;
    def.cols = 4;
    def.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.05 };
    def.springs[WEFT_SHEAR]
        = (weft_spring_def){ .present = true, .stiffness = 5.0, .damping = 0.05 };
    def.springs[WEFT_BEND]
        = (weft_spring_def){ .present = true, .stiffness = 1.0, .damping = 0.05 };
    def.pins = &corner;
    def.pin_count = 1;
    if (weft_cloth_create(&def, &cloth, &err) != WEFT_OK) {
        fprintf(stderr, "%s\n", err.message);
        return EXIT_FAILURE;
    }
    const double exact = corner_after(cloth, 1.0 / 4096.0);
    double before = 0.0;
    for (int n = 64; n <= 512; n *= 2) {
        const double error = fabs(corner_after(cloth, 1.0 / n) - exact);
        printf("h = 1/%d s: error %.3e m", n, error);
        printf(n == 64 ? "\n" : ", order %.2f\n", log2(before / error));
        before = error;
    }
    weft_cloth_destroy(cloth);
    return isfinite(exact) ? EXIT_SUCCESS : EXIT_FAILURE;
}
