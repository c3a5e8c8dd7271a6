/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_copy.c -- the scene of a run and the files that it names, copied beside its
 * results. */
#include <sys/stat.h>

#include "base/file.h"
#include "program/record/record.h"
#include "program/record/sections.h"

static weft_status write_text(const char *directory, const char *name, const char *text,
                              weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, directory, name, err));
    (void)fputs(text, file.stream);
    return record_file_commit(&file, err);
}

/* Nothing is done for a file that is itself the copy, as that of a run that goes on. */
static weft_status copy_file(const char *directory, const char *name, const char *from,
                             weft_error *err)
{
    char to[RECORD_PATH], bytes[1 << 14];
    struct stat source = { 0 }, own = { 0 };
    record_file file;
    TRY(record_path(directory, name, to, err));
    if (stat(from, &source) == 0 && stat(to, &own) == 0 && source.st_ino == own.st_ino
        && source.st_dev == own.st_dev) {
        return WEFT_OK;
    }
    FILE *stream = weft__file_open(from, "r", err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    weft_status status = record_file_open(&file, directory, name, err);
    if (status == WEFT_OK) {
        for (size_t got; (got = fread(bytes, 1, sizeof bytes, stream)) > 0;) {
            (void)fwrite(bytes, 1, got, file.stream);
        }
        status = record_file_commit(&file, err);
        if (ferror(stream)) {
            status = weft_error_set(err, WEFT_IO, "%.200s cannot be read", from);
        }
    }
    (void)fclose(stream);
    return status;
}

weft_status record_mesh(const char *directory, const char *name,
                        const weft_scene *scene, size_t k, weft_error *err)
{
    const char *file = weft_scene_part_file(scene, k),
               *made = weft_scene_part_text(scene, k);
    return file != NULL ? copy_file(directory, name, file, err)
                        : write_text(directory, name, made, err);
}

weft_status record_scene_text(const char *directory, const char *name,
                              const weft_scene *scene, weft_error *err)
{
    /* scene.yaml is read with them again */
    const weft_mesh_def *mesh = weft_scene_cloth(scene)->mesh;
    if (mesh != NULL && mesh->part_count == 0) {
        TRY(record_mesh(directory, RECORD_MESH, scene, 0, err));
    }
    for (size_t k = 0; mesh != NULL && k < mesh->part_count; ++k) {
        char copy[40];
        (void)snprintf(copy, sizeof copy, "scene-%zu.obj", k);
        if (mesh->grids == NULL || mesh->grids[k] == NULL) {
            TRY(record_mesh(directory, copy, scene, k, err));
        }
    }
    char copy[64];
    const char *body;
    for (size_t i = 0;
         (body = weft_scene_body_file(scene, i, copy, sizeof copy)) != NULL; ++i) {
        TRY(copy_file(directory, copy, body, err));
    }
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        TRY(record_sections[i]->files != NULL
                ? record_sections[i]->files(directory, scene, err)
                : WEFT_OK);
    }
    return write_text(directory, name, weft_scene_text(scene), err);
}
