/* SPDX-License-Identifier: BSD-3-Clause */
/* start.c -- what check and run print of a scene's start: how far the cloth is
 * stretched there. */
#include <math.h>

#include "program/record/yaml_out.h"
#include "program/survey/survey.h"

/* "the triangle of vertices 3, 4, 5" */
static void say_triangle(sentence *text, const char *before, const size_t at[3])
{
    say(text, "%s%zu, %zu, %zu", before, at[0], at[1], at[2]);
}

/* To the four digits that would be printed. */
static bool at_rest(const weft_stretch *of)
{
    return of->least > 1.0 - 5e-5 && of->largest < 1.0 + 5e-5;
}

static void print_part(const weft_cloth_def *def, size_t part, bool first)
{
    const weft_mesh_def *mesh = def->mesh;
    weft_stretch of;
    sentence text = { "" };
    if (weft_cloth_def_stretch(def, part, &of, NULL) != WEFT_OK
        || (of.triangles == 0 && of.median == 1.0)) {
        return; /* a grid that starts at rest, or no memory for a line of text */
    }
    if (mesh != NULL && mesh->part_count > 0) {
        say(&text, "%s: ", mesh->parts[part].name);
    }
    if (at_rest(&of)) {
        say(&text, "none: the cloth starts with its rest lengths");
        print_item(first ? "stretch" : "", "%s", text.text);
        return;
    }
    say(&text, "%.4g to %.4g of the rest lengths at the start, median %.4g; ", of.least,
        of.largest, of.median);
    if (of.triangles == 0) {
        say(&text, "all springs alike");
    } else {
        say_triangle(&text, "least in the triangle of vertices ", of.least_at);
        say_triangle(&text, ", most in that of ", of.largest_at);
    }
    print_item(first ? "stretch" : "", "%s", text.text);
}

void start_print_stretch(const weft_cloth_def *def)
{
    const size_t parts = def->mesh != NULL ? def->mesh->part_count : 0;
    for (size_t k = 0; k == 0 || k < parts; ++k) {
        print_part(def, k, k == 0);
    }
}

void start_yaml(yaml_out *out, const weft_cloth_def *def)
{
    const size_t parts = def->mesh != NULL ? def->mesh->part_count : 0;
    yaml_out_write(out, "stretch: [");
    for (size_t k = 0; k == 0 || k < parts; ++k) {
        weft_stretch of;
        if (weft_cloth_def_stretch(def, k, &of, NULL) == WEFT_OK) {
            yaml_out_write(out, "{ least: %g, median: %g, largest: %g }", of.least,
                           of.median, of.largest);
        }
    }
    yaml_out_write(out, "]");
}
