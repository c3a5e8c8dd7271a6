/* SPDX-License-Identifier: BSD-3-Clause */
/* plugin_test.c -- weft plugin-test: checks a plugin against the stepper contract, each
 * check of each method in its own process. */
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "program/cli.h"
#include "program/record/child_process.h"
#include "study/conformance/conformance.h"

/* Those of this verb alone. */
typedef struct plugin_test_options {
    bool all;
} plugin_test_options;

static const plugin_test_options *plugin_test_own(const arguments *given)
{
    return given->own;
}

enum {
    SECONDS = 60,   /* of a processor, or of idleness; the longest check takes 2 */
    SLOW = 5,       /* [s] until a check is named while it runs */
    HANGS_MOST = 2, /* of a method, whose other checks are then skipped */
    PRINTED_MOST = 1 << 20,
    CHECKS_MOST = 64
};

/* gsl_set_error_handler, if the plugin has loaded GSL. */
typedef void gsl_handler(const char *reason, const char *file, int line, int code);
typedef gsl_handler *gsl_set_handler(gsl_handler *handler);

static int gsl_calls; /* in the process of a check alone */

static void count_gsl(const char *reason, const char *file, int line, int code)
{
    (void)reason;
    (void)file;
    (void)line;
    (void)code;
    ++gsl_calls;
}

static gsl_set_handler *find_gsl(const char *file)
{
    gsl_set_handler *set = NULL;
    char path[4096];
    (void)snprintf(path, sizeof path, "%s%s", strchr(file, '/') == NULL ? "./" : "",
                   file);
    void *handle = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
    if (handle != NULL) {
        void *symbol = dlsym(handle, "gsl_set_error_handler");
        memcpy(&set, &symbol, sizeof set);
        (void)dlclose(handle); /* the registry holds it open */
    }
    return set;
}

/* Shared with the process of a check. */
typedef struct bench {
    const weft_stepper_type *type;
    gsl_set_handler *gsl;
    FILE *printed; /* takes all output */
    bool returned; /* with a verdict */
    weft_conformance seen;
    size_t check; /* under way */
    double named; /* [s] on weft__wall_clock: when to name it */
} bench;

static void breaks(weft_conformance *out, const char *seen)
{
    if (out->verdict != WEFT_PROMISE_BROKEN) {
        out->verdict = WEFT_PROMISE_BROKEN;
        (void)snprintf(out->seen, sizeof out->seen, "%s", seen);
    }
}

static int check_promise(void *ctx, size_t check)
{
    bench *self = ctx;
    const struct rlimit size = { PRINTED_MOST, PRINTED_MOST };
    (void)setrlimit(RLIMIT_FSIZE, &size);
    (void)dup2(fileno(self->printed), STDOUT_FILENO);
    (void)dup2(fileno(self->printed), STDERR_FILENO);
    if (self->gsl != NULL) {
        (void)self->gsl(count_gsl);
    }
    weft_conformance out = weft_conformance_check(self->type, check);
    if (self->gsl != NULL && self->gsl(NULL) != count_gsl) {
        breaks(&out, "the plugin left another error handler in GSL");
    } else if (gsl_calls > 0) {
        breaks(&out, "GSL called the program's error handler");
    }
    (void)fflush(NULL);
    self->seen = out;
    self->returned = true;
    return EXIT_DONE;
}

typedef struct finding {
    weft_conformance of;
    bool printed; /* the promise is broken by output */
    bool hung;    /* it did not come to an end */
} finding;

/* Reports the first line printed, if only this breaks the promise. */
static void report_output(FILE *printed, finding *out)
{
    const bool kept = out->of.verdict != WEFT_PROMISE_BROKEN;
    char line[256], seen[320];
    /* the stream may still buffer the output of an earlier check */
    const ssize_t length = pread(fileno(printed), line, sizeof line - 1, 0);
    if (length > 0) {
        line[length] = '\0';
        (void)snprintf(seen, sizeof seen, "it printed: %.*s", (int)strcspn(line, "\n"),
                       line);
        breaks(&out->of, seen);
        out->printed = kept;
    }
}

