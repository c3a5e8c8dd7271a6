/* SPDX-License-Identifier: BSD-3-Clause */
/* pace.c -- a run that hardly advances, what holds it, and shapes that are about to
 * close on the cloth, as warnings. */
#include <math.h>
#include <string.h>

#include "base/log.h"
#include "mesh/surface.h"
#include "sim/bands.h"
#include "sim/holder.h"

/* Of a frame: what WEFT__PACE steps must advance. */
#define LEAST_PART 1e-4

/* What takes all of a step's length, if it is below this part of the shortest time that
 * forces have, is neither. */
#define SHORT 1e-3

/* Of rates: contact holds the step if it is so many times as fast as all else. */
#define FASTER 2.0

/* ---- what holds a step ----------------------------------------------------------- */

/* Gathered on the band that has it. */
typedef struct stiff_part {
    double rate; /* [1/s] without contact */
    char name[120];
} stiff_part;

static stiff_part find_stiff_part(const weft_sim *sim)
{
    const weft_comm *comm = sim->def.comm;
    const weft__stiffest mine = weft__stiffest_of(sim->cloth, sim->t, sim->y);
    stiff_part out = { .rate = mine.rate };
    weft__stiffest_text(sim->cloth, mine.particle, out.name, sizeof out.name);
    (void)weft__bands_first(comm, weft__bands_max(comm, mine.rate) == mine.rate, &out,
                            sizeof out);
    return out;
}

/* The particle nearest to a shape other than one, by its number in the definition. */
typedef struct other_gap {
    double gap; /* [m] */
    size_t particle, shape;
} other_gap;

static other_gap find_other(const weft_sim *sim, size_t than)
{
    const weft_cloth *cloth = sim->cloth;
    const weft_comm *comm = sim->def.comm;
    const weft__mesh *mesh = &cloth->mesh;
    const double reach = weft__cloth_reach(cloth);
    const weft__state at = { .t = sim->t, .y = sim->y };
    weft_measures least = weft__measures_start;
    WEFT__EACH_FORCE(cloth, checks.other, sim->forces.spaces[k_], &at, than, &least)
    other_gap out = { least.gap, 0, least.gap_shape };
    out.particle = weft__vertex_of(mesh, weft__whole_index(mesh, least.gap_particle));
    const double near = least.gap < reach ? reach - least.gap : 0.0;
    const double most = weft__bands_max(comm, near);
    (void)weft__bands_first(comm, near == most, &out, sizeof out);
    return out;
}

/* What is nearest, in words, and to *out. */
static void pace_find_nearest(const weft_sim *sim, const weft_measures *now, char *text,
                              size_t size, weft__holder *out)
{
    weft__penetration *near = &out->near;
    const weft__mesh *mesh = &sim->cloth->mesh;
    char names[2][96];
    if (now->self_gap < now->gap) {
        memcpy(near->pair, now->self_pair, sizeof near->pair);
        near->gap = now->self_gap;
        for (size_t k = 0; k < 2; ++k) {
            (void)weft__primitive_text(mesh, &near->pair[k], names[k], sizeof names[k]);
        }
        (void)weft_text_format(text, size, "%s and %s are %.3g mm apart", names[0],
                               names[1], 1e3 * near->gap);
        return;
    }
    const other_gap other = find_other(sim, now->gap_shape);
    const bool two = other.gap < weft__cloth_reach(sim->cloth);
    near->gap = now->gap;
    near->particle = now->gap_particle;
    near->shape = now->gap_shape;
    out->other_shape = two ? other.shape : now->gap_shape;
    out->other_gap = two ? other.gap : 0.0;
    const int used = weft_text_format(
        text, size, "%s is %.3g mm from shapes[%zu]",
        weft__particle_name(mesh, near->particle, names[0], sizeof names[0]),
        1e3 * near->gap, near->shape);
    if (two && used > 0 && (size_t)used < size) {
        (void)weft_text_format(
            text + used, size - (size_t)used, " and %s %.3g mm from shapes[%zu]",
            weft__particle_name(mesh, other.particle, names[1], sizeof names[1]),
            1e3 * other.gap, other.shape);
    }
}

