/* SPDX-License-Identifier: BSD-3-Clause */
#include "forces/contact/bodies/bodies.h"

#include "base/grow.h"
#include "forces/contact/self/self_list.h"
#include "mesh/surface.h"

/* ---- points ---------------------------------------------------------------------- */

/* The points of a shape that is a body. */
typedef struct range {
    size_t first, end;
} range;

static range points_of(const weft__bodies *own, size_t shape)
{
    range out = { 0, own->pairs.mesh->particles };
    for (size_t k = 0; k <= shape; ++k) {
        const weft_body *body = own->contact->shapes[k].def.body;
        out = (range){ out.end, out.end + (body != NULL ? body->vertices : 0) };
    }
    return out;
}

size_t weft__bodies_shape(const weft__bodies *own, size_t point)
{
    size_t shape = 0;
    while (points_of(own, shape).end <= point) {
        ++shape;
    }
    return shape;
}

/* Whether a shape is elsewhere, or at another velocity, than in *was. */
static bool moved(const weft__shape *shape, double t, double piece,
                  const weft__spread *was)
{
    const weft_body *body = shape->def.body;
    return (t != was->t
            && (weft__body_moves(shape, t) || weft__body_moves(shape, was->t)))
           || (body->keys > 1
               && weft__body_keys_until(body, piece)
                      != weft__body_keys_until(body, was->piece));
}

/* Bodies that rest stay where they were put, and all do at the same time of a piece. */
static const double *bodies_spread(const weft__bodies *own, const weft__state *at,
                                   weft__spread *to)
{
    const size_t n = own->pairs.mesh->particles, points = own->pairs.points;
    const double piece = weft__piece(at);
    for (size_t k = 0; k < 6; ++k) {
        memcpy(to->y + k * points, at->y + k * n, n * sizeof *to->y);
    }
    const bool placed = to->placed && to->changes == own->contact->changes;
    size_t first = n;
    for (size_t k = 0; k < own->contact->shape_count; ++k) {
        const weft__shape *shape = &own->contact->shapes[k];
        if (shape->def.body == NULL) {
            continue;
        }
        if (!placed || moved(shape, at->t, piece, to)) {
            weft__body_place(shape, at->t, piece, 6, points, 1, to->y + first);
        }
        first += shape->def.body->vertices;
    }
    to->t = at->t, to->piece = piece, to->changes = own->contact->changes;
    to->placed = true;
    return to->y;
}

double *weft__bodies_spread(const weft__bodies *own, const weft__state *at)
{
    weft__spread to
        = { .y = weft__alloc(&own->memory, 6 * own->pairs.points, sizeof *to.y) };
    return to.y == NULL ? NULL : weft__unconst(bodies_spread(own, at, &to));
}

/* ---- forces ---------------------------------------------------------------------- */

/* The state of all points; without a workspace *once, which has to be freed. */
static const double *points_at(const weft__bodies *own, weft__bodies_space *space,
                               const weft__state *at, double **once)
{
    *once = space == NULL && at->y != NULL ? weft__bodies_spread(own, at) : NULL;
    return space != NULL ? bodies_spread(own, at, &space->now) : *once;
}

/* The list, which passes over bodies that rest: the last ones. */
static weft__self_list *list_of(weft__bodies_space *space)
{
    const weft__contact *contact = space->own->contact;
    if (space->changes != contact->changes + 1) {
        size_t k = contact->shape_count;
        while (k > 0 && !weft__body_moves(&contact->shapes[k - 1], -INFINITY)) {
            --k;
        }
        space->list->rest = k > 0 ? points_of(space->own, k - 1).end
                                  : space->own->pairs.mesh->particles;
        space->list->valid = false;
        space->changes = contact->changes + 1;
    }
    return space->list;
}

/* The points of a perturbed copy of the workspace's cloth, where a step's start was. */
static const double *points_of_copy(const weft__bodies *own, weft__bodies_space *space,
                                    const weft__state *at)
{
    space->before.placed = false;
    const double *y = bodies_spread(own, at, &space->before);
    space->before.placed = false;
    return y;
}

int weft__bodies_each(const weft__bodies *own, weft__bodies_space *space,
                      const weft__state *at, weft__pushed_fn *visit, void *ctx,
                      const double **y)
{
    double *once;
    const double *near = points_at(space != NULL ? space->own : own, space, at, &once);
    *y = space != NULL && space->own != own ? points_of_copy(own, space, at) : near;
    weft__self_pass all
        = { .law = weft__self_law_of(&own->pairs), .y = *y, .each = visit, .ctx = ctx };
    all.law.along = at->along;
    const int bad = near == NULL    ? -1
                    : space != NULL ? weft__self_list_each(list_of(space), near, &all)
                                    : weft__self_each(&all, NULL);
    weft__free(&own->memory, once);
    return bad;
}

