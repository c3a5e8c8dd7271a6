/* SPDX-License-Identifier: BSD-3-Clause */
/* result_read.c -- reads result.yaml of a run that is over. */
#include "record/result.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "record/record.h"

bool record_result_open(const char *directory, yaml_document_t *out)
{
    char path[RECORD_PATH];
    yaml_parser_t parser;
    FILE *stream = record_open(directory, "result.yaml", path, NULL);
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
    const yaml_node_t *root = good ? yaml_document_get_root_node(out) : NULL;
    if (good && (root == NULL || root->type != YAML_MAPPING_NODE)) {
        yaml_document_delete(out);
        good = false;
    }
    return good;
}

const char *record_result_value(yaml_document_t *result, const char *key)
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

const char *record_result_get(const char *directory, const char *key,
                              char out[RECORD_RESULT_TEXT])
{
    yaml_document_t result;
    out[0] = '\0';
    if (record_result_open(directory, &result)) {
        const char *text = record_result_value(&result, key);
        (void)snprintf(out, RECORD_RESULT_TEXT, "%s", text == NULL ? "" : text);
        yaml_document_delete(&result);
    }
    return out;
}

bool record_result_hash(const char *directory, uint64_t *hash)
{
    char text[RECORD_RESULT_TEXT];
    return sscanf(record_result_get(directory, "hash", text), "%16" SCNx64, hash) == 1;
}

bool record_unfinished(const char *directory)
{
    char status[RECORD_RESULT_TEXT];
    if (!record_exists(directory, "scene.yaml")) {
        return false;
    }
    (void)record_result_get(directory, "status", status);
    return status[0] == '\0' || strcmp(status, "interrupted") == 0
           || strcmp(status, "io_error") == 0;
}
