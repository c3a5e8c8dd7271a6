/* SPDX-License-Identifier: BSD-3-Clause */
/* test_passage.c -- cloth that enters a shape between its particles: found exactly,
 * whichever way the shape stands; warned of once; an error with contact.strict. */
#include <string.h>

#include "contact_run.h"
#include "forces/contact/passage.h"
#include "random.h"

/* ---- edges and triangles, against gaps that this file computes ---------------------
 */

static double beyond(double x, double low, double high)
{
    return fmax(x - high, 0.0) + fmax(low - x, 0.0);
}

static double fourth(double a, double b, double c)
{
    return sqrt(sqrt(a * a * a * a + b * b * b * b + c * c * c * c));
}

/* Of a shape that stands as it is defined, by the formulas of docs/theory/contact.md.
 */
static double gap_of(const weft_shape *shape, const double x[3])
{
    const double r[3]
        = { x[0] - shape->at[0], x[1] - shape->at[1], x[2] - shape->at[2] };
    const double *h = shape->half, s = shape->rounding;
    if (shape->kind == WEFT_SPHERE) {
        return sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) - shape->radius;
    }
    if (shape->kind == WEFT_BOX) {
        return fourth(beyond(r[0], s - h[0], h[0] - s),
                      beyond(r[1], s - h[1], h[1] - s),
                      beyond(r[2], s - h[2], h[2] - s))
               - s;
    }
    const double length = shape->to[2] - shape->at[2]; /* a capsule along z */
    return fourth(hypot(r[0], r[1]), beyond(r[2], 0.0, length), 0.0) - shape->radius;
}

/* The least of a convex function of s in [0, 1]. */
typedef double line_fn(const void *ctx, double s);
static double least_of(line_fn *of, const void *ctx)
{
    const double part = 0.5 * (sqrt(5.0) - 1.0);
    double low = 0.0, high = 1.0, a = 1.0 - part, b = part;
    double at[2] = { of(ctx, a), of(ctx, b) };
    double least = fmin(of(ctx, 0.0), of(ctx, 1.0));
    for (int i = 0; i < 44; ++i) {
        if (at[0] < at[1]) {
            high = b, b = a, at[1] = at[0];
            a = high - part * (high - low), at[0] = of(ctx, a);
        } else {
            low = a, a = b, at[0] = at[1];
            b = low + part * (high - low), at[1] = of(ctx, b);
        }
        least = fmin(least, fmin(at[0], at[1]));
    }
    return least;
}

typedef struct chord {
    const weft_shape *shape;
    double a[3], b[3], c[3]; /* c: of a triangle */
} chord;

static double gap_along(const void *ctx, double s)
{
    const chord *of = ctx;
    double x[3];
    for (size_t k = 0; k < 3; ++k) {
        x[k] = of->a[k] + s * (of->b[k] - of->a[k]);
    }
    return gap_of(of->shape, x);
}

/* On the chord from c to a point of the edge a b. */
static double gap_across(const void *ctx, double s)
{
    const chord *of = ctx;
    chord inner = { .shape = of->shape };
    memcpy(inner.a, of->c, sizeof inner.a);
    for (size_t k = 0; k < 3; ++k) {
        inner.b[k] = of->a[k] + s * (of->b[k] - of->a[k]);
    }
    return least_of(gap_along, &inner);
}

static weft_shape shape_of_kind(weft_shape_kind kind)
{
    weft_shape shape = weft_shape_default(kind);
    shape.radius = kind == WEFT_CAPSULE ? 0.05 : 0.2;
    shape.at[2] = -0.3;
    memcpy(shape.to, (const double[3]){ 0.0, 0.0, 0.3 }, sizeof shape.to);
    memcpy(shape.half, (const double[3]){ 0.04, 0.1, 0.3 }, sizeof shape.half);
    shape.rounding = 0.03;
    return shape;
}

/* At t = 1 the shape has turned, by a random angle about a random axis, and moved:
 * *back leads from there to where it is defined. */
static void turn_somehow(weft_shape *shape, uint64_t *seed)
{
    for (size_t k = 0; k < 3; ++k) {
        shape->turn.axis[k] = random_uniform(seed) - 0.5;
        shape->turn.about[k] = random_uniform(seed);
        shape->velocity[k] = random_uniform(seed);
    }
    shape->turn.rate = 6.0 * random_uniform(seed);
}

