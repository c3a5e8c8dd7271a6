/* SPDX-License-Identifier: BSD-3-Clause */
/* apart.c -- independent parts of a report, each in a process of its own. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "verify/verify.h"

/* What one part prints, and its counts after that. */
typedef struct part {
    FILE *text, *counts;
} part;

static void run_part(const part *to, verify_part *print, void *ctx, size_t i)
{
    verify_counts counts = { 0 };
    if (dup2(fileno(to->text), STDOUT_FILENO) < 0) {
        _exit(EXIT_FAILURE);
    }
    print(ctx, i, &counts);
    const bool written = fflush(stdout) == 0
                         && fwrite(&counts, sizeof counts, 1, to->counts) == 1
                         && fflush(to->counts) == 0;
    _exit(written ? EXIT_SUCCESS : EXIT_FAILURE);
}

static bool begin_part(part *out, verify_part *print, void *ctx, size_t i)
{
    out->text = tmpfile();
    out->counts = tmpfile();
    const pid_t child = out->text == NULL || out->counts == NULL ? -1 : fork();
    if (child == 0) {
        run_part(out, print, ctx, i);
    }
    return child > 0;
}

static bool wait_for_one(void)
{
    int status = 0;
    return wait(&status) > 0 && status == 0;
}

/* Copies and closes. */
static bool end_part(part *from, verify_counts *counts)
{
    verify_counts own = { 0 };
    bool whole = from->text != NULL && from->counts != NULL;
    if (whole) {
        rewind(from->text);
        rewind(from->counts);
        for (int c; (c = getc(from->text)) != EOF;) {
            putchar(c);
        }
        whole = fread(&own, sizeof own, 1, from->counts) == 1;
    }
    if (from->text != NULL) {
        (void)fclose(from->text);
    }
    if (from->counts != NULL) {
        (void)fclose(from->counts);
    }
    counts->judged += own.judged;
    counts->failed += own.failed;
    return whole;
}

bool verify_apart(size_t count, verify_part *print, void *ctx, verify_counts *counts)
{
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const size_t most = processors > 1 ? (size_t)processors : 1;
    part *parts = calloc(count + 1, sizeof *parts);
    size_t begun = 0, ended = 0;
    bool whole = parts != NULL;
    (void)fflush(stdout);
    while (whole && ended < count) {
        if (begun < count && begun - ended < most) {
            whole = begin_part(&parts[begun], print, ctx, begun);
            ++begun;
        } else {
            whole = wait_for_one();
            ++ended;
        }
    }
    for (size_t i = 0; i < begun; ++i) {
        whole = end_part(&parts[i], counts) && whole;
    }
    free(parts);
    return whole;
}
