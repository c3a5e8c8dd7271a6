/* SPDX-License-Identifier: BSD-3-Clause */
/* contact.c -- the time that contact takes of an evaluation of P(n): where no particle
 * touches a shape, and where all touch one of each kind; and evaluations and seconds of
 * whole runs (drape.h). One thread, by its own time. */
#define BENCH_CLOCK CLOCK_THREAD_CPUTIME_ID
#include "bench.h"

#include <math.h>

#include "drape.h"
#include "problem.h"

enum { CALLS = 20, ROUNDS = 31 };

typedef struct subject {
    weft_cloth *cloth;
    double *y, *dydt;
} subject;

static void evaluate(void *ctx)
{
    const subject *self = ctx;
    for (size_t i = 0; i < CALLS; ++i) {
        if (weft_cloth_rhs(self->cloth, 0.0, self->y, self->dydt) != 0) {
            fprintf(stderr, "a state that cannot be used\n");
            exit(1);
        }
    }
}

/* A shape whose surface is `gap` below the sheet, and flat or nearly so. */
static weft_shape below(weft_shape_kind kind, double gap)
{
    const double large = 1000.0; /* [m] */
    weft_shape shape = weft_shape_default(kind);
    const double depth = kind == WEFT_PLANE ? 0.0 : kind == WEFT_BOX ? 1.0 : large;
    shape.at[1] = shape.to[1] = -gap - depth;
    shape.at[0] = -1.0, shape.to[0] = 2.0, shape.at[2] = shape.to[2] = 0.5;
    shape.radius = large;
    shape.half[0] = shape.half[2] = 3.0;
    return shape;
}

static subject make(size_t n, const weft_shape *shape, weft_friction_law law)
{
    weft_cloth_def def = problem(n);
    weft_error err;
    subject self;
    def.contact.shapes = shape;
    def.contact.shape_count = shape != NULL ? 1 : 0;
    def.contact.law = law;
    bench_must(weft_cloth_create(&def, &self.cloth, &err), &err);
    self.y = malloc(6 * n * n * sizeof *self.y);
    self.dydt = malloc(6 * n * n * sizeof *self.dydt);
    if (self.y == NULL || self.dydt == NULL) {
        abort();
    }
    weft_cloth_start(self.cloth, self.y);
    for (size_t j = 3 * n * n; j < 6 * n * n; ++j) {
        self.y[j] = 0.1 * sin((double)j); /* [m/s]: slip */
    }
    return self;
}

static void measure(size_t n)
{
    static const struct {
        const char *name;
        weft_shape_kind kind;
        double gap; /* [m] of 5 mm; 0: no shape */
        weft_friction_law law;
    } kinds[] = {
        { "no shape", WEFT_PLANE, 0.0, WEFT_FRICTION_SMOOTH },
        { "plane, far", WEFT_PLANE, 0.1, WEFT_FRICTION_SMOOTH },
        { "sphere, far", WEFT_SPHERE, 0.1, WEFT_FRICTION_SMOOTH },
        { "plane", WEFT_PLANE, 0.003, WEFT_FRICTION_SMOOTH },
        { "plane, coulomb", WEFT_PLANE, 0.003, WEFT_FRICTION_COULOMB },
        { "sphere", WEFT_SPHERE, 0.003, WEFT_FRICTION_SMOOTH },
        { "capsule", WEFT_CAPSULE, 0.003, WEFT_FRICTION_SMOOTH },
        { "box", WEFT_BOX, 0.003, WEFT_FRICTION_SMOOTH },
    };
    enum { COUNT = sizeof kinds / sizeof kinds[0] };
    subject subjects[COUNT];
    bench_case cases[COUNT];
    for (size_t i = 0; i < COUNT; ++i) {
        const weft_shape shape = below(kinds[i].kind, kinds[i].gap);
        subjects[i] = make(n, kinds[i].gap > 0.0 ? &shape : NULL, kinds[i].law);
        cases[i] = (bench_case){ kinds[i].name, evaluate, &subjects[i], 0.0 };
    }
    bench_interleaved(cases, COUNT, ROUNDS);
    for (size_t i = 0; i < COUNT; ++i) {
        const double each = 1e9 * cases[i].median / (double)(CALLS * n * n);
        const double springs = 1e9 * cases[0].median / (double)(CALLS * n * n);
        printf("%4zu x %-4zu %-15s %6zu touch %7.2f ns a particle %+7.1f %%\n", n, n,
               kinds[i].name,
               weft_cloth_touching(subjects[i].cloth, 0.0, subjects[i].y), each,
               100.0 * (each / springs - 1.0));
        weft_cloth_destroy(subjects[i].cloth);
        free(subjects[i].y);
        free(subjects[i].dydt);
    }
}

int main(void)
{
    measure(33);
    measure(100);
    drape_all(33, 1.0);
    drape_all(100, 0.4);
    return 0;
}
