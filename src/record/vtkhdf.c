/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf.c -- frames into run.vtkhdf: first all of a frame's data, then, in one write,
 * that it is there. */
#include "record/checkpoint.h"
#include "record/vtkhdf_file.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"

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
    record_extent head; /* [bytes] of the file, as it was created */
    uint64_t sum;       /* of all that is written of the frames */
    double *buffer;     /* 3 N */
    int why;            /* errno of what failed first; 0: not known */
};

static weft_status failed(const record_vtkhdf *self, weft_error *err)
{
    return weft_error_set(err, WEFT_IO, "%s: %s", self->path,
                          self->why == 0 ? "write failed" : strerror(self->why));
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

/* libhdf5 crashes where it gets no memory for its caches, less than a megabyte. */
static bool has_memory(void)
{
    void *volatile room = malloc((size_t)4 << 20); /* volatile: not optimised away */
    free(room);
    return room != NULL;
}

weft_status record_vtkhdf_create(const record_vtkhdf_def *def, record_vtkhdf **out,
                                 weft_error *err)
{
    *out = NULL;
    if (!has_memory()) {
        return weft_error_set(err, WEFT_IO, "%s/run.vtkhdf: %s", def->directory,
                              strerror(ENOMEM));
    }
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
    self->capacity = record_vtkhdf_planned(def->record, def->last);
    self->file = H5I_INVALID_HID;
    self->buffer = buffer;
    self->sum = WEFT__HASH_START;
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

static hid_t memory_type(size_t set)
{
    return set <= STRAIN ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
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

static bool open_file(record_vtkhdf *self, const char *path, unsigned mode)
{
    const hid_t access = hdf_access();
    self->file = H5Fopen(path, mode, access);
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

/* Before libhdf5 opens the file: it may crash or loop on a damaged one. */
static weft_status check_bytes(const record_vtkhdf *self,
                               const record_vtkhdf_mark *mark, weft_error *err)
{
    unsigned char page[RECORD_PAGE];
    const weft_status status = record_no_link(self->path, err);
    if (status != WEFT_OK) {
        return status;
    }
    if (access(self->path, R_OK) != 0) {
        return weft_error_set(err, WEFT_IO, "%s: %s", self->path, strerror(errno));
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

/* As after the commit of the last frame that is kept. A smaller extent overwrites the
 * times behind it at once: by then NSteps has left them out. */
static bool cut(record_vtkhdf *self)
{
    int64_t before = 0;
    const hsize_t extent = self->count;
    if (H5Aread(self->step_count, H5T_NATIVE_INT64, &before) < 0
        || !write_count(self, self->count)) {
        return false;
    }
    if (H5Dset_extent(self->time.id, &extent) < 0) {
        (void)write_count(self, (size_t)before);
        return false;
    }
    return H5Fflush(self->file, H5F_SCOPE_GLOBAL) >= 0;
}

weft_status record_vtkhdf_cut(record_vtkhdf *self, weft_error *err)
{
    return close_file(self) && open_file(self, self->path, H5F_ACC_RDWR) && cut(self)
               ? WEFT_OK
               : failed(self, err);
}

static bool sum_row(record_vtkhdf *self, const hdf_set *set, hid_t type, size_t frame)
{
    const bool good = hdf_read(set, frame, type, self->buffer);
    if (good) {
        add_sum(self, set, self->buffer);
    }
    return good;
}

/* The same words in the same order as write_frame. */
static bool sum_frame(record_vtkhdf *self, size_t frame)
{
    const record_series *series = self->def.series;
    bool good = true;
    for (size_t i = 0; good && i < SETS; ++i) {
        good = is_left_out(self, i)
               || sum_row(self, &self->sets[i], memory_type(i), frame);
    }
    for (size_t i = 0; good && i < series->columns; ++i) {
        good = !vtkhdf_is_field(series->names[i])
               || sum_row(self, &self->fields[i], H5T_NATIVE_DOUBLE, frame);
    }
    return good && sum_row(self, &self->time, H5T_NATIVE_DOUBLE, frame);
}

static weft_status check_frames(record_vtkhdf *self, const record_vtkhdf_mark *mark,
                                bool *equal, weft_error *err)
{
    bool good = open_file(self, self->path, H5F_ACC_RDONLY);
    for (; good && self->count < mark->frames.length; ++self->count) {
        good = sum_frame(self, self->count);
    }
    *equal = self->sum == mark->frames.sum;
    self->head = mark->head;
    return good ? WEFT_OK
                : weft_error_set(err, WEFT_IO, "%s: damaged: frame %zu", self->path,
                                 self->count);
}

weft_status record_vtkhdf_reopen(const record_vtkhdf_def *def,
                                 const record_vtkhdf_mark *mark, record_vtkhdf **out,
                                 bool *equal, weft_error *err)
{
    weft_status status = record_vtkhdf_create(def, out, err);
    if (status != WEFT_OK) {
        return status;
    }
    record_vtkhdf *self = *out;
    status = check_bytes(self, mark, err);
    hdf_begin(&self->why);
    status = status == WEFT_OK ? check_frames(self, mark, equal, err) : status;
    if (status != WEFT_OK) {
        (void)record_vtkhdf_close(self, NULL);
        *out = NULL;
    }
    return status;
}

static bool read_row(void *ctx, size_t frame, double *numbers)
{
    record_vtkhdf *self = ctx;
    const record_series *series = self->def.series;
    const size_t every = self->def.record->every;
    bool good = frame % every == 0 && frame / every < self->count;
    for (size_t i = 0; good && i < series->columns; ++i) {
        good = !vtkhdf_is_field(series->names[i])
               || hdf_read(&self->fields[i], frame / every, H5T_NATIVE_DOUBLE,
                           &numbers[i]);
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

/* ---- a frame ---------------------------------------------------------------- */

static bool write_row(record_vtkhdf *self, const hdf_set *set, hid_t type,
                      const void *values)
{
    add_sum(self, set, values);
    return hdf_write(set, self->count, type, values);
}

/* The buffer, as the file will hold it; of a run that blows up, what it has room for.
 */
static bool write_set(record_vtkhdf *self, size_t set)
{
    for (size_t i = 0; i < self->n * layout[set].width; ++i) {
        const double value = self->buffer[i];
        self->buffer[i] = !self->def.record->doubles ? (double)record_single(value)
                          : value > DBL_MAX          ? DBL_MAX
                          : value < -DBL_MAX         ? -DBL_MAX
                                                     : value;
    }
    return write_row(self, &self->sets[set], memory_type(set), self->buffer);
}

static bool write_integers(record_vtkhdf *self, size_t set, const int64_t *values)
{
    return write_row(self, &self->sets[set], memory_type(set), values);
}

static bool write_particles(record_vtkhdf *self, const weft_sim *sim)
{
    weft_sim_positions(sim, self->buffer);
    bool good = write_set(self, POINTS);
    if (good && !is_left_out(self, VELOCITY)) {
        weft_sim_velocities(sim, self->buffer);
        good = write_set(self, VELOCITY);
    }
    if (good && !is_left_out(self, STRAIN)) {
        weft_cloth_strains(self->def.cloth, weft_sim_state(sim), self->buffer);
        good = write_set(self, STRAIN);
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
               || write_row(self, &self->fields[i], H5T_NATIVE_DOUBLE, &series->row[i]);
    }
    return good;
}

/* The time is beyond the end of Values until its extent grows. NSteps and that extent
 * go to the file in one write (vtkhdf_file.c). */
static bool commit(record_vtkhdf *self, double t)
{
    const hsize_t extent = (hsize_t)self->count + 1;
    return H5Dset_extent(self->time.id, &extent) >= 0
           && write_row(self, &self->time, H5T_NATIVE_DOUBLE, &t)
           && write_count(self, self->count + 1);
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

static bool sum_head(record_vtkhdf *self)
{
    const size_t end = (size_t)H5Dget_offset(self->sets[POINTS].id);
    self->head = (record_extent){ end, record_bytes_sum(self->path, RECORD_PAGE, end) };
    return self->head.sum != 0;
}

/* The file appears with a frame in it, as no reader expects one without. It is closed
 * in between: the first closing gives back room in the file. */
static bool write_first(record_vtkhdf *self, const weft_sim *sim)
{
    (void)remove(self->temporary); /* it may be a link */
    const bool made = vtkhdf_file_create(self->temporary, &self->def, self->capacity)
                      && open_file(self, self->temporary, H5F_ACC_RDWR)
                      && write_frame(self, sim);
    if (!close_file(self) || !made) {
        self->count = 0;
        return false;
    }
    if (rename(self->temporary, self->path) != 0) {
        self->why = errno;
        self->count = 0;
        return false;
    }
    return open_file(self, self->path, H5F_ACC_RDWR) && sum_head(self);
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
    errno = 0;
    if (self->count == 0 ? write_first(self, frame->sim)
                         : write_frame(self, frame->sim)) {
        return WEFT_OK;
    }
    self->why = self->why == 0 && errno == ENOMEM ? ENOMEM : self->why;
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

weft_status record_vtkhdf_sync(record_vtkhdf *self, record_vtkhdf_mark *mark,
                               weft_error *err)
{
    mark->head = self->head;
    mark->frames = (record_extent){ self->count, self->sum };
    return sync_file(self) && vtkhdf_read_page(self->path, mark->page)
               ? WEFT_OK
               : failed(self, err);
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
