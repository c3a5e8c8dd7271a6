/* SPDX-License-Identifier: BSD-3-Clause */
/* trial.c -- what the checks share: runs of the method, and expectations of them. */
#include "study/conformance/trial.h"

_Noreturn void weft__broken(trial *self, const char *format, ...)
{
    weft_conformance *out = self->out;
    out->verdict = WEFT_PROMISE_BROKEN;
    const int used = snprintf(out->seen, sizeof out->seen, "%s",
                              self->apart > 0 ? "with quadratures: " : "");
    va_list args;
    va_start(args, format);
    (void)vsnprintf(out->seen + used, sizeof out->seen - (size_t)used, format, args);
    va_end(args);
    longjmp(self->broken, 1);
}

void weft__end(trial *self, int slot)
{
    if (self->runs[slot].self != NULL) {
        self->type->destroy(self->runs[slot].self);
        self->runs[slot].self = NULL;
    }
}

trial_run *weft__begin(trial *self, int slot, weft_stepper_config config)
{
    trial_run *r = &self->runs[slot];
    weft__end(self, slot);
    *r = (trial_run){ .type = self->type, .model = { .k = 1.0, .apart = self->apart } };
    r->ode = (weft_ode){ .dim = DIM + self->apart,
                         .rhs = weft__model_rhs,
                         .ctx = &r->model };
    r->structure = weft__model_structure(&r->model);
    memcpy(r->y, weft__model_start, sizeof weft__model_start);
    config.structure = weft__needs_structure(self->type) ? &r->structure : NULL;
    r->config = config;
    config = weft__with_table(self->type, config);
    config.quadratures = self->apart;
    const weft_status status
        = self->type->create(self->type, &r->ode, &config, &r->self, &r->err);
    EXPECT(status == WEFT_OK, "create failed: %s", r->err.message);
    EXPECT(r->self != NULL, "create succeeded and left *self NULL");
    return r;
}

trial_run *weft__begin_usual(trial *self, int slot)
{
    return weft__begin(self, slot, weft__usual(self->type, self->mode));
}

weft_status weft__step(trial_run *r, double t_end)
{
    return r->type->step(r->self, t_end, &r->t, r->y, &r->err);
}

void weft__good_step(trial *self, trial_run *r, double t_end)
{
    const double before = r->t;
    EXPECT(weft__step(r, t_end) == WEFT_OK, "step from %.*g to %.*g s failed: %s",
           weft_text_digits(before), before, weft_text_digits(t_end), t_end,
           r->err.message);
    EXPECT(before < r->t && r->t <= t_end,
           "a step from %.*g towards %.*g s ended at %.*g s", weft_text_digits(before),
           before, weft_text_digits(t_end), t_end, weft_text_digits(r->t), r->t);
}

void weft__go(trial *self, trial_run *r, double t_end)
{
    for (long steps = 1; r->t < t_end; ++steps) {
        weft__good_step(self, r, t_end);
        EXPECT(steps < 1000000, "%ld steps, and only at %.*g s", steps,
               weft_text_digits(r->t), r->t);
    }
}

weft_stepper_stats weft__stats(const trial_run *r)
{
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    r->type->stats(r->self, &stats);
    return stats;
}

bool weft__same(const trial *self, const trial_run *a, const trial_run *b)
{
    return memcmp(a->y, b->y, (DIM + self->apart) * sizeof *a->y) == 0;
}

void weft__unchanged(trial *self, const trial_run *r, const trial_run *before,
                     const char *what)
{
    EXPECT(memcmp(&r->t, &before->t, sizeof r->t) == 0,
           "%s: t changed from %.*g to %.*g", what, weft_text_digits(before->t),
           before->t, weft_text_digits(r->t), r->t);
    EXPECT(weft__same(self, r, before), "%s: y changed", what);
}

void weft__calls_counted(trial *self, const trial_run *r, const char *when)
{
    const uint64_t calls = weft__stats(r).rhs_calls;
    EXPECT(calls == r->model.calls, "%s: rhs_calls is %" PRIu64 ", there were %" PRIu64,
           when, calls, r->model.calls);
}

double weft__error_at_end(const trial_run *r)
{
    double y[DIM];
    memcpy(y, weft__model_start, sizeof y);
    weft__model_solve(0.0, r->t, y);
    return weft__model_distance(r->y, y);
}

void weft__near(trial *self, const trial_run *r, double error, double allowed,
                const char *what)
{
    if (error <= allowed) {
        return;
    }
    trial_run *quiet = weft__begin(self, SLOTS - 1, r->config);
    weft__go(self, quiet, r->t);
    EXPECT(false, "%s: off by %.3g at %g s, %g allowed; without that %.2g", what, error,
           r->t, allowed, weft__error_at_end(quiet));
}

void weft__near_solution(trial *self, const trial_run *r, const char *what)
{
    weft__near(self, r, weft__error_at_end(r), weft__allowed(self->type), what);
}
