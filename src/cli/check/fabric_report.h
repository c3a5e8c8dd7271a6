/* SPDX-License-Identifier: BSD-3-Clause */
/* fabric_report.h -- weft check: the springs of a fabric, and the fabric of springs. */
#ifndef WEFT_CLI_CHECK_FABRIC_REPORT_H
#define WEFT_CLI_CHECK_FABRIC_REPORT_H

#include "record/yaml_out.h"
#include "weft/weft.h"

/* Both write nothing for a cloth without a fabric or bending rigidity. */
void fabric_print(const weft_scene *scene);
void fabric_yaml(yaml_out *out, const weft_scene *scene);

#endif
