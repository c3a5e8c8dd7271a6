/* SPDX-License-Identifier: BSD-3-Clause */
/* agreement.c -- a state of two models, each stepped by an instance of its own in its
 * own thread, against one instance that steps the whole. */
#include "study/conformance/trial.h"

#include <math.h>
#include <pthread.h>

enum { PARTS = 2, WHOLE = PARTS * DIM, GOOD = 4, STEPS = 12 };
enum call { CALL_RHS, CALL_MAX, CALL_RMS, CALL_NONE };
static const char *const call_names[]
    = { "calls rhs", "calls max", "calls rms", "is done" };

/* Where the parts wait for one another: each call of one meets the same call of the
 * other. Once they have parted nobody waits any more. */
typedef struct meeting {
    pthread_mutex_t lock;
    pthread_cond_t met;
    int present;
    uint64_t times;
    enum call calls[PARTS];
    double given[PARTS], top; /* times [s] of rhs; what is agreed on, or a sum */
    bool parted;
} meeting;

/* What a step came to. */
typedef struct outcome {
    weft_status status;
    double t, y[WHOLE];
    weft_stepper_stats stats;
    char message[sizeof((weft_error *)NULL)->message];
} outcome;

/* A run of the whole, or of one of its parts. */
typedef struct half_run {
    const trial *trial;
    meeting *meeting; /* NULL: of the whole */
    int side;
    model models[PARTS]; /* of a part: the first */
    weft_norm norm;
    weft_agree agree;
    weft_rms rms;
    weft_ode ode;
    void *self;
    outcome outcomes[STEPS];
} half_run;

/* Which calls fail, in which part. */
typedef struct disturbance {
    int part;
    fault kind;
    uint64_t at;
    bool once;
} disturbance;

static double meet(meeting *m, int side, enum call call, double mine)
{
    double top = mine;
    (void)pthread_mutex_lock(&m->lock);
    if (!m->parted) {
        m->calls[side] = call;
        m->given[side] = mine;
    }
    if (!m->parted && ++m->present < PARTS) {
        for (const uint64_t times = m->times; m->times == times;) {
            (void)pthread_cond_wait(&m->met, &m->lock);
        }
        top = m->top;
    } else if (!m->parted) {
        const double a = m->given[0], b = m->given[1];
        m->parted = m->calls[0] != m->calls[1] || (call == CALL_RHS && a != b);
        m->top = top = call == CALL_RMS       ? a + b
                       : isnan(a) || isnan(b) ? (double)NAN
                                              : fmax(a, b);
        m->present = 0;
        ++m->times;
        (void)pthread_cond_broadcast(&m->met);
    }
    (void)pthread_mutex_unlock(&m->lock);
    return top;
}

static double agreed(void *self, double mine)
{
    const half_run *r = self;
    return meet(r->meeting, r->side, CALL_MAX, mine);
}

static int part_rhs(double t, const double *y, double *dydt, void *ctx)
{
    half_run *r = ctx;
    (void)meet(r->meeting, r->side, CALL_RHS, t);
    return weft__model_rhs(t, y, dydt, &r->models[0]);
}

/* Part p of a whole, or of its velocities. */
static const double *part_of(const double *y, int p, double *part)
{
    memcpy(part, y + 3 * p, 3 * sizeof *y);
    memcpy(part + 3, y + 3 * (PARTS + p), 3 * sizeof *y);
    return part;
}

/* As weft_rms.of, with sums part by part. */
static double mean(void *self, const double *e, const double *w)
{
    half_run *r = self;
    const bool whole = r->meeting == NULL;
    double sums[PARTS] = { 0.0 };
    for (int i = 0; i < (whole ? WHOLE : DIM); ++i) {
        sums[whole ? i / 3 % PARTS : 0] += e[i] * w[i] * e[i] * w[i];
    }
    return sqrt(
        (whole ? sums[0] + sums[1] : meet(r->meeting, r->side, CALL_RMS, sums[0]))
        / WHOLE);
}

