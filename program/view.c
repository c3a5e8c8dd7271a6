/* SPDX-License-Identifier: BSD-3-Clause */
/* view.c -- weft view: a run or a batch as a page for a browser. */
#define _XOPEN_SOURCE 700 /* realpath */
#include <stdlib.h>
#include <string.h>

#include "program/cli.h"
#include "program/record/frames.h"
#include "program/record/page.h"
#include "program/record/series.h"
#include "program/run/interrupt.h"
#include "program/watch/watch.h"

/* A file:// URL of a page that exists. */
static void print_url(const char *file)
{
    char *path = realpath(file, NULL);
    fputs("file://", stdout);
    for (const char *c = path == NULL ? file : path; *c != '\0'; ++c) {
        const bool plain = (*c >= '0' && *c <= '9') || (*c >= 'a' && *c <= 'z')
                           || (*c >= 'A' && *c <= 'Z') || strchr("/-_.~", *c) != NULL;
        printf(plain ? "%c" : "%%%02X", (unsigned char)*c);
    }
    free(path);
}

int view_runs(const char *const *directories, size_t count, const char *out, bool yaml)
{
    char path[RECORD_PATH];
    weft_error err = { 0 };
    weft_status status = WEFT_OK;
    weft_error why = { 0 };
    size_t without = 0;
    const bool batch = count == 1 && record_is_batch(directories[0]);
    if (out == NULL) {
        status = record_path(directories[0],
                             batch       ? "batch.html"
                             : count > 1 ? "compare.html"
                                         : "run.html",
                             path, &err);
        out = path;
    }
    if (status == WEFT_OK) {
        status = batch ? record_batch(directories[0], out, &without, &why, &err)
                       : record_player(directories, count, out, &err);
    }
    if (status == WEFT_OK && without > 0) {
        print_line(stderr, "weft: warning: runs without frames: %zu; the first: %s",
                   without, why.message);
    }
    for (size_t i = 0; status == WEFT_OK && !batch && i < count; ++i) {
        record_series_row *rows;
        size_t row_count; /* damage stops no page: its plots are wrong or missing */
        if (record_series_rows(directories[i], &rows, &row_count, &why) != WEFT_OK) {
            print_line(stderr, "weft: warning: %s; the page lacks plots", why.message);
        }
        free(rows);
    }
    if (status != WEFT_OK) {
        const int code = report_error(&err);
        return status == WEFT_INVALID ? EXIT_USAGE : code;
    }
    fputs(yaml ? "--- {event: page, url: \"" : "", stdout);
    print_url(out);
    fputs(yaml ? "\"}\n" : "\n", stdout);
    return EXIT_DONE;
}

void report_unfinished(const char *directory)
{
    record_frames *frames;
    if (record_unfinished(directory)
        && record_frames_open(directory, &frames, NULL) == WEFT_OK) {
        print_plainly(stderr, "%s: unfinished: %zu of %zu frames\n", directory,
                      frames->count, frames->planned);
        record_frames_close(frames);
    }
}

/* A run that another process has under way. */
static int watch_elsewhere(const arguments *given)
{
    weft_error err = { 0 };
    watch_def def = { .directory = given->operands[0], .ready = -1 };
    const int code = watch_check(given, &def.port);
    if (code != EXIT_DONE) {
        return code;
    }
    if (given->operand_count > 1 || given->out != NULL) {
        return usage_error(given, "--watch shows one run, and writes no page");
    }
    if (!record_outdir_locked(def.directory)) {
        return usage_error(given,
                           "%s: no run is under way there; without --watch the page "
                           "has what was recorded",
                           def.directory);
    }
    interrupt_catch(true);
    if (watch_serve(&def, &err) != WEFT_OK) {
        return report_error(&err);
    }
    return interrupt_code(interrupt_signal());
}

static int view_verb(const arguments *given)
{
    if (given->watch || given->port != NULL) {
        return watch_elsewhere(given);
    }
    for (int i = 0; i < given->operand_count; ++i) {
        report_unfinished(given->operands[i]);
    }
    return view_runs((const char *const *)given->operands, (size_t)given->operand_count,
                     given->out, false);
}

static const verb_option options[] = {
    SHARED(out, "out", "FILE",
           "default: DIR/run.html, for two runs DIR/compare.html, for a batch "
           "DIR/batch.html"),
    SHARED(watch, "watch", NULL,
           "serve the page of a run that is under way, with its growing frames, on "
           "127.0.0.1 until the run ends"),
    SHARED(port, "port", "N", "of --watch, from 1024 to 65535; default: a free one"),
};

const verb verb_view = {
    .name = "view",
    .summary = "make a page of a run, of two side by side, or of a batch",
    .help
    = "usage: weft view DIR [DIR2] [OPTIONS]\n"
      "\n"
      "Writes one self-contained HTML page with the frames and the plots of a run, and "
      "prints its URL. A browser plays it without fetching anything. Two runs of the "
      "same grid are shown side by side at their common times, coloured by their "
      "difference. Of a directory of weft batch, the page has a table of all runs, "
      "plots of their results against the parameters, and a player for each.\n",
    OPTIONS(options),
    .more
    = "examples:\n"
      "  weft view flag\n"
      "  weft view sweep-results\n"
      "  weft view flag-rkf45 flag-verlet --out steppers.html\n"
      "\n"
      "exit codes: 0 done, 2 wrong command line, or runs that cannot be compared, 4 a "
      "file could not be read or written, 130 SIGINT, 143 SIGTERM\n",
    .operands = { 1, 2, "needs the directory of a run, of two, or of a batch", NULL },
    .run = view_verb,
};
