/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf_file.h -- creates run.vtkhdf with everything in it before the first frame.
 *
 * Everything has its place and size from the start, so that adding a frame allocates
 * nothing in the file: a kill between two writes cannot break its structure. Only the
 * extent of Steps/Values grows, within one chunk that is there from the start, as VTK
 * needs exactly NSteps times: with more its reader overruns a buffer, with fewer it
 * confuses frames. */
#pragma once

#include <hdf5.h>

#include "program/record/vtkhdf.h"

/* ---- the calls of libhdf5 that both the writer and the reader of frames need ---- */

/* A dataset of `rows` rows per frame and `width` values per row. */
typedef struct hdf_set {
    hid_t id, memory; /* type of its values in memory */
    size_t rows, width;
} hdf_set;

/* Call before anything else of libhdf5: it prints nothing from now on, and does nothing
 * at the program's exit. When the system refuses something, its errno goes to *why if
 * that is 0; NULL: it is dropped. */
void hdf_begin(int *why);

/* How files are opened: closing one closes all that is open in it; no locks, so that a
 * file can be read while it grows; values go to the file at once, and metadata are kept
 * together. Close with H5Pclose. */
hid_t hdf_access(void);

/* Of the name of a cloth; close with H5Tclose. */
hid_t hdf_name_type(void);

/* The rows of frame `frame`. */
bool hdf_write(const hdf_set *set, size_t frame, const void *values);
bool hdf_read(const hdf_set *set, size_t frame, void *values);

/* ---- the file ---- */

#define VTKHDF_FRAME_FIELD "frame" /* the field data with the frame's number */

/* Field data are the columns of the series except the hash, which is not a double. */
bool vtkhdf_is_field(const char *column);

/* Creates `path` with room for `capacity` frames and NSteps = 0. False if that fails.
 */
bool vtkhdf_file_create(const char *path, const record_vtkhdf_def *def,
                        size_t capacity);

/* Reads the page with the counts of frames: NSteps and the extent of Steps/Values. */
bool vtkhdf_read_page(const char *path, unsigned char page[RECORD_PAGE]);
/* Whether `now` equals `before` or only has more frames. */
bool vtkhdf_is_same_page(const unsigned char *before, const unsigned char *now,
                         size_t frames, size_t capacity);

/* ---- vtkhdf_rows.c: the particles' data of the frames. Each band writes its own rows
 * to their places in the file, which is made with libhdf5 by rank 0 alone ---- */

enum {
    VTKHDF_POINTS,
    VTKHDF_VELOCITY,
    VTKHDF_STRAIN,
    VTKHDF_SENSITIVITY, /* with respect to each parameter */
    VTKHDF_ROW_SETS = VTKHDF_SENSITIVITY + WEFT_SENSITIVITIES
};

typedef struct vtkhdf_rows {
    const weft_comm *comm;   /* NULL: one band, the whole cloth */
    const weft_cloth *whole; /* of bands of triangles, on rank 0; else NULL */
    weft_band band;          /* of triangles a single row of all, which rank 0 has */
    size_t cols;
    size_t skip, own; /* particles of bands of triangles */
    bool doubles;
    int file;                         /* < 0: not open */
    uint64_t places[VTKHDF_ROW_SETS]; /* [bytes] in the file; 0: not recorded */
    double *buffer; /* 3 values for each particle of the band, or of a row */
    double *all;    /* rank 0, of bands of triangles: the same in their order */
    uint64_t *sums, *all_sums; /* of rows: own; rank 0: of all bands */
} vtkhdf_rows;

/* Allocates; false: no memory. The file is not open yet. */
bool vtkhdf_rows_begin(vtkhdf_rows *self, const record_vtkhdf_def *def);
void vtkhdf_rows_end(vtkhdf_rows *self);

/* Opens the file that rank 0 has made, with rank 0's places. Collective. Errors:
 * WEFT_IO; also if another band sees another file, or none. */
weft_status vtkhdf_rows_open(vtkhdf_rows *self, const char *path, int flags,
                             weft_error *err);

/* Writes the own rows of a set, `width` values per particle, from the buffer, or reads
 * them and leaves `sums` of what the file has. false: errno says why. */
bool vtkhdf_rows_write(vtkhdf_rows *self, size_t set, size_t width, size_t frame);
bool vtkhdf_rows_read(vtkhdf_rows *self, size_t set, size_t width, size_t frame);

/* On rank 0, a sum continued by those of all rows; collective. */
uint64_t vtkhdf_rows_sum(vtkhdf_rows *self, uint64_t sum);
