/* SPDX-License-Identifier: BSD-3-Clause */
/* structure.c -- the weft_structure of a simulation: that of its cloth, with the
 * present pins and shapes. */
#include "base/memory.h"
#include "cloth/model.h"
#include "sim/simulation.h"

_Static_assert((int)WEFT_MODES_CORNERS == (int)WEFT_STIFFNESS_CORNERS,
               "weft/stepper.h and weft/cloth.h disagree");

static int linearise(double t, const double *y, double *planes, double *blocks,
                     void *ctx)
{
    const weft_sim *sim = ctx;
    return weft__linearise(sim->cloth, t, y, planes, sim->structure.bond_count,
                           sim->structure.block_planes > 0 ? blocks : NULL);
}

static int linearise_links(double t, const double *y, double *numbers, void *ctx)
{
    return weft__linearise_links(((const weft_sim *)ctx)->cloth, t, y, numbers);
}

static size_t modes(double t, const double *y, double (*corners)[2], size_t room,
                    void *ctx)
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

/* Those of bending are the last. */
static void list_runs(const weft_cloth *cloth, weft_structure *of, weft_bonds *runs)
{
    of->run_count = of->bond_count = of->bend_runs = of->bend_bonds = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__run_count all
            = weft__list_runs(cloth, k, runs != NULL ? runs + of->run_count : NULL);
        of->run_count += all.runs, of->bond_count += all.bonds;
        if (k == WEFT__FORCE_bending) {
            of->bend_runs = all.runs, of->bend_bonds = all.bonds;
        }
    }
}

/* Of triangles, for a method that knows them. False: no memory. */
static bool list_links(weft_sim *sim)
{
    weft_structure *of = &sim->structure;
    if ((sim->def.method->flags & (uint32_t)WEFT_STEPPER_LINKS) != 0) {
        of->link_count = weft__list_links(sim->cloth, NULL);
        of->tie_count = weft__list_ties(sim->cloth, NULL);
    }
    of->links = sim->links
        = weft__alloc(&sim->memory, of->link_count, sizeof *sim->links);
    of->ties = sim->ties = weft__alloc(&sim->memory, of->tie_count, sizeof *sim->ties);
    if (sim->links == NULL || sim->ties == NULL) {
        return false;
    }
    if (of->link_count + of->tie_count > 0) {
        (void)weft__list_links(sim->cloth, sim->links);
        (void)weft__list_ties(sim->cloth, sim->ties);
    }
    return true;
}

/* Whether it would take a matrix without links and ties for one of all forces. */
static bool takes_springs_alone(const weft_sim *sim)
{
    const uint32_t flags = sim->def.method->flags;
    return sim->cloth->mesh.triangles != NULL
           && (flags & (uint32_t)WEFT_STEPPER_IMPLICIT) != 0
           && (flags & (uint32_t)WEFT_STEPPER_LINKS) == 0;
}

weft_status weft__structure_init(weft_sim *sim, weft_error *err)
{
    const size_t n = weft_cloth_particles(sim->cloth);
    weft_structure *of = &sim->structure;
    *of = (weft_structure){ .struct_size = sizeof *of,
                            .particles = n,
                            .linearise = linearise,
                            .linearise_links = linearise_links,
                            .modes = modes,
                            .ctx = sim,
                            .bend_damping = sim->cloth->bending.damping };
    list_runs(sim->cloth, of, NULL);
    sim->runs = weft__alloc(&sim->memory, of->run_count, sizeof *sim->runs);
    sim->masses = weft__alloc(&sim->memory, n, 2 * sizeof *sim->masses);
    if (sim->runs == NULL || sim->masses == NULL || !list_links(sim)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a simulation");
    }
    list_runs(sim->cloth, of, sim->runs);
    of->runs = sim->runs;
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
