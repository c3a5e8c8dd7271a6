/* SPDX-License-Identifier: BSD-3-Clause */
/* model.h -- what else is asked of a cloth: measures, checks of its definition,
 * changes, bounds and its linearisation. */
#pragma once

#include "cloth/sums.h"

/* measure.c: measures a part or all of block b into *sum, which is weft__block_start
 * before. Springs belong to the block where they begin. */
typedef void weft__measure_fn(const weft_cloth *cloth, const weft__state *at, size_t b,
                              weft_measures *sum);
weft__measure_fn weft__block_energy, weft__block_power, weft__block_worst,
    weft__block_gaps, weft__block_state, /* all but powers */ weft__block_all;
extern const weft_measures weft__block_start;

/* Of all blocks, taken in their order: *sum is weft__measures_start before. */
extern const weft_measures weft__measures_start;
void weft__measures_add(weft_measures *sum, const weft_measures *block);

/* Of the forces of the whole cloth, after that. */
void weft__measure_all(const weft_cloth *cloth, void *const *spaces,
                       const weft__state *at, weft_measures *sum);

/* cloth_hash.c: of all that determines the motion of the whole cloth but its state;
 * `blocks` has the hash of each of its blocks (NULL: they are computed, for a whole
 * cloth). */
uint64_t weft__cloth_hash(const weft_cloth *cloth, const uint64_t *blocks);
uint64_t weft__cloth_block_hash(const weft_cloth *cloth, size_t b);

/* validate.c: reports every fault of a definition; a field may be an offset in a part.
 * *triangles: as weft__mesh_check makes them, NULL of a grid. */
void weft__cloth_def_check(const weft_cloth_def *def, const weft__faults *to,
                           struct weft__triangles **triangles, bool *no_memory);

/* Whether a force takes energy from any motion of the cloth. */
bool weft__def_slows(const weft_cloth_def *def);

/* What it checks of triangles, with faults of their parts to *parts (NULL: to *to).
 * Makes the triangles of a definition whose own arrays have no fault, else NULL, to be
 * destroyed by the caller; only checks with triangles NULL. *no_memory: not all could
 * be checked. */
struct weft__mesh_faults;
void weft__mesh_check(const weft_cloth_def *def, const struct weft__mesh_faults *parts,
                      const weft__faults *to, struct weft__triangles **triangles,
                      bool *no_memory);

/* What it checks on a grid without faults. */
void weft__sheet_check(const weft_cloth_def *def, const weft__faults *to);
WEFT__NUMBERS(weft__limit_numbers, method, solver, strain, sweeps, tolerance);
void weft__limit_check(const weft_limit_def *def, const weft__faults *to);
WEFT__NUMBERS(weft__fabric_numbers, density, stretch, shear, bend, twist, damping,
              coupling); /* fabric.c */

/* cloth_checks.c: whether a force needs the whole cloth in each band, acts between any
 * two particles, looks for passages; [m] the largest gap at which one acts; what no
 * band can have, or NULL. */
bool weft__cloth_gathers(const weft_cloth *cloth);
bool weft__cloth_pairs(const weft_cloth *cloth);
bool weft__cloth_passages(const weft_cloth *cloth);
double weft__cloth_reach(const weft_cloth *cloth);
const char *weft__cloth_no_bands(const weft_cloth *cloth);
const char *weft__def_no_bands(const weft_cloth_def *def);

/* Whether a force of a definition measures gaps. */
bool weft__def_has_gaps(const weft_cloth_def *def);

/* What crosses in a state, by the first force that finds any. */
weft_status weft__crossings_error(const weft_cloth *cloth, double t, const double *y,
                                  const weft__search *of, weft_error *err);

/* What passes through shapes, by all forces. */
weft__passages weft__block_passages(const weft_cloth *cloth, const weft__state *at,
                                    size_t b, double rise);

/* cloth.c: WEFT_INVALID if the cloth crosses something at t = 0; or WEFT_NO_MEMORY,
 * WEFT_STOPPED. */
weft_status weft__start_crossing_error(const weft_cloth *cloth, weft__stop *stop,
                                       weft_error *err);

/* untangle.c: weft_cloth_untangle with another question and another log. */
weft_status weft__relax_start(const weft_cloth *cloth, double *y,
                              const weft__stop *stop, const weft_log *log,
                              weft_error *err);

