/* SPDX-License-Identifier: BSD-3-Clause */
/* grids.c -- parts of a cloth that are grids: each has some forces of its own, as of
 * a cloth of its own, in the state of all; the others are those of the whole. Of each
 * there are two, with rows as blocks and with a block for each particle, for the rows
 * that blocks of the whole divide: both have the same bits. */
#include "cloth/grids.h"

#include <string.h>

#include "base/memory.h"
#include "mesh/grid_def.h"
#include "mesh/triangles.h"

weft_cloth_def weft__grid_def_of(const weft_cloth_def *whole, size_t k)
{
    weft_cloth_def out = *whole->mesh->grids[k];
    memcpy(out.velocity, whole->mesh->parts[k].velocity, sizeof out.velocity);
    out.mesh = NULL;
    out.load_count = out.pin_count = out.band_rows = 0;
    out.allocator = whole->allocator;
    out.untangle = 0.0;
    for (size_t j = 0; j < WEFT__FORCES; ++j) {
        if (weft__table[j].force->grids.define != NULL) {
            weft__table[j].force->grids.define(whole, &out);
        }
    }
    return out;
}

void weft__grids_attach(weft_cloth *whole)
{
    const weft__mesh *mesh = &whole->mesh;
    for (size_t g = 0; g < whole->grid_count; ++g) {
        weft_cloth *to = &whole->grids[g];
        to->mesh.mass = mesh->mass + to->first;
        to->mesh.inverse_mass = mesh->inverse_mass + to->first;
        to->mesh.pin = mesh->pin + to->first;
        to->mesh.motions = mesh->motions;
        to->mesh.coast = mesh->coast != NULL ? mesh->coast + 3 * to->first : NULL;
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            *(const weft__mesh **)weft__own_of(to, k) = &to->mesh;
            if (weft__table[k].force->grids.share != NULL) {
                weft__table[k].force->grids.share(weft__own_of(to, k),
                                                  weft__own(whole, k));
            }
        }
    }
}

bool weft__grids_init(weft_cloth *whole, const weft_cloth_def *def)
{
    const weft_mesh_def *mesh = def->mesh;
    if (mesh == NULL || mesh->grids == NULL) {
        return true;
    }
    whole->grids
        = weft__zeroed(&whole->memory, 2 * mesh->part_count, sizeof *whole->grids);
    for (size_t i = 0; whole->grids != NULL && i < 2 * mesh->part_count; ++i) {
        const weft__part *part = &whole->mesh.triangles->parts[i / 2];
        if (part->grid.rows > 0) {
            const weft_cloth_def own = weft__grid_def_of(def, i / 2);
            weft_cloth *to = &whole->grids[whole->grid_count++];
            to->mesh = part->grid;
            to->mesh.block = i % 2 == 0 ? part->grid.cols : 1;
            to->first = part->first;
            weft__grids_attach(whole);
            for (size_t k = 0; k < WEFT__FORCES; ++k) {
                const weft__force *force = weft__table[k].force;
                if (force->grids.have_it) { /* which takes no memory */
                    (void)force->tables.init(weft__own_of(to, k), &own, &whole->memory);
                }
            }
        }
    }
    whole->sum_grids = whole->grid_count > 0 ? weft__grids_sum : NULL;
    weft__grids_attach(whole);
    weft__grids_choose(whole);
    return whole->grids != NULL;
}

void weft__grids_choose(weft_cloth *whole)
{
    for (size_t j = 0; j < whole->grid_count * WEFT__FORCES; ++j) {
        const size_t g = j / WEFT__FORCES, k = j % WEFT__FORCES;
        if (weft__table[k].force->tables.choose != NULL) {
            weft__table[k].force->tables.choose(weft__own_of(&whole->grids[g], k),
                                                g % 2 == 0 ? whole->isa : WEFT__LOOPS);
        }
    }
}

bool weft__grids_copy(weft_cloth *copy)
{
    const weft_cloth *from = copy->grids;
    const size_t count = copy->grid_count;
    copy->grids = count > 0 ? weft__alloc(&copy->memory, count, sizeof *from) : NULL;
    copy->grid_count = copy->grids != NULL ? count : 0;
    if (copy->grids != NULL) {
        memcpy(copy->grids, from, count * sizeof *from);
    }
    return copy->grid_count == count;
}

static weft__state grids_state_of(const weft_cloth *grid, const weft__state *at)
{
    weft__state own = *at;
    own.y = at->y != NULL ? at->y + grid->first : NULL;
    own.along = at->along != NULL ? at->along + grid->first : NULL;
    return own;
}

