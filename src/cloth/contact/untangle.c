/* SPDX-License-Identifier: BSD-3-Clause */
/* untangle.c -- where a state passes through itself, bodies or shapes, and how a start
 * is relaxed until it does not.
 *
 * A pair that crosses divides its layers: what edges that cross nothing join is one
 * part. An edge lies wrong with the end that is of the smaller part: that end and the
 * triangle are moved apart, along its normal, until the end is on the side of the
 * other. Between these moves the cloth follows its elastic forces alone, strongly
 * damped. Once nothing crosses, what is nearer than most of the thickness is moved
 * apart. */
#include <string.h>

#include "base/clock.h"
#include "base/finite.h"
#include "base/grow.h"
#include "base/log.h"
#include "base/try.h"
#include "cloth/model.h"
#include "forces/contact/self/crossing.h"
#include "mesh/surface.h"

#define LEAST  0.9  /* of the thickness: of gaps at the end */
#define APART  0.95 /* of it: the gap aimed at */
#define BEYOND 0.1  /* of it: past a triangle */
#define MOST   0.5  /* of it: a move */
#define SLOWER 0.9  /* what a step leaves of a velocity */
#define PART   0.5  /* of the stable step */
#define FALLS  0.98 /* of the depth: what counts as less */
#define PERIOD 1.0  /* [s] of the wall clock from message to message */

enum { PATIENCE = 2000 }; /* steps in which neither number nor depth fall */

/* The pairs of the cloth with itself, or with bodies. */
typedef struct tangle {
    const weft__self *own;
    double *y; /* planes of its points */
    weft__crossing *pairs;
    size_t count, room, edges;
    bool *crossed;           /* of an edge by its key */
    uint32_t *part, *points; /* of a point; of a part, which its lowest one names */
    const weft_allocator *memory;
    weft__stop *stop;
    bool failed;
} tangle;

/* How a start is relaxed. */
typedef struct relaxation {
    const weft_cloth *cloth;
    weft_cloth *elastic; /* a copy with elastic forces alone */
    double *y, *rates;
    double *moves, *shares; /* [m] sums; their number, of a particle */
    double *kept;           /* the last state without a crossing, else that with the
                               fewest, of which the number is */
    size_t fewest, idle;    /* steps since the last progress */
    tangle tangles[2];
    double least, gap;        /* [m] that nothing is below at the end; aimed at */
    double depth, shallowest; /* [m] of all that crosses, together; the least so far */
    size_t near;
    weft__stop stop;
    weft_log log;
    double told;       /* when the last message was written */
    double t;          /* [s] that it has relaxed */
    const char *ended; /* why before the time of the cloth; or nothing */
} relaxation;

/* ---- what crosses ---------------------------------------------------------------- */

static void untangle_gather(void *ctx, const weft__crossing *one)
{
    tangle *of = ctx;
    of->failed = of->failed
                 || !weft__reserve(of->memory, &of->pairs, &of->room, of->count + 1,
                                   sizeof *of->pairs);
    if (!of->failed) {
        of->pairs[of->count++] = *one;
    }
}

/* The points of a state of the cloth, and the pairs that cross there. */
static void find_pairs(tangle *of, const weft_cloth *cloth, const double *y)
{
    if (!of->own->law.self) {
        return;
    }
    weft__free(of->memory, of->y);
    const size_t size = 6 * of->own->points;
    of->y
        = of->own == &cloth->bodies.pairs
              ? weft__bodies_spread(&cloth->bodies, &(weft__state){ .t = 0.0, .y = y })
              : weft__alloc(of->memory, size, sizeof *y);
    of->count = 0;
    of->failed = of->y == NULL;
    if (!of->failed) {
        if (of->own == &cloth->self) {
            memcpy(of->y, y, size * sizeof *y);
        }
        const weft__quadtree tree = weft__tree_of(of->own, of->y);
        (void)weft__each_crossing(&tree, &(weft__search){ .stop = of->stop },
                                  untangle_gather, of);
    }
}

