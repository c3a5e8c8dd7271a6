/* SPDX-License-Identifier: BSD-3-Clause */
/* result_write.c -- manifest.yaml: the program and its options; result.yaml: the end of
 * the run. */
#include <inttypes.h>

#include "record/record.h"
#include "record/result.h"
#include "record/yaml_out.h"

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
    yaml_out_map(out, "plugin");
    yaml_out_text(out, "id", plugin->id);
    yaml_out_text(out, "version", plugin->version);
    yaml_out_text(out, "solver", plugin->solver);
    yaml_out_text(out, "file", file);
    yaml_out_plain(out, "abi", "%u", (unsigned)plugin->abi);
    yaml_out_close_map(out);
    yaml_out_map(out, "method");
    yaml_out_text(out, "name", method->name);
    yaml_out_plain(out, "order", "%d", method->order);
    yaml_out_plain(out, "error_order", "%d", method->error_order);
    yaml_out_plain(out, "stages", "%d", method->stages);
    yaml_out_text(out, "reference", method->reference);
    yaml_out_text(out, "license", method->license);
    yaml_out_close_map(out);
}

static void write_option(void *out, const char *name, const char *value)
{
    yaml_out_plain(out, name, "%s", value);
}

static void write_config(yaml_out *out, const weft_scene *scene, const weft_sim *sim)
{
    const weft_stepper_config *config = weft_scene_config(scene);
    yaml_out_map(out, "stepper");
    if (config->fixed_step > 0.0) {
        yaml_out_real(out, "fixed_step", config->fixed_step);
        if (record_step_differs(scene)) {
            yaml_out_real(out, "fixed_step_asked", weft_scene_step(scene));
        }
    } else {
        yaml_out_plain(out, "norm", config->norm == WEFT_NORM_MAX ? "max" : "rms");
        yaml_out_real(out, "rtol", config->rtol);
        yaml_out_map(out, "atol");
        yaml_out_real(out, "position", config->atol_position);
        yaml_out_real(out, "velocity", config->atol_velocity);
        yaml_out_close_map(out);
        yaml_out_real(out, "first_step", config->first_step);
        yaml_out_real(out, "min_step", config->min_step);
        yaml_out_real(out, "max_step", config->max_step);
    }
    yaml_out_map(out, "options");
    weft_sim_options(sim, write_option, out);
    yaml_out_close_map(out);
    yaml_out_close_map(out);
}

static void write_cloth(yaml_out *out, const weft_cloth *cloth)
{
    yaml_out_map(out, "cloth");
    yaml_out_size(out, cloth);
    yaml_out_plain(out, "pinned", "%zu", weft_cloth_pins(cloth));
    yaml_out_plain(out, "stretch_springs", "%zu",
                   weft_cloth_springs(cloth, WEFT_STRETCH));
    yaml_out_plain(out, "shear_springs", "%zu", weft_cloth_springs(cloth, WEFT_SHEAR));
    yaml_out_plain(out, "bend_springs", "%zu", weft_cloth_springs(cloth, WEFT_BEND));
    yaml_out_real(out, "mass", weft_cloth_mass(cloth));
    yaml_out_close_map(out);
}

static void write_limit_def(yaml_out *out, const weft_limit_def *limit)
{
    if (limit->method == WEFT_LIMIT_NONE) {
        return;
    }
    yaml_out_map(out, "limit");
    yaml_out_plain(out, "method",
                   limit->method == WEFT_LIMIT_PROVOT ? "provot" : "bridson");
    yaml_out_plain(out, "solver", limit->solver == WEFT_LIMIT_FAST ? "fast" : "sweep");
    yaml_out_real(out, "strain", limit->strain);
    for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
        yaml_out_plain(out, weft_family_name((weft_family)i), "%s",
                       limit->families[i] ? "true" : "false");
    }
    yaml_out_plain(out, "sweeps", "%zu", limit->sweeps);
    yaml_out_real(out, "tolerance", limit->tolerance);
    yaml_out_plain(out, "velocity", limit->keep_velocity ? "keep" : "update");
    yaml_out_close_map(out);
}

