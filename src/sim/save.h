/* SPDX-License-Identifier: BSD-3-Clause */
/* save.h -- the bytes of a saved simulation, for save.c and restore.c.
 *
 * Words (bytes.h). First the front: "weftsave", version, blocks, cols (of triangles:
 * particles), quadratures, hashes of the cloth's definition and of the settings, the
 * method's name in 64 bytes, fields, quadratures of y, the number of shapes, a hash of
 * the law of contact, the shapes (kind, the numbers of weft_shape from `at` on, since
 * when it moves so), checksum. Then planes of all particles: the six of y, their
 * holds, and with sensitivities the six of each. The checksum is that of the front
 * before it and of a word for each row: the checksum of the row's words, plane by
 * plane. */
#pragma once

#include "base/bytes.h"
#include "sim/simulation.h"

enum { WEFT__SAVE_VERSION = 9, WEFT__SAVE_PLANES = 7, WEFT__SAVE_NAME = 64 };

#define WEFT__SAVE_MAGIC "weftsave"

/* The wind has changed; frame_check.c has found a passage. */
enum { WEFT__SAVED_WIND = 1, WEFT__SAVED_PASSAGE = 2, WEFT__SAVED_FLAGS = 3 };

/* All that is saved besides the state, in words. */
typedef struct weft__save_fields {
    double t, next_step, last_step;                /* [s] */
    double energy_start, work_limit, work_outside; /* [J] */
    double limit_step;                             /* [s] */
    uint64_t steps, rejected, rhs_calls;
    weft_limit_stats limit;
    uint64_t vetoed;
    uint64_t linear_iterations, factorisations, newton_failures;
    double event_since;        /* [s] */
    uint64_t flags;            /* WEFT__SAVED_... */
    double wind[3], wind_drag; /* of use if it has changed */
} weft__save_fields;

/* The front as far as it has one length. */
typedef struct weft__save_head {
    char magic[WEFT__WORD];
    uint64_t version, rows, cols, quadratures, cloth, settings;
    char name[WEFT__SAVE_NAME]; /* cut to the room, then zeros */
    weft__save_fields fields;
} weft__save_head;
enum { SAVE_HEAD = sizeof(weft__save_head) / WEFT__WORD };

/* What weft_shape has behind `kind`, but a body. */
enum {
    AT_REALS = offsetof(weft_shape, at),
    SHAPE_REALS = (offsetof(weft_shape, body) - AT_REALS) / sizeof(double),
    SHAPE_WORDS = 1 + SHAPE_REALS + 1
};

/* [words] Of the front of a simulation with so many shapes, the checksum the last. */
static inline size_t weft__save_front(const weft_sim *sim, size_t shapes)
{
    return SAVE_HEAD + sim->config.quadratures + 2 + SHAPE_WORDS * shapes + 1;
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
