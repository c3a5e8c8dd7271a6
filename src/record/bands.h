/* SPDX-License-Identifier: BSD-3-Clause */
/* bands.h -- files of a cloth in bands (weft/comm.h): rank 0 makes each, and every rank
 * writes its own rows to their places. With comm NULL there is one band, the whole
 * cloth. All functions with a comm are collective. */
#ifndef WEFT_RECORD_BANDS_H
#define WEFT_RECORD_BANDS_H

#include "record/record.h"

/* Writes or reads all bytes at that place of the file; false: errno says why. */
bool record_write_at(int file, const void *bytes, size_t size, uint64_t at);
bool record_read_at(int file, void *bytes, size_t size, uint64_t at);

#endif
