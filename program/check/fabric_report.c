/* SPDX-License-Identifier: BSD-3-Clause */
/* fabric_report.c -- weft check: the springs of a fabric, and the fabric of springs;
 * nothing for a cloth without a fabric or bending rigidity. */
#include <math.h>

#include "program/reports.h"
#include "program/survey/survey.h"

extern const report_section fabric_report;

typedef struct report {
    weft_fabric fabric; /* of the springs, or of triangles */
    double length[2];   /* [m] Peirce's, 0: none */
    double edge[2];     /* [m] the spacing; of triangles the mean edge */
    double area;        /* [m^2] of its triangles */
    const char *cloth;  /* of several, "" of one */
    bool coarse[2];     /* the spacing is above half of it, the edge above a quarter */
} report;

static void set_length(report *out, size_t k, const weft_cloth_def *def, double part)
{
    const double *g = def->gravity;
    out->length[k] = weft_fabric_length(&out->fabric, k,
                                        sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
    out->coarse[k] = out->length[k] > 0.0 && out->edge[k] > part * out->length[k];
}

/* Of its triangles; none has it: edges of 0. */
static report mesh_report(const weft_cloth_def *def, size_t fabric)
{
    const weft_mesh_def *mesh = def->mesh;
    double sum = 0.0, count = 0.0, area = 0.0;
    const char *cloth = "";
    for (size_t t = 0; t < mesh->triangles; ++t) {
        const rest_triangle at = rest_triangle_of(mesh, t);
        if ((mesh->fabric_of != NULL ? mesh->fabric_of[t] : 0) == fabric) {
            area += rest_area(&at);
            cloth = cloth_of(mesh, mesh->corners[3 * t]);
            for (size_t k = 0; k < 3; ++k, count += 1.0) {
                const double *a = at.corners[k], *b = at.corners[(k + 1) % 3];
                sum += hypot(b[0] - a[0], b[1] - a[1]);
            }
        }
    }
    const double edge = count > 0.0 ? sum / count : 0.0;
    report out = { .fabric = mesh->fabrics[fabric],
                   .edge = { edge, edge },
                   .area = area,
                   .cloth = cloth };
    set_length(&out, 0, def, 0.25);
    set_length(&out, 1, def, 0.25);
    return out;
}

/* false: there is nothing to report. */
static bool report_of(const weft_scene *scene, report *out)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
    const double *bend = def->bending.rigidity;
    *out = (report){ .fabric = weft_fabric_of(def),
                     .edge = { def->rows > 1 ? def->spacing[0] : 0.0,
                               def->cols > 1 ? def->spacing[1] : 0.0 } };
    set_length(out, 0, def, 0.5);
    set_length(out, 1, def, 0.5);
    return weft_scene_fabric(scene) != NULL || bend[0] > 0.0 || bend[1] > 0.0
           || def->bending.twist > 0.0;
}

static void print_least(const char *item, const char *format, double least,
                        const weft_mesh_def *mesh, size_t triangle)
{
    char number[HUMAN_SIZE];
    size_t name[3];
    for (size_t k = 0; k < 3; ++k) {
        const size_t vertex = mesh->corners[3 * triangle + k];
        name[k] = mesh->file_index != NULL ? mesh->file_index[vertex] : vertex;
    }
    (void)snprintf(number, sizeof number, format, least);
    const char *cloth = cloth_of(mesh, mesh->corners[3 * triangle]);
    print_item(
        item, "%s or more at rest, in the triangle of vertices %zu, %zu, %zu%s%s",
        number, name[0], name[1], name[2], cloth[0] != '\0' ? " of " : "", cloth);
}

