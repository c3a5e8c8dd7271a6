/* SPDX-License-Identifier: BSD-3-Clause */
/* cut_lines.c -- the paths of a cut as lines between points that do not cross: what of
 * an outline and its holes is wrong, and where lines are cut by others. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/plane.h"
#include "scene/checks.h"

#define NEAR  1e-3   /* [spacings] what is nearer touches */
#define SHARP 0.4663 /* tan(25 degrees): sharper corners are warned of */

/* From point a to b of a path, the paths being those of a list. */
typedef struct path_part {
    const weft__cut_path *path;
    uint32_t number; /* of the path */
    uint32_t index;  /* of its point a in the path */
    uint32_t a, b;   /* points */
    double low[2], high[2];
} path_part;

/* Where a part is divided. */
typedef struct division {
    uint32_t part, point;
    double along;
} division;

typedef struct line_maker {
    weft__reader *reader;
    const weft__cut *cut;
    weft__cut_lines *out;
    path_part *parts;
    division *nodes;
    uint32_t *same; /* a point in the place of each */
    size_t count, bounds, node_count, node_room, point_room;
    double near;
} line_maker;

static const double *at(const line_maker *self, uint32_t point)
{
    return &self->out->points[2 * (size_t)point];
}

static bool is_near(const line_maker *self, const double a[2], const double b[2])
{
    return sqrt(weft__squared(a, b)) <= self->near;
}

/* [m] from a point to a part, and where that is nearest, from 0 to 1. */
static double cut_lines_distance(const line_maker *self, const path_part *to,
                                 const double x[2], double *s)
{
    const double *a = at(self, to->a), *b = at(self, to->b),
                 length = sqrt(weft__squared(a, b));
    *s = ((x[0] - a[0]) * (b[0] - a[0]) + (x[1] - a[1]) * (b[1] - a[1]))
         / (length * length);
    *s = fmin(1.0, fmax(0.0, *s));
    const double nearest[] = { a[0] + *s * (b[0] - a[0]), a[1] + *s * (b[1] - a[1]) };
    return sqrt(weft__squared(x, nearest));
}

/* ---- mistakes ------------------------------------------------------------------ */

static const char *name_of(const line_maker *self, uint32_t number, char out[32])
{
    const size_t holes = self->cut->holes.count;
    (void)snprintf(out, 32, "%s %zu", number <= holes ? "hole" : "line",
                   number <= holes ? (size_t)number - 1 : number - 1 - holes);
    return number == 0 ? "the outline" : out;
}

/* The place in the scene of a point of a path. */
static weft__mark mark_of(const weft__cut_path *path, size_t index)
{
    const weft__node *node = path->node;
    const size_t i = path->reversed && index > 0 ? path->count - index : index;
    return node->type == WEFT__LIST ? weft__item(node, i)->at : node->at;
}

static void report_touch(const line_maker *self, const path_part *one,
                         const path_part *two)
{
    char a[32], b[32];
    const double *x = at(self, two->a), *y = at(self, two->b);
    weft__report_error(self->reader->report, mark_of(two->path, two->index),
                       "%s crosses or touches %s, from [%.6g, %.6g] to [%.6g, %.6g]",
                       name_of(self, two->number, a),
                       one->number == two->number ? "itself"
                                                  : name_of(self, one->number, b),
                       x[0], x[1], y[0], y[1]);
}

/* [degrees] of a tangent below SHARP. */
static double cut_lines_angle_of(double x)
{
    const double q = x * x;
    return 57.29577951308232 * x
           * (1.0 - q * (1.0 / 3.0 - q * (1.0 / 5.0 - q * (1.0 / 7.0 - q / 9.0))));
}

/* A point of a path: whether the next is another one, and the angle of the cloth. */
static void check_corner(const line_maker *self, const weft__cut_path *path,
                         uint32_t number, size_t i)
{
    const double *o = path->points[i], *a = path->points[(i + 1) % path->count],
                 *b = path->points[(i + path->count - 1) % path->count];
    const double dot = (a[0] - o[0]) * (b[0] - o[0]) + (a[1] - o[1]) * (b[1] - o[1]);
    const double sine = weft__plane_turn(o, a, b) * (number == 0 ? 1.0 : -1.0);
    if (is_near(self, o, a)) {
        weft__report_error(self->reader->report, mark_of(path, (i + 1) % path->count),
                           "a point that is there twice, at [%.6g, %.6g] m", a[0],
                           a[1]);
    } else if (path->closed && number <= self->cut->holes.count && sine > 0.0
               && dot > 0.0 && sine < SHARP * dot) {
        weft__report_warning(self->reader->report, mark_of(path, i),
                             "a corner of %.1f degrees: triangles there are no wider",
                             cut_lines_angle_of(sine / dot));
    }
}

