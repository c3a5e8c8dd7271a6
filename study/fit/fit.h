/* SPDX-License-Identifier: BSD-3-Clause */
/* fit.h -- weft fit: the parameters of a scene with which its particles follow measured
 * tracks, or its shadow at the end has a measured outline. The sum of squares of
 * (x - data) / sigma is minimised over the logarithms of the parameters by Levenberg
 * and Marquardt's method (MINPACK's lmder), whose Jacobian is the scene's
 * `sensitivity`; first over an eighth of the data's time, then over a quarter, half and
 * all of it, because from afar the whole has other minima (docs/guides/gradients.md).
 */
#pragma once

#include "program/cli.h"
#include "study/shadow.h"
#include "weft/elementary.h"

/* Where a particle was seen, NaN: a coordinate that is missing; or how far from the
 * origin the outline, which is x[0] alone. */
typedef struct fit_point {
    double time, angle;     /* [s]; of an outline [degrees], from 0 to 360 */
    size_t particle, line;  /* of positions; of the file */
    double x[3], fitted[3]; /* [m] */
    double direction[2];    /* of the angle: cosine and sine */
    shadow_point edge;      /* of the cloth, which is there */
} fit_point;

typedef struct fit {
    const arguments *given;
    weft_scene *scene; /* with `sensitivity` of the parameters; their start values */
    size_t particles;
    const char **sets; /* of sensitivities, those given, of parameters */
    char differentiate[1024], values[WEFT_SENSITIVITIES][128];
    double sigma; /* [m] */

    shadow shadow;     /* of an outline; else it has no ends */
    fit_point *points; /* by time and angle */
    size_t point_count, coordinates;
    size_t now, rows; /* how many of the points are compared, and coordinates */

    size_t parameters, runs;
    double at[WEFT_SENSITIVITIES]; /* logarithms, less those of the start: of the run
                                      whose results are below */
    double *residuals, *jacobian;  /* (x - data) / sigma; d/d log p, columns */
    double *room;                  /* of all particles */
    bool known, stale;             /* there was such a run; it was of other points */
    weft_error err;                /* or why not */
    bool converged;

    double singular[WEFT_SENSITIVITIES], /* values of the Jacobian, per unit of log p */
        direction[WEFT_SENSITIVITIES][WEFT_SENSITIVITIES],
        covariance[WEFT_SENSITIVITIES][WEFT_SENSITIVITIES]; /* of the logarithms */
} fit;

/* fit_data.c: DATA.csv, or an outline. WEFT_IO with its line. */
weft_status fit_read(fit *self, const char *file, weft_error *err);

/* fit_write.c: fit.yaml, fit.svg, and the parameters to stdout. */
weft_status fit_write(const fit *self, const char *directory, weft_error *err);

/* p */
static inline double fit_value(const fit *self, size_t j)
{
    const double start = weft_scene_sensitivities(self->scene)->values[j];
    return start * weft_pair_exp((weft_pair){ self->at[j], 0.0 });
}

static inline double fit_chi2(const fit *self)
{
    double sum = 0.0;
    for (size_t r = 0; r < self->rows; ++r) {
        sum += self->residuals[r] * self->residuals[r];
    }
    return sum;
}
