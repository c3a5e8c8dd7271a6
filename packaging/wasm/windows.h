/* SPDX-License-Identifier: BSD-3-Clause */
/* windows.h -- what the library needs of POSIX and mingw-w64 does not have; every file
 * includes it first. Plugins are linked in: no folder is searched for others. */
#pragma once

#include <dirent.h>
#include <fcntl.h>
#include <locale.h>
#include <string.h>
#include <time.h>

#define O_NONBLOCK  _O_BINARY
#define O_CLOEXEC   _O_NOINHERIT
#define LC_ALL_MASK LC_ALL
#define lstat       stat /* there are no links */
typedef const char *locale_t;

static inline locale_t newlocale(int mask, const char *name, locale_t base)
{
    (void)mask, (void)base;
    return name;
}

/* The locale of this thread by name; the one before. */
static inline locale_t uselocale(locale_t name)
{
    static _Thread_local char before[256];
    const locale_t now = setlocale(LC_ALL, NULL);
    (void)_configthreadlocale(_ENABLE_PER_THREAD_LOCALE);
    if (name != before && strlen(now) < sizeof before) {
        strcpy(before, now);
    }
    (void)setlocale(LC_ALL, name);
    return before;
}

static inline void freelocale(locale_t name)
{
    (void)name;
}

/* [ms] since the machine was started: Kernel32, which every program is linked with. */
__declspec(dllimport) unsigned long long __stdcall GetTickCount64(void);

/* In place of that of winpthreads, which a program need not be linked with. */
static inline int weft__windows_clock(int clock, struct timespec *out)
{
    const unsigned long long now = GetTickCount64();
    (void)clock;
    out->tv_sec = (time_t)(now / 1000), out->tv_nsec = (long)(now % 1000) * 1000000;
    return 0;
}
#define clock_gettime weft__windows_clock

static inline char *stpcpy(char *to, const char *from)
{
    const size_t length = strlen(from);
    memcpy(to, from, length + 1);
    return to + length;
}

static inline int alphasort(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static inline int scandir(const char *folder, struct dirent ***out,
                          int (*filter)(const struct dirent *),
                          int (*order)(const struct dirent **, const struct dirent **))
{
    (void)folder, (void)filter, (void)order;
    *out = NULL;
    return 0;
}
