/* SPDX-License-Identifier: BSD-3-Clause */
/* compare_write.c -- the output of weft compare: a table, compare.csv, compare.html. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "program/record/page.h"
#include "program/record/yaml_out.h"
#include "study/compare/compare.h"

static bool judged(const compare_point *point)
{
    return point->outcome == COMPARE_DONE && isfinite(point->error);
}

static bool near(const compare *self, const compare_point *point)
{
    return point->error < COMPARE_NEAR * self->apart;
}

/* Why the ladder ends where it does, or "". */
static const char *remark(const compare_method *method)
{
    const char *why = method->left_out;
    for (size_t i = 0; why[0] == '\0' && i < COMPARE_RUNGS; ++i) {
        const compare_point *point = &method->points[i];
        why = point->outcome == COMPARE_EXPENSIVE ? "finer: too expensive"
              : point->outcome == COMPARE_FAILED  ? point->why
                                                  : "";
    }
    return why;
}

/* ---- the terminal ----------------------------------------------------------- */

/* [ms] Two digits; compare.csv has all. */
static void print_cell(double time, bool best)
{
    const double unit = time < 999.5 ? 1.0 : time < 999.5e3 ? 1e3 : 1e6;
    const double shown = time / unit;
    char text[32];
    (void)snprintf(text, sizeof text, "%s%.*f%s", best ? "*" : "",
                   shown < 0.995  ? 2
                   : shown < 9.95 ? 1
                                  : 0,
                   shown,
                   unit > 1e3   ? "M"
                   : unit > 1.0 ? "k"
                                : "");
    printf(" %5s", text);
}

static void print_method(const compare_method *method, const compare_advice *advice)
{
    compare_cost cost;
    const int used = printf("%-6s %-17s%c", method->by.plugin->id,
                            method->by.type->name, method->own ? '<' : ' ');
    if (advice->count == 0
        || !compare_reach(method, advice->ranks[0].accuracy, &cost)) {
        putchar(' ');
        print_wrapped((size_t)used + 1, 26, PAGE_WIDTH, remark(method));
        return;
    }
    printf(" %5.3g", 1e6 * method->call_time);
    for (size_t i = 0; i < advice->count; ++i) {
        if (compare_reach(method, advice->ranks[i].accuracy, &cost)) {
            print_cell(1e3 * cost.time, advice->ranks[i].best.method == method);
        } else {
            printf("     -");
        }
    }
    putchar('\n');
}

/* Sorted by the finest accuracy reached, then by cost. */
typedef struct row {
    const compare_method *method;
    size_t reached;
    double time;
} row;

static int by_reach(const void *a, const void *b)
{
    const row *x = a, *y = b;
    const int reached = (x->reached < y->reached) - (x->reached > y->reached);
    return reached != 0 ? reached : (x->time > y->time) - (x->time < y->time);
}

static void print_rows(const compare *self, const compare_advice *advice)
{
    row *rows = calloc(self->count, sizeof *rows);
    for (size_t m = 0; m < self->count && rows != NULL; ++m) {
        rows[m] = (row){ .method = &self->shared->methods[m] };
        for (size_t i = 0; i < advice->count; ++i) {
            compare_cost cost;
            if (compare_reach(rows[m].method, advice->ranks[i].accuracy, &cost)) {
                rows[m].reached = i + 1;
                rows[m].time = cost.time;
            }
        }
    }
    if (rows != NULL) {
        qsort(rows, self->count, sizeof *rows, by_reach);
    }
    for (size_t m = 0; m < self->count; ++m) {
        print_method(rows == NULL ? &self->shared->methods[m] : rows[m].method, advice);
    }
    free(rows);
}