static void write_contact_def(yaml_out *out, const weft_contact_def *contact)
{
    if (contact->shape_count == 0 && !contact->self) {
        return;
    }
    yaml_out_map(out, "contact");
    yaml_out_real(out, "thickness", contact->thickness);
    yaml_out_real(out, "stopping_speed", contact->stopping_speed);
    yaml_out_plain(out, "exponent", "%d", contact->exponent);
    yaml_out_real(out, "damping", contact->damping);
    yaml_out_real(out, "friction", contact->friction);
    yaml_out_plain(out, "law",
                   contact->law == WEFT_FRICTION_SMOOTH ? "smooth" : "coulomb");
    yaml_out_real(out, "slip", contact->slip);
    yaml_out_plain(out, "self", contact->self ? "true" : "false");
    yaml_out_plain(out, "shapes", "%zu", contact->shape_count);
    yaml_out_close_map(out);
}

static void write_run(yaml_out *out, const weft_run_def *run)
{
    yaml_out_map(out, "run");
    yaml_out_real(out, "duration", run->duration);
    yaml_out_real(out, "fps", run->fps);
    yaml_out_plain(out, "threads", "%zu", run->threads);
    yaml_out_plain(out, "checkpoint", "%zu", run->checkpoint);
    yaml_out_close_map(out);
}

static weft_status commit(bool good, record_file *file, weft_error *err)
{
    if (!good) {
        record_file_discard(file);
        return weft_error_set(err, WEFT_IO, "%s: write failed", file->path);
    }
    return record_file_commit(file, err);
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
    record_file file;
    yaml_out out;
    const weft_status status = record_file_open(&file, directory, "manifest.yaml", err);
    if (status != WEFT_OK) {
        return status;
    }
    yaml_out_begin(&out, file.stream);
    yaml_out_text(&out, "name", weft_scene_name(scene));
    yaml_out_text(&out, "weft", weft_version());
    yaml_out_text(&out, "compiler", COMPILER);
    write_plugin(&out, plugin, plugin_file, weft_scene_method_type(scene));
    write_config(&out, scene, sim);
    write_cloth(&out, whole);
    write_contact_def(&out, &weft_scene_cloth(scene)->contact);
    write_limit_def(&out, weft_scene_limit(scene));
    write_run(&out, weft_scene_run(scene));
    yaml_out_map(&out, "record");
    yaml_out_plain(&out, "ledger", weft_scene_record(scene)->ledger ? "true" : "false");
    yaml_out_close_map(&out);
    return commit(yaml_out_end(&out), &file, err);
}

static void write_spring(yaml_out *out, const weft_cloth *cloth,
                         const weft_spring *worst)
{
    const size_t cols = weft_cloth_cols(cloth);
    yaml_out_real(out, "max_strain", worst->strain);
    if (worst->p != worst->q) {
        yaml_out_map(out, "max_strain_spring");
        yaml_out_plain(out, "family", "%s", weft_family_name(worst->family));
    }
    if (worst->p != worst->q && cols == 0) {
        yaml_out_plain(out, "from_vertex", "%zu", weft_cloth_name(cloth, worst->p));
        yaml_out_plain(out, "to_vertex", "%zu", weft_cloth_name(cloth, worst->q));
        yaml_out_close_map(out);
    } else if (worst->p != worst->q) {
        yaml_out_plain(out, "from_row", "%zu", worst->p / cols);
        yaml_out_plain(out, "from_col", "%zu", worst->p % cols);
        yaml_out_plain(out, "to_row", "%zu", worst->q / cols);
        yaml_out_plain(out, "to_col", "%zu", worst->q % cols);
        yaml_out_close_map(out);
    }
}

static void write_ledger(yaml_out *out, const record_result *result)
{
    const weft_ledger ledger = result->ledger;
    if (ledger.kept) {
        yaml_out_real(out, "dissipated", weft_sim_dissipated(result->sim));
        yaml_out_map(out, "ledger");
        yaml_out_real(out, "dissipated_springs", ledger.dissipated_springs);
        yaml_out_real(out, "dissipated_drag", ledger.dissipated_drag);
        yaml_out_real(out, "work_wind", ledger.wind_work);
        yaml_out_real(out, "work_pins", ledger.pin_work);
        yaml_out_real(out, "work_limit", ledger.limit_work);
        yaml_out_real(out, "residual", ledger.residual);
        yaml_out_real(out, "dissipated_contact", ledger.dissipated_contact);
        yaml_out_real(out, "dissipated_friction", ledger.dissipated_friction);
        yaml_out_real(out, "shape_work", ledger.shape_work);
        yaml_out_close_map(out);
    }
}

