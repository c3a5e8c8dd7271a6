/* SPDX-License-Identifier: BSD-3-Clause */
/* options.c -- the command line of a verb. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/suggest.h"
#include "cli/cli.h"
#include "cli/human.h"
#include "cli/run/progress.h"
#include "cli/run/ranks.h"

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

double option_real(const char *text)
{
    char *end;
    const double value = strtod(text, &end);
    return end != text && *end == '\0' ? value : (double)NAN;
}

bool option_count(const char *text, char end, size_t *count)
{
    char *stop;
    errno = 0;
    const unsigned long long value = strtoull(text, &stop, 10);
    *count = (size_t)value;
    return text[0] >= '0' && text[0] <= '9' && *stop == end && errno == 0
           && value <= SIZE_MAX;
}

/* The entry with that value, or the last one, which has no name. */
static const struct option *find(const struct option *table, int value)
{
    while (table->name != NULL && table->val != value) {
        ++table;
    }
    return table;
}

static void apply(const struct option *option, options *out)
{
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

static int unknown_option(const verb *self, const char *typed)
{
    const struct option *table = self->options;
    weft__guess guess = { 0 };
    char word[80] = "", near[80] = "";
    const size_t dashes = strspn(typed, "-");
    (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(typed + dashes, "="),
                   typed + dashes);
    if (strcmp(word, "bands") == 0) {
        return usage_error(self,
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
    return usage_error(self, "unknown option %s%s", typed, near);
}

int usage_choice(const verb *self, const char *option, const char *typed,
                 const char *const *names)
{
    weft__guess guess = { 0 };
    sentence list = { "" };
    char near[80];
    for (size_t i = 0; names[i] != NULL; ++i) {
        weft__guess_try(&guess, typed, names[i]);
        const char *separator = i == 0 ? "" : names[i + 1] == NULL ? " or " : ", ";
        say(&list, "%s%s", separator, names[i]);
    }
    return usage_error(self, "--%s '%s' is not %s%s", option, typed, list.text,
                       weft__guess_text(&guess, near, sizeof near));
}

/* auto or NULL: terminal if stderr is one, else lines. */
static int choose_progress(const verb *self, options *out)
{
    static const char *const names[]
        = { "auto", "lines", "terminal", "yaml", "none", NULL };
    const progress_mode modes[]
        = { progress_can_redraw() ? PROGRESS_TERMINAL : PROGRESS_LINES, PROGRESS_LINES,
            PROGRESS_TERMINAL, PROGRESS_YAML, PROGRESS_NONE };
    size_t i = 0;
    while (out->progress != NULL && names[i] != NULL
           && strcmp(names[i], out->progress) != 0) {
        ++i;
    }
    if (names[i] == NULL) {
        return usage_choice(self, "progress", out->progress, names);
    }
    if (out->quiet && out->progress != NULL) {
        return usage_error(self, "--quiet and --progress exclude each other");
    }
    out->mode = out->quiet ? PROGRESS_NONE : modes[i];
    return -1;
}

/* -1: run the verb. Else an exit code: help was printed, or the command line is wrong.
 */
static int parse(const verb *self, int argc, char **argv, options *out)
{
    const struct option *jobs = find(self->options, OPTION_AT(jobs));
    const char *letters = jobs->name == NULL ? ":h" : ":hj:";
    opterr = 0;
    optind = 1;
    for (int value;
         (value = getopt_long(argc, argv, letters, self->options, NULL)) != -1;) {
        switch (value) {
        case 'h':
            print_help(self->help);
            return EXIT_DONE;
        case '?':
            return unknown_option(self, argv[optind - 1]);
        case ':':
            return usage_error(self, "option %s needs a value", argv[optind - 1]);
        default:
            apply(value == 'j' ? jobs : find(self->options, value), out);
        }
        if ((value == 'j' || value == OPTION_AT(jobs)) && out->jobs == 0) {
            return usage_error(self, "--jobs %s: not a number from 1 to %d", optarg,
                               MOST_JOBS);
        }
    }
    out->operands = argv + optind;
    out->operand_count = argc - optind;
    const bool few = out->operand_count < self->operands.least;
    const bool many
        = self->operands.most > 0 && out->operand_count > self->operands.most;
    if (few || many) {
        return usage_error(self, "%s",
                           many && self->operands.many != NULL ? self->operands.many
                                                               : self->operands.few);
    }
    return choose_progress(self, out);
}

int verb_start(const verb *self, int argc, char **argv)
{
    options given
        = { .argv = argv, .sets = calloc((size_t)argc, 2 * sizeof *given.sets) };
    if (given.sets == NULL) {
        weft_error err = { 0 };
        weft_error_set(&err, WEFT_NO_MEMORY, "out of memory");
        return report_error(&err);
    }
    given.ats = given.sets + argc;
    int code = parse(self, argc, argv, &given);
    if (code < 0) {
        given.registry = open_registry(given.plugin_path, given.bands == NULL);
        if (given.bands == NULL) {
            ranks_hint(self);
        }
        code = given.registry == NULL ? EXIT_SIMULATION
               : given.bands == NULL  ? self->run(&given)
                                      : ranks_run(self, &given);
        weft_registry_destroy(given.registry);
    }
    free(given.sets);
    return code;
}
