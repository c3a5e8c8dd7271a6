/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf_file.c -- the layout, as vtk 9.3 and later read it: NumberOfPoints and its
 * like have one entry, PartOffsets are 0, and NumberOfParts and all four groups of
 * cells exist. Equal tables are one dataset under several names; tables of zeros are
 * never written, since a hole reads as 0. Every function returns false on failure. */
#include "program/record/vtkhdf_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/file.h"
#include "program/record/frames.h"

#define ROOT  "/VTKHDF/"
#define STEPS "/VTKHDF/Steps/"

typedef struct builder {
    hid_t file, parents, early; /* property lists: make groups; allocate at once */
    hid_t real;                 /* type of the particles' data */
    const record_vtkhdf_def *def;
    const weft_cloth *cloth; /* the whole one */
    const record_faces *faces;
    size_t n, capacity;
} builder;

bool vtkhdf_is_field(const char *column)
{
    return strcmp(column, "hash") != 0;
}

/* ---- libhdf5 ---------------------------------------------------------------- */

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

#define HAS_LOCKING                                                                    \
    (H5_VERSION_GE(1, 10, 7) && (H5_VERS_MINOR != 12 || H5_VERS_RELEASE > 0))

void hdf_begin(int *why)
{
#if !HAS_LOCKING
    (void)setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
#endif
    (void)H5dont_atexit();
    (void)H5Eset_auto2(H5E_DEFAULT, why == NULL ? NULL : on_failure, why);
}

hid_t hdf_access(void)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    (void)H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    (void)H5Pset_sieve_buf_size(access, 0);
    (void)H5Pset_meta_block_size(access, 1 << 15);
#if HAS_LOCKING
    (void)H5Pset_file_locking(access, false, true);
#endif
    return access;
}

