/* SPDX-License-Identifier: BSD-3-Clause */
/* summary.h -- what a run was and came to, in eight lines or as YAML. */
#ifndef WEFT_CLI_RUN_SUMMARY_H
#define WEFT_CLI_RUN_SUMMARY_H

#include "record/record.h"

typedef struct summary {
    const char *directory;
    const weft_scene *scene;
    const weft_sim *sim;
    const record_result *result;
    record_extremes extremes;
} summary;

void summary_step(summary *self); /* after each accepted step */
/* After each frame, with the spring of the largest strain in it. */
void summary_frame(summary *self, const weft_spring *now);

void summary_print(const summary *self);
/* What is known within a step. */
void summary_print_frames(const summary *self);
/* The same as YAML documents of a line each, at the begin and at the end. */
void summary_yaml_begin(const summary *self);
void summary_yaml_end(const summary *self);

#endif
