/* SPDX-License-Identifier: BSD-3-Clause */
/* survey.h -- what methods cost on a cloth: their stable steps, and whether a
 * stabilised or an implicit one will pay. For weft check, run and compare. */
#pragma once

#include <math.h>

#include "base/part.h"
#include "base/plane.h"
#include "program/cli.h"

#define WORTH 1.2 /* the least saving of evaluations that is reported */

/* What a method costs on a cloth if stability alone limits its step. */
typedef struct survey_method {
    const weft_plugin *plugin;
    const weft_stepper_type *type;
    double step;       /* [s] up to which no mode grows; 0: the method has none */
    bool doubling;     /* undamped ones do, as no step of the method is stable on them:
                          the step at which none more than doubles in the run */
    double calls;      /* RHS calls per step */
    double per_second; /* RHS calls per simulated second at that step */
    const char *refuses; /* the key of the scene that excludes it; NULL: none does */
} survey_method;

/* A trial of a method (trials.c). */
typedef struct survey_trial {
    const survey_method *method;
    double work;          /* in evaluations per simulated second; 0: not known */
    double from, end;     /* [s] of the part of the trial that it is of */
    bool touches;         /* in that part, from its start on */
    double rtol, atol[2]; /* [m], [m/s] */
} survey_trial;

typedef struct survey {
    bool refined;
    weft_stiffness now, any; /* guaranteed: in the first state; in whatever state */
    weft_stiffness modes;    /* behind the steps: now, refined on request */
    survey_method *methods;  /* the cheapest first, those without a step last */
    size_t count;
    const survey_method *own;   /* the scene's; NULL: its plugin is not there */
    survey_method any_state;    /* the scene's method in whatever state */
    size_t trial_steps;         /* of that method under its tolerances; 0: no trial */
    double trial_held;          /* part of them limited by stability */
    double trial_mean;          /* [s] */
    double trial_calls;         /* RHS calls per simulated second */
    const survey_method *rival; /* of higher order, tried too; NULL: no or no better */
    double rival_saves;         /* trial's RHS calls / those that it took */
    survey_trial implicit, explicit; /* of triangles, at the same tolerances */
} survey;

/* sim is of the scene, at t = 0 with that start (of start_create), and is used up by
 * the trial; NULL: no trial, and `now` holds in any state. */
weft_status survey_create(const weft_scene *scene, const weft_cloth *cloth,
                          weft_sim *sim, const double *start, const arguments *given,
                          survey *out, weft_error *err);
void survey_destroy(survey *self);

/* Only the methods, by the modes of the survey. */
weft_status survey_methods(const weft_scene *scene, const weft_registry *registry,
                           survey *out, weft_error *err);

/* Part of the trial's steps limited by stability; 0 without a stable step. */
double survey_held(const survey *of);

/* Type, step, doubling and calls of one method. WEFT_UNSUPPORTED: it has no stable
 * step. */
weft_status stable_step(const weft_scene *scene, const weft_stepper_type *type,
                        const weft_stiffness *modes, survey_method *out,
                        weft_error *err);

/* [s] The stable step of the scene's method; 0: it has none. */
double own_stable_step(const weft_scene *scene, const weft_stiffness *modes);

/* [s] The step to advise, from the stable steps at the start and in any state (0: not
 * known): shorter than both, so that two digits of it are. And what it is stable in,
 * as "which is stable in any state". */
double advised_step(double start, double any);
const char *advised_for(double any);

/* Which bound of the modes limits the stable step of the scene's method, in words. */
const char *limiting_bound(const weft_scene *scene, const weft_stiffness *modes);

/* The number of fixed steps of h [s] in a frame: none crosses its end. */
double frame_steps(const weft_run_def *run, double h);

/* [s] The longest step of a run with a fixed step, as frames cut it; 0: adaptive. */
double step_taken(const weft_scene *scene);

/* RHS calls per simulated second of a method in fixed steps of h [s]. */
double calls_per_second(const weft_scene *scene, const survey_method *method, double h);

/* Whether the scene's fixed step is beyond the stable one of the present state. Warns
 * on stderr unless quiet. */
bool stability_warn(const weft_scene *scene, const weft_sim *sim, bool quiet);

/* The places of the corners of a triangle in its rest shape [m]. */
/* The number of the one of several cloths that has a vertex, and its name; "" of one
 * cloth. */