/* cloth_checks.c: "edge (0, 14)-(0, 15) passes through shapes[0] at t = 0.5 s, one of
 * 6 edges and triangles: ..." with the cure; particles by their numbers in the whole
 * definition. Returns `text`. */
enum { WEFT__PASSAGE_TEXT = 384 };
const char *weft__passage_text(const weft_cloth *cloth, double t,
                               const weft_passage *at, double count,
                               char text[WEFT__PASSAGE_TEXT]);

/* The own forms of a level, for tests and measurements. */
void weft__cloth_choose(weft_cloth *cloth, weft__isa isa);

/* A copy of *model that owns its pins and shapes and shares the rest; *model must
 * outlive it. Destroy it with weft_cloth_destroy. NULL: no memory. */
weft_cloth *weft__cloth_copy(const weft_cloth *model, const weft_allocator *memory);

/* changes.c: the values of forces that a simulation may change. `put` writes them as
 * words, and begins those of each force by `begin`, which returns where they go. `take`
 * reads saved ones into *taken, before that a bitwise copy of the present cloth.
 * `exchange` swaps the present ones with those; a second time it swaps them back. */
enum { WEFT__CHANGES_HEAD = 2 }; /* [words] a force's name, and how many follow */
unsigned char *weft__changes_begin(unsigned char *to, const char *name, size_t words);
size_t weft__changes_words(const weft_cloth *cloth);
void weft__changes_put(const weft_cloth *cloth, unsigned char *to);
weft_status weft__changes_take(weft_cloth *taken, const unsigned char *from,
                               size_t words, const weft_allocator *memory,
                               weft_error *err);
void weft__changes_exchange(weft_cloth *cloth, weft_cloth *taken);
void weft__changes_drop(weft_cloth *taken, const weft_allocator *memory);

double weft__block_mass(const weft_cloth *cloth, size_t b); /* [kg] */

/* bounds.c: weft_cloth_stiffness in two parts: bounds in several directions, each the
 * largest of the own particles; the polygon within them. spaces as of weft__rhs_all;
 * room: of weft__range_stiffness_create, or NULL, then pairs are sought several
 * times. */
void weft__stiffness_sides(const weft_cloth *cloth, void *const *spaces,
                           weft__range_stiffness *room, double t, const double *y,
                           double most[WEFT__SIDES]);
bool weft__range_stiffness_create(
    const weft_cloth *cloth, const weft_allocator *memory,
    weft__range_stiffness **out); /* NULL without pairs; false: no memory */
weft_stiffness weft__stiffness_within(const weft_cloth *cloth, const double *y,
                                      const double most[WEFT__SIDES]);

/* The free particle of the own blocks at which all forces but contact are fastest, and
 * the larger one of its bounds sqrt(K) and C [1/s]; 0: there is none. stiffest.c: its
 * stiffest spring, or its flattest triangle, in words. */
typedef struct weft__stiffest {
    double rate;
    size_t particle;
} weft__stiffest;
weft__stiffest weft__stiffest_of(const weft_cloth *cloth, double t, const double *y);
void weft__stiffest_text(const weft_cloth *cloth, size_t i, char *text, size_t size);

/* linearise.c: fills what weft_structure lists: the runs of all forces, bending's last,
 * and with `block_couplings` the block couplings and scalar couplings. Returns the
 * memory of the lists, NULL: none. */
void *weft__list_structure(const weft_cloth *cloth, bool block_couplings,
                           const weft_allocator *memory, weft_structure *out);

/* The block couplings and the scalar couplings of all forces; NULL: their number alone.
 */
size_t weft__list_block_couplings(const weft_cloth *cloth,
                                  weft_block_coupling *block_couplings);
size_t weft__list_scalar_couplings(const weft_cloth *cloth,
                                   weft_scalar_coupling *scalar_couplings);

/* Writes numbers[18 block couplings], as weft_structure::linearise_blocks. */
int weft__linearise_block_couplings(const weft_cloth *cloth, double t, const double *y,
                                    double *numbers);

/* Writes planes[6 spring couplings] in that order, and unless NULL the contact to
 * blocks[15 N], as weft_structure::linearise; spaces as of weft__rhs_all. Returns 0, or
 * 1 if a number is not finite or a free particle is in a shape. */
int weft__linearise(const weft_cloth *cloth, void *const *spaces, const weft__state *at,
                    double *planes, size_t spring_couplings, double *blocks);
