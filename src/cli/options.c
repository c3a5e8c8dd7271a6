/* SPDX-License-Identifier: BSD-3-Clause */
/* options.c -- the command line of a verb. */
#include <getopt.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

static const struct option known[] = {
    { "help", no_argument, NULL, 'h' },
    { "out", required_argument, NULL, 'o' },
    { "set", required_argument, NULL, 's' },
    { "plugin-path", required_argument, NULL, 'p' },
    { "quiet", no_argument, NULL, 'q' },
    { "force", no_argument, NULL, 'F' },
    { "frames", required_argument, NULL, 'r' },
    { "format", required_argument, NULL, 't' },
    { "frame", required_argument, NULL, 'i' },
    { "yaml", no_argument, NULL, 'y' },
    { "markdown", no_argument, NULL, 'm' },
    { "all", no_argument, NULL, 'a' },
    { "refine", no_argument, NULL, 'R' },
    { "view", no_argument, NULL, 'v' },
    { "tol", required_argument, NULL, 'T' },
    { "jobs", required_argument, NULL, 'j' },
    { "timeout", required_argument, NULL, 'L' },
    { "shard", required_argument, NULL, 'S' },
    { "retry-failed", no_argument, NULL, 'E' },
    { "summary", no_argument, NULL, 'U' },
};

#define KNOWN (sizeof known / sizeof known[0])

int usage_error(const verb *self, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "weft %s: ", self->name);
    vfprintf(stderr, format, args);
    fprintf(stderr, "\n'weft %s --help' shows how it is used\n", self->name);
    va_end(args);
    return EXIT_USAGE;
}

static void apply(int letter, options *out)
{
    switch (letter) {
    case 'o':
        out->out = optarg;
        break;
    case 's':
        out->sets[out->set_count++] = optarg;
        break;
    case 'p':
        out->plugin_path = optarg;
        break;
    case 'q':
        out->quiet = true;
        break;
    case 'F':
        out->force = true;
        break;
    case 'r':
        out->frames = optarg;
        break;
    case 't':
        out->format = optarg;
        break;
    case 'i':
        out->frame = optarg;
        break;
    case 'y':
        out->yaml = true;
        break;
    case 'a':
        out->all = true;
        break;
    case 'R':
        out->refine = true;
        break;
    case 'v':
        out->view = true;
        break;
    case 'j':
        out->jobs = optarg;
        break;
    case 'L':
        out->timeout = optarg;
        break;
    case 'S':
        out->shard = optarg;
        break;
    case 'E':
        out->retry_failed = true;
        break;
    case 'U':
        out->summary = true;
        break;
    case 'T':
        out->tolerance = optarg;
        break;
    default:
        out->markdown = true;
        break;
    }
}

int options_parse(const verb *self, const char *takes, int argc, char **argv,
                  options *out)
{
    struct option table[KNOWN + 1] = { { 0 } };
    size_t count = 0;
    for (size_t i = 0; i < KNOWN; ++i) {
        if (known[i].val == 'h' || strchr(takes, known[i].val) != NULL) {
            table[count++] = known[i];
        }
    }
    *out = (options){ .sets = calloc((size_t)argc, sizeof *out->sets) };
    if (out->sets == NULL) {
        return usage_error(self, "out of memory");
    }
    const char *letters = strchr(takes, 'j') == NULL ? ":h" : ":hj:";
    opterr = 0;
    optind = 1;
    for (int letter; (letter = getopt_long(argc, argv, letters, table, NULL)) != -1;) {
        if (letter == 'h') {
            fputs(self->help, stdout);
            options_free(out);
            return EXIT_DONE;
        }
        if (letter == '?' || letter == ':') {
            options_free(out);
            return usage_error(
                self, letter == '?' ? "unknown option %s" : "option %s needs a value",
                argv[optind - 1]);
        }
        apply(letter, out);
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