void compare_print(const compare *self, const compare_advice *advice)
{
    sentence legend = { "" };
    char size[HUMAN_SIZE];
    print_plain(stdout, weft_scene_name(self->scene), "");
    printf(", %s\n", weft_cloth_text(self->cloth, size, sizeof size));
    print_wrapped(0, 2, PAGE_WIDTH, compare_horizon_text(self).text);
    printf("reference: ");
    print_wrapped(11, 11, PAGE_WIDTH, compare_reference_text(self).text);
    if (self->shared->stiffness.text[0] != '\0') {
        print_wrapped(0, 2, PAGE_WIDTH, self->shared->stiffness.text);
    }
    printf("\ntime [ms] until no particle is further off in any frame than [m]\n"
           "%-24sus/call",
           "");
    for (size_t i = 0; i < advice->count; ++i) {
        printf(" %.0e", advice->ranks[i].accuracy);
    }
    printf("\n");
    print_rows(self, advice);
    say(&legend,
        "* the fastest, < the scene's method, - not within %" PRIu64
        " evaluations, or not at all",
        self->budget);
    print_wrapped(0, 2, PAGE_WIDTH, legend.text);
    putchar('\n');
    for (size_t i = 0; i < advice->count; ++i) {
        printf("%.0e m: ", advice->ranks[i].accuracy);
        print_wrapped(9, 9, PAGE_WIDTH, compare_rank_text(&advice->ranks[i]).text);
    }
    print_wrapped(0, 2, PAGE_WIDTH, compare_as_is_text(self).text);
}

/* ---- for machines ----------------------------------------------------------- */

void compare_begin(const compare *self, const char *directory)
{
    yaml_out out;
    if (self->progress.mode == PROGRESS_YAML) {
        yaml_out_begin_event(&out, "begin");
        yaml_out_write(&out, "name: \"%s\", directory: \"%s\"",
                       weft_scene_name(self->scene), directory);
        yaml_out_size(&out, self->cloth);
        yaml_out_write(&out, "methods_planned: %zu, duration: %g", self->count,
                       self->run.duration);
        yaml_out_end_event(&out);
    }
}

void compare_end(const compare *self, const char *failed)
{
    yaml_out out;
    if (self->progress.mode == PROGRESS_YAML) {
        yaml_out_begin_event(&out, "end");
        yaml_out_write(&out, "status: %s, reason: \"%s\", methods: %zu",
                       failed == NULL ? "done" : "failed", failed == NULL ? "" : failed,
                       self->over);
        yaml_out_end_event(&out);
    }
}

/* ---- compare.csv ------------------------------------------------------------ */

static void put_row(const compare *self, const compare_method *method,
                    const compare_point *point, FILE *stream)
{
    static const char *const outcomes[] = {
        [COMPARE_NOT_RUN] = "not run", [COMPARE_RUNNING] = "crashed",
        [COMPARE_DONE] = "done",       [COMPARE_EXPENSIVE] = "too expensive",
        [COMPARE_FAILED] = "failed",
    };
    fprintf(stream, "%s,%s,%d,%s,%.9g,%s,", method->by.plugin->id,
            method->by.type->name, method->by.type->order,
            method->step > 0.0 ? "fixed_step" : "tolerance", point->setting,
            outcomes[point->outcome]);
    if (point->outcome == COMPARE_DONE) {
        fprintf(
            stream, "%.9g,%.9g,%.9g,%d,%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%.9g,%.9g,",
            point->error, point->rms, point->velocity, near(self, point), point->calls,
            point->steps, point->rejected, point->energy, point->time);
    } else {
        fputs(",,,,,,,,,", stream);
    }
    record_csv_quoted(stream, point->why);
    putc('\n', stream);
}

static void put_rows(const compare *self, const compare_method *method, FILE *stream)
{
    if (method->left_out[0] != '\0') {
        fprintf(stream, "%s,%s,%d,,,left out,,,,,,,,,,", method->by.plugin->id,
                method->by.type->name, method->by.type->order);
        record_csv_quoted(stream, method->left_out);
        putc('\n', stream);
        return;
    }
    for (size_t i = 0; i < COMPARE_RUNGS; ++i) {
        if (method->points[i].outcome != COMPARE_NOT_RUN) {
            put_row(self, method, &method->points[i], stream);
        }
    }
}

weft_status compare_csv(const compare *self, const char *directory, weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, directory, "compare.csv", err));
    fputs("plugin,method,order,kind,setting,outcome,error,error_rms,error_velocity,"
          "near_reference,rhs_calls,steps,rejected,energy_error,time,reason\n",
          file.stream);
    for (size_t i = 0; i < self->count; ++i) {
        put_rows(self, &self->shared->methods[i], file.stream);
    }
    return record_file_commit(&file, err);
}

