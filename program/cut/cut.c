/* SPDX-License-Identifier: BSD-3-Clause */
/* cut.c -- from lines to a mesh. Points inside, first on rows, go to where triangles
 * are even: to the mean of the centroids around them, weighted by area (L. Chen, M.
 * Holst, Comput. Methods Appl. Mech. Engrg. 200, 2011), between Delaunay
 * triangulations. A line without its edge is halved. Where an angle stays small, the
 * centre of the triangle's circle is added, or a line that it is too near to is halved
 * (J. Ruppert, J. Algorithms 18, 1995). */
#include "program/cut/cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "base/plane.h"

#define ROW    0.8660254037844386 /* [spacings] from row to row of equal triangles */
#define JITTER 0.1                /* [spacings] of the first points inside */
#define CLEAR  0.65   /* [spacings] around points on lines that has no point inside */
#define SMALL  0.5095 /* tan(27 degrees): smaller angles are refined */
/* [sizes] Sizes grow from point to point, so that points end; shorter edges and halves
 * of parts may have small angles. */
#define GROWTH     1.5
#define LEAST_EDGE 0.25
#define LEAST_HALF 0.12
#define FLAT                                                                           \
    1e-5 /* of the longest edge: what lower triangle of line points is none            \
          */
#define NOISE   1e-7 /* [spacings] so that no four points lie on one circle */
#define DEGREES 57.29577951308232

enum { ROUNDS = 16, LARGE = 200000, ROUNDS_LARGE = 3, REFINED = 40, MOST_ROUNDS = 200 };

typedef struct cut_point {
    double at[2]; /* [m] */
    double size;  /* [m] of the triangles around it */
    bool fixed;   /* on a line */
} cut_point;

/* Part of a line, an edge of the mesh. */
typedef struct cut_part {
    uint32_t from, to, line, next; /* next: behind it; CUT_NONE: the last */
    bool found;                    /* in the last triangulation */
} cut_part;

typedef struct cutter {
    const weft_cut *cut;
    weft_allocator memory; /* of all but the mesh */
    cut_point *point;
    size_t points, point_room;
    cut_part *parts;
    size_t part_count, part_room;
    uint32_t *first;  /* part of a line */
    weft__ends *ends; /* of all parts at the last triangulation, sorted */
    size_t end_count, end_room;
    uint32_t *corner;
    size_t triangles; /* inside, counterclockwise */
    uint32_t *number; /* of a point in the mesh */
    bool no_memory;
} cutter;

/* ---- points and parts ---------------------------------------------------------- */

static bool reserve(cutter *self, void *to, size_t *room, size_t count, size_t size)
{
    const bool made = weft__reserve(&self->memory, to, room, count, size);
    self->no_memory = self->no_memory || !made;
    return made;
}

/* Zeroed. */
static void *take(cutter *self, size_t count, size_t size)
{
    void *block = weft__zeroed(&self->memory, count, size);
    self->no_memory = self->no_memory || block == NULL;
    return block;
}

static uint32_t add_point(cutter *self, double u, double v, double size, bool fixed)
{
    const size_t i = self->points;
    if (!reserve(self, &self->point, &self->point_room, i + 1, sizeof *self->point)) {
        return 0;
    }
    self->point[i] = (cut_point){ { u, v }, fmin(size, self->cut->spacing), fixed };
    return (uint32_t)self->points++;
}

static void add_part(cutter *self, cut_part one)
{
    if (reserve(self, &self->parts, &self->part_room, self->part_count + 1,
                sizeof *self->parts)) {
        self->parts[self->part_count++] = one;
    }
}

/* Points of the cut have their numbers there. */
static void add_line(cutter *self, size_t line)
{
    const uint32_t *end = &self->cut->lines[2 * line];
    const double a[] = { self->point[end[0]].at[0], self->point[end[0]].at[1] };
    const double b[] = { self->point[end[1]].at[0], self->point[end[1]].at[1] };
    const double length = sqrt(weft__squared(a, b));
    const double count = fmax(1.0, rint(length / self->cut->spacing));
    uint32_t from = end[0];
    for (size_t k = 0; k < 2; ++k) {
        self->point[end[k]].size = fmin(self->point[end[k]].size, length / count);
    }
    self->first[line] = (uint32_t)self->part_count;
    for (double i = 1.0; i <= count && !self->no_memory; i += 1.0) {
        const double s = i / count;
        const bool last = i == count;
        const uint32_t to
            = last ? end[1]
                   : add_point(self, a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]),
                               length / count, true);
        add_part(self, (cut_part){ .from = from,
                                   .to = to,
                                   .line = (uint32_t)line,
                                   .next = last ? CUT_NONE
                                                : (uint32_t)self->part_count + 1 });
        from = to;
    }
}

