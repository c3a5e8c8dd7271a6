/* SPDX-License-Identifier: BSD-3-Clause */
/* piece.c -- steps within a piece of tables and keys (mesh/track.h). No step passes the
 * time of a row or a key. For all that is evaluated for a step, the forces know its
 * piece; where it ends, the pins of natural splines may jump to another velocity, and
 * methods start afresh. */
#include <math.h>

#include "sim/simulation.h"

/* A time in the middle, so that it is in the same piece where rows are at other times,
 * to which a derivative leads. */
static double middle(const weft__piece_bounds *of, double t)
{
    const bool first = of->first > -DBL_MAX, last = of->last < DBL_MAX;
    return first && last ? 0.5 * of->first + 0.5 * of->last
           : first       ? of->first + 1.0
           : last        ? of->last - 1.0
                         : t;
}

static weft__piece_bounds piece_bounds_of(const weft_sim *sim)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    weft__piece_bounds out = { -DBL_MAX, DBL_MAX };
    WEFT__EACH_FORCE(sim->cloth, law.piece, sim->t, &out);
    for (size_t i = 0; i < mesh->motion_count; ++i) {
        weft__curve_bounds(&mesh->motions[i].path, sim->t, &out);
    }
    return out;
}

void weft__piece_jump(const weft_sim *sim, double factor, double *v)
{
    if (sim->piece_begins) {
        weft__jump_pins(&sim->cloth->mesh, sim->t,
                        (double[]){ sim->piece, sim->next_piece }, factor, v);
    }
}

double weft__piece_enter(weft_sim *sim, double *t_end)
{
    const weft__piece_bounds out = piece_bounds_of(sim);
    *t_end = weft__row_met(*t_end, out.last) ? *t_end : out.last;
    sim->forces.piece = sim->piece = middle(&out, sim->t);
    sim->piece_begins = false;
    return out.last;
}

void weft__piece_leave(weft_sim *sim, double end)
{
    sim->forces.piece = (double)NAN;
    sim->piece_begins = weft__row_met(end, sim->t);
    if (sim->piece_begins) {
        const weft__piece_bounds next = piece_bounds_of(sim);
        sim->next_piece = middle(&next, sim->t);
        weft__meet_pins(&sim->cloth->mesh, sim->t, sim->next_piece,
                        sim->y + weft_cloth_dim(sim->cloth) / 2);
        weft__sensitivity_jump(sim);
        weft_stepper_ode_changed(sim->def.method, sim->stepper);
    }
}
