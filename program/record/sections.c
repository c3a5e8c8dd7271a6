/* SPDX-License-Identifier: BSD-3-Clause */
#include "program/record/sections.h"

extern const record_section contact_record;
const record_section *const record_sections[RECORD_SECTIONS] = { &contact_record };

unsigned record_section_columns(const weft_cloth_def *def)
{
    unsigned columns = 0;
    for (size_t i = 0; i < RECORD_SECTIONS; ++i) {
        columns |= record_sections[i]->columns != NULL
                       ? record_sections[i]->columns(def)
                       : 0;
    }
    return columns;
}
