/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_parts.h -- the parts of what verbs print of contact. */
#pragma once

#include "program/reports.h"
#include "program/survey/survey.h"

/* keys_report.c: prints the key frames of shapes that have some, beside the duration
 * [s]; warns, on stderr, of bodies that swing further beyond their key frames than the
 * thickness. */
void keys_print(const weft_cloth_def *def, double duration);
void keys_warn(const char *file, const weft_cloth_def *def);
