/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.c -- reads run.vtkhdf and trusts nothing in it.
 *
 * libhdf5 itself may crash on a damaged file. So a child process reads the file first,
 * and the parent reads it only if the child succeeded. */
#include "program/record/frames.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/finite.h"
#include "base/name.h"
#include "program/record/child_process.h"
#include "program/record/vtkhdf_file.h"

typedef struct frames_file {
    record_frames seen; /* first: the part that its reader sees */
    char path[RECORD_PATH];
    hid_t file;
    hdf_set points, fields[WEFT_RECORD_PINNED]; /* velocity, strain */
    hdf_set sensitivities[WEFT_SENSITIVITIES];
    size_t n;
    char wrong[48]; /* a complaint */
} frames_file;

/* ---- pieces ----------------------------------------------------------------- */

/* The rows of a set; 0 if its width is not `width`. */
static size_t set_rows(hid_t id, size_t width)
{
    hsize_t extent[2] = { 0, 1 };
    const hid_t space = H5Dget_space(id);
    const int rank = width > 1 ? 2 : 1;
    const bool good = H5Sget_simple_extent_ndims(space) == rank
                      && H5Sget_simple_extent_dims(space, extent, NULL) == rank
                      && extent[1] == width;
    (void)H5Sclose(space);
    return good ? (size_t)extent[0] : 0;
}

/* Opens a set, or returns an invalid id if it lacks that type, width or so many rows.
 */
static hid_t open_set(const frames_file *self, const char *path, hid_t type,
                      size_t rows, size_t width)
{
    const hid_t id = H5Dopen2(self->file, path, H5P_DEFAULT), held = H5Dget_type(id);
    const bool fits = H5Tequal(held, type) > 0 && set_rows(id, width) >= rows;
    (void)H5Tclose(held);
    if (!fits) {
        (void)H5Dclose(id);
    }
    return fits ? id : H5I_INVALID_HID;
}

/* Allocates the values of `count` > 0 rows of a set; NULL on failure. */
static void *read_all(const frames_file *self, const char *path, hid_t type,
                      size_t count, size_t width)
{
    const hdf_set set
        = { open_set(self, path, type, count, width), type, count, width };
    void *values = set.id < 0 ? NULL : malloc(count * width * H5Tget_size(type));
    if (values != NULL && !hdf_read(&set, 0, values)) {
        free(values);
        values = NULL;
    }
    (void)H5Dclose(set.id);
    return values;
}

