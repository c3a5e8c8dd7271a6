/* SPDX-License-Identifier: BSD-3-Clause */
/* obj_text.h -- the text of an OBJ file read alone, without a scene. */
#pragma once

#include "scene/obj.h"
#include "scene_load.h"

static weft_allocator obj_memory;
static const weft__source obj_scene = { .file = "scene.yaml", .text = "", .length = 0 };
static weft__report obj_report;
static weft__obj obj;
static double obj_weld = -1.0; /* `weld` of the next file; < 0: none */

/* Reads into `obj`; what is said of it is in `found` after obj_end. */
static inline bool obj_read(const char *text, size_t length)
{
    memset(&found, 0, sizeof found);
    obj_memory = weft_allocator_or_malloc(NULL);
    obj_report = (weft__report){ .found = &found,
                                 .sources = &obj_scene,
                                 .memory = &obj_memory };
    obj = (weft__obj){ .report = &obj_report,
                       .file.path = "shirt.obj",
                       .welds = obj_weld >= 0.0,
                       .weld = obj_weld };
    obj.file.text = weft__report_take(&obj_report, length + 1, 1);
    memcpy(obj.file.text, text, length);
    obj.file.length = length;
    return weft__obj_read(&obj);
}

static inline void obj_end(void)
{
    weft__obj_close(&obj, &obj_memory);
}
