/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.c -- writes frames into run.vtkhdf: first all data of a frame, then, in one
 * write, the counts that include it. */
#include "program/record/checkpoint.h"
#include "program/record/vtkhdf_file.h"

#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"

/* Room is made for all frames at once, which takes no space before they are written; a
 * file system may refuse a file beyond 16 TiB. */
#define MOST_BYTES ((size_t)1 << 43)

/* The sets that a frame is written to, in this order; the last is its time. */
enum {
    POINTS = VTKHDF_POINTS,
    VELOCITY = VTKHDF_VELOCITY,
    STRAIN = VTKHDF_STRAIN,
    SENSITIVITY = VTKHDF_SENSITIVITY,
    PARTS = VTKHDF_ROW_SETS,
    POINT_OFFSETS,
    FIELD_OFFSETS,
    FIELD_SIZES,
    FIELDS, /* field data, one set per column of the series */
    SETS_MAX = FIELDS + RECORD_COLUMNS_MAX + 1
};

static const struct {
    const char *path;
    size_t width;
} layout[FIELDS] = {
    [POINTS] = { "/VTKHDF/Points", 3 },
    [VELOCITY] = { "/VTKHDF/PointData/velocity", 3 },
    [STRAIN] = { "/VTKHDF/PointData/strain", 1 },
    [PARTS] = { "/VTKHDF/Steps/NumberOfParts", 1 },
    [POINT_OFFSETS] = { "/VTKHDF/Steps/PointOffsets", 1 },
    [FIELD_OFFSETS] = { "/weft/FieldOffsets", 1 },
    [FIELD_SIZES] = { "/weft/FieldSizes", 2 },
};

struct record_vtkhdf {
    record_vtkhdf_def def;
    char path[RECORD_PATH], temporary[RECORD_PATH];
    size_t n, capacity, count; /* particles; frames: room, written */
    vtkhdf_rows rows;          /* the sets up to STRAIN; the rest is rank 0's: */
    hid_t file, step_count;    /* file < 0: not open; NSteps */
    hdf_set sets[SETS_MAX];    /* id < 0: not recorded */
    size_t time;               /* the set of the times, the last */
    record_extent head;        /* [bytes] of the file before its first frame */
    uint64_t sum;              /* over all frames written */
    int why;                   /* errno of the first failure; 0: not known */
};

static bool is_first(const record_vtkhdf *self)
{
    return self->def.comm == NULL || self->def.comm->rank == 0;
}

static weft_status failed(const record_vtkhdf *self, weft_error *err)
{
    const char *why = self->why == 0 ? "write failed" : strerror(self->why);
    return is_first(self) ? weft_error_set(err, WEFT_IO, "%s: %s", self->path, why)
                          : weft_error_set(err, WEFT_IO, "%s: %s (rank %d)", self->path,
                                           why, self->def.comm->rank);
}

/* A failure of one band is one of all. */
static weft_status agree(record_vtkhdf *self, bool good, weft_error *err)
{
    self->why = !good && self->why == 0 && errno == ENOMEM ? ENOMEM : self->why;
    return weft_comm_agree(self->def.comm, good ? WEFT_OK : failed(self, err), err);
}

/* ---- opening ---------------------------------------------------------------- */

size_t record_vtkhdf_planned(const weft_record_def *record, size_t last)
{
    return (last + record->every - 1) / record->every + 1;
}

size_t record_vtkhdf_most(size_t particles)
{
    return MOST_BYTES / (7 * sizeof(double) * particles + 1024);
}

size_t record_vtkhdf_frame(const weft_record_def *record, size_t particles)
{
    const bool *wanted = record->fields;
    const size_t numbers = (wanted[WEFT_RECORD_VELOCITY] ? 6u : 3u)
                           + (wanted[WEFT_RECORD_STRAIN] ? 1u : 0u);
    const size_t real = record->doubles ? sizeof(double) : sizeof(float);
    return numbers * real * particles + 256; /* offsets and field data */
}

