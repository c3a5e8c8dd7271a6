/* SPDX-License-Identifier: BSD-3-Clause */
/* obj_flat.c -- the rest shape of a file without vt: v itself, if it is flat. */
#include <math.h>
#include <string.h>

#include "base/finite.h"
#include "mesh/rigid.h"
#include "scene/obj.h"

/* A surface that leaves its plane by less than FLAT of its extent is flat, and by less
 * than ROUNDED without a warning. */
#define FLAT    1e-3
#define ROUNDED 1e-6
#define AXIS    1e-9 /* smaller components of a normal are rounding: an axis stays one */
#define HALF    0.7071067811865476 /* cosine of 45 degrees */

/* Turns rows p and q of a symmetric matrix so that their product vanishes, and the
 * columns of `turn` with them. */
static void turn_rows(double a[3][3], double turn[3][3], size_t p, size_t q)
{
    const double half = 0.5 * (a[q][q] - a[p][p]);
    const double t
        = a[p][q] / (half + copysign(sqrt(half * half + a[p][q] * a[p][q]), half));
    const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    for (size_t k = 0; k < 3; ++k) {
        const double x = a[k][p], y = a[k][q], u = turn[k][p], v = turn[k][q];
        a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
        turn[k][p] = c * u - s * v, turn[k][q] = s * u + c * v;
    }
    for (size_t k = 0; k < 3; ++k) {
        const double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
    }
}

/* The unit eigenvector of the least eigenvalue, by Jacobi's method. */
static void least_direction(double a[3][3], double out[3])
{
    double turn[3][3] = { { 1.0 }, { 0.0, 1.0 }, { 0.0, 0.0, 1.0 } };
    enum { ROUNDS = 20 }; /* 6 are enough for doubles */
    for (size_t i = 0; i < 3 * ROUNDS; ++i) {
        const size_t p = i % 3 == 2 ? 1 : 0, q = i % 3 == 0 ? 1 : 2;
        if (a[p][q] != 0.0) {
            turn_rows(a, turn, p, q);
        }
    }
    size_t least = 0;
    for (size_t k = 1; k < 3; ++k) {
        least = a[k][k] < a[least][least] ? k : least;
    }
    for (size_t k = 0; k < 3; ++k) {
        out[k] = fabs(turn[k][least]) < AXIS ? 0.0 : turn[k][least];
    }
    const double length = weft__length(out);
    for (size_t k = 0; k < 3; ++k) {
        out[k] /= length;
    }
}

/* The vertices of faces: their mean, and the longest side of the box around them, with
 * which they are measured. */
typedef struct cloud {
    const weft__obj *obj;
    const bool *used;
    double mean[3], extent;
} cloud;

static cloud cloud_of(const weft__obj *obj, const bool *used)
{
    cloud out = { .obj = obj, .used = used };
    double low[3] = { INFINITY, INFINITY, INFINITY };
    double high[3] = { -INFINITY, -INFINITY, -INFINITY };
    size_t count = 0;
    for (size_t v = 0; v < obj->vertices; ++v) {
        for (size_t k = 0; k < 3 && used[v]; ++k) {
            const double x = obj->vertex[v][k];
            out.mean[k] += x;
            low[k] = fmin(low[k], x), high[k] = fmax(high[k], x);
        }
        count += used[v];
    }
    for (size_t k = 0; k < 3; ++k) {
        out.mean[k] /= (double)count;
        out.extent = fmax(out.extent, high[k] - low[k]);
    }
    out.extent = out.extent > 0.0 ? out.extent : 1.0;
    return out;
}

/* Where a vertex lies from the mean, as a part of the extent. */
static void away_of(const cloud *of, size_t v, double out[3])
{
    for (size_t k = 0; k < 3; ++k) {
        out[k] = (of->obj->vertex[v][k] - of->mean[k]) / of->extent;
    }
}

/* The normal of the plane that fits best, and the largest distance from it as a part of
 * the extent. */