int weft__bodies_add(const void *own, void *space, const weft__state *at,
                     weft__unit unit, double *to)
{
    const weft__bodies *of = own;
    const size_t n = of->pairs.mesh->particles;
    weft__self_sums sums = { &of->pairs, unit, to, 0, n, n };
    const double *y;
    return weft__bodies_each(of, space, at, weft__self_sum, &sums, &y);
}

int weft__bodies_transposed(const void *own, void *space, const weft__state *at,
                            double *out)
{
    const weft__bodies *of = own;
    double *once;
    const double *y = points_at(of, space, at, &once);
    const int bad
        = y == NULL
              ? -1
              : weft__self_transposed(&of->pairs, space != NULL ? list_of(space) : NULL,
                                      y, at->along, out);
    weft__free(&of->memory, once);
    return bad;
}

/* ---- measures -------------------------------------------------------------------- */

typedef struct touch_sums {
    const weft__bodies *own;
    const double *y; /* of all points */
    weft_measures *sum;
    unsigned char *marks;
} touch_sums;

/* The particle that a gap is of: the first of those of the cloth. */
static void measure_one(const touch_sums *of, const weft__pushes *from, size_t lane,
                        size_t count)
{
    const size_t n = of->own->pairs.mesh->particles, points = of->own->pairs.points;
    const uint32_t *pin = of->own->pairs.mesh->pin;
    size_t particle = SIZE_MAX, body = 0;
    for (size_t k = 0; k < count; ++k) {
        const size_t at = (size_t)from->particle[k][lane];
        double power = 0.0;
        for (size_t j = 0; j < 3; ++j) {
            power -= from->force[k][j][lane] * of->y[(3 + j) * points + at];
        }
        if (at >= n) {
            body = at;
            of->sum->power[WEFT_POWER_SHAPES] += power;
            continue;
        }
        particle = particle == SIZE_MAX ? at : particle;
        of->sum->power[WEFT_POWER_PINS] += pin[at] != 0 ? power : 0.0;
        of->marks[at] = pin[at] == 0;
    }
    if (from->gap[lane] < of->sum->gap || isnan(from->gap[lane])) {
        weft__keep_gap(of->sum, from->gap[lane], particle,
                       weft__bodies_shape(of->own, body));
    }
}

static void bodies_measure_pushes(void *ctx, weft__pair_kind kind,
                                  const weft__pushes *pushes, size_t count)
{
    const touch_sums *of = ctx;
    for (size_t i = 0; i < count; ++i) {
        const weft__pushes *from = &pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        of->sum->energy.contact += from->energy[lane];
        of->sum->power[WEFT_POWER_CONTACT] += from->heat[lane];
        of->sum->power[WEFT_POWER_FRICTION] += from->friction[lane];
        measure_one(of, from, lane, weft__kind_particles(kind));
    }
}

/* Those that touch a body, but no other shape, which has been counted. */
static size_t count_touching(const weft__bodies *own, const weft__state *at,
                             const unsigned char *marks)
{
    size_t count = 0;
    for (size_t i = 0; i < own->pairs.mesh->particles; ++i) {
        count += marks[i] != 0
                 && !weft__touches_any(own->contact, at, i, own->contact->shape_count);
    }
    return count;
}

void weft__bodies_measure(const void *own, void *space, const weft__state *at,
                          weft_measures *sum)
{
    const weft__bodies *of = own;
    weft__bodies_space *in = space;
    const size_t n = of->pairs.mesh->particles;
    touch_sums all
        = { .own = of,
            .sum = sum,
            .marks = in != NULL ? in->marks : weft__alloc(&of->memory, n, 1) };
    if (all.marks != NULL) {
        memset(all.marks, 0, n);
        (void)weft__bodies_each(of, in, at, bodies_measure_pushes, &all, &all.y);
        sum->touching += count_touching(of, at, all.marks);
    }
    if (in == NULL) {
        weft__free(&of->memory, all.marks);
    }
}

typedef struct gap_search {
    const weft__bodies *own;
    size_t than;
    weft_measures *least;
} gap_search;

static void keep_other(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                       size_t count)
{
    const gap_search *of = ctx;
    const size_t n = of->own->pairs.mesh->particles, last = weft__kind_particles(kind);
    for (size_t i = 0; i < count; ++i) {
        const weft__pushes *from = &pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        const size_t first = (size_t)from->particle[0][lane],
                     end = (size_t)from->particle[last - 1][lane];
        const size_t shape = weft__bodies_shape(of->own, first < n ? end : first);
        if (shape != of->than) {
            weft__keep_gap(of->least, from->gap[lane], first < n ? first : end, shape);
        }
    }
}

void weft__bodies_other(const void *own, void *space, const weft__state *at,
                        size_t than, weft_measures *least)
{
    gap_search of = { own, than, least };
    const double *y;
    (void)weft__bodies_each(own, space, at, keep_other, &of, &y);
}

typedef struct load_sums {
    range of;
    const double *y;
    size_t points;
    const double *at;
    double *load;
} load_sums;