weft_status record_vtkhdf_create(const record_vtkhdf_def *def, record_vtkhdf **out,
                                 weft_error *err)
{
    /* libhdf5 crashes if it gets no memory for its caches, less than a megabyte */
    void *volatile room = malloc((size_t)4 << 20); /* volatile: not optimised away */
    free(room);
    *out = NULL;
    if (room == NULL) {
        return weft_error_set(err, WEFT_IO, "%s/run.vtkhdf: %s", def->directory,
                              strerror(ENOMEM));
    }
    char path[RECORD_PATH];
    TRY(record_path(def->directory, "run.vtkhdf", path, err));
    record_vtkhdf *self = calloc(1, sizeof *self);
    vtkhdf_rows rows = { .file = -1 };
    if (self == NULL || !vtkhdf_rows_begin(&rows, def)) {
        vtkhdf_rows_end(&rows);
        free(self);
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a frame");
    }
    hdf_begin(&self->why);
    self->def = *def;
    self->rows = rows;
    self->n = rows.band.rows * rows.cols;
    self->capacity = record_vtkhdf_planned(def->record, def->last);
    self->file = H5I_INVALID_HID;
    self->time = FIELDS + def->series->columns;
    self->sum = WEFT__HASH_START;
    strcpy(self->path, path);
    record_temporary(path, self->temporary);
    *out = self;
    return WEFT_OK;
}

/* Every value is a word. */
static void add_sum(record_vtkhdf *self, const hdf_set *set, const void *values)
{
    const unsigned char *bytes = values;
    for (size_t i = 0; i < set->rows * set->width; ++i) {
        uint64_t word;
        memcpy(&word, bytes + i * sizeof word, sizeof word);
        self->sum = weft__hash_word(self->sum, word);
    }
}

static size_t width_of(size_t set)
{
    return set >= SENSITIVITY && set < PARTS ? 3 : layout[set].width;
}

static bool is_recorded(const record_vtkhdf *self, size_t set)
{
    const bool *wanted = self->def.record->fields;
    return set == VELOCITY ? wanted[WEFT_RECORD_VELOCITY]
           : set == STRAIN ? wanted[WEFT_RECORD_STRAIN]
           : set >= SENSITIVITY && set < PARTS
               ? set - SENSITIVITY < record_series_sensitivities(self->def.series)
           : set >= FIELDS ? vtkhdf_is_field(self->def.series->names[set - FIELDS])
                           : true;
}

static bool open_sets(record_vtkhdf *self)
{
    bool good = true;
    for (size_t i = 0; good && i < self->time; ++i) {
        const bool field = i >= FIELDS;
        char path[160];
        self->sets[i].id = H5I_INVALID_HID;
        if (!is_recorded(self, i)) {
            continue;
        }
        const bool own = i >= SENSITIVITY && i < PARTS;
        (void)snprintf(path, sizeof path, "%s%s",
                       field ? "/VTKHDF/FieldData/"
                       : own ? "/VTKHDF/PointData/s_"
                             : layout[i].path,
                       field ? self->def.series->names[i - FIELDS]
                       : own ? weft_scene_sensitivities(self->def.series->scene)
                                   ->keys[i - SENSITIVITY]
                             : "");
        self->sets[i]
            = (hdf_set){ .id = H5Dopen2(self->file, path, H5P_DEFAULT),
                         .memory = field ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
                         .rows = 1,
                         .width = field ? 1 : width_of(i) };
        good = self->sets[i].id >= 0;
    }
    return good;
}

/* Without a cache, a time is written alone, not with the whole chunk around it. */
static bool open_times(record_vtkhdf *self)
{
    const hid_t direct = H5Pcreate(H5P_DATASET_ACCESS);
    (void)H5Pset_chunk_cache(direct, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT);
    const hid_t id = H5Dopen2(self->file, "/VTKHDF/Steps/Values", direct);
    (void)H5Pclose(direct);
    self->sets[self->time] = (hdf_set){ id, H5T_NATIVE_DOUBLE, 1, 1 };
    /* HDF5 1.10.8 cannot write to an attribute from H5Aopen_by_name */
    const hid_t steps = H5Gopen2(self->file, "/VTKHDF/Steps", H5P_DEFAULT);
    self->step_count = H5Aopen(steps, "NSteps", H5P_DEFAULT);
    (void)H5Gclose(steps);
    return id >= 0 && self->step_count >= 0;
}

static bool open_file(record_vtkhdf *self, const char *path, unsigned mode)
{
    const hid_t access = hdf_access();
    self->file = H5Fopen(path, mode, access);
    (void)H5Pclose(access);
    if (self->file < 0 || !open_sets(self) || !open_times(self)) {
        return false;
    }
    for (size_t set = POINTS; set < PARTS; ++set) {
        self->rows.places[set]
            = is_recorded(self, set) ? (uint64_t)H5Dget_offset(self->sets[set].id) : 0;
    }
    return true;
}

