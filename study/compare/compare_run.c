/* SPDX-License-Identifier: BSD-3-Clause */
/* compare_run.c -- the runs of weft compare: references, perturbed, ladders. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "study/compare/compare.h"

enum { CALL_TIME_LEAST = 3 }; /* steps */
#define CALL_TIME_SLICE 0.01  /* [s] */
#define EXPENSIVE_HINT  1.2   /* budgets: a run with a higher estimate is not tried */

/* RHS calls that an iteration of conjugate gradients is worth with multigrid, and a
 * Jacobian with its preconditioner. */
enum { ITERATION_CALLS = 15, JACOBIAN_CALLS = 20 };

/* One run against the reference. */
typedef struct compare_trial {
    const compare *self;
    weft_sim *sim, *perturbed; /* perturbed NULL: none */
    uint64_t budget;           /* RHS calls; 0: as many as it takes */
    size_t which;              /* the reference computed, 0 or 1 */
    double judging;            /* [s] spent on comparing frames */
    double square;             /* [m^2] summed over particles and frames */
    compare_point *point;
} compare_trial;

double compare_time(const compare *self, size_t frame)
{
    return weft_run_frame_time(&self->run, frame);
}

bool compare_is_implicit(const compare_method *method)
{
    return (method->by.type->flags & WEFT_STEPPER_IMPLICIT) != 0;
}

bool compare_is_stiff(const weft_stepper_type *type)
{
    return (type->flags & (WEFT_STEPPER_STRUCTURE | WEFT_STEPPER_LINEAR)) != 0;
}

const compare_point *compare_as_is(const compare *self)
{
    return self->shared->methods[self->count].points;
}

const double compare_decades[]
    = { 1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10 };

static weft_stepper_config adaptive(const compare *self, const stepper_method *by,
                                    double tolerance)
{
    const weft_stepper_config *own = weft_scene_config(self->scene);
    weft_stepper_config config = weft_stepper_config_default();
    config.norm = own->norm;
    config.rtol = config.atol_position = config.atol_velocity = tolerance;
    if (compare_is_stiff(by->type)) {
        config.atol_velocity *= COMPARE_VELOCITY;
    }
    config.threads = own->threads;
    config.butcher
        = (by->type->flags & WEFT_STEPPER_BUTCHER) != 0 ? own->butcher : NULL;
    return config;
}

static weft_status create(const compare *self, const stepper_method *by,
                          const weft_stepper_config *config, weft_sim **out,
                          weft_error *err)
{
    weft_sim_def def = weft_sim_def_default();
    def.cloth = self->cloth;
    def.method = by->type;
    def.config = *config;
    def.limit = *weft_scene_limit(self->scene);
    def.start = self->start;
    return weft_sim_create(&def, out, err);
}

