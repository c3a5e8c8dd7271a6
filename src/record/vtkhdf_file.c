/* SPDX-License-Identifier: BSD-3-Clause */
/* vtkhdf_file.c -- the layout, as vtk 9.3 and later read it: NumberOfPoints and its
 * like have one entry, PartOffsets are 0, NumberOfParts is there, and so are all four
 * groups of cells. Tables that are equal are one dataset under several names; those
 * that are all 0 are never written, since a hole reads as 0. */
#include "record/vtkhdf_file.h"

#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/file.h"

#define ROOT  "/VTKHDF/"
#define STEPS "/VTKHDF/Steps/"

typedef struct builder {
    hid_t file, parents, early; /* property lists: make groups; allocate at once */
    const record_vtkhdf_def *def;
    size_t n, capacity;
    bool failed; /* some call did not succeed; the rest did nothing */
} builder;

bool vtkhdf_is_field(const char *column)
{
    return strcmp(column, "hash") != 0;
}

static void note(builder *self, bool good)
{
    self->failed = self->failed || !good;
}

/* ---- groups and attributes -------------------------------------------------- */

static void make_group(builder *self, const char *path)
{
    if (!self->failed) {
        const hid_t group
            = H5Gcreate2(self->file, path, self->parents, H5P_DEFAULT, H5P_DEFAULT);
        note(self, group >= 0 && H5Gclose(group) >= 0);
    }
}

/* An attribute of `count` values; 0: a single one. */
static void attribute(builder *self, const char *path, const char *name, hid_t type,
                      hid_t memory, hsize_t count, const void *values)
{
    if (self->failed) {
        return;
    }
    const hid_t space
        = count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, NULL);
    const hid_t made = H5Acreate_by_name(self->file, path, name, type, space,
                                         H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    note(self, made >= 0 && H5Awrite(made, memory, values) >= 0);
    (void)H5Aclose(made);
    (void)H5Sclose(space);
}

static void integer_attribute(builder *self, const char *path, const char *name,
                              size_t value)
{
    const int64_t wide = (int64_t)value;
    attribute(self, path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, 0, &wide);
}

/* ---- datasets --------------------------------------------------------------- */

