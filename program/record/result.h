/* SPDX-License-Identifier: BSD-3-Clause */
/* result.h -- manifest.yaml, and result.yaml: written and read. */
#pragma once

#include <yaml.h>

#include "weft/weft.h"

/* Whether the fixed step is not the one of the scene, as that would not divide a frame.
 */
bool record_step_differs(const weft_scene *scene);

/* Of one of several cloths. */
typedef struct record_part_facts {
    weft_cloth_part part;
    size_t pinned;
    double mass; /* [kg] */
} record_part_facts;
record_part_facts record_part_facts_of(const weft_cloth *cloth, size_t k);

/* The item `cloths` of a mapping (yaml_out.h); nothing of one cloth. */
struct yaml_out;
void record_cloths(struct yaml_out *out, const weft_cloth *cloth);

/* Versions, plugin, method and every option in force. */
weft_status record_manifest(const char *directory, const weft_scene *scene,
                            const weft_sim *sim, const weft_cloth *whole,
                            const weft_plugin *plugin, const char *plugin_file,
                            weft_error *err);

/* The end of a run. */
typedef struct record_result {
    const char *status; /* done | failed | io_error | interrupted */
    const char *reason; /* "" if done, unless by `stop` */
    size_t frames, planned;
    double wall_time;       /* [s] */
    const weft_sim *sim;    /* NULL: the run never began */
    weft_measures measures; /* of the sim at the end, as is: */
    weft_ledger ledger;
    double energy_start; /* [J] the sum of all energies */
    size_t warnings;
} record_result;

/* Writes the last file of a run: its presence says that the run is over. */
weft_status record_result_write(const char *directory, const record_result *result,
                                weft_error *err);

/* Writes DIR/result.yaml as record_result_write does; if there is one, only its status
 * and reason change. */
weft_status record_result_amend(const char *directory, const record_result *result,
                                weft_error *err);

/* The content of result.yaml, as items of a mapping. */
void record_result_items(struct yaml_out *out, const record_result *result);

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
