/* SPDX-License-Identifier: BSD-3-Clause */
/* records.c -- opens, reopens and closes the files of a run. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "program/record/sections.h"
#include "program/run/run.h"

weft_status run_agree(const run *self, weft_status status, weft_error *err)
{
    return weft_comm_agree(self->comm, status, err);
}

void run_remove(const run *self, const char *name)
{
    char path[RECORD_PATH];
    if (ranks_first(self->comm)
        && record_path(self->out, name, path, NULL) == WEFT_OK) {
        (void)remove(path);
    }
}

weft_status run_in_place(const run *self, weft_error *err)
{
    struct stat now;
    weft_status status = WEFT_OK;
    if (ranks_first(self->comm) && stat(self->out, &now) != 0) {
        status = record_failed(self->out, err);
    } else if (ranks_first(self->comm)
               && (now.st_dev != self->place.st_dev
                   || now.st_ino != self->place.st_ino)) {
        status = weft_error_set(err, WEFT_IO,
                                "%s: another directory than that of this run, which "
                                "was moved away: nothing is written to it",
                                self->out);
    }
    return run_agree(self, status, err);
}

weft_status run_state(const run *self, const double **y, double **gathered,
                      weft_error *err)
{
    const weft_comm *comm = self->comm;
    size_t skip;
    const size_t own = record_own(self->cloth, &skip);
    const size_t here = weft_cloth_particles(self->cloth);
    const size_t all = weft_cloth_def_particles(weft_scene_cloth(self->scene));
    const bool needed = comm != NULL && comm->rank == 0;
    *gathered = needed ? malloc(6 * all * sizeof **gathered) : NULL;
    *y = comm == NULL ? weft_sim_state(self->sim) : *gathered;
    weft_status status = WEFT_OK;
    if (needed && *gathered == NULL) {
        status = weft_error_set(err, WEFT_NO_MEMORY, "no memory for the whole state");
    }
    status = run_agree(self, status, err);
    for (size_t k = 0; comm != NULL && status == WEFT_OK && k < 6; ++k) {
        const double *mine = weft_sim_state(self->sim) + k * here + skip;
        comm->gather(comm->self, mine, own * sizeof *mine,
                     needed ? *gathered + k * all : NULL);
    }
    return status;
}

#define LARGE_FILE 1e10 /* [bytes] of run.vtkhdf: told beforehand */

double frames_bytes(const weft_scene *scene, size_t *planned)
{
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const weft_record_def *record = weft_scene_record(scene);
    const size_t last = weft_run_last_frame(weft_scene_run(scene));
    *planned = record_vtkhdf_planned(record, last);
    return (double)*planned
           * (double)record_vtkhdf_frame(record, weft_cloth_def_particles(cloth));
}

weft_status frames_have_room(const weft_scene *scene, weft_error *err)
{
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const size_t most = record_vtkhdf_most(weft_cloth_def_particles(cloth));
    size_t planned;
    const double bytes = frames_bytes(scene, &planned);
    if (bytes > LARGE_FILE) {
        fprintf(
            stderr,
            "weft: warning: run.vtkhdf has %zu frames and %.3g GB in the end; it "
            "takes that space as they are written, but a copy may take all at once\n",
            planned, 1e-9 * bytes);
    }
    return planned <= most
               ? WEFT_OK
               : weft_error_set(err, WEFT_BAD_SCENE,
                                "run.vtkhdf has room for %zu frames of this cloth, and "
                                "the scene plans %zu: record.every must be larger, or "
                                "run.duration or run.fps smaller",
                                most, planned);
}

/* The records reach the disk before the checkpoint that needs them. When a run blows
 * up, the last checkpoint that can be restored is kept. */
weft_status run_checkpoint(run *self, size_t index, weft_error *err)
{
    record_checkpoint *now = &self->checkpoint;
    now->frame = index;
    now->series = self->series.table.extent;
    now->shapes = self->shapes.extent;
    now->extremes = self->extremes;
    now->wall_time = weft__wall_clock() - self->began;
    TRY(run_in_place(self, err));
    if (!isfinite(weft_sim_ledger(self->sim).residual)) {
        return weft_sim_restart(self->sim, err);
    }
    TRY(run_agree(self, record_table_sync(&self->series.table, err), err));
    TRY(run_agree(self, record_table_sync(&self->shapes, err), err));
    TRY(record_vtkhdf_sync(self->frames, &now->vtkhdf, err));
    return record_checkpoint_write(self->out, now, self->sim, self->comm, err);
}

static weft_status write_manifest(const run *self, weft_error *err)
{
    weft_registry *registry = self->given->registry;
    const weft_plugin *plugin;
    const char *file = "";
    TRY(weft_registry_find(registry, weft_scene_plugin(self->scene), &plugin, err));
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        file = weft_registry_at(registry, i) == plugin ? weft_registry_file(registry, i)
                                                       : file;
    }
    return record_manifest(self->out, self->scene, self->sim,
                           self->whole == NULL ? self->cloth : self->whole, plugin,
                           file, err);
}

static record_vtkhdf_def frames_of(const run *self)
{
    return (record_vtkhdf_def){
        .directory = self->out,
        .cloth = self->cloth,
        .whole = self->whole,
        .comm = self->comm,
        .record = weft_scene_record(self->scene),
        .last = self->result.planned - 1,
        .series = &self->series,
    };
}

/* Names the damaged file and, if the other file shows it, the row. */
static weft_status name_damage(const run *self, const char *name, weft_error *err)
{
    char path[RECORD_PATH];
    TRY(record_path(self->out, name, path, err));
    TRY(record_vtkhdf_compare(self->frames, path, err));
    return weft_error_set(err, WEFT_IO,
                          "%s: damaged: up to frame %" PRIu64
                          " it is not as it was at " RECORD_CHECKPOINT,
                          path, self->from->frame);
}

