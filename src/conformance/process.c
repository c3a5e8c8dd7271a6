/* SPDX-License-Identifier: BSD-3-Clause */
/* process.c -- what a method must leave alone in the process it works in. */
#include "conformance/trial.h"

#include <fenv.h>
#include <float.h>
#include <locale.h>
#include <signal.h>

enum { SIGNALS = 65 };

/* What the program may have set up for itself. */
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

static void the_process_is_left_alone(trial *self)
{
    surroundings before, after;
    look_around(&before);
    for (int mode = 0; mode < 2; ++mode) {
        trial_run *r = weft__begin(self, 0, weft__usual(self->type, mode));
        if (r == NULL || !weft__go(self, r, 0.125)) {
            break;
        }
        r->model.fault = GIVE_NAN;
        (void)weft__step(self, r, 1.0);
        self->type->state_changed(r->self);
        weft__end(self, 0);
    }
    look_around(&after);
    (void)weft__expect(self, strcmp(before.locale, after.locale) == 0,
                       "the locale was '%s' and is '%s'", before.locale, after.locale);
    (void)weft__expect(self,
                       before.rounding == after.rounding
                           && before.subnormals == after.subnormals,
                       "the floating-point environment is another");
    for (int i = 1; i < SIGNALS; ++i) {
        (void)weft__expect(self,
                           before.actions[i].sa_handler == after.actions[i].sa_handler,
                           "signal %d has another handler", i);
    }
}

const check weft__process_checks[]
    = { { .name = "process",
          .promise
          = "locale, signal handlers and floating-point environment stay as they "
            "are",
          .run = the_process_is_left_alone },
        { 0 } };
