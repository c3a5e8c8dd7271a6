/* SPDX-License-Identifier: BSD-3-Clause */
/* verlet.c -- four textbook steppers without a library, and the template for plugin
 * authors: copy this file, change the methods, build it as weft-<id>.so.
 *
 * With y = (x, v), f(t, y) = (fx, fv) and the fixed step h:
 *   euler              x += h fx,  v += h fv
 *   midpoint           y += h f(t + h/2, y + (h/2) f)
 *   symplectic_euler   v += h fv,  x += h (fx + h fv)
 *   velocity_verlet    x += h (fx + (h/2) fv),  v += (h/2) (fv + fv')
 * and quadratures, behind v where there are any, as v.
 *
 * Where fx = v, fx + h fv is the new v: symplectic Euler moves x with it, as Provot
 * 1995 does. A pin keeps to its prescribed fx: moved with v, whose error has a mean, it
 * would drift. Verlet (Swope et al. 1982) takes fv' at the new x and the predicted v +
 * h fv (Groot, Warren, J. Chem. Phys. 107, 1997, lambda = 1): order 2 with damping too.
 * The next step starts from that f': one RHS call a step. */
#include "weft/stepper.h"

#include <math.h>
#include <string.h>

const weft_plugin *weft_plugin_verlet(void);

/* Numbers between arrays that a pass reads at once: so that they do not meet in the
 * same sets of a cache. */
enum { APART = 4168 };

/* One instance. Its arrays lie behind it in one block: a step allocates nothing. */
typedef struct stepper {
    const struct method *method;
    weft_ode ode;
    weft_allocator memory;
    const weft_pass *pass;   /* or NULL */
    const weft_agree *agree; /* with the steppers of other parts of y, or NULL */
    size_t half;             /* y: so many positions, so many velocities, quadratures */
    double fixed_step;       /* [s] */
    weft_stepper_stats stats;
    uint64_t idle;    /* RHS calls after one that failed, for others (weft_agree) */
    bool carries;     /* f is that of `end`, the state the last step ended in */
    bool changed;     /* t or y may have been edited since */
    double t;         /* [s] of `end` */
    double h, *y;     /* of the present step; h [s] */
    double *f, *last; /* last: of the step before */
    double *end;      /* result of a step: y keeps its value until it is known */
} stepper;

/* The public record comes first: a pointer to it is a pointer to the method. */
typedef struct method {
    weft_stepper_type type;
    int (*advance)(stepper *self, double t, double h,
                   double *y); /* what the RHS returned; > 0, too: not finite. Then y
                                  is as it was */
} method;

static int rhs(stepper *self, double t, const double *y)
{
    ++self->stats.rhs_calls;
    return self->ode.rhs(t, y, self->f, self->ode.ctx);
}

/* The next of a step's calls: after a failure only if others wait for it. */
static int rhs_after(int failed, stepper *self, double t, const double *y)
{
    if (failed == 0) {
        return rhs(self, t, y);
    }
    if (self->agree != NULL) {
        ++self->idle;
        (void)rhs(self, t, y);
    }
    return failed;
}

/* What the step has come to, for all parts of the state: 0, < 0 or > 0 as an RHS
 * returns it. `bad`: > 0 if a number of it is not finite. */
static int verdict(stepper *self, int failed, size_t bad)
{
    const int mine = failed != 0 ? failed : bad > 0;
    if (self->agree == NULL) {
        return mine;
    }
    const double code = mine == 0 ? 0.0 : (mine < 0 ? 16.0 : 8.0) + (double)self->idle;
    const double worst = weft_stepper_agreed(self->agree, code);
    self->idle = 0;
    if (!(worst < 32.0)) {
        return 1;
    }
    self->stats.rhs_calls -= (uint64_t)worst % 8;
    return worst >= 16.0 ? -1 : worst >= 8.0;
}

