/* SPDX-License-Identifier: BSD-3-Clause */
/* keys_report.c -- weft check: bodies whose vertices swing beyond their key frames, as
 * natural splines do between keys that are far apart (docs/guides/drape-on-a-body.md).
 */
#include <math.h>
#include <stdlib.h>

#include "program/contact/contact_parts.h"

/* How far a vertex leaves the range of its two keys, in any coordinate. */
typedef struct overshoot {
    double most; /* [m] */
    size_t vertex, key;
    double t; /* [s] */
} overshoot;

/* Of one coordinate of one vertex in all keys, x: c, which is h^2 / 6 times its second
 * derivative, with 0 at both ends. */
static void solve(const double *x, size_t keys, double *c, double *factor)
{
    c[0] = factor[0] = c[keys - 1] = 0.0;
    for (size_t j = 1; j + 1 < keys; ++j) {
        factor[j] = 1.0 / (4.0 - factor[j - 1]);
        c[j] = factor[j] * (x[j - 1] - 2.0 * x[j] + x[j + 1] - c[j - 1]);
    }
    for (size_t j = keys - 1; j-- > 1;) {
        c[j] -= factor[j] * c[j + 1];
    }
}

/* At s of an interval: r a + s b + (r^3 - r) c + (s^3 - s) d, r = 1 - s. */
static double beyond(const double *x, const double *c, double s)
{
    const double r = 1.0 - s;
    const double at
        = r * x[0] + s * x[1] + r * (r * r - 1.0) * c[0] + s * (s * s - 1.0) * c[1];
    return fmax(at - fmax(x[0], x[1]), fmin(x[0], x[1]) - at);
}

/* Where its derivative 3 (d - c) s^2 + 6 c s + b - a - 2 c - d is 0. */
static void look_in(const double *x, const double *c, size_t key, overshoot *found)
{
    const double square = 3.0 * (c[1] - c[0]), half = 3.0 * c[0];
    const double rest = x[1] - x[0] - 2.0 * c[0] - c[1];
    const double root = sqrt(fmax(0.0, half * half - square * rest));
    const double q = -half - copysign(root, half);
    const double at[2] = { q / square, rest / q };
    for (size_t k = 0; k < 2; ++k) {
        const double by = at[k] > 0.0 && at[k] < 1.0 ? beyond(x, c, at[k]) : 0.0;
        if (by > found->most) {
            found->most = by;
            found->key = key;
            found->t = (double)key + at[k];
        }
    }
}

/* x, c and room for solve: `keys` numbers each. */
static overshoot largest(const weft_body *body, double *x, double *c, double *room)
{
    overshoot out = { .most = 0.0 };
    for (size_t i = 0; i < 3 * body->vertices; ++i) {
        const double before = out.most;
        for (size_t j = 0; j < body->keys; ++j) {
            x[j] = body->positions[3 * body->vertices * j + i];
        }
        solve(x, body->keys, c, room);
        for (size_t j = 0; j + 1 < body->keys; ++j) {
            look_in(x + j, c + j, j, &out);
        }
        out.vertex = out.most > before ? i / 3 : out.vertex;
    }
    out.t /= body->fps;
    return out;
}

void keys_warn(const char *file, const weft_cloth_def *def)
{
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        const weft_shape *shape = &def->contact.shapes[k];
        const size_t keys = shape->kind == WEFT_MESH ? shape->body->keys : 0;
        double *room = keys > 2 ? malloc(3 * keys * sizeof *room) : NULL;
        if (room == NULL) {
            continue;
        }
        const overshoot of = largest(shape->body, room, room + keys, room + 2 * keys);
        if (of.most > def->contact.thickness) {
            print_line(stderr,
                       "%s: warning: shapes[%zu]: between keys %zu and %zu, at %.4g s, "
                       "vertex %zu swings %.3g mm beyond its places at both, more than "
                       "the thickness of %.3g mm: the spline through the keys "
                       "overshoots; give more keys there, some before a motion begins "
                       "and after it ends",
                       file, k, of.key, of.key + 1, of.t, of.vertex, 1e3 * of.most,
                       1e3 * def->contact.thickness);
        }
        free(room);
    }
}

void keys_print(const weft_cloth_def *def, double duration)
{
    bool first = true;
    for (size_t k = 0; k < def->contact.shape_count; ++k) {
        const weft_body *body = def->contact.shapes[k].body;
        sentence text = { "" };
        if (def->contact.shapes[k].kind != WEFT_MESH || body->keys < 2) {
            continue;
        }
        const double span = (double)(body->keys - 1) / body->fps;
        say(&text, "shapes[%zu]: %zu key frames, 0 to %.6g s, in a run of %.6g s", k,
            body->keys, span, duration);
        if (span > duration * (1.0 + 1e-9)) {
            say(&text, "; %zu come after its end",
                body->keys - 1 - (size_t)floor(duration * body->fps * (1.0 + 1e-9)));
        } else if (span < duration * (1.0 - 1e-9)) {
            say(&text, "; then it rests");
        }
        print_item(first ? "keys" : "", "%s", text.text);
        first = false;
    }
}
