/* SPDX-License-Identifier: BSD-3-Clause */
/* cut.c -- from lines to a mesh: points on the lines and inside, triangles between
 * them, and the order of both. */
#include "cut/cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cut/shape.h"

#define ROW     0.8660254037844386 /* [spacings] from row to row of equal triangles */
#define JITTER  0.25               /* [spacings] of the first points inside */
#define CLEAR   0.65 /* [spacings] around points on lines that has no point inside */
#define DEGREES 57.29577951308232

typedef struct cutter {
    const weft_cut *cut;
    cut_shape shape;
    uint32_t *point;         /* of the net, for a point of the cut */
    uint32_t *first;         /* part of a line */
    uint32_t *bucket, *next; /* points on lines by their place */
    size_t buckets;
    uint32_t *number; /* of a point in the mesh */
} cutter;

static const double *place(const cutter *self, uint32_t point)
{
    return &self->cut->points[2 * (size_t)point];
}

/* ---- points on lines ----------------------------------------------------------- */

static bool add_line(cutter *self, size_t line)
{
    const uint32_t *end = &self->cut->lines[2 * line];
    const double *a = place(self, end[0]), *b = place(self, end[1]);
    const double length
        = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
    const double count = fmax(1.0, rint(length / self->cut->spacing));
    uint32_t from = self->point[end[0]];
    self->first[line] = (uint32_t)self->shape.parts;
    for (double i = 1.0; i <= count; i += 1.0) {
        const double s = i / count,
                     at[] = { a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]) };
        const uint32_t to
            = i == count ? self->point[end[1]] : net_add(&self->shape.net, at);
        const uint32_t behind = i == count ? NET_NONE : (uint32_t)self->shape.parts + 1;
        if (to == NET_NONE
            || !shape_add_part(&self->shape,
                               (shape_part){ from, to, (uint32_t)line, behind })) {
            return false;
        }
        from = to;
    }
    return true;
}

static bool add_lines(cutter *self)
{
    const weft_cut *cut = self->cut;
    double low[] = { INFINITY, INFINITY }, high[] = { -INFINITY, -INFINITY };
    for (size_t i = 0; i < 2 * cut->point_count; ++i) {
        low[i % 2] = fmin(low[i % 2], cut->points[i]);
        high[i % 2] = fmax(high[i % 2], cut->points[i]);
    }
    net_begin(&self->shape.net, low, high, cut->spacing, cut->seed);
    self->shape.spacing = cut->spacing;
    bool good = true;
    for (size_t i = 0; i < cut->point_count && good; ++i) {
        self->point[i] = net_add(&self->shape.net, place(self, (uint32_t)i));
        good = self->point[i] != NET_NONE;
    }
    for (size_t i = 0; i < cut->line_count && good; ++i) {
        good = add_line(self, i);
    }
    return good;
}

/* ---- points inside ------------------------------------------------------------- */

static size_t bucket_of(const cutter *self, const double at[2], int right, int up)
{
    const double h = self->cut->spacing;
    const uint64_t u = (uint64_t)(int64_t)floor(at[0] / h) + (uint64_t)(int64_t)right;
    const uint64_t v = (uint64_t)(int64_t)floor(at[1] / h) + (uint64_t)(int64_t)up;
    return (size_t)((u * 0x9E3779B97F4A7C15U + v * 0xD1B54A32D192ED03U) >> 20)
           & (self->buckets - 1);
}

static bool fill_buckets(cutter *self)
{
    const cut_net *net = &self->shape.net;
    for (self->buckets = 64; self->buckets < net->points;) {
        self->buckets *= 2;
    }
    self->bucket = malloc(self->buckets * sizeof *self->bucket);
    self->next = malloc(net->points * sizeof *self->next);
    if (self->bucket == NULL || self->next == NULL) {
        return false;
    }
    memset(self->bucket, 0xff, self->buckets * sizeof *self->bucket);
    for (size_t i = 4; i < net->points; ++i) {
        uint32_t *head = &self->bucket[bucket_of(self, net->at[i], 0, 0)];
        self->next[i] = *head;
        *head = (uint32_t)i;
    }
    return true;
}

