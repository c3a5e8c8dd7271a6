/* SPDX-License-Identifier: BSD-3-Clause */
/* yaml_out.h -- writes one mapping as YAML with libyaml's emitter, which quotes as
 * needed. */
#ifndef WEFT_YAML_OUT_H
#define WEFT_YAML_OUT_H

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

void yaml_out_map(yaml_out *out, const char *key);
void yaml_out_list(yaml_out *out, const char *key);
void yaml_out_item(yaml_out *out); /* a mapping in a list; close it too */
void yaml_out_close_map(yaml_out *out);
void yaml_out_close_list(yaml_out *out);

void yaml_out_text(yaml_out *out, const char *key, const char *text); /* quoted */
/* A number or a bare word. */
WEFT_PRINTF(3, 4)
void yaml_out_plain(yaml_out *out, const char *key, const char *format, ...);
void yaml_out_real(yaml_out *out, const char *key, double value); /* .inf, .nan too */
/* "rows" and "cols" of the whole grid, or "vertices" and "triangles". */
void yaml_out_size(yaml_out *out, const weft_cloth *cloth);

#endif
