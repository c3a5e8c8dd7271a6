/* SPDX-License-Identifier: BSD-3-Clause */
#include "cloth/contact.h"

#include <string.h>

#include "cloth/added.h"
#include "cloth/springs.h"

typedef double num;
#define NUM(a)          (a)
#define ROOT(a)         sqrt(a)
#define CHOOSE(t, a, b) ((t) ? (a) : (b))
#define LAW             static inline
#include "cloth/contact_law.h"

double weft__touch_energy(const weft_cloth *cloth, const weft__touch *touch)
{
    const weft_contact_def *law = &cloth->contact;
    const double z = touch->gap * (1.0 / law->thickness), s = 1.0 - z;
    const double e = 0.5 * law->stopping_speed * law->stopping_speed * touch->share;
    return z > 0.0 ? e * weft__power_of(s, law->exponent) * s * s / z
                   : (double)INFINITY;
}

void weft__touch_forces(const weft_contact_def *law, double friction,
                        weft__touch *touch)
{
    const law_touch of
        = law_press(law, friction, touch->gap, touch->share, touch->speed,
                    weft__dot(touch->slip, touch->slip), touch->steepness);
    touch->push = of.push, touch->factor = of.factor;
    touch->stiffness = of.stiffness, touch->drag = of.drag;
}

/* Of a particle at x with velocity v, whose gap is there. */
static void find_speeds(const weft__pose *pose, const double x[3], const double v[3],
                        weft__touch *touch)
{
    const double *g = touch->gradient;
    double moving[3];
    touch->steepness = touch->joined ? weft__length(g) : 1.0;
    weft__surface_velocity(pose, x, touch->surface);
    for (size_t k = 0; k < 3; ++k) {
        touch->normal[k] = g[k] * (1.0 / touch->steepness);
        moving[k] = v[k] - touch->surface[k];
    }
    touch->speed = weft__dot(moving, touch->normal);
    for (size_t k = 0; k < 3; ++k) {
        touch->slip[k] = moving[k] - touch->speed * touch->normal[k];
    }
}

static bool find_touch(weft__touches *at, size_t i)
{
    const size_t n = at->cloth->particles;
    const double *z = at->y + i;
    const double x[3] = { z[0], z[n], z[2 * n] };
    const double v[3] = { z[3 * n], z[4 * n], z[5 * n] };
    weft__touch *touch = &at->touch;
    touch->gap = weft__shape_gap(&at->pose, x, touch->gradient, &touch->joined);
    if (touch->gap >= at->cloth->contact.thickness) {
        return false;
    }
    at->i = i;
    touch->share = 1.0;
    find_speeds(&at->pose, x, v, touch);
    weft__touch_forces(&at->cloth->contact, at->pose.friction, touch);
    return true;
}

weft__touches weft__touches_of(const weft_cloth *cloth, double t, const double *y,
                               size_t first, size_t end)
{
    return (weft__touches){ .cloth = cloth,
                            .t = t,
                            .y = y,
                            .first = first,
                            .end = end,
                            .next = end,
                            .end_shape = cloth->shape_count };
}

bool weft__each_touch(weft__touches *at)
{
    const weft_cloth *cloth = at->cloth;
    for (;;) {
        while (at->next < at->end) {
            const size_t i = at->next++;
            if (cloth->pin[i] == 0 && find_touch(at, i)) {
                return true;
            }
        }
        if (at->shapes == at->end_shape) {
            return false;
        }
        at->pose = weft__pose_of(&cloth->shapes[at->shapes++], at->t);
        at->next = at->first;
    }
}

static void contact_add(const weft__subject *of, size_t i, weft__unit unit, double *to)
{
    const weft_cloth *cloth = of->cloth;
    const double scale = unit == WEFT__FORCE ? cloth->mass[i] : 1.0;
    for (weft__touches at = weft__touches_of(cloth, of->t, of->y, i, i + 1);
         weft__each_touch(&at);) {
        for (size_t k = 0; k < 3; ++k) {
            const double more = weft__touch_acceleration(&at.touch, k);
            to[k * cloth->particles] += at.touch.gap > 0.0 ? scale * more : (double)NAN;
        }
    }
}

