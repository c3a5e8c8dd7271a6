/* SPDX-License-Identifier: BSD-3-Clause */
/* mutants.c -- examples/weft-bogacki.c with one fault in each method, which has the
 * name of the fault: what solvers got wrong, and what error control may get wrong
 * without a wrong order. The first has none. Published ones are odeint-v2 79 and 228,
 * SUNDIALS 311, REBOUND 485 and memilio 949. */
#include "weft/stepper.h"

#include <math.h>

enum { STAGES = 4 }; /* the last one is the first of the next step */

/* Row i: stage i + 1 is at t + c[i] h, y + h sum a[i][j] k[j]; the last row is the step
 * of order 3, and e its difference from the embedded one of order 2. */
static const double c[STAGES - 1] = { 0.5, 0.75, 1.0 };
static const double a[STAGES - 1][STAGES - 1]
    = { { 0.5 }, { 0.0, 0.75 }, { 2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0 } };
static const double e[STAGES] = { -5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0 };

static const double safety = 0.9, max_growth = 5.0, min_reduction = 0.2;

#define FAULTS(X)                                                                      \
    X(right)                                                                           \
    X(last_unchecked)  /* a step that ends at t_end */                                 \
    X(cut_shrinks)     /* what t_end has cut is the next step; REBOUND 485 */          \
    X(velocity_first)  /* atol_velocity for positions too */                           \
    X(position_first)  /* atol_position for velocities too */                          \
    X(no_rtol)         /* odeint-v2 228 */                                             \
    X(rms_sum)         /* no mean */                                                   \
    X(rms_half)        /* of half as many */                                           \
    X(rms_max)         /* the other norm */                                            \
    X(counts_apart)    /* the errors of quadratures */                                 \
    X(stale_stage)     /* of the state before it was changed */                        \
    X(reused_stage)    /* the first of the next, at the end of another state */        \
    X(stage_times)     /* all at the start of the step */                              \
    X(nan_passes)      /* odeint-v2 79 */                                              \
    X(writes_rejected) /* an attempt */                                                \
    X(no_most)         /* max_step */                                                  \
    X(no_first)        /* first_step */                                                \
    X(no_least)        /* min_step; memilio 949 */                                     \
    X(adds_up)         /* t + h where t_end was meant */                               \
    X(counts_attempts) /* as steps */                                                  \
    X(starts_over)     /* from first_step, after every change */                       \
    X(swapped)         /* each tolerance for the other half */                         \
    X(misses_last)     /* number of the error */                                       \
    X(no_integrals)    /* quadratures stay as they are */                              \
    X(no_estimate)     /* every step is good */

#define NAME(name) name,
enum { FAULTS(NAME) FAULT_COUNT };

typedef struct stepper {
    int fault;
    weft_ode ode;
    weft_stepper_config config;
    weft_allocator memory;
    size_t half; /* number of positions, and of velocities; then quadratures */
    double h;    /* [s] next to try, before any cut */
    bool fresh;  /* k[0] is f(t, y) */
    weft_stepper_stats stats;
    double *k[STAGES], *end; /* dim each, in one block after the struct */
} stepper;

/* ---- one attempt: reads y, does not change it -------------------------------------
 */

static int evaluate(stepper *self, double t, const double *y, double *f)
{
    ++self->stats.rhs_calls;
    return self->ode.rhs(t, y, f, self->ode.ctx);
}

/* The error in units of the tolerances: at most 1 is accepted. Positions and velocities
 * have separate absolute tolerances. */
static double error_of(const stepper *self, double h, const double *y)
{
    double most = 0.0, squares = 0.0;
    const size_t count = self->fault == counts_apart  ? self->ode.dim
                         : self->fault == misses_last ? 2 * self->half - 1
                                                      : 2 * self->half;
    for (size_t i = 0; i < count; ++i) {
        const bool position = self->fault == position_first
                              || ((i < self->half) != (self->fault == swapped)
                                  && self->fault != velocity_first);
        const double absolute
            = position ? self->config.atol_position : self->config.atol_velocity;
        const double size = fmax(fabs(y[i]), fabs(self->end[i]));
        double sum = 0.0;
        for (size_t j = 0; j < STAGES; ++j) {
            sum += e[j] * self->k[j][i];
        }
        const double one
            = fabs(h * sum)
              / (absolute + (self->fault == no_rtol ? 0.0 : self->config.rtol) * size);
        most = fmax(most, one);
        squares += one * one;
    }
    const double of = self->fault == rms_sum    ? 1.0
                      : self->fault == rms_half ? (double)self->half
                                                : 2.0 * (double)self->half;
    return self->fault == no_estimate ? 1e-3
           : self->config.norm == WEFT_NORM_MAX || self->fault == rms_max
               ? most
               : sqrt(squares / of);
}