/* ---- compare.html ----------------------------------------------------------- */

static void put_member(FILE *stream, const char *name, const char *text)
{
    fprintf(stream, "\"%s\":", name);
    page_text(stream, text);
    putc(',', stream);
}

static void put_point(const compare_point *point, FILE *stream)
{
    fprintf(
        stream,
        "{\"setting\":%.9g,\"error\":%.9g,\"rms\":%.9g,\"velocity\":%.9g,\"energy\":%."
        "9g,\"calls\":%" PRIu64 ",\"steps\":%" PRIu64 ",\"rejected\":%" PRIu64
        ",\"time\":%.6g}",
        point->setting, point->error, point->rms, point->velocity, point->energy,
        point->calls, point->steps, point->rejected, point->time);
}

static void put_method(const compare_method *method, FILE *stream)
{
    const char *comma = "";
    putc('{', stream);
    put_member(stream, "plugin", method->by.plugin->id);
    put_member(stream, "name", method->by.type->name);
    put_member(stream, "remark", remark(method));
    fprintf(stream, "\"order\":%d,\"own\":%s,\"fixed\":%s,\"implicit\":%s,\"points\":[",
            method->by.type->order, method->own ? "true" : "false",
            method->step > 0.0 ? "true" : "false",
            compare_is_implicit(method) ? "true" : "false");
    for (size_t i = 0; i < COMPARE_RUNGS; ++i) {
        if (judged(&method->points[i])) {
            fputs(comma, stream);
            put_point(&method->points[i], stream);
            comma = ",";
        }
    }
    fputs("]}", stream);
}

static void put_advice(const compare *self, const compare_advice *advice, FILE *stream)
{
    fputs("\"ranks\":[", stream);
    for (size_t i = 0; i < advice->count; ++i) {
        const compare_rank *rank = &advice->ranks[i];
        const compare_method *best = rank->best.method, *fewest = rank->fewest.method;
        fprintf(stream, "%s{\"accuracy\":%.0e,\"best\":%td,\"fewest\":%td,\"text\":",
                i == 0 ? "" : ",", rank->accuracy, best - self->shared->methods,
                (fewest == NULL ? best : fewest) - self->shared->methods);
        page_text(stream, compare_rank_text(rank).text);
        putc('}', stream);
    }
    fputs("],", stream);
}

static void put_description(const compare *self, const compare_advice *advice,
                            FILE *stream)
{
    char size[HUMAN_SIZE];
    fputs("<script type=\"application/json\" id=\"weft-data\">{", stream);
    put_member(stream, "weft", weft_version());
    put_member(stream, "scene", weft_scene_name(self->scene));
    put_member(stream, "size", weft_cloth_text(self->cloth, size, sizeof size));
    put_member(stream, "yaml", weft_scene_text(self->scene));
    put_member(stream, "horizon", compare_horizon_text(self).text);
    put_member(stream, "reference", compare_reference_text(self).text);
    put_member(stream, "asIs", compare_as_is_text(self).text);
    put_member(stream, "stiffness", self->shared->stiffness.text);
    put_advice(self, advice, stream);
    if (judged(compare_as_is(self))) {
        fputs("\"own\":", stream);
        put_point(compare_as_is(self), stream);
        putc(',', stream);
    }
    fprintf(stream,
            "\"time\":%.9g,\"apart\":%.9g,\"near\":%.9g,"
            "\"budget\":%" PRIu64 ",\"methods\":[",
            compare_time(self, self->last), self->apart, COMPARE_NEAR * self->apart,
            self->budget);
    for (size_t i = 0; i < self->count; ++i) {
        fputs(i == 0 ? "" : ",", stream);
        put_method(&self->shared->methods[i], stream);
    }
    fputs("]}</script>\n", stream);
}

weft_status compare_html(const compare *self, const compare_advice *advice,
                         const char *directory, weft_error *err)
{
    record_file file;
    TRY(record_file_open(&file, directory, "compare.html", err));
    page_begin(file.stream, weft__compare_page, false);
    put_description(self, advice, file.stream);
    page_end(file.stream, weft__compare_page);
    return record_file_commit(&file, err);
}
