/* SPDX-License-Identifier: BSD-3-Clause */
/* converge_quantity.c -- the quantities that weft converge compares. */
#include <string.h>

#include "base/suggest.h"
#include "cli/converge/converge.h"

/* Particles by name. A line is the first, the last or the middle. */
static const struct {
    const char *name;
    enum { FIRST, MIDDLE, LAST } line[2];
} places[] = {
    { "tip", { LAST, MIDDLE } },        { "middle", { MIDDLE, MIDDLE } },
    { "top", { FIRST, MIDDLE } },       { "bottom", { LAST, MIDDLE } },
    { "left", { MIDDLE, FIRST } },      { "right", { MIDDLE, LAST } },
    { "top-left", { FIRST, FIRST } },   { "top-right", { FIRST, LAST } },
    { "bottom-left", { LAST, FIRST } }, { "bottom-right", { LAST, LAST } },
};

enum { PLACES = sizeof places / sizeof places[0] };

/* The tip of a single row is its last particle. */
static bool find_place(const converge *self, const char *name, converge_quantity *out)
{
    const bool row = self->grid.axis[0].count == 1;
    size_t i = 0;
    while (i < PLACES && strcmp(name, places[i].name) != 0) {
        ++i;
    }
    for (size_t k = 0; i < PLACES && k < 2; ++k) {
        const int line = i == 0 && row ? LAST : (int)places[i].line[k];
        out->half[k] = line == MIDDLE;
        out->index[k] = line == LAST ? self->grid.axis[k].count - 1 : 0;
    }
    return i < PLACES;
}

/* A line of the scene; a negative number counts from the end. */
static bool read_line(const char *text, char end, size_t count, size_t *out)
{
    const bool negative = text[0] == '-';
    const bool number = option_count(text + negative, end, out);
    *out = negative ? count - *out : *out;
    return number && *out < count;
}

static bool read_particle(const converge *self, const char *name,
                          converge_quantity *out)
{
    const char *comma = strchr(name, ',');
    return find_place(self, name, out)
           || (comma != NULL
               && read_line(name, ',', self->grid.axis[0].count, &out->index[0])
               && read_line(comma + 1, '\0', self->grid.axis[1].count, &out->index[1]));
}

static int unknown_quantity(const converge *self, const record_series *series,
                            const char *typed)
{
    weft__guess guess = { 0 };
    char near[80];
    for (size_t i = 0; i < series->columns; ++i) {
        weft__guess_try(&guess, typed, series->names[i]);
    }
    for (size_t i = 0; i < PLACES; ++i) {
        weft__guess_try(&guess, typed, places[i].name);
    }
    return usage_error(&verb_converge,
                       "--at %s is no column of series.csv and no particle of %zu x "
                       "%zu%s",
                       typed, self->grid.axis[0].count, self->grid.axis[1].count,
                       weft__guess_text(&guess, near, sizeof near));
}

static void add(converge *self, converge_quantity one, const char *name, size_t which)
{
    const char coordinate[] = { '.', "xyz"[which % 3], '\0' };
    one.which = which;
    (void)snprintf(one.name, sizeof one.name, "%s%s", name,
                   one.particle ? coordinate : "");
    self->quantities[self->quantity_count++] = one;
}

/* "tip" stands for "tip.x", "tip.y" and "tip.z". */
static int add_quantity(converge *self, const record_series *series, const char *typed)
{
    converge_quantity one = { 0 };
    char name[CONVERGE_NAME - 2];
    const char *dot = strrchr(typed, '.');
    const int length = (int)(dot == NULL ? strlen(typed) : (size_t)(dot - typed));
    const size_t before = self->quantity_count;
    for (size_t i = 0; i < series->columns; ++i) {
        if (strcmp(typed, series->names[i]) == 0) {
            add(self, one, typed, i);
        }
    }
    (void)snprintf(name, sizeof name, "%.*s", length, typed);
    one.particle = read_particle(self, name, &one);
    for (size_t k = 0; one.particle && k < 3; ++k) {
        if (dot == NULL || (dot[1] == "xyz"[k] && dot[2] == '\0')) {
            add(self, one, name, k);
        }
    }
    return self->quantity_count > before ? EXIT_DONE
                                         : unknown_quantity(self, series, typed);
}

int converge_add_quantities(converge *self, const options *given)
{
    static const char *const tip = "tip";
    const char *const *ats = given->at_count == 0 ? &tip : given->ats;
    const size_t count = given->at_count == 0 ? 1 : given->at_count;
    record_series series = { 0 };
    int code = EXIT_DONE;
    record_series_begin(&series, series_columns(self->scene));
    if (count > CONVERGE_QUANTITIES / 3) {
        return usage_error(&verb_converge, "more than %d quantities",
                           CONVERGE_QUANTITIES / 3);
    }
    for (size_t i = 0; i < count && code == EXIT_DONE; ++i) {
        code = add_quantity(self, &series, ats[i]);
    }
    return code;
}

bool converge_particle(const refinement *grid, const converge_quantity *one,
                       size_t *particle)
{
    size_t row, col;
    const bool found
        = refine_line(&grid->axis[0], one->index[0], one->half[0], &row)
          && refine_line(&grid->axis[1], one->index[1], one->half[1], &col);
    *particle = found ? row * grid->axis[1].refined + col : 0;
    return found;
}
