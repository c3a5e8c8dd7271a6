/* SPDX-License-Identifier: BSD-3-Clause */
/* contact_law.h -- the law of contact.h for one number or a vector of them: the same
 * bits. A file that includes it defines before
 *
 *     num              double, or a vector of them
 *     NUM(a)           a double as a num
 *     ROOT(a)          the square root
 *     CHOOSE(t, a, b)  a where t, else b
 *     LAW              the storage class of the functions
 */
#ifndef WEFT_CLOTH_CONTACT_LAW_H
#define WEFT_CLOTH_CONTACT_LAW_H

#include "weft/cloth.h"

/* s^(p - 2) */
LAW num law_power(num s, int exponent)
{
    num power = s;
    for (int k = 3; k < exponent; ++k) {
        power = power * s;
    }
    return power;
}

typedef struct law_touch {
    num push, factor, stiffness, drag; /* as of weft__touch */
    num energy;                        /* [J/kg] by share */
} law_touch;

/* slip2: the square of |w| */
LAW law_touch law_press(const weft_contact_def *law, double friction, num gap,
                        num share, num speed, num slip2, num steepness)
{
    const double half = 0.5 * law->stopping_speed * law->stopping_speed;
    const double per = 1.0 / law->thickness, p = law->exponent;
    const num e = half * share, z = gap * per, s = 1.0 - z;
    const num power = law_power(s, law->exponent);
    const num a = z * (p * (p - 1.0) * z + 2.0 * p * s) + 2.0 * s * s;
    const num b = p * z + s, inverse = 1.0 / (a * z), iz = a * inverse;
    const num u = law->damping * speed;
    law_touch out;
    out.push = e * per * (power * s) * b * (iz * iz);
    out.factor = ROOT(1.0 + u * u) - u;
    out.stiffness = e * per * per * power * a * (iz * iz * iz);
    out.energy = half * (power * s * s) * iz;
    out.drag = NUM(0.0);
    if (friction == 0.0) {
        return out;
    }
    const num most = friction * (out.push * out.factor) * steepness;
    const num bend = out.factor * s * b;
    const num scale = 0.01 * e * power * (bend * bend) * inverse;
    if (law->law == WEFT_FRICTION_SMOOTH) {
        out.drag
            = most
              / ROOT(slip2 + (law->slip * law->slip + friction * friction * scale));
    } else {
        const num length = ROOT(slip2), y = length * (1.0 / law->slip);
        out.drag = most * CHOOSE(y < 1.0, (2.0 - y) * (1.0 / law->slip), 1.0 / length);
    }
    return out;
}

#endif