/* In the highest bit, to be or-ed: unlike a branch, this can be vectorised. */
static inline uint64_t not_finite(double a)
{
    uint64_t bits;
    memcpy(&bits, &a, sizeof bits);
    return (bits & INT64_MAX) + UINT64_C(0x0010000000000000);
}

/* to = y + h f over [first, last) of the state */
static void add(double *to, const double *y, double h, const double *f, size_t first,
                size_t last)
{
    for (size_t i = first; i < last; ++i) {
        to[i] = y[i] + h * f[i];
    }
}

/* Whether one of these would not be finite: asked first, so that a failed step need not
 * be undone. */
static size_t spoilt(const double *y, double h, const double *f, size_t first,
                     size_t last)
{
    uint64_t bad = 0;
    for (size_t i = first; i < last; ++i) {
        bad |= not_finite(y[i] + h * f[i]);
    }
    return bad >> 63;
}

/* Ends a step, by y += h f from `first` on if all is finite. */
static int finish(stepper *self, int failed, size_t bad, double h, double *y,
                  size_t first)
{
    const size_t dim = self->ode.dim;
    failed = verdict(self, failed, bad + spoilt(y, h, self->f, first, dim));
    if (failed == 0) {
        add(y, y, h, self->f, first, dim);
    }
    return failed;
}

static int euler(stepper *self, double t, double h, double *y)
{
    return finish(self, rhs(self, t, y), 0, h, y, 0);
}

static int midpoint(stepper *self, double t, double h, double *y)
{
    int failed = rhs(self, t, y);
    add(self->end, y, 0.5 * h, self->f, 0, self->ode.dim);
    failed = rhs_after(failed, self, t + 0.5 * h, self->end);
    return finish(self, failed, 0, h, y, 0);
}

/* The RHS at y between two loops over the state: in one pass where there is one. The
 * second loop returns *bad. */
static int rhs_between(stepper *self, int failed, double t, const double *y,
                       weft_part *before, weft_part *after, size_t *bad)
{
    weft_round all = { sizeof all, t, y, self->f, self, before, after, 0 };
    const int done = failed != 0 || self->pass == NULL
                         ? 1
                         : self->pass->round(self->pass->self, &all);
    if (done <= 0) {
        ++self->stats.rhs_calls;
        *bad = all.sum;
        return done;
    }
    if (before != NULL) {
        (void)before(self, 0, self->half);
    }
    failed = rhs_after(failed, self, t, y);
    *bad = after(self, 0, self->half);
    return failed;
}

/* With a pass, on all threads. */
static void for_all(stepper *self, weft_part *part)
{
    weft_round all = { .struct_size = sizeof all, .ctx = self, .before = part };
    if (self->pass == NULL || self->pass->round(self->pass->self, &all) > 0) {
        (void)part(self, 0, self->half);
    }
}

static inline double moved(double x, double h, double fx, double fv)
{
    return x + h * fx + h * h * fv;
}

static size_t spoilt_leap(void *ctx, size_t first, size_t end)
{
    const stepper *self = ctx;
    const double h = self->h, *x = self->y, *fx = self->f, *fv = fx + self->half;
    uint64_t bad = 0;
    for (size_t i = first; i < end; ++i) {
        bad |= not_finite(moved(x[i], h, fx[i], fv[i]));
    }
    return (bad >> 63) + spoilt(x + self->half, h, fv, first, end);
}

static size_t leap(void *ctx, size_t first, size_t end)
{
    const stepper *self = ctx;
    const double h = self->h, *fx = self->f, *fv = fx + self->half;
    double *x = self->y, *v = x + self->half;
    for (size_t i = first; i < end; ++i) {
        v[i] += h * fv[i];
        x[i] = moved(x[i], h, fx[i], fv[i]);
    }
    return 0;
}

static int symplectic_euler(stepper *self, double t, double h, double *y)
{
    size_t bad;
    int failed = rhs_between(self, 0, t, y, NULL, spoilt_leap, &bad);
    failed = finish(self, failed, bad, h, y, 2 * self->half);
    if (failed == 0) {
        for_all(self, leap);
    }
    return failed;
}

