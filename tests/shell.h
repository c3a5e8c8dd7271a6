/* SPDX-License-Identifier: BSD-3-Clause */
/* shell.h -- the program run by the tests as its users run it. */
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support.h"

#define WEFT BUILD_DIR "/weft"

/* A scene that needs no GSL and takes a moment. */
static const char small_scene[]
    = "weft: 1\n"
      "name: small\n"
      "cloth:\n"
      "  grid: {rows: 4, cols: 5, spacing: [0.1, 0.2]}\n"
      "  density: 0.3\n"
      "  springs:\n"
      "    stretch: {stiffness: 50, damping: 0.01}\n"
      "    shear: {stiffness: 20}\n"
      "  pins: [top-left, {at: top-right, velocity: [0.1, 0, 0]}]\n"
      "stepper: {plugin: verlet, method: velocity_verlet, fixed_step: 1.0e-3}\n"
      "run: {duration: 0.5, fps: 20}\n";

static char output[65536];

/* Run a shell command; its output goes to `output`, its exit code is returned. */
WEFT_PRINTF(1, 2) static inline int shell(const char *format, ...)
{
    char command[4096];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(command, sizeof command, format, args);
    va_end(args);
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    const size_t length = fread(output, 1, sizeof output - 1, pipe);
    output[length] = '\0';
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static inline void expect(int code, int wanted)
{
    ck_assert_msg(code == wanted, "exit code %d instead of %d:\n%s", code, wanted,
                  output);
}

/* Lines of `output` that were broken at 80 characters are made whole: those that begin
 * with so many blanks go on with the one before. */
static inline void unwrap(size_t margin)
{
    char start[64];
    (void)snprintf(start, sizeof start, "\n%*s", (int)margin, "");
    for (char *at = output; (at = strstr(at, start)) != NULL;) {
        const char *rest = at + 1 + margin;
        memmove(at + 1, rest, strlen(rest) + 1);
        *at = ' ';
    }
}

/* In one line, or in one that was broken behind a label. */
static inline void says(const char *text)
{
    if (strstr(output, text) == NULL) {
        unwrap(13);
    }
    ck_assert_msg(strstr(output, text) != NULL, "no '%s' in:\n%s", text, output);
}

static inline void write_file(const char *name, const char *text)
{
    FILE *stream = fopen(name, "w");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_ge(fputs(text, stream), 0);
    ck_assert_int_eq(fclose(stream), 0);
}

/* Without cutting it to nothing first: ext4 then writes it to the disk at each close.
 */
static inline void rewrite_file(const char *name, const void *bytes, size_t size)
{
    const int file = open(name, O_WRONLY | O_CREAT, 0666);
    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(write(file, bytes, size), (ssize_t)size);
    ck_assert_int_eq(ftruncate(file, (off_t)size), 0);
    ck_assert_int_eq(close(file), 0);
}

static inline const char *read_file(const char *name)
{
    static char text[1 << 20];
    FILE *stream = fopen(name, "r");
    ck_assert_msg(stream != NULL, "no file %s", name);
    text[fread(text, 1, sizeof text - 1, stream)] = '\0';
    (void)fclose(stream);
    return text;
}

static inline bool exists(const char *name)
{
    struct stat status;
    return stat(name, &status) == 0;
}
