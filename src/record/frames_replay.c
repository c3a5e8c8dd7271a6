/* SPDX-License-Identifier: BSD-3-Clause */
/* frames_replay.c -- frames.h by computing a run anew from DIR/scene.yaml: stands in
 * until frames are read from DIR/run.vtkhdf. */
#include "record/frames.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "record/record.h"

struct record_frames {
    size_t rows, cols, count;
    double spacing[2], fps, duration;
    bool families[WEFT_FAMILIES], *pinned;
    double *states; /* count x 6 N */
};

static const weft_plugin *find_plugin(void *ctx, const char *id, weft_error *err)
{
    const weft_plugin *plugin = NULL;
    (void)weft_registry_find(ctx, id, &plugin, err);
    return plugin;
}

static weft_status registry_open(weft_registry **out, weft_error *err)
{
    char directory[2048];
    const ssize_t length = readlink("/proc/self/exe", directory, sizeof directory - 16);
    directory[length < 0 ? 0 : length] = '\0';
    char *slash = strrchr(directory, '/');
    memcpy(slash == NULL ? directory : slash, "/plugins", sizeof "/plugins");
    weft_registry_def def = weft_registry_def_default();
    def.fallback = directory;
    return weft_registry_create(&def, out, err);
}

static weft_status scene_open(const char *directory, weft_registry *registry,
                              weft_scene **out, weft_error *err)
{
    char path[RECORD_PATH];
    weft_scene_def def = weft_scene_def_default();
    weft_diagnostics *found = calloc(1, sizeof *found);
    def.file = path;
    def.find_plugin = find_plugin;
    def.find_ctx = registry;
    weft_status status = record_path(directory, "scene.yaml", path, err);
    if (status == WEFT_OK) {
        status = weft_scene_load(&def, out, found, err);
    }
    free(found);
    return status == WEFT_OK || status == WEFT_NO_MEMORY
               ? status
               : weft_error_set(err, WEFT_IO, "%s: no run there", path);
}

static double time_of(const record_frames *frames, size_t i)
{
    const double t = (double)i / frames->fps;
    return t < frames->duration ? t : frames->duration;
}

static weft_status replay(record_frames *frames, const weft_scene *scene,
                          weft_error *err)
{
    weft_cloth *cloth = NULL;
    weft_sim *sim = NULL;
    weft_status status = weft_cloth_create(weft_scene_cloth(scene), &cloth, err);
    if (status != WEFT_OK) {
        return status;
    }
    const size_t n = weft_cloth_particles(cloth);
    frames->pinned = calloc(n, sizeof *frames->pinned);
    frames->states = calloc(frames->count, 6 * n * sizeof *frames->states);
    weft_sim_def def = weft_sim_def_default();
    def.cloth = cloth;
    def.method = weft_scene_method_type(scene);
    def.config = *weft_scene_config(scene);
    status = weft_sim_create(&def, &sim, err);
    for (size_t p = 0; p < n; ++p) {
        frames->pinned[p] = weft_cloth_pinned(cloth, p);
    }
    for (size_t i = 0; status == WEFT_OK && i < frames->count; ++i) {
        status = weft_sim_advance(sim, time_of(frames, i), err);
        memcpy(frames->states + i * 6 * n, weft_sim_state(sim), 6 * n * sizeof(double));
    }
    weft_sim_destroy(sim);
    weft_cloth_destroy(cloth);
    return status;
}