static void move(const weft_shape *shape, const weft__pose *pose, const double from[3],
                 double to[3])
{
    double arm[3];
    for (size_t k = 0; k < 3; ++k) {
        arm[k] = from[k] - shape->at[k];
    }
    weft__rotate(&pose->rigid.rotation, arm, to);
    for (size_t k = 0; k < 3; ++k) {
        to[k] += pose->at[k];
    }
}

/* 0 sphere, 1 capsule, 2 box. */
START_TEST(edges_and_triangles_enter_where_the_least_gap_is_negative)
{
    uint64_t seed = 1;
    size_t clear = 0, edges = 0, faces = 0;
    for (size_t trial = 0; trial < 1500; ++trial) {
        weft_shape shape = shape_of_kind((weft_shape_kind)(WEFT_SPHERE + _i));
        turn_somehow(&shape, &seed);
        const weft__shape made = weft__shape_of(&shape, 0.0);
        const weft__pose pose = weft__pose_of(&made, 1.0);
        double x[3][3], there[3][3];
        for (size_t k = 0; k < 9; ++k) {
            x[k / 3][k % 3] = random_uniform(&seed) - (k % 3 == 2 ? 0.8 : 0.5);
            x[k / 3][k % 3] *= trial % 2 == 0 ? 2.0 : 1.0;
        }
        bool enters = false;
        for (size_t k = 0; k < 3; ++k) {
            move(&shape, &pose, x[k], there[k]);
        }
        for (size_t k = 0; k < 3; ++k) {
            chord of = { .shape = &shape };
            memcpy(of.a, x[k], sizeof of.a), memcpy(of.b, x[(k + 1) % 3], sizeof of.b);
            const double least = least_of(gap_along, &of);
            const bool edge = weft__edge_enters(&pose, there[k], there[(k + 1) % 3]);
            ck_assert_msg(fabs(least) < 1e-9 || edge == (least < 0.0),
                          "edge %zu of triangle %zu: least gap %g", k, trial, least);
            ck_assert_int_eq(edge,
                             weft__edge_enters(&pose, there[(k + 1) % 3], there[k]));
            enters = enters || edge;
        }
        if (enters) {
            ++edges;
            continue;
        }
        chord of = { .shape = &shape };
        memcpy(of.a, x[0], sizeof of.a), memcpy(of.b, x[1], sizeof of.b);
        memcpy(of.c, x[2], sizeof of.c);
        const double least = least_of(gap_across, &of);
        const bool face = weft__face_enters(&pose, there);
        ck_assert_msg(fabs(least) < 1e-9 || face == (least < 0.0),
                      "triangle %zu: least gap %g", trial, least);
        faces += face;
        clear += !face;
    }
    ck_assert_msg(edges > 100 && faces > 50 && clear > 200, "%zu, %zu, %zu", edges,
                  faces, clear);
}
END_TEST

/* ---- while time passes -------------------------------------------------------------
 */

static struct {
    size_t count;
    char text[512];
} told;

static void hear(void *ctx, weft_log_level level, const char *text)
{
    (void)ctx;
    if (level == WEFT_LOG_WARNING) {
        ++told.count;
        (void)snprintf(told.text, sizeof told.text, "%s", text);
    }
}

/* Two particles 10 cm apart along x fall, on both sides of a capsule along z of this
 * radius, 5 cm below: the edge reaches it at some 1 m/s, after 0.1 s. */
static void over_a_line(double radius)
{
    memset(&told, 0, sizeof told);
    shapes[0] = weft_shape_default(WEFT_CAPSULE);
    memcpy(shapes[0].at, (const double[3]){ 0.05, -0.05, -1.0 }, sizeof shapes[0].at);
    memcpy(shapes[0].to, (const double[3]){ 0.05, -0.05, 1.0 }, sizeof shapes[0].to);
    shapes[0].radius = radius;
    model.spacing[1] = 0.1;
    run.log = (weft_log){ hear, NULL };
    run.config.max_step = 1e-4; /* it falls freely */
    tolerance(1e-6);
}

static weft_status no_frame(void *ctx, size_t i, weft_error *why)
{
    (void)ctx, (void)i, (void)why;
    return WEFT_OK;
}

