/* SPDX-License-Identifier: BSD-3-Clause */
/* check.h -- parts of weft check's report, each for people and for machines. */
#pragma once

#include "program/record/yaml_out.h"
#include "program/survey/survey.h"

/* stable_steps.c: a survey, with the cheapest methods or all, and advice. */
void stability_print(const weft_scene *scene, const survey *of, bool all);
void stability_yaml(yaml_out *out, const weft_scene *scene, const survey *of);
