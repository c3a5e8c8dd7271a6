/* SPDX-License-Identifier: BSD-3-Clause */
/* options.c -- the command line of a verb. */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/suggest.h"
#include "program/cli.h"

#define OPTION_AT(member) (256 + (int)offsetof(arguments, member))
#define TEXT(member)      required_argument, NULL, OPTION_AT(member)
#define FLAG(member)      no_argument, NULL, OPTION_AT(member)

/* Every option of the program, which fills a member of struct arguments, a bool or a
 * text; --set adds to `sets`, --at to `ats`, --jobs is a number. */
static const struct option all_options[] = {
    { "out", TEXT(out) },
    { "set", TEXT(sets) },
    { "plugin-path", TEXT(plugin_path) },
    { "quiet", FLAG(quiet) },
    { "force", FLAG(force) },
    { "frames", TEXT(frames) },
    { "view", FLAG(view) },
    { "watch", FLAG(watch) },
    { "port", TEXT(port) },
    { "progress", TEXT(progress) },
    { "jobs", TEXT(jobs) },
    { "bands", TEXT(bands) },
    { "timeout", TEXT(timeout) },
    { "shard", TEXT(shard) },
    { "sample", TEXT(sample) },
    { "seed", TEXT(seed) },
    { "retry-failed", FLAG(retry_failed) },
    { "summary", FLAG(summary) },
    { "yaml", FLAG(yaml) },
    { "markdown", FLAG(markdown) },
    { "all", FLAG(all) },
    { "refine", FLAG(refine) },
    { "format", TEXT(format) },
    { "frame", TEXT(frame) },
    { "garment", TEXT(garment) },
    { "tol", TEXT(tolerance) },
    { "methods", TEXT(methods) },
    { "until", TEXT(until) },
    { "sizes", TEXT(sizes) },
    { "at", TEXT(ats) },
    { "over", TEXT(over) },
    { "sigma", TEXT(sigma) },
    { "clamp-midway", FLAG(clamp_midway) },
    { "csv", FLAG(csv) },
};

enum { OPTIONS = sizeof all_options / sizeof all_options[0] };

/* Whether a line of a help begins with the option, or with -j and it. */
static bool is_in_help(const char *help, const char *name)
{
    char line[2][48];
    (void)snprintf(line[0], sizeof line[0], "\n  --%s ", name);
    (void)snprintf(line[1], sizeof line[1], "\n  -j, --%s ", name);
    return strstr(help, line[0]) != NULL || strstr(help, line[1]) != NULL;
}

/* A verb takes --help and the options that its help lists. */
static void list_options(const verb *self, struct option out[OPTIONS + 2])
{
    size_t count = 0;
    out[count++] = (struct option){ "help", no_argument, NULL, 'h' };
    for (size_t i = 0; i < OPTIONS; ++i) {
        if (is_in_help(self->help, all_options[i].name)) {
            out[count++] = all_options[i];
        }
    }
    out[count] = (struct option){ 0 };
}

/* By what getopt_long returns. */
static void apply(int value, arguments *out)
{
    const struct option *option = all_options;
    while (option->val != value) {
        ++option;
    }
    void *member = (char *)out + (option->val - 256);
    size_t jobs;
    if (option->val == OPTION_AT(sets)) {
        out->sets[out->set_count++] = optarg;
    } else if (option->val == OPTION_AT(ats)) {
        out->ats[out->at_count++] = optarg;
    } else if (option->val == OPTION_AT(jobs)) {
        out->jobs = option_count(optarg, '\0', &jobs) && jobs <= MOST_JOBS ? jobs : 0;
    } else if (option->has_arg == required_argument) {
        *(const char **)member = optarg;
    } else {
        *(bool *)member = true;
    }
}

