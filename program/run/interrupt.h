/* SPDX-License-Identifier: BSD-3-Clause */
/* interrupt.h -- SIGINT and SIGTERM end a run: before the next evaluation of the
 * forces, or, if the solver does not reach it, by a thread that watches. */
#pragma once

#include <pthread.h>
#include <stdbool.h>

#include "weft/comm.h"

/* Records signals from now on; false: they end the process again. */
void interrupt_catch(bool on);

/* If the environment has WEFT_PARENT=PID: a SIGTERM as soon as the parent of this
 * process is not that one any more. Before any other thread. */
void interrupt_with_parent(void);

/* SIGUSR1 is SIGTERM from now on: mpirun passes it on to its processes, but kills them
 * soon after a SIGTERM of its own. */
void interrupt_catch_user(void);

/* Collective: the signal that has come to a band, to all; 0: none. Later ones do not
 * count, as they may have come to some bands alone. */
int interrupt_agreed(const weft_comm *comm);

/* The signal that came; 0: none. */
int interrupt_signal(void);
/* The same, and forgets it. */
int interrupt_next(void);

/* The exit code of a program that a signal has stopped; EXIT_DONE of 0. */
int interrupt_code(int signal);

/* A weft_stop_fn. */
bool interrupt_pending(void *unused);

/* `records`, a lock on the records of a run, which the caller holds after begin and
 * before end, and whenever it uses them. If a signal has been pending for a
 * second, or comes again, another thread takes the lock for good and calls give_up,
 * which ends the process. NULL: there is no thread. */
typedef struct interrupt_watch {
    void (*give_up)(void *ctx);
    void *ctx;
    pthread_mutex_t records;
    pthread_t thread;
    bool watched; /* there is a thread, or signals only end steps */
    bool over;
    int news[2]; /* a pipe: a byte for each signal, and one at the end */
} interrupt_watch;

void interrupt_begin(interrupt_watch *self, void (*give_up)(void *ctx), void *ctx);
void interrupt_end(interrupt_watch *self);
