/* SPDX-License-Identifier: BSD-3-Clause */
/* thread_pool.c -- threads that take the parts of a job one by one: a thread that a
 * busy machine keeps from running leaves its parts to the others, and none waits for
 * it.
 *
 * One word describes the job: its number, the number of its parts and the next part. A
 * thread that raises `next` by an exchange of the whole word has a part, and the job is
 * not over before that part is done; only then may it read the task. After a job
 * helpers wait for the next one for a while, because waking takes longer than many
 * jobs, and then sleep. */
#include "base/thread_pool.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "base/memory.h"

/* Spins last some 10 us, the time between two evaluations; yields some 50. A stack
 * [bytes] holds the fast forms of forces; musl's own is too small. */
enum { HELPERS = 63, SPINS = 400, YIELDS = 500, STACK = 1 << 21 };

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

struct weft__pool {
    atomic_uint_fast64_t job; /* number << 32 | count << 16 | next */
    atomic_size_t done;       /* parts of it */
    atomic_size_t helped;     /* parts that helpers have taken */
    weft__task *task;
    void *ctx;
    fp_mode mode;     /* the caller's, for all parts */
    pthread_t caller; /* of the job */

    pthread_mutex_t lock; /* of sleeping threads */
    pthread_cond_t news;
    atomic_int asleep;
    atomic_bool ended;
    pthread_t helper[HELPERS];
    size_t helpers;
    weft_allocator memory;
};

static size_t thread_pool_count_of(uint_fast64_t job)
{
    return job >> 16 & WEFT_PARTS;
}

static size_t next_of(uint_fast64_t job)
{
    return job & WEFT_PARTS;
}

/* Waits a moment, for the i-th time: first by spinning, then by yielding. */
static void thread_pool_relax(int i)
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
static uint_fast64_t take_parts(weft__pool *pool, bool helps)
{
    uint_fast64_t job = atomic_load(&pool->job);
    size_t own = 0;
    while (next_of(job) < thread_pool_count_of(job)) {
        if (atomic_compare_exchange_weak(&pool->job, &job, job + 1)) {
            if (helps) {
                fp_mode_set(&pool->mode);
            }
            pool->task(pool->ctx, helps ? thread_pool_count_of(job) - 1
                                              - atomic_fetch_add(&pool->helped, 1)
                                        : own++);
            atomic_fetch_add(&pool->done, 1);
            job = atomic_load(&pool->job);
        }
    }
    return job;
}

static bool news(const weft__pool *pool, uint_fast64_t seen)
{
    return atomic_load(&pool->job) != seen || atomic_load(&pool->ended);
}

static void await_news(weft__pool *pool, uint_fast64_t seen)
{
    for (int i = 0; i < SPINS + YIELDS; ++i) {
        if (news(pool, seen)) {
            return;
        }
        thread_pool_relax(i);
    }
    (void)pthread_mutex_lock(&pool->lock);
    atomic_fetch_add(&pool->asleep, 1);
    while (!news(pool, seen)) {
        (void)pthread_cond_wait(&pool->news, &pool->lock);
    }
    atomic_fetch_sub(&pool->asleep, 1);
    (void)pthread_mutex_unlock(&pool->lock);
}

static void *help(void *shared)
{
    weft__pool *pool = shared;
    while (!atomic_load(&pool->ended)) {
        await_news(pool, take_parts(pool, true));
    }
    return NULL;
}

static void wake(weft__pool *pool)
{
    (void)pthread_mutex_lock(&pool->lock);
    (void)pthread_cond_broadcast(&pool->news);
    (void)pthread_mutex_unlock(&pool->lock);
}

void weft__pool_run(void *self, weft__task *task, void *ctx, size_t count)
{
    weft__pool *pool = self;
    if (pool == NULL || count <= 1) {
        for (size_t i = 0; i < count; ++i) {
            task(ctx, i);
        }
        return;
    }
    const uint_fast64_t number = (atomic_load(&pool->job) >> 32) + 1;
    pool->task = task;
    pool->ctx = ctx;
    fp_mode_get(&pool->mode);
    pool->caller = pthread_self();
    atomic_store(&pool->done, 0);
    atomic_store(&pool->helped, 0);
    atomic_store(&pool->job, number << 32 | (uint_fast64_t)count << 16);
    if (atomic_load(&pool->asleep) > 0) {
        wake(pool);
    }
    (void)take_parts(pool, false);
    for (int i = 0; atomic_load(&pool->done) < count; ++i) {
        thread_pool_relax(i);
    }
}

/* Signals are for the program's own threads. */
static void thread_pool_start(weft__pool *pool, size_t threads)
{
    sigset_t all, before;
    pthread_attr_t stack;
    (void)pthread_attr_init(&stack);
    (void)pthread_attr_setstacksize(&stack, STACK);
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    while (pool->helpers < HELPERS && pool->helpers + 1 < threads
           && pthread_create(&pool->helper[pool->helpers], &stack, help, pool) == 0) {
        ++pool->helpers;
    }
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    (void)pthread_attr_destroy(&stack);
}

weft__pool *weft__pool_create(size_t threads, const weft_allocator *given)
{
    const weft_allocator memory = weft_allocator_or_malloc(given);
    weft__pool *pool = threads > 1 ? weft__zeroed(&memory, 1, sizeof *pool) : NULL;
    if (pool == NULL) {
        return NULL;
    }
    pool->memory = memory;
    atomic_init(&pool->job, 0);
    atomic_init(&pool->done, 0);
    atomic_init(&pool->helped, 0);
    atomic_init(&pool->asleep, 0);
    atomic_init(&pool->ended, false);
    if (pthread_mutex_init(&pool->lock, NULL) != 0) {
        weft__free(&memory, pool);
        return NULL;
    }
    if (pthread_cond_init(&pool->news, NULL) != 0) {
        (void)pthread_mutex_destroy(&pool->lock);
        weft__free(&memory, pool);
        return NULL;
    }
    thread_pool_start(pool, threads);
    return pool;
}

void weft__pool_destroy(weft__pool *pool)
{
    if (pool == NULL) {
        return;
    }
    atomic_store(&pool->ended, true);
    wake(pool);
    while (pool->helpers > 0) {
        (void)pthread_join(pool->helper[--pool->helpers], NULL);
    }
    (void)pthread_cond_destroy(&pool->news);
    (void)pthread_mutex_destroy(&pool->lock);
    const weft_allocator memory = pool->memory;
    weft__free(&memory, pool);
}

bool weft__pool_in_caller(const weft__pool *pool)
{
    return pool == NULL || pthread_equal(pthread_self(), pool->caller);
}

const char *weft__pool_refusal(size_t threads)
{
    (void)threads;
    return NULL;
}

size_t weft__pool_threads(const weft__pool *pool)
{
    return pool == NULL ? 1 : pool->helpers + 1;
}
