/* SPDX-License-Identifier: BSD-3-Clause */
/* checkpoint.c -- the layout, in words (base/bytes.h): "weftckpt", format, size of the
 * file, the fields below, the program in 256 bytes, the first page of run.vtkhdf, a
 * checksum; then the simulation, which has its own. */
#include "program/record/checkpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"
#include "program/record/sections.h"

static const unsigned char magic[WEFT__WORD] = "weftckpt";

#define FORMAT 5

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
    AT_SUM = AT_PAGE + RECORD_PAGE / WEFT__WORD,
    HEAD = RECORD_CHECKPOINT_HEAD
};
_Static_assert(HEAD == (AT_SUM + 1) * WEFT__WORD, "the head is that of checkpoint.h");

void record_checkpoint_pack(const record_checkpoint *from, size_t state_size,
                            unsigned char to[RECORD_CHECKPOINT_HEAD])
{
    memcpy(to, magic, sizeof magic);
    weft__word_put(to + AT_FORMAT * WEFT__WORD, FORMAT);
    weft__word_put(to + AT_SIZE * WEFT__WORD, HEAD + state_size);
    unsigned char *field = to + AT_FIELDS * WEFT__WORD;
#define PUT(kind, name)                                                                \
    weft__##kind##_put(field, from->name);                                             \
    field += WEFT__WORD;
    FIELDS(PUT)
    weft__word_put(to + AT_FAMILY * WEFT__WORD, from->extremes.strain.family);
    memcpy(to + AT_PROGRAM * WEFT__WORD, from->program, RECORD_PROGRAM);
    memcpy(to + AT_PAGE * WEFT__WORD, from->vtkhdf.page, RECORD_PAGE);
    weft__word_put(to + AT_SUM * WEFT__WORD, weft__words_sum(to, AT_SUM));
}

/* Of the text, and of the meshes that it names. */
static uint64_t scene_hash(const weft_scene *scene)
{
    const weft_mesh_def *mesh = weft_scene_cloth(scene)->mesh;
    uint64_t hash = WEFT__HASH_START;
    for (const char *c = weft_scene_text(scene); *c != '\0'; ++c) {
        hash = weft__hash_byte(hash, (unsigned char)*c);
    }
    if (mesh != NULL) {
        hash = weft__hash_reals(hash, mesh->start, 3 * mesh->vertices);
        hash = weft__hash_reals(hash, mesh->rest, 2 * mesh->uv_count);
        for (size_t i = 0; i < 3 * mesh->triangles; ++i) {
            hash = weft__hash_word(hash, mesh->corners[i]);
            if (mesh->corner_uv != NULL) {
                hash = weft__hash_word(hash, mesh->corner_uv[i]);
            }
        }
        for (size_t i = 0; mesh->file_index != NULL && i < mesh->vertices; ++i) {
            hash = weft__hash_word(hash, mesh->file_index[i]);
        }
    }
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        hash = record_sections[i]->hash != NULL
                   ? record_sections[i]->hash(weft_scene_cloth(scene), hash)
                   : hash;
    }
    return hash;
}

weft_status record_checkpoint_identify(record_checkpoint *out, const weft_scene *scene,
                                       weft_registry *registry, weft_error *err)
{
    const weft_plugin *plugin;
    TRY(weft_registry_find(registry, weft_scene_plugin(scene), &plugin, err));
    memset(out->program, 0, sizeof out->program);
    out->scene = scene_hash(scene);
    /* without the patch, which keeps the bits: VERSIONING.md */
    const char *version = weft_version();
    const bool ours = strcmp(plugin->version, version) == 0;
    (void)snprintf(out->program, sizeof out->program, "weft %.*s, plugin %s%s%s%s%s",
                   (int)(strrchr(version, '.') - version), version, plugin->id,
                   ours ? "" : " ", ours ? "" : plugin->version,
                   plugin->solver[0] == '\0' ? "" : ", ", plugin->solver);
    return WEFT_OK;
}

/* ---- writing --------------------------------------------------------------------- */

/* A new file of that size under its temporary name, with its head. */
static weft_status make_file(record_file *file, const char *directory,
                             const record_checkpoint *from, size_t state_size,
                             weft_error *err)
{
    unsigned char head[HEAD];
    TRY(record_file_open(file, directory, RECORD_CHECKPOINT, err));
    record_checkpoint_pack(from, state_size, head);
    return ftruncate(fileno(file->stream), (off_t)(HEAD + state_size)) == 0
                   && record_write_at(fileno(file->stream), head, HEAD, 0)
               ? WEFT_OK
               : record_failed(file->path, err);
}

typedef struct output {
    const char *path;
    int file;
} output;

static weft_status put(void *ctx, uint64_t at, const void *bytes, size_t size,
                       weft_error *err)
{
    const output *to = ctx;
    return record_write_at(to->file, bytes, size, HEAD + at)
               ? WEFT_OK
               : record_failed(to->path, err);
}

