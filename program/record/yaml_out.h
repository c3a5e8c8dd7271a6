/* SPDX-License-Identifier: BSD-3-Clause */
/* yaml_out.h -- writes one mapping as YAML with libyaml's emitter, which quotes as
 * needed. */
#pragma once

#include <stdbool.h>
#include <stdio.h>
#include <yaml.h>

#include "weft/cloth.h"

typedef struct yaml_out {
    yaml_emitter_t emitter;
    bool failed; /* a call failed; later ones did nothing */
} yaml_out;

void yaml_out_begin(yaml_out *out, FILE *stream);
bool yaml_out_end(yaml_out *out); /* true if all calls succeeded */

/* An event for machines, one document in one line of stdout: --- {event: name, ...}. */
void yaml_out_begin_event(yaml_out *out, const char *name);
void yaml_out_end_event(yaml_out *out);

/* Items of the mapping, by a template: "order: %d, atol: { position: %g }, files: [".
 * Brackets that a template leaves open are closed by another. Values are %s, a bare
 * word, also as a key; \"%s\", in quotes; %d, %u, %zu, PRIu64; %g, with all digits that
 * matter, .inf and .nan too. */
WEFT_PRINTF(2, 3) void yaml_out_write(yaml_out *out, const char *format, ...);

/* "rows" and "cols" of the whole grid, or "vertices" and "triangles". */
void yaml_out_size(yaml_out *out, const weft_cloth *cloth);

static inline const char *yaml_bool(bool value)
{
    return value ? "true" : "false";
}
