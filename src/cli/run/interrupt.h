/* SPDX-License-Identifier: BSD-3-Clause */
/* interrupt.h -- SIGINT and SIGTERM end a run: before the next evaluation of the
 * forces, or, where a solver does not come back to them, by a thread that watches. */
#ifndef WEFT_CLI_RUN_INTERRUPT_H
#define WEFT_CLI_RUN_INTERRUPT_H

#include <pthread.h>
#include <stdbool.h>

/* From now on they are remembered; from then on they end the process again. */
void interrupt_catch(void);
void interrupt_restore(void);

/* The signal that came; 0: none. */
int interrupt_signal(void);
/* The same, and forgets it. */
int interrupt_next(void);

/* A weft_stop_fn. */
bool interrupt_pending(void *unused);

/* Between begin and end the records of a run belong to the caller, but while it has
 * lent them. If a signal has been pending for a second, or comes again, and they are
 * lent, another thread takes them for good and calls give_up, which ends the process.
 */
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
void interrupt_lend(interrupt_watch *self);
void interrupt_take(interrupt_watch *self);
void interrupt_end(interrupt_watch *self);

#endif
