/* SPDX-License-Identifier: BSD-3-Clause */
/* isa.c -- the levels of instructions that this machine has. */
#include "base/isa.h"

#include <string.h>

weft__isa weft__isa_last(void)
{
#if defined __x86_64__ && !defined WEFT_PLAIN
    /* all that the compiler may use of a level, not only its vectors */
    __builtin_cpu_init();
    const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                    && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool v4
        = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")
          && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq")
          && __builtin_cpu_supports("avx512vl");
    return v4 ? WEFT__V4 : v3 ? WEFT__V3 : WEFT__PLAIN;
#else
    return WEFT__PLAIN;
#endif
}

const char *weft__isa_name(weft__isa isa)
{
    static const char *const names[]
        = { "plain loops", "plain", "x86-64-v3", "x86-64-v4" };
    return names[isa];
}

weft_status weft__isa_find(const char *name, weft__isa *out, weft_error *err)
{
    const weft__isa last = weft__isa_last();
    char names[64] = "";
    *out = last;
    if (name == NULL || name[0] == '\0') {
        return WEFT_OK;
    }
    for (weft__isa i = WEFT__PLAIN; i <= last; ++i) {
        *out = i;
        if (strcmp(weft__isa_name(i), name) == 0) {
            return WEFT_OK;
        }
        strcat(strcat(names, i == WEFT__PLAIN ? "" : ", "), weft__isa_name(i));
    }
    return weft_error_set(err, WEFT_INVALID, "WEFT_ISA is '%.40s'; this machine has %s",
                          name, names);
}
