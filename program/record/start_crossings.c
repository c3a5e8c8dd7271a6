/* SPDX-License-Identifier: BSD-3-Clause */
/* start_crossings.c -- start-crossings.obj: what crosses or touches in the start of a
 * run. */
#include "program/record/record.h"

typedef struct listing {
    FILE *stream;
    size_t points;
} listing;

static void write_pair(void *ctx, const weft_crossing *one)
{
    static const char *const element[] = { "", "p", "l", "f" };
    listing *to = ctx;
    fprintf(to->stream, "# %s\n", one->text);
    for (size_t k = 0; k < 2; ++k) {
        for (size_t i = 0; i < one->count[k]; ++i) {
            const double *x = one->place[k][i];
            fprintf(to->stream, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
        }
        for (size_t i = 0; i < one->count[k]; ++i) {
            fprintf(to->stream, "%s %zu%s", i == 0 ? element[one->count[k]] : "",
                    ++to->points, i + 1 == one->count[k] ? "\n" : "");
        }
    }
}

weft_status record_crossings(const char *directory, const weft_cloth *cloth,
                             const double *y, weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, directory, RECORD_CROSSINGS, err));
    listing to = { .stream = file.stream };
    fputs("# What crosses or touches at t = 0 [m].\n", file.stream);
    const size_t count = weft_cloth_each_crossing(cloth, y, write_pair, &to);
    fprintf(file.stream, "# %zu in all\n", count);
    if (count == 0 || count == SIZE_MAX) {
        record_file_discard(&file);
        return count == 0 ? WEFT_OK : weft_error_set(err, WEFT_NO_MEMORY, "no memory");
    }
    return record_file_commit(&file, err);
}
