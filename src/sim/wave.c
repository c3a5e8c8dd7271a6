/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/wave.h"

#include <math.h>

#include "base/memory.h"
#include "cloth/model.h"
#include "sim/round.h"

/* The longest loops: compiled for the widest vectors, with the same bits. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__)                     \
    && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)                           \
    && !defined(__SANITIZE_THREAD__)
#define WIDE __attribute__((target_clones("default", "avx2", "avx512f")))
#else
#define WIDE
#endif
#define INLINE static inline __attribute__((always_inline))
#if defined(__clang__) /* a sum may go on where it is, but not in a part of itself */
#define ELEMENTWISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define ELEMENTWISE _Pragma("GCC ivdep")
#endif

/* BLOCK rows at least, and BLOCK_LEAST particles, in a call of the forces. A window
 * has room for SLACK blocks: then it moves its last four rows to the front. */
enum {
    STENCIL_ROWS = WEFT_GHOST_ROWS,
    BLOCK = 8,
    BLOCK_LEAST = 2048,
    SLACK = 4,
    LINE = 8, /* numbers of a cache line */
    PAGE = 512,
    SIDE_BY_SIDE = 8, /* terms of a sum that are read at once */
    LANES = 64,
    PARTICLES_LEAST = 20000,
    ROWS_PER_THREAD = 8 /* for each stage: a tenth of the rows is computed twice */
};

/* Stage i of a span. Rows [low, made) of its state are in z, those of its rates below
 * `done` in a ring. */
typedef struct window {
    double *z, *k, *carry_rows;
    size_t ring; /* rows of k */
    size_t low, made, done, end_made, end_done;
    weft_cloth cloth; /* rows of the whole from `low` on */
} window;

typedef struct span {
    window *windows; /* from 1 on */
    void *room;
    double *error; /* of a block; then come the windows */
    bool failed;
    double norm, most[2]; /* as in weft_attempt */
} span;

struct weft__wave {
    size_t spans, stages, block;
    size_t stride;     /* of planes of windows */
    size_t carry_rows; /* numbers of one */
    span *of;
    weft_allocator memory;
};

/* ---- sizes ----------------------------------------------------------------------- */

static size_t wave_least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* a - b, or 0 */
static size_t less(size_t a, size_t b)
{
    return a > b ? a - b : 0;
}

static size_t wave_block_of(const weft_cloth *cloth)
{
    const size_t rows = BLOCK_LEAST / cloth->mesh.cols + 1;
    return rows > BLOCK ? rows : BLOCK;
}

static size_t window_rows(size_t block)
{
    return SLACK * block + 2 * STENCIL_ROWS;
}

/* Rows of rates that later stages and the error still need. */
static size_t ring_rows(size_t block, size_t stages, size_t i)
{
    return (block + STENCIL_ROWS * (stages - 1 - i) + block - 1) / block * block;
}

/* So that planes do not meet in the same sets of a cache. */
static size_t stride_of(const weft_cloth *cloth, size_t stages)
{
    const size_t block = wave_block_of(cloth), rows = window_rows(block);
    const size_t ring = ring_rows(block, stages, 1);
    size_t n = (rows > ring ? rows : ring) * cloth->mesh.cols + 2 * WEFT_PAST;
    n = (n + LINE - 1) / LINE * LINE;
    while (n / LINE % 2 == 0 || n % PAGE < PAGE / 8 || n % PAGE > PAGE - PAGE / 8) {
        n += LINE;
    }
    return n;
}

/* Numbers of a span: its error, its windows and what their alignment takes. */
static size_t room_of(const weft__wave *wave)
{
    return wave->stride * (12 * wave->stages - 11)
           + wave->carry_rows * (wave->stages - 1) + LINE;
}

static size_t spans_of(size_t threads, const weft_cloth *cloth, size_t stages)
{
    const size_t most = cloth->mesh.rows / (ROWS_PER_THREAD * stages);
    return threads < most ? threads : most > 0 ? most : 1;
}

