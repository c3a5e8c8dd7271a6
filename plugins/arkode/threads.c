/* SPDX-License-Identifier: BSD-3-Clause */
/* threads.c -- helpers of the thread that steps. They take the parts of a job as they
 * come: who is kept from running, on a busy machine, leaves them to the others, and
 * nobody waits for one who has not begun. (OpenMP's barriers wait for all of a team,
 * running: with one other busy process on two cores, steps took 4 to 20 times longer
 * than on one thread.) Between jobs they sleep. */
#include "arkode_plugin.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { HELPERS = 63 };

struct ark_team {
    pthread_mutex_t lock;
    pthread_cond_t news;
    pthread_t helper[HELPERS];
    int helpers;
    bool ended;
    uint64_t jobs; /* so far */

    /* the job under way; NULL: none that one could still join */
    ark_task *task;
    void *ctx;
    int count;
    atomic_int next; /* part that nobody has taken yet */
    atomic_int busy; /* helpers that have joined */
};

static void take_parts(ark_team *team, ark_task *task, void *ctx, int count)
{
    for (int i; (i = atomic_fetch_add(&team->next, 1)) < count;) {
        task(ctx, i);
    }
}

static void *help(void *shared)
{
    ark_team *team = shared;
    uint64_t seen = 0;
    pthread_mutex_lock(&team->lock);
    while (!team->ended) {
        if (team->task == NULL || team->jobs == seen) {
            pthread_cond_wait(&team->news, &team->lock);
            continue;
        }
        ark_task *const task = team->task;
        void *const ctx = team->ctx;
        const int count = team->count;
        seen = team->jobs;
        atomic_fetch_add(&team->busy, 1);
        pthread_mutex_unlock(&team->lock);
        take_parts(team, task, ctx, count);
        atomic_fetch_sub(&team->busy, 1);
        pthread_mutex_lock(&team->lock);
    }
    pthread_mutex_unlock(&team->lock);
    return NULL;
}

void weft__ark_team_run(ark_team *team, ark_task *task, void *ctx, int count)
{
    pthread_mutex_lock(&team->lock);
    team->task = task;
    team->ctx = ctx;
    team->count = count;
    atomic_store(&team->next, 0);
    ++team->jobs;
    pthread_cond_broadcast(&team->news);
    pthread_mutex_unlock(&team->lock);
    take_parts(team, task, ctx, count);
    pthread_mutex_lock(&team->lock);
    team->task = NULL;
    pthread_mutex_unlock(&team->lock);
    while (atomic_load(&team->busy) > 0) {
        (void)sched_yield(); /* they are within their last part */
    }
}

/* Signals are for the program's own threads. */
static void start(ark_team *team, size_t threads)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    while (team->helpers < HELPERS && (size_t)team->helpers + 1 < threads
           && pthread_create(&team->helper[team->helpers], NULL, help, team) == 0) {
        ++team->helpers;
    }
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

ark_team *weft__ark_team(size_t threads)
{
    ark_team *team = threads > 1 ? calloc(1, sizeof *team) : NULL;
    if (team == NULL) {
        return NULL;
    }
    atomic_init(&team->next, 0);
    atomic_init(&team->busy, 0);
    if (pthread_mutex_init(&team->lock, NULL) != 0) {
        free(team);
        return NULL;
    }
    if (pthread_cond_init(&team->news, NULL) != 0) {
        (void)pthread_mutex_destroy(&team->lock);
        free(team);
        return NULL;
    }
    start(team, threads);
    return team;
}

void weft__ark_team_free(ark_team *team)
{
    if (team == NULL) {
        return;
    }
    pthread_mutex_lock(&team->lock);
    team->ended = true;
    pthread_cond_broadcast(&team->news);
    pthread_mutex_unlock(&team->lock);
    while (team->helpers > 0) {
        (void)pthread_join(team->helper[--team->helpers], NULL);
    }
    (void)pthread_cond_destroy(&team->news);
    (void)pthread_mutex_destroy(&team->lock);
    free(team);
}