/* ---- points and parts ---------------------------------------------------------- */

static uint32_t add_point(line_maker *self, const double x[2])
{
    const size_t i = self->out->point_count;
    size_t room = self->point_room;
    if (!weft__report_reserve(self->reader->report, &self->out->points, &room, i + 1,
                              2 * sizeof(double))
        || !weft__report_reserve(self->reader->report, &self->same, &self->point_room,
                                 i + 1, sizeof *self->same)) {
        return 0;
    }
    memcpy(&self->out->points[2 * i], x, 2 * sizeof(double));
    self->same[i] = (uint32_t)i;
    return (uint32_t)self->out->point_count++;
}

static void add_path(line_maker *self, const weft__cut_path *path, uint32_t number)
{
    const uint32_t first = (uint32_t)self->out->point_count;
    for (size_t i = 0; i < path->count; ++i) {
        (void)add_point(self, path->points[i]);
    }
    if (self->reader->report->no_memory) {
        return;
    }
    for (size_t i = 0; i + !path->closed < path->count; ++i) {
        path_part *to = &self->parts[self->count++];
        *to = (path_part){ path,
                           number,
                           (uint32_t)i,
                           first + (uint32_t)i,
                           first + (uint32_t)((i + 1) % path->count),
                           { 0 },
                           { 0 } };
        for (size_t k = 0; k < 2; ++k) {
            const double a = at(self, to->a)[k], b = at(self, to->b)[k];
            to->low[k] = fmin(a, b) - self->near;
            to->high[k] = fmax(a, b) + self->near;
        }
        check_corner(self, path, number, i);
    }
}

/* ---- pairs --------------------------------------------------------------------- */

static void add_node(line_maker *self, const path_part *on, uint32_t point,
                     double along)
{
    if (weft__report_reserve(self->reader->report, &self->nodes, &self->node_room,
                             self->node_count + 1, sizeof *self->nodes)) {
        self->nodes[self->node_count++]
            = (division){ (uint32_t)(on - self->parts), point, along };
    }
}

static uint32_t cut_lines_root(const line_maker *self, uint32_t point)
{
    while (self->same[point] != point) {
        point = self->same[point];
    }
    return point;
}

/* Whether an end of a part lies on another part, which is divided there, or has the
 * same point at its end. */
static bool meets(line_maker *self, uint32_t end, const path_part *on)
{
    double s;
    const double *x = at(self, end);
    if (cut_lines_distance(self, on, x, &s) > self->near) {
        return false;
    }
    const bool a = is_near(self, x, at(self, on->a));
    if (a || is_near(self, x, at(self, on->b))) {
        const uint32_t p = cut_lines_root(self, end),
                       q = cut_lines_root(self, a ? on->a : on->b);
        self->same[p > q ? p : q] = p > q ? q : p;
    } else {
        add_node(self, on, end, s);
        if (on->number <= self->cut->holes.count) { /* the border stays straight */
            const double *from = at(self, on->a), *to = at(self, on->b);
            for (size_t k = 0; k < 2; ++k) {
                self->out->points[2 * (size_t)end + k]
                    = from[k] + s * (to[k] - from[k]);
            }
        }
    }
    return true;
}

/* Where two parts cross within both, as a part of the first; NAN: nowhere. */
static double crossing(const line_maker *self, const path_part *one,
                       const path_part *two)
{
    const double *a = at(self, one->a), *b = at(self, one->b), *c = at(self, two->a),
                 *d = at(self, two->b);
    const double p = weft__plane_turn(c, d, a), q = weft__plane_turn(c, d, b),
                 r = weft__plane_turn(a, b, c), t = weft__plane_turn(a, b, d);
    return (p > 0.0) != (q > 0.0) && (r > 0.0) != (t > 0.0) ? p / (p - q) : NAN;
}

/* A point where lines cross: one that is there already, or a new one. */
static uint32_t point_at(line_maker *self, const double x[2])
{
    for (size_t i = self->bounds; i < self->out->point_count; ++i) {
        if (is_near(self, at(self, (uint32_t)i), x)) {
            return (uint32_t)i;
        }
    }
    return add_point(self, x);
}

/* Parts that follow each other in a path may only have their common point. */
static bool folds(const line_maker *self, const path_part *one, const path_part *two)
{
    double s;
    return cut_lines_distance(self, two, at(self, one->a), &s) <= self->near
           || cut_lines_distance(self, one, at(self, two->b), &s) <= self->near;
}

