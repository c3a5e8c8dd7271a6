/* SPDX-License-Identifier: BSD-3-Clause */
/* stiff_methods.c -- estimates the gain of stabilised and implicit methods, and says
 * which kind a cloth needs. docs/guides/pick-an-integrator.md has the measurements
 * behind it.
 *
 * Explicit steps are bound by the stiffest mode, of frequency omega and damping ratio
 * zeta = tau omega / 2. A stabilised method needs evaluations like sqrt(radius / h):
 * its largest stable step is known exactly, and the method says how many stages that
 * takes. The steps of BDF follow the motion, whose time scales are those of the slowest
 * waves, n / omega, and of a fall by the width of the sheet, and the accuracy; each
 * costs as much as 50 to 100 evaluations. */
#include "program/reports.h"
#include "program/survey/survey.h"

#include <math.h>
#include <string.h>

static const double accuracies[STIFF_ACCURACIES] = { 1e-2, 1e-3 }; /* [m] */

#define LEAST_ZETA 0.5  /* of stabilised methods */
#define OVERDAMPED 2.0  /* zeta from which implicit methods pay on small cloth too */
#define LEAST_SIDE 64.0 /* particles, else */

/* What a step costs besides its evaluations, in evaluations. */
#define STEP_COST 0.5
/* Time of an adaptive run with a stabilised method, by that at its largest step. */
#define RKC_COST 1.5

/* BDF's cost in evaluations per simulated second at an error of 1e-2 m on a sheet of 1
 * m where omega / n is 56 1/s; fitted with bench/stiff.c to sheets of 1 m, 32 to 512
 * particles wide, and to scenes/tarpaulin.yaml, which is 2 m wide. */
#define BDF_COST     1e4
#define BDF_WAVES    56.0
#define BDF_STIFF    (1.0 / 3.0)
#define BDF_ACCURACY 0.5
#define BDF_WIDTH    1.5 /* wider sheets move slowly, and errors count by the width */

/* The time of stiff ros2 at rtol 1e-3 on triangles, linear iterations included, in
 * evaluations per simulated second: measured on the shipped scenes of triangles, within
 * a factor of 2 (docs/guides/pick-an-integrator.md). In contact its steps are ten times
 * shorter. A gain below LEAST_GAIN is within that uncertainty. */
#define ROS2_FREE    5e4
#define ROS2_CONTACT 5e5
#define LEAST_GAIN   2.0

/* Evaluations per simulated second, the other work included. */
static double cost(const survey_method *method)
{
    return (method->calls + STEP_COST) / method->step;
}

static bool is_explicit(const survey_method *method)
{
    return method->step > 0.0 && isfinite(method->step)
           && (method->type->flags & WEFT_STEPPER_STRUCTURE) == 0;
}

const survey_method *survey_find(const survey *of, const char *plugin, const char *name)
{
    for (size_t i = 0; i < of->count; ++i) {
        const survey_method *one = &of->methods[i];
        if (strcmp(one->plugin->id, plugin) == 0
            && strcmp(one->type->name, name) == 0) {
            return one;
        }
    }
    return NULL;
}

/* [m] The root of the area of a particle. */
static double spacing_of(const weft_cloth_def *cloth)
{
    const weft_mesh_def *mesh = cloth->mesh;
    double area = 0.0;
    if (mesh == NULL) {
        return sqrt(cloth->spacing[0] * cloth->spacing[1]);
    }
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const rest_triangle at = rest_triangle_of(mesh, t);
        area += rest_area(&at);
    }
    for (size_t k = 0; mesh->grids != NULL && k < mesh->part_count; ++k) {
        const weft_cloth_def *grid = mesh->grids[k];
        area += grid != NULL
                    ? (double)mesh->parts[k].count * grid->spacing[0] * grid->spacing[1]
                    : 0.0;
    }
    return sqrt(area / (double)mesh->vertices);
}

/* By trials, as far as there are any; else by estimates, and by the stable step of the
 * cheapest explicit method. */
static void set_implicit(const survey *of, const weft_cloth_def *cloth,
                         const survey_method *least, stiff_gains *out)
{
    out->touches = report_touches(cloth);
    out->implicit = out->touches ? ROS2_CONTACT : ROS2_FREE;
    out->least = least, out->against = cost(least);
    if (of->implicit.work > 0.0) {
        out->tried = &of->implicit;
        out->implicit = of->implicit.work;
    }
    if (of->explicit.work > 0.0) {
        out->both = true;
        out->least = of->explicit.method, out->against = of->explicit.work;
    }
}

