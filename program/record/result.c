/* SPDX-License-Identifier: BSD-3-Clause */
/* result.c -- manifest.yaml: the program and its options; result.yaml: the end of the
 * run, written and read. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "program/record/record.h"
#include "program/record/result.h"
#include "program/record/sections.h"
#include "program/record/yaml_out.h"

#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown"
#endif

static void write_plugin(yaml_out *out, const weft_plugin *plugin, const char *file,
                         const weft_stepper_type *method)
{
    yaml_out_write(
        out,
        "plugin: { id: \"%s\", version: \"%s\", solver: \"%s\", file: \"%s\", "
        "abi: %u }",
        plugin->id, plugin->version, plugin->solver, file, (unsigned)plugin->abi);
    yaml_out_write(out,
                   "method: { name: \"%s\", order: %d, error_order: %d, stages: %d, "
                   "reference: \"%s\", license: \"%s\" }",
                   method->name, method->order, method->error_order, method->stages,
                   method->reference, method->license);
}

static void write_option(void *out, const char *name, const char *value)
{
    yaml_out_write(out, "%s: %s", name, value);
}

static void write_config(yaml_out *out, const weft_scene *scene, const weft_sim *sim)
{
    const weft_stepper_config *config = weft_scene_config(scene);
    yaml_out_write(out, "stepper: {");
    if (config->fixed_step > 0.0) {
        yaml_out_write(out, "fixed_step: %g", config->fixed_step);
        if (record_step_differs(scene)) {
            yaml_out_write(out, "fixed_step_asked: %g", weft_scene_step(scene));
        }
    } else {
        yaml_out_write(out,
                       "norm: %s, rtol: %g, atol: { position: %g, velocity: %g }, "
                       "first_step: %g, min_step: %g, max_step: %g",
                       config->norm == WEFT_NORM_MAX ? "max" : "rms", config->rtol,
                       config->atol_position, config->atol_velocity, config->first_step,
                       config->min_step, config->max_step);
    }
    yaml_out_write(out, "options: {");
    weft_sim_options(sim, write_option, out);
    yaml_out_write(out, "} }");
}

record_part_facts record_part_facts_of(const weft_cloth *cloth, size_t k)
{
    record_part_facts out = { .part = weft_cloth_part_at(cloth, k) };
    for (size_t i = out.part.first; i < out.part.first + out.part.count; ++i) {
        out.pinned += weft_cloth_pinned(cloth, i);
        out.mass += weft_cloth_particle_mass(cloth, i);
    }
    return out;
}

void record_cloths(yaml_out *out, const weft_cloth *cloth)
{
    const size_t count = weft_cloth_parts(cloth);
    if (count == 0) {
        return;
    }
    yaml_out_write(out, "cloths: [");
    for (size_t k = 0; k < count; ++k) {
        const record_part_facts of = record_part_facts_of(cloth, k);
        yaml_out_write(out, "{ name: \"%s\", vertices: %zu, pinned: %zu, mass: %g }",
                       of.part.name, of.part.count, of.pinned, of.mass);
    }
    yaml_out_write(out, "]");
}

static void write_limit_def(yaml_out *out, const weft_limit_def *limit)
{
    if (limit->method == WEFT_LIMIT_NONE) {
        return;
    }
    yaml_out_write(out, "limit: { method: %s, solver: %s, strain: %g",
                   limit->method == WEFT_LIMIT_PROVOT ? "provot" : "bridson",
                   limit->solver == WEFT_LIMIT_FAST ? "fast" : "sweep", limit->strain);
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        yaml_out_write(out, "%s: %s", weft_family_name((weft_family)i),
                       yaml_bool(limit->families[i]));
    }
    yaml_out_write(out, "sweeps: %zu, tolerance: %g, velocity: %s }", limit->sweeps,
                   limit->tolerance, limit->keep_velocity ? "keep" : "update");
}

bool record_step_differs(const weft_scene *scene)
{
    const double asked = weft_scene_step(scene);
    return fabs(weft_scene_config(scene)->fixed_step - asked) > 1e-9 * asked;
}

weft_status record_manifest(const char *directory, const weft_scene *scene,
                            const weft_sim *sim, const weft_cloth *whole,
                            const weft_plugin *plugin, const char *plugin_file,
                            weft_error *err)
{
    const weft_run_def *run = weft_scene_run(scene);
    record_file file;
    yaml_out out;
    TRY(record_file_open(&file, directory, "manifest.yaml", err));
    yaml_out_begin(&out, file.stream);
    yaml_out_write(&out, "name: \"%s\", weft: \"%s\", compiler: \"%s\"",
                   weft_scene_name(scene), weft_version(), COMPILER);
    write_plugin(&out, plugin, plugin_file, weft_scene_method_type(scene));
    write_config(&out, scene, sim);
    yaml_out_write(&out, "cloth: {");
    yaml_out_size(&out, whole);
    yaml_out_write(&out,
                   "pinned: %zu, stretch_springs: %zu, shear_springs: %zu, "
                   "bend_pairs: %zu, mass: %g }",
                   weft_cloth_pins(whole), weft_cloth_springs(whole, WEFT_STRETCH),
                   weft_cloth_springs(whole, WEFT_SHEAR),
                   weft_cloth_springs(whole, WEFT_BEND), weft_cloth_mass(whole));
    record_cloths(&out, whole);
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        if (record_sections[i]->manifest != NULL) {
            record_sections[i]->manifest(&out, weft_scene_cloth(scene));
        }
    }
    write_limit_def(&out, weft_scene_limit(scene));
    yaml_out_write(&out,
                   "run: { duration: %g, fps: %g, threads: %zu, checkpoint: %zu }, "
                   "record: { ledger: %s }",
                   run->duration, run->fps, run->threads, run->checkpoint,
                   yaml_bool(weft_scene_record(scene)->ledger));
    return record_file_end(&file, yaml_out_end(&out), err);
}

static void write_spring(yaml_out *out, const weft_cloth *cloth,
                         const weft_spring *worst)
{
    const size_t cols = weft_cloth_cols(cloth), p = worst->p, q = worst->q;
    yaml_out_write(out, "max_strain: %g", worst->strain);
    if (p == q) {
        return;
    }
    yaml_out_write(out, "max_strain_spring: { family: %s",
                   weft_family_name(worst->family));
    if (cols == 0) {
        if (weft_cloth_parts(cloth) > 0) {
            yaml_out_write(
                out, "cloth: \"%s\"",
                weft_cloth_part_at(cloth, weft_cloth_part_of(cloth, p)).name);
        }
        yaml_out_write(out, "from_vertex: %zu, to_vertex: %zu }",
                       weft_cloth_file_index(cloth, p),
                       weft_cloth_file_index(cloth, q));
    } else {
        yaml_out_write(out, "from_row: %zu, from_col: %zu, to_row: %zu, to_col: %zu }",
                       p / cols, p % cols, q / cols, q % cols);
    }
}

static void write_ledger(yaml_out *out, const record_result *result)
{
    const weft_ledger ledger = result->ledger;
    if (ledger.kept) {
        yaml_out_write(out, "dissipated: %g, ledger: {",
                       weft_sim_dissipated(result->sim));
#define WRITE(member, power, by) yaml_out_write(out, #member ": %g", ledger.member);
        WEFT_LEDGER_POWERS(WRITE)
        yaml_out_write(out, "work_limit: %g, residual: %g", ledger.work_limit,
                       ledger.residual);
        WEFT_LEDGER_LATER_POWERS(WRITE)
#undef WRITE
        yaml_out_write(out, "}");
    }
}

static void write_outcome(yaml_out *out, const record_result *result)
{
    const weft_sim *sim = result->sim;
    const weft_stepper_stats stats = weft_sim_stats(sim);
    const weft_limit_stats limit = weft_sim_limit_stats(sim);
    const weft_measures all = result->measures;
    char hash[20];
    yaml_out_write(
        out, "time: %g, steps: %" PRIu64 ", rejected: %" PRIu64 ", rhs_calls: %" PRIu64,
        weft_sim_time(sim), stats.steps, stats.rejected, stats.rhs_calls);
    if (stats.factorisations > 0) { /* the method solves linear systems */
        yaml_out_write(out,
                       "solver: { linear_iterations: %" PRIu64
                       ", factorisations: %" PRIu64 ", newton_failures: %" PRIu64 " }",
                       stats.linear_iterations, stats.factorisations,
                       stats.newton_failures);
    }
    yaml_out_write(out, "last_step: %g", stats.last_step);
    write_spring(out, weft_sim_cloth(sim), &all.worst);
    yaml_out_write(out, "energy_start: %g, energy_end: %g", result->energy_start,
                   weft_energy_total(all.energy));
    write_ledger(out, result);
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        if (record_sections[i]->result != NULL) {
            record_sections[i]->result(out, sim, &all);
        }
    }
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, all.hash);
    yaml_out_write(
        out,
        "limit: { corrected: %" PRIu64 ", sweeps: %" PRIu64 ", unconverged: %" PRIu64
        ", held: %zu, strain: %g }, warnings: %zu, "
        "hash: \"%s\"",
        limit.corrected, limit.sweeps, limit.unconverged, weft_sim_limit_held(sim),
        weft_sim_limit_worst(sim).strain, result->warnings, hash);
}

