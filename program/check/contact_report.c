/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_report.c -- weft check: contact. */
#include <math.h>
#include <stdlib.h>

#include "program/check/check.h"

/* ---- the law of docs/theory/contact.md, by z = gap / thickness ------------------ */

/* [m^2/s^2] U / m */
static double potential(const weft_contact_def *law, double z)
{
    const double e = 0.5 * law->stopping_speed * law->stopping_speed;
    return e * pow(1.0 - z, law->exponent) / z;
}

/* [m/s^2] N0 / m */
static double push(const weft_contact_def *law, double z)
{
    const double p = law->exponent, s = 1.0 - z;
    const double e = 0.5 * law->stopping_speed * law->stopping_speed;
    return e / law->thickness * pow(s, p - 1.0) * (p * z + s) / (z * z);
}

/* [1/s] sqrt(kn / m) */
static double omega(const weft_contact_def *law, double z)
{
    const double p = law->exponent, s = 1.0 - z;
    const double a = p * (p - 1.0) * z * z + 2.0 * p * s * z + 2.0 * s * s;
    return law->stopping_speed / law->thickness
           * sqrt(0.5 * pow(s, p - 2.0) * a / (z * z * z));
}

/* The z in (0, 1) at which a function that falls with z has a value. */
static double solve(double (*of)(const weft_contact_def *law, double z),
                    const weft_contact_def *law, double value)
{
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        *(of(law, middle) > value ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static double length_of(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Where a particle rests on a level shape; without gravity, where one that arrives at
 * the stopping speed turns. */
static double rest_of(const weft_cloth_def *def)
{
    const weft_contact_def *law = &def->contact;
    const double g = length_of(def->gravity), v = law->stopping_speed;
    return g > 0.0 ? solve(push, law, g) : solve(potential, law, 0.5 * v * v);
}

/* ---- a fall onto a shape ------------------------------------------------------- */

enum { MOST_MOVES = 1000 };

/* [m] How far the cloth, kept as it starts, falls until it touches its shape: as no
 * point is nearer than the smallest gap, it may fall by that. Infinite: past it. */
static double drop_of(const weft_cloth *cloth, const weft_cloth_def *def, double *y)
{
    const size_t n = weft_cloth_particles(cloth);
    const double g = length_of(def->gravity), thickness = def->contact.thickness;
    double drop = 0.0, gap = INFINITY;
    weft_cloth_start(cloth, y);
    for (int i = 0; i < MOST_MOVES && g > 0.0; ++i) {
        gap = weft_cloth_gap(cloth, 0.0, y, NULL, NULL);
        if (gap < thickness || !isfinite(gap)) {
            break;
        }
        drop += gap;
        for (size_t j = 0; j < 3 * n; ++j) {
            y[j] += gap * (def->gravity[j / n] / g);
        }
    }
    return gap < thickness ? drop : INFINITY;
}

typedef struct fall {
    double drop, speed; /* [m], [m/s]; infinite: it does not fall onto the shape */
    double z;           /* where it is stopped */
    size_t passages;    /* of the start, and the first in words */
    char passage[128];
} fall;

static fall fall_onto(const weft_cloth_def *def, size_t shape)
{
    weft_cloth_def one = *def;
    weft_cloth *cloth = NULL;
    fall out = { .drop = INFINITY };
    one.contact.shapes = &def->contact.shapes[shape];
    one.contact.shape_count = 1;
    double *y = calloc(6 * weft_cloth_def_particles(def), sizeof *y);
    if (y != NULL && weft_cloth_create(&one, &cloth, NULL) == WEFT_OK) {
        weft_passage first;
        weft_cloth_start(cloth, y);
        out.passages = weft_cloth_passages(cloth, 0.0, y, &first);
        if (out.passages > 0) {
            (void)weft_primitive_text(cloth, &first.primitive, out.passage,
                                      sizeof out.passage);
        }
        out.drop = drop_of(cloth, def, y);
    }
    weft_cloth_destroy(cloth);
    free(y);
    out.speed = sqrt(2.0 * length_of(def->gravity) * out.drop);
    out.z = solve(potential, &def->contact, 0.5 * out.speed * out.speed);
    return out;
}

/* ---- output -------------------------------------------------------------------- */

static double friction_of(const weft_contact_def *law, const weft_shape *shape)
{
    return shape->friction < 0.0 ? law->friction : shape->friction;
}

static void print_shape(const weft_cloth_def *def, size_t k)
{
    const weft_contact_def *law = &def->contact;
    const weft_shape *shape = &law->shapes[k];
    const fall onto = fall_onto(def, k);
    const bool moved = shape->frequency > 0.0 || length_of(shape->velocity) > 0.0
                       || length_of(shape->spin) > 0.0
                       || length_of(shape->turn.axis) > 0.0;
    sentence text = { "" };
    say(&text, "shapes[%zu]: %s, friction %g%s", k, weft_shape_name(shape->kind),
        friction_of(law, shape), moved ? ", moved" : "");
    if (isfinite(onto.drop)) {
        say(&text, "; after a fall of %.3g m at %.3g m/s: gap %.3g mm, omega %.4g 1/s",
            onto.drop, onto.speed, 1e3 * onto.z * law->thickness, omega(law, onto.z));
    }
    if (onto.passages > 0) {
        say(&text,
            "; warning: %s passes through it at the start, one of %zu edges and "
            "triangles",
            onto.passage, onto.passages);
    }
    print_item("", "%s", text.text);
}

/* Two flat layers that lie on each other have pairs of 1.3 m e phi per particle, on
 * average: those that meet at the speed v turn where that is m v^2 / 4. */
static void print_self(const weft_contact_def *law)
{
    const double pairs = 1.3, v = law->stopping_speed;
    const double z = solve(potential, law, 0.25 * v * v / pairs);
    print_item("",
               "itself: friction %g; two layers that meet at %g m/s: gap some %.2g mm, "
               "omega some %.2g 1/s",
               law->friction, v, 1e3 * z * law->thickness,
               sqrt(2.0 * pairs) * omega(law, z));
}

void contact_print(const weft_cloth_def *def)
{
    const weft_contact_def *law = &def->contact;
    const double z = rest_of(def);
    if (law->shape_count == 0 && !law->self) {
        return;
    }
    print_item("contact",
               "thickness %.4g mm, stopping speed %g m/s, exponent %d, damping %g s/m, "
               "%s friction, slip %g m/s; %s: gap %.3g mm, omega %.4g 1/s",
               1e3 * law->thickness, law->stopping_speed, law->exponent, law->damping,
               law->law == WEFT_FRICTION_SMOOTH ? "smooth" : "coulomb", law->slip,
               length_of(def->gravity) > 0.0 ? "at rest on a level shape"
                                             : "at the stopping speed",
               1e3 * z * law->thickness, omega(law, z));
    for (size_t k = 0; k < law->shape_count; ++k) {
        print_shape(def, k);
    }
    if (law->self) {
        print_self(law);
    }
}

void contact_yaml(yaml_out *out, const weft_cloth_def *def)
{
    const weft_contact_def *law = &def->contact;
    const double z = rest_of(def);
    if (law->shape_count == 0 && !law->self) {
        return;
    }
    yaml_out_write(out, "contact: { rest_gap: %g, rest_omega: %g, self: %s, shapes: [",
                   z * law->thickness, omega(law, z), yaml_bool(law->self));
    for (size_t k = 0; k < law->shape_count; ++k) {
        const fall onto = fall_onto(def, k);
        yaml_out_write(out, "{ shape: \"%s\", friction: %g",
                       weft_shape_name(law->shapes[k].kind),
                       friction_of(law, &law->shapes[k]));
        if (isfinite(onto.drop)) {
            yaml_out_write(out, "drop: %g, speed: %g, gap: %g, omega: %g", onto.drop,
                           onto.speed, onto.z * law->thickness, omega(law, onto.z));
        }
        if (onto.passages > 0) {
            yaml_out_write(out, "passages: %zu", onto.passages);
        }
        yaml_out_write(out, "}");
    }
    yaml_out_write(out, "] }");
}
