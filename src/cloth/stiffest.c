/* SPDX-License-Identifier: BSD-3-Clause */
/* stiffest.c -- the name of the stiffest spring or the flattest triangle at a particle,
 * for messages about short steps. */
#include "cloth/grids.h"
#include "mesh/surface.h"

/* Of springs that join particle i of a grid; false: there are none. */
static bool find_spring(const weft_cloth *grid, size_t i, weft_spring *out)
{
    const weft__springs *own = &grid->springs;
    double most = -1.0;
    for (size_t g = 0; g < 2 * own->group_count; ++g) {
        const weft__group *group = &own->groups[g / 2];
        const size_t stride = (size_t)group->stride, back = g % 2 == 0 ? 0 : stride;
        if (back <= i && weft__starts_at(own, group, i - back)
            && group->stiffness > most) {
            most = group->stiffness;
            *out = (weft_spring){ .family = group->family,
                                  .p = i - back,
                                  .q = i - back + stride };
        }
    }
    return most >= 0.0;
}

/* [m] The least height of a triangle at rest. */
static double height_of(const weft__triangles *of, size_t t)
{
    double most = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        const double *a = weft__rest_at(of, t, k);
        const double *b = weft__rest_at(of, t, (k + 1) % 3);
        most
            = fmax(most, (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
    }
    return 2.0 * of->area[t] / sqrt(most);
}

/* A particle by its number in the whole definition. */
static size_t vertex(const weft__mesh *mesh, size_t i)
{
    return weft__vertex_of(mesh, weft__whole_index(mesh, i));
}

static void triangle_text(const weft__mesh *mesh, size_t i, char *text, size_t size)
{
    const weft__triangles *of = mesh->triangles;
    size_t flat = of->count;
    for (size_t j = of->around_first[i]; j < of->around_first[i + 1]; ++j) {
        const size_t t = of->around[j];
        flat = flat == of->count || height_of(of, t) < height_of(of, flat) ? t : flat;
    }
    weft_primitive named
        = { .count = flat < of->count ? 3 : 1, .particle = { vertex(mesh, i) } };
    for (size_t k = 0; flat < of->count && k < 3; ++k) {
        named.particle[k] = vertex(mesh, of->corner[flat][k]);
    }
    (void)weft__primitive_text(mesh, &named, text, size);
}

void weft__stiffest_text(const weft_cloth *cloth, size_t i, char *text, size_t size)
{
    const weft__mesh *mesh = &cloth->mesh;
    const weft_cloth *among = weft__grids_at(cloth, i),
                     *grid = among != NULL             ? among
                             : mesh->triangles == NULL ? cloth
                                                       : NULL;
    weft_spring spring;
    if (grid == NULL) {
        triangle_text(mesh, i, text, size);
    } else if (find_spring(grid, i - grid->first, &spring)) {
        spring.p = vertex(mesh, grid->first + spring.p);
        spring.q = vertex(mesh, grid->first + spring.q);
        (void)weft_spring_text(cloth, &spring, text, size);
    } else {
        (void)weft__particle_name(mesh, vertex(mesh, i), text, size);
    }
}
