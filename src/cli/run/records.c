/* SPDX-License-Identifier: BSD-3-Clause */
/* records.c -- the files of a run: begun, taken up where they were, closed. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "cli/run/run.h"

void run_remove(const run *self, const char *name)
{
    char path[RECORD_PATH];
    if (record_path(self->out, name, path, NULL) == WEFT_OK) {
        (void)remove(path);
    }
}

weft_status run_in_place(const run *self, weft_error *err)
{
    struct stat now;
    if (stat(self->out, &now) != 0) {
        return weft_error_set(err, WEFT_IO, "%s: %s", self->out, strerror(errno));
    }
    return now.st_dev == self->place.st_dev && now.st_ino == self->place.st_ino
               ? WEFT_OK
               : weft_error_set(
                   err, WEFT_IO,
                   "%s: another directory than that of this run, which was "
                   "moved away: nothing is written to it",
                   self->out);
}

weft_status frames_have_room(const weft_scene *scene, weft_error *err)
{
    const weft_cloth_def *cloth = weft_scene_cloth(scene);
    const size_t planned = record_vtkhdf_planned(
        weft_scene_record(scene), weft_run_last_frame(weft_scene_run(scene)));
    const size_t most = record_vtkhdf_most(cloth->rows * cloth->cols);
    return planned <= most
               ? WEFT_OK
               : weft_error_set(err, WEFT_BAD_SCENE,
                                "run.vtkhdf has room for %zu frames of this cloth, and "
                                "the scene plans %zu: record.every must be larger, or "
                                "run.duration or run.fps smaller",
                                most, planned);
}

weft_status run_prepare(run *self, weft_error *err)
{
    record_checkpoint *next = &self->checkpoint;
    next->state_size = weft_sim_save_size(self->sim);
    next->state = malloc(next->state_size);
    if (next->state == NULL) {
        return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a checkpoint");
    }
    return record_checkpoint_identify(next, self->scene, self->registry, err);
}

/* What the checkpoint counts on is on the disk before it is. Of a run that blows up the
 * last one that can be restored is kept. */
weft_status run_checkpoint(run *self, size_t index, weft_error *err)
{
    record_checkpoint *now = &self->checkpoint;
    now->frame = index;
    now->series = self->series.extent;
    now->extremes = self->summary.extremes;
    now->wall_time = weft__wall_clock() - self->began;
    weft_status status = weft_sim_save(self->sim, now->state, now->state_size, err);
    status = status == WEFT_OK ? run_in_place(self, err) : status;
    if (status != WEFT_OK || !isfinite(weft_sim_ledger(self->sim).residual)) {
        return status;
    }
    status = record_series_sync(&self->series, err);
    if (status == WEFT_OK) {
        status = record_vtkhdf_sync(self->frames, &now->vtkhdf, err);
    }
    return status == WEFT_OK ? record_checkpoint_write(self->out, now, err) : status;
}

static weft_status write_manifest(const run *self, weft_error *err)
{
    weft_registry *registry = self->registry;
    const weft_plugin *plugin;
    const weft_status status
        = weft_registry_find(registry, weft_scene_plugin(self->scene), &plugin, err);
    const char *file = "";
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        file = weft_registry_at(registry, i) == plugin ? weft_registry_file(registry, i)
                                                       : file;
    }
    return status == WEFT_OK
               ? record_manifest(self->out, self->scene, self->sim, plugin, file, err)
               : status;
}

static record_vtkhdf_def frames_of(const run *self)
{
    return (record_vtkhdf_def){
        .directory = self->out,
        .cloth = self->cloth,
        .record = weft_scene_record(self->scene),
        .last = self->result.planned - 1,
        .series = &self->series,
    };
}

/* Names the file that is not as the checkpoint has it and, if the other one tells, the
 * row. */
static weft_status name_damage(const run *self, const char *name, weft_error *err)
{
    char path[RECORD_PATH];
    weft_status status = record_path(self->out, name, path, err);
    status
        = status == WEFT_OK ? record_vtkhdf_compare(self->frames, path, err) : status;
    return status == WEFT_OK
               ? weft_error_set(err, WEFT_IO,
                                "%s: damaged: up to frame %" PRIu64
                                " it is not as it was at " RECORD_CHECKPOINT,
                                path, self->from->frame)
               : status;
}

/* Opens the records of the checkpoint and checks all of them; nothing is written. */
static weft_status look_at_records(run *self, weft_error *err)
{
    const record_checkpoint *from = self->from;
    const record_vtkhdf_def def = frames_of(self);
    bool equal = false;
    weft_status status = record_series_reopen(
        &self->series, self->out, weft_scene_record(self->scene)->ledger, err);
    if (status != WEFT_OK) {
        return status;
    }
    status = record_vtkhdf_reopen(&def, &from->vtkhdf, &self->frames, &equal, err);
    if (status == WEFT_OK
        && record_bytes_sum(self->series.path, 0, from->series.length)
               != from->series.sum) {
        status = name_damage(self, "series.csv", err);
    } else if (status == WEFT_OK && !equal) {
        status = name_damage(self, "run.vtkhdf", err);
    }
    return status;
}

static weft_status cut_records(run *self, weft_error *err)
{
    weft_status status = write_manifest(self, err);
    status = status == WEFT_OK ? record_vtkhdf_cut(self->frames, err) : status;
    return status == WEFT_OK
               ? record_series_cut(&self->series, &self->from->series, err)
               : status;
}

/* What was written of how far it had come. */
static void remove_ends(const run *self)
{
    run_remove(self, "run.html");
    run_remove(self, "result.yaml");
    run_remove(self, "final.csv");
}

/* From t = 0. */
weft_status run_begin(run *self, weft_error *err)
{
    if (self->again) {
        remove_ends(self);
        run_remove(self, "run.vtkhdf");
    }
    const record_vtkhdf_def def = frames_of(self);
    weft_status status
        = record_text(self->out, "scene.yaml", weft_scene_text(self->scene), err);
    status = status == WEFT_OK ? write_manifest(self, err) : status;
    if (status == WEFT_OK) {
        status = record_series_open(&self->series, self->out,
                                    weft_scene_record(self->scene)->ledger, err);
    }
    status
        = status == WEFT_OK ? record_vtkhdf_create(&def, &self->frames, err) : status;
    return status == WEFT_OK ? WEFT_OK : run_close(self, status, NULL);
}

static weft_status restore(const run *self, weft_error *err)
{
    weft_error why = { 0 };
    const record_checkpoint *from = self->from;
    return weft_sim_restore(self->sim, from->state, from->state_size, &why) == WEFT_OK
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s/" RECORD_CHECKPOINT ": %s", self->out,
                                why.message);
}

/* From the checkpoint. */
weft_status run_take_up(run *self, weft_error *err)
{
    const record_checkpoint *from = self->from;
    weft_status status = restore(self, err);
    if (status == WEFT_OK) {
        status = look_at_records(self, err);
        status = status == WEFT_OK ? cut_records(self, err) : status;
        if (status != WEFT_OK) {
            return run_close(self, status, NULL);
        }
    }
    if (status == WEFT_OK) {
        const weft_limit_stats limit = weft_sim_limit_stats(self->sim);
        remove_ends(self);
        self->result.frames = from->frame + 1;
        self->limit_sweeps = limit.sweeps;
        self->told_unconverged = limit.unconverged > 0;
        self->summary.extremes = from->extremes;
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