static void write_limit(yaml_out *out, const weft_sim *sim)
{
    const weft_limit_stats stats = weft_sim_limit_stats(sim);
    yaml_out_map(out, "limit");
    yaml_out_plain(out, "corrected", "%" PRIu64, stats.corrected);
    yaml_out_plain(out, "sweeps", "%" PRIu64, stats.sweeps);
    yaml_out_plain(out, "unconverged", "%" PRIu64, stats.unconverged);
    yaml_out_plain(out, "held", "%zu", weft_sim_limit_held(sim));
    yaml_out_real(out, "strain", weft_sim_limit_worst(sim).strain);
    yaml_out_close_map(out);
}

static void write_contact(yaml_out *out, const weft_sim *sim, const weft_measures *all)
{
    const bool shapes = weft_cloth_shapes(weft_sim_cloth(sim)) > 0;
    const bool self = weft_cloth_contact(weft_sim_cloth(sim)).self;
    if (shapes || self) {
        yaml_out_map(out, "contact");
        yaml_out_real(out, "energy", all->energy.contact);
        if (shapes) {
            yaml_out_real(out, "min_gap", all->gap);
            yaml_out_plain(out, "touching", "%zu", all->touching);
        }
        if (self) {
            yaml_out_real(out, "self_gap", all->self_gap);
            yaml_out_plain(out, "self_touching", "%zu", all->self_touching);
        }
        yaml_out_plain(out, "vetoed", "%" PRIu64, weft_sim_vetoed(sim));
        yaml_out_close_map(out);
    }
}

/* Nothing of a method that solves no linear systems. */
static void write_solver(yaml_out *out, const weft_stepper_stats *stats)
{
    if (stats->factorisations > 0) {
        yaml_out_map(out, "solver");
        yaml_out_plain(out, "linear_iterations", "%" PRIu64, stats->linear_iterations);
        yaml_out_plain(out, "factorisations", "%" PRIu64, stats->factorisations);
        yaml_out_plain(out, "newton_failures", "%" PRIu64, stats->newton_failures);
        yaml_out_close_map(out);
    }
}

static void write_outcome(yaml_out *out, const record_result *result)
{
    const weft_cloth *cloth = weft_sim_cloth(result->sim);
    const weft_stepper_stats stats = weft_sim_stats(result->sim);
    const weft_measures all = result->measures;
    yaml_out_real(out, "time", weft_sim_time(result->sim));
    yaml_out_plain(out, "steps", "%" PRIu64, stats.steps);
    yaml_out_plain(out, "rejected", "%" PRIu64, stats.rejected);
    yaml_out_plain(out, "rhs_calls", "%" PRIu64, stats.rhs_calls);
    write_solver(out, &stats);
    yaml_out_real(out, "last_step", stats.last_step);
    write_spring(out, cloth, &all.worst);
    yaml_out_real(out, "energy_start", result->energy_start);
    yaml_out_real(out, "energy_end", weft_energy_total(all.energy));
    write_ledger(out, result);
    write_contact(out, result->sim, &all);
    write_limit(out, result->sim);
    yaml_out_plain(out, "warnings", "%zu", result->warnings);
    char hash[20];
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, all.hash);
    yaml_out_text(out, "hash", hash);
}

static void write_end(yaml_out *out, const record_result *result)
{
    yaml_out_plain(out, "status", "%s", result->status);
    yaml_out_text(out, "reason", result->reason);
}

void record_result_items(yaml_out *out, const record_result *result)
{
    write_end(out, result);
    yaml_out_plain(out, "frames", "%zu", result->frames);
    yaml_out_plain(out, "frames_planned", "%zu", result->planned);
    yaml_out_real(out, "wall_time", result->wall_time);
    if (result->sim != NULL) {
        write_outcome(out, result);
    }
}

weft_status record_result_write(const char *directory, const record_result *result,
                                weft_error *err)
{
    record_file file;
    yaml_out out;
    const weft_status status = record_file_open(&file, directory, "result.yaml", err);
    if (status != WEFT_OK) {
        return status;
    }
    yaml_out_begin(&out, file.stream);
    record_result_items(&out, result);
    return commit(yaml_out_end(&out), &file, err);
}

/* Copies all lines but the first two, which are status and reason. */
static void copy_outcome(FILE *from, FILE *to)
{
    int line = 1;
    for (int c; (c = getc(from)) != EOF; line += c == '\n') {
        if (line > 2) {
            (void)putc(c, to);
        }
    }
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
        copy_outcome(former, file.stream);
        status = commit(good, &file, err);
    }
    (void)fclose(former);
    return status;
}
