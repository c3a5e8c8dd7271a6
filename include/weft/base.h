/* SPDX-License-Identifier: BSD-3-Clause */
/* weft/base.h -- shared by all weft headers: version, export mark, status, error.
 *
 * Nothing here needs the library: an integrator's plugin includes weft/stepper.h, which
 * includes this header, and does not link with weft. */
#ifndef WEFT_BASE_H
#define WEFT_BASE_H

#include <locale.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define WEFT_VERSION "0.2.0"
/* The number in the name of the shared library, libweft.so.1: higher only if programs
 * built for it before no longer run (VERSIONING.md). */
#define WEFT_INTERFACE 1

/* The library is built with hidden visibility: it exports only marked names. */
#if defined(__GNUC__)
#define WEFT_API                 __attribute__((visibility("default")))
#define WEFT_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define WEFT_API
#define WEFT_PRINTF(text, first)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Growth. A program goes on working with a later libweft of the same SONAME, and one
 * built for a later libweft is refused where an earlier one would misread it. For this
 * a struct that crosses the library's boundary is one of four kinds:
 *
 * - "Fixed for ever", as its comment says: never changed. A member that it lacks goes
 * to the struct that contains it, and the enums that count its members are fixed, too.
 * - A definition, in or out of a function. struct_size comes first, filled by
 *   weft_..._default(), an inline function with the size in the caller's header. The
 *   library reads so much and takes its defaults for the rest. What it does not know
 *   must be 0: WEFT_INVALID.
 * - A result. An inline function of WEFT_RESULT returns it: the library writes as much
 *   as the caller's struct holds, and 0 to what it does not know.
 * - A struct of the library behind a const pointer: it may be longer than the caller
 *   knows. Pass the pointer on: a copy has only the members that the caller knows, and
 *   needs its own struct_size.
 *
 * Elements of arrays have their size in the definition with the array. Members are only
 * added, at the end of a struct. tools/checks/check-abi compares all with
 * tools/checks/libweft.abi.
 */
/* Whether *s, of any version, has the field, which was added to the end of its struct.
 */
#define WEFT_HAS(s, type, field)                                                       \
    ((s)->struct_size >= offsetof(type, field) + sizeof((s)->field))

#define WEFT_BARE(...) __VA_ARGS__

/* type name(parameters), and what the library exports of it: name_sized. */
#define WEFT_RESULT(type, name, parameters, arguments)                                 \
    WEFT_API void name##_sized(type *out, size_t size, WEFT_BARE parameters);          \
    static inline type name parameters                                                 \
    {                                                                                  \
        type out;                                                                      \
        name##_sized(&out, sizeof out, WEFT_BARE arguments);                           \
        return out;                                                                    \
    }

/* type type_default(void), likewise, and type_init. */
#define WEFT_DEFAULT(type)                                                             \
    WEFT_API void type##_init(type *def, size_t size);                                 \
    static inline type type##_default(void)                                            \
    {                                                                                  \
        type def;                                                                      \
        type##_init(&def, sizeof def);                                                 \
        return def;                                                                    \
    }

/* X(name, text): the source of the enum and of weft_status_text(). */
#define WEFT_STATUS_LIST(X)                                                            \
    X(OK, "ok")                                                                        \
    X(INVALID, "invalid argument")                                                     \
    X(NO_MEMORY, "out of memory")                                                      \
    X(IO, "file could not be read or written")                                         \
    X(BAD_SCENE, "error in the scene")                                                 \
    X(BAD_PLUGIN, "plugin refused or not found")                                       \
    X(UNSUPPORTED, "not supported")                                                    \
    X(NOT_FINITE, "state is not finite")                                               \
    X(STEP_TOO_SMALL, "step size fell below its minimum")                              \
    X(STOPPED, "right-hand side asked to stop")                                        \
    X(SOLVER, "the wrapped solver failed")

typedef enum weft_status {
#define WEFT_STATUS_ENUM(name, text) WEFT_##name,
    WEFT_STATUS_LIST(WEFT_STATUS_ENUM)
#undef WEFT_STATUS_ENUM
} weft_status;

/* An error and its place. The caller owns it and passes it as the last argument; NULL
 * is allowed everywhere. It is written only on failure. Fixed for ever. */
typedef struct weft_error {
    weft_status status;
    int line, column;  /* from 1; 0: no place in a file */
    char file[256];    /* empty: no file */
    char message[512]; /* one line, without a trailing period */
} weft_error;

/* The allocator of an object, to replace malloc. `resize` works like realloc, and
 * returns memory aligned like malloc's. With size 0 it frees the block and returns
 * NULL; with another size NULL means that there is no memory left, and the call fails
 * with WEFT_NO_MEMORY. weft copies this struct and calls `resize` in the thread that
 * calls weft; *ctx must outlive the object. Nothing is allocated inside a step. Fixed
 * for ever. */
typedef struct weft_allocator {
    void *(*resize)(void *ctx, void *block, size_t size);
    void *ctx;
} weft_allocator;

