/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_plan.c -- lists the runs of all scenes, and names their directories. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "program/batch/batch.h"

/* ---- names ------------------------------------------------------------------ */

enum { NAME_MAX_CHARS = 120, HASH_DIGITS = 12 };

typedef struct namer {
    char text[NAME_MAX_CHARS + 1];
    size_t used;
    bool lossy;
    uint64_t hash; /* of the whole name */
} namer;

static void add_char(namer *self, char c, bool safe)
{
    self->hash = weft__hash_byte(self->hash, (unsigned char)c);
    /* a leading dot hides a directory, or is none; a leading '-' is an option */
    safe = safe && !(self->used == 0 && (c == '.' || c == '-'));
    self->lossy = self->lossy || !safe || self->used == NAME_MAX_CHARS;
    if (self->used < NAME_MAX_CHARS
        && (safe || self->used == 0 || self->text[self->used - 1] != '_')) {
        self->text[self->used++] = safe ? c : '_';
    }
}

/* The slash of plugin/method becomes a hyphen, and stays readable. */
static void add(namer *self, const char *text, bool method)
{
    static const char letters[]
        = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._+-";
    for (; *text != '\0'; ++text) {
        const char c = method && *text == '/' ? '-' : *text;
        add_char(self, c, strchr(letters, c) != NULL);
    }
}

/* The part of a path behind its last `parts` dots. */
static const char *tail(const char *path, size_t parts)
{
    const char *from = path + strlen(path);
    while (from > path && (from[-1] != '.' || --parts > 0)) {
        --from;
    }
    return from;
}

/* The shortest end of a key's path that no other key has. */
static const char *short_key(const weft_sweep *sweep, size_t key)
{
    const char *path = weft_sweep_key(sweep, key), *shown;
    for (size_t parts = 1; (shown = tail(path, parts)) != path; ++parts) {
        bool single = true;
        for (size_t i = 0; i < weft_sweep_keys(sweep); ++i) {
            single = single
                     && (i == key
                         || strcmp(tail(weft_sweep_key(sweep, i), parts), shown) != 0);
        }
        if (single) {
            break;
        }
    }
    return shown;
}

char *batch_name(const char *stem, const weft_sweep *sweep, size_t number)
{
    namer self = { .hash = WEFT__HASH_START };
    add(&self, stem, false);
    /* not the place of the summary */
    self.lossy = self.lossy || stem[0] == '\0' || strncmp(stem, "summary.csv", 11) == 0;
    for (size_t i = 0; i < weft_sweep_keys(sweep); ++i) {
        add_char(&self, '_', true);
        add(&self, short_key(sweep, i), false);
        add_char(&self, '=', true);
        add(&self, weft_sweep_value(sweep, i, number),
            strcmp(weft_sweep_key(sweep, i), "stepper.method") == 0);
    }
    if (self.lossy) {
        const size_t most = NAME_MAX_CHARS - HASH_DIGITS - 1;
        self.used = self.used < most ? self.used : most;
        self.used += (size_t)snprintf(self.text + self.used, HASH_DIGITS + 2,
                                      "~%012" PRIx64, self.hash >> 16);
    }
    self.text[self.used] = '\0';
    return strdup(self.text);
}

/* ---- scenes ----------------------------------------------------------------- */

static int no_memory(void)
{
    return report_status(WEFT_NO_MEMORY, "no memory for the runs");
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

/* Two runs with one directory have the same values twice, or files of one name. */
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
        const batch_run *a = sorted[i - 1], *b = sorted[i];
        if (strcmp(a->name, b->name) == 0 && a->scene == b->scene) {
            const size_t first = a->number < b->number ? a->number : b->number;
            fprintf(stderr,
                    "%s: error: runs %zu and %zu of its sweep are the same (%s)\n",
                    a->scene->file, first, a->number + b->number - first, a->name);
            code = EXIT_SCENE;
        } else if (strcmp(a->name, b->name) == 0) {
            code
                = usage_error(self->given,
                              "%s and %s would both run into '%s': rename one, or give "
                              "it another --out",
                              a->scene->file, b->scene->file, a->name);
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
