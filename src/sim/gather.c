/* SPDX-License-Identifier: BSD-3-Clause */
/* gather.c -- forces between any two particles of a cloth in bands: each band gets the
 * state of all others in each evaluation, and adds the forces on its own particles in
 * the order of one process. */
#include "sim/bands.h"

#include "base/finite.h"
#include "base/memory.h"
#include "sim/spaces.h"

/* Own particles of band `rank`: the first of the whole, and their number. */
static size_t own_of(const weft__forces *forces, size_t rank, size_t *first)
{
    const weft__mesh *mesh = &forces->cloth->mesh;
    const size_t all = weft__whole_particles(mesh);
    size_t count = mesh->band.rows;
    *first = 0;
    (void)weft_comm_band(count, rank, (size_t)forces->comm->size, first, &count);
    const size_t end = (*first + count) * mesh->block;
    *first *= mesh->block;
    return (end < all ? end : all) - *first;
}

static bool gather_make_room(weft__gather *of, const weft__forces *forces)
{
    const weft_allocator *memory = &forces->memory;
    const size_t numbers = weft_cloth_dim(of->cloth);
    const size_t size = (size_t)forces->comm->size, me = (size_t)forces->comm->rank;
    of->room = weft__alloc(memory, 3 * numbers, sizeof *of->room);
    of->parcels = weft__zeroed(memory, size, sizeof *of->parcels);
    if (of->room == NULL || of->parcels == NULL) {
        return false;
    }
    of->y[0] = of->room + numbers, of->y[1] = of->y[0] + numbers;
    double *in = of->room + 6 * of->own;
    for (size_t r = 0, j = 0, first; r < size; ++r) {
        const size_t ins = 6 * own_of(forces, r, &first);
        if (r != me) {
            of->parcels[j++] = (weft_parcel){ (int)r, 6 * of->own, ins, of->room, in };
            in += ins;
        }
    }
    return true;
}

bool weft__gather_create(weft__forces *forces, bool all)
{
    const weft_cloth *cloth = forces->cloth;
    weft__gather *of = &forces->exchange.gather;
    if (forces->comm == NULL || !weft__cloth_gathers(cloth)) {
        return true;
    }
    of->cloth = cloth->whole != NULL ? cloth->whole : cloth;
    of->own = own_of(forces, (size_t)forces->comm->rank, &of->first);
    of->here = weft__block(&cloth->mesh, cloth->mesh.band.above);
    of->part = cloth->whole != NULL && !all;
    const size_t own[2] = { of->first, of->first + of->own };
    return weft__spaces_make(forces, of->cloth, of->part ? own : NULL)
           && gather_make_room(of, forces);
}

/* ---- states ---------------------------------------------------------------------- */

void weft__gather_begin(const weft__forces *forces, const double *y)
{
    const weft__gather *of = &forces->exchange.gather;
    const weft_comm *comm = forces->comm;
    const size_t n = weft_cloth_particles(forces->cloth);
    for (size_t k = 0; of->cloth != NULL && k < 6; ++k) {
        memcpy(of->room + k * of->own, y + k * n + of->here, of->own * sizeof *y);
    }
    if (of->cloth != NULL) {
        comm->post(comm->self, of->parcels, (size_t)comm->size - 1);
    }
}

/* Planes of `count` particles, to their place in those of the whole. */
static void gather_put(const weft__gather *of, const double *planes, size_t first,
                       size_t count, double *y)
{
    const size_t n = weft_cloth_particles(of->cloth);
    for (size_t k = 0; k < 6; ++k) {
        memcpy(y + k * n + first, planes + k * count, count * sizeof *y);
    }
}

const double *weft__gather_end(const weft__forces *forces, const double *y, size_t k)
{
    const weft__gather *of = &forces->exchange.gather;
    const weft_comm *comm = forces->comm;
    if (of->cloth == NULL) {
        return y;
    }
    comm->end(comm->self);
    gather_put(of, of->room, of->first, of->own, of->y[k]);
    for (size_t j = 0, first = 0; j + 1 < (size_t)comm->size; ++j) {
        const weft_parcel *from = &of->parcels[j];
        first += first == of->first ? of->own : 0;
        gather_put(of, from->in, first, from->ins / 6, of->y[k]);
        first += from->ins / 6;
    }
    return of->y[k];
}

bool weft__gather_finite(const weft__forces *forces, const double *y)
{
    const weft__gather *of = &forces->exchange.gather;
    return weft__all_finite(weft__gather_last(of, y, 0),
                            weft_cloth_dim(weft__gather_cloth(of, forces->cloth)));
}

/* ---- what is made of them -------------------------------------------------------- */

int weft__gather_add(const weft__forces *forces, double *dvdt)
{
    const weft__gather *of = &forces->exchange.gather;
    const size_t end = of->first + of->own, n = weft_cloth_particles(forces->cloth);
    int failed = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__force_at(of->cloth, k);
        if (force != NULL && force->whole.add_part != NULL) {
            failed
                |= force->whole.add_part(weft__own(of->cloth, k), forces->spaces[k],
                                         of->y[0], of->first, end, n, dvdt + of->here);
        }
    }
    return failed;
}

void weft__gather_measure(const weft__forces *forces, const weft__state *at,
                          weft_measures *sum)
{
    const weft__gather *of = &forces->exchange.gather;
    weft__state whole = *at;
    weft__gather_begin(forces, at->y);
    whole.y = weft__gather_end(forces, at->y, 0);
    weft__measure_all(weft__gather_cloth(of, forces->cloth),
                      of->part ? NULL : forces->spaces, &whole, sum);
}

void weft__gather_sides(const weft__forces *forces, double t, const double *y,
                        double most[WEFT__SIDES])
{
    const weft__gather *of = &forces->exchange.gather;
    const weft_band band = forces->cloth->mesh.band;
    if (y != NULL) {
        weft__gather_begin(forces, y);
        y = weft__gather_end(forces, y, 0);
    }
    weft_cloth own = *weft__gather_cloth(of, forces->cloth);
    if (of->cloth != NULL) { /* of the whole the own blocks */
        own.mesh.band.above = band.first;
        own.mesh.band.own = band.own;
    }
    weft__stiffness_sides(&own, of->part ? NULL : forces->spaces,
                          forces->range_stiffness, t, y, most);
}