/* The particles of a grid among those of blocks [first, end) of the whole. */
static void grids_range_of(const weft_cloth *whole, const weft_cloth *grid,
                           size_t first, size_t end, size_t range[2])
{
    for (size_t k = 0; k < 2; ++k) {
        const size_t i = weft__block(&whole->mesh, k == 0 ? first : end);
        const size_t local = i > grid->first ? i - grid->first : 0;
        range[k] = local < grid->mesh.particles ? local : grid->mesh.particles;
    }
}

int weft__grids_sum(const weft_cloth *whole, const weft__state *at, weft__unit unit,
                    double *to, size_t first, size_t end)
{
    int failed = 0;
    for (size_t g = 0; g < whole->grid_count; g += 2) {
        const weft_cloth *rows = &whole->grids[g], *points = rows + 1;
        const weft__state own = grids_state_of(rows, at);
        const size_t cols = rows->mesh.cols;
        size_t in[2];
        grids_range_of(whole, rows, first, end, in);
        const size_t low = (in[0] + cols - 1) / cols, high = in[1] / cols;
        const bool some = low < high;
        const size_t stop = some ? low * cols : in[1],
                     again = some ? high * cols : in[1];
        double *sum = to + rows->first;
        failed |= some ? weft__sum_blocks(rows, &own, unit, sum, low, high) : 0;
        failed |= in[0] < stop ? weft__sum_blocks(points, &own, unit, sum, in[0], stop)
                               : 0;
        failed |= again < in[1]
                      ? weft__sum_blocks(points, &own, unit, sum, again, in[1])
                      : 0;
    }
    return failed;
}

bool weft__grids_next(const weft_cloth *whole, const weft__state *at, size_t b,
                      weft__grid_row *row)
{
    size_t in[2];
    while (row->grid < whole->grid_count) {
        const weft_cloth *grid = &whole->grids[row->grid];
        const size_t cols = grid->mesh.cols;
        grids_range_of(whole, grid, b, b + 1, in);
        row->row = row->begun ? row->row + 1 : (in[0] + cols - 1) / cols;
        row->begun = row->row * cols < in[1];
        if (row->begun) {
            row->cloth = grid;
            row->at = grids_state_of(grid, at);
            return true;
        }
        row->grid += 2;
    }
    return false;
}

void weft__grids_measure(const weft_cloth *whole, const weft__state *at, size_t b,
                         weft__grid_part what, weft_measures *sum)
{
    weft__grid_row of = { 0 };
    while (weft__grids_next(whole, at, b, &of)) {
        weft_measures row = { .hash = 0 };
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            const weft__force *force = weft__force_at(of.cloth, k);
            weft__block_fn *measure
                = force == NULL || !force->grids.measured ? NULL
                  : what == WEFT__GRID_ENERGY             ? force->measures.energy
                  : what == WEFT__GRID_POWER              ? force->measures.power
                                                          : force->measures.worst;
            if (measure != NULL) {
                measure(weft__own(of.cloth, k), &of.at, of.row,
                        what == WEFT__GRID_WORST ? &row : sum);
            }
        }
        if (row.worst.p != row.worst.q) {
            row.worst.p += of.cloth->first, row.worst.q += of.cloth->first;
            weft__keep_worst(&sum->worst, &row.worst);
        }
    }
}

uint64_t weft__grids_hash(const weft_cloth *whole, uint64_t hash)
{
    for (size_t j = 0; j < whole->grid_count / 2 * WEFT__FORCES; ++j) {
        const weft_cloth *grid = &whole->grids[j / WEFT__FORCES * 2];
        const size_t k = j % WEFT__FORCES;
        if (weft__table[k].force->grids.measured) {
            hash = weft__hash_reals(hash, grid->mesh.spacing, 2);
            hash = weft__hash_word(hash, grid->mesh.cols);
            hash = weft__table[k].force->tables.hash(weft__own(grid, k), hash);
        }
    }
    return hash;
}

/* ---- stiffness ------------------------------------------------------------------- */

const weft_cloth *weft__grids_at(const weft_cloth *whole, size_t i)
{
    const weft_cloth *of = NULL;
    for (size_t g = 0; of == NULL && g < whole->grid_count; g += 2) {
        const weft_cloth *grid = &whole->grids[g];
        of = i >= grid->first && i - grid->first < grid->mesh.particles ? grid : NULL;
    }
    return of;
}