/* A wire of 2 mm passes between two frames, a rod of 6 cm stays for several. */
START_TEST(a_passage_is_warned_of_once)
{
    const weft_run_def film = { .duration = 0.5, .fps = _i == 0 ? 4.0 : 100.0 };
    const weft_play frames
        = { .run = &film, .last = weft_run_last_frame(&film), .frame = no_frame };
    over_a_line(_i == 0 ? 1e-3 : 3e-2);
    start();
    ck_assert(!weft_sim_passed(sim));
    ck_assert_msg(weft_sim_play(sim, &frames, &err) == WEFT_OK, "%s", err.message);
    ck_assert_uint_eq(told.count, 1);
    ck_assert(weft_sim_passed(sim));
    double t = 0.0;
    const char *at
        = strstr(told.text, "edge (0, 0)-(0, 1) passes through shapes[0] at t");
    ck_assert_msg(at != NULL && strstr(at, "triangles: true") != NULL, "%s", told.text);
    ck_assert_int_eq(sscanf(strstr(at, "t = "), "t = %lf s", &t), 1);
    const double r = shapes[0].radius; /* the edge is deeper than allowed, not past */
    const double deep = fmin(model.contact.thickness, r) / 4.0;
    const double fallen = 0.5 * 9.81 * t * t - 0.05;
    ck_assert_msg(fallen > deep - r - 1e-6 && fallen < r - deep + 1e-6, "%g", fallen);
}
END_TEST

/* Before and after such a step the edge is outside. */
START_TEST(a_step_past_a_whole_wire_shows_its_passage)
{
    over_a_line(1e-3);
    run.config.max_step = (double)INFINITY;
    model.strict = _i == 1;
    start();
    weft_status status = WEFT_OK;
    while (weft_sim_time(sim) < 0.5 && status == WEFT_OK) {
        status = weft_sim_step(sim, 0.5, &err);
    }
    ck_assert_uint_lt(weft_sim_stats(sim).steps, 20);
    ck_assert_int_eq(status, model.strict ? WEFT_INVALID : WEFT_OK);
    ck_assert_uint_eq(told.count, !model.strict);
    ck_assert(weft_sim_passed(sim));
    const char *text = model.strict ? err.message : told.text;
    ck_assert_msg(strstr(text, "edge (0, 0)-(0, 1) passes through shapes[0]") != NULL,
                  "%s", text);
}
END_TEST

START_TEST(strict_ends_the_run_at_a_passage)
{
    over_a_line(1e-3);
    model.strict = true;
    start();
    weft_status status = WEFT_OK;
    while (weft_sim_time(sim) < 0.5 && status == WEFT_OK) {
        status = weft_sim_step(sim, 0.5, &err);
    }
    ck_assert_int_eq(status, WEFT_INVALID);
    ck_assert_msg(strncmp(err.message, "contact.strict: edge (0, 0)-(0, 1) passes", 40)
                      == 0,
                  "%s", err.message);
    ck_assert_double_eq_tol(weft_sim_time(sim), 0.1, 5e-3);
    ck_assert_uint_eq(told.count, 0);
    model.origin[1] = -0.05; /* it starts so */
    weft_cloth *never = NULL;
    ck_assert_int_eq(weft_cloth_create(&model, &never, &err), WEFT_INVALID);
    ck_assert_msg(strstr(err.message, "at t = 0 s") != NULL, "%s", err.message);
}
END_TEST

START_TEST(a_restored_simulation_does_not_warn_again)
{
    static unsigned char bytes[1 << 14];
    over_a_line(3e-2);
    start();
    go(0.1);
    ck_assert_uint_eq(told.count, 1);
    const size_t size = weft_sim_save_size(sim);
    ck_assert_uint_le(size, sizeof bytes);
    ck_assert_int_eq(weft_sim_save(sim, bytes, size, &err), WEFT_OK);
    start();
    ck_assert_int_eq(weft_sim_restore(sim, bytes, size, &err), WEFT_OK);
    ck_assert(weft_sim_passed(sim));
    go(0.12);
    ck_assert_uint_eq(told.count, 1);
}
END_TEST