static bool is_clear(const cutter *self, const double at[2])
{
    const double reach = CLEAR * self->cut->spacing;
    for (int cell = 0; cell < 9; ++cell) {
        uint32_t i = self->bucket[bucket_of(self, at, cell % 3 - 1, cell / 3 - 1)];
        for (; i != NET_NONE; i = self->next[i]) {
            const double *x = self->shape.net.at[i];
            const double u = x[0] - at[0], v = x[1] - at[1];
            if (u * u + v * v < reach * reach) {
                return false;
            }
        }
    }
    return true;
}

/* Where a row passes the border. */
typedef struct crossing {
    int64_t row;
    double u;
} crossing;

static int by_row(const void *a, const void *b)
{
    const crossing *x = a, *y = b;
    return x->row != y->row ? (x->row > y->row) - (x->row < y->row)
                            : (x->u > y->u) - (x->u < y->u);
}

/* Appends the rows that a line of the border crosses, to list unless that is NULL. */
static size_t cross_rows(const cutter *self, size_t line, crossing *list)
{
    const double high = ROW * self->cut->spacing;
    const double *a = place(self, self->cut->lines[2 * line]),
                 *b = place(self, self->cut->lines[2 * line + 1]);
    const double *low = a[1] < b[1] ? a : b, *top = low == a ? b : a;
    const int64_t first = (int64_t)ceil(low[1] / high);
    size_t count = 0;
    for (int64_t row = first; (double)row * high < top[1]; ++row, ++count) {
        const double v = (double)row * high;
        if (list != NULL) {
            list[count] = (crossing){
                row, low[0] + (v - low[1]) / (top[1] - low[1]) * (top[0] - low[0])
            };
        }
    }
    return count;
}

static bool add_row(cutter *self, int64_t row, double from, double to)
{
    const double h = self->cut->spacing, v = (double)row * ROW * h;
    const double shift = (row % 2 == 0 ? 0.0 : 0.5) * h;
    for (int64_t i = (int64_t)ceil((from - shift) / h); (double)i * h + shift < to;
         ++i) {
        const uint64_t number
            = (uint64_t)row * 0x2545F4914F6CDD1DU + (uint64_t)i + 0x100000000U;
        const double at[]
            = { (double)i * h + shift
                    + JITTER * h * (2.0 * net_random(self->cut->seed, number, 0) - 1.0),
                v + JITTER * h * (2.0 * net_random(self->cut->seed, number, 1) - 1.0) };
        if (is_clear(self, at)) {
            const uint32_t point = net_add(&self->shape.net, at);
            if (point == NET_NONE) {
                return false;
            }
            self->shape.net.size[point] = h;
        }
    }
    return true;
}

static bool add_inside(cutter *self)
{
    size_t count = 0, done = 0;
    for (size_t i = 0; i < self->cut->border_count; ++i) {
        count += cross_rows(self, i, NULL);
    }
    crossing *list = malloc((count + 1) * sizeof *list);
    bool good = list != NULL && fill_buckets(self);
    for (size_t i = 0; i < self->cut->border_count && good; ++i) {
        done += cross_rows(self, i, &list[done]);
    }
    if (good) {
        qsort(list, count, sizeof *list, by_row);
    }
    for (size_t i = 0; i + 1 < count && good; i += 2) {
        good = add_row(self, list[i].row, list[i].u, list[i + 1].u);
    }
    free(list);
    return good;
}

/* ---- triangles ----------------------------------------------------------------- */

