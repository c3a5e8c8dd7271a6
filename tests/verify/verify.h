/* SPDX-License-Identifier: BSD-3-Clause */
/* verify.h -- what is measured of every method of every plugin: the program behind
 * `make verify` prints it, tests/test_verification.c asserts it.
 *
 * Nothing here knows a method by name but the pairs of two libraries that have the same
 * table. Scenes are loaded and simulations made as `weft run` does it. */
#pragma once

#include "program/cli.h"
#include "weft/weft.h"

/* Every plugin beside the program or in WEFT_PLUGIN_PATH; NULL after printing why. */
weft_registry *verify_registry(void);

/* ---- runs.c ---------------------------------------------------------------------- */

enum { VERIFY_SETS = 6 };

/* A shipped scene and what is overridden in it. */
typedef struct verify_scene {
    const char *name;              /* scenes/NAME.yaml */
    const char *sets[VERIFY_SETS]; /* up to the first NULL */
} verify_scene;

/* What takes the place of the scene's own stepper. */
typedef struct verify_stepper {
    stepper_method method;
    double tolerance;  /* rtol and both atol */
    double fixed_step; /* [s]; 0: adaptive */
} verify_stepper;

typedef struct verify_size {
    size_t particles;
    double duration; /* [s] */
} verify_size;

/* As the scene has them; 0 if it does not load. */
verify_size verify_size_of(weft_registry *registry, const verify_scene *scene,
                           const verify_stepper *stepper);

typedef struct verify_frames {
    size_t count, dim;
    double *y;      /* count states of dim numbers */
    double *energy; /* [J] kinetic, gravitational and elastic, count of them */
    double kinetic; /* [J] the largest in a frame */
    bool limited;   /* the scene has a strain limit */
    bool touches;   /* its cloth touches itself */
    weft_stepper_stats stats;
} verify_frames;

/* The frames must be freed whatever is returned. */
weft_status verify_run(weft_registry *registry, const verify_scene *scene,
                       const verify_stepper *stepper, verify_frames *out,
                       weft_error *err);
void verify_frames_free(verify_frames *frames);
/* The largest difference of a number in any frame; INFINITY if one is not finite. */
double verify_distance(const verify_frames *a, const verify_frames *b);

/* ---- stages.c -------------------------------------------------------------------- */

#define VERIFY_STAGES_ROUNDOFF 1e-6 /* of a step */

/* When a method evaluates the forces of a step: from where to where, 0 and 1 at its
 * ends. */
weft_status verify_stages_of(const weft_stepper_type *type, double range[2],
                             weft_error *err);
bool verify_stages_outside(const double range[2]);

/* ---- accuracy.c ------------------------------------------------------------------ */

enum { VERIFY_SCENES = 3 };
#define VERIFY_ERROR_BOUND     50.0 /* times the tolerance */
#define VERIFY_REFERENCE_BOUND 0.1  /* the same */

/* Scenes that are smooth and not chaotic for as long as they run here: as shipped, or
 * with few particles. */
const verify_scene *verify_scene_at(size_t i, bool small);

/* What a method is judged at, and whether on few particles. */
double verify_tolerance(const weft_stepper_type *type);
bool verify_small(const weft_stepper_type *type);

/* The solution, by the best method there is, and by the best of another plugin. */
typedef struct verify_reference {
    verify_stepper by[2];
    verify_frames frames;
    double apart; /* how much the two differ */
} verify_reference;

/* WEFT_UNSUPPORTED if there are no two methods to compare. Must be freed whatever is
 * returned. */
weft_status verify_reference_make(weft_registry *registry, const verify_scene *scene,
                                  verify_reference *out, weft_error *err);
void verify_reference_free(verify_reference *reference);

typedef struct verify_accuracy {
    double error; /* the largest of a position [m] or velocity [m/s], / tolerance */
    weft_stepper_stats stats;
} verify_accuracy;

/* An adaptive method at its tolerance. */
weft_status verify_accuracy_of(weft_registry *registry, const verify_scene *scene,
                               const stepper_method *method,
                               const verify_reference *reference, verify_accuracy *out,
                               weft_error *err);

/* ---- pairs.c --------------------------------------------------------------------- */

enum { VERIFY_PAIR_STEPS = 1000 };
#define VERIFY_PAIR_BOUND 1e-12

/* One Butcher table in two plugins. */
typedef struct verify_pair {
    const char *names[2][2]; /* plugin, method */
} verify_pair;

const verify_pair *verify_pair_at(size_t i); /* NULL past the last */

/* How much they differ after VERIFY_PAIR_STEPS fixed steps on a cloth of 17 x 17,
 * relative to the largest number of the state. WEFT_UNSUPPORTED if a plugin is not
 * there. */
weft_status verify_pair_apart(weft_registry *registry, const verify_pair *pair,
                              double *apart, weft_error *err);

/* ---- shipped.c ------------------------------------------------------------------- */

/* A tenth of it for order 1, and for methods with a history of steps: a flag in the
 * wind amplifies what they lose at the same tolerance (bdf on pennant-cut after 0.27 s:
 * 6 % of the energy at 1e-3, below 0.05 % at 1e-4). */
#define VERIFY_SHIPPED_TOLERANCE 1e-3
#define VERIFY_ENERGY_BOUND      0.2

enum { VERIFY_NAME = 64, VERIFY_SHIPPED_MOST = 64, VERIFY_PARTICLES_MANY = 1000 };
#define VERIFY_WORK_ENOUGH 4000000 /* force evaluations times particles */

/* Names of all scenes/NAME.yaml, sorted; how many. */
size_t verify_shipped(char names[VERIFY_SHIPPED_MOST][VERIFY_NAME]);

/* Whether a method runs scenes whatever their damping; the others refuse most. */
bool verify_any_damping(const weft_stepper_type *type);

/* Not a method that needs damping, or with dense matrices of that many particles; nor a
 * multistep one where a strain limit restarts its history in every step. */
bool verify_shipped_suits(const weft_stepper_type *type,
                          const verify_frames *reference);

/* The run that others are compared with, by the method of the best reference, and the
 * scene they run for it: the whole, or the first of 0.05, 0.1, 0.2, ... s that takes
 * VERIFY_WORK_ENOUGH; in haste 0.05 s, with more than VERIFY_PARTICLES_MANY 0.01 s. */
weft_status verify_shipped_reference(weft_registry *registry, const char *name,
                                     bool haste, verify_scene *scene,
                                     verify_frames *out, weft_error *err);

typedef struct verify_shipped_result {
    double fixed_step; /* [s] found stable, for a method that cannot adapt; else 0 */
    uint64_t steps;
    double energy; /* largest difference in a frame, part of the energy at play */
} verify_shipped_result;

/* To the end: adaptive, or with the first of 2^-8, 2^-9, ... s that is stable. */
weft_status verify_shipped_run(weft_registry *registry, const verify_scene *scene,
                               const stepper_method *method,
                               const verify_frames *reference,
                               verify_shipped_result *out, weft_error *err);

/* ---- apart.c --------------------------------------------------------------------- */

typedef struct verify_counts {
    size_t judged, failed;
} verify_counts;

typedef void verify_part(void *ctx, size_t i, verify_counts *counts);

/* Parts 0 to count - 1, as many at once as there are processors; what they print comes
 * in their order, what they count is added up. False if one has died. */
bool verify_apart(size_t count, verify_part *print, void *ctx, verify_counts *counts);