/* Computes `end`, the state at t_new = t + h; *error is INFINITY if it is unusable.
 * Returns the result of the right-hand side. */
static int attempt(stepper *self, double t, double h, double t_new, const double *y,
                   double *error)
{
    int failed = self->fresh ? 0 : evaluate(self, t, y, self->k[0]);
    bool finite = true;
    self->fresh = failed == 0;
    for (size_t s = 1; s < STAGES && failed == 0; ++s) {
        const double *row = a[s - 1];
        for (size_t i = 0; i < self->ode.dim; ++i) {
            double sum = 0.0; /* in a fixed order: part of the result */
            for (size_t j = 0; j < s; ++j) {
                sum += row[j] * self->k[j][i];
            }
            self->end[i] = y[i] + h * sum;
        }
        const double at = s + 1 < STAGES ? t + c[s - 1] * h : t_new;
        failed = evaluate(self, self->fault == stage_times ? t : at, self->end,
                          self->k[s]);
    }
    for (size_t i = 0; i < self->ode.dim && failed == 0; ++i) {
        finite
            = self->fault == nan_passes
              || (finite && isfinite(self->end[i]) && isfinite(self->k[STAGES - 1][i]));
    }
    *error = failed != 0 || !finite          ? (double)INFINITY
             : self->config.fixed_step > 0.0 ? 0.0
                                             : error_of(self, h, y);
    return failed;
}

/* The factor for h. The error is proportional to h^3, but cbrt and pow differ in the
 * last bit from libm to libm, and sqrt does not: a fourth root is a little more
 * cautious and has the same target. */
static double change(double error)
{
    const double factor = safety / sqrt(sqrt(error));
    return factor > max_growth      ? max_growth
           : factor > min_reduction ? factor
                                    : min_reduction; /* NaN too */
}

/* ---- the step ---------------------------------------------------------------------
 */

/* Only this function writes y. */
static void accept(stepper *self, double t_new, double h, double *t, double *y)
{
    double *last = self->k[self->fault == reused_stage ? 1 : STAGES - 1];
    memcpy(y, self->end,
           (self->fault == no_integrals ? 2 * self->half : self->ode.dim) * sizeof *y);
    *t = t_new;
    self->k[self->fault == reused_stage ? 1 : STAGES - 1] = self->k[0];
    self->k[0] = last; /* fresh: evaluated at t_new and `end`, bit for bit */
    ++self->stats.steps;
    self->stats.last_step = h;
}

static double limited(const stepper *self, double h)
{
    const double most = self->fault == no_most ? INFINITY : self->config.max_step;
    return fmax(fmin(h, most), self->fault == no_least ? 0.0 : self->config.min_step);
}

static weft_status step(void *instance, double t_end, double *t, double *y,
                        weft_error *err)
{
    stepper *self = (stepper *)instance;
    const bool adapts = !(self->config.fixed_step > 0.0);
    const double rest = t_end - *t;
    if (!(rest > 0.0)) {
        return weft_error_set(err, WEFT_INVALID, "step from %.17g to %.17g s", *t,
                              t_end);
    }
    double most = max_growth, h = self->h;
    for (;;) {
        /* If only roundoff makes the rest longer than h, take it in one step. */
        const bool last = h >= rest * (1.0 - 1e-6);
        const double now = last ? rest : h;
        const double t_new = last && self->fault != adds_up ? t_end : *t + now;
        double error;
        if (t_new == *t) {
            return weft_error_set(err, WEFT_STEP_TOO_SMALL, "t + h == t at h = %g s",
                                  now);
        }
        if (attempt(self, *t, now, t_new, y, &error) < 0) {
            return weft_error_set(err, WEFT_STOPPED, "stopped by the model");
        }
        const double next = now * fmin(change(error), most);
        if (error <= 1.0
            || (self->fault == last_unchecked && last && isfinite(error))) {
            accept(self, t_new, now, t, y);
            /* A step cut short by the end of a frame does not reduce h. */
            h = now < h && self->fault != cut_shrinks ? fmax(h, next) : next;
            self->h = adapts ? limited(self, h) : self->h;
            return WEFT_OK;
        }
        ++self->stats.rejected;
        self->stats.steps += self->fault == counts_attempts;
        if (self->fault == writes_rejected) {
            memcpy(y, self->end, self->ode.dim * sizeof *y);
        }
        if (!adapts || (now <= self->config.min_step && self->fault != no_least)) {
            return isfinite(error)
                       ? weft_error_set(err, WEFT_STEP_TOO_SMALL,
                                        "needs less than %g s", now)
                       : weft_error_set(err, WEFT_NOT_FINITE,
                                        "not finite after a step of %g s", now);
        }
        most = 1.0; /* no growth right after a rejection */
        h = self->fault == no_least ? next : fmax(next, self->config.min_step);
    }
}

