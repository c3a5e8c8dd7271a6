/* SPDX-License-Identifier: BSD-3-Clause */
/* cloth_slice.h -- makes the whole cloth of a definition of a band of triangles this
 * band; and what of a definition has none. Of others both do nothing. */
#pragma once

#include "cloth/model.h"

weft_status weft__cloth_slice(weft_cloth *cloth, const weft_cloth_def *def,
                              weft_error *err);
weft_status weft__slice_check(const weft_cloth_def *def, weft_error *err);
