/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/step_check.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "cloth/shapes.h"
#include "cloth/springs.h"

/* Poses are found once for so many shapes, and particles looked at in blocks. */
enum { SHAPES = 8, BLOCK = 64 };

/* Of a correction, before it is given up. */
enum { HALVINGS = 60 };

/* A shape at both ends of a path. */
typedef struct passage {
    double h;       /* [s] */
    double between; /* [m/s] beyond what its velocity is at the ends */
    weft__pose pose[2];
} passage;

typedef struct path_check {
    const weft_cloth *cloth;
    const weft__path *path;
    atomic_bool failed;
} path_check;

/* With linear interpolation between its ends, V is off by at most h^2 / 8 max |V''|. */
static passage passage_of(const weft__shape *shape, const weft__path *path)
{
    const weft__motion *motion = &shape->motion;
    const double h = path->t1 - path->t0, turn = motion->omega * h;
    const double swing = sqrt(weft__dot(motion->amplitude, motion->amplitude));
    return (passage){ .h = h,
                      .between = swing * motion->omega * fmin(2.0, turn * turn / 8.0),
                      .pose = { weft__pose_of(shape, path->t0),
                                weft__pose_of(shape, path->t1) } };
}

/* [m^2/s^2] of a particle beside the surface, or beside a shape that does not spin. */
static double speed2(const weft__pose *pose, const double x[3], const double v[3])
{
    double surface[3], with[3], without[3];
    weft__surface_velocity(pose, x, surface);
    for (size_t k = 0; k < 3; ++k) {
        with[k] = v[k] - surface[k];
        without[k] = v[k] - pose->velocity[k];
    }
    return fmax(weft__dot(with, with), weft__dot(without, without));
}

/* gap: [m] at the end. */
static bool is_clear(const passage *of, const weft__path *path, size_t n, size_t i,
                     double *gap)
{
    const double *ends[2] = { path->y0 + i, path->y1 + i };
    double d[2], square = 0.0;
    for (size_t e = 0; e < 2; ++e) {
        const double *y = ends[e];
        const double x[3] = { y[0], y[n], y[2 * n] };
        const double v[3] = { y[3 * n], y[4 * n], y[5 * n] };
        d[e] = weft__gap_at(&of->pose[e], x);
        square = fmax(square, speed2(&of->pose[e], x, v));
    }
    *gap = d[1];
    return d[1] > 0.0 && of->h * (sqrt(square) + of->between) < d[0] + d[1];
}

/* Around both ends of all paths of a block. */
typedef struct ball {
    double centre[3], radius; /* [m] */
    double speed;             /* [m/s] no particle is faster at an end */
} ball;

static double fastest2(const double *v, size_t n, size_t count)
{
    double most = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double square
            = v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i];
        most = square > most ? square : most;
    }
    return most;
}

static ball ball_around(const weft__path *path, size_t n, size_t first, size_t count)
{
    const double *y0 = path->y0 + first, *y1 = path->y1 + first;
    ball out = { .speed = sqrt(fmax(fastest2(y0 + 3 * n, n, count),
                                    fastest2(y1 + 3 * n, n, count))) };
    double square = 0.0;
    for (size_t k = 0; k < 3; ++k, y0 += n, y1 += n) {
        double low = y0[0], high = low, low1 = y1[0], high1 = low1;
        for (size_t i = 0; i < count; ++i) {
            low = y0[i] < low ? y0[i] : low;
            high = y0[i] > high ? y0[i] : high;
            low1 = y1[i] < low1 ? y1[i] : low1;
            high1 = y1[i] > high1 ? y1[i] : high1;
        }
        low = fmin(low, low1), high = fmax(high, high1);
        out.centre[k] = 0.5 * (low + high);
        square += 0.25 * (high - low) * (high - low);
    }
    out.radius = sqrt(square);
    return out;
}

/* Whether the path is clear of the shape for all that is in the ball. */
static bool is_far(const passage *of, const ball *block, double thickness)
{
    double d[2], speed = 0.0;
    for (size_t e = 0; e < 2; ++e) {
        const weft__pose *pose = &of->pose[e];
        double arm2 = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            const double arm = block->centre[k] - pose->at[k];
            arm2 += arm * arm;
        }
        const double arm = sqrt(arm2) + block->radius;
        d[e] = weft__gap_at(pose, block->centre) - block->radius;
        speed = fmax(speed, sqrt(weft__dot(pose->velocity, pose->velocity))
                                + arm * sqrt(weft__dot(pose->spin, pose->spin)));
    }
    return d[1] > thickness
           && of->h * (block->speed + speed + of->between) < d[0] + d[1];
}

static bool block_clear(const path_check *of, const passage *shapes, size_t count,
                        size_t first, size_t end)
{
    const weft_cloth *cloth = of->cloth;
    const ball block = ball_around(of->path, cloth->particles, first, end - first);
    for (size_t k = 0; k < count; ++k) {
        if (is_far(&shapes[k], &block, cloth->contact.thickness)) {
            continue;
        }
        for (size_t i = first; i < end; ++i) {
            double gap;
            if (cloth->pin[i] == 0
                && !is_clear(&shapes[k], of->path, cloth->particles, i, &gap)) {
                return false;
            }
        }
    }
    return true;
}