/* y was edited, or f has changed: k[0] is stale. A needless call costs one evaluation,
 * which gives the same bits again. */
static void state_changed(void *instance)
{
    stepper *self = (stepper *)instance;
    self->fresh = self->fresh && self->fault == stale_stage;
    self->h = self->fault == starts_over && !(self->config.fixed_step > 0.0)
                  ? self->config.first_step
                  : self->h;
}

/* ---- create, query, destroy -------------------------------------------------------
 */

static int fault_of(const weft_stepper_type *type);

static weft_status create(const weft_stepper_type *type, const weft_ode *ode,
                          const weft_stepper_config *config, void **out,
                          weft_error *err)
{
    const char *wrong = weft_stepper_mistake(type, ode, config);
    wrong = wrong == NULL && ode->dim > SIZE_MAX / 64 ? "dim is too large" : wrong;
    *out = NULL;
    if (wrong != NULL) {
        return weft_error_set(err, WEFT_INVALID, "%s: %s", type->name, wrong);
    }
    const weft_allocator memory = weft_stepper_memory(config);
    const size_t arrays = (STAGES + 1) * ode->dim * sizeof(double);
    stepper *self = (stepper *)memory.resize(memory.ctx, NULL, sizeof *self + arrays);
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    const bool adapts = !(config->fixed_step > 0.0);
    *self = (stepper){ .fault = fault_of(type), .ode = *ode, .memory = memory };
    memcpy(&self->config, config, WEFT_STEPPER_CONFIG_LEAST); /* older ones end there */
    self->half = weft_stepper_half(ode, config);
    self->h = !adapts                   ? config->fixed_step
              : self->fault == no_first ? 1e-3
                                        : limited(self, config->first_step);
    self->end = (double *)(self + 1);
    for (size_t s = 0; s < STAGES; ++s) {
        self->k[s] = self->end + (s + 1) * ode->dim;
    }
    *out = self;
    return WEFT_OK;
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    const stepper *self = (const stepper *)instance;
    weft_stepper_stats all = self->stats;
    all.next_step = self->h;
    weft_stepper_stats_copy(&all, out);
}

/* Choices beyond the config, for the manifest of a run. */
static void options(const void *instance, weft_option_fn *tell, void *ctx)
{
    if (!(((const stepper *)instance)->config.fixed_step > 0.0)) {
        tell(ctx, "safety", "0.9");
        tell(ctx, "max_growth", "5");
        tell(ctx, "min_reduction", "0.2");
    }
}

static void destroy(void *instance)
{
    if (instance != NULL) {
        const weft_allocator memory = ((stepper *)instance)->memory;
        (void)memory.resize(memory.ctx, instance, 0);
    }
}

#define METHOD(fault_name)                                                             \
    [fault_name] = {                                                                   \
        .abi = WEFT_STEPPER_ABI,                                                       \
        .struct_size = sizeof(weft_stepper_type),                                      \
        .name = #fault_name,                                                           \
        .reference = "P. Bogacki, L. F. Shampine, Appl. Math. Lett. 2, 1989",          \
        .license = "BSD-3-Clause",                                                     \
        .order = 3,                                                                    \
        .error_order = 2,                                                              \
        .stages = 3,                                                                   \
        .flags = WEFT_STEPPER_FSAL | WEFT_STEPPER_QUADRATURES,                         \
        .create = create,                                                              \
        .step = step,                                                                  \
        .state_changed = state_changed,                                                \
        .stats = stats,                                                                \
        .destroy = destroy,                                                            \
        .options = options,                                                            \
    },

static const weft_stepper_type methods[] = { FAULTS(METHOD) };

static int fault_of(const weft_stepper_type *type)
{
    return (int)(type - methods);
}

const weft_plugin *weft_plugin_mutants(void);

WEFT_API const weft_plugin *weft_plugin_mutants(void)
{
#define POINTER(name) &methods[name],
    static const weft_stepper_type *const types[] = { FAULTS(POINTER) NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "mutants",
        .version = "1.0",
        .solver = "",
        .types = types,
    };
    return &plugin;
}
