/* SPDX-License-Identifier: BSD-3-Clause */
/* scene_help.c -- weft scene-help: every key of a scene. */
#include "cli/cli.h"

static void print_line(void *ctx, const char *text)
{
    (void)ctx;
    puts(text);
}

static int scene_help_verb(int argc, char **argv)
{
    options given;
    const int code = options_parse(&verb_scene_help, "m", argc, argv, &given);
    if (code >= 0) {
        return code;
    }
    options_free(&given);
    if (given.operand_count > 0) {
        return usage_error(&verb_scene_help, "takes no file");
    }
    weft_scene_help(given.markdown ? WEFT_HELP_MARKDOWN : WEFT_HELP_TEXT, print_line,
                    NULL);
    return EXIT_DONE;
}

const verb verb_scene_help = {
    .name = "scene-help",
    .summary = "print every key of a scene with type, unit and default",
    .help = "usage: weft scene-help [--markdown]\n\n"
            "Prints every key that a scene may have: type, unit, default, meaning.\n\n"
            "  --markdown           as the table of docs/scene.md\n",
    .run = scene_help_verb,
};
