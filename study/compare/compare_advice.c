/* SPDX-License-Identifier: BSD-3-Clause */
/* compare_advice.c -- recommends a method for each accuracy, with reasons. */
#include <math.h>

#include "study/compare/compare.h"

#define LEAST_ERROR 1e-300 /* in logarithms, for an error of 0 */

static double between(double from, double to, double part)
{
    return exp(log(from) + part * (log(to) - log(from)));
}

/* The coarsest point from which on all finer ones are as good. */
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

/* A finer setting may cost less: its cost bounds that of every coarser accuracy. */
bool compare_reach(const compare_method *method, double accuracy, compare_cost *out)
{
    const compare_point *before, *good = first_good(method, accuracy, &before);
    *out = (compare_cost){ 0 };
    if (good == NULL) {
        return false;
    }
    *out = (compare_cost){ method, good->setting, (double)good->calls, good->time };
    if (before != NULL) {
        const double e = log(fmax(good->error, LEAST_ERROR));
        const double part
            = (log(accuracy) - log(before->error)) / (e - log(before->error));
        out->calls = between((double)before->calls, out->calls, part);
        out->time = between(before->time, out->time, part);
        out->setting = between(before->setting, out->setting, part);
    }
    for (const compare_point *p = good; p < method->points + COMPARE_RUNGS; ++p) {
        if (p->outcome == COMPARE_DONE && p->time < out->time) {
            *out = (compare_cost){ method, p->setting, (double)p->calls, p->time };
        }
    }
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
        if (out->best.method == NULL || cost.time < out->best.time) {
            out->second = out->best;
            out->best = cost;
        } else if (out->second.method == NULL || cost.time < out->second.time) {
            out->second = cost;
        }
        if (!compare_is_implicit(cost.method)
            && (out->fewest.method == NULL || cost.calls < out->fewest.calls)) {
            out->fewest = cost;
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
    for (size_t k = 1; k <= COMPARE_DECADES; ++k) {
        compare_rank rank;
        const double accuracy = compare_decades[k];
        if (accuracy < COMPARE_NEAR * self->apart) {
            break;
        }
        rank_at(self, accuracy, &rank);
        if (rank.best.method == NULL) {
            break;
        }
        out->count -= out->count > 0 && rank.best.time <= above;
        out->ranks[out->count++] = rank;
        above = rank.best.time;
    }
}

/* ---- words ------------------------------------------------------------------ */

static void add_cost(const compare_cost *cost, sentence *out)
{
    const compare_method *method = cost->method;
    say(out, "%s %s %s %.1e%s", method->by.plugin->id, method->by.type->name,
        method->step > 0.0 ? "in steps of" : "at tolerance", cost->setting,
        method->step > 0.0 ? " s" : "");
    if (compare_is_stiff(method->by.type)) {
        say(out, " m and %.1e m/s", COMPARE_VELOCITY * cost->setting);
    }
    say(out, ", %s, %.0f evaluations", human_time(cost->time).text, cost->calls);
}

static void add_rival(const char *lead, const compare_cost *other, double times,
                      sentence *out)
{
    say(out, "%s%s %s takes %.*f times", lead, other->method->by.plugin->id,
        other->method->by.type->name,
        times < 1.095  ? 2
        : times < 9.95 ? 1
                       : 0,
        times);
}

sentence compare_rank_text(const compare_rank *rank)
{
    const compare_cost *best = &rank->best, *second = &rank->second, *own = &rank->own,
                       *fewest = &rank->fewest;
    sentence out = { "" };
    add_cost(best, &out);
    if (second->method != NULL) {
        add_rival("; next, ", second, second->time / best->time, &out);
        say(&out, " as long");
    }
    if (own->method == best->method) {
        say(&out, "; it is the scene's");
    } else if (own->method != NULL && own->method != second->method) {
        add_rival(", the scene's ", own, own->time / best->time, &out);
    }
    if (fewest->method != NULL && !compare_is_implicit(best->method)
        && fewest->calls * WORTH < best->calls) {
        say(&out, "; %s %s needs %.1f times fewer evaluations",
            fewest->method->by.plugin->id, fewest->method->by.type->name,
            best->calls / fewest->calls);
    }
    return out;
}

sentence compare_as_is_text(const compare *self)
{
    const compare_point *point = compare_as_is(self);
    compare_rank rank;
    sentence out = { "" };
    say(&out, "as the scene is (%s %s)", weft_scene_plugin(self->scene),
        weft_scene_method(self->scene));
    if (point->outcome != COMPARE_DONE) {
        say(&out, ": %s",
            point->outcome == COMPARE_FAILED ? point->why
                                             : "more evaluations than the reference");
        return out;
    }
    say(&out, ": error %.1e m in %s, %llu evaluations", point->error,
        human_time(point->time).text, (unsigned long long)point->calls);
    rank_at(self, fmax(point->error, COMPARE_NEAR * self->apart), &rank);
    if (rank.best.method != NULL && rank.best.time * WORTH < point->time) {
        say(&out, "; as good and %.1f times faster: ", point->time / rank.best.time);
        add_cost(&rank.best, &out);
    }
    return out;
}

sentence compare_horizon_text(const compare *self)
{
    sentence out = { "" };
    say(&out,
        "predictable to t = %.4g s%s: a perturbed run displaced by %.0e m is then %.1e "
        "m away "
        "(rate %.3g 1/s",
        compare_time(self, self->last), self->chaotic ? "" : " at least", COMPARE_NUDGE,
        self->perturbed[self->last], self->growth);
    if (self->chaotic) {
        say(&out, ": 10 times every %.2g s); compared up to there, not to %.4g s",
            log(10.0) / self->growth, self->run.duration);
    } else {
        say(&out, ")");
    }
    return out;
}

sentence compare_reference_text(const compare *self)
{
    sentence out = { "" };
    say(&out,
        "%s %s and %s %s at tolerance %.0e, %.1e m apart: errors below %.0e m are "
        "marked and not judged",
        self->by[0].plugin->id, self->by[0].type->name, self->by[1].plugin->id,
        self->by[1].type->name, COMPARE_TIGHTEST, self->apart,
        COMPARE_NEAR * self->apart);
    return out;
}
