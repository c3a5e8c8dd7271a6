/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/rigid.h"

#include <string.h>

#include "base/hash.h"
#include "weft/elementary.h"

#define TURNS_PER_RADIAN 0.15915494309189535 /* 1 / (2 pi) */

weft__rigid_motion weft__rigid_motion_of(const weft__motion *motion,
                                         const weft_turn *turn, const double at[3])
{
    weft__rigid_motion of = { .motion = *motion, .turn = *turn };
    const double length = sqrt(weft__dot(turn->axis, turn->axis));
    of.turns = length > 0.0;
    for (size_t k = 0; k < 3; ++k) {
        of.turn.axis[k] = of.turns ? turn->axis[k] / length : 0.0;
    }
    if (isnan(turn->about[0]) || !of.turns) {
        memcpy(of.turn.about, at, sizeof of.turn.about);
    }
    return of;
}

weft__matrix weft__matrix_of(const double q[4])
{
    weft__matrix out;
    const double square = weft__dot(q, q) + q[3] * q[3];
    const double twice = square > 0.0 ? 2.0 / square : 0.0;
    for (size_t r = 0; r < 3; ++r) {
        const size_t a = (r + 1) % 3, b = (r + 2) % 3;
        out.row[r][r] = 1.0 - twice * (q[a] * q[a] + q[b] * q[b]);
        out.row[r][a] = twice * (q[r] * q[a] - q[3] * q[b]);
        out.row[r][b] = twice * (q[r] * q[b] + q[3] * q[a]);
    }
    return out;
}

void weft__quaternion_times(const double a[4], const double b[4], double out[4])
{
    double cross[3];
    weft__cross(a, b, cross);
    for (size_t k = 0; k < 3; ++k) {
        out[k] = a[3] * b[k] + b[3] * a[k] + cross[k];
    }
    out[3] = a[3] * b[3] - weft__dot(a, b);
}

weft__rigid weft__rigid_at(const weft__rigid_motion *of, double t)
{
    const weft_turn *turn = &of->turn;
    weft__rigid now = { .turns = of->turns, .quaternion = { 0.0, 0.0, 0.0, 1.0 } };
    double offset[3], rate[6];
    weft__motion_offset(&of->motion, t, offset);
    weft__motion_rate(&of->motion, t, t, rate);
    for (size_t k = 0; k < 3; ++k) {
        now.about[k] = turn->about[k] + offset[k];
        now.velocity[k] = rate[k];
    }
    if (of->turns) {
        double sine, cosine;
        weft_sincos_turns(turn->frequency, t, &sine, &cosine);
        const double swing = turn->amplitude * WEFT__TWO_PI * turn->frequency;
        const double angle
            = turn->rate * (t - of->motion.since) + turn->amplitude * sine;
        double half;
        weft_sincos_turns(0.5 * TURNS_PER_RADIAN * angle, 1.0, &half,
                          &now.quaternion[3]);
        for (size_t k = 0; k < 3; ++k) {
            now.quaternion[k] = half * turn->axis[k];
            now.omega[k] = (turn->rate + swing * cosine) * turn->axis[k];
        }
    }
    now.rotation = weft__matrix_of(now.quaternion);
    return now;
}

double weft__rigid_fastest(const weft__rigid_motion *of)
{
    const weft_turn *turn = &of->turn;
    return of->turns ? fabs(turn->rate)
                           + fabs(turn->amplitude) * WEFT__TWO_PI * turn->frequency
                     : 0.0;
}

double weft__rigid_swing(const weft__rigid_motion *of)
{
    const double w = WEFT__TWO_PI * of->turn.frequency;
    return of->turns ? w * w * fabs(of->turn.amplitude) : 0.0;
}

bool weft__rigid_usable(const weft__rigid_motion *of)
{
    const double most = weft__rigid_fastest(of) + weft__rigid_swing(of);
    return weft__motion_usable(&of->motion) && isfinite(most * most);
}

uint64_t weft__rigid_hash(const weft__rigid_motion *of, uint64_t hash)
{
    const weft_turn *turn = &of->turn;
    hash = weft__motion_hash(&of->motion, hash);
    if (!of->turns) {
        return hash;
    }
    hash = weft__hash_reals(weft__hash_reals(hash, turn->axis, 3), turn->about, 3);
    return WEFT__HASH_NUMBERS(hash, turn->rate, turn->amplitude, turn->frequency);
}
