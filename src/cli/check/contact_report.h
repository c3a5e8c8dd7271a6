/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_report.h -- weft check's report of contact: the shapes, and how stiff contact
 * is at rest and after a fall onto each of them. */
#ifndef WEFT_CLI_CHECK_CONTACT_REPORT_H
#define WEFT_CLI_CHECK_CONTACT_REPORT_H

#include "record/yaml_out.h"
#include "weft/cloth.h"

/* The same for people and for machines; nothing without shapes. */
void contact_print(const weft_cloth_def *def);
void contact_yaml(yaml_out *out, const weft_cloth_def *def);

#endif