bool weft__wave_pays(const weft__forces *forces, size_t stages)
{
    const size_t threads = weft__pool_threads(forces->pool);
    return weft__round_can(forces) && stages > 1 && stages <= WEFT__WAVE_STAGES
           && weft_cloth_particles(forces->cloth) >= PARTICLES_LEAST
           && spans_of(threads, forces->cloth, stages) == threads;
}

size_t weft__wave_bytes(const weft__wave *wave)
{
    return wave == NULL ? 0
                        : wave->spans
                              * (sizeof(span) + wave->stages * sizeof(window)
                                 + room_of(wave) * sizeof(double));
}

void weft__wave_destroy(weft__wave *wave)
{
    if (wave != NULL) {
        const weft_allocator memory = wave->memory;
        for (size_t b = 0; wave->of != NULL && b < wave->spans; ++b) {
            span *of = &wave->of[b];
            WEFT__FREE_ALL(&memory, of->room, of->windows);
        }
        WEFT__FREE_ALL(&memory, wave->of, wave);
    }
}

static bool make_span(const weft__wave *wave, span *of)
{
    const size_t stride = wave->stride;
    of->windows = weft__zeroed(&wave->memory, wave->stages, sizeof *of->windows);
    of->room = weft__alloc(&wave->memory, room_of(wave), sizeof *of->error);
    if (of->windows == NULL || of->room == NULL) {
        return false;
    }
    const uintptr_t past = (uintptr_t)of->room / sizeof(double) % LINE;
    of->error = (double *)of->room + (past == 0 ? 0 : LINE - past);
    for (size_t i = 1; i < wave->stages; ++i) {
        of->windows[i].z = of->error + stride * (12 * i - 11);
        of->windows[i].k = of->windows[i].z + 6 * stride;
        of->windows[i].carry_rows = of->error + stride * (12 * wave->stages - 11)
                                    + wave->carry_rows * (i - 1);
    }
    return true;
}

weft__wave *weft__wave_create(const weft__forces *forces, size_t stages,
                              const weft_allocator *given)
{
    const weft_allocator memory = weft_allocator_or_malloc(given);
    weft__wave *wave = weft__alloc(&memory, 1, sizeof *wave);
    if (wave == NULL) {
        return NULL;
    }
    const size_t threads = weft__pool_threads(forces->pool);
    *wave = (weft__wave){ .spans = spans_of(threads, forces->cloth, stages),
                          .stages = stages,
                          .block = wave_block_of(forces->cloth),
                          .stride = stride_of(forces->cloth, stages),
                          .carry_rows = weft__carry_length(forces->cloth->mesh.cols),
                          .memory = memory };
    wave->of = weft__zeroed(&memory, wave->spans, sizeof *wave->of);
    for (size_t b = 0; b < wave->spans; ++b) {
        if (wave->of == NULL || !make_span(wave, &wave->of[b])) {
            weft__wave_destroy(wave);
            return NULL;
        }
    }
    return wave;
}

/* ---- sums ------------------------------------------------------------------------ */

typedef struct terms {
    size_t count;
    const double *x[WEFT__WAVE_STAGES + 1];
    double c[WEFT__WAVE_STAGES + 1];
} terms;

INLINE uint64_t magnitude_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & INT64_MAX;
}

/* The sum at i, from left to right. */
INLINE double sum_at(const double *const *x, const double *c, size_t count, size_t i)
{
    double sum = c[0] * x[0][i];
    for (size_t k = 1; k < count; ++k) {
        sum += c[k] * x[k][i];
    }
    return sum;
}

/* The highest bit shows a sum that is not finite: it carries into the sign. */
INLINE uint64_t add_up(const double *const *given, const double *factors, size_t count,
                       double *to, size_t n)
{
    const double *x[SIDE_BY_SIDE];
    double c[SIDE_BY_SIDE];
    uint64_t bad = 0;
    for (size_t k = 0; k < count; ++k) {
        x[k] = given[k], c[k] = factors[k];
    }
    ELEMENTWISE
    for (size_t i = 0; i < n; ++i) {
        to[i] = sum_at(x, c, count, i);
        bad |= magnitude_bits(to[i]) + UINT64_C(0x0010000000000000);
    }
    return bad;
}

#define EACH_COUNT(DO) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7) DO(8)