static void put_part(const double *part, int p, double *y)
{
    memcpy(y + 3 * p, part, 3 * sizeof *y);
    memcpy(y + 3 * (PARTS + p), part + 3, 3 * sizeof *y);
}

static int whole_rhs(double t, const double *y, double *dydt, void *ctx)
{
    half_run *r = ctx;
    int failed = 0;
    for (int p = 0; p < PARTS; ++p) {
        double part[DIM], rates[DIM];
        const int result
            = weft__model_rhs(t, part_of(y, p, part), rates, &r->models[p]);
        put_part(rates, p, dydt);
        failed = result < 0 || failed == 0 ? result : failed;
    }
    return failed;
}

static weft_status create(half_run *r, weft_error *err)
{
    const weft_stepper_type *type = r->trial->type;
    weft_stepper_config config
        = weft__with_table(type, weft__usual(type, r->trial->mode));
    const bool whole = r->meeting == NULL;
    r->agree = (weft_agree){ r, agreed };
    r->rms = (weft_rms){ r, mean };
    r->ode = (weft_ode){ whole ? WHOLE : DIM, whole ? whole_rhs : part_rhs, r };
    config.agree = whole ? NULL : &r->agree;
    config.norm = r->norm;
    config.rms = &r->rms;
    return type->create(type, &r->ode, &config, &r->self, err);
}

/* Good steps, then steps under the disturbance, then good ones again. */
static void *steps(void *run)
{
    half_run *r = run;
    const weft_stepper_type *type = r->trial->type;
    double t = 0.0, y[WHOLE];
    for (int p = 0; p < PARTS; ++p) {
        put_part(weft__model_start, p, y);
    }
    if (r->meeting != NULL) {
        memcpy(y, weft__model_start, sizeof weft__model_start);
    }
    const model before[PARTS] = { r->models[0], r->models[1] };
    for (int i = 0; i < STEPS; ++i) {
        outcome *o = &r->outcomes[i];
        weft_error err = { 0 };
        for (int p = 0; p < PARTS; ++p) {
            model *m = &r->models[p];
            m->fault = i >= GOOD && i < 2 * GOOD ? before[p].fault : NO_FAULT;
            m->at = i == GOOD ? m->calls + before[p].at : m->at;
        }
        o->status = type->step(r->self, 1.0, &t, y, &err);
        o->t = t;
        memcpy(o->y, y, r->ode.dim * sizeof *y);
        memcpy(o->message, err.message, sizeof err.message);
        o->stats.struct_size = sizeof o->stats;
        type->stats(r->self, &o->stats);
        if (i % 6 == 2) { /* of the second part alone */
            y[r->meeting == NULL ? 3 : 0]
                += r->meeting == NULL || r->side == 1 ? 0.01 : 0.0;
        }
        if (i % 3 == 2) {
            type->state_changed(r->self);
        }
    }
    if (r->meeting != NULL) {
        (void)meet(r->meeting, r->side, CALL_NONE, 0.0);
    }
    return NULL;
}

/* Runs the whole and the parts; false if there is no instance or no thread. */
static bool run_all(half_run *whole, half_run parts[], weft_error *err)
{
    const weft_stepper_type *type = whole->trial->type;
    pthread_t thread;
    bool ready = create(whole, err) == WEFT_OK && create(&parts[0], err) == WEFT_OK
                 && create(&parts[1], err) == WEFT_OK;
    ready = ready && pthread_create(&thread, NULL, steps, &parts[1]) == 0;
    if (ready) {
        (void)steps(&parts[0]);
        (void)pthread_join(thread, NULL);
        (void)steps(whole);
    }
    type->destroy(whole->self);
    type->destroy(parts[0].self);
    type->destroy(parts[1].self);
    return ready;
}

