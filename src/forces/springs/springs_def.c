/* SPDX-License-Identifier: BSD-3-Clause */
/* springs_def.c -- the springs of a definition: their numbers, groups and hash. */
#include "forces/springs/springs.h"

#include "base/hash.h"
#include "mesh/grid_def.h"

#define NOT_NEGATIVE .least = 0.0

const struct weft__spring_numbers weft__spring_numbers = {
    WEFT__FIELD(weft_spring_def, stiffness, "N/m or N", NOT_NEGATIVE),
    WEFT__FIELD(weft_spring_def, damping, "kg/s", NOT_NEGATIVE),
};

const weft__number weft__spring_law = { offsetof(weft_cloth_def, law), "law", NULL,
                                        .type = WEFT__ENUM, .most = WEFT_LAW_STRAIN };

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

bool weft__group_init(const weft__mesh *mesh, size_t orientation, weft__group *group)
{
    const direction *of = &directions[orientation];
    const size_t reach = of->right < 0 ? 1 : (size_t)of->right;
    *group = (weft__group){
        .family = of->family,
        .orientation = (unsigned)orientation,
        .end_row = mesh->rows - of->down,
        .first_col = of->right < 0 ? reach : 0,
        .end_col = of->right < 0 ? mesh->cols : mesh->cols - reach,
        .stride = (ptrdiff_t)(of->down * mesh->cols) + of->right,
    };
    return mesh->rows > of->down && mesh->cols > reach;
}

static void set_law(const weft__springs *own, const weft_cloth_def *def,
                    weft__group *group)
{
    const weft_family family = group->family;
    const direction *direct = &directions[group->orientation];
    const bool chain = own->mesh->rows == 1 || own->mesh->cols == 1;
    const weft_spring_def *spring = direct->down == 0 && def->across[family].present
                                        ? &def->across[family]
                                        : &def->springs[family];
    const double across = own->mesh->spacing[1] * (double)direct->right;
    const double along = own->mesh->spacing[0] * (double)direct->down;
    group->rest_length = sqrt(across * across + along * along);
    group->stiffness = def->law == WEFT_LAW_STRAIN
                           ? spring->stiffness / group->rest_length
                           : spring->stiffness;
    group->damping = spring->damping;
    group->half_rim = def->rim_half && !chain && family != WEFT_SHEAR;
}

void weft__groups_init(weft__springs *own, const weft_cloth_def *def)
{
    own->group_count = 0;
    for (size_t orientation = 0; def->mesh == NULL && orientation < WEFT_GROUPS;
         ++orientation) {
        weft__group *next = &own->groups[own->group_count];
        if (def->springs[directions[orientation].family].present
            && weft__group_init(own->mesh, orientation, next)) {
            set_law(own, def, next);
            ++own->group_count;
        }
    }
}

static size_t springs_def_at_most(size_t count, size_t most)
{
    return count < most ? count : most;
}

size_t weft__springs_count(const weft__springs *own, weft_family family)
{
    const size_t first = own->mesh->band.above, end = first + own->mesh->band.own;
    size_t count = 0;
    for (size_t g = 0; g < own->group_count; ++g) {
        const weft__group *group = &own->groups[g];
        if (group->family == family) {
            count += (springs_def_at_most(end, group->end_row)
                      - springs_def_at_most(first, group->end_row))
                     * (group->end_col - group->first_col);
        }
    }
    return count;
}

static void check_groups(const weft_cloth_def *def, const weft__faults *to)
{
    weft__mesh grid = { .rows = 0 };
    weft__springs own = { .mesh = &grid };
    bool usable = true;
    weft__grid_init(&grid, def);
    weft__groups_init(&own, def);
    for (size_t g = 0; g < own.group_count; ++g) {
        const weft__group *group = &own.groups[g];
        usable = usable && group->rest_length > 0.0 && isfinite(group->rest_length)
                 && isfinite(group->stiffness);
    }
    if (!usable) {
        weft__fault(to, offsetof(weft_cloth_def, spacing),
                    offsetof(weft_cloth_def, spacing),
                    "the springs are too large or too small for a double");
    }
}

void weft__springs_check(const weft_cloth_def *def, const weft__faults *to)
{
    if (def->mesh != NULL) {
        return;
    }
    (void)weft__numbers_check(&weft__spring_law, 1, def, to, "%s", "");
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        const weft_spring_def *springs = &def->springs[i], *across = &def->across[i];
        const char *name = weft_family_name((weft_family)i);
        if (springs->present) {
            (void)WEFT__NUMBERS_CHECK(weft__spring_numbers, springs, to,
                                      "%s springs: ", name);
        }
        if (springs->present && across->present) {
            (void)WEFT__NUMBERS_CHECK(weft__spring_numbers, across, to,
                                      "%s springs along a row: ", name);
        }
        if (across->present && i == WEFT_SHEAR) {
            weft__fault(to, offsetof(weft_cloth_def, across),
                        offsetof(weft_cloth_def, across),
                        "%s springs along a row: they lie along the diagonals", name);
        }
    }
    check_groups(def, to);
}

bool weft__springs_init(void *own, const weft_cloth_def *def,
                        const weft_allocator *memory)
{
    (void)memory;
    weft__groups_init(own, def);
    return true;
}

uint64_t weft__springs_hash(const void *own, uint64_t hash)
{
    const weft__springs *of = own;
    for (size_t g = 0; g < of->group_count; ++g) {
        const weft__group *group = &of->groups[g];
        hash = weft__hash_word(hash, group->family);
        hash = weft__hash_word(hash, group->orientation);
        hash = WEFT__HASH_NUMBERS(hash, group->rest_length, group->stiffness,
                                  group->damping);
        hash = group->half_rim ? weft__hash_word(hash, 1) : hash;
    }
    return hash;
}
