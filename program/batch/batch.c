/* SPDX-License-Identifier: BSD-3-Clause */
/* batch.c -- weft batch: many runs, each in its own process and directory. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program/batch/batch.h"
#include "program/run/interrupt.h"

/* Those of this verb alone. */
typedef struct batch_options {
    const char *timeout;
    bool retry_failed;
    const char *shard;
    bool summary;
    const char *sample;
    const char *seed;
} batch_options;

static const batch_options *batch_own(const arguments *given)
{
    return given->own;
}

/* ---- the command line ---------------------------------------------------------- */

static int take_options(batch *self)
{
    const arguments *given = self->given;
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    self->out = given->out;
    self->jobs = given->jobs > 0 ? given->jobs : cores < 1 ? 1 : (size_t)cores;
    self->shard = self->shards = 1;
    if (given->out == NULL || given->out[0] == '\0') {
        return usage_error(given, "no --out DIR given");
    }
    if (batch_own(given)->timeout != NULL) {
        self->timeout = option_real(batch_own(given)->timeout);
        if (!(self->timeout > 0.0 && isfinite(self->timeout))) {
            return usage_error(given, "--timeout %s: not a number of seconds > 0",
                               batch_own(given)->timeout);
        }
    }
    if (batch_own(given)->shard != NULL /* "2/3": shard 2 of 3 */
        && !(option_count(batch_own(given)->shard, '/', &self->shard)
             && option_count(strchr(batch_own(given)->shard, '/') + 1, '\0',
                             &self->shards)
             && self->shard >= 1 && self->shard <= self->shards)) {
        return usage_error(given, "--shard %s: not i/n with i from 1 to n",
                           batch_own(given)->shard);
    }
    return batch_own(given)->seed != NULL && batch_own(given)->sample == NULL
               ? usage_error(given, "--seed goes with --sample N")
               : EXIT_DONE;
}

/* --KEY N as --set sweep.KEY=N, for which `sets` has the place of the option. */
static int set_in_sweep(arguments *given, const char *key, const char *typed,
                        size_t least, size_t most, char set[64])
{
    size_t number = 0;
    if (typed == NULL) {
        return EXIT_DONE;
    }
    if (!option_count(typed, '\0', &number) || number < least || number > most) {
        return usage_error(given, "--%s %s: not a number from %zu to %zu", key, typed,
                           least, most);
    }
    (void)snprintf(set, 64, "sweep.%s=%zu", key, number);
    given->sets.at[given->sets.count++] = set;
    return EXIT_DONE;
}

/* ---- the runs of this process ------------------------------------------------- */

static bool to_run(const batch *self, const batch_run *run)
{
    switch (run->status) {
    case BATCH_NEW:
    case BATCH_PARTIAL:
    case BATCH_IO_ERROR:
        return true;
    case BATCH_FAILED:
    case BATCH_CRASHED:
    case BATCH_TIMEOUT:
        return batch_own(self->given)->retry_failed;
    case BATCH_CHANGED:
        return self->given->force;
    default:
        return false;
    }
}

static bool is_mine(const batch *self, size_t run)
{
    return batch_own(self->given)->summary || run % self->shards == self->shard - 1;
}

/* ---- the end ------------------------------------------------------------------- */

static void print_warned(const batch *self)
{
    const batch_run *first = NULL;
    size_t count = 0;
    for (size_t i = 0; i < self->run_count; ++i) {
        if (is_mine(self, i) && batch_warned(self, &self->runs[i])) {
            first = first == NULL ? &self->runs[i] : first;
            ++count;
        }
    }
    if (count > 0) {
        print_plainly(stdout, " (%zu of them with warnings: see %s/%s/log.txt)", count,
                      self->out, first->name);
    }
}

/* "24 runs in DIR: 20 done (2 of them with warnings: see DIR/flag_n=2/log.txt), 4
 * failed" */
static int print_counts(const batch *self)
{
    static const char *const reasons[BATCH_STATUSES] = {
        [BATCH_CHANGED] = ("holds a run of another scene, or of this one before it was "
                           "changed: --force runs it again"),
        [BATCH_BUSY] = "is being run by another process",
        [BATCH_UNREADABLE] = "is not a readable directory",
    };
    size_t counts[BATCH_STATUSES] = { 0 }, mine = 0;
    for (size_t i = 0; i < self->run_count; ++i) {
        if (is_mine(self, i)) {
            const batch_run *run = &self->runs[i];
            ++mine;
            ++counts[run->status];
            if (reasons[run->status] != NULL) {
                print_plainly(stderr, "weft: error: %s/%s %s\n", self->out, run->name,
                              reasons[run->status]);
            }
        }
    }
    if (!self->given->quiet) {
        const char *join = ": ";
        print_plainly(stdout, "%zu runs in %s", mine, self->out);
        for (size_t i = 0; i < BATCH_STATUSES; ++i) {
            if (counts[i] > 0) {
                printf("%s%zu %s", join, counts[i], batch_status_names[i]);
                join = ", ";
                if (i == BATCH_DONE) {
                    print_warned(self);
                }
            }
        }
        putchar('\n');
    }
    const size_t refused = counts[BATCH_CHANGED] + counts[BATCH_BUSY]
                           + counts[BATCH_UNREADABLE] + counts[BATCH_IO_ERROR];
    return refused > 0                 ? EXIT_FILE
           : counts[BATCH_DONE] < mine ? EXIT_SIMULATION
                                       : EXIT_DONE;
}

