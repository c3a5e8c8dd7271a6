/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.h -- the frames of a run directory, whoever asks: export, the player.
 *
 * Planes as in the file: single precision unless the run recorded doubles. */
#ifndef WEFT_RECORD_FRAMES_H
#define WEFT_RECORD_FRAMES_H

#include "weft/weft.h"

typedef struct record_frames record_frames;

/* Opens DIR/run.vtkhdf, up to its last committed frame. Errors: WEFT_IO with the file
 * and what is wrong with it. */
weft_status record_frames_open(const char *directory, record_frames **out,
                               weft_error *err);
void record_frames_close(record_frames *frames); /* NULL is allowed */

size_t record_frames_count(const record_frames *frames);
size_t record_frames_planned(const record_frames *frames); /* there is room for */
size_t record_frames_rows(const record_frames *frames);
size_t record_frames_cols(const record_frames *frames);
double record_frames_time(const record_frames *frames, size_t i); /* [s] */
/* Its number in the run, as in series.csv: not i where record.every is not 1. */
size_t record_frames_number(const record_frames *frames, size_t i);
bool record_frames_doubles(const record_frames *frames); /* else single precision */
/* Whether all frames have it; pinned() is false for all particles without. */
bool record_frames_has(const record_frames *frames, weft_record_field field);
bool record_frames_pinned(const record_frames *frames, size_t particle);

/* x y z of particle 0, x y z of particle 1, ...: 3 N doubles each. Velocities may be
 * absent (record.fields): WEFT_UNSUPPORTED. */
weft_status record_frames_positions(record_frames *frames, size_t i, double *xyz,
                                    weft_error *err); /* [m] */
weft_status record_frames_velocities(record_frames *frames, size_t i, double *xyz,
                                     weft_error *err); /* [m/s] */
/* Largest (L - s) / s of the springs at each particle: N doubles. */
weft_status record_frames_strain(record_frames *frames, size_t i, double *strain,
                                 weft_error *err);

/* Where the particles rest: 3 N doubles, valid until the frames are closed. */
const double *record_frames_rest(const record_frames *frames); /* [m] */

#endif
