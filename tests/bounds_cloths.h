/* SPDX-License-Identifier: BSD-3-Clause */
/* bounds_cloths.h -- thirteen cloths for tests of the bounds: small enough for a dense
 * eigensolver, each with a difficulty of its own. */
#pragma once

#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CORNER(r, c)                                                                   \
    {                                                                                  \
        .rows = { r, r }, .cols = { c, c }                                             \
    }
#define ALL                                                                            \
    {                                                                                  \
        0, -1                                                                          \
    }

static const weft_pin corners[] = { CORNER(0, 0), CORNER(0, -1) };
static const weft_pin rim[] = { { .rows = { 0, 0 }, .cols = ALL },
                                { .rows = { -1, -1 }, .cols = ALL },
                                { .rows = ALL, .cols = { 0, 0 } },
                                { .rows = ALL, .cols = { -1, -1 } } };
static const weft_load loads[]
    = { { .rows = { 3, 3 }, .cols = { 2, 2 }, .mass = 0.05 },
        { .rows = { 0, 1 }, .cols = { 4, 4 }, .mass = 1e-3 } };

/* All of them at rest in equilibrium: without gravity. */
static const weft_cloth_def cloths[] = {
    /* stretch springs alone, equal masses */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { .present = true, .stiffness = 100 } } },
    /* two families, more columns than rows, pinned corners */
    { .rows = 6,
      .cols = 8,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .pins = corners,
      .pin_count = 2,
      .springs = { { .present = true, .stiffness = 100 },
                   { .present = true, .stiffness = 50 } } },
    /* all three families */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { .present = true, .stiffness = 100 },
                   { .present = true, .stiffness = 100 },
                   { .present = true, .stiffness = 100 } } },
    /* oblong cells, masses of a half and a quarter on the rim */
    { .rows = 7,
      .cols = 6,
      .spacing = { 0.05, 0.1 },
      .density = 0.2,
      .springs = { { .present = true, .stiffness = 100 },
                   { .present = true, .stiffness = 50 },
                   { .present = true, .stiffness = 5 } } },
    /* loads */
    { .rows = 7,
      .cols = 6,
      .spacing = { 0.1, 0.1 },
      .density = 0.2,
      .loads = loads,
      .load_count = 2,
      .springs = { { .present = true, .stiffness = 100 },
                   { .present = true, .stiffness = 50 } } },
    /* taut in a frame */
    { .rows = 8,
      .cols = 8,
      .spacing = { 0.1, 0.1 },
      .scale = 1.2,
      .mass = 1e-3,
      .pins = rim,
      .pin_count = 4,
      .springs = { { .present = true, .stiffness = 100, .damping = 0.02 },
                   { .present = true, .stiffness = 50, .damping = 0.01 } } },
    /* the strain law, damped alike along columns and rows but not diagonals */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .law = WEFT_LAW_STRAIN,
      .pins = corners,
      .pin_count = 2,
      .springs = { { .present = true, .stiffness = 10, .damping = 0.05 },
                   { .present = true, .stiffness = 5, .damping = 0.05 } } },
    /* damping in proportion to stiffness */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .density = 0.2,
      .pins = corners,
      .pin_count = 2,
      .springs = { { .present = true, .stiffness = 100, .damping = 0.2 },
                   { .present = true, .stiffness = 50, .damping = 0.1 },
                   { .present = true, .stiffness = 5, .damping = 0.01 } } },
    /* damping of one family only */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { .present = true, .stiffness = 100, .damping = 0.1 },
                   { .present = true, .stiffness = 60 } } },
    /* over-damped springs */
    { .rows = 7,
      .cols = 7,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .springs = { { .present = true, .stiffness = 100, .damping = 1.5 },
                   { .present = true, .stiffness = 50, .damping = 0.75 } } },
    /* a chain, and the drag of treacle */
    { .rows = 1,
      .cols = 30,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .damping = 1.0,
      .springs = { { .present = true, .stiffness = 100 } } },
    /* a chain with bend springs and drag */
    { .rows = 1,
      .cols = 30,
      .spacing = { 0.1, 0.1 },
      .mass = 1e-3,
      .damping = 0.1,
      .springs = { { .present = true, .stiffness = 100, .damping = 0.05 },
                   { .present = false },
                   { .present = true, .stiffness = 30, .damping = 0.01 } } },
    /* warp and weft that differ, a rim that carries half */
    { .rows = 6,
      .cols = 7,
      .spacing = { 0.1, 0.08 },
      .density = 0.2,
      .pins = corners,
      .pin_count = 2,
      .rim_half = true,
      .across = { { .present = true, .stiffness = 40, .damping = 0.008 } },
      .springs = { { .present = true, .stiffness = 100, .damping = 0.02 },
                   { .present = true, .stiffness = 20, .damping = 0.004 } } },
};

enum { CLOTHS = sizeof cloths / sizeof cloths[0] };

/* Rigidity instead of bend springs, as stiff as the others and damped or not: nothing
 * but bending, the default twist, a larger one. */
static inline void bend(weft_cloth_def *def, size_t i)
{
    const double a = def->rows > 1 ? def->spacing[0] : 1.0, b = def->spacing[1];
    const double along = i % 2 ? 20.0 : 60.0, across = i % 3 ? 30.0 : 10.0; /* [N/m] */
    def->springs[WEFT_BEND].present = false;
    def->springs[WEFT_SHEAR].present = def->springs[WEFT_SHEAR].present && i % 5 != 0;
    def->springs[WEFT_STRETCH].present = i % 4 != 3;
    def->bending.rigidity[0] = along * a * a * a / b;
    def->bending.rigidity[1] = across * b * b * b / a;
    def->bending.twist = i % 3 == 1 ? 20.0 * a * b : -1.0;
    def->bending.damping = i % 2 ? 1e-3 * (double)i : 0.0;
}

/* Cloths from CLOTHS on are these again on a plane that approaches them, from 2 CLOTHS
 * on slides as well, and from 3 CLOTHS on with rigidity instead. */
static inline weft_cloth *make(size_t i)
{
    const weft_cloth_def usual = weft_cloth_def_default();
    weft_cloth_def def = cloths[i % CLOTHS];
    weft_shape plane = weft_shape_default(WEFT_PLANE);
    plane.normal[1] = 0.0, plane.normal[2] = 1.0, plane.at[2] = -8e-3;
    plane.velocity[0] = i < 2 * CLOTHS ? 0.0 : 0.3, plane.velocity[2] = 0.5;
    def.struct_size = usual.struct_size, def.load_size = usual.load_size;
    def.pin_size = usual.pin_size, def.shape_size = usual.shape_size;
    def.contact = usual.contact;
    def.contact.thickness = 0.02, def.contact.slip = 0.1;
    def.contact.shapes = &plane;
    def.contact.shape_count = i < CLOTHS || i >= 3 * CLOTHS ? 0 : 1;
    if (i >= 3 * CLOTHS) {
        bend(&def, i - 3 * CLOTHS);
    }
    memcpy(def.right, usual.right, sizeof def.right);
    memcpy(def.down, usual.down, sizeof def.down);
    def.scale = def.scale == 0.0 ? 1.0 : def.scale;
    return test_cloth(&def);
}

/* In (-1, 1). */
static inline double noise(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*seed >> 11) * 0x1p-52 - 1.0;
}