static bool close_file(record_vtkhdf *self)
{
    const hid_t file = self->file;
    self->file = H5I_INVALID_HID;
    return file < 0 || H5Fclose(file) >= 0;
}

/* ---- opening again ---------------------------------------------------------- */

/* Called before libhdf5 opens the file, as it may crash or loop on a damaged one. */
static weft_status check_bytes(const record_vtkhdf *self,
                               const record_vtkhdf_mark *mark, weft_error *err)
{
    unsigned char page[RECORD_PAGE];
    TRY(record_no_link(self->path, err));
    if (access(self->path, R_OK) != 0) {
        return record_failed(self->path, err);
    }
    return vtkhdf_read_page(self->path, page)
                   && vtkhdf_is_same_page(mark->page, page, mark->frames.length,
                                          self->capacity)
                   && record_bytes_sum(self->path, RECORD_PAGE, mark->head.length)
                          == mark->head.sum
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO,
                                "%s: damaged: it is not the file of " RECORD_CHECKPOINT,
                                self->path);
}

static bool write_count(record_vtkhdf *self, size_t count)
{
    const int64_t steps = (int64_t)count;
    return H5Awrite(self->step_count, H5T_NATIVE_INT64, &steps) >= 0
           && H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0;
}

/* Restores the state after the commit of the last frame kept. A smaller extent
 * overwrites the times behind it at once, so NSteps must exclude them before. */
static bool cut(record_vtkhdf *self)
{
    int64_t before = 0;
    const hsize_t extent = self->count;
    if (H5Aread(self->step_count, H5T_NATIVE_INT64, &before) < 0
        || !write_count(self, self->count)) {
        return false;
    }
    if (H5Dset_extent(self->sets[self->time].id, &extent) < 0) {
        (void)write_count(self, (size_t)before);
        return false;
    }
    return H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0;
}

weft_status record_vtkhdf_cut(record_vtkhdf *self, weft_error *err)
{
    TRY(agree(self,
              !is_first(self)
                  || (close_file(self) && open_file(self, self->path, H5F_ACC_RDWR)
                      && cut(self)),
              err));
    return vtkhdf_rows_open(&self->rows, self->path, O_WRONLY, err);
}

/* ---- a frame ---------------------------------------------------------------- */

/* A set that is not recorded is passed over. */
static bool write_set(record_vtkhdf *self, size_t i, const void *values)
{
    const hdf_set *set = &self->sets[i];
    if (set->id < 0) {
        return true;
    }
    add_sum(self, set, values);
    return hdf_write(set, self->count, values);
}

/* The buffer, with values that the file has no room for clamped: a run may blow up. */
static bool write_buffer(record_vtkhdf *self, size_t set)
{
    const size_t width = width_of(set);
    double *values = self->rows.buffer;
    for (size_t i = 0; i < weft_cloth_particles(self->def.cloth) * width; ++i) {
        const double value = values[i];
        values[i] = !self->def.record->doubles ? (double)record_single(value)
                    : value > DBL_MAX          ? DBL_MAX
                    : value < -DBL_MAX         ? -DBL_MAX
                                               : value;
    }
    const bool good = vtkhdf_rows_write(&self->rows, set, width, self->count);
    self->why = !good && self->why == 0 ? errno : self->why;
    self->sum = vtkhdf_rows_sum(&self->rows, self->sum);
    return good;
}

/* All bands take part to the end, whatever fails. */
static bool write_particles(record_vtkhdf *self, const weft_sim *sim)
{
    double *values = self->rows.buffer;
    weft_sim_positions(sim, values);
    bool good = write_buffer(self, POINTS);
    if (is_recorded(self, VELOCITY)) {
        weft_sim_velocities(sim, values);
        good = write_buffer(self, VELOCITY) && good;
    }
    if (is_recorded(self, STRAIN)) {
        weft_cloth_strains(self->def.cloth, weft_sim_state(sim), values);
        good = write_buffer(self, STRAIN) && good;
    }
    for (size_t j = 0; is_recorded(self, SENSITIVITY + j) && j < WEFT_SENSITIVITIES;
         ++j) {
        record_sensitivity(self->def.series->scene, sim, j, false, values);
        good = write_buffer(self, SENSITIVITY + j) && good;
    }
    return good;
}

/* The time lies beyond the end of Values until its extent grows. NSteps and that extent
 * are written at once (vtkhdf_file.c). */
static bool commit(record_vtkhdf *self, const void *time)
{
    const hsize_t extent = (hsize_t)self->count + 1;
    return H5Dset_extent(self->sets[self->time].id, &extent) >= 0
           && write_set(self, self->time, time) && write_count(self, self->count + 1);
}