WEFT__PART_OF(part_of, weft_mesh_def)

static inline const char *cloth_of(const weft_mesh_def *mesh, size_t vertex)
{
    return mesh->part_count > 0 ? mesh->parts[part_of(mesh, vertex)].name : "";
}

typedef struct rest_triangle {
    double corners[3][2];
} rest_triangle;

/* In its own plane, of a triangle that rests in space. */
static inline void lay_triangle(const weft_mesh_def *mesh, size_t t, double to[3][2])
{
    const double *from = mesh->space != NULL ? mesh->space : mesh->start;
    double side[2][3], square = 0.0, dot = 0.0, other = 0.0;
    for (size_t j = 0; j < 6; ++j) {
        const size_t k = j / 3, m = j % 3;
        side[k][m] = from[3 * (size_t)mesh->corners[3 * t + 1 + k] + m]
                     - from[3 * (size_t)mesh->corners[3 * t] + m];
    }
    for (size_t m = 0; m < 3; ++m) {
        square += side[0][m] * side[0][m];
        dot += side[0][m] * side[1][m];
        other += side[1][m] * side[1][m];
    }
    const double base = sqrt(square), along = dot / base;
    to[0][0] = to[0][1] = to[1][1] = 0.0;
    to[1][0] = base, to[2][0] = along;
    to[2][1] = sqrt(fmax(0.0, other - along * along));
}

static inline rest_triangle rest_triangle_of(const weft_mesh_def *mesh, size_t t)
{
    const uint32_t *places = mesh->corner_uv != NULL ? mesh->corner_uv : mesh->corners;
    const size_t part = part_of(mesh, mesh->corners[3 * t]);
    rest_triangle at = { .corners = { { 0.0 } } };
    if (mesh->rests != NULL && mesh->rests[part].shape == WEFT_REST_START) {
        lay_triangle(mesh, t, at.corners);
        return at;
    }
    for (size_t k = 0; k < 3; ++k) {
        const double *from = &mesh->rest[2 * (size_t)places[3 * t + k]];
        at.corners[k][0] = from[0], at.corners[k][1] = from[1];
    }
    return at;
}

static inline double rest_area(const rest_triangle *of) /* [m^2] */
{
    return 0.5 * fabs(weft__plane_turn(of->corners[0], of->corners[1], of->corners[2]));
}

/* trials.c: tries a method from a start (NULL: of the cloth) on, in the part of the
 * motion of another trial that has found its work, or as far as that is NULL. A method
 * that refuses the scene leaves its work unknown. */
weft_status try_method(const weft_scene *scene, const weft_cloth *cloth,
                       const survey_method *method, const double *start,
                       const survey_trial *other, survey_trial *out, weft_error *err);

/* ---- stiff_methods.c: estimates, not bounds ---- */

/* NULL: the method is not there. */
const survey_method *survey_find(const survey *of, const char *plugin,
                                 const char *name);

enum { STIFF_ACCURACIES = 2 };

/* A gain is the time of an explicit method by that of the other one; 0: no gain is to
 * be expected. */
typedef struct stiff_gains {
    double omega, zeta;        /* [1/s] of the stiffest mode, and its damping ratio */
    const survey_method *over; /* explicit, the scene's own if it is; NULL: none */
    const survey_method *rkc;  /* NULL: there is none, or it refuses the cloth */
    double stabilised;         /* of rkc */
    double bdf[STIFF_ACCURACIES]; /* of a grid: at 1e-2 m, at 1e-3 m */
    const survey_method *multistep,
        *ros2;       /* cvode bdf and stiff ros2; NULL: not there */
    double implicit; /* of triangles: the time of stiff ros2, in evaluations per
                        simulated second; 0: unknown */
    bool touches;    /* there are shapes, or contact of the cloth with itself */
    const survey_trial *tried;  /* behind `implicit`; NULL: an estimate is */
    const survey_method *least; /* explicit */
    double against;             /* its evaluations per simulated second */
    bool both;                  /* by a trial like the implicit method's */
} stiff_gains;

/* From the methods of a survey, the modes behind their steps and the cloth's width. */
stiff_gains stiff_gains_of(const survey *of, const weft_cloth_def *cloth);

/* "stiffest mode: omega 5657 1/s, damping ratio zeta 1.4: over-damped; ..." */
void stiff_say(const stiff_gains *gains, sentence *out);
