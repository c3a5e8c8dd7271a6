/* SPDX-License-Identifier: BSD-3-Clause */
/* obj.c -- any bytes as an OBJ file. */
#include "fuzz/fuzz.h"

#include "obj_text.h"

static void check_definition(const weft_mesh_def *def)
{
    for (size_t i = 0; i < 3 * def->triangles; ++i) {
        HOLDS(def->corners[i] < def->vertices);
        HOLDS(def->corner_uv[i] < def->uv_count);
    }
    for (size_t i = 0; i < 3 * def->vertices; ++i) {
        HOLDS(def->start[i] - def->start[i] == 0.0); /* finite */
    }
    for (size_t i = 0; i < 2 * def->uv_count; ++i) {
        HOLDS(def->rest[i] - def->rest[i] == 0.0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    obj_weld = (double[]){ -1.0, 0.0, 0.1 }[size % 3];
    const bool good = obj_read((const char *)data, size);
    HOLDS(good == (found.errors == 0));
    if (good) {
        bool *member = calloc(obj.def.vertices, sizeof *member);
        HOLDS(member != NULL);
        check_definition(&obj.def);
        (void)weft__obj_group(&obj, "waist", member);
        for (size_t t = 0; t < obj.def.triangles; ++t) {
            weft__obj_fault(&obj, WEFT__MESH_TRIANGLE, t, "a triangle");
        }
        weft__obj_fault(&obj, WEFT__MESH_PLACE, obj.def.uv_count - 1, "a place");
        weft__obj_fault(&obj, WEFT__MESH_VERTEX, obj.def.vertices - 1, "a vertex");
        free(member);
    }
    weft__obj_forget(&obj);
    fuzz_check_items();
    obj_end();
    return 0;
}