/* [s] With one thread the processor's time, which excludes other programs' work. */
static double work_clock(const compare *self)
{
    struct timespec now;
    (void)clock_gettime(
        self->run.threads > 1 ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static uint64_t work(const weft_stepper_stats *stats)
{
    return stats->rhs_calls + ITERATION_CALLS * stats->linear_iterations
           + JACOBIAN_CALLS * stats->factorisations;
}

/* ---- references and perturbed
 * --------------------------------------------------------- */

/* Displaces every free particle by COMPARE_NUDGE, always in the same directions. */
static weft_status nudge(weft_sim *perturbed, weft_error *err)
{
    const size_t n = weft_cloth_particles(weft_sim_cloth(perturbed));
    double *xyz = malloc(3 * n * sizeof *xyz);
    uint32_t state = 1;
    if (xyz == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a perturbed run");
    }
    weft_sim_positions(perturbed, xyz);
    for (size_t i = 0; i < n; ++i) {
        double d[3];
        for (size_t k = 0; k < 3; ++k) {
            state = state * 1664525u + 1013904223u; /* Numerical Recipes' LCG */
            d[k] = (double)state / 2147483648.0 - 1.0;
        }
        const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (size_t k = 0; k < 3; ++k) {
            xyz[3 * i + k] += COMPARE_NUDGE * d[k] / length;
        }
    }
    const weft_status status = weft_sim_set_state(perturbed, xyz, NULL, err);
    free(xyz);
    return status;
}

double compare_farthest(const double *a, const double *b, size_t n, double *square)
{
    double top = 0.0;
    for (size_t i = 0; i < n; ++i) {
        double sum = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const double apart = a[k * n + i] - b[k * n + i];
            sum += apart * apart;
        }
        top = sum <= top ? top : isfinite(sum) ? sum : (double)INFINITY;
        *square += sum;
    }
    return sqrt(top);
}

static weft_status keep(void *ctx, size_t i, weft_error *err)
{
    compare_trial *of = ctx;
    const compare *self = of->self;
    const size_t n = weft_cloth_particles(self->cloth);
    const double *y = weft_sim_state(of->sim);
    double square = 0.0;
    memcpy(self->frames[of->which] + i * 6 * n, y, 6 * n * sizeof *y);
    if (of->perturbed != NULL) {
        self->energy[i] = weft_energy_total(
            weft_cloth_energy(self->cloth, weft_sim_time(of->sim), y));
        TRY(weft_sim_advance(of->perturbed, compare_time(self, i), err));
        self->perturbed[i]
            = compare_farthest(y, weft_sim_state(of->perturbed), n, &square);
        if (self->perturbed[i] > COMPARE_GROWTH * COMPARE_NUDGE) {
            atomic_store(&self->shared->last, i - 1);
        }
    }
    self->calls[of->which][i] = weft_sim_stats(of->sim).rhs_calls; /* it is complete */
    return WEFT_OK;
}

/* One reference stops behind the frame at which the other's perturbed has diverged. */
static bool go_on(void *ctx)
{
    const compare_trial *of = ctx;
    const size_t last = atomic_load(&of->self->shared->last);
    return weft_sim_time(of->sim) < compare_time(of->self, last + 1)
           || last == of->self->planned;
}

/* `frames` lacks run and ctx. */
static weft_status play(compare_trial *of, weft_play frames, weft_error *err)
{
    frames.run = &of->self->run;
    frames.ctx = of;
    const double began = work_clock(of->self);
    const weft_status status = weft_sim_play(of->sim, &frames, err);
    const weft_stepper_stats stats = weft_sim_stats(of->sim);
    of->point->time = work_clock(of->self) - began - of->judging;
    of->point->calls = stats.rhs_calls;
    of->point->steps = stats.steps;
    of->point->rejected = stats.rejected;
    of->point->work = work(&stats);
    return status;
}

int compare_reference(void *ctx, size_t which)
{
    const compare *self = ctx;
    const weft_stepper_config config
        = adaptive(self, &self->by[which], COMPARE_TIGHTEST);
    weft_error *err = &self->shared->err[which];
    compare_point point = { 0 };
    compare_trial of = { .self = self, .which = which, .point = &point };
    const weft_play frames = { .last = self->planned, .frame = keep, .step = go_on };
    weft_status status = create(self, &self->by[which], &config, &of.sim, err);
    if (status == WEFT_OK && which == 0) {
        status = create(self, &self->by[0], &config, &of.perturbed, err);
        status = status == WEFT_OK ? nudge(of.perturbed, err) : status;
    }
    status = status == WEFT_OK ? play(&of, frames, err) : status;
    err->status = status == WEFT_STOPPED ? WEFT_OK : status;
    weft_sim_destroy(of.sim);
    weft_sim_destroy(of.perturbed);
    return EXIT_DONE;
}

/* ---- a run against the reference -------------------------------------------- */

static weft_status judge(void *ctx, size_t i, weft_error *err)
{
    compare_trial *of = ctx;
    const compare *self = of->self;
    compare_point *point = of->point;
    const size_t n = weft_cloth_particles(self->cloth);
    const double *y = weft_sim_state(of->sim), *right = self->frames[0] + i * 6 * n;
    const double began = work_clock(self);
    const double energy
        = weft_energy_total(weft_cloth_energy(self->cloth, weft_sim_time(of->sim), y));
    double unused = 0.0;
    (void)err;
    point->error = fmax(point->error, compare_farthest(y, right, n, &of->square));
    point->velocity
        = fmax(point->velocity, compare_farthest(y + 3 * n, right + 3 * n, n, &unused));
    point->energy = fmax(point->energy, fabs(energy - self->energy[i]) / self->at_play);
    of->judging += work_clock(self) - began;
    return WEFT_OK;
}

static bool affordable(void *ctx)
{
    const compare_trial *of = ctx;
    const weft_stepper_stats stats = weft_sim_stats(of->sim);
    return of->budget == 0 || work(&stats) <= of->budget;
}

/* WEFT_UNSUPPORTED: the method refuses the cloth. */
static weft_status run(const compare *self, const stepper_method *by,
                       const weft_stepper_config *config, uint64_t budget,
                       compare_point *point)
{
    weft_error err = { 0 };
    compare_trial of = { .self = self, .budget = budget, .point = point };
    const weft_play frames = { .last = self->last, .frame = judge, .step = affordable };
    point->outcome = COMPARE_RUNNING;
    weft_status status = create(self, by, config, &of.sim, &err);
    if (status == WEFT_OK) {
        status = play(&of, frames, &err);
        const double count
            = (double)weft_cloth_particles(self->cloth) * (double)(self->last + 1);
        point->rms = sqrt(of.square / count);
    }
    weft_sim_destroy(of.sim);
    point->outcome = status == WEFT_OK        ? COMPARE_DONE
                     : status == WEFT_STOPPED ? COMPARE_EXPENSIVE
                                              : COMPARE_FAILED;
    if (point->outcome == COMPARE_FAILED) {
        (void)snprintf(point->why, sizeof point->why, "%.*s",
                       (int)sizeof point->why - 1, err.message);
    }
    return status;
}

/* ---- stiffness --------------------------------------------------------------- */

int compare_stiffness(void *ctx, size_t unused)
{
    const compare *self = ctx;
    survey found = { .modes = self->modes };
    (void)unused;
    if (found.modes.omega2 > 0.0
        && survey_methods(self->scene, self->given->registry, &found, NULL)
               == WEFT_OK) {
        const stiff_gains gains = stiff_gains_of(&found, weft_scene_cloth(self->scene));
        stiff_say(&gains, &self->shared->stiffness);
    }
    survey_destroy(&found);
    return EXIT_DONE;
}

/* ---- ladders ---------------------------------------------------------------- */

static void set_rung(const compare *self, const compare_method *method, size_t rung,
                     weft_stepper_config *config, compare_point *point)
{
    if (method->step > 0.0) {
        *config = adaptive(self, &method->by, 1e-6);
        config->fixed_step = point->setting = ldexp(method->step, -(int)rung);
    } else {
        point->setting = compare_decades[COMPARE_FIRST + rung];
        *config = adaptive(self, &method->by, point->setting);
    }
}

/* Estimated work in RHS calls: of fixed steps from their number, of others from the
 * growth of the last two rungs; 0: unknown. */
static double foresee(const compare *self, const compare_method *method, size_t rung)
{
    const compare_point *points = method->points;
    if (method->step > 0.0) {
        return method->step_calls * compare_time(self, self->last)
               / ldexp(method->step, -(int)rung);
    }
    if (rung < 2 || points[rung - 1].outcome != COMPARE_DONE
        || points[rung - 2].outcome != COMPARE_DONE) {
        return 0.0;
    }
    const double before = (double)points[rung - 2].work,
                 last = (double)points[rung - 1].work;
    return last * fmax(1.0, last / before);
}

int compare_ladder(void *ctx, size_t i)
{
    const compare *self = ctx;
    compare_method *method = &self->shared->methods[i];
    if (i == self->count) {
        const stepper_method by = { NULL, weft_scene_method_type(self->scene) };
        (void)run(self, &by, weft_scene_config(self->scene), self->calls[0][self->last],
                  &method->points[0]);
        return EXIT_DONE;
    }
    bool dear = false, done = method->left_out[0] != '\0';
    for (size_t rung = 0; rung < COMPARE_RUNGS && !done; ++rung) {
        compare_point *point = &method->points[rung];
        weft_stepper_config config;
        set_rung(self, method, rung, &config, point);
        const double foreseen = foresee(self, method, rung);
        if (dear || foreseen > EXPENSIVE_HINT * (double)self->budget) {
            point->outcome = COMPARE_EXPENSIVE;
        } else if (run(self, &method->by, &config, self->budget, point)
                       == WEFT_UNSUPPORTED
                   && rung == 0) { /* the method refuses the cloth */
            const compare_point refused = *point;
            (void)snprintf(method->left_out, sizeof method->left_out, "%.*s",
                           (int)sizeof method->left_out - 1, refused.why);
            *point = (compare_point){ 0 };
            break;
        }
        dear = point->outcome == COMPARE_EXPENSIVE;
        done = point->outcome == COMPARE_DONE && point->error < self->apart;
    }
    return EXIT_DONE;
}

/* ---- time ------------------------------------------------------------------- */

double compare_call_time(const compare *self, const compare_method *method)
{
    weft_stepper_config config;
    compare_point point = { 0 };
    weft_sim *sim = NULL;
    size_t rung = COMPARE_RUNGS;
    while (rung > 0 && method->points[rung - 1].outcome != COMPARE_DONE) {
        --rung;
    }
    if (rung == 0) {
        return 0.0;
    }
    const compare_point *middle = &method->points[(rung - 1) / 2];
    if (compare_is_implicit(method)) {
        return middle->outcome == COMPARE_DONE ? middle->time / (double)middle->calls
                                               : 0.0;
    }
    set_rung(self, method, (rung - 1) / 2, &config, &point);
    const double end = compare_time(self, self->last);
    weft_status status = create(self, &method->by, &config, &sim, NULL);
    const double began = work_clock(self);
    for (int i = 0;
         status == WEFT_OK && weft_sim_time(sim) < end
         && (i < CALL_TIME_LEAST || work_clock(self) - began < CALL_TIME_SLICE);
         ++i) {
        status = weft_sim_step(sim, end, NULL);
    }
    const double spent = work_clock(self) - began;
    const double calls
        = status == WEFT_OK ? (double)weft_sim_stats(sim).rhs_calls : INFINITY;
    weft_sim_destroy(sim);
    return spent / calls;
}
