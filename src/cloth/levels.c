/* SPDX-License-Identifier: BSD-3-Clause */
/* levels.c -- selects the kernels of this machine. WEFT_PLAIN: there are none. */
#include "cloth/levels.h"

#include <string.h>

#define ADDED(name, level) weft__##name##_##level,
#define KERNELS(level)                                                                 \
    weft__rows_##level, weft__damping_##level, weft__products_##level,                 \
        { WEFT_ADDED(ADDED, level) }, weft__clear_##level, weft__pushes_##level,       \
        weft__waits_##level, weft__extent_##level, weft__drift_##level

static const weft__level levels[] = {
#ifdef WEFT_PLAIN
    { "plain",
      weft__reference_rows,
      weft__reference_damping,
      weft__reference_rows,
      { NULL },
      weft__reference_clear,
      weft__reference_pushes,
      weft__reference_waits,
      weft__reference_extent,
      weft__reference_drift },
#else
    { "plain", KERNELS(plain) },
#ifdef __x86_64__
    { "x86-64-v3", KERNELS(v3) },
    { "x86-64-v4", KERNELS(v4) },
#endif
#endif
};

size_t weft__level_count(void)
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
    return v4 ? 3 : v3 ? 2 : 1;
#else
    return 1;
#endif
}

const weft__level *weft__level_at(size_t i)
{
    return &levels[i];
}

weft_status weft__level_find(const char *name, const weft__level **out, weft_error *err)
{
    const size_t count = weft__level_count();
    char names[64] = "";
    *out = &levels[count - 1];
    if (name == NULL || name[0] == '\0') {
        return WEFT_OK;
    }
    for (size_t i = 0; i < count; ++i) {
        *out = &levels[i];
        if (strcmp(levels[i].name, name) == 0) {
            return WEFT_OK;
        }
        strcat(strcat(names, i == 0 ? "" : ", "), levels[i].name);
    }
    return weft_error_set(err, WEFT_INVALID, "WEFT_ISA is '%.40s'; this machine has %s",
                          name, names);
}

void weft__cloth_set_level(weft_cloth *cloth, const weft__level *level)
{
    cloth->level = level;
}

const char *weft_cloth_isa(const weft_cloth *cloth)
{
    return cloth->level->name;
}
