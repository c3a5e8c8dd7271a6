/* SPDX-License-Identifier: BSD-3-Clause */
/* structure.c -- the weft_structure of a simulation: that of its cloth, with the
 * present pins and shapes. */
#include "base/memory.h"
#include "cloth/model.h"
#include "sim/simulation.h"

_Static_assert((int)WEFT_MODES_CORNERS == (int)WEFT_STIFFNESS_CORNERS,
               "weft/stepper.h and weft/cloth.h disagree");

static int structure_linearise(double t, const double *y, double *planes,
                               double *blocks, void *ctx)
{
    const weft_sim *sim = ctx;
    const weft__state at = weft__forces_state(&sim->forces, t, y);
    return weft__linearise(sim->cloth, sim->forces.spaces, &at, planes,
                           sim->structure.pair_count,
                           sim->structure.block_planes > 0 ? blocks : NULL);
}

static int linearise_blocks(double t, const double *y, double *numbers, void *ctx)
{
    return weft__linearise_block_couplings(((const weft_sim *)ctx)->cloth, t, y,
                                           numbers);
}

static size_t structure_modes(double t, const double *y, double (*corners)[2],
                              size_t room, void *ctx)
{
    const weft_sim *sim = ctx;
    const weft_stiffness of = weft_sim_stiffness(sim, t, y);
    const double about[4][2] = {
        { 0.0, 0.0 }, { of.omega2, 0.0 }, { of.omega2, of.damping }, { 0.0, of.damping }
    };
    const size_t count = of.count <= room ? of.count : room < 4 ? 0 : 4;
    memcpy(corners, of.count <= room ? of.corners : about, count * sizeof *corners);
    return count;
}

/* Whether it would take a matrix without block couplings and scalar couplings for one
 * of all forces. */
static bool takes_springs_alone(const weft_sim *sim)
{
    const uint32_t flags = sim->def.method->flags;
    return sim->cloth->mesh.triangles != NULL
           && (flags & (uint32_t)WEFT_STEPPER_IMPLICIT) != 0
           && (flags & (uint32_t)WEFT_STEPPER_COUPLINGS) == 0;
}

weft_status weft__structure_init(weft_sim *sim, weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    weft_structure *of = &sim->structure;
    *of = (weft_structure){ .struct_size = sizeof *of,
                            .particles = n,
                            .linearise = structure_linearise,
                            .linearise_blocks = linearise_blocks,
                            .modes = structure_modes,
                            .ctx = sim };
    const bool block_couplings
        = (sim->def.method->flags & (uint32_t)WEFT_STEPPER_COUPLINGS) != 0;
    sim->lists = weft__list_structure(sim->cloth, block_couplings, &sim->memory, of);
    sim->masses = weft__alloc(&sim->memory, n, 2 * sizeof *sim->masses);
    if (sim->lists == NULL || sim->masses == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    of->mass = sim->masses;
    of->drag = sim->masses + n;
    for (size_t i = 0; i < n; ++i) {
        sim->masses[n + i] = sim->cloth->body.drag;
    }
    weft__structure_update(sim);
    sim->config.structure = takes_springs_alone(sim) ? NULL : of;
    return WEFT_OK;
}

void weft__structure_update(weft_sim *sim)
{
    const weft_cloth *cloth = sim->cloth;
    for (size_t i = 0; i < cloth->mesh.particles; ++i) {
        sim->masses[i] = cloth->mesh.pin[i] != 0 ? 0.0 : cloth->mesh.mass[i];
    }
    sim->structure.block_planes = weft__sim_checks(sim) ? WEFT_BLOCK_PLANES : 0;
}
