/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/weft.h -- all of libweft: cloth, springs or triangles, under your solver. */
#ifndef WEFT_WEFT_H
#define WEFT_WEFT_H

#include "weft/base.h"
#include "weft/cloth.h"
#include "weft/gradient.h"
#include "weft/registry.h"
#include "weft/scene.h"
#include "weft/sim.h"
#include "weft/stability.h"
#include "weft/stepper.h"

#endif