static size_t read_integer(const frames_file *self, const char *object,
                           const char *name)
{
    int64_t value = 0;
    const hid_t id
        = H5Aopen_by_name(self->file, object, name, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(id), space = H5Aget_space(id);
    const bool good = H5Tequal(type, H5T_STD_I64LE) > 0
                      && H5Sget_simple_extent_npoints(space) == 1
                      && H5Aread(id, H5T_NATIVE_INT64, &value) >= 0;
    (void)H5Tclose(type);
    (void)H5Sclose(space);
    (void)H5Aclose(id);
    return good && value > 0 ? (size_t)value : 0;
}

/* ---- the whole: each function returns a complaint, or NULL ------------------- */

static const char *load_size(frames_file *self)
{
    const size_t most = (size_t)1 << 31;
    const size_t rows = read_integer(self, "/weft", "rows");
    const size_t cols = read_integer(self, "/weft", "cols");
    record_faces *faces = &self->seen.faces;
    *faces = (record_faces){ .particles = read_integer(self, "/weft", "vertices"),
                             .triangles = read_integer(self, "/weft", "triangles") };
    if (faces->particles > most || faces->triangles > most
        || (faces->triangles == 0 && (rows == 0 || cols == 0 || rows > most / cols))) {
        return "rows and cols of /weft are missing or wrong";
    }
    if (faces->triangles == 0) {
        *faces = record_grid(rows, cols);
    }
    self->n = faces->particles;
    int64_t *points = read_all(self, "/VTKHDF/NumberOfPoints", H5T_STD_I64LE, 1, 1);
    const bool equal = points != NULL && *points == (int64_t)self->n;
    free(points);
    return equal ? NULL : "NumberOfPoints is missing or not rows x cols";
}

/* Whether a file of this size can hold so many bytes: zlib can expand a byte to 1032 at
 * most, should it be repacked. */
static bool has_room(const frames_file *self, double bytes)
{
    struct stat status;
    return stat(self->path, &status) == 0 && bytes <= 1032.0 * (double)status.st_size;
}

static bool all_below(const uint32_t *values, size_t count, size_t end)
{
    size_t i = 0;
    while (i < count && values[i] < end) {
        ++i;
    }
    return i == count;
}

static bool load_corners(frames_file *self)
{
    record_faces *of = &self->seen.faces;
    const size_t count = 3 * of->triangles;
    int64_t *ids
        = read_all(self, "/VTKHDF/Polygons/Connectivity", H5T_STD_I64LE, count, 1);
    of->corners = ids == NULL ? NULL : malloc(count * sizeof *of->corners);
    for (size_t i = 0; of->corners != NULL && i < count; ++i) {
        of->corners[i]
            = ids[i] < 0 || ids[i] > UINT32_MAX ? UINT32_MAX : (uint32_t)ids[i];
    }
    free(ids);
    return of->corners != NULL && all_below(of->corners, count, of->particles);
}

/* Cloths in the order of their particles. false: they are not. */
static bool load_parts(frames_file *self)
{
    const char *path = "/weft/ClothNames";
    record_faces *of = &self->seen.faces;
    if (H5Lexists(self->file, path, H5P_DEFAULT) <= 0) {
        return true;
    }
    const hid_t set = H5Dopen2(self->file, path, H5P_DEFAULT), type = hdf_name_type();
    const size_t count = set < 0 ? 0 : set_rows(set, 1);
    const bool some = count > 0 && count <= WEFT_CLOTHS_MAX;
    char(*names)[WEFT_CLOTH_NAME_MAX]
        = some ? read_all(self, path, type, count, 1) : NULL;
    int64_t *first
        = some ? read_all(self, "/weft/ClothFirst", H5T_STD_I64LE, count, 1) : NULL;
    of->parts = calloc(count + 1, sizeof *of->parts);
    bool good = names != NULL && first != NULL && of->parts != NULL && first[0] == 0;
    for (size_t i = 0; good && i < count; ++i) {
        memcpy(of->parts[i].name, names[i], sizeof names[i]);
        of->parts[i].first = (size_t)first[i];
        good = WEFT__IS_CLOTH_NAME(of->parts[i].name)
               && (i == 0 || (first[i] > first[i - 1] && first[i] < (int64_t)self->n));
    }
    of->part_count = good ? count : 0;
    free(names);
    free(first);
    (void)H5Tclose(type);
    (void)H5Dclose(set);
    return good;
}

/* Nothing of a grid. */
static const char *load_triangles(frames_file *self)
{
    const char *names = "/VTKHDF/PointData/vertex";
    record_faces *of = &self->seen.faces;
    if (of->triangles == 0) {
        return NULL;
    }
    const hid_t places = H5Dopen2(self->file, "/weft/Places", H5P_DEFAULT);
    of->places = places < 0 ? 0 : set_rows(places, 2);
    (void)H5Dclose(places);
    if (!has_room(self, 24.0 * (double)of->triangles + 16.0 * (double)of->places)) {
        return "more triangles than the file has room for";
    }
    of->uv = read_all(self, "/weft/Places", H5T_IEEE_F64LE, of->places, 2);
    of->corner_uv
        = read_all(self, "/weft/CornerPlaces", H5T_STD_U32LE, of->triangles, 3);
    if (H5Lexists(self->file, names, H5P_DEFAULT) > 0) {
        of->names = read_all(self, names, H5T_STD_I64LE, of->particles, 1);
        if (of->names == NULL) {
            return "PointData/vertex is wrong";
        }
    }
    if (!load_parts(self)) {
        return "/weft/ClothNames or /weft/ClothFirst are wrong";
    }
    return load_corners(self) && of->uv != NULL
                   && weft__all_finite(of->uv, 2 * of->places) && of->corner_uv != NULL
                   && all_below(of->corner_uv, 3 * of->triangles, of->places)
               ? NULL
               : "Polygons, /weft/Places or /weft/CornerPlaces are missing or wrong";
}

static hdf_set frame_set(const frames_file *self, const char *path, size_t width)
{
    const hid_t type = self->seen.doubles ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
    const hid_t id = open_set(self, path, type, self->seen.count * self->n, width);
    return (hdf_set){ id, H5T_NATIVE_DOUBLE, self->n, width };
}

static const char *load_points(frames_file *self)
{
    const char *path = "/VTKHDF/Points";
    /* a frame is committed once both NSteps and Steps/Values include it */
    const hid_t times = open_set(self, "/VTKHDF/Steps/Values", H5T_IEEE_F64LE, 1, 1);
    const size_t written = times < 0 ? 0 : set_rows(times, 1);
    const size_t steps = read_integer(self, "/VTKHDF/Steps", "NSteps");
    (void)H5Dclose(times);
    self->seen.count = steps < written ? steps : written;
    if (self->seen.count == 0) {
        return "NSteps or Steps/Values are missing or wrong";
    }
    if (!has_room(self, (double)self->seen.count * (double)self->n * 12.0)) {
        return "more frames than the file has room for";
    }
    self->points = frame_set(self, path, 3);
    self->seen.doubles = self->points.id < 0;
    self->points = self->seen.doubles ? frame_set(self, path, 3) : self->points;
    if (self->points.id < 0) {
        return "Points are missing or wrong";
    }
    self->seen.planned = set_rows(self->points.id, 3) / self->n;
    return NULL;
}

/* A field that is not there was not recorded. */
static const char *load_fields(frames_file *self)
{
#define FIELD "/VTKHDF/PointData/"
    static const char *const known[] = { [WEFT_RECORD_VELOCITY] = FIELD "velocity",
                                         [WEFT_RECORD_STRAIN] = FIELD "strain",
                                         [WEFT_RECORD_PINNED] = FIELD "pinned" };
    for (size_t i = 0; i < WEFT_RECORD_FIELDS; ++i) {
        bool good = true;
        self->seen.fields[i] = H5Lexists(self->file, known[i], H5P_DEFAULT) > 0;
        if (self->seen.fields[i] && i == WEFT_RECORD_PINNED) {
            self->seen.pinned = read_all(self, known[i], H5T_STD_U8LE, self->n, 1);
            good = self->seen.pinned != NULL;
        } else if (self->seen.fields[i]) {
            self->fields[i]
                = frame_set(self, known[i], i == WEFT_RECORD_VELOCITY ? 3 : 1);
            good = self->fields[i].id >= 0;
        }
        if (!good) {
            (void)snprintf(self->wrong, sizeof self->wrong, "%s is wrong",
                           known[i] + strlen("/VTKHDF/"));
            return self->wrong;
        }
    }
    return NULL;
}

/* The sets s_KEY. */
static const char *load_sensitivities(frames_file *self)
{
    H5G_info_t group = { .nlinks = 0 };
    (void)H5Gget_info_by_name(self->file, "/VTKHDF/PointData", &group, H5P_DEFAULT);
    for (hsize_t i = 0; i < group.nlinks; ++i) {
        char path[sizeof FIELD + 2 + RECORD_KEY] = FIELD, *name = path + strlen(FIELD);
        const ssize_t length
            = H5Lget_name_by_idx(self->file, "/VTKHDF/PointData", H5_INDEX_NAME,
                                 H5_ITER_INC, i, name, 2 + RECORD_KEY, H5P_DEFAULT);
        if (length <= 2 || strncmp(name, "s_", 2) != 0) {
            continue;
        }
        hdf_set *set = &self->sensitivities[self->seen.sensitivities];
        if (length >= 2 + RECORD_KEY || self->seen.sensitivities == WEFT_SENSITIVITIES
            || (*set = frame_set(self, path, 3)).id < 0) {
            return "PointData/s_... is wrong";
        }
        strcpy(self->seen.keys[self->seen.sensitivities++], name + 2);
    }
    return NULL;
}

static const char *load_tables(frames_file *self)
{
    const hid_t type = H5T_IEEE_F64LE;
    self->seen.rest = read_all(self, "/weft/Rest", type, self->n, 3);
    self->seen.times
        = read_all(self, "/VTKHDF/Steps/Values", type, self->seen.count, 1);
    self->seen.numbers = read_all(self, "/VTKHDF/FieldData/" VTKHDF_FRAME_FIELD, type,
                                  self->seen.count, 1);
    if (self->seen.rest == NULL || self->seen.times == NULL
        || self->seen.numbers == NULL) {
        return "/weft/Rest, Steps/Values or FieldData/" VTKHDF_FRAME_FIELD
               " are missing or wrong";
    }
    if (!weft__all_finite(self->seen.rest, 3 * self->n)) {
        return "/weft/Rest is not finite";
    }
    for (size_t i = 0; i < self->seen.count; ++i) {
        const double number = self->seen.numbers[i];
        const bool later = i == 0
                           || (self->seen.times[i] > self->seen.times[i - 1]
                               && number > self->seen.numbers[i - 1]);
        if (!later || !isfinite(self->seen.times[i])
            || !(number >= 0.0 && number < 0x1p53) || floor(number) != number) {
            return "times or numbers of frames are not in order";
        }
    }
    return NULL;
}

static const char *load(frames_file *self)
{
    const hid_t access = hdf_access();
    self->file = H5Fopen(self->path, H5F_ACC_RDONLY, access);
    (void)H5Pclose(access);
    if (self->file < 0) {
        return "no HDF5 file";
    }
    const char *wrong = load_size(self);
    wrong = wrong == NULL ? load_triangles(self) : wrong;
    wrong = wrong == NULL ? load_points(self) : wrong;
    wrong = wrong == NULL ? load_fields(self) : wrong;
    wrong = wrong == NULL ? load_sensitivities(self) : wrong;
    return wrong == NULL ? load_tables(self) : wrong;
}

static void unload(frames_file *self)
{
    if (self->file >= 0) {
        (void)H5Fclose(self->file);
    }
    record_faces_free(&self->seen.faces);
    free((void *)self->seen.times);
    free((void *)self->seen.numbers);
    free((void *)self->seen.rest);
    free((void *)self->seen.pinned);
}

/* ---- reading ---------------------------------------------------------------- */

static weft_status read_frame(const frames_file *self, const hdf_set *set, size_t i,
                              double *values, weft_error *err)
{
    if (i >= self->seen.count) {
        return weft_error_set(err, WEFT_INVALID, "%s: frame %zu of %zu", self->path, i,
                              self->seen.count);
    }
    return hdf_read(set, i, values) && weft__all_finite(values, set->rows * set->width)
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s: damaged: frame %zu", self->path, i);
}

weft_status record_frames_positions(record_frames *frames, size_t i, double *xyz,
                                    weft_error *err)
{
    const frames_file *self = (frames_file *)frames;
    return read_frame(self, &self->points, i, xyz, err);
}

weft_status record_frames_field(record_frames *frames, weft_record_field field,
                                size_t i, double *values, weft_error *err)
{
    const frames_file *self = (frames_file *)frames;
    return frames->fields[field]
               ? read_frame(self, &self->fields[field], i, values, err)
               : weft_error_set(err, WEFT_UNSUPPORTED,
                                "%s: not recorded (record.fields)", self->path);
}

weft_status record_frames_sensitivity(record_frames *frames, size_t j, size_t i,
                                      double *values, weft_error *err)
{
    const frames_file *self = (frames_file *)frames;
    return read_frame(self, &self->sensitivities[j], i, values, err);
}

/* ---- opening ---------------------------------------------------------------- */

/* In the child: everything that the parent will do, once. */
static int read_some(void *ctx, size_t job)
{
    frames_file *self = ctx;
    double *values = load(self) == NULL ? malloc(3 * self->n * sizeof *values) : NULL;
    (void)job;
    for (size_t i = 0; values != NULL && i < 2; ++i) {
        const size_t frame = i * (self->seen.count - 1);
        (void)record_frames_positions(&self->seen, frame, values, NULL);
        (void)record_frames_field(&self->seen, WEFT_RECORD_VELOCITY, frame, values,
                                  NULL);
        (void)record_frames_field(&self->seen, WEFT_RECORD_STRAIN, frame, values, NULL);
        for (size_t j = 0; j < self->seen.sensitivities; ++j) {
            (void)record_frames_sensitivity(&self->seen, j, frame, values, NULL);
        }
    }
    free(values);
    unload(self);
    return 0;
}

/* libhdf5 may also loop for ever on a damaged file. The time limit is ten times that of
 * the processor: the disk may be slow, or stall. */
static weft_status try_in_child(frames_file *self, weft_error *err)
{
    process child;
    struct stat status;
    const off_t size = stat(self->path, &status) == 0 ? status.st_size : 0;
    const unsigned seconds = size >> 26 > 58 ? 60 : 2 + (unsigned)(size >> 26);
    const process_def def = { .work = read_some,
                              .ctx = self,
                              .end_signal = SIGKILL,
                              .seconds = 10.0 * seconds,
                              .cpu_seconds = seconds,
                              .untrusted = true };
    if (!process_run(&def, 0, &child)) {
        return weft_error_set(err, WEFT_IO, "%s: no process to check it: %s",
                              self->path, strerror(errno));
    }
    return child.status == 0 ? WEFT_OK
           : child.late
               ? weft_error_set(err, WEFT_IO, "%s: not read within %g s", self->path,
                                def.seconds)
               : weft_error_set(err, WEFT_IO, "%s: damaged: libhdf5 fails on it",
                                self->path);
}

static weft_status open_frames(frames_file *self, const char *directory,
                               weft_error *err)
{
    FILE *stream = record_open(directory, "run.vtkhdf", self->path, err);
    if (stream == NULL) {
        (void)record_is_run(directory, err); /* it says more */
        return WEFT_IO;
    }
    (void)fclose(stream);
    TRY(try_in_child(self, err));
    const char *wrong = load(self);
    return wrong == NULL
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s: damaged: %s", self->path, wrong);
}

weft_status record_frames_open(const char *directory, record_frames **out,
                               weft_error *err)
{
    frames_file *self = calloc(1, sizeof *self);
    *out = (record_frames *)self; /* its first member */
    if (self == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory to read frames");
    }
    hdf_begin(NULL);
    self->file = H5I_INVALID_HID;
    const weft_status status = open_frames(self, directory, err);
    if (status != WEFT_OK) {
        record_frames_close(&self->seen);
        *out = NULL;
    }
    return status;
}

void record_frames_close(record_frames *frames)
{
    if (frames != NULL) {
        unload((frames_file *)frames);
        free(frames);
    }
}
