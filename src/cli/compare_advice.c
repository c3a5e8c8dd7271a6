/* SPDX-License-Identifier: BSD-3-Clause */
/* compare_advice.c -- which method for which accuracy, and why, in words. */
#include <math.h>
#include <string.h>

#include "cli/compare.h"

#define LEAST_ERROR 1e-300 /* in logarithms, for an error of 0 */

static double between(double from, double to, double part)
{
    return exp(log(from) + part * (log(to) - log(from)));
}

/* A lucky point does not count: all that are finer must be as good. */
static const compare_point *first_good(const compare_method *method, double accuracy,
                                       const compare_point **before)
{
    const compare_point *good = NULL;
    *before = NULL;
    for (size_t i = COMPARE_RUNGS; i-- > 0;) {
        const compare_point *point = &method->points[i];
        if (point->outcome != COMPARE_DONE) {
            continue;
        }
        if (!(point->error <= accuracy)) {
            *before = isfinite(point->error) ? point : NULL;
            return good;
        }
        good = point;
    }
    return good;
}

bool compare_reach(const compare_method *method, double accuracy, compare_cost *out)
{
    const compare_point *before, *good = first_good(method, accuracy, &before);
    *out = (compare_cost){ 0 };
    if (good == NULL) {
        return false;
    }
    out->method = method;
    out->calls = (double)good->calls;
    out->setting = good->setting;
    if (before != NULL) {
        const double e = log(fmax(good->error, LEAST_ERROR));
        const double part
            = (log(accuracy) - log(before->error)) / (e - log(before->error));
        out->calls = between((double)before->calls, out->calls, part);
        out->setting = between(before->setting, out->setting, part);
    }
    out->time = out->calls * method->call_time;
    return true;
}

static void rank_at(const compare *self, double accuracy, compare_rank *out)
{
    *out = (compare_rank){ .accuracy = accuracy };
    for (size_t i = 0; i < self->count; ++i) {
        compare_cost cost;
        if (!compare_reach(&self->shared->methods[i], accuracy, &cost)) {
            continue;
        }
        if (out->best.method == NULL || cost.calls < out->best.calls) {
            out->second = out->best;
            out->best = cost;
        } else if (out->second.method == NULL || cost.calls < out->second.calls) {
            out->second = cost;
        }
        if (cost.time > 0.0
            && (out->fastest.method == NULL || cost.time < out->fastest.time)) {
            out->fastest = cost;
        }
        if (cost.method->own) {
            out->own = cost;
        }
    }
}

/* Coarse accuracies that cost no less than the next one are left out. */
void compare_advise(const compare *self, compare_advice *out)
{
    double above = 0.0;
    out->count = 0;
    for (int k = 1; k <= COMPARE_DECADES; ++k) {
        compare_rank rank;
        const double accuracy = pow(10.0, -k);
        if (accuracy < COMPARE_NEAR * self->apart) {
            break;
        }
        rank_at(self, accuracy, &rank);
        if (rank.best.method == NULL) {
            break;
        }
        out->count -= out->count > 0 && rank.best.calls <= above;
        out->ranks[out->count++] = rank;
        above = rank.best.calls;
    }
}

/* ---- words ------------------------------------------------------------------------
 */

WEFT_PRINTF(3, 4)
static void add(char *text, size_t size, const char *format, ...)
{
    const size_t used = strlen(text);
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text + used, size - used, format, args);
    va_end(args);
}

static const char *kind(const compare_method *method)
{
    return method->step > 0.0 ? "in steps of" : "at tolerance";
}

static void add_fewer(const compare_cost *best, const compare_cost *other,
                      const char *of, char *text, size_t size)
{
    const stepper_method *by = &other->method->by;
    add(text, size, "%.*f times fewer than %s%s %s",
        other->calls < 9.95 * best->calls ? 1 : 0, other->calls / best->calls, of,
        by->plugin->id, by->type->name);
}

void compare_say(const compare_rank *rank, char *text, size_t size)
{
    const compare_cost *best = &rank->best;
    const bool rivals = rank->second.method != NULL;
    text[0] = '\0';
    add(text, size, "to %.0e m: %s %s %s %.1g%s, %.3g calls", rank->accuracy,
        best->method->by.plugin->id, best->method->by.type->name, kind(best->method),
        best->setting, best->method->step > 0.0 ? " s" : "", best->calls);
    if (rivals) {
        add(text, size, "; ");
        add_fewer(best, &rank->second, "the next, ", text, size);
    }
    if (rank->own.method != NULL && rank->own.method != best->method
        && rank->own.method != rank->second.method) {
        add(text, size, ", ");
        add_fewer(best, &rank->own, "the scene's ", text, size);
    } else if (rank->own.method == best->method) {
        add(text, size, "; it is the scene's");
    }
    const compare_method *fastest = rank->fastest.method;
    if (fastest != NULL && fastest != best->method) {
        add(text, size, "; by the clock %s %s, %.1f times as fast",
            fastest->by.plugin->id, fastest->by.type->name,
            best->time / rank->fastest.time);
    }
}

void compare_say_as_is(const compare *self, char *text, size_t size)
{
    const compare_point *point = &self->shared->as_is;
    compare_rank rank;
    text[0] = '\0';
    add(text, size, "as the scene is (%s %s)", weft_scene_plugin(self->scene),
        weft_scene_method(self->scene));
    if (point->outcome != COMPARE_DONE) {
        add(text, size, ": %s",
            point->outcome == COMPARE_FAILED ? point->why
                                             : "more calls than the reference");
        return;
    }
    add(text, size, ": error %.2g m for %llu calls", point->error,
        (unsigned long long)point->calls);
    rank_at(self, fmax(point->error, COMPARE_NEAR * self->apart), &rank);
    if (rank.best.method != NULL && rank.best.calls < (double)point->calls) {
        add(text, size, "; %s %s %s %.1g%s is as good for %.3g, %.1f times fewer",
            rank.best.method->by.plugin->id, rank.best.method->by.type->name,
            kind(rank.best.method), rank.best.setting,
            rank.best.method->step > 0.0 ? " s" : "", rank.best.calls,
            (double)point->calls / rank.best.calls);
    }
}

void compare_say_horizon(const compare *self, char *text, size_t size)
{
    const double t = compare_time(self, self->last), far = self->twin[self->last];
    text[0] = '\0';
    if (self->chaotic) {
        add(text, size,
            "predictable to t = %.4g s: a twin displaced by %.0e m has come %.0e m off "
            "by "
            "then (rate %.3g 1/s: 10 times every %.2g s); compared up to there, not to "
            "%.4g s",
            t, COMPARE_NUDGE, far, self->growth, log(10.0) / self->growth,
            self->run.duration);
    } else {
        add(text, size,
            "predictable to t = %.4g s at least: a twin displaced by %.0e m is %.1e m "
            "off "
            "by then (rate %.3g 1/s)",
            t, COMPARE_NUDGE, far, self->growth);
    }
}

void compare_say_reference(const compare *self, char *text, size_t size)
{
    text[0] = '\0';
    add(text, size,
        "%s %s and %s %s at tolerance %.0e, %.1e m apart: errors below %.0e m are "
        "marked and not judged",
        self->by[0].plugin->id, self->by[0].type->name, self->by[1].plugin->id,
        self->by[1].type->name, COMPARE_TIGHTEST, self->apart,
        COMPARE_NEAR * self->apart);
}
