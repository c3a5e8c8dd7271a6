/* SPDX-License-Identifier: BSD-3-Clause */
/* rhs.c -- the equations of motion as a first-order system y' = f(t, y):
 *
 *     free particle     x' = v,   v' = (the forces of WEFT_FORCES) / m
 *     pinned particle   x' = V + w A cos(w t),   v' = -w^2 A sin(w t),  w = 2 pi f
 *
 * A pinned particle has inverse mass 0 and follows its prescribed motion; one without
 * motion has x' = v' = 0 and keeps its position bit for bit. */
#include <string.h>

#include "cloth/model.h"

#define PLACE(name) { &weft__##name##_force, offsetof(struct weft_cloth, name) },
const weft__line weft__table[WEFT__FORCES] = { WEFT_FORCES(PLACE) };

/* Weight and air alone, where no springs are. */
static bool has_springs(const weft_cloth *cloth)
{
    return cloth->mesh.cols > 0; /* a grid; a mesh would start with its body */
}

static int start(const weft_cloth *cloth, const weft__state *at, double *dydt,
                 size_t first, size_t end)
{
    return has_springs(cloth) ? weft__springs_force.start(&cloth->springs, &cloth->body,
                                                          at, dydt, first, end)
                              : weft__body_force.start(&cloth->body, &cloth->body, at,
                                                       dydt, first, end);
}

int weft__rhs_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                     size_t first, size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    double *dvdt = dydt + 3 * mesh->particles;
    int failed = start(cloth, at, dydt, first, end);
    for (size_t k = WEFT__FORCE_springs + 1; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__table[k].force;
        weft__add_fn *add = at->along != NULL ? force->change : force->add;
        if (add != NULL) {
            failed
                |= add(weft__own(cloth, k), at, WEFT__ACCELERATION, dvdt, first, end);
        }
    }
    if (at->along == NULL) {
        weft__move_pins(mesh, at->t, dydt, weft__block(mesh, first),
                        weft__block(mesh, end));
    }
    return failed;
}

int weft__rhs_all(const weft_cloth *cloth, void *const *spaces, const weft__state *at,
                  weft__unit unit, double *dvdt)
{
    int failed = 0;
    for (size_t k = 0; k < WEFT__FORCES; ++k) {
        const weft__force *force = weft__table[k].force;
        if (force->add_all != NULL) {
            failed |= force->add_all(weft__own(cloth, k),
                                     spaces != NULL ? spaces[k] : NULL, at, unit, dvdt);
        }
    }
    return failed;
}

void weft__ghost_blocks(const weft_cloth *cloth, const weft__state *at, double *dydt,
                        size_t first, size_t end)
{
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles, low = weft__block(mesh, first);
    const size_t high = weft__block(mesh, end);
    for (size_t k = 0; k < 3; ++k) {
        memcpy(dydt + k * n + low, at->y + (k + 3) * n + low,
               (high - low) * sizeof *dydt);
    }
    weft__move_pins(mesh, at->t, dydt, low, high);
}

int weft_cloth_rhs(const weft_cloth *cloth, double t, const double *y, double *dydt)
{
    const weft__state at = { .t = t, .y = y };
    return weft__rhs_blocks(cloth, &at, dydt, 0, weft__blocks(&cloth->mesh))
           | weft__rhs_all(cloth, NULL, &at, WEFT__ACCELERATION,
                           dydt + 3 * cloth->mesh.particles);
}

void weft_cloth_force(const weft_cloth *cloth, double t, const double *y, double *f)
{
    const weft__state at = { .t = t, .y = y };
    const weft__mesh *mesh = &cloth->mesh;
    const size_t n = mesh->particles;
    for (size_t i = 0; i < n; ++i) {
        double springs[3];
        weft__springs_pull(&cloth->springs, i, y, NULL, springs);
        for (size_t k = 0; k < 3; ++k) {
            f[k * n + i] = mesh->mass[i] * cloth->body.gravity[k]
                           + (springs[k] - cloth->body.drag * y[(k + 3) * n + i]);
        }
    }
    for (size_t k = WEFT__FORCE_springs + 1; k < WEFT__FORCES; ++k) {
        if (weft__table[k].force->add != NULL) {
            (void)weft__table[k].force->add(weft__own(cloth, k), &at, WEFT__FORCE, f, 0,
                                            weft__blocks(mesh));
        }
    }
    (void)weft__rhs_all(cloth, NULL, &at, WEFT__FORCE, f);
}

/* J dy, J = [0 I; -M^-1 K -M^-1 C]. */
int weft_cloth_jacobian_product(const weft_cloth *cloth, double t, const double *y,
                                const double *dy, double *out)
{
    const weft__state at = { .t = t, .y = y, .along = dy };
    const weft__mesh *mesh = &cloth->mesh;
    const int failed = weft__rhs_blocks(cloth, &at, out, 0, weft__blocks(mesh));
    for (size_t j = 0; j < mesh->pinned; ++j) {
        for (size_t k = 0; k < 6; ++k) {
            out[k * mesh->particles + mesh->pins[j]] = 0.0;
        }
    }
    return failed;
}
