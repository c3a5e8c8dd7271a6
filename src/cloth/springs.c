/* SPDX-License-Identifier: BSD-3-Clause */
/* springs.c -- stretch, shear and bend springs of a grid; their law is in springs.h. */
#include "cloth/springs.h"

static bool starts_at(const weft_cloth *cloth, const weft__group *group, size_t i)
{
    const size_t r = i / cloth->cols, c = i % cloth->cols;
    return r < group->end_row && c >= group->first_col && c < group->end_col;
}

size_t weft__particle_springs(const weft_cloth *cloth, size_t i, const double *x,
                              weft__spring springs[WEFT__SPRINGS_MAX])
{
    size_t count = 0;
    for (size_t g = 0; g < cloth->group_count; ++g) {
        const weft__group *group = &cloth->groups[g];
        const size_t stride = (size_t)group->stride;
        if (starts_at(cloth, group, i)) {
            springs[count++] = weft__spring_from(cloth, group, i, x);
        }
        if (i >= stride && starts_at(cloth, group, i - stride)) {
            springs[count++] = weft__spring_from(cloth, group, i - stride, x);
        }
    }
    return count;
}

/* [N] of one of them on p, or its derivative. */
static void spring_force(const weft_cloth *cloth, const weft__spring *at,
                         const double *y, const double *along, double pull[3])
{
    const double *v = y + 3 * cloth->particles;
    double w[3], dd[3], dw[3];
    if (along == NULL) {
        const double tension
            = weft__spring_tension(at, weft__spring_rate(cloth, at, v));
        for (size_t k = 0; k < 3; ++k) {
            pull[k] = tension * at->d[k];
        }
        return;
    }
    weft__spring_difference(cloth, at, v, w);
    weft__spring_difference(cloth, at, along, dd);
    weft__spring_difference(cloth, at, along + 3 * cloth->particles, dw);
    weft__spring_change(at, w, dd, dw, pull);
}

/* The order of summation is part of the result, and that of src/kernel/kernel.c. */
void weft__springs_force(const weft_cloth *cloth, size_t i, const double *y,
                         const double *along, double force[3])
{
    enum { RIGHT, DOWN, CROSS, ANTI, RIGHT2, DOWN2 }; /* as in directions */
    double from[WEFT_GROUPS][3] = { 0 }, to[WEFT_GROUPS][3] = { 0 }; /* [N] on p */
    weft__spring springs[WEFT__SPRINGS_MAX];
    const size_t count = weft__particle_springs(cloth, i, y, springs);
    for (const weft__spring *at = springs; at < springs + count; ++at) {
        spring_force(cloth, at, y, along, (at->p == i ? from : to)[at->group->way]);
    }
    for (size_t k = 0; k < 3; ++k) {
        const double begun = from[RIGHT][k] + from[DOWN][k] + from[CROSS][k]
                             + from[RIGHT2][k] + from[DOWN2][k];
        const double above = to[DOWN2][k] + (to[DOWN][k] + to[ANTI][k]) + to[CROSS][k];
        force[k] = begun - (above + (to[RIGHT][k] - from[ANTI][k]) + to[RIGHT2][k]);
    }
}

const char *weft_family_name(weft_family family)
{
    static const char *const names[WEFT_FAMILIES] = { "stretch", "shear", "bend" };
    return (unsigned)family < WEFT_FAMILIES ? names[family] : "unknown";
}

const char *weft_spring_text(const weft_spring *spring, size_t cols, char *text,
                             size_t size)
{
    cols = cols > 0 ? cols : SIZE_MAX;
    (void)snprintf(text, size, "%s spring (%zu, %zu)-(%zu, %zu)",
                   weft_family_name(spring->family), spring->p / cols, spring->p % cols,
                   spring->q / cols, spring->q % cols);
    return text;
}

/* The direction of a group: rows down, columns to the right (-1: to the left). */
typedef struct direction {
    weft_family family;
    size_t down;
    ptrdiff_t right;
} direction;

static const direction directions[WEFT_GROUPS] = {
    { WEFT_STRETCH, 0, 1 }, { WEFT_STRETCH, 1, 0 }, { WEFT_SHEAR, 1, 1 },
    { WEFT_SHEAR, 1, -1 },  { WEFT_BEND, 0, 2 },    { WEFT_BEND, 2, 0 },
};

bool weft__group_init(const weft_cloth *cloth, size_t way, weft__group *group)
{
    const direction *of = &directions[way];
    const size_t reach = of->right < 0 ? 1 : (size_t)of->right;
    *group = (weft__group){
        .family = of->family,
        .way = (unsigned)way,
        .end_row = cloth->rows - of->down,
        .first_col = of->right < 0 ? reach : 0,
        .end_col = of->right < 0 ? cloth->cols : cloth->cols - reach,
        .stride = (ptrdiff_t)(of->down * cloth->cols) + of->right,
    };
    return cloth->rows > of->down && cloth->cols > reach;
}

static void set_law(const weft_cloth *cloth, const weft_cloth_def *def,
                    weft__group *group)
{
    const weft_family family = group->family;
    const direction *way = &directions[group->way];
    const bool chain = cloth->rows == 1 || cloth->cols == 1;
    const weft_spring_def *spring = way->down == 0 && def->across[family].present
                                        ? &def->across[family]
                                        : &def->springs[family];
    const double across = cloth->spacing[1] * (double)way->right;
    const double along = cloth->spacing[0] * (double)way->down;
    group->rest_length = sqrt(across * across + along * along);
    group->stiffness = def->law == WEFT_LAW_STRAIN
                           ? spring->stiffness / group->rest_length
                           : spring->stiffness;
    group->damping = spring->damping;
    group->half_rim = def->rim_half && !chain && family != WEFT_SHEAR;
}

void weft__groups_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    cloth->group_count = 0;
    for (size_t way = 0; way < WEFT_GROUPS; ++way) {
        weft__group *next = &cloth->groups[cloth->group_count];
        if (def->springs[directions[way].family].present
            && weft__group_init(cloth, way, next)) {
            set_law(cloth, def, next);
            ++cloth->group_count;
        }
    }
}
