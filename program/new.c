/* SPDX-License-Identifier: BSD-3-Clause */
/* new.c -- weft new: a scene to begin with. */
#include <errno.h>
#include <string.h>

#include "program/cli.h"
#include "program/record/page.h"

static int new_verb(const arguments *given)
{
    const char *name = given->operands[0];
    const char *dot = strrchr(name, '.');
    char path[RECORD_PATH];
    const bool whole = dot != NULL && strcmp(dot, ".yaml") == 0;
    size_t named = whole ? (size_t)(dot - name) : strlen(name);
    while (named > 0 && name[named - 1] == '.') {
        --named;
    }
    /* not "", "dir/", "..", nor ".yaml": their files would be hidden, or odd */
    if (named == 0 || name[named - 1] == '/') {
        return usage_error(given,
                           "'%s' names no file; a name is like first or "
                           "dir/first.yaml",
                           name);
    }
    const int length = snprintf(path, sizeof path, "%s%s", name, whole ? "" : ".yaml");
    weft_status status = WEFT_IO;
    FILE *stream = length < RECORD_PATH ? fopen(path, "wx") : NULL;
    if (stream != NULL) {
        (void)fputs(weft__hammock_page, stream);
        status = fflush(stream) == 0 && !ferror(stream) ? WEFT_OK : WEFT_IO;
        const int kept = errno;
        (void)fclose(stream);
        (void)(status == WEFT_OK || remove(path));
        errno = kept;
    }
    if (status != WEFT_OK) {
        return report_status(status, "%s: %s", path,
                             length < RECORD_PATH ? strerror(errno) : "too long");
    }
    print_plainly(stdout, "%s: a hammock; 'weft run %s --view' plays it\n", path, path);
    return EXIT_DONE;
}

const verb verb_new = {
    .name = "new",
    .summary = "write a scene to begin with",
    .help = "usage: weft new NAME\n\n"
            "Writes NAME.yaml, a small scene with comments, to change into your own. A "
            "file of that name is left as it is.\n\n"
            "example: weft new first && weft run first.yaml --view\n\n"
            "exit codes: 0 done, 2 wrong command line, 4 the file exists or could not "
            "be written\n",
    .operands = { 1, 1, "no name given", "more than one name" },
    .run = new_verb,
};
