/* SPDX-License-Identifier: BSD-3-Clause */
#include "record/yaml_out.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void emit(yaml_out *out, yaml_event_t *event, int initialised)
{
    if (!initialised || out->failed || !yaml_emitter_emit(&out->emitter, event)) {
        out->failed = true;
    }
}

/* Names of files need not be UTF-8, but YAML must be. */
static void ascii(char *text)
{
    for (; *text != '\0'; ++text) {
        *text = (unsigned char)*text < 0x80 ? *text : '?';
    }
}

static void scalar(yaml_out *out, const char *text, yaml_scalar_style_t style)
{
    yaml_event_t event;
    int made = yaml_scalar_event_initialize(
        &event, NULL, NULL, (const yaml_char_t *)text, (int)strlen(text), 1, 1, style);
    char *copy = made ? NULL : strdup(text);
    if (copy != NULL) {
        ascii(copy);
        made = yaml_scalar_event_initialize(&event, NULL, NULL,
                                            (const yaml_char_t *)copy,
                                            (int)strlen(copy), 1, 1, style);
    }
    emit(out, &event, made);
    free(copy);
}

static void key_scalar(yaml_out *out, const char *key)
{
    if (key != NULL) {
        scalar(out, key, YAML_PLAIN_SCALAR_STYLE);
    }
}

static void begin(yaml_out *out, FILE *stream, int implicit, yaml_mapping_style_t style)
{
    yaml_event_t event;
    out->failed = yaml_emitter_initialize(&out->emitter) == 0;
    if (!out->failed) {
        yaml_emitter_set_output_file(&out->emitter, stream);
        yaml_emitter_set_unicode(&out->emitter, 1);
        yaml_emitter_set_width(&out->emitter, -1);
    }
    emit(out, &event, yaml_stream_start_event_initialize(&event, YAML_UTF8_ENCODING));
    emit(out, &event,
         yaml_document_start_event_initialize(&event, NULL, NULL, NULL, implicit));
    emit(out, &event,
         yaml_mapping_start_event_initialize(&event, NULL, NULL, 1, style));
}

void yaml_out_begin(yaml_out *out, FILE *stream)
{
    begin(out, stream, 1, YAML_BLOCK_MAPPING_STYLE);
}

void yaml_out_begin_event(yaml_out *out, const char *name)
{
    begin(out, stdout, 0, YAML_FLOW_MAPPING_STYLE);
    yaml_out_plain(out, "event", "%s", name);
}

void yaml_out_end_event(yaml_out *out)
{
    (void)yaml_out_end(out);
    (void)fflush(stdout);
}

bool yaml_out_end(yaml_out *out)
{
    yaml_event_t event;
    yaml_out_close_map(out);
    emit(out, &event, yaml_document_end_event_initialize(&event, 1));
    emit(out, &event, yaml_stream_end_event_initialize(&event));
    yaml_emitter_delete(&out->emitter);
    return !out->failed;
}

void yaml_out_item(yaml_out *out)
{
    yaml_event_t event;
    emit(out, &event,
         yaml_mapping_start_event_initialize(&event, NULL, NULL, 1,
                                             YAML_BLOCK_MAPPING_STYLE));
}

void yaml_out_map(yaml_out *out, const char *key)
{
    key_scalar(out, key);
    yaml_out_item(out);
}

void yaml_out_list(yaml_out *out, const char *key)
{
    yaml_event_t event;
    key_scalar(out, key);
    emit(out, &event,
         yaml_sequence_start_event_initialize(&event, NULL, NULL, 1,
                                              YAML_BLOCK_SEQUENCE_STYLE));
}

void yaml_out_close_map(yaml_out *out)
{
    yaml_event_t event;
    emit(out, &event, yaml_mapping_end_event_initialize(&event));
}

void yaml_out_close_list(yaml_out *out)
{
    yaml_event_t event;
    emit(out, &event, yaml_sequence_end_event_initialize(&event));
}

void yaml_out_text(yaml_out *out, const char *key, const char *text)
{
    key_scalar(out, key);
    scalar(out, text, YAML_DOUBLE_QUOTED_SCALAR_STYLE);
}

void yaml_out_plain(yaml_out *out, const char *key, const char *format, ...)
{
    char text[128];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    key_scalar(out, key);
    scalar(out, text, YAML_PLAIN_SCALAR_STYLE);
}

void yaml_out_real(yaml_out *out, const char *key, double value)
{
    if (isfinite(value)) {
        char text[32];
        int digits = 15; /* the fewest that read back as the same number */
        do {
            (void)snprintf(text, sizeof text, "%.*g", digits, value);
        } while (strtod(text, NULL) != value && ++digits <= 17);
        char *e = strchr(text, 'e');
        if (e != NULL && strchr(text, '.') == NULL) { /* YAML 1.1 wants a point */
            memmove(e + 2, e, strlen(e) + 1);
            memcpy(e, ".0", 2);
        }
        yaml_out_plain(out, key, "%s", text);
    } else {
        yaml_out_plain(out, key, isnan(value) ? ".nan" : value > 0 ? ".inf" : "-.inf");
    }
}

void yaml_out_size(yaml_out *out, const weft_cloth *cloth)
{
    const size_t cols = weft_cloth_cols(cloth);
    yaml_out_plain(out, cols > 0 ? "rows" : "vertices", "%zu",
                   cols > 0 ? weft_cloth_band(cloth).rows
                            : weft_cloth_particles(cloth));
    yaml_out_plain(out, cols > 0 ? "cols" : "triangles", "%zu",
                   cols > 0 ? cols : weft_cloth_triangles(cloth, NULL));
}