static int run_batch(batch *self)
{
    weft_error err = { 0 };
    batch_run **wanted = calloc(self->run_count, sizeof *wanted);
    if (wanted == NULL) {
        return report_status(WEFT_NO_MEMORY, "no memory for the runs");
    }
    weft_status status = record_directory(self->out, &err);
    if (status != WEFT_OK) {
        free(wanted);
        return report_error(&err);
    }
    size_t count = 0; /* that this process runs */
    for (size_t i = 0; i < self->run_count; ++i) {
        batch_run *run = &self->runs[i];
        run->status = batch_look(self, run);
        if (!batch_own(self->given)->summary && is_mine(self, i) && to_run(self, run)) {
            wanted[count++] = run;
        }
    }
    const int stop = batch_pool_run(self, wanted, count);
    free(wanted);
    /* One shard does not know the results of the others. */
    if (self->shards == 1) {
        status = batch_summary(self, &err);
    }
    const int code = print_counts(self);
    if (status != WEFT_OK) {
        return report_error(&err);
    }
    return stop != 0 ? interrupt_code(stop) : code;
}

static int batch_verb(const arguments *given)
{
    char sample[64], seed[64];
    arguments all = *given;
    batch self = { .given = &all };
    int code = take_options(&self);
    code = code == EXIT_DONE ? set_in_sweep(&all, "sample", batch_own(given)->sample, 1,
                                            100000, sample)
                             : code;
    code = code == EXIT_DONE
               ? set_in_sweep(&all, "seed", batch_own(given)->seed, 0, INT_MAX, seed)
               : code;
    code = code == EXIT_DONE ? batch_plan(&self) : code;
    code = code == EXIT_DONE ? run_batch(&self) : code;
    batch_free(&self);
    return code;
}

static const verb_option options[] = {
    SHARED(out, "out", "DIR", "the directory of the runs' directories"),
    SHARED(jobs, "jobs", "N", "runs at a time; default: the number of processors"),
    OWN(batch_options, timeout, "timeout", "S", "end a run that takes longer [s]"),
    OWN(batch_options, retry_failed, "retry-failed", NULL,
        "repeat runs that failed, crashed or took too long"),
    SHARED(force, "force", NULL, "repeat existing runs whose scene has changed"),
    OWN(batch_options, shard, "shard", "I/N",
        "only every N-th run, from the I-th (1 to N) on; no summary"),
    OWN(batch_options, summary, "summary", NULL, "run nothing, only write summary.csv"),
    OWN(batch_options, sample, "sample", "N",
        "N runs with values drawn from the ranges of the sweep instead of all "
        "combinations"),
    OWN(batch_options, seed, "seed", "S", "draws other values; default: 1"),
    SHARED(sets, "set", "KEY.PATH=VALUE",
           "override a key of all scenes; may be repeated"),
    OPTION_PLUGIN_PATH,
    SHARED(quiet, "quiet", NULL, "no progress, no summary line"),
};

const verb verb_batch = {
    .name = "batch",
    .summary = "run many scenes and sweeps, one process and directory each",
    .help = "usage: weft batch SCENE.yaml... --out DIR [OPTIONS]\n"
            "\n"
            "Runs every scene, and every run of a scene with 'sweep', each in its own "
            "process and directory DIR/NAME. Joins the results in DIR/summary.csv. A "
            "repeated call skips finished runs and continues the others.\n",
    OPTIONS(options),
    .own_size = sizeof(batch_options),
    .more = "examples:\n"
            "  weft batch scenes/flag.yaml scenes/curtain.yaml --out both -j 2\n"
            "  weft batch sweep.yaml --out sweep --timeout 600 --retry-failed\n"
            "  weft batch sweep.yaml --out sample --sample 100 --seed 7\n"
            "\n"
            "exit codes: 0 all done, 1 a run is not done, 2 wrong command line, 3 "
            "wrong scene, 4 a file could not be read or written, or a directory holds "
            "another scene's run, 130 SIGINT, 143 SIGTERM\n",
    .operands = { 1, ANY_NUMBER, "no scene given", NULL },
    .run = batch_verb,
};
