/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/reports.h"

extern const report_section fabric_report, contact_report;
const report_section *const report_sections[REPORT_SECTIONS]
    = { &fabric_report, &contact_report };

bool report_touches(const weft_cloth_def *def)
{
    bool touches = false;
    for (size_t i = 0; i < REPORT_SECTIONS; ++i) {
        touches = touches
                  || (report_sections[i]->touches != NULL
                      && report_sections[i]->touches(def));
    }
    return touches;
}