/* Where a part of a length is halved: one that begins in a point of the cut on a circle
 * around it that has a power of two as its radius, or two at a sharp corner would halve
 * each other for ever. */
static double place_of_half(const cutter *self, const cut_part *one, double length)
{
    const bool from = one->from < self->cut->point_count,
               to = one->to < self->cut->point_count;
    int power;
    const double whole = frexp(length, &power);
    const double near = (whole > 0.75 ? 0.5 : 0.25) / whole;
    return from == to ? 0.5 : from ? near : 1.0 - near;
}

/* [m] The least of the sizes at some points. */
static double size_of(const cutter *self, size_t count, const uint32_t *points)
{
    double size = self->cut->spacing;
    for (size_t k = 0; k < count; ++k) {
        size = fmin(size, self->point[points[k]].size);
    }
    return size;
}

/* Unless a half were shorter than `least` sizes. */
static bool halve(cutter *self, size_t index, double least)
{
    const cut_part whole = self->parts[index];
    const double *a = self->point[whole.from].at, *b = self->point[whole.to].at;
    const double length = sqrt(weft__squared(a, b)),
                 s = place_of_half(self, &whole, length);
    const double size = size_of(self, 2, (const uint32_t[]){ whole.from, whole.to });
    if (length < 2.0 * least * size) {
        return false;
    }
    const uint32_t middle = add_point(self, a[0] + s * (b[0] - a[0]),
                                      a[1] + s * (b[1] - a[1]), GROWTH * size, true);
    self->parts[index].to = middle;
    self->parts[index].next = (uint32_t)self->part_count;
    add_part(self, (cut_part){ .from = middle,
                               .to = whole.to,
                               .line = whole.line,
                               .next = whole.next });
    return true;
}

/* ---- points inside ------------------------------------------------------------- */