static void free_tangle(tangle *of)
{
    WEFT__FREE_ALL(of->memory, of->y, of->pairs, of->crossed, of->part, of->points);
}

static void untangle_place(const tangle *of, size_t i, double x[3])
{
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->y[k * of->own->points + i];
    }
}

/* "particle (3, 4) is 2 mm inside shapes[1]", by the number of its definition. */
static void inside(const weft__mesh *mesh, size_t i, double gap, size_t shape,
                   char text[WEFT__CROSSING_TEXT])
{
    char name[64];
    (void)snprintf(text, WEFT__CROSSING_TEXT, "%s is %.3g mm inside shapes[%zu]",
                   weft__particle_name(mesh, i, name, sizeof name), -1e3 * gap, shape);
}

size_t weft_cloth_each_crossing(const weft_cloth *cloth, const double *y,
                                weft_crossing_fn *each, void *ctx)
{
    const weft__mesh *mesh = &cloth->mesh;
    tangle both[2] = { { .own = &cloth->self, .memory = &cloth->memory },
                       { .own = &cloth->bodies.pairs, .memory = &cloth->memory } };
    weft_crossing out;
    size_t count = 0;
    bool failed = false;
    for (size_t k = 0; k < 2; ++k) {
        find_pairs(&both[k], cloth, y);
        for (size_t i = 0; i < both[k].count; ++i) {
            const weft__crossing *one = &both[k].pairs[i];
            out = (weft_crossing){ .count
                                   = { one->side[0].count, one->side[1].count } };
            weft__crossing_names(one, k == 0 ? weft__self_name : weft__bodies_name,
                                 k == 0 ? (const void *)&cloth->self : &cloth->bodies,
                                 out.text);
            for (size_t j = 0; j < 6; ++j) {
                if (j % 3 < out.count[j / 3]) {
                    untangle_place(&both[k], one->side[j / 3].particle[j % 3],
                                   out.place[j / 3][j % 3]);
                }
            }
            if (each != NULL) {
                each(ctx, &out);
            }
        }
        count += both[k].count;
        failed = failed || both[k].failed;
        free_tangle(&both[k]);
    }
    for (weft__touches at
         = weft__touches_of(&cloth->contact, 0.0, y, 0, mesh->particles);
         weft__each_touch(&at);) {
        if (!(at.touch.gap > 0.0)) {
            out = (weft_crossing){ .count = { 1, 0 } };
            inside(mesh, weft__vertex_of(mesh, at.i), at.touch.gap, at.shapes - 1,
                   out.text);
            for (size_t k = 0; k < 3; ++k) {
                out.place[0][0][k] = y[k * mesh->particles + at.i];
            }
            if (each != NULL) {
                each(ctx, &out);
            }
            ++count;
        }
    }
    return failed ? SIZE_MAX : count;
}

/* ---- parts ----------------------------------------------------------------------- */

static uint32_t untangle_part_of(uint32_t *part, uint32_t i)
{
    while (part[i] != i) {
        i = part[i] = part[part[i]];
    }
    return i;
}

/* What edges join that cross nothing. */
static void find_parts(tangle *of)
{
    const weft__self *own = of->own;
    memset(of->crossed, 0, of->edges * sizeof *of->crossed);
    for (size_t i = 0; i < of->count; ++i) {
        of->crossed[of->pairs[i].key[0]] = true;
    }
    for (uint32_t i = 0; i < own->points; ++i) {
        of->part[i] = i;
        of->points[i] = 0;
    }
    for (size_t i = 0; i < own->points; ++i) {
        weft__incident edges;
        weft__incident_of(own, i, 2, &edges);
        for (size_t e = 0; e < edges.count; ++e) {
            const uint32_t a = untangle_part_of(of->part, edges.at[2 * e]);
            const uint32_t b = untangle_part_of(of->part, edges.at[2 * e + 1]);
            if (!of->crossed[edges.key + e]) {
                of->part[a < b ? b : a] = a < b ? a : b;
            }
        }
    }
    for (uint32_t i = 0; i < own->points; ++i) {
        ++of->points[untangle_part_of(of->part, i)];
    }
}

