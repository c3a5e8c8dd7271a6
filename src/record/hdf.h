/* SPDX-License-Identifier: BSD-3-Clause */
/* hdf.h -- the little of libhdf5 that a run's frames need, for writer and reader. */
#ifndef WEFT_RECORD_HDF_H
#define WEFT_RECORD_HDF_H

#include <hdf5.h>

#include "weft/base.h"

/* A dataset of `rows` rows for each frame, `width` values a row. */
typedef struct hdf_set {
    hid_t id;
    size_t rows, width;
} hdf_set;

/* Call before anything else of libhdf5: it prints nothing from now on, and does nothing
 * at the program's exit. When the system refuses something, its errno goes to *why if
 * that is 0; NULL: to nobody. */
void hdf_begin(int *why);

/* How files are opened: closing one closes all that is open in it; no locks, so that a
 * file can be read while it grows; values go to the file at once, and what describes
 * them stands together. Close with H5Pclose. */
hid_t hdf_access(void);

/* Rows of frame `frame`, to or from values of type `memory`. */
bool hdf_write(const hdf_set *set, size_t frame, hid_t memory, const void *values);
bool hdf_read(const hdf_set *set, size_t frame, hid_t memory, void *values);

#endif
