/* SPDX-License-Identifier: BSD-3-Clause */
/* triangles.c -- the tables of a mesh of triangles from its definition. */
#include "mesh/triangles.h"

#include "base/sized.h"

void weft_mesh_def_init(weft_mesh_def *def, size_t size)
{
    const weft_mesh_def start = { .struct_size = (uint32_t)size };
    weft__sized_write(def, size, &start, sizeof start);
}
