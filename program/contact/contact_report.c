/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_report.c -- what verbs print of contact: weft check, the shapes, and how
 * stiff contact is at rest and after a fall onto each of them; weft run, what touches
 * at the end, and what helps where contact holds the step. */
#include <math.h>
#include <stdlib.h>

#include "program/contact/contact_parts.h"

extern const report_section contact_report;

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

static void contact_print(const weft_cloth_def *def)
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

static void contact_check(const weft_scene *scene, const weft_cloth *cloth)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
    (void)cloth;
    contact_print(def);
    keys_print(def, weft_scene_run(scene)->duration);
}

static void contact_yaml(yaml_out *out, const weft_scene *scene)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
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

/* ---- runs ----------------------------------------------------------------------- */

/* "the smallest gap is 3.2 mm at the end" */
static void say_gap(sentence *text, double gap)
{
    if (isfinite(gap)) {
        say(text, " and the smallest gap is %.3g mm", 1e3 * gap);
    }
    say(text, " at the end; ");
}

/* Nothing without contact. */
static void contact_summary(const weft_scene *scene, const weft_sim *sim,
                            const weft_measures *all)
{
    sentence text = { "" };
    const weft_cloth *cloth = weft_sim_cloth(sim);
    const size_t shapes = weft_cloth_shapes(cloth);
    const bool has_self = weft_cloth_contact(cloth).self;
    if (shapes > 0) {
        say(&text, "%zu %s, %s particles touch", shapes,
            shapes == 1 ? "shape" : "shapes", human_count(all->touching).text);
        say_gap(&text, all->gap);
    }
    if (has_self) {
        say(&text, "%s pairs of the cloth's own parts touch",
            human_count(all->self_touching).text);
        say_gap(&text, all->self_gap);
    }
    if (shapes > 0 || has_self) {
        print_item("contact", "%s%s steps rolled back", text.text,
                   human_count(weft_sim_vetoed(sim)).text);
    }
    keys_print(weft_scene_cloth(scene), weft_scene_run(scene)->duration);
}

static bool contact_advise(const weft_failure *failure, const weft_cloth *cloth,
                           sentence *out)
{
    const double two = 2e3 * weft_cloth_contact(cloth).thickness;
    if (!failure->held_by_contact) {
        return false;
    }
    if (!failure->contact) {
        say(out, "look at what presses the cloth on itself there: other tolerances do "
                 "not help where contact holds the step");
    } else if (failure->other_shape == failure->gap_shape) {
        say(out,
            "look at what presses the cloth on shapes[%zu] there: other tolerances do "
            "not help where contact holds the step",
            failure->gap_shape);
    } else {
        say(out,
            "keep shapes[%zu] and shapes[%zu] two thicknesses (%.3g mm) apart where "
            "cloth is between them, or stop the run before they meet: other tolerances "
            "do not help where contact holds the step",
            failure->gap_shape < failure->other_shape ? failure->gap_shape
                                                      : failure->other_shape,
            failure->gap_shape < failure->other_shape ? failure->other_shape
                                                      : failure->gap_shape,
            two);
    }
    return true;
}

static bool contact_touches(const weft_cloth_def *def)
{
    return def->contact.shape_count > 0 || def->contact.self;
}

const report_section contact_report = { .check = contact_check,
                                        .check_yaml = contact_yaml,
                                        .warn = keys_warn,
                                        .summary = contact_summary,
                                        .advise = contact_advise,
                                        .touches = contact_touches };