/* A check that takes long is named while it runs. */
static void name_check(void *ctx)
{
    bench *self = ctx;
    if (weft__wall_clock() >= self->named) {
        (void)fprintf(
            stderr,
            "weft: plugin-test: %s: check %zu of %zu, '%s', has run for %d s; "
            "it may take %d s\n",
            self->type->name, self->check + 1, weft_conformance_count(),
            weft_conformance_name(self->check), SLOW, SECONDS);
        self->named = HUGE_VAL;
    }
}

static bool run_check(bench *self, size_t check, finding *out)
{
    process child;
    const process_def def = { .work = check_promise,
                              .ctx = self,
                              .tick = name_check,
                              .end_signal = SIGKILL,
                              .seconds = SECONDS,
                              .idle = true,
                              .cpu_seconds = SECONDS,
                              .untrusted = true };
    self->returned = false;
    self->check = check;
    self->named = weft__wall_clock() + SLOW;
    const int printed = fileno(self->printed);
    if (lseek(printed, 0, SEEK_SET) != 0 || ftruncate(printed, 0) != 0
        || !process_run(&def, check, &child)) {
        perror("weft: error: plugin-test");
        return false;
    }
    out->of = self->seen;
    if (!self->returned) { /* no verdict */
        const int status = child.status;
        char text[128];
        out->hung = WIFSIGNALED(status)
                    && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
        out->of = (weft_conformance){ .verdict = WEFT_PROMISE_KEPT };
        process_describe(status, text, sizeof text);
        breaks(&out->of, out->hung ? "the check did not come to an end" : text);
    }
    report_output(self->printed, out);
    return true;
}

typedef struct found {
    size_t count;
    finding checks[CHECKS_MOST];
} found;

/* The results of a plugin's methods. */
typedef struct tally {
    size_t methods, bad, noted;
    weft_conformance note; /* the last */
} tally;

/* The number of checks in [from, to) with the same finding: one crash, or one line
 * printed, breaks many promises. */
static size_t count_same(const found *self, size_t check, size_t from, size_t to)
{
    const finding *a = &self->checks[check];
    size_t count = 0;
    for (const finding *b = self->checks + from; b < self->checks + to; ++b) {
        count += a->of.verdict == b->of.verdict
                 && ((a->printed && b->printed) || strcmp(a->of.seen, b->of.seen) == 0);
    }
    return count;
}

static void print_finding(const char *mark, const char *name, const char *text)
{
    enum { COLUMN = 21 };
    printf("  %-4s %-12s  ", mark, name);
    print_wrapped(COLUMN, COLUMN, PAGE_WIDTH, text);
}

static void print_verdict(const found *self, size_t check, bool all)
{
    static const char *const marks[] = { [WEFT_PROMISE_KEPT] = "pass",
                                         [WEFT_PROMISE_NOT_ASKED] = "  - ",
                                         [WEFT_PROMISE_NOTED] = "note" };
    const weft_conformance *one = &self->checks[check].of;
    const char *name = weft_conformance_name(check);
    const char *promise = weft_conformance_promise(check);
    const bool broken = one->verdict == WEFT_PROMISE_BROKEN;
    if (all && !broken) {
        print_finding(marks[one->verdict], name,
                      one->verdict == WEFT_PROMISE_KEPT ? promise : one->seen);
    } else if (broken && (all || count_same(self, check, 0, check) == 0)) {
        char seen[sizeof one->seen + 8];
        const size_t again = count_same(self, check, check + 1, self->count);
        print_finding("FAIL", name, promise);
        (void)snprintf(seen, sizeof seen, "seen: %s", one->seen);
        print_finding("", "", seen);
        if (!all && again > 0) {
            (void)snprintf(seen, sizeof seen, "and the same in %zu more check%s", again,
                           again == 1 ? "" : "s");
            print_finding("", "", seen);
        }
    }
}

