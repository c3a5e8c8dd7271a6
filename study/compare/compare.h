/* SPDX-License-Identifier: BSD-3-Clause */
/* compare.h -- weft compare: the cost of every method on a scene, at every accuracy.
 *
 * Errors are distances [m] from a reference: the scene with the best method available
 * at COMPARE_TIGHTEST, checked by the best method of another plugin. Both, and a
 * perturbed displaced by COMPARE_NUDGE at the start, run first; the divergence of the
 * perturbed bounds the time that is compared. Then every method runs its ladder: of
 * tolerances, or of fixed steps, halved from its largest stable one on. Each reference
 * and each ladder has its own process, which writes its numbers to shared memory. One
 * process alone measures times per evaluation, last of all.
 *
 * Methods are ranked by time: what an implicit method does besides evaluations has no
 * other measure. */
#pragma once

#include <stdatomic.h>

#include "program/cli.h"
#include "program/run/progress.h"
#include "program/survey/survey.h"

enum {
    COMPARE_RUNGS = 9,
    COMPARE_DECADES = 9,
    COMPARE_FIRST = 2 /* 1e-2 is the tolerance of the first rung, 1e-3 of the next */
};

#define COMPARE_TIGHTEST 1e-12 /* tolerance of the reference */
#define COMPARE_NUDGE    1e-10 /* [m] */
#define COMPARE_GROWTH   1e4   /* of the nudge, up to which the scene is predictable */
#define COMPARE_PARTED   1e-4  /* [m] the same limit between the two references */
#define COMPARE_NEAR     10.0  /* times the error of the reference: not judged */
#define COMPARE_WORK     1e9 /* RHS calls times particles, of all runs but references */
/* Tolerance of velocities [m/s] by that of positions [m], of methods for stiff cloth:
 * with 1, the velocities of stiff modes set their steps. */
#define COMPARE_VELOCITY 100.0

typedef enum compare_outcome {
    COMPARE_NOT_RUN,
    COMPARE_RUNNING,
    COMPARE_DONE,
    COMPARE_EXPENSIVE, /* would take more calls than the budget */
    COMPARE_FAILED
} compare_outcome;

/* One run. */
typedef struct compare_point {
    compare_outcome outcome;
    double setting;  /* tolerance, or fixed step [s] */
    double error;    /* [m] largest distance of a particle in a frame */
    double rms;      /* [m] root mean square over particles and frames */
    double velocity; /* [m/s] largest, as `error` */
    double energy;   /* largest difference in a frame, part of the energy at play */
    uint64_t calls, steps, rejected;
    uint64_t work; /* in RHS calls, linear systems included: compare_work */
    double time;   /* [s] the run's own; if explicit, calls * call_time if known */
    char why[200]; /* FAILED */
} compare_point;

typedef struct compare_method {
    stepper_method by;
    bool own;           /* the scene's */
    double step;        /* [s] fixed step of the first rung; 0: adaptive */
    double step_calls;  /* RHS calls per step of this size */
    double call_time;   /* [s] per call, all overhead included; 0: unknown */
    char left_out[160]; /* why it has no ladder; "" if it has */
    compare_point points[COMPARE_RUNGS];
} compare_method;

/* Shared by the processes. */
typedef struct compare_shared {
    _Atomic size_t last; /* frame, lowered when the perturbed diverges */
    weft_error err[2];   /* of the references */
    sentence stiffness;  /* of the cloth, and the kind of method that it needs */
    /* [count], then the scene with its own method and settings: one point */
    compare_method methods[];
} compare_shared;

typedef struct compare {
    const arguments *given;
    const weft_scene *scene;
    weft_cloth *cloth;
    double *start;    /* of start_create */
    weft_run_def run; /* of the scene, up to --until */
    stepper_method by[2];
    size_t last;          /* frame up to which errors are judged */
    size_t planned;       /* frame up to which they should be */
    weft_stiffness modes; /* at the start */
    progress progress;    /* of the ladders */

    /* shared; frames of 6 N numbers, planned + 1 of them */
    compare_shared *shared;
    double *frames[2];  /* of the references */
    double *perturbed;  /* [m] its distance, by frames */
    double *energy;     /* [J] kinetic, elastic and gravitational, by frames */
    uint64_t *calls[2]; /* RHS calls of the references up to each frame */

    size_t count;    /* of methods */
    double at_play;  /* [J] range of the energy, or the largest kinetic */
    double apart;    /* [m] between the references */
    double growth;   /* [1/s] of the perturbed's distance */
    bool chaotic;    /* `last` is where the perturbed has parted, */
    bool parted;     /* or the references */
    size_t over;     /* of methods: their ladders */
    uint64_t budget; /* RHS calls of a run; not of `as_is` */
} compare;

/* ---- compare_run.c ---------------------------------------------------------- */

double compare_time(const compare *self, size_t frame); /* [s] */
const compare_point *compare_as_is(const compare *self);
extern const double compare_decades[]; /* 10^-k */
/* Whether a method solves linear systems, so that its RHS calls are not its cost. */
bool compare_is_implicit(const compare_method *method);
/* Whether its tolerance of velocities is COMPARE_VELOCITY times that of positions. */
bool compare_is_stiff(const weft_stepper_type *type);

/* process_def.work. Frames, energies and perturbed of by[0]; frames of by[1]. */
int compare_reference(void *ctx, size_t which);
/* Writes shared->stiffness: methods are run for it. */
int compare_stiffness(void *ctx, size_t unused);
/* The ladder of a method; past the last method: the scene as it is. */
int compare_ladder(void *ctx, size_t i);
/* The largest length of a difference of 3-vectors in n entries of three planes each;
 * INFINITY if one is not finite. Adds their squares to *square. */
double compare_farthest(const double *a, const double *b, size_t n, double *square);
/* [s] per call: measured for a moment, or of an implicit method that of a run of its
 * ladder; 0 if it fails. */
double compare_call_time(const compare *self, const compare_method *method);

/* ---- compare_advice.c ------------------------------------------------------- */

/* What a method takes to reach an accuracy: between two points of its ladder along a
 * straight line of logarithms. */
typedef struct compare_cost {
    const compare_method *method; /* NULL: none reaches it */
    double setting, calls, time;  /* time [s] */
} compare_cost;

typedef struct compare_rank {
    double accuracy;                /* [m] */
    compare_cost best, second, own; /* by time */
    compare_cost fewest;            /* evaluations, of explicit methods */
} compare_rank;

typedef struct compare_advice {
    size_t count;
    compare_rank ranks[COMPARE_DECADES];
} compare_advice;

bool compare_reach(const compare_method *method, double accuracy, compare_cost *out);
void compare_advise(const compare *self, compare_advice *out);
/* A rank, and the properties of the scene, in words. */
sentence compare_rank_text(const compare_rank *rank);
sentence compare_as_is_text(const compare *self);
sentence compare_horizon_text(const compare *self);
sentence compare_reference_text(const compare *self);

/* ---- compare_write.c -------------------------------------------------------- */

/* With --progress yaml: documents before anything is run and after all was. `failed`:
 * why, or NULL. */
void compare_begin(const compare *self, const char *directory);
void compare_end(const compare *self, const char *failed);
void compare_print(const compare *self, const compare_advice *advice);
weft_status compare_csv(const compare *self, const char *directory, weft_error *err);
weft_status compare_html(const compare *self, const compare_advice *advice,
                         const char *directory, weft_error *err);