WIDE static uint64_t add_some(const double *const *x, const double *c, size_t count,
                              double *to, size_t n)
{
    switch (count) {
#define CASE(m)                                                                        \
    case m:                                                                            \
        return add_up(x, c, m, to, n);
        EACH_COUNT(CASE)
#undef CASE
    default:
        return 0;
    }
}

/* Longer sums continue from what is there. Returns whether all of it is finite. */
static bool wave_add(const terms *of, double *to, size_t n)
{
    size_t done = wave_least(of->count, SIDE_BY_SIDE);
    uint64_t bad = add_some(of->x, of->c, done, to, n);
    while (done < of->count) {
        const double *x[SIDE_BY_SIDE] = { to };
        double c[SIDE_BY_SIDE] = { 1.0 };
        size_t k = 1;
        for (; k < SIDE_BY_SIDE && done < of->count; ++k, ++done) {
            x[k] = of->x[done], c[k] = of->c[done];
        }
        bad = add_some(x, c, k, to, n);
    }
    return bad >> 63 == 0;
}

/* The largest |e| / (rtol |y| + atol) of LANES numbers or fewer, or NaN. */
WIDE static double judge(const double *e, const double *y, double rtol, double atol,
                         size_t n, double most)
{
    double lane[LANES] = { 0.0 };
    uint64_t nan = 0;
    const double weight = 1.0 / atol;
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = n - at < LANES ? n - at : LANES;
        for (size_t i = 0; i < m; ++i) {
            const double by
                = rtol == 0.0 ? weight : 1.0 / (rtol * fabs(y[at + i]) + atol);
            const double size = fabs(e[at + i] * by);
            lane[i] = size > lane[i] ? size : lane[i];
            nan |= magnitude_bits(size) + UINT64_C(0x000fffffffffffff);
        }
    }
    for (size_t i = 0; i < LANES; ++i) {
        most = lane[i] > most ? lane[i] : most;
    }
    return nan >> 63 != 0 ? (double)NAN : most;
}

/* Copies n numbers; the largest magnitude of them, none a NaN, and of `most`. */
WIDE static double take(const double *from, double *to, size_t n, double most)
{
    double lane[LANES] = { 0.0 };
    for (size_t at = 0; at < n; at += LANES) {
        const size_t m = n - at < LANES ? n - at : LANES;
        for (size_t i = 0; i < m; ++i) {
            const double size = fabs(from[at + i]);
            to[at + i] = from[at + i];
            lane[i] = size > lane[i] ? size : lane[i];
        }
    }
    for (size_t i = 0; i < LANES; ++i) {
        most = lane[i] > most ? lane[i] : most;
    }
    return most;
}

/* ---- the pass -------------------------------------------------------------------- */

typedef struct wave_job {
    const weft__wave *wave;
    const weft__forces *forces;
    const weft_cloth *cloth;
    weft_attempt *of;
} wave_job;

/* A span on its way. Before a round the front is `front`, and rows below `left` have
 * left the wave. */
typedef struct wave_progress {
    const wave_job *of;
    span *span;
    size_t last; /* stage */
    size_t start, first, end, front, left;
} wave_progress;

/* The first row of the rates of stage i. */
static size_t first_of(const wave_progress *by, size_t i)
{
    return less(by->first, STENCIL_ROWS * (by->last - i));
}

static size_t slot(const wave_progress *by, size_t i, size_t row)
{
    return (row - by->start + STENCIL_ROWS * i) % by->span->windows[i].ring;
}

/* Plane p of row `row` of the rates of stage i. */
static const double *rates_at(const wave_progress *by, size_t i, size_t p, size_t row)
{
    const weft__mesh *mesh = &by->of->cloth->mesh;
    return i == 0 ? by->of->of->k + p * mesh->particles + row * mesh->cols
                  : by->span->windows[i].k + p * by->of->wave->stride
                        + slot(by, i, row) * mesh->cols;
}

/* The terms of a sum over `count` stages in plane p, and how many rows from `row` on
 * lie one behind the other in all of them; with_state: and then the state itself. */
