/* SPDX-License-Identifier: BSD-3-Clause */
/* interrupt.c -- records signals, and watches for steps that do not end: a solver may
 * spend minutes in its linear algebra. The watching thread cannot end the step. It
 * waits for the lock on the records, which is free within a step, and closes them. */
#include "program/run/interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "program/cli.h"

/* [ms] for an evaluation of the forces, or a step, to end before the process does */
enum { PATIENCE = 1000 };

static volatile sig_atomic_t came, wake = -1;

static void on_signal(int number)
{
    const int kept = errno;
    came = number == SIGUSR1 ? SIGTERM : number;
    if (wake >= 0) {
        (void)!write(wake, "", 1);
    }
    errno = kept;
}

static void catch_one(int number, bool on)
{
    struct sigaction action
        = { .sa_handler = on ? on_signal : SIG_DFL, .sa_flags = SA_RESTART };
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(number, &action, NULL);
}

void interrupt_catch(bool on)
{
    catch_one(SIGINT, on);
    catch_one(SIGTERM, on);
}

void interrupt_catch_user(void)
{
    catch_one(SIGUSR1, true);
}

int interrupt_agreed(const weft_comm *comm)
{
    const int mine = came;
    const int number = comm == NULL ? mine : (int)comm->max(comm->self, mine);
    came = number != 0 ? number : came;
    return number;
}

int interrupt_signal(void)
{
    return came;
}

int interrupt_next(void)
{
    const int number = came;
    if (number != 0) {
        came = 0;
    }
    return number;
}

int interrupt_code(int signal)
{
    return signal == SIGINT    ? EXIT_SIGINT
           : signal == SIGTERM ? EXIT_SIGTERM
                               : EXIT_DONE;
}

bool interrupt_pending(void *unused)
{
    (void)unused;
    return came != 0;
}

/* ---- the thread --------------------------------------------------------------- */

static void wait_for_news(const interrupt_watch *self, int patience)
{
    struct pollfd news = { .fd = self->news[0], .events = POLLIN };
    char byte;
    if (poll(&news, 1, patience) > 0) {
        (void)!read(news.fd, &byte, 1);
    }
}

static void *watch(void *ctx)
{
    interrupt_watch *self = ctx;
    wait_for_news(self, -1);
    (void)pthread_mutex_lock(&self->records);
    if (!self->over) {
        (void)pthread_mutex_unlock(&self->records);
        wait_for_news(self, PATIENCE);
        (void)pthread_mutex_lock(&self->records);
    }
    if (!self->over) {
        self->give_up(self->ctx);
    }
    (void)pthread_mutex_unlock(&self->records);
    return NULL;
}

/* A thread that blocks all signals: the stepping thread receives them. */
static bool start_thread(pthread_t *thread, void *(*body)(void *), void *ctx)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool started = pthread_create(thread, NULL, body, ctx) == 0;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

static bool start(interrupt_watch *self)
{
    if (pipe(self->news) != 0) {
        return false;
    }
    (void)fcntl(self->news[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(self->news[1], F_SETFD, FD_CLOEXEC);
    const bool started = start_thread(&self->thread, watch, self);
    if (!started) {
        (void)close(self->news[0]);
        (void)close(self->news[1]);
    }
    return started;
}

void interrupt_begin(interrupt_watch *self, void (*give_up)(void *ctx), void *ctx)
{
    *self = (interrupt_watch){ .give_up = give_up, .ctx = ctx };
    (void)pthread_mutex_init(&self->records, NULL);
    (void)pthread_mutex_lock(&self->records);
    self->watched = give_up != NULL && start(self);
    wake = self->watched ? self->news[1] : -1;
    if (self->watched && came != 0) {
        (void)!write(wake, "", 1);
    }
}

void interrupt_end(interrupt_watch *self)
{
    self->over = true;
    (void)pthread_mutex_unlock(&self->records);
    if (self->watched) {
        wake = -1;
        (void)close(self->news[1]); /* wakes the thread, which a lost write would not */
        (void)pthread_join(self->thread, NULL);
        (void)close(self->news[0]);
    }
    (void)pthread_mutex_destroy(&self->records);
}

/* ---- the parent --------------------------------------------------------------- */

#define PARENT_PERIOD 100000000L /* [ns] */

/* No portable call tells when the parent ends. */
static void *watch_parent(void *ctx)
{
    const pid_t parent = (pid_t) * (const size_t *)ctx;
    const struct timespec pause = { .tv_nsec = PARENT_PERIOD };
    while (getppid() == parent) {
        (void)nanosleep(&pause, NULL);
    }
    (void)kill(getpid(), SIGTERM);
    return NULL;
}

void interrupt_with_parent(void)
{
    const char *given = getenv("WEFT_PARENT");
    static size_t parent; /* which the thread reads as long as the program runs */
    pthread_t thread;
    if (given != NULL && option_count(given, '\0', &parent)) {
        (void)unsetenv("WEFT_PARENT"); /* of a program that this one starts, another */
        if (start_thread(&thread, watch_parent, &parent)) {
            (void)pthread_detach(thread);
        }
    }
}
