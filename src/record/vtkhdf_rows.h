/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf_rows.h -- the particles' data of the frames of run.vtkhdf: each band writes
 * its own rows to their places in the file, which is made with libhdf5 by rank 0 alone.
 */
#ifndef WEFT_RECORD_VTKHDF_ROWS_H
#define WEFT_RECORD_VTKHDF_ROWS_H

#include "record/record.h"

enum { VTKHDF_POINTS, VTKHDF_VELOCITY, VTKHDF_STRAIN, VTKHDF_ROW_SETS };

typedef struct vtkhdf_rows {
    const weft_comm *comm; /* NULL: one band, the whole cloth */
    weft_band band;        /* of triangles a single row of all */
    size_t cols;
    bool doubles;
    int file;                         /* < 0: not open */
    uint64_t places[VTKHDF_ROW_SETS]; /* [bytes] in the file; 0: not recorded */
    double *buffer;                   /* 3 values for each particle of the band */
    uint64_t *sums, *all_sums;        /* of rows: own; rank 0: of all bands */
} vtkhdf_rows;

/* Allocates; false: no memory. The file is not open yet. */
bool vtkhdf_rows_begin(vtkhdf_rows *self, const weft_comm *comm,
                       const weft_cloth *cloth, bool doubles);
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

#endif
