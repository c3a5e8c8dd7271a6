/* SPDX-License-Identifier: BSD-3-Clause */
/* vectors.h -- how loops over long arrays are compiled: for the machine's widest
 * vectors, with the same bits. All plugins that have such loops include it. */
#pragma once

/* Wider vectors where the machine has them, for static functions: the symbols of others
 * would be exported. The choice is made as the plugin is loaded, which is before an
 * address sanitizer works. */
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__)                   \
    && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define WIDE
#endif

/* A loop whose output may be one of the vectors read, but not a part of one. */
#if defined(__clang__)
#define ELEMENTWISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define ELEMENTWISE _Pragma("GCC ivdep")
#endif

/* A loop that several WIDE functions share, each for its own constants. */
#define INLINE static inline __attribute__((always_inline))