static weft_status write_frame(record_vtkhdf *self, const weft_sim *sim,
                               weft_error *err)
{
    const double t = weft_sim_time(sim);
    const int64_t ones[2] = { 1, 1 }, step = (int64_t)self->count;
    const int64_t first_point = (int64_t)(self->count * self->n);
    TRY(agree(self, write_particles(self, sim), err));
    bool good = !is_first(self)
                || (write_set(self, PARTS, ones)
                    && write_set(self, POINT_OFFSETS, &first_point)
                    && write_set(self, FIELD_OFFSETS, &step)
                    && write_set(self, FIELD_SIZES, ones));
    for (size_t i = FIELDS; good && is_first(self) && i < self->time; ++i) {
        good = write_set(self, i, &self->def.series->row[i - FIELDS]);
    }
    TRY(agree(self, good && (!is_first(self) || commit(self, &t)), err));
    ++self->count;
    return WEFT_OK;
}

static bool make_file(record_vtkhdf *self)
{
    (void)remove(self->temporary); /* it may be a link */
    return vtkhdf_file_create(self->temporary, &self->def, self->capacity)
           && open_file(self, self->temporary, H5F_ACC_RDWR);
}

/* It is closed once before: the first H5Fclose releases unused room in the file. */
static bool publish(record_vtkhdf *self)
{
    if (!close_file(self)) {
        return false;
    }
    if (rename(self->temporary, self->path) != 0) {
        self->why = errno;
        return false;
    }
    if (!open_file(self, self->path, H5F_ACC_RDWR)) {
        return false;
    }
    const size_t end = (size_t)H5Dget_offset(self->sets[POINTS].id);
    self->head = (record_extent){ end, record_bytes_sum(self->path, RECORD_PAGE, end) };
    return self->head.sum != 0;
}

/* The file appears with one frame, as readers do not expect an empty one. */
static weft_status write_first(record_vtkhdf *self, const weft_sim *sim,
                               weft_error *err)
{
    TRY(agree(self, !is_first(self) || make_file(self), err));
    TRY(vtkhdf_rows_open(&self->rows, self->temporary, O_WRONLY, err));
    TRY(write_frame(self, sim, err));
    return agree(self, !is_first(self) || publish(self), err);
}

/* Reads a frame, its words in the order of write_frame: into the sum, or, unless that
 * is NULL, into the file `to`. */
static bool pass_frame(record_vtkhdf *self, size_t frame, record_vtkhdf *to)
{
    uint64_t values[2];
    bool good = true;
    for (size_t set = POINTS; set < PARTS; ++set) {
        const size_t width = width_of(set);
        if (!is_recorded(self, set)) {
            continue;
        }
        good = vtkhdf_rows_read(&self->rows, set, width, frame) && good;
        if (to == NULL) {
            self->sum = vtkhdf_rows_sum(&self->rows, self->sum);
        } else {
            memcpy(to->rows.buffer, self->rows.buffer,
                   to->n * width * sizeof *to->rows.buffer);
            good = good && write_buffer(to, set);
        }
    }
    for (size_t i = PARTS; good && is_first(self) && i <= self->time; ++i) {
        const hdf_set *set = &self->sets[i];
        good = set->id < 0 || hdf_read(set, frame, values);
        if (good && set->id >= 0 && to == NULL) {
            add_sum(self, set, values);
        } else if (good && set->id >= 0) {
            good = i < self->time ? write_set(to, i, values) : commit(to, values);
        }
    }
    return good;
}

/* ---- an existing file -------------------------------------------------------- */

static weft_status damaged(const record_vtkhdf *self, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: damaged: frame %zu", self->path,
                          self->count);
}

static weft_status check_frames(record_vtkhdf *self, const record_vtkhdf_mark *mark,
                                bool *equal, weft_error *err)
{
    weft_status status = is_first(self) ? check_bytes(self, mark, err) : WEFT_OK;
    if (status == WEFT_OK && is_first(self)
        && !open_file(self, self->path, H5F_ACC_RDONLY)) {
        status = damaged(self, err);
    }
    TRY(weft_comm_agree(self->def.comm, status, err));
    TRY(vtkhdf_rows_open(&self->rows, self->path, O_RDONLY, err));
    for (; self->count < mark->frames.length; ++self->count) {
        const bool good = pass_frame(self, self->count, NULL);
        TRY(weft_comm_agree(self->def.comm, good ? WEFT_OK : damaged(self, err), err));
    }
    *equal = !is_first(self) || self->sum == mark->frames.sum;
    self->head = mark->head;
    return WEFT_OK;
}