typedef enum weft_log_level {
    WEFT_LOG_DEBUG,  /* steps that took more than one attempt */
    WEFT_LOG_INFO,   /* an object created or a file loaded */
    WEFT_LOG_WARNING /* a possible fault of the results */
} weft_log_level;

/* Messages that are not failures, one line per call without a newline; the library
 * itself never prints. Called in the thread that calls weft. Fixed for ever. */
typedef struct weft_log {
    void (*write)(void *ctx, weft_log_level level, const char *text); /* NULL: none */
    void *ctx;
} weft_log;

/* Asked again and again during a computation that may take long, in the thread that
 * calls weft; true ends it with WEFT_STOPPED. For a signal, a deadline or a button:
 * return a flag that another thread or a handler sets. */
typedef bool weft_stop_fn(void *ctx);

/** Returns the text of a status.
 * @param status any value, also one that only a later version has
 * @return static text, such as "invalid argument"; never NULL */
WEFT_API const char *weft_status_text(weft_status status);

/** Returns the version of the running library, which may be later than the headers'
 * WEFT_VERSION.
 * @return static text, such as "0.2.0" */
WEFT_API const char *weft_version(void);

/** Formats as vsnprintf does, with points in numbers, whatever the program's locale is.
 * Header-only, for plugins. For the point, <locale.h> must have uselocale, as POSIX
 * demands; where this header is compiled without it, the locale decides.
 * @param text receives the text, cut to size - 1 characters; may be NULL if size is 0
 * @param size [bytes] of text
 * @param format as of printf
 * @param args its arguments
 * @return the length of the whole text, as vsnprintf does; < 0: an encoding error */
WEFT_PRINTF(3, 0)
static inline int weft_text_format_list(char *text, size_t size, const char *format,
                                        va_list args)
{
#ifdef LC_GLOBAL_LOCALE
    const locale_t points = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    const locale_t before = uselocale(points);
#endif
    const int length = vsnprintf(text, size, format, args);
#ifdef LC_GLOBAL_LOCALE
    (void)uselocale(before);
    if (points != (locale_t)0) {
        freelocale(points);
    }
#endif
    return length;
}

/** Formats as snprintf does, with points in numbers, whatever the program's locale is;
 * see weft_text_format_list. Header-only, for plugins.
 * @param text receives the text, cut to size - 1 characters; may be NULL if size is 0
 * @param size [bytes] of text
 * @param format as of printf, with its arguments behind it
 * @return the length of the whole text, as snprintf does; < 0: an encoding error */
WEFT_PRINTF(3, 4)
static inline int weft_text_format(char *text, size_t size, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int length = weft_text_format_list(text, size, format, args);
    va_end(args);
    return length;
}

/** Counts the significant digits of the shortest decimal that reads back as x. With
 * them a message prints 0.1 as 0.1: weft_error_set(err, WEFT_INVALID, "t is %.*g s",
 * weft_text_digits(t), t). Header-only, for plugins.
 * @param x any number
 * @return 1 to 17 */
static inline int weft_text_digits(double x)
{
    char text[32];
    int digits = 0;
    do {
        (void)snprintf(text, sizeof text, "%.*g", ++digits, x);
    } while (digits < 17 && strtod(text, NULL) != x);
    return digits;
}

/** Fills an error, so that a failing function may end with `return weft_error_set(err,
 * WEFT_INVALID, "rows is %zu", rows);`. Header-only, for plugins.
 * @param err receives the status and the message, without a place in a file; may be
 *   NULL
 * @param status not WEFT_OK
 * @param format as of printf, with its arguments behind it: one line, without a period
 *   at its end
 * @return status
 * @par Example
 * @snippet own_stepper.c create */
WEFT_PRINTF(3, 4)
static inline weft_status weft_error_set(weft_error *err, weft_status status,
                                         const char *format, ...)
{
    if (err != NULL) {
        va_list args;
        err->status = status;
        err->line = 0;
        err->column = 0;
        err->file[0] = '\0';
        va_start(args, format);
        (void)weft_text_format_list(err->message, sizeof err->message, format, args);
        va_end(args);
    }
    return status;
}

/** Resizes a block as weft_allocator.resize does, with malloc's memory.
 * @param ctx not used
 * @param block NULL, or what an earlier call returned
 * @param size [bytes]; 0 frees the block
 * @return the block; NULL if size is 0 or there is no memory */
static inline void *weft_malloc_resize(void *ctx, void *block, size_t size)
{
    (void)ctx;
    if (size == 0) {
        free(block);
        return NULL;
    }
    return realloc(block, size);
}

/** Copies an allocator, or makes one of malloc. Header-only, for plugins.
 * @param given NULL: malloc's
 * @return the copy */
static inline weft_allocator weft_allocator_or_malloc(const weft_allocator *given)
{
    weft_allocator memory = { weft_malloc_resize, NULL };
    return given != NULL ? *given : memory;
}

#ifdef __cplusplus
}
#endif

#endif
