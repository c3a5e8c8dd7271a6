/* SPDX-License-Identifier: BSD-3-Clause */
/* main.c -- the weft program: find the verb, run it. */
#include <fcntl.h>
#include <locale.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "base/suggest.h"
#include "program/cli.h"
#include "program/run/interrupt.h"

static const verb *const verbs[] = {
    &verb_new,         &verb_run,  &verb_resume,   &verb_batch,    &verb_check,
    &verb_export,      &verb_view, &verb_steppers, &verb_fabrics,  &verb_scene_help,
#ifdef WEFT_STUDY
    &verb_lab,         &verb_diff, &verb_compare,  &verb_converge, &verb_fit,
    &verb_plugin_test,
#endif
};

#define VERBS (sizeof verbs / sizeof verbs[0])

static void print_usage(FILE *stream)
{
    fputs("usage: weft VERB [OPTIONS] [FILES]\n\n"
          "weft simulates cloth, springs or triangles, under established solvers.\n\n",
          stream);
    for (size_t i = 0; i < VERBS; ++i) {
        fprintf(stream, "  %-12s %s\n", verbs[i]->name, verbs[i]->summary);
    }
    fputs(
        "\n  weft VERB --help   options and examples of a verb\n"
        "  weft --version     versions of weft and of its plugin interface\n\n"
        "exit codes: 0 done, 1 the simulation failed, 2 wrong command line, 3 wrong\n"
        "scene, 4 a file could not be read or written, 130/143 stopped by a signal\n\n"
        "example: weft run scenes/curtain.yaml --out curtain\n",
        stream);
}

static int print_version(void)
{
    printf("weft %s\nplugin interface %u\n", weft_version(), WEFT_STEPPER_ABI);
    weft_registry *registry = open_registry(NULL, true);
    if (registry == NULL) {
        return EXIT_SIMULATION;
    }
    (void)load_plugins(registry, NULL);
    for (size_t i = 0; i < weft_registry_count(registry); ++i) {
        const weft_plugin *plugin = weft_registry_at(registry, i);
        printf("plugin %s %s%s%s: %s\n", plugin->id, plugin->version,
               plugin->solver[0] == '\0' ? "" : ", ", plugin->solver,
               weft_registry_file(registry, i));
    }
    weft_registry_destroy(registry);
    return EXIT_DONE;
}

static int flush_stdout(int code)
{
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == EXIT_DONE) {
        print_line(stderr, "weft: error: standard output could not be written");
        return EXIT_FILE;
    }
    return code;
}

/* Verbs of weft that this program was built without. */
static const char *const left_out[] = {
#ifndef WEFT_STUDY
    "lab", "diff", "compare", "converge", "fit", "plugin-test",
#endif
    NULL
};

static int no_verb(const char *typed)
{
    for (size_t i = 0; left_out[i] != NULL; ++i) {
        if (strcmp(typed, left_out[i]) == 0) {
            print_line(stderr, "weft: built without the verb '%s' (make STUDY=no)",
                       typed);
            return EXIT_USAGE;
        }
    }
    weft__guess guess = { 0 };
    char near[80];
    for (size_t i = 0; i < VERBS; ++i) {
        weft__guess_try(&guess, typed, verbs[i]->name);
    }
    weft__guess_try(&guess, typed, "--version");
    const size_t length = strlen(typed);
    const bool scene = length > 5 && strcmp(typed + length - 5, ".yaml") == 0;
    sentence hint = { "" };
    say(&hint, scene ? " (did you mean 'weft run %s'?)" : "%s",
        scene ? typed : weft__guess_text(&guess, near, sizeof near));
    print_line(stderr, "weft: no verb '%s'%s; 'weft --help' lists them", typed,
               hint.text);
    return EXIT_USAGE;
}

/* A file opened later would take the number of a closed standard stream, and receive
 * its messages. */
static bool open_standard_streams(void)
{
    for (int i = STDIN_FILENO; i <= STDERR_FILENO; ++i) {
        if (fcntl(i, F_GETFD) < 0 && open("/dev/null", O_RDWR) != i) {
            return false;
        }
    }
    return true;
}

/* A wrong WEFT_ISA is reported before a verb writes anything. */
static int check_environment(void)
{
    weft_error err = { 0 };
    weft_cloth *cloth = NULL;
    const weft_cloth_def any = weft_cloth_def_default();
    const weft_status status = weft_cloth_create(&any, &cloth, &err);
    weft_cloth_destroy(cloth);
    if (status == WEFT_INVALID) {
        (void)report_error(&err);
        return EXIT_USAGE;
    }
    return EXIT_DONE;
}

int main(int argc, char **argv)
{
    if (!open_standard_streams()) {
        return EXIT_FILE;
    }
    interrupt_with_parent();
    /* A plugin may call setlocale: numbers keep their points. */
    (void)uselocale(newlocale(LC_ALL_MASK, "C", (locale_t)0));
    /* Beyond the limit of file sizes a write then fails, and is reported. */
    (void)signal(SIGXFSZ, SIG_IGN);
    if (argc < 2) {
        print_usage(stderr);
        return EXIT_USAGE;
    }
    for (size_t i = 0; i < VERBS; ++i) {
        if (strcmp(argv[1], verbs[i]->name) == 0) {
            const int code = check_environment();
            return code != EXIT_DONE
                       ? code
                       : flush_stdout(verb_start(verbs[i], argc - 1, argv + 1));
        }
    }
    if (strcmp(argv[1], "--version") == 0) {
        return flush_stdout(print_version());
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0
        || strcmp(argv[1], "help") == 0) {
        print_usage(stdout);
        return flush_stdout(EXIT_DONE);
    }
    return no_verb(argv[1]);
}
