/* SPDX-License-Identifier: BSD-3-Clause */
/* sim_state.c -- what a simulation tells of itself. */
#include "base/sized.h"
#include "mesh/surface.h"
#include "sim/bands.h"
#include "sim/simulation.h"

double weft_sim_time(const weft_sim *sim)
{
    return sim->t;
}

const double *weft_sim_state(const weft_sim *sim)
{
    return sim->y;
}

const weft_cloth *weft_sim_cloth(const weft_sim *sim)
{
    return sim->cloth;
}

void weft_sim_measure_sized(weft_measures *out, size_t size, const weft_sim *sim)
{
    const weft__state at = { .t = sim->t, .y = sim->y };
    weft__measure_fn *of = sim->ledger.on ? weft__block_all : weft__block_state;
    const weft__mesh *mesh = &sim->cloth->mesh;
    weft_measures all = weft__forces_measure(&sim->forces, &at, of);
    all.worst.p = weft__vertex_of(mesh, all.worst.p);
    all.worst.q = weft__vertex_of(mesh, all.worst.q);
    all.gap_particle = weft__vertex_of(mesh, all.gap_particle);
    for (size_t k = 0; k < 2; ++k) {
        all.self_pair[k] = weft__primitive_of(mesh, all.self_pair[k]);
    }
    weft__sized_write(out, size, &all, sizeof all);
}

/* Of a band its first block has the counts. */
static void count_block(const void *ctx, size_t r, double *numbers)
{
    const weft_cloth *cloth = ctx;
    const bool counts = r == cloth->mesh.band.above;
    numbers[0] = weft__block_mass(cloth, r);
    numbers[1] = counts ? (double)weft_cloth_pins(cloth) : 0.0;
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        numbers[2 + k]
            = counts ? (double)weft_cloth_springs(cloth, (weft_family)k) : 0.0;
    }
}

void weft_sim_totals_sized(weft_totals *out, size_t size, const weft_sim *sim)
{
    double sum[2 + WEFT_FAMILIES];
    weft__bands_sum(&sim->forces, count_block, sim->cloth, 2 + WEFT_FAMILIES, sum);
    weft_totals totals = { .particles = weft__whole_particles(&sim->cloth->mesh),
                           .pins = (size_t)sum[1],
                           .mass = sum[0] };
    for (size_t k = 0; k < WEFT_FAMILIES; ++k) {
        totals.springs[k] = (size_t)sum[2 + k];
    }
    weft__sized_write(out, size, &totals, sizeof totals);
}

weft_stiffness weft_sim_stiffness(const weft_sim *sim, double t, const double *y)
{
    const weft_comm *comm = sim->def.comm;
    double most[WEFT__SIDES];
    weft__gather_sides(&sim->forces, t, y, most);
    if (comm != NULL) {
        weft__bands_most(&sim->forces, most, WEFT__SIDES);
    }
    return weft__stiffness_within(sim->cloth, y, most);
}

void weft_sim_stats_sized(weft_stepper_stats *out, size_t size, const weft_sim *sim)
{
    weft_stepper_stats stats = { .struct_size = sizeof stats };
    sim->def.method->stats(sim->stepper, &stats);
    stats.last_step = stats.steps > 0 ? stats.last_step : sim->earlier.last_step;
    stats.steps += sim->earlier.steps;
    stats.rejected += sim->earlier.rejected;
    stats.rhs_calls += sim->earlier.rhs_calls;
    stats.linear_iterations += sim->earlier.linear_iterations;
    stats.factorisations += sim->earlier.factorisations;
    stats.newton_failures += sim->earlier.newton_failures;
    stats.bytes = stats.bytes > 0 && sim->bytes > 0 ? stats.bytes + sim->bytes : 0;
    stats.struct_size = (uint32_t)size;
    weft__sized_write(out, size, &stats, sizeof stats);
}

void weft_sim_options(const weft_sim *sim, weft_option_fn *tell, void *ctx)
{
    const weft_stepper_type *method = sim->def.method;
    weft_sim *told = (weft_sim *)sim; /* no simulation is a constant */
    if (WEFT_HAS(method, weft_stepper_type, options) && method->options != NULL) {
        ++told->callbacks;
        method->options(sim->stepper, tell, ctx);
        --told->callbacks;
    }
}

void weft_sim_ledger_sized(weft_ledger *out, size_t size, const weft_sim *sim)
{
    const weft_ledger ledger
        = weft__ledger_read(&sim->ledger, &sim->forces, sim->t, sim->y);
    weft__sized_write(out, size, &ledger, sizeof ledger);
}

double weft_sim_dissipated(const weft_sim *sim)
{
    return weft__ledger_heat(&sim->ledger, sim->cloth, sim->y);
}

uint64_t weft_sim_vetoed(const weft_sim *sim)
{
    return sim->guard.vetoed;
}

/* Copies three planes of a state to triples. */
static void interleave(const weft__mesh *mesh, const double *planes, double *xyz)
{
    for (size_t i = 0; i < mesh->particles; ++i) {
        double *x = &xyz[3 * weft__shown(mesh, i)];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = planes[k * mesh->particles + i];
        }
    }
}

void weft_sim_positions(const weft_sim *sim, double *xyz)
{
    interleave(&sim->cloth->mesh, sim->y, xyz);
}

static void sim_state_put(float *array, size_t bytes, double value)
{
    const float number = (float)value;
    memcpy((char *)array + bytes, &number, sizeof number);
}

void weft_sim_vertices(const weft_sim *sim, float *positions, float *normals,
                       size_t stride)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    const size_t n = mesh->particles, step = stride != 0 ? stride : 3 * sizeof(float);
    for (size_t i = 0; i < n; ++i) {
        const size_t at = weft__shown(mesh, i) * step;
        double normal[3] = { 0.0, 0.0, 0.0 };
        if (normals != NULL) {
            weft__surface_normal(mesh, sim->y, i, normal);
        }
        for (size_t k = 0; k < 3; ++k) {
            if (positions != NULL) {
                sim_state_put(positions + k, at, sim->y[k * n + i]);
            }
            if (normals != NULL) {
                sim_state_put(normals + k, at, normal[k]);
            }
        }
    }
}

void weft_sim_velocities(const weft_sim *sim, double *xyz)
{
    const weft__mesh *mesh = &sim->cloth->mesh;
    interleave(mesh, sim->y + 3 * mesh->particles, xyz);
}
