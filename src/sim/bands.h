/* SPDX-License-Identifier: BSD-3-Clause */
/* bands.h -- what a simulation of one band of a cloth does together with the others:
 * right-hand sides, sums over blocks and decisions. All functions that take a comm or
 * forces are collective; with comm NULL the cloth is whole and they are local.
 *
 * Every band makes the same calls in the same order, so nothing between two of them may
 * return early on one band alone: weft_comm_agree before that. */
#pragma once

#include "sim/forces.h"
#include "weft/sim.h"

/* Whether all functions of a comm are there. */
weft_status weft__bands_comm_check(const weft_comm *comm, weft_error *err);

/* Whether the cloth is the band of this comm, and the definition has nothing that a
 * band cannot do. Local. */
weft_status weft__bands_check(const weft_sim_def *def, weft_error *err);

/* The largest number >= 0. */
double weft__bands_max(const weft_comm *comm, double mine);

/* The data of the first band that has any, to all; false if none has. */
bool weft__bands_first(const weft_comm *comm, bool has, void *data, size_t bytes);

/* `size` bytes of each own block from `blocks` on: all of the whole cloth in their
 * order on band 0, else NULL. */
const void *weft__bands_blocks(const weft__forces *forces, const void *blocks,
                               size_t size);

/* Whether this band has what is gathered. */
bool weft__bands_is_first(const weft_comm *comm);

/* From band 0 to all. */
void weft__bands_share(const weft_comm *comm, void *data, size_t bytes);

/* Of triangles: who needs whose particles. */
weft_status weft__bands_handshake(weft__forces *forces, weft_error *err);

/* As weft_cloth_rhs in own blocks; x' and the other bands' v' in ghosts. */
int weft__bands_rhs(const weft__forces *forces, const weft__state *of, double *dydt);

/* Of what the bands found, with its number in the whole cloth, the deepest penetration
 * in the last right-hand side that all could evaluate. */
void weft__bands_deepest(const weft_comm *comm, weft__penetration *penetration);

/* The sum of `count` numbers, as many as fit in weft_measures, over all blocks in
 * their order: `of` writes those of block b, on any thread. */
typedef void weft__numbers_fn(const void *ctx, size_t b, double *numbers);
void weft__bands_sum(const weft__forces *forces, weft__numbers_fn *of, const void *ctx,
                     size_t count, double *sum);

/* The largest of all bands of each of so many numbers, of either sign. */
void weft__bands_most(const weft__forces *forces, double *numbers, size_t count);

/* weft__cloth_hash of the whole. */
uint64_t weft__bands_cloth_hash(const weft__forces *forces);
