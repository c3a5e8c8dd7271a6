/* SPDX-License-Identifier: BSD-3-Clause */
/* checkpoint.c -- the layout, in words (base/bytes.h): "weftckpt", format, size of the
 * file, the fields below, the program in 256 bytes, the first page of run.vtkhdf, the
 * state, a checksum. */
#include "record/checkpoint.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"

static const unsigned char magic[WEFT__WORD] = "weftckpt";

#define FORMAT 4

/* X(kind of word, member of the checkpoint) */
#define FIELDS(X)                                                                      \
    X(word, scene)                                                                     \
    X(word, frame)                                                                     \
    X(word, series.length)                                                             \
    X(word, series.sum)                                                                \
    X(word, vtkhdf.frames.length)                                                      \
    X(word, vtkhdf.frames.sum)                                                         \
    X(word, vtkhdf.head.length)                                                        \
    X(word, vtkhdf.head.sum)                                                           \
    X(word, extremes.strain.p)                                                         \
    X(word, extremes.strain.q)                                                         \
    X(real, extremes.strain.strain)                                                    \
    X(real, extremes.strain_time)                                                      \
    X(real, extremes.short_step)                                                       \
    X(real, extremes.long_step)                                                        \
    X(real, wall_time)                                                                 \
    X(word, shapes.length)                                                             \
    X(word, shapes.sum)

#define ONE(kind, name) +1

enum {
    AT_FORMAT = 1,
    AT_SIZE,
    AT_FIELDS,
    AT_FAMILY = AT_FIELDS FIELDS(ONE),
    AT_PROGRAM,
    AT_PAGE = AT_PROGRAM + RECORD_PROGRAM / WEFT__WORD,
    HEAD = AT_PAGE + RECORD_PAGE / WEFT__WORD
};

uint64_t record_hash(const char *text)
{
    uint64_t hash = WEFT__HASH_START;
    for (; *text != '\0'; ++text) {
        hash = weft__hash_byte(hash, (unsigned char)*text);
    }
    return hash;
}

static size_t size_of(size_t state_size)
{
    return HEAD * WEFT__WORD + state_size + WEFT__WORD;
}

/* The size of a simulation's state is a multiple of a word. */
static void pack(const record_checkpoint *from, unsigned char *to, size_t size)
{
    const size_t words = size / WEFT__WORD;
    memcpy(to, magic, sizeof magic);
    weft__word_put(to + AT_FORMAT * WEFT__WORD, FORMAT);
    weft__word_put(to + AT_SIZE * WEFT__WORD, size);
    unsigned char *field = to + AT_FIELDS * WEFT__WORD;
#define PUT(kind, name)                                                                \
    weft__##kind##_put(field, from->name);                                             \
    field += WEFT__WORD;
    FIELDS(PUT)
    weft__word_put(to + AT_FAMILY * WEFT__WORD, from->extremes.strain.family);
    memcpy(to + AT_PROGRAM * WEFT__WORD, from->program, RECORD_PROGRAM);
    memcpy(to + AT_PAGE * WEFT__WORD, from->vtkhdf.page, RECORD_PAGE);
    memcpy(to + HEAD * WEFT__WORD, from->state, from->state_size);
    weft__word_put(to + (words - 1) * WEFT__WORD, weft__words_sum(to, words - 1));
}

weft_status record_checkpoint_identify(record_checkpoint *out, const weft_scene *scene,
                                       weft_registry *registry, weft_error *err)
{
    const weft_plugin *plugin;
    const weft_status status
        = weft_registry_find(registry, weft_scene_plugin(scene), &plugin, err);
    if (status == WEFT_OK) {
        memset(out->program, 0, sizeof out->program);
        out->scene = record_hash(weft_scene_text(scene));
        (void)snprintf(out->program, sizeof out->program, "weft %s, plugin %s %s%s%s",
                       weft_version(), plugin->id, plugin->version,
                       plugin->solver[0] == '\0' ? "" : ", ", plugin->solver);
    }
    return status;
}

