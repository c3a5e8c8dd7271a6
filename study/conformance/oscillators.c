/* SPDX-License-Identifier: BSD-3-Clause */
#include "study/conformance/oscillators.h"

#include <time.h>

const double weft__model_start[DIM] = { 0.613, -0.387, 0.159, 0.271, 0.829, -0.443 };
const char *const weft__fault_names[FAULTS] = {
    "", "returns 1", "returns -1", "gives NaN", "gives infinity",
};

enum { PASSES = 256 }; /* each pass waits for the scheduler */

/* If a method lets only one thread step at a time, the other rhs is never called: the
 * baton is dropped after a while. */
static void pass(baton *self, int side)
{
    struct timespec until;
    (void)clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += 2;
    (void)pthread_mutex_lock(&self->lock);
    self->turn = 1 - side;
    self->dropped = self->dropped || ++self->passes >= PASSES;
    (void)pthread_cond_broadcast(&self->passed);
    while (self->turn != side && !self->dropped) {
        self->late = pthread_cond_timedwait(&self->passed, &self->lock, &until) != 0;
        self->dropped = self->dropped || self->late;
    }
    (void)pthread_mutex_unlock(&self->lock);
}

void weft__baton_drop(baton *self)
{
    (void)pthread_mutex_lock(&self->lock);
    self->dropped = true;
    (void)pthread_cond_broadcast(&self->passed);
    (void)pthread_mutex_unlock(&self->lock);
}

int weft__model_rhs(double t, const double *y, double *dydt, void *ctx)
{
    model *m = ctx;
    ++m->calls;
    memcpy(dydt, y + 3, 3 * sizeof *y);
    dydt[3] = -m->k * sin(2.385 * y[0]) + 0.713 * (y[1] - y[0]) - 0.131 * y[3];
    dydt[4]
        = -1.618 * y[1] * y[1] * y[1] + 0.713 * (y[0] - y[1]) + 0.257 * cos(1.37 * t);
    dydt[5] = -0.941 * y[2] + 0.318 * (y[1] - y[2]);
    if (m->single > 0) {
        memset(dydt + 3, 0, 3 * sizeof *dydt);
        dydt[2 + m->single] = -m->k * sin(2.385 * y[m->single - 1]);
    }
    if (m->baton != NULL) {
        pass(m->baton, m->side);
    }
    if ((m->edge > 0.0 && !(fabs(y[0]) < m->edge)) || (m->last > 0.0 && t > m->last)) {
        return 1;
    }
    const bool fails
        = m->fault != NO_FAULT && (m->once ? m->calls == m->at : m->calls >= m->at);
    const double rates[APART] = { 1.0, y[3], y[3] * y[4] };
    memcpy(dydt + DIM, rates, m->apart * sizeof *rates);
    if (fails && (m->fault == GIVE_NAN || m->fault == GIVE_INF)) {
        dydt[m->apart > 0 ? DIM + m->apart - 1 : 3]
            = m->fault == GIVE_NAN ? (double)NAN : (double)INFINITY;
    }
    return fails && m->fault == REFUSE ? 1 : fails && m->fault == STOP ? -1 : 0;
}

static int linearise(double t, const double *y, double *planes, double *blocks,
                     void *ctx)
{
    const model *m = ctx;
    const double k[9] = { 2.385 * m->k * cos(2.385 * y[0]) + 0.713,
                          -0.713,
                          0.0,
                          -0.713,
                          3.0 * 1.618 * y[1] * y[1] + 0.713,
                          0.0,
                          0.0,
                          -0.318,
                          0.941 + 0.318 };
    const double c[6] = { 0.131 };
    (void)t, (void)planes;
    memcpy(blocks, k, sizeof k);
    memcpy(blocks + 9, c, sizeof c);
    if (m->single > 0) {
        memset(blocks, 0, sizeof k + sizeof c);
        blocks[4 * (m->single - 1)] = 2.385 * m->k * cos(2.385 * y[m->single - 1]);
    }
    return 0;
}

size_t weft__no_modes(double t, const double *y, double (*corners)[2], size_t room,
                      void *ctx)
{
    (void)t, (void)y, (void)corners, (void)room, (void)ctx;
    return 0;
}

weft_structure weft__model_structure(model *of)
{
    static const double mass = 1.0, drag = 0.0;
    return (weft_structure){ .struct_size = sizeof(weft_structure),
                             .particles = 1,
                             .mass = &mass,
                             .drag = &drag,
                             .block_planes = WEFT_BLOCK_PLANES,
                             .linearise = linearise,
                             .modes = weft__no_modes,
                             .ctx = of };
}

double weft__model_distance(const double *a, const double *b)
{
    double top = 0.0;
    for (int i = 0; i < DIM; ++i) {
        top = fmax(top, isfinite(a[i]) ? fabs(a[i] - b[i]) : (double)INFINITY);
    }
    return top;
}

void weft__runge_kutta(const weft_ode *ode, double t, double h, double *y)
{
    double k[4][WEFT__DIM_MOST], z[WEFT__DIM_MOST];
    const double c[4] = { 0.0, 0.5, 0.5, 1.0 };
    for (int s = 0; s < 4; ++s) {
        for (size_t i = 0; i < ode->dim; ++i) {
            z[i] = y[i] + (s == 0 ? 0.0 : h * c[s] * k[s - 1][i]);
        }
        (void)ode->rhs(t + h * c[s], z, k[s], ode->ctx);
    }
    for (size_t i = 0; i < ode->dim; ++i) {
        y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
}

void weft__model_solve(double t, double t_end, double *y)
{
    model m = { .k = 1.0 };
    const weft_ode ode = { .dim = DIM, .rhs = weft__model_rhs, .ctx = &m };
    const double h = 0x1p-13;
    for (int i = 0; t + i * h < t_end; ++i) {
        weft__runge_kutta(&ode, t + i * h, h, y);
    }
}
