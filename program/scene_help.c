/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_help.c -- weft scene-help: every key of a scene. */
#include "program/cli.h"

static void put_line(void *ctx, const char *text)
{
    (void)ctx;
    puts(text);
}

static int scene_help_verb(const arguments *given)
{
    weft_error err = { 0 };
    if (given->operand_count > 0 && given->markdown) {
        return usage_error(given, "--markdown prints all keys");
    }
    for (int i = 0; i < given->operand_count; ++i) {
        if (weft_scene_help_key(given->operands[i], put_line, NULL, &err) != WEFT_OK) {
            return usage_error(given, "%s", err.message);
        }
    }
    if (given->operand_count == 0) {
        weft_scene_help(given->markdown ? WEFT_HELP_MARKDOWN : WEFT_HELP_TEXT, put_line,
                        NULL);
    }
    return EXIT_DONE;
}

static const verb_option options[] = {
    SHARED(markdown, "markdown", NULL, "as the table of docs/reference/scene.md"),
};

const verb verb_scene_help = {
    .name = "scene-help",
    .summary = "print keys of a scene with type, unit and default",
    .help = "usage: weft scene-help [KEY... | --markdown]\n"
            "\n"
            "Prints type, unit, default and meaning of keys, and of the keys below "
            "them; without KEY, of every key of a scene.\n",
    OPTIONS(options),
    .more = "example: weft scene-help stepper.rtol cloth.pins\n",
    .operands = { .most = ANY_NUMBER },
    .run = scene_help_verb,
};