static void compare_pair(line_maker *self, const path_part *one, const path_part *two)
{
    double s;
    if (one->number == two->number && (one->b == two->a || two->b == one->a)) {
        if (one->b == two->a ? folds(self, one, two) : folds(self, two, one)) {
            report_touch(self, one, two);
        }
        return;
    }
    const double where = crossing(self, one, two);
    if (two->number <= self->cut->holes.count) { /* both bound the piece */
        if (!isnan(where)
            || cut_lines_distance(self, two, at(self, one->a), &s) <= self->near
            || cut_lines_distance(self, two, at(self, one->b), &s) <= self->near
            || cut_lines_distance(self, one, at(self, two->a), &s) <= self->near
            || cut_lines_distance(self, one, at(self, two->b), &s) <= self->near) {
            report_touch(self, one, two);
        }
        return;
    }
    bool met = meets(self, one->a, two);
    met = meets(self, one->b, two) || met;
    met = meets(self, two->a, one) || met;
    met = meets(self, two->b, one) || met;
    if (!met && !isnan(where)) {
        const double *a = at(self, one->a), *b = at(self, one->b);
        const double x[]
            = { a[0] + where * (b[0] - a[0]), a[1] + where * (b[1] - a[1]) };
        const uint32_t point = point_at(self, x);
        (void)cut_lines_distance(self, two, x, &s);
        add_node(self, one, point, where);
        add_node(self, two, point, s);
    }
}

static int by_left(const void *a, const void *b)
{
    const path_part *const *x = a, *const *y = b;
    return (*x)->low[0] != (*y)->low[0]
               ? ((*x)->low[0] > (*y)->low[0]) - ((*x)->low[0] < (*y)->low[0])
               : (*x > *y) - (*x < *y);
}

/* Every two parts whose boxes meet, the one that stands first in the cut first. */
static void compare_all(line_maker *self)
{
    const path_part **order
        = weft__report_take(self->reader->report, self->count, sizeof *order);
    for (size_t i = 0; order != NULL && i < self->count; ++i) {
        order[i] = &self->parts[i];
    }
    if (order != NULL) {
        qsort(order, self->count, sizeof *order, by_left);
    }
    for (size_t i = 0; order != NULL && i < self->count; ++i) {
        const path_part *one = order[i];
        for (size_t j = i + 1; j < self->count && order[j]->low[0] <= one->high[0];
             ++j) {
            const path_part *two = order[j];
            if (two->low[1] <= one->high[1] && one->low[1] <= two->high[1]) {
                compare_pair(self, one < two ? one : two, one < two ? two : one);
            }
        }
    }
    weft__free(self->reader->report->memory, order);
}

/* ---- holes --------------------------------------------------------------------- */

static bool is_in(const weft__cut_path *path, const double x[2])
{
    bool in = false;
    for (size_t i = 0; i < path->count; ++i) {
        const double *a = path->points[i], *b = path->points[(i + 1) % path->count];
        if ((a[1] > x[1]) != (b[1] > x[1])
            && x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
            in = !in;
        }
    }
    return in;
}

static void check_holes(const line_maker *self)
{
    const weft__cut_paths *holes = &self->cut->holes;
    for (size_t i = 0; i < holes->count; ++i) {
        const weft__cut_path *hole = &holes->list[i];
        if (!is_in(self->cut->outline.list, hole->points[0])) {
            ERROR_AT(self->reader, hole->node, "hole %zu lies outside the outline", i);
        }
        for (size_t k = 0; k < holes->count; ++k) {
            if (k != i && is_in(&holes->list[k], hole->points[0])) {
                ERROR_AT(self->reader, hole->node, "hole %zu lies in hole %zu", i, k);
            }
        }
    }
}

/* ---- lines that do not cross --------------------------------------------------- */

static int by_part(const void *a, const void *b)
{
    const division *x = a, *y = b;
    return x->part != y->part     ? (x->part > y->part) - (x->part < y->part)
           : x->along != y->along ? (x->along > y->along) - (x->along < y->along)
                                  : (x->point > y->point) - (x->point < y->point);
}

static void add_line(line_maker *self, uint32_t from, uint32_t to, uint32_t path)
{
    weft__cut_lines *out = self->out;
    from = cut_lines_root(self, from);
    to = cut_lines_root(self, to);
    if (from != to) {
        out->lines[2 * out->line_count] = from;
        out->lines[2 * out->line_count + 1] = to;
        out->path[out->line_count++] = path;
    }
}