/* ---- moves ----------------------------------------------------------------------- */

/* The share of a point in a move: bodies and pins have none. */
static double ease(const tangle *of, size_t i)
{
    const weft__mesh *mesh = of->own->mesh;
    return i < mesh->particles ? mesh->inverse_mass[i] : 0.0;
}

static void untangle_move(relaxation *to, size_t i, double by, const double along[3])
{
    const size_t n = to->cloth->mesh.particles;
    for (size_t k = 0; k < 3; ++k) {
        to->moves[k * n + i] += by * along[k];
    }
    to->shares[i] += 1.0;
}

/* The end of an edge that lies wrong of a triangle, and the side of the other: that of
 * the smaller part, or else the nearer one. height: [m] of both ends, along the normal.
 */
static size_t wrong_end(tangle *of, const weft_primitive *edge, const double height[2],
                        double *side)
{
    const size_t a
        = of->points[untangle_part_of(of->part, (uint32_t)edge->particle[0])];
    const size_t b
        = of->points[untangle_part_of(of->part, (uint32_t)edge->particle[1])];
    const double sum = height[0] + height[1];
    const size_t wrong = a != b ? b < a : fabs(height[1]) < fabs(height[0]);
    const double other = a != b ? height[1 - wrong] : sum;
    *side = other < 0.0 ? -1.0 : 1.0;
    return wrong;
}

/* Moves the wrong end of an edge and a triangle apart. */
static void part_pair(relaxation *to, tangle *of, const weft__crossing *one)
{
    const weft_primitive *edge = &one->side[0], *triangle = &one->side[1];
    const double dh = of->own->law.thickness;
    double x[5][3], u[3], v[3], normal[3], height[2], side;
    if (edge->count != 2 || triangle->count != 3) {
        return;
    }
    for (size_t k = 0; k < 5; ++k) {
        untangle_place(of, k < 2 ? edge->particle[k] : triangle->particle[k - 2], x[k]);
    }
    for (size_t k = 0; k < 3; ++k) {
        u[k] = x[3][k] - x[2][k], v[k] = x[4][k] - x[2][k];
    }
    weft__cross(u, v, normal);
    const double area = sqrt(weft__dot(normal, normal));
    for (size_t k = 0; k < 3; ++k) {
        normal[k] /= area;
    }
    for (size_t e = 0; e < 2; ++e) {
        const double p[3] = { x[e][0] - x[2][0], x[e][1] - x[2][1], x[e][2] - x[2][2] };
        height[e] = weft__dot(p, normal);
    }
    const size_t wrong = wrong_end(of, edge, height, &side),
                 end = edge->particle[wrong];
    const double displacement = fmin(BEYOND * dh - side * height[wrong], MOST * dh);
    const double of_end = ease(of, end);
    double sum = of_end;
    for (size_t k = 0; k < 3; ++k) {
        sum += ease(of, triangle->particle[k]) / 3.0;
    }
    if (!(sum > 0.0) || !(area > 0.0)) {
        return;
    }
    to->depth += fabs(height[wrong]);
    if (of_end > 0.0) {
        untangle_move(to, end, side * displacement * of_end / sum, normal);
    }
    for (size_t k = 0; k < 3; ++k) {
        const double share = ease(of, triangle->particle[k]);
        if (share > 0.0) {
            untangle_move(to, triangle->particle[k], -side * displacement * share / sum,
                          normal);
        }
    }
}

