/* SPDX-License-Identifier: BSD-3-Clause */
/* attractor_keys.h -- the keys of forces.attractor: a part of scene/keys.c. */

static const weft__key attractor_keys[] = {
    { "strength", WEFT__NUMBER, .required = true, NUMBER(attractor, attractor_strength),
      .meaning = "of the pull to the origin" },
    { "drag", WEFT__NUMBER, .fallback = "0", NUMBER(attractor, attractor_drag),
      .meaning = "of the motion" },
};