/* Marks what the border encloses: what is an odd number of its lines from the box. */
static bool find_inside(cutter *self)
{
    cut_net *net = &self->shape.net;
    uint8_t *seen = calloc(net->triangles + 1, 1);
    uint32_t *stack = malloc((net->triangles + 1) * sizeof *stack);
    size_t count = 0;
    if (seen != NULL && stack != NULL) {
        stack[count++] = net->of[0];
        seen[net->of[0]] = 1;
        net->triangle[net->of[0]].outside = true;
    }
    while (count > 0) {
        const net_triangle *at = &net->triangle[stack[--count]];
        for (unsigned k = 0; k < 3; ++k) {
            const uint32_t t = at->beside[k];
            if (t != NET_NONE && !seen[t]) {
                const uint32_t mark = at->mark[k];
                const bool border
                    = mark != 0
                      && self->shape.part[mark - 1].line < self->cut->border_count;
                net->triangle[t].outside = at->outside != border;
                seen[t] = 1;
                stack[count++] = t;
            }
        }
    }
    const bool good = seen != NULL && stack != NULL;
    free(seen);
    free(stack);
    return good;
}

static weft_status triangulate(cutter *self, weft_error *err)
{
    cut_net *net = &self->shape.net;
    const char *why = net_start(net);
    if (why != NULL) {
        return weft_error_set(err, net->no_memory ? WEFT_NO_MEMORY : WEFT_BAD_SCENE,
                              "%s", why);
    }
    for (size_t i = 0; i < self->shape.parts; ++i) {
        const shape_part *part = &self->shape.part[i];
        if (!net_mark(net, part->from, part->to, (uint32_t)i + 1)) {
            const double *at = net->at[part->from];
            return weft_error_set(err, WEFT_BAD_SCENE,
                                  "lines are too near to each other at (%.6g, %.6g) m",
                                  at[0], at[1]);
        }
    }
    if (!find_inside(self)) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for the mesh of a cut");
    }
    net_restore(net);
    self->shape.most = 2 * net->points + 10000;
    shape_smooth(net);
    shape_refine(&self->shape);
    return WEFT_OK;
}

/* ---- the mesh ------------------------------------------------------------------ */

static void *take(const cutter *self, size_t count, size_t size)
{
    const weft_allocator *memory = self->cut->memory;
    return memory->resize(memory->ctx, NULL, (count + 1) * size);
}

typedef struct inner {
    double u, v;
    int64_t row;
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
    if (self->number[point] == NET_NONE - 1) {
        self->number[point] = (uint32_t)out->vertices++;
    }
}

/* Points of triangles: those on lines in the order of these, then the others by rows.
 */
static bool give_numbers(cutter *self, weft_cut_mesh *out)
{
    const cut_net *net = &self->shape.net;
    const shape_part *part = self->shape.part;
    inner *list = malloc((net->points + 1) * sizeof *list);
    self->number = malloc((net->points + 1) * sizeof *self->number);
    if (list == NULL || self->number == NULL) {
        free(list);
        return false;
    }
    memset(self->number, 0xff, (net->points + 1) * sizeof *self->number);
    for (size_t t = 0; t < net->triangles; ++t) {
        out->triangles += !net->triangle[t].outside;
        for (unsigned k = 0; k < 3 && !net->triangle[t].outside; ++k) {
            self->number[net->triangle[t].corner[k]] = NET_NONE - 1;
        }
    }
    for (size_t i = 0; i < self->cut->line_count; ++i) {
        for (uint32_t k = self->first[i]; k != NET_NONE; k = part[k].next) {
            give_number(self, part[k].from, out);
            if (part[k].next == NET_NONE) {
                give_number(self, part[k].to, out);
            }
        }
    }
    size_t count = 0;
    for (uint32_t i = 0; i < net->points; ++i) {
        if (self->number[i] == NET_NONE - 1) {
            const double *x = net->at[i];
            list[count++]
                = (inner){ x[0], x[1],
                           (int64_t)floor(x[1] / (ROW * self->cut->spacing)), i };
        }
    }
    qsort(list, count, sizeof *list, by_place);
    for (size_t i = 0; i < count; ++i) {
        give_number(self, list[i].point, out);
    }
    free(list);
    return true;
}

static int by_corners(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    for (unsigned k = 0; k < 3; ++k) {
        if (x[k] != y[k]) {
            return x[k] < y[k] ? -1 : 1;
        }
    }
    return 0;
}