static size_t predict(void *ctx, size_t first, size_t end)
{
    const stepper *self = ctx;
    const double h = self->h, drift = 0.5 * h * h, *x = self->y, *v = x + self->half;
    const double *fx = self->last, *fv = fx + self->half;
    double *ex = self->end, *ev = ex + self->half;
    for (size_t i = first; i < end; ++i) {
        ex[i] = x[i] + h * fx[i] + drift * fv[i];
        ev[i] = v[i] + h * fv[i];
    }
    return 0;
}

static size_t correct(void *ctx, size_t first, size_t end)
{
    const stepper *self = ctx;
    const double kick = 0.5 * self->h, *v = self->y + self->half;
    const double *from = self->last + self->half, *to = self->f + self->half;
    double *fx = self->f, *ex = self->end, *ev = ex + self->half;
    uint64_t bad = 0;
    for (size_t i = first; i < end; ++i) {
        const double next = v[i] + kick * from[i] + kick * to[i];
        fx[i] = fx[i] == ev[i] ? next : fx[i]; /* where it is v, not the predicted */
        ev[i] = next;
        bad |= not_finite(ex[i]) | not_finite(next);
    }
    return bad >> 63;
}

static size_t accept(void *ctx, size_t first, size_t end)
{
    const stepper *self = ctx;
    for (size_t i = first; i < 2 * self->half; i += self->half) {
        memcpy(self->y + i, self->end + i, (end - first) * sizeof *self->y);
    }
    return 0;
}

static int velocity_verlet(stepper *self, double t, double h, double *y)
{
    const size_t half = self->half, dim = self->ode.dim;
    /* f is stale if t or y really was changed: a needless state_changed alters nothing.
     */
    bool fresh = self->carries;
    if (fresh && self->changed) {
        const bool same
            = t == self->t && memcmp(y, self->end, 2 * half * sizeof *y) == 0;
        fresh = weft_stepper_agreed(self->agree, same ? 0.0 : 1.0) == 0.0;
    }
    int failed = fresh ? 0 : rhs(self, t, y);
    self->carries = self->changed = false;
    if (failed != 0 && self->agree == NULL) {
        return failed;
    }
    double *f = self->last;
    size_t bad;
    self->last = self->f, self->f = f;
    add(self->end, y, 0.5 * h, self->last, 2 * half, dim);
    failed = rhs_between(self, failed, t + h, self->end, predict, correct, &bad);
    failed = finish(self, failed, bad, 0.5 * h, self->end, 2 * half);
    if (failed == 0) {
        for_all(self, accept);
        memcpy(y + 2 * half, self->end + 2 * half, (dim - 2 * half) * sizeof *y);
        self->carries = true;
    }
    return failed;
}

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
    const weft_pass *pass = weft_stepper_pass(config);
    const size_t array = ode->dim + (pass != NULL ? APART : 0);
    const bool verlet = (type->flags & (uint32_t)WEFT_STEPPER_FSAL) != 0;
    const size_t touched
        = (verlet ? 3 : (size_t)type->stages) * ode->dim * sizeof(double);
    stepper *self
        = memory.resize(memory.ctx, NULL, sizeof *self + 3 * array * sizeof(double));
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "%s: no memory", type->name);
    }
    *self = (stepper){ .method = (const method *)type,
                       .ode = *ode,
                       .memory = memory,
                       .pass = pass,
                       .agree = weft_stepper_agree(config),
                       .half = weft_stepper_half(ode, config),
                       .fixed_step = config->fixed_step,
                       .stats = { .next_step = config->fixed_step, .bytes = touched } };
    self->f = (double *)(self + 1);
    self->end = self->f + array, self->last = self->end + array;
    *out = self;
    return WEFT_OK;
}