/* Moves free particles out of shapes, and away from them; how many were inside. */
static size_t part_shapes(relaxation *to)
{
    size_t inside = 0;
    for (weft__touches at = weft__touches_of(&to->cloth->contact, 0.0, to->y, 0,
                                             to->cloth->mesh.particles);
         weft__each_touch(&at);) {
        const double displacement = to->gap - at.touch.gap;
        inside += !(at.touch.gap > 0.0);
        to->depth += fmax(-at.touch.gap, 0.0);
        if (at.touch.gap < to->least
            && isfinite(weft__dot(at.touch.normal, at.touch.normal))) {
            untangle_move(to, at.i, displacement, at.touch.normal);
            ++to->near;
        }
    }
    return inside;
}

/* Moves pairs that are too near apart, along their forces. */
static void part_near(void *ctx, weft__pair_kind kind, const weft__pushes *pushes,
                      size_t count)
{
    relaxation *to = ctx;
    const size_t n = to->cloth->mesh.particles, points = weft__kind_particles(kind);
    for (size_t i = 0; i < count; ++i) {
        const weft__pushes *from = &pushes[i / WEFT__BLOCK];
        const size_t lane = i % WEFT__BLOCK;
        const double displacement = to->gap - from->gap[lane];
        const bool near = from->gap[lane] < to->least;
        double force[4][3], most = 0.0;
        for (size_t j = 0; j < 3 * points; ++j) {
            force[j / 3][j % 3] = from->force[j / 3][j % 3][lane];
        }
        for (size_t j = 0; j < points; ++j) {
            most = fmax(most, sqrt(weft__dot(force[j], force[j])));
        }
        for (size_t j = 0; near && most > 0.0 && j < points; ++j) {
            const size_t at = (size_t)from->particle[j][lane];
            if (at < n && to->cloth->mesh.inverse_mass[at] > 0.0) {
                untangle_move(to, at, 0.5 * displacement / most, force[j]);
            }
        }
        to->near += near;
    }
}

/* Finds the moves of a finite state; false: no memory. *crosses: how many pairs do. */
static bool find_moves(relaxation *to, size_t *crosses)
{
    const size_t n = to->cloth->mesh.particles;
    memset(to->moves, 0, 3 * n * sizeof *to->moves);
    memset(to->shares, 0, n * sizeof *to->shares);
    to->near = 0, to->depth = 0.0;
    *crosses = part_shapes(to);
    for (size_t k = 0; k < 2; ++k) {
        tangle *of = &to->tangles[k];
        find_pairs(of, to->cloth, to->y);
        if (of->failed) {
            return false;
        }
        if (of->count > 0) {
            find_parts(of);
        }
        for (size_t i = 0; i < of->count; ++i) {
            part_pair(to, of, &of->pairs[i]);
        }
        *crosses += of->count;
    }
    for (size_t k = 0; k < 2 && *crosses == 0; ++k) {
        weft__self_pass all = { .law = weft__self_law_of(to->tangles[k].own),
                                .y = to->tangles[k].y,
                                .each = part_near,
                                .ctx = to };
        (void)weft__self_each(&all, NULL);
    }
    return true;
}

/* Takes the moves, and a step h [s] by elastic forces. */
static void take_step(relaxation *of, double h)
{
    const weft__mesh *mesh = &of->cloth->mesh;
    const size_t n = mesh->particles;
    (void)weft_cloth_rhs(of->elastic, 0.0, of->y, of->rates);
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = i; mesh->pin[i] == 0 && j < 3 * n; j += n) {
            double *v = &of->y[3 * n + j];
            *v = SLOWER * (*v + h * of->rates[3 * n + j]);
            of->y[j] += h * *v;
            of->y[j] += of->shares[i] > 0.0 ? of->moves[j] / of->shares[i] : 0.0;
        }
    }
}

/* ---- a start --------------------------------------------------------------------- */

static weft_status untangle_no_memory(weft_error *err)
{
    return weft_error_set(err, WEFT_NO_MEMORY, "no memory for contact.untangle");
}

