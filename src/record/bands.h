/* SPDX-License-Identifier: BSD-3-Clause */
/* bands.h -- files of a cloth in bands (weft/comm.h): rank 0 makes each, and every rank
 * writes its own rows to their places. With comm NULL there is one band, the whole
 * cloth. All functions with a comm are collective. */
#ifndef WEFT_RECORD_BANDS_H
#define WEFT_RECORD_BANDS_H

#include "record/record.h"

/* The error of the first band that has one, for all bands; it names the band. err may
 * be NULL. */
weft_status record_agree(const weft_comm *comm, weft_status status, weft_error *err);

/* `size` bytes of each own row of each band, from the first row on, to rank 0, into
 * *all, which is allocated; NULL on other ranks. */
weft_status record_gather(const weft_comm *comm, const weft_band *band,
                          const void *mine, size_t size, void **all, weft_error *err);

/* Writes or reads all bytes at that place of the file; false: errno says why. */
bool record_write_at(int file, const void *bytes, size_t size, uint64_t at);
bool record_read_at(int file, void *bytes, size_t size, uint64_t at);

#endif