static terms terms_of(const wave_progress *by, const double *factors, size_t count,
                      size_t p, size_t row, bool with_state)
{
    const weft__mesh *mesh = &by->of->cloth->mesh;
    terms out = { .count = 0 };
    for (size_t i = 0; i < count; ++i) {
        if (factors[i] != 0.0) {
            out.x[out.count] = rates_at(by, i, p, row);
            out.c[out.count++] = factors[i];
        }
    }
    if (with_state) {
        out.x[out.count] = by->of->of->y + p * mesh->particles + row * mesh->cols;
        out.c[out.count++] = 1.0;
    }
    return out;
}

/* Rows from `row` on that no ring of the first stages breaks off. */
static size_t rows_together(const wave_progress *by, size_t count, size_t row,
                            size_t end)
{
    size_t rows = end - row;
    for (size_t i = 1; i < count; ++i) {
        rows = wave_least(rows, by->span->windows[i].ring - slot(by, i, row));
    }
    return rows;
}

/* Moves the rows that are still needed to the front of the window. */
static void slide(const wave_progress *by, window *at)
{
    const size_t cols = by->of->cloth->mesh.cols, keep = less(at->done, STENCIL_ROWS);
    for (size_t p = 0; keep > at->low && p < 6; ++p) {
        double *plane = at->z + p * by->of->wave->stride;
        memmove(plane, plane + (keep - at->low) * cols,
                (at->made - keep) * cols * sizeof *plane);
    }
    at->low = keep > at->low ? keep : at->low;
}

static bool wave_make_state(const wave_progress *by, size_t i, size_t end)
{
    window *at = &by->span->windows[i];
    const size_t cols = by->of->cloth->mesh.cols, stride = by->of->wave->stride;
    const double *factors = by->of->of->a + i * (i - 1) / 2;
    bool good = true;
    if (end > at->low + window_rows(by->of->wave->block)) {
        slide(by, at);
    }
    while (at->made < end) {
        const size_t rows = rows_together(by, i, at->made, end);
        for (size_t p = 0; p < 6; ++p) {
            const terms sum = terms_of(by, factors, i, p, at->made, true);
            good &= wave_add(&sum, at->z + p * stride + (at->made - at->low) * cols,
                             rows * cols);
        }
        at->made += rows;
    }
    return good;
}

/* The window as a cloth: its forces see rows from at->low on. */
static void wave_place(const wave_progress *by, window *at)
{
    const weft__mesh *whole = &by->of->cloth->mesh;
    weft__mesh *mesh = &at->cloth.mesh;
    const size_t i = at->low * whole->cols;
    mesh->rows = whole->rows - at->low;
    mesh->band.first = at->low;
    mesh->mass = whole->mass + i;
    mesh->inverse_mass = whole->inverse_mass + i;
    mesh->pin = whole->pin + i;
    for (size_t k = 0; k < at->cloth.springs.group_count; ++k) {
        at->cloth.springs.groups[k].end_row
            = less(by->of->cloth->springs.groups[k].end_row, at->low);
    }
}

/* Rates go from rows of z to those of a ring: from one place of the same room to
 * another. */
static bool make_rates(const wave_progress *by, size_t i, size_t end)
{
    window *at = &by->span->windows[i];
    const size_t cols = by->of->cloth->mesh.cols, first = at->done - at->low;
    const double t = by->of->of->t[i];
    const weft__state state = weft__forces_state(by->of->forces, t, at->z);
    weft__carry carry = { at->carry_rows, at->done > first_of(by, i) };
    double *to = at->k + slot(by, i, at->done) * cols;
    wave_place(by, at);
    const int failed
        = weft__sum_carried(&at->cloth, &state, &carry, WEFT__ACCELERATION,
                            to - first * cols, first, first + (end - at->done));
    weft__move_pins(&by->of->cloth->mesh, t, weft__piece(&state), to,
                    by->of->wave->stride, at->done * cols, end * cols);
    return failed == 0;
}