static bool is_intact(const record_table *table, const record_extent *kept)
{
    return table->stream == NULL
           || record_bytes_sum(table->path, 0, kept->length) == kept->sum;
}

unsigned series_columns(const weft_scene *scene)
{
    const uint32_t flags = weft_scene_method_type(scene)->flags;
    return (weft_scene_record(scene)->ledger ? RECORD_LEDGER : 0u)
           | ((flags & WEFT_STEPPER_LINEAR) != 0 ? RECORD_SOLVER : 0u)
           | record_section_columns(weft_scene_cloth(scene))
           | (weft_scene_run(scene)->interpolate ? RECORD_BETWEEN : 0u);
}

/* New ones, or `again` those that are there. On other ranks they only have columns. */
static weft_status open_tables(run *self, bool again, weft_error *err)
{
    const unsigned columns = series_columns(self->scene);
    if (!ranks_first(self->comm)) {
        record_series_begin(&self->series, columns, self->scene);
        return WEFT_OK;
    }
    if (!again) {
        TRY(record_scene_text(self->out, "scene.yaml", self->scene, err));
        TRY(write_manifest(self, err));
    }
    TRY(record_series_open(&self->series, self->out, columns, self->scene, again, err));
    return record_shapes_open(&self->shapes, self->out, self->cloth, again, err);
}

static weft_status check_sums(run *self, bool equal, weft_error *err)
{
    const record_checkpoint *from = self->from;
    const char *damaged = !is_intact(&self->series.table, &from->series) ? "series.csv"
                          : !equal                                       ? "run.vtkhdf"
                          : !is_intact(&self->shapes, &from->shapes)     ? "shapes.csv"
                                                                         : NULL;
    return damaged == NULL ? WEFT_OK : name_damage(self, damaged, err);
}

/* Opens the records of the checkpoint and checks all of them; writes nothing. */
static weft_status check_records(run *self, weft_error *err)
{
    record_vtkhdf_def def = frames_of(self);
    bool equal = false;
    def.last = self->from->last;
    TRY(run_agree(self, open_tables(self, true, err), err));
    TRY(record_vtkhdf_reopen(&def, &self->from->vtkhdf, &self->frames, &equal, err));
    return run_agree(self, check_sums(self, equal, err), err);
}

static weft_status cut_tables(run *self, weft_error *err)
{
    TRY(record_table_cut(&self->shapes, &self->from->shapes, err));
    return record_table_cut(&self->series.table, &self->from->series, err);
}

/* The files that an earlier attempt wrote at its end. */
static void remove_ends(const run *self)
{
    run_remove(self, "run.html");
    run_remove(self, "result.yaml");
    run_remove(self, "final.csv");
    run_remove(self, RECORD_SENSITIVITY);
}

static bool is_longer(const run *self)
{
    return self->from->scene != self->checkpoint.scene;
}

/* Until run_checkpoint, a run that is killed starts again. */
static weft_status make_longer(run *self, weft_error *err)
{
    record_vtkhdf *longer = NULL;
    const weft_status status
        = record_vtkhdf_grow(self->frames, self->result.planned - 1, &longer, err);
    (void)record_vtkhdf_close(self->frames, NULL);
    self->frames = longer;
    TRY(status);
    TRY(write_manifest(self, err));
    remove_ends(self);
    run_remove(self, RECORD_CHECKPOINT);
    TRY(record_scene_text(self->out, "scene.yaml", self->scene, err));
    TRY(record_vtkhdf_publish(self->frames, err));
    return cut_tables(self, err);
}

/* To the checkpoint's frame. */
static weft_status reopen_records(run *self, weft_error *err)
{
    TRY(check_records(self, err));
    if (is_longer(self)) {
        return make_longer(self, err);
    }
    TRY(run_agree(self, ranks_first(self->comm) ? write_manifest(self, err) : WEFT_OK,
                  err));
    TRY(record_vtkhdf_cut(self->frames, err));
    return run_agree(self, cut_tables(self, err), err);
}

weft_status run_begin(run *self, weft_error *err)
{
    if (self->again) {
        remove_ends(self);
        run_remove(self, "run.vtkhdf");
    }
    const record_vtkhdf_def def = frames_of(self);
    weft_status status = run_agree(self, open_tables(self, false, err), err);
    if (status == WEFT_OK) {
        status = run_agree(self, record_vtkhdf_create(&def, &self->frames, err), err);
    }
    return status == WEFT_OK ? WEFT_OK : run_close(self, status, NULL);
}

weft_status run_take_up(run *self, weft_error *err)
{
    const record_checkpoint *from = self->from;
    TRY(record_checkpoint_restore(self->from, self->sim, err));
    const weft_status status = reopen_records(self, err);
    if (status != WEFT_OK) {
        return run_close(self, status, NULL);
    }
    const weft_limit_stats limit = weft_sim_limit_stats(self->sim);
    remove_ends(self);
    self->result.frames = from->frame + 1;
    self->limit_sweeps = limit.sweeps;
    self->extremes = from->extremes;
    self->began -= from->wall_time;
    return is_longer(self) ? run_checkpoint(self, from->frame, err) : WEFT_OK;
}

/* Reports the first error. */
weft_status run_close(run *self, weft_status status, weft_error *err)
{
    const weft_status frames
        = record_vtkhdf_close(self->frames, status == WEFT_OK ? err : NULL);
    status = status == WEFT_OK ? frames : status;
    record_table *const tables[] = { &self->series.table, &self->shapes };
    for (size_t i = 0; i < 2; ++i) {
        const weft_status table
            = record_table_close(tables[i], status == WEFT_OK ? err : NULL);
        status = status == WEFT_OK ? table : status;
    }
    return status;
}
