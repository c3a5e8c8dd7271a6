/* SPDX-License-Identifier: BSD-3-Clause */
/* reports.h -- what sections of a scene add to what verbs print: each verb asks all of
 * the table in reports.c, in its order. */
#pragma once

#include "program/cli.h"
#include "program/record/yaml_out.h"

/* A member that is NULL adds nothing. */
typedef struct report_section {
    /* weft check: for people, for machines, and warnings on stderr. */
    void (*check)(const weft_scene *scene, const weft_cloth *cloth);
    void (*check_yaml)(yaml_out *out, const weft_scene *scene);
    void (*warn)(const char *file, const weft_cloth_def *def);

    /* The end of a run. */
    void (*summary)(const weft_scene *scene, const weft_sim *sim,
                    const weft_measures *all);

    /* What helps where it holds the step of a run that failed; false: it does not. */
    bool (*advise)(const weft_failure *failure, const weft_cloth *cloth, sentence *out);

    /* Whether parts of the cloth may touch something, which makes it stiffer. */
    bool (*touches)(const weft_cloth_def *def);
} report_section;

enum { REPORT_SECTIONS = 2 };
extern const report_section *const report_sections[REPORT_SECTIONS];

bool report_touches(const weft_cloth_def *def);