stiff_gains stiff_gains_of(const survey *of, const weft_cloth_def *cloth)
{
    const double side = sqrt((double)weft_cloth_def_particles(cloth));
    const double width = side * spacing_of(cloth); /* [m] */
    const survey_method *least = NULL;
    /* the cheapest of order 2 and more: Euler's is stable on damped cloth, and useless
     */
    for (size_t i = 0; i < of->count; ++i) {
        const survey_method *one = &of->methods[i];
        if (is_explicit(one) && one->type->order >= 2
            && (least == NULL || cost(one) < cost(least))) {
            least = one;
        }
    }
    const survey_method *rkc
        = survey_find(of, "stiff", "rkc2"); /* measured for RKC_COST */
    stiff_gains out = { 0 };
    double w = 0.0,
           c = 0.0; /* the largest omega^2, the least damping that goes with it */
    for (size_t i = 0; i < of->modes.count; ++i) {
        const double *corner = of->modes.corners[i];
        c = corner[0] > w || (corner[0] == w && corner[1] < c) ? corner[1] : c;
        w = fmax(w, corner[0]);
    }
    out.omega = sqrt(w);
    out.zeta = w > 0.0 ? 0.5 * c / out.omega : 0.0;
    if (rkc != NULL && rkc->step > 0.0 && isfinite(rkc->step)) {
        out.rkc = rkc;
    }
    out.over = of->own != NULL && is_explicit(of->own) ? of->own : least;
    if (least == NULL || !(out.omega > 0.0)) {
        return out;
    }
    if (out.rkc != NULL && out.zeta >= LEAST_ZETA) {
        const double stages = RKC_COST * out.rkc->calls / out.rkc->step;
        out.stabilised = cost(least) / stages >= WORTH ? cost(out.over) / stages : 0.0;
    }
    out.ros2 = survey_find(of, "stiff", "ros2");
    out.multistep = survey_find(of, "cvode", "bdf");
    if (cloth->mesh != NULL && out.ros2 != NULL) {
        set_implicit(of, cloth, least, &out);
    }
    const bool may = cloth->mesh == NULL && out.multistep != NULL
                     && out.zeta >= (side < LEAST_SIDE ? OVERDAMPED : LEAST_ZETA);
    for (size_t i = 0; i < STIFF_ACCURACIES && may; ++i) {
        const double bdf = BDF_COST * pow(out.omega / side / BDF_WAVES, BDF_STIFF)
                           * pow(1e-2 / accuracies[i], BDF_ACCURACY)
                           / pow(width, BDF_WIDTH);
        const double gain = fmin(cost(least), cost(out.over)) / bdf;
        out.bdf[i] = gain >= WORTH ? cost(out.over) / bdf : 0.0;
    }
    return out;
}

/* ---- in words ---------------------------------------------------------------- */

/* With the key of the scene without which it could be chosen. */
static void say_method(const survey_method *method, sentence *out)
{
    say(out, "%s %s", method->plugin->id, method->type->name);
    if (method->refuses != NULL) {
        say(out, ", without %s,", method->refuses);
    }
}

static void say_gain(double gain, sentence *out)
{
    say(out, gain < 9.95 ? "%.1f x" : "%.0f x", gain);
}

/* The tolerances that a trial has shown to work are named. */
static void say_trial(const stiff_gains *gains, sentence *out)
{
    const survey_trial *tried = gains->tried;
    say(out, "in a trial of %.2g s%s, at rtol %g, atol %g m and %g m/s, ",
        tried->end - tried->from,
        tried->touches   ? " in contact"
        : gains->touches ? " in which the cloth does not touch yet"
                         : "",
        tried->rtol, tried->atol[0], tried->atol[1]);
}

static void say_implicit(const stiff_gains *gains, sentence *out)
{
    const double gain = gains->against / gains->implicit;
    say(out, "; ");
    if (gains->both) {
        say_trial(gains, out);
    }
    say(out, "%s %s%s takes %.2g evaluations per simulated second; ",
        gains->least->plugin->id, gains->least->type->name,
        gains->both ? "" : " at its stable step", gains->against);
    if (gains->tried != NULL && !gains->both) {
        say_trial(gains, out);
    }
    say_method(gains->ros2, out);
    say(out, "%s %.2g%s: ",
        gains->tried != NULL ? " takes the work of" : " at rtol 1e-3 the time of about",
        gains->implicit,
        gains->tried != NULL ? ""
        : gains->touches     ? " where the cloth touches (estimated)"
                             : " (estimated)");
    if (gain >= LEAST_GAIN) {
        say(out, "implicit methods gain about ");
        say_gain(gain, out);
    } else {
        say(out, "implicit methods do not pay");
    }
}

void stiff_say(const stiff_gains *gains, sentence *out)
{
    say(out, "stiffest mode: omega %.4g 1/s, damping ratio %.2g: %s", gains->omega,
        gains->zeta,
        gains->zeta >= 1.0          ? "over-damped"
        : gains->zeta >= LEAST_ZETA ? "damped"
                                    : "lightly damped");
    if (gains->implicit > 0.0) {
        say_implicit(gains, out);
    }
    if (!(gains->stabilised > 0.0) && !(gains->bdf[0] > 0.0)) {
        if (gains->implicit > 0.0) {
            return;
        }
        say(out, "; explicit methods: %s",
            gains->zeta < LEAST_ZETA
                ? "too little damping for others to gain"
                : "the cloth is too small or too soft for others to gain");
        return;
    }
    say(out, "; estimated, over %s %s: ", gains->over->plugin->id,
        gains->over->type->name);
    if (gains->stabilised > 0.0) {
        say_method(gains->rkc, out);
        say(out, " is ");
        say_gain(gains->stabilised, out);
        say(out, " faster for errors above 1e-4 m%s", gains->bdf[0] > 0.0 ? "; " : "");
    }
    for (size_t i = 0; i < STIFF_ACCURACIES && gains->bdf[i] > 0.0; ++i) {
        if (i == 0) {
            say_method(gains->multistep, out);
        }
        say(out, "%s", i == 0 ? " is " : ", ");
        say_gain(gains->bdf[i], out);
        say(out, "%s %.0e m", i == 0 ? " faster at" : " at", accuracies[i]);
    }
}