/* rows x width, or a plain list where width is 1; values NULL: not written. */
static void dataset(builder *self, const char *path, hid_t type, size_t rows,
                    size_t width, hid_t memory, const void *values)
{
    const hsize_t extent[2] = { rows, width };
    if (self->failed) {
        return;
    }
    const hid_t space = H5Screate_simple(width > 1 ? 2 : 1, extent, NULL);
    const hid_t made = H5Dcreate2(self->file, path, type, space, self->parents,
                                  self->early, H5P_DEFAULT);
    note(self, made >= 0);
    if (values != NULL && made >= 0 && rows > 0) {
        note(self, H5Dwrite(made, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    }
    (void)H5Dclose(made);
    (void)H5Sclose(space);
}

static void integers(builder *self, const char *path, size_t rows, size_t width,
                     const int64_t *values)
{
    dataset(self, path, H5T_STD_I64LE, rows, width, H5T_NATIVE_INT64, values);
}

/* The same dataset under another name. */
static void same(builder *self, const char *path, const char *as)
{
    if (!self->failed) {
        note(self, H5Lcreate_hard(self->file, path, self->file, as, self->parents,
                                  H5P_DEFAULT)
                       >= 0);
    }
}

static void each_field(builder *self, const char *group, const char *path)
{
    const record_series *series = self->def->series;
    for (size_t i = 0; i < series->columns; ++i) {
        char name[160];
        (void)snprintf(name, sizeof name, "%s/%s", group, series->names[i]);
        if (vtkhdf_is_field(series->names[i])) {
            if (path == NULL) {
                dataset(self, name, H5T_IEEE_F64LE, self->capacity, 1,
                        H5T_NATIVE_DOUBLE, NULL);
            } else {
                same(self, path, name);
            }
        }
    }
}

/* ---- cells ------------------------------------------------------------------ */

/* `count` cells of `size` points each, one after another in `connectivity`. */
static void cells(builder *self, const char *group, size_t count, size_t size,
                  const int64_t *connectivity)
{
    static const char *const names[]
        = { "NumberOfCells", "NumberOfConnectivityIds", "Offsets", "Connectivity" };
    char paths[4][80];
    int64_t *offsets = malloc((count + 1) * sizeof *offsets);
    const int64_t cell_count = (int64_t)count, id_count = (int64_t)(count * size);
    if (offsets == NULL) {
        self->failed = true;
        return;
    }
    for (size_t i = 0; i < 4; ++i) {
        (void)snprintf(paths[i], sizeof paths[i], ROOT "%s/%s", group, names[i]);
    }
    for (size_t i = 0; i <= count; ++i) {
        offsets[i] = (int64_t)(i * size);
    }
    integers(self, paths[0], 1, 1, &cell_count);
    integers(self, paths[1], 1, 1, &id_count);
    integers(self, paths[2], count + 1, 1, offsets);
    integers(self, paths[3], count * size, 1, connectivity);
    free(offsets);
}

/* Quads a, a + cols, a + cols + 1, a + 1; a chain is one line through all particles. */
static void topology(builder *self)
{
    const size_t rows = weft_cloth_rows(self->def->cloth);
    const size_t cols = weft_cloth_cols(self->def->cloth);
    const size_t quads = (rows - 1) * (cols - 1);
    int64_t *ids = malloc((quads == 0 ? self->n : 4 * quads) * sizeof *ids);
    if (ids == NULL) {
        self->failed = true;
        return;
    }
    for (size_t q = 0; q < quads; ++q) {
        const size_t a = q / (cols - 1) * cols + q % (cols - 1);
        const size_t corners[4] = { a, a + cols, a + cols + 1, a + 1 };
        for (size_t k = 0; k < 4; ++k) {
            ids[4 * q + k] = (int64_t)corners[k];
        }
    }
    for (size_t i = 0; quads == 0 && i < self->n; ++i) {
        ids[i] = (int64_t)i;
    }
    cells(self, "Polygons", quads, 4, ids);
    cells(self, "Lines", quads == 0, self->n, ids);
    cells(self, "Vertices", 0, 0, NULL);
    cells(self, "Strips", 0, 0, NULL);
    free(ids);
}

/* ---- particles -------------------------------------------------------------- */

static void pinned(builder *self)
{
    uint8_t *flags = malloc(self->n);
    if (flags == NULL) {
        self->failed = true;
        return;
    }
    for (size_t i = 0; i < self->n; ++i) {
        flags[i] = weft_cloth_pinned(self->def->cloth, i);
    }
    dataset(self, ROOT "PointData/pinned", H5T_STD_U8LE, self->n, 1, H5T_NATIVE_UINT8,
            flags);
    free(flags);
}

static void rest(builder *self)
{
    double *xyz = malloc(3 * self->n * sizeof *xyz);
    if (xyz == NULL) {
        self->failed = true;
        return;
    }
    weft_cloth_rest(self->def->cloth, xyz);
    dataset(self, "/weft/Rest", H5T_IEEE_F64LE, self->n, 3, H5T_NATIVE_DOUBLE, xyz);
    free(xyz);
}

/* What no frame changes. */
static void fixed(builder *self)
{
    const int64_t count = (int64_t)self->n;
    integers(self, ROOT "NumberOfPoints", 1, 1, &count);
    make_group(self, ROOT "PointData");
    if (self->def->record->fields[WEFT_RECORD_PINNED]) {
        pinned(self);
    }
    rest(self);
    topology(self);
}

static void particles(builder *self)
{
    const weft_record_def *record = self->def->record;
    const hid_t real = record->doubles ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
    const size_t rows = self->capacity * self->n;
    dataset(self, ROOT "Points", real, rows, 3, 0, NULL);
    integers(self, STEPS "PointOffsets", self->capacity, 1, NULL);
    make_group(self, STEPS "PointDataOffsets");
    if (record->fields[WEFT_RECORD_VELOCITY]) {
        dataset(self, ROOT "PointData/velocity", real, rows, 3, 0, NULL);
        same(self, STEPS "PointOffsets", STEPS "PointDataOffsets/velocity");
    }
    if (record->fields[WEFT_RECORD_STRAIN]) {
        dataset(self, ROOT "PointData/strain", real, rows, 1, 0, NULL);
        same(self, STEPS "PointOffsets", STEPS "PointDataOffsets/strain");
    }
    if (record->fields[WEFT_RECORD_PINNED]) {
        integers(self, STEPS "PointDataOffsets/pinned", self->capacity, 1, NULL);
    }
}

/* ---- steps ------------------------------------------------------------------ */

static void steps(builder *self)
{
    integers(self, STEPS "NumberOfParts", self->capacity, 1, NULL);
    integers(self, STEPS "PartOffsets", self->capacity, 1, NULL);
    integers(self, STEPS "CellOffsets", self->capacity, 4, NULL);
    same(self, STEPS "CellOffsets", STEPS "ConnectivityIdOffsets");
    integers(self, "/weft/FieldOffsets", self->capacity, 1, NULL);
    integers(self, "/weft/FieldSizes", self->capacity, 2, NULL);
    each_field(self, ROOT "FieldData", NULL);
    each_field(self, STEPS "FieldDataOffsets", "/weft/FieldOffsets");
    each_field(self, STEPS "FieldDataSizes", "/weft/FieldSizes");
}

/* The one dataset that grows. Its only chunk holds every time there may be; 2^28 of
 * them are the most that a chunk may hold. allocate_times makes it, behind all that no
 * frame changes. */
static void times(builder *self)
{
    const hsize_t one = 1, unlimited = H5S_UNLIMITED;
    const hsize_t chunk = self->capacity < 1 << 28 ? self->capacity : 1 << 28;
    if (self->failed) {
        return;
    }
    const hid_t chunked = H5Pcopy(self->early);
    note(self, H5Pset_alloc_time(chunked, H5D_ALLOC_TIME_INCR) >= 0);
    const hid_t space = H5Screate_simple(1, &one, &unlimited);
    note(self, H5Pset_chunk(chunked, 1, &chunk) >= 0);
    const hid_t made = H5Dcreate2(self->file, STEPS "Values", H5T_IEEE_F64LE, space,
                                  self->parents, chunked, H5P_DEFAULT);
    note(self, made >= 0);
    (void)H5Dclose(made);
    (void)H5Sclose(space);
    (void)H5Pclose(chunked);
}

/* NSteps and the header of Steps/Values side by side, in the first page of the file:
 * both change in one write then, which a kill cannot cut in two. So they come first. */
static void counts(builder *self)
{
    make_group(self, STEPS);
    integer_attribute(self, STEPS, "NSteps", 0);
    times(self);
}

static void allocate_times(builder *self)
{
    const double none = 0.0;
    if (!self->failed) {
        const hid_t id = H5Dopen2(self->file, STEPS "Values", H5P_DEFAULT);
        note(self, H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &none)
                       >= 0);
        (void)H5Dclose(id);
    }
}

static void heads(builder *self)
{
    const int64_t version[2] = { 2, 0 };
    const char type[] = "PolyData";
    const hid_t text = H5Tcopy(H5T_C_S1);
    note(self, H5Tset_size(text, sizeof type - 1) >= 0
                   && H5Tset_strpad(text, H5T_STR_NULLPAD) >= 0);
    attribute(self, "/VTKHDF", "Version", H5T_STD_I64LE, H5T_NATIVE_INT64, 2, version);
    attribute(self, "/VTKHDF", "Type", text, text, 0, type);
    (void)H5Tclose(text);
    make_group(self, "/weft");
    integer_attribute(self, "/weft", "format", 1);
    integer_attribute(self, "/weft", "rows", weft_cloth_rows(self->def->cloth));
    integer_attribute(self, "/weft", "cols", weft_cloth_cols(self->def->cloth));
}

bool vtkhdf_file_create(const char *path, const record_vtkhdf_def *def, size_t capacity)
{
    const hid_t access = hdf_access();
    /* room before the frames for all that describes the file */
    (void)H5Pset_meta_block_size(access, (16 + def->series->columns) << 10);
    builder self = {
        .file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access),
        .parents = H5Pcreate(H5P_LINK_CREATE),
        .early = H5Pcreate(H5P_DATASET_CREATE),
        .def = def,
        .n = weft_cloth_particles(def->cloth),
        .capacity = capacity,
    };
    note(&self, self.file >= 0 && H5Pset_create_intermediate_group(self.parents, 1) >= 0
                    && H5Pset_alloc_time(self.early, H5D_ALLOC_TIME_EARLY) >= 0
                    && H5Pset_fill_time(self.early, H5D_FILL_TIME_NEVER) >= 0
                    && H5Pset_obj_track_times(self.early, false) >= 0);
    counts(&self);
    heads(&self);
    fixed(&self);
    particles(&self);
    allocate_times(&self);
    steps(&self);
    note(&self, self.file >= 0 && H5Fclose(self.file) >= 0);
    (void)H5Pclose(self.parents);
    (void)H5Pclose(self.early);
    (void)H5Pclose(access);
    return !self.failed;
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
