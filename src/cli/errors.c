/* SPDX-License-Identifier: BSD-3-Clause */
/* errors.c -- what is wrong, to stderr. */
#include <string.h>

#include "base/suggest.h"
#include "cli/cli.h"
#include "cli/human.h"

int report_error(const weft_error *err)
{
    char place[sizeof err->file + 32] = "";
    if (err->file[0] != '\0') {
        (void)snprintf(place, sizeof place, "%s:%d:%d: ", err->file, err->line,
                       err->column);
    }
    print_line(stderr, "weft: error: %s%s", place, err->message);
    return err->status == WEFT_IO          ? EXIT_FILE
           : err->status == WEFT_BAD_SCENE ? EXIT_SCENE
                                           : EXIT_SIMULATION;
}

int usage_error(const arguments *given, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char text[1024];
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    print_line(stderr, "weft %s: %s", given->verb->name, text);
    print_line(stderr, "'weft %s --help' shows how it is used", given->verb->name);
    return EXIT_USAGE;
}

int choose(const arguments *given, const char *option, const char *typed,
           const char *const *names, size_t *chosen)
{
    weft__guess guess = { 0 };
    sentence list = { "" };
    char near[80];
    for (size_t i = 0; names[i] != NULL; ++i) {
        if (strcmp(typed, names[i]) == 0) {
            *chosen = i;
            return EXIT_DONE;
        }
        weft__guess_try(&guess, typed, names[i]);
        const char *separator = i == 0 ? "" : names[i + 1] == NULL ? " or " : ", ";
        say(&list, "%s%s", separator, names[i]);
    }
    return usage_error(given, "--%s '%s' is not %s%s", option, typed, list.text,
                       weft__guess_text(&guess, near, sizeof near));
}
