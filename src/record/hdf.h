/* SPDX-License-Identifier: BSD-3-Clause */
/* hdf.h -- the calls of libhdf5 that both the writer and the reader of frames need. */
#ifndef WEFT_RECORD_HDF_H
#define WEFT_RECORD_HDF_H

#include <hdf5.h>

#include "weft/base.h"

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

/* The rows of frame `frame`. */
bool hdf_write(const hdf_set *set, size_t frame, const void *values);
bool hdf_read(const hdf_set *set, size_t frame, void *values);

#endif
