/* SPDX-License-Identifier: BSD-3-Clause */
/* records.c -- the files of a run: begun, taken up where they were, closed. */
#include <stdlib.h>

#include "cli/run.h"

void run_remove(const run *self, const char *name)
{
    char path[RECORD_PATH];
    if (record_path(self->out, name, path, NULL) == WEFT_OK) {
        (void)remove(path);
    }
}

weft_status run_prepare(run *self, weft_registry *registry, weft_error *err)
{
    record_checkpoint *next = &self->checkpoint;
    next->state_size = weft_sim_save_size(self->sim);
    next->state = malloc(next->state_size);
    if (next->state == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a checkpoint");
    }
    return resume_identity(self->scene, registry, next, err);
}

/* What the checkpoint counts on is on the disk before it is. */
weft_status run_checkpoint(void *ctx, size_t index, weft_error *err)
{
    run *self = ctx;
    record_checkpoint *now = &self->checkpoint;
    now->frame = index;
    now->wall_time = wall_clock() - self->began;
    weft_status status = weft_sim_save(self->sim, now->state, now->state_size, err);
    if (status == WEFT_OK) {
        status = record_series_sync(&self->series, &now->series_bytes, err);
    }
    if (status == WEFT_OK) {
        status = record_vtkhdf_sync(self->frames, &now->frames, err);
    }
    return status == WEFT_OK ? record_checkpoint_write(self->out, now, err) : status;
}

/* What can be known before the first step. */
static weft_status write_first_files(const run *self, weft_registry *registry,
                                     weft_error *err)
{
    const weft_plugin *plugin;
    weft_status status
        = weft_registry_find(registry, weft_scene_plugin(self->scene), &plugin, err);
    const char *file = "";
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        file = weft_registry_at(registry, i) == plugin ? weft_registry_file(registry, i)
                                                       : file;
    }
    if (status == WEFT_OK) {
        status
            = record_text(self->out, "scene.yaml", weft_scene_text(self->scene), err);
    }
    if (status == WEFT_OK) {
        status = record_manifest(self->out, self->scene, self->sim, plugin, file, err);
    }
    return status;
}

static weft_status open_frames(run *self, weft_error *err)
{
    const record_vtkhdf_def frames = {
        .directory = self->out,
        .cloth = self->cloth,
        .record = weft_scene_record(self->scene),
        .last = self->result.planned - 1,
        .series = &self->series,
    };
    return self->from == NULL
               ? record_vtkhdf_create(&frames, &self->frames, err)
               : record_vtkhdf_reopen(&frames, self->from->frames, &self->frames, err);
}

/* Where they were, nothing is cut before all of them are found to be good. */
static weft_status open_records(run *self, weft_error *err)
{
    const bool ledger = weft_scene_record(self->scene)->ledger;
    weft_status status
        = self->from == NULL
              ? record_series_open(&self->series, self->out, ledger, err)
              : record_series_reopen(&self->series, self->out, ledger, err);
    if (status != WEFT_OK) {
        return status;
    }
    status = open_frames(self, err);
    if (status == WEFT_OK && self->from != NULL) {
        status = record_series_cut(&self->series, self->from->series_bytes, err);
    }
    if (status != WEFT_OK) {
        (void)record_vtkhdf_close(self->frames, NULL);
        (void)record_series_close(&self->series, NULL);
    }
    return status;
}

/* What was written of how far it had come. */
static void remove_ends(const run *self)
{
    run_remove(self, "run.html");
    run_remove(self, "result.yaml");
    run_remove(self, "final.csv");
}

/* From t = 0. */
weft_status run_begin(run *self, weft_registry *registry, weft_error *err)
{
    if (self->again) {
        remove_ends(self);
        run_remove(self, "run.vtkhdf");
    }
    const weft_status status = write_first_files(self, registry, err);
    return status == WEFT_OK ? open_records(self, err) : status;
}

/* From the checkpoint. On failure all files are as before. */
weft_status run_take_up(run *self, weft_error *err)
{
    const record_checkpoint *from = self->from;
    weft_status status = resume_state(self->out, from, self->sim, err);
    if (status == WEFT_OK) {
        status = open_records(self, err);
    }
    if (status == WEFT_OK) {
        const weft_limit_stats limit = weft_sim_limit_stats(self->sim);
        remove_ends(self);
        self->result.frames = from->frame + 1;
        self->limit_sweeps = limit.sweeps;
        self->told_unconverged = limit.unconverged > 0;
        self->began -= from->wall_time;
    }
    return status;
}

/* The first thing that went wrong is told. */
weft_status run_close(run *self, weft_status status, weft_error *err)
{
    const weft_status frames
        = record_vtkhdf_close(self->frames, status == WEFT_OK ? err : NULL);
    status = status == WEFT_OK ? frames : status;
    const weft_status series
        = record_series_close(&self->series, status == WEFT_OK ? err : NULL);
    return status == WEFT_OK ? series : status;
}