/* A random number of [0, 1) that depends on all three (splitmix64). */
static double random_of(uint64_t seed, uint64_t number, uint64_t which)
{
    uint64_t z = seed * 0x9E3779B97F4A7C15U + number * 0xD1B54A32D192ED03U + which + 1;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where the border passes a height v, from the left. */
static size_t crossings(const cutter *self, double v, double *list)
{
    size_t count = 0;
    for (size_t i = 0; i < self->cut->border_count; ++i) {
        const double *a = self->point[self->cut->lines[2 * i]].at,
                     *b = self->point[self->cut->lines[2 * i + 1]].at;
        if ((a[1] > v) != (b[1] > v)) {
            list[count++] = a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        }
    }
    qsort(list, count, sizeof *list, by_size);
    return count;
}

static bool is_inside(const cutter *self, double u, double v)
{
    bool inside = false;
    for (size_t i = 0; i < self->cut->border_count; ++i) {
        const double *a = self->point[self->cut->lines[2 * i]].at,
                     *b = self->point[self->cut->lines[2 * i + 1]].at;
        inside ^= (a[1] > v) != (b[1] > v)
                  && u < a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
    }
    return inside;
}

static void add_row(cutter *self, int64_t row, double from, double to)
{
    const double h = self->cut->spacing, shift = row % 2 == 0 ? 0.0 : 0.5;
    for (double i = ceil(from / h - shift); (i + shift) * h < to; i += 1.0) {
        const uint64_t number
            = (uint64_t)row * 0x2545F4914F6CDD1DU + (uint64_t)(int64_t)i;
        double at[2] = { i + shift, (double)row * ROW };
        for (uint64_t k = 0; k < 2; ++k) {
            at[k] += JITTER * (2.0 * random_of(self->cut->seed, number, k) - 1.0);
        }
        (void)add_point(self, at[0] * h, at[1] * h, h, false);
    }
}

static void add_inside(cutter *self)
{
    const double high = ROW * self->cut->spacing;
    double low = INFINITY, top = -INFINITY;
    double *list = take(self, self->cut->border_count, sizeof *list);
    for (size_t i = 0; i < 2 * self->cut->border_count; ++i) {
        const double v = self->point[self->cut->lines[i]].at[1];
        low = fmin(low, v), top = fmax(top, v);
    }
    for (int64_t row = (int64_t)ceil(low / high);
         (double)row * high < top && !self->no_memory; ++row) {
        const size_t count = crossings(self, (double)row * high, list);
        for (size_t i = 0; i + 1 < count; i += 2) {
            add_row(self, row, list[i], list[i + 1]);
        }
    }
    weft__free(&self->memory, list);
}

/* ---- triangles ----------------------------------------------------------------- */

static void sort_ends(cutter *self)
{
    self->end_count = 0;
    if (!reserve(self, &self->ends, &self->end_room, self->part_count,
                 sizeof *self->ends)) {
        return;
    }
    for (size_t i = 0; i < self->part_count; ++i) {
        cut_part *one = &self->parts[i];
        one->found = false;
        self->ends[self->end_count++] = weft__ends_of(one->from, one->to, (uint32_t)i);
    }
    qsort(self->ends, self->end_count, sizeof *self->ends, weft__compare_ends);
}

/* The part from a to b or back; NULL: there is none. */
static cut_part *part_of(const cutter *self, uint32_t a, uint32_t b)
{
    const weft__ends wanted = weft__ends_of(a, b, 0);
    const weft__ends *found = !self->point[a].fixed || !self->point[b].fixed
                                  ? NULL
                                  : bsearch(&wanted, self->ends, self->end_count,
                                            sizeof wanted, weft__compare_ends);
    return found == NULL ? NULL : &self->parts[found->number];
}

/* Turns a triangle counterclockwise, finds the parts that are its edges, and tells
 * whether it lies inside. That lies with its centroid, unless a corner is inside. */
static bool take_triangle(cutter *self, uint32_t c[3])
{
    double area = weft__plane_turn(self->point[c[0]].at, self->point[c[1]].at,
                                   self->point[c[2]].at),
           u = 0.0, v = 0.0, longest = 0.0;
    bool fixed = true;
    if (area < 0.0) {
        const uint32_t one = c[1];
        c[1] = c[2], c[2] = one, area = -area;
    }
    for (unsigned k = 0; k < 3; ++k) {
        cut_part *along = part_of(self, c[k], c[(k + 1) % 3]);
        const double *x = self->point[c[k]].at;
        if (along != NULL) {
            along->found = true;
        }
        u += x[0] / 3.0, v += x[1] / 3.0;
        fixed = fixed && self->point[c[k]].fixed;
        longest = fmax(longest, weft__squared(x, self->point[c[(k + 1) % 3]].at));
    }
    return !fixed || (area > FLAT * longest && is_inside(self, u, v));
}

static bool triangulate(cutter *self)
{
    const double noise = NOISE * self->cut->spacing;
    double(*moved)[2] = take(self, self->points, sizeof *moved);
    size_t count = 0;
    free(self->corner);
    self->corner = NULL;
    self->triangles = 0;
    sort_ends(self);
    for (size_t i = 0; moved != NULL && i < 2 * self->points; ++i) {
        moved[i / 2][i % 2] = self->point[i / 2].at[i % 2]
                              + noise * random_of(self->cut->seed, i / 2, i % 2);
    }
    if (moved != NULL && !self->no_memory) {
        self->corner = cut_delaunay(self->points, &moved[0][0], &count);
    }
    weft__free(&self->memory, moved);
    for (size_t t = 0; t < count; ++t) {
        uint32_t *c = &self->corner[3 * t];
        if (take_triangle(self, c)) {
            memmove(&self->corner[3 * self->triangles++], c, 3 * sizeof *c);
        }
    }
    return self->corner != NULL;
}

/* ---- better triangles ---------------------------------------------------------- */

/* Drops points inside that are too near to one on a line; that is a neighbour then. */
static void drop_near(cutter *self)
{
    const double reach = CLEAR * self->cut->spacing;
    size_t kept = 0;
    bool *near = take(self, self->points, sizeof *near);
    if (near == NULL) {
        return;
    }
    for (size_t i = 0; i < 3 * self->triangles; ++i) {
        const uint32_t a = self->corner[i], b = self->corner[i - i % 3 + (i + 1) % 3];
        if (self->point[a].fixed != self->point[b].fixed
            && weft__squared(self->point[a].at, self->point[b].at) < reach * reach) {
            near[self->point[a].fixed ? b : a] = true;
        }
    }
    for (size_t i = 0; i < self->points; ++i) {
        if (!near[i]) {
            self->point[kept++] = self->point[i];
        }
    }
    self->points = kept;
    weft__free(&self->memory, near);
}

/* Halves the parts that are no edges. How many; -1: *at is too short for that. */
static int halve_missing(cutter *self, const double **at)
{
    const size_t count = self->part_count;
    int halved = 0;
    for (size_t i = 0; i < count && !self->no_memory; ++i) {
        if (!self->parts[i].found) {
            if (!halve(self, i, LEAST_HALF / 16.0)) {
                *at = self->point[self->parts[i].from].at;
                return -1;
            }
            ++halved;
        }
    }
    return halved;
}

static void smooth(cutter *self)
{
    double(*sum)[3] = take(self, self->points, sizeof *sum);
    for (size_t t = 0; sum != NULL && t < self->triangles; ++t) {
        const uint32_t *c = &self->corner[3 * t];
        const double *x = self->point[c[0]].at, *y = self->point[c[1]].at,
                     *z = self->point[c[2]].at;
        const double area = weft__plane_turn(x, y, z);
        for (unsigned k = 0; k < 3; ++k) {
            sum[c[k]][0] += area * (x[0] + y[0] + z[0]);
            sum[c[k]][1] += area * (x[1] + y[1] + z[1]);
            sum[c[k]][2] += 3.0 * area;
        }
    }
    for (size_t i = 0; sum != NULL && i < self->points; ++i) {
        if (!self->point[i].fixed && sum[i][2] > 0.0) {
            self->point[i].at[0] = sum[i][0] / sum[i][2];
            self->point[i].at[1] = sum[i][1] / sum[i][2];
        }
    }
    weft__free(&self->memory, sum);
}

/* Tangent of the smallest angle of a triangle, opposite its shortest edge. */
static double angle_of(const cutter *self, const uint32_t c[3], unsigned *corner)
{
    double edge[3];
    unsigned k = 0;
    for (unsigned i = 0; i < 3; ++i) {
        edge[i] = weft__squared(self->point[c[(i + 1) % 3]].at,
                                self->point[c[(i + 2) % 3]].at);
        k = edge[i] < edge[k] ? i : k;
    }
    *corner = k;
    return 2.0
           * weft__plane_turn(self->point[c[0]].at, self->point[c[1]].at,
                              self->point[c[2]].at)
           / (edge[(k + 1) % 3] + edge[(k + 2) % 3] - edge[k]);
}

/* Whether corner k lies between two parts: its angle is given. */
static bool is_given(const cutter *self, const uint32_t c[3], unsigned k)
{
    return part_of(self, c[k], c[(k + 1) % 3]) != NULL
           && part_of(self, c[k], c[(k + 2) % 3]) != NULL;
}

/* Square of the radius. */
static double circle_of(const cutter *self, const uint32_t c[3], double centre[2])
{
    const double *a = self->point[c[0]].at, *x = self->point[c[1]].at,
                 *y = self->point[c[2]].at;
    const double d = 2.0 * weft__plane_turn(a, x, y), p = weft__squared(a, x),
                 q = weft__squared(a, y);
    centre[0] = a[0] + ((y[1] - a[1]) * p - (x[1] - a[1]) * q) / d;
    centre[1] = a[1] + ((x[0] - a[0]) * q - (y[0] - a[0]) * p) / d;
    return weft__squared(a, centre);
}

/* Halves the parts that are seen at more than a right angle from a point; whether there
 * are some. */
static bool halve_near(cutter *self, const double x[2], size_t count, bool *halved)
{
    bool near = false;
    for (size_t i = 0; i < count && !self->no_memory; ++i) {
        const double *a = self->point[self->parts[i].from].at,
                     *b = self->point[self->parts[i].to].at;
        if ((a[0] - x[0]) * (b[0] - x[0]) + (a[1] - x[1]) * (b[1] - x[1]) < 0.0) {
            near = true;
            *halved = halve(self, i, LEAST_HALF) || *halved;
        }
    }
    return near;
}

/* Adds a point for each small angle, unless another has one nearby. */
static bool refine(cutter *self)
{
    const size_t before = self->points, parts = self->part_count;
    bool changed = false;
    for (size_t t = 0; t < self->triangles && !self->no_memory; ++t) {
        const uint32_t *c = &self->corner[3 * t];
        const double size = size_of(self, 3, c);
        unsigned k;
        double x[2];
        if (angle_of(self, c, &k) >= SMALL || is_given(self, c, k)
            || weft__squared(self->point[c[(k + 1) % 3]].at,
                             self->point[c[(k + 2) % 3]].at)
                   < LEAST_EDGE * LEAST_EDGE * size * size) {
            continue;
        }
        const double reach = circle_of(self, c, x);
        bool alone = true;
        for (size_t i = before; i < self->points && alone; ++i) {
            alone = weft__squared(self->point[i].at, x) > reach;
        }
        if (alone && !halve_near(self, x, parts, &changed)
            && is_inside(self, x[0], x[1])) {
            (void)add_point(self, x[0], x[1], GROWTH * size, false);
            changed = true;
        }
    }
    return changed;
}

/* NULL, or why there is no mesh. */
static weft_status make_triangles(cutter *self, weft_error *err)
{
    int smoothed = self->points > LARGE ? ROUNDS_LARGE : ROUNDS, refined = REFINED;
    for (int round = 0; round < MOST_ROUNDS && !self->no_memory; ++round) {
        const double *at = NULL;
        if (!triangulate(self)) {
            return weft_error_set(err, WEFT_BAD_SCENE, "Qhull finds no triangles");
        }
        if (round == 0) {
            drop_near(self);
            continue;
        }
        const int halved = halve_missing(self, &at);
        if (halved < 0) {
            return weft_error_set(err, WEFT_BAD_SCENE,
                                  "lines are too near to each other at (%.6g, %.6g) m",
                                  at[0], at[1]);
        }
        if (halved == 0 && smoothed-- > 0) {
            smooth(self);
        } else if (halved == 0 && (refined-- <= 0 || !refine(self))) {
            return WEFT_OK;
        }
    }
    return self->no_memory ? WEFT_NO_MEMORY
                           : weft_error_set(err, WEFT_BAD_SCENE,
                                            "its lines are no edges of triangles");
}

/* ---- the mesh ------------------------------------------------------------------ */

typedef struct inner {
    double u, row;
    uint32_t point;
} inner;

static int by_place(const void *a, const void *b)
{
    const inner *x = a, *y = b;
    return x->row != y->row ? (x->row > y->row) - (x->row < y->row)
           : x->u != y->u   ? (x->u > y->u) - (x->u < y->u)
                            : (x->point > y->point) - (x->point < y->point);
}

static void give_number(cutter *self, uint32_t point, weft_cut_mesh *out)
{
    if (self->number[point] == CUT_NONE - 1) {
        self->number[point] = (uint32_t)out->vertices++;
    }
}

/* Points of triangles: those on lines in the order of these, then the others by rows.
 */
static void give_numbers(cutter *self, weft_cut_mesh *out)
{
    inner *list = take(self, self->points, sizeof *list);
    size_t count = 0;
    self->number = take(self, self->points, sizeof *self->number);
    if (self->no_memory) {
        weft__free(&self->memory, list);
        return;
    }
    memset(self->number, 0xff, self->points * sizeof *self->number);
    for (size_t i = 0; i < 3 * self->triangles; ++i) {
        self->number[self->corner[i]] = CUT_NONE - 1;
    }
    for (size_t i = 0; i < self->cut->line_count; ++i) {
        for (uint32_t k = self->first[i]; k != CUT_NONE; k = self->parts[k].next) {
            give_number(self, self->parts[k].from, out);
            give_number(self, self->parts[k].to, out);
        }
    }
    for (uint32_t i = 0; i < self->points; ++i) {
        if (self->number[i] == CUT_NONE - 1) {
            const double *x = self->point[i].at;
            list[count++]
                = (inner){ x[0], floor(x[1] / (ROW * self->cut->spacing)), i };
        }
    }
    qsort(list, count, sizeof *list, by_place);
    for (size_t i = 0; i < count; ++i) {
        give_number(self, list[i].point, out);
    }
    weft__free(&self->memory, list);
}

static int by_corners(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    const unsigned k = x[0] != y[0] ? 0 : x[1] != y[1] ? 1 : 2;
    return (x[k] > y[k]) - (x[k] < y[k]);
}

static void write_triangles(const cutter *self, weft_cut_mesh *out)
{
    double least = INFINITY;
    for (size_t t = 0; t < self->triangles; ++t) {
        const uint32_t *c = &self->corner[3 * t];
        uint32_t n[3], *to = &out->corners[3 * out->triangles++];
        unsigned k, low = 0;
        for (k = 0; k < 3; ++k) {
            n[k] = self->number[c[k]];
            low = n[k] < n[low] ? k : low;
        }
        for (k = 0; k < 3; ++k) {
            to[k] = n[(low + k) % 3];
        }
        const double angle = angle_of(self, c, &k);
        if (angle < least && !is_given(self, c, k)) {
            least = angle;
            memcpy(out->least_at, self->point[c[k]].at, sizeof out->least_at);
        }
    }
    out->least_angle = DEGREES * atan(least);
    qsort(out->corners, out->triangles, 3 * sizeof *out->corners, by_corners);
}

static void write_edges(const cutter *self, weft_cut_mesh *out)
{
    for (size_t i = 0; i < self->cut->line_count; ++i) {
        for (uint32_t k = self->first[i]; k != CUT_NONE; k = self->parts[k].next) {
            const uint32_t from = self->number[self->parts[k].from],
                           to = self->number[self->parts[k].to];
            if (from != CUT_NONE && to != CUT_NONE) {
                uint32_t *edge = &out->edge[3 * out->edges++];
                edge[0] = from, edge[1] = to, edge[2] = (uint32_t)i;
            }
        }
    }
}

static void write_mesh(cutter *self, weft_cut_mesh *out)
{
    give_numbers(self, out);
    const weft_allocator *memory = self->cut->memory;
    out->uv = weft__alloc(memory, out->vertices, 2 * sizeof *out->uv);
    out->corners = weft__alloc(memory, self->triangles, 3 * sizeof *out->corners);
    out->edge = weft__alloc(memory, self->part_count, 3 * sizeof *out->edge);
    self->no_memory = self->no_memory || out->uv == NULL || out->corners == NULL
                      || out->edge == NULL;
    for (size_t i = 0; !self->no_memory && i < self->points; ++i) {
        if (self->number[i] != CUT_NONE) {
            memcpy(&out->uv[2 * (size_t)self->number[i]], self->point[i].at,
                   2 * sizeof *out->uv);
        }
    }
    if (!self->no_memory) {
        write_triangles(self, out);
        write_edges(self, out);
    }
}

weft_status cut_mesh(void *ctx, const weft_cut *cut, weft_cut_mesh *out,
                     weft_error *err)
{
    cutter self = { .cut = cut, .memory = weft_allocator_or_malloc(NULL) };
    (void)ctx;
    *out = (weft_cut_mesh){ .vertices = 0 };
    self.first = take(&self, cut->line_count, sizeof *self.first);
    for (size_t i = 0; i < cut->point_count; ++i) {
        (void)add_point(&self, cut->points[2 * i], cut->points[2 * i + 1], cut->spacing,
                        true);
    }
    for (size_t i = 0; i < cut->line_count && !self.no_memory; ++i) {
        add_line(&self, i);
    }
    add_inside(&self);
    weft_status status = make_triangles(&self, err);
    if (status == WEFT_OK) {
        write_mesh(&self, out);
    }
    WEFT__FREE_ALL(&self.memory, self.point, self.parts, self.first, self.ends,
                   self.number);
    free(self.corner);
    return !self.no_memory
               ? status
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory for the mesh of a cut");
}