static void expect_part(trial *self, const half_run *whole, const half_run *part, int i,
                        const char *what)
{
    const outcome *w = &whole->outcomes[i], *o = &part->outcomes[i];
    double y[DIM];
    EXPECT(o->status == w->status
               && (o->status == WEFT_OK || strcmp(o->message, w->message) == 0),
           "%s: step %d returned '%s' (%s), that of the whole '%s' (%s)", what, i + 1,
           weft_status_text(o->status), o->message, weft_status_text(w->status),
           w->message);
    EXPECT(memcmp(&o->t, &w->t, sizeof o->t) == 0,
           "%s: step %d ended at %.*g s, that of the whole at %.*g s", what, i + 1,
           weft_text_digits(o->t), o->t, weft_text_digits(w->t), w->t);
    EXPECT(memcmp(o->y, part_of(w->y, part->side, y), sizeof y) == 0,
           "%s: step %d has another result than that of the whole", what, i + 1);
    EXPECT(o->stats.steps == w->stats.steps && o->stats.rejected == w->stats.rejected,
           "%s: after step %d, %" PRIu64 " steps and %" PRIu64
           " rejected; of the whole %" PRIu64 " and %" PRIu64,
           what, i + 1, o->stats.steps, o->stats.rejected, w->stats.steps,
           w->stats.rejected);
    EXPECT(o->stats.rhs_calls == w->stats.rhs_calls,
           "%s: %" PRIu64 " rhs_calls after step %d, of the whole %" PRIu64, what,
           o->stats.rhs_calls, i + 1, w->stats.rhs_calls);
}

static void try_parts(trial *self, weft_norm norm, disturbance d)
{
    meeting m = { .present = 0 };
    half_run whole = { .trial = self, .norm = norm }, parts[PARTS];
    char what[80] = "two parts";
    weft_error err = { 0 };
    for (int p = 0; p < PARTS; ++p) {
        whole.models[p] = (model){ .k = 1.0 + 8.0 * p, .at = d.at, .once = d.once };
        whole.models[p].fault = d.part == p ? d.kind : NO_FAULT;
        parts[p] = (half_run){ .trial = self, .norm = norm, .meeting = &m, .side = p };
        parts[p].models[0] = whole.models[p];
    }
    if (d.kind != NO_FAULT) {
        (void)snprintf(what, sizeof what, "rhs of part %d %s %s call %" PRIu64 " %s",
                       d.part + 1, weft__fault_names[d.kind], d.once ? "in" : "from",
                       d.at, d.once ? "of a step" : "of a step on");
    }
    (void)pthread_mutex_init(&m.lock, NULL);
    (void)pthread_cond_init(&m.met, NULL);
    const bool ran = run_all(&whole, parts, &err);
    (void)pthread_cond_destroy(&m.met);
    (void)pthread_mutex_destroy(&m.lock);
    EXPECT(ran, "no instance with agree, or no thread: %s", err.message);
    EXPECT(!m.parted, "%s: one %s, t = %.9g s, while the other %s", what,
           call_names[m.calls[0]], m.given[0], call_names[m.calls[1]]);
    for (int i = 0; i < STEPS; ++i) {
        expect_part(self, &whole, &parts[0], i, what);
        expect_part(self, &whole, &parts[1], i, what);
    }
}

const char *weft__agrees_with_nobody(const weft_stepper_type *type)
{
    return (type->flags & (uint32_t)WEFT_STEPPER_DISTRIBUTED) == 0
               ? "the method integrates whole states only"
           : weft__needs_structure(type) ? "it needs the structure of each part"
                                         : NULL;
}

void weft__parts_agree(trial *self)
{
    const uint64_t calls[] = { 1, 2, 3, 6, 9 };
    for (weft_norm norm = WEFT_NORM_MAX; norm <= WEFT_NORM_RMS; ++norm) {
        try_parts(self, norm, (disturbance){ .kind = NO_FAULT });
        for (fault kind = REFUSE; kind < FAULTS; ++kind) {
            for (int i = 0; i < 4 * (int)(sizeof calls / sizeof *calls); ++i) {
                try_parts(self, norm,
                          (disturbance){ i % 2, kind, calls[i / 4], i / 2 % 2 != 0 });
            }
        }
    }
}
