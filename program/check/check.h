/* SPDX-License-Identifier: BSD-3-Clause */
/* check.h -- the parts of weft check's report, each for people and for machines. */
#pragma once

#include "program/record/yaml_out.h"
#include "program/survey/survey.h"

/* contact_report.c: the shapes, and how stiff contact is at rest and after a fall onto
 * each of them; nothing without contact. */
void contact_print(const weft_cloth_def *def);
void contact_yaml(yaml_out *out, const weft_cloth_def *def);

/* keys_report.c: warns, on stderr, of bodies that swing further beyond their key frames
 * than the thickness. */
void keys_warn(const char *file, const weft_cloth_def *def);

/* fabric_report.c: the springs of a fabric, and the fabric of springs; nothing for a
 * cloth without a fabric or bending rigidity. */
void fabric_print(const weft_scene *scene, const weft_cloth *cloth);
void fabric_yaml(yaml_out *out, const weft_scene *scene);

/* stable_steps.c: a survey, with the cheapest methods or all, and advice. */
void stability_print(const weft_scene *scene, const survey *of, bool all);
void stability_yaml(yaml_out *out, const weft_scene *scene, const survey *of);
