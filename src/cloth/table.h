/* SPDX-License-Identifier: BSD-3-Clause */
/* table.h -- all forces, in the order of summation, which is part of the result. The
 * first one starts a sum. */
#pragma once

#include "forces/bending/angles.h"
#include "forces/bending/bending.h"
#include "forces/bending/plate.h"
#include "forces/body/body.h"
#include "forces/contact/bodies/bodies.h"
#include "forces/contact/contact.h"
#include "forces/contact/self/self.h"
#include "forces/membrane/membrane.h"
#include "forces/springs/springs.h"
#include "forces/wind/wind.h"

#define WEFT_FORCES(X)                                                                 \
    X(springs)                                                                         \
    X(bending)                                                                         \
    X(membrane) X(plate) X(angles) X(body) X(wind) X(contact) X(self) X(bodies)

/* Forces that read the own of another one. */
#define WEFT_FORCE_LINKS(cloth)                                                        \
    (cloth)->angles.plate = &(cloth)->plate;                                           \
    (cloth)->bodies.contact = &(cloth)->contact;
