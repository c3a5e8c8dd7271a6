/* SPDX-License-Identifier: BSD-3-Clause */
/* batch_page.c -- a page of all runs of a batch: a table of their results, numbers of
 * their series, and a player for each. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "program/record/page.h"
#include "program/record/series.h"
#include "weft/scene.h"

#define PLAYERS_BUDGET 24e6 /* [B] of the frames of all runs */
#define PLAYER_LEAST   3e3  /* [B] of a run: with less there is no player */

enum { RUN_NAME = 256 };

typedef struct batch_page {
    const char *directory;
    char (*names)[RUN_NAME]; /* of the runs' directories */
    size_t count, without;
    weft_error *why; /* of the first run without frames */
    FILE *stream;
} batch_page;

bool record_is_batch(const char *directory)
{
    return record_exists(directory, "summary.csv")
           && !record_exists(directory, "run.vtkhdf");
}

/* ---- summary.csv --------------------------------------------------------- */

/* Reads a cell without its quotes, at most as much as fits. Returns the character after
 * it: ',', '\n' or EOF. */
static int read_cell(FILE *stream, char *cell, size_t size)
{
    size_t used = 0;
    bool quoted = false;
    int c;
    while ((c = getc(stream)) != EOF && (quoted || (c != ',' && c != '\n'))) {
        quoted = quoted != (c == '"');
        if (c != '"' && used + 1 < size) {
            cell[used++] = (char)c;
        }
    }
    cell[used] = '\0';
    return c;
}

/* A name that leads out of the batch is left empty: anybody may have written it. */
static weft_status add_name(batch_page *self, const char *name, weft_error *err)
{
    const bool inside = name[0] != '.' && strchr(name, '/') == NULL;
    if ((self->count & (self->count - 1)) == 0) { /* full at powers of two */
        const size_t room = self->count == 0 ? 1 : 2 * self->count;
        void *grown = realloc(self->names, room * sizeof *self->names);
        if (grown == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a page");
        }
        self->names = grown;
    }
    strcpy(self->names[self->count++], inside ? name : "");
    return WEFT_OK;
}

/* The column `directory`, in the order of the rows. */
static weft_status read_names(batch_page *self, weft_error *err)
{
    char path[RECORD_PATH], cell[RUN_NAME];
    FILE *stream = record_open(self->directory, "summary.csv", path, err);
    if (stream == NULL) {
        return WEFT_IO;
    }
    weft_status status = WEFT_OK;
    size_t wanted = SIZE_MAX, column = 0;
    for (int c = ','; c == ','; ++column) {
        c = read_cell(stream, cell, sizeof cell);
        wanted = strcmp(cell, "directory") == 0 ? column : wanted;
    }
    for (int c = 0; status == WEFT_OK && wanted != SIZE_MAX && c != EOF;) {
        for (column = 0, c = ','; status == WEFT_OK && c == ','; ++column) {
            c = read_cell(stream, cell, sizeof cell);
            if (column == wanted) {
                status = add_name(self, cell, err);
            }
        }
    }
    (void)fclose(stream);
    return status != WEFT_OK || self->count > 0
               ? status
               : weft_error_set(err, WEFT_IO, "%s: no rows with a directory", path);
}

/* ---- the page ------------------------------------------------------------ */

/* {"time":[last,least,most,mean],...} */
static void write_columns(FILE *stream, const char *directory)
{
    record_column columns[RECORD_COLUMNS_MAX];
    size_t count;
    (void)record_series_columns(directory, columns, &count, NULL);
    putc('{', stream);
    for (size_t i = 0; i < count; ++i) {
        const record_column *c = &columns[i];
        const double numbers[] = { c->last, c->least, c->most, c->mean };
        fputs(i == 0 ? "" : ",", stream);
        page_text(stream, c->name);
        for (size_t k = 0; k < 4; ++k) {
            fputs(k == 0 ? ":[" : ",", stream);
            fprintf(stream, isfinite(numbers[k]) ? "%.6g" : "null", numbers[k]);
        }
        putc(']', stream);
    }
    putc('}', stream);
}

/* The directory of run i; false if it has no name, or is a link, which might lead out
 * of the batch. */
static bool run_directory(const batch_page *self, size_t i, char path[RECORD_PATH])
{
    return self->names[i][0] != '\0'
           && record_path(self->directory, self->names[i], path, NULL) == WEFT_OK
           && record_no_link(path, NULL) == WEFT_OK;
}

