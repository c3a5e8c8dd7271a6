/* SPDX-License-Identifier: BSD-3-Clause */
/* team.c -- threads that take the parts of a job one by one: a thread that a busy
 * machine keeps from running leaves its parts to the others, and none waits for it.
 *
 * One word describes the job: its number, the number of its parts and the next part. A
 * thread that raises `next` by an exchange of the whole word has a part, and the job is
 * not over before that part is done; only then may it read the task. After a job
 * helpers wait for the next one for a while, because waking takes longer than many
 * jobs, and then sleep. */
#include "base/team.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "base/memory.h"

/* Spins last some 10 us, the time between two evaluations; yields some 50. */
enum { HELPERS = 63, SPINS = 400, YIELDS = 500 };

/* Rounding and, on x86-64, the treatment of subnormal numbers, of the SSE unit alone:
 * the mode of the x87 would cost as much as a small job. */
#ifdef __SSE2__
typedef unsigned fp_mode;
#define fp_mode_get(mode) ((void)(*(mode) = _mm_getcsr()))
#define fp_mode_set(mode) _mm_setcsr(*(mode))
#else
typedef fenv_t fp_mode;
#define fp_mode_get(mode) ((void)fegetenv(mode))
#define fp_mode_set(mode) ((void)fesetenv(mode))
#endif

struct weft__team {
    atomic_uint_fast64_t job; /* number << 32 | count << 16 | next */
    atomic_size_t done;       /* parts of it */
    atomic_size_t helped;     /* parts that helpers have taken */
    weft__task *task;
    void *ctx;
    fp_mode mode; /* the caller's, for all parts */

    pthread_mutex_t lock; /* of sleeping threads */
    pthread_cond_t news;
    atomic_int asleep;
    atomic_bool ended;
    pthread_t helper[HELPERS];
    size_t helpers;
    weft_allocator memory;
};

static size_t count_of(uint_fast64_t job)
{
    return job >> 16 & WEFT_PARTS;
}

static size_t next_of(uint_fast64_t job)
{
    return job & WEFT_PARTS;
}

/* Waits a moment, for the i-th time: first by spinning, then by yielding. */
static void relax(int i)
{
    if (i >= SPINS) {
        (void)sched_yield();
        return;
    }
#ifdef __x86_64__
    __builtin_ia32_pause();
#endif
}

/* Takes parts until there are no more; returns the job as it was then. The caller takes
 * the first ones and helpers the last: from job to job most parts stay with a core,
 * which has their numbers in its cache. */
static uint_fast64_t take_parts(weft__team *team, bool helps)
{
    uint_fast64_t job = atomic_load(&team->job);
    size_t own = 0;
    while (next_of(job) < count_of(job)) {
        if (atomic_compare_exchange_weak(&team->job, &job, job + 1)) {
            if (helps) {
                fp_mode_set(&team->mode);
            }
            team->task(team->ctx,
                       helps ? count_of(job) - 1 - atomic_fetch_add(&team->helped, 1)
                             : own++);
            atomic_fetch_add(&team->done, 1);
            job = atomic_load(&team->job);
        }
    }
    return job;
}

static bool news(const weft__team *team, uint_fast64_t seen)
{
    return atomic_load(&team->job) != seen || atomic_load(&team->ended);
}

static void await_news(weft__team *team, uint_fast64_t seen)
{
    for (int i = 0; i < SPINS + YIELDS; ++i) {
        if (news(team, seen)) {
            return;
        }
        relax(i);
    }
    (void)pthread_mutex_lock(&team->lock);
    atomic_fetch_add(&team->asleep, 1);
    while (!news(team, seen)) {
        (void)pthread_cond_wait(&team->news, &team->lock);
    }
    atomic_fetch_sub(&team->asleep, 1);
    (void)pthread_mutex_unlock(&team->lock);
}

static void *help(void *shared)
{
    weft__team *team = shared;
    while (!atomic_load(&team->ended)) {
        await_news(team, take_parts(team, true));
    }
    return NULL;
}

static void wake(weft__team *team)
{
    (void)pthread_mutex_lock(&team->lock);
    (void)pthread_cond_broadcast(&team->news);
    (void)pthread_mutex_unlock(&team->lock);
}

void weft__team_run(void *self, weft__task *task, void *ctx, size_t count)
{
    weft__team *team = self;
    const uint_fast64_t number = (atomic_load(&team->job) >> 32) + 1;
    team->task = task;
    team->ctx = ctx;
    fp_mode_get(&team->mode);
    atomic_store(&team->done, 0);
    atomic_store(&team->helped, 0);
    atomic_store(&team->job, number << 32 | (uint_fast64_t)count << 16);
    if (atomic_load(&team->asleep) > 0) {
        wake(team);
    }
    (void)take_parts(team, false);
    for (int i = 0; atomic_load(&team->done) < count; ++i) {
        relax(i);
    }
}

/* Signals are for the program's own threads. */
static void start(weft__team *team, size_t threads)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    while (team->helpers < HELPERS && team->helpers + 1 < threads
           && pthread_create(&team->helper[team->helpers], NULL, help, team) == 0) {
        ++team->helpers;
    }
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

weft__team *weft__team_create(size_t threads, const weft_allocator *given)
{
    const weft_allocator memory = weft_allocator_or_malloc(given);
    weft__team *team = threads > 1 ? weft__zeroed(&memory, 1, sizeof *team) : NULL;
    if (team == NULL) {
        return NULL;
    }
    team->memory = memory;
    atomic_init(&team->job, 0);
    atomic_init(&team->done, 0);
    atomic_init(&team->helped, 0);
    atomic_init(&team->asleep, 0);
    atomic_init(&team->ended, false);
    if (pthread_mutex_init(&team->lock, NULL) != 0) {
        weft__free(&memory, team);
        return NULL;
    }
    if (pthread_cond_init(&team->news, NULL) != 0) {
        (void)pthread_mutex_destroy(&team->lock);
        weft__free(&memory, team);
        return NULL;
    }
    start(team, threads);
    return team;
}

void weft__team_destroy(weft__team *team)
{
    if (team == NULL) {
        return;
    }
    atomic_store(&team->ended, true);
    wake(team);
    while (team->helpers > 0) {
        (void)pthread_join(team->helper[--team->helpers], NULL);
    }
    (void)pthread_cond_destroy(&team->news);
    (void)pthread_mutex_destroy(&team->lock);
    const weft_allocator memory = team->memory;
    weft__free(&memory, team);
}

size_t weft__team_threads(const weft__team *team)
{
    return team == NULL ? 1 : team->helpers + 1;
}