/* A cell about the axis y of a level sheet of 6 x 6, threaded by a rod. */
START_TEST(a_rod_that_threads_a_cell_touches_none_of_its_edges)
{
    level_sheet();
    shapes[0] = weft_shape_default(WEFT_CAPSULE);
    memcpy(shapes[0].at, (const double[3]){ 5e-3, -0.2, 5e-3 }, sizeof shapes[0].at);
    memcpy(shapes[0].to, (const double[3]){ 5e-3, 0.2, 5e-3 }, sizeof shapes[0].to);
    shapes[0].radius = 2e-3;
    cloth = test_cloth(&model);
    double y[6 * 36];
    weft_passage first;
    weft_cloth_start(cloth, y);
    ck_assert_uint_eq(weft_cloth_passages(cloth, 0.0, y, &first), 1);
    ck_assert_uint_eq(first.primitive.count, 3);
    ck_assert_uint_eq(first.shape, 0);
    char text[64];
    ck_assert_str_eq(weft_primitive_text(cloth, &first.primitive, text, sizeof text),
                     "cell (2, 2)");
    for (size_t i = 0; i < 36; ++i) {
        y[36 + i] = 0.3; /* above it */
    }
    ck_assert_uint_eq(weft_cloth_passages(cloth, 0.0, y, &first), 0);
    ck_assert_uint_eq(first.primitive.count, 0);
}
END_TEST

/* Pins that hold a corner inside a ball, or all corners about it. */
START_TEST(what_pins_hold_in_a_shape_does_not_count)
{
    double y[12];
    weft_pin pin = { .rows = { 0, 0 }, .cols = { 0, _i } };
    over_a_line(3e-2);
    shapes[0].at[0] = shapes[0].to[0] = _i == 0 ? -0.02 : 0.05;
    shapes[0].at[1] = shapes[0].to[1] = 0.0;
    model.pins = &pin, model.pin_count = 1;
    cloth = test_cloth(&model);
    weft_cloth_start(cloth, y);
    ck_assert_uint_eq(weft_cloth_passages(cloth, 0.0, y, NULL), 0);
    teardown();
    shapes[0].at[0] = shapes[0].to[0] = 0.05;
    pin.cols.last = 0; /* the pin outside, the rod between */
    cloth = test_cloth(&model);
    ck_assert_uint_eq(weft_cloth_passages(cloth, 0.0, y, NULL), 1);
}
END_TEST

/* ---- triangles of a shape -------------------------------------------------------- */

/* How often a body has a directed edge. */
static size_t edges_of(const weft_body *body, uint32_t from, uint32_t to)
{
    size_t count = 0;
    for (size_t j = 0; j < 3 * body->triangles; ++j) {
        const size_t next = j % 3 == 2 ? j - 2 : j + 1;
        count += body->corners[j] == from && body->corners[next] == to;
    }
    return count;
}

/* [m^3] */
static double volume_of(const weft_body *body)
{
    double sum = 0.0;
    for (size_t t = 0; t < body->triangles; ++t) {
        const double *x[3];
        double cross[3];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = body->positions + 3 * (size_t)body->corners[3 * t + k];
        }
        weft__cross(x[1], x[2], cross);
        sum += weft__dot(x[0], cross) / 6.0;
    }
    return sum;
}

/* 0 sphere, 1 capsule, 2 box. */
START_TEST(triangles_of_a_shape_are_closed_and_lie_on_it)
{
    const double thickness = 0.02;
    const double volumes[] = { 4.0 / 3.0 * (0.5 * WEFT__TWO_PI) * 8e-3,
                               5.3e-3 /* with fuller ends */, 9.6e-3 };
    weft_shape shape = shape_of_kind((weft_shape_kind)(WEFT_SPHERE + _i));
    const weft_shape as_was = shape;
    weft_body *body;
    shape.orientation[1] = shape.orientation[3] = 0.5;
    ck_assert_int_eq(weft_shape_triangulate(&shape, thickness, 0.0, NULL, &body, &err),
                     WEFT_OK);
    ck_assert(shape.kind == WEFT_MESH && shape.body == body && body->keys == 1);
    ck_assert(shape.orientation[1] == (as_was.kind == WEFT_BOX ? 0.5 : 0.0));
    const double radius = as_was.kind == WEFT_BOX ? as_was.rounding : as_was.radius;
    const double longest = sqrt(2.0 * radius * thickness);
    ck_assert_uint_eq(body->vertices, body->triangles / 2 + 2);
    for (size_t i = 0; i < body->vertices; ++i) {
        double x[3];
        for (size_t k = 0; k < 3; ++k) {
            x[k] = as_was.at[k] + body->positions[3 * i + k];
        }
        ck_assert_double_eq_tol(gap_of(&as_was, x), 0.0, 1e-15);
    }
    for (size_t j = 0; j < 3 * body->triangles; ++j) {
        const size_t next = j % 3 == 2 ? j - 2 : j + 1;
        const uint32_t p = body->corners[j], q = body->corners[next];
        double square = 0.0, x[3];
        for (size_t k = 0; k < 3; ++k) {
            const double a = body->positions[3 * (size_t)p + k],
                         b = body->positions[3 * (size_t)q + k];
            square += (b - a) * (b - a);
            x[k] = as_was.at[k] + 0.5 * (a + b);
        }
        ck_assert_double_le(sqrt(square), longest);
        ck_assert_double_gt(gap_of(&as_was, x), -0.25 * thickness);
        ck_assert_uint_eq(edges_of(body, p, q), 1);
        ck_assert_uint_eq(edges_of(body, q, p), 1);
    }
    const double volume = volume_of(body), whole = volumes[_i];
    ck_assert_msg(volume > 0.8 * whole && volume < 1.1 * whole, "%g of %g", volume,
                  whole);
    weft_body_destroy(body, NULL);
}
END_TEST

