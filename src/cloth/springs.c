/* SPDX-License-Identifier: BSD-3-Clause */
/* springs.c -- stretch, shear and bend springs of a grid.
 *
 * A spring from p to q, of rest length s [m], stiffness k [N/m] and damping
 * c [kg/s], pulls p by T u and q by -T u, where
 *
 *     T = k (L - s) + c w.u,   d = x_q - x_p,  L = |d|,  u = d / L,  w = v_q - v_p
 *
 * and by nothing where L = 0. The strain law T = K (L / s - 1) is the same with
 * k = K / s. The elastic part is -dE/dx of E = k (L - s)^2 / 2; the damped part acts
 * along the spring only, so that both kinds of momentum stay. The three families are
 * those of Provot 1995; the damped law is the one of the lecture (docs/physics.md). */
#include "cloth/model.h"

#include <math.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

weft__stance weft__spring_stance(size_t particles, size_t p, size_t q, const double *y)
{
    const double *x = y, *v = y + 3 * particles;
    weft__stance at;
    for (size_t k = 0; k < 3; ++k) {
        at.d[k] = x[k * particles + q] - x[k * particles + p];
        at.w[k] = v[k * particles + q] - v[k * particles + p];
    }
    at.length = sqrt(dot(at.d, at.d));
    return at;
}

size_t weft__group_springs(const weft__group *group)
{
    return group->end_row * (group->end_col - group->first_col);
}

static void add_pull(const weft_cloth *cloth, const weft__group *group, size_t p,
                     const double *y, double *f)
{
    const size_t n = cloth->particles;
    const size_t q = p + (size_t)group->stride;
    const weft__stance at = weft__spring_stance(n, p, q, y);

    /* u is undefined at L = 0. NaN passes, for the RHS to find and refuse. */
    if (at.length == 0.0) {
        return;
    }
    const double elastic = group->stiffness * (at.length - group->rest_length);
    const double damped = group->damping * dot(at.w, at.d) / at.length;
    const double scale = (elastic + damped) / at.length;
    for (size_t k = 0; k < 3; ++k) {
        const double pull = scale * at.d[k];
        f[k * n + p] += pull;
        f[k * n + q] -= pull;
    }
}

/* The order of the loops is the order of summation and part of the result. */
void weft__group_add_force(const weft_cloth *cloth, const weft__group *group,
                           const double *y, double *f)
{
    for (size_t r = 0; r < group->end_row; ++r) {
        for (size_t c = group->first_col; c < group->end_col; ++c) {
            add_pull(cloth, group, r * cloth->cols + c, y, f);
        }
    }
}

const char *weft_family_name(weft_family family)
{
    static const char *const names[WEFT_FAMILIES] = { "stretch", "shear", "bend" };
    return (unsigned)family < WEFT_FAMILIES ? names[family] : "unknown";
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

/* False if the grid is too small for a spring of that direction. */
static bool group_init(const weft_cloth *cloth, const weft_cloth_def *def,
                       const direction *way, weft__group *group)
{
    const size_t reach = way->right < 0 ? 1 : (size_t)way->right;
    if (cloth->rows <= way->down || cloth->cols <= reach) {
        return false;
    }
    const weft_spring_def *spring = &def->springs[way->family];
    const double across = cloth->spacing[1] * (double)way->right;
    const double along = cloth->spacing[0] * (double)way->down;
    const double rest_length = sqrt(across * across + along * along);
    *group = (weft__group){
        .family = way->family,
        .way = (unsigned)(way - directions),
        .end_row = cloth->rows - way->down,
        .first_col = way->right < 0 ? reach : 0,
        .end_col = way->right < 0 ? cloth->cols : cloth->cols - reach,
        .stride = (ptrdiff_t)(way->down * cloth->cols) + way->right,
        .rest_length = rest_length,
        .stiffness = def->law == WEFT_LAW_STRAIN ? spring->stiffness / rest_length
                                                 : spring->stiffness,
        .damping = spring->damping,
    };
    return true;
}

void weft__groups_init(weft_cloth *cloth, const weft_cloth_def *def)
{
    cloth->group_count = 0;
    for (size_t i = 0; i < WEFT_GROUPS; ++i) {
        const direction *way = &directions[i];
        weft__group *next = &cloth->groups[cloth->group_count];
        if (def->springs[way->family].present && group_init(cloth, def, way, next)) {
            ++cloth->group_count;
        }
    }
}
