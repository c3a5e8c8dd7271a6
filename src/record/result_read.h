/* SPDX-License-Identifier: BSD-3-Clause */
/* result_read.h -- reads result.yaml of a run that is over. */
#ifndef WEFT_RECORD_RESULT_READ_H
#define WEFT_RECORD_RESULT_READ_H

#include <stdbool.h>
#include <stdint.h>
#include <yaml.h>

/* DIR/result.yaml, a mapping; false if there is none. The caller deletes the
 * document. */
bool record_result_open(const char *directory, yaml_document_t *out);
/* The text of a key, or NULL. */
const char *record_result_value(yaml_document_t *result, const char *key);

/* The text of one key in DIR/result.yaml; "" if there is none. Returns out. */
enum { RECORD_RESULT_TEXT = 32 };
const char *record_result_get(const char *directory, const char *key,
                              char out[RECORD_RESULT_TEXT]);

/* The hash of the last state; false if there is none, as after a kill. */
bool record_result_hash(const char *directory, uint64_t *hash);

#endif
