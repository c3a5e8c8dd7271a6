/* SPDX-License-Identifier: BSD-3-Clause */
/* levels.c -- which instructions this machine has. */
#include "cloth/kernel.h"

#include <string.h>

static const weft__level levels[] = {
    { "plain", weft__springs_plain, weft__wind_plain, weft__heat_plain },
#ifdef __x86_64__
    { "x86-64-v3", weft__springs_v3, weft__wind_v3, weft__heat_v3 },
    { "x86-64-v4", weft__springs_v4, weft__wind_v4, weft__heat_v4 },
#endif
};

size_t weft__level_count(void)
{
#ifdef __x86_64__
    /* what the compiler may use of a level, not merely its vectors */
    __builtin_cpu_init();
    const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                    && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool v4
        = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")
          && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq")
          && __builtin_cpu_supports("avx512vl");
    return v4 ? 3 : v3 ? 2 : 1;
#else
    return 1;
#endif
}

const weft__level *weft__level_at(size_t i)
{
    return &levels[i];
}

const weft__level *weft__level_named(const char *name)
{
    const size_t count = weft__level_count();
    for (size_t i = 0; name != NULL && i < count; ++i) {
        if (strcmp(levels[i].name, name) == 0) {
            return &levels[i];
        }
    }
    return &levels[count - 1];
}

void weft__cloth_set_level(weft_cloth *cloth, const weft__level *level)
{
    cloth->level = level;
}

const char *weft_cloth_isa(const weft_cloth *cloth)
{
    return cloth->level->name;
}