static double fit_plane(const cloud *of, double normal[3])
{
    double sums[3][3] = { { 0.0 } }, x[3], most = 0.0;
    for (size_t v = 0; v < of->obj->vertices; ++v) {
        away_of(of, v, x);
        for (size_t j = 0; j < 9 && of->used[v]; ++j) {
            sums[j / 3][j % 3] += x[j / 3] * x[j % 3];
        }
    }
    least_direction(sums, normal);
    for (size_t v = 0; v < of->obj->vertices; ++v) {
        away_of(of, v, x);
        most = of->used[v] ? fmax(most, fabs(weft__dot(normal, x))) : most;
    }
    return most;
}

/* The directions of u and v: v along what lies in the plane of the y axis, of the z
 * axis in a plane nearer to the horizontal, and u across, towards the positive end of
 * the axis that it is nearest to. */
static void directions_of(const double n[3], double u[3], double v[3])
{
    const size_t up = fabs(n[1]) > HALF + AXIS ? 2 : 1;
    for (size_t k = 0; k < 3; ++k) {
        v[k] = (k == up ? 1.0 : 0.0) - n[up] * n[k];
    }
    const double length = weft__length(v);
    for (size_t k = 0; k < 3; ++k) {
        v[k] /= length;
    }
    weft__cross(v, n, u);
    size_t most = fabs(u[1]) > fabs(u[0]) ? 1 : 0;
    most = fabs(u[2]) > fabs(u[most]) ? 2 : most;
    const double sign = u[most] < 0.0 ? -1.0 : 1.0;
    for (size_t k = 0; k < 3; ++k) {
        u[k] *= sign;
    }
}

/* Gives each vertex a place, and each face those of its vertices. */
static void put_places(weft__obj *obj, const double u[3], const double v[3])
{
    for (size_t i = 0; i < obj->vertices; ++i) {
        obj->place[i][0] = weft__dot(u, obj->vertex[i]);
        obj->place[i][1] = weft__dot(v, obj->vertex[i]);
        obj->place_byte[i] = obj->vertex_byte[i];
    }
    for (size_t f = 0; f < obj->faces; ++f) {
        memcpy(obj->face[f].place, obj->face[f].vertex, sizeof obj->face[f].place);
    }
    obj->places = obj->vertices;
    obj->flat_rest = true;
    memcpy(obj->warp, v, sizeof obj->warp);
}

static bool lay_flat(weft__obj *obj, const bool *used)
{
    double normal[3], u[3], v[3];
    const cloud of = cloud_of(obj, used);
    const double away = fit_plane(&of, normal);
    const weft__mark at = weft__obj_mark(obj, obj->face[0].byte);
    if (!(away <= FLAT)) {
        weft__report_error(
            obj->report, at,
            "the file has no vt lines, which give the rest shape in the plane, and v "
            "is not flat: it leaves its plane by %.3g of its extent of %.3g; `rest: "
            "start` takes the start as it is, or unwrap the mesh and export its UVs as "
            "lengths",
            away, of.extent);
        return false;
    }
    if (away > ROUNDED) {
        weft__report_warning(obj->report, at,
                             "the file has no vt lines, and v leaves its plane by %.3g "
                             "of its extent of %.3g: the rest shape is that plane",
                             away, of.extent);
    }
    directions_of(normal, u, v);
    put_places(obj, u, v);
    if (!weft__all_finite(obj->place[0], 2 * obj->places)) {
        weft__report_error(obj->report, at, "v is too large for a plane of doubles");
        return false;
    }
    return true;
}

bool weft__obj_lay_flat(weft__obj *obj)
{
    weft__report *report = obj->report;
    const size_t n = obj->vertices;
    bool flat = false;
    WEFT__FREE_ALL(report->memory, obj->place, obj->place_byte);
    obj->place = weft__report_take(report, n, sizeof *obj->place);
    obj->place_byte = weft__report_take(report, n, sizeof *obj->place_byte);
    bool *used = weft__report_take(report, n, sizeof *used);
    if (!report->no_memory) {
        for (size_t f = 0; f < obj->faces; ++f) {
            for (size_t k = 0; k < 4 && obj->face[f].vertex[k] != WEFT__NONE; ++k) {
                used[obj->face[f].vertex[k]] = true;
            }
        }
        flat = lay_flat(obj, used);
    }
    weft__free(report->memory, used);
    return flat;
}