/* Rows that all stages have passed: the error is judged, state and rates are stored. */
static void leave(const wave_progress *by, size_t end)
{
    const weft_attempt *of = by->of->of;
    const window *at = &by->span->windows[by->last];
    const weft__mesh *mesh = &by->of->cloth->mesh;
    const size_t cols = mesh->cols, count = by->last + (of->k_end != NULL);
    double *e = by->span->error;
    for (size_t row = by->left, rows; row < end; row += rows) {
        rows = rows_together(by, count, row, end);
        const size_t n = rows * cols;
        for (size_t p = 0; p < 6; ++p) {
            const size_t to = p * mesh->particles + row * cols;
            if (of->e != NULL) {
                const terms sum = terms_of(by, of->e, count, p, row, false);
                by->span->failed |= !wave_add(&sum, e, n);
                by->span->norm = judge(e, of->y + to, of->rtol, of->atol[p / 3], n,
                                       by->span->norm);
            }
            by->span->most[p / 3]
                = take(at->z + p * by->of->wave->stride + (row - at->low) * cols,
                       of->y_end + to, n, by->span->most[p / 3]);
            if (of->k_end != NULL) {
                memcpy(of->k_end + to, rates_at(by, by->last, p, row), n * sizeof *e);
            }
        }
    }
}

static void wave_begin(const wave_progress *by)
{
    const size_t rows = by->of->cloth->mesh.rows;
    for (size_t i = 1; i <= by->last; ++i) {
        window *at = &by->span->windows[i];
        const size_t halo = STENCIL_ROWS * (by->last - i);
        at->ring = ring_rows(by->of->wave->block, by->last + 1, i);
        at->done = first_of(by, i);
        at->low = at->made = less(at->done, STENCIL_ROWS);
        at->end_done = wave_least(rows, by->end + halo);
        at->end_made = wave_least(rows, by->end + halo + STENCIL_ROWS);
        at->cloth = *by->of->cloth;
        at->cloth.mesh.particles = at->cloth.mesh.stride = by->of->wave->stride;
        at->cloth.mesh.band.above = 0;
        for (size_t k = 0; k < WEFT__FORCES; ++k) {
            *(const weft__mesh **)weft__own_of(&at->cloth, k) = &at->cloth.mesh;
        }
    }
}

static void wave_do_span(void *ctx, size_t b)
{
    const wave_job *of = ctx;
    const size_t rows = of->cloth->mesh.rows, last = (size_t)of->of->stages - 1;
    const size_t first = b * rows / of->wave->spans;
    wave_progress by = { .of = of,
                         .span = &of->wave->of[b],
                         .last = last,
                         .start = less(first, STENCIL_ROWS * last),
                         .first = first,
                         .end = (b + 1) * rows / of->wave->spans,
                         .left = first };
    by.span->failed = false;
    by.span->norm = by.span->most[0] = by.span->most[1] = 0.0;
    wave_begin(&by);
    for (by.front = by.start; by.left < by.end && !by.span->failed;) {
        by.front += of->wave->block;
        for (size_t i = 1; i <= last; ++i) {
            window *at = &by.span->windows[i];
            const size_t made
                = wave_least(at->end_made, less(by.front, STENCIL_ROWS * (i - 1)));
            const size_t done
                = wave_least(at->end_done, less(by.front, STENCIL_ROWS * i));
            bool good = made <= at->made || wave_make_state(&by, i, made);
            if (done > at->done) {
                good = good
                       && ((i == last && of->of->k_end == NULL)
                           || make_rates(&by, i, done));
                at->done = done;
            }
            by.span->failed |= !good;
        }
        const size_t end = wave_least(by.end, by.span->windows[last].done);
        if (end > by.left) {
            leave(&by, end);
            by.left = end;
        }
    }
}

int weft__wave_run(weft__wave *wave, const weft__forces *forces, weft_attempt *attempt)
{
    wave_job of = { wave, forces, forces->cloth, attempt };
    weft__pool_run(forces->pool, wave_do_span, &of, wave->spans);
    bool failed = false;
    attempt->norm = attempt->most[0] = attempt->most[1] = 0.0;
    for (size_t b = 0; b < wave->spans; ++b) {
        const span *at = &wave->of[b];
        failed |= at->failed || isnan(at->norm);
        attempt->norm = fmax(attempt->norm, at->norm);
        for (size_t half = 0; half < 2; ++half) {
            attempt->most[half] = fmax(attempt->most[half], at->most[half]);
        }
    }
    return failed || !isfinite(attempt->norm);
}