/* The smallest angle and height at rest, and their triangles. */
static void print_triangles(const weft_mesh_def *mesh)
{
    double least = 180.0, low = (double)INFINITY;
    size_t sharp = 0, flat = 0;
    for (size_t j = 0; j < 3 * mesh->triangles; ++j) {
        const rest_triangle at = rest_triangle_of(mesh, j / 3);
        const double *a = at.corners[j % 3], *b = at.corners[(j + 1) % 3],
                     *c = at.corners[(j + 2) % 3];
        const double u[] = { b[0] - a[0], b[1] - a[1] };
        const double v[] = { c[0] - a[0], c[1] - a[1] };
        const double angle = 180.0 / acos(-1.0)
                             * atan2(2.0 * rest_area(&at), u[0] * v[0] + u[1] * v[1]);
        const double height = 2.0 * rest_area(&at) / hypot(c[0] - b[0], c[1] - b[1]);
        sharp = angle < least ? j / 3 : sharp;
        flat = height < low ? j / 3 : flat;
        least = fmin(least, angle);
        low = fmin(low, height);
    }
    print_least("angles", "%.3g degrees", least, mesh, sharp);
    print_least("heights", "%.3g mm", 1e3 * low, mesh, flat);
}

/* Pieces, and what is sewn. */
static void print_pieces(const weft_cloth *cloth)
{
    size_t sewn;
    double length;
    sentence text = { "" };
    say(&text, "%zu", weft_cloth_panels(cloth, &sewn, &length));
    if (sewn > 0) {
        say(&text, ", sewn along %zu edges, %.4g m", sewn, length);
    }
    print_item("pieces", "%s", text.text);
}

/* What a cloth is that rests in space. */
static void print_space(const weft_cloth_def *def, size_t part)
{
    weft_rest_report of;
    sentence text = { "" };
    if (weft_cloth_def_rest(def, part, &of, NULL) != WEFT_OK || of.triangles == 0) {
        return;
    }
    say(&text, "in space: %zu part%s", of.pieces, of.pieces == 1 ? "" : "s");
    if (of.closed > 0) {
        say(&text, ", %zu closed", of.closed);
    }
    if (of.one_sided > 0) {
        say(&text, ", %zu one-sided", of.one_sided);
    }
    if (of.flipped > 0) {
        say(&text, ", %zu faces turned over (no side is needed)", of.flipped);
    }
    print_item("rest shape", "%s", text.text);
    print_item("", "sharpest fold %.3g degrees, along edge %zu-%zu",
               of.fold * 180.0 / acos(-1.0), of.fold_at[0], of.fold_at[1]);
    if (of.defect != 0.0) {
        print_item("", "largest angle defect %.3g degrees, at vertex %zu",
                   of.defect * 180.0 / acos(-1.0), of.defect_at);
    }
}

static void print_peirce(const report *of, const char *first, const char *second)
{
    if (of->length[0] > 0.0 || of->length[1] > 0.0) {
        print_item("", "Peirce length %.3g mm along %s, %.3g mm along %s",
                   1e3 * of->length[0], first, 1e3 * of->length[1], second);
    }
}

/* Of the lengths that are there. */
static double shorter(const double length[2])
{
    return length[0] > 0.0 && length[1] > 0.0 ? fmin(length[0], length[1])
                                              : fmax(length[0], length[1]);
}

static void print_mesh(const weft_cloth_def *def, const weft_cloth *cloth)
{
    print_pieces(cloth);
    for (size_t k = 0; k == 0 || k < def->mesh->part_count; ++k) {
        print_space(def, k);
    }
    if (def->mesh->triangles > 0) {
        print_triangles(def->mesh);
    }
    for (size_t i = 0; i < def->mesh->fabric_count; ++i) {
        const report of = mesh_report(def, i);
        const weft_fabric *fabric = &of.fabric;
        if (of.edge[0] == 0.0) {
            continue; /* no triangle has it */
        }
        print_item(
            "fabric",
            "%s%s%s%sC %.5g and %.5g, G %.5g, C12 %.5g N/m; rigidity %.4g and %.4g, "
            "twist %.4g N m; edges of %.3g mm, %.4g m^2",
            of.cloth, of.cloth[0] == '\0' ? "" : ": ",
            fabric->name == NULL ? "" : fabric->name, fabric->name == NULL ? "" : ": ",
            fabric->stretch[0], fabric->stretch[1], fabric->shear, fabric->coupling,
            fabric->bend[0], fabric->bend[1],
            fabric->twist < 0.0 ? sqrt(fabric->bend[0] * fabric->bend[1])
                                : fabric->twist,
            1e3 * of.edge[0], of.area);
        print_peirce(&of, "the warp", "the weft");
        if (of.coarse[0] || of.coarse[1]) {
            print_item("advice",
                       "edges of %.3g mm are above a quarter of the Peirce length: too "
                       "coarse for the bends of this fabric; these take edges of at "
                       "most %.3g mm",
                       1e3 * of.edge[0], 0.25e3 * shorter(of.length));
        }
    }
}