static void write_end(yaml_out *out, const record_result *result)
{
    yaml_out_write(out, "status: %s, reason: \"%s\"", result->status, result->reason);
}

void record_result_items(yaml_out *out, const record_result *result)
{
    write_end(out, result);
    yaml_out_write(out, "frames: %zu, frames_planned: %zu, wall_time: %g",
                   result->frames, result->planned, result->wall_time);
    if (result->sim != NULL) {
        write_outcome(out, result);
    }
}

weft_status record_result_write(const char *directory, const record_result *result,
                                weft_error *err)
{
    record_file file;
    yaml_out out;
    TRY(record_file_open(&file, directory, "result.yaml", err));
    yaml_out_begin(&out, file.stream);
    record_result_items(&out, result);
    return record_file_end(&file, yaml_out_end(&out), err);
}

weft_status record_result_amend(const char *directory, const record_result *result,
                                weft_error *err)
{
    record_file file;
    yaml_out out;
    char path[RECORD_PATH];
    FILE *former = record_open(directory, "result.yaml", path, NULL);
    if (former == NULL) {
        return record_result_write(directory, result, err);
    }
    weft_status status = record_file_open(&file, directory, "result.yaml", err);
    if (status == WEFT_OK) {
        yaml_out_begin(&out, file.stream);
        write_end(&out, result);
        const bool good = yaml_out_end(&out);
        int line = 1; /* all but the first two, which are status and reason */
        for (int c; (c = getc(former)) != EOF; line += c == '\n') {
            if (line > 2) {
                (void)putc(c, file.stream);
            }
        }
        status = record_file_end(&file, good, err);
    }
    (void)fclose(former);
    return status;
}

/* ---- reading ---------------------------------------------------------------- */

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
