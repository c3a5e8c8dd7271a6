/* SPDX-License-Identifier: BSD-3-Clause */
/* process.c -- the state of the process, which a method must leave unchanged. */
#include "conformance/trial.h"

#include <fenv.h>
#include <float.h>
#include <locale.h>
#include <signal.h>

enum { SIGNALS = 65 };

/* Settings that belong to the program. */
typedef struct surroundings {
    char locale[256];
    int rounding;
    bool subnormals;
    struct sigaction actions[SIGNALS];
} surroundings;

static void look_around(surroundings *out)
{
    const volatile double smallest = DBL_MIN;
    const char *locale = setlocale(LC_ALL, NULL);
    memset(out, 0, sizeof *out);
    (void)snprintf(out->locale, sizeof out->locale, "%s", locale == NULL ? "" : locale);
    out->rounding = fegetround();
    out->subnormals = smallest / 2.0 > 0.0;
    for (int i = 1; i < SIGNALS; ++i) {
        (void)sigaction(i, NULL, &out->actions[i]);
    }
}

void weft__the_process_is_left_alone(trial *self)
{
    surroundings before, after;
    look_around(&before);
    trial_run *r = weft__begin_usual(self, 0);
    weft__go(self, r, 0.125);
    r->model.fault = GIVE_NAN;
    (void)weft__step(self, r, 1.0);
    self->type->state_changed(r->self);
    weft__end(self, 0);
    look_around(&after);
    weft__expect(self, strcmp(before.locale, after.locale) == 0,
                 "the locale was '%s' and is '%s'", before.locale, after.locale);
    weft__expect(self,
                 before.rounding == after.rounding
                     && before.subnormals == after.subnormals,
                 "the floating-point environment has changed");
    for (int i = 1; i < SIGNALS; ++i) {
        weft__expect(self, before.actions[i].sa_handler == after.actions[i].sa_handler,
                     "signal %d has another handler", i);
    }
}