weft_status record_frames_open(const char *directory, record_frames **out,
                               weft_error *err)
{
    weft_registry *registry = NULL;
    weft_scene *scene = NULL;
    record_frames *frames = calloc(1, sizeof *frames);
    size_t last = 0;
    weft_status status = registry_open(&registry, err);
    if (status == WEFT_OK) {
        status = scene_open(directory, registry, &scene, err);
    }
    if (status == WEFT_OK) {
        status = record_series_last(directory, &last, err);
    }
    if (status == WEFT_OK) {
        const weft_cloth_def *def = weft_scene_cloth(scene);
        frames->rows = def->rows;
        frames->cols = def->cols;
        frames->count = last + 1;
        memcpy(frames->spacing, def->spacing, sizeof frames->spacing);
        frames->fps = weft_scene_run(scene)->fps;
        frames->duration = weft_scene_run(scene)->duration;
        for (size_t i = 0; i < WEFT_FAMILIES; ++i) {
            frames->families[i] = def->springs[i].present;
        }
        status = replay(frames, scene, err);
    }
    weft_scene_destroy(scene);
    weft_registry_destroy(registry);
    if (status != WEFT_OK) {
        record_frames_close(frames);
        frames = NULL;
    }
    *out = frames;
    return status;
}

void record_frames_close(record_frames *frames)
{
    if (frames != NULL) {
        free(frames->pinned);
        free(frames->states);
        free(frames);
    }
}

size_t record_frames_count(const record_frames *frames)
{
    return frames->count;
}

size_t record_frames_rows(const record_frames *frames)
{
    return frames->rows;
}

size_t record_frames_cols(const record_frames *frames)
{
    return frames->cols;
}

double record_frames_time(const record_frames *frames, size_t i)
{
    return time_of(frames, i);
}

bool record_frames_pinned(const record_frames *frames, size_t particle)
{
    return frames->pinned[particle];
}

static void interleave(const record_frames *frames, size_t i, size_t plane, double *xyz)
{
    const size_t n = frames->rows * frames->cols;
    for (size_t p = 0; p < n; ++p) {
        for (size_t k = 0; k < 3; ++k) {
            xyz[3 * p + k] = frames->states[i * 6 * n + (plane + k) * n + p];
        }
    }
}

weft_status record_frames_positions(record_frames *frames, size_t i, double *xyz,
                                    weft_error *err)
{
    (void)err;
    interleave(frames, i, 0, xyz);
    return WEFT_OK;
}

weft_status record_frames_velocities(record_frames *frames, size_t i, double *xyz,
                                     weft_error *err)
{
    (void)err;
    interleave(frames, i, 3, xyz);
    return WEFT_OK;
}

static void pull(const record_frames *frames, const double *y, size_t p, ptrdiff_t dr,
                 ptrdiff_t dc, double *strain)
{
    const size_t n = frames->rows * frames->cols;
    const ptrdiff_t r = (ptrdiff_t)(p / frames->cols) + dr;
    const ptrdiff_t c = (ptrdiff_t)(p % frames->cols) + dc;
    if (r < 0 || c < 0 || r >= (ptrdiff_t)frames->rows
        || c >= (ptrdiff_t)frames->cols) {
        return;
    }
    const size_t q = (size_t)r * frames->cols + (size_t)c;
    double squared = 0.0;
    for (size_t k = 0; k < 3; ++k) {
        squared += (y[k * n + q] - y[k * n + p]) * (y[k * n + q] - y[k * n + p]);
    }
    const double rest
        = hypot((double)dr * frames->spacing[0], (double)dc * frames->spacing[1]);
    const double e = sqrt(squared) / rest - 1.0;
    strain[p] = e > strain[p] ? e : strain[p];
    strain[q] = e > strain[q] ? e : strain[q];
}

weft_status record_frames_strain(record_frames *frames, size_t i, double *strain,
                                 weft_error *err)
{
    static const ptrdiff_t offsets[WEFT_FAMILIES][2][2]
        = { { { 0, 1 }, { 1, 0 } }, { { 1, 1 }, { 1, -1 } }, { { 0, 2 }, { 2, 0 } } };
    const size_t n = frames->rows * frames->cols;
    (void)err;
    for (size_t p = 0; p < n; ++p) {
        strain[p] = -1.0;
    }
    for (size_t f = 0; f < 2 * WEFT_FAMILIES; ++f) {
        for (size_t p = 0; p < n && frames->families[f / 2]; ++p) {
            pull(frames, frames->states + i * 6 * n, p, offsets[f / 2][f % 2][0],
                 offsets[f / 2][f % 2][1], strain);
        }
    }
    return WEFT_OK;
}