static weft_status step(void *instance, double t_end, double *t, double *y,
                        weft_error *err)
{
    stepper *self = instance;
    const double rest = t_end - *t;
    if (!(rest > 0.0)) {
        return weft_error_set(err, WEFT_INVALID, "step from %.*g s to %.*g s",
                              weft_text_digits(*t), *t, weft_text_digits(t_end), t_end);
    }
    /* A rest that is longer than the step by roundoff alone is taken whole. */
    const bool last = self->fixed_step >= rest * (1.0 - 1e-6);
    const double h = last ? rest : self->fixed_step;
    if (!last && *t + h == *t) {
        return weft_error_set(err, WEFT_STEP_TOO_SMALL, "t + h == t at h = %g s", h);
    }
    self->h = h, self->y = y;
    const int failed = self->method->advance(self, *t, h, y);
    if (failed != 0) {
        return failed < 0 ? weft_error_set(err, WEFT_STOPPED, "stopped by the model")
                          : weft_error_set(err, WEFT_NOT_FINITE,
                                           "not finite after a step of %g s", h);
    }
    *t = self->t = last ? t_end : *t + h;
    ++self->stats.steps;
    self->stats.last_step = h;
    return WEFT_OK;
}

/* Three methods keep nothing, and Verlet compares t and y with its own. */
static void state_changed(void *instance)
{
    stepper *self = instance;
    self->changed = true;
}

static void ode_changed(void *instance)
{
    ((stepper *)instance)->carries = false;
}

static void stats(const void *instance, weft_stepper_stats *out)
{
    const stepper *self = instance;
    weft_stepper_stats_copy(&self->stats, out);
}

static void destroy(void *instance)
{
    if (instance != NULL) {
        const weft_allocator memory = ((stepper *)instance)->memory;
        (void)memory.resize(memory.ctx, instance, 0);
    }
}

enum {
    FLAGS
    = WEFT_STEPPER_FIXED_ONLY | WEFT_STEPPER_QUADRATURES | WEFT_STEPPER_DISTRIBUTED
};

#define METHOD(id, p, calls, more, source)                                             \
    {                                                                                  \
        .type = { .abi = WEFT_STEPPER_ABI,                                             \
                  .struct_size = sizeof(weft_stepper_type),                            \
                  .name = #id,                                                         \
                  .reference = (source),                                               \
                  .license = "BSD-3-Clause",                                           \
                  .order = (p),                                                        \
                  .stages = (calls),                                                   \
                  .flags = FLAGS | (more),                                             \
                  .create = create,                                                    \
                  .step = step,                                                        \
                  .state_changed = state_changed,                                      \
                  .stats = stats,                                                      \
                  .destroy = destroy,                                                  \
                  .ode_changed = ode_changed },                                        \
        .advance = id                                                                  \
    }

static const method methods[] = {
    METHOD(symplectic_euler, 1, 1, WEFT_STEPPER_PASS,
           "X. Provot, Graphics Interface, 1995"),
    METHOD(velocity_verlet, 2, 1, WEFT_STEPPER_FSAL | WEFT_STEPPER_PASS,
           "W. C. Swope et al., J. Chem. Phys. 76, 1982"),
    METHOD(euler, 1, 1, 0, "L. Euler, Institutiones calculi integralis I, 1768"),
    METHOD(midpoint, 2, 2, 0, "C. Runge, Math. Ann. 46, 1895"),
};

WEFT_API const weft_plugin *weft_plugin_verlet(void)
{
    static const weft_stepper_type *const types[]
        = { &methods[0].type, &methods[1].type, &methods[2].type, &methods[3].type,
            NULL };
    static const weft_plugin plugin = {
        .abi = WEFT_STEPPER_ABI,
        .struct_size = sizeof(weft_plugin),
        .id = "verlet",
        .version = WEFT_VERSION,
        .solver = "",
        .types = types,
    };
    return &plugin;
}
