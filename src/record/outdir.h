/* SPDX-License-Identifier: BSD-3-Clause */
/* outdir.h -- the directory of a run: made, emptied, locked. */
#ifndef WEFT_RECORD_OUTDIR_H
#define WEFT_RECORD_OUTDIR_H

#include "weft/base.h"

/* Makes `directory` and its parents unless they exist. */
weft_status record_directory(const char *directory, weft_error *err);

/* Makes `directory`, or accepts an empty one. One that is not empty is
 * refused unless `force`, which removes the files of an earlier run of weft. */
weft_status record_outdir(const char *directory, bool force, weft_error *err);

/* Makes `directory` if need be and locks it for this process until *lock is closed or
 * the process ends. WEFT_IO if another process has the lock for `patience` [s]: one
 * that was killed keeps it until the system has cleaned up. */
#define RECORD_PATIENCE 0.2
weft_status record_outdir_lock(const char *directory, double patience, int *lock,
                               weft_error *err);

/* Whether a process has that lock. */
bool record_outdir_locked(const char *directory);

/* result_read.c: whether a run was begun there that has not ended by itself. */
bool record_unfinished(const char *directory);

/* The names of all files that weft writes there, NULL at their end. */
extern const char *const record_names[];

#endif