static weft_status put_parts(const record_file *file, weft_sim *sim,
                             const weft_comm *comm, weft_error *err)
{
    output to = { .path = file->path };
    weft_status status
        = record_shared_open(comm, file->temporary, O_WRONLY, &to.file, err);
    status = status == WEFT_OK ? weft_sim_save_parts(sim, put, &to, err) : status;
    const bool synced = status != WEFT_OK || fsync(to.file) == 0;
    const bool closed = to.file < 0 || close(to.file) == 0;
    if (status == WEFT_OK && !(synced && closed)) {
        status = record_failed(to.path, err);
    }
    return weft_comm_agree(comm, status, err);
}

weft_status record_checkpoint_write(const char *directory,
                                    const record_checkpoint *checkpoint, weft_sim *sim,
                                    const weft_comm *comm, weft_error *err)
{
    record_file file = { .stream = NULL };
    const bool first = comm == NULL || comm->rank == 0;
    weft_status status
        = first ? make_file(&file, directory, checkpoint, weft_sim_save_size(sim), err)
                : record_path(directory, RECORD_CHECKPOINT, file.path, err);
    status = weft_comm_agree(comm, status, err);
    if (status == WEFT_OK) {
        record_temporary(file.path, file.temporary);
        status = put_parts(&file, sim, comm, err);
    }
    if (status == WEFT_OK) {
        status = first ? record_file_commit(&file, err) : WEFT_OK;
        status = weft_comm_agree(comm, status, err);
    } else if (file.stream != NULL) {
        record_file_discard(&file);
    }
    return status;
}

/* ---- reading ----------------------------------------------------------------- */

static uint64_t word(const unsigned char *bytes, size_t at)
{
    return weft__word_at(bytes + at * WEFT__WORD);
}

/* A complaint about the head of a file of that size, or NULL. */
static const char *check(const unsigned char *bytes, uint64_t size)
{
    if (size < HEAD || memcmp(bytes, magic, sizeof magic) != 0) {
        return "damaged: no checkpoint";
    }
    if (word(bytes, AT_FORMAT) != FORMAT) {
        return "a checkpoint of another version of weft";
    }
    if (word(bytes, AT_SIZE) != size) {
        return "damaged: cut off, or longer than it was";
    }
    if (word(bytes, AT_FAMILY) >= WEFT_FAMILIES) {
        return "damaged: no such spring";
    }
    return weft__words_sum(bytes, AT_SUM) == word(bytes, AT_SUM)
               ? NULL
               : "damaged: its checksum is wrong";
}

weft_status record_checkpoint_read(const char *directory, record_checkpoint *out,
                                   weft_error *err)
{
    unsigned char head[HEAD];
    *out = (record_checkpoint){ .stream = NULL };
    FILE *stream = record_open(directory, RECORD_CHECKPOINT, out->path, err);
    out->stream = stream;
    if (stream == NULL) {
        return WEFT_IO;
    }
    const off_t size = lseek(fileno(stream), 0, SEEK_END);
    const char *wrong
        = size < 0 || (size >= HEAD && !record_read_at(fileno(stream), head, HEAD, 0))
              ? strerror(errno)
              : check(head, (uint64_t)size);
    if (wrong != NULL) {
        record_checkpoint_close(out);
        return weft_error_set(err, WEFT_IO, "%s: %s", out->path, wrong);
    }
    const unsigned char *field = head + AT_FIELDS * WEFT__WORD;
#define GET(kind, name)                                                                \
    out->name = weft__##kind##_at(field);                                              \
    field += WEFT__WORD;
    FIELDS(GET)
    out->extremes.strain.family = (weft_family)word(head, AT_FAMILY);
    memcpy(out->program, head + AT_PROGRAM * WEFT__WORD, RECORD_PROGRAM);
    memcpy(out->vtkhdf.page, head + AT_PAGE * WEFT__WORD, RECORD_PAGE);
    out->program[RECORD_PROGRAM - 1] = '\0';
    out->state_size = (size_t)size - HEAD;
    return WEFT_OK;
}

static weft_status get(void *ctx, uint64_t at, void *bytes, size_t size,
                       weft_error *err)
{
    const record_checkpoint *from = ctx;
    return record_read_at(fileno(from->stream), bytes, size, HEAD + at)
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s", strerror(errno));
}

weft_status record_checkpoint_restore(record_checkpoint *from, weft_sim *sim,
                                      weft_error *err)
{
    weft_error why = { 0 };
    return weft_sim_restore_parts(sim, get, from, from->state_size, &why) == WEFT_OK
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s: %s", from->path, why.message);
}

void record_checkpoint_close(record_checkpoint *checkpoint)
{
    if (checkpoint->stream != NULL) {
        (void)fclose(checkpoint->stream);
    }
    checkpoint->stream = NULL;
}
