/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.h -- reads the frames of a run directory, for exports, pages and comparisons.
 *
 * Numbers are as in the file: single precision unless the run recorded doubles. */
#ifndef WEFT_RECORD_FRAMES_H
#define WEFT_RECORD_FRAMES_H

#include "record/faces.h"

typedef struct record_frames {
    record_faces faces;
    size_t count, planned;           /* planned: frames that the file has room for */
    bool doubles;                    /* else single precision */
    bool fields[WEFT_RECORD_FIELDS]; /* those that the run recorded */
    const double *times;             /* [s] */
    const double *numbers;           /* their numbers in series.csv: not 0, 1, 2, ... if
                                        record.every is not 1 */
    const double *rest;              /* [m] rest positions: x y z of each */
    const uint8_t *pinned;           /* 0 or 1 for each particle; NULL: not recorded */
} record_frames;

/* Opens DIR/run.vtkhdf, up to its last committed frame. Errors: WEFT_IO names the file
 * and its fault. */
weft_status record_frames_open(const char *directory, record_frames **out,
                               weft_error *err);
void record_frames_close(record_frames *frames); /* NULL is allowed */

/* [m] x y z of particle 0, x y z of particle 1, ...: 3 N doubles. */
weft_status record_frames_positions(record_frames *frames, size_t i, double *xyz,
                                    weft_error *err);
/* Velocities [m/s], 3 N doubles likewise, or the largest strain (L - s) / s of the
 * springs at each particle, N doubles. WEFT_UNSUPPORTED: not recorded. */
weft_status record_frames_field(record_frames *frames, weft_record_field field,
                                size_t i, double *values, weft_error *err);

#endif