static void rest(relaxation *of)
{
    const weft__mesh *mesh = &of->cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t j = 3 * n; j < 6 * n; ++j) {
        of->y[j] = mesh->pin[j % n] == 0 ? 0.0 : of->y[j];
    }
}

static weft_cloth *elastic_copy(const weft_cloth *cloth)
{
    weft_cloth *copy = weft__cloth_copy(cloth, &cloth->memory);
    if (copy != NULL) {
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            const weft__force *force = weft__table[k].force;
            if (force->tables.leave_out != NULL) {
                force->tables.leave_out(weft__own_of(copy, k));
            }
        }
    }
    return copy;
}

static bool untangle_create(relaxation *of, const weft_cloth *cloth, double *y)
{
    const weft_allocator *memory = &cloth->memory;
    const size_t n = cloth->mesh.particles;
    *of = (relaxation){ .cloth = cloth,
                        .y = y,
                        .ended = "",
                        .elastic = elastic_copy(cloth),
                        .rates = weft__alloc(memory, 6 * n, sizeof *y),
                        .moves = weft__alloc(memory, 3 * n, sizeof *y),
                        .shares = weft__alloc(memory, n, sizeof *y),
                        .kept = weft__alloc(memory, 3 * n, sizeof *y),
                        .least = LEAST * cloth->contact.law.thickness,
                        .gap = APART * cloth->contact.law.thickness };
    bool made = of->elastic != NULL && of->rates != NULL && of->moves != NULL
                && of->shares != NULL && of->kept != NULL;
    for (size_t k = 0; k < 2; ++k) {
        tangle *to = &of->tangles[k];
        to->memory = memory;
        to->stop = &of->stop;
        to->own = k == 0 ? &cloth->self : &cloth->bodies.pairs;
        if (to->own->law.self) {
            to->edges = to->own->surface != NULL ? to->own->surface->edges
                                                 : 3 * to->own->points;
            to->crossed = weft__alloc(memory, to->edges, sizeof *to->crossed);
            to->part = weft__alloc(memory, to->own->points, sizeof *to->part);
            to->points = weft__alloc(memory, to->own->points, sizeof *to->points);
            made
                = made && to->crossed != NULL && to->part != NULL && to->points != NULL;
        }
    }
    return made;
}

static void destroy(relaxation *of)
{
    WEFT__FREE_ALL(&of->cloth->memory, of->rates, of->moves, of->shares, of->kept);
    free_tangle(&of->tangles[0]);
    free_tangle(&of->tangles[1]);
    weft_cloth_destroy(of->elastic);
}

/* How far it is, once in a while. */
static void untangle_tell(relaxation *of, size_t crosses)
{
    const double now = weft__wall_clock();
    if (now - of->told >= PERIOD) {
        of->told = now;
        weft__log(&of->log, WEFT_LOG_INFO,
                  "contact.untangle: %zu crossings after %.3g of %.6g s, at least %zu",
                  crosses, of->t, of->cloth->untangle, of->fewest);
    }
}

/* Keeps a state that is better than the ones before: one without a crossing always, as
 * it then becomes wider. */
static void untangle_keep_better(relaxation *of, size_t crosses)
{
    if (crosses < of->fewest || crosses == 0) {
        memcpy(of->kept, of->y, 3 * of->cloth->mesh.particles * sizeof *of->kept);
        of->fewest = crosses;
        of->idle = 0;
    }
    if (of->depth < FALLS * of->shallowest) {
        of->shallowest = of->depth;
        of->idle = 0;
    }
}

/* From a state that crosses, whose moves are found, for the time of the cloth at most.
 */
