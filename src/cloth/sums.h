/* SPDX-License-Identifier: BSD-3-Clause */
/* sums.h -- a cloth: a mesh and its forces, and the sums over them. */
#pragma once

#include "base/stop.h"
#include "base/try.h"
#include "cloth/table.h"
#include "forces/bounds.h"

typedef int weft__sum_fn(const weft_cloth *cloth, const weft__state *at,
                         weft__unit unit, double *to, size_t first, size_t end);

#define WEFT_FORCE_MEMBER(name) weft__##name name;
struct weft_cloth {
    weft__mesh mesh;
    WEFT_FORCES(WEFT_FORCE_MEMBER)
    double *rows; /* row_count of them, of all paths */
    size_t row_count;
    weft__isa isa;
    double untangle;     /* [s] */
    bool strict;         /* as of weft_cloth_def */
    bool copied;         /* shares masses, motions and rows with its model */
    uint64_t whole_hash; /* of a band of triangles: weft__cloth_hash of the whole */
    struct weft_cloth *whole; /* of a band with contact.self; else NULL */
    weft_allocator memory;
    weft_log log;
    weft__stop stop;
    struct weft_cloth *grids; /* grid_count of them: grids.h */
    size_t grid_count, first; /* of a grid: the whole's particle that is its first */
    weft__sum_fn *sum_grids;  /* NULL: none */
};
#undef WEFT_FORCE_MEMBER

/* The forces with their places in a cloth, in the order of summation:
 *
 *     for (size_t k = 0; k < WEFT__FORCES; ++k)
 *         weft__table[k].force, weft__own(cloth, k) */
#define WEFT_FORCE_PLACE(name) WEFT__FORCE_##name,
enum { WEFT_FORCES(WEFT_FORCE_PLACE) WEFT__FORCES };
#undef WEFT_FORCE_PLACE
typedef struct weft__line {
    const weft__force *force;
    size_t at;
} weft__line;
extern const weft__line weft__table[WEFT__FORCES]; /* rhs.c */

static inline const void *weft__own(const weft_cloth *of, size_t k)
{
    return (const char *)of + weft__table[k].at;
}

static inline void *weft__own_of(weft_cloth *of, size_t k)
{
    return (char *)of + weft__table[k].at;
}

/* The force, or NULL where the cloth has none of it. */
static inline const weft__force *weft__force_at(const weft_cloth *of, size_t k)
{
    const weft__force *force = weft__table[k].force;
    return force->present == NULL || force->present(weft__own(of, k)) ? force : NULL;
}

/* Whether a force wants steps checked. */
static inline bool weft__cloth_checks(const weft_cloth *of)
{
    bool wanted = false;
    for (size_t k = 0; k < WEFT__FORCES && !wanted; ++k) {
        const weft__force_checks *checks = &weft__table[k].force->checks;
        wanted = checks->wanted != NULL && checks->wanted(weft__own(of, k));
    }
    return wanted;
}

/* Calls `member` of each force of a cloth that has one, with own and the rest; what it
 * returns goes `into`, as in: failed |= */
#define WEFT__FROM_EACH_FORCE(into, cloth, member, ...)                                \
    for (size_t k_ = 0; k_ < WEFT__FORCES; ++k_) {                                     \
        const weft__force *force_ = weft__force_at((cloth), k_);                       \
        if (force_ != NULL && force_->member != NULL) {                                \
            into force_->member(weft__own((cloth), k_), __VA_ARGS__);                  \
        }                                                                              \
    }
#define WEFT__EACH_FORCE(cloth, member, ...)                                           \
    WEFT__FROM_EACH_FORCE((void), cloth, member, __VA_ARGS__)

/* rhs.c: all forces but whole.add of blocks [first, end), in three planes; with
 * WEFT__ACCELERATION x' are before them. */
weft__sum_fn weft__sum_blocks;

/* The same in calls that each go on where the last one ended. */
int weft__sum_carried(const weft_cloth *cloth, const weft__state *at,
                      weft__carry *carry, weft__unit unit, double *to, size_t first,
                      size_t end);

/* All of dy/dt of blocks [first, end) but what whole.add adds. Returns 0, or 1 if
 * a number is not finite. The bits do not depend on how blocks are divided among calls.
 */
int weft__rhs_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                     size_t first, size_t end);

/* Adds the forces after the first one to three planes. */
int weft__rhs_others(const weft_cloth *cloth, const weft__state *at, weft__unit unit,
                     double *planes, size_t first, size_t end);

/* The whole-cloth forces; spaces[WEFT__FORCES] or NULL. dvdt: v' */
int weft__rhs_all(const weft_cloth *cloth, void *const *spaces, const weft__state *at,
                  weft__unit unit, double *dvdt);

/* x' of blocks [first, end), whose v' is computed elsewhere. */
void weft__ghost_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                        size_t first, size_t end);
