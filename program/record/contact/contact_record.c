/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_record.c -- contact and its shapes in the files of a run. */
#include <inttypes.h>
#include <math.h>

#include "base/hash.h"
#include "program/record/record.h"
#include "program/record/sections.h"
#include "program/record/series.h"

extern const record_section contact_record;

static void write_contact_def(yaml_out *out, const weft_cloth_def *def)
{
    const weft_contact_def *contact = &def->contact;
    if (contact->shape_count > 0 || contact->self) {
        yaml_out_write(out,
                       "contact: { thickness: %g, stopping_speed: %g, exponent: %d, "
                       "damping: %g, friction: %g, law: %s, slip: %g, self: %s, "
                       "shapes: %zu }",
                       contact->thickness, contact->stopping_speed, contact->exponent,
                       contact->damping, contact->friction,
                       contact->law == WEFT_FRICTION_SMOOTH ? "smooth" : "coulomb",
                       contact->slip, yaml_bool(contact->self), contact->shape_count);
    }
}

static void write_contact(yaml_out *out, const weft_sim *sim, const weft_measures *all)
{
    const bool shapes = weft_cloth_shapes(weft_sim_cloth(sim)) > 0;
    const bool self = weft_cloth_contact(weft_sim_cloth(sim)).self;
    if (shapes || self) {
        yaml_out_write(out, "contact: { energy: %g", all->energy.contact);
        if (shapes) {
            yaml_out_write(out, "min_gap: %g, touching: %zu", all->gap, all->touching);
        }
        if (self) {
            yaml_out_write(out, "self_gap: %g, self_touching: %zu", all->self_gap,
                           all->self_touching);
        }
        yaml_out_write(out, "vetoed: %" PRIu64 " }", weft_sim_vetoed(sim));
    }
}

/* ---- the page ---- */

static const char *comma(size_t i)
{
    return i > 0 ? "," : "";
}

static void write_numbers(FILE *stream, const char *name, const double *x, size_t count)
{
    fprintf(stream, ",\"%s\":%s", name, count > 1 ? "[" : "");
    for (size_t k = 0; k < count; ++k) {
        fprintf(stream, "%s%.17g", comma(k), x[k]);
    }
    fputs(count > 1 ? "]" : "", stream);
}

/* In single precision, as the page draws. */
static void write_body(FILE *stream, const weft_body *body)
{
    fprintf(stream, ",\"fps\":%.17g,\"keys\":[", body->fps);
    for (size_t i = 0; i < 3 * body->vertices * body->keys; ++i) {
        const size_t in = i % (3 * body->vertices);
        fprintf(stream, "%s%s%.7g", in == 0 ? comma(i) : "", in == 0 ? "[" : ",",
                body->positions[i]);
        fputs(in + 1 == 3 * body->vertices ? "]" : "", stream);
    }
    fputs("],\"corners\":[", stream);
    for (size_t i = 0; i < 3 * body->triangles; ++i) {
        fprintf(stream, "%s%" PRIu32, comma(i), body->corners[i]);
    }
    fputc(']', stream);
}

static void write_shape(FILE *stream, const weft_shape *shape)
{
    fprintf(stream, "{\"shape\":\"%s\"", weft_shape_name(shape->kind));
    write_numbers(stream, "at", shape->at, 3);
    write_numbers(stream, "to", shape->to, 3);
    write_numbers(stream, "normal", shape->normal, 3);
    write_numbers(stream, "radius", &shape->radius, 1);
    write_numbers(stream, "half", shape->half, 3);
    write_numbers(stream, "rounding", &shape->rounding, 1);
    write_numbers(stream, "velocity", shape->velocity, 3);
    write_numbers(stream, "amplitude", shape->amplitude, 3);
    write_numbers(stream, "frequency", &shape->frequency, 1);
    write_numbers(stream, "spin", shape->spin, 3);
    const weft_turn *turn = &shape->turn;
    if (turn->axis[0] != 0.0 || turn->axis[1] != 0.0 || turn->axis[2] != 0.0) {
        fprintf(stream, ",\"turn\":{\"rate\":%.17g", turn->rate);
        write_numbers(stream, "axis", turn->axis, 3);
        write_numbers(stream, "about", isnan(turn->about[0]) ? shape->at : turn->about,
                      3);
        write_numbers(stream, "amplitude", &turn->amplitude, 1);
        write_numbers(stream, "frequency", &turn->frequency, 1);
        fputc('}', stream);
    }
    if (shape->body != NULL) {
        write_body(stream, shape->body);
    }
    fputc('}', stream);
}

static void write_obstacles(FILE *stream, const weft_cloth_def *def)
{
    const weft_contact_def none = { .shape_count = 0 };
    const weft_contact_def *contact = def == NULL ? &none : &def->contact;
    write_numbers(stream, "thickness", &contact->thickness, 1);
    fprintf(stream, ",\"self\":%s,\"obstacles\":[", contact->self ? "true" : "false");
    for (size_t k = 0; k < contact->shape_count; ++k) {
        fputs(comma(k), stream);
        write_shape(stream, &contact->shapes[k]);
    }
    fputc(']', stream);
}

/* ---- files ---- */

/* The triangles that weft made of shape k, from its place, as an OBJ file. */
static weft_status write_made(const char *directory, size_t k, const weft_body *body,
                              weft_error *err)
{
    char name[40];
    record_file file;
    (void)snprintf(name, sizeof name, "shape-%zu.obj", k);
    TRY(record_file_open(&file, directory, name, err));
    for (size_t i = 0; i < body->vertices; ++i) {
        const double *x = body->positions + 3 * i;
        fprintf(file.stream, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
    }
    for (size_t t = 0; t < body->triangles; ++t) {
        const uint32_t *c = body->corners + 3 * t;
        fprintf(file.stream, "f %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", c[0] + 1,
                c[1] + 1, c[2] + 1);
    }
    return record_file_commit(&file, err);
}

static weft_status write_shapes(const char *directory, const weft_scene *scene,
                                weft_error *err)
{
    const weft_contact_def *contact = &weft_scene_cloth(scene)->contact;
    for (size_t k = 0; k < contact->shape_count; ++k) {
        TRY(weft_scene_shape_made(scene, k)
                ? write_made(directory, k, contact->shapes[k].body, err)
                : WEFT_OK);
    }
    return WEFT_OK;
}

static uint64_t shapes_hash(const weft_cloth_def *def, uint64_t hash)
{
    const weft_contact_def *contact = &def->contact;
    for (size_t k = 0; k < contact->shape_count; ++k) {
        const weft_body *body = contact->shapes[k].body;
        const size_t vertices = body == NULL ? 0 : body->vertices * body->keys;
        hash = weft__hash_reals(hash, body == NULL ? NULL : body->positions,
                                3 * vertices);
        for (size_t i = 0; body != NULL && i < 3 * body->triangles; ++i) {
            hash = weft__hash_word(hash, body->corners[i]);
        }
    }
    return hash;
}

static unsigned contact_columns(const weft_cloth_def *def)
{
    return def->contact.self ? RECORD_SELF : 0u;
}

const record_section contact_record = { .manifest = write_contact_def,
                                        .result = write_contact,
                                        .page = write_obstacles,
                                        .columns = contact_columns,
                                        .hash = shapes_hash,
                                        .files = write_shapes };