static weft_status untangle_relax(relaxation *of, size_t crosses, weft_error *err)
{
    const size_t size = 3 * of->cloth->mesh.particles;
    const weft_stiffness most = weft_cloth_stiffness(of->elastic, 0.0, of->y);
    const double step = PART / (sqrt(fmax(most.omega2, 0.0)) + most.damping);
    const double time = of->cloth->untangle, h = isfinite(step) ? step : 0.01 * time;
    bool able = true;
    of->fewest = SIZE_MAX;
    of->shallowest = INFINITY;
    of->told = weft__wall_clock();
    untangle_keep_better(of, crosses);
    rest(of);
    while (able && of->t < time && of->ended[0] == '\0' && (crosses > 0 || of->near > 0)
           && !weft__stops(&of->stop)) {
        take_step(of, h);
        of->t += h;
        if (!weft__all_finite(of->y, 2 * size)) { /* nothing would cross */
            of->ended = ", where the state ceased to be finite";
            break;
        }
        able = find_moves(of, &crosses);
        if (able && !of->stop.came) {   /* else not all pairs were found */
            of->idle += of->fewest > 0; /* once nothing crosses, it becomes wider */
            untangle_keep_better(of, crosses);
            untangle_tell(of, crosses);
            of->ended = of->idle < PATIENCE
                            ? ""
                            : ", as the number of crossings did not fall any more";
        }
    }
    memcpy(of->y, of->kept, size * sizeof *of->kept);
    rest(of);
    return !able           ? untangle_no_memory(err)
           : of->stop.came ? weft__stopped(err)
                           : WEFT_OK;
}

/* The error of what is left. */
static weft_status tangled(relaxation *left, weft_error *err)
{
    const weft_cloth *cloth = left->cloth;
    const double *y = left->y;
    char where[128];
    size_t i, k;
    const weft__search of = { .where = where, .stop = &left->stop };
    (void)snprintf(where, sizeof where, "after %.6g s of contact.untangle%s: ",
                   left->ended[0] == '\0' ? cloth->untangle : left->t, left->ended);
    weft_status status = weft__crossings_error(cloth, 0.0, y, &of, err);
    const double gap = weft_cloth_gap(cloth, 0.0, y, &i, &k);
    if (status == WEFT_OK && !(gap > 0.0)) {
        char text[WEFT__CROSSING_TEXT];
        inside(&cloth->mesh, i, gap, k, text);
        status = weft_error_set(err, WEFT_INVALID, "%s%s", where, text);
    }
    if (status == WEFT_INVALID && err != NULL) {
        err->status = WEFT_SOLVER;
    }
    return status == WEFT_INVALID ? WEFT_SOLVER : status;
}

weft_status weft__relax_start(const weft_cloth *cloth, double *y,
                              const weft__stop *stop, const weft_log *log,
                              weft_error *err)
{
    size_t crosses = 0;
    relaxation of;
    if (cloth->untangle == 0.0) {
        return WEFT_OK;
    }
    if (!weft__all_finite(y, weft_cloth_dim(cloth))) {
        return weft_error_set(err, WEFT_INVALID, "a state must be finite");
    }
    const weft__search pins
        = { .where = "contact.untangle cannot move the cloth out: " };
    TRY(weft__bodies_force.present(&cloth->bodies)
            ? weft__bodies_pins_error(&cloth->bodies, 0.0, y, &pins, err)
            : WEFT_OK);
    weft_status status
        = untangle_create(&of, cloth, y) ? WEFT_OK : untangle_no_memory(err);
    of.stop = *stop, of.log = *log;
    if (status == WEFT_OK) {
        status = !find_moves(&of, &crosses) ? untangle_no_memory(err)
                 : of.stop.came             ? weft__stopped(err)
                 : crosses > 0              ? untangle_relax(&of, crosses, err)
                                            : WEFT_OK;
    }
    status = status == WEFT_OK ? tangled(&of, err) : status;
    destroy(&of);
    return status;
}

weft_status weft_cloth_untangle(const weft_cloth *cloth, double *y, weft_error *err)
{
    return weft__relax_start(cloth, y, &cloth->stop, &cloth->log, err);
}
