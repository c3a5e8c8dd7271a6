/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.c -- frames into run.vtkhdf: first all of a frame's data, then, in one write,
 * that it is there. */
#include "record/frames.h"
#include "record/vtkhdf_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Room is made for all frames at once, which costs no space before they come; a file
 * system may refuse a file beyond 16 TiB. */
#define MOST_BYTES ((size_t)1 << 43)

enum {
    POINTS,
    VELOCITY,
    STRAIN,
    PARTS,
    POINT_OFFSETS,
    FIELD_OFFSETS,
    FIELD_SIZES,
    SETS
};

/* What a frame is written to, beside its field data and its time. */
static const struct {
    const char *path;
    bool particles; /* a row each, else one row */
    size_t width;
} layout[SETS] = {
    [POINTS] = { "/VTKHDF/Points", true, 3 },
    [VELOCITY] = { "/VTKHDF/PointData/velocity", true, 3 },
    [STRAIN] = { "/VTKHDF/PointData/strain", true, 1 },
    [PARTS] = { "/VTKHDF/Steps/NumberOfParts", false, 1 },
    [POINT_OFFSETS] = { "/VTKHDF/Steps/PointOffsets", false, 1 },
    [FIELD_OFFSETS] = { "/weft/FieldOffsets", false, 1 },
    [FIELD_SIZES] = { "/weft/FieldSizes", false, 2 },
};

struct record_vtkhdf {
    record_vtkhdf_def def;
    char path[RECORD_PATH], temporary[RECORD_PATH];
    size_t n, capacity, count; /* particles; frames: room, written */
    hid_t file, step_count;    /* file < 0: not open; NSteps */
    hdf_set sets[SETS], fields[RECORD_COLUMNS_MAX], time;
    double *buffer; /* 3 N */
    int why;        /* errno of what failed first; 0: not known */
};

static weft_status failed(const record_vtkhdf *self, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: %s", self->path,
                          self->why == 0 ? "write failed" : strerror(self->why));
}

/* ---- opening ---------------------------------------------------------------- */

static size_t capacity_of(const record_vtkhdf_def *def)
{
    const size_t planned
        = (def->last + def->record->every - 1) / def->record->every + 1;
    const size_t most
        = MOST_BYTES / (7 * sizeof(double) * weft_cloth_particles(def->cloth) + 1024);
    return planned < most ? planned : most;
}

weft_status record_vtkhdf_create(const record_vtkhdf_def *def, record_vtkhdf **out,
                                 weft_error *err)
{
    *out = NULL;
    record_vtkhdf *self = calloc(1, sizeof *self);
    const size_t n = weft_cloth_particles(def->cloth);
    double *buffer = malloc(3 * n * sizeof *buffer);
    if (self == NULL || buffer == NULL) {
        free(buffer);
        free(self);
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a frame");
    }
    hdf_begin(&self->why);
    self->def = *def;
    self->n = n;
    self->capacity = capacity_of(def);
    self->file = H5I_INVALID_HID;
    self->buffer = buffer;
    const weft_status status
        = record_path(def->directory, "run.vtkhdf", self->path, err);
    if (status != WEFT_OK) {
        (void)record_vtkhdf_close(self, NULL);
        return status;
    }
    memcpy(self->temporary, self->path, strlen(self->path) + 1);
    strcat(self->temporary, ".tmp");
    *out = self;
    return WEFT_OK;
}

static bool open_set(const record_vtkhdf *self, hdf_set *set, const char *path,
                     size_t rows, size_t width)
{
    const hid_t id = H5Dopen2(self->file, path, H5P_DEFAULT);
    *set = (hdf_set){ id, rows, width };
    return id >= 0;
}

static bool is_left_out(const record_vtkhdf *self, size_t set)
{
    const bool *wanted = self->def.record->fields;
    return (set == VELOCITY && !wanted[WEFT_RECORD_VELOCITY])
           || (set == STRAIN && !wanted[WEFT_RECORD_STRAIN]);
}

static bool open_sets(record_vtkhdf *self)
{
    const record_series *series = self->def.series;
    bool good = true;
    for (size_t i = 0; good && i < SETS; ++i) {
        good = is_left_out(self, i)
               || open_set(self, &self->sets[i], layout[i].path,
                           layout[i].particles ? self->n : 1, layout[i].width);
    }
    for (size_t i = 0; good && i < series->columns; ++i) {
        char name[160];
        (void)snprintf(name, sizeof name, "/VTKHDF/FieldData/%s", series->names[i]);
        good = !vtkhdf_is_field(series->names[i])
               || open_set(self, &self->fields[i], name, 1, 1);
    }
    return good;
}

