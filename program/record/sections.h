/* SPDX-License-Identifier: BSD-3-Clause */
/* sections.h -- what sections of a scene that most scenes do without add to the files
 * of a run: each file asks all of the table in sections.c. */
#pragma once

#include "program/record/yaml_out.h"
#include "weft/weft.h"

/* A member that is NULL adds nothing. `page`: members of an object, each after a comma;
 * def NULL: there is no scene. `columns`: RECORD_... of series.h. `hash`: of what is in
 * files that a scene's text names, and `files`: copies of them. */
typedef struct record_section {
    void (*manifest)(yaml_out *out, const weft_cloth_def *def);
    void (*result)(yaml_out *out, const weft_sim *sim, const weft_measures *all);
    void (*page)(FILE *stream, const weft_cloth_def *def);
    unsigned (*columns)(const weft_cloth_def *def);
    uint64_t (*hash)(const weft_cloth_def *def, uint64_t hash);
    weft_status (*files)(const char *directory, const weft_scene *scene,
                         weft_error *err);
} record_section;

enum { RECORD_SECTIONS = 1 };
extern const record_section *const record_sections[RECORD_SECTIONS];

/* The optional columns of series.csv: RECORD_... */
unsigned record_section_columns(const weft_cloth_def *def);
