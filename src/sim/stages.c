/* SPDX-License-Identifier: BSD-3-Clause */
/* stages.c -- the sums of stages.h, from what a method makes of unit vectors: its call
 * i has the rate 1 in component i of three groups, free, prescribed p and prescribed q,
 * and 0 elsewhere; one more free component only moves. */
#include "sim/stages.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum {
    CALLS = 2 * WEFT__STAGES + 2,
    P = CALLS,
    Q = 2 * CALLS,
    MOVES = 3 * CALLS,
    HALF = MOVES + 1
};

#define AWAY     3.0   /* [m/s] of prescribed components: no rate of theirs */
#define NOTHING  1e-14 /* roundoff of a share */
#define THE_SAME 1e-12

typedef struct unit_model {
    size_t calls, ends[2];
    double t[CALLS], y[CALLS][2 * HALF];
    double start[3][2 * HALF]; /* of both steps, and the end */
} unit_model;

static int rates(double t, const double *y, double *dydt, void *ctx)
{
    unit_model *of = ctx;
    const size_t i = of->calls;
    if (i == CALLS) {
        return -1;
    }
    memcpy(of->y[i], y, sizeof of->y[i]);
    of->t[i] = t;
    ++of->calls;
    for (size_t k = 0; k < HALF; ++k) {
        const bool prescribed = k >= P && k < MOVES;
        dydt[k] = prescribed ? k == P + i : y[HALF + k];
        dydt[HALF + k] = k == i || k == Q + i;
    }
    return 0;
}

/* Two steps of 1 s. */
static weft_status take_steps(const weft_stepper_type *method,
                              const weft_stepper_config *given, unit_model *of,
                              weft_error *err)
{
    weft_stepper_config config = *given;
    const weft_ode ode = { 2 * (size_t)HALF, rates, of };
    void *stepper = NULL;
    double t = 0.0, y[2 * HALF] = { 0.0 };
    config.fixed_step = 1.0;
    config.structure = NULL, config.team = NULL, config.threads = 1;
    for (size_t k = P; k < HALF; ++k) {
        y[HALF + k] = k == MOVES ? 1.0 : AWAY;
    }
    weft_status status = method->create(method, &ode, &config, &stepper, err);
    for (size_t i = 0; status == WEFT_OK && i < 2; ++i) {
        memcpy(of->start[i], y, sizeof y);
        status = method->step(stepper, 2.0, &t, y, err);
        of->ends[i] = of->calls;
    }
    memcpy(of->start[2], y, sizeof y);
    if (stepper != NULL) {
        method->destroy(stepper);
    }
    return status;
}

static double clean(double a)
{
    return fabs(a) < NOTHING ? 0.0 : a;
}

/* What state y has of the rate of a call, in a step from `from`. */
static weft__share share_of(const double *from, const double *y, double c, size_t call)
{
    const double *x0 = from, *v0 = from + HALF, *x = y, *v = y + HALF;
    return (weft__share){ clean(x[call] - x0[call] - c * v0[call]),
                          clean(v[call] - v0[call]), clean(x[P + call] - x0[P + call]),
                          clean(x[Q + call] - x0[Q + call]),
                          clean(v[Q + call] - v0[Q + call]) };
}

static bool stages_same(const weft__share *a, const weft__share *b)
{
    return fabs(a->xa - b->xa) + fabs(a->va - b->va) + fabs(a->xp - b->xp)
               + fabs(a->xq - b->xq) + fabs(a->vq - b->vq)
           < THE_SAME;
}

static bool is_nothing(const weft__share *a)
{
    return stages_same(a, &(weft__share){ 0 });
}

/* Fills a table from one of the two steps, whose rate 0 is that of call `zero`; of no
 * call if that is CALLS. False: it is no such sum. */
static bool stages_fill(const unit_model *of, size_t step, size_t first, size_t zero,
                        weft__stages *to)
{
    const double *from = of->start[step];
    bool sums = true;
    for (size_t k = 1; k <= to->count + 1; ++k) {
        const bool end = k > to->count;
        const double *y = end ? of->start[step + 1] : of->y[first + k - 1];
        to->c[k] = y[MOVES] - from[MOVES];
        for (size_t i = 0; i < of->calls; ++i) {
            const weft__share share = share_of(from, y, to->c[k], i);
            const size_t j = i == zero ? 0 : i - first + 1;
            const bool before = i == zero || (i >= first && j < k);
            if (before) {
                to->share[k][j] = share;
            }
            sums = sums && (before || is_nothing(&share));
        }
        sums = sums && y[HALF + MOVES] == 1.0
               && fabs(to->c[k] - (end ? 1.0 : of->t[first + k - 1] - (double)step))
                      < THE_SAME;
    }
    return sums;
}

/* Which states the end needs, or by what it carries the next step. */
static void find_needed(weft__stages *of)
{
    const size_t end = of->count + 1;
    of->needed[end] = true;
    for (size_t k = end; k > 0; --k) {
        of->carries = of->carries || !is_nothing(&of->share[k][0]);
    }
    of->needed[of->count] = of->carries;
    for (size_t k = end; k > 0; --k) {
        for (size_t j = 0; of->needed[k] && j < k; ++j) {
            of->needed[j] = of->needed[j] || !is_nothing(&of->share[k][j]);
        }
    }
}

static bool find_sums(const unit_model *of, weft__stages *first, weft__stages *out)
{
    const size_t before = of->ends[0], count = of->ends[1] - before;
    first->count = out->count = count;
    if (count == 0 || count > WEFT__STAGES
        || (before != count && before != count + 1)) {
        return false;
    }
    bool sums = stages_fill(of, 1, before, before - 1, out);
    sums = stages_fill(of, 0, before - count, before == count ? CALLS : 0, first)
           && sums;
    for (size_t k = 1; k <= count + 1; ++k) {
        for (size_t j = 0; j < k; ++j) {
            sums = sums && stages_same(&first->share[k][j], &out->share[k][j]);
        }
    }
    find_needed(out);
    return sums && out->carries == (before > count);
}

weft_status weft__stages_find(const weft_stepper_type *method,
                              const weft_stepper_config *config, weft__stages *out,
                              weft_error *err)
{
    const weft_allocator memory = weft_stepper_memory(config);
    unit_model *of = weft__zeroed(&memory, 1, sizeof *of);
    weft__stages *first = weft__zeroed(&memory, 1, sizeof *first);
    weft_status status
        = of != NULL && first != NULL
              ? take_steps(method, config, of, err)
              : weft_error_set(err, WEFT_NO_MEMORY, "no memory for stages");
    *out = (weft__stages){ 0 };
    if (status == WEFT_STOPPED || (status == WEFT_OK && !find_sums(of, first, out))) {
        status = weft_error_set(err, WEFT_UNSUPPORTED,
                                "method '%.40s' is no sum of the rates of its stages, "
                                "which a gradient goes back through",
                                method->name);
    }
    WEFT__FREE_ALL(&memory, of, first);
    return status;
}
