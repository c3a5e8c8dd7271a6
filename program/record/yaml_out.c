/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/record/yaml_out.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void emit(yaml_out *out, yaml_event_t *event, int initialised)
{
    if (!initialised || out->failed || !yaml_emitter_emit(&out->emitter, event)) {
        out->failed = true;
    }
}

/* Names of files need not be UTF-8, but YAML must be: '?' stands for other bytes then.
 */
static void scalar(yaml_out *out, const char *text, size_t length, bool quoted)
{
    const yaml_scalar_style_t style
        = quoted ? YAML_DOUBLE_QUOTED_SCALAR_STYLE : YAML_PLAIN_SCALAR_STYLE;
    yaml_event_t event;
    int made = yaml_scalar_event_initialize(&event, NULL, NULL, (yaml_char_t *)text,
                                            (int)length, 1, 1, style);
    unsigned char *copy = made ? NULL : malloc(length + 1);
    for (size_t i = 0; copy != NULL && i < length; ++i) {
        copy[i] = (unsigned char)text[i] < 0x80 ? (unsigned char)text[i] : '?';
    }
    if (copy != NULL) {
        made = yaml_scalar_event_initialize(&event, NULL, NULL, copy, (int)length, 1, 1,
                                            style);
    }
    emit(out, &event, made);
    free(copy);
}

static void real(double value, char text[32])
{
    if (!isfinite(value)) {
        strcpy(text, isnan(value) ? ".nan" : value > 0 ? ".inf" : "-.inf");
        return;
    }
    int digits = 15; /* the fewest that read back as the same number */
    do {
        (void)snprintf(text, 32, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
    char *e = strchr(text, 'e');
    if (e != NULL && strchr(text, '.') == NULL) { /* YAML 1.1 wants a point */
        memmove(e + 2, e, strlen(e) + 1);
        memcpy(e, ".0", 2);
    }
}

/* Returns the length of the directive at the begin of `format`. */
static size_t write_value(yaml_out *out, const char *format, va_list *args)
{
    const bool quoted = *format == '"';
    const size_t length = strcspn(format, ":, }]");
    const char kind = format[length - 1 - quoted];
    char number[32];
    const char *text = number;
    if (kind == 's') {
        text = va_arg(*args, const char *);
    } else if (kind == 'g') {
        real(va_arg(*args, double), number);
    } else if (kind == 'd') {
        (void)snprintf(number, sizeof number, "%d", va_arg(*args, int));
    } else {
        const uint64_t value = format[1] == 'z'   ? va_arg(*args, size_t)
                               : format[1] == 'l' ? va_arg(*args, uint64_t)
                                                  : va_arg(*args, unsigned);
        (void)snprintf(number, sizeof number, "%" PRIu64, value);
    }
    scalar(out, text, strlen(text), quoted);
    return length;
}

static void write_bracket(yaml_out *out, char bracket)
{
    yaml_event_t event;
    emit(out, &event,
         bracket == '{'   ? yaml_mapping_start_event_initialize(&event, NULL, NULL, 1,
                                                                YAML_BLOCK_MAPPING_STYLE)
         : bracket == '[' ? yaml_sequence_start_event_initialize(
               &event, NULL, NULL, 1, YAML_BLOCK_SEQUENCE_STYLE)
         : bracket == '}' ? yaml_mapping_end_event_initialize(&event)
                          : yaml_sequence_end_event_initialize(&event));
}

void yaml_out_write(yaml_out *out, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    for (size_t length; *format != '\0'; format += length) {
        length = strspn(format, ":, ");
        if (length > 0) {
            continue;
        }
        if (*format == '%' || *format == '"') {
            length = write_value(out, format, &args);
        } else if (strchr("{}[]", *format) != NULL) {
            length = 1;
            write_bracket(out, *format);
        } else {
            length = strcspn(format, ":");
            scalar(out, format, length, false);
        }
    }
    va_end(args);
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
    yaml_out_write(out, "event: %s", name);
}

void yaml_out_end_event(yaml_out *out)
{
    (void)yaml_out_end(out);
    (void)fflush(stdout);
}

bool yaml_out_end(yaml_out *out)
{
    yaml_event_t event;
    write_bracket(out, '}');
    emit(out, &event, yaml_document_end_event_initialize(&event, 1));
    emit(out, &event, yaml_stream_end_event_initialize(&event));
    yaml_emitter_delete(&out->emitter);
    return !out->failed;
}

void yaml_out_size(yaml_out *out, const weft_cloth *cloth)
{
    const size_t cols = weft_cloth_cols(cloth);
    if (cols > 0) {
        yaml_out_write(out, "rows: %zu, cols: %zu", weft_cloth_band(cloth).rows, cols);
    } else {
        yaml_out_write(out, "vertices: %zu, triangles: %zu",
                       weft_cloth_particles(cloth), weft_cloth_triangles(cloth, NULL));
    }
}
