/* SPDX-License-Identifier: BSD-3-Clause */
/* shared_file.h -- files that rank 0 makes and that each band writes or reads at places
 * of its own. */
#ifndef WEFT_RECORD_SHARED_FILE_H
#define WEFT_RECORD_SHARED_FILE_H

#include "record/record.h"

/* Opens the file that rank 0 has made; *file < 0: not open. Collective. Errors:
 * WEFT_IO; also if another band sees another file, or none. */
weft_status record_shared_open(const weft_comm *comm, const char *path, int flags,
                               int *file, weft_error *err);

/* All bytes, at a place [bytes]; false: errno says why. */
bool record_write_at(int file, const void *bytes, size_t size, uint64_t at);
bool record_read_at(int file, void *bytes, size_t size, uint64_t at);

#endif