static void load_pushes(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                        size_t count)
{
    const load_sums *of = ctx;
    for (size_t j = 0; j < count * weft__kind_particles(kind); ++j) {
        const weft__pushes *from
            = &pushes[j / weft__kind_particles(kind) / WEFT__BLOCK];
        const size_t lane = j / weft__kind_particles(kind) % WEFT__BLOCK;
        const size_t k = j % weft__kind_particles(kind);
        const size_t i = (size_t)from->particle[k][lane];
        if (i < of->of.first || i >= of->of.end) {
            continue;
        }
        const double f[3] = { from->force[k][0][lane], from->force[k][1][lane],
                              from->force[k][2][lane] };
        double arm[3], torque[3];
        for (size_t c = 0; c < 3; ++c) {
            arm[c] = of->y[c * of->points + i] - of->at[c];
        }
        weft__cross(arm, f, torque);
        for (size_t c = 0; c < 3; ++c) {
            of->load[c] += f[c];
            of->load[3 + c] += torque[c];
        }
    }
}

void weft__bodies_load(const weft__bodies *own, weft__bodies_space *space,
                       const weft__state *at, size_t k, double load[WEFT__LOAD])
{
    const weft__pose pose = weft__pose_of(&own->contact->shapes[k], at->t);
    load_sums of = { .of = points_of(own, k),
                     .points = own->pairs.points,
                     .at = pose.at,
                     .load = load };
    memset(load, 0, WEFT__LOAD * sizeof *load);
    (void)weft__bodies_each(own, space, at, load_pushes, &of, &of.y);
}

/* ---- steps ----------------------------------------------------------------------- */

bool weft__bodies_clear(const void *of, void *in, const weft__path *path,
                        weft__penetration *out)
{
    weft__bodies_space *space = in;
    const weft__bodies *own = space->own;
    (void)of;
    if (weft__self_list_far(list_of(space), path->y0, path->y1, path->t1 - path->t0)) {
        return true;
    }
    const weft__state ends[] = { { .t = path->t0, .y = path->y0 },
                                 { .t = path->t1, .y = path->y1, .piece = &path->t0 } };
    const weft__stride stride
        = { &own->pairs, bodies_spread(own, &ends[0], &space->before),
            bodies_spread(own, &ends[1], &space->now), path->t1 - path->t0 };
    weft_primitive pair[2];
    if (weft__self_list_clear(list_of(space), &stride, pair, &out->gap)) {
        const weft__spread end = space->now; /* where the next step starts */
        space->now = space->before, space->before = end;
        return true;
    }
    const size_t side = pair[0].particle[0] < own->pairs.mesh->particles ? 0 : 1;
    out->particle = pair[side].particle[0];
    out->shape = weft__bodies_shape(own, pair[1 - side].particle[0]);
    return false;
}

void weft__bodies_hold(void *in, double t, const double *from, double *y)
{
    weft__bodies_space *space = in;
    const weft__bodies *own = space->own;
    const size_t n = own->pairs.mesh->particles, points = own->pairs.points;
    (void)bodies_spread(own, &(weft__state){ .t = t, .y = y }, &space->now);
    const weft__state start = { .t = t, .y = from };
    weft__self_list_hold(list_of(space), bodies_spread(own, &start, &space->before),
                         space->now.y);
    for (size_t k = 0; k < 6; ++k) {
        memcpy(y + k * n, space->now.y + k * points, n * sizeof *y);
    }
}

/* ---- bounds ---------------------------------------------------------------------- */

void weft__bodies_range_stiffness(const void *own, void *space, const weft__state *at,
                                  size_t first, size_t count,
                                  weft__range_stiffness *range_stiffness)
{
    const weft__bodies *of = own;
    weft__bodies_space *in = at->y != NULL ? space : NULL;
    double *once;
    const weft__state all = { .t = at->t, .y = points_at(of, in, at, &once) };
    if (at->y == NULL || all.y != NULL) {
        weft__self_range_stiffness(&of->pairs, in != NULL ? list_of(in) : NULL, &all,
                                   first, count, range_stiffness);
    }
    weft__free(&of->memory, once);
}

void weft__bodies_multiply(const void *own, const weft__state *at, double a, double b,
                           const double *x, double *out)
{
    const weft__bodies *of = own;
    double *once;
    const weft__state all = { .t = at->t, .y = points_at(of, NULL, at, &once) };
    if (once != NULL) {
        weft__self_multiply(&of->pairs, &all, a, b, x, out);
    }
    weft__free(&of->memory, once);
}

int weft__bodies_blocks(const void *own, void *space, const weft__state *at, double *to)
{
    const weft__bodies *of = own;
    weft__bodies_space *in = space;
    double *once;
    const weft__state all = { .t = at->t, .y = points_at(of, in, at, &once) };
    const int bad = all.y == NULL
                        ? 1
                        : weft__self_blocks(&of->pairs, in != NULL ? list_of(in) : NULL,
                                            &all, to);
    weft__free(&of->memory, once);
    return bad;
}
