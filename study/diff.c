/* SPDX-License-Identifier: BSD-3-Clause */
/* diff.c -- weft diff: where two runs begin to differ, and by how much.
 *
 * Two runs are equal if their states have equal hashes in series.csv and their frames
 * in run.vtkhdf are equal; with a tolerance, if their positions in run.vtkhdf differ by
 * no more. Positions show where and by how much. Only times that both have count. */
#include <math.h>
#include <stdlib.h>

#include "program/cli.h"
#include "program/record/frames.h"
#include "program/record/series.h"

/* Those of this verb alone. */
typedef struct diff_options {
    const char *tolerance;
} diff_options;

static const diff_options *diff_own(const arguments *given)
{
    return given->own;
}

#define TIME_MATCH 1e-9 /* relative: two frames of the same time */

typedef struct diff_side {
    const char *directory;
    record_series_row *rows;
    size_t row_count;
    record_frames *frames; /* NULL: no run.vtkhdf */
    double *x;             /* [m] positions of one frame */
} diff_side;

/* A time of both runs, and the largest distance of a particle then. */
typedef struct gap {
    bool found;
    size_t frame[2];
    double time, distance; /* [s], [m] */
    size_t particle;
} gap;

typedef struct comparison {
    diff_side side[2];
    double tolerance;     /* [m]; < 0: bit for bit */
    bool single;          /* compare in single precision: one was recorded in it */
    size_t rows, unequal; /* of series.csv: at common times, with other hashes */
    gap first;            /* of those; without a distance */
    size_t frames;        /* of run.vtkhdf, at common times */
    size_t beyond;        /* of those, with positions beyond the tolerance */
    gap begin, largest;   /* first beyond the tolerance; of all */
    const char *field;    /* the first field to differ, beside positions; NULL: none */
    gap other;            /* its frame */
} comparison;

/* Compared beside the positions. */
static const struct {
    const char *name;
    weft_record_field field;
    size_t width;
} fields[] = {
    { "velocities", WEFT_RECORD_VELOCITY, 3 },
    { "strain", WEFT_RECORD_STRAIN, 1 },
};

enum { FIELDS = sizeof fields / sizeof fields[0] };

/* ---- opening ---------------------------------------------------------------- */

static weft_status open_side(diff_side *self, weft_error *err)
{
    TRY(record_series_rows(self->directory, &self->rows, &self->row_count, err));
    return record_exists(self->directory, "run.vtkhdf")
               ? record_frames_open(self->directory, &self->frames, err)
               : WEFT_OK;
}

static bool both_have_frames(const comparison *self)
{
    return self->side[0].frames != NULL && self->side[1].frames != NULL;
}

static weft_status open_both(comparison *self, weft_error *err)
{
    TRY(open_side(&self->side[0], err));
    TRY(open_side(&self->side[1], err));
    if (!both_have_frames(self)) {
        return self->tolerance < 0.0
                   ? WEFT_OK
                   : weft_error_set(err, WEFT_IO,
                                    "%s/run.vtkhdf is missing: --tol compares the "
                                    "positions of frames",
                                    self->side[self->side[0].frames != NULL].directory);
    }
    const record_frames *a = self->side[0].frames, *b = self->side[1].frames;
    if (!record_faces_same(&a->faces, &b->faces)) {
        return record_faces_differ(self->side[0].directory, &a->faces,
                                   self->side[1].directory, &b->faces, WEFT_BAD_SCENE,
                                   err);
    }
    self->single = !a->doubles || !b->doubles;
    for (size_t k = 0; k < 2; ++k) {
        self->side[k].x = malloc(3 * a->faces.particles * sizeof(double));
        if (self->side[k].x == NULL) {
            return weft_error_set(err, WEFT_NO_MEMORY, "no memory for a frame");
        }
    }
    return WEFT_OK;
}

/* ---- comparing -------------------------------------------------------------- */

/* < 0, 0, > 0: a is earlier, the same, later */
static int order(double a, double b)
{
    return fabs(a - b) <= TIME_MATCH * (1.0 + fabs(a)) ? 0 : a < b ? -1 : 1;
}

static void compare_hashes(comparison *self)
{
    const diff_side *a = &self->side[0], *b = &self->side[1];
    for (size_t i = 0, j = 0; i < a->row_count && j < b->row_count;) {
        const record_series_row *p = &a->rows[i], *q = &b->rows[j];
        const int which = order(p->time, q->time);
        if (which == 0) {
            ++self->rows;
            self->unequal += p->hash != q->hash;
            if (p->hash != q->hash && self->unequal == 1) {
                self->first = (gap){ .frame = { p->frame, q->frame }, .time = p->time };
            }
        }
        i += which <= 0;
        j += which >= 0;
    }
}

static double rounded(const comparison *self, double value)
{
    return self->single ? (double)record_single(value) : value;
}

static bool are_equal(const comparison *self, size_t count)
{
    const double *a = self->side[0].x, *b = self->side[1].x;
    size_t i = 0;
    while (i < count && rounded(self, a[i]) == rounded(self, b[i])) {
        ++i;
    }
    return i == count;
}