/* A time goes to the file alone, not with all the chunk it is in. */
static bool open_times(record_vtkhdf *self)
{
    const hid_t direct = H5Pcreate(H5P_DATASET_ACCESS);
    (void)H5Pset_chunk_cache(direct, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
    const hid_t id = H5Dopen2(self->file, "/VTKHDF/Steps/Values", direct);
    (void)H5Pclose(direct);
    self->time = (hdf_set){ id, 1, 1 };
    /* what H5Aopen_by_name opens cannot be written (1.10.8) */
    const hid_t steps = H5Gopen2(self->file, "/VTKHDF/Steps", H5P_DEFAULT);
    self->step_count = H5Aopen(steps, "NSteps", H5P_DEFAULT);
    (void)H5Gclose(steps);
    return id >= 0 && self->step_count >= 0;
}

static bool open_file(record_vtkhdf *self, const char *path)
{
    const hid_t access = hdf_access();
    self->file = H5Fopen(path, H5F_ACC_RDWR, access);
    (void)H5Pclose(access);
    return self->file >= 0 && open_sets(self) && open_times(self);
}

static bool close_file(record_vtkhdf *self)
{
    const hid_t file = self->file;
    self->file = H5I_INVALID_HID;
    return file < 0 || H5Fclose(file) >= 0;
}

/* ---- opening again ---------------------------------------------------------- */

/* Read by who trusts nothing before libhdf5 is let loose on it here. */
static weft_status check_frames(const record_vtkhdf *self, size_t count,
                                weft_error *err)
{
    const record_vtkhdf_def *def = &self->def;
    record_frames *there = NULL;
    weft_status status = record_no_link(self->path, err);
    status
        = status == WEFT_OK ? record_frames_open(def->directory, &there, err) : status;
    if (status != WEFT_OK) {
        return status;
    }
    const bool fits = record_frames_rows(there) == weft_cloth_rows(def->cloth)
                      && record_frames_cols(there) == weft_cloth_cols(def->cloth)
                      && record_frames_doubles(there) == def->record->doubles
                      && record_frames_count(there) >= count && count > 0;
    record_frames_close(there);
    return fits ? WEFT_OK
                : weft_error_set(err, WEFT_IO,
                                 "%s: damaged: it has not the frames it had",
                                 self->path);
}

/* As after the commit of the last frame that is kept. A smaller extent overwrites the
 * times behind it at once: by then NSteps has left them out. */
static bool cut(record_vtkhdf *self, size_t count)
{
    const int64_t steps = (int64_t)count;
    const hsize_t extent = count;
    self->count = count;
    return H5Awrite(self->step_count, H5T_NATIVE_INT64, &steps) >= 0
           && H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0
           && H5Dset_extent(self->time.id, &extent) >= 0
           && H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0;
}

weft_status record_vtkhdf_reopen(const record_vtkhdf_def *def, size_t count,
                                 record_vtkhdf **out, weft_error *err)
{
    weft_status status = record_vtkhdf_create(def, out, err);
    if (status != WEFT_OK) {
        return status;
    }
    record_vtkhdf *self = *out;
    status = check_frames(self, count, err);
    hdf_begin(&self->why);
    if (status == WEFT_OK && !(open_file(self, self->path) && cut(self, count))) {
        status = failed(self, err);
    }
    if (status != WEFT_OK) {
        (void)record_vtkhdf_close(self, NULL);
        *out = NULL;
    }
    return status;
}

/* ---- a frame ---------------------------------------------------------------- */

static bool write_set(const record_vtkhdf *self, size_t set, const double *values)
{
    return hdf_write(&self->sets[set], self->count, H5T_NATIVE_DOUBLE, values);
}

static bool write_integers(const record_vtkhdf *self, size_t set, const int64_t *values)
{
    return hdf_write(&self->sets[set], self->count, H5T_NATIVE_INT64, values);
}

static bool write_particles(record_vtkhdf *self, const weft_sim *sim)
{
    weft_sim_positions(sim, self->buffer);
    bool good = write_set(self, POINTS, self->buffer);
    if (good && !is_left_out(self, VELOCITY)) {
        weft_sim_velocities(sim, self->buffer);
        good = write_set(self, VELOCITY, self->buffer);
    }
    if (good && !is_left_out(self, STRAIN)) {
        weft_cloth_strains(self->def.cloth, weft_sim_state(sim), self->buffer);
        good = write_set(self, STRAIN, self->buffer);
    }
    return good;
}

static bool write_tables(record_vtkhdf *self)
{
    const record_series *series = self->def.series;
    const int64_t ones[2] = { 1, 1 }, step = (int64_t)self->count;
    const int64_t first_point = (int64_t)(self->count * self->n);
    bool good = write_integers(self, PARTS, ones)
                && write_integers(self, POINT_OFFSETS, &first_point)
                && write_integers(self, FIELD_OFFSETS, &step)
                && write_integers(self, FIELD_SIZES, ones);
    for (size_t i = 0; good && i < series->columns; ++i) {
        good = !vtkhdf_is_field(series->names[i])
               || hdf_write(&self->fields[i], self->count, H5T_NATIVE_DOUBLE,
                            &series->row[i]);
    }
    return good;
}

/* The time is beyond the end of Values until its extent grows. NSteps and that extent
 * go to the file in one write (vtkhdf_file.c). */
static bool commit(record_vtkhdf *self, double t)
{
    const int64_t steps = (int64_t)self->count + 1;
    const hsize_t extent = (hsize_t)steps;
    return H5Dset_extent(self->time.id, &extent) >= 0
           && hdf_write(&self->time, self->count, H5T_NATIVE_DOUBLE, &t)
           && H5Awrite(self->step_count, H5T_NATIVE_INT64, &steps) >= 0
           && H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0;
}

static bool write_frame(record_vtkhdf *self, const weft_sim *sim)
{
    if (!write_particles(self, sim) || !write_tables(self)
        || !commit(self, weft_sim_time(sim))) {
        return false;
    }
    ++self->count;
    return true;
}

/* The file appears with a frame in it, as no reader expects one without. It is closed
 * in between: the first closing gives back room in the file. */
static bool write_first(record_vtkhdf *self, const weft_sim *sim)
{
    (void)remove(self->temporary); /* it may be a link */
    const bool made = vtkhdf_file_create(self->temporary, &self->def, self->capacity)
                      && open_file(self, self->temporary) && write_frame(self, sim);
    if (!close_file(self) || !made) {
        self->count = 0;
        return false;
    }
    if (rename(self->temporary, self->path) != 0) {
        self->why = errno;
        self->count = 0;
        return false;
    }
    return open_file(self, self->path);
}

weft_status record_vtkhdf_add(record_vtkhdf *self, const record_frame *frame,
                              weft_error *err)
{
    if (frame->index % self->def.record->every != 0 && frame->index != self->def.last) {
        return WEFT_OK;
    }
    if (self->count == self->capacity) {
        return weft_error_set(err, WEFT_IO, "%s: full with %zu frames", self->path,
                              self->count);
    }
    if (self->count == 0 ? write_first(self, frame->sim)
                         : write_frame(self, frame->sim)) {
        return WEFT_OK;
    }
    return failed(self, err);
}

/* ---- the end ---------------------------------------------------------------- */

static bool sync_file(record_vtkhdf *self)
{
    void *descriptor = NULL;
    if (self->file < 0) {
        return true;
    }
    if (H5Fget_vfd_handle(self->file, H5P_DEFAULT, &descriptor) < 0) {
        return false;
    }
    if (fsync(*(int *)descriptor) != 0) {
        self->why = errno;
        return false;
    }
    return true;
}

weft_status record_vtkhdf_sync(record_vtkhdf *self, size_t *count, weft_error *err)
{
    *count = self->count;
    return sync_file(self) ? WEFT_OK : failed(self, err);
}

weft_status record_vtkhdf_close(record_vtkhdf *self, weft_error *err)
{
    if (self == NULL) {
        return WEFT_OK;
    }
    const bool synced = sync_file(self), good = close_file(self) && synced;
    hdf_begin(NULL);
    if (self->count == 0 && self->temporary[0] != '\0') {
        (void)remove(self->temporary);
    }
    const weft_status status = good ? WEFT_OK : failed(self, err);
    free(self->buffer);
    free(self);
    return status;
}