static void contact_power(const weft__subject *of, size_t r, weft_measures *row)
{
    const size_t cols = of->cloth->cols;
    for (weft__touches at
         = weft__touches_of(of->cloth, of->t, of->y, r * cols, (r + 1) * cols);
         weft__each_touch(&at);) {
        const weft__touch *touch = &at.touch;
        const double m = of->cloth->mass[at.i];
        const double taken = touch->push * (1.0 - touch->factor) * touch->steepness;
        double work = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            work += weft__touch_acceleration(touch, k) * touch->surface[k];
        }
        row->power[WEFT_POWER_CONTACT] += m * (taken * touch->speed);
        row->power[WEFT_POWER_FRICTION]
            += m * (touch->drag * weft__dot(touch->slip, touch->slip));
        row->power[WEFT_POWER_SHAPES] += m * work;
    }
}

static double contact_damping(const weft_cloth *cloth, size_t i)
{
    (void)cloth, (void)i;
    return 0.0;
}

const weft__added weft__contact
    = { contact_add, contact_power, weft__contact_change, contact_damping };

void weft__row_contact_energy(const weft__subject *of, size_t r, weft_measures *row)
{
    const size_t cols = of->cloth->cols;
    for (weft__touches at
         = weft__touches_of(of->cloth, of->t, of->y, r * cols, (r + 1) * cols);
         weft__each_touch(&at);) {
        row->energy.contact
            += of->cloth->mass[at.i] * weft__touch_energy(of->cloth, &at.touch);
    }
}

/* ---- gaps ------------------------------------------------------------------------ */

static double gap_of(const weft__subject *of, const weft__pose *pose, size_t i)
{
    const size_t n = of->cloth->particles;
    const double x[3] = { of->y[i], of->y[n + i], of->y[2 * n + i] };
    return weft__gap_at(pose, x);
}

/* Whether particle i touches one of the first `count` shapes. */
static bool touches_any(const weft__subject *of, size_t i, size_t count)
{
    bool touches = false;
    for (size_t k = 0; k < count && !touches; ++k) {
        const weft__pose pose = weft__pose_of(&of->cloth->shapes[k], of->t);
        touches = gap_of(of, &pose, i) < of->cloth->contact.thickness;
    }
    return touches;
}

void weft__keep_gap(weft_measures *kept, double gap, size_t particle, size_t shape)
{
    if (!isnan(kept->gap) && !(gap >= kept->gap)) {
        kept->gap = gap;
        kept->gap_particle = particle;
        kept->gap_shape = shape;
    }
}

void weft__row_gap(const weft__subject *of, size_t r, weft_measures *row)
{
    const weft_cloth *cloth = of->cloth;
    for (size_t k = 0; k < cloth->shape_count; ++k) {
        const weft__pose pose = weft__pose_of(&cloth->shapes[k], of->t);
        for (size_t i = r * cloth->cols; i < (r + 1) * cloth->cols; ++i) {
            if (cloth->pin[i] == 0) {
                const double gap = gap_of(of, &pose, i);
                weft__keep_gap(row, gap, i, k);
                row->touching
                    += gap < cloth->contact.thickness && !touches_any(of, i, k);
            }
        }
    }
}

/* ---- loads ----------------------------------------------------------------------- */

/* What the particles of row r exert on shape k: its force, then its torque. */
static void add_row_load(const weft__subject *of, size_t r, size_t k, double load[6])
{
    const weft_cloth *cloth = of->cloth;
    const size_t n = cloth->particles;
    double sum[6] = { 0.0 };
    weft__touches at
        = weft__touches_of(cloth, of->t, of->y, r * cloth->cols, (r + 1) * cloth->cols);
    for (at.shapes = k, at.end_shape = k + 1; weft__each_touch(&at);) {
        double arm[3], f[3];
        for (size_t j = 0; j < 3; ++j) {
            arm[j] = of->y[j * n + at.i] - at.pose.at[j];
            f[j] = -cloth->mass[at.i] * weft__touch_acceleration(&at.touch, j);
            sum[j] += f[j];
        }
        for (size_t j = 0; j < 3; ++j) {
            const size_t a = (j + 1) % 3, b = (j + 2) % 3;
            sum[3 + j] += arm[a] * f[b] - arm[b] * f[a];
        }
    }
    for (size_t j = 0; j < 6; ++j) {
        load[j] += sum[j];
    }
}

void weft_cloth_shape_load(const weft_cloth *cloth, double t, const double *y, size_t k,
                           double force[3], double torque[3])
{
    const weft__subject of = { .cloth = cloth, .t = t, .y = y };
    double load[6] = { 0.0 };
    for (size_t r = 0; r < cloth->rows; ++r) {
        add_row_load(&of, r, k, load);
    }
    memcpy(force, load, 3 * sizeof *force);
    memcpy(torque, load + 3, 3 * sizeof *torque);
}