static void fabric_print(const weft_scene *scene, const weft_cloth *cloth)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
    const weft_fabric *given = weft_scene_fabric(scene);
    const weft_spring_def *stretch = &def->springs[WEFT_STRETCH];
    const weft_spring_def *across
        = def->across[WEFT_STRETCH].present ? &def->across[WEFT_STRETCH] : stretch;
    const weft_spring_def *shear = &def->springs[WEFT_SHEAR];
    const char *name = given == NULL ? NULL : given->name;
    const bool sheet = def->rows > 1 && def->cols > 1;
    report of;
    if (def->mesh != NULL) {
        print_mesh(def, cloth);
        return;
    }
    if (!report_of(scene, &of)) {
        return;
    }
    print_item("fabric",
               "%s%sstretch springs %.5g along columns and %.5g along rows, shear "
               "springs %.5g %s%s",
               name == NULL ? "" : name, name == NULL ? "" : ": ", stretch->stiffness,
               across->stiffness, shear->stiffness,
               def->law == WEFT_LAW_HOOKE ? "N/m" : "N",
               def->rim_half && sheet ? ", half along the rim" : "");
    print_item("",
               "they make C11 %.5g, C22 %.5g, C12 = G %.5g N/m; rigidity %.4g and "
               "%.4g, twist %.4g N m",
               of.fabric.stretch[0], of.fabric.stretch[1], of.fabric.shear,
               of.fabric.bend[0], of.fabric.bend[1], of.fabric.twist);
    print_peirce(&of, "columns", "rows");
    for (size_t k = 0; k < 2; ++k) {
        if (of.coarse[k]) {
            print_item("advice",
                       "the spacing of %g mm along %s is above half the Peirce length: "
                       "too coarse for the bends of this fabric; these take a spacing "
                       "of at most %.3g mm",
                       1e3 * def->spacing[k], k == 0 ? "columns" : "rows",
                       0.5e3 * of.length[k]);
        }
    }
}

static void write_report(yaml_out *out, const report *of)
{
    yaml_out_write(
        out,
        "c11: %g, c22: %g, c12: %g, shear: %g, bend_warp: %g, bend_weft: %g, "
        "twist: %g, length_warp: %g, length_weft: %g, coarse: %s }",
        of->fabric.stretch[0], of->fabric.stretch[1], of->fabric.coupling,
        of->fabric.shear, of->fabric.bend[0], of->fabric.bend[1], of->fabric.twist,
        of->length[0], of->length[1], yaml_bool(of->coarse[0] || of->coarse[1]));
}

static void fabric_yaml(yaml_out *out, const weft_scene *scene)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
    report of;
    if (def->mesh != NULL) {
        yaml_out_write(out, "fabrics: [");
        for (size_t i = 0; i < def->mesh->fabric_count; ++i) {
            of = mesh_report(def, i);
            yaml_out_write(out, "{ edge: %g", of.edge[0]);
            if (of.cloth[0] != '\0') {
                yaml_out_write(out, "cloth: \"%s\"", of.cloth);
            }
            write_report(out, &of);
        }
        yaml_out_write(out, "]");
    } else if (report_of(scene, &of)) {
        yaml_out_write(out, "fabric: {");
        write_report(out, &of);
    }
}

const report_section fabric_report
    = { .check = fabric_print, .check_yaml = fabric_yaml };