START_TEST(what_cannot_become_triangles_is_refused)
{
    static const struct {
        weft_shape_kind kind;
        double spin, edge;
        const char *told;
    } refused[] = {
        { WEFT_PLANE, 0.0, 0.01, "a sphere, a capsule or a box" },
        { WEFT_SPHERE, 1.0, 0.01, "cannot spin" },
        { WEFT_SPHERE, 0.0, 1e-4, "more than 200000: a longer edge makes fewer" },
        { WEFT_SPHERE, 0.0, (double)NAN, "must be finite and > 0" },
    };
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; ++i) {
        weft_shape shape = shape_of_kind(refused[i].kind);
        weft_body *body = (void *)&shape;
        shape.spin[1] = refused[i].spin;
        const double thickness = isnan(refused[i].edge) ? (double)NAN : 5e-3;
        ck_assert_int_eq(weft_shape_triangulate(&shape, thickness, refused[i].edge,
                                                NULL, &body, &err),
                         WEFT_INVALID);
        ck_assert(body == NULL && shape.kind == refused[i].kind);
        ck_assert_msg(strstr(err.message, refused[i].told) != NULL, "%s", err.message);
    }
}
END_TEST

/* The two particles and the edge between them, on the rod that they fell past. */
START_TEST(nothing_passes_a_shape_of_triangles)
{
    weft_body *body;
    over_a_line(3e-2);
    model.strict = true;
    model.springs[WEFT_STRETCH]
        = (weft_spring_def){ .present = true, .stiffness = 100.0, .damping = 0.5 };
    ck_assert_int_eq(weft_shape_triangulate(&shapes[0], model.contact.thickness, 0.0,
                                            NULL, &body, &err),
                     WEFT_OK);
    run.method = test_method_named("gsl/rkf45");
    tolerance(1e-4);
    model.rows = 2; /* an edge of a cell */
    model.spacing[0] = 0.05, model.down[1] = 0.0, model.down[2] = 1.0;
    model.springs[WEFT_SHEAR] = model.springs[WEFT_STRETCH];
    start();
    weft_body_destroy(body, NULL); /* copied */
    go(0.15);
    ck_assert_double_gt(gap(), 0.0);
    ck_assert_double_gt(fmin(at(0, 1), at(2, 1)), -0.05);
    ck_assert(!weft_sim_passed(sim));
}
END_TEST

TEST_SUITE(passage)
{
    Suite *suite = suite_create("passage");
    TCase *tcase = tcase_create("passage");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(
        tcase, edges_and_triangles_enter_where_the_least_gap_is_negative, 0, 3);
    tcase_add_loop_test(tcase, a_passage_is_warned_of_once, 0, 2);
    tcase_add_loop_test(tcase, a_step_past_a_whole_wire_shows_its_passage, 0, 2);
    tcase_add_test(tcase, strict_ends_the_run_at_a_passage);
    tcase_add_test(tcase, a_restored_simulation_does_not_warn_again);
    tcase_add_test(tcase, a_rod_that_threads_a_cell_touches_none_of_its_edges);
    tcase_add_loop_test(tcase, what_pins_hold_in_a_shape_does_not_count, 0, 2);
    tcase_add_loop_test(tcase, triangles_of_a_shape_are_closed_and_lie_on_it, 0, 3);
    tcase_add_test(tcase, what_cannot_become_triangles_is_refused);
    tcase_add_test(tcase, nothing_passes_a_shape_of_triangles);
    suite_add_tcase(suite, tcase);
    return suite;
}