static bool both_have_field(const comparison *self, size_t k)
{
    return self->side[0].frames->fields[fields[k].field]
           && self->side[1].frames->fields[fields[k].field];
}

/* The first of them to differ in frame i of the first run and frame j of the second. */
static weft_status compare_fields(comparison *self, size_t i, size_t j, const gap *here,
                                  weft_error *err)
{
    const diff_side *a = &self->side[0], *b = &self->side[1];
    const size_t n = a->frames->faces.particles;
    for (size_t k = 0; self->field == NULL && k < FIELDS; ++k) {
        if (!both_have_field(self, k)) {
            continue;
        }
        TRY(record_frames_field(a->frames, fields[k].field, i, a->x, err));
        TRY(record_frames_field(b->frames, fields[k].field, j, b->x, err));
        if (!are_equal(self, fields[k].width * n)) {
            self->field = fields[k].name;
            self->other = *here;
        }
    }
    return WEFT_OK;
}

static void find_farthest(const comparison *self, gap *here)
{
    const double *a = self->side[0].x, *b = self->side[1].x;
    for (size_t p = 0; p < self->side[0].frames->faces.particles; ++p) {
        double d[3];
        for (size_t k = 0; k < 3; ++k) {
            d[k] = rounded(self, a[3 * p + k]) - rounded(self, b[3 * p + k]);
        }
        const double distance
            = hypot(hypot(d[0], d[1]), d[2]); /* squares may overflow or underflow */
        if (distance > here->distance) {
            here->distance = distance;
            here->particle = p;
            here->found = true;
        }
    }
}

static weft_status compare_frame(comparison *self, size_t i, size_t j, weft_error *err)
{
    record_frames *a = self->side[0].frames, *b = self->side[1].frames;
    gap here = { .frame = { (size_t)a->numbers[i], (size_t)b->numbers[j] },
                 .time = a->times[i] };
    TRY(record_frames_positions(a, i, self->side[0].x, err));
    TRY(record_frames_positions(b, j, self->side[1].x, err));
    if (!are_equal(self, 3 * a->faces.particles)) {
        find_farthest(self, &here);
    }
    if (self->tolerance < 0.0 && self->unequal == 0) {
        TRY(compare_fields(self, i, j, &here, err));
    }
    if (here.distance > fmax(self->tolerance, 0.0)) {
        self->begin = self->beyond++ == 0 ? here : self->begin;
    }
    if (here.distance > self->largest.distance) {
        self->largest = here;
    }
    ++self->frames;
    return WEFT_OK;
}

/* ---- the report ------------------------------------------------------------- */

static bool ends_differ(const comparison *self, double end[2])
{
    for (size_t k = 0; k < 2; ++k) {
        end[k] = self->side[k].rows[self->side[k].row_count - 1].time;
    }
    return order(end[0], end[1]) != 0;
}

static bool differs(const comparison *self)
{
    return ends_differ(self, (double[2]){ 0 }) || self->begin.found
           || (self->tolerance < 0.0 && (self->unequal > 0 || self->field != NULL));
}

static void print_frame(const gap *at)
{
    if (at->frame[0] == at->frame[1]) {
        printf("frame %zu (t = %.9g s)", at->frame[0], at->time);
    } else {
        printf("frames %zu and %zu (t = %.9g s)", at->frame[0], at->frame[1], at->time);
    }
}

static void print_gap(const comparison *self, const char *label, const gap *found)
{
    char name[RECORD_FACES_TEXT];
    printf("%s: ", label);
    print_frame(found);
    printf(": %s by %.3g m\n",
           record_particle_text(&self->side[0].frames->faces, found->particle, name),
           found->distance);
}

static void print_positions(const comparison *self)
{
    if (self->begin.found) {
        print_gap(self,
                  self->tolerance < 0.0 ? "first other positions"
                                        : "first beyond the tolerance",
                  &self->begin);
    } else if (self->tolerance < 0.0) {
        printf("positions are equal in the %zu frames of run.vtkhdf that both have%s\n",
               self->frames, self->single ? ", in single precision" : "");
    }
    if (self->largest.found) {
        print_gap(self, "largest", &self->largest);
    }
}

/* Equal states have equal positions and velocities. Their strain differs if the springs
 * do. */
static void print_other_frames(const comparison *self)
{
    const bool damaged = self->begin.found || self->field == fields[0].name;
    printf("the states are equal by their hashes in series.csv: %s\n",
           damaged ? "one run.vtkhdf is damaged"
                   : "the springs differ, or one run.vtkhdf is damaged");
    if (self->begin.found) {
        print_positions(self);
    }
    if (self->field != NULL) {
        printf("first other %s: ", self->field);
        print_frame(&self->other);
        putchar('\n');
    }
}

