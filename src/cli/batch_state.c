/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_state.c -- what is in the directory of a run. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "cli/batch.h"

static const char *const names[BATCH_STATUSES] = {
    [BATCH_NEW] = "missing",
    [BATCH_PARTIAL] = "interrupted",
    [BATCH_DONE] = "done",
    [BATCH_FAILED] = "failed",
    [BATCH_CRASHED] = "crashed",
    [BATCH_TIMEOUT] = "timeout",
    [BATCH_CHANGED] = "changed",
    [BATCH_BUSY] = "busy",
    [BATCH_UNREADABLE] = "unreadable",
};

const char *batch_status_name(batch_status status)
{
    return names[status];
}

weft_status batch_directory(const batch *self, const batch_run *run,
                            char path[RECORD_PATH], weft_error *err)
{
    return record_path(self->out, run->name, path, err);
}

/* Whether a file holds a text and nothing else; *missing if there is no such file. */
static bool holds(const char *path, const char *text, bool *missing)
{
    FILE *stream = fopen(path, "rb");
    *missing = stream == NULL && errno == ENOENT;
    if (stream == NULL) {
        return false;
    }
    int c = getc(stream);
    for (; c != EOF && *text != '\0' && c == (unsigned char)*text; ++text) {
        c = getc(stream);
    }
    const bool same = c == EOF && *text == '\0' && !ferror(stream);
    (void)fclose(stream);
    return same;
}

bool batch_result_open(const char *directory, yaml_document_t *out)
{
    char path[RECORD_PATH];
    yaml_parser_t parser;
    FILE *stream = record_path(directory, "result.yaml", path, NULL) == WEFT_OK
                       ? fopen(path, "rb")
                       : NULL;
    if (stream == NULL) {
        return false;
    }
    bool good = yaml_parser_initialize(&parser) != 0;
    if (good) {
        yaml_parser_set_input_file(&parser, stream);
        good = yaml_parser_load(&parser, out) != 0;
        yaml_parser_delete(&parser);
    }
    (void)fclose(stream);
    if (good
        && (out->nodes.start == out->nodes.top
            || out->nodes.start->type != YAML_MAPPING_NODE)) {
        yaml_document_delete(out);
        return false;
    }
    return good;
}

const char *batch_result_value(yaml_document_t *result, const char *key)
{
    const yaml_node_t *map = yaml_document_get_root_node(result);
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
         pair < map->data.mapping.pairs.top; ++pair) {
        const yaml_node_t *name = yaml_document_get_node(result, pair->key);
        const yaml_node_t *value = yaml_document_get_node(result, pair->value);
        if (name->type == YAML_SCALAR_NODE && value->type == YAML_SCALAR_NODE
            && strcmp((const char *)name->data.scalar.value, key) == 0) {
            return (const char *)value->data.scalar.value;
        }
    }
    return NULL;
}

static batch_status result_status(const char *directory)
{
    static const batch_status over[]
        = { BATCH_DONE, BATCH_FAILED, BATCH_CRASHED, BATCH_TIMEOUT };
    yaml_document_t result;
    batch_status status = BATCH_PARTIAL;
    if (!batch_result_open(directory, &result)) {
        return status;
    }
    const char *said = batch_result_value(&result, "status");
    for (size_t i = 0; said != NULL && i < sizeof over / sizeof over[0]; ++i) {
        status = strcmp(said, names[over[i]]) == 0 ? over[i] : status;
    }
    yaml_document_delete(&result);
    return status;
}

batch_status batch_look(const batch *self, const batch_run *run,
                        const weft_scene *scene)
{
    char directory[RECORD_PATH], path[RECORD_PATH];
    struct stat there;
    bool missing;
    if (batch_directory(self, run, directory, NULL) != WEFT_OK
        || record_path(directory, "scene.yaml", path, NULL) != WEFT_OK) {
        return BATCH_UNREADABLE;
    }
    if (lstat(directory, &there) != 0) {
        return errno == ENOENT ? BATCH_NEW : BATCH_UNREADABLE;
    }
    /* A link would lead out of the batch. */
    if (!S_ISDIR(there.st_mode)) {
        return BATCH_UNREADABLE;
    }
    if (!holds(path, weft_scene_text(scene), &missing)) {
        return missing ? BATCH_NEW : BATCH_CHANGED;
    }
    return result_status(directory);
}

bool batch_claim(const char *directory, int *lock)
{
    enum { TRIES = 50 };
    const struct timespec pause = { .tv_nsec = 100000000 };
    for (int i = 0; i < TRIES; ++i) {
        if (record_outdir_lock(directory, lock, NULL) == WEFT_OK) {
            return true;
        }
        (void)nanosleep(&pause, NULL);
    }
    return false;
}
