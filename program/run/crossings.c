/* SPDX-License-Identifier: BSD-3-Clause */
/* crossings.c -- start-crossings.obj in the directory of a run whose start crosses. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program/run/run.h"

/* A directory that a run may take, or with --force any: nothing in it is removed. */
static weft_status claim(const arguments *given, const char *out, int *lock,
                         weft_error *err)
{
    TRY(record_outdir_lock(out, RECORD_PATIENCE, lock, err));
    return given->force ? WEFT_OK : record_outdir(out, false, err);
}

static weft_status write_pairs(const arguments *given, const char *out,
                               const weft_scene *scene, weft_error *err)
{
    int lock = -1;
    weft_cloth *cloth = NULL;
    double *y = NULL;
    TRY(cloth_create(scene, weft_scene_cloth(scene), &cloth, err));
    weft_status status = start_create(scene, cloth, false, &y, err);
    if (status == WEFT_OK && weft_cloth_each_crossing(cloth, y, NULL, NULL) > 0) {
        status = claim(given, out, &lock, err);
        status = status == WEFT_OK ? record_crossings(out, cloth, y, err) : status;
    }
    if (lock >= 0) {
        (void)close(lock);
    }
    free(y);
    weft_cloth_destroy(cloth);
    return status;
}

void crossings_of_mistake(const arguments *given, const char *out)
{
    const char **sets = malloc((given->sets.count + 1) * sizeof *sets);
    weft_scene *scene = NULL;
    weft_error err = { 0 };
    if (sets == NULL || given->comm != NULL) {
        free(sets);
        return;
    }
    for (size_t i = 0; i < given->sets.count; ++i) {
        sets[i] = given->sets.at[i];
    }
    sets[given->sets.count] = "contact.untangle=1";
    arguments other = *given;
    other.sets = (texts){ sets, given->sets.count + 1 };
    other.silent = true;
    if (open_scene(given->operands[0], &other, &scene, NULL) == EXIT_DONE
        && write_pairs(given, out, scene, &err) != WEFT_OK) {
        (void)report_error(&err);
    }
    weft_scene_destroy(scene);
    free(sets);
}
