/* SPDX-License-Identifier: BSD-3-Clause */
/* fabric.c -- measured fabrics: the springs that have their moduli, the moduli that
 * springs have, and presets. */
#include "base/sized.h"
#include "cloth/model.h"
#include "mesh/grid_def.h"
#include "weft/elementary.h"

#include <string.h>

const struct weft__fabric_numbers weft__fabric_numbers = {
    WEFT__FIELD(weft_fabric, density, "kg/m^2", .strict = true),
    WEFT__FIELD(weft_fabric, stretch, "N/m", .count = 2, .strict = true),
    WEFT__FIELD(weft_fabric, shear, "N/m", .least = 0.0),
    WEFT__FIELD(weft_fabric, bend, "N m", .count = 2, .least = 0.0),
    WEFT__FIELD(weft_fabric, twist, "N m", .least = -HUGE_VAL),
    WEFT__FIELD(weft_fabric, damping, "s", .count = 2, .least = 0.0),
    WEFT__FIELD(weft_fabric, coupling, "N/m", .least = -HUGE_VAL),
};

/* H. Wang, J. F. O'Brien, R. Ramamoorthi, Data-driven elastic models for cloth, ACM
 * Trans. Graph. 30(4), 71 (2011). Its bending coefficients ke belong to hinges of
 * energy ke l^2 / (2 (A1 + A2)) theta^2 / 4, which bend like plates of rigidity ke / 4.
 * Its row 0 is that of edges along the warp, which bend the weft. */
#define PRESET(name, density, warp, weft, shear, bend_warp, bend_weft, twist,          \
               coupling)                                                               \
    {                                                                                  \
        name, density, { warp, weft }, shear,                                          \
            { (bend_warp) / 1e6, (bend_weft) / 1e6 }, (twist) / 1e6, { 0.0, 0.0 },     \
            coupling                                                                   \
    }

/* kg/m^2; N/m of warp, weft, shear; 1e-6 N m of warp, weft, twist; N/m of coupling,
 * from the files of ARCSim (twice row 0), R. Narain, A. Samii, J. F. O'Brien, ACM
 * Trans. Graph. 31(6), 152 (2012): negative where the fit of a knit gave that */
static const weft_fabric presets[] = {
    PRESET("tango-red-jet-set", 0.113, 86.0, 343.0, 14.3, 5.0, 3.5, 6.8, 108.7),
    PRESET("white-dots-on-blk", 0.128, 4004.0, 4055.0, 19.2, 7.8, 13.0, 10.1, 0.7),
    PRESET("gray-interlock", 0.187, 33.0, 69.0, 36.9, 3.5, 5.8, 7.9, -29.4),
    PRESET("white-swim-solid", 0.204, 96.0, 209.0, 60.8, 12.8, 15.0, 15.6, 13.7),
    PRESET("royal-target", 0.220, 4033.0, 4070.0, 104.8, 31.3, 31.3, 22.8, 18.3),
    PRESET("pink-ribbon-brown", 0.228, 303.0, 490.0, 30.3, 15.0, 29.3, 21.9, 212.1),
    PRESET("ivory-rib-knit", 0.276, 86.0, 130.0, 83.2, 8.0, 11.5, 5.3, -0.5),
    PRESET("camel-ponte-roma", 0.284, 62.0, 88.0, 31.9, 9.3, 9.0, 7.4, -25.6),
    PRESET("11oz-black-denim", 0.324, 411.0, 2028.0, 53.4, 24.3, 16.0, 16.4, 20.5),
};

const weft_fabric *weft_fabric_presets(size_t *count)
{
    *count = sizeof presets / sizeof presets[0];
    return presets;
}

const weft_fabric *weft_fabric_find(const char *name)
{
    for (size_t i = 0; i < sizeof presets / sizeof presets[0]; ++i) {
        if (strcmp(presets[i].name, name) == 0) {
            return &presets[i];
        }
    }
    return NULL;
}

/* ---- springs of a fabric --------------------------------------------------------- */

static bool is_chain(const weft_cloth_def *def)
{
    return def->rows == 1 || def->cols == 1;
}

/* Whether springs can have these moduli at the spacings of a grid; to roundoff. */
static weft_status check_ratio(const weft_fabric *fabric, const weft_cloth_def *def,
                               weft_error *err)
{
    const double warp = fabric->stretch[0], weft = fabric->stretch[1];
    const double shear = fabric->shear, ratio = def->spacing[1] / def->spacing[0];
    const double least = sqrt(shear / warp), most = sqrt(weft / shear);
    if (is_chain(def)
        || (ratio >= least * (1.0 - 1e-12) && ratio <= most * (1.0 + 1e-12))) {
        return WEFT_OK;
    }
    if (least > most) {
        return weft_error_set(
            err, WEFT_INVALID,
            "no ratio of spacings makes this fabric of springs: shear "
            "%g N/m is above sqrt(%g * %g) N/m of stretch",
            shear, warp, weft);
    }
    const double middle = def->spacing[0] * sqrt(least * most);
    const double inward = 5e-6; /* so that the ends as they are printed are possible */
    return weft_error_set(
        err, WEFT_INVALID,
        "spacing [a, b] = [%g, %g] m has b / a = %.6g; springs make this fabric for b "
        "/ a from %.6g to %.6g: sqrt(shear / stretch[0]) to sqrt(stretch[1] / shear), "
        "such as [%g, %.*g]",
        def->spacing[0], def->spacing[1], ratio, least * (1.0 + inward),
        most * (1.0 - inward), def->spacing[0], most / least > 1.02 ? 3 : 6, middle);
}