void weft__sim_find_holder(const weft_sim *sim, const weft_measures *now,
                           weft__holder *out)
{
    char near[240];
    const double fixed = sim->config.fixed_step, h = weft_sim_stats(sim).last_step;
    const weft_stiffness all = weft_sim_stiffness(sim, sim->t, sim->y);
    const double rate = fmax(sqrt(fmax(all.omega2, 0.0)), all.damping);
    const stiff_part part = find_stiff_part(sim);
    const double least = fmin(now->gap, now->self_gap);
    *out = (weft__holder){ .near.found = least < weft__cloth_reach(sim->cloth)
                                         && rate > FASTER * part.rate
                                         && !(fixed > 0.0) };
    if (fixed > 0.0) {
        (void)weft_text_format(out->text, sizeof out->text, "the fixed step is %g s",
                               fixed);
    } else if (out->near.found) {
        pace_find_nearest(sim, now, near, sizeof near, out);
        (void)weft_text_format(out->text, sizeof out->text,
                               "contact holds it: %s (rates up to %.2g 1/s; without "
                               "contact %.2g 1/s, by %s)",
                               near, rate, part.rate, part.name);
    } else if (h == 0.0 || h * rate >= SHORT) {
        (void)weft_text_format(out->text, sizeof out->text,
                               "what is stiffest holds it: %s (rates up to %.2g 1/s)",
                               part.name, rate);
    } else {
        (void)weft_text_format(out->text, sizeof out->text,
                               "neither stiffness (rates up to %.2g 1/s, by %s) nor "
                               "contact holds it, but what drives the cloth",
                               rate, part.name);
    }
}

/* ---- warnings -------------------------------------------------------------------- */

static void warn_of_pace(weft_sim *sim, double covered)
{
    weft__holder held;
    const weft_measures now = weft_sim_measure(sim);
    weft__sim_find_holder(sim, &now, &held);
    weft__log(&sim->def.log, WEFT_LOG_WARNING,
              "%d steps advance %.3g s at t = %.9g s, %.2g of a frame: %s; the run may "
              "take very long",
              WEFT__PACE, covered, sim->t, covered / sim->pace.frame, held.text);
    sim->pace.told = true;
}

static void pace_warn_of_closing(weft_sim *sim)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const double two = 2.0 * weft__cloth_reach(sim->cloth);
    const weft__state at = { .t = sim->t, .y = sim->y };
    weft__closing found = { .found = false };
    char name[96];
    for (size_t k = 0; k < WEFT__FORCES && !found.found; ++k) {
        const weft__force *force = weft__force_at(sim->cloth, k);
        if (force != NULL && force->checks.closing != NULL) {
            found = force->checks.closing(weft__own(sim->cloth, k),
                                          sim->forces.spaces[k], &at);
        }
    }
    if (found.found) {
        sim->pace.closed = true;
        weft__log(
            &sim->def.log, WEFT_LOG_WARNING,
            "shapes[%zu] and shapes[%zu] are %.3g mm apart at t = %.9g s, less than "
            "two "
            "thicknesses (%.3g mm), and meet at t = %.3g s, with %s between them: "
            "contact cannot keep it out of both, so steps shrink until the run ends",
            found.shape[0], found.shape[1], 1e3 * found.apart, sim->t, 1e3 * two,
            found.meet_time,
            weft__particle_name(mesh, weft__vertex_of(mesh, found.particle), name,
                                sizeof name));
    }
}

/* Once per frame, where somebody listens; with bands the others do not look. */
void weft__sim_look_ahead(weft_sim *sim)
{
    if (!sim->pace.closed && sim->def.log.write != NULL && sim->def.comm == NULL) {
        pace_warn_of_closing(sim);
    }
}

void weft__sim_look_back(weft_sim *sim)
{
    const double covered = sim->t - sim->pace.since;
    if (covered >= 0.0 && covered < LEAST_PART * sim->pace.frame && !sim->pace.told) {
        warn_of_pace(sim, covered);
    }
}
