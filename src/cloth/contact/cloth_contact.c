/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_contact.c -- what a cloth tells of its contact with shapes and with itself. */
#include <string.h>

#include "base/sized.h"
#include "cloth/model.h"
#include "forces/contact/self/crossing.h"
#include "mesh/surface.h"

size_t weft_cloth_shapes(const weft_cloth *cloth)
{
    return cloth->contact.shape_count;
}

weft_contact_def weft_cloth_contact(const weft_cloth *cloth)
{
    return cloth->contact.law;
}

void weft_cloth_shape_sized(weft_shape *out, size_t size, const weft_cloth *cloth,
                            size_t k)
{
    weft__sized_write(out, size, &cloth->contact.shapes[k].def, sizeof(weft_shape));
}

void weft_cloth_shape_pose(const weft_cloth *cloth, size_t k, double t, double at[3],
                           double velocity[3])
{
    const weft__pose pose = weft__pose_of(&cloth->contact.shapes[k], t);
    if (at != NULL) {
        memcpy(at, pose.at, sizeof pose.at);
    }
    if (velocity != NULL) {
        memcpy(velocity, pose.velocity, sizeof pose.velocity);
    }
}

void weft_cloth_shape_rotation(const weft_cloth *cloth, size_t k, double t,
                               double rotation[9], double omega[3])
{
    const weft__pose pose = weft__pose_of(&cloth->contact.shapes[k], t);
    const weft__matrix *now
        = pose.kind == WEFT_BOX ? &pose.frame : &pose.rigid.rotation;
    if (rotation != NULL) {
        memcpy(rotation, now, sizeof *now);
    }
    if (omega != NULL) {
        memcpy(omega, pose.rigid.omega, sizeof pose.rigid.omega);
    }
}

void weft_cloth_shape_load(const weft_cloth *cloth, double t, const double *y, size_t k,
                           double force[3], double torque[3])
{
    const weft__state at = { .t = t, .y = y };
    double load[WEFT__LOAD] = { 0.0 }, block[WEFT__LOAD];
    if (cloth->contact.shapes[k].def.body != NULL) {
        weft__bodies_load(&cloth->bodies, NULL, &at, k, load);
    }
    for (size_t b = 0; b < cloth->mesh.band.own; ++b) {
        weft__block_load(&cloth->contact, &at, cloth->mesh.band.above + b, k, block);
        for (size_t j = 0; j < WEFT__LOAD; ++j) {
            load[j] += block[j];
        }
    }
    memcpy(force, load, 3 * sizeof *force);
    memcpy(torque, load + 3, 3 * sizeof *torque);
}

static weft_measures gap(const weft_cloth *cloth, double t, const double *y)
{
    const weft__state at = { .t = t, .y = y };
    const size_t first = cloth->mesh.band.above, end = first + cloth->mesh.band.own;
    weft_measures sum = weft__measures_start;
    for (size_t b = first; b < end; ++b) {
        weft_measures block = weft__block_start;
        weft__contact_gaps(&cloth->contact, &at, b, &block);
        weft__measures_add(&sum, &block);
    }
    if (cloth->bodies.pairs.law.self) {
        weft__bodies_force.whole.measure(&cloth->bodies, NULL, &at, &sum);
    }
    return sum;
}

double weft_cloth_gap(const weft_cloth *cloth, double t, const double *y,
                      size_t *particle, size_t *shape)
{
    const weft_measures found = gap(cloth, t, y);
    if (particle != NULL) {
        *particle = weft__shown(&cloth->mesh, found.gap_particle);
    }
    if (shape != NULL) {
        *shape = found.gap_shape;
    }
    return found.gap;
}

size_t weft_cloth_touching(const weft_cloth *cloth, double t, const double *y)
{
    return gap(cloth, t, y).touching;
}

static weft_measures self_measures(const weft_cloth *cloth, const double *y)
{
    const weft__state at = { .y = y };
    weft_measures sum = weft__measures_start;
    weft__self_measure(&cloth->self, NULL, &at, &sum);
    return sum;
}

double weft_cloth_self_gap(const weft_cloth *cloth, const double *y,
                           weft_primitive pair[2])
{
    const weft_measures found = self_measures(cloth, y);
    for (size_t k = 0; pair != NULL && k < 2; ++k) {
        pair[k] = weft__primitive_of(&cloth->mesh, found.self_pair[k]);
    }
    return found.self_gap;
}

size_t weft_cloth_self_touching(const weft_cloth *cloth, const double *y)
{
    return self_measures(cloth, y).self_touching;
}

size_t weft_cloth_crossings(const weft_cloth *cloth, const double *y,
                            weft_primitive pair[2])
{
    weft__self own = cloth->self;
    weft__crossings found = { .count = SIZE_MAX };
    if (!own.law.self && own.mesh->triangles != NULL) { /* slit edges alone, at rest */
        own.law.thickness
            = fmin(own.law.thickness, 1e-3 * sqrt(weft__area(own.mesh, 0)));
    }
    if (own.surface != NULL || own.mesh->triangles == NULL
        || weft__self_cover(&own, &cloth->memory)) {
        const weft__quadtree tree = weft__tree_of(&own, y);
        found = weft__crossings_of(&tree, &(weft__search){ 0 });
    }
    if (own.surface != cloth->self.surface) {
        weft__contact_surface_destroy(own.surface, &cloth->memory);
    }
    for (size_t k = 0; pair != NULL && k < 2; ++k) {
        pair[k] = weft__primitive_of(&cloth->mesh, found.first.side[k]);
    }
    return found.count;
}