weft_status record_checkpoint_write(const char *directory,
                                    const record_checkpoint *checkpoint,
                                    weft_error *err)
{
    record_file file;
    const size_t size = size_of(checkpoint->state_size);
    unsigned char *bytes = malloc(size);
    if (bytes == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a checkpoint");
    }
    pack(checkpoint, bytes, size);
    weft_status status = record_file_open(&file, directory, RECORD_CHECKPOINT, err);
    if (status == WEFT_OK) {
        (void)fwrite(bytes, 1, size, file.stream);
        status = record_file_commit(&file, err);
    }
    free(bytes);
    return status;
}

/* ---- reading ----------------------------------------------------------------- */

static uint64_t word(const unsigned char *bytes, size_t at)
{
    return weft__word_at(bytes + at * WEFT__WORD);
}

/* A complaint about a file of that size, or NULL. */
static const char *check(const unsigned char *bytes, size_t size)
{
    if (size < size_of(0) || memcmp(bytes, magic, sizeof magic) != 0) {
        return "damaged: no checkpoint";
    }
    if (word(bytes, AT_FORMAT) != FORMAT) {
        return "a checkpoint of another version of weft";
    }
    if (word(bytes, AT_SIZE) != size || size % WEFT__WORD != 0) {
        return "damaged: cut off, or longer than it was";
    }
    if (word(bytes, AT_FAMILY) >= WEFT_FAMILIES) {
        return "damaged: no such spring";
    }
    const size_t last = size / WEFT__WORD - 1;
    return weft__words_sum(bytes, last) == word(bytes, last)
               ? NULL
               : "damaged: its checksum is wrong";
}

static void unpack(const unsigned char *bytes, record_checkpoint *out)
{
    const unsigned char *field = bytes + AT_FIELDS * WEFT__WORD;
#define GET(kind, name)                                                                \
    out->name = weft__##kind##_at(field);                                              \
    field += WEFT__WORD;
    FIELDS(GET)
    out->extremes.strain.family = (weft_family)word(bytes, AT_FAMILY);
    memcpy(out->program, bytes + AT_PROGRAM * WEFT__WORD, RECORD_PROGRAM);
    memcpy(out->vtkhdf.page, bytes + AT_PAGE * WEFT__WORD, RECORD_PAGE);
    out->program[RECORD_PROGRAM - 1] = '\0';
}

/* Reads the whole file into allocated memory. */
static weft_status slurp(const char *directory, char path[RECORD_PATH],
                         unsigned char **bytes, size_t *size, weft_error *err)
{
    FILE *stream = record_open(directory, RECORD_CHECKPOINT, path, err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    const long length = fseek(stream, 0, SEEK_END) == 0 ? ftell(stream) : -1;
    rewind(stream);
    *size = length < 0 ? 0 : (size_t)length;
    *bytes = length < 0 ? NULL : malloc(*size + 1);
    const bool done = *bytes != NULL && fread(*bytes, 1, *size + 1, stream) == *size;
    const int why = errno;
    (void)fclose(stream);
    if (done) {
        return WEFT_OK;
    }
    free(*bytes);
    return weft_error_set(err, WEFT_IO, "%s: %s", path, strerror(why));
}

weft_status record_checkpoint_read(const char *directory, record_checkpoint *out,
                                   weft_error *err)
{
    char path[RECORD_PATH];
    unsigned char *bytes = NULL;
    size_t size = 0;
    *out = (record_checkpoint){ .state = NULL };
    const weft_status status = slurp(directory, path, &bytes, &size, err);
    if (status != WEFT_OK) {
        return status;
    }
    const char *wrong = check(bytes, size);
    if (wrong != NULL) {
        free(bytes);
        return weft_error_set(err, WEFT_IO, "%s: %s", path, wrong);
    }
    unpack(bytes, out);
    out->state = bytes;
    out->state_size = size - size_of(0);
    memmove(bytes, bytes + HEAD * WEFT__WORD, out->state_size);
    return WEFT_OK;
}

void record_checkpoint_free(record_checkpoint *checkpoint)
{
    free(checkpoint->state);
    checkpoint->state = NULL;
}