static weft_status fabric_check(const weft_fabric *fabric, const weft_cloth_def *def,
                                weft_error *err)
{
    weft__refusal first = { WEFT_OK, err };
    const weft__faults to = { weft__keep_first, &first };
    if (!WEFT_HAS(def, weft_cloth_def, across)) {
        return weft_error_set(err, WEFT_INVALID,
                              "weft_cloth_def: struct_size is %u; start from "
                              "weft_cloth_def_default()",
                              (unsigned)def->struct_size);
    }
    (void)WEFT__NUMBERS_CHECK(weft__fabric_numbers, fabric, &to, "fabric: ");
    (void)weft__numbers_check((const weft__number *)&weft__grid_numbers, 3, def, &to,
                              "%s", "");
    return first.status == WEFT_OK ? check_ratio(fabric, def, err) : first.status;
}

static weft_spring_def springs_of(bool present, double stiffness, double damping)
{
    return (weft_spring_def){ .present = present,
                              .stiffness = stiffness,
                              .damping = damping * stiffness };
}

weft_status weft_fabric_apply(const weft_fabric *fabric, weft_cloth_def *def,
                              weft_error *err)
{
    TRY(weft__given(fabric, def, "weft_fabric_apply", err));
    TRY(fabric_check(fabric, def, err));
    const bool chain = is_chain(def);
    const double a = weft__width(def->rows, def->spacing[0]);
    const double b = weft__width(def->cols, def->spacing[1]);
    const double shear = chain ? 0.0 : fabric->shear, damping = fabric->damping[0];
    const double column = fabric->stretch[0] * b / a - shear * a / b;
    const double row = fabric->stretch[1] * a / b - shear * b / a;
    const double across = shear * (a * a + b * b) / (2.0 * a * b);
    const bool any = column > 0.0 || row > 0.0;
    def->mass = 0.0;
    def->density = fabric->density;
    def->law = WEFT_LAW_HOOKE;
    def->rim_half = true;
    memset(def->springs, 0, sizeof def->springs);
    memset(def->across, 0, sizeof def->across);
    def->springs[WEFT_STRETCH] = springs_of(any, fmax(0.0, column), damping);
    def->across[WEFT_STRETCH]
        = springs_of(any && column != row, fmax(0.0, row), damping);
    def->springs[WEFT_SHEAR] = springs_of(across > 0.0, across, damping);
    def->bending = (weft_bending_def){ { fabric->bend[0], fabric->bend[1] },
                                       fabric->twist,
                                       fabric->damping[1] };
    return WEFT_OK;
}

/* ---- the fabric of springs ------------------------------------------------------ */

/* Adds the moduli of a group: springs of direction n and elongation s n.E n have the
 * energy k s^2 (n.E n)^2 / 2 each at a homogeneous strain E. */
static void fabric_add_group(const weft__mesh *grid, const weft__group *group,
                             double area, weft_fabric *to)
{
    const size_t lines = group->end_row, each = group->end_col - group->first_col;
    const double down = (double)(grid->rows - lines) * grid->spacing[0];
    const double right = (double)(grid->cols - each) * grid->spacing[1];
    const size_t rims = !group->half_rim ? 0 : down == 0.0 ? each : lines;
    const double count = (double)(lines * each - rims); /* two rims, half of each */
    const double length = group->rest_length;
    const double k = group->stiffness * count * length * length / area;
    const double n0 = down / length * (down / length);
    const double n1 = right / length * (right / length);
    to->stretch[0] += k * n0 * n0;
    to->stretch[1] += k * n1 * n1;
    to->shear += k * n0 * n1;
}

weft_fabric weft_fabric_of(const weft_cloth_def *def)
{
    weft__mesh grid = { .rows = 0 };
    weft__springs springs = { .mesh = &grid };
    weft_cloth_def whole = *def;
    whole.band_rows = 0;
    weft__grid_init(&grid, &whole);
    weft__groups_init(&springs, &whole);
    const double a = weft__width(def->rows, def->spacing[0]);
    const double b = weft__width(def->cols, def->spacing[1]);
    const double down = weft__width(def->rows, (double)(def->rows - 1) * a);
    const double right = weft__width(def->cols, (double)(def->cols - 1) * b);
    const weft_bending_def *bending = &def->bending;
    weft_fabric fabric
        = { .density = def->density > 0.0 ? def->density : def->mass / (a * b),
            .bend = { bending->rigidity[0], bending->rigidity[1] },
            .twist = weft__twist_of(bending) };
    for (size_t g = 0; g < springs.group_count; ++g) {
        fabric_add_group(&grid, &springs.groups[g], down * right, &fabric);
    }
    fabric.coupling = fabric.shear;
    return fabric;
}

double weft_fabric_length(const weft_fabric *fabric, size_t way, double gravity)
{
    const double force = fabric->density * gravity;
    return force > 0.0 ? weft_pow(fabric->bend[way] / force, 1.0 / 3.0) : 0.0;
}
