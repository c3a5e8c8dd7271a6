/* SPDX-License-Identifier: BSD-3-Clause */
/* fabric_report.c -- weft check: a fabric and its springs. */
#include <math.h>

#include "cli/check/check.h"

typedef struct report {
    weft_fabric fabric; /* of the springs */
    double length[2];   /* [m] Peirce's, 0: none */
    bool coarse[2];     /* the spacing is above half of it */
} report;

/* false: there is nothing to report. */
static bool report_of(const weft_scene *scene, report *out)
{
    const weft_cloth_def *def = weft_scene_cloth(scene);
    const double *g = def->gravity, *bend = def->bending.rigidity;
    const size_t neighbours[2] = { def->rows - 1, def->cols - 1 };
    *out = (report){ .fabric = weft_fabric_of(def) };
    for (size_t k = 0; k < 2; ++k) {
        out->length[k] = weft_fabric_length(
            &out->fabric, k, sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
        out->coarse[k] = neighbours[k] > 0 && out->length[k] > 0.0
                         && def->spacing[k] > 0.5 * out->length[k];
    }
    return weft_scene_fabric(scene) != NULL || bend[0] > 0.0 || bend[1] > 0.0
           || def->bending.twist > 0.0;
}

void fabric_print(const weft_scene *scene)
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
    if (of.length[0] > 0.0 || of.length[1] > 0.0) {
        print_item("", "Peirce length %.3g mm along columns, %.3g mm along rows",
                   1e3 * of.length[0], 1e3 * of.length[1]);
    }
    for (size_t k = 0; k < 2; ++k) {
        if (of.coarse[k]) {
            print_item("warning",
                       "the spacing of %g mm along %s is above half the Peirce length: "
                       "too coarse for the bends of this fabric",
                       1e3 * def->spacing[k], k == 0 ? "columns" : "rows");
        }
    }
}

void fabric_yaml(yaml_out *out, const weft_scene *scene)
{
    report of;
    if (!report_of(scene, &of)) {
        return;
    }
    yaml_out_map(out, "fabric");
    yaml_out_real(out, "c11", of.fabric.stretch[0]);
    yaml_out_real(out, "c22", of.fabric.stretch[1]);
    yaml_out_real(out, "c12", of.fabric.shear);
    yaml_out_real(out, "shear", of.fabric.shear);
    yaml_out_real(out, "bend_warp", of.fabric.bend[0]);
    yaml_out_real(out, "bend_weft", of.fabric.bend[1]);
    yaml_out_real(out, "twist", of.fabric.twist);
    yaml_out_real(out, "length_warp", of.length[0]);
    yaml_out_real(out, "length_weft", of.length[1]);
    yaml_out_plain(out, "coarse", of.coarse[0] || of.coarse[1] ? "true" : "false");
    yaml_out_close_map(out);
}