hid_t hdf_name_type(void)
{
    const hid_t text = H5Tcopy(H5T_C_S1);
    (void)H5Tset_size(text, WEFT_CLOTH_NAME_MAX);
    (void)H5Tset_strpad(text, H5T_STR_NULLPAD);
    return text;
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

/* ---- groups and attributes -------------------------------------------------- */

static bool make_group(const builder *self, const char *path)
{
    const hid_t group
        = H5Gcreate2(self->file, path, self->parents, H5P_DEFAULT, H5P_DEFAULT);
    return group >= 0 && H5Gclose(group) >= 0;
}

/* An attribute of `count` values; 0: a single one. */
static bool attribute(const builder *self, const char *path, const char *name,
                      hid_t type, hid_t memory, hsize_t count, const void *values)
{
    const hid_t space
        = count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, NULL);
    const hid_t made = H5Acreate_by_name(self->file, path, name, type, space,
                                         H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const bool good = made >= 0 && H5Awrite(made, memory, values) >= 0;
    const bool closed = H5Aclose(made) >= 0;
    (void)H5Sclose(space);
    return good && closed;
}

static bool integer_attribute(const builder *self, const char *path, const char *name,
                              size_t value)
{
    const int64_t wide = (int64_t)value;
    return attribute(self, path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, 0, &wide);
}

/* ---- datasets --------------------------------------------------------------- */

/* rows x width, or a plain list where width is 1; values NULL: not written. */
static bool dataset(const builder *self, const char *path, hid_t type, size_t rows,
                    size_t width, hid_t memory, const void *values)
{
    const hsize_t extent[2] = { rows, width };
    const hid_t space = H5Screate_simple(width > 1 ? 2 : 1, extent, NULL);
    const hid_t made = H5Dcreate2(self->file, path, type, space, self->parents,
                                  self->early, H5P_DEFAULT);
    const bool good
        = made >= 0
          && (values == NULL || rows == 0
              || H5Dwrite(made, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    const bool closed = H5Dclose(made) >= 0; /* it may write */
    (void)H5Sclose(space);
    return good && closed;
}

static bool integers(const builder *self, const char *path, size_t rows, size_t width,
                     const int64_t *values)
{
    return dataset(self, path, H5T_STD_I64LE, rows, width, H5T_NATIVE_INT64, values);
}

/* The same dataset under another name. */
static bool same(const builder *self, const char *path, const char *as)
{
    return H5Lcreate_hard(self->file, path, self->file, as, self->parents, H5P_DEFAULT)
           >= 0;
}

/* A dataset of reals for each column, or the dataset `path` under its name. */
static bool each_field(const builder *self, const char *group, const char *path)
{
    const record_series *series = self->def->series;
    bool good = true;
    for (size_t i = 0; good && i < series->columns; ++i) {
        char name[160];
        (void)snprintf(name, sizeof name, "%s/%s", group, series->names[i]);
        good = !vtkhdf_is_field(series->names[i])
               || (path == NULL
                       ? dataset(self, name, H5T_IEEE_F64LE, self->capacity, 1, 0, NULL)
                       : same(self, path, name));
    }
    return good;
}

/* ---- cells ------------------------------------------------------------------ */

static bool cell_table(const builder *self, const char *group, const char *name,
                       size_t rows, const int64_t *values)
{
    char path[80];
    (void)snprintf(path, sizeof path, ROOT "%s/%s", group, name);
    return integers(self, path, rows, 1, values);
}

/* `count` cells of `size` points each, one after another in `connectivity`. */
static bool cells(const builder *self, const char *group, size_t count, size_t size,
                  const int64_t *connectivity)
{
    int64_t *offsets = malloc((count + 1) * sizeof *offsets);
    const int64_t cell_count = (int64_t)count, id_count = (int64_t)(count * size);
    for (size_t i = 0; offsets != NULL && i <= count; ++i) {
        offsets[i] = (int64_t)(i * size);
    }
    const bool good
        = offsets != NULL && cell_table(self, group, "NumberOfCells", 1, &cell_count)
          && cell_table(self, group, "NumberOfConnectivityIds", 1, &id_count)
          && cell_table(self, group, "Offsets", count + 1, offsets)
          && cell_table(self, group, "Connectivity", count * size, connectivity);
    free(offsets);
    return good;
}

/* A chain is one line through all particles. */
static bool topology(const builder *self)
{
    const size_t faces = record_face_count(self->faces);
    const size_t sides = record_face_sides(self->faces);
    int64_t *ids = malloc((faces == 0 ? self->n : sides * faces) * sizeof *ids);
    for (size_t f = 0; ids != NULL && f < faces; ++f) {
        size_t corners[4];
        record_face(self->faces, f, corners);
        for (size_t k = 0; k < sides; ++k) {
            ids[sides * f + k] = (int64_t)corners[k];
        }
    }
    for (size_t i = 0; ids != NULL && faces == 0 && i < self->n; ++i) {
        ids[i] = (int64_t)i;
    }
    const bool good = ids != NULL && cells(self, "Polygons", faces, sides, ids)
                      && cells(self, "Lines", faces == 0, self->n, ids)
                      && cells(self, "Vertices", 0, 0, NULL)
                      && cells(self, "Strips", 0, 0, NULL);
    free(ids);
    return good;
}

/* Of several cloths: their names and first particles, and the cloth of each one. */
static bool cloths(const builder *self)
{
    const record_faces *of = self->faces;
    const size_t count = of->part_count;
    char(*names)[WEFT_CLOTH_NAME_MAX] = calloc(count + 1, sizeof *names);
    int64_t *numbers = calloc(count + self->n, sizeof *numbers),
            *part = numbers + count;
    const hid_t type = hdf_name_type();
    bool good = names != NULL && numbers != NULL;
    for (size_t i = 0; good && i < count; ++i) {
        memcpy(names[i], of->parts[i].name, sizeof *names);
        numbers[i] = (int64_t)of->parts[i].first;
    }
    for (size_t i = 0; good && i < self->n; ++i) {
        part[i] = (int64_t)record_part_of(of, i);
    }
    good = good && dataset(self, "/weft/ClothNames", type, count, 1, type, names)
           && integers(self, "/weft/ClothFirst", count, 1, numbers)
           && integers(self, ROOT "PointData/cloth", self->n, 1, part);
    (void)H5Tclose(type);
    free(names);
    free(numbers);
    return good;
}

/* Of triangles: the flat rest shape, and names that are not 0, 1, ... */
static bool mesh(const builder *self)
{
    const record_faces *of = self->faces;
    return of->cols > 0
           || (dataset(self, "/weft/Places", H5T_IEEE_F64LE, of->places, 2,
                       H5T_NATIVE_DOUBLE, of->uv)
               && dataset(self, "/weft/CornerPlaces", H5T_STD_U32LE, of->triangles, 3,
                          H5T_NATIVE_UINT32, of->corner_uv)
               && (of->names == NULL
                   || integers(self, ROOT "PointData/vertex", self->n, 1, of->names))
               && (of->part_count == 0 || cloths(self)));
}

/* ---- particles -------------------------------------------------------------- */

/* Data that are the same in all frames. */
static bool fixed(const builder *self)
{
    const int64_t count = (int64_t)self->n;
    double *xyz = malloc(3 * self->n * sizeof *xyz);
    uint8_t *flags = malloc(self->n);
    const bool able = xyz != NULL && flags != NULL;
    for (size_t i = 0; able && i < self->n; ++i) {
        flags[i] = weft_cloth_pinned(self->cloth, i);
    }
    if (able) {
        weft_cloth_rest(self->cloth, xyz);
    }
    const bool good = able && integers(self, ROOT "NumberOfPoints", 1, 1, &count)
                      && make_group(self, ROOT "PointData")
                      && (!self->def->record->fields[WEFT_RECORD_PINNED]
                          || dataset(self, ROOT "PointData/pinned", H5T_STD_U8LE,
                                     self->n, 1, H5T_NATIVE_UINT8, flags))
                      && dataset(self, "/weft/Rest", H5T_IEEE_F64LE, self->n, 3,
                                 H5T_NATIVE_DOUBLE, xyz)
                      && topology(self) && mesh(self);
    free(xyz);
    free(flags);
    return good;
}

/* The offsets of a field's rows are those of the points. */
static bool field(const builder *self, weft_record_field field, const char *path,
                  const char *offsets, size_t width)
{
    const size_t rows = self->capacity * self->n;
    return !self->def->record->fields[field]
           || (dataset(self, path, self->real, rows, width, 0, NULL)
               && same(self, STEPS "PointOffsets", offsets));
}

static bool sensitivities(const builder *self)
{
    bool good = true;
    for (size_t j = 0; j < record_series_sensitivities(self->def->series); ++j) {
        char path[160], offsets[160];
        const char *key = weft_scene_sensitivities(self->def->series->scene)->keys[j];
        (void)snprintf(path, sizeof path, ROOT "PointData/s_%s", key);
        (void)snprintf(offsets, sizeof offsets, STEPS "PointDataOffsets/s_%s", key);
        good = good
               && dataset(self, path, self->real, self->capacity * self->n, 3, 0, NULL)
               && same(self, STEPS "PointOffsets", offsets);
    }
    return good;
}

static bool particles(const builder *self)
{
    const size_t rows = self->capacity * self->n;
    return dataset(self, ROOT "Points", self->real, rows, 3, 0, NULL)
           && integers(self, STEPS "PointOffsets", self->capacity, 1, NULL)
           && make_group(self, STEPS "PointDataOffsets")
           && field(self, WEFT_RECORD_VELOCITY, ROOT "PointData/velocity",
                    STEPS "PointDataOffsets/velocity", 3)
           && field(self, WEFT_RECORD_STRAIN, ROOT "PointData/strain",
                    STEPS "PointDataOffsets/strain", 1)
           && sensitivities(self)
           && (!self->def->record->fields[WEFT_RECORD_PINNED]
               || integers(self, STEPS "PointDataOffsets/pinned", self->capacity, 1,
                           NULL))
           && (self->faces->names == NULL
               || integers(self, STEPS "PointDataOffsets/vertex", self->capacity, 1,
                           NULL))
           && (self->faces->part_count == 0
               || integers(self, STEPS "PointDataOffsets/cloth", self->capacity, 1,
                           NULL));
}

/* ---- steps ------------------------------------------------------------------ */

static bool steps(const builder *self)
{
    const size_t frames = self->capacity;
    return integers(self, STEPS "NumberOfParts", frames, 1, NULL)
           && integers(self, STEPS "PartOffsets", frames, 1, NULL)
           && integers(self, STEPS "CellOffsets", frames, 4, NULL)
           && same(self, STEPS "CellOffsets", STEPS "ConnectivityIdOffsets")
           && integers(self, "/weft/FieldOffsets", frames, 1, NULL)
           && integers(self, "/weft/FieldSizes", frames, 2, NULL)
           && each_field(self, ROOT "FieldData", NULL)
           && each_field(self, STEPS "FieldDataOffsets", "/weft/FieldOffsets")
           && each_field(self, STEPS "FieldDataSizes", "/weft/FieldSizes");
}

/* The one dataset that grows. Its only chunk has room for all times; 2^28 of them are
 * the most that a chunk may hold. allocate_times allocates it behind the fixed data. */
static bool times(const builder *self)
{
    const hsize_t one = 1, unlimited = H5S_UNLIMITED;
    const hsize_t chunk = self->capacity < 1 << 28 ? self->capacity : 1 << 28;
    const hid_t chunked = H5Pcopy(self->early);
    const hid_t space = H5Screate_simple(1, &one, &unlimited);
    const bool able = H5Pset_alloc_time(chunked, H5D_ALLOC_TIME_INCR) >= 0
                      && H5Pset_chunk(chunked, 1, &chunk) >= 0;
    const hid_t made = H5Dcreate2(self->file, STEPS "Values", H5T_IEEE_F64LE, space,
                                  self->parents, chunked, H5P_DEFAULT);
    const bool closed = H5Dclose(made) >= 0;
    (void)H5Sclose(space);
    (void)H5Pclose(chunked);
    return able && closed;
}

static bool allocate_times(const builder *self)
{
    const double none = 0.0;
    const hid_t id = H5Dopen2(self->file, STEPS "Values", H5P_DEFAULT);
    const bool good
        = H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &none) >= 0;
    return H5Dclose(id) >= 0 && good;
}

static bool heads(const builder *self)
{
    const int64_t version[2] = { 2, 0 };
    const char type[] = "PolyData";
    const hid_t text = H5Tcopy(H5T_C_S1);
    const bool good = H5Tset_size(text, sizeof type - 1) >= 0
                      && H5Tset_strpad(text, H5T_STR_NULLPAD) >= 0
                      && attribute(self, "/VTKHDF", "Version", H5T_STD_I64LE,
                                   H5T_NATIVE_INT64, 2, version)
                      && attribute(self, "/VTKHDF", "Type", text, text, 0, type);
    (void)H5Tclose(text);
    return good && make_group(self, "/weft")
           && integer_attribute(self, "/weft", "format", 1)
           && (self->faces->cols > 0
                   ? integer_attribute(self, "/weft", "rows", self->faces->rows)
                         && integer_attribute(self, "/weft", "cols", self->faces->cols)
                   : integer_attribute(self, "/weft", "vertices", self->n)
                         && integer_attribute(self, "/weft", "triangles",
                                              self->faces->triangles));
}

bool vtkhdf_file_create(const char *path, const record_vtkhdf_def *def, size_t capacity)
{
    const weft_cloth *whole = def->whole == NULL ? def->cloth : def->whole;
    record_faces faces;
    const bool taken = record_faces_of(whole, &faces, NULL) == WEFT_OK;
    const hid_t access = hdf_access();
    /* room before the frames for all metadata */
    (void)H5Pset_meta_block_size(access, (48 + def->series->columns) << 10);
    const builder self = {
        .file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access),
        .parents = H5Pcreate(H5P_LINK_CREATE),
        .early = H5Pcreate(H5P_DATASET_CREATE),
        .real = def->record->doubles ? H5T_IEEE_F64LE : H5T_IEEE_F32LE,
        .def = def,
        .cloth = whole,
        .faces = &faces,
        .n = weft_cloth_particles(whole),
        .capacity = capacity,
    };
    /* NSteps and the header of Steps/Values come first, so that both are in the first
     * page: they change in one write then, which a kill cannot cut in two */
    const bool good = taken && self.file >= 0
                      && H5Pset_create_intermediate_group(self.parents, 1) >= 0
                      && H5Pset_alloc_time(self.early, H5D_ALLOC_TIME_EARLY) >= 0
                      && H5Pset_fill_time(self.early, H5D_FILL_TIME_NEVER) >= 0
                      && H5Pset_obj_track_times(self.early, false) >= 0
                      && make_group(&self, STEPS)
                      && integer_attribute(&self, STEPS, "NSteps", 0) && times(&self)
                      && heads(&self) && fixed(&self) && particles(&self)
                      && allocate_times(&self) && steps(&self);
    const bool closed = self.file >= 0 && H5Fclose(self.file) >= 0;
    (void)H5Pclose(self.parents);
    (void)H5Pclose(self.early);
    (void)H5Pclose(access);
    record_faces_free(&faces);
    return good && closed;
}

/* ---- the first page --------------------------------------------------------- */

bool vtkhdf_read_page(const char *path, unsigned char page[RECORD_PAGE])
{
    FILE *stream = weft__file_open(path, "r", NULL);
    const bool good
        = stream != NULL && fread(page, 1, RECORD_PAGE, stream) == RECORD_PAGE;
    if (stream != NULL) {
        (void)fclose(stream);
    }
    return good;
}

/* The upper half of word 2 says whether the file was closed. */
bool vtkhdf_is_same_page(const unsigned char *before, const unsigned char *now,
                         size_t frames, size_t capacity)
{
    bool same = true;
    for (size_t at = 0; at < RECORD_PAGE; at += WEFT__WORD) {
        const uint64_t a = weft__word_at(before + at), b = weft__word_at(now + at);
        const bool added = a == frames && b >= frames && b <= capacity;
        const bool closed
            = at == 2 * WEFT__WORD && (uint32_t)a == (uint32_t)b && b >> 32 <= 1;
        same = same && (a == b || added || closed);
    }
    return same;
}
