/* SPDX-License-Identifier: BSD-3-Clause */
/* converge_quantity.c -- the quantities that weft converge compares. */
#include <string.h>

#include "base/suggest.h"
#include "program/record/series.h"
#include "program/survey/survey.h"
#include "study/converge/converge.h"

static const struct {
    const char *name, *particle;
} places[] = {
    { "tip", "-1,middle" },  { "middle", "middle,middle" }, { "top-left", "0,0" },
    { "top-right", "0,-1" }, { "bottom-left", "-1,0" },     { "bottom-right", "-1,-1" },
};

enum { PLACES = sizeof places / sizeof places[0] };

/* A line of the scene, for refine_line; a negative number counts from the end. */
static bool read_line(const char *text, char end, size_t count, size_t *place)
{
    static const char middle[] = "middle";
    const size_t length = strlen(middle);
    const bool negative = text[0] == '-';
    size_t line;
    if (strncmp(text, middle, length) == 0 && text[length] == end) {
        *place = count - 1;
        return true;
    }
    const bool number = option_count(text + negative, end, &line);
    line = negative ? count - line : line;
    *place = 2 * line;
    return number && line < count;
}

/* The vertex that has a number, of several cloths "shirt:17"; their number: none has.
 */
static size_t find_vertex(const weft_mesh_def *mesh, const char *name)
{
    const char *colon = mesh->part_count > 0 ? strchr(name, ':') : NULL;
    const size_t cloth = colon != NULL ? (size_t)(colon - name) : 0;
    size_t number, v = 0;
    if (!option_count(colon != NULL ? colon + 1 : name, '\0', &number)
        || (mesh->part_count > 0 && colon == NULL)) {
        return mesh->vertices;
    }
    while (v < mesh->vertices
           && ((mesh->file_index == NULL ? v : mesh->file_index[v]) != number
               || strlen(cloth_of(mesh, v)) != cloth
               || strncmp(cloth_of(mesh, v), name, cloth) != 0)) {
        ++v;
    }
    return v;
}

/* A particle, the tip of a single row being its last. */
static bool read_particle(const converge *self, const char *name, size_t place[2])
{
    const weft_mesh_def *mesh = weft_scene_cloth(self->scene)->mesh;
    if (mesh != NULL) {
        place[0] = find_vertex(mesh, name);
        return place[0] < mesh->vertices;
    }
    const refine_axis *axis = self->grid.axis;
    const char *particle = name;
    for (size_t i = 0; i < PLACES; ++i) {
        if (strcmp(name, places[i].name) == 0) {
            particle = i == 0 && axis[0].count == 1 ? "0,-1" : places[i].particle;
        }
    }
    const char *comma = strchr(particle, ',');
    return comma != NULL && read_line(particle, ',', axis[0].count, &place[0])
           && read_line(comma + 1, '\0', axis[1].count, &place[1]);
}

static int unknown_quantity(const converge *self, const record_series *series,
                            const char *typed)
{
    weft__guess guess = { 0 };
    char near[80];
    for (size_t i = 0; i < series->columns; ++i) {
        weft__guess_try(&guess, typed, series->names[i]);
    }
    for (size_t i = 0; i < PLACES && !self->mesh; ++i) {
        weft__guess_try(&guess, typed, places[i].name);
    }
    const weft_cloth_def *cloth = weft_scene_cloth(self->scene);
    sentence nor = { "" };
    if (self->mesh) {
        say(&nor, "vertex%s of %zu",
            cloth->mesh->part_count > 0 ? ", CLOTH:NUMBER," : "",
            cloth->mesh->vertices);
    } else {
        say(&nor, "particle of %zu x %zu", cloth->rows, cloth->cols);
    }
    return usage_error(self->given, "--at %s is no column of series.csv and no %s%s",
                       typed, nor.text, weft__guess_text(&guess, near, sizeof near));
}

/* "tip" stands for "tip.x", "tip.y" and "tip.z". False: nothing has that name. */
static bool add_quantity(converge *self, const record_series *series, const char *typed)
{
    const size_t before = self->quantity_count, length = strcspn(typed, ".");
    converge_quantity one = { 0 };
    (void)snprintf(one.name, sizeof one.name, "%.*s", (int)length, typed);
    one.particle = read_particle(self, one.name, one.place);
    for (size_t i = 0; i < (one.particle ? 3 : series->columns); ++i) {
        const char coordinate[] = { '.', "xyz"[i % 3], '\0' };
        const char *name = one.particle ? coordinate : series->names[i];
        const char *wanted = one.particle ? typed + length : typed;
        if (strcmp(wanted, name) == 0 || (one.particle && wanted[0] == '\0')) {
            converge_quantity *to = &self->quantities[self->quantity_count++];
            *to = one;
            to->which = i;
            (void)snprintf(to->name, sizeof to->name, "%.*s%s",
                           one.particle ? (int)length : 0, typed, name);
        }
    }
    return self->quantity_count > before;
}

int converge_add_quantities(converge *self)
{
    const arguments *given = self->given;
    const char *usual = self->mesh ? "elastic" : "tip";
    const texts typed = converge_own(given)->ats;
    const bool none = typed.count == 0;
    const char **ats = none ? &usual : typed.at;
    record_series series = { 0 };
    record_series_begin(&series, series_columns(self->scene), NULL);
    for (size_t i = 0; i < (none ? 1 : typed.count); ++i) {
        if (self->quantity_count + 3 > CONVERGE_QUANTITIES) {
            return usage_error(self->given, "--at: more than %d quantities",
                               CONVERGE_QUANTITIES - 3);
        }
        if (!add_quantity(self, &series, ats[i])) {
            return unknown_quantity(self, &series, ats[i]);
        }
    }
    return EXIT_DONE;
}
