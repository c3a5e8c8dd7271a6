/* SPDX-License-Identifier: BSD-3-Clause */
/* options.c -- the command line of a verb. */
#include <getopt.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/suggest.h"
#include "cli/cli.h"
#include "cli/human.h"

typedef enum kind { FLAG, TEXT, LIST, JOBS } kind;

/* An option: its value is a bool, a const char *, a size_t for --jobs or, for --set,
 * one more of a list. */
static const struct {
    const char *name;
    int letter;
    kind kind;
    size_t at; /* in options */
} known[] = {
    { "out", 'o', TEXT, offsetof(options, out) },
    { "set", 's', LIST, offsetof(options, sets) },
    { "plugin-path", 'p', TEXT, offsetof(options, plugin_path) },
    { "quiet", 'q', FLAG, offsetof(options, quiet) },
    { "force", 'F', FLAG, offsetof(options, force) },
    { "frames", 'r', TEXT, offsetof(options, frames) },
    { "format", 't', TEXT, offsetof(options, format) },
    { "frame", 'i', TEXT, offsetof(options, frame) },
    { "yaml", 'y', FLAG, offsetof(options, yaml) },
    { "markdown", 'm', FLAG, offsetof(options, markdown) },
    { "all", 'a', FLAG, offsetof(options, all) },
    { "refine", 'R', FLAG, offsetof(options, refine) },
    { "view", 'v', FLAG, offsetof(options, view) },
    { "progress", 'P', TEXT, offsetof(options, progress) },
    { "tol", 'L', TEXT, offsetof(options, tolerance) },
    { "jobs", 'j', JOBS, offsetof(options, jobs) },
    { "timeout", 'T', TEXT, offsetof(options, timeout) },
    { "shard", 'S', TEXT, offsetof(options, shard) },
    { "retry-failed", 'E', FLAG, offsetof(options, retry_failed) },
    { "summary", 'U', FLAG, offsetof(options, summary) },
    { "methods", 'M', TEXT, offsetof(options, methods) },
    { "until", 'u', TEXT, offsetof(options, until) },
};

#define KNOWN (sizeof known / sizeof known[0])

int usage_error(const verb *self, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char text[1024];
    (void)vsnprintf(text, sizeof text, format, args);
    fprintf(stderr, "weft %s: ", self->name);
    print_plain(stderr, text, "");
    fprintf(stderr, "\n'weft %s --help' shows how it is used\n", self->name);
    va_end(args);
    return EXIT_USAGE;
}

/* 0: not a number of jobs. */
static size_t jobs_of(const char *text)
{
    char *end;
    const long jobs = strtol(text, &end, 10);
    return *end == '\0' && jobs >= 1 && jobs <= MOST_JOBS ? (size_t)jobs : 0;
}

static void apply(int letter, options *out)
{
    size_t i = 0;
    while (known[i].letter != letter) {
        ++i;
    }
    void *value = (char *)out + known[i].at;
    if (known[i].kind == LIST) {
        out->sets[out->set_count++] = optarg;
    } else if (known[i].kind == JOBS) {
        *(size_t *)value = jobs_of(optarg);
    } else if (known[i].kind == TEXT) {
        *(const char **)value = optarg;
    } else {
        *(bool *)value = true;
    }
}

/* The options that a verb takes, as getopt_long has them. */
static void make_table(const char *takes, struct option *table)
{
    size_t count = 0;
    table[count++] = (struct option){ "help", no_argument, NULL, 'h' };
    for (size_t i = 0; i < KNOWN; ++i) {
        if (strchr(takes, known[i].letter) != NULL) {
            table[count++] = (struct option){ known[i].name,
                                              known[i].kind == FLAG ? no_argument
                                                                    : required_argument,
                                              NULL, known[i].letter };
        }
    }
}

static int unknown_option(const verb *self, const char *typed,
                          const struct option *table)
{
    weft__guess guess = { 0 };
    char word[80] = "", near[80] = "";
    const size_t dashes = strspn(typed, "-");
    (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(typed + dashes, "="),
                   typed + dashes);
    for (size_t i = 0; table[i].name != NULL; ++i) {
        weft__guess_try(&guess, word, table[i].name);
    }
    if (guess.name != NULL) {
        (void)snprintf(near, sizeof near, " (did you mean '--%s'?)", guess.name);
    }
    return usage_error(self, "unknown option %s%s", typed, near);
}

int usage_choice(const verb *self, const char *option, const char *typed,
                 const char *const *names)
{
    weft__guess guess = { 0 };
    char list[200] = "", near[80];
    size_t used = 0;
    for (size_t i = 0; names[i] != NULL && used < sizeof list; ++i) {
        weft__guess_try(&guess, typed, names[i]);
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s",
                                 i == 0                 ? ""
                                 : names[i + 1] == NULL ? " or "
                                                        : ", ",
                                 names[i]);
    }
    return usage_error(self, "--%s '%s' is not %s%s", option, typed, list,
                       weft__guess_text(&guess, near, sizeof near));
}

int options_parse(const verb *self, const char *takes, int argc, char **argv,
                  options *out)
{
    struct option table[KNOWN + 2] = { { 0 } };
    make_table(takes, table);
    *out = (options){ .sets = calloc((size_t)argc, sizeof *out->sets) };
    if (out->sets == NULL) {
        return usage_error(self, "out of memory");
    }
    const char *letters = strchr(takes, 'j') == NULL ? ":h" : ":hj:";
    opterr = 0;
    optind = 1;
    for (int letter; (letter = getopt_long(argc, argv, letters, table, NULL)) != -1;) {
        if (letter == 'h') {
            print_help(self->help);
            options_free(out);
            return EXIT_DONE;
        }
        if (letter == '?' || letter == ':') {
            options_free(out);
            return letter == '?'
                       ? unknown_option(self, argv[optind - 1], table)
                       : usage_error(self, "option %s needs a value", argv[optind - 1]);
        }
        apply(letter, out);
        if (letter == 'j' && out->jobs == 0) {
            options_free(out);
            return usage_error(self, "--jobs %s: not a number from 1 to %d", optarg,
                               MOST_JOBS);
        }
    }
    out->operands = argv + optind;
    out->operand_count = argc - optind;
    return -1;
}

void options_free(options *out)
{
    free(out->sets);
    out->sets = NULL;
}
