/* SPDX-License-Identifier: BSD-3-Clause */
/* prescribed.c -- the motion of pins and shapes:
 *
 *     x(t) = x0 + velocity (t - since) + amplitude sin(2 pi frequency t) */
#include <string.h>

#include "cloth/model.h"
#include "weft/elementary.h"

/* 2 pi, correctly rounded */
#define TWO_PI 6.283185307179586

weft__motion weft__motion_of(const double velocity[3], const double amplitude[3],
                             double frequency)
{
    weft__motion motion = { .frequency = frequency, .omega = TWO_PI * frequency };
    memcpy(motion.velocity, velocity, sizeof motion.velocity);
    memcpy(motion.amplitude, amplitude, sizeof motion.amplitude);
    for (size_t k = 0; k < 3; ++k) {
        motion.moves = motion.moves || velocity[k] != 0.0
                       || (frequency > 0.0 && amplitude[k] != 0.0);
    }
    return motion;
}

void weft__motion_rate(const weft__motion *motion, double t, double rate[6])
{
    const double w = motion->omega;
    double sine = 0.0, cosine = 1.0;
    if (w != 0.0) {
        weft_sincos_turns(motion->frequency, t, &sine, &cosine);
    }
    for (size_t k = 0; k < 3; ++k) {
        rate[k] = motion->velocity[k] + w * motion->amplitude[k] * cosine;
        rate[k + 3] = -w * w * motion->amplitude[k] * sine;
    }
}

void weft__motion_offset(const weft__motion *motion, double t, double offset[3])
{
    double sine = 0.0, cosine = 1.0;
    if (motion->omega != 0.0) {
        weft_sincos_turns(motion->frequency, t, &sine, &cosine);
    }
    for (size_t k = 0; k < 3; ++k) {
        offset[k]
            = motion->velocity[k] * (t - motion->since) + motion->amplitude[k] * sine;
    }
}