weft_status record_vtkhdf_reopen(const record_vtkhdf_def *def,
                                 const record_vtkhdf_mark *mark, record_vtkhdf **out,
                                 bool *equal, weft_error *err)
{
    weft_status status = record_vtkhdf_create(def, out, err);
    status = weft_comm_agree(def->comm, status, err);
    status = status == WEFT_OK ? check_frames(*out, mark, equal, err) : status;
    if (status != WEFT_OK) {
        (void)record_vtkhdf_close(*out, NULL);
        *out = NULL;
    }
    return status;
}

static bool read_row(void *ctx, size_t frame, double *numbers)
{
    record_vtkhdf *self = ctx;
    const size_t every = self->def.record->every;
    bool good = frame % every == 0 && frame / every < self->count;
    for (size_t i = FIELDS; good && i < self->time; ++i) {
        good = self->sets[i].id < 0
               || hdf_read(&self->sets[i], frame / every, &numbers[i - FIELDS]);
    }
    return good;
}

weft_status record_vtkhdf_compare(record_vtkhdf *self, const char *damaged,
                                  weft_error *err)
{
    const record_series *series = self->def.series;
    return record_series_compare(self->def.directory, damaged, series->names,
                                 series->columns, read_row, self, err);
}

weft_status record_vtkhdf_grow(record_vtkhdf *self, size_t last, record_vtkhdf **out,
                               weft_error *err)
{
    record_vtkhdf_def def = self->def;
    def.last = last;
    TRY(record_vtkhdf_create(&def, out, err));
    record_vtkhdf *to = *out;
    bool good = make_file(to)
                && vtkhdf_rows_open(&to->rows, to->temporary, O_WRONLY, err) == WEFT_OK;
    while (good && to->count < self->count) {
        good = pass_frame(self, to->count, to);
        to->count += good;
    }
    to->count = good ? to->count : 0; /* closing removes the file */
    return good ? WEFT_OK : failed(to, err);
}

weft_status record_vtkhdf_publish(record_vtkhdf *self, weft_error *err)
{
    return agree(self, publish(self), err);
}

weft_status record_vtkhdf_add(record_vtkhdf *self, const record_frame *frame,
                              weft_error *err)
{
    if (frame->index % self->def.record->every != 0 && frame->index != self->def.last
        && !frame->is_end) {
        return WEFT_OK;
    }
    if (self->count == self->capacity) {
        return weft_error_set(err, WEFT_IO, "%s: full with %zu frames", self->path,
                              self->count);
    }
    errno = 0;
    if (self->count > 0) {
        return write_frame(self, frame->sim, err);
    }
    const weft_status status = write_first(self, frame->sim, err);
    if (status != WEFT_OK) {
        self->count = 0;
        (void)close_file(self);
    }
    return status;
}

/* ---- the end ---------------------------------------------------------------- */

static bool sync_descriptor(record_vtkhdf *self, int file)
{
    const bool good = file < 0 || fsync(file) == 0;
    self->why = good ? self->why : errno;
    return good;
}

static bool sync_file(record_vtkhdf *self)
{
    void *descriptor = NULL;
    return self->file < 0
           || (H5Fget_vfd_handle(self->file, H5P_DEFAULT, &descriptor) >= 0
               && sync_descriptor(self, *(int *)descriptor));
}

weft_status record_vtkhdf_sync(record_vtkhdf *self, record_vtkhdf_mark *mark,
                               weft_error *err)
{
    mark->head = self->head;
    mark->frames = (record_extent){ self->count, self->sum };
    const bool good
        = sync_descriptor(self, self->rows.file)
          && (!is_first(self)
              || (sync_file(self) && vtkhdf_read_page(self->path, mark->page)));
    return agree(self, good, err);
}

weft_status record_vtkhdf_close(record_vtkhdf *self, weft_error *err)
{
    if (self == NULL) {
        return WEFT_OK;
    }
    const bool synced = sync_descriptor(self, self->rows.file) && sync_file(self);
    const bool good = close_file(self) && synced;
    hdf_begin(NULL);
    if (self->count == 0 && is_first(self)) {
        (void)remove(self->temporary);
    }
    const weft_status status = good ? WEFT_OK : failed(self, err);
    vtkhdf_rows_end(&self->rows);
    free(self);
    return status;
}