static int unknown_option(const arguments *given, const struct option *table,
                          const char *typed)
{
    weft__guess guess = { 0 };
    char word[80] = "", near[80] = "";
    const size_t dashes = strspn(typed, "-");
    (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(typed + dashes, "="),
                   typed + dashes);
    if (strcmp(word, "bands") == 0) {
        return usage_error(given,
                           "%s: weft run and weft resume alone have one cloth in "
                           "bands",
                           typed);
    }
    for (size_t i = 0; table[i].name != NULL; ++i) {
        const bool is_out = table[i].val == OPTION_AT(out);
        weft__guess_try(&guess, word, is_out ? "output" : table[i].name);
        weft__guess_try(&guess, word, table[i].name);
    }
    if (guess.name != NULL) {
        (void)snprintf(near, sizeof near, " (did you mean '--%s'?)",
                       strcmp(guess.name, "output") == 0 ? "out" : guess.name);
    }
    return usage_error(given, "unknown option %s%s", typed, near);
}

/* auto or NULL: terminal if stderr is one that can return to the start of a line, else
 * lines. */
static int choose_progress(arguments *given)
{
    static const char *const names[]
        = { "auto", "lines", "terminal", "yaml", "none", NULL };
    const char *kind = getenv("TERM");
    const bool redraws
        = isatty(STDERR_FILENO) == 1 && kind != NULL && strcmp(kind, "dumb") != 0;
    const progress_mode modes[]
        = { redraws ? PROGRESS_TERMINAL : PROGRESS_LINES, PROGRESS_LINES,
            PROGRESS_TERMINAL, PROGRESS_YAML, PROGRESS_NONE };
    size_t i = 0;
    if (given->progress != NULL
        && choose(given, "progress", given->progress, names, &i) != EXIT_DONE) {
        return EXIT_USAGE;
    }
    if (given->quiet && given->progress != NULL) {
        return usage_error(given, "--quiet and --progress exclude each other");
    }
    given->mode = given->quiet ? PROGRESS_NONE : modes[i];
    return -1;
}

/* -1: run the verb. Else an exit code: help was printed, or the command line is wrong.
 */
static int parse(arguments *given, int argc)
{
    const verb *self = given->verb;
    char **argv = given->argv;
    struct option table[OPTIONS + 2];
    list_options(self, table);
    const char *letters = is_in_help(self->help, "jobs") ? ":hj:" : ":h";
    opterr = 0;
    optind = 1;
    for (int value; (value = getopt_long(argc, argv, letters, table, NULL)) != -1;) {
        value = value == 'j' ? OPTION_AT(jobs) : value;
        switch (value) {
        case 'h':
            print_help(self->help);
            return EXIT_DONE;
        case '?':
            return unknown_option(given, table, argv[optind - 1]);
        case ':':
            return usage_error(given, "option %s needs a value", argv[optind - 1]);
        default:
            apply(value, given);
        }
        if (value == OPTION_AT(jobs) && given->jobs == 0) {
            return usage_error(given, "--jobs %s: not a number from 1 to %d", optarg,
                               MOST_JOBS);
        }
    }
    given->operands = argv + optind;
    given->operand_count = argc - optind;
    const bool few = given->operand_count < self->operands.least;
    const bool many = given->operand_count > self->operands.most;
    if (few || many) {
        return usage_error(given, "%s",
                           many && self->operands.many != NULL ? self->operands.many
                                                               : self->operands.few);
    }
    return choose_progress(given);
}

int verb_start(const verb *self, int argc, char **argv)
{
    arguments given = { .verb = self,
                        .argv = argv,
                        .sets = calloc((size_t)argc, 2 * sizeof *given.sets) };
    if (given.sets == NULL) {
        return report_status(WEFT_NO_MEMORY, "out of memory");
    }
    given.ats = given.sets + argc;
    int code = parse(&given, argc);
    if (code < 0) {
        given.registry = open_registry(given.plugin_path, given.bands == NULL);
        if (given.bands == NULL && is_in_help(self->help, "bands")) {
            ranks_hint();
        }
        code = given.registry == NULL ? EXIT_SIMULATION
               : given.bands == NULL  ? self->run(&given)
                                      : ranks_run(&given);
        weft_registry_destroy(given.registry);
    }
    free(given.sets);
    return code;
}
