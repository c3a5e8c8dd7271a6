/* SPDX-License-Identifier: BSD-3-Clause */
/* save.h -- the bytes of a saved simulation, for save.c and restore.c.
 *
 * Words (bytes.h). First the front: "weftsave", version, blocks, cols (of triangles:
 * particles), quadratures, hashes of the cloth's definition and of the settings, the
 * method's name in 64 bytes, fields, the number of the words of changes, quadratures of
 * y, the changes of the forces (cloth/changes.c), checksum. Then planes of all
 * particles: the six of y, their holds, and with sensitivities the six of each. The
 * checksum is that of the front before it and of a word for each row: the checksum of
 * the row's words, plane by plane. */
#pragma once

#include "base/bytes.h"
#include "sim/simulation.h"

enum { WEFT__SAVE_VERSION = 10, WEFT__SAVE_PLANES = 7, WEFT__SAVE_NAME = 64 };

#define WEFT__SAVE_MAGIC "weftsave"

/* frame_check.c has found a passage. */
enum { WEFT__SAVED_PASSAGE = 1, WEFT__SAVED_FLAGS = 1 };

/* All that is saved besides the state, in words. */
typedef struct weft__save_fields {
    double t, next_step, last_step;                /* [s] */
    double energy_start, work_limit, work_outside; /* [J] */
    double limit_step;                             /* [s] */
    uint64_t steps, rejected, rhs_calls;
    weft_limit_stats limit;
    uint64_t vetoed;
    uint64_t linear_iterations, factorisations, newton_failures;
    double event_since; /* [s] */
    uint64_t flags;     /* WEFT__SAVED_... */
} weft__save_fields;

/* The front as far as it has one length. */
typedef struct weft__save_head {
    char magic[WEFT__WORD];
    uint64_t version, rows, cols, quadratures, cloth, settings;
    char name[WEFT__SAVE_NAME]; /* cut to the room, then zeros */
    weft__save_fields fields;
    uint64_t changes; /* [words] */
} weft__save_head;
enum { SAVE_HEAD = sizeof(weft__save_head) / WEFT__WORD };

/* [words] Of the front of a simulation with so many of changes, the checksum the last.
 */
static inline size_t weft__save_front(const weft_sim *sim, size_t changes)
{
    return SAVE_HEAD + sim->config.quadratures + changes + 1;
}

static inline size_t weft__save_planes(const weft_sim *sim)
{
    return WEFT__SAVE_PLANES + 6 * sim->sensitivity.count;
}

/* Of the whole cloth, in a plane. */
static inline size_t weft__save_particles(const weft_sim *sim)
{
    return weft__whole_particles(&sim->cloth->mesh);
}

/* save_format9.c: the least of a front in format 9, which 0.2 wrote; and such a front
 * of `words` as it is now, *now words, or NULL: no memory. */
enum { WEFT__SAVE_VERSION_9 = 9 };
size_t weft__save_front_9(const weft_sim *sim);
unsigned char *weft__save_from_9(const weft_sim *sim, const unsigned char *front,
                                 size_t words, size_t *now);

/* That of a simulation. */
weft__save_head weft__save_head_of(const weft_sim *sim);

/* The checksum, on band 0: of `words` words of the front and of all rows of y, holds
 * and the planes of sensitivities s, whose particles are those here. Collective. */
uint64_t weft__save_sum(const weft_sim *sim, const double *y, const double *s,
                        const uint64_t *holds, const unsigned char *front,
                        size_t words);

/* Replaces the stepper; only the h to try and the counts remain. Collective. */
weft_status weft__sim_renew(weft_sim *sim, const weft__save_fields *counted,
                            weft_error *err);
