/* SPDX-License-Identifier: BSD-3-Clause */
/* export_cache.c -- point caches: the positions of all frames in one file. */
#include "record/export/export.h"

static void write_points(FILE *stream, const record_surface *surface, bool big)
{
    for (size_t i = 0; i < 3 * surface->faces.particles; ++i) {
        record_put_float(stream, surface->position[i], big);
    }
}

/* ---- MDD: big-endian; frames, points, times [s], positions -------------------- */

static void begin_mdd(FILE *stream, const double *times, size_t frames,
                      size_t particles)
{
    record_put(stream, frames, 4, true);
    record_put(stream, particles, 4, true);
    for (size_t i = 0; i < frames; ++i) {
        record_put_float(stream, times[i], true);
    }
}

static void points_mdd(FILE *stream, const record_surface *surface)
{
    write_points(stream, surface, true);
}

const record_movie record_mdd = { .begin = begin_mdd, .points = points_mdd };

/* ---- PC2: little-endian; a sample a frame, from frame 0 ------------------------ */

static void begin_pc2(FILE *stream, const double *times, size_t frames,
                      size_t particles)
{
    (void)times;
    fwrite("POINTCACHE2", 1, 12, stream);
    record_put(stream, 1, 4, false); /* version */
    record_put(stream, particles, 4, false);
    record_put_float(stream, 0.0, false); /* first frame */
    record_put_float(stream, 1.0, false); /* frames per sample */
    record_put(stream, frames, 4, false);
}

static void points_pc2(FILE *stream, const record_surface *surface)
{
    write_points(stream, surface, false);
}

const record_movie record_pc2 = { .begin = begin_pc2, .points = points_pc2 };