/* Leaves out lines that are there twice; the first stays. */
static void drop_copies(line_maker *self)
{
    weft__cut_lines *out = self->out;
    weft__ends *list
        = weft__tree_take(self->reader->tree, out->line_count, sizeof *list);
    size_t kept = 0;
    for (size_t i = 0; list != NULL && i < out->line_count; ++i) {
        list[i] = weft__ends_of(out->lines[2 * i], out->lines[2 * i + 1], (uint32_t)i);
    }
    if (list != NULL) {
        qsort(list, out->line_count, sizeof *list, weft__compare_ends);
    }
    for (size_t i = 1; list != NULL && i < out->line_count; ++i) {
        if (weft__compare_ends(&list[i], &list[i - 1]) == 0) {
            const uint32_t a = list[i - 1].number, b = list[i].number;
            out->path[a > b ? a : b] = UINT32_MAX;
            list[i].number = a < b ? a : b;
        }
    }
    for (size_t i = 0; list != NULL && i < out->line_count; ++i) {
        if (out->path[i] != UINT32_MAX) {
            memmove(&out->lines[2 * kept], &out->lines[2 * i], 2 * sizeof *out->lines);
            out->path[kept] = out->path[i];
            out->border_count = out->path[kept] <= self->cut->holes.count
                                    ? kept + 1
                                    : out->border_count;
            ++kept;
        }
    }
    out->line_count = kept;
}

static void divide_parts(line_maker *self)
{
    const size_t most = self->count + self->node_count;
    self->out->lines
        = weft__tree_take(self->reader->tree, most, 2 * sizeof *self->out->lines);
    self->out->path
        = weft__tree_take(self->reader->tree, most, sizeof *self->out->path);
    if (self->out->lines == NULL || self->out->path == NULL) {
        return;
    }
    if (self->node_count > 0) {
        qsort(self->nodes, self->node_count, sizeof *self->nodes, by_part);
    }
    for (size_t i = 0, k = 0; i < self->count; ++i) {
        uint32_t from = self->parts[i].a;
        for (; k < self->node_count && self->nodes[k].part == i; ++k) {
            add_line(self, from, self->nodes[k].point, self->parts[i].number);
            from = self->nodes[k].point;
        }
        add_line(self, from, self->parts[i].b, self->parts[i].number);
    }
    drop_copies(self);
}

/* Points of lines; others were merged. */
static void number_points(line_maker *self)
{
    weft__cut_lines *out = self->out;
    uint32_t *number
        = weft__tree_take(self->reader->tree, out->point_count, sizeof *number);
    double *points
        = weft__tree_take(self->reader->tree, out->point_count, 2 * sizeof *points);
    size_t count = 0;
    for (size_t i = 0; number != NULL && points != NULL && i < 2 * out->line_count;
         ++i) {
        const uint32_t point = out->lines[i];
        if (number[point] == 0) {
            memcpy(&points[2 * count], at(self, point), 2 * sizeof *points);
            number[point] = (uint32_t)++count;
        }
        out->lines[i] = number[point] - 1;
    }
    weft__free(self->reader->report->memory, out->points);
    out->points = points;
    out->point_count = count;
}

bool weft__cut_lines_of(weft__reader *reader, const weft__cut *cut,
                        weft__cut_lines *out)
{
    const weft__cut_paths *const all[] = { &cut->outline, &cut->holes, &cut->lines };
    line_maker self = { .reader = reader, .cut = cut, .out = out };
    const size_t before = reader->report->mistakes;
    size_t points = 0;
    uint32_t number = 0;
    *out = (weft__cut_lines){ .points = NULL };
    self.near = NEAR * cut->grid.spacing[0];
    for (size_t k = 0; k < 3; ++k) {
        for (size_t i = 0; i < all[k]->count; ++i) {
            points += all[k]->list[i].count;
        }
    }
    self.parts = weft__tree_take(reader->tree, points, sizeof *self.parts);
    for (size_t k = 0; k < 3 && self.parts != NULL; ++k) {
        self.bounds = out->point_count;
        for (size_t i = 0; i < all[k]->count; ++i) {
            add_path(&self, &all[k]->list[i], number++);
        }
    }
    if (!reader->report->no_memory && reader->report->mistakes == before) {
        compare_all(&self);
    }
    if (!reader->report->no_memory && reader->report->mistakes == before) {
        check_holes(&self);
        divide_parts(&self);
    }
    number_points(&self);
    WEFT__FREE_ALL(reader->report->memory, self.nodes, self.same);
    return !reader->report->no_memory && reader->report->mistakes == before;
}
