/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_plan.c -- lists the runs of all scenes. */
#include <stdlib.h>
#include <string.h>

#include "cli/batch/batch.h"

static int no_memory(void)
{
    weft_error err = { 0 };
    weft_error_set(&err, WEFT_NO_MEMORY, "no memory for the runs");
    return report_error(&err);
}

/* The file's name without folders and without .yaml. */
static char *stem_of(const char *file)
{
    const char *slash = strrchr(file, '/');
    char *stem = strdup(slash == NULL ? file : slash + 1);
    char *dot = stem == NULL ? NULL : strrchr(stem, '.');
    if (dot != NULL && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0)) {
        *dot = '\0';
    }
    return stem;
}

/* Reads all scenes, so that all mistakes are reported. */
static int read_scenes(batch *self)
{
    int code = EXIT_DONE;
    self->scene_count = (size_t)self->given->operand_count;
    self->scenes = calloc(self->scene_count, sizeof *self->scenes);
    if (self->scenes == NULL) {
        return no_memory();
    }
    for (size_t i = 0; i < self->scene_count; ++i) {
        batch_scene *scene = &self->scenes[i];
        scene->file = self->given->operands[i];
        scene->stem = stem_of(scene->file);
        const int one = scene->stem == NULL
                            ? no_memory()
                            : open_scene(scene->file, self->given, NULL, &scene->sweep);
        code = code == EXIT_DONE ? one : code;
    }
    return code;
}

static bool name_runs(batch *self)
{
    for (size_t i = 0; i < self->scene_count; ++i) {
        self->run_count += weft_sweep_runs(self->scenes[i].sweep);
    }
    self->runs = calloc(self->run_count, sizeof *self->runs);
    batch_run *run = self->runs;
    for (size_t i = 0; run != NULL && i < self->scene_count; ++i) {
        const batch_scene *scene = &self->scenes[i];
        for (size_t k = 1; k <= weft_sweep_runs(scene->sweep); ++k, ++run) {
            *run = (batch_run){ .scene = scene,
                                .number = k,
                                .name = batch_name(scene->stem, scene->sweep, k) };
            if (run->name == NULL) {
                return false;
            }
        }
    }
    return run != NULL;
}

static int by_name(const void *a, const void *b)
{
    const batch_run *const *left = a, *const *right = b;
    return strcmp((*left)->name, (*right)->name);
}

/* Two runs with one directory: the same values twice, or files of one name. */
static int report_twins(const batch *self, const batch_run *a, const batch_run *b)
{
    if (a->scene == b->scene) {
        fprintf(stderr, "%s: error: runs %zu and %zu of its sweep are the same (%s)\n",
                a->scene->file, a->number < b->number ? a->number : b->number,
                a->number < b->number ? b->number : a->number, a->name);
        return EXIT_SCENE;
    }
    return usage_error(self->given,
                       "%s and %s would both run into '%s': rename one, or give it "
                       "another --out",
                       a->scene->file, b->scene->file, a->name);
}

static int check_names(const batch *self)
{
    const batch_run **sorted = malloc(self->run_count * sizeof *sorted);
    int code = EXIT_DONE;
    if (sorted == NULL) {
        return no_memory();
    }
    for (size_t i = 0; i < self->run_count; ++i) {
        sorted[i] = &self->runs[i];
    }
    qsort(sorted, self->run_count, sizeof *sorted, by_name);
    for (size_t i = 1; i < self->run_count && code == EXIT_DONE; ++i) {
        if (strcmp(sorted[i - 1]->name, sorted[i]->name) == 0) {
            code = report_twins(self, sorted[i - 1], sorted[i]);
        }
    }
    free(sorted);
    return code;
}

static void free_runs(batch *self)
{
    for (size_t i = 0; self->runs != NULL && i < self->run_count; ++i) {
        free(self->runs[i].name);
    }
    free(self->runs);
}

int batch_check(const arguments *given, const char *file, weft_sweep *sweep)
{
    batch_scene scene = { .file = file, .stem = stem_of(file), .sweep = sweep };
    batch self = { .given = given, .scenes = &scene, .scene_count = 1 };
    const int code
        = scene.stem != NULL && name_runs(&self) ? check_names(&self) : no_memory();
    free_runs(&self);
    free(scene.stem);
    return code;
}

int batch_plan(batch *self)
{
    const int code = read_scenes(self);
    return code != EXIT_DONE ? code : name_runs(self) ? check_names(self) : no_memory();
}

void batch_free(batch *self)
{
    free_runs(self);
    for (size_t i = 0; self->scenes != NULL && i < self->scene_count; ++i) {
        weft_sweep_destroy(self->scenes[i].sweep);
        free(self->scenes[i].stem);
    }
    free(self->scenes);
}
