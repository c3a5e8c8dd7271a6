/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_arcsim.c -- a fabric fitted to the samples of an ARCSim material.
 *
 * `stretching` has four numbers c11, c12, c22, c33 [N/m], half of the moduli: at no
 * strain, and at a strain of 1/6 in five directions from the warp to the weft;
 * `bending` the coefficients of hinges [N m] that lie at 0, 45 and 90 degrees to the
 * warp, at five curvatures from 0 on (H. Wang, J. F. O'Brien, R. Ramamoorthi, ACM
 * Trans. Graph. 30(4), 71, 2011; dde.cpp and physics.cpp of R. Narain, A. Samii, J. F.
 * O'Brien, ACM Trans. Graph. 31(6), 152, 2012). weft's constants are exact without
 * strain and curvature, as those of its presets; the note says by how much the other
 * samples differ. */
#include <math.h>
#include <string.h>

#include "scene/checks.h"

enum { STRETCHES = 6, MODULI = 4, DIRECTIONS = 5, HINGES = 3, CURVATURES = 5 };

/* A hinge bends like a plate of a quarter of its coefficient. */
#define PLATE 0.25

typedef struct samples {
    const weft__node *stretch_node, *bend_node;
    const double *stretch, *bend; /* rows */
} samples;

/* The rows of a table; NULL: what is wrong was reported, or no memory. */
static const double *read_samples(weft__reader *reader, const weft__node *map,
                                  const weft__key *key, size_t rows, size_t width)
{
    char row[64];
    const weft__node *node = weft__value_of(map, key->name);
    if (node == NULL) {
        ERROR_AT(reader, map,
                 "the material lacks '%s', %zu rows of %zu numbers: an ARCSim material "
                 "has density, stretching and bending",
                 key->name, rows, width);
        return NULL;
    }
    if (weft__item_count(node) != rows) {
        ERROR_AT(reader, node, "%s has %zu rows, not %zu of %zu numbers", key->name,
                 weft__item_count(node), rows, width);
        return NULL;
    }
    (void)snprintf(row, sizeof row, "a row of %zu numbers [%s]", width, key->unit);
    return weft__read_table(reader, key, node, width, row);
}

static void warn_of_other_keys(weft__reader *reader, const weft__node *map)
{
    static const char *const known[] = { "density", "stretching", "bending" };
    for (size_t i = 0; i < map->count; ++i) {
        const weft__node *key = map->entries[i].key;
        bool read = false;
        for (size_t k = 0; k < sizeof known / sizeof *known; ++k) {
            read = read || strcmp(key->text, known[k]) == 0;
        }
        if (!read) {
            WARNING_AT(reader, key,
                       "'%.40s' is no key of an ARCSim material that weft "
                       "reads: density, stretching, bending",
                       key->text);
        }
    }
}

/* The value of the energy of a strain in direction k of five, from a row. */
static double along(const double *row, size_t k)
{
    static const double square[] = { 1.0, 0.8535533905932737, 0.5, 0.14644660940672624,
                                     0.0 }; /* of the cosine of 22.5 k degrees */
    const double c = square[k], s = 1.0 - c;
    return row[0] * c * c + 2.0 * (row[1] + row[3]) * c * s + row[2] * s * s;
}

typedef struct deviation {
    double least, most; /* of samples by the fit */
} deviation;

static void compare_sample(deviation *to, double sample, double fit)
{
    if (fit > 0.0) {
        to->least = fmin(to->least, sample / fit);
        to->most = fmax(to->most, sample / fit);
    }
}

static void note_fit(weft__reader *reader, const weft__node *map, const samples *of,
                     const weft_fabric *fit)
{
    deviation stretch = { INFINITY, -INFINITY }, bend = { INFINITY, -INFINITY };
    const double first[] = { 0.5 * fit->stretch[0], 0.5 * fit->coupling,
                             0.5 * fit->stretch[1], fit->shear };
    const double rigidity[]
        = { fit->bend[1], 0.25 * (fit->bend[0] + fit->bend[1]) + 0.5 * fit->twist,
            fit->bend[0] };
    for (size_t k = 0; k < DIRECTIONS; ++k) {
        compare_sample(&stretch, along(of->stretch + (k + 1) * MODULI, k),
                       along(first, k));
    }
    for (size_t i = 0; i < HINGES * CURVATURES; ++i) {
        compare_sample(&bend, PLATE * of->bend[i], rigidity[i / CURVATURES]);
    }
    weft__note_add(
        reader, "arcsim",
        "%.200s%sC %.5g and %.5g, G %.5g, C12 %.5g N/m; rigidity %.4g and %.4g, twist "
        "%.4g N m: exact at small strain; the samples at a strain of 1/6 are %.3g to "
        "%.3g times as stiff, those of all curvatures %.3g to %.3g times",
        map->at.in != NULL ? map->at.in->path : "", map->at.in != NULL ? ": " : "",
        fit->stretch[0], fit->stretch[1], fit->shear, fit->coupling, fit->bend[0],
        fit->bend[1], fit->twist, stretch.least, stretch.most, bend.least, bend.most);
}

/* [N/m] What ARCSim does where the data have no elastic energy. */
static double coupling_of(weft__reader *reader, const samples *of)
{
    const double *row = of->stretch;
    if (row[1] < 0.0 && row[1] * row[1] >= row[0] * row[2]) {
        WARNING_AT(reader, weft__item(weft__item(of->stretch_node, 0), 1),
                   "C12 of %g N/m has no elastic energy beside C of %g and %g N/m: it "
                   "counts as 0, as negative values do in ARCSim",
                   2.0 * row[1], 2.0 * row[0], 2.0 * row[2]);
        return 0.0;
    }
    return 2.0 * row[1];
}

static void fit_fabric(weft__reader *reader, const samples *of, weft_fabric *fabric)
{
    const double *row = of->stretch, *bend = of->bend;
    for (size_t k = 0; k < 3; k += 2) {
        if (!(row[k] > 0.0)) {
            ERROR_AT(reader, weft__item(weft__item(of->stretch_node, 0), k),
                     "the modulus of %s at no strain must be > 0, not %g",
                     k == 0 ? "the warp" : "the weft", row[k]);
        }
    }
    fabric->stretch[0] = 2.0 * row[0];
    fabric->stretch[1] = 2.0 * row[2];
    fabric->coupling = coupling_of(reader, of);
    fabric->shear = fmax(0.0, row[3]);
    fabric->bend[0] = PLATE * fmax(0.0, bend[2 * CURVATURES]);
    fabric->bend[1] = PLATE * fmax(0.0, bend[0]);
    fabric->twist = fmax(0.0, 2.0 * PLATE * bend[CURVATURES]
                                  - 0.5 * (fabric->bend[0] + fabric->bend[1]));
}

void weft__read_arcsim(weft__reader *reader, const weft__key *key,
                       const weft__node *node, void *to)
{
    static const weft__number above = { .strict = true };
    static const weft__key density = {
        .name = "density", .kind = WEFT__NUMBER, .number = &above, .unit = "kg/m^2"
    };
    static const weft__key stretching = { .name = "stretching", .unit = "N/m" };
    static const weft__key hinges = { .name = "bending", .unit = "N m" };
    const size_t before = reader->report->mistakes;
    weft_fabric *fabric = to;
    samples of;
    if (node->type != WEFT__MAP) {
        if (reader->report->mistakes == before && weft__text_of(node) == NULL) {
            weft__refuse_value(reader, key, node);
        }
        return;
    }
    warn_of_other_keys(reader, node);
    const weft__node *mass = weft__value_of(node, "density");
    if (mass == NULL) {
        ERROR_AT(reader, node, "the material lacks 'density' [kg/m^2]%s",
                 weft__value_of(node, "data") != NULL
                     ? ": give the file that its 'data' names"
                     : "");
    } else {
        (void)weft__read_number(reader, &density, "density", mass, &fabric->density);
    }
    of = (samples){ weft__value_of(node, "stretching"), weft__value_of(node, "bending"),
                    read_samples(reader, node, &stretching, STRETCHES, MODULI),
                    read_samples(reader, node, &hinges, HINGES, CURVATURES) };
    if (reader->report->mistakes == before && of.stretch != NULL && of.bend != NULL) {
        fit_fabric(reader, &of, fabric);
        note_fit(reader, node, &of, fabric);
    }
}
