/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/hdf.h"

#include <stdlib.h>
#include <string.h>

/* libhdf5 reports errno only inside a sentence. */
static herr_t look_for_errno(unsigned depth, const H5E_error2_t *entry, void *why)
{
    static const char label[] = "errno = ";
    const char *found = entry->desc == NULL ? NULL : strstr(entry->desc, label);
    (void)depth;
    if (found != NULL && *(int *)why == 0) {
        *(int *)why = (int)strtol(found + strlen(label), NULL, 10);
    }
    return 0;
}

static herr_t on_failure(hid_t stack, void *why)
{
    return H5Ewalk2(stack, H5E_WALK_UPWARD, look_for_errno, why);
}

void hdf_begin(int *why)
{
    (void)H5dont_atexit();
    (void)H5Eset_auto2(H5E_DEFAULT, why == NULL ? NULL : on_failure, why);
}

hid_t hdf_access(void)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    (void)H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    (void)H5Pset_sieve_buf_size(access, 0);
    (void)H5Pset_meta_block_size(access, 1 << 15);
#if H5_VERSION_GE(1, 10, 7) && (H5_VERS_MINOR != 12 || H5_VERS_RELEASE > 0)
    (void)H5Pset_file_locking(access, false, true);
#endif
    return access;
}

/* Writes `from` to the rows of a frame, or if that is NULL reads them into `to`. */
static bool transfer(const hdf_set *set, size_t frame, const void *from, void *to)
{
    const hsize_t start[2] = { (hsize_t)frame * set->rows, 0 };
    const hsize_t count[2] = { set->rows, set->width }, numbers = count[0] * count[1];
    const hid_t file = H5Dget_space(set->id);
    const hid_t flat = H5Screate_simple(1, &numbers, NULL);
    const hid_t id = set->id, type = set->memory;
    const bool done
        = file >= 0 && flat >= 0
          && H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0
          && (from != NULL ? H5Dwrite(id, type, flat, file, H5P_DEFAULT, from)
                           : H5Dread(id, type, flat, file, H5P_DEFAULT, to))
                 >= 0;
    (void)H5Sclose(flat);
    (void)H5Sclose(file);
    return done;
}

bool hdf_write(const hdf_set *set, size_t frame, const void *values)
{
    return transfer(set, frame, values, NULL);
}

bool hdf_read(const hdf_set *set, size_t frame, void *values)
{
    return transfer(set, frame, NULL, values);
}