static void write_triangles(const cutter *self, weft_cut_mesh *out)
{
    const cut_net *net = &self->shape.net;
    double least = INFINITY;
    size_t count = 0;
    for (size_t t = 0; t < net->triangles; ++t) {
        const net_triangle *at = &net->triangle[t];
        uint32_t n[3];
        unsigned k;
        if (at->outside) {
            continue;
        }
        for (k = 0; k < 3; ++k) {
            n[k] = self->number[at->corner[k]];
        }
        const unsigned low
            = n[0] < n[1] ? (n[0] < n[2] ? 0 : 2) : (n[1] < n[2] ? 1 : 2);
        for (k = 0; k < 3; ++k) {
            out->corners[count++] = n[(low + k) % 3];
        }
        const double angle = shape_angle(net, at, &k);
        const uint32_t one = at->mark[(k + 1) % 3], two = at->mark[(k + 2) % 3];
        const bool given = one != 0 && two != 0
                           && self->shape.part[one - 1].line < self->cut->border_count
                           && self->shape.part[two - 1].line < self->cut->border_count;
        if (angle < least && !given) {
            least = angle;
            memcpy(out->least_at, net->at[at->corner[k]], sizeof out->least_at);
        }
    }
    out->least_angle = DEGREES * atan(least);
    qsort(out->corners, out->triangles, 3 * sizeof *out->corners, by_corners);
}

static void write_edges(const cutter *self, weft_cut_mesh *out)
{
    const shape_part *part = self->shape.part;
    for (size_t i = 0; i < self->cut->line_count; ++i) {
        for (uint32_t k = self->first[i]; k != NET_NONE; k = part[k].next) {
            const uint32_t from = self->number[part[k].from],
                           to = self->number[part[k].to];
            if (from < NET_NONE - 1 && to < NET_NONE - 1) {
                uint32_t *edge = &out->edge[3 * out->edges++];
                edge[0] = from;
                edge[1] = to;
                edge[2] = (uint32_t)i;
            }
        }
    }
}

static bool write_mesh(cutter *self, weft_cut_mesh *out)
{
    if (!give_numbers(self, out)) {
        return false;
    }
    out->places = take(self, out->vertices, 2 * sizeof *out->places);
    out->corners = take(self, out->triangles, 3 * sizeof *out->corners);
    out->edge = take(self, self->shape.parts, 3 * sizeof *out->edge);
    if (out->places == NULL || out->corners == NULL || out->edge == NULL) {
        return false;
    }
    for (size_t i = 0; i < self->shape.net.points; ++i) {
        if (self->number[i] < NET_NONE - 1) {
            memcpy(&out->places[2 * (size_t)self->number[i]], self->shape.net.at[i],
                   2 * sizeof *out->places);
        }
    }
    write_triangles(self, out);
    write_edges(self, out);
    return true;
}

weft_status cut_mesh(void *ctx, const weft_cut *cut, weft_cut_mesh *out,
                     weft_error *err)
{
    cutter self = { .cut = cut };
    weft_status status = WEFT_OK;
    (void)ctx;
    *out = (weft_cut_mesh){ .vertices = 0 };
    self.point = malloc((cut->point_count + 1) * sizeof *self.point);
    self.first = malloc((cut->line_count + 1) * sizeof *self.first);
    bool good = self.point != NULL && self.first != NULL && add_lines(&self)
                && add_inside(&self);
    if (good) {
        status = triangulate(&self, err);
        good = status != WEFT_OK
               || (!self.shape.net.no_memory && write_mesh(&self, out));
    }
    net_end(&self.shape.net);
    void *const blocks[] = { self.point, self.first,  self.bucket,
                             self.next,  self.number, self.shape.part };
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; ++i) {
        free(blocks[i]);
    }
    return good
               ? status
               : weft_error_set(err, WEFT_NO_MEMORY, "no memory for the mesh of a cut");
}