static void print_compared(const comparison *self)
{
    fputs("compared: states by their hashes in series.csv; ", stdout);
    if (!both_have_frames(self)) {
        puts("not run.vtkhdf, which only one of them has, or none");
        return;
    }
    fputs("positions", stdout);
    for (size_t k = 0; k < FIELDS; ++k) {
        printf("%s%s", both_have_field(self, k) ? ", " : "",
               both_have_field(self, k) ? fields[k].name : "");
    }
    printf(" in %zu frames of run.vtkhdf\n", self->frames);
}

static void print_verdict(const comparison *self, bool other_frames)
{
    const bool bitwise = self->tolerance < 0.0;
    const size_t different = bitwise ? self->unequal : self->beyond;
    const size_t all = bitwise ? self->rows : self->frames;
    if (other_frames) {
        printf("different in run.vtkhdf; equal states at %zu times that both have\n",
               all);
    } else if (different > 0) {
        printf("different at %zu of %zu times that both have\n", different, all);
    } else {
        printf("%s at %zu times that both have\n",
               bitwise ? "equal" : "equal within the tolerance", all);
    }
}

static void print_all(const comparison *self)
{
    const bool framed = both_have_frames(self);
    const bool bitwise = self->tolerance < 0.0;
    double end[2];
    const bool other_frames
        = bitwise && self->unequal == 0 && (self->begin.found || self->field != NULL);
    print_verdict(self, other_frames);
    if (ends_differ(self, end)) {
        print_plainly(stdout, "%s ends at t = %.9g s, %s at t = %.9g s\n",
                      self->side[0].directory, end[0], self->side[1].directory, end[1]);
    }
    if (self->unequal > 0) {
        printf("first other state: ");
        print_frame(&self->first);
        putchar('\n');
    }
    if (other_frames) {
        print_other_frames(self);
    } else if (framed && (self->unequal > 0 || !bitwise)) {
        print_positions(self);
    } else if (!framed && self->unequal > 0) {
        printf("no run.vtkhdf to show where and by how much\n");
    } else if (bitwise) {
        print_compared(self);
    }
}

/* ---- the verb --------------------------------------------------------------- */

static weft_status compare(comparison *self, weft_error *err)
{
    TRY(open_both(self, err));
    compare_hashes(self);
    const record_frames *a = self->side[0].frames, *b = self->side[1].frames;
    for (size_t i = 0, j = 0; both_have_frames(self) && i < a->count && j < b->count;) {
        const int which = order(a->times[i], b->times[j]);
        if (which == 0) {
            TRY(compare_frame(self, i, j, err));
        }
        i += which <= 0;
        j += which >= 0;
    }
    return self->rows > 0
               ? WEFT_OK
               : weft_error_set(err, WEFT_IO, "%s and %s have no time in common",
                                self->side[0].directory, self->side[1].directory);
}

static int diff_verb(const arguments *given)
{
    const double tolerance = diff_own(given)->tolerance == NULL
                                 ? -1.0
                                 : option_real(diff_own(given)->tolerance);
    if (diff_own(given)->tolerance != NULL
        && !(tolerance >= 0.0 && isfinite(tolerance))) {
        return usage_error(given, "--tol %s: must be a number >= 0 [m]",
                           diff_own(given)->tolerance);
    }
    weft_error err = { 0 };
    comparison self = { .side = { { .directory = given->operands[0] },
                                  { .directory = given->operands[1] } },
                        .tolerance = tolerance };
    int code = EXIT_DONE;
    if (compare(&self, &err) != WEFT_OK) {
        code = report_error(&err);
    } else {
        print_all(&self);
        code = differs(&self) ? EXIT_DIFFERENT : EXIT_DONE;
    }
    for (size_t k = 0; k < 2; ++k) {
        record_frames_close(self.side[k].frames);
        free(self.side[k].rows);
        free(self.side[k].x);
    }
    return code;
}

static const verb_option options[] = {
    OWN(diff_options, tolerance, "tol", "X",
        "compare the positions of run.vtkhdf: equal if none differ by more than X "
        "metres"),
};

const verb verb_diff = {
    .name = "diff",
    .summary = "find where two runs begin to differ, and by how much",
    .help = "usage: weft diff DIR DIR2 [OPTIONS]\n"
            "\n"
            "Compares two runs of the same grid or mesh at their common times. Prints "
            "the first frame that differs, the particle with the largest distance in "
            "it, this distance, and the largest distance of all frames. States are "
            "compared bit for bit by the hashes in series.csv, and frames by the "
            "positions, velocities and strain in run.vtkhdf.\n",
    OPTIONS(options),
    .own_size = sizeof(diff_options),
    .more = "examples:\n"
            "  weft diff flag flag-again\n"
            "  weft diff flag-rkf45 flag-verlet --tol 1e-4\n"
            "\n"
            "exit codes: 0 equal, 1 different, also if one ends before the other, 2 "
            "wrong command line, 3 different grids, 4 a file is missing or damaged, or "
            "there is no common time\n",
    .operands = { 2, 2, "needs the directories of two runs", NULL },
    .run = diff_verb,
};
