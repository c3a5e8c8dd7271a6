/* SPDX-License-Identifier: BSD-3-Clause */
/* motion.c -- prescribed motion, of pins and shapes:
 *
 *     x(t) = x0 + velocity (t - since) + amplitude sin(2 pi frequency t)
 *               + path(t) - path(0) */
#include <string.h>

#include "base/hash.h"
#include "mesh/mesh.h"
#include "weft/elementary.h"

weft__motion weft__motion_of(const double velocity[3], const double amplitude[3],
                             double frequency)
{
    weft__motion motion = { .frequency = frequency, .omega = WEFT__TWO_PI * frequency };
    memcpy(motion.velocity, velocity, sizeof motion.velocity);
    memcpy(motion.amplitude, amplitude, sizeof motion.amplitude);
    for (size_t k = 0; k < 3; ++k) {
        motion.moves = motion.moves || velocity[k] != 0.0
                       || (frequency > 0.0 && amplitude[k] != 0.0);
    }
    return motion;
}

weft__motion weft__pin_motion(const weft_pin *pin, double *rows)
{
    weft__motion motion
        = weft__motion_of(pin->velocity, pin->amplitude, pin->frequency);
    motion.path = weft__curve_make(&pin->path, pin->path_natural, rows);
    motion.moves = motion.moves || pin->path.count > 1;
    return motion;
}

void weft__motion_rate(const weft__motion *motion, double t, double piece,
                       double rate[6])
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
    if (motion->path.count > 0) {
        double path[3][3];
        weft__curve_at(&motion->path, t, piece, path);
        for (size_t k = 0; k < 3; ++k) {
            rate[k] += path[1][k];
            rate[k + 3] += path[2][k];
        }
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
    if (motion->path.count > 0) {
        double now[3][3], start[3][3];
        weft__curve_at(&motion->path, t, t, now);
        weft__curve_at(&motion->path, 0.0, 0.0, start);
        for (size_t k = 0; k < 3; ++k) {
            offset[k] += now[0][k] - start[0][k];
        }
    }
}

bool weft__motion_usable(const weft__motion *motion)
{
    bool can = true;
    for (size_t k = 0; k < 3; ++k) {
        can = can && isfinite(motion->omega * motion->omega * motion->amplitude[k]);
    }
    return can;
}

uint64_t weft__motion_hash(const weft__motion *motion, uint64_t hash)
{
    hash = weft__hash_reals(hash, motion->velocity, 3);
    hash = weft__hash_reals(hash, motion->amplitude, 3);
    hash = weft__hash_reals(hash, motion->path.rows,
                            WEFT__CURVE_WIDTH * motion->path.count);
    return weft__hash_real(hash, motion->omega);
}

void weft__pin_rate(const weft__mesh *mesh, size_t i, double t, double piece,
                    double rate[6])
{
    weft__motion motion = mesh->motions[mesh->pin[i] - 1];
    if (motion.coasts) {
        memcpy(motion.velocity, mesh->coast + 3 * i, sizeof motion.velocity);
    }
    weft__motion_rate(&motion, t, piece, rate);
}

void weft__jump_pins(const weft__mesh *mesh, double t, const double piece[2],
                     double factor, double *v)
{
    for (size_t j = 0; j < mesh->pinned; ++j) {
        const size_t i = mesh->pins[j];
        double before[6], after[6];
        if (mesh->motions[mesh->pin[i] - 1].path.jumps) {
            weft__pin_rate(mesh, i, t, piece[0], before);
            weft__pin_rate(mesh, i, t, piece[1], after);
            for (size_t k = 0; k < 3; ++k) {
                v[k * mesh->stride + i] += factor * (after[k] - before[k]);
            }
        }
    }
}

void weft__meet_pins(const weft__mesh *mesh, double t, double piece, double *v)
{
    for (size_t j = 0; j < mesh->pinned; ++j) {
        const size_t i = mesh->pins[j];
        if (weft__pin_meets(mesh, i)) {
            double rate[6];
            weft__pin_rate(mesh, i, t, piece, rate);
            for (size_t k = 0; k < 3; ++k) {
                v[k * mesh->stride + i] = rate[k];
            }
        }
    }
}

enum { KEPT = 8 }; /* motions whose rates a pass keeps */

void weft__move_pins(const weft__mesh *mesh, double t, double piece, double *to,
                     size_t stride, size_t first, size_t end)
{
    uint32_t kept[KEPT] = { 0 };
    double rates[KEPT][6];
    for (size_t j = 0; j < mesh->pinned; ++j) {
        const size_t i = mesh->pins[j];
        if (i < first || i >= end) {
            continue;
        }
        const uint32_t pin = mesh->pin[i], at = pin % KEPT;
        if (kept[at] != pin || mesh->motions[pin - 1].coasts) {
            kept[at] = pin;
            weft__pin_rate(mesh, i, t, piece, rates[at]);
        }
        for (size_t k = 0; k < 6; ++k) {
            to[k * stride + i - first] = rates[at][k];
        }
    }
}