/* The unit of a key is in the last brackets before its default: "vector [x, y, z]
 * [m/s]; default ...". Only the first such line is of the key itself. */
static void take_unit(void *ctx, const char *line)
{
    char *unit = ctx;
    const char *end = strchr(line, ';'), *from = end;
    if (end == NULL || unit[0] != '\0') {
        return;
    }
    while (from > line && *from != '[') {
        --from;
    }
    const bool has = *from == '[' && end[-1] == ']' && end - from < RUN_NAME;
    snprintf(unit, RUN_NAME, "%.*s", has ? (int)(end - from - 2) : 1,
             has ? from + 1 : "-");
}

/* {"forces.damping":"kg/s",...}: of the columns of summary.csv that are keys. */
static void write_units(FILE *stream, const char *directory)
{
    char path[RECORD_PATH], cell[RUN_NAME];
    FILE *summary = record_open(directory, "summary.csv", path, NULL);
    const char *before = "{";
    for (int c = ','; summary != NULL && c == ',';) {
        char unit[RUN_NAME] = "";
        c = read_cell(summary, cell, sizeof cell);
        if (strcmp(cell, "scene") == 0) {
            break;
        }
        if (weft_scene_help_key(cell, take_unit, unit, NULL) == WEFT_OK) {
            fputs(before, stream);
            page_text(stream, cell);
            putc(':', stream);
            page_text(stream, strcmp(unit, "-") == 0 ? "" : unit);
            before = ",";
        }
    }
    fputs(before[0] == '{' ? "{}" : "}", stream);
    if (summary != NULL) {
        (void)fclose(summary);
    }
}

static void write_batch(const batch_page *self)
{
    FILE *stream = self->stream;
    char path[RECORD_PATH];
    fputs("<script id=\"weft-batch\" type=\"application/json\">{\"weft\":", stream);
    page_text(stream, weft_version());
    fputs(",\"directory\":", stream);
    page_directory(stream, self->directory);
    fputs(",\"summary\":", stream);
    page_file(stream, self->directory, "summary.csv");
    fputs(",\"units\":", stream);
    write_units(stream, self->directory);
    for (size_t i = 0; i < self->count; ++i) {
        const bool there = run_directory(self, i, path);
        fprintf(stream, "%s{\"page\":%s,\"columns\":", i == 0 ? ",\"runs\":[" : ",\n",
                there && record_exists(path, "run.html") ? "true" : "false");
        write_columns(stream, there ? path : "");
        putc('}', stream);
    }
    fputs("]}</script>\n", stream);
}

/* Into memory first: a file that turns out to be damaged leaves no half of a player. */
static weft_status write_player(const char *directory, double budget, FILE *stream,
                                weft_error *err)
{
    player_page player = { .budget = budget, .brief = true };
    char *text = NULL;
    size_t size = 0;
    weft_status status = player_page_open(&player, &directory, 1, err);
    player.stream = status == WEFT_OK ? open_memstream(&text, &size) : NULL;
    if (player.stream != NULL) {
        status = player_page_write(&player, err);
        const bool whole = fclose(player.stream) == 0;
        if (status == WEFT_OK && whole) {
            (void)fwrite(text, 1, size, stream);
        }
    }
    free(text);
    player_page_close(&player);
    return status;
}

/* A <template> for each run, empty where it has no frames. */
static void write_players(batch_page *self)
{
    const double budget = PLAYERS_BUDGET / (double)self->count;
    for (size_t i = 0; budget >= PLAYER_LEAST && i < self->count; ++i) {
        char path[RECORD_PATH];
        weft_error err = { .message = "not a directory" };
        fputs("<template>", self->stream);
        if (!run_directory(self, i, path)
            || write_player(path, budget, self->stream, &err) != WEFT_OK) {
            *self->why = self->without == 0 ? err : *self->why;
            ++self->without;
        }
        fputs("</template>\n", self->stream);
    }
}

weft_status record_batch(const char *directory, const char *path, size_t *without,
                         weft_error *why, weft_error *err)
{
    batch_page self = { .directory = directory, .why = why };
    record_file file;
    weft_status status = read_names(&self, err);
    status = status == WEFT_OK ? page_open(&file, path, err) : status;
    if (status == WEFT_OK) {
        self.stream = file.stream;
        write_batch(&self);
        write_players(&self);
        status = page_commit(&file, WEFT_OK, err);
    }
    *without = self.without;
    free(self.names);
    return status;
}
