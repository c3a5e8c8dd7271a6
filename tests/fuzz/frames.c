/* SPDX-License-Identifier: BSD-3-Clause */
/* frames.c -- files that libhdf5 can read, of any content, as run.vtkhdf: refused, or
 * frames that are finite. The bytes choose sizes, types and values of all that the
 * reader asks for; broken HDF5 is that of the target `vtkhdf`. */
#include "fuzz/frames.h"
#include "program/record/vtkhdf_file.h"

typedef struct bytes {
    const uint8_t *at, *end;
} bytes;

static unsigned next(bytes *from)
{
    return from->at < from->end ? *from->at++ : 0;
}

/* Mostly right, so that what comes after is looked at too. */
static hsize_t near(bytes *from, hsize_t right)
{
    const unsigned byte = next(from);
    return byte < 224 ? right : byte < 240 ? right + byte - 232 : byte - 240;
}

static hid_t type_of(bytes *from, hid_t right)
{
    const hid_t others[]
        = { H5T_STD_I64LE,  H5T_STD_U8LE,   H5T_STD_I32BE, H5T_IEEE_F32LE,
            H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_C_S1 };
    const unsigned byte = next(from);
    return byte < 240 ? right : others[byte % (sizeof others / sizeof others[0])];
}

/* Numbers that rise by 1, mostly. */
static void fill(bytes *from, double first, double *values, size_t count)
{
    static const double odd[] = { NAN, INFINITY, -1.0, 1e300, 0.5, 0.0 };
    for (size_t i = 0; i < count; ++i) {
        const unsigned byte = next(from);
        values[i] = byte < 250 ? first + (double)i : odd[byte - 250];
    }
}

enum { MOST = 4096 };

static hid_t space_of(bytes *from, hsize_t rows, hsize_t width)
{
    const hsize_t extent[3] = { near(from, rows), near(from, width), 1 };
    const unsigned rank = next(from);
    return rank > 250 ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(rank > 245  ? 3
                                         : width > 1 ? 2
                                                     : 1,
                                         extent, NULL);
}

static void put_values(bytes *from, hid_t id, hid_t space, double first)
{
    static double values[MOST];
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (count > 0 && count <= MOST) {
        fill(from, first, values, (size_t)count);
        (void)H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    }
}

/* A set, which may be missing. */
static void put_set(bytes *from, hid_t file, const char *path, hid_t type, hsize_t rows,
                    hsize_t width, double first)
{
    if (next(from) > 240) {
        return;
    }
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    (void)H5Pset_create_intermediate_group(links, 1);
    const hid_t of = type_of(from, type), space = space_of(from, rows, width);
    const hid_t id = H5Dcreate2(file, path, of, space, links, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0) {
        put_values(from, id, space, first);
    }
    (void)H5Dclose(id);
    (void)H5Sclose(space);
    (void)H5Pclose(links);
}

/* An integer of an object, which may be missing, or be wrong. */
static void put_integer(bytes *from, hid_t file, const char *object, const char *name,
                        hsize_t right)
{
    static const int64_t odd[] = { 0, -1, INT64_MAX, INT64_MIN, (int64_t)1 << 31 };
    const unsigned byte = next(from);
    const size_t count = sizeof odd / sizeof odd[0];
    const int64_t value
        = byte >= 256 - count ? odd[256 - byte - 1] : (int64_t)near(from, right);
    const hid_t of = type_of(from, H5T_STD_I64LE);
    const hid_t space = next(from) < 250 ? H5Screate(H5S_SCALAR) : space_of(from, 1, 1);
    const hid_t group = H5Oopen(file, object, H5P_DEFAULT);
    const hid_t id = H5Acreate2(group, name, of, space, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0 && H5Sget_simple_extent_npoints(space) == 1) {
        (void)H5Awrite(id, H5T_NATIVE_INT64, &value);
    }
    (void)H5Aclose(id);
    (void)H5Oclose(group);
    (void)H5Sclose(space);
}

static void make_file(bytes *from)
{
    const hsize_t rows = 2, cols = 2 + next(from) % 2, n = rows * cols;
    const hsize_t count = 1 + next(from) % 3;
    const hid_t real = next(from) % 2 == 0 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
    const hid_t access = hdf_access();
    const hid_t file
        = H5Fcreate(fuzz_file("run.vtkhdf"), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    HOLDS(file >= 0);
    put_set(from, file, "/weft/Rest", H5T_IEEE_F64LE, n, 3, 0.0);
    put_set(from, file, "/VTKHDF/Steps/Values", H5T_IEEE_F64LE, count, 1, 0.0);
    put_set(from, file, "/VTKHDF/FieldData/frame", H5T_IEEE_F64LE, count, 1, 0.0);
    put_set(from, file, "/VTKHDF/NumberOfPoints", H5T_STD_I64LE, 1, 1, (double)n);
    put_set(from, file, "/VTKHDF/Points", real, count * n, 3, 0.0);
    put_set(from, file, "/VTKHDF/PointData/velocity", real, count * n, 3, 0.0);
    put_set(from, file, "/VTKHDF/PointData/strain", real, count * n, 1, 0.0);
    put_set(from, file, "/VTKHDF/PointData/pinned", H5T_STD_U8LE, n, 1, 0.0);
    put_integer(from, file, "/weft", "rows", rows);
    put_integer(from, file, "/weft", "cols", cols);
    put_integer(from, file, "/VTKHDF/Steps", "NSteps", count);
    (void)H5Pclose(access);
    HOLDS(H5Fclose(file) >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes from = { data, data + size };
    hdf_begin(NULL);
    make_file(&from);
    frames_check();
    return 0;
}