/* False: the checks could not run. */
static bool test_method(const weft_plugin *plugin, bench *on, bool all, tally *of)
{
    size_t counts[WEFT_PROMISE_NOTED + 1] = { 0 };
    const size_t count = weft_conformance_count();
    size_t hangs = 0;
    found seen = { .count = count < CHECKS_MOST ? count : CHECKS_MOST };
    for (size_t i = 0; i < seen.count; ++i) {
        const weft_conformance *one = &seen.checks[i].of;
        if (hangs == HANGS_MOST) {
            seen.checks[i] = (finding){ .of = { WEFT_PROMISE_NOT_ASKED,
                                                "two checks did not come to an end" } };
        } else if (!run_check(on, i, &seen.checks[i])) {
            return false;
        }
        hangs += seen.checks[i].hung;
        ++counts[one->verdict];
        of->note = one->verdict == WEFT_PROMISE_NOTED ? *one : of->note;
    }
    print_line(stdout, "%s %s/%s: %zu kept, %zu broken, %zu not asked",
               counts[WEFT_PROMISE_BROKEN] > 0 ? "FAIL" : "pass", plugin->id,
               on->type->name, counts[WEFT_PROMISE_KEPT], counts[WEFT_PROMISE_BROKEN],
               counts[WEFT_PROMISE_NOT_ASKED] + counts[WEFT_PROMISE_NOTED]);
    for (size_t i = 0; i < seen.count; ++i) {
        print_verdict(&seen, i, all);
    }
    if (hangs == HANGS_MOST) {
        print_finding("", "", "two checks did not come to an end: the rest is skipped");
    }
    ++of->methods;
    of->bad += counts[WEFT_PROMISE_BROKEN] > 0 ? 1 : 0;
    of->noted += counts[WEFT_PROMISE_NOTED] > 0 ? 1 : 0;
    return true;
}

static int print_tally(const char *file, const tally *of)
{
    char note[sizeof of->note.seen + 100];
    const char *plural = of->methods == 1 ? "" : "s";
    if (of->noted > 0) {
        (void)snprintf(note, sizeof note,
                       "note: with %zu of %zu method%s %s, as is allowed", of->noted,
                       of->methods, plural, of->note.seen);
        print_wrapped(0, 6, PAGE_WIDTH, note);
    }
    if (of->bad == 0) {
        print_line(stdout, "%s meets every requirement with %zu method%s", file,
                   of->methods, plural);
        return EXIT_DONE;
    }
    print_line(stdout, "%s fails requirements with %zu of %zu method%s", file, of->bad,
               of->methods, plural);
    return EXIT_SIMULATION;
}

static int test_plugin(const char *file, const weft_plugin *plugin, bool all)
{
    tally of = { 0 };
    bench *on = process_memory(1, sizeof *on);
    FILE *printed = tmpfile();
    bool able = on != NULL && printed != NULL;
    if (!able) {
        perror("weft: error: plugin-test");
    }
    for (size_t i = 0; able && plugin->types[i] != NULL; ++i) {
        on->type = plugin->types[i];
        on->gsl = find_gsl(file);
        on->printed = printed;
        able = test_method(plugin, on, all, &of);
    }
    if (printed != NULL) {
        (void)fclose(printed);
    }
    return able ? print_tally(file, &of) : EXIT_FILE;
}

static int plugin_test_verb(const arguments *given)
{
    weft_error err = { 0 };
    const char *file = given->operands[0];
    if (access(file, R_OK) != 0) {
        return report_status(WEFT_IO, "%s: %s", file, strerror(errno));
    }
    if (weft_registry_load(given->registry, file, &err) != WEFT_OK) {
        print_plainly(stdout, "FAIL %s\n", err.message);
        return EXIT_SIMULATION;
    }
    return test_plugin(file, weft_registry_at(given->registry, 0),
                       plugin_test_own(given)->all);
}

static const verb_option options[] = {
    OWN(plugin_test_options, all, "all", NULL,
        "every verdict; default: one line per method, and the failed requirements"),
};

const verb verb_plugin_test = {
    .name = "plugin-test",
    .summary = "check a plugin against the contract",
    .help = "usage: weft plugin-test weft-ID.so [--all]\n"
            "\n"
            "Loads a plugin and checks every requirement of weft/stepper.h with every "
            "method: the order, the ends of steps, the state after a failure, edited "
            "states, statistics, threads, memory. Each check runs in its own process. "
            "Documentation: docs/guides/test-an-integrator.md\n",
    OPTIONS(options),
    .own_size = sizeof(plugin_test_options),
    .more = "example: weft plugin-test build/plugins/weft-verlet.so --all\n"
            "\n"
            "exit codes: 0 every requirement is met, 1 one is not or the plugin is "
            "refused, 2 wrong command line, 4 the file cannot be read\n",
    .operands = { 1, 1, "takes one file, weft-ID.so", NULL },
    .run = plugin_test_verb,
};