static void check_band(void *ctx, size_t first_row, size_t end_row)
{
    path_check *of = ctx;
    const weft_cloth *cloth = of->cloth;
    const size_t end = end_row * cloth->cols;
    for (size_t k = 0; k < cloth->shape_count; k += SHAPES) {
        const size_t left = cloth->shape_count - k,
                     count = left < SHAPES ? left : SHAPES;
        passage shapes[SHAPES];
        for (size_t j = 0; j < count; ++j) {
            shapes[j] = passage_of(&cloth->shapes[k + j], of->path);
        }
        for (size_t i = first_row * cloth->cols; i < end; i += BLOCK) {
            if (atomic_load_explicit(&of->failed, memory_order_relaxed)
                || !block_clear(of, shapes, count, i,
                                i + BLOCK < end ? i + BLOCK : end)) {
                atomic_store(&of->failed, true);
                return;
            }
        }
    }
}

bool weft__path_clear(const weft__forces *forces, const weft__path *path)
{
    path_check of = { .cloth = forces->cloth, .path = path };
    weft__forces_bands(forces, check_band, &of);
    return !atomic_load(&of.failed);
}

weft__breach weft__path_breach(const weft_cloth *cloth, const weft__path *path)
{
    weft__breach out = { .t = path->t1 };
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        const passage shape = passage_of(&cloth->shapes[k], path);
        const size_t end = out.found ? out.particle : cloth->particles;
        for (size_t i = 0; i < end; ++i) {
            double gap;
            if (cloth->pin[i] == 0
                && !is_clear(&shape, path, cloth->particles, i, &gap)) {
                out = (weft__breach){ true, i, k, gap, path->t1 };
                break;
            }
        }
    }
    return out;
}

weft__breach weft__state_breach(const weft_cloth *cloth, double t, const double *y)
{
    weft__breach out = { .t = t };
    out.gap = weft_cloth_gap(cloth, t, y, &out.particle, &out.shape);
    out.found = out.gap <= 0.0;
    return out;
}

weft__breach weft__particle_breach(const weft_cloth *cloth, double t, const double *y,
                                   size_t i)
{
    const size_t n = cloth->particles;
    const double x[3] = { y[i], y[n + i], y[2 * n + i] };
    weft__breach out = { .particle = i, .gap = INFINITY, .t = t };
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&cloth->shapes[k], t);
        const double gap = weft__gap_at(&pose, x);
        if (gap < out.gap) {
            out.gap = gap, out.shape = k;
        }
    }
    out.found = out.gap <= 0.0;
    return out;
}

weft_status weft__breach_error(const weft_cloth *cloth, const weft__breach *breach,
                               const char *what, weft_error *err)
{
    return weft_error_set(
        err, WEFT_INVALID, "particle (%zu, %zu) %s %.3g mm inside shapes[%zu]",
        breach->particle / cloth->cols, breach->particle % cloth->cols, what,
        1e3 * fabs(breach->gap), breach->shape);
}

/* ---- corrections ----------------------------------------------------------------- */

typedef struct correction {
    const weft_cloth *cloth;
    double t;
    const double *from;
    double *y;
} correction;

/* All six numbers of a particle, `share` of the way from where they were. */
static void shorten(const correction *of, size_t i, double share)
{
    for (size_t j = i; j < 6 * of->cloth->particles; j += of->cloth->particles) {
        of->y[j] = of->from[j] + share * (of->y[j] - of->from[j]);
    }
}

/* The way is shorter than d0 + d1: so is each first part of it that is left by another
 * shape. */
static bool line_clear(const correction *of, const weft__pose *pose, size_t i)
{
    const size_t n = of->cloth->particles;
    const double *a = of->from + i, *b = of->y + i;
    const double x0[3] = { a[0], a[n], a[2 * n] }, x1[3] = { b[0], b[n], b[2 * n] };
    const double way[3] = { x1[0] - x0[0], x1[1] - x0[1], x1[2] - x0[2] };
    const double square = weft__dot(way, way);
    const double end = square == 0.0 ? 0.0 : weft__gap_at(pose, x1);
    return square == 0.0 || (end > 0.0 && sqrt(square) < weft__gap_at(pose, x0) + end);
}

static void hold_band(void *ctx, size_t first_row, size_t end_row)
{
    const correction *of = ctx;
    const weft_cloth *cloth = of->cloth;
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&cloth->shapes[k], of->t);
        for (size_t i = first_row * cloth->cols; i < end_row * cloth->cols; ++i) {
            for (int tries = 0; cloth->pin[i] == 0 && !line_clear(of, &pose, i);
                 ++tries) {
                shorten(of, i, tries < HALVINGS ? 0.5 : 0.0);
            }
        }
    }
}

void weft__hold_back(const weft__forces *forces, double t, const double *from,
                     double *y)
{
    correction of = { forces->cloth, t, from, y };
    weft__forces_bands(forces, hold_band, &of);
}
