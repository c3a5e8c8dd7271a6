/* SPDX-License-Identifier: BSD-3-Clause */
/* trial.c -- all checks in one table, and what they share. */
#include "conformance/trial.h"

static const check *const lists[]
    = { weft__creation_checks, weft__step_checks,     weft__failure_checks,
        weft__state_checks,    weft__accuracy_checks, weft__memory_checks,
        weft__process_checks };

/* NULL past the last. */
static const check *check_at(size_t i)
{
    for (size_t list = 0; list < sizeof lists / sizeof lists[0]; ++list) {
        for (const check *c = lists[list]; c->name != NULL; ++c) {
            if (i-- == 0) {
                return c;
            }
        }
    }
    return NULL;
}

size_t weft_conformance_count(void)
{
    size_t count = 0;
    while (check_at(count) != NULL) {
        ++count;
    }
    return count;
}

const char *weft_conformance_name(size_t i)
{
    return check_at(i)->name;
}

const char *weft_conformance_promise(size_t i)
{
    return check_at(i)->promise;
}

const char *weft__no_error_control(const weft_stepper_type *type)
{
    return weft__adapts(type) ? NULL : "the method has no error control";
}

weft_conformance weft_conformance_check(const weft_stepper_type *type, size_t i)
{
    const check *c = check_at(i);
    weft_conformance out = { .verdict = WEFT_PROMISE_KEPT };
    const char *pointless = c->pointless == NULL ? NULL : c->pointless(type);
    if (pointless != NULL) {
        out.verdict = WEFT_PROMISE_NOT_ASKED;
        (void)snprintf(out.seen, sizeof out.seen, "%s", pointless);
        return out;
    }
    const bool both = !c->once && (type->flags & WEFT_STEPPER_QUADRATURES) != 0;
    for (size_t apart = 0; apart <= (both ? APART : 0); apart += APART) {
        trial self = { .type = type, .apart = apart, .out = &out };
        c->run(&self);
        for (int slot = 0; slot < SLOTS; ++slot) {
            weft__end(&self, slot);
        }
    }
    return out;
}

bool weft__expect(trial *self, bool ok, const char *format, ...)
{
    weft_conformance *out = self->out;
    if (!ok && out->verdict == WEFT_PROMISE_KEPT) {
        out->verdict = WEFT_PROMISE_BROKEN;
        const int used = snprintf(out->seen, sizeof out->seen, "%s",
                                  self->apart > 0 ? "with quadratures: " : "");
        va_list args;
        va_start(args, format);
        (void)vsnprintf(out->seen + used, sizeof out->seen - (size_t)used, format,
                        args);
        va_end(args);
    }
    return ok;
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
    *r = (trial_run){ .model = { .k = 1.0, .apart = self->apart } };
    r->ode = (weft_ode){ .dim = DIM + self->apart,
                         .rhs = weft__model_rhs,
                         .ctx = &r->model };
    memcpy(r->y, weft__model_start, sizeof weft__model_start);
    r->config = config;
    config = weft__with_table(self->type, config);
    config.quadratures = self->apart;
    const weft_status status
        = self->type->create(self->type, &r->ode, &config, &r->self, &r->err);
    const bool made
        = weft__expect(self, status == WEFT_OK, "create failed: %s", r->err.message)
          && weft__expect(self, r->self != NULL,
                          "create succeeded and left *self NULL");
    return made ? r : NULL;
}

weft_status weft__step(const trial *self, trial_run *r, double t_end)
{
    return self->type->step(r->self, t_end, &r->t, r->y, &r->err);
}

bool weft__good_step(trial *self, trial_run *r, double t_end)
{
    const double before = r->t;
    return weft__expect(self, weft__step(self, r, t_end) == WEFT_OK,
                        "step from %.17g to %.17g s failed: %s", before, t_end,
                        r->err.message)
           && weft__expect(self, before < r->t && r->t <= t_end,
                           "a step from %.17g towards %.17g s ended at %.17g s", before,
                           t_end, r->t);
}

bool weft__go(trial *self, trial_run *r, double t_end)
{
    for (long steps = 1; r->t < t_end; ++steps) {
        if (!weft__good_step(self, r, t_end)
            || !weft__expect(self, steps < 1000000, "%ld steps, and only at %.17g s",
                             steps, r->t)) {
            return false;
        }
    }
    return true;
}

weft_stepper_stats weft__stats(const trial *self, const trial_run *r)
{
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    self->type->stats(r->self, &stats);
    return stats;
}

bool weft__same(const trial *self, const trial_run *a, const trial_run *b)
{
    return memcmp(a->y, b->y, (DIM + self->apart) * sizeof *a->y) == 0;
}

double weft__error_at_end(const trial_run *r)
{
    double y[DIM];
    memcpy(y, weft__model_start, sizeof y);
    weft__model_solve(0.0, r->t, y);
    return weft__model_distance(r->y, y);
}

bool weft__near(trial *self, const trial_run *r, double error, double allowed,
                const char *what, ...)
{
    char done[96];
    va_list args;
    if (error <= allowed) {
        return true;
    }
    trial_run *quiet = weft__begin(self, SLOTS - 1, r->config);
    if (quiet == NULL || !weft__go(self, quiet, r->t)) {
        return false;
    }
    va_start(args, what);
    (void)vsnprintf(done, sizeof done, what, args);
    va_end(args);
    return weft__expect(self, false,
                        "%s: off by %.3g at %g s, %g allowed; without that %.2g", done,
                        error, r->t, allowed, weft__error_at_end(quiet));
}
