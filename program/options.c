/* SPDX-License-Identifier: BSD-3-Clause */
/* options.c -- the command line of a verb. */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/suggest.h"
#include "program/cli.h"

enum { OPTIONS_MOST = 16, FIRST = 256 }; /* what getopt_long returns of option 0 */

/* A verb takes --help and its options. */
static void list_options(const verb *self, struct option out[OPTIONS_MOST + 2])
{
    size_t count = 0;
    out[count++] = (struct option){ "help", no_argument, NULL, 'h' };
    for (size_t i = 0; i < self->option_count && i < OPTIONS_MOST; ++i) {
        const verb_option *of = &self->options[i];
        const int has = of->value != NULL ? required_argument : no_argument;
        out[count++] = (struct option){ of->name, has, NULL, FIRST + (int)i };
    }
    out[count] = (struct option){ 0 };
}

static const verb_option *option_named(const verb *self, const char *name)
{
    for (size_t i = 0; i < self->option_count; ++i) {
        if (strcmp(self->options[i].name, name) == 0) {
            return &self->options[i];
        }
    }
    return NULL;
}

static bool is_jobs(const verb_option *of)
{
    return !of->own && of->at == offsetof(arguments, jobs);
}

/* own: that of `out`, which is still empty. */
static void apply(const verb_option *of, arguments *out, void *own)
{
    void *member = (char *)(of->own ? own : out) + of->at;
    size_t jobs;
    if (of->list) {
        texts *to = member;
        to->at[to->count++] = optarg;
    } else if (is_jobs(of)) {
        out->jobs = option_count(optarg, '\0', &jobs) && jobs <= MOST_JOBS ? jobs : 0;
    } else if (of->value != NULL) {
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
        const bool is_out = strcmp(table[i].name, "out") == 0;
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

/* Reads the options of the verb. -1: it goes on; else an exit code: help was printed,
 * or the command line is wrong. */
static int parse_options(arguments *given, void *own, int argc)
{
    const verb *self = given->verb;
    const verb_option *jobs = option_named(self, "jobs");
    char **argv = given->argv;
    struct option table[OPTIONS_MOST + 2];
    list_options(self, table);
    opterr = 0;
    optind = 1;
    for (int value;
         (value = getopt_long(argc, argv, jobs != NULL ? ":hj:" : ":h", table, NULL))
         != -1;) {
        const verb_option *of = value == 'j'     ? jobs
                                : value >= FIRST ? &self->options[value - FIRST]
                                                 : NULL;
        if (value == 'h') {
            print_help(self);
            return EXIT_DONE;
        }
        if (value == ':') {
            return usage_error(given, "option %s needs a value", argv[optind - 1]);
        }
        if (of == NULL) {
            return unknown_option(given, table, argv[optind - 1]);
        }
        apply(of, given, own);
        if (of == jobs && given->jobs == 0) {
            return usage_error(given, "--jobs %s: not a number from 1 to %d", optarg,
                               MOST_JOBS);
        }
    }
    return -1;
}

/* The same of all of the command line. */
static int parse(arguments *given, void *own, int argc)
{
    const verb *self = given->verb;
    const int code = parse_options(given, own, argc);
    if (code >= 0) {
        return code;
    }
    given->operands = given->argv + optind;
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

static int run_verb(arguments *given)
{
    given->registry = open_registry(given->plugin_path, given->bands == NULL);
    if (given->bands == NULL && option_named(given->verb, "bands") != NULL) {
        ranks_hint();
    }
    const int code = given->registry == NULL ? EXIT_SIMULATION
                     : given->bands == NULL  ? given->verb->run(given)
                                             : ranks_run(given);
    weft_registry_destroy(given->registry);
    return code;
}

/* Gives each option that may be repeated room for as many values as there are words. */
static void give_room(const verb *self, const char **room, size_t words,
                      arguments *given, void *own)
{
    given->sets.at = room;
    for (size_t i = 0; i < self->option_count; ++i) {
        const verb_option *of = &self->options[i];
        if (of->list) {
            texts *to = (texts *)(void *)((char *)(of->own ? own : given) + of->at);
            to->at = room + words * (1 + i);
        }
    }
}

int verb_start(const verb *self, int argc, char **argv)
{
    const size_t words = (size_t)argc;
    arguments given = { .verb = self, .argv = argv };
    const char **room = calloc(words * (self->option_count + 1), sizeof *room);
    void *own = calloc(1, self->own_size + 1);
    int code = EXIT_SIMULATION;
    if (room == NULL || own == NULL) {
        code = report_status(WEFT_NO_MEMORY, "out of memory");
    } else {
        give_room(self, room, words, &given, own);
        given.own = own;
        code = parse(&given, own, argc);
        code = code < 0 ? run_verb(&given) : code;
    }
    free(own);
    free(room);
    return code;
}
