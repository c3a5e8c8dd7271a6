/* SPDX-License-Identifier: BSD-3-Clause */
/* failure.c -- the state in which a step failed, for programs and as a message. */
#include <math.h>
#include <string.h>

#include "base/sized.h"
#include "cloth/model.h"
#include "mesh/surface.h"
#include "sim/bands.h"
#include "sim/holder.h"

static void find_fastest(const weft_sim *sim, weft_failure *out)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    const weft_comm *comm = sim->def.comm;
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t first = weft__block(mesh, mesh->band.above);
    const size_t end = weft__block(mesh, mesh->band.above + mesh->band.own);
    const double *x = sim->y, *v = sim->y + 3 * n;
    out->particle = first;
    for (size_t i = first; i < end; ++i) {
        const double speed
            = sqrt(v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        if (speed > out->speed) {
            out->speed = speed;
            out->particle = i;
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        out->position[k] = x[k * n + out->particle];
    }
    out->particle = weft__vertex_of(mesh, weft__whole_index(mesh, out->particle));
    (void)weft__bands_first(comm, weft__bands_max(comm, out->speed) == out->speed, out,
                            sizeof *out);
}

/* The first free particle, in the order of the definition, on which the own force of
 * the last evaluation is not finite. */
static void find_force(const weft_sim *sim, weft_failure *out)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t v = 0; sim->def.force != NULL && v < n; ++v) {
        const size_t i = weft__meant(mesh, v);
        const double f[3] = { sim->added[i], sim->added[n + i], sim->added[2 * n + i] };
        if (mesh->pin[i] == 0 && !weft__all_finite(f, 3)) {
            out->force = true;
            out->force_particle = v;
            memcpy(out->added, f, sizeof f);
            return;
        }
    }
}

/* A smaller strain is an error of rounding, which says nothing. */
#define ROUNDING 1e-9

/* What moves fastest or, if the own force is the reason, where it is not finite; "" at
 * rest. */
static void particle_text(const weft_failure *self, const weft_cloth *cloth, char *text,
                          size_t size)
{
    char name[64];
    const size_t i = self->force ? self->force_particle : self->particle;
    const char *who = weft_particle_text(cloth, i, name, sizeof name);
    const double *x = self->position, *f = self->added;
    text[0] = '\0';
    if (self->force) {
        (void)weft_text_format(
            text, size, "; the own force on %s is (%.3g, %.3g, %.3g) N, not finite",
            who, weft__unsigned_nan(f[0]), weft__unsigned_nan(f[1]),
            weft__unsigned_nan(f[2]));
    } else if (!(self->speed == 0.0)) {
        (void)weft_text_format(text, size,
                               "; fastest %s at (%.3g, %.3g, %.3g) m, %.3g m/s", who,
                               x[0], x[1], x[2], self->speed);
    }
}

static void spring_text(const weft_failure *self, const weft_cloth *cloth, char *text,
                        size_t size)
{
    const weft_spring *worst = &self->spring;
    char name[96];
    text[0] = '\0';
    if (worst->p == worst->q) {
        (void)weft_text_format(text, size, "; no springs");
    } else if (!(fabs(worst->strain) < ROUNDING)) {
        (void)weft_text_format(text, size, "; most strained %s at %.3g %%",
                               weft_spring_text(cloth, worst, name, sizeof name),
                               100.0 * worst->strain);
    }
}

/* Without what says nothing, as the speed of a first step that was refused. */
static void set_message(const weft_failure *self, const weft_cloth *cloth,
                        weft_error *err)
{
    char step[48] = "", spring[128], particle[192];
    if (self->last_step > 0.0) {
        (void)weft_text_format(step, sizeof step, ", last h = %.3g s", self->last_step);
    }
    particle_text(self, cloth, particle, sizeof particle);
    spring_text(self, cloth, spring, sizeof spring);
    weft_error_set(err, self->status,
                   "%s at t = %.9g s%s%s%s%s%s; energy %.4g J before that step",
                   self->reason, self->time, step, self->held[0] != '\0' ? "; " : "",
                   self->held, particle, spring, self->energy);
}

void weft__sim_not_finite(const weft_sim *sim, weft_error *why)
{
    static const char *const of[] = { "x", "y", "z", "vx", "vy", "vz" };
    const size_t n = sim->cloth->mesh.particles;
    char name[64];
    for (size_t j = 0; j < 6 * n; ++j) {
        const double value = sim->y[j % 6 * n + weft__meant(&sim->cloth->mesh, j / 6)];
        if (!isfinite(value)) {
            weft_error_set(
                why, WEFT_NOT_FINITE,
                "the correction left a state that is not finite: %s of %s is %g",
                of[j % 6], weft_particle_text(sim->cloth, j / 6, name, sizeof name),
                weft__unsigned_nan(value));
            return;
        }
    }
}

static void tell_holder(const weft_sim *sim, const weft_measures *now,
                        weft_failure *out)
{
    weft__holder of;
    weft__sim_find_holder(sim, now, &of);
    memcpy(out->held, of.text, sizeof out->held);
    out->held_by_contact = of.near.found;
    if (of.near.found && of.near.pair[0].count > 0) {
        memcpy(out->self_pair, of.near.pair, sizeof out->self_pair);
        out->gap = of.near.gap;
    } else if (of.near.found) {
        out->contact = true;
        out->gap = of.near.gap;
        out->gap_particle = of.near.particle;
        out->gap_shape = of.near.shape;
        out->other_shape = of.other_shape;
        out->other_gap = of.other_gap;
    }
}

weft_status weft__sim_fail(weft_sim *sim, const weft_error *why, weft_error *err)
{
    const weft_measures measures = weft_sim_measure(sim);
    const weft__mesh *mesh = &sim->cloth->mesh;
    weft_failure *failure = &sim->failure;
    *failure
        = (weft_failure){ .status = why->status,
                          .time = sim->t,
                          .last_step = weft_sim_stats(sim).last_step,
                          .spring = measures.worst,
                          .energy = weft_energy_total(measures.energy),
                          .contact = sim->guard.penetration.found
                                     && sim->guard.penetration.pair[0].count == 0 };
    if (sim->guard.penetration.found) {
        failure->gap_particle = weft__vertex_of(mesh, sim->guard.penetration.particle);
        failure->gap_shape = sim->guard.penetration.shape;
        for (size_t k = 0; k < 2; ++k) {
            failure->self_pair[k]
                = weft__primitive_of(mesh, sim->guard.penetration.pair[k]);
        }
        failure->gap = sim->guard.penetration.gap;
        failure->gap_step = sim->guard.penetration.t - sim->t;
    }
    find_force(sim, failure);
    if (!sim->guard.penetration.found && !failure->force
        && sim->config.fixed_step == 0.0
        && (why->status == WEFT_STEP_TOO_SMALL || why->status == WEFT_SOLVER)) {
        tell_holder(sim, &measures, failure);
    }
    (void)snprintf(failure->reason, sizeof failure->reason, "%s", why->message);
    find_fastest(sim, failure);
    set_message(failure, sim->cloth, err);
    return why->status;
}

bool weft_sim_failure_sized(const weft_sim *sim, weft_failure *out, size_t size)
{
    weft__sized_write(out, size, &sim->failure, sizeof sim->failure);
    return sim->failure.status != WEFT_OK;
}
