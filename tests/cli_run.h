/* SPDX-License-Identifier: BSD-3-Clause */
/* cli_run.h -- run the program as a user does and look at what it says and leaves. */
#ifndef CLI_RUN_H
#define CLI_RUN_H

#include "support.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define WEFT BUILD_DIR "/weft"

static char output[65536];

/* Run a shell command; its output goes to `output`, its exit code is returned. */
static inline int shell(const char *format, ...)
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

static inline void says(const char *text)
{
    ck_assert_msg(strstr(output, text) != NULL, "no '%s' in:\n%s", text, output);
}

static inline void write_file(const char *name, const char *text)
{
    FILE *stream = fopen(name, "w");
    ck_assert_ptr_nonnull(stream);
    ck_assert_int_ge(fputs(text, stream), 0);
    ck_assert_int_eq(fclose(stream), 0);
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

#endif
