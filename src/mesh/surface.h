/* SPDX-License-Identifier: BSD-3-Clause */
/* surface.h -- a mesh of either kind as it is drawn, exported and named: in the numbers
 * of its definition. */
#pragma once

#include "mesh/triangles.h"

/* weft_cloth_triangles, weft_cloth_edges, weft_cloth_uv, weft_cloth_panels. */
size_t weft__surface_triangles(const weft__mesh *mesh, uint32_t *corners);
size_t weft__surface_edges(const weft__mesh *mesh, uint32_t *ends);
size_t weft__surface_places(const weft__mesh *mesh, uint32_t *corner_uv, double *uv);
size_t weft__surface_pieces(const weft__mesh *mesh, size_t *sewn, double *length);

/* Of particle i in planes of positions: weft_sim_vertices. */
void weft__surface_normal(const weft__mesh *mesh, const double *x, size_t i,
                          double normal[3]);

/* A primitive of particles in numbers of the definition. */
static inline weft_primitive weft__primitive_of(const weft__mesh *mesh,
                                                weft_primitive of)
{
    for (size_t k = 0; k < of.count; ++k) {
        of.particle[k] = weft__vertex_of(mesh, of.particle[k]);
    }
    return of;
}

/* Texts of numbers of the whole definition, as snprintf writes them; all return
 * `text`. "(3, 4)" or "17"; then as weft_particle_text and weft_primitive_text. */
enum { WEFT__NAME_TEXT = 48 };
const char *weft__name_text(const weft__mesh *mesh, size_t vertex,
                            char text[WEFT__NAME_TEXT]);
/* " of shirt" of a vertex; "" if its cloth has no name. */
enum { WEFT__CLOTH_TEXT = 4 + WEFT_CLOTH_NAME_MAX + 1 };
const char *weft__cloth_name(const weft__mesh *mesh, size_t vertex,
                             char text[WEFT__CLOTH_TEXT]);
const char *weft__particle_name(const weft__mesh *mesh, size_t vertex, char *text,
                                size_t size);
const char *weft__primitive_text(const weft__mesh *mesh,
                                 const weft_primitive *primitive, char *text,
                                 size_t size);
