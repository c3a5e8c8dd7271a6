/* SPDX-License-Identifier: BSD-3-Clause */
/* files.c -- any bytes as a scene and the files that it names. The byte 0x1E ends each
 * of them; they are called, in this order, as `names` says. A diagnostic must be about
 * the text of the file that it names. */
#include "fuzz/file.h"

static const char *const names[]
    = { "scene", "cloth.obj", "body.obj", "k-0.obj", "k-1.obj", "k-3.obj", "cape.obj" };

enum { FILES = sizeof names / sizeof *names };

typedef struct part {
    const uint8_t *text;
    size_t length;
} part;

static void divide(const uint8_t *data, size_t size, part *parts)
{
    const uint8_t *at = data, *end = data + size;
    for (size_t i = 0; i < FILES; ++i) {
        const uint8_t *stop = at < end ? memchr(at, 0x1E, (size_t)(end - at)) : NULL;
        stop = stop == NULL ? end : stop;
        parts[i] = (part){ at, (size_t)(stop - at) };
        at = stop < end ? stop + 1 : end;
    }
}

static const part *named(const part *parts, const char *place)
{
    const char *slash = strrchr(place, '/');
    for (size_t i = 1; i < FILES; ++i) {
        if (strcmp(slash == NULL ? place : slash + 1, names[i]) == 0) {
            return &parts[i];
        }
    }
    return NULL;
}

/* The end of the line that begins at `at`, or of the file. Where no line but the last
 * ends with LF, CR alone ends them, as in obj_parse.c. */
static const uint8_t *line_end(const part *of, const uint8_t *at)
{
    const uint8_t *end = of->text + of->length;
    size_t inner = of->length;
    while (inner > 0 && of->text[inner - 1] == '\0') {
        --inner;
    }
    inner -= inner > 0;
    const bool bare = memchr(of->text, '\0', inner) == NULL
                      && memchr(of->text, '\n', inner) == NULL;
    while (at < end && *at != '\n' && !(bare && *at == '\r')) {
        ++at;
    }
    return at;
}

/* The file has the line that is shown: a short one as it is, if it is plain text. */
static void check_place(const part *of, const weft_diagnostic *item)
{
    const uint8_t *at = of->text, *end = at + of->length;
    for (int line = 1; line < item->line; ++line) {
        at = line_end(of, at);
        HOLDS(at < end);
        ++at;
    }
    size_t length = (size_t)(line_end(of, at) - at);
    length -= length > 0 && at[length - 1] == '\r';
    bool plain = length < 100;
    for (size_t i = 0; i < length; ++i) {
        plain = plain && at[i] >= ' ' && at[i] < 0x7F;
    }
    HOLDS(!plain
          || (strlen(item->source) == length && memcmp(item->source, at, length) == 0));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    part parts[FILES];
    char *text, file[300];
    divide(data, size, parts);
    for (size_t i = 1; i < FILES; ++i) {
        if (parts[i].length > 0) {
            fuzz_write(names[i], parts[i].text, parts[i].length);
        } else {
            (void)unlink(fuzz_file(names[i]));
        }
    }
    text = malloc(parts[0].length + 1);
    HOLDS(text != NULL);
    memcpy(text, parts[0].text, parts[0].length);
    weft_scene_def def = scene_of_text("");
    (void)snprintf(file, sizeof file, "%s/test.yaml", fuzz_directory);
    def.file = file;
    def.text = text;
    def.length = parts[0].length;
    weft_scene_destroy(fuzz_load(&def));
    for (size_t i = 0; i < found.count; ++i) {
        const part *of = named(parts, found.items[i].place);
        if (of != NULL && found.items[i].line > 0) {
            check_place(of, &found.items[i]);
        }
    }
    free(text);
    return 0;
}
